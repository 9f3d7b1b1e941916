"""Spectrum x response -> p(z, x): the response in front, inside and behind, and the choice of a line for an rtol.

Everything here is for one frequency; a `Scene` holds what does not change from line to line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from . import spectral
from .beam import Beam
from .conventions import outgoing_kz
from .media import FluidValues, SegmentValues, Slab, slab_values
from .response import solve
from .spectral import Line, Reach

#: How often a line is tightened before the asked rtol is given up, and the most modes that a line may have.
LEVELS = (1.0, 1.3, 1.7, 2.2, 3.0)
MOST_MODES = 400_000

#: h(kx, z): what a plane wave of the source's spectrum has become at z; (Z, n).
Transfer = Callable[[np.ndarray, np.ndarray], np.ndarray]


class Scene(NamedTuple):
    """One slab at F frequencies, as arrays; most functions here take F = 1."""

    segments: list[SegmentValues]
    before: FluidValues
    after: FluidValues
    omega: np.ndarray  # (F, 1)
    thickness: float
    k0: Any  # float for one frequency, (F,) for several
    branches: tuple[Any, ...]  # |kx| of the branch points, shaped like k0


def scene(slab: Slab, frequency: float) -> Scene:
    """Evaluate a slab at one frequency; refuse half-spaces in which the question has no answer."""
    s = scenes(slab, np.array([frequency]))
    return s._replace(k0=float(s.k0[0]), branches=tuple(float(b[0]) for b in s.branches))


def scenes(slab: Slab, f: np.ndarray) -> Scene:
    """Evaluate a slab at frequencies (F,)."""
    branches = []
    for name, fluid in (("before", slab.before), ("after", slab.after)):
        k = fluid.wavenumber(f).real
        bad = (k < 0) | ((k == 0) | np.isinf(k) if name == "before" else False)
        if np.any(bad):
            raise ValueError(
                f"{name}: expected a half-space that carries forward waves at {f[bad][0]} Hz, got {fluid!r}"
            )
        if np.all((k > 0) & np.isfinite(k)):
            branches.append(k)
    return Scene(
        slab_values(slab, f),
        slab.before.at(f),
        slab.after.at(f),
        2 * np.pi * f[:, None],
        slab.thickness,
        slab.before.wavenumber(f).real,
        tuple(branches),
    )


def factors(s: Scene, kx: np.ndarray, z: np.ndarray, z0: float) -> np.ndarray:
    """h(z, kx): total pressure at z per unit of the source's spectrum on z = z0; (Z, n)."""
    out = np.empty((z.size, kx.size), complex)
    front, behind = z <= 0, z >= s.thickness
    inside = ~front & ~behind
    kz = outgoing_kz(kx, s.omega[0], *(v[0] for v in s.before))
    launch = np.exp(-1j * kz * z0)
    res = solve(s.segments, s.before, s.after, s.omega, kx[None], z[inside])
    with np.errstate(under="ignore"):
        if front.any():
            depth = z[front][:, None]
            out[front] = np.exp(1j * kz * (depth - z0)) + res.r[0] * launch * np.exp(-1j * kz * depth)
        if inside.any():
            out[inside] = res.inside[0] * launch
        if behind.any():
            kz2 = outgoing_kz(kx, s.omega[0], *(v[0] for v in s.after))
            out[behind] = res.t[0] * launch * np.exp(1j * kz2 * (z[behind] - s.thickness)[:, None])
    return out


def through(s: Scene, z0: float) -> Transfer:
    """The transfer through a slab from the launch plane z0."""
    return lambda kx, z: factors(s, kx, z, z0)


def free(s: Scene) -> Transfer:
    """The transfer through the medium in front alone, over the distance z."""

    def transfer(kx: np.ndarray, z: np.ndarray) -> np.ndarray:
        kz = outgoing_kz(kx, s.omega[0], *(v[0] for v in s.before))
        return np.exp(1j * np.multiply.outer(z, kz))

    return transfer


def even_spacing(x: np.ndarray) -> float:
    """Spacing of an even grid, 0 for any other."""
    if x.size < 8:
        return 0.0
    dx = (x[-1] - x[0]) / (x.size - 1)
    even = dx > 0 and np.max(np.abs(x - (x[0] + dx * np.arange(x.size)))) <= 1e-12 * max(abs(x[0]), abs(x[-1]))
    return float(dx) if even else 0.0


def _reach(s: Scene, beams: list[Beam], x: np.ndarray, z: np.ndarray, rtol: float) -> Reach:
    tolerance = rtol * 1e-2
    bands = [beam.band(s.k0, tolerance) for beam in beams]
    beam = beams[0]
    source = beam.reach(tolerance)
    extent = float(np.max(np.abs(x - beam.centre), initial=0.0))
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    band = max(max(-lo, hi) for lo, hi in bands)
    return Reach(s.k0, min(s.branches), band, max(extent, source), source, path)


