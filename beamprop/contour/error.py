"""The error of a field on a contour, estimated by a second contour that shares no number with the first.

Their difference at a few planes and positions is the error of the coarser one. What both would miss is added: the end of
the band, and a spectrum that ends inside a contour. The second contour's response is taken at kx and w moved in their last bits,
so that rounding which both share shows too. Errors are over the largest |p| of the plane, which may lie far from the
requested positions: a beam is looked for where it lands, too.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..memory import check_contour
from ..sources.angles import AngleInterpolation
from . import sums
from .check_points import Checks, interpolated
from .paths import EPS, Contour
from .sums import beam_amplitudes

#: How far kx and w are moved.
SHIFT = 4 * EPS
#: Planes on which the largest |p| is below this are dark.
DARK = 1e-290


class Sampled(NamedTuple):
    """A line, and its response at the planes that are compared."""

    contour: Contour
    h: np.ndarray
    amplitudes: tuple[np.ndarray, np.ndarray]  #: of the beams that are summed


def sampled(checks: Checks, contour: Contour, moved: bool) -> Sampled:
    """The response at the planes that are compared, `moved` in its last bits or not."""
    check_contour(contour.k.size, checks.sources.angles.size, checks.z.size)
    h = checks.transfer(contour.k, checks.z, SHIFT if moved else 0.0)
    return Sampled(contour, h, beam_amplitudes(checks.k0, checks.sources, contour))


#: Of more asked beams than this so many are judged, spread evenly over the angles; those between take the worse neighbour's error.
ESTIMATED = 64


def difference(checks: Checks, one: Sampled, two: Sampled) -> tuple[np.ndarray, float]:
    """Estimated error of the first line over the largest |p| of each plane, by asked beam; and what lies beyond the ends of both."""
    requested = checks.sources.requested
    if checks.sources.weights is None or requested.size <= ESTIMATED:
        return _difference(checks, one, two)
    some = checks.sources.spread(ESTIMATED)
    dark = None if checks.dark is None else checks.dark[some]
    part = checks._replace(sources=checks.sources.taken(some), peaks_outside=checks.peaks_outside[some], dark=dark)
    error, edge = _difference(part, one, two)
    return -interpolated(requested, requested[some], -error), edge


def _difference(checks: Checks, one: Sampled, two: Sampled) -> tuple[np.ndarray, float]:
    sources = checks.sources
    (right1, left1), (right2, left2) = one.amplitudes, two.amplitudes
    x = checks.x - sources.beam.centre
    # some of the angles that are mixed are summed by themselves too, in the same product: the extremes, where mixing errs most
    some = np.empty(0, int)
    right, left = right1, left1
    if sources.weights is not None:
        some = sources.spread(5)
        pairs = zip(
            one.amplitudes,
            beam_amplitudes(checks.k0, AngleInterpolation(sources.beam, sources.requested[some]), one.contour),
            strict=True,
        )
        right, left = (np.concatenate(pair) for pair in pairs)
    own = np.asarray(sums.direct_sum(one.contour, one.h, right, left, x))
    a = sources.interpolated_to(own[: sources.angles.size])
    b = sources.interpolated_to(np.asarray(sums.direct_sum(two.contour, two.h, right2, left2, x)))
    largest = np.minimum(np.max(np.abs(a), axis=2), np.max(np.abs(b), axis=2))  # (A, Z)
    largest = np.maximum(largest, checks.peaks_outside)
    seen = largest > DARK if checks.dark is None else (largest > DARK) & ~checks.dark
    scale = np.where(seen, largest, 1.0)
    source = _source_rounding(checks.k0, sources, one)
    edge = first_edge = np.zeros(largest.shape)
    with np.errstate(invalid="ignore", over="ignore"):
        error = (np.max(np.abs(a - b), axis=2) + source) / scale
        if sources.beam.entire:
            weights = None if sources.weights is None else np.abs(sources.weights)
            edge, cut = (
                _beyond(two, right2, left2),
                _cut_off(checks, one, right1, left1, float(np.max(np.abs(x)))),
            )
            first_edge = _beyond(one, right1, left1)
            edge, cut, first_edge = (v if weights is None else weights @ v for v in (edge, cut, first_edge))
            error += cut / scale
        if sources.weights is not None:
            error += 3 * np.max(np.abs(own[sources.angles.size :] - a[some]), axis=(0, 2)) / scale
    worst = np.max(np.where(seen, 1.5 * np.nan_to_num(error, nan=np.inf) + edge / scale, 0.0), axis=1)
    # both lines share the rounding of k0, of a tilt k0 sin(angle) and of lengths: a unit of the last place of the longest phase
    way = float(np.max(np.abs(x)) + np.max(checks.z) - sources.beam.z0)
    ends = np.max(np.where(seen, np.maximum(edge, first_edge) / scale, 0.0))
    return worst + EPS * (4 + checks.k0 * way), float(ends)


def _source_rounding(k0: float, sources: AngleInterpolation, one: Sampled) -> np.ndarray:
    """What rounding of a sampled source brings to each plane, on both lines alike; (Z,).

    The less of two bounds: all plane waves in phase; or, as white noise of power N over kx, (1/2 pi) integral N |h|^2 dkx
    (Parseval). Of many angles the outermost stand for all, |kx - k0 sin(angle)| is largest there.
    """
    h, weight, bounds = np.abs(one.h), 2 * np.abs(one.contour.weight), [np.zeros(one.h.shape[0])]
    for angle in {float(sources.angles.min()), float(sources.angles.max())}:
        rounding: Any = getattr(sources.at(angle), "spectral_rounding", None)
        for k in (one.contour.k, -one.contour.k) if rounding else ():
            coherent, white = rounding(k, k0)
            with np.errstate(over="ignore", invalid="ignore"):
                bounds.append(np.fmin(h @ (weight * coherent), np.sqrt(h**2 @ (weight * white**2))))
    return 4 * np.nan_to_num(np.max(bounds, axis=0), posinf=0.0)  # the largest of many positions


def _beyond(end: Sampled, right: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Size of what lies beyond the end of a path: its last two tenths, continued geometrically; (B, Z)."""
    if end.contour.closed:
        return np.zeros((right.shape[0], end.h.shape[0]))
    n, circles = end.contour.k.size, end.contour.circles
    tenth = max(1, (n - circles) // 10)
    tail = slice(max(circles, n - 2 * tenth), n)
    size = (np.abs(right[:, tail]) + np.abs(left[:, tail]))[:, None] * np.abs(end.h[:, tail])
    last, before = size[..., -tenth:].sum(axis=-1), size[..., :-tenth].sum(axis=-1)
    ratio = np.clip(last / np.maximum(before, 1e-300), 0.0, 0.95)
    return 2 * last * ratio / (1 - ratio)


def _cut_off(checks: Checks, one: Sampled, right: np.ndarray, left: np.ndarray, extent: float) -> np.ndarray:
    """Size of what is missing where a spectrum ends inside a line (samples too coarse for their profile); (B, Z).

    |w S h e^{ikx}| at the last node or above it on the real axis, where the cut is defined, times the nodes that would fit between
    them: on a long way along z waves below the axis have died when those on the axis have not.
    """
    contour, sources, k0 = one.contour, checks.sources, checks.k0
    missing = np.zeros((right.shape[0], one.h.shape[0]))
    for side, amplitude in ((1, right), (-1, left)):
        beyond = sources.spectra(side * _after(contour, contour.k.size - 1), k0)
        for i in np.flatnonzero((amplitude[:, -1] == 0) | ~beyond.any(axis=1)):
            used = np.flatnonzero(amplitude[i])
            if used.size < 2:
                continue
            j = int(used[-1])
            if sources.at(float(sources.angles[i])).spectrum(side * _after(contour, j), k0).any():
                continue
            step, depth = max(abs(contour.k[j] - contour.k[j - 1]), 1e-300), abs(contour.k[j].imag)
            below = np.abs(one.h[:, j]) * math.exp(min(depth * extent, 100))
            on_axis = np.nan_to_num(np.abs(checks.transfer(np.array([contour.k[j].real + 0j]), checks.z)[:, 0]))
            missing[i] += np.abs(amplitude[i, j]) * np.maximum(below, on_axis) * (1 + depth / step)
    return missing


def _after(contour: Contour, j: int) -> np.ndarray:
    """Two places beyond node j."""
    step = max(abs(contour.k[j] - contour.k[j - 1]), 1e-300)
    return contour.k[j] + 2 * step * np.arange(1, 3)
