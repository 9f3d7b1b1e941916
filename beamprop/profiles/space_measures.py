"""A beam in three dimensions as a whole, at a face of the slab: widths, place, shift, second moments, power, direction."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..contour.error import SHIFT, ErrorBudget, uniform_budget
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.in_space import unit_vector
from ..sources.sum_in_space import parts_of
from . import power
from .directions import Directions
from .level_area import Area, area_above, connected
from .measures import Side, any_beam, carried, unchanged
from .power import NOTHING, PowerError, Radiated
from .space_plane import Sampled, Way, Window, sampled, widened
from .space_widths import cuts_of, section
from .windows import TAIL

#: Widths of the principal axes that differ by less than this are equal, and their orientation rounding; so is the azimuth of a mean
#: direction that is nearer to the normal.
EQUAL = 1e-6
#: Gauss nodes beyond half the turns of |p|^2 over a window: Bessel functions of so much higher order are 1e-16.
BEYOND = 20


class Beamlet(NamedTuple):
    """Measures of one outgoing beam at a face; names of the dataset's variables. Arrays (2,) along x and y."""

    fwhm: np.ndarray
    width_1e2: np.ndarray
    width_second_moment: np.ndarray
    centroid: np.ndarray
    lateral_shift: np.ndarray
    area: float
    ellipticity: float
    orientation: float
    peak: float
    power: float
    divergence: np.ndarray
    far_angle: float
    far_azimuth: float
    crossings: np.ndarray
    moments_from: np.ndarray
    moments_to: np.ndarray
    rim: float


#: Those that have a value along each axis.
BY_AXIS = (
    *("fwhm", "width_1e2", "width_second_moment", "centroid", "lateral_shift", "divergence", "crossings"),
    *("moments_from", "moments_to"),
)

_NAN, _NANS = math.nan, np.full(2, math.nan)
#: The measures of a side without a beam.
NO_BEAM = Beamlet(
    *(_NANS, _NANS, _NANS, _NANS, _NANS, _NAN, _NAN, _NAN, 0.0, 0.0, _NANS, _NAN, _NAN, np.zeros(2), _NANS, _NANS, _NAN)
)


class Measured(NamedTuple):
    """A beam, the estimated errors of its |p| over the largest, of its power and of its area, and whether its peak is a ring."""

    beamlet: Beamlet
    budget: ErrorBudget
    power: PowerError
    area: Area
    ring: bool = False


def reflected_and_transmitted(s: SampledSlab, source: Any, rtol: float, window: float | None) -> list[Measured]:
    """The reflected and the transmitted beam; places are from the source's middle."""
    slope, z0 = math.tan(math.radians(source.angle)), source.z0
    directions = Directions(source, s, {})
    launched = _radiated(s, directions, Side(TransferFunction(s, unchanged), 0.0, False), rtol)
    sides = (
        SpaceSide(partial(transfer_function.reflected, s), -z0 * slope, False),
        SpaceSide(partial(transfer_function.through, s), (s.thickness - z0) * slope, True),
    )
    return [_measure(s, directions, side, launched, rtol, window) for side in sides]


class SpaceSide(NamedTuple):
    """As `Side`, for sources on launch planes of their own."""

    transfer: Callable[[float], TransferFunction]  #: of a launch plane's z0
    ray: float  #: where the geometric ray meets that face, from the source's middle towards its azimuth [m]
    behind: bool


def _measure(
    s: SampledSlab, directions: Directions, side: SpaceSide, launched: Radiated, rtol: float, window: float | None
) -> Measured:
    source = directions.source
    if not any(any_beam(s, part.source, side.transfer(part.source.z0)) for part in parts_of(source)):
        return Measured(NO_BEAM, uniform_budget(1, 0.0), PowerError(), Area(0.0, 0.0))
    way = Way(side.transfer, s.thickness)
    ray = side.ray * np.array(unit_vector(source.azimuth))
    if window is None:
        profile = widened(s, source, way, rtol, TAIL)
    else:
        profile = sampled(s, source, way, Window(ray, np.full(2, window), chosen=True), rtol)
    half = section(profile, 0.5)
    moments = _in_part(profile) if window is None else _in_window(profile)
    area = area_above(profile, half.peak, 0.5, rtol)
    radiated = _radiated(s, directions, Side(side.transfer(source.z0), side.ray, side.behind), rtol)
    ellipticity, orientation = _principal(moments.matrix)
    divergence, far_angle, far_azimuth = _direction(radiated)
    beamlet = Beamlet(
        fwhm=half.width,
        width_1e2=np.array([float(cut.width) for cut in cuts_of(profile, half.peak, math.exp(-1))]),
        width_second_moment=4 * np.sqrt(np.diag(moments.matrix)),
        centroid=moments.centroid,
        lateral_shift=moments.centroid - ray,
        area=area.value,
        ellipticity=ellipticity,
        orientation=orientation,
        peak=half.peak.size,
        power=radiated.total / launched.total if launched.total > 0 else math.nan,
        divergence=divergence,
        far_angle=far_angle,
        far_azimuth=far_azimuth,
        crossings=half.crossings,
        moments_from=moments.begin,
        moments_to=moments.end,
        rim=moments.rim,
    )
    return Measured(beamlet, half.budget, radiated.error.plus(launched.error), area, half.peak.ring)


