"""The three forms of file, spreadsheet, grid and sectionwise, to one table of points and columns."""

from __future__ import annotations

import re
import warnings
from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np

from .names import Column, column_names, parse_column, parse_title
from .text import ELEMENT_COUNT, LENGTHS, META_LINE, Source, find_delimiter, plain_unit, short, split_rows, to_numbers

#: Coordinate of the dataset: what models call it.
PARAMETERS = {
    "frequency": ("freq", "frequency", "f"),
    "time": ("t", "time"),
    "angle": ("theta", "theta0", "theta_0", "theta_i", "theta_inc", "angle"),
}
_COORDINATES = ("x", "y", "z", "r", "X", "Y", "Z", "R")
#: Places along a line: those, and the coordinates of a cut line's or plane's own.
_PLACE = re.compile(r"[xyzr]|(?:cln|cpl)\d+[xyz]", re.IGNORECASE)
#: What plots call the values of a curve, whatever they are over.
_CURVE = "Height"
SECTION = re.compile(rf"(?!{ELEMENT_COUNT})(Grid|Coordinates|Elements|Data)\b\s*:?\s*(.*)", re.IGNORECASE)


@dataclass
class Table:
    """A file's contents: coordinates [m] of its points, columns and their values, one row for each point.

    A table whose rows are no points has no coordinates.
    """

    source: Source
    coordinates: dict[str, np.ndarray]
    columns: list[Column]
    values: list[np.ndarray]
    elements: np.ndarray | None = None
    scattered: dict[str, tuple[np.ndarray, str]] = field(default_factory=dict)  # parameters that are columns


def read_spreadsheet(source: Source, factor: float, placed: bool, expression: str | None) -> Table:
    """Rows of coordinates and values below a line of names; `placed` says that the first of a line's columns is a place."""
    lines = source.body
    for n, text in lines:
        if text.startswith("%"):
            source.refuse(n, "numbers down to the file's end", short(text))
    delimiter = find_delimiter(lines[0][1])
    rows = split_rows(source, lines, delimiter, None)
    line, names = _header_names(source, delimiter, len(rows[0]))
    _check_nodes(source, len(rows))
    numbers = [n for n, _ in lines]
    columns = [(parse_title if "table" in source.meta else parse_column)(source, line, name) for name in names]
    values = [to_numbers(source, numbers, list(cells)) for cells in zip(*rows, strict=True)]
    if "table" in source.meta or source.meta.get("dimension") == "0":
        return Table(source, {}, _told_apart(columns), values)
    dimension = _count_coordinates(source, line, columns)
    _check_expressions(source, len(columns), dimension)
    if dimension == 1 and not placed and not _is_line(columns, expression):
        return Table(source, {}, _told_apart(_with_length_unit(source, columns)), values)
    table = Table(source, {}, [], [])
    for k, (column, value) in enumerate(zip(columns, values, strict=True)):
        if k < dimension:
            table.coordinates[column.expression] = _coordinate(source, line, column, value, factor)
        elif not column.parameters and column.expression in sum(PARAMETERS.values(), ()):
            table.scattered[column.expression] = (value, column.unit)
        else:
            table.columns.append(column)
            table.values.append(value)
    if not table.columns:
        source.refuse(line, "columns of values beside the coordinates", ", ".join(names))
    return table


def _header_names(source: Source, delimiter: str, width: int) -> tuple[int, list[str]]:
    """The line that names the columns: the last of the header."""
    line, text = source.header[-1] if source.header else (None, "")
    if line is None or not text or META_LINE.fullmatch(text):
        source.refuse(line, "a line that names the columns above the numbers", short(text) if text else "none")
    splits = [column_names(text, d) for d in (delimiter, *(d for d in (",", ";", " ") if d != delimiter))]
    prose = [
        name.strip('"') for name in re.split(r"\s{2,}|\t", text)
    ]  # titles of tables and legends of plots, in columns
    for names in [prose, *splits] if "table" in source.meta else [*splits, prose]:
        if len(names) == width:
            return line, names
    count = len(column_names(text, delimiter))
    source.refuse(line, f"{width} names, for the {width} columns below", f"{count} in {short(text)}")


