"""Pictures of plane waves: reflection and transmission, Bloch waves, guided modes."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr

from .. import validate
from . import labels, panels, spread, style

LATERAL = ("kx_over_k0", "kx", "angle")
#: What guided modes are drawn by.
KINDS = ("kx_over_k0", "direction")
#: So near the edge of the first zone a Bloch wave is at the edge.
EDGE = 1e-6


def scattering(
    ds: xr.Dataset,
    quantity: str = "transmissivity",
    log: bool = False,
    ax: Any = None,
    label: str | None = None,
    along: str | None = None,
    width: float = style.COLUMN,
) -> Any:
    """A plane-wave quantity against kx, kx/k0, angle or frequency: up to eight curves, or a map over two axes.

    The map over kx and frequency is the dispersion diagram: guided and leaky waves are its ridges, and a dotted line marks the waves
    that graze the slab, \\|kx\\| = k0.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.scattering`, or a `beamprop.sweep` of it: more axes make panels.
    quantity : str
        transmissivity, reflectivity, energy_transmission or absorption.
    log : bool
        A logarithmic scale; that of colours spans twelve decades at most.
    ax : Axes, optional
    label : str, optional
        Before the names of the curves.
    along : str, optional
        The dimension that is the horizontal axis: by default kx, kx/k0 or angle, unless it has eight values or fewer and another more.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes, or array of Axes
        The latter of panels.

    Raises
    ------
    ValueError
        Also for more than eight panels, and for panels in a given `ax`.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> ds = bp.scattering(slab, 2500.0, kx_over_k0=np.linspace(0, 5, 101))
    >>> ax = bp.plot.scattering(ds, log=True)
    >>> many = bp.scattering(slab, np.linspace(2000, 3000, 21), kx_over_k0=np.linspace(0, 5, 101))
    >>> ax = bp.plot.scattering(many, log=True, width=180)
    """
    validate.word(quantity, "quantity", "transmissivity", "reflectivity", "energy_transmission", "absorption")
    labels.need(ds, quantity)
    validate.flag(log, "log")
    labels.text_or_none(label, "label")
    v = ds[quantity].squeeze(drop=True)
    chosen = spread.axis_along(v, along, *LATERAL, "frequency")
    axes = panels.draw(v, chosen, (ax, width), log, label)
    if spread.plan(v, chosen).is_map:
        for each in np.atleast_1d(axes):
            _mark_grazing(v, each, chosen)
    return panels.tell_where(axes, ds[quantity])


def _mark_grazing(v: xr.DataArray, ax: Any, along: str) -> None:
    """A dotted line where the waves of a map are at grazing incidence."""
    across = next((str(d) for d in v.dims if d in (*LATERAL, "frequency") and d != along), None)
    if "kx_over_k0" not in v.coords or across is None or not {"kx_over_k0", "kx"} & {along, across}:
        return
    ratio = v.kx_over_k0.broadcast_like(v[along] * v[across]).transpose(across, along)
    ax.contour(v[along], v[across], np.abs(ratio), levels=[1.0], colors="0.7", linestyles=":", linewidths=0.8)


def bloch(
    ds: xr.Dataset,
    ax: Any = None,
    label: str | None = None,
    imaginary: bool = True,
    mirror: bool = False,
    along: str | None = None,
    width: float = style.COLUMN,
) -> Any:
    """Bloch waves: equifrequency contours, kz/k0 against kx, or bands, kz d/pi of a cell of thickness d against frequency.

    The imaginary part is dotted. More than eight curves are maps of \\|Re kz d/pi\\|, which -kz has too, and of Im kz d/pi. Bands are in
    the first zone, with a gap where they leave it at an edge and come back at the opposite one.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.bloch`.
    ax : Axes, optional
    label : str, optional
        Before the names of the curves.
    imaginary : bool
        Draw the decay too; False where a map is drawn in a given `ax`, which has the real part alone.
    mirror : bool
        Draw -kz too, which belongs to the contour; of curves alone.
    along : str, optional
        The dimension that is the horizontal axis: by default kx or kx/k0, unless it has eight values or fewer and frequency more.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes, or array of Axes
        The latter of panels, and of maps with the imaginary part.

    Raises
    ------
    ValueError
        Also for panels in a given `ax`.

    Examples
    --------
    >>> ds = bp.bloch(bp.lmmd_cell(), 2500.0, kx_over_k0=np.linspace(-10, 10, 101))
    >>> ax = bp.plot.bloch(ds, mirror=True)
    >>> bands = bp.bloch(bp.Cell((bp.Layer(bp.AIR, 0.05), bp.Layer(bp.material("water"), 0.05))), np.linspace(10, 5000, 500), kx=0)
    >>> ax = bp.plot.bloch(bands)
    """
    labels.need(ds, "kz_over_k0")
    for name, value in (("imaginary", imaginary), ("mirror", mirror)):
        validate.flag(value, name)
    labels.text_or_none(label, "label")
    v = ds["kz_over_k0"].squeeze(drop=True).assign_attrs(units="1", long_name="$k_z/k_0$")
    chosen = spread.axis_along(v, along, *LATERAL, "frequency")
    plan = spread.plan(v, chosen)
    bands = plan.is_map or chosen == "frequency"
    v = spread.in_order(_bands(ds) if bands else v)
    if plan.is_map:
        return panels.tell_where(_bloch_maps(v, chosen, plan.panels, (ax, width), imaginary), ds)

    def contours(part: xr.DataArray, axes: Any) -> None:
        _contours(part, chosen, axes, label, bands, (imaginary, mirror))

    v.attrs["long_name"] += " (dotted: imaginary part)" if imaginary else ""
    return panels.tell_where(panels.draw_curves(v, chosen, plan.panels, (ax, width), contours), ds)


def _bands(ds: xr.Dataset) -> xr.DataArray:
    """kz d/pi in the first zone, -1 to 1, its upper edge for waves that decay at an edge; kz where cells of points differ in d."""
    from ..io.datasets import provenance

    labels.need(ds, "kz")
    kz = ds["kz"].squeeze(drop=True)
    cell = provenance(ds).get("cell")
    if cell is None:
        return kz.assign_attrs(units="rad/m", long_name="$k_z$")
    kz = kz * (cell.thickness / np.pi)
    return (kz - 2 * np.ceil((kz.real - 1 - EDGE) / 2)).assign_attrs(units="1", long_name=r"$k_z d/\pi$")


def _contours(v: xr.DataArray, along: str, ax: Any, label: str | None, bands: bool, shown: tuple[bool, bool]) -> None:
    """Curves of the real part, and if they are `shown`, dotted ones of the imaginary part and, in the real one's style, those of -kz."""
    start = len(ax.lines)
    panels.curves(v.real, along, ax, label)
    for line, (_, kz) in zip(ax.lines[start:], spread.each(v, along), strict=True):
        x, y = _unjoined(v[along].values, kz.real) if bands else (v[along].values, kz.real)
        line.set_data(x, y)
        same: dict[str, Any] = {"color": line.get_color(), "marker": line.get_marker()}
        if shown[0]:
            ax.plot(v[along].values, kz.imag, ls=":" if line.get_linestyle() == "-" else (0, (1, 4)), **same)
        if shown[1]:
            ax.plot(x, -y, ls=line.get_linestyle(), **same)


