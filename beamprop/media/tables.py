"""Layers from a table: the rows of a CSV file or of a pandas DataFrame, in the units that its header names."""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from .. import validate
from .attenuation import NEPERS_IN_DB_PER_CM, Attenuation, PowerLaw
from .fluids import Fluid
from .materials import material
from .solids import Solid
from .structures import Layer, Membrane

#: What a column may hold, and its units by the value of each in SI units; the first is meant where the header names none.
COLUMNS: dict[str, dict[str, float]] = {
    "thickness": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "density": {"kg_m3": 1.0, "g_cm3": 1e3},
    "sound_speed": {"m_s": 1.0, "km_s": 1e3},
    "shear_speed": {"m_s": 1.0, "km_s": 1e3},
    "bulk_modulus": {"pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9},
    "attenuation": {
        "np_m": 1.0,
        "np_cm": 100.0,
        "db_m": NEPERS_IN_DB_PER_CM / 100,
        "db_cm": NEPERS_IN_DB_PER_CM,
        "db_mm": NEPERS_IN_DB_PER_CM * 10,
    },
    "reference_frequency": {"hz": 1.0, "khz": 1e3, "mhz": 1e6},
    "exponent": {},
    "areal_density": {"kg_m2": 1.0, "g_m2": 1e-3},
    "material": {},
}

#: A row: the columns that it fills, each with the SI value of its unit and its cell.
Row = Mapping[str, tuple[float, Any]]


def layers_from_table(table: Any) -> tuple[Layer | Membrane, ...]:
    """The layers that the rows of a table describe, from the near side on; `Slab.from_table` tells the columns."""
    header, rows = _from_frame(table) if hasattr(table, "to_dict") and hasattr(table, "columns") else _from_file(table)
    columns = [_column(name) for name in header]
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise ValueError(f"table: expected one column of {name}, got {names.count(name)}")
    if not rows:
        raise ValueError("table: expected at least one row below the header, got none")
    layers = []
    for number, cells in enumerate(rows, start=1):
        if len(cells) != len(header):
            raise ValueError(f"table: expected {len(header)} cells in row {number}, as in the header, got {len(cells)}")
        row: Row = {
            name: (unit, cell) for (name, unit), cell in zip(columns, cells, strict=True) if not _is_empty(cell)
        }
        with _row_named(number):
            layers.append(_layer(row))
    return tuple(layers)


def _from_frame(frame: Any) -> tuple[list[str], list[list[Any]]]:
    header = [str(name) for name in frame.columns]
    cells = frame.astype(object).where(frame.notna(), None)  # pandas has an NA that equals nothing
    return header, [list(record) for record in cells.itertuples(index=False, name=None)]


def _from_file(path: Any) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of a CSV file: commas, semicolons or tabs; empty lines and those that begin with # are left out."""
    with open(validate.existing(validate.as_path(path, "table"), "table"), encoding="utf-8-sig", newline="") as file:
        try:
            lines = [line for line in file if line.strip() and not line.lstrip().startswith("#")]
        except UnicodeDecodeError as error:
            raise ValueError(f"table: expected text in UTF-8, got {error.reason} in {os.fspath(path)}") from None
    if not lines:
        raise ValueError(f"table: expected a line of column names, got no text in {os.fspath(path)}")
    separator = max(",;\t", key=lines[0].count)
    header, *rows = csv.reader(lines, delimiter=separator, skipinitialspace=True)
    return [name.strip() for name in header], [[cell.strip() for cell in row] for row in rows]


def _column(header: str) -> tuple[str, float]:
    """What a column holds and the SI value of its unit: thickness, thickness_mm, thickness [mm], Thickness (mm)."""
    plain = header.lower().translate(str.maketrans("µμ³²", "uu32", "^"))
    plain = re.sub(r"^speed", "sound_speed", re.sub(r"[^a-z0-9]+", "_", plain).strip("_"))
    for name, units in COLUMNS.items():
        if plain == name:
            return name, 1.0
        if plain.startswith(name + "_") and plain[len(name) + 1 :] in units:
            return name, units[plain[len(name) + 1 :]]
    known = ", ".join(
        f"{name} ({', '.join(units).replace('_', '/')})" if units else name for name, units in COLUMNS.items()
    )
    raise validate.refuse("table", f"columns of {known}", header)


def _is_empty(cell: Any) -> bool:
    return cell is None or cell == ""


@contextmanager
def _row_named(number: int) -> Iterator[None]:
    """Errors with the row of the table that they come from."""
    try:
        yield
    except ValueError as error:
        name, colon, said = str(error).partition(": ")
        raise ValueError(f"{name}, row {number}: {said}" if colon else f"row {number}: {error}") from None


def _layer(row: Row) -> Layer | Membrane:
    given = set(row)
    if "areal_density" in given:
        _only(given, "areal_density", "thickness")
        if "thickness" in given and _number(row, "thickness") != 0:
            raise validate.refuse("thickness", "0 or nothing beside an areal density", row["thickness"][1])
        return Membrane(_number(row, "areal_density"))
    if "thickness" not in given:
        raise ValueError("thickness: expected a number, got an empty cell or no such column")
    return Layer(_fluid(row), _real(row, "thickness"))


def _fluid(row: Row) -> Fluid | Solid:
    given = set(row)
    if "material" in given:
        _only(given, "material", "thickness", "attenuation", "reference_frequency", "exponent")
        try:
            return material(row["material"][1], attenuation=_attenuation(row))
        except ValueError as error:
            raise ValueError(str(error).replace("name: ", "material: ", 1)) from None
    if "density" not in given or ("sound_speed" in given) == ("bulk_modulus" in given):
        came = ", ".join(name for name in row if name != "thickness") or "none of them"
        raise ValueError(f"density: expected material, or density and one of sound_speed and bulk_modulus, got {came}")
    if "shear_speed" in given:
        _only(given, "shear_speed", "thickness", "density", "sound_speed")
        return Solid(*(_number(row, name) for name in ("density", "sound_speed", "shear_speed")))
    if "bulk_modulus" in given:
        _only(given, "bulk_modulus", "thickness", "density")
        return Fluid(_number(row, "density"), _number(row, "bulk_modulus"))
    return Fluid.from_speed(_number(row, "density"), _number(row, "sound_speed"), _attenuation(row))


def _attenuation(row: Row) -> Attenuation:
    """A number of Np/m, or a power law where the row has a reference frequency."""
    if "attenuation" not in row or "reference_frequency" not in row:
        for name in {"reference_frequency", "exponent"} & set(row):
            missing = "attenuation" if "attenuation" not in row else "reference_frequency"
            raise ValueError(f"{missing}: expected a number beside {name}, got an empty cell or no such column")
        return _real(row, "attenuation") if "attenuation" in row else 0.0
    exponent = _real(row, "exponent") if "exponent" in row else 2.0
    return PowerLaw(_real(row, "attenuation") / NEPERS_IN_DB_PER_CM, _real(row, "reference_frequency"), exponent)


def _only(given: set[str], column: str, *beside: str) -> None:
    more = sorted(given - {column, *beside})
    if more:
        raise ValueError(f"{', '.join(more)}: expected an empty cell beside {column}, got a value")


def _number(row: Row, name: str) -> complex:
    """A cell as a number in SI units; complex ones as 2+0.5j, or with i."""
    unit, cell = row[name]
    if isinstance(cell, str):
        try:
            return complex(cell.replace(" ", "").replace("i", "j")) * unit
        except ValueError:
            raise validate.refuse(name, "a number", cell) from None
    return validate.as_complex(cell, name) * unit


def _real(row: Row, name: str) -> float:
    number = _number(row, name)
    if number.imag != 0:
        raise validate.refuse(name, "a real number", row[name][1])
    return number.real
