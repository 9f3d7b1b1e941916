"""Two fields of the same problem, measured against each other: ours, finite elements, or a file's.

b is brought onto a's points in the region that both cover. With weights w (the grid's cells) and sums over z and x,

    relative_l2 = sqrt(sum w |a - b|^2 / sum w |a|^2),    scale = sum w conj(b) a / sum w |b|^2,

and the scale is the complex factor that brings b nearest to a.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..conventions import LABELS, label
from ..io import datasets
from ..io.comsol import PRESSURE_UNITS, plain_unit
from ..profiles.fwhm import full_width

_TOLERANCE = 1e-9  # positions nearer than this share of the span are the same
_ROUNDED = 1e-4  # frequencies and angles of files are rounded to five digits
_NOTICEABLE = 1e-3  # misfits below this are no question of a convention
_NAMES = {
    "relative_l2": ("1", "relative L2 error"),
    "relative_l2_by_z": ("1", "relative L2 error at each depth"),
    "relative_l2_scaled": ("1", "relative L2 error after the best complex scale factor"),
    "scale": ("1", "complex factor that brings b nearest to a"),
    "largest_error": ("1", "largest |a - b| over the largest |a|"),
    "largest_error_x": ("m", "lateral position of the largest error"),
    "largest_error_z": ("m", "depth of the largest error"),
    "fwhm_a": ("m", "full width at half maximum of |a|"),
    "fwhm_b": ("m", "full width at half maximum of |b|"),
    "fwhm_difference": ("m", "full width of |b| less that of |a|"),
    "peak_a": ("Pa", "largest |a| at each depth"),
    "peak_b": ("Pa", "largest |b| at each depth"),
    "peak_difference": ("Pa", "largest |b| less largest |a|"),
    "p_a": ("Pa", "complex sound pressure of a"),
    "p_b": ("Pa", "complex sound pressure of b on a's grid"),
    "error": ("Pa", "|a - b|"),
    "interpolation_error": ("1", "estimated share of the error that comes from interpolating b"),
    "wraparound": ("1", "relative L2 difference that the period makes"),
}
_FIELDS = ("p_a", "p_b", "error")
_BY_Z = tuple(n for n in _NAMES if n.startswith(("fwhm", "peak", "relative_l2_by")))


def compare(
    a: xr.Dataset, b: xr.Dataset, rescale: bool = False, *, open_reference: xr.Dataset | None = None
) -> xr.Dataset:
    """Measure field b against field a.

    Parameters
    ----------
    a, b : Dataset
        With the pressure `p` on (z, x), from `beamprop.field`, `fem.field` or `read_comsol`; further dims such as
        frequency and angle must be the same in both.
    rescale : bool
        Multiply b by the best complex scale factor first, for fields that were launched with different amplitudes.
    open_reference : Dataset, optional
        The same field in open space. Its difference to the periodic one of a and b (a, if both are) is reported as
        `wraparound`: that share of the error comes from the period, and not from either code.

    Returns
    -------
    Dataset
        By frequency and angle, if there are any: `relative_l2`, `relative_l2_scaled` and `scale`, `largest_error` (over
        the largest |a|) and where it is. By z too: `relative_l2_by_z` (over |a| at that z), `fwhm_a`, `fwhm_b` and
        `fwhm_difference` (NaN where the half level is not reached), `peak_a`, `peak_b` and `peak_difference`. The
        fields `p_a`, `p_b` and `error` = |a - b| on a's points in the region that both cover, in a's unit. The
        attribute `conjugate_fits_better` is 1 where conj(b) is much nearer to a than b.

    Raises
    ------
    ValueError
        No `p`, no common region, another frequency or angle, units that cannot be converted.

    Warns
    -----
    UserWarning
        Different boundaries or periods, b that looks like exp(+i w t), points without a value, a field that b's points
        do not resolve.

    Notes
    -----
    Between b's points, cubic splines of the complex field: b must resolve it, and `interpolation_error` estimates how
    well it does. Inside a slab of thin layers the field changes from layer to layer, so there both need the same z.
    Points that are NaN in either field are left out.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> x = np.linspace(-0.5, 0.5, 201)
    >>> one = bp.field(slab, beam, 2500.0, x, slab.thickness * np.array([0, 1]))
    >>> effective = bp.field(bp.lmmd_emt_slab(slab), beam, 2500.0, x, slab.thickness * np.array([0, 1]))
    >>> round(float(bp.compare(one, effective).relative_l2), 3)
    0.056
    """
    validate.flag(rescale, "rescale")
    with np.errstate(over="ignore", invalid="ignore"):  # a ratio of |p| that no double holds is infinite
        return _compared(a, b, bool(rescale), open_reference)


def _compared(a: xr.Dataset, b: xr.Dataset, rescale: bool, open_reference: xr.Dataset | None) -> xr.Dataset:
    p_a = _field(a, "a")
    unit = p_a.attrs.get("units")
    p_b = _match(_field(b, "b"), p_a, unit, "b")
    z_b = p_b["z"].values
    p_a, p_b, shares = _on_common_grid(p_a, p_b, "b")
    between = np.hypot(shares["z"], shares["x"])
    w = _weights(p_a, p_b)
    filled_a, filled_b = (np.where(w > 0, p.values, 0) for p in (p_a, p_b))
    scale = _scale(filled_a, filled_b, w)
    misfit = _scaled_misfit(filled_a, filled_b, w)
    out: dict[str, Any] = {"scale": scale, "relative_l2_scaled": misfit, "interpolation_error": between}
    conjugate = _warn_of_conjugate(filled_a, filled_b, w)
    if open_reference is not None:
        out["wraparound"] = _wraparound(a, b, open_reference)
    _warn_of_boundaries(a, b, out.get("wraparound"))
    if rescale:
        p_b, filled_b = p_b * scale[..., None, None], filled_b * scale[..., None, None]
    out |= _errors(filled_a, filled_b, w, p_a.x.values, p_a.z.values) | _measures(p_a, p_b)
    if not (shares["z"] and _warn_of_layers(a, b, z_b, p_a["z"].values)):
        _warn_of_interpolation(between, out["relative_l2"])
    out |= {"p_a": p_a.values, "p_b": p_b.values, "error": np.abs(p_a.values - p_b.values)}
    return _dataset(out, p_a, unit, a, b, rescale=rescale, conjugate_fits_better=int(conjugate))


# --- the same problem on the same points ----------------------------------------------------------------------------


def _field(ds: Any, name: str) -> xr.DataArray:
    """The pressure on (…, z, x), both rising; dims of one entry become scalar coordinates, z and x never."""
    if not isinstance(ds, xr.Dataset) or "p" not in ds:
        got = ", ".join(map(str, ds.data_vars)) if isinstance(ds, xr.Dataset) else type(ds).__name__
        raise ValueError(f"{name}: expected a dataset with the pressure p, got {got}")
    p = ds["p"]
    if "node" in p.dims:
        raise ValueError(f"{name}: expected p on (z, x), got p on scattered nodes: bring it onto a grid with to_grid")
    for axis in ("z", "x"):
        if axis not in p.coords:
            raise ValueError(f"{name}: expected p on (z, x), got no {axis} among {', '.join(map(str, p.coords))}")
        if axis not in p.dims:
            p = p.expand_dims(axis)
        if not np.all(np.isfinite(p[axis])) or p.get_index(axis).has_duplicates:
            raise ValueError(f"{name}: expected finite and distinct positions {axis}, got others")
        p = p.sortby(axis)
    p = p.squeeze([d for d in p.dims if d not in ("z", "x") and p.sizes[d] == 1])
    return p.transpose(..., "z", "x")


def _match(p: xr.DataArray, to: xr.DataArray, unit: str | None, name: str) -> xr.DataArray:
    """p in the unit of `to`, with its further dims in the same order; refused where they are of different problems."""
    found = p.attrs.get("units")
    if found != unit:
        if {plain_unit(str(found)), plain_unit(str(unit))} - set(PRESSURE_UNITS):
            raise ValueError(f"{name}: expected p in {unit!r} as a has it, or in a unit of pressure, got {found!r}")
        p = p * (PRESSURE_UNITS[plain_unit(str(found))] / PRESSURE_UNITS[plain_unit(str(unit))])
    lead = [d for d in to.dims if d not in ("z", "x")]
    for dim in {*lead, *p.dims} - {"z", "x"}:
        if (dim in lead) != (dim in p.dims):
            raise ValueError(f"{name}: expected the dims {to.dims} as a has them, got {p.dims}: select one {dim}")
    for key in {*lead, "frequency", "angle"} & set(p.coords) & set(to.coords):
        _check_same(p, to, key, name)
        if key in lead:
            p = p.assign_coords({key: to[key]})
    drop = [c for c in p.coords if c not in to.coords]
    return p.drop_vars(drop).transpose(*lead, "z", "x")


def _check_same(p: xr.DataArray, to: xr.DataArray, key: Any, name: str) -> None:
    ours, theirs = to[key].values, p[key].values
    near = _ROUNDED * (np.abs(ours).max(initial=0.0) if ours.dtype.kind in "fiuc" else 0.0)
    if ours.shape != theirs.shape or not np.all(ours == theirs if near == 0 else np.abs(ours - theirs) <= near):
        raise ValueError(f"{name}: expected the same {key} as a, {_short(ours)}, got {_short(theirs)}")


def _short(values: np.ndarray) -> str:
    return np.array2string(values, threshold=6, edgeitems=2, precision=6)


def _on_common_grid(
    to: xr.DataArray, p: xr.DataArray, name: str
) -> tuple[xr.DataArray, xr.DataArray, dict[str, float]]:
    """Both on those of `to`'s points that p's grid covers, and each axis' estimated relative error of interpolation."""
    shares = {}
    for axis in ("z", "x"):
        new, old = to[axis].values, p[axis].values
        near = _TOLERANCE * max(np.ptp(new), np.ptp(old), 1e-6 * np.abs(new).max())
        inside = (new >= old[0] - near) & (new <= old[-1] + near)
        if not np.any(inside):
            raise ValueError(
                f"{name}: expected {axis} that covers points of a, {new[0]:g} to {new[-1]:g} m, "
                f"got {old[0]:g} to {old[-1]:g} m"
            )
        to = to.isel({axis: inside})
        values = np.moveaxis(p.values, p.dims.index(axis), -1)
        new_values, shares[axis] = _resample(old, values, new[inside], near)
        moved = np.moveaxis(new_values, -1, p.dims.index(axis))
        p = xr.DataArray(moved, p.drop_vars(axis).coords, p.dims).assign_coords({axis: to[axis]})
    return to, p, shares


