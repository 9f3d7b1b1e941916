"""The error of a field on a contour, estimated by a second contour of other parameters.

Their difference at the points of `check_points` is the error of the coarser contour. Errors that both contours share are added: the
end of the band, and a spectrum that ends inside a contour. The second contour's response is evaluated at kx, w and z moved in their
last bits, so that its rounding shows in the difference too. Errors are over the largest |p| of the plane, which may lie far from
the requested positions: it is looked for where the beam lands, too.

`experiments/accuracy.py` measures estimates over true errors; with `--terms` it switches off each term in turn.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from ..memory import check_contour
from ..sources.angles import AngleInterpolation
from .check_points import Checks, with_dark_planes, worse_neighbours
from .paths import EPS, Contour

#: Relative change of kx and w at which a response rounds anew: a few units of the last place. The response itself changes by SHIFT
#: times its phase, which counts as error too.
SHIFT = 4 * EPS
#: Planes on which the largest |p| is below this are dark: 1e-16 of what adds up to it is hardly above the smallest normal number, 2e-308,
#: below which digits are lost.
DARK = 1e-290
#: Estimate over the largest difference at the points that are compared: between these the difference may be larger. A plain choice:
#: more makes needless warnings, less estimates below the error, both of which `experiments/accuracy.py` counts.
MARGIN = 1.5


class ErrorBudget(NamedTuple):
    """The estimated error of a field by its terms, each over the largest |p| of the plane on which their sum is largest.

    Arrays (A,), by requested beam.
    """

    difference: np.ndarray  #: of the fields on two contours
    samples_rounding: np.ndarray  #: of a sampled profile, shared by both contours
    cut_spectrum: np.ndarray  #: plane waves beyond the end of a spectrum inside the contour
    angle_interpolation: np.ndarray  #: of interpolated beams, seen on five that are also summed
    band_end: np.ndarray  #: plane waves beyond the end of the contour
    long_phases: np.ndarray  #: rounding of k0 and of lengths, shared by both contours
    low_rank: np.ndarray  #: of planes that are combinations of other planes
    cancelling: np.ndarray  #: of sources of a sum that cancel each other

    @property
    def total(self) -> np.ndarray:
        """The sum of all terms, (A,)."""
        return functools.reduce(np.add, self)

    @property
    def worst(self) -> ErrorBudget:
        """The budget of the beam with the largest total, (1,); an unknown total, nan, is no largest one."""
        return self.taken([int(np.argmax(np.where(np.isnan(self.total), -np.inf, self.total)))])

    @property
    def largest(self) -> str:
        """The largest term of the beam with the largest total, in words."""
        return TERMS[self._fields[int(np.argmax([term[0] for term in self.worst]))]]

    def taken(self, beams: Any) -> ErrorBudget:
        """The budget of the beams of an index."""
        return ErrorBudget(*(term[beams] for term in self))

    def worse(self, second: ErrorBudget) -> ErrorBudget:
        """The budget of the beam with the largest total in both, (1,)."""
        return ErrorBudget(*(np.concatenate(pair) for pair in zip(self, second, strict=True))).worst


#: The terms in the words of a warning.
TERMS = {
    "difference": "the difference between two contours",
    "samples_rounding": "the rounding of a profile's samples",
    "cut_spectrum": "a spectrum that is cut off",
    "angle_interpolation": "the interpolation of angles",
    "band_end": "the end of the band of plane waves",
    "long_phases": "the rounding of long phases",
    "low_rank": "planes that are combinations of other planes",
    "cancelling": "sources of the sum that cancel each other",
}


def uniform_budget(beams: int, value: float) -> ErrorBudget:
    """A budget with the same value of every term."""
    return ErrorBudget(*np.full((len(ErrorBudget._fields), beams), value))


class Sampled(NamedTuple):
    """A contour, and its response on the planes where contours are compared."""

    contour: Contour
    h: np.ndarray
    amplitudes: tuple[np.ndarray, np.ndarray]  #: of the beams that are summed
    fields: np.ndarray | None = None  #: their p at the positions of the checks, (B, Z, X), where it is computed already


def fields_of(checks: Checks, sampled: Sampled) -> np.ndarray:
    """p of the beams that are summed at the positions of the checks: (B, Z, X)."""
    return checks.places.fields(checks.k0, checks.sources, sampled.contour, sampled.h, sampled.amplitudes)


def sampled(checks: Checks, contour: Contour, moved: bool) -> Sampled:
    """A contour with its response on the planes of the checks, at kx and w `moved` in their last bits or not."""
    check_contour(contour.k.size, checks.sources.angles.size, checks.z.size)
    h = checks.transfer(contour.k, checks.z, SHIFT if moved else 0.0)
    return Sampled(contour, h, checks.places.amplitudes(checks.k0, checks.sources, contour))


class Estimate(NamedTuple):
    """The estimated error of the first of two contours."""

    budget: ErrorBudget
    edge: float  #: the largest band end of both contours, over the largest |p| of its plane

    @property
    def worst(self) -> float:
        """The largest total of all beams."""
        return float(self.budget.total.max())


class Compared(NamedTuple):
    """Two contours, the estimated error of the first, and the checks that it was made with."""

    first: Sampled
    second: Sampled
    estimate: Estimate
    checks: Checks


def compare(checks: Checks, contours: tuple[Contour, Contour], rtol: float) -> Compared:
    """Estimate the error of the first of two contours; planes dark to rounding are searched for only where it is above `rtol`."""
    first, second = sampled(checks, contours[0], False), sampled(checks, contours[1], True)
    error = estimate(checks, first, second)
    if error.worst > rtol and checks.dark is None:
        checks = with_dark_planes(checks)
        error = estimate(checks, first, second)
    return Compared(first, second, error, checks)


#: The share of rtol that a plan allows for the end of the band, and for images; the rest is for the terms that no plan changes.
SHARE = 0.3
#: Of more requested beams than this so many are compared, spread evenly over the angles; those between take their worse neighbour's error.
#: Twice the thirty nodes of a usual interpolation over angles: they resolve how the error changes with the angle.
ESTIMATED = 64


def estimate(checks: Checks, first: Sampled, second: Sampled) -> Estimate:
    """Estimated error of the first contour, on the worst plane of each requested beam, over the largest |p| of the plane."""
    requested = checks.sources.requested
    if checks.sources.weights is None or requested.size <= ESTIMATED:
        return _on_worst_planes(terms_by_plane(checks, first, second))
    chosen = checks.sources.spread(ESTIMATED)
    dark = None if checks.dark is None else checks.dark[chosen]
    part = checks._replace(sources=checks.sources.taken(chosen), peaks_outside=checks.peaks_outside[chosen], dark=dark)
    error = _on_worst_planes(terms_by_plane(part, first, second))
    return error._replace(budget=error.budget.taken(worse_neighbours(requested, requested[chosen], error.budget.total)))


def _on_worst_planes(by_plane: Estimate) -> Estimate:
    """Terms (A, Z) on the plane where their sum is largest, (A,)."""
    worst = np.argmax(by_plane.budget.total, axis=1)
    return by_plane._replace(budget=by_plane.budget.taken((np.arange(worst.size), worst)))


@np.errstate(over="ignore", invalid="ignore")  # a term that is not finite counts as infinite
def terms_by_plane(checks: Checks, first: Sampled, second: Sampled) -> Estimate:
    """The terms of the error of the first contour by requested beam and plane, (A, Z)."""
    sources, across = checks.sources, checks.places.across
    # interpolated beams that are also summed: the extreme angles, where interpolation errs most, and three between
    extremes = np.empty(0, int) if sources.weights is None else sources.spread(5)
    summed, themselves = _summed(checks, first, extremes)
    a = sources.interpolated_to(summed)
    b = sources.interpolated_to(fields_of(checks, second) if second.fields is None else second.fields)
    largest = _largest(checks, a, b)
    seen = ~(largest <= DARK)  # a field that is not finite is not dark
    if checks.dark is not None:
        seen &= ~checks.dark
    scale = np.where(seen, largest, 1.0)
    zero = np.zeros(largest.shape)
    apart = np.max(np.abs(a - b), axis=2)
    cut = interpolation = end = first_end = zero
    if sources.beam.entire:
        cut = _of_requested(sources, _cut_off(checks, first, across))
        end, first_end = (_of_requested(sources, _beyond(contour)) for contour in (second, first))
    if extremes.size:  # thrice, for five angles may miss the largest error
        interpolation = 3 * np.max(np.abs(themselves - a[extremes]), axis=(0, 2))
    source = np.fmax(_source_rounding(checks.k0, sources, first), _rounding_beyond(checks, first.contour))
    apart, source, cut, interpolation = (
        MARGIN * _on_seen(v / scale, seen) for v in (apart, source, cut, interpolation)
    )
    end, first_end = (_on_seen(v / scale, seen) for v in (end, first_end))
    # both contours share the rounding of k0, of a tilt k0 sin(angle) and of lengths: a unit of the last place of the longest phase,
    # and four of the numbers themselves
    way = across + float(np.max(checks.z)) - sources.beam.z0
    phases = np.full(largest.shape, EPS * (4 + checks.k0 * way))
    budget = ErrorBudget(apart, source, cut, interpolation, end, phases, low_rank=zero, cancelling=zero)
    return Estimate(budget, float(np.max(np.maximum(end, first_end))))


def _on_seen(term: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """A term, 0 on dark planes, and infinite where it is not finite."""
    return np.where(seen, np.nan_to_num(term, nan=np.inf, posinf=np.inf), 0.0)


def _largest(checks: Checks, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The largest |p| of each plane (A, Z): the lesser of two fields' (A, Z, X), or the peak where the beam lands."""
    return np.maximum(np.minimum(np.max(np.abs(a), axis=2), np.max(np.abs(b), axis=2)), checks.peaks_outside)


