"""Kill studies at random moments, go on, and compare their stores with one that nobody disturbed, bit for bit.

    python experiments/study_kills.py                      # 20 kills of the main process, 10 of a worker
    python experiments/study_kills.py --dask 10            # and 10 of a worker of dask

Each study has 300 points of five milliseconds, in blocks of six, two processes, and so four blocks under way at most. The table says how
many blocks were answered more than once, which may be those under way alone, and how many workers outlived their main process by two seconds.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr

import beamprop as bp
from beamprop.study import store
from beamprop.study.axes import study_of
from beamprop.study.blocks import Grid
from beamprop.study.engine import AHEAD
from beamprop.study.sweep import sample_of

AXES = {"a": np.arange(15), "b": np.arange(20.0)}
POINTS, BLOCK, SECONDS, WORKERS = 300, 6, 0.005, 2


class Question:
    """Takes its time, and writes down in a file that it was asked."""

    def __init__(self, log: str) -> None:
        self.log = log

    def __call__(self, a: int, b: float) -> xr.Dataset:
        time.sleep(SECONDS)
        with open(self.log, "ab", buffering=0) as file:
            file.write(f"{a} {b}\n".encode())
        if a == 7 and b == 3.0:
            raise ArithmeticError("no value here")
        return xr.Dataset({"v": ("x", np.sin(a + b * np.arange(4.0)))}, attrs={"provenance": f"a {a}"})


def empty_store(path: Path, log: Path) -> None:
    """A store whose blocks have a known size."""
    study = study_of(Question(str(log)), AXES)
    store.create(path, study, sample_of(study).schema, Grid(study.shape, (1, BLOCK)), 2 * SECONDS)
    log.write_bytes(b"")


def run(path: str, log: str, cluster: bool) -> None:
    """The command that is killed and repeated."""
    if not cluster:
        bp.sweep(Question(log), AXES, store=path, workers=WORKERS, progress=False)
        return
    from distributed import Client, LocalCluster

    with (
        LocalCluster(n_workers=WORKERS, threads_per_worker=1, dashboard_address=None) as local,
        Client(local) as client,
    ):
        bp.sweep(Question(log), AXES, store=path, workers=WORKERS, executor=client.get_executor(), progress=False)


def children(pid: int) -> list[int]:
    """The workers of a process: its children, and theirs, that multiprocessing has spawned."""
    known = []
    for task in Path(f"/proc/{pid}/task").glob("*"):
        for child in map(int, (task / "children").read_text().split()):
            worker = b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()
            known += [child] * worker + children(child)
    return known


def started(path: Path, log: Path, cluster: bool = False) -> subprocess.Popen:
    """The command, begun."""
    command = [
        sys.executable,
        "-W",
        "ignore::RuntimeWarning",
        __file__,
        "--run",
        str(path),
        str(log),
        *(["--cluster"] if cluster else []),
    ]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def kill_main(process: subprocess.Popen, log: Path) -> list[int]:
    """Kill it; its workers."""
    workers = children(process.pid)
    os.kill(process.pid, signal.SIGKILL)
    return workers


def kill_worker(process: subprocess.Popen, log: Path) -> list[int]:
    """Kill a worker of it."""
    workers = children(process.pid)
    if workers:
        os.kill(random.choice(workers), signal.SIGKILL)
    return []


def contents(path: Path) -> dict[str, bytes]:
    """All files of a store."""
    return {str(file.relative_to(path)): file.read_bytes() for file in sorted(path.rglob("*")) if file.is_file()}


def living(pids: list[int], patience: float = 2.0) -> int:
    """How many processes outlive `patience` [s]."""
    end = time.monotonic() + patience
    while (alive := [pid for pid in pids if lives(pid)]) and time.monotonic() < end:
        time.sleep(0.02)
    return len(alive)


def lives(pid: int) -> bool:
    """Whether a process has not ended; one that has may wait in the list for whoever is to ask for its end (Z)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def trial(folder: Path, fraction: float, kill: Callable, cluster: bool = False) -> tuple[bool, int, int, int]:
    """Begin, kill when a fraction of the points is answered, go on to the end.

    Returns whether the store equals the undisturbed one, blocks answered more than once, points answered, workers left.
    """
    path, log = folder / "study.zarr", folder / "log"
    shutil.rmtree(path, ignore_errors=True)
    shutil.copytree(folder / "empty.zarr", path)
    log.write_bytes(b"")
    process = started(path, log, cluster)
    # the fraction below zero: before the first point
    while process.poll() is None and len(log.read_bytes().splitlines()) < fraction * POINTS:
        time.sleep(0.003)
    time.sleep(random.random() * 2 * SECONDS)
    left = living(kill(process, log)) if process.poll() is None else 0
    process.communicate(timeout=120)
    again = started(path, log, cluster)
    errors = again.communicate(timeout=120)[1]
    assert again.returncode == 0, errors
    asked = Counter(log.read_text().splitlines())
    blocks = {(a, int(float(b)) // BLOCK) for (a, b), n in ((line.split(), n) for line, n in asked.items()) if n > 1}
    return contents(path) == contents(folder / "whole.zarr"), len(blocks), len(asked), left


def prepare(folder: Path) -> None:
    """An empty store, and a copy of it that is filled without a disturbance."""
    empty_store(folder / "empty.zarr", folder / "log")
    shutil.copytree(folder / "empty.zarr", folder / "whole.zarr")
    process = started(folder / "whole.zarr", folder / "log")
    errors = process.communicate(timeout=120)[1]
    assert process.returncode == 0, errors


def table(folder: Path, counts: dict[str, int], seed: int = 0) -> str:
    """Trials as a Markdown table."""
    random.seed(seed)
    prepare(folder)
    lines = [
        "| killed | times | stores equal | blocks done twice, at most | under way | workers left |",
        "|---|---|---|---|---|---|",
    ]
    kinds = {"main process": (kill_main, False), "worker": (kill_worker, False), "worker of dask": (kill_worker, True)}
    for what, count in counts.items():
        rows = [trial(folder, random.random(), *kinds[what]) for _ in range(count)]
        if rows:
            equal = sum(same and points == POINTS for same, _, points, _ in rows)
            most, left = max(r[1] for r in rows), sum(r[3] for r in rows)
            lines.append(f"| {what} | {count} | {equal} | {most} | {AHEAD * WORKERS} | {left} |")
    return "\n".join(lines)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--main", type=int, default=20)
    parser.add_argument("--workers", type=int, default=10)
    parser.add_argument("--dask", type=int, default=0, help="kills of a worker of dask")
    parser.add_argument("--run", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--cluster", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.run:
        run(*options.run, options.cluster)
        return
    with tempfile.TemporaryDirectory() as folder:
        counts = {"main process": options.main, "worker": options.workers, "worker of dask": options.dask}
        print(table(Path(folder), counts))


if __name__ == "__main__":
    main()