def _resample(old: np.ndarray, values: np.ndarray, new: np.ndarray, near: float) -> tuple[np.ndarray, float]:
    """Values along the last axis at new positions: picked where they are the old ones, else by cubic splines."""
    nearest = np.abs(old[:, None] - new[None, :]).argmin(axis=0) if old.size * new.size < 1e7 else _nearest(old, new)
    if np.all(np.abs(old[nearest] - new) <= near):
        return values[..., nearest], 0.0
    from scipy.interpolate import CubicSpline

    if np.all(np.isfinite(values)):
        return CubicSpline(old, values, axis=-1)(new), _interpolation_error(old, values, new)
    moved = np.apply_along_axis(lambda line: _through_gaps(old, line, new), -1, values)
    whole = np.isfinite(values).all(-1)
    return moved, _interpolation_error(old, values[whole], new) if np.any(whole) else 0.0


def _interpolation_error(old: np.ndarray, values: np.ndarray, new: np.ndarray) -> float:
    """Relative L2 error of splines through the samples, from those through every second and every fourth of them.

    The error falls from the fourth to the second as it falls from the second to all: 16 times for smooth fields.
    Where the second still miss the field, the samples may not resolve it either, and no fall is counted on.
    """
    second, fourth = (_misfit_of_every(stride, old, values, new) for stride in (2, 4))
    return second / float(np.clip(fourth / second, 1, 16)) if 0 < second < 0.1 else second


