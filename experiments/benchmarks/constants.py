"""What each constant of sizes and accuracies buys: a question's time, and the change of its answer, at other values of the constant.

    python experiments/benchmarks/constants.py [name ...]

One line a value. The processor's time is over that at the value in the package; the change of the answer, relative to its largest value, is 0 where
the constant decides about time alone. A constant is well chosen where no other value is faster by much without a larger change.
"""

from __future__ import annotations

import importlib
import sys
import time
import tracemalloc
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

import beamprop as bp

Question = Callable[[], np.ndarray]
F = 2500.0
BEAM = bp.GaussianBeam(0.096)
LOSSY, LOSSLESS = bp.Slab(bp.lmmd_cell(), 450), bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)


class Constant(NamedTuple):
    """A constant of a module, other values of it, and a question that it decides."""

    module: str
    name: str
    values: tuple[Any, ...]
    question: Question


def on_planes(planes: int, points: int = 1001) -> Question:
    """A periodic field, whose orders are few, on an even grid of some planes behind the slab."""
    x, z = np.linspace(-1, 1, points), LOSSY.thickness + np.linspace(0, 0.3, planes)
    return lambda: np.asarray(bp.field(LOSSY, BEAM, F, x, z, boundary="periodic", period=7.0).p)


def on_planes_at_angles(planes: int) -> Question:
    """A field of a beam at four angles, at positions that are no even grid."""
    x, z = np.linspace(-1, 1, 301) ** 3, LOSSY.thickness + np.linspace(0, 0.3, planes)
    return lambda: np.asarray(bp.field(LOSSY, BEAM, F, x, z, angle=[0.0, 10.0, 20.0, 30.0]).p)


def mapped(planes: int, points: int) -> Question:
    """A map in front of, inside and behind the slab."""
    x, z = np.linspace(-1, 1, points), np.linspace(0, LOSSY.thickness + 0.3, planes)
    return lambda: np.asarray(bp.field(LOSSY, BEAM, F, x, z).p)


def widths(slab: bp.Slab, count: int, beam: Any = BEAM) -> Question:
    """Widths at many frequencies, behind the slab and without it."""
    frequency = np.linspace(2000, 3000, count)

    def question() -> np.ndarray:
        ds = bp.beam_width(slab, beam, frequency)
        return np.stack([ds.fwhm_out, ds.fwhm_air])

    return question


def measures(name: str, beam: Any = BEAM, slab: bp.Slab = LOSSY, **options: Any) -> Question:
    """One measure of the transmitted beam."""
    return lambda: np.asarray(bp.beam_measures(slab, beam, F, **options)[name].sel(side="transmitted"))


SLITS = bp.Slits(0.02, 0.08, 3, z0=-0.05)
NARROW = bp.Slab(
    [bp.Layer(bp.Fluid(7800.0, 2.7e11), 0.59), bp.Layer(bp.AIR, 0.0686), bp.Layer(bp.Fluid(7800.0, 2.7e11), 0.59)]
)
NEVER = 10**9

