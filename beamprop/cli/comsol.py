"""What `compare` and `convert` are told about COMSOL's text, and the grid for scattered nodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import parameters
from .options import all_of, axis_of, option

if TYPE_CHECKING:
    import xarray as xr

GROUP = "COMSOL's text"
COMSOL = all_of(
    option("--length-unit", text="Unit of the coordinates, where the file states none.", group=GROUP),
    option("--angle-unit", text="Unit of angles such as theta=0.5, where the file states none: deg, rad.", group=GROUP),
    option(
        "--grid",
        nargs=2,
        kind=axis_of("x"),
        text="Bring scattered nodes onto this grid by linear interpolation: two axes [m], each a,b,c or start:stop:count.",
        group=GROUP,
    ),
)


def is_text(path: Path) -> bool:
    """Whether a file is COMSOL's text: whatever is no dataset of ours."""
    from ..io.storage import STORED

    return path.suffix.lower() not in STORED


def read(path: Path, **options: Any) -> xr.Dataset:
    """A dataset of ours, or COMSOL's text with `options` of `read_comsol`."""
    from ..io.comsol import read_comsol
    from ..io.storage import load

    return read_comsol(path, **options) if is_text(path) else load(path)


def on_grid(grid: tuple[parameters.Axis, parameters.Axis] | None, *datasets: xr.Dataset) -> list[xr.Dataset]:
    """Scattered nodes brought onto a grid (x, z), if one is given."""
    from ..io.comsol import to_grid

    if not grid:
        return list(datasets)
    if not any("node" in ds.dims for ds in datasets):
        raise ValueError("grid: expected none, for there are no scattered nodes, got two axes")
    with parameters.named("grid", "x", "z"):
        return [to_grid(ds, *grid) if "node" in ds.dims else ds for ds in datasets]


def refuse_unused(options: dict[str, str | None], *paths: Path) -> None:
    """Refuse what is said of COMSOL's text where no file is one."""
    for name, value in options.items():
        if value is not None and not any(map(is_text, paths)):
            raise ValueError(f"{name}: expected none, for there is no text of COMSOL's to be read, got {value!r}")
