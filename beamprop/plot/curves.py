"""Curves: plane-wave quantities, equifrequency contours, widths, sweeps."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from . import style
from .labels import need, title_of


def _axes(ax: Any) -> Any:
    with style.drawing(ax, style.COLUMN) as axes:
        return axes


def _lateral(ds: xr.Dataset) -> str:
    for name in ("kx_over_k0", "angle", "kx"):
        if name in ds.dims:
            return name
    raise ValueError(f"ds: expected a dimension kx, kx_over_k0 or angle, got {', '.join(map(str, ds.dims)) or 'none'}")


def _lines(ds: xr.Dataset, y: xr.DataArray, along: str, ax: Any, label: str | None) -> None:
    """One curve per entry of the dimensions across."""
    across = [d for d in y.dims if d != along]
    if not across:
        ax.plot(ds[along], y, label=label)
        return
    for i, row in enumerate(y.transpose(*across, along).values.reshape(-1, y.sizes[along])):
        values = np.unravel_index(i, [y.sizes[d] for d in across])
        text = ", ".join(
            f"{d} {ds[d].values[j]:g} {ds[d].attrs.get('units', '')}" for d, j in zip(across, values, strict=True)
        )
        ax.plot(ds[along], row, label=text if label is None else f"{label}, {text}")


def scattering(
    ds: xr.Dataset, quantity: str = "transmissivity", log: bool = False, ax: Any = None, label: str | None = None
) -> Any:
    """Curves of a plane-wave quantity against kx, kx/k0, angle or frequency, on a linear or logarithmic scale.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.scattering`.
    quantity : str
        transmissivity, reflectivity, energy_transmission or absorption.
    log : bool
    ax : Axes, optional
    label : str, optional

    Examples
    --------
    >>> ds = bp.scattering(bp.Slab(bp.lmmd_cell(), periods=20), 2500.0, kx_over_k0=np.linspace(0, 5, 101))
    >>> ax = bp.plot.scattering(ds, log=True)
    """
    validate.word(quantity, "quantity", "transmissivity", "reflectivity", "energy_transmission", "absorption")
    need(ds, quantity)
    validate.flag(log, "log")
    along = "frequency" if ds[quantity].dims == ("frequency",) else _lateral(ds)
    ax = _axes(ax)
    y = ds[quantity]
    if log:
        ax.set_yscale("log")
        y = y.where(y > 0)
    _lines(ds, y, along, ax, label)
    ax.set(xlabel=_short(ds, along), ylabel=title_of(ds[quantity]))
    if len(ax.lines) > 1 or label:
        _legend(ax)
    return ax


#: Curves that a legend names at most: of more, this many from the first to the last, whose colours run through a colour map.
NAMED = 8


def _legend(ax: Any) -> None:
    """A legend that fits, whatever the number of curves."""
    lines = [line for line in ax.lines if line.get_label()[0] != "_"]
    if len(lines) > NAMED:
        import matplotlib

        for i, line in enumerate(lines):
            line.set_color(matplotlib.colormaps["viridis"](i / (len(lines) - 1)))
        lines = [lines[i] for i in np.linspace(0, len(lines) - 1, NAMED).round().astype(int)]
    ax.legend(handles=lines, fontsize="small")


def _short(ds: xr.Dataset, along: str) -> str:
    return {"kx_over_k0": "$k_x/k_0$", "kx": "$k_x$ [rad/m]", "angle": "angle [degree]"}.get(along, title_of(ds[along]))


def bloch(
    ds: xr.Dataset, ax: Any = None, label: str | None = None, imaginary: bool = True, mirror: bool = False
) -> Any:
    """Equifrequency contour: Re kz/k0 (and Im, thinner and dotted) against kx/k0.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.bloch`.
    ax : Axes, optional
    label : str, optional
    imaginary : bool
        Draw the decay too.
    mirror : bool
        Draw -kz too, which belongs to the contour.

    Examples
    --------
    >>> ds = bp.bloch(bp.lmmd_cell(), 2500.0, kx_over_k0=np.linspace(-10, 10, 101))
    >>> ax = bp.plot.bloch(ds, mirror=True)
    """
    need(ds, "kz_over_k0")
    for name, value in (("imaginary", imaginary), ("mirror", mirror)):
        validate.flag(value, name)
    along = _lateral(ds)
    ax = _axes(ax)
    kz = ds["kz_over_k0"]
    rows = kz.values.reshape(-1, kz.sizes[along]) if kz.dims[-1] == along else kz.transpose(..., along).values
    frequency = np.atleast_1d(ds["frequency"].values)
    for i, row in enumerate(np.atleast_2d(rows)):
        text = label or (f"{frequency[i]:g} Hz" if frequency.size > 1 else None)
        (line,) = ax.plot(ds[along], row.real, label=text)
        if imaginary:
            ax.plot(ds[along], row.imag, color=line.get_color(), ls=":", lw=1)
        if mirror:
            ax.plot(ds[along], -row.real, color=line.get_color(), ls=line.get_linestyle())
    ax.set(xlabel=_short(ds, along), ylabel="$k_z/k_0$" + (" (dotted: imaginary part)" if imaginary else ""))
    if any(line.get_label()[0] != "_" for line in ax.lines):
        ax.legend(fontsize="small")
    return ax


def width(ds: xr.Dataset, ax: Any = None, label: str | None = None) -> Any:
    """Widths against frequency (or angle): launched, behind the slab, and after the distance without it.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.beam_width`.
    ax : Axes, optional
    label : str, optional
        Before the names of the curves.

    Examples
    --------
    >>> ds = bp.beam_width(bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096), [2000, 2500, 3000])
    >>> ax = bp.plot.width(ds)
    """
    need(ds, "fwhm_in", "fwhm_out", "fwhm_air")
    along = next((d for d in ("frequency", "angle") if d in ds.dims), None)
    if along is None:
        raise ValueError("ds: expected widths along frequency or angle, got scalars")
    ax = _axes(ax)
    names = {
        "fwhm_in": ("incident, near face", "-"),
        "fwhm_out": ("behind the slab", "o"),
        "fwhm_air": ("without the slab", "--"),
    }
    for name, (text, mark) in names.items():
        y = ds[name] * 100
        y = y.transpose(along, ...)
        lines = ax.plot(ds[along], y, mark, ms=3.5, mfc="none", label=f"{label}: {text}" if label else text)
        for line in lines[1:]:
            line.set_label("_")
    ax.set(xlabel=title_of(ds[along]), ylabel="full width at half maximum [cm]", ylim=(0, None))
    ax.legend(fontsize="small")
    return ax


def sweep(ds: xr.Dataset, quantity: str | None = None, log: bool = False, ax: Any = None) -> Any:
    """A quantity of a sweep: a curve on one axis, a map on two.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.sweep`.
    quantity : str, optional
        The first variable; of complex ones the magnitude is drawn.
    log : bool
        On a logarithmic scale.
    ax : Axes, optional

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> ds = bp.sweep(lambda angle: bp.scattering(slab, 2500.0, angle=angle), {"angle": [0.0, 30.0, 60.0]}, workers=1)
    >>> ax = bp.plot.sweep(ds, "transmissivity")
    """
    name = next(iter(ds.data_vars)) if quantity is None else quantity
    need(ds, str(name))
    v = ds[name].squeeze()
    if v.ndim not in (1, 2):
        raise ValueError(f"ds: expected {name} on one or two axes, got {', '.join(map(str, v.dims)) or 'one value'}")
    values = abs(v).assign_attrs(v.attrs) if v.dtype.kind == "c" else v
    ax = _axes(ax)
    if v.ndim == 1:
        values.plot(ax=ax, marker=".", yscale="log" if log else None)  # type: ignore[call-arg]
    else:
        from matplotlib.colors import LogNorm

        values.plot(ax=ax, norm=LogNorm() if log else None)  # type: ignore[call-arg]
    return ax