#: Each is decided by its question; constants that follow from others, or bound memory, are derived where they are defined.
CONSTANTS = [
    Constant("fields.evaluate", "TABLE_PLANES", (0, NEVER), on_planes(1)),
    Constant("fields.evaluate", "TABLE_PLANES", (0, NEVER), on_planes(4)),
    Constant("fields.evaluate", "TABLE_PLANES", (0, NEVER), on_planes(16)),
    Constant("fields.evaluate", "TABLE_PLANES", (0, NEVER), on_planes(32)),
    Constant("fields.evaluate", "PLANES_OF_A_BEAM", (0, NEVER), on_planes_at_angles(32)),
    Constant("fields.evaluate", "PLANES_OF_A_BEAM", (0, NEVER), on_planes_at_angles(128)),
    Constant("fields.evaluate", "MANY_PLANES", (0, NEVER), mapped(200, 1024)),
    Constant("fields.evaluate", "MANY_PLANES", (0, NEVER), mapped(1000, 1024)),
    Constant("fields.evaluate", "MANY_POINTS", (0, NEVER), mapped(1000, 32)),
    Constant("fields.evaluate", "MANY_POINTS", (0, NEVER), mapped(1000, 128)),
    Constant("fields.evaluate", "TOGETHER", (512, 8192), mapped(4000, 256)),
    Constant("fields.evaluate", "SEARCHED", (45, 180), mapped(1000, 256)),
    Constant("profiles.many_frequencies", "STEP", (4, 8, 16, 32), widths(LOSSY, 101)),
    Constant("profiles.many_frequencies", "MOST_TOGETHER", (2**12, 2**14, 2**20), widths(LOSSY, 501)),
    Constant("profiles.many_frequencies", "MOST_OF_A_FREQUENCY", (50, 1_000_000), widths(bp.Slab.uniform(bp.AIR, 100.0), 3)),
    Constant("profiles.many_frequencies", "ROUND", (0.1, 0.5), widths(LOSSLESS, 5)),
    Constant("profiles.measures", "FINER", (2, 4, 16), measures("width_second_moment", window=0.1)),
    Constant("profiles.measures", "TAIL", (0.02, 0.005), measures("width_second_moment")),
    Constant("profiles.windows", "FAINT", (1e-6, 1e-2), widths(LOSSY, 2, SLITS)),
    Constant("profiles.power", "FINE", (16, 32), measures("power", slab=NARROW)),
    Constant("profiles.power", "COARSE", (13, 21), measures("power", slab=NARROW)),
    Constant("profiles.power", "SHARE", (1e-2, 1e-4), measures("power", slab=NARROW)),
    Constant("profiles.power", "MOST_PANELS", (500, 50_000), measures("power", slab=NARROW)),
]  # fmt: skip


@contextmanager
def changed(constant: Constant, value: Any) -> Iterator[None]:
    """The package with another value."""
    module = importlib.import_module(f"beamprop.{constant.module}")
    kept = getattr(module, constant.name)
    setattr(module, constant.name, value)
    try:
        yield
    finally:
        setattr(module, constant.name, kept)


def processor_time(*questions: Question, repeats: int = 5) -> list[float]:
    """The least times of the processor [s] of questions in turn: what else runs on the machine does not count."""

    def once(question: Question) -> float:
        start = time.process_time()
        question()
        return time.process_time() - start

    return [min(times) for times in zip(*([once(q) for q in questions] for _ in range(repeats)), strict=True)]


def lines_of(constant: Constant) -> Iterator[str]:
    """A line for each value: time over the package's, and the largest change of the answer."""
    value = getattr(importlib.import_module(f"beamprop.{constant.module}"), constant.name)
    answer = constant.question()
    for changed_to in constant.values:

        def question(changed_to: Any = changed_to) -> np.ndarray:
            with changed(constant, changed_to):
                return constant.question()

        change = np.nanmax(np.abs(question() - answer)) / np.nanmax(np.abs(answer))
        ours, theirs = processor_time(constant.question, question)
        yield (
            f"{constant.module}.{constant.name} {value:g} -> {changed_to:g}: "
            f"{theirs / ours:.2f} times the time ({1e3 * ours:.3g} ms), change {change:.1e}"
        )


def costs() -> Iterator[str]:
    """Predicted and measured time and memory of the finite elements' solvers."""
    for method, periods, elements in (
        ("superelement", 450, 48),
        ("superelement", 450, 96),
        ("sparse", 10, 48),
        ("sparse", 40, 48),
    ):
        slab, settings = bp.Slab(bp.lmmd_cell(), periods), {"period": 0.9, "method": method, "elements_x": elements}
        plan = bp.fem.plan(slab, BEAM, F, **settings)
        tracemalloc.start()
        ds = bp.fem.field(slab, BEAM, F, [0.0], [0.0], **settings)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        yield (
            f"fem.solvers.COSTS {method}, {plan.dofs} unknowns: {ds.seconds:.2f} s, predicted {plan.seconds:.2f} s; "
            f"{peak / 1e6:.0f} MB in arrays, predicted {plan.memory / 1e6:.0f} MB with the process"
        )


def main(names: list[str]) -> None:
    warnings.simplefilter("ignore")
    if not names or "COSTS" in names:
        print(*costs(), sep="\n")
    for constant in CONSTANTS:
        if not names or constant.name in names:
            for line in lines_of(constant):
                print(line, flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
