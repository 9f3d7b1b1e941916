"""From objects to arrays: fluids, cells and slabs evaluated at frequencies.

A kernel sees `FluidValues` of the half-spaces and `SegmentValues` of the layers between them, and no object.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from .fluids import Fluid, FluidValues
from .solid_runs import Part, has_solids, items_of, parts, run_values, solid_half_space
from .solids import Solid, SolidBlock, SolidHalfSpace
from .structures import Cell, Layer, Membrane, Slab, is_solid


class LayerValues(NamedTuple):
    """The layers of a cell at F frequencies: arrays (N, F), and the thickness (N,), or (N, F) of a cell for each frequency.

    A layer's matrix needs no more than mass ``rho_z d``, compliance ``d / K`` and mobility ``d / rho_x``; a
    membrane has mass alone. Rows are divided in proportion where a layer is cut. A run of solids in contact is one row without
    mass, compliance and mobility, and stands in `solids` by its number.
    """

    mass: np.ndarray
    compliance: np.ndarray
    mobility: np.ndarray
    thickness: np.ndarray
    vanishing: np.ndarray  # (N, F): isotropic density 0, solved as the limit of small density
    solids: tuple[tuple[int, tuple[SolidBlock, ...]], ...] = ()


class SegmentValues(NamedTuple):
    """One segment of a slab: its layers and how often they repeat."""

    layers: LayerValues
    periods: int


#: Replaces an isotropic density of exactly 0, whose limit is r = -1, t = 0 off the normal: the error is of this size beside
#: densities near 1.
TINY_DENSITY = 1e-40


class Materials(NamedTuple):
    """The materials of a cell's layers at F frequencies, from which differences between neighbours are formed.

    `fluid` arrays (N, F); a membrane has its areal density [kg/m2] for rho_z.
    """

    fluid: FluidValues
    thickness: np.ndarray  # (N,), or (N, F) of a cell for each frequency
    membrane: np.ndarray  # (N,)


def materials(cell: Cell | Sequence[Cell], frequency: np.ndarray) -> Materials:
    """Layers as materials at frequencies [Hz] (1-D): of a cell, or of a cell for each frequency.

    Such cells have equally many layers, and membranes at the same places.
    """
    cells = [cell] if isinstance(cell, Cell) else cell
    numbers = np.array([[_numbers(layer) for layer in cell.layers] for cell in cells], complex)
    values = np.empty((3, numbers.shape[1], frequency.size), complex)
    values[:] = numbers.T
    if np.isnan(numbers).any():
        for columns, cell in zip(np.array_split(np.arange(frequency.size), len(cells)), cells, strict=True):
            dispersive = {layer for layer in cell.layers if _numbers(layer) is _DISPERSIVE}
            seen = {layer: _at(layer, frequency[columns]) for layer in dispersive}
            for j, layer in enumerate(cell.layers):
                if layer in seen:
                    values[:, j, columns] = seen[layer]
    thickness = np.array([[layer.thickness for layer in cell.layers] for cell in cells]).T
    membrane = np.array([isinstance(layer, Membrane) for layer in cells[0].layers])
    return Materials(FluidValues(*values), thickness[:, 0] if len(cells) == 1 else thickness, membrane)


_DISPERSIVE = (np.nan, np.nan, np.nan)


def _numbers(layer: Layer | Membrane) -> tuple[Any, Any, Any]:
    """rho_z, rho_x and K of a layer whose properties are numbers. A membrane is mass without thickness, which does not move along x."""
    row: tuple[Any, Any, Any]
    if isinstance(layer, Membrane):
        row = (layer.areal_density, np.inf, 1.0)
    else:
        fluid = layer.fluid
        assert isinstance(fluid, Fluid)  # solids have rows of their own
        row = (fluid.density, fluid.density if fluid.density_x is None else fluid.density_x, fluid.bulk_modulus)
    return _DISPERSIVE if callable(row[0]) or callable(row[1]) or callable(row[2]) else row


def _at(layer: Layer | Membrane, frequency: np.ndarray) -> Any:
    """The same of a layer with functions of frequency: (3, F)."""
    if isinstance(layer, Layer):
        return layer.fluid.at(frequency)
    mass = layer.at(frequency)
    return mass, np.full(mass.shape, np.inf), np.ones(mass.shape)


def layer_values(cell: Cell | Sequence[Cell], frequency: np.ndarray) -> LayerValues:
    """`materials` as mass, compliance and mobility."""
    (rho_z, rho_x, K), thickness, membrane = materials(cell, frequency)
    vanishing = (rho_z == 0) & (rho_x == 0)
    if vanishing.any():
        rho_z, rho_x = (np.where(vanishing, TINY_DENSITY, rho) for rho in (rho_z, rho_x))
    mobility = np.divide(1, rho_x, out=np.zeros(rho_x.shape, complex), where=np.isfinite(rho_x))
    d = thickness.reshape(len(thickness), -1)
    mass = rho_z * np.where(membrane[:, None], 1.0, d)
    return LayerValues(mass, d / K, mobility * d, thickness, vanishing)


def along_normal(cell: Cell, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Masses and compliances (N, F), and thicknesses (N,), of a cell's layers for waves along the normal, which shear nothing."""
    if not any(is_solid(layer) for layer in cell.layers):
        layers = layer_values(cell, frequency)
        return layers.mass, layers.compliance, layers.thickness
    rows = []
    for layer in cell.layers:
        if isinstance(layer, Layer) and isinstance(layer.fluid, Solid):
            solid = layer.fluid.at(frequency)
            rows.append((solid.density * layer.thickness, layer.thickness / solid.longitudinal_modulus))
        else:
            values = layer_values(Cell((layer,)), frequency)
            rows.append((values.mass[0], values.compliance[0]))
    mass, compliance = (np.stack(column) for column in zip(*rows, strict=True))
    return mass, compliance, np.array([layer.thickness for layer in cell.layers])


