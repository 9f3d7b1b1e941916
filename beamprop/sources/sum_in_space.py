"""A sum of sources in three dimensions, about its middle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from .in_space import SpaceBeam
from .source_sum import SourceSum


class Part(NamedTuple):
    """A source of a sum: about its own middle, which lies `at` a place (2,) from that of the sum [m]."""

    source: SpaceBeam
    weight: complex
    at: np.ndarray


@dataclass(frozen=True, eq=False)
class SumInSpace:
    """The sources of a `SourceSum` in three dimensions, about (0, 0).

    Each has a factor to the response of its own, so that a sum is no `SpaceBeam`.
    """

    parts: tuple[Part, ...]
    angle: float
    azimuth: float

    @property
    def z0(self) -> float:
        """The plane behind which all are: the launch plane, or the last rim of bowls."""
        return max(part.source.z0 for part in self.parts)

    def reach(self, tolerance: float) -> float:
        """From the middle to the farthest end of any source [m]."""
        return max(float(np.hypot(*part.at)) + part.source.reach(tolerance) for part in self.parts)

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """From the middle to the farthest ends along x and y [m]."""
        x, y = np.max([np.abs(part.at) + part.source.half_widths(tolerance) for part in self.parts], axis=0)
        return float(x), float(y)

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """Around those of all sources: see `SpaceBeam.box`."""
        boxes = np.array([part.source.box(k0, tolerance) for part in self.parts])
        return np.stack([boxes[..., 0].min(axis=0), boxes[..., 1].max(axis=0)], axis=1)


def parts_of(source: Any) -> tuple[Part, ...]:
    """The sources of a sum in space, or a single source as the one part of it."""
    return source.parts if isinstance(source, SumInSpace) else (Part(source, 1.0, np.zeros(2)),)


def middle_of(beam: Any) -> np.ndarray:
    """The middle of a source in three dimensions, (2,) m.

    Of a sum that of the rectangle outside of which each source has less than half its largest |p|.
    """
    if not isinstance(beam, SourceSum):
        return np.array([beam.x0, beam.y0])
    sources: list[Any] = list(beam.sources)
    ends = [middle_of(s) + side * np.array(s.in_space(s.azimuth).half_widths(0.5)) for s in sources for side in (-1, 1)]
    return np.asarray((np.min(ends, axis=0) + np.max(ends, axis=0)) / 2)


def in_space(beam: Any, azimuth: float | None) -> Any:
    """A source about the origin in three dimensions, tilted towards an azimuth, its own by default."""
    if not isinstance(beam, SourceSum):
        return beam.in_space(beam.azimuth if azimuth is None else azimuth)
    middle = middle_of(beam)
    sources: list[Any] = list(beam.sources)
    parts = tuple(
        Part(in_space(s, azimuth), w, middle_of(s) - middle) for s, w in zip(sources, beam.weights, strict=True)
    )
    return SumInSpace(parts, beam.angle, beam.azimuth if azimuth is None else azimuth)
