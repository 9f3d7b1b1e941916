"""Comparison on a mesh's own nodes: the field of ours is evaluated there, and nothing is interpolated.

A dataset from `field` records its slab, beam and settings, so that the same field can be had at any point, to the same rtol. Nodes in
front of the launch plane, where it is not defined, are left out. Each node counts by the area around it.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..api.field_at import field_at
from ..io import datasets
from ..sources.base import Beam
from .grid import SAME_POSITION, matched, pressure_of

#: How far p may be from what its dataset records, over its largest |p|, beside the errors that it states: a field that was scaled or
#: moved by less than this makes no difference that a comparison of two programs would notice.
AS_RECORDED = 1e-4
#: Positions along x and z at which that is looked at.
LOOKED_AT = 5
#: What the record of a field has to hold.
NEEDED = {"slab", "beam", "boundary", "period", "rtol"}
HOW = "bring the nodes onto a grid with to_grid (the command's --grid)"


def scattered(ds: Any) -> bool:
    """Whether a dataset has its pressure on scattered nodes."""
    return isinstance(ds, xr.Dataset) and "p" in ds and "node" in ds["p"].dims


def on_nodes(a: xr.Dataset, b: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray, np.ndarray, str]:
    """Both pressures on (…, node), the nodes' areas (N,), and in words what was done; b is not yet in a's unit."""
    if scattered(a) and scattered(b):
        raise ValueError(f"a, b: expected a grid at least on one side, got scattered nodes in both: {HOW}")
    name, other = ("a", "b") if scattered(a) else ("b", "a")
    mesh, ours = (a, b) if scattered(a) else (b, a)
    if ours.attrs.get("geometry") == "3-D":
        raise ValueError(
            f"{other}: expected a field without y beside scattered nodes, got one in three dimensions: {HOW}"
        )
    on_mesh, grid = _pressure_on_nodes(mesh, name), pressure_of(ours, other)
    areas, weighed = _areas(on_mesh, mesh)
    record = _record(ours, name)
    first, second = (on_mesh, grid) if name == "a" else (grid, on_mesh)
    # what is of different problems is refused before the work
    matched(second, first, first.attrs.get("units"), "b")
    keep = _behind_launch(on_mesh["z"].values, record["beam"].z0, name)
    on_mesh = on_mesh.isel(node=keep)
    evaluated = _evaluated(ours, record, on_mesh, other)
    how = f"nodes of {name}; {other} evaluated there; weighed {weighed}"
    p_a, p_b = (on_mesh, evaluated) if name == "a" else (evaluated, on_mesh)
    return p_a, p_b, areas[keep], how


def _pressure_on_nodes(ds: xr.Dataset, name: str) -> xr.DataArray:
    p = ds["p"]
    for axis in ("x", "z"):
        if axis not in p.coords or p[axis].dims != ("node",):
            raise ValueError(f"{name}: expected coordinates x and z of the nodes, got none for {axis}")
        validate.positions(p[axis].values, name)
    p = p.squeeze([d for d in p.dims if d != "node" and p.sizes[d] == 1])
    return p.transpose(..., "node")


def _record(ds: xr.Dataset, mesh: str) -> dict[str, Any]:
    """What `field` records of its making; refused where the field cannot be made again from it. `mesh` is the other's name."""
    record = datasets.provenance(ds) if "provenance" in ds.attrs else {}
    made = record.get("question", "no known origin")
    if made != "field" or not set(record) >= NEEDED or not isinstance(record["beam"], Beam):
        made = "a source of the user's own or of more samples than a record keeps" if made == "field" else made
        raise ValueError(
            f"{mesh}: expected p on (z, x), or for scattered nodes a field of beamprop beside it, which can be evaluated "
            f"there, got one of {made}: {HOW}"
        )
    return record


def _behind_launch(z: np.ndarray, z0: float, name: str) -> np.ndarray:
    """Whether each node lies on the launch plane or behind it, within rounding."""
    keep = z >= z0 - SAME_POSITION * np.ptp(z)
    if not keep.any():
        raise ValueError(f"{name}: expected nodes behind the launch plane z0 = {z0:g} m, got z up to {z.max():g} m")
    if not keep.all():
        warnings.warn(
            f"{np.count_nonzero(~keep)} of {z.size} nodes lie in front of the launch plane z0 = {z0:g} m and are left out",
            stacklevel=5,
        )
    return keep