def _misfit_of_every(stride: int, old: np.ndarray, values: np.ndarray, new: np.ndarray) -> float:
    """Relative L2 error at the midpoints of a spline through every `stride`-th sample, where the new positions lie."""
    from scipy.interpolate import CubicSpline

    half = stride // 2
    middle = np.arange(half, old.size - half, stride)
    middle = middle[(old[middle + half] >= new[0]) & (old[middle - half] <= new[-1])]
    if old.size < 2 * stride or middle.size == 0:
        return 0.0
    values = values / (np.abs(values).max() or 1.0)
    misfit = CubicSpline(old[::stride], values[..., ::stride], axis=-1)(old[middle]) - values[..., middle]
    return float(np.linalg.norm(misfit) / (np.linalg.norm(values[..., middle]) or 1.0))


def _nearest(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    right = np.clip(np.searchsorted(old, new), 1, old.size - 1)
    return np.where(new - old[right - 1] <= old[right] - new, right - 1, right)


def _through_gaps(old: np.ndarray, line: np.ndarray, new: np.ndarray) -> np.ndarray:
    """A spline over each run of finite values; NaN between the runs."""
    from scipy.interpolate import CubicSpline

    out = np.full(new.size, complex(np.nan, np.nan))
    good = np.flatnonzero(np.isfinite(line))
    for run in np.split(good, np.flatnonzero(np.diff(good) > 1) + 1):
        if run.size > 1:
            inside = (new >= old[run[0]]) & (new <= old[run[-1]])
            out[inside] = CubicSpline(old[run], line[run])(new[inside])
    return out


# --- errors, on arrays (…, z, x) that are 0 where either field has no value ------------------------------------------


def _weights(p_a: xr.DataArray, p_b: xr.DataArray) -> np.ndarray:
    """Area of each point's cell, 0 where either field has no value; equal on an even grid."""
    dz, dx = (np.gradient(p_a[d].values) if p_a.sizes[d] > 1 else np.ones(1) for d in ("z", "x"))
    good = np.isfinite(p_a.values) & np.isfinite(p_b.values)
    missing = good.size - np.count_nonzero(good)
    if missing == good.size:
        raise ValueError("b: expected values in the region that a covers, got NaN in one of them throughout")
    if missing:
        warnings.warn(f"{missing} of {good.size} points have no value in a or b and are left out", stacklevel=4)
    return good * np.outer(dz, dx)


def _divide(top: np.ndarray, bottom: np.ndarray) -> np.ndarray:
    """NaN over nothing."""
    return np.where(bottom > 0, top / np.where(bottom > 0, bottom, 1), np.nan)


def _scaled_down(p: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> tuple[np.ndarray, np.ndarray]:
    """p over a power of two near its largest |p|, whose squares neither overflow nor vanish, and that power."""
    largest = np.abs(p).max(axes, keepdims=True)
    power = np.ldexp(1.0, np.frexp(largest)[1] - 1)
    return p / power, power


def _norm(p: np.ndarray, w: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> np.ndarray:
    small, power = _scaled_down(p, axes)
    return np.sqrt((w * np.abs(small) ** 2).sum(axes)) * power.squeeze(axes)


def _scale(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> np.ndarray:
    """The complex factor that brings b nearest to a."""
    (a, of_a), (b, of_b) = _scaled_down(a), _scaled_down(b)
    near_one = _divide((w * np.conj(b) * a).sum((-2, -1)), (w * np.abs(b) ** 2).sum((-2, -1)))
    return near_one * (of_a / of_b).squeeze((-2, -1))


def _relative_l2(a: np.ndarray, b: np.ndarray, w: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> np.ndarray:
    return _divide(_norm(a - b, w, axes), _norm(a, w, axes))


def _scaled_misfit(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Relative L2 error that the best scale factor leaves."""
    a, b = _scaled_down(a)[0], _scaled_down(b)[0]
    return _relative_l2(a, _scale(a, b, w)[..., None, None] * b, w)


def _errors(a: np.ndarray, b: np.ndarray, w: np.ndarray, x: np.ndarray, z: np.ndarray) -> dict[str, Any]:
    off = np.where(w > 0, np.abs(a - b), -1.0)
    flat = off.reshape(*off.shape[:-2], -1)
    row, column = np.unravel_index(flat.argmax(-1), off.shape[-2:])
    return {
        "relative_l2": _relative_l2(a, b, w),
        "relative_l2_by_z": _relative_l2(a, b, w, (-1,)),
        "largest_error": _divide(flat.max(-1), np.abs(a).max((-2, -1))),
        "largest_error_x": x[column],
        "largest_error_z": z[row],
    }


def _measures(p_a: xr.DataArray, p_b: xr.DataArray) -> dict[str, np.ndarray]:
    """Widths and peaks by z."""
    out = {}
    for name, p in (("a", p_a), ("b", p_b)):
        lines = p.values.reshape(-1, p.sizes["x"])
        found = np.array([_width_and_peak(p.x.values, line) for line in lines]).reshape(*p.shape[:-1], 2)
        out[f"fwhm_{name}"], out[f"peak_{name}"] = found[..., 0], found[..., 1]
    for kind in ("fwhm", "peak"):
        out[f"{kind}_difference"] = out[f"{kind}_b"] - out[f"{kind}_a"]
    return out


def _width_and_peak(x: np.ndarray, line: np.ndarray) -> tuple[float, float]:
    """Width at half maximum and largest |p|, over the run of finite values that holds the largest."""
    good = np.isfinite(line)
    if not np.any(good):
        return np.nan, np.nan
    top = int(np.argmax(np.where(good, np.abs(line), -1)))
    gaps = np.flatnonzero(~good)
    first, last = (gaps[gaps < top].max(initial=-1) + 1, gaps[gaps > top].min(initial=line.size))
    if last - first < 2 or line[top] == 0:
        return np.nan, float(np.abs(line[top]))
    width = full_width(x[first:last], line[first:last])
    return width.width, width.peak


# --- what may be wrong with the comparison itself ---------------------------------------------------------------------


def _warn_of_conjugate(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> bool:
    """Whether conj(b), scaled, is much nearer to a than b, scaled."""
    norm = _norm(a, w)
    if not np.any(norm > 0):
        return False
    power = (norm / norm.max()) ** 2
    as_it_is, turned = (
        float(np.sqrt(np.average(np.nan_to_num(_scaled_misfit(a, p, w), nan=1.0) ** 2, weights=power)))
        for p in (b, np.conj(b))
    )
    better = as_it_is > _NOTICEABLE and turned < as_it_is / 3
    if better:
        warnings.warn(
            f"b looks like exp(+i w t): conj(b) fits a with a relative L2 error of {turned:.2g}, b with "
            f"{as_it_is:.2g} (each with its best scale factor)",
            stacklevel=4,
        )
    return better


def _warn_of_interpolation(between: float, error: np.ndarray) -> None:
    if between > 3e-4 and between > 0.3 * np.max(error, initial=0.0, where=np.isfinite(error)):
        warnings.warn(
            f"b's points do not resolve its field: interpolating it makes a relative error of about "
            f"{between:.2g}; compare on the same x and z",
            stacklevel=4,
        )


def _warn_of_layers(a: xr.Dataset, b: xr.Dataset, old: np.ndarray, new: np.ndarray) -> bool:
    """Whether b's z skip layers: such samples may look smooth, and only the structure tells that the field is not."""
    for ds in (a, b):
        slab = datasets.provenance(ds).get("slab") if "provenance" in ds.attrs else None
        if slab is None:
            continue
        layers = [layer.thickness for cell, _ in slab.segments for layer in cell.layers if hasattr(layer, "thickness")]
        inside = old[(old > 0) & (old < slab.thickness)]
        needed = np.any((new > 0) & (new < slab.thickness)) and (len(layers) > 1 or len(slab.segments) > 1)
        if needed and (inside.size < 2 or np.diff(inside).max() > min(layers) / 2):
            warnings.warn(
                f"the field changes from layer to layer ({min(layers):.3g} m), and b's z are too far apart "
                "to be interpolated inside of the slab: compare on the same z",
                stacklevel=4,
            )
            return True
    return False


def _boundary(ds: xr.Dataset) -> tuple[str | None, float | None]:
    boundary, period = ds.attrs.get("boundary"), ds.attrs.get("period")
    return boundary, None if period is None or boundary == "open" else float(period)


def _warn_of_boundaries(a: xr.Dataset, b: xr.Dataset, wraparound: np.ndarray | None) -> None:
    (kind_a, period_a), (kind_b, period_b) = _boundary(a), _boundary(b)
    if {kind_a, kind_b} == {"open", "periodic"}:
        which, period = ("a", period_a) if kind_a == "periodic" else ("b", period_b)
        text = f"{which} is periodic{'' if period is None else f' ({period:g} m)'} and the other in open space"
    elif period_a is not None and period_b is not None and abs(period_a - period_b) > _TOLERANCE * period_a:
        text = f"a has the period {period_a:.9g} m, b {period_b:.9g} m"
    else:
        return
    share = "" if wraparound is None else f", estimated at {np.nanmax(wraparound):.2g} (wraparound)"
    warnings.warn(f"{text}: the wrap-around of the neighbouring beams is counted in the error{share}", stacklevel=4)


def _wraparound(a: xr.Dataset, b: xr.Dataset, reference: xr.Dataset) -> np.ndarray:
    """Relative L2 difference of the periodic field (a, if both are) to the same field in open space."""
    p_open = _field(reference, "open_reference")
    if _boundary(reference)[0] == "periodic":
        raise ValueError("open_reference: expected a field in open space, got boundary 'periodic'")
    kinds = [_boundary(ds)[0] for ds in (a, b)]
    if kinds == ["open", "open"]:
        raise ValueError("open_reference: expected a or b to be periodic, got boundary 'open' in both")
    chosen = kinds.index("periodic") if "periodic" in kinds else kinds.index(None)
    p = _field((a, b)[chosen], "ab"[chosen])
    p, p_open, _ = _on_common_grid(p, _match(p_open, p, p.attrs.get("units"), "open_reference"), "open_reference")
    w = _weights(p, p_open)
    return _relative_l2(np.where(w > 0, p.values, 0), np.where(w > 0, p_open.values, 0), w)


# --- the dataset -----------------------------------------------------------------------------------------------------


def _dataset(
    variables: dict[str, np.ndarray], p: xr.DataArray, unit: str | None, a: xr.Dataset, b: xr.Dataset, **settings: Any
) -> xr.Dataset:
    known = {n: (tuple(map(str, c.dims)), c.values) for n, c in p.coords.items() if n in LABELS}
    frequency = np.atleast_1d(np.asarray(p.coords["frequency"].values if "frequency" in p.coords else [], float))
    dims = tuple(map(str, p.dims))
    own = {**dict.fromkeys(_FIELDS, dims), **dict.fromkeys(_BY_Z, dims[:-1]), "interpolation_error": ()}
    arrays = {n: (own.get(n, dims[:-2]), v) for n, v in variables.items()}
    ds = datasets.make(
        arrays,
        {str(n): c for n, c in known.items()},
        "compare",
        frequency,
        a=a.attrs.get("provenance"),
        b=b.attrs.get("provenance"),
        **settings,
    )
    others = {n: c.variable for n, c in p.coords.items() if n not in known and set(c.dims) <= set(p.dims)}
    ds = ds.assign_coords(others)
    for name, variable in ds.data_vars.items():
        units, long_name = _NAMES[str(name)]
        variable.attrs = {"units": (unit or "1") if units == "Pa" else units, "long_name": long_name}
    for name in ("z", "x"):
        ds[name].attrs = label(name) | p[name].attrs
    return ds.assign_attrs(
        {k: v for k, v in settings.items() if k == "conjugate_fits_better"}, rescaled=int(settings["rescale"])
    )
