"""Spectrum x response -> p(z, x): the response in front, inside and behind, and the choice of a line for an rtol.

Everything here is for one frequency; a `Scene` holds what does not change from line to line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from . import modes, spectral
from .beam import Beam
from .conventions import outgoing_kz
from .response import solve
from .scene import Scene
from .spectral import Line, Reach

#: The most modes that a line may have, and how often a plan is widened before the asked rtol is given up.
MOST_MODES = 200_000
ATTEMPTS = 14

#: h(kx, z): what a plane wave of the source's spectrum has become at z; (Z, n).
#: h(kx, z, shift): the same at kx (1 + shift) and w (1 - shift), to see what rounding does.
Transfer = Callable[..., np.ndarray]


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

    def transfer(kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        return factors(_shifted(s, shift), kx * (1 + shift), z, z0)

    return transfer


def _shifted(s: Scene, shift: float) -> Scene:
    """w (1 - shift), and layers of a cell that differ among themselves by an eighth of that: densities may cancel."""
    if not shift:
        return s
    segments = []
    for values in s.segments:
        mass = values.layers.mass
        uneven = 1 + shift / 8 * np.where(np.sin(2.4 * np.arange(mass.shape[0])) > 0, 1, -1)[:, None]
        segments.append(values._replace(layers=values.layers._replace(mass=mass * uneven)))
    return s._replace(omega=s.omega * (1 - shift), segments=segments)


def free(s: Scene) -> Transfer:
    """The transfer through the medium in front alone, over the distance z."""

    def transfer(kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        kz = outgoing_kz(kx * (1 + shift), _shifted(s, shift).omega[0], *(v[0] for v in s.before))
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
    tolerance = rtol * 1e-3
    bands = [beam.band(s.k0, tolerance) for beam in beams]
    beam = beams[0]
    source = beam.reach(tolerance)
    extent = float(np.max(np.abs(x - beam.centre), initial=0.0))
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    band = max(max(-lo, hi) for lo, hi in bands)
    band = min(band, _arriving(s, beam.z0, z, tolerance))
    return Reach(s.k0, min(s.branches), band, max(extent, source), source, path)


def _arriving(s: Scene, z0: float, z: np.ndarray, tolerance: float) -> float:
    """|kx| beyond which waves have decayed to `tolerance` on their way, in the half-spaces, to the nearest plane.

    What a slab does to them is not known here: it shows in the band's edge.
    """
    nearest = float(z.min())
    way = min(nearest, 0.0) - z0 + max(0.0, nearest - s.thickness)
    return math.hypot(max(s.branches), math.log(1 / tolerance) / way) if way > 0 else math.inf


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
    fft: int = 0  #: FFT length if the line fits the asked even grid, else 0
    circles: bool = False  #: whether it has circles around backward modes


class _Checks(NamedTuple):
    """Where two lines are compared."""

    beams: list[Beam]
    transfer: Transfer
    x: np.ndarray
    z: np.ndarray
    guided: bool


def choose_line(
    s: Scene,
    beams: list[Beam],
    transfer: Transfer,
    x: np.ndarray,
    z: np.ndarray,
    rtol: float,
    guided: bool = True,
) -> Solution:
    """The cheapest line on which the field keeps rtol, judged by a second line of other parameters.

    The two share no error term, so their difference at the check points is the error of the coarser one. An even grid of
    many points gets a pair of straight lines for FFTs, judged by the bent path. `guided` says whether the transfer knows
    guided modes (none without a slab).
    """
    reach = _reach(s, beams, x, z, rtol)
    points, planes = _check_points(x, z, beams[0], reach.source, s.thickness)
    checks = _Checks(beams, transfer, points, planes, guided)
    if not all(beam.entire for beam in beams):
        return _propagating_solution(s, checks, reach, rtol)
    bent = _bent_solution(s, checks, reach, rtol)
    straight = None if bent.circles else _straight_solution(s, checks, reach, rtol, bent, x)
    return straight or bent


def _bent_solution(s: Scene, checks: _Checks, reach: Reach, rtol: float) -> Solution:
    """Widen the window, or the band where its edge is what is missing, until two bent paths agree."""
    plan = spectral.plan_bent(reach, rtol, noise := _noise(checks, reach))
    found, searched = modes.NONE, 0.0 if checks.guided else math.inf
    best: Solution | None = None
    shrinks = 2 if modes.is_lossless(s) else 6  # on the axis itself their number does not fall
    in_vain = 0
    for _ in range(ATTEMPTS):
        if plan.other().band * plan.other().window > 2 * np.pi * MOST_MODES:
            break
        if plan.band > searched:
            searched = 1.15 * plan.band
            found = modes.between(s, 1.05 * plan.depth, searched)
        if found is modes.UNCLEAR and shrinks == 0:
            break
        if found is modes.UNCLEAR:  # nearer to the axis there are fewer
            shrinks -= 1
            plan = spectral.plan_bent(reach._replace(band=plan.band), rtol, noise, plan.depth / 3)
            searched = 0.0
            continue
        line, second = (
            modes.with_circles(spectral.bent_line(p), found, max(reach.extent, reach.source))
            for p in (plan, plan.other())
        )
        error, edge = _difference(s, checks, line, second)
        stuck = best is not None and error.max() > 0.5 * best.error.max()
        if best is None or error.max() < best.error.max():
            best = Solution(line, error, circles=bool(found.wrong))
        in_vain = in_vain + 1 if stuck else 0
        if error.max() <= rtol or in_vain > 3:
            break
        if edge > 0.3 * rtol:
            plan = plan._replace(band=plan.band * 1.5)
        elif stuck:  # wider does not help: rounding, magnified by exp(depth X)
            plan = plan._replace(depth=plan.depth * 0.6, window=plan.window * 1.3)
        else:
            plan = plan._replace(window=plan.window * 1.6)
    if best is None and found is modes.UNCLEAR:
        raise ValueError("slab: it guides more backward waves than can be told from the forward ones; add loss")
    if best is None:
        raise ValueError(
            f"rtol: {rtol:g} needs more than {MOST_MODES} plane waves for this source and window (the spectrum of a sharp "
            "edge does not end on its own launch plane: ask for z a little behind z0)"
        )
    return best


def _noise(checks: _Checks, reach: Reach) -> float:
    """Relative rounding of the response, seen in its change when k changes in the last bits."""
    k = np.linspace(0.03, min(reach.band, 3 * reach.k0), 24) * (1 - 0.05j)
    a, b = (
        checks.transfer(np.concatenate([k, k * (1 + 4 * spectral.EPS)]), checks.z).reshape(-1, 2, k.size).swapaxes(0, 1)
    )
    size = np.max(np.abs(a), axis=1, keepdims=True)
    change = np.abs(a - b) / np.where(size > 0, size, 1.0)
    return float(np.max(change, initial=0.0, where=np.isfinite(change)))


def _straight_solution(
    s: Scene, checks: _Checks, reach: Reach, rtol: float, bent: Solution, x: np.ndarray
) -> Solution | None:
    """Straight lines for an FFT where that is cheaper than a matrix product over the bent path, and as good."""
    dx = even_spacing(x)
    if not dx:
        return None
    for tighten in (1.0, 1.4):
        plan = spectral.plan_open(reach, rtol, tighten)
        n = spectral.fast_length(max(math.ceil(plan.window / dx), x.size))
        if not _fft_is_cheaper(n, bent.line.k.size, x.size):
            return None
        line = spectral.open_line(plan._replace(window=n * dx))
        error, _ = _difference(s, checks, line, bent.line)
        if error.max() <= rtol:
            return Solution(line, np.maximum(error, bent.error), n)
    return None


def _fft_is_cheaper(n: int, modes: int, points: int) -> bool:
    """Whether two FFTs of length n cost less than a row of a matrix product (in units that were measured)."""
    return 7 * n * math.log2(n) < modes * points


def _propagating_solution(s: Scene, checks: _Checks, reach: Reach, rtol: float) -> Solution:
    """Gauss nodes over the propagating waves, doubled until two numbers of nodes agree."""
    count = int(60 + 0.6 * reach.k0 * (reach.extent + reach.path))
    for _ in range(6):
        lines = [spectral.propagating_line(s.k0, list(s.branches), c) for c in (count, int(1.4 * count))]
        error, _ = _difference(s, checks, *lines)
        if error.max() <= rtol or count > MOST_MODES // 4:
            break
        count = int(1.8 * count)
    return Solution(lines[1], error)


def _difference(s: Scene, checks: _Checks, one: Line, two: Line) -> tuple[np.ndarray, float]:
    """Estimated error of the first line over the largest |p| of each plane, by beam; and what is due to the band's edge.

    The second line's response is taken at kx and w moved in their last bits, so that rounding which both lines share shows
    too.
    """
    h1, h2 = checks.transfer(one.k, checks.z), checks.transfer(two.k, checks.z, 4 * spectral.EPS)
    errors, edges = [], []
    for beam in checks.beams:
        a, b = (point_sum(s, beam, line, h, checks.x) for line, h in ((one, h1), (two, h2)))
        largest = np.minimum(*(np.max(np.abs(v), axis=1) for v in (a, b)))
        seen = largest > 1e-290
        scale = np.where(seen, largest, 1.0)
        edge = _beyond(s, beam, two, h2) if beam.entire else np.zeros(largest.shape)
        with np.errstate(invalid="ignore", over="ignore"):
            error = np.max(np.abs(a - b), axis=1) / scale
            if beam.entire:
                error += _cut_off(s, beam, one, h1, float(np.max(np.abs(checks.x - beam.centre)))) / scale
        errors.append(np.max(np.where(seen, 1.5 * np.nan_to_num(error, nan=np.inf) + edge / scale, 0.0)))
        edges.append(np.max(np.where(seen, edge / scale, 0.0)))
    return np.maximum(np.array(errors), 4 * spectral.EPS), float(max(edges))


def _beyond(s: Scene, beam: Beam, line: Line, h: np.ndarray) -> np.ndarray:
    """Size of what lies beyond the end of a line, plane by plane: its last two tenths, continued geometrically."""
    right, left = spectral.amplitudes(line, lambda k: beam.spectrum(k, s.k0), beam.centre)
    size = (np.abs(right) + np.abs(left)) * np.abs(h)
    tenth = max(1, line.k.size // 10)
    last, before = size[:, -tenth:].sum(axis=1), size[:, -2 * tenth : -tenth].sum(axis=1)
    ratio = np.clip(last / np.maximum(before, 1e-300), 0.0, 0.95)
    return 2 * last * ratio / (1 - ratio)


def _cut_off(s: Scene, beam: Beam, line: Line, h: np.ndarray, extent: float) -> np.ndarray:
    """Size of what is missing where a spectrum ends inside a line (samples too coarse for their profile), plane by plane.

    |w S h e^{ikx}| at the last node, times the nodes that would fit between it and the real axis, where the cut is defined.
    """
    missing = np.zeros(h.shape[0])
    for side, amplitude in zip(
        (1, -1), spectral.amplitudes(line, lambda k: beam.spectrum(k, s.k0), beam.centre), strict=True
    ):
        used = np.flatnonzero(amplitude)
        if used.size < 2:
            continue
        j = used[-1]
        k, step = line.k[j], max(abs(line.k[j] - line.k[j - 1]), 1e-300)
        if not beam.spectrum(side * (k + 2 * step * np.arange(1, 3)), s.k0).any():
            depth = abs(k.imag)
            missing += np.abs(amplitude[j] * h[:, j]) * (1 + depth / step) * math.exp(min(depth * extent, 100.0))
    return missing


def point_sum(s: Scene, beam: Beam, line: Line, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) at any x by a matrix product."""
    right, left = spectral.amplitudes(line, lambda k: beam.spectrum(k, s.k0), beam.centre)
    return spectral.direct_sum(line, h, right, left, x - beam.centre)


def beam_sum(s: Scene, beam: Beam, solution: Solution, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) by whichever of FFT and matrix product is cheaper."""
    right, left = spectral.amplitudes(solution.line, lambda k: beam.spectrum(k, s.k0), beam.centre)
    x = x - beam.centre
    n = solution.fft
    if n and _fft_is_cheaper(n, solution.line.k.size, x.size):
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
