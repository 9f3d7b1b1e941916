"""Two fields on the same points: the pressure of a dataset, checked, in one unit, on the region that both cover."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ..io.comsol import PRESSURE_UNITS, plain_unit
from .resample import resample

#: Positions that differ by less than this share of the span are the same: files print ten digits and more of them.
SAME_POSITION = 1e-9
#: Dims that are places.
PLACES = ("z", "y", "x", "node")
#: Frequencies and angles of files are rounded to five digits.
ROUNDED = 1e-4


def pressure_of(ds: Any, name: str) -> xr.DataArray:
    """The pressure on (…, z, x) or (…, z, y, x), all rising; dims of one entry become scalar coordinates, z and x never."""
    if not isinstance(ds, xr.Dataset) or "p" not in ds:
        got = ", ".join(map(str, ds.data_vars)) if isinstance(ds, xr.Dataset) else type(ds).__name__
        raise ValueError(f"{name}: expected a dataset with the pressure p, got {got}")
    p = ds["p"]
    if "node" in p.dims:
        raise ValueError(
            f"{name}: expected p on (z, x), got p on scattered nodes: bring it onto a grid with to_grid "
            "(the command's --grid)"
        )
    across = ("y",) if p.sizes.get("y", 1) > 1 else ()
    for axis in ("z", *across, "x"):
        if axis not in p.coords:
            raise ValueError(f"{name}: expected p on (z, x), got no {axis} among {', '.join(map(str, p.coords))}")
        if axis not in p.dims:
            p = p.expand_dims(axis)
        if not np.all(np.isfinite(p[axis])) or p.get_index(axis).has_duplicates:
            raise ValueError(f"{name}: expected finite and distinct positions {axis}, got others")
        p = p.sortby(axis)
    p = p.squeeze([d for d in p.dims if d not in ("z", "x") and p.sizes[d] == 1])
    return p.transpose(..., "z", *across, "x")


def places_of(p: xr.DataArray) -> tuple[str, ...]:
    """The axes of a grid: z, y in three dimensions, and x."""
    return tuple(d for d in PLACES if d in p.dims)


def as_rows(values: np.ndarray, p: xr.DataArray) -> np.ndarray:
    """Values on the grid of p with each plane as a row: (…, z, points)."""
    return values.reshape(*p.shape[: p.dims.index("z") + 1], -1)


def matched(p: xr.DataArray, to: xr.DataArray, unit: str | None, name: str) -> xr.DataArray:
    """p in the unit of `to`, with its further dims in the same order; refused where they are of different problems."""
    own_unit = p.attrs.get("units")
    if own_unit != unit:
        if {plain_unit(str(own_unit)), plain_unit(str(unit))} - set(PRESSURE_UNITS):
            raise ValueError(f"{name}: expected p in {unit!r} as a has it, or in a unit of pressure, got {own_unit!r}")
        p = p * (PRESSURE_UNITS[plain_unit(str(own_unit))] / PRESSURE_UNITS[plain_unit(str(unit))])
    lead = [d for d in to.dims if d not in PLACES]
    for dim in {*to.dims, *p.dims} - {"z", "x", "node"}:
        if (dim in to.dims) != (dim in p.dims):
            raise ValueError(f"{name}: expected the dims {to.dims} as a has them, got {p.dims}: select one {dim}")
    for key in {*lead, "frequency", "angle"} & set(p.coords) & set(to.coords):
        _check_same(p, to, key, name)
        if key in lead:
            p = p.assign_coords({key: to[key]})
    _check_same_y(p, to, name)
    drop = [c for c in p.coords if c not in to.coords]
    return p.drop_vars(drop).transpose(*lead, *(d for d in PLACES if d in p.dims))


def _check_same(p: xr.DataArray, to: xr.DataArray, key: Any, name: str) -> None:
    ours, theirs = to[key].values, p[key].values
    near = ROUNDED * (np.abs(ours).max(initial=0.0) if ours.dtype.kind in "fiuc" else 0.0)
    if ours.shape != theirs.shape or not np.all(ours == theirs if near == 0 else np.abs(ours - theirs) <= near):
        raise ValueError(f"{name}: expected the same {key} as a, {_short(ours)}, got {_short(theirs)}")


def _check_same_y(p: xr.DataArray, to: xr.DataArray, name: str) -> None:
    """Refuse cuts at different y; a field on which nothing depends on y has none."""
    if all("y" in q.coords and q["y"].ndim == 0 for q in (p, to)):
        ours, theirs = float(to["y"]), float(p["y"])
        if not abs(ours - theirs) <= SAME_POSITION * max(np.ptp(to["x"].values), abs(ours), abs(theirs)):
            raise ValueError(f"{name}: expected the same y as a, {ours:.9g}, got {theirs:.9g}")


def _short(values: np.ndarray) -> str:
    return np.array2string(values, threshold=6, edgeitems=2, precision=6)


def on_common_grid(to: xr.DataArray, p: xr.DataArray, name: str) -> tuple[xr.DataArray, xr.DataArray, dict[str, float]]:
    """Both on those of `to`'s points that p's grid covers, and each axis' estimated relative error of interpolation."""
    shares = {}
    for axis in places_of(to):
        new, old = to[axis].values, p[axis].values
        near = SAME_POSITION * max(np.ptp(new), np.ptp(old), 1e-6 * np.abs(new).max())
        inside = (new >= old[0] - near) & (new <= old[-1] + near)
        if not np.any(inside):
            raise ValueError(
                f"{name}: expected {axis} that covers points of a, {new[0]:g} to {new[-1]:g} m, "
                f"got {old[0]:g} to {old[-1]:g} m"
            )
        to = to.isel({axis: inside})
        values = np.moveaxis(p.values, p.dims.index(axis), -1)
        new_values, shares[axis] = resample(old, values, new[inside], near)
        moved = np.moveaxis(new_values, -1, p.dims.index(axis))
        p = xr.DataArray(moved, p.drop_vars(axis).coords, p.dims).assign_coords({axis: to[axis]})
    return to, p, shares