def _count_coordinates(source: Source, line: int, columns: list[Column]) -> int:
    """How many of the first columns are coordinates: as the header states, else those with a coordinate's name."""
    known = 0
    while known < len(columns) and columns[known].expression in _COORDINATES and not columns[known].parameters:
        known += 1
    stated = source.count("dimension")
    count = known if stated is None else stated
    if not 1 <= count <= min(3, len(columns)) or any(c.parameters for c in columns[:count]):
        names = ", ".join(c.expression for c in columns[:4])
        source.refuse(line, f"one to three coordinates first ({', '.join(_COORDINATES)})", names)
    return count


def _is_line(columns: list[Column], expression: str | None) -> bool:
    """Whether the rows of a one-dimensional file are points of a line.

    Sweeps of a parameter are none, nor curves of a plot, unless one is the `expression` to be read.
    """
    first = columns[0]
    place = plain_unit(first.unit) in LENGTHS if first.unit else _PLACE.fullmatch(first.expression)
    curves = any(c.expression == _CURVE for c in columns) or _told_apart(columns) != columns
    return bool(place) and (expression is not None or not curves)


def _told_apart(columns: list[Column]) -> list[Column]:
    """Columns of one name, as the curves of a plot have, with numbers: 'p', 'p (2)'."""
    seen: Counter[str] = Counter()
    out = []
    for column in columns:
        name = column.expression
        seen[name] += not column.parameters
        again = seen[name] > 1 and not column.parameters
        out.append(replace(column, expression=f"{name} ({seen[name]})") if again else column)
    return out


def _with_length_unit(source: Source, columns: list[Column]) -> list[Column]:
    """The file's unit of length on the first column, if that has a coordinate's name."""
    first, stated = columns[0], source.meta.get("length unit", "null")
    if first.unit or stated in ("", "null") or not _PLACE.fullmatch(first.expression):
        return columns
    return [replace(first, unit=stated), *columns[1:]]


def _coordinate(source: Source, line: int, column: Column, value: np.ndarray, factor: float) -> np.ndarray:
    if column.unit:
        if plain_unit(column.unit) not in LENGTHS:
            source.refuse(line, f"a unit of length for {column.expression}", repr(column.unit))
        factor = LENGTHS[plain_unit(column.unit)]
        source.meta["length unit"] = column.unit
    if np.iscomplexobj(value) or not np.all(np.isfinite(value)):
        source.refuse(None, f"finite real positions in column {column.expression}", "NaN, infinite or complex ones")
    return value * factor


def _check_nodes(source: Source, points: int) -> None:
    """The header's count of nodes shows a file that was cut off."""
    stated = source.count("nodes")
    if stated is not None and stated != points:
        source.refuse(None, f"{stated} points, as '% Nodes' states (was the file cut off?)", f"{points}")


def _check_expressions(source: Source, columns: int, dimension: int) -> None:
    stated = source.count("expressions")
    if stated is not None and stated not in (columns, columns - dimension):
        warnings.warn(
            f"{source.path}: '% Expressions' states {stated} columns of values, there are {columns - dimension}",
            stacklevel=4,
        )


@dataclass
class _Section:
    line: int
    kind: str
    label: str
    rows: list[tuple[int, str]] = field(default_factory=list)


def _sections(source: Source) -> list[_Section]:
    """Sections of a grid or sectionwise file; a comment below '% Data' is its label, or starts the next data."""
    out: list[_Section] = []
    comments = [(n, f"% {text}") for n, text in source.header]
    for n, text in (*comments, *source.body):
        name = text.lstrip("%").strip()
        if not text.startswith("%"):
            out[-1].rows.append((n, text))
        elif m := SECTION.fullmatch(name):
            label = m[2].strip()
            out.append(_Section(n, m[1].lower(), label[1:-1] if re.fullmatch(r"\(.*\)", label) else label))
        elif out and out[-1].kind == "data" and name:
            if out[-1].rows:
                out.append(_Section(n, "data", name))
            else:
                out[-1].label = name
    for section in out:
        if not section.rows:
            source.refuse(section.line, f"rows of numbers below '% {section.kind.capitalize()}'", "none")
    return out


def _data_sections(source: Source, sections: list[_Section], kind: str) -> tuple[list[_Section], list[Column]]:
    """The sections of values and what they hold; refused where an axis or the values are missing."""
    data = [s for s in sections if s.kind == "data"]
    if not data or sum(s.kind == kind for s in sections) != 1:
        source.refuse(
            None,
            f"one section '% {kind.capitalize()}' and then '% Data'",
            ", ".join(f"'% {s.kind.capitalize()}'" for s in sections),
        )
    if len(data) == 1 and not data[0].label:
        warnings.warn(f"{source.path}: does not name its data, pressure in Pa taken", stacklevel=5)
        return data, [Column("p", "Pa", ())]
    for s in data:
        if not s.label:
            source.refuse(s.line, "the name of the data, '% Data (acpr.p_t (Pa))'", "none")
    return data, [parse_column(source, s.line, s.label) for s in data]


