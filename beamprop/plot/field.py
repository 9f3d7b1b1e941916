"""The map of a field."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..profiles.fwhm import of_samples
from . import labels, maps, style, volume
from .quantities import QUANTITIES, drawn, variables


def field(
    ds: xr.Dataset,
    quantity: str = "abs",
    ax: Any = None,
    colorbar: bool = True,
    limit: float | None = None,
    *,
    floor: float = -40.0,
    half_level: bool = False,
    width: float = style.COLUMN,
) -> Any:
    """Map of a field on (z, x), (z, y) or (x, y), with the slab's faces as dashed lines and its layers, where there is room, as thin ones.

    A volume is drawn as the three planes through its largest \\|p\\|, on one colour scale.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.field` at one frequency and angle.
    quantity : "abs", "real", "phase", "dB" or "intensity"
        \\|p\\|; Re p on a symmetric scale; the phase on a cyclic one; the level of \\|p\\| over its largest; \\|p\\|^2, or the size of the
        time-averaged intensity where the dataset holds intensity_x and intensity_z.
    ax : Axes, optional
        By default those of a new figure, as high as the map in true proportion takes; none for a volume.
    colorbar : bool
    limit : float, optional
        The colour scale's end: \\|p\\| [Pa], or the intensity [W/m^2]; what a level is over. By default the 99.8th percentile, of
        a level the largest. Where values go beyond the colours, the colour bar has a tip and the title says how far.
    floor : float, dB
        The least level.
    half_level : bool
        Draw where \\|p\\| is half its largest at each z, as lines along z; of a map along z alone.
    width : float, mm
        Of a new figure: 88 is one column of a journal, 180 is two.

    Returns
    -------
    Axes, of a volume an array of three: (x, z), (y, z) and (y, x)

    Warns
    -----
    HintWarning
        The planes skip through the cells of the slab: the map shows stripes that are not there. See `beamprop.faces`.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> ds = bp.field(slab, beam, 2500.0, x=np.linspace(-0.2, 0.2, 101), z=slab.cell.thickness * np.arange(60))
    >>> ax = bp.plot.field(ds, quantity="real", half_level=True)
    >>> ax.figure.savefig("field.svg")
    """
    for name, value in (("colorbar", colorbar), ("half_level", half_level)):
        validate.flag(value, name)
    validate.word(quantity, "quantity", *QUANTITIES)
    limit, floor = maps.checked_scale(limit, floor)
    validate.instance(ds, xr.Dataset, "ds")
    names = variables(ds, quantity)
    labels.need(ds, *names, "x", "z")
    parts = maps.on_grid(ds, names, volume=True)
    if len(parts[0].dims) == 3:
        volume.check_alone(ax, half_level)
        size = sum((abs(part) ** 2 for part in parts[1:]), abs(parts[0]) ** 2)
        return volume.draw(
            ds, parts[0], drawn(parts, quantity, limit, floor), volume.through_peak(size), width, colorbar
        )
    if half_level and "z" not in parts[0].dims:
        raise ValueError("half_level: expected False for a plane at one z, got True")
    shown = drawn(parts, quantity, limit, floor)
    with style.drawing(ax, width) as axes:
        maps.draw(axes, ds, parts[0], shown, width if ax is None else None, colorbar)
        if half_level:
            _draw_half_level(axes, maps.on_grid(ds, ("p",))[0], shown.line)
    return axes


def _draw_half_level(ax: Any, p: xr.DataArray, color: str) -> None:
    """Both edges of |p| at half its largest on each plane that has values everywhere."""
    upright = str(p.dims[0])
    if p.sizes[upright] < 4:
        raise ValueError(f"ds: expected at least 4 samples along {upright} for half_level, got {p.sizes[upright]}")
    rows = p.transpose("z", upright).values
    edges = np.full((2, len(rows)), np.nan)
    whole = np.all(np.isfinite(rows), axis=1)
    widths = of_samples(p[upright].values, rows[whole])
    edges[:, whole] = widths.left, widths.right
    for edge in edges:
        ax.plot(p["z"].values, edge, color=color, ls="-", lw=0.8)
