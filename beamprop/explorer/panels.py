"""The answers that the page draws: plain arrays behind a line of JSON."""

from __future__ import annotations

import json
import math
import struct
import time
import warnings
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..study import questions
from . import cost, state
from .controls import Board, Description

if TYPE_CHECKING:
    import xarray as xr

Drawn = tuple[dict[str, Any], dict[str, np.ndarray]]
#: Widths at the frequency of the map.
WIDTHS = ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air")


def answer(board: Board, name: str, moved: Any) -> bytes:
    """The answer to a question at moved values, as the page reads it.

    Raises
    ------
    ValueError
        Names the value that is wrong, or says what the question would take.
    """
    start = time.perf_counter()
    described = state.description(board, state.values_of(board, moved), name)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        meta, arrays = _DRAWN[name](described, board, moved)
    said = dict.fromkeys(str(w.message) for w in caught if not issubclass(w.category, DeprecationWarning))
    return packed(meta | {"warnings": list(said), "seconds": time.perf_counter() - start}, arrays)


def ask(description: Description) -> xr.Dataset:
    """The dataset of a question that does not take too long."""
    cost.check(description)
    return questions.ask(description)


def packed(meta: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> bytes:
    """Length of the JSON (4 bytes, little-endian), the JSON, and arrays of float32 in its order.

    Examples
    --------
    >>> from beamprop.explorer.panels import packed
    >>> packed({}, {"x": np.zeros(1)})[4:].rstrip()
    b'{"arrays": [["x", [1]]]}    \\x00\\x00\\x00\\x00'
    """
    text = json.dumps(plain(dict(meta) | {"arrays": [[name, v.shape] for name, v in arrays.items()]}), allow_nan=False)
    head = text.encode()
    head += b" " * (-len(head) % 4)
    return b"".join([struct.pack("<I", len(head)), head, *(v.astype("<f4").tobytes() for v in arrays.values())])


def plain(value: Any) -> Any:
    """What JSON can hold: a number that is not finite is null."""
    if isinstance(value, Mapping):
        return {key: plain(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _field(description: Description, board: Board, moved: Any) -> Drawn:
    ds = ask(description)
    p = ds["p"].transpose("x", "z").values
    meta = {
        "thickness": float(ds.attrs["slab_thickness"]),
        "error": float(ds["error_estimate"]),
        "peak": float(np.percentile(np.abs(p[::4, ::4]), 99.8)),
    }
    return meta, {"x": ds["x"].values, "z": ds["z"].values, "re": p.real, "im": p.imag}


def _scattering(description: Description, board: Board, moved: Any) -> Drawn:
    ds = ask(description)
    names = ("kx_over_k0", "transmissivity", "reflectivity")
    return {}, {name: ds[name].values for name in names}


def _bloch(description: Description, board: Board, moved: Any) -> Drawn:
    ds = ask(description)
    kz = ds["kz_over_k0"].values
    return {}, {"kx_over_k0": ds["kx_over_k0"].values, "re": kz.real, "im": kz.imag}


def _beam_width(description: Description, board: Board, moved: Any) -> Drawn:
    """The curve, and behind it the widths at the frequency of the map."""
    curve = questions.arguments(description)["frequency"]
    here = state.values_of(board, moved)["question.frequency"]
    ds = ask(description | {"question": description["question"] | {"frequency": [*curve.tolist(), here]}})
    widths = {name: float(ds[name][-1]) for name in WIDTHS}
    arrays = {name: ds[name].values[:-1] for name in ("fwhm_in", "fwhm_out", "fwhm_air")}
    return {"here": {"frequency": here, **widths}}, {"frequency": curve, **arrays}


_DRAWN: dict[str, Callable[[Description, Board, Any], Drawn]] = {
    "field": _field,
    "scattering": _scattering,
    "bloch": _bloch,
    "beam_width": _beam_width,
}
