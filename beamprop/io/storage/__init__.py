"""Datasets to files and back: netCDF and Zarr by ending; complex numbers, attributes and provenance round-trip.

Complex variables are written as the compound type {r, i}, which netCDF4 (``auto_complex=True``), h5py and Octave read
as complex numbers too. `save` with ``split_complex=True`` writes a pair of real variables ``p_real`` and ``p_imag`` for readers
that do not know compound types; `load` joins them again. A file appears under its name only when it is complete, is on the disk by then,
and carries checksums that `load` verifies.

Order of the files here: `whole` and `settled` know paths alone, `guarded` and `seal` bytes, `netcdf` and `zarr_store` a format each.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from ... import validate
from ..labels import label
from .blocked import BlockedVariables, Blocks
from .parts import joined, split
from .settled import read_settled
from .whole import check_target, write_whole

__all__ = ["NETCDF", "ZARR", "Blocks", "check_target", "load", "save", "save_blocks", "write_whole"]

NETCDF = (".nc", ".nc4", ".netcdf", ".h5")
ZARR = (".zarr",)


def _kind(path: Path) -> str:
    if path.suffix.lower() in NETCDF:
        return "netcdf"
    if path.suffix.lower() in ZARR:
        return "zarr"
    raise ValueError(f"path: expected an ending of {', '.join(NETCDF + ZARR)}, got {path.name!r}")


def _path(path: object) -> Path:
    if "\0" in str(path) and isinstance(path, str | Path):
        raise validate.refuse("path", "a name that the file system takes", str(path))
    return validate.as_path(path)


def save(ds: xr.Dataset, path: str | Path, *, split_complex: bool = False, compression: int = 0) -> None:
    """Write a dataset to a netCDF file (.nc) or a Zarr store (.zarr), with checksums.

    Parameters
    ----------
    ds : Dataset
    path : path
        Replaced if it exists, once the new one is complete: readers find the old one or the new one.
    split_complex : bool
        Write complex variables as pairs of real ones, for readers that do not know compound types.
    compression : int
        zlib level 0 to 9 of netCDF variables. Fields of full precision hardly compress.

    Raises
    ------
    ValueError
        Unknown ending, missing folder, a folder of other things in the way, or no Dataset.
    OSError
        The system refused a write (a full disk, say). What stood there is left as it was.

    Examples
    --------
    >>> ds = bp.bloch(bp.lmmd_cell(), 2500.0, kx_over_k0=np.linspace(0, 5, 11))
    >>> bp.save(ds, "contour.nc")
    >>> bp.load("contour.nc").identical(ds)
    True
    """
    if not isinstance(ds, xr.Dataset):
        raise ValueError(f"ds: expected a Dataset, got {type(ds).__name__}")
    split_complex, compression = validate.flag(split_complex, "split_complex"), _level(compression)
    path = _path(path)
    kind = _kind(path)
    out = split(ds) if split_complex else ds.copy(deep=False)
    for name in out.variables:
        out[name].encoding = {}

    def write(draft: Path) -> None:
        if kind == "netcdf":
            from . import netcdf

            netcdf.write(draft, out, compression)
        else:
            from . import zarr_store

            zarr_store.write(draft, out)

    write_whole(path, write)


def _level(compression: int) -> int:
    level = validate.as_count(compression, "compression", 0)
    if level > 9:
        raise validate.refuse("compression", "a whole number from 0 to 9", compression)
    return level


def save_blocks(
    path: str | Path,
    kinds: dict[str, type],
    sizes: dict[str, int],
    chunks: tuple[int, ...],
    blocks: Blocks,
    rest: Callable[[], xr.Dataset],
) -> None:
    """Write variables block by block, then what goes with them; `load` gives what it gives of `save`'s file.

    Parameters
    ----------
    path : path
        Ending in .nc or .zarr; replaced if it exists, once the new one is complete.
    kinds : name -> type of its values, complex or float
    sizes : dimension -> length
        Of all variables, in their order.
    chunks : tuple of int
        Of the file, which blocks must cover whole.
    blocks : iterable of (index, name -> values)
    rest : function
        The dataset without these variables, asked for when all blocks have been written.
    """
    path = _path(path)
    kind = _kind(path)
    variables = BlockedVariables(kinds, sizes, chunks, {name: dict(label(name)) for name in kinds}, blocks)

    def write(draft: Path) -> None:
        if kind == "netcdf":
            from . import netcdf

            netcdf.write_blocks(draft, variables, rest)
        else:
            from . import zarr_store

            zarr_store.write_blocks(draft, variables, rest)

    write_whole(path, write)


def load(path: str | Path) -> xr.Dataset:
    """Read a dataset that `save` wrote, into memory.

    Checksums are verified, and what `save` does not write is refused before it is opened. `beamprop.provenance` rebuilds the slab and beam
    that the dataset records.

    Raises
    ------
    ValueError
        No such file, an unknown ending, or a file that is damaged, cut off, or of another kind: names it, the variable,
        and what is wrong.

    Examples
    --------
    >>> bp.save(bp.scattering(bp.Slab(bp.lmmd_cell(), periods=20), 2500.0, angle=[0, 45]), "spectrum.nc")
    >>> bp.load("spectrum.nc").sizes["angle"]
    2
    """
    path = _path(path)
    ds = read_settled(path, _reader(_kind(path)))
    for name in ds.variables:
        with contextlib.suppress(KeyError):
            ds[name].encoding = {}
    ds.encoding = {}
    return joined(ds)


def _reader(kind: str) -> Callable[[Path], xr.Dataset]:
    if kind == "netcdf":
        from . import netcdf

        return netcdf.read
    from . import zarr_store

    return zarr_store.read
