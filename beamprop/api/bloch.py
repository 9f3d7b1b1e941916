"""`bloch`: the Bloch wavenumber of an infinite stack of a cell."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import response, validate
from ..io import datasets
from ..media.fluids import AIR, Fluid
from ..media.structures import Cell
from ..media.values import period_values
from . import checks


def bloch(
    cell: Cell,
    frequency: Any,
    *,
    kx: Any = None,
    kx_over_k0: Any = None,
    background: Fluid = AIR,
    estimate: bool = True,
) -> xr.Dataset:
    """Bloch wavenumber of an infinite stack of a cell: its equifrequency contour.

    Parameters
    ----------
    cell : Cell
    frequency : float or 1-D array, Hz
    kx, kx_over_k0 : float or 1-D array, real
        One of: lateral wavenumber [rad/m], or the same over the wavenumber k0 of `background`.
    background : Fluid
        Whose wavenumber is k0.
    estimate : bool
        Estimate what rounding does, by a second evaluation with the last bits of kx and layers moved.

    Returns
    -------
    Dataset
        On (frequency, the one given): complex `kz` [rad/m] and `kz_over_k0`. Im(kz) >= 0: the wave that decays, or
        where none does carries energy, along +z; the real part is continuous in kx, in the first zone at the kx
        nearest to 0. -kz belongs to the contour too. With `estimate` also `error_estimate`, the error of kz over the larger
        of \\|kz\\| and k0: at a band edge kz is a square root, and known to half the digits.

    Warns
    -----
    AccuracyWarning
        The estimated error is above 1e-6.

    Raises
    ------
    ValueError
        Also for a cell with a layer of isotropic density 0 and kx other than 0: no finite limit.

    Examples
    --------
    >>> ds = bp.bloch(bp.lmmd_cell(0.05, 0), 2500.0, kx_over_k0=[0, 5])
    >>> ds.kz_over_k0.real.values.round(4)
    array([0.7308, 0.7352])
    """
    validate.instance(cell, Cell, "cell")
    validate.instance(background, Fluid, "background")
    if cell.thickness < validate.LEAST:  # phases of thinner cells underflow, and kz is the phase over the thickness
        raise ValueError(f"cell: expected a thickness of at least {validate.LEAST:g} m, got {cell.thickness:g}")
    f = validate.axis(frequency, "frequency", positive=True)
    name, value = checks.single_option(kx=kx, kx_over_k0=kx_over_k0)
    flat = np.atleast_1d(f)
    axis, k = checks.lateral(name, value, lambda g: checks.forward_k0(background, g, "background"), flat, 350.0)
    if np.iscomplexobj(axis):
        raise ValueError(f"{name}: expected real values, got complex ones")
    layers = period_values(cell, flat)
    if np.any(layers.vanishing) and np.any(k != 0):
        raise ValueError(
            "cell: a layer of density 0 blocks every kx other than 0, its Bloch wavenumber has no finite limit"
        )
    omega, k = 2 * np.pi * flat[:, None], k.astype(complex)
    kz = response.bloch_wavenumber(layers, omega, k)
    if not np.all(np.isfinite(kz)):
        raise ValueError(f"{name}: the Bloch wavenumber is not finite (double precision cannot hold the cell's matrix)")
    k0 = checks.forward_k0(background, flat, "background")
    dims, pick = checks.dims(frequency=f, **{name: axis})
    variables = {"kz": kz, "kz_over_k0": kz / k0[:, None]}
    if estimate:
        error = response.bloch_error(layers, omega, k) / np.maximum(np.abs(kz), k0[:, None])
        checks.warn_of_plane_waves(error, flat, name, np.atleast_1d(axis))
        variables["error_estimate"] = error
    coords = checks.coords(frequency=f, **{name: axis})
    return datasets.make(
        {n: (dims, v[pick]) for n, v in variables.items()}, coords, "bloch", flat, cell=cell, background=background
    )