def _summed(checks: Checks, sampled: Sampled, extremes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fields (B, Z, X) of the beams that are summed, and of the beams at `extremes`, in one product."""
    sources, amplitudes, places, contour = checks.sources, sampled.amplitudes, checks.places, sampled.contour
    beams = AngleInterpolation(sources.beam, np.concatenate([sources.angles, sources.requested[extremes]]))
    if extremes.size:
        more = AngleInterpolation(sources.beam, sources.requested[extremes])
        pairs = zip(amplitudes, places.amplitudes(checks.k0, more, contour), strict=True)
        right, left = (np.concatenate(pair) for pair in pairs)
        amplitudes = right, left
    p = places.fields(checks.k0, beams, contour, sampled.h, amplitudes)
    return p[: sources.angles.size], p[sources.angles.size :]


def _of_requested(sources: AngleInterpolation, bound: np.ndarray) -> np.ndarray:
    """A bound for each requested beam (A, Z), from those of the beams that are summed (B, Z)."""
    return bound if sources.weights is None else np.abs(sources.weights) @ bound


def _source_rounding(k0: float, sources: AngleInterpolation, first: Sampled) -> np.ndarray:
    """Error on each plane, (Z,), by the rounding of a sampled source, the same on both contours.

    The lesser of two bounds: all plane waves in phase; or, as white noise of power N over kx, (1/2 pi) integral N |h|^2 dkx
    (Parseval). The outermost angles bound all: |kx - k0 sin(angle)| is largest there.
    """
    h, weight, bounds = np.abs(first.h), 2 * np.abs(first.contour.weight), [np.zeros(first.h.shape[0])]
    for angle in {float(sources.angles.min()), float(sources.angles.max())}:
        rounding: Any = getattr(sources.at(angle), "spectral_rounding", None)
        for k in (first.contour.k, -first.contour.k) if rounding else ():
            coherent, white = rounding(k, k0)
            with np.errstate(over="ignore", invalid="ignore"):
                bounds.append(np.fmin(h @ (weight * coherent), np.sqrt(h**2 @ (weight * white**2))))
    return 4 * np.nan_to_num(np.max(bounds, axis=0), posinf=0.0)  # of 1e4 normal deviates the largest is 4


#: Wavenumbers at which noise beyond the end of a contour is counted, a plain choice: a pass band there is about k0 wide.
BEYOND = 64


def _rounding_beyond(checks: Checks, contour: Contour) -> np.ndarray:
    """The same on each plane, (Z,), by plane waves between the contour's end and those of the spectra: rounding of the samples' values.

    A slab that lets through next to nothing of a beam may have a pass band there.
    """
    sources, k0, end = checks.sources, checks.k0, contour.k[int(np.argmax(contour.k.real))]
    step = (float(np.max(sources.spectrum_ends(k0), initial=0.0)) - end.real) / BEYOND
    noises: Any = [getattr(sources.at(float(a)), "rounding_of_values", None) for a in (sources.angles[[0, -1]])]
    if contour.closed or step <= 0 or None in noises:
        return np.zeros(checks.z.size)
    k = end + step * (np.arange(BEYOND) + 0.5)
    noise = np.max([of(side * k, k0) for of in noises for side in (1, -1)], axis=0)
    with np.errstate(over="ignore", invalid="ignore"):
        size = np.sqrt(np.abs(checks.transfer(k, checks.z)) ** 2 @ (step / np.pi * noise**2))
    return 4 * np.nan_to_num(size, posinf=0.0)


def _beyond(end: Sampled) -> np.ndarray:
    """Size of the plane waves beyond the end of a contour, (B, Z): its last two tenths, continued geometrically.

    The ratio of a tenth to the one before is taken to be at most 0.95, with 19 times the last tenth beyond; the factor 2 is a margin.
    """
    right, left = end.amplitudes
    if end.contour.closed:
        return np.zeros((right.shape[0], end.h.shape[0]))
    n, circles = end.contour.k.size - end.contour.falling, end.contour.circles
    tenth = max(1, (n - circles) // 10)
    tail = slice(max(circles, n - 2 * tenth), n)
    size = (np.abs(right[:, tail]) + np.abs(left[:, tail]))[:, None] * np.abs(end.h[:, tail])
    last, before = size[..., -tenth:].sum(axis=-1), size[..., :-tenth].sum(axis=-1)
    ratio = np.clip(last / np.maximum(before, 1e-300), 0.0, 0.95)
    return 2 * last * ratio / (1 - ratio)


def _cut_off(checks: Checks, first: Sampled, extent: float) -> np.ndarray:
    """Size of the plane waves beyond the end of a spectrum inside a contour (samples too coarse for their profile); (B, Z).

    |w S h e^{ikx}| at the last node or above it on the real axis, where the cut is defined, times the nodes that would fit between
    them: over a long way along z waves below the axis decay, and those on the axis do not.
    """
    contour, sources, k0 = first.contour, checks.sources, checks.k0
    missing = np.zeros((first.amplitudes[0].shape[0], first.h.shape[0]))
    for side, amplitude in zip((1, -1), first.amplitudes, strict=True):
        beyond = sources.spectra(side * _after(contour, contour.k.size - 1), k0)
        for i in np.flatnonzero((amplitude[:, -1] == 0) | ~beyond.any(axis=1)):
            used = np.flatnonzero(amplitude[i])
            if used.size < 2:
                continue
            j = int(used[-1])
            if sources.at(float(sources.angles[i])).spectrum(side * _after(contour, j), k0).any():
                continue
            step, depth = max(abs(contour.k[j] - contour.k[j - 1]), 1e-300), abs(contour.k[j].imag)
            below = np.abs(first.h[:, j]) * math.exp(min(depth * extent, 100))
            on_axis = np.nan_to_num(np.abs(checks.transfer(np.array([contour.k[j].real + 0j]), checks.z)[:, 0]))
            missing[i] += np.abs(amplitude[i, j]) * np.maximum(below, on_axis) * (1 + depth / step)
    return missing


def _after(contour: Contour, j: int) -> np.ndarray:
    """Two points two and four steps beyond node j."""
    step = max(abs(contour.k[j] - contour.k[j - 1]), 1e-300)
    return contour.k[j] + 2 * step * np.arange(1, 3)
