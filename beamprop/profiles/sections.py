"""Profiles of a beam across one plane, measured: the rows of a table of widths.

All frequencies are measured at once (`many_frequencies`). Whatever fails a test there (error above rtol, a window too narrow, a
spectrum that is not entire) is measured again by itself (`one_frequency`), with a window that grows until it holds the beam.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import is_dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..contour.error import ErrorBudget, uniform_budget
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..sources.rows import RowBeam, at_row
from .fwhm import HALF_LEVEL, centroid, full_width
from .many_frequencies import measured_together
from .one_frequency import measured_alone
from .routes import Measures, Route, far_face, measures_of, without


def measure(routes: Sequence[Route], beam: RowBeam, rtol: float) -> list[Measures]:
    """Width, peak and centroid of the profiles across the planes of routes of the same frequencies."""
    level = _half_level(beam)
    return [
        _checked(route, beam, rtol, level, *measured)
        for route, measured in zip(routes, measured_together(routes, beam, rtol, level), strict=True)
    ]


def _checked(route: Route, beam: RowBeam, rtol: float, level: float, measures: Measures, good: np.ndarray) -> Measures:
    """The measures, those that cannot be trusted once more by themselves."""
    if good.all():
        return measures
    table = measures.table
    for i in np.flatnonzero(~good):
        slab, source = route.slab.take(int(i)), at_row(beam, int(i))
        # a distance without the slab is measured from the launch plane: the way to the slab is no part of it
        source = source if route.guided or not is_dataclass(source) else replace(source, z0=0.0)
        way = float(route.z[i]), float(route.path[i])
        table[:, i] = measured_alone(slab, source, route.transfer(slab), way, rtol, level, route.guided).table[:, 0]
    return measures_of(table)


def _half_level(beam: RowBeam) -> float:
    return HALF_LEVEL[getattr(beam, "width_of", "pressure")]


class Row(NamedTuple):
    """What `beam_width` reports, (F,) each, in its order."""

    fwhm_launch: np.ndarray
    fwhm_in: np.ndarray
    fwhm_out: np.ndarray
    fwhm_air: np.ndarray
    peak_out: np.ndarray
    centroid_out: np.ndarray


def rows(s: SampledSlab, beam: RowBeam, rtol: float, air_distance: float | None) -> tuple[Row, np.ndarray, ErrorBudget]:
    """Widths at all frequencies of a slab, at an angle or at one in each row; crossings of the level in the four planes, (4, F); the worst errors, (F,)."""
    face, routes = np.full(s.k0.shape, s.thickness), {}
    if not beam.entire:
        routes["launch"] = _free(s, 0.0)
    if beam.z0 != 0:
        routes["near"] = _free(s, -beam.z0)
    routes["far"] = Route(
        s,
        lambda slab, _: far_face(slab, beam.z0),
        lambda slab: transfer_function.through(slab, beam.z0),
        face,
        face - beam.z0,
        True,
    )
    routes["air"] = _free(s, air_distance or 4 * np.pi / s.k0)
    measured = dict(zip(routes, measure([*routes.values()], beam, rtol), strict=True))
    launch = measured.get("launch") or _as_launched(s, beam)
    near, far, air = measured.get("near", launch), measured["far"], measured["air"]
    planes = launch, near, far, air
    row = Row(launch.width, near.width, far.width, air.width, far.peak, far.centroid)
    return row, np.stack([plane.crossings for plane in planes]), _worst([plane.budget for plane in planes])


def _free(s: SampledSlab, distance: Any) -> Route:
    """Over a distance in the medium in front."""
    way = np.full(s.k0.shape, distance)
    return Route(s.without_slab(), without, transfer_function.free, way, way, False)


def _worst(budgets: list[ErrorBudget]) -> ErrorBudget:
    """At each frequency the budget with the largest total, (F,); an unknown total, nan, is no largest one."""
    table = np.array(budgets)  # (planes, terms, F)
    largest = np.argmax(np.nan_to_num(table.sum(axis=1), nan=-np.inf), axis=0)
    return ErrorBudget(*np.take_along_axis(table, largest[None, None], 0)[0])


def _as_launched(s: SampledSlab, beam: RowBeam) -> Measures:
    """The launch profile itself; |p| does not depend on the frequency."""
    if (known := getattr(beam, "launch_width", None)) is not None:
        width, peak, place, crossings = np.full((s.k0.size, 4), [known, np.nan, np.nan, 2.0]).T
        return Measures(width, peak, place, crossings, uniform_budget(s.k0.size, 0.0))
    k0 = float(s.k0[0])
    x = beam.centre + beam.reach(1e-2) * 1.5 * np.linspace(-1, 1, 2001)
    p = beam.profile(x, k0)
    section = full_width(x, p, _half_level(beam), lambda at: beam.profile(at, k0))
    width, peak, place, crossings = np.full(
        (s.k0.size, 4), [section.width, section.peak, centroid(x, p), section.crossings]
    ).T
    return Measures(width, peak, place, crossings, uniform_budget(s.k0.size, 0.0))
