"""A row of the conformance page: our value, the reference's, what may lie between them and why."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

#: Relative differences below this are noise whatever the tolerance.
NOISE = 1e-8


@dataclass(frozen=True)
class Tolerance:
    """What a difference may be, over the row's scale, and where that comes from.

    Differences that are `noise` come from rounding, or from what a contour leaves: they change with the machine and its libraries.
    """

    value: float
    reason: str
    noise: bool = False


def rounding(times: float = 1.0) -> Tolerance:
    """Both sides are exact but for double precision: a thousand units of its last place, times the condition of the question."""
    return Tolerance(times * 1000 * 2.0**-52, "rounding", noise=True)


def requested(rtol: float) -> Tolerance:
    """The question was asked with this rtol."""
    return Tolerance(rtol, "rtol requested", noise=True)


def printed(digit: float, reference: complex) -> Tolerance:
    """Half a unit of the last digit that the source prints."""
    return Tolerance(digit / 2 / abs(reference), "printed digits")


def next_term(value: float) -> Tolerance:
    """The size, or a bound, of the first term that the reference leaves out."""
    return Tolerance(abs(value), "next term")


@dataclass(frozen=True)
class Row:
    """One comparison.

    `scale` is what the difference is taken relative to: the reference itself if it is left out, so that a reference
    of 0 needs one. A `refuted` statement of a source is shown with its difference, and must lie outside its tolerance.
    """

    quantity: str
    source: str
    ours: complex
    reference: complex
    tolerance: Tolerance
    scale: float = 0.0
    refuted: bool = False

    @property
    def difference(self) -> float:
        """|ours - reference| over the scale."""
        return abs(self.ours - self.reference) / (self.scale or abs(self.reference))

    @property
    def share(self) -> float:
        """The difference over the tolerance; infinite where there is no number."""
        share = self.difference / self.tolerance.value
        return share if math.isfinite(share) else math.inf

    @property
    def moves(self) -> bool:
        """Whether the difference changes with the machine."""
        return self.tolerance.noise or self.difference < NOISE

    @property
    def holds(self) -> bool:
        """Whether the row is as it should be."""
        return (self.share > 1) == self.refuted


@dataclass(frozen=True)
class Section:
    """Rows that belong together: `rows` makes them, `text` says what they are."""

    title: str
    text: str
    rows: Callable[[], list[Row]]
