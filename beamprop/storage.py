"""Datasets to files and back: netCDF and Zarr by ending; complex numbers, attributes and provenance round-trip.

Complex variables are written as the compound type {r, i}, which netCDF4 (``auto_complex=True``), h5py and Octave read
as complex numbers too. `save` with ``split_complex=True`` writes a pair of real variables ``p_real`` and ``p_imag`` for readers
that do not know compound types; `load` joins them again. A file appears under its name only when it is complete.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .conventions import label

NETCDF = (".nc", ".nc4", ".netcdf", ".h5")
ZARR = (".zarr",)


def _kind(path: Path) -> str:
    if path.suffix.lower() in NETCDF:
        return "netcdf"
    if path.suffix.lower() in ZARR:
        return "zarr"
    raise ValueError(f"path: expected an ending of {', '.join(NETCDF + ZARR)}, got {path.name!r}")


def write_whole(path: str | Path, write: Callable[[Path], None]) -> None:
    """Let `write` make a file or folder beside `path`, and give it its name only when it is complete.

    Raises
    ------
    ValueError
        The folder does not exist.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise ValueError(f"path: expected a file in an existing folder, got {str(path)!r}")
    scratch = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
    try:
        draft = scratch / path.name
        write(draft)
        if path.is_dir() and not path.is_symlink():
            if not (path / "zarr.json").exists() and not (path / ".zgroup").exists() and any(path.iterdir()):
                raise ValueError(f"path: expected a file or a Zarr store to replace, got a folder {str(path)!r}")
            old = scratch / "replaced"
            os.rename(path, old)
        if draft.is_file():
            mask = os.umask(0)
            os.umask(mask)
            draft.chmod(0o666 & ~mask)
        os.replace(draft, path)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def save(ds: xr.Dataset, path: str | Path, *, split_complex: bool = False, compression: int = 0) -> None:
    """Write a dataset to a netCDF file (.nc) or a Zarr store (.zarr).

    Parameters
    ----------
    ds : Dataset
    path : path
        Replaced if it exists, once the new one is complete.
    split_complex : bool
        Write complex variables as pairs of real ones, for readers that do not know compound types.
    compression : int
        zlib level 0 to 9 of netCDF variables. Fields of full precision hardly compress.

    Raises
    ------
    ValueError
        Unknown ending, missing folder, or no Dataset.
    """
    if not isinstance(ds, xr.Dataset):
        raise ValueError(f"ds: expected a Dataset, got {type(ds).__name__}")
    if compression not in range(10):
        raise ValueError(f"compression: expected a whole number from 0 to 9, got {compression!r}")
    path = Path(path)
    kind = _kind(path)
    out = _split(ds) if split_complex else ds.copy(deep=False)
    for name in out.variables:
        out[name].encoding = {}

    def write(draft: Path) -> None:
        if kind == "netcdf":
            options = {"zlib": compression > 0, "complevel": compression} if compression else {}
            encoding = {n: options for n, v in out.variables.items() if v.ndim} if options else {}
            out.to_netcdf(draft, engine="h5netcdf", encoding=encoding)
        else:
            _import_zarr()
            # unfinished complex chunks would read as 0 + 0j otherwise
            fill = {n: {"fill_value": complex(np.nan, np.nan)} for n, v in out.variables.items() if v.dtype.kind == "c"}
            out.to_zarr(draft, encoding=fill, consolidated=False)

    write_whole(path, write)


#: Where a block of a variable goes, and its values.
Blocks = Iterable[tuple[tuple[Any, ...], np.ndarray]]


