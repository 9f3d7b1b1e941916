"""Units by size: positions in m, mm or µm, frequencies in Hz, kHz or MHz. Data stay in SI; labels and ticks are scaled."""

from __future__ import annotations

from typing import Any

import numpy as np

#: Of an SI unit: (from this size on, name, factor to it).
SCALES: dict[str, tuple[tuple[float, str, float], ...]] = {
    "m": ((0.1, "m", 1.0), (1e-4, "mm", 1e3), (0.0, "µm", 1e6)),
    "Hz": ((1e6, "MHz", 1e-6), (1e4, "kHz", 1e-3), (0.0, "Hz", 1.0)),
}


def scale(unit: str, values: Any) -> tuple[str, float]:
    """Name of the unit that suits the largest of some values, and the factor from the SI unit to it.

    Examples
    --------
    >>> scale("m", [0.0, -0.02]), scale("Hz", 2500.0), scale("1", 3.0)
    (('mm', 1000.0), ('Hz', 1.0), ('1', 1.0))
    """
    sizes = np.abs(np.asarray(values, float))
    largest = float(np.max(sizes[np.isfinite(sizes)], initial=0.0))
    if largest == 0.0 or unit not in SCALES:
        return unit, 1.0
    return next((name, factor) for least, name, factor in SCALES[unit] if largest >= least)


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
    >>> quantity(2.5e5, "Hz"), quantity(45.0, "degree"), quantity(3.0, "1")
    ('250 kHz', '45°', '3')
    """
    if unit in ("", "1"):
        return number(value)
    if unit == "degree":
        return f"{number(value)}°"
    name, factor = scale(unit, value)
    return f"{number(value * factor)} {name}"


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
    axis.set_label_text(label if unit in ("", "1") else f"{label} [{'°' if name == 'degree' else name}]")
    if factor != 1.0:
        axis.set_major_formatter(lambda v, _: number(v * factor))
