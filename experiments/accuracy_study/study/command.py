"""The study's command line."""

from __future__ import annotations

import argparse
import itertools
from pathlib import Path

import xarray as xr
from common import save_all, table

from ..cases.numbering import CASES, KINDS, numbers_of, quick_numbers
from ..cases.solid import SOLID
from . import in_space, report
from .comparison import study
from .limit import limit_table, limiting_absorption
from .terms import term_table


def compute(quick: bool = False, workers: int = 2) -> dict[str, xr.Dataset]:
    """The study and the sequence of losses."""
    numbers = quick_numbers() if quick else range(CASES)
    return {"cases": study(numbers, workers), "limit": limiting_absorption(40 if quick else 450)}


def arguments(text: str) -> argparse.Namespace:
    """--quick for a few cases, --class and --count for those of one class, --case for single ones."""
    parser = argparse.ArgumentParser(description=text.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few cases: a check that everything runs")
    parser.add_argument("--output", type=Path, default=Path("results"), help="folder for data and pictures")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument(
        "--class", dest="kind", action="append", choices=[*KINDS, "all"], help="cases of this class alone"
    )
    parser.add_argument("--count", type=int, default=40, help="how many of each class")
    parser.add_argument(
        "--skip", type=int, default=0, help="how many of each class, or in three dimensions, to pass over"
    )
    parser.add_argument("--case", type=int, action="append", help="the case of this number alone")
    parser.add_argument("--space", type=int, metavar="COUNT", help="so many fields in three dimensions alone")
    parser.add_argument("--solids", type=int, metavar="COUNT", help="so many cases of each class with solids alone")
    parser.add_argument("--terms", action="store_true", help="whether every term of the error estimate is needed")
    return parser.parse_args()


def chosen(options: argparse.Namespace) -> list[int]:
    """Numbers of the cases of the requested classes, and those requested by number."""
    kinds = KINDS if "all" in (options.kind or []) else options.kind or []
    of_each = (itertools.islice(numbers_of(kind), options.skip, options.skip + options.count) for kind in kinds)
    return [*itertools.chain(*of_each), *(options.case or [])]


def main(text: str) -> None:
    """Run the requested cases and print them."""
    options = arguments(text)
    if options.terms:
        print(term_table())
        return
    if options.space:
        print(in_space.summary(in_space.study(range(options.skip, options.skip + options.space), options.workers)))
        return
    if options.solids:
        options.kind, options.count = list(SOLID), options.solids
    if options.kind or options.case:
        ds = study(chosen(options), options.workers)
        print(report.class_table(ds), report.reasons(ds), report.faults(ds), sep="\n\n")
        return
    data = compute(options.quick, options.workers)
    cases, limit = data["cases"], data["limit"]
    print(report.class_table(cases), report.reasons(cases), limit_table(limit), sep="\n\n", end="\n\n")
    save_all("accuracy", options.output, data, report.plot(cases))
    print(table(report.statements(cases, limit.apart.values)))
