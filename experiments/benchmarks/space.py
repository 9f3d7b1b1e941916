"""Fields in three dimensions against the field of two of as many values, in one run: times, their ratios, and memory.

    python experiments/benchmarks/space.py [--repeats 5]

The two-dimensional field has 500 x 500 values on (z, x); both are judged. Windows 300 wavelengths aside have a table of their own. `ROW_OVER_PLANE` of `fields/in_space.py` is the last table: the
time of one row y on all planes over that of one plane, for lattices of different beams.
"""

from __future__ import annotations

import argparse
import functools
import time
import tracemalloc
import warnings
from typing import Any

import numpy as np
from timing import Work, amount, measure

import beamprop as bp
from beamprop.contour.space import lattice
from beamprop.fields.in_space import SpaceQuestion, prepare

F, SLAB = 2500.0, bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)
BEAMS = {
    "circular, 0": bp.GaussianBeam(0.096, z0=-0.1),
    "circular, 45": bp.GaussianBeam(0.096, 45, z0=-0.1),
    "30 x 15 cm, 45, azimuth 30": bp.GaussianBeam((0.3, 0.15), 45, z0=-0.1, azimuth=30.0),
}


def grids() -> dict[str, dict[str, Any]]:
    """The questions: a cut, a plane, a volume."""
    z = np.linspace(-0.1, 1.3, 500)
    plane, coarse = np.linspace(-1, 1, 512), np.linspace(-1, 1, 200)
    return {
        "cut 500 x 500": {"x": np.linspace(-1, 1, 500), "z": z, "y": 0.0},
        "plane 512 x 512": {"x": plane, "z": SLAB.thickness, "y": plane},
        "volume 200^3": {"x": coarse, "z": np.linspace(-0.1, 1.3, 200), "y": coarse},
    }


def windows_aside() -> dict[str, tuple[bp.Slab, bp.GaussianBeam, dict[str, Any], float]]:
    """Slab, beam, grid and rtol of windows 300 wavelengths aside: several kinds, long contours among them; a long one, and one at 730 wavelengths."""
    air, narrow = bp.Slab.uniform(bp.AIR, 0.5), bp.GaussianBeam(0.1, 80, z0=-0.1)
    x, y = np.linspace(41, 45, 100), np.linspace(-2, 2, 100)
    return {
        "4 m x 4 m behind the slab": (SLAB, bp.GaussianBeam(0.27, 45, z0=-0.1), {"x": x, "z": 1.2, "y": y}, 1e-8),
        "10 m x 1 m behind the slab": (SLAB, narrow, {"x": np.linspace(41, 51, 100), "z": 1.2, "y": y / 4}, 1e-8),
        "20 planes of 4 m x 4 m in air": (air, narrow, {"x": x, "z": np.linspace(1, 3, 20), "y": y}, 1e-8),
        "200 x 200, 2 m deep, in air": (
            air,
            narrow,
            {"x": np.linspace(41, 45, 200), "z": np.linspace(1, 3, 200), "y": 0.0},
            1e-8,
        ),
        "4 m x 4 m in air, rtol 1e-11": (air, narrow, {"x": x, "z": 3.0, "y": y}, 1e-11),
        "20 m x 0.5 m behind the slab": (SLAB, narrow, {"x": np.linspace(41, 61, 100), "z": 1.2, "y": y / 8}, 1e-8),
        "3 m x 3 m, 100 m aside in air, rtol 1e-11": (
            air,
            narrow,
            {"x": np.linspace(100, 103, 100), "z": 3.0, "y": 0.75 * y},
            1e-11,
        ),
    }


def question(beam: bp.GaussianBeam, grid: dict[str, Any]) -> Work:
    """A field."""
    return lambda: bp.field(SLAB, beam, F, **grid)


def memory_beside(work: Work, answer: float) -> float:
    """The most bytes that Python and NumPy hold at a time, less the answer's."""
    tracemalloc.start()
    work()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak - answer


def row_over_plane(beam: bp.GaussianBeam) -> float:
    """Time of a row y on 500 planes, over that of a plane of 500 rows."""
    x = np.linspace(-1, 1, 500)
    question = SpaceQuestion(
        SLAB, beam.in_space(beam.azimuth), np.array([F]), np.array([beam.angle]), x[:1] * 0 + 1, x, x, 1e-8
    )
    waves = prepare(question, 0).waves
    grid = waves.quadrature.contour.lattice
    spectra, h = grid.spectra(waves.k0, waves.sources), np.ones((500, waves.quadrature.contour.k.size), complex)
    out, of_row = np.empty((1, 4, 500, 500), complex), np.empty((1, 500, 1, 500), complex)
    row, planes = measure(
        lambda: lattice.rows(grid, spectra, h, x, x[200:201], of_row),
        lambda: lattice.fields(grid, spectra, h[:4], x, x, out),
        repeats=3,
    )
    return row / (planes / 4)


def main() -> None:
    """All tables."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    repeats = parser.parse_args().repeats
    x, z = np.linspace(-1, 1, 500), np.linspace(-0.1, 1.3, 500)
    print("| field | beam | time | over the 2-D field | memory beside the answer |", "|---|---|---|---|---|", sep="\n")
    for name, grid in grids().items():
        for text, beam in BEAMS.items():
            work = question(beam, grid)
            flat, ours = measure(lambda: bp.field(SLAB, BEAMS["circular, 0"], F, x, z), work, repeats=repeats)
            beside = memory_beside(work, 16.0 * np.prod([np.size(v) for v in grid.values()]))
            print(f"| {name} | {text} | {amount(ours, 's')} | {ours / flat:.2g} | {amount(beside, 'B')} |", flush=True)
    print("\n| window aside | time | memory beside the answer |", "|---|---|---|", sep="\n")
    warnings.simplefilter(
        "ignore", bp.AccuracyWarning
    )  # two of them are dark to rounding: their error is over |p| far outside
    for name, (slab, beam, grid, rtol) in windows_aside().items():
        work = functools.partial(bp.field, slab, beam, F, **grid, rtol=rtol)
        (ours,) = measure(work, repeats=repeats)
        beside = memory_beside(work, 16.0 * np.prod([np.size(v) for v in grid.values()]))
        print(f"| {name} | {amount(ours, 's')} | {amount(beside, 'B')} |", flush=True)
    print("\n| beam | a row y over a plane |", "|---|---|", sep="\n")
    for text, beam in BEAMS.items():
        print(f"| {text} | {row_over_plane(beam):.2g} |")


if __name__ == "__main__":
    start = time.perf_counter()
    main()
    print(f"\n{time.perf_counter() - start:.0f} s in all")
