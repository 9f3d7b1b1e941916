"""Windows across planes in three dimensions: what their sums take, how they are refused, and how they grow."""

import warnings

import numpy as np
import pytest
from scipy.ndimage import label
from scipy.optimize import brentq, minimize_scalar

import beamprop as bp
from beamprop import memory
from beamprop.contour.error import uniform_budget
from beamprop.profiles.space_plane import Plane, PlaneOfSum

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
FREE = bp.Slab.uniform(WATER, 5e-3, background=WATER)
SHORT = bp.Array(np.stack([0.0012 * np.arange(-4, 4), np.zeros(8)], axis=1), bp.Piston(0.0004, z0=-0.02), angle=30)
LINE = bp.Array(np.stack([0.0012 * np.arange(-12, 12), np.zeros(24)], axis=1), SHORT.element, angle=30)
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


@pytest.mark.parametrize("question", [bp.beam_measures, bp.beam_width])
def test_a_lines_beam_is_as_wide_across_it_as_its_elements_spread(question):
    """Many times wider than the line's elements: cuts and area of Rayleigh's integral over every element, by Gauss's rule."""
    k = 2 * np.pi * MHZ / 1500.0
    g, w = np.polynomial.legendre.leggauss(4)
    radii, turn = 0.0002 * (g + 1)[:, None], np.pi / 3 * np.arange(6)
    middles = LINE.positions[:, 0]
    places = (middles[:, None, None] + radii * np.cos(turn)).ravel(), np.tile(radii * np.sin(turn), (24, 1, 1)).ravel()
    driven = np.exp(0.5j * k * (middles - middles.mean()))  # sin 30 degrees
    weights = (driven[:, None, None] * 0.0002 * (w[:, None] * radii) / 6 * np.ones(6)).ravel()

    def size(x, y):
        away = np.sqrt(np.subtract.outer(x, places[0]) ** 2 + np.subtract.outer(y, places[1]) ** 2 + 0.025**2)
        return np.abs(k * np.exp(1j * k * away) / away @ weights)

    x, y = np.linspace(-0.06, 0.1, 321), np.linspace(0, 0.1, 201)
    half = np.array([size(x, np.full(x.size, v)) for v in y])
    plane = np.concatenate([half[:0:-1], half])
    top = minimize_scalar(
        lambda v: -size(v, 0.0),
        bounds=x[half[0].argmax()] + np.array([-1e-3, 1e-3]),
        method="bounded",
        options={"xatol": 1e-9},
    )
    along_x, along_y = (lambda t: size(top.x + t, 0.0) + top.fun / 2), (lambda t: size(top.x, t) + top.fun / 2)
    widths = brentq(along_x, 0, 0.02) - brentq(along_x, -0.02, 0), 2 * brentq(along_y, 0, 0.06)
    numbered, _ = label(plane >= -top.fun / 2)
    area = np.count_nonzero(numbered == numbered.ravel()[plane.argmax()]) * (x[1] - x[0]) * (y[1] - y[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # tails outside, and a side without a beam
        ds = question(FREE, LINE, MHZ, rtol=1e-3)
    if question is bp.beam_measures:
        ds = ds.sel(side="transmitted").rename(fwhm="fwhm_out", area="area_out", peak="peak_out")
    assert ds.fwhm_out.values == pytest.approx(widths, rel=1e-3)
    assert float(ds.peak_out) == pytest.approx(-top.fun, rel=1e-3)
    assert float(ds.area_out) == pytest.approx(area, rel=3e-3)
