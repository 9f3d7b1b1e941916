"""Complex variables as pairs of real ones, for readers that know no complex numbers, and back."""

from __future__ import annotations

from typing import Any

import xarray as xr


def split(ds: xr.Dataset) -> xr.Dataset:
    """Complex variables and coordinates as pairs of real ones."""
    pairs: dict[str, Any] = {}
    for name, v in ds.variables.items():
        if v.dtype.kind == "c":
            attrs = dict(v.attrs)
            where = {"was_coordinate": 1} if name in ds.coords else {}
            for part, values in (("real", v.values.real), ("imag", v.values.imag)):
                long_name = f"{attrs.get('long_name', name)}, {part} part"
                pairs[f"{name}_{part}"] = (
                    v.dims,
                    values,
                    attrs | {"long_name": long_name, "part_of": str(name)} | where,
                )
    return ds.drop_vars([n for n, v in ds.variables.items() if v.dtype.kind == "c"]).assign(pairs)


def joined(ds: xr.Dataset) -> xr.Dataset:
    """Pairs of real variables as the complex ones they came from; structured {r, i} as complex."""
    whole: dict[str, Any] = {}
    places: list[str] = []
    for name, v in ds.variables.items():
        if v.dtype.names == ("r", "i"):
            whole[str(name)] = (v.dims, v.values["r"] + 1j * v.values["i"], v.attrs)
        part_of = v.attrs.get("part_of")
        if part_of and str(name) == f"{part_of}_real" and f"{part_of}_imag" in ds.variables:
            attrs = {k: a for k, a in v.attrs.items() if k not in ("part_of", "was_coordinate")}
            if v.attrs.get("was_coordinate"):
                places.append(part_of)
            attrs["long_name"] = attrs.get("long_name", "").removesuffix(", real part")
            whole[part_of] = (v.dims, v.values + 1j * ds.variables[f"{part_of}_imag"].values, attrs)
            ds = ds.drop_vars([name, f"{part_of}_imag"])
    return ds.assign(whole).set_coords(places)
