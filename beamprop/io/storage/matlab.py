"""MATLAB's files (.mat, version 5): each variable an array of its name, complex as complex; a struct tells the rest.

The struct `ABOUT` has a field for each variable, with its dimensions, units and other attributes, and a field `DATASET` with the attributes of the
whole. It is what `read` makes the dataset from.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .parts import as_text
from .settled import Refusal

ABOUT, DATASET = "about", "dataset"
#: Names that MATLAB takes, and what it holds in one variable [bytes].
NAME, MOST = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII), 2**31
#: Fields of `ABOUT` that are no attributes.
FIELDS = ("dims", "shape", "dtype", "coordinate")


def write(draft: Path, ds: xr.Dataset, _level: int) -> None:
    """Write a dataset; zlib's level does not concern .mat, whose compression is what tells damage."""
    from scipy.io import savemat

    about: dict[str, Any] = {DATASET: _attributes("the dataset", ds.attrs)}
    values: dict[str, Any] = {}
    for key, v in ds.variables.items():
        name = _name(key, "variable")
        if name in (ABOUT, DATASET):
            raise ValueError(
                f"ds: expected another name than {name!r}, which is taken in .mat, got a variable of that name"
            )
        if v.nbytes >= MOST:
            raise ValueError(
                f"ds: expected variables below 2 GiB, which is what .mat holds, got {name!r} of {v.nbytes / 2**30:.3g} GiB: write .nc"
            )
        text = as_text(v)
        if text is None and v.dtype.kind not in "biufc":
            raise ValueError(f"ds: expected numbers or text, which .mat holds, got {name!r} of type {v.dtype}")
        data = v.values if text is None else text
        fields = " ".join(map(str, v.dims)), np.array(v.shape, float), str(data.dtype), float(key in ds.coords)
        about[name] = dict(zip(FIELDS, fields, strict=True)) | _attributes(repr(name), v.attrs)
        values[name] = data if text is None else data.astype(object)  # words as a cell array
    savemat(draft, values | {ABOUT: about}, long_field_names=True, do_compression=True, oned_as="column")


def _name(key: Any, what: str) -> str:
    if not isinstance(key, str) or not NAME.fullmatch(key):
        raise ValueError(
            f"ds: expected names of letters, digits and _, at most 63, which MATLAB takes, got the {what} {key!r}: write .nc"
        )
    return key


def _attributes(where: str, attrs: dict[Any, Any]) -> dict[str, Any]:
    for key, value in attrs.items():
        if _name(key, "attribute") in FIELDS:
            raise ValueError(
                f"ds: expected no attribute {key!r}, which is a field of its own in .mat, got one of {where}"
            )
        if not isinstance(value, str | int | float | np.number | np.ndarray | list | tuple):
            raise ValueError(f"ds: expected attributes that are text or numbers, got {key!r} of {where}: {value!r:.60}")
    return dict(attrs)


def read(path: Path) -> xr.Dataset:
    """Read a file into memory.

    Raises
    ------
    ValueError
        Names the file, and the variable, that is damaged or no dataset's.
    """
    from scipy.io import loadmat

    try:
        content = loadmat(path, simplify_cells=True)
    except MemoryError:
        raise
    except Exception as error:
        raise ValueError(
            f"{path}: expected a .mat file of version 5, got one that cannot be read, damaged or cut off ({error})"
        ) from None
    about = content.get(ABOUT)
    if not isinstance(about, dict) or not isinstance(about.get(DATASET), dict):
        raise Refusal(
            f"{path}: expected a .mat file that save wrote, got one without the struct {ABOUT!r}: {', '.join(content)}"
        )
    whole: dict[str, Any] = {"attrs": _texts(about.pop(DATASET)), "coords": {}, "data_vars": {}}
    for name, fields in about.items():
        try:
            where = "coords" if fields["coordinate"] else "data_vars"
            whole[where][name] = _variable(content[name], dict(fields))
        except (LookupError, TypeError, ValueError) as error:
            raise ValueError(f"{path}: expected variable {name!r} as it was written, got another ({error})") from None
    return xr.Dataset.from_dict(whole)


def _variable(value: Any, fields: dict[str, Any]) -> dict[str, Any]:
    dims, shape, dtype, _ = (fields.pop(name) for name in FIELDS)
    data = np.asarray(value)
    if np.dtype(dtype).kind == "U":  # an empty word comes back as an array of none
        data = np.array([word if isinstance(word, str) else "" for word in data.ravel()])
    data = data.astype(np.dtype(dtype)).reshape(np.atleast_1d(shape).astype(int))
    return {"dims": dims.split() if len(dims) else [], "data": data, "attrs": _texts(fields)}


def _texts(attrs: dict[str, Any]) -> dict[str, Any]:
    """Attributes, the empty text among them, which comes back as an array of none."""
    return {
        key: "" if isinstance(a, np.ndarray) and a.dtype.kind == "U" and not a.size else a for key, a in attrs.items()
    }
