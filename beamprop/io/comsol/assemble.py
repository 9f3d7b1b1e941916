"""A table of points and columns to a labelled dataset: axes or nodes, parameters as dimensions, names and units."""

from __future__ import annotations

import math
import re
import warnings
from collections import Counter
from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr

from .. import datasets
from .forms import PARAMETERS, Table
from .names import Column
from .text import PRESSURE_UNITS, QUANTITIES, Source, plain_unit

_RESERVED = ("x", "z", "p", "node", "elements", "element", "corner")
_PRESSURE = re.compile(r"(?:\w+\.)*(p_t|p)")
#: Combinations that a dataset may hold: so many values, or this many times those in the file.
ROOM, SPARSE = 2**16, 16
NEAR = 1e-9  # coordinates closer than this share of their span are one, for exports carry rounding errors


def make_dataset(
    table: Table, axes: tuple[str | None, str | None], expression: str | None, conjugate: bool, angle_unit: str | None
) -> xr.Dataset:
    """Points onto axes or nodes, columns onto dimensions, expressions onto variables."""
    chosen = _choose_axes(table, *axes)
    places, index, shape = _place(table, chosen)
    columns, values = _spread(table, index, int(np.prod(list(shape.values()))))
    names = _parameter_names([*(n for c in columns for n, _, _ in c.parameters)])
    columns = _in_si(table.source, columns, names, angle_unit)
    by_expression: dict[str, list[int]] = {}
    for k, column in enumerate(columns):
        by_expression.setdefault(column.expression, []).append(k)
    everything = _parameter_axes(table.source, columns)
    variables = {}
    for name, members in by_expression.items():
        variables[name] = _variable(
            table.source, [columns[k] for k in members], [values[k] for k in members], everything, shape
        )
    return _label(table, variables, everything, columns, (places, chosen, shape), index, expression, conjugate)


def _choose_axes(table: Table, x: str | None, z: str | None) -> dict[str, str]:
    """Dataset's axis -> file's coordinate; a third coordinate must be constant."""
    found = table.coordinates
    for argument, name in (("x", x), ("z", z)):
        if name is not None and name not in found:
            raise ValueError(
                f"{argument}: expected one of the coordinates {', '.join(found)} of {table.source.path}, got {name!r}"
            )
    left = [n for n in found if n not in (x, z)]
    varying = [n for n in left if np.ptp(found[n]) > NEAR * np.abs(found[n]).max()]
    if len(found) > 2 and len(varying) > 2 - sum(n is not None for n in (x, z)):
        raise ValueError(
            f"x, z: expected a plane, got {table.source.path} with varying {', '.join(found)}: export one plane of it"
        )
    left.sort(key=lambda n: (len(found) > 2 and n not in varying, list(found).index(n)))
    if len(found) == 1:
        return {"z": z} if z is not None else {"x": next(iter(found))}
    x = left.pop(0) if x is None else x
    return {"z": left.pop(0) if z is None else z, "x": x}


