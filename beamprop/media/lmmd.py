"""The paper's layered cell of large mass-density modulation depth (LMMD)."""

from __future__ import annotations

import functools
import math

import numpy as np

from .. import memory, validate
from ..validate import as_complex, as_count, as_number
from .fluids import AIR, Fluid
from .hints import warn_of_eta
from .structures import Cell, Layer


def lmmd_cell(
    rho_m: complex = 0.05 + 0.05j,
    delta_rho: float = 0.025,
    n_layers: int = 10,
    eta: float = 1 / 60,
    design_frequency: float = 2500.0,
    background: Fluid = AIR,
    lossless: bool = False,
) -> Cell:
    """One period of the rapidly modulated medium of large modulation depth, the paper's Eq. (10).

    Layer j = 1..N has the density ``rho_m + (1/eta + i delta_rho) cos(2 pi (j-1)/N)`` relative to the
    background's, the background's bulk modulus, and the thickness ``eta lambda0 / N``.

    Parameters
    ----------
    rho_m : complex
        Mean relative density.
    delta_rho : float
        Modulation of the loss.
    n_layers : int
        N, layers in a period.
    eta : float
        Period over the background's wavelength at `design_frequency`.
    design_frequency : float, Hz
    background : Fluid
        Isotropic; evaluated at `design_frequency` if it is dispersive.
    lossless : bool
        Take the real part of `rho_m` and no `delta_rho`.

    Raises
    ------
    ValueError
        Names the argument; a layer with gain is the fault of ``rho_m, delta_rho``: Im(rho_m) has to be as large as
        \\|delta_rho\\|.

    Examples
    --------
    >>> cell = bp.lmmd_cell(lossless=True)
    >>> [round(layer.fluid.density.real / 1.25, 2) for layer in cell.layers][:3]
    [60.05, 48.59, 18.59]
    """
    n_layers = as_count(n_layers, "n_layers")
    memory.check("n_layers", 1000.0 * n_layers, f"{n_layers:.3g} layers", "take fewer")
    eta = as_number(eta, "eta", positive=True)
    design_frequency = as_number(design_frequency, "design_frequency", positive=True)
    delta_rho = as_number(delta_rho, "delta_rho")
    rho_m = as_complex(rho_m, "rho_m")
    if not np.isfinite(rho_m):
        raise validate.refuse("rho_m", "a finite number", rho_m)
    validate.within(rho_m, "rho_m", zero=True)
    if validate.flag(lossless, "lossless"):
        rho_m, delta_rho = complex(rho_m.real), 0.0
    validate.instance(background, Fluid, "background")
    values = background.at(design_frequency)
    k0 = float(background.wavenumber(design_frequency).real)
    if not (math.isfinite(k0) and k0 > 0):
        raise ValueError(f"background: expected a fluid in which waves propagate, got {background!r}")
    rho, bulk_modulus = complex(values.rho_z), complex(values.bulk_modulus)
    made = _cell if n_layers <= MOST_LAYERS and abs(bulk_modulus) >= STIFF else _cell.__wrapped__
    cell = made(rho_m, delta_rho, n_layers, eta, rho, bulk_modulus, k0)
    warn_of_eta(eta)
    return cell


#: The last cell is kept, for neighbouring points of a study mostly have the same: if it has no more layers, and none of a modulus [Pa] so
#: small that there is a hint about it, which is due at every call.
MOST_LAYERS, STIFF = 1000, 1e5


@functools.lru_cache(maxsize=1)
def _cell(
    rho_m: complex, delta_rho: float, n_layers: int, eta: float, rho: complex, bulk_modulus: complex, k0: float
) -> Cell:
    """The cell of checked numbers, in a background of density `rho`."""
    cosine = np.cos(2 * np.pi * np.arange(n_layers) / n_layers)
    cosine[np.abs(cosine) < 1e-15] = 0.0  # cos(pi/2): exactly zero, as in the formula
    density = rho * (rho_m + (1 / eta + 1j * delta_rho) * cosine)
    if np.any(density.imag < 0):
        raise ValueError(
            "rho_m, delta_rho: expected a passive medium, Im(density) >= 0 in every layer and so Im(rho_m) >= |delta_rho|, "
            f"got {rho_m if rho_m.imag else rho_m.real:.6g} and {delta_rho:.6g}; lossless=True drops both losses"
        )
    validate.within(density[density != 0], "rho_m, delta_rho, eta")
    thickness = eta * 2 * np.pi / k0 / n_layers
    validate.within(thickness, "eta")
    return Cell(tuple(Layer(Fluid(layer, bulk_modulus), thickness) for layer in density.tolist()))
