"""Fields for ParaView, in VTK's XML formats for even and uneven grids: a description, and behind it the numbers as they are in memory.

x, y and z are VTK's own three axes; a dimension that a dataset has not has one point. Points are counted with x first.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import xarray as xr

#: VTK's axes.
AXES = ("x", "y", "z")
#: Steps of a grid may differ by this share and be even: positions are rounded numbers.
EVEN = 1e-6
#: Arrays in one file, among which a reader chooses by name.
MOST = 1000

#: An array's tag with its attributes, and its numbers.
Array = tuple[str, np.ndarray]


def image(ds: xr.Dataset) -> list[bytes]:
    """A file of an even grid (.vti)."""
    ds, axes = _on_axes(ds)
    steps = {}
    for name, values in axes.items():
        steps[name] = float(values[-1] - values[0]) / max(1, values.size - 1) or 1.0
        if np.max(np.abs(np.diff(values) - steps[name]), initial=0.0) > EVEN * steps[name]:
            raise ValueError(
                f"path: expected .vtr for positions that are not even, got .vti and {name} with steps of several sizes"
            )
    where = f'Origin="{_list(float(v[0]) for v in axes.values())}" Spacing="{_list(steps.values())}"'
    return _file("ImageData", where, ds, axes, [])


def rectilinear(ds: xr.Dataset) -> list[bytes]:
    """A file of a grid with any positions (.vtr)."""
    ds, axes = _on_axes(ds)
    return _file(
        "RectilinearGrid", "", ds, axes, [array for name, values in axes.items() for array in _parts(name, values)]
    )


def _on_axes(ds: xr.Dataset) -> tuple[xr.Dataset, dict[str, np.ndarray]]:
    """The dataset with its positions in ascending order, and the positions on each axis."""
    present = [name for name in AXES if name in ds.dims]
    if not present:
        raise ValueError(
            f"ds: expected a field on x, y or z, which ParaView draws, got the dimensions {', '.join(map(str, ds.dims)) or 'none'}: write .csv or .nc"
        )
    axes = {name: np.atleast_1d(np.asarray(ds[name].values if name in ds.variables else 0.0)) for name in AXES}
    for name in AXES:
        if (
            axes[name].dtype.kind not in "iuf"
            or not np.all(np.isfinite(axes[name]))
            or np.unique(axes[name]).size != axes[name].size
        ):
            raise ValueError(f"ds: expected positions {name} that are numbers, finite and each there once, got others")
    return ds.sortby(present), {name: np.sort(values.astype(float)) for name, values in axes.items()}


def _file(kind: str, where: str, ds: xr.Dataset, axes: dict[str, np.ndarray], coordinates: list[Array]) -> list[bytes]:
    """The pieces of a file, from arrays in the order in which their numbers follow the description."""
    extent = _list(f"0 {values.size - 1}" for values in axes.values())
    groups = {"FieldData": _without_position(ds), "Coordinates": coordinates, "PointData": _on_points(ds, axes)}
    tags, numbers, offset = {}, [], 0
    for group, arrays in groups.items():
        lines = []
        for about, values in arrays:
            lines.append(f'<{about} format="appended" offset="{offset}"/>\n')
            numbers += [np.array(values.nbytes, "<u8").tobytes(), values.tobytes()]
            offset += 8 + values.nbytes
        tags[group] = f"<{group}>\n{''.join(lines)}</{group}>\n" if lines else ""
    head = (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<{kind} WholeExtent="{extent}" {where}>\n{tags["FieldData"]}<Piece Extent="{extent}">\n'
        f'{tags["Coordinates"]}{tags["PointData"]}</Piece>\n</{kind}>\n<AppendedData encoding="raw">\n_'
    )
    return [head.encode(), *numbers, b"\n</AppendedData>\n</VTKFile>\n"]


def _on_points(ds: xr.Dataset, axes: dict[str, np.ndarray]) -> list[Array]:
    """The arrays on the grid, one for each value of the other dimensions."""
    shape = {name: values.size for name, values in reversed(axes.items())}
    arrays = []
    for name, v in ds.variables.items():
        if name in AXES or not set(v.dims) & set(AXES):
            continue
        if v.dtype.kind not in "biufc":
            raise ValueError(f"ds: expected numbers on x, y, z, which ParaView draws, got {name!r} of type {v.dtype}")
        named = [dim for dim in v.dims if dim not in AXES]
        for index in itertools.product(*(range(ds.sizes[dim]) for dim in named)):
            whole = v.isel(dict(zip(named, index, strict=True))).set_dims(shape).transpose(*shape)
            label = ", ".join(_place(ds, dim, k) for dim, k in zip(named, index, strict=True))
            arrays += _parts(str(name), whole.values, f" ({label})" if label else "")
            if len(arrays) > MOST:
                raise ValueError(f"ds: expected at most {MOST} arrays in a file, got more: take some by ds.isel")
    return arrays


def _place(ds: xr.Dataset, dim: Any, index: int) -> str:
    """Where a dimension stands, in words."""
    if dim not in ds.variables:
        return f"{dim} {index}"
    value = ds[dim].values[index]
    number = f"{value:.15g}" if ds[dim].dtype.kind in "iufc" else str(value)
    units = ds[dim].attrs.get("units", "1")
    return f"{dim} {number}" + (f" {units}" if units != "1" else "")


def _without_position(ds: xr.Dataset) -> list[Array]:
    """What is no field: numbers, the dataset's attributes, and all units."""
    arrays = []
    for name, v in ds.variables.items():
        if not set(v.dims) & set(AXES) and v.dtype.kind in "biufc":
            arrays += _parts(str(name), np.atleast_1d(v.values), "", count=True)
    units = ", ".join(f"{name}: {v.attrs['units']}" for name, v in ds.variables.items() if "units" in v.attrs)
    for name, text in {**ds.attrs, "units": units}.items():
        letters = np.frombuffer(str(text).encode() + b"\0", np.uint8)
        arrays.append((f'Array Name={quoteattr(str(name))} type="String" NumberOfTuples="1"', letters))
    return arrays


def _parts(name: str, values: np.ndarray, label: str = "", count: bool = False) -> list[Array]:
    """Arrays of real numbers with their tags: of complex ones real and imaginary part, magnitude and phase."""
    parts = {"": values}
    if values.dtype.kind == "c":
        parts = {"_real": values.real, "_imag": values.imag, "_abs": np.abs(values), "_phase": np.angle(values)}
    arrays = []
    for part, numbers in parts.items():
        kind, word = ("<f8", "Float64") if numbers.dtype.kind == "f" else ("<i8", "Int64")
        about = f'DataArray Name={quoteattr(name + part + label)} type="{word}"'
        about += f' NumberOfTuples="{numbers.size}"' if count else ""
        arrays.append((about, np.ascontiguousarray(numbers, kind)))
    return arrays


def _list(values: Iterable[Any]) -> str:
    return " ".join(str(v) for v in values)
