"""Effective media: a cell to a fluid, a slab to a slab, so that the exact solver serves them, too.

* Standard theory: ``rho_x = <1/rho>^-1, rho_z = <rho>, 1/K = <1/K>``.
* Large modulation depth, the paper's Eq. (9): no motion along x (``1/rho_x = 0``) and
  ``rho_z = <rho> + w^2 <G^2 / K>`` with G the primitive of ``rho - <rho>`` whose compliance-weighted mean over the period
  is zero. For a uniform K this is ``<rho> + (w^2/K) <G^2>``, the paper's ``rho_m + (k0/K)^2 sum b_n b_-n / n^2`` in
  real space; unlike the paper's b_n it counts delta_rho in the modulation too (an imaginary part of 4e-4 on 0.05).

The derivation in two lines: at lowest order ``p = p_mean + q G(z)``; with it the mean of ``dq/dz = -(w^2/K) p`` and of
``dp/dz = rho q`` gives the effective fluid, and ``p - p_mean = q G`` at the two faces gives the interface term.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import validate
from ..conventions import real_or_complex
from .fluids import Fluid, FluidValues
from .structures import Cell, Layer, Membrane, Slab


def _layers(cell: Cell, frequency: np.ndarray) -> tuple[np.ndarray, list[FluidValues]]:
    validate.instance(cell, Cell, "cell")
    layers = [layer for layer in cell.layers if isinstance(layer, Layer)]
    if len(layers) != len(cell.layers):
        raise ValueError("cell: an effective medium needs a cell of layers only, got a Membrane")
    fluids = [validate.instance(layer.fluid, Fluid, "cell: a layer") for layer in layers]
    return np.array([layer.thickness for layer in layers]), [fluid.at(frequency) for fluid in fluids]


def _mean(cell: Cell, frequency: np.ndarray, name: str, inverse: bool = False) -> np.ndarray:
    """Thickness-weighted mean over the period of a property, or of its inverse; frequency's shape."""
    d, fluids = _layers(cell, frequency)
    values = [getattr(v, name) for v in fluids]
    if inverse and any(np.any(v == 0) for v in values):
        raise ValueError("cell: the mean of 1/density does not exist, a layer has density 0")
    return sum(w * (1 / v if inverse else v) for w, v in zip(d / d.sum(), values, strict=True))


@dataclass(frozen=True)
class CellMean:
    """Mean of a property over a cell (of its inverse with `inverse`, inverted again), as a function of frequency."""

    cell: Cell
    name: str
    inverse: bool = False

    def __call__(self, frequency: np.ndarray) -> np.ndarray:
        mean = _mean(self.cell, real_or_complex(frequency), self.name, self.inverse)
        if not self.inverse:
            return mean
        # inverses that cancel to exactly 0 are those of an infinite property
        return np.divide(1, mean, out=np.full(np.shape(mean), np.inf, complex), where=np.not_equal(mean, 0))


