"""Profiles of a beam across one plane, measured: all frequencies at once, and a slow path for what does not fit.

The fast path samples p on the whole window of an open line by one small FFT a frequency, finds the peak and the half
level on that grid, and places them by Newton's method on the exact sum over the modes. A second line of other
parameters judges the values there. Whatever fails a test (error above rtol, a window too narrow, a spectrum that is not
entire) is done again alone, with a window that grows until it holds the beam.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import is_dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from .. import memory
from ..arrays import fft
from ..contour import choose, near_normal, paths
from ..contour.paths import Contour, Extent, StraightPlan
from ..fields import evaluate as field_sums
from ..modes import misplaced
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import FAINT as DARK
from ..response.transfer_function import TransferFunction, shifts
from ..sources.angles import single
from ..sources.beams import Beam
from .fwhm import HALF_LEVEL, centroid, crossings, full_width

#: h(kx) at one plane for each frequency: (F, n) -> (F, n).
Plane = Callable[[np.ndarray], np.ndarray]


#: A window holds the beam when |p| at its ends is below this share of the level asked for. Not lower: the guided waves of a
#: lossless slab run on along it without end.
EDGE = 0.8
#: Newton's method doubles its digits at each step: after a step this small, in samples, the next would be rounding. The peak
#: needs half the digits of an edge, for |p| is flat there.
NEAR_PEAK, NEAR_EDGE = 1e-6, 1e-8


class Measures(NamedTuple):
    """Of a profile, (F,) each: full width [m], peak [Pa], centroid [m]; how often |p| crosses the level in the window, and error.

    The error is that of |p| over its peak.
    """

    width: np.ndarray
    peak: np.ndarray
    centroid: np.ndarray
    crossings: np.ndarray
    error: np.ndarray


def far_face(s: SampledSlab, z0: float) -> Plane:
    """Transfer from the launch plane z0 to the far face."""

    def plane(kx: np.ndarray) -> np.ndarray:
        return transfer_function.transmitted_at_face(s, kx, z0)

    return plane


def without(s: SampledSlab, distance: np.ndarray) -> Plane:
    """Transfer over distances (F,) in the medium in front."""

    def plane(kx: np.ndarray) -> np.ndarray:
        return transfer_function.over_distance(s, kx, distance)

    return plane


#: From a way along z of so many 1/k0 on the window is found by `_far_landing`, and waves land at most so far to the side before.
FAR = 1e4


def landing(s: SampledSlab, beam: Beam, plane: Plane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half-width (F,) of windows that hold the beam after a way `path` (F,) along z, by stationary phase.

    The beam's strong plane waves span the window.
    """
    lo, hi = beam.band(s.k0, 0.3)
    even = bool(np.all(lo == -hi))  # h is even in kx too: half of the plane waves show all
    k0 = s.k0[:, None]
    k = np.clip(np.linspace(0 * lo if even else lo, hi, 21 if even else 41, axis=-1), -0.98 * k0, 0.98 * k0)
    small = 1e-4 * k0
    low, high = np.split(plane(np.concatenate([k - small, k + small], axis=-1).astype(complex)), 2, axis=-1)
    least, most = shifts(low, high, small)
    if even:
        least, most = np.minimum(least, -most), np.maximum(most, -least)
    least, most = (np.clip(v, -FAR / s.k0, FAR / s.k0) for v in (least, most))
    far = path > FAR / s.k0
    if np.any(far):
        least, most = (
            np.where(far, *pair) for pair in zip(_far_landing(s, beam, plane, path), (least, most), strict=True)
        )
    return beam.centre + (most + least) / 2, 1.5 * beam.reach(1e-2) + 2 * np.pi / s.k0 + (most - least) / 2


#: Plane waves by which a far field is looked at, and what share of the largest |p| the window of a far field holds.
RAYS, BRIGHT = 401, 0.25


