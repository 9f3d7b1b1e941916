"""Parameters of columns to dimensions: their names in the dataset, SI units, and the values of each."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

from .forms import PARAMETERS
from .names import Column
from .text import QUANTITIES, Source, plain_unit

#: Names of the dataset that no parameter takes.
RESERVED = ("x", "z", "p", "node", "elements", "element", "corner", "row")


def parameter_names(file_names: Iterable[str]) -> dict[str, str]:
    """File's parameter -> the dataset's name; two that would share a name keep their own."""
    distinct = list(dict.fromkeys(file_names))
    names = {n: n if n not in RESERVED else f"{n}_parameter" for n in distinct}
    for target, aliases in PARAMETERS.items():
        present = [n for n in distinct if n in aliases]
        if len(present) == 1:
            names[present[0]] = target
    return names


def in_si(source: Source, columns: list[Column], names: dict[str, str], angle_unit: str | None) -> list[Column]:
    """Parameters under their names in the dataset, and in SI units and degrees where the unit is known."""
    bare = any(names[n] == "angle" and not unit and value != 0 for c in columns for n, value, unit in c.parameters)
    if bare and angle_unit is None:
        warnings.warn(
            f"{source.path}: states no unit of the angle, degrees taken (angle_unit= or --angle-unit says otherwise)",
            stacklevel=4,
        )
    defaults = {"frequency": "Hz", "angle": angle_unit or "deg", "time": "s"}
    kinds = {"frequency": "Hz", "angle": "degree", "time": "s"}

    def bring(name: str, value: Any, unit: str) -> tuple[str, Any, str]:
        unit = plain_unit(unit) or defaults.get(names[name], "")
        to, known = next(((t, k) for t, k in QUANTITIES if unit in k), (unit, {unit: 1.0}))
        if kinds.get(names[name], to) != to or (names[name] in kinds and isinstance(value, str | complex)):
            source.refuse(None, f"real values of {name} in {kinds[names[name]]}", f"{value!r} [{unit}]")
        return names[name], value if isinstance(value, str) else value * known[unit], to

    return [Column(c.expression, c.unit, tuple(bring(*p) for p in c.parameters)) for c in columns]


def parameter_axes(source: Source, columns: list[Column]) -> dict[str, tuple[list[Any], str]]:
    """Each parameter's values (rising, where they are real) and unit; frequency and angle first."""
    values: dict[str, dict[Any, None]] = {}
    units: dict[str, set[str]] = {}
    for column in columns:
        for name, value, unit in column.parameters:
            values.setdefault(name, {})[value] = None
            units.setdefault(name, set()).add(unit)
    for name, units_of_one in units.items():
        if len(units_of_one) > 1:
            source.refuse(None, f"one unit for the parameter {name}", " and ".join(sorted(map(repr, units_of_one))))
    order = sorted(values, key=lambda n: (n != "frequency", n != "angle"))
    real = {n: all(isinstance(v, float) for v in values[n]) for n in order}
    return {n: (sorted(values[n]) if real[n] else list(values[n]), units[n].pop()) for n in order}
