"""The rows as Markdown, and what counts as drift between two prints of them."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable

from .records import Row, Section

HEAD = "| quantity | source | beamprop | reference | difference | tolerance | share |\n|---|---|---|---|---|---|---|"
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]\d+)?")


def digits_of(row: Row) -> int:
    """Significant digits that show a difference which does not change with the machine: 6 to 9."""
    return (
        6
        if row.moves or not math.isfinite(row.difference)
        else min(9, max(6, 2 - math.floor(math.log10(row.difference))))
    )


def value_text(value: complex, size: float, digits: int) -> str:
    """A number to `digits` digits; parts of no account beside the size are 0."""
    value = complex(value)
    real, imag = (0.0 if abs(part) < 0.5 * 10**-digits * size else part for part in (value.real, value.imag))
    if not imag:
        return f"{real:#.{digits}g}" if real else "0"
    if not real:
        return f"{imag:#.{digits}g}i"
    # both parts to the same decimal, that of the last digit of the size, which may be 1 but for rounding
    decimals = max(0, digits - 1 - math.floor(math.log10(size * (1 + 1e-9))))
    return f"{real:.{decimals}f}{imag:+.{decimals}f}i" if decimals < 10 else f"{real:.5e}{imag:+.5e}i"


def class_text(value: float, classes: Iterable[float], form: str) -> str:
    """The smallest class that a value lies below, as "< class"."""
    return "< " + form.format(next(c for c in classes if value < c))


def difference_text(row: Row) -> str:
    """Two digits, or the decade of what changes with the machine."""
    if row.moves and row.difference < 1:
        return class_text(row.difference, (10.0**-n for n in range(14, -1, -1)), "{:.0e}")
    return f"{row.difference:.1e}"


def share_text(row: Row) -> str:
    """Whole percent; a class where the difference is printed as a class, or the share is small."""
    if row.refuted:
        return "does not hold"
    if row.share < 0.01 or (row.moves and row.share <= 1):
        return class_text(100 * row.share, (1, 10, 100.1), "{:.0f} %")
    return f"{100 * row.share:.0f} %"


def row_text(row: Row) -> str:
    """A line of the table."""
    size = abs(row.reference) or row.scale
    ours, reference = (value_text(v, size, digits_of(row)) for v in (row.ours, row.reference))
    tolerance = f"{row.tolerance.value:.1e}, {row.tolerance.reason}"
    cells = (row.quantity, row.source, ours, reference, difference_text(row), tolerance, share_text(row))
    return "| " + " | ".join(cells) + " |"


def page_text(answers: list[tuple[Section, list[Row]]]) -> str:
    """All sections, after a table of how many rows each has."""
    rows = [row for _, part in answers for row in part]
    nearest = max((row for row in rows if not row.moves and not row.refuted), key=lambda row: row.share)
    lines = ["| section | rows |", "|---|---|", *(f"| {section.title} | {len(part)} |" for section, part in answers)]
    refuted = sum(row.refuted for row in rows)
    lines += [
        f"| all | {len(rows)} |",
        "",
        f"{len(rows) - refuted} rows hold, {refuted} statements of a source do not. ",
    ]
    lines[-1] += f"The row nearest to its tolerance uses {share_text(nearest)} of it: {nearest.quantity}."
    for section, part in answers:
        lines += ["", f"### {section.title}", "", section.text, "", HEAD, *map(row_text, part)]
    return "\n".join(lines)


def unit(number: str) -> float:
    """One unit of the last digit of a printed number."""
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def agree(stored: str, fresh: str) -> bool:
    """Whether two cells say the same: words alike, numbers within a unit of their last digit, classes as they come."""
    if stored == fresh or (stored.startswith("<") and fresh.startswith("<")):
        return True
    if NUMBER.sub("#", stored) != NUMBER.sub("#", fresh):
        return False
    pairs = zip(NUMBER.findall(stored), NUMBER.findall(fresh), strict=True)
    return all(abs(float(a) - float(b)) <= 1.01 * min(unit(a), unit(b)) for a, b in pairs)


def same_line(stored: str, fresh: str) -> bool:
    """Whether two lines agree: rows of a comparison by the cells behind quantity and source, all else to the letter."""
    a, b = stored.split(" | "), fresh.split(" | ")
    if len(a) != 7 or len(b) != 7:
        return stored == fresh
    return a[:2] == b[:2] and all(map(agree, a[2:], b[2:]))


def drift(stored: str, fresh: str) -> list[str]:
    """Lines of two pages that do not agree, as "- stored" and "+ fresh"."""
    pairs = itertools.zip_longest(stored.splitlines(), fresh.splitlines(), fillvalue="")
    return [line for a, b in pairs if not same_line(a, b) for line in (f"- {a}", f"+ {b}")]
