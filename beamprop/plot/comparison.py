"""The picture of a comparison: the two fields and their difference, and how far they part along z."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import maps, style, units
from .quantities import drawn

#: From this width on pictures of curves stand side by side; below it one above another [mm].
BROAD = 130.0
#: From this height over width on maps stand side by side in a narrow figure, too.
STEEP = 0.7
#: Height of a picture of curves, and what ticks, labels and the colour bar add to the height of a map, and to its width [mm].
CURVES, ABOVE, BESIDE = 42.0, 17.0, 6.0
#: Heights of a map, and of one of three above one another, which fit on a page [mm].
HEIGHTS, STACKED = (25.0, 90.0), (20.0, 34.0)


def comparison(cmp_ds: xr.Dataset, axes: Any = None, *, ax: Any = None, width: float = style.PAGE) -> Any:
    """Draw a comparison: |a|, |b| and |a - b| as maps, and by depth the relative L2 error and the widths' difference.

    A plane at one z is the three maps alone; of a volume the maps are those at the y of its largest |a|.

    Parameters
    ----------
    cmp_ds : Dataset
        From `beamprop.compare`, at one frequency and angle.
    axes, ax : Axes or sequence of Axes, optional
        One Axes gets the error by depth, two get the error and the widths' difference, five the three maps before
        them. By default a new figure, with maps if the dataset has the fields at more than one depth.
    width : float, mm
        Of a new figure: 180, or 88, with the curves, and maps that are flat, one above another.

    Returns
    -------
    Axes, or array of Axes
        Those that were drawn in.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> x, z = np.linspace(-0.4, 0.4, 81), np.linspace(0, slab.thickness, 21)
    >>> one, two = (bp.field(s, beam, 2500.0, x, z) for s in (slab, bp.lmmd_emt_slab(slab, interface=False)))
    >>> axes = bp.plot.comparison(bp.compare(one, two))
    """
    ds = _checked(cmp_ds)
    fields = [n for n in ("p_a", "p_b", "error") if n in ds]
    upright, level = _axes_of(ds)
    with_maps = len(fields) == 3 and ds.sizes[level] > 1 and ds.sizes[upright] > 1
    alone = with_maps and level != "z"
    given = ax if axes is None else axes
    places = np.atleast_1d(
        np.asarray(_figure(ds, with_maps, width, alone) if given is None else given, dtype=object)
    ).ravel()
    if places.size not in ((3,) if alone else (1, 2, 5)) or (places.size == 5 and not with_maps):
        counts = "3" if alone else "1, 2 or (for a dataset with fields) 5"
        raise ValueError(f"axes: expected {counts} Axes, got {places.size}")
    with style.styled(places[0].get_figure(root=True)):
        if places.size >= 3:
            _maps(ds, list(places[:3]))
        if alone:
            return places
        _errors(ds, places[0] if places.size == 1 else places[-2])
        if places.size > 1:
            _widths(ds, places[-1])
    return places[0] if places.size == 1 else places


def _checked(ds: Any) -> xr.Dataset:
    if not isinstance(ds, xr.Dataset) or not {"relative_l2_by_z", "fwhm_difference"} <= set(ds.data_vars):
        got = ", ".join(map(str, ds.data_vars)) if isinstance(ds, xr.Dataset) else type(ds).__name__
        raise ValueError(f"cmp_ds: expected a dataset from compare, got {got}")
    ds = ds.squeeze([d for d in ds.dims if d not in ("z", "x") and ds.sizes[d] == 1])
    if "p_a" in ds and ds.p_a.ndim == 3 and ds.sizes["z"] > 1 and {"x", "y"} <= set(ds.p_a.dims):
        held = "y" if ds.sizes["x"] > 1 else "x"
        peak = abs(ds.p_a).fillna(0).argmax([held, "z", *({"x", "y"} - {held})])
        ds = ds.isel({held: peak[held]})
    extra = [str(d) for d in ds.relative_l2_by_z.dims if d != "z"]
    if extra:
        raise ValueError(f"cmp_ds: expected one field, got several along {', '.join(extra)}: select one with isel")
    return ds


def _axes_of(ds: xr.Dataset) -> tuple[str, str]:
    """The upright and the level axis of its maps."""
    dims = set(map(str, ds.p_a.dims)) if "p_a" in ds else {"x", "z"}
    if "y" in dims and ("z" not in dims or ds.sizes["z"] == 1):
        return "y", "x"
    return ("y" if "x" not in dims else "x"), "z"


def _figure(ds: xr.Dataset, with_maps: bool, width: float, alone: bool = False) -> Sequence[Any]:
    """Axes of a new figure: maps above, curves below, or maps alone."""
    below = 0 if alone else 1 if width >= BROAD else 2
    beside = 3 if with_maps and (width >= BROAD or (_proportion(ds) >= STEEP and not alone)) else 1
    rows = [CURVES] * below
    if with_maps:
        each = (width - 12.0) / beside - BESIDE
        rows = [ABOVE + float(np.clip(_proportion(ds) * each, *(STACKED if beside == 1 else HEIGHTS)))] * (
            3 // beside
        ) + rows
    figure = style.new_figure(width, sum(rows) + 8.0 * alone)  # of maps alone the outermost labels have no curves' room
    with style.styled(figure):
        grid = figure.add_gridspec(len(rows), 6, height_ratios=rows)
        wide, half = 6 // beside, 3 * below
        places = [grid[k // beside, wide * (k % beside) : wide * (k % beside) + wide] for k in range(3 * with_maps)]
        places += [
            grid[len(rows) - below + k * (below - 1), half * k * (2 - below) : half * k * (2 - below) + half]
            for k in range(2 * (below > 0))
        ]
        return [figure.add_subplot(place) for place in places]


def _proportion(ds: xr.Dataset) -> float:
    """Height over width of a map in true proportion."""
    upright, level = _axes_of(ds)
    return float(np.ptp(ds[upright].values) / np.ptp(ds[level].values))


def _maps(ds: xr.Dataset, axes: Sequence[Any]) -> None:
    """|a| and |b| on one scale, |a - b| on its own; in true proportion unless that makes stripes of them."""
    if _axes_of(ds)[1] != "z":
        ds = ds.squeeze("z")
    first = drawn((ds.p_a.transpose(*_axes_of(ds)),), "abs")
    aspect = "equal" if 0.4 < _proportion(ds) < 2.5 else "auto"
    for ax, name, title in zip(axes, ("p_a", "p_b", "error"), ("|a|", "|b|", "|a − b|"), strict=True):
        p = ds[name].transpose(*_axes_of(ds))
        shown = drawn((p,), "abs", first.high)._replace(name=title)
        if name == "error":
            shown = shown._replace(high=shown.most or 1.0)
        mesh = maps.mesh_of(ax, p, shown)
        ax.set_aspect(aspect)
        maps.add_colorbar(ax, mesh, shown, above=True)
    if axes[0].get_subplotspec() is not None and axes[0].get_subplotspec().rowspan == axes[1].get_subplotspec().rowspan:
        for ax in axes[1:]:
            ax.tick_params(labelleft=False)
            ax.set_ylabel("")
    else:
        for ax in axes[:2]:
            ax.set_xlabel("")


def _errors(ds: xr.Dataset, ax: Any) -> None:
    """Relative L2 error by depth, with the overall one; on a logarithmic scale where it spans more than a decade."""
    values = np.where(ds.relative_l2_by_z > 0, ds.relative_l2_by_z, np.nan)
    _curve(ax, ds.z.values, values, "C0")
    overall = float(np.nan_to_num(ds.relative_l2)) if "relative_l2" in ds else 0.0
    if overall > 0:
        ax.axhline(overall, color="C1", ls="--", label=f"overall {overall:.2g}")
        ax.legend()
    if np.nanmax(values, initial=0.0) > 10 * np.nanmin(values, initial=np.inf):
        ax.set_yscale("log")
    else:
        ax.set_ylim(0, 1.1 * max(np.nanmax(values, initial=0.0), overall) or 1.0)
        ax.ticklabel_format(axis="y", scilimits=(-2, 3), useMathText=True)
    ax.set_ylabel("relative L2 error")
    units.name_axis(ax.xaxis, "z", ds.z.values, "m")
    ax.grid(True)


def _widths(ds: xr.Dataset, ax: Any) -> None:
    """Difference of the widths by depth, along x or of planes along each axis, in a unit that its size suits."""
    lines = {"": ds.fwhm_difference}
    if "axis" in ds.fwhm_difference.dims:
        lines = {str(axis): ds.fwhm_difference.sel(axis=axis) for axis in ds.axis.values}
    values = np.asarray(ds.fwhm_difference.values, float)
    largest = float(np.nanmax(np.abs(values), initial=0.0)) if np.any(np.isfinite(values)) else 0.0
    factor, unit = next(((f, u) for f, u in ((1, "m"), (1e3, "mm")) if largest * f >= 1), (1e6, "µm"))
    for i, (axis, line) in enumerate(lines.items()):
        _curve(ax, ds.z.values, np.asarray(line.values, float) * factor, f"C{i}", f"along {axis}" if axis else None)
    if len(lines) > 1:
        ax.legend()
    ax.axhline(0, color="0.5", lw=0.8)
    ax.set_ylabel(f"width of b less a [{unit}]")
    units.name_axis(ax.xaxis, "z", ds.z.values, "m")
    ax.grid(True)
    if not np.any(np.isfinite(values)):
        ax.text(0.5, 0.5, "half level not reached", transform=ax.transAxes, ha="center", va="center", color="0.4")


def _curve(ax: Any, z: np.ndarray, values: np.ndarray, color: str, label: str | None = None) -> None:
    ax.plot(z, values, color=color, label=label, marker="o" if z.size < 12 else "")
    if np.ptp(z) > 0:  # where there are no widths, too
        ax.set_xlim(z.min(), z.max())
