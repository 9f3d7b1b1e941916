"""A beam as a whole, at a face of the slab: widths by three definitions, place, shift, power, divergence."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.integrate import simpson

from ..contour import choose
from ..contour.error import SHIFT
from ..fields import evaluate
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import single
from ..sources.base import Beam
from . import fwhm, power, sections
from .power import NOTHING, Radiated

#: The window ends where |p| has fallen to this share of its peak; second moments and centroids are taken inside.
TAIL = 0.01
#: So often the window is doubled to get there; guided waves of a lossless slab run along for ever.
DOUBLINGS = 6
#: Samples in a window of the user's choice, over those that the beam's band needs: |p|^2 is cut off at its ends.
FINER = 8


class Beamlet(NamedTuple):
    """Measures of one outgoing beam at a face; names of the dataset's variables."""

    fwhm: float
    width_1e2: float
    width_second_moment: float
    centroid: float
    lateral_shift: float
    peak: float
    power: float
    divergence: float
    far_angle: float
    crossings: int
    moments_from: float
    moments_to: float
    rim: float


def reflected_and_transmitted(
    s: SampledSlab, beam: Beam, rtol: float, window: float | None
) -> list[tuple[Beamlet, float, float]]:
    """The reflected and the transmitted beam, each with the estimated errors of its |p| over the largest, and of its power."""
    choose.check_rays(s, beam, s.thickness - beam.z0, 0.0 if window is None else window)
    slope = math.tan(math.radians(beam.angle))
    ray = beam.centre - beam.z0 * slope
    launched = _power(s, beam, _unchanged, False, rtol)
    out = []
    for transfer, place, behind in (
        (transfer_function.reflected(s, beam.z0), ray, False),
        (transfer_function.transmitted(s, beam.z0), ray + s.thickness * slope, True),
    ):
        out.append(_measure(s, beam, transfer, place, behind, launched, rtol, window))
    return out


#: kx (n,), shift -> H at a face (n,), at kx (1 + shift) and w (1 - shift): see `TransferFunction`.
Face = Callable[..., np.ndarray]


def _unchanged(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
    return np.ones(kx.shape)


def _at_face(transfer: TransferFunction) -> Face:
    """A transfer function that is the same at all depths, as a function of kx alone."""
    return lambda kx, shift=0.0: transfer(kx, np.zeros(1), shift)[0]


def _measure(
    s: SampledSlab,
    beam: Beam,
    transfer: TransferFunction,
    ray: float,
    behind: bool,
    launched: Radiated,
    rtol: float,
    window: float | None,
) -> tuple[Beamlet, float, float]:
    face = _at_face(transfer)
    if not _any_beam(s, beam, face):
        return NO_BEAM, 0.0, 0.0
    plane = np.array([s.thickness])
    for x in _windows(s, beam, ray, window):
        quadrature = choose.choose_contour(s, single(beam), transfer, x, plane, rtol)
        h = face(quadrature.contour.k)[None]
        if window is None and not quadrature.fft:
            x = sections.needed(s, beam, quadrature, h, x)
        p = evaluate.beam_sum(s, beam, quadrature, h, x)[0]
        size = np.abs(p)
        if max(size[0], size[-1]) < TAIL * size.max() or size.max() == 0:
            break
    between = evaluate.evaluator(s, beam, quadrature, h)
    full = fwhm.full_width(x, p, 0.5, between)
    e2 = fwhm.full_width(x, p, math.exp(-1), between)
    centroid, spread, part = _moments(x, size, window is not None)
    radiated = _power(s, beam, face, behind, rtol)
    crossings = int(np.count_nonzero(np.diff(size > full.peak / 2)))
    beamlet = Beamlet(
        full.width,
        e2.width,
        4 * spread,
        centroid,
        centroid - ray,
        full.peak,
        radiated.total / launched.total if launched.total > 0 else math.nan,
        2 * radiated.deviation,
        radiated.mean,
        crossings,
        float(x[part][0]),
        float(x[part][-1]),
        float(max(size[part][0], size[part][-1]) / full.peak) if full.peak > 0 else 0.0,
    )
    return beamlet, float(quadrature.error[0]), radiated.error + launched.error


#: What is said of a side without a beam.
_NAN = math.nan
NO_BEAM = Beamlet(_NAN, _NAN, _NAN, _NAN, _NAN, 0.0, 0.0, _NAN, _NAN, 0, _NAN, _NAN, _NAN)


def _any_beam(s: SampledSlab, beam: Beam, face: Face) -> bool:
    """Whether more than rounding goes that way (a slab of the ambient reflects nothing)."""
    k = np.linspace(-0.999, 0.999, 101) * s.k0 + 0j
    strength = np.abs(beam.spectrum(k, s.k0))
    return bool(
        np.max(strength * np.abs(face(k)))
        > 1e-12 * np.max(strength * np.abs(transfer_function.launched(s, k, beam.z0)))
    )


def _windows(s: SampledSlab, beam: Beam, ray: float, window: float | None) -> Iterator[np.ndarray]:
    """Positions of the window that is asked for, or of wider and wider ones."""
    if window is not None:
        yield ray + window * np.linspace(-1, 1, FINER * (_samples(s, beam, window) - 1) + 1)
        return
    half = 1.5 * beam.reach(TAIL) + 4 * np.pi / s.k0 + abs(ray - beam.centre)
    for _ in range(DOUBLINGS + 1):
        yield beam.centre + half * np.linspace(-1, 1, _samples(s, beam, half))
        half *= 2


def _samples(s: SampledSlab, beam: Beam, half: float) -> int:
    finest = max(abs(k) for k in beam.band(s.k0, 1e-3))
    return 2 * int(min(max(64, math.ceil(2 * half * finest / np.pi)), 40_000)) + 1


def _moments(x: np.ndarray, size: np.ndarray, whole: bool) -> tuple[float, float, slice]:
    """Centroid and standard deviation of |p|^2, and where they are taken.

    That is where |p| is connected to the peak above the tail, or the `whole` window if asked for or if the tail is cut off.
    """
    top = int(np.argmax(size))
    below = np.flatnonzero(size < TAIL * size[top])
    left, right = below[below < top], below[below > top]
    part = slice(None) if whole or left.size == 0 or right.size == 0 else slice(left[-1], right[0] + 1)
    x, weight = x[part], size[part] ** 2
    integral = simpson if whole else np.trapezoid  # samples of a beam that ends inside are best summed alike
    total = integral(weight, x=x)
    if not total > 0:
        return math.nan, math.nan, part
    centre = integral(weight * x, x=x) / total
    return float(centre), float(np.sqrt(integral(weight * (x - centre) ** 2, x=x) / total)), part


def _power(s: SampledSlab, beam: Beam, face: Face, behind: bool, rtol: float) -> Radiated:
    """What S h radiates into a half-space, but for a constant."""
    k = s.largest_kx(behind)
    if k == 0:
        return NOTHING

    def density(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
        kx = kx.astype(complex)
        admittance = (s.admittance_after(kx) if behind else s.admittance_before(kx))[0].real
        h = face(kx, shift)
        right, left = (np.abs(beam.spectrum(sign * kx, s.k0)) ** 2 * admittance for sign in (1, -1))
        return np.stack([np.abs(h) ** 2 * right, np.abs(h) ** 2 * left, h * (right + left)])

    count = 200 + 2 * k * (beam.reach(1e-6) + s.thickness - beam.z0)
    return power.radiated(density, lambda kx: density(kx, SHIFT), k, s.real_branches, count, rtol)
