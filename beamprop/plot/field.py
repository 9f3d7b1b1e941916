"""The map of a field."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from . import labels, style, units


def field(
    ds: xr.Dataset, quantity: str = "abs", ax: Any = None, colorbar: bool = True, limit: float | None = None
) -> Any:
    """Map of a field on (z, x), with the slab's faces as dashed lines.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.field` at one frequency and angle.
    quantity : "abs" or "real"
        |p|, or Re p.
    ax : Axes, optional
    colorbar : bool
    limit : float, optional
        The colour scale's end [Pa]; the 99.8th percentile of |p| by default.

    Returns
    -------
    Axes

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> ds = bp.field(slab, beam, 2500.0, x=np.linspace(-0.5, 0.5, 101), z=np.linspace(0, 0.3, 61))
    >>> ax = bp.plot.field(ds, quantity="real")
    >>> ax.figure.savefig("field.png")
    """
    labels.need(ds, "p", "x", "z")
    validate.flag(colorbar, "colorbar")
    if limit is not None:
        limit = validate.as_number(limit, "limit", positive=True)
    validate.word(quantity, "quantity", "abs", "real")
    p = ds["p"].squeeze(drop=True)
    if set(p.dims) != {"z", "x"}:
        raise ValueError(
            f"ds: expected a field on (z, x); select one of {', '.join(set(map(str, p.dims)) - {'z', 'x'})}"
        )
    p = p.transpose("x", "z")
    ax = style.new_figure(180.0, 107.0).add_subplot() if ax is None else ax
    values = np.abs(p.values) if quantity == "abs" else p.values.real
    top = limit or float(np.percentile(np.abs(p.values), 99.8)) or 1.0
    scale = (
        {"cmap": "inferno", "vmin": 0, "vmax": top}
        if quantity == "abs"
        else {"cmap": "RdBu_r", "vmin": -top, "vmax": top}
    )
    mesh = ax.pcolormesh(p["z"].values, p["x"].values, values, shading="nearest", rasterized=True, **scale)
    edge = "white" if quantity == "abs" else "black"
    for face in (0.0, ds.attrs.get("slab_thickness")):
        if face is not None and p["z"].min() <= face <= p["z"].max():
            ax.axvline(face, color=edge, ls="--", lw=0.8)
    ax.set_aspect("equal")
    for axis, name in ((ax.xaxis, "z"), (ax.yaxis, "x")):
        units.name_axis(axis, name, [np.abs(p[n]).max() for n in ("z", "x")], "m")
    if colorbar:
        text = {"abs": "|p| [Pa]", "real": "Re p [Pa]"}[quantity]
        ax.figure.colorbar(mesh, ax=ax, label=text, shrink=0.8)
    ax.set_title(labels.where(ds), fontsize="medium")
    return ax
