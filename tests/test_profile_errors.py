"""The terms of the error of widths and measures: their sum, and that a warning names the largest."""

import numpy as np
import pytest
from worse_contours import with_larger_errors

import beamprop as bp
from beamprop.contour import error
from beamprop.profiles import many_frequencies, power, routes

SLAB = bp.Slab(bp.lmmd_cell(), 20)
BEAM = bp.GaussianBeam(0.2)
F = 2500.0  # Hz


def pattern(estimate, of, words):
    return rf"^estimated error {estimate} of {of}, above the requested rtol 1\.0e-06, mostly: {words}$"


# --- widths -----------------------------------------------------------------------------------------------


def test_a_width_names_the_difference_of_two_contours_at_many_frequencies(monkeypatch):
    """The second straight contour's amplitudes are off by 2e-5, at one frequency: 1.5 times that is the estimate."""
    both = many_frequencies._both_contours

    def off(*args):
        first, second, near = both(*args)
        size = 1 + 2e-5 * (np.arange(len(second.right)) == 1)[:, None]
        return first, second._replace(right=second.right * size, left=second.left * size), near

    measured = many_frequencies._measured

    def trusted(*args):  # else a frequency above rtol is measured again by itself, which is right
        measures, good = measured(*args)
        return measures, np.ones_like(good)

    monkeypatch.setattr(many_frequencies, "_both_contours", off)
    monkeypatch.setattr(many_frequencies, "_measured", trusted)
    words = "the difference between two contours"
    with pytest.warns(bp.AccuracyWarning, match=pattern(r"3\.0e-05", r"the largest \|p\|", words)):
        bp.beam_width(SLAB, BEAM, [2000.0, F, 3000.0], rtol=1e-6)


@pytest.mark.parametrize("term", [name for name in error.ErrorBudget._fields if name != "low_rank"])
def test_a_width_names_the_largest_term_of_its_contour(term, monkeypatch):
    """A beam whose spectrum is not entire is measured by itself at each frequency."""
    with_larger_errors(monkeypatch, term, 3e-5)
    rotated = bp.GaussianBeam(0.3, angle=10.0, z0=-0.05, form="rotated")
    with pytest.warns(bp.AccuracyWarning, match=pattern(r"3\.0e-05", r"the largest \|p\|", error.TERMS[term])):
        bp.beam_width(SLAB, rotated, F, rtol=1e-6)


def test_measures_as_a_table_and_back():
    """Every number has a row: none is lost or mistaken where frequencies are put together."""
    table = np.random.default_rng(1).random((4 + len(error.ErrorBudget._fields), 5))
    measures = routes.measures_of(table)
    np.testing.assert_array_equal(measures.table, table)
    np.testing.assert_array_equal(measures.budget.total, np.add.reduce(table[4:]))
    assert measures.crossings is not measures.centroid


# --- measures of a beam -----------------------------------------------------------------------------------


@pytest.mark.parametrize("term", [name for name in error.ErrorBudget._fields if name != "low_rank"])
def test_a_measure_names_the_largest_term_of_its_contour(term, monkeypatch):
    with_larger_errors(monkeypatch, term, 3e-5)
    with pytest.warns(bp.AccuracyWarning, match=pattern(r"3\.0e-05", r"the largest \|p\|", error.TERMS[term])):
        bp.beam_measures(SLAB, BEAM, F, rtol=1e-6)


@pytest.mark.parametrize(
    ("terms", "words"),
    [
        ({"rules": 1e-5}, "the difference between two quadrature rules"),
        ({"rounding": 1e-5}, "the rounding of the response"),
    ],
)
def test_a_power_names_its_largest_term(terms, words, monkeypatch):
    """The share of the launched power errs by what both powers err: of the launched one, and of the one that passes."""
    radiated = power.radiated
    monkeypatch.setattr(power, "radiated", lambda *args: radiated(*args)._replace(error=power.PowerError(**terms)))
    with pytest.warns(bp.AccuracyWarning, match=pattern(r"2\.0e-05", "a power", words)):
        bp.beam_measures(SLAB, BEAM, F, rtol=1e-6)


def test_the_error_of_a_power_is_the_sum_of_its_terms():
    total = power.PowerError(1e-3, 3e-3).plus(power.PowerError(5e-3, 0.0))
    assert total == pytest.approx((6e-3, 3e-3))
    assert total.total == pytest.approx(9e-3)
