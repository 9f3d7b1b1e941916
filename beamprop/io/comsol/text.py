"""A file's lines: header and body, cells and numbers, and the units that they may come in."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

import numpy as np

#: Units of pressure in Pa.
PRESSURE_UNITS = {
    "Pa": 1.0,
    "kPa": 1e3,
    "MPa": 1e6,
    "GPa": 1e9,
    "hPa": 1e2,
    "mPa": 1e-3,
    "uPa": 1e-6,
    "bar": 1e5,
    "mbar": 1e2,
    "atm": 101325.0,
    "N/m^2": 1.0,
    "psi": 6894.757293168361,
}
LENGTHS = {
    "m": 1.0,
    "mm": 1e-3,
    "cm": 1e-2,
    "dm": 0.1,
    "km": 1e3,
    "um": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "inch": 0.0254,
    "ft": 0.3048,
    "mil": 2.54e-5,
}
_FREQUENCIES = {"Hz": 1.0, "kHz": 1e3, "MHz": 1e6, "GHz": 1e9, "THz": 1e12, "mHz": 1e-3, "1/s": 1.0}
_TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0}
ANGLES = {"deg": 1.0, "degree": 1.0, "\N{DEGREE SIGN}": 1.0, "rad": 180 / np.pi}
#: Kind of quantity: (the unit it is brought to, factors).
QUANTITIES = (("Hz", _FREQUENCIES), ("m", LENGTHS), ("s", _TIMES), ("degree", ANGLES), ("Pa", PRESSURE_UNITS))
_META = ("Model", "Version", "Date", "Dimension", "Nodes", "Expressions", "Description", "Length unit", "Table")
#: '% Elements: 1122' is a count; '% Elements (triangles)' begins a section.
ELEMENT_COUNT = r"Elements(?=\s*[:,;\t]\s*\d+$)"
META_LINE = re.compile(rf"({'|'.join(_META)}|{ELEMENT_COUNT})\s*[:,;\t]\s*(.*)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(
    r"[-+]?\d*,?\d+([eE][-+]?\d+)?([-+]\d*,?\d+([eE][-+]?\d+)?\*?[ij])?[ij]?|[-+]?(nan|inf)", re.IGNORECASE
)


@dataclass
class Source:
    """The file's lines (number, text), header lines without their %, and what the header states."""

    path: str
    header: list[tuple[int, str]] = field(default_factory=list)
    body: list[tuple[int, str]] = field(default_factory=list)  # with the % of later comments
    meta: dict[str, str] = field(default_factory=dict)

    def refuse(self, line: int | None, expected: str, got: str) -> NoReturn:
        where = f"{self.path}, line {line}" if line else self.path
        if "table" in self.meta:
            got += f" (the file is a '% Table' export, {short(self.meta['table'])})"
        raise ValueError(f"{where}: expected {expected}, got {got}")

    def count(self, key: str) -> int | None:
        """A whole number of the header, None where it is not stated."""
        try:
            return int(self.meta[key]) if key in self.meta else None
        except ValueError:
            self.refuse(None, f"a whole number after '% {key.capitalize()}'", repr(self.meta[key]))


def scan(path: str) -> Source:
    """Read the file and part its header from its body."""
    source = Source(path)
    lines = [(n, t) for n, text in enumerate(_decode(path).splitlines(), 1) if (t := text.strip().strip("\0"))]
    header = True
    for n, text in lines:
        if header and _starts_header(text):
            source.header.append((n, text.lstrip("%").strip().rstrip(",;")))
        else:
            header = False
            source.body.append((n, text))
    for _, text in source.header:
        if m := META_LINE.fullmatch(text.replace('"', "")):
            source.meta[m[1].lower()] = m[2].strip(" ,;\t")
    if not source.body:
        source.refuse(None, "rows of numbers below the header", "none")
    return source


def _decode(path: str) -> str:
    raw = Path(path).read_bytes()
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16")
    if raw[:4] == b"PK\x03\x04" or b"\0" in raw[:4096]:
        raise ValueError(f"{path}: expected a text export, got a binary file (COMSOL's own .mph models are no exports)")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    return text.replace("\N{MINUS SIGN}", "-")


