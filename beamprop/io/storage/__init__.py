"""Datasets to files and back: netCDF, Zarr and MATLAB's format by ending; complex numbers, attributes and provenance round-trip.

A netCDF file holds arrays of real numbers alone, for that is what all readers take: a complex `p` is the pair ``p_real`` and ``p_imag``, which `load`
joins again. (The compound type {r, i}, which files of 0.1.0 hold, is read by Octave as zeros.) Zarr knows complex numbers, MATLAB words too.
A file appears under its name only when it is complete and is on the disk by then; netCDF and Zarr carry checksums that `load` verifies.

Order of the files here: `whole` and `settled` know paths alone, `guarded` and `seal` bytes, `netcdf`, `zarr_store` and `matlab` a format each.
"""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

from ... import validate
from ..labels import label
from .blocked import BlockedVariables, Blocks
from .parts import plain, restored, split
from .rounding import as_digits, in_double, rounded
from .settled import read_settled
from .whole import check_target, write_whole

__all__ = ["STORED", "Blocks", "check_target", "load", "save", "save_blocks", "write_whole"]

#: Endings, and the file here that knows their format.
FORMATS = dict.fromkeys((".nc", ".nc4", ".netcdf", ".h5"), "netcdf") | {".zarr": "zarr_store", ".mat": "matlab"}
STORED = tuple(FORMATS)
#: Endings for other programs, which are not read again.
EXPORTS = (".vti", ".vtr", ".csv")
#: zlib's level for rounded values: higher ones are slower and save some percent.
LEVEL_OF_ROUNDED = 4


def _kind(path: Path, kinds: tuple[str, ...] = ("netcdf", "zarr_store", "matlab")) -> str:
    endings = [ending for ending, kind in FORMATS.items() if kind in kinds]
    if path.suffix.lower() not in endings:
        hint = " (which export writes)" if path.suffix.lower() in EXPORTS else ""
        raise ValueError(f"path: expected an ending of {', '.join(endings)}, got {path.name!r}{hint}")
    return FORMATS[path.suffix.lower()]


def _format(kind: str) -> Any:
    """The module of a format, imported when it is needed."""
    return importlib.import_module(f".{kind}", __name__)


def _path(path: object) -> Path:
    if "\0" in str(path) and isinstance(path, str | Path):
        raise validate.refuse("path", "a name that the file system takes", str(path))
    return validate.as_path(path)


def save(
    ds: xr.Dataset,
    path: str | Path,
    *,
    digits: int | None = None,
    split_complex: bool | None = None,
    compression: int | None = None,
) -> None:
    """Write a dataset to a netCDF file (.nc), a Zarr store (.zarr) or a file of MATLAB's (.mat).

    Parameters
    ----------
    ds : Dataset
    path : path
        Replaced if it exists, once the new one is complete: readers find the old one or the new one.
    digits : int
        Round each data variable to so many digits of its largest value, and store what is left compressed, in single precision where
        that holds it. The attribute ``rounding_error`` states the largest error of a value (of real and imaginary part each). All digits by default.
    split_complex : bool
        Write complex variables as pairs of real ones, ``p_real`` and ``p_imag``. By default netCDF files have such pairs, which every
        reader takes, and Zarr and MATLAB have complex numbers. False writes netCDF with a compound type, which few readers know.
    compression : int
        zlib level 0 to 9 of netCDF variables: 4 with `digits`, otherwise 0, for values of full precision hardly compress.

    Raises
    ------
    ValueError
        Unknown ending, missing folder, a folder of other things in the way, no Dataset, or names that the format has not.
    OSError
        The system refused a write (a full disk, say). What stood there is left as it was.

    Examples
    --------
    >>> ds = bp.bloch(bp.lmmd_cell(), 2500.0, kx_over_k0=np.linspace(0, 5, 11))
    >>> bp.save(ds, "contour.nc")
    >>> bp.load("contour.nc").identical(ds)
    True
    >>> bp.save(ds, "contour.nc", digits=4)
    >>> error = bp.load("contour.nc").kz_over_k0.attrs["rounding_error"]
    >>> bool(error <= 0.5e-4 * abs(ds.kz_over_k0).max())
    True
    """
    if not isinstance(ds, xr.Dataset):
        raise ValueError(f"ds: expected a Dataset, got {type(ds).__name__}")
    digits = as_digits(digits)
    level = _level(compression if compression is not None else LEVEL_OF_ROUNDED if digits else 0)
    path = _path(path)
    kind = _kind(path)
    pairs = kind == "netcdf" if split_complex is None else validate.flag(split_complex, "split_complex")
    out = rounded(ds, digits) if digits else ds.copy(deep=False)
    out = plain(out, pairs) if kind != "matlab" else split(out) if pairs else out
    for name in out.variables:
        out[name].encoding = {}
    write_whole(path, lambda draft: _format(kind).write(draft, out, level))


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
    kind = _kind(path, ("netcdf", "zarr_store"))
    variables = BlockedVariables(kinds, sizes, chunks, {name: dict(label(name)) for name in kinds}, blocks)
    write_whole(path, lambda draft: _format(kind).write_blocks(draft, variables, rest))


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
    ds = read_settled(path, _format(_kind(path)).read)
    for name in ds.variables:
        with contextlib.suppress(KeyError):
            ds[name].encoding = {}
    ds.encoding = {}
    return in_double(restored(ds))
