"""Arrays to labelled datasets: the only maker of xarray objects, and the record that rides in every one of them.

Each dataset carries one attribute, ``provenance``: JSON with the version, the question, the structure, the beam and the
settings. `describe` turns an object into such a record and `rebuild` makes the object again.
"""

from __future__ import annotations

import base64
import contextlib
import dataclasses
import functools
import hashlib
import json
import math
import zlib
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from .._version import __version__
from ..media import air, attenuation, effective, membranes, porous
from ..media.fluids import Fluid
from ..media.membranes import Membrane
from ..media.properties import Tabulated
from ..media.solids import Solid, SpeedOfModuli
from ..media.structures import Cell, Layer, Slab
from ..media.tolerance import Copy, Tolerance
from ..sources.array import Array
from ..sources.base import Beam
from ..sources.bowl import Bowl
from ..sources.gaussian import GaussianBeam
from ..sources.piston import Piston
from ..sources.profile import Profile
from ..sources.slits import Slits
from ..sources.source_plane import SourcePlane
from ..sources.source_sum import SourceSum
from .labels import label

#: The records that a file can hold; a dispersive property by any other function is kept as a table.
_RECORDS: dict[str, type] = {
    cls.__name__: cls
    for cls in (
        Fluid,
        Layer,
        Membrane,
        Solid,
        SpeedOfModuli,
        Cell,
        Slab,
        Tolerance,
        Copy,
        Array,
        Bowl,
        GaussianBeam,
        Piston,
        Profile,
        Slits,
        SourcePlane,
        SourceSum,
        Tabulated,
        *effective.FUNCTIONS,
        *attenuation.FUNCTIONS,
        *air.FUNCTIONS,
        *membranes.FUNCTIONS,
        *porous.FUNCTIONS,
    )
}

_KINDS = frozenset(_RECORDS.values())
_SOURCES = frozenset({Array, Bowl, GaussianBeam, Piston, Profile, Slits, SourcePlane, SourceSum})
#: Of an array of a source that has more numbers a checksum is recorded in their place: a hologram of 401 x 401 samples is 10 MB of text.
MOST_NUMBERS = 4096
#: Of a source of the user's own its class and so much of its text are recorded [characters].
MOST_TEXT = 1000
#: All records of a block of a study [bytes].
MOST_RECORDS = 2**28
#: The text of the last slab is kept if it has no more layers, for questions about many frequencies and angles one by one.
MOST_LAYERS = 1000


class _NeedsFrequency(Exception):
    """Ends a record that depends on the frequency."""


def describe(value: Any, frequency: np.ndarray | None) -> Any:
    """A JSON-ready record of a structure, beam or setting.

    A property that is some user's function of frequency is recorded by its values at `frequency` [Hz].
    """
    kind: Any = type(value)
    if kind in _SOURCES:
        return _record_of_source(value)
    if kind in _KINDS:
        fields = {name: describe(getattr(value, name), frequency) for name in _field_names(kind)}
        return {"type": kind.__name__, **fields}
    if isinstance(value, complex | np.complexfloating):
        return {"re": _number(value.real), "im": _number(value.imag)}
    if isinstance(value, np.ndarray):
        return {"array": [describe(v, frequency) for v in value.tolist()]}
    if isinstance(value, tuple | list):
        return [describe(v, frequency) for v in value]
    if isinstance(value, bool | str | int | type(None)):
        return value
    if isinstance(value, float | np.floating):
        return _number(float(value))
    if callable(value):
        if frequency is None:
            raise _NeedsFrequency
        f = np.unique(frequency)
        return describe(Tabulated(f, np.asarray(value(f), complex)), frequency)
    if isinstance(value, Beam):  # a source of the user's own, which no file can bring back
        return {"source": f"{kind.__module__}.{kind.__qualname__}", "text": repr(value)[:MOST_TEXT]}
    raise TypeError(f"no record for {type(value).__name__}")


def _record_of_source(source: Any) -> dict[str, Any]:
    """All of a source, under ``type``, or under ``source`` what remains to be told of it where a part has too many numbers or is not known."""
    kind: Any = type(source)
    values = {name: getattr(source, name) for name in _field_names(kind)}
    if any(isinstance(v, np.ndarray) and v.size > MOST_NUMBERS for v in values.values()):
        records = {k: _summary(v) if isinstance(v, np.ndarray) else describe(v, None) for k, v in values.items()}
        file = getattr(source, "file", "")
        return {"source": kind.__name__, **records} | ({"file": file} if file else {})
    records = {name: describe(value, None) for name, value in values.items()}
    parts = [part for record in records.values() for part in (record if isinstance(record, list) else [record])]
    whole = not any(isinstance(part, dict) and "source" in part for part in parts)
    return {"type" if whole else "source": kind.__name__, **records}


def _summary(values: np.ndarray) -> dict[str, Any]:
    """Shape and checksum of an array's bytes, row by row; of positions the ends and the step too, for samples are even."""
    exact = np.ascontiguousarray(values + 0.0)  # -0.0, which 0.0 is equal to, becomes it
    record: dict[str, Any] = {
        "shape": list(values.shape),
        "dtype": str(values.dtype),
        "sha256": hashlib.sha256(exact.tobytes()).hexdigest(),
    }
    if values.ndim == 1 and values.dtype.kind == "f":
        first, last = float(values[0]), float(values[-1])
        record |= {"from": first, "to": last, "step": (last - first) / (values.size - 1)}
    return record