def _evaluated(ours: xr.Dataset, record: dict[str, Any], on_mesh: xr.DataArray, name: str) -> xr.DataArray:
    """The recorded field at the nodes, on (…, node); refused where the dataset's p is not what is recorded."""
    grid = pressure_of(ours, name)
    lead = [d for d in ("frequency", "angle") if d in grid.dims]
    if not {"frequency", "angle"} <= set(grid.coords) or set(grid.dims) > {*lead, "z", "x"}:
        raise ValueError(f"{name}: expected p by frequency and angle, got {', '.join(map(str, grid.dims))}: select one")
    known = _looked_at(grid).transpose(*lead, "point")
    x, z = (np.concatenate([on_mesh[n].values, known[n].values]) for n in ("x", "z"))
    z = np.maximum(z, record["beam"].z0)  # nodes on the launch plane may lie in front of it by rounding
    frequency, angle = (np.atleast_1d(grid[n].values) for n in ("frequency", "angle"))
    p = field_at(record, frequency, angle, x, z)
    p = p.reshape(*(grid.sizes[d] for d in lead), x.size)
    nodes = on_mesh.sizes["node"]
    _check_record(p[..., nodes:], known.values, grid, _stated_error(ours, record), name)
    coords = {n: c.variable for n, c in grid.coords.items() if not {"z", "x"} & set(c.dims)}
    at = {n: ("node", on_mesh[n].values, grid[n].attrs) for n in ("x", "z")}
    return xr.DataArray(p[..., :nodes], coords | at, (*lead, "node"), "p", grid.attrs)


def _looked_at(grid: xr.DataArray) -> xr.DataArray:
    """p of a grid at a few of its points, on the dim point."""
    few = {d: np.unique(np.linspace(0, grid.sizes[d] - 1, LOOKED_AT).round().astype(int)) for d in ("z", "x")}
    return grid.isel(few).stack(point=("z", "x"))


def _stated_error(ours: xr.Dataset, record: dict[str, Any]) -> float:
    """The relative error of the field that its dataset states."""
    return float(max(record["rtol"], np.max(ours["error_estimate"].values if "error_estimate" in ours else 0.0)))


def _check_record(made: np.ndarray, given: np.ndarray, grid: xr.DataArray, error: float, name: str) -> None:
    """A field that was changed after it was made, scaled or moved, is not what its dataset records."""
    largest = float(np.nanmax(np.abs(grid.values)))
    off = float(np.nanmax(np.abs(made - given), initial=0.0))
    rounding = 2 * float(grid.attrs.get("rounding_error", 0.0))  # of files that keep some digits, in both parts
    if off > (AS_RECORDED + 2 * error) * largest + rounding:
        raise ValueError(
            f"{name}: expected p as its provenance records it, got one that is off by {off / largest:.2g} of the "
            f"largest |p| (was it scaled or moved?): {HOW}"
        )


def _areas(p: xr.DataArray, mesh: xr.Dataset) -> tuple[np.ndarray, str]:
    """The area around each node: a third of each triangle that it is a corner of."""
    x, z = p["x"].values, p["z"].values
    corners, what = _triangles(x, z, mesh)
    if corners is None:
        return np.ones(x.size), "each node alike"
    (x0, x1, x2), (z0, z1, z2) = x[corners.T], z[corners.T]
    areas = np.abs((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / 6
    return np.bincount(corners.ravel(), np.repeat(areas, 3), x.size), what


def _triangles(x: np.ndarray, z: np.ndarray, mesh: xr.Dataset) -> tuple[np.ndarray | None, str]:
    """Corners (T, 3) of the mesh's triangles, or of the Delaunay triangles of its nodes; None for nodes on a line."""
    if "elements" in mesh and mesh["elements"].shape[1] == 3:
        return mesh["elements"].values, "by the areas of the elements"
    from scipy.spatial import Delaunay, QhullError

    try:
        return Delaunay(np.stack([x, z], axis=-1)).simplices, "by the areas of the nodes' Delaunay triangles"
    except QhullError:
        return None, ""
