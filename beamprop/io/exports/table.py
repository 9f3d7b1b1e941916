"""A table of what has one dimension, as text with commas between (RFC 4180)."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np
import xarray as xr


def rows(ds: xr.Dataset) -> list[bytes]:
    """The table: a header of names and units, a row for each value of the dimension."""
    ds = ds.squeeze()  # a dimension of length one is a scalar
    if len(ds.dims) > 1:
        sizes = ", ".join(f"{dim} {size}" for dim, size in ds.sizes.items())
        first = next(iter(ds.dims))
        raise ValueError(
            f"ds: expected one dimension, which a table has, got {sizes}: take one value by ds.isel({first}=0), or write .nc or .mat"
        )
    length = next(iter(ds.sizes.values()), 1)
    columns: dict[str, list[str]] = {}
    for name in (*ds.dims, *ds.data_vars, *ds.coords):
        if name in ds.variables:
            columns |= {
                header: np.broadcast_to(values, length).tolist() for header, values in _columns(str(name), ds[name])
            }
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(map(_cell, column) for column in columns.values()), strict=True))
    return [text.getvalue().encode()]


def _columns(name: str, v: xr.DataArray) -> list[tuple[str, Any]]:
    unit = f" ({v.attrs['units']})" if "units" in v.attrs and v.dtype.kind in "iufc" else ""
    parts = {"_real": v.values.real, "_imag": v.values.imag} if v.dtype.kind == "c" else {"": v.values}
    return [(f"{name}{part}{unit}", values) for part, values in parts.items()]


def _cell(value: Any) -> str:
    """All digits of a number; the words for what is none are those that MATLAB, Octave, R and pandas take for numbers."""
    text = str(value)
    return {"nan": "NaN", "inf": "Inf", "-inf": "-Inf"}.get(text, text) if isinstance(value, float) else text