def _check_points(
    x: np.ndarray, z: np.ndarray, beam: Beam, source: float, thickness: float
) -> tuple[np.ndarray, np.ndarray]:
    """A few planes and positions that stand for all: the ends, the faces, some between, and the beam's own reach."""
    zs = np.sort(z)
    pick = zs[np.unique(np.linspace(0, zs.size - 1, 7).round().astype(int))]
    near = [zs[np.argmin(np.abs(zs - face))] for face in (0.0, thickness)]
    xs = np.sort(x)
    xs = xs[np.unique(np.linspace(0, xs.size - 1, 31).round().astype(int))]
    own = beam.centre + source * np.linspace(-1, 1, 41)
    return np.concatenate([xs, own]), np.unique([*pick, *near])


class Solution(NamedTuple):
    """A line that serves, and the estimated relative error by angle."""

    line: Line
    error: np.ndarray
    fft: int  #: FFT length if the line fits the asked even grid, else 0


def choose_line(s: Scene, beams: list[Beam], transfer: Transfer, x: np.ndarray, z: np.ndarray, rtol: float) -> Solution:
    """The cheapest line on which the field keeps rtol, judged by a second line of other parameters.

    The two share no error term: sigma, delta and W all differ, so their difference at the check points is the error of the
    coarser one.
    """
    reach = _reach(s, beams, x, z, rtol)
    points, planes = _check_points(x, z, beams[0], reach.source, s.thickness)
    dx = even_spacing(x)
    best: Solution | None = None
    for tighten in LEVELS:
        if all(beam.entire for beam in beams):
            plan = spectral.plan_open(reach, rtol, tighten)
            n = spectral.fast_length(math.ceil(plan.window / dx)) if dx else 0
            if n and n <= max(4096, 8 * x.size):
                plan = plan._replace(window=n * dx)
            else:
                n = 0
            if plan.band * plan.window > 2 * np.pi * MOST_MODES:
                break
            line, second = spectral.open_line(plan), spectral.open_line(plan.other())
        else:
            n = 0
            count = int((40 + 0.8 * reach.k0 * (reach.extent + reach.path)) * tighten)
            line, second = (spectral.propagating_line(s.k0, list(s.branches), c) for c in (count, int(1.3 * count)))
        found = Solution(line, _difference(s, beams, transfer, line, second, points, planes), n)
        if best is None or found.error.max() < best.error.max():
            best = found
        if found.error.max() <= rtol:
            break
    if best is None:
        raise ValueError(f"rtol: {rtol:g} needs more than {MOST_MODES} plane waves for this source and window")
    return best


def _difference(
    s: Scene, beams: list[Beam], transfer: Transfer, one: Line, two: Line, x: np.ndarray, z: np.ndarray
) -> np.ndarray:
    """Largest difference between the fields on two lines, over the largest |p| of each plane, by beam."""
    h1, h2 = (transfer(line.k, z) for line in (one, two))
    errors = []
    for beam in beams:
        a, b = (point_sum(s, beam, line, h, x) for line, h in ((one, h1), (two, h2)))
        largest = np.max(np.abs(a), axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = np.max(np.abs(a - b), axis=1) / largest
        errors.append(np.max(np.where(largest > 1e-290, ratio, 0.0)))
    return np.maximum(1.5 * np.array(errors), 4 * spectral.EPS)


def point_sum(s: Scene, beam: Beam, line: Line, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) at any x by a matrix product."""
    right, left = spectral.amplitudes(line, lambda k: beam.spectrum(k, s.k0), beam.centre)
    return spectral.direct_sum(line, h, right, left, x - beam.centre)


def beam_sum(s: Scene, beam: Beam, solution: Solution, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) by whichever of FFT and matrix product is cheaper."""
    right, left = spectral.amplitudes(solution.line, lambda k: beam.spectrum(k, s.k0), beam.centre)
    x = x - beam.centre
    n = solution.fft
    if n and n * math.log2(n) * 4 < solution.line.k.size * x.size:
        return spectral.fft_sum(solution.line, h, right, left, x, n)
    return spectral.direct_sum(solution.line, h, right, left, x)


def periodic_solution(s: Scene, beams: list[Beam], x: np.ndarray, period: float) -> Solution:
    """The plain sum over the real orders of a stated period."""
    band = max(max(-lo, hi) for lo, hi in (beam.band(s.k0, 1e-15) for beam in beams))
    if band * period > 2 * np.pi * MOST_MODES:
        band = 2 * np.pi * MOST_MODES / period
    line = spectral.periodic_line(period, band)
    dx = even_spacing(x)
    n = round(period / dx) if dx else 0
    fits = n and abs(n * dx - period) < 1e-12 * period and spectral.fast_length(n) == n
    return Solution(line, np.zeros(len(beams)), n if fits and n >= x.size else 0)