def _matrix(source: Source, section: _Section, width: int | None) -> np.ndarray:
    """A section's rows as an array (row, column)."""
    rows = split_rows(source, section.rows, find_delimiter(section.rows[0][1]), width)
    lines = [n for n, _ in section.rows]
    return np.stack([to_numbers(source, lines, list(cells)) for cells in zip(*rows, strict=True)], axis=-1)


def read_grid(source: Source, factor: float) -> Table:
    """'% Grid': a row for each axis. '% Data': the first axis runs along a row, the second down the rows."""
    sections = _sections(source)
    data, columns = _data_sections(source, sections, "grid")
    grid = next(s for s in sections if s.kind == "grid")
    axes = []
    for row in grid.rows:
        positions = _matrix(source, _Section(row[0], "grid", "", [row]), None)[0]
        if np.iscomplexobj(positions) or not np.all(np.isfinite(positions)) or np.any(np.diff(positions) <= 0):
            source.refuse(row[0], "an axis of finite, strictly increasing positions", short(row[1]))
        axes.append(positions * factor)
    _check_dimension(source, grid, len(axes))
    height = int(np.prod([a.size for a in axes[1:]]))
    values = []
    for section in data:
        if len(section.rows) != height:
            source.refuse(
                section.line, f"{height} rows of data, one for each point of the other axes", f"{len(section.rows)}"
            )
        values.append(_matrix(source, section, axes[0].size).ravel())
    _check_nodes(source, values[0].size)
    mesh = np.meshgrid(*axes[::-1], indexing="ij")[::-1]
    return Table(source, {n: m.ravel() for n, m in zip("xyz", mesh, strict=False)}, columns, values)


def read_sections(source: Source, factor: float) -> Table:
    """'% Coordinates', '% Elements' (one-based corners) and '% Data', a column for each expression."""
    sections = _sections(source)
    data, columns = _data_sections(source, sections, "coordinates")
    nodes = next(s for s in sections if s.kind == "coordinates")
    points = _matrix(source, nodes, None)
    _check_dimension(source, nodes, points.shape[1])
    if np.iscomplexobj(points) or not np.all(np.isfinite(points)):
        source.refuse(nodes.line, "finite real coordinates", "NaN, infinite or complex ones")
    _check_nodes(source, len(points))
    values = []
    for section in data:
        if len(section.rows) != len(points):
            source.refuse(section.line, f"{len(points)} values, one for each node", f"{len(section.rows)}")
        values.append(_matrix(source, section, 1)[:, 0])
    elements = _read_elements(source, [s for s in sections if s.kind == "elements"], len(points))
    coordinates = {n: c * factor for n, c in zip("xyz", points.T, strict=False)}
    return Table(source, coordinates, columns, values, elements)


def _check_dimension(source: Source, section: _Section, count: int) -> None:
    stated = source.count("dimension")
    if count > 3 or (stated is not None and count != stated):
        source.refuse(section.line, f"{stated or 'one to three'} coordinates", f"{count}")


def _read_elements(source: Source, sections: list[_Section], nodes: int) -> np.ndarray | None:
    """Corners of the elements, counted from 0; None without elements, or with elements of several shapes."""
    blocks = []
    for section in sections:
        corners = _matrix(source, section, None)
        whole = not np.iscomplexobj(corners) and np.all(corners == np.floor(corners))
        if not whole or corners.min() < 1 or corners.max() > nodes:
            source.refuse(section.line, f"numbers of nodes from 1 to {nodes} in the elements", "others")
        blocks.append(corners.astype(int) - 1)
    stated, count = source.count("elements"), sum(len(block) for block in blocks)
    if stated is not None and stated != count:
        warnings.warn(f"{source.path}: '% Elements' states {stated} elements, there are {count}", stacklevel=4)
    return np.concatenate(blocks) if len({f.shape[1] for f in blocks}) == 1 else None


#: First section of the header -> reader.
READERS = {"grid": read_grid, "coordinates": read_sections}
