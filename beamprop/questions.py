"""The questions a user asks: objects in, labelled datasets out. Public arguments are checked here."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import xarray as xr

from . import datasets, propagate, response, sections, widths
from .beam import Beam, sin_degrees
from .conventions import outgoing_kz
from .media import AIR, Cell, Fluid, Slab, as_number, layer_values, slab_values
from .scene import Scene, scene, scenes

#: Wraps the items of a loop, to watch it.
Progress = Callable[[Iterable[Any]], Iterable[Any]]


class AccuracyWarning(UserWarning):
    """A field whose estimated error is above the asked rtol."""


# --- checks -----------------------------------------------------------------------------------------------


def _axis(value: Any, name: str, *, kind: type = float, positive: bool = False) -> np.ndarray:
    """A scalar or 1-D array of finite numbers, as an array; ValueErrors name the argument."""
    try:
        array = np.asarray(value)
        array = array.astype(kind) if kind is complex or not np.iscomplexobj(array) else array
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected a number or a 1-D array of numbers, got {value!r}") from None
    if np.iscomplexobj(array) and kind is not complex:
        raise ValueError(f"{name}: expected real numbers, got complex ones")
    if array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name}: expected a number or a 1-D array of at least one, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: expected finite values, got {array[~np.isfinite(array)].flat[0]}")
    if positive and np.any(array <= 0):
        raise ValueError(f"{name}: expected values above zero, got {array.min()}")
    return array


def _instance(value: Any, cls: Any, name: str) -> None:
    if not isinstance(value, cls):
        raise ValueError(f"{name}: expected a {cls.__name__}, got {value!r}")


def _angles(angle: Any, beam: Beam) -> np.ndarray:
    angles = _axis(beam.angle if angle is None else angle, "angle")
    if np.any(np.abs(angles) >= 90):
        raise ValueError(f"angle: expected degrees from the normal, between -90 and 90, got {angles.flat[0]}")
    return angles


def _rtol(rtol: Any) -> float:
    value = as_number(rtol, "rtol", positive=True)
    if not 1e-12 <= value <= 0.1:
        raise ValueError(f"rtol: expected a value from 1e-12 to 0.1, got {rtol!r}")
    return value


def _k0(slab: Slab, frequency: np.ndarray) -> np.ndarray:
    return _forward_k0(slab.before, frequency, "before")


def _forward_k0(fluid: Fluid, frequency: np.ndarray, name: str) -> np.ndarray:
    k0 = fluid.wavenumber(frequency)
    if not np.all(np.isfinite(k0) & (k0.real > 0)):
        raise ValueError(f"{name}: kx_over_k0 and angle need a fluid that carries forward waves, got {fluid!r}; use kx")
    return k0.real


def _one_of(**options: Any) -> tuple[str, Any]:
    given = {name: value for name, value in options.items() if value is not None}
    if len(given) != 1:
        raise ValueError(f"expected exactly one of {', '.join(options)}, got {', '.join(given) or 'none'}")
    return next(iter(given.items()))


def _lateral(name: str, value: Any, k0: Any, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The asked axis and kx on (frequency, axis); k0 is a function that is called only where it is needed."""
    axis = _axis(value, name, kind=float if name == "angle" else complex)
    if not np.any(axis.imag):
        axis = axis.real
    flat = np.atleast_1d(axis)
    if name == "kx":
        return axis, np.broadcast_to(flat, (frequency.size, flat.size))
    if name == "angle":
        if np.any(np.abs(flat) > 90):
            raise ValueError(f"angle: expected degrees from -90 to 90, got {flat[np.abs(flat) > 90][0]}")
        flat = sin_degrees(flat)
    return axis, np.atleast_1d(k0(frequency))[:, None] * flat


def _dims(**axes: np.ndarray) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """Names of the axes that are arrays, and the index that drops the scalar ones."""
    return tuple(n for n, a in axes.items() if a.ndim), tuple(slice(None) if a.ndim else 0 for a in axes.values())