def _far_landing(s: SampledSlab, beam: Beam, plane: Plane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most shift (F,) along x of the rays that are bright where they land.

    Rays part on a long way: |p| of a far field is |S h| / sqrt(2 pi |dx/dkx|), x(kx) being where a plane wave lands (stationary
    phase). Few are as bright as the strongest, so that the window is narrower than all the plane waves of the beam would span it.
    """
    lo, hi = (np.clip(v, -0.999 * s.k0, 0.999 * s.k0) for v in beam.band(s.k0, 1e-2))
    k0, k = s.k0[:, None], np.linspace(lo, hi, RAYS, axis=-1)
    small = np.minimum(1e-4 * k0, 0.01 * k0 / (1 + k0 * path[:, None]))  # phases turn little over a step
    low, high = np.split(plane(np.concatenate([k - small, k + small], axis=-1).astype(complex)), 2, axis=-1)
    twice = np.where(np.abs(low + high) > DARK, low + high, 1.0)
    x = -np.imag((high - low) / (small * twice))
    spread = np.abs(np.gradient(x, axis=-1)) / (np.maximum(hi - lo, 1e-6 * s.k0)[:, None] / (RAYS - 1))
    strength = np.abs(low + high) * np.abs(beam.spectrum(k, k0))
    size = strength / np.sqrt(spread + beam.reach(0.1) ** 2)
    bright = size > BRIGHT * np.max(size, axis=-1, keepdims=True)
    bright[:, 1:] |= bright[:, :-1]
    bright[:, :-1] |= bright[:, 1:]
    least, most = np.min(x, axis=-1, where=bright, initial=np.inf), np.max(x, axis=-1, where=bright, initial=-np.inf)
    good = np.isfinite(least) & np.isfinite(most)
    return np.where(good, least, 0.0), np.where(good, most, 0.0)


#: Exponentials on an even line are products of two small tables, this many steps apart.
STEP = 12


class PlaneWaves(NamedTuple):
    """p(x) = sum right e^{ikx} + left e^{-ikx} over an even line, x from the beam's centre; arrays (F, n)."""

    contour: Contour
    right: np.ndarray
    left: np.ndarray

    def slopes(self, order: int) -> np.ndarray:
        """Amplitudes of p, dp/dx, ... up to an order: right (ik)^j, then conj(left (-ik)^j); (F, 2 (order + 1), n)."""
        rows = order + 1
        out = np.empty((self.right.shape[0], 2 * rows, self.right.shape[1]), complex)
        ik = 1j * self.contour.k
        out[:, 0], out[:, rows] = self.right, np.conj(self.left)
        back = -np.conj(ik)
        for j in range(1, rows):
            np.multiply(out[:, j - 1], ik, out=out[:, j])
            np.multiply(out[:, rows + j - 1], back, out=out[:, rows + j])
        return out

    def at(self, x: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        """p and its slopes at positions (F, m), from their amplitudes: (order + 1, F, m)."""
        # plain: sums over k of (ik)^j (right e^{ikx} + (-1)^j left e^{-ikx}). With k = m ds - i sigma, e^{ikx} is a power of
        # e^{i ds x} times e^{sigma x}; powers are products of two tables, and what goes to the left has their conjugates.
        contour, n = self.contour, self.contour.k.shape[-1]
        angle = 1j * (np.asarray(contour.step)[:, None] * x)[..., None]
        coarse = np.exp(angle * (contour.first + np.arange(0, n, STEP)))
        powers = (coarse[..., None] * np.exp(angle * np.arange(STEP))[..., None, :]).reshape(*x.shape, -1)[..., :n]
        sums = np.moveaxis(powers @ np.swapaxes(slopes, 1, 2), -1, 0)
        rows = sums.shape[0] // 2
        grow = np.exp(np.asarray(contour.sigma)[:, None] * x)
        return sums[:rows] * grow + np.conj(sums[rows:]) / grow

    def value(self, x: np.ndarray) -> np.ndarray:
        """p at positions (F, m)."""
        return self.at(x, self.slopes(0))[0]


def _both_modes(s: SampledSlab, beam: Beam, plane: Plane, plan: StraightPlan) -> tuple[PlaneWaves, PlaneWaves]:
    """The plane waves at the plane, on a line and on another to judge it by; one response for both."""
    contours = paths.straight_contour(plan), paths.straight_contour(plan.other())
    k, weight = (np.concatenate([contour[i] for contour in contours], axis=-1) for i in (0, 1))
    h = plane(k)
    right, left = paths.amplitudes(Contour(k, weight), lambda k: beam.spectrum(k, s.k0[:, None]), beam.centre)
    right, left, n = right * h, left * h, contours[0].k.shape[-1]
    return PlaneWaves(contours[0], right[:, :n], left[:, :n]), PlaneWaves(contours[1], right[:, n:], left[:, n:])


def _plan(s: SampledSlab, beam: Beam, path: Any, middle: np.ndarray, half: np.ndarray, rtol: float) -> StraightPlan:
    lo, hi = beam.band(s.k0, rtol * 1e-2)
    source = beam.reach(rtol * 1e-2)
    extent = np.abs(middle - beam.centre) + half
    branch = s.nearest_branch
    return paths.plan_straight(Extent(s.k0, branch, np.maximum(-lo, hi), extent, source, path), rtol)


class Route(NamedTuple):
    """How a beam gets to the plane that is measured, at F frequencies."""

    slab: SampledSlab
    plane: Callable[[SampledSlab, np.ndarray], Plane]  #: of a slab and the lengths along z
    transfer: Callable[[SampledSlab], TransferFunction]  #: the same for the slab of one frequency
    z: np.ndarray  #: (F,) where that transfer meets the plane
    path: np.ndarray  #: (F,) length along z
    guided: bool  #: whether there is a slab on the way


def measure(route: Route, beam: Beam, rtol: float) -> Measures:
    """Width, peak and centroid of the profiles across one plane per frequency."""
    s = route.slab
    level = HALF_LEVEL[getattr(beam, "width_of", "pressure")]
    out, good = _together(route, beam, rtol, level)
    for i in np.flatnonzero(~good):
        one = s.take(int(i))
        way = float(route.z[i]), float(route.path[i])
        found = _measured_alone(one, beam, route.transfer(one), way, rtol, level, route.guided)
        for values, value in zip(out, found, strict=True):
            values[i] = value
    return out


#: The most plane waves of all frequencies that are worked on at a time, and of one of them.
MOST_TOGETHER, MOST_OF_ONE = 2**18, 20_000
#: Poles nearer to kx = 0 than this share of delta count half on either side of a straight contour, whatever its delta.
ROUND = 0.25


def _together(route: Route, beam: Beam, rtol: float, level: float) -> tuple[Measures, np.ndarray]:
    """Measures at all frequencies by the fast path, in halves where that takes many plane waves, and which are good."""
    s, count = route.slab, np.size(route.slab.k0)
    out, good = Measures(*(np.full(count, np.nan) for _ in Measures._fields)), np.zeros(count, bool)
    if not beam.entire:
        return out, good
    plane = route.plane(s, route.path)
    middle, half = landing(s, beam, plane, route.path)
    plan = _plan(s, beam, route.path, middle, half, rtol)
    size = float(np.max(plan.band * plan.window)) / (2 * np.pi)
    if count > 1 and count * min(size, MOST_OF_ONE) > MOST_TOGETHER:
        halves = [_together(_taken(route, rows), beam, rtol, level) for rows in np.array_split(np.arange(count), 2)]
        found = Measures(*(np.concatenate(pair) for pair in zip(*(m for m, _ in halves), strict=True)))
        return found, np.concatenate([some for _, some in halves])
    if size < MOST_OF_ONE:
        first, second = _both_modes(s, beam, plane, plan)
        out, good = _measured(first, second, plan, middle - beam.centre, half, level, rtol)
        out = out._replace(centroid=out.centroid + beam.centre)
        if route.guided:
            good &= ~_backward(s, plan)
            near = plane(near_normal.around(np.asarray(plan.delta)[:, None] * ROUND))
            good &= near_normal.is_calm(near, max(0.01 * rtol, 1e-12))[:, 0]
    return out, good


def _taken(route: Route, rows: np.ndarray) -> Route:
    """Some frequencies of a route."""
    return route._replace(slab=route.slab.take(rows), z=route.z[rows], path=route.path[rows])


def _backward(s: SampledSlab, plan: StraightPlan) -> np.ndarray:
    """Where the lines leave a mode on their wrong side, (F,)."""
    bad = misplaced.any_misplaced(s, 1.1 * plan.sigma, plan.band)
    for i in np.flatnonzero(bad) if s.lossless else []:  # what was counted may be forward
        one = s.take(int(i))
        start = min(1e-3 * one.k0, 0.1 * one.nearest_branch)
        found = misplaced.misplaced(one, 1.1 * float(plan.sigma[i]), float(plan.band[i]), start)
        bad[i] = bool(found.poles) or math.isfinite(found.crossing)
    return bad


def _sampled(plane_waves: PlaneWaves, plan: StraightPlan) -> tuple[np.ndarray, np.ndarray]:
    """p on an even grid over each whole window: x and p, (F, n)."""
    contour = plane_waves.contour
    m = contour.first + np.arange(contour.k.shape[-1])
    n = fft.fast_length(3 * int(np.max(np.abs(m))) + 1)
    x = plan.window[:, None] * ((np.arange(n) - n // 2) / n)
    bins = np.zeros((2, *contour.k.shape[:-1], n), complex)
    turn = np.where(m % 2, -1.0, 1.0) if n % 2 == 0 else np.exp(-2j * np.pi * m * (n // 2) / n)
    bins[0][:, m % n] = plane_waves.right * turn
    bins[1][:, -m % n] = plane_waves.left * np.conj(turn)
    right, left = fft.transform(bins)
    grow = np.exp(contour.sigma[:, None] * x)
    return x, right * grow + left / grow


def _measured(
    plane_waves: PlaneWaves,
    second: PlaneWaves,
    plan: StraightPlan,
    middle: np.ndarray,
    half: np.ndarray,
    level: float,
    rtol: float,
) -> tuple[Measures, np.ndarray]:
    """Measures from the samples and Newton's method, and where they can be trusted."""
    x, p = _sampled(plane_waves, plan)
    valid = np.abs(x - middle[:, None]) <= half[:, None]
    size = np.where(valid, np.abs(p), 0.0)
    rows = np.arange(size.shape[0])
    top = np.argmax(size, axis=-1)
    ends = np.argmax(valid, axis=-1), valid.shape[-1] - 1 - np.argmax(valid[:, ::-1], axis=-1)
    dx = plan.window / x.shape[-1]
    slopes = plane_waves.slopes(2)
    position = _newton_peak(plane_waves, slopes, x[rows, top], dx)
    peak = np.abs(plane_waves.at(position[:, None], slopes)[0, :, 0])
    edge = np.maximum(size[rows, ends[0]], size[rows, ends[1]])
    good = (edge < EDGE * level * peak) & (peak > 0)
    crossing, found = _crossings(x, np.abs(p), valid, top, position, peak, level)
    good &= found
    edges = _newton_level(plane_waves, slopes, *crossing, level * peak)
    check = np.concatenate([edges, position[:, None]], axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = 1.5 * np.max(np.abs(plane_waves.at(check, slopes)[0] - second.value(check)), axis=-1) / peak
        power = np.where(valid, np.abs(p) ** 2, 0.0)
        place = (power * x).sum(-1) / power.sum(-1)
    error = np.nan_to_num(error, nan=1.0)
    good &= error <= rtol
    met = np.count_nonzero(np.diff(size > level * peak[:, None], axis=-1), axis=-1)
    return Measures(edges[:, 1] - edges[:, 0], peak, place, met, error), good


def _crossings(
    x: np.ndarray,
    size: np.ndarray,
    valid: np.ndarray,
    top: np.ndarray,
    position: np.ndarray,
    peak: np.ndarray,
    level: float,
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Points above and below the level on both sides of the peak, a guess between them, (F, 2); and whether they exist, (F,)."""
    target = level * peak[:, None]
    below = valid & (size < target)
    index = np.arange(size.shape[-1])
    left = np.max(np.where(below & (index < top[:, None]), index, -1), axis=-1)
    right = np.min(np.where(below & (index > top[:, None]), index, index.size), axis=-1)
    found = (left >= 0) & (right < index.size)
    ends = np.stack([np.where(found, left, 0), np.where(found, right, index.size - 1)], axis=-1)
    beside = np.clip(ends + np.array([1, -1]), 0, index.size - 1)
    outer, inner = np.take_along_axis(x, ends, -1), np.take_along_axis(x, beside, -1)
    beyond = (inner - position[:, None]) * np.array([1, -1]) > 0  # the peak lies between the two samples
    inner = np.where(beyond, position[:, None], inner)
    above = np.where(beyond, peak[:, None], np.take_along_axis(size, beside, -1)) ** 2
    fall = above - np.take_along_axis(size, ends, -1) ** 2
    share = np.clip((above - target**2) / np.where(fall > 0, fall, 1.0), 0.01, 0.99)
    return (inner, outer, inner + share * (outer - inner)), found


def _newton_peak(plane_waves: PlaneWaves, slopes: np.ndarray, start: np.ndarray, dx: np.ndarray) -> np.ndarray:
    """Where |p|^2 is largest within a sample of start."""
    x = start
    for _ in range(5):
        p, slope, bend = plane_waves.at(x[:, None], slopes)[..., 0]
        first = (p.conj() * slope).real
        curve = np.abs(slope) ** 2 + (p.conj() * bend).real
        step = np.where(curve < 0, -first / np.where(curve < 0, curve, 1.0), np.sign(first) * dx / 4)
        before, x = x, np.clip(x + step, start - dx, start + dx)
        if np.all(np.abs(x - before) <= NEAR_PEAK * dx):
            break
    return x


def _newton_level(
    plane_waves: PlaneWaves,
    slopes: np.ndarray,
    inner: np.ndarray,
    outer: np.ndarray,
    guess: np.ndarray,
    target: np.ndarray,
) -> np.ndarray:
    """Where |p| crosses the target (F,) between inner (above it) and outer (below it), (F, 2): bracketed Newton."""
    x, size = guess, np.abs(outer - inner)
    for _ in range(9):
        p, slope, _ = plane_waves.at(x, slopes)
        excess = np.abs(p) ** 2 - target[:, None] ** 2
        inner, outer = np.where(excess >= 0, x, inner), np.where(excess >= 0, outer, x)
        steep = 2 * (p.conj() * slope).real
        guess = x - excess / np.where(steep == 0, 1.0, steep)
        low, high = np.minimum(inner, outer), np.maximum(inner, outer)
        before, x = x, np.where((guess >= low) & (guess <= high), guess, (inner + outer) / 2)
        if np.all(np.abs(x - before) <= NEAR_EDGE * size):
            break
    return x


# --- one at a time ----------------------------------------------------------------------------------------


def _measured_alone(
    s: SampledSlab,
    beam: Beam,
    transfer: TransferFunction,
    way: tuple[float, float],
    rtol: float,
    level: float,
    guided: bool,
) -> tuple[float, float, float, int, float]:
    """What `Measures` holds, across the plane z, in a window that grows until its edges are below the level.

    `way` is z and the length of the path along z.
    """
    planes, path = np.array([way[0]]), np.array([way[1]])
    middle, half = (float(v[0]) for v in landing(s.stacked(), beam, lambda k: transfer(k[0], planes), path))
    choose.check_rays(s, beam, way[1], half)
    seen: list[_Rim] = []
    for _ in range(9):
        step = min(np.pi / (2 * max(abs(k) for k in beam.band(s.k0, 1e-4))), half / 64)
        x = middle + half * np.linspace(-1, 1, 2 * min(math.ceil(half / step), 50_000) + 1)
        quadrature = choose.choose_contour(s, single(beam), transfer, x, planes, rtol, guided)
        h = transfer(quadrature.contour.k, planes)
        if not quadrature.fft:
            x = needed(s, beam, quadrature, h, x)
        p = field_sums.beam_sum(s, beam, quadrature, h, x)[0]
        size = np.abs(p)
        if max(size[0], size[-1]) < EDGE * level * size.max():
            break
        seen.append(_rim(size, level))
        if guided and _runs_on(seen, s.lossless):
            break
        half *= 2
    found = full_width(x, p, level, field_sums.evaluator(s, beam, quadrature, h))
    return found.width, found.peak, centroid(x, p), crossings(p, level * found.peak), float(quadrature.error[0])


class _Rim(NamedTuple):
    """What a window shows of a wave that runs on beyond it: the peak, the largest |p| in its outer tenths, and whether the level
    is met on both sides of the peak."""

    peak: float
    outer: float
    met: bool


#: A guided wave is what still has this share of its |p| in the outer tenths of a window that is twice as wide: a beam in open space
#: falls to 0.7 of it or less. The peak is the same one if it is within this share. And in so many windows more a wave without loss
#: that lies above the level on one side is looked at before the width is said to have no end there.
UNDIMINISHED, SAME, MORE = 0.9, 0.02, 3


def _rim(size: np.ndarray, level: float) -> _Rim:
    top, tenth = int(np.argmax(size)), max(1, size.size // 10)
    below = size < level * size[top]
    outer = max(size[:tenth].max(), size[-tenth:].max())
    return _Rim(float(size[top]), float(outer), bool(np.any(below[:top]) and np.any(below[top:])))


def _runs_on(seen: list[_Rim], lossless: bool) -> bool:
    """Whether windows, each twice as wide as the one before, show the same peak and a guided wave beside it that no window holds."""
    steady = [
        abs(now.peak - before.peak) < SAME * now.peak and UNDIMINISHED * before.outer < now.outer < now.peak
        for before, now in itertools.pairwise(seen)
    ]
    if all(rim.met for rim in seen[-2:]):
        return steady[-1:] == [True]
    return lossless and len(steady) >= MORE and all(steady[-MORE:])


#: Plane waves below this share of the strongest do not show in widths, nor did they choose the positions.
FAINT = 1e-4


def needed(s: SampledSlab, beam: Beam, quadrature: choose.Quadrature, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """As many of even positions as those plane waves need that get there: of a sharp edge's most die on the way."""
    right, left = quadrature.amplitudes_of(s.k0, single(beam))
    strength = np.abs(h[0]) * (np.abs(right[0]) + np.abs(left[0]))
    largest = float(np.max(np.abs(quadrature.contour.k.real), where=strength > FAINT * strength.max(), initial=0.0))
    count = 2 * max(64, math.ceil((x[-1] - x[0]) * largest / np.pi)) + 1
    memory.check_terms(quadrature.contour.k.size, min(count, x.size))
    return x if count >= x.size else np.linspace(x[0], x[-1], count)


# --- the row of a table of widths -------------------------------------------------------------------------


class Row(NamedTuple):
    """What `beam_width` reports, (F,) each, in its order."""

    fwhm_launch: np.ndarray
    fwhm_in: np.ndarray
    fwhm_out: np.ndarray
    fwhm_air: np.ndarray
    peak_out: np.ndarray
    centroid_out: np.ndarray


def rows(s: SampledSlab, beam: Beam, rtol: float, air_distance: float | None) -> tuple[Row, np.ndarray, np.ndarray]:
    """Widths at all frequencies of a slab, at one angle; crossings of the level, and errors, in the four planes, (4, F)."""
    wavelengths = 2 * np.pi / s.k0
    # a distance without the slab is measured from the launch plane: the way to the slab is no part of it
    launched = replace(beam, z0=0.0) if is_dataclass(beam) else beam

    def free(distance: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not np.any(distance) and beam.entire:
            return _launch_widths(s, beam)
        route = Route(s.without_slab(), without, transfer_function.free, distance, distance, False)
        found = measure(route, launched, rtol)
        return found.width, found.crossings, found.error

    launch = free(np.zeros(s.k0.shape))
    near = launch if beam.z0 == 0 else free(np.full(s.k0.shape, -beam.z0))
    face = np.full(s.k0.shape, s.thickness)
    through = Route(
        s,
        lambda some, _: far_face(some, beam.z0),
        lambda one: transfer_function.through(one, beam.z0),
        face,
        face - beam.z0,
        True,
    )
    far = measure(through, beam, rtol)
    air = free(2 * wavelengths if air_distance is None else np.full(s.k0.shape, air_distance))
    widths, met, errors = zip(launch, near, (far.width, far.crossings, far.error), air, strict=True)
    return Row(*widths, far.peak, far.centroid), np.stack(met), np.stack(errors)


def _launch_widths(s: SampledSlab, beam: Beam) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Widths of the launch profile itself, crossings and errors; |p| does not depend on the frequency."""
    level = HALF_LEVEL[getattr(beam, "width_of", "pressure")]
    k0 = float(s.k0[0])
    x = beam.centre + beam.reach(1e-2) * 1.5 * np.linspace(-1, 1, 2001)
    p = beam.profile(x, k0)
    found = full_width(x, p, level, lambda at: beam.profile(at, k0))
    met = crossings(p, level * found.peak)
    return np.full(s.k0.shape, found.width), np.full(s.k0.shape, met), np.zeros(s.k0.shape)
