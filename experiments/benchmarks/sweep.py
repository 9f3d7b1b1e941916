"""A study of 100 000 points: points per second by `sweep`, by a plain loop, and by xarray with dask by hand, in one run.

    python experiments/benchmarks/sweep.py                       # the table
    python experiments/benchmarks/sweep.py --points 5000 --by-hand 500

The axes are eta, number of periods, angle and frequency; each point is one `beam_width`. "Frequencies together" is the same study with a question that
takes all frequencies at once, as a dimension of its own. What `sweep` itself costs is measured with a question that costs nothing.
"""

import _one_thread  # noqa: F401  # isort: skip

import argparse
import os
import resource
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import dask
import numpy as np
import xarray as xr

import beamprop as bp
from beamprop.study import store
from beamprop.study.arrays import InMemory
from beamprop.study.axes import study_of
from beamprop.study.blocks import OVERHEAD, Grid
from beamprop.study.engine import Processes
from beamprop.study.sweep import sample_of
from beamprop.study.work import Task, answers, empty_result

ETA = np.linspace(1 / 100, 1 / 50, 10)
PERIODS = np.arange(50, 500, 45)
ANGLE = np.linspace(0.0, 45.0, 10)
BEAM = bp.GaussianBeam(0.096)


def axes_of(points: int) -> dict[str, np.ndarray]:
    """The axes of about so many points."""
    count = max(2, points // (len(ETA) * len(PERIODS) * len(ANGLE)))
    return {"eta": ETA, "periods": PERIODS, "angle": ANGLE, "frequency": np.linspace(2000.0, 3000.0, count)}


def width(eta: float, periods: int, angle: float, frequency: float) -> xr.Dataset:
    """One point."""
    slab = bp.Slab(bp.lmmd_cell(eta=eta, lossless=False), periods)
    return bp.beam_width(slab, BEAM, frequency, angle)


def together(frequencies: np.ndarray) -> Callable[[float, int, float], xr.Dataset]:
    """All frequencies of a point of the other axes."""
    return lambda eta, periods, angle: width(eta, periods, angle, frequencies)  # type: ignore[arg-type]


def seconds_of(work: Callable[[], object]) -> float:
    """Time of one run."""
    return times_of(work)[0]


def times_of(work: Callable[[], object]) -> tuple[float, float]:
    """Time of one run, and processor time, that of the processes which it started and which have ended included."""
    start, before = time.perf_counter(), sum(os.times()[:4])
    work()
    return time.perf_counter() - start, sum(os.times()[:4]) - before


def loop(axes: dict[str, np.ndarray], count: int) -> int:
    """The plain loop, over every so-manieth point; how many it did."""
    study = study_of(width, axes)
    points = study.points(np.linspace(0, study.size - 1, count).astype(int))
    for point in points:
        width(*point).fwhm_out.item()
    return len(points)


def by_hand(axes: dict[str, np.ndarray], count: int) -> int:
    """`xarray.apply_ufunc` on chunks, by two processes of dask: one variable, no provenance, no store; how many points it did."""
    part = {**axes, "frequency": axes["frequency"][:2], "eta": ETA[: max(1, count // (len(PERIODS) * len(ANGLE) * 2))]}
    grid = xr.broadcast(*(xr.DataArray(v, {n: v}, n) for n, v in part.items()))
    chunks = {"eta": 1, "periods": 5, "angle": 10, "frequency": -1}
    lazy = xr.apply_ufunc(
        lambda *point: width(*point).fwhm_out.item(),
        *(values.chunk(chunks) for values in grid),
        vectorize=True,
        dask="parallelized",
        output_dtypes=[float],
    )
    with dask.config.set(scheduler="processes", num_workers=2):
        return lazy.compute().size


def row(name: str, workers: int, points: int, took: tuple[float, float], store: str = "-") -> str:
    """A line of the table."""
    wall, processor = took
    return f"| {name} | {workers} | {points} | {wall:.1f} | {points / wall:.0f} | {1e3 * processor / points:.2f} ms | {store} |"


def study_row(
    name: str, question: Callable, axes: dict[str, np.ndarray], points: int, workers: int
) -> tuple[str, tuple[float, float]]:
    """A line of the table, and `times_of` the study."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.zarr"
        took = times_of(lambda: bp.sweep(question, axes, store=path, workers=workers, progress=False))
        size = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    return row(name, workers, points, took, f"{size / 1e6:.1f} MB"), took


def own_costs() -> list[str]:
    """What `sweep` costs by itself: a point, a block in memory, in a store, and sent to another process."""
    answer = width(ETA[0], 50, 0.0, 2500.0)
    axes = {"a": np.arange(20), "frequency": np.arange(500.0)}
    study = study_of(lambda a, frequency: answer, axes)
    schema = sample_of(study).schema
    grid = Grid(study.shape, (1, 500))
    task = Task(_pickled(study.question), tuple(axes), study.points(grid.points(0)), schema, {})
    point = min(seconds_of(lambda: answers(task)) for _ in range(5)) / len(task.points)
    result = empty_result(schema, len(task.points), 1, "")
    memory = InMemory(study, schema, grid)
    in_memory = min(seconds_of(lambda: memory.put(0, result)) for _ in range(5))
    with tempfile.TemporaryDirectory() as folder:
        store.create(Path(folder) / "a.zarr", study, schema, grid, 1.0)
        kept = store.Store(Path(folder) / "a.zarr", study)
        in_store = min(seconds_of(lambda: kept.put(0, result)) for _ in range(5))
    pool = Processes(1)
    small = task._replace(points=task.points[:1])
    pool.submit(answers, small).result()
    sent = min(seconds_of(lambda: pool.submit(answers, task).result()) for _ in range(5)) - point * len(task.points)
    pool.close()
    return [
        f"a point costs {1e6 * point:.0f} µs beside its question; a block of 500 points {1e3 * in_memory:.1f} ms in memory, "
        f"{1e3 * in_store:.1f} ms in a store, {1e3 * max(sent, 0.0):.1f} ms to send; `OVERHEAD` is {1e3 * OVERHEAD:.0f} ms"
    ]


def _pickled(question: Callable) -> bytes:
    import cloudpickle

    return cloudpickle.dumps(question)


def report(points: int, count: int) -> str:
    """The table, and sentences."""
    axes = axes_of(points)
    size = int(np.prod([len(v) for v in axes.values()]))
    frequencies = axes["frequency"]
    rest = {n: v for n, v in axes.items() if n != "frequency"}
    width(ETA[0], 50, 0.0, 2500.0)
    lines = [
        "| way | workers | points | s | points/s | processor time a point | store |",
        "|---|---|---|---|---|---|---|",
    ]
    done: list[int] = []
    for name, work, workers in (("plain loop", loop, 1), ("xarray and dask by hand", by_hand, 2)):
        took = times_of(lambda work=work: done.append(work(axes, count)))  # type: ignore[misc]
        lines.append(row(name, workers, done[-1], took))
    times = {}
    for name, question, over in (("sweep", width, axes), ("sweep, frequencies together", together(frequencies), rest)):
        for workers in (1, 2):
            line, times[name, workers] = study_row(name, question, over, size, workers)
            lines.append(line)
    names = list(dict.fromkeys(name for name, _ in times))
    ratios = ", ".join(f"{times[n, 1][0] / times[n, 2][0]:.2f} ({n})" for n in names)
    alone = ", ".join(f"{times[n, 2][1] / 2:.0f} s ({n})" for n in names)
    peak = {who: resource.getrusage(kind).ru_maxrss / 1024 for who, kind in (("main", 0), ("workers", -1))}
    lines += [
        "",
        f"{size} points on two cores that nobody else uses, by processor time: {alone}",
        f"two workers over one: {ratios}; largest memory {peak['main']:.0f} MB here, {peak['workers']:.0f} MB in a worker",
    ]
    return "\n".join([*lines, *own_costs()])


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--by-hand", type=int, default=2000, help="points of the loop and of dask")
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # profiles that meet the half level more than twice: the times are asked for
    print(report(options.points, options.by_hand))


if __name__ == "__main__":
    main()
