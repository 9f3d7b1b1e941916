"""A table of points and columns to a labelled dataset: axes or nodes, parameters as dimensions, names and units."""

from __future__ import annotations

import math
import re
import warnings
from collections import Counter
from typing import Any

import numpy as np
import xarray as xr

from .. import datasets
from .forms import Table
from .names import Column
from .parameters import RESERVED, in_si, parameter_axes, parameter_names
from .points import choose_axes, place, refuse_sparse, spread
from .text import PRESSURE_UNITS, Source, plain_unit

_PRESSURE = re.compile(r"(?:\w+\.)*(p_t|p)")


def make_dataset(
    table: Table, axes: tuple[str | None, str | None], expression: str | None, conjugate: bool, angle_unit: str | None
) -> xr.Dataset:
    """Points onto axes or nodes, columns onto dimensions, expressions onto variables."""
    chosen = choose_axes(table, *axes)
    places, index, shape = place(table, chosen)
    columns, values = spread(table, index, int(np.prod(list(shape.values()))))
    names = parameter_names([*(n for c in columns for n, _, _ in c.parameters)])
    columns = in_si(table.source, columns, names, angle_unit)
    by_expression: dict[str, list[int]] = {}
    for k, column in enumerate(columns):
        by_expression.setdefault(column.expression, []).append(k)
    parameters = parameter_axes(table.source, columns)
    variables = {}
    for name, members in by_expression.items():
        variables[name] = _variable(
            table.source, [columns[k] for k in members], [values[k] for k in members], parameters, shape
        )
    return _label(table, variables, parameters, columns, (places, chosen, shape), index, expression, conjugate)


def _variable(
    source: Source,
    columns: list[Column],
    values: list[np.ndarray],
    parameters: dict[str, tuple[list[Any], str]],
    shape: dict[str, int],
) -> tuple[tuple[str, ...], np.ndarray, str]:
    """Dims, values and unit of one expression; missing combinations of parameters are NaN and warned about."""
    name, unit = columns[0].expression, columns[0].unit
    own = {n for n, _, _ in columns[0].parameters}
    for column in columns:
        if {n for n, _, _ in column.parameters} != own or column.unit != unit:
            source.refuse(None, f"the same parameters and unit in all columns of {name}", f"{columns[0]} and {column}")
    lead = [n for n in parameters if n in own and len(parameters[n][0]) > 1]
    sizes = tuple(len(parameters[n][0]) for n in lead)
    combinations = math.prod(sizes)
    refuse_sparse(
        source,
        combinations * values[0].size,
        len(values) * values[0].size,
        f"points and parameters of {name}",
        ", ".join(lead),
    )
    out = np.full((*sizes, values[0].size), np.nan, np.result_type(*values))
    seen = np.zeros(sizes, bool)
    for column, value in zip(columns, values, strict=True):
        at = {n: parameters[n][0].index(v) for n, v, _ in column.parameters}
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
        candidates = [n for n, kind in matches.items() if kind == wanted]
        if len(candidates) > 1:
            raise ValueError(
                f"expression: expected one to be chosen of {', '.join(candidates)} of {source.path}, got None"
            )
        if candidates:
            return candidates[0]
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
    if not places and expression is None and pressure and plain_unit(variables[pressure][2]) not in PRESSURE_UNITS:
        pressure = None  # a column p of a table may be a power
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
    ds.attrs["convention"] = f"{time}; " + (
        "SI units; origin of z as in the file" if places else "units as in the file"
    )
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
    reserved = RESERVED if table.coordinates else set(RESERVED) - {"x", "z"}
    added: dict[str, Any] = {}
    for name, (dims, values, unit) in variables.items():
        word = _clean(name)
        if word in ds.variables or word in reserved or alike[word] > 1:
            word = re.sub(r"\W+", "_", name).strip("_")
        while word in ds.variables or word in added or word in reserved or word[0].isdigit():
            word = f"v_{word}"
        attrs = {"units": unit or "1", "long_name": name, "expression": name}
        if not np.iscomplexobj(values):
            attrs["convention"] = "real, as in the file: exp(+i w t)"
        added[word] = (dims, np.conj(values) if conjugate else values, attrs)
    ds = ds.assign(added)
    if table.elements is not None and "node" in ds.dims:
        ds["elements"] = (
            ("element", "corner"),
            index[table.elements],
            {"units": "1", "long_name": "nodes at the corners of each element, from 0"},
        )
    return ds