def slab_values(slab: Slab | Sequence[Slab], frequency: np.ndarray) -> list[SegmentValues]:
    """Segments, from the near face on, at frequencies [Hz] (1-D): of a slab, or of a slab of the same `layout` for each frequency.

    Where solids of two periods touch, the periods begin elsewhere in the cell: every run of solids lies within one segment.
    """
    slabs = [slab] if isinstance(slab, Slab) else slab
    if has_solids(slabs[0]):
        return [_with_solids(part, frequency) for part in parts(slabs[0])]
    segments = zip(*(slab.segments for slab in slabs), strict=True)
    return [SegmentValues(layer_values([cell for cell, _ in pairs], frequency), pairs[0][1]) for pairs in segments]


def period_values(cell: Cell, frequency: np.ndarray) -> LayerValues:
    """One period of an infinite stack; with solids it begins with a fluid, so that no run of solids is cut."""
    solid = [is_solid(layer) for layer in cell.layers]
    if not any(solid):
        return layer_values(cell, frequency)
    if all(solid):
        raise ValueError("cell: expected a fluid beside the solids of a cell: solids alone carry two Bloch waves")
    first = solid.index(False)
    turned = items_of(cell.layers[first:] + cell.layers[:first])
    return _with_solids(Part(turned, 1), frequency).layers


def _with_solids(part: Part, frequency: np.ndarray) -> SegmentValues:
    """A segment whose runs of solids are rows of their own."""
    fluids = [j for j, item in enumerate(part.items) if not isinstance(item, tuple)]
    runs = {j: run_values(item, frequency) for j, item in enumerate(part.items) if isinstance(item, tuple)}
    shape = len(part.items), frequency.size
    rows = [np.zeros(shape, complex) for _ in range(3)]
    vanishing = np.zeros(shape, bool)
    thickness = np.array([sum(b.thickness for b in runs[j]) if j in runs else 0.0 for j in range(shape[0])])
    if fluids:
        of_fluids: Any = layer_values(Cell(tuple(part.items[j] for j in fluids)), frequency)  # type: ignore[misc]
        for whole, row in zip((*rows, thickness, vanishing), of_fluids[:5], strict=True):
            whole[fluids] = row
    mass, compliance, mobility = rows
    values = LayerValues(mass, compliance, mobility, thickness, vanishing, tuple(runs.items()))
    return SegmentValues(values, part.periods)


def half_space_values(fluids: Sequence[Fluid], frequency: np.ndarray) -> FluidValues:
    """A half-space at frequencies [Hz] (1-D): a fluid at all of them, or a fluid for each."""
    if all(fluid == fluids[0] for fluid in fluids):
        return fluids[0].at(frequency)
    rows = (fluid.at(frequency[i : i + 1]) for i, fluid in enumerate(fluids))
    return FluidValues(*(np.concatenate(column) for column in zip(*rows, strict=True)))


def behind_values(slabs: Sequence[Slab], frequency: np.ndarray) -> FluidValues | SolidHalfSpace:
    """The half-space behind, of a slab, or of a slab for each frequency (slabs with solids: equal ones)."""
    if isinstance(slabs[0].after, Solid):
        return solid_half_space(slabs[0], frequency)
    return half_space_values([slab.after for slab in slabs], frequency)  # type: ignore[misc]


def layout(slab: Slab) -> tuple[Any, ...]:
    """What slabs have in common whose values fit into the same arrays: for each segment its periods, and which layers are membranes.

    Slabs with solids have it in common with equal ones only.
    """
    if has_solids(slab):
        return (*slab.segments, slab.after)
    return tuple((n, tuple(isinstance(layer, Membrane) for layer in cell.layers)) for cell, n in slab.segments)
