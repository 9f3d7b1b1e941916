"""Windows across planes in three dimensions: what their sums take, how they are refused, and how they grow."""

import numpy as np
import pytest

import beamprop as bp
from beamprop import memory
from beamprop.contour.error import uniform_budget
from beamprop.profiles.space_plane import Plane, PlaneOfSum

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
FREE = bp.Slab.uniform(WATER, 5e-3, background=WATER)
SHORT = bp.Array(np.stack([0.0012 * np.arange(-4, 4), np.zeros(8)], axis=1), bp.Piston(0.0004, z0=-0.02), angle=30)
MHZ = 0.5e6


@pytest.mark.parametrize("sizes", [(9, 2), (2, 9)])
def test_planes_are_summed_by_the_cheaper_of_two_products(sizes):
    """Against the plain sum over plane waves; multiplications are counted by hand for 5 x 4 of them."""
    rng = np.random.default_rng(1)
    kx, ky, x, y = (rng.normal(size=n) for n in (5, 4, *sizes))
    waves = rng.normal(size=(4, 5)) + 1j * rng.normal(size=(4, 5))
    plane = Plane(kx, ky, waves, uniform_budget(1, 0.0))
    plain = np.einsum("ba,bY,aX->YX", waves, np.exp(1j * np.outer(ky, y)), np.exp(1j * np.outer(kx, x)))
    np.testing.assert_allclose(plane.on_grid(x, y), plain, atol=1e-13)
    terms = {(9, 2): 2 * 4 * 5 + 2 * 5 * 9, (2, 9): 2 * 4 * 5 + 2 * 4 * 9}[sizes]
    assert plane.terms(*sizes) == terms
    both = PlaneOfSum((plane, plane), (1.0, 1.0), (np.zeros(2), np.zeros(2)), plane.budget)
    assert both.terms(*sizes) == 2 * terms


def test_sums_that_take_too_long_name_a_window_that_was_chosen(monkeypatch):
    monkeypatch.setattr(memory, "MOST_PRODUCTS", 1e5)
    with pytest.raises(
        ValueError, match=r"^window: expected one .* 1e\+05 terms, got one .*: take a smaller one, a larger rtol"
    ):
        bp.beam_measures(FREE, SHORT, MHZ, rtol=1e-3, window=0.02)
    with pytest.raises(ValueError, match=r"^slab: expected one .* choose the window= of beam_measures"):
        bp.beam_measures(FREE, SHORT, MHZ, rtol=1e-3)
