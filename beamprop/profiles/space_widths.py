"""Widths of a beam in three dimensions on the planes of `beam_width`, at one frequency."""

from __future__ import annotations

import functools
import math
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..contour.error import ErrorBudget, uniform_budget
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..sources.in_space import EllipticalGaussian, has_edge
from ..sources.sum_in_space import SumInSpace
from .fwhm import Width, full_width
from .level_area import Area, area_above
from .peak import Peak, peak_of
from .space_plane import Sampled, Way, widened
from .windows import EDGE


class SpaceRow(NamedTuple):
    """What `beam_width` reports of a beam in three dimensions, in its order; arrays (2,) along x and y, from the source's middle."""

    fwhm_launch: np.ndarray
    fwhm_in: np.ndarray
    fwhm_out: np.ndarray
    fwhm_air: np.ndarray
    area_out: float
    equivalent_out: float
    peak_out: float
    centroid_out: np.ndarray


class Section(NamedTuple):
    """Of a profile across a plane: the cuts along x and y through its peak."""

    peak: Peak  #: its place is unknown, nan, of a launched profile whose width is known
    width: np.ndarray  #: (2,) m
    crossings: np.ndarray  #: (2,), how often |p| meets the level along each
    budget: ErrorBudget


class Widths(NamedTuple):
    """Widths, how often |p| meets the level in each plane along each axis, (4, 2), in which planes the peak is a ring, (4,), and errors."""

    row: SpaceRow
    crossings: np.ndarray
    rings: np.ndarray
    budget: ErrorBudget
    area: Area


def widths(s: SampledSlab, source: Any, level: float, rtol: float, distance: float) -> Widths:
    """At one frequency and angle; `distance` is that from the launch plane without the slab."""
    z0 = source.z0
    launch = known_launch(source, level) or _free(s, source, z0, level, rtol)
    near = launch if z0 == 0 else _free(s, source, 0.0, level, rtol)
    profile = widened(s, source, Way(partial(transfer_function.through, s), s.thickness), rtol, EDGE * level)
    far, air = section(profile, level), _free(s, source, z0 + distance, level, rtol)
    area = area_above(profile, far.peak, level, rtol)
    row = SpaceRow(
        fwhm_launch=launch.width,
        fwhm_in=near.width,
        fwhm_out=far.width,
        fwhm_air=air.width,
        area_out=area.value,
        equivalent_out=2 * math.sqrt(area.value / math.pi),
        peak_out=far.peak.size,
        centroid_out=centroid(profile),
    )
    sections = launch, near, far, air
    worst = functools.reduce(ErrorBudget.worse, (plane.budget for plane in sections))
    crossings, rings = (
        np.array(v) for v in zip(*((plane.crossings, plane.peak.ring) for plane in sections), strict=True)
    )
    return Widths(row, crossings, rings, worst, area)


def _free(s: SampledSlab, source: Any, z: float, level: float, rtol: float) -> Section:
    """Across a plane of the medium in front alone."""
    free = s.without_slab()
    return section(widened(free, source, Way(partial(transfer_function.through, free), z), rtol, EDGE * level), level)


def section(profile: Sampled, level: float) -> Section:
    """Peak and full widths of a profile."""
    peak = peak_of(profile)
    cuts = cuts_of(profile, peak, level)
    width, crossings = (
        np.array([float(v) for v in values]) for values in ([c.width for c in cuts], [c.crossings for c in cuts])
    )
    return Section(peak, width, crossings, profile.plane.budget)


def cuts_of(profile: Sampled, peak: Peak, level: float) -> list[Width]:
    """The widths along x and y through the peak."""
    cuts = []
    for axis, at in enumerate((profile.x, profile.y)):
        line = profile.plane.along(axis, float(peak.place[1 - axis]))
        cuts.append(full_width(at, line(at), level, line))
    return cuts


def known_launch(source: Any, level: float) -> Section | None:
    """The launched width where it is known: of a Gaussian, and a sharp edge's diameter.

    Where sources of a sum or elements of an array have sharp edges, which no lattice resolves on their plane, it is left open, nan.
    """
    if isinstance(source, SumInSpace):
        if len(source.parts) == 1:
            return known_launch(source.parts[0].source, level)
        if not has_edge(source):
            return None
        width = np.full(2, np.nan)
    elif left_open(source):
        width = np.full(2, np.nan)
    elif isinstance(source, EllipticalGaussian):
        width = 2 * np.array(source.radii) * math.sqrt(math.log(1 / level))
    elif has_edge(source):
        width = np.full(2, 2 * getattr(source, "element", source).reach(0.5))
    else:
        return None
    return Section(Peak(np.full(2, np.nan), np.nan), width, np.full(2, 2.0), uniform_budget(1, 0.0))


def left_open(source: Any) -> bool:
    """Whether the launched width is that of several sharp edges: of a sum, or of an array of more than one position."""
    several = isinstance(source, SumInSpace) or len(getattr(source, "positions", ())) > 1
    return several and has_edge(source)


def centroid(profile: Sampled) -> np.ndarray:
    """Of |p|^2 over the window, by the trapezoid rule: (2,)."""
    power = np.abs(profile.p) ** 2
    total = np.trapezoid(np.trapezoid(power, profile.x), profile.y)
    if not total > 0:
        return np.full(2, np.nan)
    moments = np.trapezoid(power @ np.diag(profile.x), profile.x), np.trapezoid(power, profile.x) * profile.y
    return np.array([np.trapezoid(v, profile.y) for v in moments]) / total