def _starts_header(text: str) -> bool:
    """A comment, a line that a spreadsheet program put into quotes, or names of columns without the %."""
    first = text.lstrip('"').lstrip()
    return first.startswith("%") or bool(re.match(r"(?!nan\b|inf\b)[A-Za-z]", first, re.IGNORECASE))


def length_factor(source: Source, given: str | None) -> float:
    """Metres in the file's unit of length."""
    stated = source.meta.get("length unit", "")
    unit = plain_unit(stated if stated not in ("", "null") else given or "m")
    if unit not in LENGTHS:
        source.refuse(None, f"a unit of length, one of {', '.join(LENGTHS)}", repr(stated))
    return LENGTHS[unit]


def plain_unit(unit: str) -> str:
    """A unit with a plain u for micro."""
    return unit.strip().replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")


def find_delimiter(text: str) -> str:
    """What parts the cells of a row: ";", "," or " " for any blank."""
    if ";" in text:
        return ";"
    parts = text.split()
    if "," not in text or (len(parts) > 1 and all(_DECIMAL_COMMA.fullmatch(part) for part in parts)):
        return " "
    return ","


def _cells(text: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return text.split()
    if '"' in text:
        return [c.strip() for c in next(csv.reader([text], delimiter=delimiter, skipinitialspace=True))]
    return [c.strip() for c in text.split(delimiter)]


def split_rows(source: Source, lines: list[tuple[int, str]], delimiter: str, width: int | None) -> list[list[str]]:
    """Cells of all lines, `width` of them (as many as in the first line, if None) in each; decimal commas to points."""
    rows = [_cells(text, delimiter) for _, text in lines]
    width = len(rows[0]) if width is None else width
    for (n, text), row in zip(lines, rows, strict=True):
        if len(row) == width + 1 and row[-1] == "" and delimiter != " ":
            row.pop()
        if len(row) != width:
            source.refuse(n, f"{width} values", f"{len(row)} in {short(text)}")
    if (delimiter != "," or any('"' in text for _, text in lines)) and any("," in text for _, text in lines):
        _refuse_mixed_points(source, lines, rows)
        rows = [[cell.replace(",", ".") for cell in row] for row in rows]
    return rows


def _refuse_mixed_points(source: Source, lines: list[tuple[int, str]], rows: list[list[str]]) -> None:
    """A file with decimal commas must have no points: 1.234,5 and 1.234 cannot be told apart safely."""
    if not any("," in cell for row in rows for cell in row):
        return
    for (n, text), row in zip(lines, rows, strict=True):
        if any("." in cell for cell in row):
            source.refuse(n, "decimal commas throughout, as in other lines", short(text))


def short(text: str) -> str:
    """A text as a message shows it."""
    return repr(text if len(text) < 60 else text[:57] + "...")


def to_numbers(source: Source, lines: list[int], cells: list[str]) -> np.ndarray:
    """Cells to floats, or to complex where any has an imaginary part."""
    try:
        numbers = np.array(cells, dtype=float)
    except ValueError:
        numbers = _to_complex(source, lines, cells)
    for k in np.flatnonzero(np.isinf(numbers)):
        if "inf" not in cells[k].lower():
            source.refuse(lines[k], "numbers within 1e308, as doubles are", repr(cells[k]))
    return numbers


def _to_complex(source: Source, lines: list[int], cells: list[str]) -> np.ndarray:
    out = np.empty(len(cells), complex)
    for k, cell in enumerate(cells):
        try:
            out[k] = as_complex(cell)
        except ValueError:
            source.refuse(lines[k], "a real or complex number", repr(cell))
    return out


def as_complex(text: str) -> complex:
    """A number as COMSOL writes it: -3.308E-5-0.00388i."""
    text = text.replace(" ", "")
    if text[-1:] in ("i", "j"):
        text = text[:-1].removesuffix("*") + "j"
    return complex(text)
