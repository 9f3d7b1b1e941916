"""From objects to arrays: fluids, cells and slabs evaluated at frequencies.

A kernel sees `FluidValues` of the half-spaces and `SegmentValues` of the layers between them, and no object.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .fluids import Fluid, FluidValues
from .structures import Cell, Membrane, Slab


class LayerValues(NamedTuple):
    """The layers of a cell at F frequencies: arrays (N, F), and the thickness (N,).

    A layer's matrix needs no more than mass ``rho_z d``, compliance ``d / K`` and mobility ``d / rho_x``; a
    membrane has mass alone. Rows are divided in proportion where a layer is cut.
    """

    mass: np.ndarray
    compliance: np.ndarray
    mobility: np.ndarray
    thickness: np.ndarray
    vanishing: np.ndarray  # (N, F): isotropic density 0, solved as the limit of small density


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
    thickness: np.ndarray  # (N,)
    membrane: np.ndarray  # (N,)


def materials(cell: Cell, frequency: np.ndarray) -> Materials:
    """A cell's layers as materials at frequencies [Hz] (1-D)."""
    seen: dict[Fluid, FluidValues] = {}
    rows = []
    for layer in cell.layers:
        if isinstance(layer, Membrane):  # mass without thickness, which does not move along x
            rows.append(
                FluidValues(layer.at(frequency), np.full(frequency.shape, np.inf + 0j), np.ones(frequency.shape))
            )
            continue
        if layer.fluid not in seen:
            seen[layer.fluid] = layer.fluid.at(frequency)
        rows.append(seen[layer.fluid])
    fluid = FluidValues(*(np.stack(column) for column in zip(*rows, strict=True)))
    thickness = np.array([layer.thickness for layer in cell.layers])
    return Materials(fluid, thickness, np.array([isinstance(layer, Membrane) for layer in cell.layers]))


def layer_values(cell: Cell, frequency: np.ndarray) -> LayerValues:
    """A cell's layers as mass, compliance and mobility at frequencies [Hz] (1-D)."""
    (rho_z, rho_x, K), thickness, membrane = materials(cell, frequency)
    vanishing = (rho_z == 0) & (rho_x == 0)
    if vanishing.any():
        rho_z, rho_x = (np.where(vanishing, TINY_DENSITY, rho) for rho in (rho_z, rho_x))
    mobility = np.divide(1, rho_x, out=np.zeros(rho_x.shape, complex), where=np.isfinite(rho_x))
    d = thickness[:, None]
    mass = rho_z * np.where(membrane[:, None], 1.0, d)
    return LayerValues(mass, d / K, mobility * d, thickness, vanishing)


def slab_values(slab: Slab, frequency: np.ndarray) -> list[SegmentValues]:
    """A slab's segments, from the near face on, at frequencies [Hz] (1-D)."""
    return [SegmentValues(layer_values(cell, frequency), periods) for cell, periods in slab.segments]
