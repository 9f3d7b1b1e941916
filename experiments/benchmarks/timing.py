"""How the benchmarks measure: our work and its limit in turn, medians, ratios."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

Work = Callable[[], object]


@dataclass(frozen=True)
class Row:
    """One line of the table: times in seconds (or bytes), and the largest ratio (or smallest, or time) asked for."""

    work: str
    ours: float
    limit_name: str
    limit: float
    required: str
    holds: bool | None
    unit: str = "s"

    @property
    def ratio(self) -> float:
        """Our cost over the limit's."""
        return self.ours / self.limit


def measure(*works: Work, repeats: int = 9, clock: Callable[[], float] = time.perf_counter) -> list[float]:
    """Median times of several works, run in turn so that all meet the same load; one run of each to warm up."""
    times: list[list[float]] = [[] for _ in works]
    for number in range(repeats + 1):
        for work, seconds in zip(works, times, strict=True):
            start = clock()
            work()
            if number:
                seconds.append(clock() - start)
    return [statistics.median(seconds) for seconds in times]


def process(*arguments: str) -> Work:
    """A fresh python process."""
    return lambda: subprocess.run([sys.executable, *arguments], check=True, capture_output=True)


def amount(value: float, unit: str) -> str:
    """A time or a size in readable units."""
    if unit == "B":
        return f"{value / 2**20:.1f} MiB"
    for factor, name in ((1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")):
        if value * factor >= 1:
            return f"{value * factor:.3g} {name}"
    return f"{value:.3g} s"


def table(rows: list[Row]) -> str:
    """The rows as a Markdown table."""
    lines = ["| work | ours | limit | its cost | ratio | asked | holds? |", "|---|---|---|---|---|---|---|"]
    for r in rows:
        holds = "-" if r.holds is None else "yes" if r.holds else "NO"
        ratio = f"{r.ratio:.3g}" if r.ratio > 0.1 else f"1/{1 / r.ratio:.3g}"
        lines.append(
            f"| {r.work} | {amount(r.ours, r.unit)} | {r.limit_name} | {amount(r.limit, r.unit)} | {ratio} "
            f"| {r.required} | {holds} |"
        )
    return "\n".join(lines)
