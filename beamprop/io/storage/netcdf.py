"""netCDF files: written through a guarded file with checksums, read after a look at what they ask for."""

from __future__ import annotations

import contextlib
import json
import math
import uuid
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr

from .blocked import BlockedVariables
from .guarded import GuardedFile, uninterrupted
from .parts import pair_attributes, plain
from .seal import Stretch, check_seal, seal
from .settled import Refusal, read_values, refuse_expansion

#: Attribute with the variables that were written: their sizes and types, and the file's token.
RECORD = "beamprop_variables"
#: netCDF's record of the libraries that wrote a file, which readers hide and do not copy. It repeats the token: a record that was
#: copied into another file with the other attributes is recognised by that.
PROPERTIES = "_NCProperties"
#: Largest chunk [bytes]: what HDF5's cache of chunks holds.
CHUNK = 2**20
#: Space for names, attributes and tables: for a file, for each of its variables, and as a share of the values.
FOR_FILE, FOR_VARIABLE, FOR_VALUES = 2**16, 2**13, 1 / 256
#: Text of a fixed length in an attribute has less bytes than this, HDF5's limit of a header.
LONGEST = 2**16 - 2**10
#: HDF5's filters that are compiled into it or into h5py. Others are loaded from plug-ins, code of somebody's choice.
FILTERS = {1: "deflate", 2: "shuffle", 3: "fletcher32", 4: "szip", 5: "nbit", 6: "scaleoffset", 32000: "lzf"}
#: netCDF's mark of a dataset that stands for the length of a dimension, and is not read.
LENGTH_ALONE = b"This is a netCDF dimension but not a netCDF variable"


def write(draft: Path, ds: xr.Dataset, compression: int) -> None:
    """Write a dataset; values that dask would still have to compute are computed first."""
    ds = ds.compute()
    size = 0 if compression else sum(_stored(v.shape, _chunks(v), v.dtype.itemsize) for v in ds.variables.values())
    with _new(draft, size, len(ds.variables)) as (file, _):
        _dump(ds, file, compression)


def write_blocks(draft: Path, variables: BlockedVariables, rest: Callable[[], xr.Dataset]) -> None:
    """Write variables block by block, complex ones as pairs of real ones, and then the others."""
    sizes, kinds = variables.sizes, variables.kinds
    shape = tuple(sizes.values())
    bytes_each = sum(np.dtype(kind).itemsize for kind in kinds.values())
    with _new(draft, _stored(shape, variables.chunks, bytes_each), 8 + len(kinds)) as (file, guarded):
        file.dimensions = sizes
        options: dict[str, Any] = {"chunks": variables.chunks, "fletcher32": True} if shape else {}
        into: dict[str, list[Any]] = {name: [] for name in kinds}
        for name, attrs in variables.attrs.items():
            for part, own in (pair_attributes(name, attrs) if kinds[name] is complex else {name: attrs}).items():
                into[name].append(file.create_variable(part, tuple(sizes), dtype=np.dtype(float), **options))
                into[name][-1].attrs.update(own)
        for where, block in variables.blocks:
            for name, values in block.items():
                for part, numbers in zip(into[name], (values.real, values.imag), strict=False):  # real ones have one
                    with uninterrupted():
                        part[where] = np.ascontiguousarray(numbers)
                    guarded.check()
        _dump(plain(rest()), file, 0)


@contextlib.contextmanager
def _new(draft: Path, size: int, variables: int) -> Iterator[tuple[h5netcdf.File, GuardedFile]]:
    """A file to fill with about `size` bytes of values; afterwards its variables are recorded and it is sealed."""
    reserve = size and int(size * (1 + FOR_VALUES)) + FOR_FILE + FOR_VARIABLE * variables
    guarded = GuardedFile(draft, reserve)
    try:
        with uninterrupted():
            h5 = h5py.File(guarded, "w", track_order=True)
            file = h5netcdf.File(h5, "w")
        try:
            yield file, guarded
        finally:
            with uninterrupted():
                stretches = _close(file, h5)
        guarded.finish()
    except Exception:
        guarded.check()  # a failed write is the cause of whatever followed
        raise
    finally:
        guarded.close()
    seal(draft, stretches)


def _close(file: h5netcdf.File, h5: h5py.File) -> list[Stretch]:
    """Record the variables and close a file; where their values lie in it."""
    with h5:
        file.close()
        _record(h5)
        _plain_attributes(h5)
        h5.flush()
        return [s for name, item in h5.items() for s in _stretches(name, item)]


def _dump(ds: xr.Dataset, file: h5netcdf.File, compression: int) -> None:
    encoding = {name: _encoding(v, compression) for name, v in ds.variables.items()}
    with uninterrupted():
        ds.dump_to_store(xr.backends.H5NetCDFStore(file), encoding=encoding)


def _encoding(v: xr.Variable, compression: int) -> dict[str, Any]:
    """Chunks with checksums for arrays of numbers; HDF5 takes filters for neither scalars nor strings of any length."""
    if not v.size or not v.ndim or v.dtype.kind in "OSU":
        return {}
    packed = {"zlib": True, "complevel": compression, "shuffle": True} if compression else {}
    return {"fletcher32": True, "chunksizes": _chunks(v), **packed}


