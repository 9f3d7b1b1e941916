"""The picture of a comparison: the two fields and their difference, and how far they part along z."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from . import units

_WIDTH = 7.1  # inches, two columns of a journal


def comparison(cmp_ds: xr.Dataset, axes: Any = None) -> Any:
    """Draw a comparison: |a|, |b| and |a - b| as maps, and by depth the relative L2 error and the widths' difference.

    Parameters
    ----------
    cmp_ds : Dataset
        From `beamprop.compare`, at one frequency and angle.
    axes : Axes or sequence of Axes, optional
        One Axes gets the error by depth, two get the error and the widths' difference, five the three maps before
        them. By default a new figure, with maps if the dataset has the fields at more than one depth.

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
    maps = len(fields) == 3 and ds.sizes["z"] > 1 and ds.sizes["x"] > 1
    if axes is None:
        axes = _figure(ds, maps)
    drawn = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if drawn.size not in (1, 2, 5) or (drawn.size == 5 and not maps):
        raise ValueError(f"axes: expected 1, 2 or (for a dataset with fields) 5 Axes, got {drawn.size}")
    if drawn.size == 5:
        _maps(ds, list(drawn[:3]))
    _errors(ds, drawn[0] if drawn.size == 1 else drawn[-2])
    if drawn.size > 1:
        _widths(ds, drawn[-1])
    return drawn[0] if drawn.size == 1 else drawn


def _checked(ds: Any) -> xr.Dataset:
    if not isinstance(ds, xr.Dataset) or not {"relative_l2_by_z", "fwhm_difference"} <= set(ds.data_vars):
        got = ", ".join(map(str, ds.data_vars)) if isinstance(ds, xr.Dataset) else type(ds).__name__
        raise ValueError(f"cmp_ds: expected a dataset from compare, got {got}")
    ds = ds.squeeze([d for d in ds.dims if d not in ("z", "x") and ds.sizes[d] == 1])
    extra = [str(d) for d in ds.relative_l2_by_z.dims if d != "z"]
    if extra:
        raise ValueError(f"cmp_ds: expected one field, got several along {', '.join(extra)}: select one with isel")
    return ds


def _figure(ds: xr.Dataset, maps: bool) -> Sequence[Any]:
    """Axes of a new figure: maps above, curves below."""
    import matplotlib.pyplot as plt

    if not maps:
        return plt.subplots(1, 2, figsize=(_WIDTH, 2.6), layout="constrained")[1]
    height = float(np.clip(_proportion(ds) * _WIDTH / 4, 1.3, 3.6))
    figure = plt.figure(figsize=(_WIDTH, height + 3.2), layout="constrained")
    grid = figure.add_gridspec(2, 6, height_ratios=[height + 0.6, 2.2])
    first = figure.add_subplot(grid[0, :2])
    further = [figure.add_subplot(grid[0, k : k + 2], sharex=first, sharey=first) for k in (2, 4)]
    return [first, *further, figure.add_subplot(grid[1, :3]), figure.add_subplot(grid[1, 3:])]


def _proportion(ds: xr.Dataset) -> float:
    """Height over width of a map in true proportion."""
    return float(np.ptp(ds.x.values) / np.ptp(ds.z.values))


def _maps(ds: xr.Dataset, axes: Sequence[Any]) -> None:
    """|a| and |b| on one scale, |a - b| on its own; in true proportion unless that makes stripes of them."""
    unit = ds.p_a.attrs.get("units", "")
    sizes = [np.abs(ds[n].transpose("x", "z").values) for n in ("p_a", "p_b", "error")]
    top = float(np.nanpercentile(sizes[0], 99.8)) or 1.0
    limits = (top, top, float(np.nanmax(sizes[2])) or 1.0)
    aspect = "equal" if 0.4 < _proportion(ds) < 2.5 else "auto"
    for ax, size, limit, title in zip(axes, sizes, limits, ("|a|", "|b|", "|a − b|"), strict=True):
        factor, scaled = _scaled_unit(limit, unit)
        mesh = ax.pcolormesh(
            ds.z.values,
            ds.x.values,
            size * factor,
            shading="nearest",
            cmap="inferno",
            vmin=0,
            vmax=limit * factor,
            rasterized=True,
        )
        ax.set_aspect(aspect)
        units.name_axis(ax.xaxis, "z", ds.z.values, "m")
        bar = ax.figure.colorbar(mesh, cax=ax.inset_axes([0, 1.04, 1, 0.05]), orientation="horizontal")
        bar.ax.xaxis.set_ticks_position("top")
        bar.ax.xaxis.set_label_position("top")
        bar.ax.locator_params(nbins=4)
        bar.set_label(f"{title} [{scaled}]")
    units.name_axis(axes[0].yaxis, "x", ds.x.values, "m")
    for ax in axes[1:]:
        ax.tick_params(labelleft=False)


def _scaled_unit(limit: float, unit: str) -> tuple[float, str]:
    """Factor and unit, with a power of ten where numbers up to the limit are small or large."""
    power = int(np.floor(np.log10(limit)))
    return (1.0, unit) if -2 < power < 3 else (10.0**-power, rf"$10^{{{power}}}$ {unit}")


def _errors(ds: xr.Dataset, ax: Any) -> None:
    """Relative L2 error by depth, with the overall one; on a logarithmic scale where it spans more than a decade."""
    values = np.where(ds.relative_l2_by_z > 0, ds.relative_l2_by_z, np.nan)
    _curve(ax, ds.z.values, values, "C0")
    overall = float(np.nan_to_num(ds.relative_l2)) if "relative_l2" in ds else 0.0
    if overall > 0:
        ax.axhline(overall, color="C1", ls="--", lw=1, label=f"overall {overall:.2g}")
        ax.legend(frameon=False, fontsize="small")
    if np.nanmax(values, initial=0.0) > 10 * np.nanmin(values, initial=np.inf):
        ax.set_yscale("log")
    else:
        ax.set_ylim(0, 1.1 * max(np.nanmax(values, initial=0.0), overall) or 1.0)
        ax.ticklabel_format(axis="y", scilimits=(-2, 3), useMathText=True)
    ax.set_ylabel("relative L2 error")
    units.name_axis(ax.xaxis, "z", ds.z.values, "m")
    ax.grid(True, color="0.9", lw=0.5)


def _widths(ds: xr.Dataset, ax: Any) -> None:
    """Difference of the widths by depth, in a unit that its size suits."""
    values = np.asarray(ds.fwhm_difference.values, float)
    largest = float(np.nanmax(np.abs(values), initial=0.0)) if np.any(np.isfinite(values)) else 0.0
    factor, unit = next(((f, u) for f, u in ((1, "m"), (1e3, "mm")) if largest * f >= 1), (1e6, "µm"))
    _curve(ax, ds.z.values, values * factor, "C0")
    ax.axhline(0, color="0.5", lw=0.8)
    ax.set_ylabel(f"width of b less a [{unit}]")
    units.name_axis(ax.xaxis, "z", ds.z.values, "m")
    ax.grid(True, color="0.9", lw=0.5)
    if not np.any(np.isfinite(values)):
        ax.text(0.5, 0.5, "half level not reached", transform=ax.transAxes, ha="center", va="center", color="0.4")


def _curve(ax: Any, z: np.ndarray, values: np.ndarray, color: str) -> None:
    ax.plot(z, values, color=color, lw=1.2, marker="o" if z.size < 12 else "", ms=4)
