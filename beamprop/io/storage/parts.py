"""What the readers of netCDF and Zarr have in common: arrays of real numbers; complex variables as pairs of them, text as codes with a list of words.

A complex `p` becomes `p_real` and `p_imag`. Words become whole numbers with CF's attributes ``flag_values`` and ``flag_meanings``. Arrays of
characters would be the other form, but Octave's ``load`` gives up at one, with all variables whose names come later. Whole numbers have 32 bits,
for ParaView gives up at one of 64. Zarr's text is in no specification yet, and its complex numbers are.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

#: Attributes that lead back to the complex variable, and to the words.
PAIR = ("part_of", "formula", "was_coordinate")
FLAGS = ("flag_values", "flag_meanings", "flag_words")
LONG = "was_int64"


def plain(ds: xr.Dataset, pairs: bool = True) -> xr.Dataset:
    """A dataset as all readers take it."""
    return coded(short(split(ds) if pairs else ds))


def restored(ds: xr.Dataset) -> xr.Dataset:
    """The dataset that it was."""
    return joined(worded(long(ds)))


# --- complex numbers ------------------------------------------------------------------------------------------


def pair_attributes(name: str, attrs: dict[str, Any], coordinate: bool = False) -> dict[str, dict[str, Any]]:
    """Names and attributes of the real and the imaginary part of a variable."""
    more: dict[str, Any] = {"part_of": name, "formula": f"{name} = {name}_real + 1i*{name}_imag"}
    more |= {"was_coordinate": 1} if coordinate else {}
    return {
        f"{name}_{part}": attrs
        | ({"long_name": f"{attrs['long_name']}, {part} part"} if "long_name" in attrs else {})
        | more
        for part in ("real", "imag")
    }


def split(ds: xr.Dataset) -> xr.Dataset:
    """Complex variables and coordinates as pairs of real ones."""
    pairs: dict[str, Any] = {}
    whole = {str(name): v for name, v in ds.variables.items() if v.dtype.kind == "c"}
    for name, v in whole.items():
        attributes = pair_attributes(name, dict(v.attrs), name in ds.coords)
        for (part, attrs), values in zip(attributes.items(), (v.data.real, v.data.imag), strict=True):
            if part in ds.variables:
                raise ValueError(
                    f"ds: expected no variable {part!r} beside the complex {name!r}, a part of which it would be"
                )
            pairs[part] = (v.dims, values, attrs)
    return ds.drop_vars(list(whole)).assign(pairs)


def joined(ds: xr.Dataset) -> xr.Dataset:
    """Pairs of real variables as the complex ones they came from; structured {r, i} as complex."""
    whole: dict[str, Any] = {}
    places: list[str] = []
    parts: list[str] = []
    for name, v in ds.variables.items():
        if v.dtype.names == ("r", "i"):
            whole[str(name)] = (v.dims, _complex(v.values["r"], v.values["i"]), v.attrs)
        part_of = v.attrs.get("part_of")
        imag = ds.variables.get(f"{part_of}_imag") if str(name) == f"{part_of}_real" else None
        if isinstance(part_of, str) and imag is not None and imag.dims == v.dims:
            attrs = {k: a for k, a in v.attrs.items() if k not in PAIR}
            if "long_name" in attrs:
                attrs["long_name"] = attrs["long_name"].removesuffix(", real part")
            places += [part_of] if v.attrs.get("was_coordinate") else []
            parts += [str(name), f"{part_of}_imag"]
            whole[part_of] = (v.dims, _complex(v.values, imag.values), attrs)
    return ds.drop_vars(parts).assign(whole).set_coords(places)


def _complex(real: np.ndarray, imag: np.ndarray) -> np.ndarray:
    """Put together rather than computed: 1j times infinity has a real part of NaN."""
    out = np.empty(real.shape, np.result_type(real, np.complex64))
    out.real, out.imag = real, imag
    return out


# --- whole numbers ------------------------------------------------------------------------------------------


def short(ds: xr.Dataset) -> xr.Dataset:
    """Whole numbers of 64 bits in 32, where those hold them."""
    most = np.iinfo(np.int32).max
    fitting = {n: v for n, v in ds.variables.items() if v.dtype == np.int64 and np.all(np.abs(v.values) <= most)}
    return ds.assign({n: (v.dims, v.values.astype(np.int32), v.attrs | {LONG: 1}) for n, v in fitting.items()})


def long(ds: xr.Dataset) -> xr.Dataset:
    """Those whole numbers in 64 bits again."""
    shortened = {n: v for n, v in ds.variables.items() if LONG in v.attrs and v.dtype.kind == "i"}
    plain = {n: {k: a for k, a in v.attrs.items() if k != LONG} for n, v in shortened.items()}
    return ds.assign({n: (v.dims, v.values.astype(np.int64), plain[n]) for n, v in shortened.items()})


# --- words ----------------------------------------------------------------------------------------------------


def as_text(v: xr.Variable) -> np.ndarray | None:
    """The words of a variable of text; None of others."""
    if v.dtype.kind not in "OUT" or (v.dtype.kind == "O" and not all(isinstance(s, str) for s in v.values.flat)):
        return None
    return np.array(v.values.tolist(), dtype=str)  # of NumPy's two types of text the one that all libraries know


def coded(ds: xr.Dataset) -> xr.Dataset:
    """Text as whole numbers, with the words in attributes."""
    flags: dict[str, Any] = {}
    for name, v in ds.variables.items():
        if (text := as_text(v)) is not None and v.size:
            words, codes = np.unique(text, return_inverse=True)
            values = (
                np.arange(words.size, dtype=np.int32),
                " ".join("_".join(w.split()) for w in words.tolist()),
                json.dumps(words.tolist()),
            )
            attrs = v.attrs | dict(zip(FLAGS, values, strict=True))
            flags[str(name)] = (v.dims, codes.reshape(v.shape).astype(np.int32), attrs)
    return ds.assign(flags)


def worded(ds: xr.Dataset) -> xr.Dataset:
    """Text again from its codes, and as NumPy's text from any other form."""
    text: dict[str, Any] = {}
    for name, v in ds.variables.items():
        words = _words(v)
        if words is not None:
            text[str(name)] = (v.dims, words[v.values], {k: a for k, a in v.attrs.items() if k not in FLAGS})
        elif v.size and (values := as_text(v)) is not None:
            text[str(name)] = (v.dims, values, v.attrs)
    return ds.assign(text)


def _words(v: xr.Variable) -> np.ndarray | None:
    """The words that the codes of a variable stand for; None where they are no such codes."""
    try:
        words = json.loads(v.attrs["flag_words"])
        fitting = (
            isinstance(words, list) and v.dtype.kind == "i" and v.values.min() >= 0 and v.values.max() < len(words)
        )
    except (KeyError, TypeError, ValueError, RecursionError):
        return None
    return np.array(words, dtype=str) if fitting and all(isinstance(w, str) for w in words) else None
