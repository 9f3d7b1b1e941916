"""Questions about plane waves: scattering by a slab, Bloch waves of a cell."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from .. import datasets, memory, modes, response, roots, validate
from ..conventions import outgoing_kz
from ..media import AIR, Cell, Fluid, Slab, layer_values, materials, slab_values
from ..scene import Scene, last_branch, parts_between_walls, scene
from . import checks


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

    Warns
    -----
    AccuracyWarning
        An estimated error is above 1e-6: near a guided mode or a sharp resonance the last bits of kx and of the layers decide.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came.
    """
    validate.instance(slab, Slab, "slab")
    f = validate.axis(frequency, "frequency", positive=True)
    name, value = checks.one_of(kx=kx, kx_over_k0=kx_over_k0, angle=angle)
    flat = np.atleast_1d(f)
    axis, k = checks.lateral(name, value, lambda g: checks.k0(slab, g), flat, 100.0)
    names = WAVES + (ERRORS if estimate else ())
    variables = {n: np.empty(k.shape, complex if n in ("r", "t") else float) for n in names}
    for rows, columns in _blocks(k.shape):
        answers = _answer(slab, flat[rows], k[rows, columns], name, estimate)
        for whole, part in zip(variables.values(), answers, strict=True):
            whole[rows, columns] = part
    dims, pick = checks.dims(frequency=f, **{name: axis})
    if estimate:
        _warn_of(variables["error_estimate"], flat, name, np.atleast_1d(axis))
    coords = checks.coords(frequency=f, **{name: axis})
    coords |= _other_coords(slab, name, k, flat, dims, pick)
    return datasets.make({n: (dims, v[pick]) for n, v in variables.items()}, coords, "scattering", flat, slab=slab)


#: What is told of plane waves, and of its errors.
WAVES = ("r", "t", "transmissivity", "reflectivity", "energy_transmission", "absorption")
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
    """The variables of `WAVES` at some frequencies and kx, and those of `ERRORS` if asked for, (F, n) each."""
    before, after = slab.before.at(frequency), slab.after.at(frequency)
    omega = 2 * np.pi * frequency[:, None]
    res, errors = _solved(slab, frequency, omega, kx, estimate)
    with np.errstate(over="ignore"):
        reflectivity, transmissivity = np.abs(res.r) ** 2, np.abs(res.t) ** 2
    if not (np.all(np.isfinite(reflectivity)) and np.all(np.isfinite(transmissivity))):
        raise ValueError(f"{name}: the response is not finite (a guided mode of a lossless slab, or density 0)")
    energies = _energies(reflectivity, transmissivity, kx, omega, before, after)
    return (res.r, res.t, transmissivity, reflectivity, *energies, *errors)


def _solved(
    slab: Slab, frequency: np.ndarray, omega: np.ndarray, kx: np.ndarray, estimate: bool
) -> tuple[response.Response | response.Checked, tuple[np.ndarray, ...]]:
    """r and t, and the variables that tell their errors."""
    values, before, after = slab_values(slab, frequency), slab.before.at(frequency), slab.after.at(frequency)
    if not estimate:
        return response.solve(values, before, after, omega, kx), ()
    rows = [materials(cell, frequency) for cell, _ in slab.segments]
    res = response.solve_checked(values, rows, before, after, omega, kx)
    return res, (res.r_error, res.t_error, np.maximum(res.r_error, res.t_error))


#: Relative errors of plane waves from which on a warning is due.
WORTH_A_WARNING = 1e-6


def _warn_of(error: np.ndarray, frequency: np.ndarray, name: str, axis: np.ndarray) -> None:
    """A warning with the largest of errors (F, n) and where it is, if it is large."""
    i, j = np.unravel_index(np.argmax(error), error.shape)
    if error[i, j] > WORTH_A_WARNING:
        warnings.warn(
            f"estimated error {error[i, j]:.1e} (relative) at {frequency[i]:.8g} Hz, {name} {axis[j]:.8g}, and above "
            f"{WORTH_A_WARNING:.0e} at {np.count_nonzero(error > WORTH_A_WARNING)} of {error.size} places: "
            "the last bits of the input decide there",
            checks.AccuracyWarning,
            stacklevel=3,
        )


