"""The terms of an error estimate, what a warning says of them, and the plan that is tried after an estimate."""

import math

import numpy as np
import pytest
from worse_contours import with_larger_errors

import beamprop as bp
from beamprop.contour import bent, check_points, error, in_stretches, paths, stretches, summed

RTOL = 1e-8
PLAN = paths.BentPlan(depth=2.0, window=10.0, band=100.0, bend=50.0)


def budget(**terms):
    """A budget of two beams, 0 but for the given terms."""
    return error.uniform_budget(2, 0.0)._replace(**{name: np.array(values) for name, values in terms.items()})


# --- budgets ----------------------------------------------------------------------------------------------


def test_the_total_is_the_sum_of_all_terms():
    count = len(error.ErrorBudget._fields)
    powers = error.ErrorBudget(*(np.array([2.0**i, 0.0]) for i in range(count)))  # every subset has a sum of its own
    assert powers.total.tolist() == [2.0**count - 1, 0.0]


def test_the_largest_term_is_that_of_the_worst_beam():
    terms = budget(difference=[3e-9, 1e-9], long_phases=[0.0, 5e-9])
    assert terms.worst.total == pytest.approx([6e-9])
    assert terms.largest == "the rounding of long phases"
    assert budget(difference=[3e-9, np.nan], low_rank=[1e-9, 1.0]).largest == "the difference between two contours"


def test_the_worse_of_two_budgets():
    small, large = budget(band_end=[1e-9, 2e-9]), budget(cut_spectrum=[1e-12, 1e-3])
    for worse in (small.worse(large), large.worse(small)):
        assert worse.largest == "a spectrum that is cut off"
        assert worse.total.tolist() == [1e-3]
    unknown = error.uniform_budget(1, math.nan)
    assert unknown.worse(small).total.tolist() == small.worse(unknown).total.tolist() == [2e-9]


def test_errors_of_a_sum_are_added_over_its_largest():
    """On the worst plane; what it is smaller by than each of its fields counts as their cancelling."""
    budgets = [budget(difference=[1e-9, 0.0]), budget(difference=[2e-9, 0.0], band_end=[0.0, 1e-9])]
    of_fields = np.array([[[1.0, 3.0], [1.0, 1.0]], [[2.0, 3.0], [1.0, 1.0]]])  # (fields, beams, planes)
    of_sum = np.array([[3.0, 0.1], [4.0, 4.0]])
    total = summed.added(budgets, summed.Scales(of_sum, of_fields))
    assert total.total == pytest.approx([9e-9 / 0.1, 1e-9 / 4])
    assert total.difference == pytest.approx([3e-9, 0.0])
    assert total.band_end == pytest.approx([0.0, 1e-9 / 4])
    assert total.cancelling == pytest.approx([9e-9 / 0.1 - 3e-9, 0.0])
    assert total.largest == "sources of the sum that cancel each other"
    nothing = summed.added([budget(), budget()], summed.Scales(0 * of_sum, 0 * of_fields))
    assert nothing.total.tolist() == [0.0, 0.0]


def test_a_lower_rtol_is_a_share_of_what_was_missed():
    assert summed.lower_rtol(1e-9, 1e-8, 1e-8) is None
    assert summed.lower_rtol(math.nan, 1e-8, 1e-8) is None
    assert summed.lower_rtol(1e-7, 1e-8, 1e-8) == pytest.approx(3e-10)
    assert summed.lower_rtol(1.0, 1e-8, 1e-8) == summed.LEAST
    assert summed.lower_rtol(1.0, 1e-8, summed.LEAST) is None


def test_beams_between_take_the_terms_of_the_worse_neighbour():
    known, total = np.array([-10.0, 0.0, 10.0]), np.array([3.0, 1.0, 2.0])
    at = np.array([-10.0, -5.0, 0.0, 1.0, 10.0])
    assert check_points.worse_neighbours(at, known, total).tolist() == [0, 0, 1, 2, 2]


@pytest.mark.parametrize("term", error.ErrorBudget._fields)
def test_a_warning_names_the_largest_term(term, monkeypatch):
    """Of a contour whose estimate is above rtol by one term: `field` warns with the estimate, rtol and the term in words."""
    with_larger_errors(monkeypatch, term)
    if term == "low_rank":  # this one is not the contour's: planes of a few are none here
        monkeypatch.setattr("beamprop.fields.evaluate.fill_map", lambda *_: np.array([3e-5]))
    with pytest.warns(bp.AccuracyWarning, match=rf"3\.0e-05 .* rtol 1\.0e-08, mostly: {error.TERMS[term]}$"):
        bp.field(bp.Slab.uniform(bp.AIR, 0.1), bp.GaussianBeam(0.2), 2500.0, np.linspace(-0.2, 0.2, 5), 0.1)


# --- what is tried next -----------------------------------------------------------------------------------


def after(*errors):
    """Attempts with these errors, in order."""
    attempts, smallest = bent.Attempts(shrinks=2), math.inf
    for worst in errors:
        attempts, smallest = attempts.after(worst, smallest), min(worst, smallest)
    return attempts


