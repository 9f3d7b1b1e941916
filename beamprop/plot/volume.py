"""The picture of a volume: three planes through its peak, on one colour scale."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr

from .. import validate
from . import maps, spread, style, units
from .quantities import Drawn

#: From this width on the planes stand side by side; below it one above another [mm].
BROAD = 130.0
#: What labels take of a panel's width, beside it, and what its title, its axis and the figure's title take of the height [mm].
BESIDE, ABOVE, TITLE = 18.0, 15.0, 10.0
#: Height of a panel over its width at most: steeper maps are drawn narrower.
STEEP = 0.8
#: What the colour bar takes of the figure's width [mm].
BAR = 18.0


def through_peak(p: xr.DataArray) -> dict[str, int]:
    """Indices of the largest |p|; y, x and z."""
    size = np.where(np.isfinite(p.values), np.abs(p.values), -1.0)
    return {str(d): int(i) for d, i in zip(p.dims, np.unravel_index(size.argmax(), p.shape), strict=True)}


def draw(ds: xr.Dataset, p: xr.DataArray, shown: Drawn, at: dict[str, int], width: float, colorbar: bool) -> np.ndarray:
    """The planes (x, z), (y, z) and (y, x) of `shown`, which is on the grid of p, (y, x, z), through the point `at`: three Axes."""
    planes = [p.isel({d: at[d]}) for d in ("y", "x", "z")]
    values = [shown.values[at["y"]], shown.values[:, at["x"]], shown.values[:, :, at["z"]]]
    beside = 3 if width >= BROAD else 1
    across = (width - BAR * colorbar) / beside - BESIDE
    heights = [min(maps.proportion(plane, across) or maps.BROAD, STEEP) * across for plane in planes]
    each = [max(heights)] if beside == 3 else heights
    largest = max(maps.farthest(p, str(d)) for d in p.dims)
    figure = style.new_figure(width, TITLE + sum(height + ABOVE for height in each))
    with mpl.rc_context(style.settings()):
        grid = figure.subplots(3 // beside, beside, squeeze=False, height_ratios=each)
        axes = grid.ravel()
        for ax, plane, part, held in zip(axes, planes, values, ("y", "x", "z"), strict=True):
            mesh = maps.mesh_of(ax, plane, shown._replace(values=part), largest)
            note = maps.shape(ax, plane, across)
            if "z" in plane.dims:
                maps.outline(ax, ds, across, shown.line)
            ax.set_title("; ".join(filter(None, (spread.said(p, held, at[held]), note))), fontsize="medium")
        maps.warn_of_grid(ds, p["z"].values)
        if colorbar:
            bar = figure.colorbar(mesh, ax=list(axes), extend=shown.extend, aspect=30, pad=0.02)
            units.name_axis(bar.ax.yaxis, shown.name, (shown.low, shown.high), shown.unit)
            if shown.cmap == "twilight":
                bar.set_ticks([-180, -90, 0, 90, 180])
        text = (spread.where(ds), shown.note if colorbar else "")
        figure.suptitle("\n".join(filter(None, text)), fontsize="medium")
    return axes


def check_alone(ax: Any, half_level: bool) -> None:
    """Refuse what a volume has no place for."""
    if ax is not None:
        raise validate.refuse("ax", "none for a volume, which takes three; draw a plane, such as ds.isel(y=0)", ax)
    if half_level:
        raise validate.refuse("half_level", "False for a volume", half_level)
