"""Is every term of the error estimate needed? Each is switched off in turn, and questions are sought that it alone decides.

A term is a line of the package's source: the function that holds it is compiled again with the line changed. Most terms make the
estimate larger, and are needed if without them it falls below a third of the true error somewhere, or if the search for a contour
does not reach rtol without what they tell; those that make it smaller are needed if without them a right field is warned of.
"""

from __future__ import annotations

import importlib
import inspect
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import NamedTuple

import numpy as np

import beamprop as bp

from ..case import Case
from ..cases.built import (
    BLACK,
    CANCELLED,
    FAR,
    MIXED,
    SHADOW,
    WALL,
    Among,
    coarse_profiles,
    cones,
    first_numbers,
    tilted_plateaus,
)
from ..cases.numbering import angles_of, make_case, map_of
from ..reference.quadrature import Truth
from ..reference.real_axis import LAUNCHED, STEPPED, as_launched, on_the_axis
from .comparison import compared_with, error_of


class Term(NamedTuple):
    """One term: where it stands, what it reads without it, and the questions that may need it."""

    name: str
    module: str
    function: str
    line: str
    without: str
    candidates: tuple[object, ...]  #: numbers of cases, or questions built for it
    larger: bool = True  #: whether the term makes the estimate larger


#: Every term of the estimate. Where the package's line changes, it changes here.
TERMS = [
    Term(
        "difference of two contours", "contour.error_estimate", "_difference",
        "np.max(np.abs(a - b), axis=2)", "0 * np.max(np.abs(a - b), axis=2)", tuple(range(15)),
    ),
    Term(
        "rounding of a profile's samples", "contour.error_estimate", "_difference", "+ source) / scale", "+ 0 * source) / scale", (CANCELLED,),
    ),
    Term(
        "what lies beyond the band", "contour.error_estimate", "_beyond",
        "return 2 * last * ratio / (1 - ratio)", "return 0 * last", tuple(cones()),
    ),
    Term(
        "a spectrum that is cut off", "contour.error_estimate", "_difference", "error += cut / scale", "error += 0 * cut / scale",
        tuple(coarse_profiles()),
    ),
    Term(
        "mixing of angles", "contour.error_estimate", "_difference", "error += 3 *", "error += 0 *", (MIXED,),
    ),
    Term(
        "planes made of a few", "fields.evaluate", "_fill_low_rank", "return error", "return 0 * error", tuple(range(1, 600, 5)),
    ),
    Term(
        "rounding of long phases", "contour.error_estimate", "_difference",
        "return worst + paths.EPS * (4 + checks.k0 * way)", "return worst + 0 * way", tuple(tilted_plateaus()),
    ),
    Term(
        "second response moved in its last bits", "contour.error_estimate", "sampled", "SHIFT if moved else 0.0", "0.0",
        (*first_numbers("sharp resonances", 20), *first_numbers("LMMD, 1 or 100 000 periods", 20)),
    ),
    Term(
        "brightness outside the window", "contour.error_estimate", "_difference",
        "largest = np.maximum(largest, checks.peaks_outside)", "largest = largest * 1.0", (FAR,), False,
    ),
    Term(
        "planes too dark to be seen", "contour.error_estimate", "_difference", "seen = largest > DARK", "seen = largest > -1.0", (SHADOW, BLACK), False,
    ),
    Term(
        "planes dark to rounding", "contour.error_estimate", "_difference", "(largest > DARK) & ~checks.dark", "(largest > DARK)", (WALL,), False,
    ),
]  # fmt: skip


@contextmanager
def switched_off(term: Term) -> Iterator[None]:
    """The package without a term."""
    module: ModuleType = importlib.import_module(f"beamprop.{term.module}")
    kept = getattr(module, term.function)
    source = inspect.getsource(kept)
    if source.count(term.line) != 1:
        raise LookupError(
            f"{term.module}.{term.function}: expected one line {term.line!r}, found {source.count(term.line)}"
        )
    changed: dict[str, object] = {}
    exec(compile(source.replace(term.line, term.without), module.__file__ or "", "exec"), vars(module), changed)
    setattr(module, term.function, changed[term.function])
    try:
        yield
    finally:
        setattr(module, term.function, kept)


