"""Columns of numbers in a text file: what parts them, and what their decimal mark is."""

from __future__ import annotations

import os
import re

import numpy as np

_TIGHT = re.compile(r"\d,\d")
_LOOSE = re.compile(r",\s|\s,")
_DECIMAL_COMMA = re.compile(r"[-+]?(\d+(,\d*)?|,\d+)([eE][-+]?\d+)?")
_HINT = "columns parted by ; or tabs where commas are decimal, or decimal points"


def read_columns(path: str | os.PathLike[str], fewest: int, most: int, what: str) -> np.ndarray:
    """Rows of finite numbers, (row, column), as many in each.

    Columns are parted by commas, semicolons, tabs or blanks. Commas are decimal where semicolons or tabs part the columns and no number
    has a point. What could be read either way is refused.

    Parameters
    ----------
    path : path
    fewest, most : int
        Columns.
    what : str
        Their names, for messages.

    Raises
    ------
    ValueError
        Names the file, the line, what was expected and what came.
    """
    try:
        with open(path, encoding="utf-8-sig") as file:
            lines = [(n, text) for n, line in enumerate(file, 1) if (text := line.strip()) and text[0] not in "#%"]
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: expected text (UTF-8), got {error.reason} at byte {error.start}") from None
    commas = _commas(str(path), lines)
    rows: list[list[float]] = []
    for number, text in lines:
        row = _numbers(text, commas)
        if row is None or not fewest <= len(row) <= most or (rows and len(row) != len(rows[0])):
            hint = f" ({_HINT})" if _TIGHT.search(text) and commas == "part" else ""
            raise ValueError(f"{path}, line {number}: expected {fewest} or {most} numbers ({what}){hint}, got {text!r}")
        if not np.isfinite(row).all():
            raise ValueError(f"{path}, line {number}: expected finite numbers within 1e-308 and 1e308, got {text!r}")
        rows.append(row)
    if len(rows) < 2:
        raise ValueError(f"{path}: expected at least 2 rows of {what}, got {len(rows)}")
    return np.array(rows)


def _commas(path: str, lines: list[tuple[int, str]]) -> str:
    """What commas do: "decimal", or "part" columns; refused where that is not plain."""
    tight = [(n, text) for n, text in lines if _TIGHT.search(text)]
    if not tight:
        return "part"
    points = any("." in text for _, text in lines)
    parted = [(n, text) for n, text in lines if ";" in text or "\t" in text]
    number, text = tight[0]
    if parted:
        if not points and all(_DECIMAL_COMMA.fullmatch(cell) for _, line in lines for cell in _cells(line)):
            return "decimal"
    elif not any(_blanks(line) for _, line in lines) and (points or not any(_LOOSE.search(line) for _, line in lines)):
        return "part"
    raise ValueError(f"{path}, line {number}: expected {_HINT}, got {text!r}, where a comma may be either")


def _blanks(text: str) -> bool:
    """Whether blanks part columns, other than blanks beside commas."""
    return len(re.sub(r"\s*,\s*", ",", text).split()) > 1


def _cells(text: str) -> list[str]:
    """Cells between semicolons, or else tabs."""
    text = text.strip("; \t")
    return [cell.strip() for cell in text.split(";" if ";" in text else "\t")]


def _numbers(text: str, commas: str) -> list[float] | None:
    cells = (
        re.split(r"[,;\s]+", text.strip(",; \t")) if commas == "part" else [c.replace(",", ".") for c in _cells(text)]
    )
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        return None
