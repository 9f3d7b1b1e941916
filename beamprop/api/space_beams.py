"""`beam_width` and `beam_measures` in three dimensions: what they share, and the answers, labelled."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import memory, validate
from ..contour.error import uniform_budget
from ..io import datasets
from ..media.structures import Slab
from ..profiles import space_measures, space_widths
from ..profiles.fwhm import HALF_LEVEL
from ..profiles.measures import SIDES
from ..profiles.power import PowerError
from ..profiles.windows import TAIL
from ..progress import Progress, watched
from ..response.sampled_slab import sample
from ..sources.base import Beam
from ..sources.in_space import has_edge, needs_y
from ..sources.source_sum import SourceSum
from ..sources.sum_in_space import in_space, middle_of
from . import checks, hints
from .field_in_space import refuse_directions

#: Names of the dimension `axis`.
AXES = ("x", "y")


class SpaceBeams(NamedTuple):
    """Checked arguments of a question about beams in three dimensions."""

    slab: Slab
    beam: Any
    beams: checks.Beams
    azimuth: float
    origin: np.ndarray  #: the beam's middle, (2,) m
    given: float | None  #: the azimuth that overrides the beam's, or those of a sum's sources

    def at_angle(self, angle: float) -> Any:
        """The beam about the origin, at an angle."""
        return in_space(self.beam.at_angle(angle), self.given)

    def labelled(
        self, table: Mapping[str, tuple[tuple[str, ...], np.ndarray]], question: str, **settings: Any
    ) -> xr.Dataset:
        """The dataset of variables by name, each with its dimensions after (frequency, angle)."""
        dims, pick = checks.dims(**self.beams.axes)
        coords = checks.coords(**self.beams.axes) | {"azimuth": ((), self.azimuth), "axis": (("axis",), list(AXES))}
        if question == "beam_measures":
            coords["side"] = (("side",), list(SIDES))
        variables = {name: ((*dims, *more), values[pick]) for name, (more, values) in table.items()}
        given = {"slab": self.slab, "beam": self.beam, "rtol": self.beams.rtol, "azimuth": self.azimuth}
        ds = datasets.make(variables, coords, question, self.beams.flat[0], **given, **settings)
        ds.attrs["geometry"] = "3-D"
        return ds


def is_in_space(beam: Any, azimuth: Any) -> bool:
    """Whether a question about a beam is of three dimensions."""
    return azimuth is not None or needs_y(beam)


def space_beams(slab: Slab, beam: Beam, frequency: Any, angle: Any, rtol: float, azimuth: Any) -> SpaceBeams:
    """The arguments checked, or a ValueError that names the wrong one."""
    beams = checks.unmoved_beams(slab, beam, frequency, angle, rtol)
    source: Any = beam
    each: Any = beam.sources if isinstance(beam, SourceSum) else (beam,)
    if not all(hasattr(single, "in_space") for single in each):
        expected = "one GaussianBeam, Piston, Bowl, SourcePlane or Array in three dimensions, or a sum of these"
        raise validate.refuse("beam", expected, beam)
    given = None if azimuth is None else validate.as_number(azimuth, "azimuth")
    about_origin = in_space(beam, given)  # refuses the form that is not known there
    for value in beams.flat[1]:
        source.at_angle(float(value))
    if source.z0 == 0 and has_edge(about_origin):
        raise validate.refuse("beam", "a sharp edge in front of the near face, whose z is 0", beam)
    refuse_directions(slab, beams.flat[0])
    checks.warn_if_not_ended(beam, slab, beams.flat[0], -beam.z0, beams.rtol)
    return SpaceBeams(slab, beam, beams, about_origin.azimuth if given is None else given, middle_of(beam), given)


def widths_in_space(question: SpaceBeams, air_distance: float | None, progress: Progress) -> xr.Dataset:
    """The answer of `beam_width`."""
    slab, beams = question.slab, question.beams
    flat, angles = beams.flat
    hints.warn_of_width_beside(slab, question.beam, flat)
    memory.check_table(flat.size * angles.size, 120.0)
    level = HALF_LEVEL[getattr(question.beam, "width_of", "pressure")]
    shape, many = (flat.size, angles.size), ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air", "centroid_out")
    names = space_widths.SpaceRow._fields
    table = {name: np.empty((*shape, 2) if name in many else shape) for name in names}
    worst, most, corners, rings = uniform_budget(1, 0.0), np.zeros((4, 2), int), 0.0, np.zeros(4, bool)
    for i, j in watched(progress, list(itertools.product(*map(range, shape))), "widths"):
        s = sample(slab, float(flat[i]))
        source = question.at_angle(float(angles[j]))
        distance = 4 * math.pi / s.k0 if air_distance is None else air_distance
        measured = space_widths.widths(s, source, level, beams.rtol, distance)
        worst, corners = worst.worse(measured.budget), max(corners, measured.area.change)
        most, rings = np.maximum(most, measured.crossings.astype(int)), rings | measured.rings
        for name, value in measured.row._asdict().items():
            table[name][i, j] = value
    table["centroid_out"] += question.origin
    checks.warn_if_inaccurate(worst, beams.rtol)
    _warn_of_corners(corners, beams.rtol)
    left_open = space_widths.left_open(in_space(question.beam, question.given))
    missed = {name: values for name, values in table.items() if not (left_open and name == "fwhm_launch")}
    _warn_of_missing(missed, "no half level inside the window")
    _warn_of_rings([name for name, ring in zip(names, rings, strict=False) if ring])
    checks.warn_of_crossings(
        int(most.max()), ", ".join(n for n, times in zip(names, most.max(axis=1), strict=False) if times > 2)
    )
    dims: dict[str, tuple[str, ...]] = {name: ("axis",) if name in many else () for name in names}
    return question.labelled(
        {name: (dims[name], values) for name, values in table.items()}, "beam_width", air_distance=air_distance
    )


def measures_in_space(question: SpaceBeams, window: float | None, progress: Progress) -> xr.Dataset:
    """The answer of `beam_measures`."""
    flat, angles = question.beams.flat
    rtol, shape = question.beams.rtol, (flat.size, angles.size)
    memory.check_table(flat.size * angles.size, 560.0)
    by_axis, names = space_measures.BY_AXIS, space_measures.Beamlet._fields
    table = {name: np.full((*shape, 2, 2) if name in by_axis else (*shape, 2), np.nan) for name in names}
    worst, of_power, corners = uniform_budget(1, 0.0), PowerError(), 0.0
    rings: set[str] = set()
    for i, j in watched(progress, list(itertools.product(*map(range, shape))), "beams"):
        s, source = sample(question.slab, float(flat[i])), question.at_angle(float(angles[j]))
        both = space_measures.reflected_and_transmitted(s, source, rtol, window)
        for side, measured in enumerate(both):
            worst, corners = worst.worse(measured.budget), max(corners, measured.area.change)
            of_power = max(of_power, measured.power, key=lambda error: error.total)
            rings |= {SIDES[side]} if measured.ring else set()
            for name, value in measured.beamlet._asdict().items():
                table[name][i, j, side] = value
    for name in ("centroid", "moments_from", "moments_to"):
        table[name] += question.origin
    checks.warn_if_inaccurate(worst, rtol)
    checks.warn_if_inaccurate(of_power, rtol, of="a power")
    _warn_of_corners(corners, rtol)
    _warn_of_missing(table, "no beam on a side, or a level not reached inside the window")
    warn_of_cut_moments(table["rim"], window is not None)
    _warn_of_rings(sorted(rings))
    checks.warn_of_crossings(int(table["crossings"].max()))
    table["crossings"] = table["crossings"].astype(int)
    dims: dict[str, tuple[str, ...]] = {name: ("side", "axis") if name in by_axis else ("side",) for name in names}
    return question.labelled(
        {name: (dims[name], values) for name, values in table.items()}, "beam_measures", window=window
    )


def warn_of_cut_moments(rim: np.ndarray, chosen: bool) -> None:
    """Warn where |p| is more than a hundredth of its peak on the rim of the part over which moments are taken, unless that was chosen."""
    largest = float(np.max(np.nan_to_num(rim, nan=0.0)))
    if largest > TAIL and not chosen:
        warnings.warn(
            f"|p| falls to {largest:.2g} of its peak only, in the widest window tried: centroid, lateral_shift and second moment "
            "are those of moments_from to moments_to; choose a window",
            RuntimeWarning,
            stacklevel=3,
        )


def _warn_of_missing(table: dict[str, np.ndarray], why: str) -> None:
    missing = [name for name in table if np.any(np.isnan(table[name]))]
    if missing:
        warnings.warn(f"{why}: nan in {', '.join(missing)}", RuntimeWarning, stacklevel=4)


def _warn_of_rings(names: list[str]) -> None:
    if names:
        warnings.warn(
            f"the peak is a ring, to within the error; cuts pass through its place farthest along x: {', '.join(names)}",
            RuntimeWarning,
            stacklevel=4,
        )


def _warn_of_corners(change: float, rtol: float) -> None:
    if change > rtol:
        warnings.warn(
            f"estimated error {change:.1e} of an area, above the requested rtol {rtol:.1e}: its boundary has sharp corners",
            checks.AccuracyWarning,
            stacklevel=4,
        )
