"""How a quantity on several axes is spread over a picture: curves, a map, panels of either, and the words for each part."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from .. import validate
from . import labels, units

#: Curves that an eye tells apart in one Axes, which are also the line styles of the style file; and panels of a figure.
MOST = 8
#: Names of dimensions in pictures, where they are not the long names of the dataset.
SHORT = {"kx_over_k0": "$k_x/k_0$", "kx": "$k_x$", "angle": "angle"}

#: Letters of a line of a title.
TITLE = 56
#: Units of coordinates that do not tell theirs.
UNITS = {"frequency": "Hz", "angle": "degree", "x": "m", "y": "m", "z": "m"}
#: Coordinates that say the same: the first that has a value is told.
LATERAL = ("angle", "kx_over_k0", "kx")


def is_number(v: xr.DataArray) -> bool:
    """Whether values are real numbers, which an axis can show."""
    return v.dtype.kind in "fiu"


def axis_along(v: xr.DataArray, along: str | None, *first: str) -> str:
    """The dimension that is the horizontal axis: `along`, or of those named first, then of all others by size, the first that is long.

    Raises
    ------
    ValueError
        There is no axis, or not the one wanted, or it is complex.

    Examples
    --------
    >>> v = xr.DataArray(np.zeros((3, 40)), dims=("angle", "frequency"), coords={"angle": range(3), "frequency": range(40)})
    >>> axis_along(v, None, "angle", "frequency"), axis_along(v, "angle")
    ('frequency', 'angle')
    """
    dims = [str(d) for d in v.dims if v.sizes[d] > 1]
    if labels.text_or_none(along, "along") is not None and along not in dims:
        raise validate.refuse("along", " or ".join(dims) or "none, for there is one value", along)
    ordered = [d for d in first if d in dims] + sorted((d for d in dims if d not in first), key=lambda d: -v.sizes[d])
    numeric = [d for d in ordered if d not in v.coords or is_number(v[d])] or ordered
    if not numeric:
        raise ValueError(f"ds: expected an axis of several values{_such_as(first)}, got one value")
    chosen = along or next((d for d in numeric if v.sizes[d] > MOST), numeric[0])
    if chosen in v.coords and v[chosen].dtype.kind == "c":
        raise ValueError(f"ds: expected real values of {chosen}, got complex ones")
    return chosen


def _such_as(names: tuple[str, ...]) -> str:
    return f", such as {' or '.join(names)}" if names else ""


class Plan(NamedTuple):
    """How a quantity is spread: the dimension of the panels, if there are any, and whether each is a map."""

    panels: str | None
    is_map: bool


def plan(v: xr.DataArray, along: str, most: int = MOST) -> Plan:
    """Up to `most` curves, or so many in each panel along the shortest dimension that leaves no more; else a map, or panels of maps.

    Raises
    ------
    ValueError
        More panels than `MOST`, or curves along words: says which to select.

    Examples
    --------
    >>> plan(xr.DataArray(np.zeros((9, 3, 50)), dims=("angle", "eta", "frequency")), "frequency")
    Plan(panels='eta', is_map=True)
    """
    across = sorted((str(d) for d in v.dims if d != along), key=lambda d: v.sizes[d])
    within = {None: across} | {p: [d for d in across if d != p] for p in across if v.sizes[p] <= MOST}
    for panels, dims in within.items():
        if math.prod(v.sizes[d] for d in dims) <= most:
            return Plan(panels, False)
    for panels, dims in within.items():
        if len(dims) == 1 and all(d not in v.coords or is_number(v[d]) for d in (dims[0], along)):
            return Plan(panels, True)
    shown = ", ".join(f"{d} {v.sizes[d]}" for d in across)
    raise ValueError(
        f"ds: expected at most {MOST} curves or panels beside {along}, got {shown}: select some with ds.isel({across[-1]}=[...])"
    )


def in_order(v: xr.DataArray) -> xr.DataArray:
    """With growing values along every axis of numbers."""
    return v.sortby([d for d in v.dims if d in v.coords and is_number(v[d])])


def name_of(v: xr.DataArray, otherwise: str) -> str:
    """What a dimension or quantity is called on an axis."""
    return SHORT.get(str(v.name)) or str(v.attrs.get("long_name", v.name or otherwise)).replace(
        "^2", "\N{SUPERSCRIPT TWO}"
    )


def said(v: xr.DataArray | xr.Dataset, dim: str, index: int, digits: int = 4) -> str:
    """A value of a coordinate, in words, to so many digits unless it is whole.

    Examples
    --------
    >>> v = xr.DataArray(np.zeros(2), dims="eta", coords={"eta": ("eta", [0.05, 0.1], {"units": "1"})})
    >>> said(v, "eta", 0)
    'eta = 0.05'
    """
    value, unit = np.ravel(v[dim].values)[index], v[dim].attrs.get("units", UNITS.get(dim, ""))
    if not is_number(v[dim]):
        return str(value)
    value = float(value if value == np.round(value) else f"{value:.{digits}g}")
    if unit in ("Hz", "degree") and dim != "azimuth":
        return units.quantity(value, unit)
    text = units.number(value) if unit in ("", "1") else units.quantity(value, unit)
    return f"{SHORT.get(dim, dim.replace('_', ' '))} = {text}"


def where(v: xr.DataArray | xr.Dataset) -> str:
    """What is held at one value: frequency, angle (or kx), position and all else that is a number, for a title.

    Examples
    --------
    >>> where(xr.DataArray(np.zeros(2), dims="z", coords={"z": [0.0, 1.0], "frequency": 2500.0, "x": 0.005}))
    '2500 Hz, x = 5 mm'
    """
    names = [n for n in map(str, v.coords) if v[n].size == 1 and is_number(v[n]) and np.all(np.isfinite(v[n].values))]
    lateral = [n for n in LATERAL if n in names]
    first = [n for n in ("frequency", *lateral[:1]) if n in names]
    rest = [n for n in names if n not in first and n not in lateral]
    return textwrap.fill(", ".join(said(v, n, 0, 6) for n in first + rest), TITLE)


def each(v: xr.DataArray, along: str) -> Iterator[tuple[str, np.ndarray]]:
    """The curves along a dimension: the words for the other ones, and the values."""
    across = [str(d) for d in v.dims if d != along]
    for index in np.ndindex(*(v.sizes[d] for d in across)):
        words = [said(v, d, i) for d, i in zip(across, index, strict=True)]
        yield ", ".join(words), v.isel(dict(zip(across, index, strict=True))).values
