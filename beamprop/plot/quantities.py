"""What is drawn of a field: size, real part, phase, level or intensity, on which colour map and from where to where."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import xarray as xr

from .units import joined, number, quantity, scale

#: The words of `quantity`.
QUANTITIES = ("abs", "real", "phase", "dB", "intensity")
#: Share of the values that a colour scale holds [%]: single bright points, at the edges of slits, would darken all else.
HELD = 99.8
#: The level of no sound: smaller ones are rounding [dB].
SILENT = -400.0


class Drawn(NamedTuple):
    """Values, what they are called, the ends of the colour scale, and how far the values go (of a film, at any time)."""

    values: np.ndarray
    name: str
    unit: str
    low: float
    high: float
    least: float
    most: float
    cmap: str = "inferno"
    line: str = "white"  #: colour of lines that are seen on the map

    @property
    def beyond(self) -> tuple[bool, bool]:
        """Whether values lie below and above the scale, by more than rounding."""
        room = 1e-9 * (self.high - self.low)
        return self.least < self.low - room, self.most > self.high + room

    @property
    def extend(self) -> str:
        """Where the colours end before the values do: neither, min, max or both."""
        below, above = self.beyond
        return "both" if below and above else "min" if below else "max" if above else "neither"

    @property
    def note(self) -> str:
        """How far the values go where the colours end, or ''."""
        below, above = self.beyond
        unit, factor = scale(self.unit, (self.low, self.high))
        lower, upper = (number(float(f"{value * factor:.3g}")) for value in (self.least, self.most))
        if self.least <= SILENT and below:
            lower = "−∞"
        if below and above:
            return f"values from {lower} to {joined(upper, unit)}"
        return (
            f"values down to {joined(lower, unit)}" if below else f"values up to {joined(upper, unit)}" if above else ""
        )


def variables(ds: xr.Dataset, what: str) -> tuple[str, ...]:
    """The variables that a quantity is made of: the intensity, where the dataset has it, and the pressure for all else."""
    needed = {"intensity_x", "intensity_z"} | ({"intensity_y"} if ds.attrs.get("geometry") == "3-D" else set())
    return tuple(sorted(needed)) if what == "intensity" and needed <= set(ds.data_vars) else ("p",)


def drawn(parts: tuple[xr.DataArray, ...], what: str, limit: float | None = None, floor: float = -40.0) -> Drawn:
    """What is drawn of `variables`.

    Parameters
    ----------
    parts : arrays
    what : str, of QUANTITIES
    limit : float, optional
        |p| (of two parts, the intensity) at the end of the scale; by default `HELD` per cent of the values lie below, of a level all.
    floor : float
        The least level [dB].
    """
    p, unit = parts[0].values, parts[0].attrs.get("units", "")
    size = functools.reduce(np.hypot, (part.values for part in parts)) if len(parts) > 1 else np.abs(p)
    finite = size[np.isfinite(size)]
    if what == "phase":
        return Drawn(np.degrees(np.angle(p)), "phase", "degree", -180.0, 180.0, -180.0, 180.0, "twilight", "black")
    if what == "dB":
        top = limit or float(np.max(finite, initial=0.0)) or 1.0
        with np.errstate(divide="ignore"):
            level = np.maximum(20 * np.log10(size / top), SILENT)
        of = "max" if limit is None else quantity(limit, unit)
        return Drawn(level, "|p|", f"dB re {of}", floor, 0.0, *_ends(level))
    top = limit or (float(np.percentile(finite, HELD)) if finite.size else 0.0) or 1.0
    if what == "real":
        return Drawn(p.real, "Re p", unit, -top, top, *_ends(p.real), "cividis", "black")
    if what == "intensity" and len(parts) == 1:
        return Drawn(size**2, "|p|²", unit and f"{unit}²", 0.0, top**2, *_ends(size**2))
    return Drawn(size, "|p|" if len(parts) == 1 else "|I|", unit, 0.0, top, *_ends(size))


def _ends(values: np.ndarray) -> tuple[float, float]:
    """The least and the largest finite value; of none, 0."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
