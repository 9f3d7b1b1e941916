"""The choice of a contour in stretches: panels are shortened, or the band is widened, until two of them agree."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from . import error, stretches
from .paths import Contour
from .quadrature import Quadrature
from .search import MOST_PLANE_WAVES, Search, refusal, too_many

#: How often a contour in stretches is planned again: each has shorter panels and another depth, or a wider band. A
#: band may so grow by 1.5^6 = 11, or panels be shortened by 1.4^6 = 7.5.
TRIES = 7


class Tried(NamedTuple):
    """The best of the contours in stretches that were tried, if any served, and whether poles were unclear."""

    best: Quadrature | None
    unclear: bool


def quadrature_in_stretches(search: Search, crowded: bool) -> Quadrature:
    """A contour in stretches, or the refusal of a question for which there is none.

    `crowded` says whether the slab guides more modes than can be told apart: its bands say where the contour passes then.
    """
    best, unclear = best_in_stretches(search, crowded)
    if best is None:
        raise ValueError(refusal(search) if unclear else too_many(search.rtol))
    if crowded and best.worst > 1:  # no digit is known
        raise ValueError(refusal(search))
    return best


def best_in_stretches(search: Search, crowded: bool) -> Tried:
    """Shorten the panels, or widen the band where its edge is what is missing, until two contours in stretches agree."""
    s, checks, rtol = search.slab, search.checks, search.rtol
    plan, closed = _first_plan(search)
    best, unclear, in_vain = None, False, 0
    for _ in range(TRIES):
        pair = stretches.pair_of_contours(s, search.extent, plan, search.start, crowded, search.ends, closed)
        if pair is None:
            plan, unclear = plan._replace(depth=plan.depth / 3, height=plan.height / 3), True
            continue
        if _size(pair) > MOST_PLANE_WAVES:
            break
        first, _, found, checks = error.compare(checks, pair, rtol)
        in_vain = in_vain + 1 if best is not None and found.worst > 0.5 * best.worst else 0
        if best is None or found.worst < best.worst:
            best = Quadrature(first.contour, found.budget, circles=True, amplitudes=first.amplitudes)
        if found.worst <= rtol or in_vain > 1:
            break
        plan = next_plan(plan, found.edge, rtol)
    return Tried(best, unclear)


def _first_plan(search: Search) -> tuple[stretches.Plan, bool]:
    """The first plan, and whether it is closed: all spectra end at the last of their ends that matter."""
    extent, ends = search.extent, search.ends
    plan = stretches.plan_stretches(extent, extent.path - search.slab.thickness, search.rtol, search.noise)
    closed = bool(ends.size) and bool(ends[-1] == np.max(search.checks.sources.spectrum_ends(search.slab.k0)))
    return (plan._replace(band=1.01 * float(ends[-1])) if closed else plan), closed


def next_plan(plan: stretches.Plan, edge: float, rtol: float) -> stretches.Plan:
    """The plan to try after one that does not keep rtol; `edge` is what lies beyond its end, over the largest |p|."""
    if edge > 0.3 * rtol:
        return plan._replace(band=plan.band * 1.5)
    return plan._replace(depth=plan.depth * 0.7, height=plan.height * 0.75, finer=plan.finer * 1.4)


def _size(pair: tuple[Contour, Contour]) -> int:
    return max(contour.k.size for contour in pair)