def _coords(**axes: np.ndarray) -> dict[str, tuple[tuple[str, ...], Any]]:
    return {n: ((n,) if a.ndim else (), a) for n, a in axes.items()}


# --- plane waves ------------------------------------------------------------------------------------------


def scattering(slab: Slab, frequency: Any, *, kx: Any = None, kx_over_k0: Any = None, angle: Any = None) -> xr.Dataset:
    """Exact reflection and transmission of plane waves by a slab.

    Parameters
    ----------
    slab : Slab
    frequency : float or 1-D array, Hz
    kx, kx_over_k0, angle : float or 1-D array
        One of: lateral wavenumber [rad/m] (may be complex: continued as a small loss would, see
        `conventions.outgoing_kz`), the same over that of ``slab.before``, or angle of incidence [degree].

    Returns
    -------
    Dataset
        On (frequency, the one given): complex `r`, `t`; `transmissivity` = \\|t\\|^2 and `reflectivity` = \\|r\\|^2 (the paper's
        pressure ratios, for evanescent waves too); `energy_transmission` = \\|t\\|^2 Re(kz_after/rho_after) /
        Re(kz_before/rho_before) and `absorption` = 1 - reflectivity - energy_transmission, nan unless the incident
        wave propagates in a lossless `before`.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came.
    """
    _instance(slab, Slab, "slab")
    f = _axis(frequency, "frequency", positive=True)
    name, value = _one_of(kx=kx, kx_over_k0=kx_over_k0, angle=angle)
    flat = np.atleast_1d(f)
    axis, k = _lateral(name, value, lambda g: _k0(slab, g), flat)
    before, after = slab.before.at(flat), slab.after.at(flat)
    omega = 2 * np.pi * flat[:, None]
    res = response.solve(slab_values(slab, flat), before, after, omega, k)
    if not (np.all(np.isfinite(res.r)) and np.all(np.isfinite(res.t))):
        raise ValueError(f"{name}: the response is not finite (a guided mode of a lossless slab, or density 0)")
    energy, absorption = _energies(res.r, res.t, k, omega, before, after)
    dims, pick = _dims(frequency=f, **{name: axis})
    variables = {
        "r": res.r,
        "t": res.t,
        "transmissivity": np.abs(res.t) ** 2,
        "reflectivity": np.abs(res.r) ** 2,
        "energy_transmission": energy,
        "absorption": absorption,
    }
    coords = _coords(frequency=f, **{name: axis})
    coords |= _other_coords(slab, name, k, flat, dims, pick)
    return datasets.make({n: (dims, v[pick]) for n, v in variables.items()}, coords, "scattering", flat, slab=slab)


def _energies(r: np.ndarray, t: np.ndarray, kx: np.ndarray, omega: np.ndarray, before: Any, after: Any) -> tuple:
    """energy_transmission and absorption; nan where the incident wave carries no power of its own."""
    front, behind = ([v[:, None] for v in fluid] for fluid in (before, after))
    y1 = outgoing_kz(kx, omega, *front) / front[0]
    y2 = (outgoing_kz(kx, omega, *behind) / behind[0]).real
    lossless = np.all([np.imag(v) == 0 for v in front], axis=0)
    carries = lossless & (np.imag(kx) == 0) & (np.abs(y1.imag) <= 1e-12 * np.abs(y1))
    ratio = np.divide(y2, y1.real, out=np.where(t == 0, 0.0, 1.0), where=carries & (y1.real != 0))
    T = np.where(carries, np.abs(t) ** 2 * ratio, np.nan)
    return T, 1 - np.abs(r) ** 2 - T


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


