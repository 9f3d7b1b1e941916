"""Drawing what `spread` plans: curves, maps and panels, their axes, colour bars and legends."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter
from matplotlib.transforms import ScaledTranslation

from . import spread, style, units

#: A curve of fewer points than this shows each of them by a marker.
POINTS = 13
#: A logarithmic colour scale spans so much at most: smaller values have its lowest colour.
SPAN = 1e-12
#: Colours of a linear scale end at this percentile where the largest value is half as large again: a sharp resonance would leave all else dark.
CLIPPED, SHARP = 99.5, 1.5
#: A figure narrower than this [mm] has two panels in a row at most, others four.
NARROW = (style.COLUMN + style.PAGE) / 2
#: Between panels [inches], and between an axis and the legend below it.
APART, BELOW = 0.05, 0.04
#: The Axes that there are, or None, and the width of a new figure [mm].
Where = tuple[Any, float]


# --- words of axes ----------------------------------------------------------------------------------------


def name_axis(axis: Any, v: xr.DataArray, dim: str) -> None:
    """Label an axis of matplotlib by a dimension, in the unit that suits it; logarithmic where its values have even ratios."""
    coordinate = v[dim]
    label, unit = spread.name_of(coordinate, dim), coordinate.attrs.get("units", "")
    if not spread.is_number(coordinate):
        axis.set_label_text(label)
        return
    values = coordinate.values.astype(float)
    if _has_even_ratios(values):
        {"x": axis.axes.set_xscale, "y": axis.axes.set_yscale}[axis.axis_name]("log")
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(lambda value, _: units.number(value))
        axis.set_minor_formatter(NullFormatter())
    units.name_axis(axis, label, values, unit)


def _has_even_ratios(values: np.ndarray) -> bool:
    if values.size < 4 or not np.all(values > 0) or values.max() < 4 * values.min():
        return False
    ratios = values[1:] / values[:-1]
    return bool(np.allclose(ratios, ratios[0], rtol=1e-6))


def name_values(axis: Any, v: xr.DataArray, log: bool = False) -> None:
    """Label an axis by a quantity; lengths in the unit that suits them, unless the ticks are powers of ten."""
    unit = v.attrs.get("units", "")
    units.name_axis(axis, spread.name_of(v, "value"), 1.0 if log else np.abs(v.values), unit)


def wrap(axis: Any, taken: float = 0.0) -> None:
    """Break the label of an axis that is longer than the axis, less what is taken of it [pixels], into lines of about the same length."""
    box, size = axis.axes.get_window_extent(), axis.label.get_window_extent()
    long, room = (size.width, box.width) if axis.axis_name == "x" else (size.height, box.height)
    axis.set_label_text(_wrapped(axis.label.get_text(), long, max(room - taken, 0.3 * room)))


def _wrapped(text: str, long: float, room: float) -> str:
    lines = math.ceil(long / (0.95 * room)) if long > room else 1
    return text if lines == 1 else textwrap.fill(text, math.ceil(1.2 * len(text) / lines), break_long_words=False)


def finish(ax: Any, new: bool) -> None:
    """The legend, below the Axes, where it covers no data, and labels that fit. A new figure is made higher by the legend.

    A figure without layout keeps the legend inside, at the best place.
    """
    handles, figure = ax.get_legend_handles_labels()[0], ax.get_figure(root=True)
    wrap(ax.xaxis)
    height = 0.0
    if handles and figure.get_layout_engine() is not None:
        height = _legend_below(ax, len(handles))
    elif handles:
        ax.legend()
    # before its layout an Axes is not larger than after it, but for the legend, which makes a new figure higher
    wrap(ax.yaxis, 0.0 if new else height * figure.dpi)
    if new:
        figure.set_figheight(figure.get_figheight() + height)


def _legend_below(ax: Any, count: int) -> float:
    """A legend below the Axes, and the height that it takes [inches]."""
    dpi = ax.get_figure(root=True).dpi
    below = (ax.bbox.y0 - ax.xaxis.get_tightbbox().y0) / dpi + BELOW
    place = ax.transAxes + ScaledTranslation(0, -below, ax.figure.dpi_scale_trans)
    options = {"loc": "upper center", "bbox_to_anchor": (0.5, 0), "bbox_transform": place, "borderaxespad": 0}
    return _in_columns(lambda columns: ax.legend(ncols=columns, **options), count, ax.bbox.width) / dpi + BELOW


def _in_columns(made: Callable[[int], Any], count: int, room: float) -> float:
    """A legend in as many columns as fit: its height [pixels]."""
    for columns in range(min(count, 4), 0, -1):
        legend = made(columns)
        box = legend.get_window_extent()
        if box.width <= room or columns == 1:
            break
        legend.remove()
    return float(box.height)


def tell_where(axes: Any, v: xr.DataArray | xr.Dataset) -> Any:
    """Say what is held at one value above Axes without a title, or above all panels; the Axes."""
    places, text = np.atleast_1d(axes), spread.where(v)
    figure = places[0].get_figure(root=True)
    with style.styled(figure):
        if places.size > 1 and text:
            figure.suptitle(text, fontsize="medium")
        elif places.size == 1 and not places[0].get_title():
            places[0].set_title(text, fontsize="medium")
    return axes


# --- curves and maps --------------------------------------------------------------------------------------


def curves(v: xr.DataArray, along: str, ax: Any, label: str | None = None) -> None:
    """A curve for each entry of the dimensions across `along`."""
    x = v[along].values
    for words, y in spread.each(v, along):
        ax.plot(x, y, marker="o" if x.size < POINTS else "", label=", ".join(filter(None, (label, words))) or None)


class Colours(NamedTuple):
    """A colour scale: matplotlib's options, the ends that values lie beyond, and what the largest of them is, if it does."""

    options: dict[str, Any]
    extend: str = "neither"
    note: str = ""


