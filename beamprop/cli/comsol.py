"""What `compare` and `convert` are told about COMSOL's text, and the grid for scattered nodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import parameters
from .options import all_of

if TYPE_CHECKING:
    import xarray as xr

COMSOL = all_of(
    click.option("--length-unit", help="Unit of the coordinates in COMSOL's text, where it states none."),
    click.option(
        "--angle-unit", help="Unit of angles such as theta=0.5 in COMSOL's text, where it states none: deg, rad."
    ),
    click.option(
        "--grid",
        nargs=2,
        metavar="X Z",
        help="Bring scattered nodes onto this grid by linear interpolation: two axes [m], each a,b,c or start:stop:count.",
    ),
)


def is_text(path: Path) -> bool:
    """Whether a file is COMSOL's text: whatever is no dataset of ours."""
    from ..io.storage import NETCDF, ZARR

    return path.suffix.lower() not in NETCDF + ZARR


def read(path: Path, **options: Any) -> xr.Dataset:
    """A dataset of ours, or COMSOL's text with `options` of `read_comsol`."""
    from ..io.comsol import read_comsol
    from ..io.storage import load

    return read_comsol(path, **options) if is_text(path) else load(path)


def on_grid(grid: tuple[str, str] | None, *datasets: xr.Dataset) -> list[xr.Dataset]:
    """Scattered nodes brought onto a grid (x, z), if one is given."""
    from ..io.comsol import to_grid

    if not grid:
        return list(datasets)
    if not any("node" in ds.dims for ds in datasets):
        raise ValueError(f"grid: expected none, for there are no scattered nodes, got {' '.join(grid)}")
    x, z = (parameters.axis(text, "grid") for text in grid)
    return [to_grid(ds, x, z) if "node" in ds.dims else ds for ds in datasets]


def refuse_unused(units: dict[str, str | None], *paths: Path) -> None:
    """Refuse units where no file is a text that they could be for."""
    for name, unit in units.items():
        if unit is not None and not any(map(is_text, paths)):
            raise ValueError(f"{name}: expected none, for there is no text of COMSOL's to be read, got {unit!r}")
