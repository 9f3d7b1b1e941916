"""A bent contour on which the field keeps rtol: plans are changed until two contours agree.

The loop evaluates two contours and estimates the error; `next_plan`, a pure function of the estimate, makes the plan to try next.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from . import error, in_stretches
from .check_points import Checks
from .error import Compared
from .paths import SLOPE, BentPlan
from .quadrature import Quadrature
from .search import (
    Planned,
    Search,
    pair_of_contours,
    refusal,
    shallower,
    too_many,
    too_many_in_space,
    too_many_plane_waves,
    with_poles,
)

#: The most plans that are tried before the requested rtol is given up: a band that grows by half each time grows 1.5^13 = 200-fold.
ATTEMPTS = 14
#: How many of these may be nearer to the axis by a factor of 3, so that fewer poles lie between. Modes of a lossless slab lie on the axis
#: itself, and two tries show that their number does not fall; with loss a depth 3^6 = 700 times smaller leaves the nearly lossless ones.
SHRINKS, LOSSLESS_SHRINKS = 6, 2
#: After more plans than this in a row that do not halve the error it is given up: 0.6^3 times as deep, a contour magnifies rounding by
#: exp(0.2 DEEPEST) = 6 at most.
MOST_IN_VAIN = 3
#: Where a wider window does not help, an error above NO_ROUNDING, a plain choice far above rounding times exp(DEEPEST) = 3e3, is one of poles
#: that the contour passes closely: those of layers ten times as fast as the medium in front lie a tenth of its wavenumber from the origin,
#: where the contour has hardly bent. It leaves the origin STEEPER then.
NO_ROUNDING, STEEPER = 1e-3, 8.0
#: Likewise nodes are graded so much finer towards the origin beside a pole that has a circle: its error exp(-2 pi distance/step) falls to the
#: 1.6th power.
FINER = 1.6
#: Above this an estimate does not tell by how many decades images have to fall.
MEANINGLESS = 1e6


class Attempts(NamedTuple):
    """How the plans that were tried have fared."""

    shrinks: int  #: how often a plan may still come nearer to the axis
    made: int = 0
    in_vain: int = 0  #: plans in a row, up to the last, that did not halve the smallest error
    wider: bool = (
        False  #: whether the window of the last plan was wider than that before: a band alone says nothing of windows
    )
    near_origin: bool = False  #: whether the last plan was changed near the origin alone
    circled: bool = False  #: whether the last plan's contour passes by poles on its wrong side

    def after(self, worst: float, smallest: float) -> Attempts:
        """The attempts after a plan with the error `worst`; `smallest` is the least of the plans before it, inf for the first."""
        in_vain = self.in_vain + (not self.near_origin) if worst > 0.5 * smallest else 0
        return self._replace(made=self.made + 1, in_vain=in_vain)

    def before(self, plan: BentPlan, last: BentPlan) -> Attempts:
        """The attempts before a plan that follows the last one."""
        near_origin = (plan.bend, plan.grading) != (last.bend, last.grading)
        return self._replace(wider=plan.window > last.window, near_origin=near_origin)


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
        None where rtol is kept, or where MOST_IN_VAIN plans in a row have not come nearer to it.
    """
    if worst <= rtol or attempts.in_vain > MOST_IN_VAIN:
        return None
    if edge > error.SHARE * rtol:
        return plan._replace(band=plan.band * 1.5)
    if attempts.in_vain and (attempts.wider or attempts.near_origin):  # a wider window does not help
        # poles beside the contour near the origin, or else rounding, magnified by exp(depth X)
        if not attempts.near_origin and worst > NO_ROUNDING and plan.bend > 2 * plan.depth / SLOPE:
            return plan._replace(bend=max(plan.depth / SLOPE, plan.bend / STEEPER))
        if not attempts.near_origin and attempts.circled and plan.grading:
            return plan._replace(grading=plan.grading * FINER)
        return plan._replace(depth=plan.depth * 0.6, window=plan.window * 1.3)
    more = math.log(min(worst, MEANINGLESS) / (error.SHARE * rtol)) / plan.depth  # images fall as exp(-depth W)
    return plan._replace(window=plan.window + min(max(more, 0.5 * plan.window), plan.window))