def bloch(cell: Cell, frequency: Any, *, kx: Any = None, kx_over_k0: Any = None, background: Fluid = AIR) -> xr.Dataset:
    """Bloch wavenumber of an infinite stack of a cell: its equifrequency contour.

    Parameters
    ----------
    cell : Cell
    frequency : float or 1-D array, Hz
    kx, kx_over_k0 : float or 1-D array, real
        One of: lateral wavenumber [rad/m], or the same over the wavenumber k0 of `background`.
    background : Fluid
        Whose wavenumber is k0.

    Returns
    -------
    Dataset
        On (frequency, the one given): complex `kz` [rad/m] and `kz_over_k0`. Im(kz) >= 0: the wave that decays, or
        where none does carries energy, along +z; the real part is continuous in kx, in the first zone at the kx
        nearest to 0. -kz belongs to the contour too.

    Raises
    ------
    ValueError
        Also for a cell with a layer of isotropic density 0 and kx other than 0: no finite limit.
    """
    _instance(cell, Cell, "cell")
    _instance(background, Fluid, "background")
    f = _axis(frequency, "frequency", positive=True)
    name, value = _one_of(kx=kx, kx_over_k0=kx_over_k0)
    flat = np.atleast_1d(f)
    axis, k = _lateral(name, value, lambda g: _forward_k0(background, g, "background"), flat)
    if np.iscomplexobj(axis):
        raise ValueError(f"{name}: expected real values, got complex ones")
    layers = layer_values(cell, flat)
    if np.any(layers.vanishing) and np.any(k != 0):
        raise ValueError(
            "cell: a layer of density 0 blocks every kx other than 0, its Bloch wavenumber has no finite limit"
        )
    kz = response.bloch_wavenumber(layers, 2 * np.pi * flat[:, None], k.astype(complex))
    k0 = _forward_k0(background, flat, "background")
    dims, pick = _dims(frequency=f, **{name: axis})
    variables = {"kz": kz, "kz_over_k0": kz / k0[:, None]}
    coords = _coords(frequency=f, **{name: axis})
    return datasets.make(
        {n: (dims, v[pick]) for n, v in variables.items()}, coords, "bloch", flat, cell=cell, background=background
    )


# --- beams ------------------------------------------------------------------------------------------------


def field(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    x: Any,
    z: Any,
    angle: Any = None,
    boundary: str = "open",
    period: float | None = None,
    rtol: float = 1e-8,
    progress: Progress = iter,
) -> xr.Dataset:
    """Total pressure of a beam in front of, inside and behind a slab.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
    frequency : float or 1-D array, Hz
    x, z : float or 1-D array, m
        Any positions; z not in front of the launch plane ``beam.z0``.
    angle : float or 1-D array, degree, optional
        Overrides the beam's. All angles share one response.
    boundary : "open" or "periodic"
        "open": one beam in open space, the limit of vanishing absorption. "periodic": an array of beams, `period`
        apart: the plain sum over real kx, which is what a calculation with periodic sides answers.
    period : float, m
        For "periodic"; the length of the x grid (n dx) where it is even and no period is given.
    rtol : float
        Asked error of the open field over the largest |p| of each plane.
    progress : function
        Wraps the list of frequencies that is worked through (``tqdm.tqdm``, say).

    Returns
    -------
    Dataset
        `p` on (frequency, angle, z, x), scalars as scalar coordinates, and `error_estimate` on (frequency, angle), of
        open fields: the largest difference between two contours of integration that share no error term.

    Warns
    -----
    AccuracyWarning
        The estimate is above rtol.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came.
    """
    _instance(slab, Slab, "slab")
    _instance(beam, Beam, "beam")
    f, xs, zs = _axis(frequency, "frequency", positive=True), _axis(x, "x"), _axis(z, "z")
    angles, rtol = _angles(angle, beam), _rtol(rtol)
    if boundary not in ("open", "periodic"):
        raise ValueError(f"boundary: expected 'open' or 'periodic', got {boundary!r}")
    if np.min(zs) < beam.z0:
        raise ValueError(f"z: expected positions not in front of the launch plane z0 = {beam.z0}, got {np.min(zs)}")
    beams = [beam.at_angle(float(a)) for a in np.atleast_1d(angles)]
    flat, x1, z1 = (np.atleast_1d(v) for v in (f, xs, zs))
    if boundary == "periodic":
        period = _period(period, x1, beam, slab, flat)
    elif period is not None:
        raise ValueError(f"period: expected none with boundary='open', got {period!r}")
    p = np.empty((flat.size, len(beams), z1.size, x1.size), complex)
    errors = np.full(p.shape[:2], np.nan)
    for i, frequency_i in enumerate(progress(flat)):
        s = scene(slab, float(frequency_i))
        _field_at(s, beams, x1, z1, period, rtol, p[i], errors[i])
    _announce(p, errors, rtol)
    axes = {"frequency": f, "angle": angles, "z": zs, "x": xs}
    dims, pick = _dims(**axes)
    few = tuple(d for d in dims if d in ("frequency", "angle"))
    variables: dict[str, Any] = {"p": (dims, p[pick])}
    if boundary == "open":
        variables["error_estimate"] = (few, errors[pick[:2]])
    ds = datasets.make(
        variables, _coords(**axes), "field", flat, slab=slab, beam=beam, boundary=boundary, period=period, rtol=rtol
    )
    ds.attrs |= {"boundary": boundary, "slab_thickness": slab.thickness}
    if period is not None:
        ds.attrs["period"] = period
    return ds


