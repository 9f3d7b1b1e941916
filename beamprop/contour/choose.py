"""The choice of a contour for a field and an rtol, at one frequency."""

from __future__ import annotations

import math

import numpy as np

from ..arrays.fft import fast_length
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation
from . import check_points, paths
from .bent import quadrature_on_bent_contour
from .check_points import Checks
from .error import ESTIMATED, uniform_budget
from .in_stretches import quadrature_in_stretches
from .line import Line
from .paths import Extent
from .propagating import check_rays as check_rays
from .propagating import propagating_quadrature
from .quadrature import Quadrature as Quadrature
from .search import BELOW_RTOL, MOST_PLANE_WAVES, begin, too_many_plane_waves
from .straight import quadrature_on_straight_contours, spacing_for_fft
from .survey import Survey, survey
from .unseen_bands import with_unseen_bands


def choose_contour(
    s: SampledSlab,
    sources: AngleInterpolation,
    transfer: TransferFunction,
    x: np.ndarray,
    z: np.ndarray,
    rtol: float,
    guided: bool = True,
) -> Quadrature:
    """The cheapest contour on which the field keeps rtol, its error estimated by a second contour.

    An even grid of many points gets a straight contour for FFTs, compared with a bent one; any other grid a bent contour,
    compared with a second one. `guided` says whether the transfer function has guided modes (none without a slab).
    """
    extent = _extent(s, sources, x, z, rtol)
    many = sources.weights is not None and sources.requested.size > ESTIMATED
    points = check_points.check_positions(x, sources.beam.centre, extent.source, many)
    planes = check_points.check_planes(z, s.thickness, 2 * math.pi / s.k0)
    if z.size > planes.size:
        planes = np.union1d(planes, check_points.darkest_planes(sources, s.k0, transfer, z))
    seen = survey(s, sources, transfer, points, planes, extent, rtol)
    line = Line(points - sources.beam.centre)
    checks = Checks(sources, s.k0, transfer, line, planes, guided, seen.peaks_outside, None)
    chosen = with_unseen_bands(s, checks, _chosen(s, checks, extent, seen, x, rtol))
    return chosen._replace(checked_planes=planes)


def _chosen(s: SampledSlab, checks: Checks, extent: Extent, seen: Survey, x: np.ndarray, rtol: float) -> Quadrature:
    if not checks.sources.beam.entire:
        return propagating_quadrature(s, checks, extent, rtol, seen.sharp)
    search, planned = begin(s, checks, extent, rtol, seen)
    if s.backward_branch is not None and checks.guided:
        return quadrature_in_stretches(search, crowded=False)
    tried = None  # the plan whose second contour straight ones were compared with
    if not (too_many_plane_waves(planned.plan) or search.ends.size):
        tried = planned.plan
        straight, planned = quadrature_on_straight_contours(search, planned, x)
        if straight is not None:
            return straight
    bent, planned = quadrature_on_bent_contour(search, planned)
    if search.ends.size or planned.plan == tried:
        return bent
    return quadrature_on_straight_contours(search, planned, x)[0] or bent


def _extent(s: SampledSlab, sources: AngleInterpolation, x: np.ndarray, z: np.ndarray, rtol: float) -> Extent:
    tolerance = BELOW_RTOL * rtol
    beam = sources.beam
    farthest = float(np.max(np.abs(x - beam.centre), initial=0.0))
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    band = min(sources.band(s.k0, tolerance), arriving(s, beam.z0, z, tolerance))
    return Extent(s.k0, s.nearest_branch, band, farthest, beam.reach(tolerance), path)


def arriving(s: SampledSlab, z0: float, z: np.ndarray, tolerance: float) -> float:
    """|kx| beyond which waves have decayed to `tolerance` on their way through half-spaces to the nearest plane.

    Their transmission by a slab shows in the band's end.
    """
    nearest = float(z.min())
    way = min(nearest, 0.0) - z0 + max(0.0, nearest - s.thickness)
    return math.hypot(s.last_branch, math.log(1 / tolerance) / way) if way > 0 else math.inf


def periodic_quadrature(s: SampledSlab, sources: AngleInterpolation, x: np.ndarray, period: float) -> Quadrature:
    """The plain sum over the real orders of a stated period."""
    band = min(sources.band(s.k0, 1e-15), 2 * np.pi * MOST_PLANE_WAVES / period)
    contour = paths.periodic_contour(period, band)
    dx = spacing_for_fft(x, band, paths.EPS)
    n = round(period / dx) if dx else 0
    fits = n and abs(n * dx - period) < 4 * paths.EPS * period and fast_length(n) == n
    return Quadrature(contour, uniform_budget(sources.requested.size, 0.0), n if fits and n >= x.size else 0)
