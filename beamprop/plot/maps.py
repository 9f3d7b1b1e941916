"""What maps have in common: their grid, their place in a figure, the colour bar beside them, and the slab's outline."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation, blended_transform_factory

from .. import validate
from ..io.datasets import provenance
from ..media.planes import warn_of_stripes
from ..media.structures import Slab
from . import spread, units
from .quantities import Drawn
from .style import INCH

#: Axes of a map, from the upright to the level one.
PLACES = ("y", "x", "z")
#: Gap between map and colour bar, and the bar's width [mm].
GAP, BAR = 1.5, 2.5
#: What labels and the colour bar take of a figure's width, about [mm].
BESIDE = 26.0
#: A map in true proportion has room for the colour bar's label from this height on, and is at most so many times as high as wide [mm].
LOWEST, STEEPEST = 22.0, 4.0
#: A figure is at most so many times as high as wide, and fits on a page [mm].
HIGHEST, PAGE_HEIGHT = 1.5, 230.0
#: Height over width of a map that is not in true proportion.
BROAD, STEEP = 0.6, 1.0
#: Both axes of a map have one unit, unless one reaches so many times as far.
FEW_ZEROS = 50
#: Lines nearer to each other than this are not drawn [mm].
APART = 1.2


def on_grid(ds: xr.Dataset, names: tuple[str, ...], volume: bool = False) -> tuple[xr.DataArray, ...]:
    """Variables on a plane, its upright axis and then its level one (z, or else x), both rising; refused if they are not on a map.

    With `volume` they may be on (y, x, z) as well.
    """
    parts = tuple(ds[name].squeeze(drop=True) for name in names)
    dims = list(map(str, parts[0].dims))
    if more := [d for d in dims if d not in PLACES]:
        raise ValueError(f"ds: expected a field on (z, x); select one of {', '.join(more)}")
    if len(dims) == 3 and not volume:
        raise ValueError("ds: expected a field on a plane, got one in a volume: select one of y, x or z")
    if len(dims) < 2:
        raise ValueError(
            f"ds: expected a field on (z, x), got one {f'along {dims[0]}' if dims else 'point'} for plot.cut"
        )
    order = [d for d in PLACES if d in dims]
    return tuple(part.transpose(*order).sortby(order).drop_duplicates(...) for part in parts)


def slab_of(ds: xr.Dataset) -> Slab | None:
    """The slab of a dataset's provenance, if there is one."""
    try:
        slab = provenance(ds).get("slab")
    except (ValueError, KeyError, TypeError):  # of another program, or of a later version
        return None
    return slab if isinstance(slab, Slab) else None


def checked_scale(limit: float | None, floor: float) -> tuple[float | None, float]:
    """Both ends of a colour scale, checked."""
    floor = validate.as_number(floor, "floor")
    if floor >= 0:
        raise validate.refuse("floor", "a level below zero [dB]", floor)
    return None if limit is None else validate.as_number(limit, "limit", positive=True), floor


def draw(ax: Any, ds: xr.Dataset, p: xr.DataArray, shown: Drawn, width: float | None, colorbar: bool = True) -> Any:
    """The map of `shown`, which is on the grid of p, with all that belongs to it; its mesh. `width` [mm] is that of a new figure."""
    across = ax.get_window_extent().width / ax.figure.dpi * INCH if width is None else width - BESIDE
    mesh = mesh_of(ax, p, shown)
    note = shape(ax, p, across)
    if "z" in p.dims:
        warn_of_grid(ds, p["z"].values)
        outline(ax, ds, across, shown.line)
    if colorbar:
        add_colorbar(ax, mesh, shown)
    notes = [shown.note] * colorbar + [note]
    ax.set_title("\n".join(filter(None, (spread.where(ds), "; ".join(filter(None, notes))))), fontsize="medium")
    if width is not None:
        _fit_height(ax.figure)
    return mesh


def warn_of_grid(ds: xr.Dataset, z: np.ndarray) -> None:
    """A hint that the planes of a field skip through the cells of its slab, unless they are means over a cell."""
    slab = slab_of(ds)
    if slab is not None and "frequency" in ds.coords and "average" not in ds.attrs:
        frequency = np.atleast_1d(np.asarray(ds["frequency"].values, float))
        warn_of_stripes(slab, z, frequency)


# --- proportion -------------------------------------------------------------------------------------------


def _span(p: xr.DataArray) -> tuple[float, float]:
    """What a map spans to the side and upwards [m], with half a step at each end."""
    upright, level = (float(np.ptp(p[d].values) * (1 + 1 / (p.sizes[d] - 1))) for d in p.dims)
    return level, upright


def proportion(p: xr.DataArray, across: float) -> float | None:
    """Height over width in true proportion of a map `across` mm wide, or None where that would be a stripe."""
    level, upright = _span(p)
    ratio = upright / level
    return ratio if LOWEST / across <= ratio <= STEEPEST else None


