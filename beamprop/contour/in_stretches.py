"""The choice of a contour in stretches: panels are shortened, or the band is widened, until two contours agree."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from . import error, stretches
from .quadrature import Quadrature
from .search import MOST_PLANE_WAVES, Search, refusal, too_many

#: The most plans that are tried, each with shorter panels and another depth, or a wider band, than the one before: after seven the band
#: may have grown by 1.5^6 = 11, or panels be shorter by 1.4^6 = 7.5.
TRIES = 7


class Tried(NamedTuple):
    """The most accurate contour in stretches that was tried, and whether poles could not be told apart for any."""

    best: Quadrature | None
    unclear: bool


def quadrature_in_stretches(search: Search, crowded: bool) -> Quadrature:
    """A contour in stretches, or the refusal of a question for which there is none.

    `crowded` says whether the slab guides more modes than can be told apart, so that its bands decide where the contour passes.
    """
    best, unclear = best_in_stretches(search, crowded)
    if best is None:
        raise ValueError(refusal(search) if unclear else too_many(search))
    if crowded and best.worst > 1:  # not a digit is right
        raise ValueError(refusal(search))
    return best


def best_in_stretches(search: Search, crowded: bool) -> Tried:
    """Shorten the panels, or widen the band where its edge is what is missing, until two contours in stretches agree."""
    checks, rtol = search.checks, search.rtol
    plan = _first_plan(search)
    best, unclear, in_vain = None, False, 0
    for _ in range(TRIES):
        pair = stretches.pair_of_contours(search, plan, crowded)
        if pair is None:
            plan, unclear = plan._replace(depth=plan.depth / 3, height=plan.height / 3), True
            continue
        if max(contour.k.size for contour in pair) > MOST_PLANE_WAVES:
            break
        first, _, estimate, checks = error.compare(checks, pair, rtol)
        in_vain = in_vain + 1 if best is not None and estimate.worst > 0.5 * best.worst else 0
        if best is None or estimate.worst < best.worst:
            best = Quadrature(first.contour, estimate.budget, circles=True, amplitudes=first.amplitudes)
        if estimate.worst <= rtol or in_vain > 1:
            break
        plan = next_plan(plan, estimate.edge, rtol)
    return Tried(best, unclear)


def _first_plan(search: Search) -> stretches.Plan:
    """The first plan; closed if all spectra vanish beyond the last end of those that are cut off."""
    extent, ends = search.extent, search.ends
    plan = stretches.plan_stretches(extent, extent.path - search.slab.thickness, search.rtol, search.noise)
    closed = bool(ends.size) and bool(ends[-1] == np.max(search.checks.sources.spectrum_ends(search.slab.k0)))
    return plan._replace(band=1.01 * float(ends[-1]), closed=True) if closed else plan


def next_plan(plan: stretches.Plan, edge: float, rtol: float) -> stretches.Plan:
    """The plan to try after one that does not keep rtol; `edge` is what lies beyond its end, over the largest |p|."""
    if edge > error.SHARE * rtol:
        return plan._replace(band=plan.band * 1.5)
    return plan._replace(depth=plan.depth * 0.7, height=plan.height * 0.75, finer=plan.finer * 1.4)
