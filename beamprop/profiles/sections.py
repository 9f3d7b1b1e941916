"""Profiles of a beam across one plane, measured: the rows of a table of widths.

All frequencies are measured at once (`many_frequencies`). Whatever fails a test there (error above rtol, a window too narrow, a
spectrum that is not entire) is measured again by itself (`one_frequency`), with a window that grows until it holds the beam.
"""

from __future__ import annotations

from dataclasses import is_dataclass, replace
from typing import NamedTuple

import numpy as np

from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..sources.base import Beam
from .fwhm import HALF_LEVEL, full_width
from .many_frequencies import measured_together
from .one_frequency import measured_alone
from .routes import Measures, Route, far_face, without


def measure(route: Route, beam: Beam, rtol: float) -> Measures:
    """Width, peak and centroid of the profiles across one plane per frequency."""
    s = route.slab
    level = HALF_LEVEL[getattr(beam, "width_of", "pressure")]
    measures, good = measured_together(route, beam, rtol, level)
    if np.all(good):
        return measures
    table = np.array(measures, float)
    for i in np.flatnonzero(~good):
        slab = s.take(int(i))
        way = float(route.z[i]), float(route.path[i])
        table[:, i] = measured_alone(slab, beam, route.transfer(slab), way, rtol, level, route.guided)
    return Measures(*table)


class Row(NamedTuple):
    """What `beam_width` reports, (F,) each, in its order."""

    fwhm_launch: np.ndarray
    fwhm_in: np.ndarray
    fwhm_out: np.ndarray
    fwhm_air: np.ndarray
    peak_out: np.ndarray
    centroid_out: np.ndarray


def rows(s: SampledSlab, beam: Beam, rtol: float, air_distance: float | None) -> tuple[Row, np.ndarray, np.ndarray]:
    """Widths at all frequencies of a slab, at one angle; crossings of the level, and errors, in the four planes, (4, F)."""
    wavelengths = 2 * np.pi / s.k0
    # a distance without the slab is measured from the launch plane: the way to the slab is no part of it
    launched = replace(beam, z0=0.0) if is_dataclass(beam) else beam

    def free(distance: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not np.any(distance) and beam.entire:
            return _launch_widths(s, beam)
        route = Route(s.without_slab(), without, transfer_function.free, distance, distance, False)
        measures = measure(route, launched, rtol)
        return measures.width, measures.crossings, measures.error

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
    widths, met, errors = zip(launch, near, (far.width, far.crossings, far.error), air, strict=True)
    return Row(*widths, far.peak, far.centroid), np.stack(met), np.stack(errors)


def _launch_widths(s: SampledSlab, beam: Beam) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Widths of the launch profile itself, crossings and errors; |p| does not depend on the frequency."""
    level = HALF_LEVEL[getattr(beam, "width_of", "pressure")]
    k0 = float(s.k0[0])
    x = beam.centre + beam.reach(1e-2) * 1.5 * np.linspace(-1, 1, 2001)
    p = beam.profile(x, k0)
    section = full_width(x, p, level, lambda at: beam.profile(at, k0))
    return np.full(s.k0.shape, section.width), np.full(s.k0.shape, section.crossings), np.zeros(s.k0.shape)
