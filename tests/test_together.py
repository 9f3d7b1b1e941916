"""`together`: questions whose widths are computed in one go have the answers, warnings and errors of plain calls."""

import warnings
from functools import partial

import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop.api import together as module
from beamprop.api.together import together

BEAM = bp.GaussianBeam(0.096, x0=0.1)


def widths(eta, angle=0.0, rtol=1e-8):
    """The widths at a point."""
    return bp.beam_width(bp.Slab(bp.lmmd_cell(eta=eta), 45), BEAM, 2500.0, angle=angle, rtol=rtol)


@pytest.fixture
def computed(monkeypatch):
    """How many points were computed in each go."""
    counts = []
    widths_of = module.widths_of
    monkeypatch.setattr(module, "widths_of", lambda slabs, *rest: counts.append(len(slabs)) or widths_of(slabs, *rest))
    return counts


def same(got, want):
    """Equal datasets but for rounding, provenance included."""
    assert got.attrs == want.attrs
    xr.testing.assert_allclose(got.drop_vars("centroid_out"), want.drop_vars("centroid_out"), rtol=1e-8)
    assert abs(got.centroid_out.item() - want.centroid_out.item()) < 1e-5


def test_the_answers_of_plain_calls(computed):
    points = [(1 / n, angle, rtol) for n in (60, 50) for angle in (0.0, 30.0) for rtol in (1e-8, 1e-6)]
    for point, answer in zip(points, together([partial(widths, *point) for point in points]), strict=True):
        same(answer, widths(*point))
    assert sorted(computed) == [4, 4]  # by rtol


def test_what_a_question_makes_of_its_widths(computed):
    def growth(n):
        first, second = (widths(1 / n, angle).fwhm_out.item() for angle in (0.0, 20.0))
        return second / first

    assert np.allclose(
        together([partial(growth, n) for n in (60, 50, 40)]), [growth(n) for n in (60, 50, 40)], rtol=1e-9
    )
    assert computed == [3, 3]


def test_whatever_else_is_asked():
    slab = bp.Slab(bp.lmmd_cell(), 20)
    questions = [
        lambda: 3,
        lambda: bp.beam_width(slab, BEAM, [2000.0, 2500.0]),
        lambda: bp.scattering(slab, 2500.0, angle=0.0),
        lambda: bp.beam_width(slab, bp.GaussianBeam(0.3, 20.0, form="rotated"), 2500.0),
        lambda: together([lambda: widths(1 / 60)])[0],
    ]
    for answer, question in zip(together(questions), questions, strict=True):
        want = question()
        if isinstance(want, xr.Dataset):
            xr.testing.assert_allclose(answer, want, rtol=1e-8, atol=1e-5)
        else:
            assert answer == want


def test_errors_are_answers(computed):
    backward = bp.Fluid(-1.0, -1e5)
    wrong = partial(bp.beam_width, bp.Slab.uniform(bp.AIR, 0.1, before=backward), BEAM, 2500.0)
    answers = together([partial(widths, 1 / 60), wrong, lambda: 1 / 0, partial(widths, -1)])
    same(answers[0], widths(1 / 60))
    assert "before: expected a half-space that carries forward waves" in str(answers[1])
    assert isinstance(answers[2], ZeroDivisionError)
    assert "eta: expected a finite number above zero" in str(answers[3])
    assert computed == [2]


def test_a_question_that_changes_its_mind():
    """At a point other than the one that was noted the widths are those of that point."""
    cells = iter((60, 50, 40))
    same(together([lambda: widths(1 / next(cells))])[0], widths(1 / 50))


def test_what_ends_a_program_ends_it():
    def interrupted():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        together([interrupted])
    same(widths(1 / 60), together([partial(widths, 1 / 60)])[0])  # nothing is left behind


@pytest.mark.parametrize("slab", [bp.Slab(bp.lmmd_cell(lossless=True), 450), bp.Slab.uniform(bp.Fluid(0.0, 1e5), 0.1)])
def test_the_warnings_of_plain_calls(slab):
    def said(ask):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            ask()
        return [(w.category, str(w.message)) for w in caught]

    ask = partial(bp.beam_width, slab, bp.GaussianBeam(0.03, 60.0), 2700.0)
    assert said(lambda: together([ask])) == said(ask) != []


class Own:
    """A source of the user's own, which cannot be hashed."""

    __hash__ = None

    def __init__(self, beam):
        self.beam = beam

    def __getattr__(self, name):
        if name == "moved_to_origin":
            raise AttributeError
        return getattr(self.beam, name)

    def __eq__(self, second):
        return np.array([True, True])


def test_a_source_that_cannot_be_compared(computed):
    own = Own(bp.GaussianBeam(0.096))
    own.at_angle = lambda angle: own
    slab = bp.Slab(bp.lmmd_cell(), 20)
    answer = together([lambda: bp.beam_width(slab, own, 2500.0)])[0]
    assert answer.fwhm_out.item() == pytest.approx(bp.beam_width(slab, own.beam, 2500.0).fwhm_out.item(), rel=1e-8)
    assert computed == []