def quadrature_on_bent_contour(search: Search, planned: Planned) -> tuple[Quadrature, Planned]:
    """The first bent contour that keeps rtol, or the most accurate one that was tried; and the last plan.

    Errors are over the largest |p| of each plane. Where that peak lies far outside of the window, the field inside is brought to
    rtol by its own size if MOST_WIDENED plane waves do it. Where spectra are cut off, contours in stretches are tried first.
    """
    checks, rtol = search.checks, search.rtol
    best: Quadrature | None = None
    by_window: Checks | None = None  # the checks without peaks far outside, once these have been looked for
    attempts = Attempts(LOSSLESS_SHRINKS if search.slab.lossless else SHRINKS)
    while attempts.made < ATTEMPTS and not _too_many(search, planned):
        planned, attempts = _told_apart(search, planned, attempts)
        if planned.unclear:
            break
        if best is None and search.ends.size:  # where spectra are cut off a contour meets the axis
            best = in_stretches.best_in_stretches(search, crowded=False).best
        if best is not None and best.worst <= rtol:
            return best, planned
        compared = error.compare(checks, pair_of_contours(search, planned), rtol)
        # widening the first plan did not do: is the peak outside? Unless only its band was too short until now
        done = not attempts.wider and compared.estimate.edge <= error.SHARE * rtol
        if best is not None and by_window is None and compared.estimate.worst > rtol and not done:
            by_window, checks = compared.checks, checks.places.with_wider_look(search, planned, compared.checks)
            compared = compared._replace(checks=checks, estimate=error.estimate(checks, *compared[:2]))
        checks, (worst, edge) = compared.checks, (compared.estimate.worst, compared.estimate.edge)
        attempts = attempts.after(worst, best.worst if best is not None else math.inf)
        if best is None or worst < best.worst:
            best = _quadrature(planned, compared)
        if worst <= rtol and by_window is not None:
            return _good_by_itself(search, planned, by_window, best)
        attempts = attempts._replace(circled=bool(planned.poles.poles))
        plan = next_plan(planned.plan, worst, edge, attempts, rtol)
        if plan is None:
            break
        attempts = attempts.before(plan, planned.plan)
        planned = planned._replace(plan=plan)
    return best or _without_any(search, planned), planned


def _told_apart(search: Search, planned: Planned, attempts: Attempts) -> tuple[Planned, Attempts]:
    """The plan with its poles, nearer to the axis as often as allowed, until they can be separated."""
    planned = with_poles(search, planned)
    while planned.unclear and attempts.shrinks and attempts.made < ATTEMPTS:
        attempts = attempts._replace(shrinks=attempts.shrinks - 1, made=attempts.made + 1)
        planned = shallower(search, planned)
        if _too_many(search, planned):
            break
        planned = with_poles(search, planned)
    return planned, attempts


def _too_many(search: Search, planned: Planned) -> bool:
    return too_many_plane_waves(planned.plan) or search.checks.places.too_large(search, planned.plan)


def _without_any(search: Search, planned: Planned) -> Quadrature:
    """A contour in stretches for a periodic slab whose poles cannot be told apart, or the refusal of the question."""
    if planned.unclear and search.slab.periodic and search.checks.places.on_a_line:
        return in_stretches.quadrature_in_stretches(search, crowded=True)
    if planned.unclear:
        raise ValueError(refusal(search))
    raise ValueError(too_many(search) if search.checks.places.on_a_line else too_many_in_space(search))


def _quadrature(planned: Planned, compared: Compared) -> Quadrature:
    contour, _, amplitudes, _ = compared.first
    return Quadrature(contour, compared.estimate.budget, circles=bool(planned.poles.poles), amplitudes=amplitudes)


#: How often a contour that keeps rtol by a peak far outside is widened for the field inside the window, and the most plane waves that it
#: may have then, a response of 80 kB a plane. A plain choice: rtol does not promise that accuracy, which may not cost much.
WIDENED, MOST_WIDENED = 5, 5_000


def _good_by_itself(search: Search, planned: Planned, checks: Checks, best: Quadrature) -> tuple[Quadrature, Planned]:
    """Widen a contour that keeps rtol over a peak far outside until it keeps rtol over the largest |p| inside, if it soon does."""
    before = math.inf
    for _ in range(WIDENED):
        compared = error.compare(checks, pair_of_contours(search, planned), math.inf)  # dark planes are known
        worst, plan = compared.estimate.worst, planned.plan
        if worst <= search.rtol:
            return _quadrature(planned, compared), planned
        more = 1.5 * math.log(min(worst, MEANINGLESS) / (0.1 * search.rtol)) / plan.depth
        if 0.1 * before < worst < 1 or compared.estimate.edge > error.SHARE * search.rtol:
            break
        if worst < before:
            best = _quadrature(planned, compared)._replace(budget=best.budget)
        before, planned = worst, planned._replace(plan=plan._replace(window=plan.window + more))
        if planned.plan.second_plan().nodes > MOST_WIDENED:
            break
    return best, planned
