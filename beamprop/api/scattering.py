"""`scattering`: reflection and transmission of plane waves by a slab."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, response, validate
from ..conventions import outgoing_kz
from ..io import datasets
from ..media.fluids import FluidValues
from ..media.solid_runs import has_solids
from ..media.solids import Solid, SolidHalfSpace
from ..media.structures import Slab
from ..media.values import behind_values, materials, slab_values
from . import checks, hints


def scattering(
    slab: Slab,
    frequency: Any,
    *,
    kx: Any = None,
    kx_over_k0: Any = None,
    angle: Any = None,
    estimate: bool = True,
) -> xr.Dataset:
    """Exact reflection and transmission of plane waves by a slab.

    Parameters
    ----------
    slab : Slab
    frequency : float or 1-D array, Hz
    kx, kx_over_k0, angle : float or 1-D array
        One of: lateral wavenumber [rad/m] (may be complex: continued as a small loss would, see
        `conventions.outgoing_kz`), the same over that of ``slab.before``, or angle of incidence [degree].
    estimate : bool
        Estimate what rounding does, by a second evaluation with the last bits of kx and layers moved, and answer by a more
        robust form where it does much (near-perfect lenses, surfaces of negative density). False: half the time, no estimate,
        and at such places digits may be lost without a warning.

    Returns
    -------
    Dataset
        On (frequency, the one given): complex `r`, `t`; `transmissivity` = \\|t\\|^2 and `reflectivity` = \\|r\\|^2 (the paper's
        pressure ratios, for evanescent waves too); `energy_transmission` = \\|t\\|^2 Re(kz_after/rho_after) /
        Re(kz_before/rho_before) and `absorption` = 1 - reflectivity - energy_transmission, nan unless the incident
        wave propagates in a lossless `before`. With `estimate` also `r_error_estimate`, the error of r over the larger of \\|r\\|
        and 1 (the incident wave), `t_error_estimate`, that of t over \\|t\\|, and `error_estimate`, the larger of both. A kx
        that is k0 to the last bit counts as grazing incidence itself.

        With a solid behind `t` is that of p = -s_zz at the far face, `t_p` and `t_s` are the amplitudes there of
        rho w^2 phi and rho w^2 psi over the incident pressure, where u = grad phi + (-d psi/dz, d psi/dx) is the displacement of P and S
        waves, and `energy_transmission` is what both carry along z.

    Warns
    -----
    AccuracyWarning
        An estimated error is above 1e-6: near a guided mode or a sharp resonance the last bits of kx and of the layers decide.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
    >>> ds = bp.scattering(slab, 2500.0, angle=[0, 45, 85])
    >>> bool((ds.reflectivity + ds.energy_transmission <= 1).all())
    True
    """
    validate.instance(slab, Slab, "slab")
    f = validate.axis(frequency, "frequency", positive=True)
    hints.warn_of_air(slab, f)
    name, value = checks.single_option(kx=kx, kx_over_k0=kx_over_k0, angle=angle)
    flat = np.atleast_1d(f)
    axis, k = checks.lateral(name, value, lambda g: checks.k0(slab, g), flat, 100.0)
    if np.any(k):  # at the normal nothing shears
        hints.warn_of_solids(slab, f)
    in_solid = IN_SOLID if isinstance(slab.after, Solid) else ()
    names = ("r", "t", *in_solid, *WAVES, *(ERRORS if estimate else ()))
    variables = {n: np.empty(k.shape, complex if n in ("r", "t", *IN_SOLID) else float) for n in names}
    for rows, columns in _blocks(k.shape):
        answers = _answer(slab, flat[rows], k[rows, columns], name, estimate)
        for whole, part in zip(variables.values(), answers, strict=True):
            whole[rows, columns] = part
    dims, pick = checks.dims(frequency=f, **{name: axis})
    if estimate:
        checks.warn_of_plane_waves(variables["error_estimate"], flat, name, np.atleast_1d(axis))
    coords = checks.coords(frequency=f, **{name: axis})
    coords |= _derived_coords(slab, name, k, flat, dims, pick)
    return datasets.make({n: (dims, v[pick]) for n, v in variables.items()}, coords, "scattering", flat, slab=slab)


#: What is told of plane waves beside r and t, of those in a solid behind, and of errors.
IN_SOLID = ("t_p", "t_s")
WAVES = ("transmissivity", "reflectivity", "energy_transmission", "absorption")
ERRORS = ("r_error_estimate", "t_error_estimate", "error_estimate")


def _blocks(shape: tuple[int, int]) -> Iterator[tuple[slice, slice]]:
    """Parts of (frequency, kx) that are answered at a time: equal ones, so that none is too small to be fast."""
    many, long = shape
    parts = -(-long // memory.WAVES_AT_A_TIME)
    columns = -(-long // parts)
    rows = max(1, memory.WAVES_AT_A_TIME // columns)
    for i, j in itertools.product(range(0, many, rows), range(0, long, columns)):
        yield slice(i, i + rows), slice(j, j + columns)


def _answer(slab: Slab, frequency: np.ndarray, kx: np.ndarray, name: str, estimate: bool) -> tuple[np.ndarray, ...]:
    """r, t, with a solid behind `IN_SOLID`, then `WAVES` and with `estimate` `ERRORS`, at frequencies (F,) and kx (F, n): (F, n) each."""
    before, after = slab.before.at(frequency), behind_values([slab], frequency)
    omega = 2 * np.pi * frequency[:, None]
    res, errors = _solved(slab, after, frequency, kx, estimate)
    with np.errstate(over="ignore"):
        reflectivity, transmissivity = np.abs(res.r) ** 2, np.abs(res.t) ** 2
    if not (np.all(np.isfinite(reflectivity)) and np.all(np.isfinite(transmissivity))):
        raise ValueError(f"{name}: the response is not finite (a guided mode of a lossless slab, or density 0)")
    energies = _energies(res, reflectivity, kx, omega, (before, after))
    in_solid = () if res.waves is None else (res.waves[0], 1j * res.waves[1])
    return (res.r, res.t, *in_solid, transmissivity, reflectivity, *energies, *errors)


def _solved(
    slab: Slab, after: FluidValues | SolidHalfSpace, frequency: np.ndarray, kx: np.ndarray, estimate: bool
) -> tuple[response.Response | response.Checked, tuple[np.ndarray, ...]]:
    """r and t, and the variables that tell their errors."""
    omega = 2 * np.pi * frequency[:, None]
    values, before = slab_values(slab, frequency), slab.before.at(frequency)
    if not estimate:
        return response.solve(values, before, after, omega, kx), ()
    rows = [] if has_solids(slab) else [materials(cell, frequency) for cell, _ in slab.segments]
    res = response.solve_checked(values, rows, before, after, omega, kx)
    return res, (res.r_error, res.t_error, np.maximum(res.r_error, res.t_error))


def _energies(
    res: response.Response | response.Checked,
    reflectivity: np.ndarray,
    kx: np.ndarray,
    omega: np.ndarray,
    half_spaces: tuple[FluidValues, FluidValues | SolidHalfSpace],
) -> tuple[np.ndarray, np.ndarray]:
    """energy_transmission and absorption; nan where the incident wave carries no power of its own."""
    before, after = half_spaces
    front = [v[:, None] for v in before]
    y1 = outgoing_kz(kx, omega, *front) / front[0]
    flux = response.transmitted_flux(before, after, omega, kx, res)
    lossless = np.all([np.imag(v) == 0 for v in front], axis=0)
    carries = lossless & (np.imag(kx) == 0) & (np.abs(y1.imag) <= 1e-12 * np.abs(y1))
    share = np.divide(flux, y1.real, out=np.abs(res.t) ** 2, where=carries & (y1.real != 0))
    T = np.where(carries, share, np.nan)
    return T, 1 - reflectivity - T


def _derived_coords(slab: Slab, name: str, k: np.ndarray, frequency: np.ndarray, dims: tuple, pick: tuple) -> dict:
    """kx and kx_over_k0 (and the angle, when that was given) as coordinates on the axis."""
    derived: dict[str, Any] = {}
    if name != "kx":
        # on the same dimensions at every angle, 0 too, so that datasets of several angles fit together
        derived["kx"] = (dims, k[pick])
    k0 = slab.before.wavenumber(frequency).real
    if name != "kx_over_k0" and np.all(np.isfinite(k0) & (k0 > 0)):
        derived["kx_over_k0"] = (dims, (k / k0[:, None])[pick])
    return derived
