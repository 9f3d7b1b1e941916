"""A survey of the response: its rounding, where beams land, singularities near kx = 0, how much of a band arrives."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation
from . import near_normal, paths, sums
from .check_points import Checks, interpolated, strong_waves
from .error import SHIFT
from .paths import EPS, Extent
from .stationary_phase import span
from .sums import beam_amplitudes


class Survey(NamedTuple):
    """Properties of the response by which contours are planned."""

    noise: float  #: relative rounding of the response at the first and last plane
    peaks_outside: np.ndarray  #: see `Checks`
    sharp: float  #: distance from kx = 0 of the nearest singularity, inf where none is near


def survey(
    s: SampledSlab,
    sources: AngleInterpolation,
    transfer: TransferFunction,
    x: np.ndarray,
    z: np.ndarray,
    extent: Extent,
    rtol: float,
) -> Survey:
    """Rounding of the response when kx changes in its last bits, where beams land, and the nearest singularity to kx = 0.

    On the first and the last plane: a beam that lands among the positions there does so between too.
    """
    noise, sharp, rays, ends = rounding_and_rays(s, sources, transfer, z, extent, rtol)
    requested, chosen = sources.requested, rays.chosen
    middle, half = rays.landing(sources, ends)
    peaks_outside = np.zeros((requested.size, z.size))
    if np.any(middle < x.min() - half / 2) or np.any(middle > x.max() + half / 2):
        if z.size > 1:
            middle, half = rays.landing(sources, transfer(rays.beside, z))
        places = middle[..., None] + half[..., None] * np.array([-0.4, 0.0, 0.4])
        peaks_outside = interpolated(
            requested, requested[chosen], _brightness(s, sources, transfer, z, requested[chosen], places.ravel())
        )
    return Survey(noise, peaks_outside, sharp)


class Rays(NamedTuple):
    """The strong plane waves of three requested beams, by which they are followed to where they land."""

    chosen: np.ndarray  #: indices of the beams
    beside: np.ndarray  #: kx a step below all of their plane waves, and a step above
    step: float

    def landing(self, sources: AngleInterpolation, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Middle and half-width of the places where the beams land on each plane, (Z, beams), from h at `beside`."""
        low, high = (v.reshape(h.shape[0], self.chosen.size, -1) for v in np.split(h, 2, axis=1))
        least, most = span(low, high, self.step)
        return sources.beam.centre + (least + most) / 2, sources.beam.reach(0.1) + (most - least) / 2


def rounding_and_rays(
    s: SampledSlab, sources: AngleInterpolation, transfer: TransferFunction, z: np.ndarray, extent: Extent, rtol: float
) -> tuple[float, float, Rays, np.ndarray]:
    """Relative rounding, the nearest singularity to kx = 0, and the beams' rays with H beside them on the first and last plane."""
    # 24 places below the axis, out to evanescent waves of 3 k0: rounding is much the same everywhere
    k = np.linspace(0.03, min(extent.band, 3 * s.k0), 24) * (1 - 0.05j)
    chosen = sources.spread(3)
    strong = np.concatenate([strong_waves(sources.at(float(a)), s.k0) for a in sources.requested[chosen]])
    step = 1e-6 * s.k0
    rays = Rays(chosen, np.abs(np.concatenate([strong - step, strong + step])), step)  # the response is even in kx
    ends = z[[0, -1]] if z.size > 1 else z
    # a fifth of kb, or where the phase kx^2 Z/2k0 is 1: Gauss panels over propagating waves resolve no more at first
    wide = min(0.2 * extent.branch, math.sqrt(2 * s.k0 / max(extent.path, 1e-9)))
    first_node = math.pi / paths.plan_bent(extent, rtol).window if sources.beam.entire else wide
    near = near_normal.around(np.array([first_node]))
    with np.errstate(over="ignore", invalid="ignore"):  # is_calm takes what is not finite for singular
        h = transfer(np.concatenate([k, k * (1 + SHIFT), near, rays.beside]), ends)
    noise = _change(h[:, : k.size], h[:, k.size : 2 * k.size])
    allowed = max(0.01 * rtol, 30 * max(noise, EPS))  # well below rtol, but clear of rounding
    sharp = math.inf
    if not np.all(near_normal.is_calm(h[:, 2 * k.size : 2 * k.size + near.size], allowed)):
        sharp = near_normal.nearest_singularity(transfer, ends, first_node, s.k0, allowed)
    return noise, sharp, rays, h[:, 2 * k.size + near.size :]


