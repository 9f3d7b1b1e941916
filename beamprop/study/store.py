"""A study's store: Zarr format 3, each block one chunk of each array, its status written last.

Chunks are written here rather than through zarr, each under a name of its own first and then in place, as whole.py does with files: a kill leaves
whole chunks or none, in every version of zarr, and a block of a dozen arrays takes milliseconds. Any reader of Zarr reads them.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from .._version import __version__
from ..io import datasets
from ..io.storage.whole import check_target, scratch_beside, sync
from ..io.storage.zarr_store import STUDY, checksum, chunk_files, encoding, need_zarr, texts_allowed
from .arrays import Spec, chunks_of, specs
from .axes import Study
from .blocks import Grid
from .claims import Claims
from .differences import differences
from .fingerprint import parts_of, text_of
from .work import FAILED, Field, Result, Schema

FORMAT = 1
#: Arrays of texts.
TEXTS = ("message", "records")


class Store:
    """An open store."""

    def __init__(self, path: Path, study: Study) -> None:
        about = _about(path)
        _refuse_another(path, about["study"], record_of(study))
        self.path, self.seconds = path, float(about["seconds"])
        self.grid = Grid(study.shape, tuple(about["chunk"]))
        with self.dataset(*TEXTS) as ds:
            self.schema = _schema(ds, study, about)
        self._specs = specs(study, self.schema, self.grid)
        own = (file for name in (*study.axes, *self.schema.coords) for file in chunk_files(path / name))
        if wrong := _damage(path, own):
            raise validate.refuse("store", "one whose axes are as they were written, or a new name", f"{path}: {wrong}")

    def put(self, block: int, result: Result) -> None:
        """Write a block, its status last.

        Raises
        ------
        OSError
            The system refused (a full disk, say). The block stays empty.
        """
        try:
            for name, part in chunks_of(self.grid, block, result).items():
                _write(self._file(name, block), self._specs[name], part)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self.path)) from error

    def is_kept(self, block: int) -> bool:
        """Whether a block has a status, which comes last."""
        return self._file("status", block).exists()

    def forget(self, block: int) -> None:
        """Make a block an empty one."""
        for name in ("status", *self._specs):
            self._file(name, block).unlink(missing_ok=True)

    def damage(self, block: int) -> str:
        """What is wrong with a block that has a status: the first chunk that is missing or not as it was written."""
        return _damage(self.path, (self._file(name, block) for name in self._specs))

    def failures(self) -> list[int]:
        """Numbers of the blocks in which a point has failed."""
        with self.dataset(*TEXTS) as ds:
            status = ds["status"].values
        return [block for block in range(self.grid.size) if np.any(status[self.grid.where(block)] == FAILED)]

    def _file(self, name: str, block: int) -> Path:
        index = (block,) if name == "records" else self.grid.index(block)
        own = len(self._specs[name].shape) - len(index)
        return self.path.joinpath(name, "c", *map(str, (*index, *[0] * own)))

    def claims(self) -> Claims:
        """Claims on blocks, for as long as they are open.

        Raises
        ------
        ValueError
            The store cannot be written to.
        """
        try:
            return Claims(self.path)
        except OSError as error:
            got = f"{self.path} ({error.strerror})"
            raise validate.refuse("store", "one that can be written to", got) from None

    def dataset(self, *without: str) -> xr.Dataset:
        """What is kept, read from the disk when it is used; texts, by earlier versions of xarray, at once."""
        with texts_allowed():
            return xr.open_zarr(self.path, consolidated=False, chunks=None, drop_variables=without)


def _damage(path: Path, chunks: Iterable[Path]) -> str:
    """What is wrong with the first chunk that is missing or not as it was written."""
    for file in chunks:
        name = file.relative_to(path).as_posix()
        try:
            data = file.read_bytes()
        except FileNotFoundError:
            return f"{name} is missing"
        if len(data) < 4 or checksum(data[:-4]) != data[-4:]:
            return f"{name} is not as it was written (wrong checksum)"
    return ""


def _write(file: Path, spec: Spec, part: np.ndarray) -> None:
    """Write a chunk as the codecs of `create` do: whole, filled up at the ends of the axes, and in one step."""
    from numcodecs import VLenUTF8, Zstd

    whole = np.full(spec.chunk, spec.fill, object if spec.dtype is str else spec.dtype)
    whole[tuple(map(slice, part.shape))] = part
    plain = (
        VLenUTF8().encode(whole.ravel()) if spec.dtype is str else whole.astype(whole.dtype.newbyteorder("<")).tobytes()
    )
    packed = bytes(Zstd(level=0).encode(plain))
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_name(f".{file.name}.draft")
    try:
        draft.write_bytes(packed + checksum(packed))
        os.replace(draft, file)
    except OSError:
        draft.unlink(missing_ok=True)
        raise


# --- what a store says of itself ------------------------------------------------------------------------------


def record_of(study: Study) -> dict[str, Any]:
    """What makes a study this one, as texts; versions of libraries beside it, which may change."""
    axes = {
        f"axes[{name!r}]": f"{len(v)} values from {v[0]} to {v[-1]} ({text_of(v).split()[-1]})"
        for name, v in study.axes.items()
    }
    versions = {"python": platform.python_version(), "numpy": np.__version__, "xarray": xr.__version__}
    record = {"beamprop": __version__, **axes, "parts": parts_of(study.question), "versions": versions}
    digest = hashlib.sha256(json.dumps(_flat(record), sort_keys=True).encode()).hexdigest()
    return {**record, "hash": digest}


def _flat(record: dict[str, Any]) -> dict[str, str]:
    own = {name: text for name, text in record.items() if name not in ("parts", "versions", "hash")}
    return own | record.get("parts", {})


def _refuse_another(path: Path, there: dict[str, Any], here: dict[str, Any]) -> None:
    """Refuse to go on with a store of another study, parameter by parameter."""
    old, new = _flat(there), _flat(here)
    if old != new or list(old) != list(new):
        what = "\n  ".join(differences(old, new) or ["the order of the axes"])
        raise ValueError(f"store: expected the study that {str(path)!r} was begun with, got a changed one:\n  {what}")


def _about(path: Path) -> dict[str, Any]:
    """The root's description of the study.

    Raises
    ------
    ValueError
        Another folder, or a store of another version.
    """
    try:
        root = json.loads((path / "zarr.json").read_text(encoding="utf-8"))
        about = json.loads(root["attributes"][STUDY])
    except (OSError, ValueError, LookupError, TypeError):
        raise validate.refuse("store", "a new name, or a store that a sweep has begun", str(path)) from None
    if about.get("format") != FORMAT:
        expected = f"a store of format {FORMAT}, which this version of beamprop goes on with"
        raise validate.refuse(
            "store", expected, f"{path}: format {about.get('format')} of {about.get('study', {}).get('beamprop')}"
        )
    return about


def _schema(ds: xr.Dataset, study: Study, about: dict[str, Any]) -> Schema:
    fields, attrs = {}, {}
    axes = len(study.axes)
    for name in about["variables"]:
        v = ds.variables[name]
        fields[name] = Field(tuple(map(str, v.dims[axes:])), v.shape[axes:], v.dtype)
        attrs[name] = dict(v.attrs)
    own = {d for field in fields.values() for d in field.dims if d in ds.variables}
    coords = {d: ds.variables[d].load() for d in sorted(own)}
    return Schema(fields, coords, attrs, tuple(about["secondary"]), str(ds.attrs.get("convention", "")))


def attributes_of(study: Study, schema: Schema) -> dict[str, str]:
    """Attributes of a study's dataset."""
    record = {"beamprop": __version__, "question": "sweep", "study": record_of(study)}
    return {"provenance": json.dumps(record), "convention": schema.convention}