def save_blocks(
    path: str | Path,
    name: str,
    sizes: dict[str, int],
    chunks: tuple[int, ...],
    blocks: Blocks,
    rest: Callable[[], xr.Dataset],
) -> None:
    """Write one complex variable block by block, then what goes with it; the file is what `save` would write.

    Parameters
    ----------
    path : path
        Ending in .nc or .zarr; replaced if it exists, once the new one is complete.
    name : str
    sizes : dimension -> length
        Of the variable, in its order.
    chunks : tuple of int
        Of a Zarr store, which blocks must cover whole.
    blocks : iterable of (index, values)
    rest : function
        The dataset without that variable, asked for when all blocks have been written.
    """
    path = Path(path)
    kind = _kind(path)
    shape, labels = tuple(sizes.values()), dict[str, Any](label(name))

    def write(draft: Path) -> None:
        if kind == "netcdf":
            import h5netcdf

            with h5netcdf.File(draft, "w") as file:
                file.dimensions = sizes
                into = file.create_variable(name, tuple(sizes), dtype=np.dtype(complex))
                into.attrs.update(labels)
                for where, values in blocks:
                    into[where] = values
            rest().to_netcdf(draft, mode="a", engine="h5netcdf")
            return
        _import_zarr()
        import zarr

        group = zarr.open_group(draft, mode="w")
        nothing, dims = complex(np.nan, np.nan), list(sizes)
        into = group.create_array(
            name, shape=shape, dtype=complex, chunks=chunks, fill_value=nothing, dimension_names=dims, attributes=labels
        )
        for where, values in blocks:
            into[where] = values
        rest().to_zarr(draft, mode="a", consolidated=False)

    write_whole(path, write)


def load(path: str | Path) -> xr.Dataset:
    """Read a dataset that `save` wrote, into memory.

    `beamprop.provenance` rebuilds the slab and beam that it records.

    Raises
    ------
    ValueError
        No such file, or an unknown ending.
    """
    path = Path(path)
    kind = _kind(path)
    if not path.exists():
        raise ValueError(f"path: expected an existing file, got {str(path)!r}")
    if kind == "netcdf":
        with xr.open_dataset(path, engine="h5netcdf") as opened:
            ds = opened.load()
    else:
        _import_zarr()
        with xr.open_zarr(path, consolidated=False) as opened:
            ds = opened.load()
    for name in ds.variables:
        with contextlib.suppress(KeyError):
            ds[name].encoding = {}
    ds.encoding = {}
    return _joined(ds)


def _import_zarr() -> None:
    try:
        import zarr  # noqa: F401
    except ImportError:
        raise ImportError('Zarr stores need zarr: pip install "beamprop[zarr]"') from None


def _split(ds: xr.Dataset) -> xr.Dataset:
    """Complex variables and coordinates as pairs of real ones."""
    pairs: dict[str, Any] = {}
    for name, v in ds.variables.items():
        if v.dtype.kind == "c":
            attrs = dict(v.attrs)
            where = {"was_coordinate": 1} if name in ds.coords else {}
            for part, values in (("real", v.values.real), ("imag", v.values.imag)):
                long_name = f"{attrs.get('long_name', name)}, {part} part"
                pairs[f"{name}_{part}"] = (
                    v.dims,
                    values,
                    attrs | {"long_name": long_name, "part_of": str(name)} | where,
                )
    return ds.drop_vars([n for n, v in ds.variables.items() if v.dtype.kind == "c"]).assign(pairs)


def _joined(ds: xr.Dataset) -> xr.Dataset:
    """Pairs of real variables as the complex ones they came from; structured {r, i} as complex."""
    whole: dict[str, Any] = {}
    places: list[str] = []
    for name, v in ds.variables.items():
        if v.dtype.names == ("r", "i"):
            whole[str(name)] = (v.dims, v.values["r"] + 1j * v.values["i"], v.attrs)
        part_of = v.attrs.get("part_of")
        if part_of and str(name) == f"{part_of}_real" and f"{part_of}_imag" in ds.variables:
            attrs = {k: a for k, a in v.attrs.items() if k not in ("part_of", "was_coordinate")}
            if v.attrs.get("was_coordinate"):
                places.append(part_of)
            attrs["long_name"] = attrs.get("long_name", "").removesuffix(", real part")
            whole[part_of] = (v.dims, v.values + 1j * ds.variables[f"{part_of}_imag"].values, attrs)
            ds = ds.drop_vars([name, f"{part_of}_imag"])
    return ds.assign(whole).set_coords(places)
