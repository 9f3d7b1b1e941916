"""Datasets for other programs: MATLAB (.mat), ParaView (.vti, .vtr), and tables of what has one dimension (.csv)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

from ... import validate
from ..storage import EXPORTS, STORED, save, write_whole
from . import table, vtk

#: Of each ending, what makes the pieces of the file.
PIECES: dict[str, Callable[[xr.Dataset], list[bytes]]] = dict(
    zip(EXPORTS, (vtk.image, vtk.rectilinear, table.rows), strict=True)
)
EXPORTED = (".mat", *PIECES)
#: What a file can be written as at all.
WRITTEN = (*STORED, *PIECES)


def export(ds: xr.Dataset, path: str | Path) -> None:
    """Write a dataset for another program: MATLAB (.mat), ParaView (.vti, .vtr), or a table of one dimension (.csv).

    Parameters
    ----------
    ds : Dataset
    path : path
        Replaced if it exists, once the new file is complete. By ending:

        .mat
            Each variable by its name, complex as complex; the struct ``about`` has units and dimensions. `load` reads it.
        .vti, .vtr
            The field on its positions x, y, z [m]: real and imaginary part, magnitude and phase [rad] of what is complex. An array for each
            frequency and angle, named by them. Uneven positions take .vtr. What has no position stands in the file's field data.
        .csv
            A row for each value of the one dimension, which begins it; columns by name and unit, two of what is complex, and those of
            scalars. NaN and Inf are words.

    Raises
    ------
    ValueError
        Unknown ending, missing folder, or a dataset that the format does not hold: names what to do.
    OSError
        The system refused a write. What stood there is left as it was.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> bp.export(bp.field(slab, beam, 2500.0, np.linspace(-0.1, 0.1, 21), np.linspace(0, 0.2, 11)), "beam.vti")
    >>> bp.export(bp.scattering(slab, 2500.0, angle=[0, 30, 60]), "spectrum.csv")
    >>> with open("spectrum.csv") as file:
    ...     file.readline()[:32]
    'angle (degree),r_real (1),r_imag'
    """
    validate.instance(ds, xr.Dataset, "ds")
    path = validate.as_path(path)
    ending = path.suffix.lower()
    if ending not in EXPORTED:
        raise validate.refuse("path", f"an ending of {', '.join(EXPORTED)}", path.name)
    if ending in PIECES:
        pieces = PIECES[ending](ds)
        write_whole(path, lambda draft: _write(draft, pieces))
    else:
        save(ds, path)


def write(ds: xr.Dataset, path: str | Path, **options: Any) -> None:
    """Save or export a dataset, by the ending of its file; options are those of `save`."""
    if Path(path).suffix.lower() not in PIECES:
        save(ds, path, **options)
        return
    if options:
        raise validate.refuse(next(iter(options)), f"a file ending in {', '.join(STORED)}", str(path))
    export(ds, path)


def _write(draft: Path, pieces: list[bytes]) -> None:
    with open(draft, "wb") as file:
        file.writelines(pieces)
