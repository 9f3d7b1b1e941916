"""Units by size: positions in m, mm or µm, frequencies in Hz, kHz or MHz, pressures in MPa to µPa, powers of ten of all else.

Data stay in SI; labels and ticks are scaled.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

#: Of an SI unit: (from this size on, name, factor to it).
SCALES: dict[str, tuple[tuple[float, str, float], ...]] = {
    "m": ((0.1, "m", 1.0), (1e-4, "mm", 1e3), (0.0, "µm", 1e6)),
    "Pa": ((1e6, "MPa", 1e-6), (1e3, "kPa", 1e-3), (0.1, "Pa", 1.0), (1e-4, "mPa", 1e3), (1e-8, "µPa", 1e6)),
    "Hz": ((1e6, "MHz", 1e-6), (1e4, "kHz", 1e-3), (0.0, "Hz", 1.0)),
}
#: Units that are written as they are, whatever the size; and from where to where numbers of all others are.
UNSCALED, PLAIN = ("degree",), (1e-2, 1e4)
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def scale(unit: str, values: Any) -> tuple[str, float]:
    """Name of the unit that suits the largest of some values, and the factor from the SI unit to it.

    Examples
    --------
    >>> scale("m", [0.0, -0.02]), scale("Hz", 2500.0), scale("W/m^2", 2e-7)
    (('mm', 1000.0), ('Hz', 1.0), ('10⁻⁹ W/m²', 1000000000.0))
    """
    sizes = np.abs(np.asarray(values, float))
    largest = float(np.max(sizes[np.isfinite(sizes)], initial=0.0))
    for least, name, factor in SCALES.get(unit, ()) if largest else ():
        if largest >= least:
            return name, factor
    plain = "°" if unit == "degree" else "" if unit == "1" else unit.replace("^2", "²")
    if largest == 0.0 or unit in UNSCALED or PLAIN[0] <= largest < PLAIN[1]:
        return plain, 1.0
    power = 3 * math.floor(math.log10(largest) / 3)
    return f"10{str(power).translate(_SUPERSCRIPTS)} {plain}".strip(), 10.0**-power


def number(value: float) -> str:
    """A number as the labels write it, with a proper minus sign.

    Examples
    --------
    >>> number(-0.25)
    '−0.25'
    """
    return f"{value:.6g}".replace("-", "\N{MINUS SIGN}")


def quantity(value: float, unit: str) -> str:
    """A value with its unit.

    Examples
    --------
    >>> quantity(2.5e5, "Hz"), quantity(45.0, "degree"), quantity(3.0, "1"), quantity(2e6, "W/m^2")
    ('250 kHz', '45°', '3', '2·10⁶ W/m²')
    """
    name, factor = scale(unit, value)
    return joined(number(value * factor), name)


def joined(written: str, name: str) -> str:
    """A number that is written already, and the name of its unit."""
    return f"{written}{'·' if name.startswith('10') else '' if name in ('', '°') else ' '}{name}"


def name_axis(axis: Any, label: str, values: Any, unit: str) -> None:
    """Label an axis of matplotlib, and tick it in the unit that suits the SI `values` that it shows.

    Examples
    --------
    >>> import matplotlib.pyplot as plt
    >>> ax = plt.figure().add_subplot()
    >>> name_axis(ax.xaxis, "z", [0, 0.02], "m")
    >>> ax.get_xlabel(), ax.xaxis.get_major_formatter()(0.01)
    ('z [mm]', '10')
    """
    name, factor = scale(unit, values)
    axis.set_label_text(f"{label} [{name}]" if name else label)
    if factor != 1.0:
        axis.set_major_formatter(lambda v, _: number(v * factor))