def shape(ax: Any, p: xr.DataArray, across: float) -> str:
    """Give Axes the proportion of their map; a note where it is not the true one."""
    if proportion(p, across) is not None:
        ax.set_aspect("equal")
        return ""
    level, upright = _span(p)
    ax.set_aspect("auto")
    ax.set_box_aspect(BROAD if upright < level else STEEP)
    return f"{' and '.join(map(str, p.dims))} not to scale"


def _fit_height(figure: Any) -> None:
    """Make a figure as high as what is on it, where that has the figure's width."""
    width, _ = figure.get_size_inches()
    most = min(HIGHEST * width, PAGE_HEIGHT / INCH)
    figure.set_size_inches(width, 3 * width)
    figure.draw_without_rendering()
    needed = figure.get_tightbbox().height + 2 * figure.get_layout_engine().get()["h_pad"]
    figure.set_size_inches(width, min(needed, most))


# --- on the map -------------------------------------------------------------------------------------------


def mesh_of(ax: Any, p: xr.DataArray, shown: Drawn, largest: float = 0.0) -> Any:
    """The map's cells, each about its point. `largest` is the largest position of maps beside it, if that is larger."""
    upright, level = map(str, p.dims)
    mesh = ax.pcolormesh(
        p[level].values,
        p[upright].values,
        shown.values,
        shading="nearest",
        rasterized=True,
        cmap=shown.cmap,
        vmin=shown.low,
        vmax=shown.high,
    )
    reach = {name: farthest(p, name) for name in (level, upright)}
    largest = max(largest, *reach.values())
    for axis, name in ((ax.xaxis, level), (ax.yaxis, upright)):
        units.name_axis(axis, name, largest if FEW_ZEROS * reach[name] >= largest else reach[name], "m")
    return mesh


def farthest(p: xr.DataArray, name: str) -> float:
    """The largest position along an axis, of either sign."""
    return float(np.abs(p[name].values).max(initial=0.0))


def add_colorbar(ax: Any, mesh: Any, shown: Drawn, above: bool = False) -> Any:
    """A colour bar exactly as high as the map beside it, or as wide `above` it, whatever the layout."""
    side, across = (0, 1), (GAP / INCH, BAR / INCH)
    inches = ax.figure.dpi_scale_trans + ScaledTranslation(*(side if above else side[::-1]), ax.transAxes)
    if above:
        place = ax.inset_axes([0, across[0], 1, across[1]], transform=blended_transform_factory(ax.transAxes, inches))
    else:
        place = ax.inset_axes([across[0], 0, across[1], 1], transform=blended_transform_factory(inches, ax.transAxes))
    bar = ax.figure.colorbar(mesh, cax=place, extend=shown.extend, orientation="horizontal" if above else "vertical")
    axis = bar.ax.xaxis if above else bar.ax.yaxis
    units.name_axis(axis, shown.name, (shown.low, shown.high), shown.unit)
    if above:
        axis.set_ticks_position("top")
        axis.set_label_position("top")
    if shown.cmap == "twilight":
        bar.set_ticks([-180, -90, 0, 90, 180])
    else:
        bar.locator = MaxNLocator(_ticks(ax) if above else 6, steps=[1, 2, 5, 10])
    return bar


def _ticks(ax: Any) -> int:
    """Intervals of a colour bar above a map, whose numbers take 9 mm each."""
    return max(1, min(5, int(ax.get_window_extent().width / ax.figure.dpi * INCH / 9)))


def outline(ax: Any, ds: xr.Dataset, across: float, color: str) -> None:
    """The slab's faces as dashed lines, and its layers (or its cells) as thin ones where `across` mm have room for them."""
    slab = slab_of(ds)
    left, right = sorted(ax.get_xlim())
    thickness = ds.attrs.get("slab_thickness") if slab is None else slab.thickness
    for face in {0.0, thickness} - {None}:
        if left <= face <= right:
            ax.axvline(face, color=color, ls="--", lw=0.8)
    if slab is not None:
        for z in inner_faces(slab, APART * (right - left) / across):
            if left < z < right:
                ax.axvline(z, color=color, ls="-", lw=0.4, alpha=0.6)


def inner_faces(slab: Slab, apart: float) -> list[float]:
    """Where layers meet inside a slab [m]: of each segment all layers, its cells or its faces, whichever are `apart` [m]."""
    faces, start = [], 0.0
    for cell, periods in slab.segments:
        layers = np.cumsum([layer.thickness for layer in cell.layers])
        if min((layer.thickness for layer in cell.layers if layer.thickness > 0), default=0.0) < apart:
            layers = layers[-1:]
        if cell.thickness >= apart:
            faces += [start + i * cell.thickness + float(z) for i in range(periods) for z in layers]
        start += periods * cell.thickness
        faces.append(start)
    return sorted(set(faces))[:-1]
