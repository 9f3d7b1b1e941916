"""Contours whose estimated error is larger than it is, for the tests of warnings."""

from beamprop.contour import choose


def with_larger_errors(monkeypatch, term="difference", by=3e-5):
    """Every contour's estimate is larger by one term."""
    choose_contour = choose.choose_contour

    def worse(*args):
        chosen = choose_contour(*args)
        return chosen._replace(budget=chosen.budget._replace(**{term: getattr(chosen.budget, term) + by}))

    monkeypatch.setattr(choose, "choose_contour", worse)
