"""One page of stored results that needs no server: selectors over the dimensions of a dataset, everything inside the file."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import memory
from ..study.files import StudyFile
from .panels import plain
from .routes import text_of
from .start import colour_maps

if TYPE_CHECKING:
    import xarray as xr

#: Bytes of values that a page may hold: a browser reads such a page in a second or so.
MOST_BYTES = 50e6
SCRIPTS = ("plots.js", "map.js", "stored.js")


def page(source: StudyFile | Path) -> str:
    """The page of a dataset, or of the stored answer of a study.

    Parameters
    ----------
    source : StudyFile or path
        A study whose store or file is there, or a .nc, .zarr or .mat.

    Raises
    ------
    ValueError
        There is no answer, or it is larger than a page may be.
    """
    from ..io.storage import load

    path = _answer_of(source) if isinstance(source, StudyFile) else source
    ds = load(path)
    title = source.path.stem if isinstance(source, StudyFile) else path.stem
    return html_of(title, data_of(ds))


def _answer_of(study: StudyFile) -> Path:
    """Where the answer of a study is stored."""
    targets = [Path(study.output[key]) for key in ("store", "file") if study.output[key]]
    for target in targets:
        if target.exists():
            return target
    where = " or ".join(target.name for target in targets) or "a store or file in [output]"
    raise ValueError(
        f"export: expected the stored answer of the study in {where}, got none; run it first: beamprop run {study.path.name}"
    )


def data_of(ds: xr.Dataset) -> dict[str, Any]:
    """Variables and coordinates of a dataset as JSON can hold them: values in base64, as float32, of complex ones both parts.

    Examples
    --------
    >>> from beamprop.explorer.stored import data_of
    >>> ds = bp.scattering(bp.Slab(bp.lmmd_cell(), periods=2), 2500.0, kx_over_k0=[0.0, 1.0])
    >>> data_of(ds)["variables"]["transmissivity"]["dims"]
    ['kx_over_k0']
    """
    shown = {str(name): v for name, v in ds.data_vars.items() if v.dtype.kind in "fciu" and v.size > 0}
    size = sum(v.size * (8.0 if v.dtype.kind == "c" else 4.0) for v in shown.values())
    if size > MOST_BYTES:
        raise ValueError(
            f"export: expected at most {memory.text(MOST_BYTES)} of values in a page, got {memory.text(size)}; select a part with xarray first"
        )
    if not shown:
        raise ValueError("export: expected a dataset with numbers, got none")
    dims = dict.fromkeys(str(d) for v in shown.values() for d in v.dims)
    return {
        "variables": {name: _about(v) | {"values": _text(v.values)} for name, v in shown.items()},
        "coords": {d: _coordinate(ds, d) for d in dims},
        "thickness": ds.attrs.get("slab_thickness"),
    }


def _about(v: xr.DataArray) -> dict[str, Any]:
    return {
        "dims": [str(d) for d in v.dims],
        "units": str(v.attrs.get("units", "")),
        "long_name": str(v.attrs.get("long_name", v.name)),
        "complex": v.dtype.kind == "c",
    }


def _coordinate(ds: xr.Dataset, dim: str) -> dict[str, Any]:
    """Its values: numbers, words, or where it has none the places from 0 on."""
    if dim not in ds.coords:
        return {"values": list(range(ds.sizes[dim])), "units": "", "long_name": dim, "complex": False, "dims": [dim]}
    v = ds[dim]
    return _about(v) | {"values": v.values.tolist() if v.dtype.kind in "fiu" else [str(each) for each in v.values]}


def _text(values: np.ndarray) -> str:
    parts = [values.real, values.imag] if values.dtype.kind == "c" else [values]
    return base64.b64encode(b"".join(np.ascontiguousarray(part, "<f4").tobytes() for part in parts)).decode()


def html_of(title: str, data: dict[str, Any]) -> str:
    """The page: style, scripts and data inside, and a policy under which nothing else runs and nothing is fetched."""
    style = text_of("page.css").decode()
    scripts = [text_of(name).decode() for name in SCRIPTS]
    policy = f"default-src 'none'; style-src {_hash(style)}; script-src {' '.join(map(_hash, scripts))}; img-src data:"
    inner = json.dumps(plain(data | {"colours": colour_maps(), "title": title}), allow_nan=False).replace(
        "<", "\\u003c"
    )
    return (
        text_of("stored.html")
        .decode()
        .replace("{policy}", policy)
        .replace("{title}", html.escape(title))
        .replace("{style}", f"<style>{style}</style>")
        .replace("{scripts}", "\n".join(f"<script>{script}</script>" for script in scripts))
        .replace("{data}", inner)
    )


def _hash(text: str) -> str:
    """A text as a policy names it."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