def _chunks(v: xr.Variable) -> tuple[int, ...]:
    """Chunks of at most `CHUNK` bytes, as even as can be: HDF5 stores those at the ends whole."""
    chunks = list(v.shape)
    for axis, length in enumerate(v.shape):
        rest = v.dtype.itemsize * math.prod(chunks[axis + 1 :])
        count = -(-length // max(1, CHUNK // max(1, rest)))
        chunks[axis] = -(-length // max(1, count))
    return tuple(chunks)


def _stored(shape: tuple[int, ...], chunks: tuple[int, ...], size: int) -> int:
    """Bytes that an array's chunks take."""
    return size * math.prod(-(-n // max(1, c)) * c for n, c in zip(shape, chunks, strict=True))


def _record(h5: h5py.File) -> None:
    token = uuid.uuid4().hex
    h5.attrs[RECORD] = json.dumps({"file": token, "variables": _layout(h5)})
    known = h5.attrs.get(PROPERTIES, b"")
    text = (known.decode() if isinstance(known, bytes) else str(known)) + f",beamprop={token}"
    h5.attrs.create(PROPERTIES, np.bytes_(text.lstrip(",")))


def _plain_attributes(h5: h5py.File) -> None:
    """Give text in attributes a fixed length: text of any length is a type that Octave and earlier MATLABs do not read."""
    for item in (h5, *h5.values()):
        for name, value in list(item.attrs.items()):
            if isinstance(value, str) and 0 < (length := len(value.encode())) < LONGEST:
                item.attrs.create(name, value.encode(), dtype=h5py.string_dtype("utf-8", length))


def _layout(h5: h5py.File) -> dict[str, Any]:
    """Shape and type of each variable."""
    return {n: [list(item.shape), str(item.dtype)] for n, item in h5.items() if isinstance(item, h5py.Dataset)}


def _stretches(name: str, item: Any) -> list[Stretch]:
    """Where the values of a dataset lie in the file."""
    if not isinstance(item, h5py.Dataset):
        return []
    if item.chunks is None:
        start = item.id.get_offset()
        return [] if start is None else [(start, start + item.id.get_storage_size(), name)]
    stretches: list[Stretch] = []
    item.id.chunk_iter(lambda chunk: stretches.append((chunk.byte_offset, chunk.byte_offset + chunk.size, name)))
    return stretches


# --- reading --------------------------------------------------------------------------------------------------


def read(path: Path) -> xr.Dataset:
    """Read a file into memory.

    Raises
    ------
    ValueError
        Names the file, and the variable, that is damaged or asks for what `save` does not write.
    """
    check_seal(path)
    unreadable = "expected a netCDF file, got one that cannot be read, damaged or cut off"
    ds = read_values(path, lambda: _open(path), unreadable)
    ds.attrs.pop(RECORD, None)
    return ds


def _open(path: Path) -> xr.Dataset:
    with h5py.File(path, "r") as h5:
        _refuse_foreign(path, h5, h5, set())
        _check_record(path, h5)
    return xr.open_dataset(path, engine="h5netcdf")


def _refuse_foreign(path: Path, h5: h5py.File, group: h5py.Group, seen: set[Any]) -> None:
    """Refuse what `save` does not write: values and groups outside of the file, and filters that would be loaded."""
    for name in group:
        link = group.get(name, getlink=True)
        where = f"{group.name.rstrip('/')}/{name}"
        if not isinstance(link, h5py.HardLink):
            raise Refusal(
                f"{path}: expected variables that lie in the file, got a link at {where!r} ({type(link).__name__})"
            )
        item = group[name]
        address = h5py.h5o.get_info(item.id).addr
        if address in seen:
            continue
        seen.add(address)
        if isinstance(item, h5py.Group):
            _refuse_foreign(path, h5, item, seen)
        elif isinstance(item, h5py.Dataset):
            _refuse_dataset(path, where, item)


def _refuse_dataset(path: Path, where: str, item: h5py.Dataset) -> None:
    if item.external:
        raise Refusal(
            f"{path}: expected variables that lie in the file, got {where!r} with values in {item.external[0][0]!r}"
        )
    if item.is_virtual:
        raise Refusal(
            f"{path}: expected variables that lie in the file, got {where!r} made of others (a virtual dataset)"
        )
    plist = item.id.get_create_plist()
    for k in range(plist.get_nfilters()):
        number, _, _, name = plist.get_filter(k)
        if number not in FILTERS:
            raise Refusal(
                f"{path}: expected the filters {', '.join(FILTERS.values())}, got {where!r} with filter {number} {name.decode(errors='replace')!r}"
            )
    if bytes(item.attrs.get("NAME", b"")).startswith(LENGTH_ALONE):
        return
    size = item.dtype.itemsize * math.prod(item.shape or ())
    refuse_expansion(str(path), repr(where), size, item.id.get_storage_size())


def _check_record(path: Path, h5: h5py.File) -> None:
    """Compare the variables with those that were written; a record copied from another file is none."""
    text, properties = h5.attrs.get(RECORD), h5.attrs.get(PROPERTIES, b"")
    text = text.decode(errors="replace") if isinstance(text, bytes) else text
    if not isinstance(text, str):
        return
    try:
        record: Mapping[str, Any] = json.loads(text)
        token, written = record["file"], dict(record["variables"])
    except (ValueError, LookupError, TypeError):
        raise Refusal(f"{path}: expected the list of its variables in {RECORD!r}, got {text[:60]!r}") from None
    if f"beamprop={token}".encode() not in bytes(properties):
        return
    present = _layout(h5)
    for name, layout in written.items():
        if name not in present:
            raise Refusal(
                f"{path}: expected the variable {name!r}, which was written, got {', '.join(present) or 'none'}"
            )
        if present[name] != layout:
            raise Refusal(
                f"{path}: expected variable {name!r} of shape and type {layout}, as written, got {present[name]}"
            )
