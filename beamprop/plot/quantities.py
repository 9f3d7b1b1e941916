"""What is drawn of a field: size, real part, phase, level or intensity, on which colour map and from where to where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from .units import number, quantity

#: The words of `quantity`.
QUANTITIES = ("abs", "real", "phase", "dB", "intensity")
#: Share of the values that a colour scale holds [%]: single bright points, at the edges of slits, would darken all else.
HELD = 99.8
#: The level of no sound: smaller ones are rounding [dB].
SILENT = -400.0


class Drawn(NamedTuple):
    """Values, the colour map and both ends of its scale, their label, and the colour of lines that are seen on the map."""

    values: np.ndarray
    cmap: str
    low: float
    high: float
    label: str
    line: str = "white"

    @property
    def beyond(self) -> tuple[bool, bool]:
        """Whether values lie below and above the scale, by more than rounding."""
        finite, room = self.values[np.isfinite(self.values)], 1e-9 * (self.high - self.low)
        return bool(np.any(finite < self.low - room)), bool(np.any(finite > self.high + room))

    @property
    def extend(self) -> str:
        """Where the colours end before the values do: neither, min, max or both."""
        below, above = self.beyond
        return "both" if below and above else "min" if below else "max" if above else "neither"

    @property
    def note(self) -> str:
        """How far the values go where the colours end, or ''."""
        below, above = self.beyond
        least = float(np.nanmin(self.values, initial=np.inf))
        lower = "−∞" if least <= SILENT else number(float(f"{least:.3g}"))
        upper = number(float(f"{np.nanmax(self.values, initial=-np.inf):.3g}"))
        if below and above:
            return f"values from {lower} to {upper}"
        return f"values down to {lower}" if below else f"values up to {upper}" if above else ""


def variables(ds: xr.Dataset, what: str) -> tuple[str, ...]:
    """The variables that a quantity is made of: the intensity, where the dataset has it, and the pressure for all else."""
    intensity = ("intensity_x", "intensity_z")
    return intensity if what == "intensity" and set(intensity) <= set(ds.data_vars) else ("p",)


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
    size = np.hypot(*(np.abs(part.values) for part in parts)) if len(parts) > 1 else np.abs(p)
    finite = size[np.isfinite(size)]
    if what == "phase":
        return Drawn(np.degrees(np.angle(p)), "twilight", -180.0, 180.0, "phase [°]", "black")
    if what == "dB":
        top = limit or float(np.max(finite, initial=0.0)) or 1.0
        with np.errstate(divide="ignore"):
            level = np.fmax(20 * np.log10(size / top), np.where(np.isnan(size), np.nan, SILENT))
        of = "max" if limit is None else quantity(limit, unit)
        return Drawn(level, "inferno", floor, 0.0, f"|p| [dB re {of}]")
    top = limit or (float(np.percentile(finite, HELD)) if finite.size else 0.0) or 1.0
    if what == "real":
        return Drawn(p.real, "cividis", -top, top, labelled("Re p", unit), "black")
    if what == "intensity" and len(parts) == 1:
        return Drawn(size**2, "inferno", 0.0, top**2, labelled("|p|²", unit and f"{unit}²"))
    return Drawn(size, "inferno", 0.0, top, labelled("|p|" if len(parts) == 1 else "|I|", unit.replace("^2", "²")))


def labelled(name: str, unit: str) -> str:
    """A name with its unit, if it has one."""
    return name if unit in ("", "1") else f"{name} [{unit}]"