def _unjoined(x: np.ndarray, kz: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bands, with a gap where they leave the first zone at an edge and come back at the opposite one, which no line should join."""
    jumps = np.flatnonzero(np.abs(np.diff(kz)) > 1) + 1
    return np.insert(x, jumps, np.nan), np.insert(kz, jumps, np.nan)


def _bloch_maps(v: xr.DataArray, along: str, dim: str | None, where: panels.Where, imaginary: bool) -> Any:
    """A map of abs(Re kz), which -kz has too, and one of Im kz beside or, in a column, below it."""
    name = v.attrs["long_name"]
    parts = [abs(v.real).assign_attrs(v.attrs | {"long_name": f"|Re {name}|"})]
    if imaginary:
        parts.append(v.imag.assign_attrs(v.attrs | {"long_name": f"Im {name}"}))
    if not imaginary:
        return panels.draw(parts[0], along, where)
    if dim is not None or where[0] is not None:
        got = "Axes" if dim is None else f"several values of {dim}"
        raise ValueError(f"imaginary: expected False for maps in given Axes or of three axes, got True and {got}")
    wide = where[1] >= panels.NARROW
    figure = style.new_figure(where[1], (0.4 if wide else 1.2) * where[1])
    with mpl.rc_context(style.settings()):
        axes = figure.subplots(*((1, 2) if wide else (2, 1)), sharex=True, sharey=True)
    for ax, part in zip(axes, parts, strict=True):
        panels.draw(part, along, (ax, where[1]))
        ax.label_outer()
    return axes


def modes(ds: xr.Dataset, ax: Any = None, label: str | None = None, width: float = style.COLUMN) -> Any:
    """Guided modes: kx/k0 in the complex plane at one frequency, Re kx/k0 against frequency at several.

    Filled circles are forward modes, whose energy flows along their phase, open ones backward modes; lines join the branches that
    `beamprop.guided_modes` follows along frequency.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.guided_modes`.
    ax : Axes, optional
    label : str, optional
        Before the names of the two kinds.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes

    Examples
    --------
    >>> ds = bp.guided_modes(bp.Slab(bp.lmmd_cell(0.05, 0), periods=20), 2500.0)
    >>> ax = bp.plot.modes(ds)
    """
    labels.need(ds, "kx_over_k0", "direction")
    labels.text_or_none(label, "label")
    k, direction = (ds[name].squeeze([d for d in ds[name].dims if d != "mode" and ds.sizes[d] == 1]) for name in KINDS)
    if set(k.dims) - {"frequency", "mode"}:
        raise ValueError(
            f"ds: expected modes along frequency alone, got {', '.join(map(str, k.dims))}: select with isel"
        )
    several = "frequency" in k.dims
    x, y = (ds["frequency"].broadcast_like(k).values, k.real.values) if several else (k.real.values, k.imag.values)
    with style.drawing(ax, width) as axes:
        for sign, kind, filled in ((1, "forward", "full"), (-1, "backward", "none")):
            here = direction.values == sign
            text = f"{label}: {kind}" if label else kind
            axes.plot(x[here], y[here], ls="", marker="o", fillstyle=filled, label=text if here.any() else None)
        if several and "branch" in ds:
            _join_branches(axes, x, y, ds["branch"].transpose(*k.dims, ...).values.reshape(k.shape))
        if not np.any(direction):
            axes.text(0.5, 0.6, "no guided mode", transform=axes.transAxes, ha="center", color="0.4")
        if several:
            panels.name_axis(axes.xaxis, k, "frequency")
            axes.set_ylabel("Re $k_x/k_0$")
        else:
            _complex_plane(axes, y)
        panels.finish(axes, ax is None)
    return panels.tell_where(axes, ds.drop_vars("mode", errors="ignore"))


def _join_branches(ax: Any, x: np.ndarray, y: np.ndarray, branch: np.ndarray) -> None:
    """A thin line through the modes of each branch, by growing x."""
    for number in range(int(branch.max(initial=-1)) + 1):
        here = branch == number
        order = np.argsort(x[here])
        ax.plot(x[here][order], y[here][order], color="0.6", lw=0.8, ls="-", zorder=1)


def _complex_plane(ax: Any, y: np.ndarray) -> None:
    """Axes of the complex plane, in which what rounding leaves of an imaginary part is none."""
    end = max(1.2 * float(np.nanmax(np.abs(y), initial=0.0)), 0.01)
    ax.set(xlabel="Re $k_x/k_0$", ylabel="Im $k_x/k_0$", ylim=(-end, end))
    ax.axhline(0, color="0.6", lw=0.5, zorder=0)
