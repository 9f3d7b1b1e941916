"""Pictures of widths and of sweeps over any parameters."""

from __future__ import annotations

import warnings
from typing import Any

import xarray as xr

from .. import validate
from . import labels, panels, spread, style, units

#: Variables of `beam_width` in a picture: name, words, line style, share of the usual line width.
WIDTHS = {
    "fwhm_in": ("incident, near face", ":", 1.0),
    "fwhm_out": ("behind the slab", "-", 1.5),
    "fwhm_air": ("without the slab", "--", 1.0),
}
#: Widths smaller than this are ticked in mm [cm].
SMALL = 1.0


def width(
    ds: xr.Dataset, ax: Any = None, label: str | None = None, along: str | None = None, width: float = style.COLUMN
) -> Any:
    """Widths against frequency, angle or any swept axis: at the near face, behind the slab, and after the distance without it.

    Up to eight curves share one Axes, two values of a second axis; up to eight values have a panel each; the widths behind the slab at
    more are a map.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.beam_width`, or a `beamprop.sweep` of it.
    ax : Axes, optional
    label : str, optional
        Before the names of the curves.
    along : str, optional
        The dimension that is the horizontal axis: by default frequency, unless it has eight values or fewer and another more.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes, or array of Axes
        The latter of panels. Curves are in cm.

    Raises
    ------
    ValueError
        Also for panels in a given `ax`.

    Examples
    --------
    >>> ds = bp.beam_width(bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096), [2000, 2500, 3000])
    >>> ax = bp.plot.width(ds)
    """
    labels.need(ds, *WIDTHS)
    labels.text_or_none(label, "label")
    behind = ds["fwhm_out"].squeeze(drop=True).assign_attrs(units="m", long_name="full width behind the slab")
    chosen = spread.axis_along(behind, along, "frequency", "angle")
    plan = spread.plan(behind, chosen, spread.MOST // len(WIDTHS))
    if plan.is_map:
        return panels.tell_where(panels.draw(behind, chosen, (ax, width)), ds["fwhm_out"])
    kinds = [ds[name].squeeze(drop=True) * 100 for name in WIDTHS]
    v = spread.in_order(xr.concat(kinds, xr.Variable("kind", list(WIDTHS)), join="exact", combine_attrs="drop"))
    small = float(v.max()) < SMALL
    v.attrs = {"units": "mm" if small else "cm", "long_name": "full width at half maximum"}

    def curves(part: xr.DataArray, axes: Any) -> None:
        _widths(part, chosen, axes, label, 10.0 if small else 1.0)

    return panels.tell_where(panels.draw_curves(v, chosen, plan.panels, (ax, width), curves), ds["fwhm_out"])


def _widths(v: xr.DataArray, along: str, ax: Any, label: str | None, factor: float) -> None:
    """The widths of each kind in a line style, of each point of another axis in a colour; ticks are those of cm times the factor."""
    x = v[along].values
    marker = "o" if x.size < panels.POINTS else ""
    colours: dict[str, Any] = {}
    ax.update_datalim([(x[0], 0.0)])
    for name, (text, dashes, thick) in WIDTHS.items():
        for words, y in spread.each(v.sel(kind=name, drop=True), along):
            said = ", ".join(filter(None, (f"{label}: {text}" if label else text, words)))
            (line,) = ax.plot(x, y, label=said, marker=marker, **colours.get(words, {}))
            colours.setdefault(words, {"color": line.get_color(), "ls": "-"})
            line.set(linestyle=dashes, linewidth=thick * line.get_linewidth())
            line.sticky_edges.y.append(0.0)  # the axis begins at 0, also when more curves are drawn later
    if factor != 1.0:
        ax.yaxis.set_major_formatter(lambda value, _: units.number(value * factor))


def sweep(
    ds: xr.Dataset,
    quantity: str | None = None,
    log: bool = False,
    ax: Any = None,
    along: str | None = None,
    band: str | None = None,
    percentiles: tuple[float, float] = (5.0, 95.0),
    width: float = style.COLUMN,
) -> Any:
    """A quantity of any dataset on axes of any number: up to eight curves, or a map over two axes, or up to eight panels of either.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.sweep`, or any question.
    quantity : str, optional
        The first variable; of complex ones the magnitude is drawn.
    log : bool
        On a logarithmic scale.
    ax : Axes, optional
    along : str, optional
        The dimension that is the horizontal axis, by default the longest.
    band : str, optional
        The dimension of random copies, such as those of `beamprop.tolerance`: the median over it is a curve, and the range between
        the percentiles a band.
    percentiles : (float, float)
        Of the band, from 0 to 100.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes, or array of Axes
        The latter of panels.

    Warns
    -----
    UserWarning
        Copies are nan, and left out of a band.

    Raises
    ------
    ValueError
        Also for more than eight panels, and for panels in a given `ax`.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> ds = bp.sweep(lambda angle: bp.scattering(slab, 2500.0, angle=angle), {"angle": [0.0, 30.0, 60.0]}, workers=1)
    >>> ax = bp.plot.sweep(ds, "transmissivity")
    >>> def copy(sample, angle):
    ...     return bp.scattering(bp.tolerance(slab, thickness=0.02, count=9, seed=1)[sample], 2500.0, angle=angle)
    >>> ds = bp.sweep(copy, {"sample": np.arange(9), "angle": [0.0, 30.0, 60.0]}, workers=1)
    >>> ax = bp.plot.sweep(ds, "transmissivity", band="sample")
    """
    labels.need(ds)
    name = labels.text_or_none(quantity, "quantity") or str(next(iter(ds.data_vars), "a variable"))
    labels.need(ds, name)
    validate.flag(log, "log")
    v = ds[name].squeeze(drop=True)
    if v.dtype.kind == "c":
        v = abs(v).assign_attrs(v.attrs | {"long_name": f"magnitude of {v.attrs.get('long_name', name)}"})
    if not spread.is_number(v):
        raise validate.refuse("quantity", "a variable of numbers", name)
    if band is None:
        axes = panels.draw(v, spread.axis_along(v, along), (ax, width), log)
    else:
        axes = _band(v, along, band, percentiles, log, (ax, width))
    return panels.tell_where(axes, ds[name])


def _band(
    v: xr.DataArray, along: str | None, band: str, percentiles: tuple[float, float], log: bool, where: tuple[Any, float]
) -> Any:
    """Medians, and the ranges between two percentiles, along a dimension."""
    if labels.text_or_none(band, "band") not in v.dims:
        raise validate.refuse("band", " or ".join(map(str, v.dims)) or "none, for there is one value", band)
    low, high = _pair(percentiles)
    chosen = spread.axis_along(v.isel({band: 0}, drop=True), along)
    unknown = int(v.isnull().sum())
    if unknown:
        warnings.warn(f"{unknown} of {v.size} values are nan, and left out of the band over {band}", stacklevel=3)
    with warnings.catch_warnings():  # where all copies are nan the band has a gap
        warnings.filterwarnings("ignore", "All-NaN", RuntimeWarning)
        shares = spread.in_order(v.quantile([low / 100, 0.5, high / 100], band, keep_attrs=True))
    plan = spread.plan(shares.isel(quantile=1, drop=True), chosen)
    if plan.is_map:
        raise ValueError(f"band: expected at most {spread.MOST} bands in a picture, got more: select with ds.isel")

    def bands(part: xr.DataArray, axes: Any) -> None:
        start = len(axes.lines)
        lower, middle, upper = (part.isel(quantile=i, drop=True) for i in range(3))
        panels.curves(middle, chosen, axes, None if middle.ndim > 1 else "median")
        text: str | None = f"{units.number(low)}th to {units.number(high)}th percentile"
        for line, (_, y0), (_, y1) in zip(
            axes.lines[start:], spread.each(lower, chosen), spread.each(upper, chosen), strict=True
        ):
            axes.fill_between(part[chosen].values, y0, y1, color=line.get_color(), alpha=0.2, lw=0, label=text)
            text = None

    return panels.draw_curves(shares, chosen, plan.panels, where, bands, log)


def _pair(percentiles: Any) -> tuple[float, float]:
    expected = "two growing numbers from 0 to 100"
    if not isinstance(percentiles, tuple | list) or len(percentiles) != 2:
        raise validate.refuse("percentiles", expected, percentiles)
    low, high = (validate.as_number(p, "percentiles") for p in percentiles)
    if not 0 <= low < high <= 100:
        raise validate.refuse("percentiles", expected, percentiles)
    return low, high
