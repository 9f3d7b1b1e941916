"""The choice of a contour for a field in three dimensions and an rtol, at one frequency."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...modes import misplaced
from ...response.sampled_slab import SampledSlab
from ...response.transfer_function import TransferFunction
from ...sources.angles import AngleInterpolation
from .. import check_points, survey
from ..bent import quadrature_on_bent_contour
from ..check_points import Checks
from ..choose import arriving
from ..paths import Extent
from ..quadrature import Quadrature
from ..search import Planned, Search, first_plan, with_poles
from ..unseen_bands import with_unseen_bands
from .sheet import ASIDE, CUT, GAP, INSIDE, Sheet, fall, landed, margin_of, spectrum_of

#: Positions along x and along y at which contours are compared: of those that are requested, and about the source, with twice as many
#: gaps. Their products are some hundred positions, as many as on a line.
PICKED, AROUND = 9, 7


def choose_in_space(
    s: SampledSlab,
    sources: AngleInterpolation,
    transfer: TransferFunction,
    grid: tuple[np.ndarray, np.ndarray],
    z: np.ndarray,
    rtol: float,
) -> Quadrature:
    """A contour on which the field at x and y of the `grid`, from the source's middle, keeps rtol; its error by a second contour."""
    if s.backward_branch is not None:
        raise ValueError(
            "slab: expected half-spaces that carry forward waves in three dimensions, got one that carries backward waves: "
            "not available yet"
        )
    sheet = _sheet(sources, s.k0, grid)
    extent = _extent(s, sources, sheet, z, rtol)
    planes = check_points.check_planes(z, s.thickness, 2 * math.pi / s.k0)
    if z.size > planes.size:
        planes = np.union1d(planes, check_points.darkest_planes(sources, s.k0, transfer, z))
    noise, sharp, rays, _ = survey.rounding_and_rays(s, sources, transfer, planes, extent, rtol)
    sheet = _with_landings(sheet._replace(rays=rays), sources, transfer, planes[[0, -1]])
    peaks_outside = np.zeros((sources.requested.size, planes.size))
    checks = Checks(sources, s.k0, transfer, sheet, planes, True, peaks_outside, None)
    search = Search(s, checks, extent, rtol, noise, sharp, np.empty(0))
    plan = first_plan(search)
    # the filter falls beyond the band, and before its begin
    falling = (1 + INSIDE) * fall(rtol) * plan.depth
    low = extent.low - falling
    if low <= 0 or not survey.wide_enough(transfer, planes, extent.low, extent.band):
        low = 0.0
    search = search._replace(extent=extent._replace(band=extent.band + falling, low=low))
    plan = first_plan(search)
    search = search._replace(checks=checks._replace(places=sheet._replace(first=plan)))
    planned = Planned(plan, misplaced.NONE, 0.0)
    if sheet.around is not None:
        planned = with_poles(search, planned)
        if not planned.unclear:
            places: Any = search.checks.places
            search = search._replace(checks=places.with_wider_look(search, planned, search.checks))
    quadrature, _ = quadrature_on_bent_contour(search, planned)
    return with_unseen_bands(s, search.checks, quadrature)._replace(checked_planes=planes)


def _sheet(sources: AngleInterpolation, k0: float, grid: tuple[np.ndarray, np.ndarray]) -> Sheet:
    """Positions among the requested ones, and about the source's middle: apart where it is far."""
    beam: Any = sources.beam
    picked, around, aside = [], [], False
    for positions, half in zip(grid, beam.half_widths(0.5), strict=True):
        order = np.sort(positions)
        picked.append(order[np.unique(np.linspace(0, order.size - 1, PICKED).round().astype(int))])
        around.append(half * np.linspace(-1, 1, AROUND))
        gap = max(order[0], -order[-1]) - half
        aside |= gap > max(ASIDE * (np.ptp(order) + 2 * half), GAP / k0)
    x, y = picked
    if aside:
        return Sheet(x, y, _far(x, y), around=(around[0], around[1]))
    x, y = (np.unique(np.concatenate(pair)) for pair in zip(picked, around, strict=True))
    return Sheet(x, y, _far(x, y))


def _far(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """The largest |x| and |y|."""
    return float(np.max(np.abs(x))), float(np.max(np.abs(y)))


def _with_landings(sheet: Sheet, sources: AngleInterpolation, transfer: TransferFunction, z: np.ndarray) -> Sheet:
    """With the positions where beams land, as far as they lie no farther out than the requested ones."""
    assert sheet.rays is not None
    x, y = landed(sheet.rays, sources, transfer, z)
    low = -np.array(sheet.far) if sheet.around is None else np.array([sheet.x.min(), sheet.y.min()])
    high = np.array(sheet.far) if sheet.around is None else np.array([sheet.x.max(), sheet.y.max()])
    inside = (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
    x, y = (np.unique(np.concatenate(pair)) for pair in ((sheet.x, x[inside]), (sheet.y, y[inside])))
    return sheet._replace(x=x, y=y)


def _extent(s: SampledSlab, sources: AngleInterpolation, sheet: Sheet, z: np.ndarray, rtol: float) -> Extent:
    tolerance = CUT * rtol
    beam: Any = sources.beam
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    spectrum = spectrum_of(sources, s.k0, tolerance)
    band = min(spectrum.high, arriving(s, beam.z0, z, tolerance))
    if not math.isfinite(band):
        raise ValueError(
            f"z: expected positions behind the launch plane z0 = {beam.z0:.9g} of a source with a sharp edge, got {float(z.min()):.9g}: "
            "its spectrum does not end there; and behind the slab where z0 is its near face"
        )
    length = math.hypot(*sheet.lengths(sources, tolerance))
    farthest = length + margin_of(length, band, spectrum.high, fall(rtol))
    return Extent(s.k0, s.nearest_branch, band, farthest, beam.reach(tolerance), path, spectrum.low)