def _modulation(cell: Cell, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(<rho>, <G^2 / K>) and, beside them, G at the face: arrays of frequency's shape."""
    d, fluids = _layers(cell, frequency)
    share = d / d.sum()
    rho = np.stack([v.rho_z for v in fluids], axis=-1)
    compliance = share / np.stack([v.bulk_modulus for v in fluids], axis=-1)
    steps = (rho - (rho @ share)[..., None]) * d
    G = np.concatenate([np.zeros_like(steps[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)
    left, right = G[..., :-1], G[..., 1:]
    G = G - ((compliance * (left + right) / 2).sum(-1) / compliance.sum(-1))[..., None]
    left, right = G[..., :-1], G[..., 1:]
    return (compliance * (left**2 + left * right + right**2) / 3).sum(-1), G[..., 0]


@dataclass(frozen=True)
class LmmdDensity:
    """Effective density along z of a cell, the paper's Eq. (9), as a function of frequency."""

    cell: Cell

    def __call__(self, frequency: np.ndarray) -> np.ndarray:
        f = real_or_complex(frequency)
        return _mean(self.cell, f, "rho_z") + (2 * np.pi * f) ** 2 * _modulation(self.cell, f)[0]


@dataclass(frozen=True)
class LmmdJump:
    """The interface term of a face as an areal density, sign times G at the face, as a function of frequency."""

    cell: Cell
    sign: int

    def __call__(self, frequency: np.ndarray) -> np.ndarray:
        return self.sign * _modulation(self.cell, real_or_complex(frequency))[1]


#: The functions of frequency made here: a file records them by their cell, not as a table.
FUNCTIONS: tuple[type, ...] = (CellMean, LmmdDensity, LmmdJump)


def _simplify(cell: Cell, function: Any) -> Any:
    """A number where the cell does not depend on frequency, the function otherwise."""
    validate.instance(cell, Cell, "cell")
    dispersive = any(isinstance(layer, Layer) and layer.fluid.dispersive for layer in cell.layers)
    return function if dispersive else complex(function(np.array(1.0)))


def standard_emt(cell: Cell) -> Fluid:
    """The standard effective fluid of a cell: ``rho_x = <1/rho>^-1, rho_z = <rho>, 1/K = <1/K>``.

    Raises
    ------
    ValueError
        A layer has density 0, so that <1/rho> does not exist.

    Examples
    --------
    >>> fluid = bp.standard_emt(bp.lmmd_cell(0.05, 0))
    >>> round(float(fluid.at(2500.0).rho_z.real) / 1.25, 6)
    0.05
    """
    return Fluid(
        _simplify(cell, CellMean(cell, "rho_z")),
        _simplify(cell, CellMean(cell, "bulk_modulus", inverse=True)),
        _simplify(cell, CellMean(cell, "rho_x", inverse=True)),
    )


def wood_mixture(*parts: tuple[Fluid, float]) -> Fluid:
    """A mixture much finer than the wavelength, such as bubbles in water: ``rho = <rho>``, ``1/K = <1/K>``.

    Parameters
    ----------
    parts : pairs of Fluid and float
        Each isotropic, with its share of the volume; the shares add up to 1.

    Raises
    ------
    ValueError
        Names the part that is wrong, or the sum of the shares.

    Source: A. B. Wood, A Textbook of Sound (1930). Bubbles do not resonate in it, so that it holds far below their resonance.

    Examples
    --------
    >>> water = bp.material("water")
    >>> bubbly = bp.wood_mixture((water, 0.99), (bp.AIR, 0.01))
    >>> round(float(2 * np.pi * 100 / bubbly.wavenumber(100.0).real), 1)  # m/s, far below that of both
    121.6
    """
    layers = []
    for part in parts:
        if not (isinstance(part, tuple) and len(part) == 2):
            raise validate.refuse("parts", "pairs (Fluid, share of the volume)", part)
        validate.instance(part[0], Fluid, "parts")
        if part[0].density_x is not None:
            raise ValueError(f"parts: expected isotropic fluids, got {part[0]!r}")
        layers.append(Layer(part[0], validate.as_number(part[1], "parts", positive=True)))
    total = sum(layer.thickness for layer in layers)
    if abs(total - 1) > 1e-9:
        raise ValueError(f"parts: expected shares of the volume that add up to 1, got {total:g}")
    cell = Cell(tuple(layers))
    return Fluid(
        _simplify(cell, CellMean(cell, "rho_z")), _simplify(cell, CellMean(cell, "bulk_modulus", inverse=True))
    )


def lmmd_emt(cell: Cell) -> Fluid:
    """The effective fluid of a rapidly and deeply modulated cell, the paper's Eq. (9): dispersive, rho_x infinite.

    Examples
    --------
    >>> fluid = bp.lmmd_emt(bp.lmmd_cell(0.05, 0))
    >>> round(float(fluid.at(2500.0).rho_z.real) / 1.25, 5)
    0.53388
    """
    return Fluid(
        LmmdDensity(cell),
        _simplify(cell, CellMean(cell, "bulk_modulus", inverse=True)),
        np.inf,
        active=True,  # rounding of <G^2> may give a passive cell a gain of 1e-16; the cell itself was checked
    )


def lmmd_emt_slab(slab: Slab, interface: bool = True) -> Slab:
    """The slab with every cell replaced by its effective fluid.

    Parameters
    ----------
    slab : Slab
    interface : bool
        Add the term beyond the paper: the lowest-order pressure is ``p_mean + q G(z)``, and G at the faces of a cell is
        not zero unless the cell starts at a symmetric point. It is a membrane of areal density -G at the near
        face and +G at the far face: ``[[1, G], [0, 1]] M [[1, -G], [0, 1]]``.

    Returns
    -------
    Slab
        Of the same thickness and half-spaces.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=80)
    >>> T = [float(bp.scattering(s, 2500.0, angle=30).transmissivity) for s in (slab, bp.lmmd_emt_slab(slab))]
    >>> bool(abs(T[1] / T[0] - 1) < 0.05)
    True
    """
    validate.instance(slab, Slab, "slab")
    validate.flag(interface, "interface")
    segments = []
    for cell, periods in slab.segments:
        layers: tuple[Layer | Membrane, ...] = (Layer(lmmd_emt(cell), cell.thickness * periods),)
        if interface:
            near = Membrane(_simplify(cell, LmmdJump(cell, -1)), active=True)
            far = Membrane(_simplify(cell, LmmdJump(cell, 1)), active=True)
            layers = (near, *layers, far)
        segments.append((Cell(layers), 1))
    return Slab.stack(segments, slab.before, slab.after)
