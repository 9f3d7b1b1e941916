"""What a picture says of its dataset: names of axes and quantities, and where it was taken."""

from __future__ import annotations

from typing import Any

import xarray as xr

from .. import validate


def need(ds: xr.Dataset, *names: str) -> None:
    """Refuse a dataset that lacks some variables."""
    validate.instance(ds, xr.Dataset, "ds")
    missing = [n for n in names if n not in ds.variables]
    if missing:
        raise ValueError(f"ds: expected a dataset with {', '.join(names)}, got one without {', '.join(missing)}")


def text_or_none(value: Any, name: str) -> str | None:
    """A word, or None."""
    if value is not None and not isinstance(value, str):
        raise validate.refuse(name, "a word", value)
    return value


def title_of(v: Any) -> str:
    """Long name and unit of a variable."""
    unit = v.attrs.get("units", "")
    name = v.attrs.get("long_name", v.name)
    return name if unit in ("", "1") else f"{name} [{unit}]"
