"""COMSOL's text exports to the schema of `beamprop.field`: spreadsheet (txt, csv, dat), grid and sectionwise files.

Such a file is a header of lines that start with ``%`` and then numbers. In the spreadsheet form the last line of the
header names the columns: coordinates, then one column for each expression and combination of parameters,

    % x,y,acpr.p_t (Pa) @ freq=2400, theta=0,acpr.p_t (Pa) @ freq=2500, theta=0

with the commas inside of a name unquoted; in txt and dat the names stand apart by one blank or more, and hold blanks
too. The grid form has the sections ``% Grid`` (one row for each axis) and ``% Data`` (x runs along a row), the
sectionwise form ``% Coordinates``, ``% Elements`` and ``% Data``, with or without counts such as ``% Elements: 1122`` above them.
A table (``% Table``) is a spreadsheet whose columns are titles, parted by two blanks or more, or quoted. COMSOL is exp(+i w t), so complex fields are
conjugated here.

Data flows text -> names -> forms (a table of points and columns, lengths in m) -> points, parameters -> assemble (the dataset). Every refusal
names the file, the line, what was expected and what came.
"""

from __future__ import annotations

import warnings
from os import PathLike
from typing import Any

import numpy as np
import xarray as xr

from ... import memory, validate
from .assemble import make_dataset
from .forms import READERS, SECTION, read_spreadsheet
from .text import ANGLES, LENGTHS, PRESSURE_UNITS, length_factor, plain_unit, scan

__all__ = ["PRESSURE_UNITS", "plain_unit", "read_comsol", "to_grid"]


def read_comsol(
    path: str | PathLike[str],
    x: str | None = None,
    z: str | None = None,
    expression: str | None = None,
    conjugate: bool = True,
    *,
    length_unit: str | None = None,
    angle_unit: str | None = None,
) -> xr.Dataset:
    """Read a COMSOL text export: spreadsheet (txt, csv, dat), grid or sectionwise.

    Parameters
    ----------
    path : str or path
    x, z : str, optional
        The file's coordinates that are the lateral x and the depth z, such as ``x="y", z="x"``. By default the
        first that varies is x and the second z. The depth keeps the file's origin.
    expression : str, optional
        The file's expression that becomes `p`. By default the total pressure (``acpr.p_t``, ``pabe.p_t``), else the
        pressure (``p``, ``acpr.p``), else ``real(...)`` and ``imag(...)`` of it.
    conjugate : bool
        Bring complex values from COMSOL's exp(+i w t) to exp(-i w t).
    length_unit, angle_unit : str, optional
        Unit of the coordinates, and of an angle such as ``theta=45``, where the file states none.
        By default m and degrees are taken, with a warning.

    Returns
    -------
    Dataset
        `p` [Pa] complex and the other expressions under names without the physics' tag, complex or real, with their
        units; dims (frequency, angle, other parameters, z, x). A parameter with one value is a scalar coordinate.
        Points that form no grid have the dim `node`, with coordinates x(node) and z(node): see `to_grid`, and `compare`.
        Rows that are no points have the dim `row` and no coordinates, each column a variable in the file's unit: tables
        (``% Table``), plots of curves (``R, Height``), sweeps (``k1, ...``). x= or z= makes a line of them.

    Raises
    ------
    ValueError
        What cannot be read without doubt, with the file, the line, what was expected and what came.
    OSError
        The file cannot be opened.

    Warns
    -----
    UserWarning
        Combinations of parameters that are missing (NaN in the dataset), and everything that had to be assumed.

    Examples
    --------
    >>> rows = ["% x (m)   y (m)   p (Pa) @ freq=2500", "0 0 1+2i", "1 0 3+4i", "0 1 5+6i", "1 1 7+8i"]
    >>> with open("export.txt", "w") as file:
    ...     for row in rows:
    ...         print(row, file=file)
    >>> ds = bp.read_comsol("export.txt")
    >>> complex(ds.p.sel(x=0, z=0))  # conjugated
    (1-2j)
    """
    _check_arguments(x, z, expression, conjugate, length_unit, angle_unit)
    source = scan(str(validate.as_path(path)))
    factor = length_factor(source, length_unit)
    kinds = [m[1].lower() for _, text in source.header if (m := SECTION.fullmatch(text))]
    reader = READERS.get(kinds[0] if kinds else "")
    placed = x is not None or z is not None
    table = reader(source, factor) if reader else read_spreadsheet(source, factor, placed, expression)
    if table.coordinates and length_unit is None and source.meta.get("length unit", "null") in ("", "null"):
        warnings.warn(
            f"{path}: states no unit of length, metres taken (length_unit= or --length-unit says otherwise)",
            stacklevel=2,
        )
    return make_dataset(table, (x, z), expression, conjugate, angle_unit)


