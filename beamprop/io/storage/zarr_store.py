"""Zarr stores, format 3: written with checksums, read after a look at every file's description of itself.

Chunks carry a CRC-32C each. The root's attribute `RECORD` holds CRC-32s of each chunk's bytes, of each array's metadata and of the root's, so that a chunk or
an array that is missing is noticed too: to Zarr a missing chunk is one of fill values. xarray neither shows nor copies attributes that
begin with "_nc".
"""

from __future__ import annotations

import contextlib
import itertools
import json
import math
import os
import re
import warnings
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .blocked import BlockedVariables
from .parts import plain
from .settled import HARMLESS, read_values, refuse_expansion

RECORD, RECORDED = "_nc_beamprop_checksums", "_nc_beamprop_checked"
#: The root's attribute that describes a study, whose store grows block by block and has no list of checksums.
STUDY = "_nc_beamprop_study"
#: In place of a CRC-32: the chunk is one of fill values, which Zarr does not write.
ABSENT = "-" * 8
#: Largest file of metadata that is read [bytes].
LIMIT = 2**26
#: The codecs that `save` writes: none of them runs code that a store names.
CODECS = ("bytes", "vlen-utf8", "zstd", "crc32c")
_VERSION_2 = (".zgroup", ".zarray", ".zattrs", ".zmetadata")
_GROUP = {"zarr_format", "node_type", "attributes", "consolidated_metadata"}
_ARRAY = {
    *("zarr_format", "node_type", "attributes", "shape", "data_type", "chunk_grid", "chunk_key_encoding", "fill_value"),
    *("codecs", "dimension_names", "storage_transformers"),
}


def need_zarr() -> None:
    """Raise an ImportError with advice if zarr is missing."""
    try:
        import zarr  # noqa: F401
    except ImportError:
        raise ImportError('Zarr stores need zarr: pip install -e ".[zarr]" in the checkout') from None


@contextlib.contextmanager
def texts_allowed() -> Iterator[None]:
    """Without the warning of earlier versions of zarr that texts were no part of the format yet."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".* not part in the Zarr format 3 specification")
        yield


def _compressors() -> list[Any]:
    from zarr.codecs import Crc32cCodec, ZstdCodec

    return [ZstdCodec(level=0), Crc32cCodec()]


# --- writing --------------------------------------------------------------------------------------------------


def checksum(data: bytes) -> bytes:
    """The four bytes that the codec crc32c puts behind a chunk."""
    from google_crc32c import value

    return int(value(data)).to_bytes(4, "little")


def write(draft: Path, ds: xr.Dataset, _level: int) -> None:
    """Write a dataset; zlib's level does not concern Zarr."""
    need_zarr()
    ds.to_zarr(draft, encoding={name: encoding(v.dtype) for name, v in ds.variables.items()}, consolidated=False)
    record(draft)


def write_blocks(draft: Path, variables: BlockedVariables, rest: Callable[[], xr.Dataset]) -> None:
    """Write variables block by block, and then the others."""
    need_zarr()
    import zarr

    group = zarr.open_group(draft, mode="w")
    into = {
        name: group.create_array(
            name,
            shape=tuple(variables.sizes.values()),
            dtype=kind,
            chunks=variables.chunks,
            compressors=_compressors(),
            fill_value=np.nan if kind is float else complex(np.nan, np.nan),
            dimension_names=list(variables.sizes),
            attributes=variables.attrs[name],
        )
        for name, kind in variables.kinds.items()
    }
    for where, block in variables.blocks:
        for name, values in block.items():
            into[name][where] = values
    others = plain(rest(), pairs=False)
    others.to_zarr(
        draft, mode="a", encoding={n: encoding(v.dtype) for n, v in others.variables.items()}, consolidated=False
    )
    record(draft)


def encoding(dtype: np.dtype) -> dict[str, Any]:
    """How an array is written."""
    # unfinished complex chunks would read as 0 + 0j otherwise
    fill = {"fill_value": complex(np.nan, np.nan)} if dtype.kind == "c" else {}
    return {"compressors": _compressors(), **fill}


def record(store: Path) -> None:
    """Put the checksums of a complete store into its root's attributes, and the arrays' metadata beside them (consolidated)."""
    metadata = {folder.relative_to(store).as_posix(): about for folder, about in _nodes(store) if folder != store}
    arrays = {
        name: [_digest(about), "".join(_chunk_crcs(store / name, about))]
        for name, about in metadata.items()
        if about["node_type"] == "array"
    }
    root = _metadata(store)
    root["consolidated_metadata"] = {"kind": "inline", "must_understand": False, "metadata": metadata}
    attributes = {k: v for k, v in root.get("attributes", {}).items() if k not in (RECORD, RECORDED)}
    root["attributes"] = attributes
    sums = {"root": _digest(root), "arrays": arrays}
    root["attributes"] = attributes | {RECORD: sums | {"crc32": _digest(sums)}, RECORDED: 1}
    (store / "zarr.json").write_text(json.dumps(root, indent=1), encoding="utf-8")


