"""The names of columns: 'acpr.p_t (Pa) @ 1: freq=2.5 kHz, theta=45 deg', and where one ends and the next starts."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .text import QUANTITIES, Source, as_complex, plain_unit

ASSIGNED = re.compile(r"\s*[A-Za-z_]\w*\s*(?:\[[^\]]*\])?\s*=(?!=)")


@dataclass(frozen=True)
class Column:
    """One column of values: an expression at one combination of parameters (name, value, unit)."""

    expression: str
    unit: str
    parameters: tuple[tuple[str, Any, str], ...]


def _pieces(text: str, delimiter: str) -> Iterator[str]:
    """Parts of a line between delimiters that stand outside of brackets and quotes."""
    depth, quoted, start = 0, False, 0
    for k, char in enumerate(text):
        quoted ^= char == '"'
        depth += (char in "([") - (char in ")]")
        if not quoted and depth <= 0 and (char.isspace() if delimiter == " " else char == delimiter):
            yield text[start:k].strip().strip('"').strip()
            start = k + 1
    yield text[start:].strip().strip('"').strip()


def column_names(text: str, delimiter: str) -> list[str]:
    """The columns' names of a header line, each one whole: 'acpr.p_t (Pa) @ freq=100, theta=0'."""
    pieces = [p for p in _pieces(text, delimiter) if p]
    if delimiter == " ":
        return list(_join_tokens(pieces))
    names: list[str] = []
    for piece in pieces:
        if names and "@" in names[-1] and ASSIGNED.match(piece):
            names[-1] += f", {piece}"
        else:
            names.append(piece)
    return names


def _join_tokens(tokens: list[str]) -> Iterator[str]:
    """Whole names from words: an expression, its (unit), and after @ its parameters, parted by commas."""
    name: list[str] = []
    for k, token in enumerate(tokens):
        if name and _ends_name(name, token, tokens[k + 1] if k + 1 < len(tokens) else ""):
            yield " ".join(name)
            name = []
        name.append(token)
    if name:
        yield " ".join(name)


def _ends_name(name: list[str], token: str, following: str) -> bool:
    """Whether `token` starts another name than the words so far."""
    last = name[-1]
    if token == "@" or last in ("@", "+", "-", "*", "/", "=") or last.endswith((",", "=")) or token[0] in "=[":
        return False
    if "@" not in name:
        # an operator carries an expression on; a unit follows a name that has none yet
        return not (token in ("+", "-", "*", "/") or (token[0] == "(" and not last.startswith("(")))
    if re.fullmatch(r"\d+:", last):
        return False
    unit = plain_unit(token.rstrip(","))
    return not (
        any(unit in known for _, known in QUANTITIES)
        and "=" in last
        and (token.endswith(",") or not following.startswith(("(", "@")))
    )


def parse_column(source: Source, line: int, name: str) -> Column:
    """Parse 'expression (unit) @ 1: freq=2.5[kHz], theta=45 deg'."""
    head, _, tail = name.partition("@")
    head, unit = _split_unit(head.strip())
    tail = re.sub(r"^\s*\d+\s*(:|$)", "", tail)
    parameters = []
    for text in re.split(rf",(?={ASSIGNED.pattern})", tail) if tail.strip() else []:
        if not ASSIGNED.match(text):
            source.refuse(line, "parameters such as 'freq=100, theta=0' after @", repr(text.strip()))
        parameters.append(_parameter(*text.split("=", 1)))
        if isinstance(value := parameters[-1][1], str) and "inf" not in value.lower() and _overflows(value):
            source.refuse(line, "numbers within 1e308, as doubles are", repr(text.strip()))
    if not head:
        source.refuse(line, "an expression in each column's name", repr(name))
    return Column(head, unit, tuple(parameters))


def parse_title(source: Source, line: int, name: str) -> Column:
    """Parse the title of a table's column, 'Total pressure (Pa), Point: (0.1, 0)': the point is part of what is evaluated."""
    head, point, where = name.partition(", Point:")
    column = parse_column(source, line, head)
    return replace(column, expression=f"{column.expression}{point}{where}")


def _split_unit(text: str) -> tuple[str, str]:
    """'abs(p) (Pa)' -> 'abs(p)', 'Pa': the last bracket is a unit where a blank stands before it."""
    depth = 0
    for k in range(len(text) - 1, -1, -1):
        depth += (text[k] == ")") - (text[k] == "(")
        if depth == 0:
            if text.endswith(")") and k > 0 and text[k - 1].isspace():
                return text[:k].strip(), text[k + 1 : -1].strip()
            break
    return text, ""


def _parameter(name: str, text: str) -> tuple[str, Any, str]:
    """Name, value and unit of 'freq', '2.5[kHz]' or '2.5 kHz' or '2.5'; also of 'freq[kHz]', '2.5'."""
    name, _, unit = name.strip().partition("[")
    text, m = text.strip(), re.fullmatch(r"(.+?)\s*\[([^\]]*)\]", text.strip())
    if m:
        text, unit = m[1], m[2]
    elif " " in text and is_number(text.split()[0]):
        text, _, unit = text.partition(" ")
    number = text.replace(",", ".")
    value = as_complex(number) if is_number(number) else text.strip("'\"")
    return name.strip(), value.real if isinstance(value, complex) and not value.imag else value, unit.strip(" ]")


def _overflows(text: str) -> bool:
    """Whether a text is a number in digits that no double holds: 1e400, with a unit or without."""
    try:
        return bool(re.match(r"[-+\d.,]", text)) and bool(np.isinf(as_complex(text.split()[0].replace(",", "."))))
    except ValueError:
        return False


def is_number(text: str) -> bool:
    """Whether a text is a number."""
    try:
        return bool(np.isfinite(as_complex(text.replace(",", "."))))
    except ValueError:
        return False
