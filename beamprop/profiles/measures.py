"""A beam as a whole, at a face of the slab: widths by three definitions, place, shift, power, divergence."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..contour import choose
from ..contour.error import SHIFT, ErrorBudget, uniform_budget
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.base import Beam
from . import power
from .fwhm import full_width
from .power import NOTHING, PowerError, Radiated
from .windows import TAIL, Windows, ends_over_peak, widened

#: So often the window is doubled to get there, to 64 times the first; guided waves of a lossless slab run along for ever.
DOUBLINGS = 6
#: Samples in a window of the user's choice, over those that the beam's band needs: |p|^2 is cut off at its ends, where the error of
#: Simpson's rule falls with the fourth power of the spacing, to 2e-4 of what the needed samples leave.
FINER = 8


#: Names of the sides, in the order of `reflected_and_transmitted`.
SIDES = ("reflected", "transmitted")


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


#: A beam, and the estimated errors of its |p| over the largest and of its power.
Measured = tuple[Beamlet, ErrorBudget, PowerError]


def reflected_and_transmitted(s: SampledSlab, beam: Beam, rtol: float, window: float | None) -> list[Measured]:
    """The reflected and the transmitted beam."""
    choose.check_rays(s, beam, s.thickness - beam.z0, 0.0 if window is None else window)
    slope = math.tan(math.radians(beam.angle))
    ray = beam.centre - beam.z0 * slope
    launched = _power(s, beam, TransferFunction(s, unchanged), False, rtol)
    sides = (
        Side(transfer_function.reflected(s, beam.z0), ray, False),
        Side(transfer_function.through(s, beam.z0), ray + s.thickness * slope, True),
    )
    return [_measure(s, beam, side, launched, rtol, window) for side in sides]


class Side(NamedTuple):
    """The beam that leaves a face of the slab."""

    transfer: TransferFunction  #: whose value on the far face's z is the beam at its own face
    ray: float  #: where the geometric ray meets that face [m]
    behind: bool


def unchanged(s: SampledSlab, kx: np.ndarray, z: np.ndarray) -> np.ndarray:
    """H = 1: the launched beam."""
    return np.ones((z.size, kx.size))


def _measure(s: SampledSlab, beam: Beam, side: Side, launched: Radiated, rtol: float, window: float | None) -> Measured:
    if not any_beam(s, beam, side.transfer):
        return NO_BEAM, uniform_budget(1, 0.0), PowerError()
    whole = window is not None
    profile = widened(
        s,
        beam,
        side.transfer,
        s.thickness,
        Windows(_windows(s, beam, side.ray, window), lambda p: not ends_over_peak(p) >= TAIL, thin=not whole),
        rtol,
    )
    x, p, exact = profile.x, profile.p, profile.evaluator(s, beam)
    half = full_width(x, p, 0.5, exact)
    size, peak = np.abs(p), float(half.peak)
    centroid, spread, part = _moments(x, size, whole)
    radiated = _power(s, beam, side.transfer, side.behind, rtol)
    beamlet = Beamlet(
        fwhm=float(half.width),
        width_1e2=float(full_width(x, p, math.exp(-1), exact).width),
        width_second_moment=4 * spread,
        centroid=centroid,
        lateral_shift=centroid - side.ray,
        peak=peak,
        power=radiated.total / launched.total if launched.total > 0 else math.nan,
        divergence=2 * radiated.deviation,
        far_angle=radiated.mean,
        crossings=int(half.crossings),
        moments_from=float(x[part][0]),
        moments_to=float(x[part][-1]),
        rim=float(max(size[part][0], size[part][-1])) / peak if peak > 0 else 0.0,
    )
    return beamlet, profile.quadrature.budget, radiated.error.plus(launched.error)


#: The measures of a side without a beam.
_NAN = math.nan
NO_BEAM = Beamlet(_NAN, _NAN, _NAN, _NAN, _NAN, 0.0, 0.0, _NAN, _NAN, 0, _NAN, _NAN, _NAN)


def any_beam(s: SampledSlab, beam: Beam, transfer: TransferFunction) -> bool:
    """Whether more than rounding goes that way (a slab of the ambient reflects nothing)."""
    k = np.linspace(-0.999, 0.999, 101) * s.k0 + 0j
    strength = np.abs(beam.spectrum(k, s.k0))
    arriving = strength * np.abs(transfer(k, np.array([s.thickness]))[0])
    return bool(np.max(arriving) > 1e-12 * np.max(strength * np.abs(transfer_function.launched(s, k, beam.z0)[0])))


def _windows(s: SampledSlab, beam: Beam, ray: float, window: float | None) -> Iterator[np.ndarray]:
    """Positions of the requested window, or of windows each twice as wide as the one before."""
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

    That is where |p| is connected to the peak above the tail, or the `whole` window if requested or if the tail is cut off.
    """
    from scipy.integrate import simpson  # after the question: it takes long to import

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


def carried(
    s: SampledSlab, z0: float, transfer: TransferFunction, behind: bool, kx: np.ndarray, shift: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """H at a face, what plane waves of unit spectrum on z0 carry away from it, and kz but for a factor, at real kx: (n,) each."""
    if behind:
        h, flux = transfer_function.transmitted_power(s, kx, z0, shift)
        return h, flux, np.sqrt(np.maximum(s.largest_kx(behind) ** 2 - kx.real**2, 0.0))
    h, weight = transfer(kx, np.array([s.thickness]), shift)[0], s.admittance_before(kx)[0].real
    return h, np.abs(h) ** 2 * weight, weight


def _power(s: SampledSlab, beam: Beam, transfer: TransferFunction, behind: bool, rtol: float) -> Radiated:
    """What S h radiates into a half-space, but for a constant."""
    k = s.largest_kx(behind)
    if k == 0:
        return NOTHING

    def density(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
        kx = kx.astype(complex)
        h, flux, weight = carried(s, beam.z0, transfer, behind, kx, shift)
        right, left = (np.abs(beam.spectrum(sign * kx, s.k0)) ** 2 for sign in (1, -1))
        return np.stack([flux * right, flux * left, h * weight * (right + left)])

    count = 200 + 2 * k * (beam.reach(1e-6) + s.thickness - beam.z0)
    return power.radiated(density, lambda kx: density(kx, SHIFT), k, s.real_branches, count, rtol)