def _digest(value: Any) -> int:
    """CRC-32 of a value of JSON, however it was written down."""
    return zlib.crc32(json.dumps(value, sort_keys=True).encode())


def _chunk_keys(about: dict[str, Any]) -> Iterator[str]:
    """Names of all chunks of an array, below its folder."""
    sizes = about["chunk_grid"]["configuration"]["chunk_shape"]
    counts = [-(-n // max(1, size)) for n, size in zip(about["shape"], sizes, strict=True)]
    return ("/".join(["c", *map(str, index)]) for index in itertools.product(*map(range, counts)))


def chunk_files(folder: Path) -> list[Path]:
    """The files of an array's chunks, there or not."""
    return [folder / key for key in _chunk_keys(_metadata(folder))]


def _chunk_crcs(folder: Path, about: dict[str, Any]) -> Iterator[str]:
    for key in _chunk_keys(about):
        try:
            yield f"{zlib.crc32((folder / key).read_bytes()):08x}"
        except FileNotFoundError:
            yield ABSENT


# --- reading --------------------------------------------------------------------------------------------------


def read(path: Path) -> xr.Dataset:
    """Read a store into memory.

    Raises
    ------
    ValueError
        Names the store, and the variable, that is damaged or asks for what `save` does not write.
    """
    need_zarr()
    _refuse_strange_files(path)
    nodes = dict(_nodes(path))
    for folder, about in nodes.items():
        _refuse_foreign(path, folder, about)
    try:
        _check_record(path, nodes)
        _check_blocks(path, nodes)
    except (LookupError, TypeError, AttributeError):
        raise ValueError(
            f"{path}: expected a store as it was written, got one whose list of checksums is none"
        ) from None
    unreadable = "expected a Zarr store, got one that cannot be read"
    with texts_allowed():
        return read_values(path, lambda: xr.open_zarr(path, consolidated=False), unreadable)


def _refuse_strange_files(path: Path) -> None:
    """Refuse links, which may lead out of the store, and format 2, whose filters may be any code."""
    if not path.is_dir():
        raise ValueError(f"{path}: expected a Zarr store, which is a folder, got a file")
    for folder, folders, files in os.walk(path):
        for name in folders + files:
            if (link := Path(folder, name)).is_symlink():
                raise ValueError(
                    f"{path}: expected a Zarr store without links, got the link {str(link.relative_to(path))!r}"
                )
            if name in _VERSION_2:
                raise ValueError(
                    f"{path}: expected a Zarr store of format 3, got format 2 ({str(link.relative_to(path))!r}), whose filters may run "
                    "any code: convert it by a program that you trust it to"
                )


def _nodes(store: Path) -> Iterator[tuple[Path, dict[str, Any]]]:
    """The store's groups and arrays: folder and metadata, the root first."""
    waiting = [store]
    while waiting:
        folder = waiting.pop()
        about = _metadata(folder)
        yield folder, about
        if about.get("node_type") != "array":
            waiting += sorted(Path(entry.path) for entry in os.scandir(folder) if entry.is_dir())


def _metadata(folder: Path) -> dict[str, Any]:
    """A folder's zarr.json."""
    file = folder / "zarr.json"
    try:
        size = file.stat().st_size
        if size > LIMIT:
            raise ValueError(f"{size} bytes")
        about = json.loads(file.read_bytes())
        if not isinstance(about, dict):
            raise ValueError(repr(about)[:60])
    except (OSError, ValueError, RecursionError) as error:
        got = "none" if isinstance(error, FileNotFoundError) else f"what cannot be read ({error})"
        raise ValueError(f"{file}: expected the metadata of a Zarr array or group, got {got}") from None
    return about


def _refuse_foreign(path: Path, folder: Path, about: dict[str, Any]) -> None:
    """Refuse what `save` does not write, naming it."""
    where = f"{path}: {folder.relative_to(path).as_posix()!r}"
    kind = about.get("node_type")
    if about.get("zarr_format") != 3 or kind not in ("array", "group"):
        raise ValueError(
            f"{where}: expected an array or a group of Zarr format 3, got {kind!r} of {about.get('zarr_format')!r}"
        )
    if unknown := set(about) - (_ARRAY if kind == "array" else _GROUP):
        raise ValueError(f"{where}: expected metadata of an {kind}, got {', '.join(map(repr, sorted(unknown)))}")
    if not isinstance(about.get("attributes", {}), dict):
        raise ValueError(f"{where}: expected attributes with names, got {about['attributes']!r:.60}")
    if kind == "array":
        try:
            _refuse_array(where, folder, about)
        except (LookupError, TypeError, AttributeError) as error:
            raise ValueError(f"{where}: expected the metadata of an array, got incomplete ones ({error!r})") from None
        return
    inner = about.get("consolidated_metadata") or {}
    copies = inner.get("metadata", {}) if isinstance(inner, dict) else None
    if not isinstance(copies, dict):
        raise ValueError(f"{where}: expected consolidated metadata by name, got {inner!r:.60}")
    for name, copy in copies.items():
        if not isinstance(copy, dict) or not (folder / name).resolve().is_relative_to(path.resolve()):
            raise ValueError(f"{where}: expected consolidated metadata of what is in the store, got {name!r}")
        _refuse_foreign(path, folder / name, copy)


def _refuse_array(where: str, folder: Path, about: dict[str, Any]) -> None:
    for codec in about["codecs"]:
        name = codec if isinstance(codec, str) else codec["name"]
        if name not in CODECS:
            raise ValueError(
                f"{where}: expected the codecs {', '.join(CODECS)}, got {name!r}, which save does not write"
            )
    if about.get("storage_transformers"):
        raise ValueError(f"{where}: expected no storage transformers, got {about['storage_transformers']!r:.60}")
    names = about["chunk_grid"]["name"], about["chunk_key_encoding"]["name"]
    if names != ("regular", "default"):
        raise ValueError(f"{where}: expected a regular grid of chunks with default names, got {names}")
    if about["chunk_key_encoding"].get("configuration", {}).get("separator", "/") != "/":
        raise ValueError(
            f"{where}: expected the names of chunks to be parted by '/', got {about['chunk_key_encoding']!r:.60}"
        )
    shape, sizes = about["shape"], about["chunk_grid"]["configuration"]["chunk_shape"]
    if len(shape) != len(sizes) or not all(type(n) is int and n >= 0 for n in (*shape, *sizes)):
        raise ValueError(f"{where}: expected lengths of an array and its chunks, got {shape!r:.60} and {sizes!r:.60}")
    _refuse_huge(where, folder, about)


def _refuse_huge(where: str, folder: Path, about: dict[str, Any]) -> None:
    """Few bytes must not ask for much memory."""
    bits = re.search(r"\d+$", about["data_type"]) if isinstance(about["data_type"], str) else None
    size = int(bits.group()) // 8 if bits else 8
    chunk = size * math.prod(about["chunk_grid"]["configuration"]["chunk_shape"])
    size = max(size * math.prod(about["shape"]), chunk)
    if size > HARMLESS:  # only then are the files looked at
        stored = sum(Path(f, n).stat().st_size for f, _, names in os.walk(folder) for n in names)
        refuse_expansion(where, "an array", size, stored)


def _check_record(path: Path, nodes: dict[Path, dict[str, Any]]) -> None:
    """Compare the store with its checksums; one without them, of an earlier version or another program, passes."""
    root = nodes[path]
    attributes = dict(root.get("attributes", {}))
    sums, recorded = attributes.pop(RECORD, None), attributes.pop(RECORDED, None)
    if sums is None and recorded is None:
        return
    wrong = f"{path}: expected a store as it was written, got one with damage in"
    whole = {k: v for k, v in sums.items() if k != "crc32"} if isinstance(sums, dict) else None
    if recorded != 1 or whole is None or _digest(whole) != sums.get("crc32"):
        raise ValueError(f"{wrong} the list of its checksums (in zarr.json)")
    if _digest(root | {"attributes": attributes}) != whole["root"]:
        raise ValueError(f"{wrong} the names or attributes of the whole (in zarr.json)")
    arrays = {f.relative_to(path).as_posix(): (f, about) for f, about in nodes.items() if about["node_type"] == "array"}
    for name, (metadata, crcs) in whole["arrays"].items():
        if name not in arrays:
            raise ValueError(f"{wrong} variable {name!r}: it is missing")
        folder, about = arrays[name]
        if _digest(about) != metadata:
            raise ValueError(f"{wrong} variable {name!r}: its dimensions, type or attributes (in {name}/zarr.json)")
        wanted = [crcs[k : k + 8] for k in range(0, len(crcs), 8)]
        for key, crc, is_now in zip(_chunk_keys(about), wanted, _chunk_crcs(folder, about), strict=True):
            if is_now != crc:
                what = "is missing" if is_now == ABSENT else "is not as it was written (wrong checksum)"
                raise ValueError(f"{wrong} variable {name!r}: its chunk {key!r} {what}")
    if added := set(arrays) - set(whole["arrays"]):
        raise ValueError(f"{wrong} what it holds: {', '.join(map(repr, sorted(added)))} came later")


def _check_blocks(path: Path, nodes: dict[Path, dict[str, Any]]) -> None:
    """Of a study, each block that has a status has a chunk of every array, and arrays that are not in blocks have all of theirs."""
    if STUDY not in nodes[path].get("attributes", {}):
        return
    status = nodes[path / "status"]
    axes = status["dimension_names"]
    blocks = [(k, key) for k, key in enumerate(_chunk_keys(status)) if (path / "status" / key).exists()]
    for folder, about in nodes.items():
        if about["node_type"] != "array":
            continue
        dims = about["dimension_names"]
        if folder.name == "records":
            keys = [f"c/{k}" for k, _ in blocks]
        elif dims[: len(axes)] == axes and folder.name not in axes:
            keys = [key + "/0" * (len(dims) - len(axes)) for _, key in blocks]
        else:
            keys = list(_chunk_keys(about))
        for key in keys:
            if not (folder / key).exists():
                what = f"damage in variable {folder.name!r}: its chunk {key!r} is missing"
                raise ValueError(f"{path}: expected a store as it was written, got one with {what}")