def _field_at(
    s: Scene,
    beams: list[Beam],
    x: np.ndarray,
    z: np.ndarray,
    period: float | None,
    rtol: float,
    out: np.ndarray,
    errors: np.ndarray,
) -> None:
    """Fill out (angle, z, x) and errors (angle) at one frequency, in blocks of planes of bounded memory."""
    transfer = propagate.through(s, beams[0].z0)
    if period is None:
        solution = propagate.choose_line(s, beams, transfer, x, z, rtol)
        errors[:] = solution.error
    else:
        solution = propagate.periodic_solution(s, beams, x, period)
    block = max(16, 20_000_000 // (16 * max(1, solution.line.k.size)))
    for start in range(0, z.size, block):
        rows = slice(start, start + block)
        h = transfer(solution.line.k, z[rows])
        for j, beam in enumerate(beams):
            out[j, rows] = propagate.beam_sum(s, beam, solution, h, x)


def _period(period: Any, x: np.ndarray, beam: Beam, slab: Slab, frequency: np.ndarray) -> float:
    """The period of a periodic boundary; refused where neighbouring beams overlap."""
    if period is None:
        dx = propagate.even_spacing(x)
        if not dx:
            raise ValueError("period: expected a length [m] with boundary='periodic' and an uneven x, got None")
        period = dx * x.size
    value = as_number(period, "period", positive=True)
    k0 = float(_k0(slab, frequency)[0])
    across = beam.profile(beam.centre + value / 2 * np.linspace(-1, 1, 2001), k0)
    seam = float(max(abs(across[0]), abs(across[-1])) / np.abs(across).max())
    if seam > 1e-2:
        raise ValueError(
            f"period: expected a grid wide enough for the beam, got {value:.6g} m, at whose ends the launched |p| is "
            f"still {seam:.2g} of its largest"
        )
    return value


def _announce(p: np.ndarray, errors: np.ndarray, rtol: float) -> None:
    """Nothing that is not finite leaves, and nothing above rtol leaves without a word."""
    if not np.all(np.isfinite(p)):
        raise ValueError(
            "the field is not finite: a plane wave of the sum meets a guided mode of a lossless slab, or overflow"
        )
    worst = np.max(errors, initial=0.0, where=np.isfinite(errors))
    if worst > rtol:
        warnings.warn(
            f"estimated error {worst:.1e} of the largest |p|, above the asked rtol {rtol:.1e}",
            AccuracyWarning,
            stacklevel=3,
        )


def beam_width(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-8,
    air_distance: float | None = None,
    progress: Progress = iter,
) -> xr.Dataset:
    """Widths of a beam: launched, at the near face, behind the slab, and after a distance without the slab.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
    frequency : float or 1-D array, Hz
    angle : float or 1-D array, degree, optional
        Overrides the beam's.
    rtol : float
        Asked error of the fields over their largest |p|.
    air_distance : float, m, optional
        Of `fwhm_air`, in the fluid in front; two of its wavelengths at each frequency by default.
    progress : function
        Wraps the list of blocks that is worked through (``tqdm.tqdm``, say).

    Returns
    -------
    Dataset
        On (frequency, angle): `fwhm_launch`, `fwhm_in` (near face, incident beam alone), `fwhm_out` (far face), `fwhm_air`
        [m]; `peak_out` [Pa] and `centroid_out` [m] at the far face. Widths are of |p|, or of |p|^2 for a beam
        whose `width_of` is "intensity": between the two places nearest to the peak where it is reached. The centroid is
        taken over the window recorded as attribute. nan, with a warning, where the half level is not met.
    """
    _instance(slab, Slab, "slab")
    _instance(beam, Beam, "beam")
    f = _axis(frequency, "frequency", positive=True)
    angles, rtol = _angles(angle, beam), _rtol(rtol)
    if air_distance is not None:
        air_distance = as_number(air_distance, "air_distance", positive=True)
    flat, flat_angles = np.atleast_1d(f), np.atleast_1d(angles)
    names = sections.Row._fields
    table = {name: np.empty((flat.size, flat_angles.size)) for name in names}
    work = [
        (rows, j)
        for rows in np.array_split(np.arange(flat.size), -(-flat.size // 128))
        for j in range(flat_angles.size)
    ]
    for rows, j in progress(work):
        s = scenes(slab, flat[rows])
        found = sections.rows(s, beam.at_angle(float(flat_angles[j])), rtol, air_distance)
        for name, values in found._asdict().items():
            table[name][rows, j] = values
    missing = [name for name in names if np.any(np.isnan(table[name]))]
    if missing:
        warnings.warn(f"no half level inside the window: nan in {', '.join(missing)}", RuntimeWarning, stacklevel=2)
    dims, pick = _dims(frequency=f, angle=angles)
    return datasets.make(
        {n: (dims, v[pick]) for n, v in table.items()},
        _coords(frequency=f, angle=angles),
        "beam_width",
        flat,
        slab=slab,
        beam=beam,
        rtol=rtol,
        air_distance=air_distance,
    )


def fwhm(profile: xr.DataArray, dim: str = "x", width_of: str = "pressure") -> xr.DataArray:
    """Full width at half maximum of a profile along a dimension.

    Parameters
    ----------
    profile : DataArray
        Complex pressure (or \\|p\\|).
    dim : str
    width_of : "pressure" or "intensity"
        Width of \\|p\\|, or of \\|p\\|^2.

    Returns
    -------
    DataArray
        In the units of `dim`, located on a cubic spline of the samples; nan with a warning where the half level is not
        reached inside the window.
    """
    if not isinstance(profile, xr.DataArray):
        raise ValueError(f"profile: expected a DataArray, got {type(profile).__name__}")
    if dim not in profile.dims:
        raise ValueError(f"dim: expected one of {', '.join(map(str, profile.dims))}, got {dim!r}")
    if width_of not in widths.HALF_LEVEL:
        raise ValueError(f"width_of: expected 'pressure' or 'intensity', got {width_of!r}")
    if profile.sizes[dim] < 4:
        raise ValueError(f"profile: expected at least 4 samples along {dim}, got {profile.sizes[dim]}")
    ordered = profile.sortby(dim)
    x = np.asarray(ordered[dim], float)
    if not np.all(np.isfinite(ordered)):
        raise ValueError("profile: expected finite values, got NaN or infinity")

    def one(p: np.ndarray) -> float:
        return widths.full_width(x, p, widths.HALF_LEVEL[width_of]).width

    out = xr.apply_ufunc(one, ordered, input_core_dims=[[dim]], vectorize=True, output_dtypes=[float])
    if np.any(np.isnan(out)):
        warnings.warn("fwhm: the half level is not reached inside the window: nan", RuntimeWarning, stacklevel=2)
    out.attrs = {"units": profile[dim].attrs.get("units", "m"), "long_name": "full width at half maximum"}
    return out.rename("fwhm")
