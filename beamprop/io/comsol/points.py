"""Rows of a table to points: the axes or nodes of a dataset, the place of each row among them, and columns over them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .forms import Table
from .names import Column
from .text import Source

#: Combinations that a dataset may hold: so many values, or this many times those in the file.
ROOM, SPARSE = 2**16, 16
#: Coordinates closer than this share of their span are one, for exports carry rounding errors.
NEAR = 1e-9
#: Coordinates closer than this share of the largest span are one: planes and lines that are turned in space carry such noise.
NOISE = 1e-12


def choose_axes(table: Table, x: str | None, z: str | None) -> dict[str, str]:
    """Dataset's axis -> file's coordinate; a third coordinate must be constant."""
    coordinates = table.coordinates
    for argument, name in (("x", x), ("z", z)):
        if name is not None and not coordinates:
            raise ValueError(
                f"{argument}: expected none, for the rows of {table.source.path} are no points, got {name!r}"
            )
        if name is not None and name not in coordinates:
            raise ValueError(
                f"{argument}: expected one of the coordinates {', '.join(coordinates)} of {table.source.path}, got {name!r}"
            )
    if not coordinates:
        return {}
    left = [n for n in coordinates if n not in (x, z)]
    noise = _noise(coordinates)
    varying = [n for n in left if np.ptp(coordinates[n]) > max(NEAR * np.abs(coordinates[n]).max(), noise)]
    if len(coordinates) > 2 and len(varying) > 2 - sum(n is not None for n in (x, z)):
        raise ValueError(
            f"x, z: expected a plane, got {table.source.path} with varying {', '.join(coordinates)}: export one plane of it"
        )
    left.sort(key=lambda n: (len(coordinates) > 2 and n not in varying, list(coordinates).index(n)))
    if len(coordinates) == 1:
        return {"z": z} if z is not None else {"x": next(iter(coordinates))}
    x = left.pop(0) if x is None else x
    return {"z": left.pop(0) if z is None else z, "x": x}


def _noise(coordinates: dict[str, np.ndarray]) -> float:
    """What coordinates may be off by rounding, as their largest span tells."""
    return NOISE * max(float(np.ptp(c)) for c in coordinates.values())


def _snap(values: np.ndarray, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Distinct values, those within rounding errors being one, and the index of each value among them."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    near = max(NEAR * max(float(np.ptp(values)), 1e-6 * float(np.abs(values).max())), noise)
    new = np.concatenate([[True], np.diff(ordered) > near])
    index = np.empty(values.size, int)
    index[order] = np.cumsum(new) - 1
    return np.where(np.abs(ordered[new]) > noise, ordered[new], 0.0), index


def place(table: Table, chosen: dict[str, str]) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, int]]:
    """Positions of the dataset's axes or nodes, each row's place among its points, and the points' dims.

    Points that fill at least half of the grid of their distinct coordinates are a grid, with NaN elsewhere.
    """
    if not chosen:
        rows = table.values[0].size
        return {}, np.arange(rows), {"row": rows}
    noise = _noise(table.coordinates)
    snapped = {axis: _snap(table.coordinates[name], noise) for axis, name in chosen.items()}
    shape = {axis: s[0].size for axis, s in snapped.items()}
    key = np.zeros(len(next(iter(table.coordinates.values()))), int)
    for axis, (_, index) in snapped.items():
        key = key * shape[axis] + index
    distinct, first, inverse = np.unique(key, return_index=True, return_inverse=True)
    cells = int(np.prod(list(shape.values())))
    if distinct.size == cells or (table.elements is None and 2 * distinct.size >= cells):
        if distinct.size < cells:
            warnings.warn(
                f"{table.source.path}: {cells - distinct.size} of the grid's {cells} points are missing, NaN there",
                stacklevel=4,
            )
        return {axis: s[0] for axis, s in snapped.items()}, key, shape
    return {axis: table.coordinates[name][first] for axis, name in chosen.items()}, inverse, {"node": distinct.size}


def spread(table: Table, index: np.ndarray, size: int) -> tuple[list[Column], list[np.ndarray]]:
    """Columns over the distinct points; parameters that are columns of their own become parameters of columns."""
    groups = _groups(table, index.size)
    refuse_sparse(table.source, len(groups) * size, index.size, "points", ", ".join(table.scattered))
    columns, values = [], []
    for key, rows in groups:
        for column, value in zip(table.columns, table.values, strict=True):
            columns.append(Column(column.expression, column.unit, (*key, *column.parameters)))
            values.append(_at_points(table.source, column, index[rows], value[rows], size))
    return columns, values


def _groups(table: Table, rows: int) -> list[tuple[tuple[tuple[str, Any, str], ...], np.ndarray]]:
    """Values of the parameters that are columns, and the rows that have them; one group of all rows without such."""
    names, levels, level = list(table.scattered), [], []
    for name, (value, _) in table.scattered.items():
        if np.iscomplexobj(value) or not np.all(np.isfinite(value)):
            table.source.refuse(None, f"finite real values in the column {name}", "NaN, infinite or complex ones")
        distinct, number = _snap(value)
        levels.append(distinct)
        level.append(number)
    if not names:
        return [((), np.arange(rows))]
    combinations, group = np.unique(np.stack(level, axis=-1), axis=0, return_inverse=True)
    members = np.split(np.argsort(group.ravel(), kind="stable"), np.cumsum(np.bincount(group.ravel()))[:-1])
    units = [table.scattered[n][1] for n in names]
    keys = [
        tuple((n, float(v[k]), u) for n, v, k, u in zip(names, levels, key, units, strict=True)) for key in combinations
    ]
    return list(zip(keys, members, strict=True))


def refuse_sparse(source: Source, cells: int, stored: int, what: str, names: str) -> None:
    """What is made of a file is bounded by what it holds: a few bytes must not ask for gigabytes of NaN."""
    if cells > ROOM and cells > SPARSE * stored:
        source.refuse(
            None, f"values for at least one in {SPARSE} of the combinations of {what} ({names})", f"{stored} of {cells}"
        )


def _at_points(source: Source, column: Column, index: np.ndarray, value: np.ndarray, size: int) -> np.ndarray:
    """Values in their places; of a point that stands twice in the file, the first that is finite."""
    finite = np.isfinite(value)
    out = np.full(size, np.nan, value.dtype)
    out[index[~finite]] = value[~finite]
    out[index[finite][::-1]] = value[finite][::-1]
    differences = np.abs(out[index[finite]] - value[finite])
    ambiguous = np.count_nonzero(differences > 1e-6 * np.abs(value[finite]).max(initial=0.0))
    if ambiguous:
        warnings.warn(
            f"{source.path}: {column.expression} has two values at {ambiguous} points, the first is kept", stacklevel=6
        )
    return out