def create(path: Path, study: Study, schema: Schema, grid: Grid, seconds: float) -> None:
    """Make an empty store, under its name when it is complete; if another run has just made it, that is the store."""
    import zarr

    about = {
        **{"format": FORMAT, "chunk": grid.chunk, "seconds": seconds, "study": record_of(study)},
        **{"variables": list(schema.fields), "secondary": schema.secondary},
    }
    coordinates = " ".join((*schema.secondary, "message", "record", "records", "status"))
    with scratch_beside(path) as scratch, texts_allowed():
        draft = scratch / "draft.zarr"
        group = zarr.open_group(draft, mode="w")
        for name, spec in specs(study, schema, grid).items():
            group.create_array(
                name,
                shape=spec.shape,
                chunks=spec.chunk,
                dtype=spec.dtype,
                fill_value=spec.fill,
                dimension_names=spec.dims,
                attributes=spec.attrs,
                compressors=encoding(np.dtype(float))["compressors"],
            )
        axes = datasets.labelled({}, {**study.coords(), **schema.coords}, {})
        words = {name: v.astype(object) for name, v in axes.variables.items() if v.dtype.kind == "U"}
        axes = axes.assign_coords(words)  # Zarr 3 has strings of any length, none of a fixed one
        axes.to_zarr(
            draft,
            mode="a",
            write_empty_chunks=True,
            encoding={n: encoding(v.dtype) for n, v in axes.variables.items()},
            consolidated=False,
        )
        group.attrs.put({**attributes_of(study, schema), "coordinates": coordinates, STUDY: json.dumps(about)})
        sync(draft)
        try:
            os.rename(draft, path)
        except OSError:
            if not path.exists():
                raise


def target(store: Any) -> Path:
    """The path of a store, where there is one or one can be made.

    Raises
    ------
    ValueError
        Not the name of a .zarr, a missing folder, or one that cannot be written to.
    """
    path = validate.as_path(store, "store")
    if path.suffix != ".zarr":
        raise validate.refuse("store", "a name that ends in .zarr", str(path))
    need_zarr()
    try:
        return path if path.is_dir() else check_target(path)
    except ValueError as error:
        raise ValueError(str(error).replace("path:", "store:", 1)) from None