def _energies(
    reflectivity: np.ndarray, transmissivity: np.ndarray, kx: np.ndarray, omega: np.ndarray, before: Any, after: Any
) -> tuple[np.ndarray, np.ndarray]:
    """energy_transmission and absorption; nan where the incident wave carries no power of its own."""
    front, behind = ([v[:, None] for v in fluid] for fluid in (before, after))
    kz1 = outgoing_kz(kx, omega, *front)
    alike = all(np.array_equal(a, b) for a, b in zip(front, behind, strict=True))
    y1 = kz1 / front[0]
    y2 = (y1 if alike else outgoing_kz(kx, omega, *behind) / behind[0]).real
    lossless = np.all([np.imag(v) == 0 for v in front], axis=0)
    carries = lossless & (np.imag(kx) == 0) & (np.abs(y1.imag) <= 1e-12 * np.abs(y1))
    ratio = np.divide(y2, y1.real, out=np.where(transmissivity == 0, 0.0, 1.0), where=carries & (y1.real != 0))
    T = np.where(carries, transmissivity * ratio, np.nan)
    return T, 1 - reflectivity - T


def _other_coords(slab: Slab, name: str, k: np.ndarray, frequency: np.ndarray, dims: tuple, pick: tuple) -> dict:
    """kx and kx_over_k0 (and the angle, when that was given) as coordinates on the axis."""
    others: dict[str, Any] = {}
    if name != "kx":
        fixed = frequency.size == 1 or np.array_equal(k, np.broadcast_to(k[:1], k.shape))
        others["kx"] = (dims, k[pick]) if not fixed else (dims[-1:] if pick[1] != 0 else (), k[0][pick[1]])
    k0 = slab.before.wavenumber(frequency).real
    if name != "kx_over_k0" and np.all(np.isfinite(k0) & (k0 > 0)):
        others["kx_over_k0"] = (dims, (k / k0[:, None])[pick])
    return others


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
    """
    validate.instance(cell, Cell, "cell")
    validate.instance(background, Fluid, "background")
    if cell.thickness < validate.LEAST:  # phases of thinner cells underflow, and kz is the phase over the thickness
        raise ValueError(f"cell: expected a thickness of at least {validate.LEAST:g} m, got {cell.thickness:g}")
    f = validate.axis(frequency, "frequency", positive=True)
    name, value = checks.one_of(kx=kx, kx_over_k0=kx_over_k0)
    flat = np.atleast_1d(f)
    axis, k = checks.lateral(name, value, lambda g: checks.forward_k0(background, g, "background"), flat, 350.0)
    if np.iscomplexobj(axis):
        raise ValueError(f"{name}: expected real values, got complex ones")
    layers = layer_values(cell, flat)
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
        _warn_of(error, flat, name, np.atleast_1d(axis))
        variables["error_estimate"] = error
    coords = checks.coords(frequency=f, **{name: axis})
    return datasets.make(
        {n: (dims, v[pick]) for n, v in variables.items()}, coords, "bloch", flat, cell=cell, background=background
    )


def guided_modes(slab: Slab, frequency: Any, kx_over_k0_max: float = 10.0, strip_over_k0: float = 0.5) -> xr.Dataset:
    """The modes that a slab guides: zeros of its dispersion function, found without a guess.

    The argument principle counts them in the strip k_edge < Re kx < kx_over_k0_max k0, \\|Im kx\\| < strip_over_k0 k0, where
    k_edge is the larger wavenumber of the two half-spaces; boxes are halved until Newton's method finds each one. -kx is a
    mode too.

    A layer of density exactly 0 is a soft wall, p = 0, on both sides: the answer has the modes of the part in front, for which
    k_edge is that of ``slab.before``, of the part behind, with that of ``slab.after``, and of the parts between two such
    layers, which are closed: k_edge is k0/1000, since their modes may have any Re kx. The cells of a repeated one each have theirs.

    Parameters
    ----------
    slab : Slab
    frequency : float or 1-D array, Hz
    kx_over_k0_max, strip_over_k0 : float
        The strip, over the wavenumber of ``slab.before``.

    Returns
    -------
    Dataset
        On (frequency, mode), by growing Re kx: complex `kx` [rad/m] and `kx_over_k0`; `direction` +1 where energy flows along
        +Re kx (forward), -1 against it (backward, or a complex mode of a lossless slab that grows along +x); `residual`, the
        last step of Newton's method over kx; `error_estimate`, how far a mode moves, over kx, with the last bits of the
        layers (modes that are nearly one feel their square root). nan and 0 where a frequency has fewer modes than another;
        `count`, on (frequency), is how many the argument principle counts.

    Warns
    -----
    AccuracyWarning
        An estimated error is above 1e-6.

    Raises
    ------
    ValueError
        Wrong arguments, or modes that were counted and not found.
    """
    validate.instance(slab, Slab, "slab")
    f = validate.axis(frequency, "frequency", positive=True)
    highest = validate.as_number(kx_over_k0_max, "kx_over_k0_max", positive=True)
    strip = validate.as_number(strip_over_k0, "strip_over_k0", positive=True)
    flat = np.atleast_1d(f)
    found = [_modes_at(slab, float(g), highest, strip) for g in flat]
    most = max(len(rows) for rows, _ in found)
    kx = np.full((flat.size, most), complex(np.nan, np.nan))
    direction, (residual, error) = np.zeros(kx.shape, int), np.full((2, *kx.shape), np.nan)
    for i, (rows, _) in enumerate(found):
        for j, mode in enumerate(rows):
            kx[i, j], direction[i, j], residual[i, j], error[i, j] = mode
    if most:
        _warn_of(np.nan_to_num(error, nan=0.0), flat, "mode", np.arange(most))
    k0 = slab.before.wavenumber(flat).real
    dims, pick = (("frequency",), ...) if f.ndim else ((), 0)
    both = (*dims, "mode")
    variables = {
        "kx": (both, kx[pick]),
        "kx_over_k0": (both, (kx / k0[:, None])[pick]),
        "direction": (both, direction[pick]),
        "residual": (both, residual[pick]),
        "error_estimate": (both, error[pick]),
        "count": (dims, np.array([total for _, total in found])[pick]),
    }
    coords = checks.coords(frequency=f) | {"mode": (("mode",), np.arange(most))}
    return datasets.make(
        variables, coords, "guided_modes", flat, slab=slab, kx_over_k0_max=highest, strip_over_k0=strip
    )


#: Modes of a part between two walls are searched for from this Re kx on, over k0: those that decay along x lie at Re kx = 0.
CLOSED = 1e-3


def _modes_at(slab: Slab, frequency: float, highest: float, strip: float) -> tuple[list[modes.Mode], int]:
    """The modes of all parts of a slab at one frequency, by Re kx, and how many the argument principle counts."""
    found, total = [], 0
    for part, times in parts_between_walls(scene(slab, frequency)):
        own, count = _modes_of(part, frequency, highest, strip)
        memory.check("slab", 400.0 * (total + times * count), "the modes of all its parts", "take fewer periods")
        found += times * own
        total += times * count
    return sorted(found, key=lambda mode: mode.kx.real), total


def _modes_of(s: Scene, frequency: float, highest: float, strip: float) -> tuple[list[modes.Mode], int]:
    edge = last_branch(s) * (1 + modes.BESIDE) if s.branches else CLOSED * s.k0
    if highest * s.k0 <= edge:
        raise ValueError(
            f"kx_over_k0_max: expected more than {edge / s.k0:.6g}, where guided modes begin, got {highest}"
        )
    most = memory.most_values()
    try:
        found, total = modes.find_modes(s, roots.Box(edge, highest * s.k0, -strip * s.k0, strip * s.k0), most)
    except roots.TooManyValues:
        raise ValueError(
            f"kx_over_k0_max: expected a strip that {most:.2g} values of the dispersion function search through, got "
            f"{highest:g} by {strip:g} k0; search a part of it, by kx_over_k0_max and strip_over_k0"
        ) from None
    except roots.TooManyModes:
        raise ValueError(
            f"slab: two of its modes at {frequency} Hz are one to rounding, and run both ways; add loss"
        ) from None
    except roots.UncertainCount as counts:
        raise ValueError(
            f"kx_over_k0_max: expected a strip in which modes can be counted, got {counts} modes at {frequency} Hz; "
            "one may lie on the edge of the strip: change it a little"
        ) from None
    if len(found) != total:
        raise ValueError(
            f"kx_over_k0_max: {total} modes were counted at {frequency} Hz and {len(found)} found; "
            "one may lie on the edge of the strip: change it a little"
        )
    return found, total