def colours(values: np.ndarray, log: bool = False) -> Colours:
    """The scale that shows values: from 0 if all are positive, symmetric if they have both signs, logarithmic over `SPAN` at most.

    Examples
    --------
    >>> colours(np.array([1e-20, 1.0]), log=True).extend
    'min'
    >>> colours(np.array([*np.linspace(0, 1, 999), 30.0])).note
    '; largest 30'
    """
    finite = values[np.isfinite(values)]
    largest, least = float(finite.max(initial=0.0)), float(finite.min(initial=0.0))
    if log:
        positive = finite[finite > 0]
        low = max(float(positive.min()), largest * SPAN) if positive.size else 0.1
        norm = mpl.colors.LogNorm(low, max(largest, 2 * low))
        return Colours({"norm": norm}, "min" if np.any(finite < low) else "neither")
    if least < 0:
        end = max(largest, -least)
        return Colours({"vmin": -end, "vmax": end, "cmap": "RdBu_r"})
    top = float(np.percentile(finite, CLIPPED)) if finite.size else 0.0
    if 0 < SHARP * top < largest:
        return Colours({"vmin": 0.0, "vmax": top}, "max", f"; largest {largest:.3g}".replace("e+", "e"))
    return Colours({"vmin": 0.0, "vmax": largest or 1.0})


def mesh(v: xr.DataArray, along: str, ax: Any, scale: Colours) -> Any:
    """A map of `along` and the dimension across it."""
    (across,) = (str(d) for d in v.dims if d != along)
    values = v.transpose(across, along).values
    if "norm" in scale.options:  # zeros have the lowest colour: white is for what is not known
        values = np.where(values <= 0, scale.options["norm"].vmin / 10, values)
    x, y = v[along].values, v[across].values
    drawn = ax.pcolormesh(x, y, values, shading="nearest", rasterized=True, **scale.options)
    name_axis(ax.yaxis, v, across)
    return drawn


def colour_bar(drawn: Any, axes: Any, scale: Colours, v: xr.DataArray) -> None:
    """The colour bar of maps, which says where colours end before the values do."""
    bar = np.atleast_1d(axes)[0].figure.colorbar(drawn, ax=axes, extend=scale.extend, aspect=30, pad=0.02)
    top = scale.options.get("vmax")
    name_values(bar.ax.yaxis, v if top is None else v.clip(max=top), "norm" in scale.options)
    bar.ax.set_ylabel(bar.ax.get_ylabel() + scale.note)
    wrap(bar.ax.yaxis)


# --- the figure -------------------------------------------------------------------------------------------


def draw(v: xr.DataArray, along: str, where: Where, log: bool = False, label: str | None = None) -> Any:
    """Draw a quantity by its plan; the Axes, or an array of the panels' Axes."""
    v = spread.in_order(v)
    plan = spread.plan(v, along)
    if plan.is_map:
        return _maps(v, along, plan.panels, where, log)
    return draw_curves(v, along, plan.panels, where, lambda part, ax: curves(part, along, ax, label), log)


