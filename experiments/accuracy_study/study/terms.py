"""Is every term of the error estimate needed? Each is switched off in turn, and questions are sought that it alone decides.

A term of the error budget is set to zero in what the function that makes budgets answers; the other terms are constants or answers of
functions, which are replaced. Most terms make the estimate larger, and are needed if without them it falls below a third of the true
error somewhere, or if the search for a contour does not reach rtol without what they tell; those that make it smaller are needed if without them a right field is warned of.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

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
    """One term: the name in the package that holds it, what stands there without it, and the questions that may need it."""

    name: str
    module: str
    attribute: str
    without: Callable[[Any], Any]  #: of what stands there
    candidates: tuple[object, ...]  #: numbers of cases, or questions built for it
    larger: bool = True  #: whether the term makes the estimate larger


def term_of_budget(term: str) -> Callable[[Any], Any]:
    """The function that makes budgets with one term set to zero."""

    def without(terms: Any) -> Any:
        def changed(*given: Any) -> Any:
            estimate = terms(*given)
            return estimate._replace(budget=estimate.budget._replace(**{term: 0 * estimate.budget.long_phases}))

        return changed

    return without


def _nothing_beyond(beyond: Any) -> Any:
    return lambda contour: np.zeros_like(beyond(contour))


def _no_low_rank(fill_low_rank: Any) -> Any:
    def changed(*given: Any) -> Any:
        error = fill_low_rank(*given)
        return None if error is None else 0 * error

    return changed


def _not_moved(sampled: Any) -> Any:
    return lambda checks, contour, moved: sampled(checks, contour, False)


def _no_peaks_outside(largest: Any) -> Any:
    return lambda checks, *fields: largest(checks._replace(peaks_outside=0.0), *fields)


def _none_dark(with_dark_planes: Any) -> Any:
    def changed(checks: Any) -> Any:
        checks = with_dark_planes(checks)
        return checks._replace(dark=np.zeros_like(checks.dark))

    return changed


#: Every term of the estimate. The end of the band is also what a search widens its band by: nothing is known of it without the term.
TERMS = [
    Term("difference of two contours", "contour.error", "terms_by_plane", term_of_budget("difference"), tuple(range(15))),
    Term("rounding of a profile's samples", "contour.error", "terms_by_plane", term_of_budget("samples_rounding"), (CANCELLED,)),
    Term("what lies beyond the band", "contour.error", "_beyond", _nothing_beyond, tuple(cones())),
    Term("a spectrum that is cut off", "contour.error", "terms_by_plane", term_of_budget("cut_spectrum"), tuple(coarse_profiles())),
    Term("interpolation over angles", "contour.error", "terms_by_plane", term_of_budget("angle_interpolation"), (MIXED,)),
    Term("planes by low rank", "fields.evaluate", "_fill_low_rank", _no_low_rank, tuple(range(1, 600, 5))),
    Term("rounding of long phases", "contour.error", "terms_by_plane", term_of_budget("long_phases"), tuple(tilted_plateaus())),
    Term(
        "second response moved in its last bits", "contour.error", "sampled", _not_moved,
        (*first_numbers("sharp resonances", 20), *first_numbers("LMMD, 1 or 100 000 periods", 20)),
    ),
    Term("peaks outside the window", "contour.error", "_largest", _no_peaks_outside, (FAR,), False),
    Term("planes too dark to be seen", "contour.error", "DARK", lambda _: -1.0, (SHADOW, BLACK), False),
    Term("planes dark to rounding", "contour.error", "with_dark_planes", _none_dark, (WALL,), False),
]  # fmt: skip


@contextmanager
def switched_off(term: Term) -> Iterator[None]:
    """The package without a term."""
    module = importlib.import_module(f"beamprop.{term.module}")
    kept = getattr(module, term.attribute)
    setattr(module, term.attribute, term.without(kept))
    try:
        yield
    finally:
        setattr(module, term.attribute, kept)


class Evidence(NamedTuple):
    """What a question says of a term."""

    number: object
    error: float
    estimate: float
    without: float  #: the estimate without the term
    needed: bool


class _Question(NamedTuple):
    """A case, and what is requested with it."""

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
        evidence = decided(term)
        if evidence is None:
            lines.append(f"| {term.name} | none changed | | | | NO |")
            continue
        says = "yes" if evidence.needed else "not shown"
        lines.append(
            f"| {term.name} | {evidence.number} | {evidence.error:.1e} | {evidence.estimate:.1e} | {evidence.without:.1e} | {says} |"
        )
    return "\n".join(lines)