def to_grid(ds: xr.Dataset, x: Any, z: Any) -> xr.Dataset:
    """Bring scattered nodes onto a grid by linear interpolation on the Delaunay triangles of the nodes.

    Parameters
    ----------
    ds : Dataset
        With a dim `node` and coordinates x(node), z(node), from `read_comsol`.
    x, z : 1-D arrays, m
        Strictly increasing.

    Returns
    -------
    Dataset
        The same variables with dims (..., z, x); NaN outside the nodes' convex hull.

    Examples
    --------
    >>> import xarray as xr
    >>> nodes = {"x": ("node", [0.0, 1.0, 0.0, 1.0]), "z": ("node", [0.0, 0.0, 1.0, 1.0])}
    >>> scattered = xr.Dataset({"p": ("node", [1.0, 2.0, 3.0, 4.0])}, nodes)
    >>> float(bp.to_grid(scattered, x=[0.25, 0.75], z=[0.5, 0.6]).p[0, 0])
    2.25
    """
    if not isinstance(ds, xr.Dataset) or "node" not in ds.dims:
        dims = ", ".join(map(str, ds.dims)) or "none" if isinstance(ds, xr.Dataset) else type(ds).__name__
        raise ValueError(f"ds: expected a dataset with the dim 'node', got {dims}")
    axes = {name: validate.positions(v, name, increasing=True) for name, v in (("x", x), ("z", z))}
    points = axes["x"].size * axes["z"].size
    memory.check("x", 120.0 * points, f"a grid of {points:.3g} points", "take fewer points")
    missing = [n for n in ("x", "z") if n not in ds.variables or ds[n].dims != ("node",)]
    if missing:
        raise ValueError(f"ds: expected coordinates x and z of the nodes, got none for {', '.join(missing)}")
    nodes = [validate.positions(ds[n].values, "ds") for n in ("x", "z")]
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import Delaunay, QhullError

    try:
        triangles = Delaunay(np.stack(nodes, axis=-1))
    except QhullError:
        raise ValueError(
            f"ds: expected three nodes or more that span a plane, got {nodes[0].size} that do not"
        ) from None
    targets = np.stack(np.meshgrid(axes["x"], axes["z"]), axis=-1)
    out = ds.drop_dims("node")
    for name in ("x", "z"):
        out = out.assign_coords({name: (name, axes[name], ds[name].attrs)})
    for key, variable in ds.data_vars.items():
        if "node" not in variable.dims:
            continue
        lead = [d for d in variable.dims if d != "node"]
        on_nodes = variable.transpose("node", *lead).values
        on_grid = np.moveaxis(LinearNDInterpolator(triangles, on_nodes)(targets), (0, 1), (-2, -1))
        out[key] = ((*lead, "z", "x"), on_grid, variable.attrs)
    return out


def _check_arguments(x: Any, z: Any, expression: Any, conjugate: Any, length_unit: Any, angle_unit: Any) -> None:
    names = {"x": x, "z": z, "expression": expression, "length_unit": length_unit, "angle_unit": angle_unit}
    for name, value in names.items():
        if value is not None and not (isinstance(value, str) and value.strip()):
            raise validate.refuse(name, "a name", value)
    validate.flag(conjugate, "conjugate")
    if x is not None and x == z:
        raise ValueError(f"z: expected another coordinate than x, got {z!r} for both")
    for name, table in (("length_unit", LENGTHS), ("angle_unit", ANGLES)):
        if names[name] is not None and plain_unit(names[name]) not in table:
            raise ValueError(f"{name}: expected one of {', '.join(table)}, got {names[name]!r}")
