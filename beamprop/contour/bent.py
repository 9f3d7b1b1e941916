"""A bent contour on which the field keeps rtol: plans are changed until two contours agree.

The loop evaluates two contours and estimates the error; `next_plan`, a pure function of what came of it, says what to try next.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from . import error, in_stretches, peak_outside
from .check_points import Checks
from .error import Compared
from .paths import BentPlan
from .quadrature import Quadrature
from .search import Planned, Search, pair_of_contours, refusal, shallower, too_many, too_many_plane_waves, with_poles

#: How often a plan is changed before the requested rtol is given up: a band that grows by half each time grows 200-fold.
ATTEMPTS = 14
#: How often of these a plan comes nearer to the axis to leave fewer poles between: modes of a lossless slab lie on the axis
#: itself, and their number does not fall; with loss a depth 3^6 times smaller leaves those that are all but lossless.
SHRINKS, LOSSLESS_SHRINKS = 6, 2
#: After more plans than this in a row that do not halve the error what is left is rounding.
MOST_IN_VAIN = 3
#: The share of rtol that may lie beyond the end of the band, and that is left to images.
SHARE = 0.3
#: Above this an estimate does not say how many decades images have to fall by.
MEANINGLESS = 1e6


class Attempts(NamedTuple):
    """What came of the plans that were tried."""

    shrinks: int  #: how often a plan may still come nearer to the axis
    made: int = 0
    in_vain: int = 0  #: plans in a row, up to the last, that did not halve the smallest error

    def after(self, worst: float, smallest: float) -> Attempts:
        """With one more plan, of an error `worst`, the smallest before it being `smallest` (inf: there was none)."""
        return Attempts(self.shrinks, self.made + 1, self.in_vain + 1 if worst > 0.5 * smallest else 0)


def next_plan(plan: BentPlan, worst: float, edge: float, attempts: Attempts, rtol: float) -> BentPlan | None:
    """The plan to try after one whose contour is estimated to err by `worst`.

    Parameters
    ----------
    plan : BentPlan
    worst, edge : float
        Estimated error, and what lies beyond the end of the band, over the largest |p| of a plane.
    attempts : Attempts
        The plan's included.
    rtol : float

    Returns
    -------
    BentPlan or None
        None where rtol is kept, and where no other plan has come nearer to it for long.
    """
    if worst <= rtol or attempts.in_vain > MOST_IN_VAIN:
        return None
    if edge > SHARE * rtol:
        return plan._replace(band=plan.band * 1.5)
    if attempts.in_vain:  # a wider window does not help: rounding, magnified by exp(depth X)
        return plan._replace(depth=plan.depth * 0.6, window=plan.window * 1.3)
    more = math.log(min(worst, MEANINGLESS) / (SHARE * rtol)) / plan.depth  # images fall as exp(-depth W)
    return plan._replace(window=plan.window + min(max(more, 0.5 * plan.window), plan.window))


def quadrature_on_bent_contour(search: Search, planned: Planned) -> tuple[Quadrature, Planned]:
    """The first bent contour that keeps rtol, or the best of those that were tried; and the plan that came last.

    Errors are over the largest |p| of each plane. Where that lies far outside of the window, the field inside is still made as
    accurate by its own size as some thousand plane waves make it. Where spectra are cut off, contours in stretches come first.
    """
    checks, rtol = search.checks, search.rtol
    best: Quadrature | None = None
    by_window: Checks | None = None  # the checks before peaks far outside were looked for
    attempts = Attempts(LOSSLESS_SHRINKS if search.slab.lossless else SHRINKS)
    while attempts.made < ATTEMPTS and not too_many_plane_waves(planned.plan):
        planned, attempts = _told_apart(search, planned, attempts)
        if planned.unclear:
            break
        best = best or _in_stretches_first(search)
        if best is not None and best.worst <= rtol:
            return best, planned
        compared = error.compare(checks, pair_of_contours(search, planned), rtol)
        if best is not None and by_window is None and compared.estimate.worst > rtol:  # a wider window alone did not do
            by_window, compared = compared.checks, _with_wider_look(search, planned, compared)
        checks, (worst, edge) = compared.checks, (compared.estimate.worst, compared.estimate.edge)
        attempts = attempts.after(worst, best.worst if best is not None else math.inf)
        if best is None or worst < best.worst:
            best = _quadrature(planned, compared)
        if worst <= rtol and by_window is not None:
            return _good_by_itself(search, planned, by_window, best)
        plan = next_plan(planned.plan, worst, edge, attempts, rtol)
        if plan is None:
            break
        planned = planned._replace(plan=plan)
    return best or _without_any(search, planned), planned


def _told_apart(search: Search, planned: Planned, attempts: Attempts) -> tuple[Planned, Attempts]:
    """The poles of a plan that comes nearer to the axis as often as it may, until they can be told apart."""
    planned = with_poles(search, planned)
    while planned.unclear and attempts.shrinks and attempts.made < ATTEMPTS:
        attempts = attempts._replace(shrinks=attempts.shrinks - 1, made=attempts.made + 1)
        planned = shallower(search, planned)
        if too_many_plane_waves(planned.plan):
            break
        planned = with_poles(search, planned)
    return planned, attempts


def _in_stretches_first(search: Search) -> Quadrature | None:
    """The best contour that comes up to the axis where spectra are cut off."""
    return in_stretches.best_in_stretches(search, crowded=False).best if search.ends.size else None


def _without_any(search: Search, planned: Planned) -> Quadrature:
    """A contour in stretches for a periodic slab whose poles cannot be told apart, or the refusal of the question."""
    if planned.unclear and search.slab.periodic:
        return in_stretches.quadrature_in_stretches(search, crowded=True)
    raise ValueError(refusal(search) if planned.unclear else too_many(search.rtol))


def _quadrature(planned: Planned, compared: Compared) -> Quadrature:
    first = compared.first
    circles = bool(planned.poles.poles)
    return Quadrature(first.contour, compared.estimate.budget, circles=circles, amplitudes=first.amplitudes)


def _with_wider_look(search: Search, planned: Planned, compared: Compared) -> Compared:
    """The same contours with the largest |p| of each plane looked for far outside of the window."""
    checks = peak_outside.with_wider_look(search.slab, compared.checks, search.extent, planned.plan, planned.poles)
    return compared._replace(checks=checks, estimate=error.estimate(checks, compared.first, compared.second))


#: How often a contour that keeps rtol by a peak far outside is widened for the window alone, and the most plane waves it may have
#: then: 80 kB of the response a plane.
WIDENED, MOST_WIDENED = 5, 5_000


def _good_by_itself(search: Search, planned: Planned, checks: Checks, best: Quadrature) -> tuple[Quadrature, Planned]:
    """Widen a contour that keeps rtol by the plane's peak far outside until it does by the largest |p| inside, if it soon does."""
    before = math.inf
    for _ in range(WIDENED):
        compared = error.compare(checks, pair_of_contours(search, planned), math.inf)  # dark planes are known
        worst, plan = compared.estimate.worst, planned.plan
        if worst <= search.rtol:
            return _quadrature(planned, compared), planned
        more = 1.5 * math.log(min(worst, MEANINGLESS) / (0.1 * search.rtol)) / plan.depth
        if 0.1 * before < worst < 1 or compared.estimate.edge > SHARE * search.rtol:
            break
        if worst < before:
            best = _quadrature(planned, compared)._replace(budget=best.budget)
        before, planned = worst, planned._replace(plan=plan._replace(window=plan.window + more))
        if planned.plan.second_plan().nodes > MOST_WIDENED:
            break
    return best, planned
