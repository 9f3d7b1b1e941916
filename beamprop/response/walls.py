"""Layers of density 0: soft walls, p = 0 on both faces, which no plane wave passes but the normal one."""

from __future__ import annotations

import itertools

import numpy as np

from ..media.values import LayerValues, SegmentValues


def up_to_wall(segments: list[SegmentValues]) -> list[SegmentValues]:
    """Segments up to the first wall and with it: nothing behind it has an influence off the normal."""
    for i, segment in enumerate(segments):
        walls = _walls(segment)
        if walls:
            return [*segments[:i], _cut(segment, 0, walls[0] + 1)]
    return segments


def parts_between(segments: list[SegmentValues]) -> list[tuple[list[SegmentValues], int]]:
    """The parts into which walls divide segments, and how often each is there; each keeps the walls that bound it."""
    parts: list[tuple[list[SegmentValues], int]] = []
    current: list[SegmentValues] = []
    for segment in segments:
        walls = _walls(segment)
        if not walls:
            current.append(segment)
            continue
        front, back = _cut(segment, 0, walls[0] + 1), _cut(segment, walls[-1], None)
        parts.append(([*current, front], 1))
        parts += [([_cut(segment, near, far + 1)], segment.periods) for near, far in itertools.pairwise(walls)]
        if segment.periods > 1:
            parts.append(([back, front], segment.periods - 1))
        current = [back]
    return [*parts, (current, 1)]


def all_walls(segments: list[SegmentValues]) -> bool:
    """Whether every layer is a wall."""
    return all(bool(np.all(segment.layers.vanishing)) for segment in segments)


def _walls(segment: SegmentValues) -> list[int]:
    """Indices of the layers that are walls at a frequency or more."""
    return [int(i) for i in np.flatnonzero(np.any(segment.layers.vanishing, axis=1))]


def _cut(segment: SegmentValues, start: int, stop: int | None) -> SegmentValues:
    """A single period of the layers from `start` to `stop`."""
    layers = segment.layers
    end = len(layers.thickness) if stop is None else stop
    solids = tuple((slot - start, run) for slot, run in layers.solids if start <= slot < end)
    mass, compliance, mobility, thickness, vanishing = (v[start:stop] for v in layers[:5])
    return SegmentValues(LayerValues(mass, compliance, mobility, thickness, vanishing, solids), 1)