# --- second moments ---------------------------------------------------------------------------------------


class Moments(NamedTuple):
    """Centroid (2,) and covariance (2, 2) of |p|^2, the rectangle in which they are taken, and the largest |p| where it is cut off, over the peak."""

    centroid: np.ndarray
    matrix: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    rim: float


def _in_part(profile: Sampled) -> Moments:
    """Over the samples that are connected to the peak above the tail."""
    size = np.abs(profile.p)
    row, column = np.unravel_index(np.argmax(size), size.shape)
    part = connected(size >= TAIL * size.max(), (int(row), int(column)))
    weight = np.where(part, size**2, 0.0)
    rows, columns = (np.flatnonzero(part.any(axis=axis)) for axis in (1, 0))
    begin = np.array([profile.x[columns[0]], profile.y[rows[0]]])
    end = np.array([profile.x[columns[-1]], profile.y[rows[-1]]])
    rim = profile._replace(p=np.where(part, size, 0.0)).rim
    return Moments(*_moments(weight, profile.x, profile.y), begin, end, max(rim, TAIL))


def _in_window(profile: Sampled) -> Moments:
    """Over the whole window, by Gauss's rule: its ends cut off what an even grid would sum to fourth order."""
    nodes = []
    for at, k in zip((profile.x, profile.y), profile.plane.ends, strict=True):
        g, w = np.polynomial.legendre.leggauss(BEYOND + math.ceil((at[-1] - at[0]) / 4 * np.ptp(k)))
        nodes.append(((at[0] + at[-1]) / 2 + (at[-1] - at[0]) / 2 * g, w))
    (x, of_x), (y, of_y) = nodes
    weight = np.abs(profile.plane.on_grid(x, y)) ** 2 * np.outer(of_y, of_x)
    begin, end = (np.array([profile.x[i], profile.y[i]]) for i in (0, -1))
    return Moments(*_moments(weight, x, y), begin, end, profile.rim)


def _moments(weight: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centroid and covariance of weights (Y, X)."""
    total = weight.sum()
    if not total > 0:
        return _NANS, np.full((2, 2), math.nan)
    of_x, of_y = weight.sum(axis=0) / total, weight.sum(axis=1) / total
    middle = np.array([of_x @ x, of_y @ y])
    u, v = x - middle[0], y - middle[1]
    mixed = v @ weight @ u / total
    return middle, np.array([[of_x @ u**2, mixed], [mixed, of_y @ v**2]])


def _principal(matrix: np.ndarray) -> tuple[float, float]:
    """The smaller over the larger principal width, and the direction of the larger [degree], in (-90, 90]; 0 where they are equal."""
    if not np.all(np.isfinite(matrix)):
        return math.nan, math.nan
    (least, most), axes = np.linalg.eigh(matrix)
    ratio = math.sqrt(max(least, 0.0) / most)
    x, y = axes[:, 1]
    direction = math.degrees(math.atan2(y, x))
    direction -= 180 * math.ceil((direction - 90) / 180)
    return ratio, direction if ratio < 1 - EQUAL else 0.0


# --- power ------------------------------------------------------------------------------------------------


def _radiated(s: SampledSlab, directions: Directions, side: Side, rtol: float) -> Radiated:
    """What a source radiates from a side: the integral over |k| of the mean of |S|^2 over directions.

    Its means are those of `Directions.means`.
    """
    k, source = s.largest_kx(side.behind), directions.source
    if k == 0:
        return NOTHING
    drive = directions.drive
    reach = source.reach(1e-8)

    def density(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
        launched, *by_direction = directions.means(kx, k, shift)
        kx = kx.astype(complex)
        driven = drive(kx, np.zeros(1), shift)[0]
        h, flux, weight = carried(s, source.z0, side.transfer, side.behind, kx, shift)
        flux = flux * np.abs(driven) ** 2 * kx.real
        rows = [flux * launched, np.zeros(kx.size), h * driven * weight * launched * kx.real]
        return np.stack([*rows, *(flux * mean for mean in by_direction)])

    count = 200 + 2 * k * (reach + s.thickness - source.z0)
    return power.radiated(density, lambda kx: density(kx, SHIFT), k, s.real_branches, count, rtol)


def _direction(radiated: Radiated) -> tuple[np.ndarray, float, float]:
    """Two standard deviations along x and y, and the mean direction from the normal and its azimuth [degree]; nan where nothing radiates."""
    if not radiated.means.size:
        return _NANS, math.nan, math.nan
    x, y, z, *angles = radiated.means
    mean, square = np.array(angles[:2]), np.array(angles[2:])
    aside = math.hypot(x, y)
    azimuth = math.degrees(math.atan2(y, x)) if aside > EQUAL * z else 0.0
    return 2 * np.degrees(np.sqrt(np.maximum(square - mean**2, 0.0))), math.degrees(math.atan2(aside, z)), azimuth