@functools.cache
def _field_names(kind: type) -> tuple[str, ...]:
    return getattr(kind, "recorded", None) or tuple(field.name for field in dataclasses.fields(kind))


def _number(value: Any) -> float | str:
    return float(value) if math.isfinite(value) else str(float(value))


def rebuild(record: Any) -> Any:
    """The object that `describe` recorded."""
    if isinstance(record, list):
        return tuple(rebuild(v) for v in record)
    if not isinstance(record, dict):
        return record
    if "source" in record:
        return record
    if "array" in record:
        return np.array([rebuild(v) for v in record["array"]])
    if "type" not in record:
        return complex(float(record["re"]), float(record["im"]))
    fields = {k: rebuild(v) for k, v in record.items() if k != "type"}
    cls = _RECORDS[record["type"]]
    return Slab.stack(**fields) if cls is Slab else cls(**fields)


def make(
    variables: dict[str, tuple[tuple[str, ...], Any]],
    coords: dict[str, tuple[tuple[str, ...], Any]],
    question: str,
    frequency: np.ndarray,
    /,
    **settings: Any,
) -> xr.Dataset:
    """A dataset whose names all stand in `labels.LABELS`, with its provenance.

    Parameters
    ----------
    variables, coords : name -> (dims, values)
    question : str
        The public function that was asked.
    frequency : array, Hz
        Where functions of frequency are recorded.
    settings
        Structure, beam and arguments to record.
    """
    record = {"beamprop": __version__, "question": question} | settings
    text = ", ".join(f"{json.dumps(k)}: {_text_of(v, frequency)}" for k, v in record.items())
    attrs = {"provenance": f"{{{text}}}", "convention": "exp(-i w t), SI units, z = 0 at the near face"}
    if any(dims for dims, _ in (*variables.values(), *coords.values())):
        labelled = {n: (d, v, label(n)) for n, (d, v) in variables.items()}
        return xr.Dataset(labelled, {n: (d, v, label(n)) for n, (d, v) in coords.items()}, attrs)
    ds = _of_scalars(tuple(variables), tuple(coords)).copy()
    for name, (_, value) in (variables | coords).items():
        ds.variables[name].data = np.asarray(value)
    ds.attrs = attrs
    return ds


@functools.lru_cache(maxsize=16)
def _of_scalars(variables: tuple[str, ...], coords: tuple[str, ...]) -> xr.Dataset:
    """A dataset of one point to copy, which takes a third of the time of making it."""
    return xr.Dataset({n: ((), 0.0, label(n)) for n in variables}, {n: ((), 0.0, label(n)) for n in coords})


def _text_of(value: Any, frequency: np.ndarray) -> str:
    """The JSON of a record."""
    if type(value) is Slab and sum(len(cell.layers) for cell, _ in value.segments) <= MOST_LAYERS:
        with contextlib.suppress(_NeedsFrequency, TypeError):  # TypeError: a function that cannot be hashed
            return _text_of_constant(value)
    return json.dumps(describe(value, frequency))


@functools.lru_cache(maxsize=1)
def _text_of_constant(value: Any) -> str:
    return json.dumps(describe(value, None))


def labelled(variables: dict[str, Any], coords: dict[str, Any], attrs: dict[str, Any]) -> xr.Dataset:
    """A dataset of what has its names, units and attributes already."""
    return xr.Dataset(variables, coords, attrs)


def provenance(ds: xr.Dataset) -> dict[str, Any]:
    """What a dataset records of its making, with slab, cell and beam rebuilt as objects.

    Of a source that is not one of the package's own its class and its text are recorded, as a dict; of one with more than 4096 samples
    or positions the class, their shape, SHA-256, ends and steps, and the name of the file that it was read from. Of a point of a `sweep` it is what
    the question recorded there; of points that differ in it, the study.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> ds = bp.scattering(slab, 2500.0, angle=0)
    >>> bp.provenance(ds)["slab"] == slab
    True
    """
    validate.instance(ds, xr.Dataset, "ds")
    text = _record_of_points(ds) or ds.attrs.get("provenance")
    if not isinstance(text, str):
        raise ValueError("ds: expected a dataset with the attribute provenance, got one without it")
    record = json.loads(text)
    return {key: value if key == "study" else rebuild(value) for key, value in record.items()}


def packed(records: list[str]) -> str:
    """Records of provenance, which repeat one another, as a short text."""
    return base64.b64encode(zlib.compress(json.dumps(records).encode(), 1)).decode()


def unpacked(text: str) -> list[str]:
    """The records again; few bytes do not ask for much memory."""
    return list(json.loads(zlib.decompressobj().decompress(base64.b64decode(text), MOST_RECORDS)))


def _record_of_points(ds: xr.Dataset) -> str:
    """The record of a study's points, where they share one: `record` numbers it, `records` holds those of each block."""
    if not {"record", "records"} <= set(ds.variables):
        return ""
    texts: set[str] = set()
    per_block = int(ds["record"].attrs["per_block"])
    numbers = np.unique(ds["record"].values)
    for block in np.unique(numbers // per_block):
        if block < 0 or len(texts) > 1:
            return ""
        of_block = unpacked(str(ds["records"][int(block)].values))
        texts |= {of_block[number % per_block] for number in numbers[numbers // per_block == block]}
    return texts.pop() if len(texts) == 1 else ""
