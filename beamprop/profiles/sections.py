"""Profiles of a beam across one plane, measured: the rows of a table of widths.

All frequencies are measured at once (`many_frequencies`). Whatever fails a test there (error above rtol, a window too narrow, a
spectrum that is not entire) is measured again by itself (`one_frequency`), with a window that grows until it holds the beam.
"""

from __future__ import annotations

from dataclasses import is_dataclass, replace
from typing import NamedTuple

import numpy as np

from ..contour.error import ErrorBudget, uniform_budget
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..sources.base import Beam
from .fwhm import HALF_LEVEL, centroid, full_width
from .many_frequencies import measured_together
from .one_frequency import measured_alone
from .routes import Measures, Route, far_face, measures_of, without


def measure(route: Route, beam: Beam, rtol: float) -> Measures:
    """Width, peak and centroid of the profiles across one plane per frequency."""
    s = route.slab
    level = _half_level(beam)
    measures, good = measured_together(route, beam, rtol, level)
    table = measures.table
    for i in np.flatnonzero(~good):
        slab = s.take(int(i))
        way = float(route.z[i]), float(route.path[i])
        table[:, i] = measured_alone(slab, beam, route.transfer(slab), way, rtol, level, route.guided).table[:, 0]
    return measures_of(table)


def _half_level(beam: Beam) -> float:
    return HALF_LEVEL[getattr(beam, "width_of", "pressure")]


class Row(NamedTuple):
    """What `beam_width` reports, (F,) each, in its order."""

    fwhm_launch: np.ndarray
    fwhm_in: np.ndarray
    fwhm_out: np.ndarray
    fwhm_air: np.ndarray
    peak_out: np.ndarray
    centroid_out: np.ndarray


def rows(s: SampledSlab, beam: Beam, rtol: float, air_distance: float | None) -> tuple[Row, np.ndarray, ErrorBudget]:
    """Widths at all frequencies of a slab, at one angle; crossings of the level in the four planes, (4, F); the worst errors, (F,)."""
    wavelengths = 2 * np.pi / s.k0
    # a distance without the slab is measured from the launch plane: the way to the slab is no part of it
    launched = replace(beam, z0=0.0) if is_dataclass(beam) else beam

    def free(distance: np.ndarray) -> Measures:
        if not np.any(distance) and beam.entire:
            return _as_launched(s, beam)
        return measure(
            Route(s.without_slab(), without, transfer_function.free, distance, distance, False), launched, rtol
        )

    launch = free(np.zeros(s.k0.shape))
    near = launch if beam.z0 == 0 else free(np.full(s.k0.shape, -beam.z0))
    face = np.full(s.k0.shape, s.thickness)
    through = Route(
        s,
        lambda slab, _: far_face(slab, beam.z0),
        lambda slab: transfer_function.through(slab, beam.z0),
        face,
        face - beam.z0,
        True,
    )
    far = measure(through, beam, rtol)
    air = free(2 * wavelengths if air_distance is None else np.full(s.k0.shape, air_distance))
    planes = launch, near, far, air
    row = Row(launch.width, near.width, far.width, air.width, far.peak, far.centroid)
    return row, np.stack([plane.crossings for plane in planes]), _worst([plane.budget for plane in planes])


def _worst(budgets: list[ErrorBudget]) -> ErrorBudget:
    """At each frequency the budget with the largest total, (F,); an unknown total, nan, is no largest one."""
    table = np.array(budgets)  # (planes, terms, F)
    largest = np.argmax(np.nan_to_num(table.sum(axis=1), nan=-np.inf), axis=0)
    return ErrorBudget(*np.take_along_axis(table, largest[None, None], 0)[0])


def _as_launched(s: SampledSlab, beam: Beam) -> Measures:
    """The launch profile itself; |p| does not depend on the frequency."""
    k0 = float(s.k0[0])
    x = beam.centre + beam.reach(1e-2) * 1.5 * np.linspace(-1, 1, 2001)
    p = beam.profile(x, k0)
    section = full_width(x, p, _half_level(beam), lambda at: beam.profile(at, k0))
    width, peak, place, crossings = np.full(
        (s.k0.size, 4), [section.width, section.peak, centroid(x, p), section.crossings]
    ).T
    return Measures(width, peak, place, crossings, uniform_budget(s.k0.size, 0.0))