class Evidence(NamedTuple):
    """What a question says of a term."""

    number: object
    error: float
    estimate: float
    without: float  #: the estimate without the term
    needed: bool


class _Question(NamedTuple):
    """A case, and what is asked for with it."""

    case: Case
    x: np.ndarray
    z: np.ndarray
    angles: np.ndarray | None


def _question(candidate: object) -> _Question:
    if isinstance(candidate, int):
        case = make_case(candidate)
        return _Question(case, *map_of(candidate, case), angles_of(candidate, case))
    if isinstance(candidate, Among):
        return _Question(candidate.case, candidate.case.x, candidate.case.z, candidate.angles)
    assert isinstance(candidate, Case)
    return _Question(candidate, candidate.x, candidate.z, None)


def _truth(case: Case, goal: float) -> tuple[Truth | str, np.ndarray]:
    """The truth, and at which of the case's positions."""
    every = np.arange(case.x.size)
    if case.kind == STEPPED:
        return on_the_axis(case), every
    if case.kind == LAUNCHED:
        return as_launched(case), every
    return compared_with(case, goal)


def _estimate(question: _Question) -> tuple[np.ndarray, float] | None:
    """The package's p at the case's own positions and its estimate; None where it refuses."""
    case, x, z, angles = question
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            ds = bp.field(case.slab, case.beam, case.frequency, x, z, angle=angles, rtol=case.rtol)
        except ValueError:
            return None
    ds = ds if angles is None else ds.isel(angle=int(np.flatnonzero(angles == case.beam.angle)[0]))
    p = ds.p.values.reshape(z.size, x.size)[np.searchsorted(z, case.z)][:, np.searchsorted(x, case.x)]
    return p, float(ds.error_estimate)


def tried(term: Term, candidate: object) -> Evidence | None:
    """One question with and without a term; None where there is no truth or no answer."""
    question = _question(candidate)
    case = question.case
    whole = _estimate(question)
    with switched_off(term):
        without = _estimate(question)
    label = candidate if isinstance(candidate, int) else "built"
    if whole is not None and without is None and not term.larger:  # what is answered, is refused without it
        return Evidence(label, np.nan, whole[1], np.inf, whole[1] <= case.rtol)
    if whole is None or without is None:
        return None
    if term.larger and whole[1] <= case.rtol < without[1]:  # the search needs it
        return Evidence(label, np.nan, whole[1], without[1], True)
    if term.larger and without[1] > 0.9 * whole[1]:
        return None
    truth, positions = _truth(case, max(without[1], 1e-16))
    if isinstance(truth, str):
        return None
    error, unknown = error_of(without[0][:, positions], truth)
    if term.larger:
        needed = error - unknown > 3 * max(without[1], unknown)
    else:
        needed = error + unknown < case.rtol / 3 and not without[1] <= case.rtol
    return Evidence(label, error, whole[1], without[1], needed)


def decided(term: Term, candidates: Iterable[object] | None = None) -> Evidence | None:
    """The first question that needs a term, or the one that came nearest; None where no question was changed by it."""
    nearest: Evidence | None = None
    for candidate in term.candidates if candidates is None else candidates:
        evidence = tried(term, candidate)
        if evidence is None:
            continue
        if evidence.needed:
            return evidence
        if nearest is None or evidence.error / max(evidence.without, 1e-17) > nearest.error / max(
            nearest.without, 1e-17
        ):
            nearest = evidence
    return nearest


def term_table() -> str:
    """Every term, and the question that needs it."""
    lines = ["| term | case | true error | estimate | without it | needed |", "|---" * 6 + "|"]
    for term in TERMS:
        try:
            evidence = decided(term)
        except LookupError as gone:
            lines.append(f"| {term.name} | | | | | the package has no such line: {gone} |")
            continue
        if evidence is None:
            lines.append(f"| {term.name} | none changed | | | | NO |")
            continue
        says = "yes" if evidence.needed else "not shown"
        lines.append(
            f"| {term.name} | {evidence.number} | {evidence.error:.1e} | {evidence.estimate:.1e} | {evidence.without:.1e} | {says} |"
        )
    return "\n".join(lines)