def _snap(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distinct values, those within rounding errors being one, and the index of each value among them."""
    order = np.argsort(values, kind="stable")
    ordered = values[order]
    near = NEAR * max(float(np.ptp(values)), 1e-6 * float(np.abs(values).max()))
    new = np.concatenate([[True], np.diff(ordered) > near])
    index = np.empty(values.size, int)
    index[order] = np.cumsum(new) - 1
    return ordered[new], index


def _place(table: Table, chosen: dict[str, str]) -> tuple[dict[str, np.ndarray], np.ndarray, dict[str, int]]:
    """Positions of the dataset's axes or nodes, each row's place among its points, and the points' dims.

    Points that fill at least half of the grid of their distinct coordinates are a grid, with NaN elsewhere.
    """
    snapped = {axis: _snap(table.coordinates[name]) for axis, name in chosen.items()}
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


def _spread(table: Table, index: np.ndarray, size: int) -> tuple[list[Column], list[np.ndarray]]:
    """Columns over the distinct points; parameters that are columns of their own become parameters of columns."""
    groups = _groups(table, index.size)
    _refuse_sparse(table.source, len(groups) * size, index.size, "points", ", ".join(table.scattered))
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
    found, group = np.unique(np.stack(level, axis=-1), axis=0, return_inverse=True)
    members = np.split(np.argsort(group.ravel(), kind="stable"), np.cumsum(np.bincount(group.ravel()))[:-1])
    units = [table.scattered[n][1] for n in names]
    keys = [tuple((n, float(v[k]), u) for n, v, k, u in zip(names, levels, key, units, strict=True)) for key in found]
    return list(zip(keys, members, strict=True))


def _refuse_sparse(source: Source, cells: int, stored: int, what: str, names: str) -> None:
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
    unlike = np.abs(out[index[finite]] - value[finite])
    several = np.count_nonzero(unlike > 1e-6 * np.abs(value[finite]).max(initial=0.0))
    if several:
        warnings.warn(
            f"{source.path}: {column.expression} has two values at {several} points, the first is kept", stacklevel=6
        )
    return out


def _parameter_names(found: Iterable[str]) -> dict[str, str]:
    """File's parameter -> the dataset's name; two that would share a name keep their own."""
    raw = list(dict.fromkeys(found))
    names = {n: n if n not in _RESERVED else f"{n}_parameter" for n in raw}
    for target, aliases in PARAMETERS.items():
        present = [n for n in raw if n in aliases]
        if len(present) == 1:
            names[present[0]] = target
    return names


def _in_si(source: Source, columns: list[Column], names: dict[str, str], angle_unit: str | None) -> list[Column]:
    """Parameters under their names in the dataset, and in SI units and degrees where the unit is known."""
    bare = any(names[n] == "angle" and not unit and value != 0 for c in columns for n, value, unit in c.parameters)
    if bare and angle_unit is None:
        warnings.warn(
            f"{source.path}: states no unit of the angle, degrees taken (angle_unit= says otherwise)", stacklevel=4
        )
    defaults = {"frequency": "Hz", "angle": angle_unit or "deg", "time": "s"}
    kinds = {"frequency": "Hz", "angle": "degree", "time": "s"}

    def bring(name: str, value: Any, unit: str) -> tuple[str, Any, str]:
        unit = plain_unit(unit) or defaults.get(names[name], "")
        to, known = next(((t, k) for t, k in QUANTITIES if unit in k), (unit, {unit: 1.0}))
        if kinds.get(names[name], to) != to or (names[name] in kinds and isinstance(value, str | complex)):
            source.refuse(None, f"real values of {name} in {kinds[names[name]]}", f"{value!r} [{unit}]")
        return names[name], value if isinstance(value, str) else value * known[unit], to

    return [Column(c.expression, c.unit, tuple(bring(*p) for p in c.parameters)) for c in columns]


def _parameter_axes(source: Source, columns: list[Column]) -> dict[str, tuple[list[Any], str]]:
    """Each parameter's values (rising, where they are real) and unit; frequency and angle first."""
    found: dict[str, dict[Any, None]] = {}
    units: dict[str, set[str]] = {}
    for column in columns:
        for name, value, unit in column.parameters:
            found.setdefault(name, {})[value] = None
            units.setdefault(name, set()).add(unit)
    for name, several in units.items():
        if len(several) > 1:
            source.refuse(None, f"one unit for the parameter {name}", " and ".join(sorted(map(repr, several))))
    order = sorted(found, key=lambda n: (n != "frequency", n != "angle"))
    real = {n: all(isinstance(v, float) for v in found[n]) for n in order}
    return {n: (sorted(found[n]) if real[n] else list(found[n]), units[n].pop()) for n in order}


def _variable(
    source: Source,
    columns: list[Column],
    values: list[np.ndarray],
    everything: dict[str, tuple[list[Any], str]],
    shape: dict[str, int],
) -> tuple[tuple[str, ...], np.ndarray, str]:
    """Dims, values and unit of one expression; missing combinations of parameters are NaN and warned about."""
    name, unit = columns[0].expression, columns[0].unit
    own = {n for n, _, _ in columns[0].parameters}
    for column in columns:
        if {n for n, _, _ in column.parameters} != own or column.unit != unit:
            source.refuse(None, f"the same parameters and unit in all columns of {name}", f"{columns[0]} and {column}")
    lead = [n for n in everything if n in own and len(everything[n][0]) > 1]
    sizes = tuple(len(everything[n][0]) for n in lead)
    combinations = math.prod(sizes)
    _refuse_sparse(
        source,
        combinations * values[0].size,
        len(values) * values[0].size,
        f"points and parameters of {name}",
        ", ".join(lead),
    )
    out = np.full((*sizes, values[0].size), np.nan, np.result_type(*values))
    seen = np.zeros(sizes, bool)
    for column, value in zip(columns, values, strict=True):
        at = {n: everything[n][0].index(v) for n, v, _ in column.parameters}
        place = tuple(at[n] for n in lead)
        if seen[place]:
            source.refuse(
                None,
                f"one column of {name} for each combination of parameters",
                f"two at {dict((n, v) for n, v, _ in column.parameters)}",
            )
        out[place], seen[place] = value, True
    if not seen.all():
        warnings.warn(
            f"{source.path}: {np.count_nonzero(~seen)} of {seen.size} combinations of parameters are "
            f"missing for {name}, NaN there",
            stacklevel=5,
        )
    return (*lead, *shape), out.reshape(*sizes, *shape.values()), unit


def _pressure(source: Source, variables: dict[str, Any], expression: str | None) -> str | None:
    """The expression that becomes p."""
    if expression is not None:
        if expression not in variables:
            raise ValueError(f"expression: expected one of {', '.join(variables)} of {source.path}, got {expression!r}")
        return expression
    matches = {n: m[1] for n in variables if (m := _PRESSURE.fullmatch(n))}
    for wanted in ("p_t", "p"):
        found = [n for n, kind in matches.items() if kind == wanted]
        if len(found) > 1:
            raise ValueError(f"expression: expected one to be chosen of {', '.join(found)} of {source.path}, got None")
        if found:
            return found[0]
    for name in variables:
        part = re.fullmatch(r"real\((.*)\)", name)
        if part and _PRESSURE.fullmatch(part[1].strip()) and f"imag({part[1]})" in variables:
            return name
    return None


def _clean(name: str) -> str:
    """A variable's name from an expression: 'abs(acpr.p_t)' -> 'abs_p_t'."""
    word = re.sub(r"\W+", "_", re.sub(r"\b(?:[A-Za-z_]\w*\.)+", "", name)).strip("_") or "expression"
    return word if not word[0].isdigit() else f"v_{word}"


def _label(
    table: Table,
    variables: dict[str, tuple[tuple[str, ...], np.ndarray, str]],
    parameters: dict[str, tuple[list[Any], str]],
    columns: list[Column],
    geometry: tuple[dict[str, np.ndarray], dict[str, str], dict[str, int]],
    index: np.ndarray,
    expression: str | None,
    conjugate: bool,
) -> xr.Dataset:
    """The dataset with names, units and where they come from."""
    places, chosen, shape = geometry
    source = table.source
    spatial = {a: ((a,) if "node" not in shape else ("node",), v) for a, v in places.items()}
    swept = {n: ((n,) if len(v) > 1 else (), np.array(v) if len(v) > 1 else v[0]) for n, (v, _) in parameters.items()}
    known = {n: c for n, c in swept.items() if n in ("frequency", "angle")}
    pressure = _pressure(source, variables, expression)
    frequency = np.atleast_1d(np.asarray(parameters.get("frequency", ([], ""))[0], float))
    made = _make_p(source, variables, pressure, conjugate)
    ds = datasets.make(
        made,
        {**known, **spatial},
        "read_comsol",
        frequency,
        file=source.path,
        expression=pressure,
        conjugate=bool(conjugate),
        comsol=source.meta.get("version"),
    )
    for name, coordinate in swept.items():
        if name not in known:
            ds = ds.assign_coords({name: (*coordinate, {"units": parameters[name][1] or "1", "long_name": name})})
    for axis, name in chosen.items():
        ds[axis].attrs["file_coordinate"] = name
    time = "exp(-i w t), conjugated from COMSOL's exp(+i w t)" if conjugate else "exp(+i w t), as in the file"
    ds.attrs["convention"] = f"{time}; SI units; origin of z as in the file"
    if "p" in made:
        ds.p.attrs["expression"] = str(pressure)
        if not conjugate:
            ds.p.attrs["long_name"] = "complex sound pressure, exp(+i w t)"
    return _add_rest(ds, table, {n: v for n, v in variables.items() if n != pressure}, index, conjugate)


def _make_p(
    source: Source, variables: dict[str, tuple[tuple[str, ...], np.ndarray, str]], pressure: str | None, conjugate: bool
) -> dict[str, tuple[tuple[str, ...], np.ndarray]]:
    """The variable p in Pa; nothing where the file has no pressure."""
    if pressure is None:
        return {}
    dims, values, unit = variables[pressure]
    if not unit:
        warnings.warn(f"{source.path}: states no unit of {pressure}, Pa taken", stacklevel=5)
    elif plain_unit(unit) not in PRESSURE_UNITS:
        source.refuse(None, f"a unit of pressure for {pressure}, one of {', '.join(PRESSURE_UNITS)}", repr(unit))
    values = values * (PRESSURE_UNITS[plain_unit(unit)] if unit else 1.0) + 0j
    if (part := re.fullmatch(r"real\((.*)\)", pressure)) and (other := variables.get(f"imag({part[1]})")):
        values = values + 1j * other[1] * (PRESSURE_UNITS[plain_unit(unit)] if unit else 1.0)
    return {"p": (dims, np.conj(values) if conjugate else values)}


def _add_rest(
    ds: xr.Dataset,
    table: Table,
    variables: dict[str, tuple[tuple[str, ...], np.ndarray, str]],
    index: np.ndarray,
    conjugate: bool,
) -> xr.Dataset:
    """The other expressions, under names that are free, and the elements."""
    alike = Counter(_clean(n) for n in variables)
    found: dict[str, Any] = {}
    for name, (dims, values, unit) in variables.items():
        word = _clean(name)
        if word in ds.variables or word in _RESERVED or alike[word] > 1:
            word = re.sub(r"\W+", "_", name).strip("_")
        while word in ds.variables or word in found or word in _RESERVED or word[0].isdigit():
            word = f"v_{word}"
        attrs = {"units": unit or "1", "long_name": name, "expression": name}
        if not np.iscomplexobj(values):
            attrs["convention"] = "real, as in the file: exp(+i w t)"
        found[word] = (dims, np.conj(values) if conjugate else values, attrs)
    ds = ds.assign(found)
    if table.elements is not None and "node" in ds.dims:
        ds["elements"] = (
            ("element", "corner"),
            index[table.elements],
            {"units": "1", "long_name": "nodes at the corners of each element, from 0"},
        )
    return ds
