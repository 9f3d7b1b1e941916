"""Where solids touch: a slab cut so that every run of solids in contact lies within one segment."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from .solids import Solid, SolidBlock, SolidHalfSpace, SolidLayers
from .structures import Layer, Membrane, Slab, is_solid

#: Layers, and how often they repeat.
Stack = tuple[tuple[Any, ...], int]


class Part(NamedTuple):
    """A segment: its layers from the near side on, a run of solids being one item, a tuple of (layers, periods); and its periods."""

    items: tuple[Layer | Membrane | tuple[Stack, ...], ...]
    periods: int


def has_solids(slab: Slab) -> bool:
    """Whether some layer, or the half-space behind, is a solid."""
    return isinstance(slab.after, Solid) or any(is_solid(layer) for cell, _ in slab.segments for layer in cell.layers)


def in_solid(slab: Slab, z: np.ndarray) -> np.ndarray:
    """Which depths z (Z,) [m] lie in a solid; its near face does, its far face does not."""
    out, start = np.zeros(z.shape, bool), 0.0
    for cell, periods in slab.segments:
        depth, end = z - start, cell.thickness * periods
        depth = np.where((depth >= 0) & (depth < end), np.mod(depth, cell.thickness or 1.0), -1.0)
        near = 0.0
        for layer in cell.layers:
            out |= is_solid(layer) & (depth >= near) & (depth < near + layer.thickness)
            near += layer.thickness
        start += end
    return out | ((z >= start) & isinstance(slab.after, Solid))


def parts(slab: Slab) -> list[Part]:
    """The segments of a slab, cut anew: none begins or ends within a run of solids.

    A cell that ends in a solid and begins with one is repeated from its first fluid on. A run in contact with a solid half-space is
    left out: it goes with that.
    """
    out = _parts(slab)
    return out[:-1] if _last_run(slab, out) else out


def solid_half_space(slab: Slab, frequency: np.ndarray) -> SolidHalfSpace:
    """The half-space of solid behind a slab at frequencies [Hz] (F,), with the solids in contact with it."""
    assert isinstance(slab.after, Solid)
    return SolidHalfSpace(*slab.after.at(frequency), run_values(_last_run(slab, _parts(slab)), frequency))


def _last_run(slab: Slab, out: list[Part]) -> tuple[Stack, ...]:
    """The run of solids in contact with a solid half-space."""
    last = out[-1].items[-1]
    return last if isinstance(slab.after, Solid) and isinstance(last, tuple) else ()


def _parts(slab: Slab) -> list[Part]:
    out: list[Part] = []
    for alike, group in itertools.groupby(_cut(slab), key=lambda stack: all(map(is_solid, stack[0]))):
        if alike:
            out.append(Part((tuple(group),), 1))
        else:
            out += [Part(items_of(layers), periods) for layers, periods in group]
    return out


def _cut(slab: Slab) -> Iterable[Stack]:
    """Stacks of solids alone, and stacks that begin and end with a fluid or end with a whole run before their repetition."""
    for cell, periods in slab.segments:
        layers = cell.layers
        solid = [is_solid(layer) for layer in layers]
        if all(solid) or not (solid[0] or solid[-1]):
            yield layers, periods
            continue
        first, last = solid.index(False), len(solid) - solid[::-1].index(False)
        head, body, tail = layers[:first], layers[first:last], layers[last:]
        if head:
            yield head, 1
        if periods > 1:
            yield body + tail + head, periods - 1
        yield body, 1
        if tail:
            yield tail, 1


def items_of(layers: tuple[Any, ...]) -> tuple[Any, ...]:
    """Layers with runs of solids as one item each."""
    items: list[Any] = []
    for solid, group in itertools.groupby(layers, key=is_solid):
        alike = tuple(group)
        items += [((alike, 1),)] if solid else alike
    return tuple(items)


def run_values(run: tuple[Stack, ...], frequency: np.ndarray) -> tuple[SolidBlock, ...]:
    """A run of solids at frequencies [Hz] (F,)."""
    return tuple(SolidBlock(_layers(layers, frequency), periods) for layers, periods in run)


def _layers(layers: tuple[Layer, ...], frequency: np.ndarray) -> SolidLayers:
    values: dict[Any, Any] = {layer.fluid: layer.fluid.at(frequency) for layer in layers}
    density, modulus, shear = (np.stack(row) for row in zip(*(values[layer.fluid] for layer in layers), strict=True))
    return SolidLayers(density, modulus, shear, np.array([layer.thickness for layer in layers]))