def wide_enough(transfer: TransferFunction, z: np.ndarray, low: float, band: float) -> bool:
    """Whether a beam's own plane waves, low < kx < band, arrive on the first and the last plane with |H| > 0.01 for any."""
    k = np.linspace(low, band, 24) + 0j
    h = np.abs(transfer(k, z[[0, -1]] if z.size > 1 else z))
    return bool(np.all(np.max(np.nan_to_num(h), axis=1) > 0.01))


def _change(a: np.ndarray, b: np.ndarray) -> float:
    """Largest relative change from a to b, over the largest of each row."""
    size = np.max(np.abs(a), axis=1, keepdims=True)
    change = np.abs(a - b) / np.where(size > 0, size, 1.0)
    return float(np.max(change, initial=0.0, where=np.isfinite(change)))


#: The most nodes over the propagating waves that search for peaks outside, and the most terms of their sum, a few tenths of a second:
#: beyond, no such peak is known, and estimates are larger.
MOST_RAYS, MOST_LOOKED_AT = 300_000, 1e7


def _brightness(
    s: SampledSlab,
    sources: AngleInterpolation,
    transfer: TransferFunction,
    z: np.ndarray,
    angles: np.ndarray,
    x: np.ndarray,
) -> np.ndarray:
    """The largest |p| of propagating waves at positions x, roughly, the lesser of two sums over them: (angles, Z)."""
    x = x - sources.beam.centre
    path = float(z.max()) - sources.beam.z0 + s.thickness
    count = 60 + 0.6 * s.k0 * (float(np.max(np.abs(x))) + path)
    largest = np.full((2, angles.size, z.size), np.inf)
    if count > MOST_RAYS or count * x.size > MOST_LOOKED_AT:
        return np.zeros(largest.shape[1:])
    beams = AngleInterpolation(sources.beam, angles)
    for i, more in enumerate((1.0, 1.4)):
        contour = paths.propagating_contour(s.k0, s.real_branches, int(more * count))
        right, left = beam_amplitudes(s.k0, beams, contour)
        with np.errstate(invalid="ignore", over="ignore"):
            p = sums.direct_sum(contour, transfer(contour.k, z), right, left, x)
            largest[i] = np.max(np.abs(p), axis=2)
    return np.nan_to_num(largest.min(axis=0), nan=0.0, posinf=0.0)


def _strengths(s: SampledSlab, checks: Checks, k: np.ndarray) -> np.ndarray:
    """|S H| of plane waves to both sides on each plane, of the strongest beam; 0 where it is not finite; (Z, n)."""
    launched = np.max(np.abs(checks.sources.spectra(k, s.k0)) + np.abs(checks.sources.spectra(-k, s.k0)), axis=0)
    return np.nan_to_num(np.abs(checks.transfer(k.astype(complex), checks.z)) * launched, nan=0.0, posinf=0.0)


def arriving_band(s: SampledSlab, checks: Checks, extent: Extent, tolerance: float) -> float:
    """|kx| up to which more than `tolerance` of the strongest plane wave arrives on any plane."""
    k = np.geomspace(0.01 * extent.k0, extent.band, 400)
    size = _strengths(s, checks, k) * k  # |S H| dkx for equal steps of log kx
    size = np.maximum.accumulate(size[:, ::-1], axis=1)[:, ::-1]  # edges have spectra with zeros
    strong = np.any(size > tolerance * size.max(axis=1, keepdims=True), axis=0)
    last = int(np.flatnonzero(strong)[-1]) if np.any(strong) else 0
    return float(k[min(last + 1, k.size - 1)])


def cut_spectra(s: SampledSlab, checks: Checks, extent: Extent, tolerance: float) -> np.ndarray:
    """Every |kx| in the band at which a spectrum is cut off while more than `tolerance` of the strongest plane wave arrives there."""
    ends = checks.sources.spectrum_ends(s.k0)
    ends = ends[(ends > 0) & (ends <= extent.band * (1 + 1e-9))]
    if not ends.size:
        return ends
    # spectra of edges have zeros: an end counts by the largest of nine places in the last twentieth before it
    before = ends[:, None] * np.linspace(0.95, 1 - 1e-12, 9)
    k = np.concatenate([np.linspace(0.01, 1, 100) * ends[-1], before.ravel()])
    size = _strengths(s, checks, k)
    at = size[:, 100:].reshape(size.shape[0], *before.shape).max(axis=2)
    return ends[np.any(at > tolerance * size.max(axis=1, keepdims=True), axis=0)]
