"""x, y and complex p of a sampled plane, from MATLAB's, NumPy's and netCDF's files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .. import validate

#: What is read, if it is there.
NAMES = ("x", "y", "p", "p_real", "p_imag")
#: netCDF's attributes by which a stored number is not its value.
SCALED = ("scale_factor", "add_offset")


def read_plane(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x (X,), y (Y,) and p (Y, X), or a ValueError that names the file and what is wrong."""
    readers = {".mat": _matlab, ".npz": _numpy, ".nc": _netcdf}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise validate.refuse("path", f"a file {', '.join(readers)}", str(path))
    with open(validate.existing(path), "rb"):  # a file that cannot be opened is an OSError, whatever the format
        pass
    try:
        arrays = reader(path)
    except (MemoryError, _Refusal):
        raise
    except Exception as error:
        raise ValueError(f"{path}: expected a {path.suffix} file, got one that cannot be read ({error})") from None
    parts = ("p",) if "p" in arrays else ("p_real", "p_imag")
    missing = [name for name in ("x", "y", *parts) if name not in arrays]
    if missing:
        missing = ["p" if name in parts else name for name in missing]
        names = ", ".join(sorted(arrays)) or "none"
        raise ValueError(
            f"{path}: expected variables x, y and p (or p_real and p_imag), got no {missing[0]} in {names}"
        )
    x, y = (np.atleast_1d(np.squeeze(arrays[name])) for name in "xy")  # MATLAB has rows and columns alone
    p = np.asarray(arrays["p"]) if len(parts) == 1 else np.asarray(arrays["p_real"]) + 1j * np.asarray(arrays["p_imag"])
    p = p.reshape(p.shape[-2:]) if p.ndim > 2 and p.size == p.shape[-1] * p.shape[-2] else p
    if p.shape == (x.size, y.size) != (y.size, x.size):
        raise ValueError(f"{path}: expected p (y, x) of shape {(y.size, x.size)}, got its transpose {p.shape}")
    return x, y, p


class _Refusal(ValueError):
    """A message that is complete."""


def _matlab(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    try:
        return {k: v for k, v in loadmat(path).items() if not k.startswith("__")}
    except NotImplementedError:
        return _matlab_73(path)


def _matlab_73(path: Path) -> Mapping[str, Any]:
    """Version 7.3 is HDF5, by columns where HDF5 goes by rows, with complex numbers as pairs."""
    import h5py

    with h5py.File(path) as file:
        return {k: _of_pairs(v[()]).T for k, v in file.items() if isinstance(v, h5py.Dataset) and k in NAMES}


def _of_pairs(values: np.ndarray) -> np.ndarray:
    return values["real"] + 1j * values["imag"] if values.dtype.names == ("real", "imag") else values


def _numpy(path: Path) -> Mapping[str, Any]:
    with np.load(path, allow_pickle=False) as archive:
        return dict(archive)


def _netcdf(path: Path) -> Mapping[str, Any]:
    import h5py

    with h5py.File(path) as file:
        variables = {k: v for k, v in file.items() if isinstance(v, h5py.Dataset) and k in NAMES}
        scaled = [k for k, v in variables.items() if any(name in v.attrs for name in SCALED)]
        if scaled:
            raise _Refusal(
                f"{path}: expected values as they are, got {scaled[0]} with a scale or an offset: open it with xarray and use from_data"
            )
        return {k: v[()] for k, v in variables.items()}