def _maps(v: xr.DataArray, along: str, dim: str | None, where: Where, log: bool) -> Any:
    scale = colours(v.values, log)
    if dim is not None:
        axes, drawn = in_panels(v, along, dim, where, lambda part, ax: mesh(part, along, ax, scale))
        with mpl.rc_context(style.settings()):
            colour_bar(drawn[-1], list(axes), scale, v)
        return axes
    with style.drawing(*where) as ax:
        colour_bar(mesh(v, along, ax, scale), ax, scale, v)
        name_axis(ax.xaxis, v, along)
    return ax


def draw_curves(
    v: xr.DataArray,
    along: str,
    dim: str | None,
    where: Where,
    draw_part: Callable[[xr.DataArray, Any], None],
    log: bool = False,
) -> Any:
    """Curves, drawn by a function of a part of `v` and its Axes, in one Axes or in a panel for each value of `dim`."""
    if dim is not None:
        axes, _ = in_panels(v, along, dim, where, draw_part)
        _share(axes, v, log)
        return axes
    with style.drawing(*where) as ax:
        draw_part(v, ax)
        if log:
            ax.set_yscale("log", nonpositive="mask")
        name_axis(ax.xaxis, v, along)
        name_values(ax.yaxis, v, log)
        finish(ax, where[0] is None)
    return ax


def in_panels(
    v: xr.DataArray, along: str, dim: str, where: Where, draw_part: Callable[[xr.DataArray, Any], Any]
) -> tuple[np.ndarray, list[Any]]:
    """A panel for each value of `dim`, drawn by a function of the part and its Axes: all Axes, and what the function returned.

    Raises
    ------
    ValueError
        There is one Axes for all of them.
    """
    count = v.sizes[dim]
    if where[0] is not None:
        raise ValueError(
            f"ax: expected none for a figure of {count} panels, got Axes; draw one panel with ds.isel({dim}=0)"
        )
    rows = math.ceil(count / (2 if where[1] < NARROW else 4))
    columns = math.ceil(count / rows)
    figure = style.new_figure(where[1], rows * 0.75 * where[1] / columns + 12)
    with mpl.rc_context(style.settings()):
        figure.get_layout_engine().set(w_pad=APART, h_pad=APART)
        grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
        axes = grid[:count]
        for unused in grid[count:]:
            unused.remove()
        drawn = [draw_part(v.isel({dim: i}), ax) for i, ax in enumerate(axes)]
        for i, ax in enumerate(axes):
            ax.set_title(spread.said(v, dim, i))
            ax.xaxis.set_major_locator(MaxNLocator(3))
            name_axis(ax.xaxis, v, along)
            ax.label_outer()
            ax.xaxis.set_tick_params(labelbottom=i + columns >= count)
        _shared_label(figure.supxlabel, [ax.xaxis for ax in axes])
        if axes[0].get_ylabel():
            _shared_label(figure.supylabel, [ax.yaxis for ax in axes])
    return axes, drawn


def _shared_label(put: Callable[[str], Any], axes: list[Any]) -> None:
    """One label of the figure in place of those of its axes."""
    label = put(axes[0].label.get_text() or axes[-1].label.get_text())
    figure, size = label.figure.bbox, label.get_window_extent()
    upright = label.get_rotation() != 0
    label.set_text(
        _wrapped(label.get_text(), *((size.height, figure.height) if upright else (size.width, figure.width)))
    )
    for axis in axes:
        axis.set_label_text("")


def _share(axes: np.ndarray, v: xr.DataArray, log: bool) -> None:
    """What panels of curves say together: the label of their values, and a legend above them."""
    figure = axes[0].figure
    with mpl.rc_context(style.settings()):
        for ax in axes:
            if log:
                ax.set_yscale("log", nonpositive="mask")
            name_values(ax.yaxis, v, log)
        _shared_label(figure.supylabel, [ax.yaxis for ax in axes])
        handles = axes[0].get_legend_handles_labels()[0]
        if handles:
            _in_columns(
                lambda n: figure.legend(handles=handles, loc="outside upper center", ncols=n),
                len(handles),
                figure.bbox.width,
            )
