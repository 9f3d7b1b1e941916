"""Curves through a field, along x or along z."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from . import labels, maps, panels, style, units
from .quantities import QUANTITIES, drawn, variables

#: Curves of a picture at most: the line cycle has no more.
MOST = 8


def cut(
    ds: xr.Dataset,
    z: Any = None,
    x: Any = None,
    quantity: str = "abs",
    ax: Any = None,
    label: str | None = None,
    *,
    floor: float = -40.0,
    width: float = style.COLUMN,
) -> Any:
    """Curves of a field along x on planes z, or along z on lines x, with the slab's faces as dashed lines.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.field` at one frequency and angle.
    z, x : float or up to 8 of them, m
        Where to cut: either of them. The nearest plane or line of the grid is drawn, and named in the legend. Both may be left out
        where `ds` is on one axis.
    quantity : "abs", "real", "phase", "dB" or "intensity"
        As in `plot.field`; a level is over the largest \\|p\\| of `ds`.
    ax : Axes, optional
    label : str, optional
        Before the place in the legend.
    floor : float, dB
        The least level.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came; also for a place outside of the grid.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> ds = bp.field(slab, beam, 2500.0, x=np.linspace(-0.2, 0.2, 101), z=slab.cell.thickness * np.arange(60))
    >>> ax = bp.plot.cut(ds, z=[0.0, slab.thickness])
    >>> [line.get_label() for line in ax.lines]
    ['z = 0 m', 'z = 0.04573 m']
    """
    validate.word(quantity, "quantity", *QUANTITIES)
    validate.instance(ds, xr.Dataset, "ds")
    _, floor = maps.checked_scale(None, floor)
    names = variables(ds, quantity)
    labels.need(ds, *names)
    parts = tuple(ds[name].squeeze(drop=True) for name in names)
    along, places = _place(parts[0], z, x)
    shown = drawn(tuple(part.transpose(..., along).sortby(along) for part in parts), quantity, None, floor)
    at = np.sort(ds[along].values)
    with style.drawing(ax, width) as axes:
        for place, text in places:
            values = shown.values if place is None else shown.values[place]
            name = text if label is None else f"{label}, {text}" if text else label
            axes.plot(at, _unbroken(values) if quantity == "phase" else values, label=name or None)
        _name(axes, along, at, shown, quantity)
        if along == "z":
            maps.warn_of_grid(ds, at)
            maps.outline(axes, ds, axes.get_window_extent().width / axes.figure.dpi * style.INCH, "0.4")
        panels.tell_where(axes, ds)
        if axes.get_legend_handles_labels()[0]:
            # phases fill the picture: their legend stands beside it
            axes.legend(**{"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if quantity == "phase" else {})
    return axes


def _name(ax: Any, along: str, at: np.ndarray, shown: Any, quantity: str) -> None:
    """Labels and limits of both axes."""
    units.name_axis(ax.xaxis, along, at, "m")
    units.name_axis(ax.yaxis, shown.name, ax.get_ylim() if quantity != "phase" else (-180, 180), shown.unit)
    ax.set_xlim(at[0], at[-1])
    if quantity in ("abs", "intensity"):
        ax.set_ylim(0, None)
    elif quantity == "dB":
        ax.set_ylim(shown.low, shown.high + 2)
    elif quantity == "phase":
        ax.set_yticks([-180, -90, 0, 90, 180])


def _place(p: xr.DataArray, z: Any, x: Any) -> tuple[str, list[tuple[int | None, str]]]:
    """The axis along which is cut, and of each curve its index on the axis across and its name."""
    dims = list(map(str, p.dims))
    if more := [d for d in dims if d not in ("z", "x")]:
        raise ValueError(f"ds: expected a field on (z, x); select one of {', '.join(more)}")
    given = {name: value for name, value in (("z", z), ("x", x)) if value is not None}
    if len(dims) == 1 and not given:
        return dims[0], [(None, "")]
    if len(dims) != 2 or len(given) != 1:
        raise ValueError(
            f"z, x: expected {'either of them' if len(dims) == 2 else 'none for a field on one axis'}, "
            f"got {' and '.join(given) or 'neither'}"
        )
    ((across, places),) = given.items()
    return ("x" if across == "z" else "z"), _nearest(p[across], places, across)


def _nearest(grid: xr.DataArray, places: Any, name: str) -> list[tuple[int | None, str]]:
    """Indices of the places of a grid that are nearest to some, with their names."""
    wanted = np.atleast_1d(validate.axis(places, name))
    if wanted.size > MOST:
        raise ValueError(f"{name}: expected at most {MOST} curves, got {wanted.size}")
    at = np.asarray(grid.values, float)
    low, high = at.min(), at.max()
    room = (high - low) / (at.size - 1)
    for value in wanted:
        if not low - room <= value <= high + room:
            raise ValueError(f"{name}: expected positions from {low:g} to {high:g} m, got {value:g}")
    nearest = [int(np.argmin(np.abs(at - value))) for value in wanted]
    unit, factor = units.scale("m", at)
    return [(i, f"{name} = {units.number(float(f'{at[i] * factor:.4g}'))} {unit}") for i in nearest]


def _unbroken(phase: np.ndarray) -> np.ndarray:
    """A phase whose jumps by a turn are gaps, not strokes across the picture."""
    jumps = np.abs(np.diff(phase, append=phase[-1:])) > 180
    return np.where(jumps, np.nan, phase)