def test_attempts_in_vain_are_those_in_a_row_that_do_not_halve_the_error():
    assert [
        after(*errors).in_vain for errors in ([1.0], [1.0, 0.4], [1.0, 0.6], [1.0, 0.6, 0.55], [1.0, 0.6, 0.1])
    ] == [
        0,
        0,
        1,
        2,
        0,
    ]
    assert after(1.0, 0.4, 0.3).made == 3


def test_no_plan_follows_one_that_keeps_rtol():
    assert bent.next_plan(PLAN, RTOL, 1.0, after(RTOL), RTOL) is None


def test_no_plan_follows_four_in_vain():
    worst = 1e-6
    assert bent.next_plan(PLAN, worst, 0.0, after(*4 * [worst]), RTOL) is not None
    assert bent.next_plan(PLAN, worst, 0.0, after(*5 * [worst]), RTOL) is None


def test_the_band_is_widened_where_its_end_is_missing():
    assert bent.next_plan(PLAN, 1e-6, 0.31 * RTOL, after(1e-6), RTOL) == PLAN._replace(band=150.0)


def test_rounding_asks_for_a_contour_nearer_to_the_axis():
    """Where a wider window did not help."""
    attempts = after(1e-6, 1e-6)._replace(wider=True)
    assert bent.next_plan(PLAN, 1e-6, 0.29 * RTOL, attempts, RTOL) == PLAN._replace(depth=1.2, window=13.0)


def test_a_wider_band_says_nothing_of_windows():
    """What is left once the band is wide enough may be images."""
    following = bent.next_plan(PLAN, 1e-6, 0.29 * RTOL, after(1e-6, 1e-6), RTOL)
    assert following.depth == PLAN.depth
    assert following.window > PLAN.window


@pytest.mark.parametrize(
    ("worst", "window"),
    [
        (1e-6, 15.0),  # the images' ln(1e-6/3e-9)/depth = 2.9 is less than half a window
        (0.3 * RTOL * math.exp(2 * 7.0), 17.0),  # 7 m more: exp(-2 7) of this is 0.3 rtol
        (1e9, 20.0),  # at most twice the window
        (math.inf, 20.0),
    ],
)
def test_images_ask_for_a_wider_window(worst, window):
    following = bent.next_plan(PLAN, worst, 0.0, after(worst), RTOL)
    assert following.window == pytest.approx(window)
    assert following._replace(window=PLAN.window) == PLAN


def test_a_contour_in_stretches_gets_a_wider_band_or_shorter_panels():
    plan = stretches.Plan(1.0, 0.5, 0.6, 100.0)
    assert in_stretches.next_plan(plan, 0.31 * RTOL, RTOL) == plan._replace(band=150.0)
    finer = in_stretches.next_plan(plan, 0.29 * RTOL, RTOL)
    assert finer.band == plan.band
    assert finer.finer > plan.finer
    assert finer.depth < plan.depth
    assert finer.height < plan.height


def test_a_field_that_is_not_finite_is_not_taken_for_a_dark_plane(monkeypatch):
    """Its estimated error is infinite; as a dark plane it would have none."""
    asked, terms = [], error.terms_by_plane
    monkeypatch.setattr(error, "terms_by_plane", lambda *args: asked.append(args) or terms(*args))
    bp.field(bp.Slab(bp.lmmd_cell(eta=1 / 40), 7), bp.GaussianBeam(0.1), 2100.0, [0.0, 0.1], [0.0, 0.05])
    checks, first, second = asked[0]
    fields = error.fields_of(checks, second)
    assert np.all(terms(checks, first, second._replace(fields=fields)).budget.total < 1)
    fields[:, 1] = np.nan
    total = terms(checks, first, second._replace(fields=fields)).budget.total
    assert np.all(np.isinf(total[:, 1]))
    assert np.all(total[:, 0] < 1)


def test_nodes_are_graded_finer_beside_a_pole_where_a_wider_window_does_not_help():
    plan = PLAN._replace(sharp=1.0, grading=5.0)
    attempts = after(1e-6, 1e-6)._replace(wider=True, circled=True)
    finer = bent.next_plan(plan, 1e-6, 0.0, attempts, RTOL)
    assert finer == plan._replace(grading=8.0)
    shallower = bent.next_plan(finer, 1e-6, 0.0, attempts.before(finer, plan).after(1e-6, 1e-6), RTOL)
    assert (shallower.depth, shallower.grading) == (0.6 * plan.depth, 8.0)


def test_a_contour_bends_nearer_to_the_origin_where_a_wider_window_does_not_help():
    attempts = after(0.1, 0.1)._replace(wider=True)
    bend = 100 * PLAN.depth
    steeper = bent.next_plan(PLAN._replace(bend=bend), 0.1, 0.0, attempts, RTOL)
    assert steeper == PLAN._replace(bend=bend / 8)
    assert bent.next_plan(PLAN._replace(bend=bend), 1e-4, 0.0, attempts, RTOL).depth < PLAN.depth
