"""Widths of beams whose |p| is largest on a ring: cuts through its place farthest along x, wherever the samples lie."""

import warnings

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from scipy.special import lambertw

import beamprop as bp

FREQUENCY = 2500.0
THIN = bp.Slab.uniform(bp.AIR, 1e-10)
WATER = bp.Fluid.from_speed(1000.0, 1500.0)


@pytest.mark.parametrize(("middle", "rtol"), [((0.0, 0.0), 1e-6), ((0.0123, -0.0071), 1e-6), ((0.0123, -0.0071), 1e-3)])
def test_a_ring_has_a_hole(middle, rtol):
    """|p| = (r/a)^2 exp(1 - (r/a)^2): half of its peak at -W(-1/2e) and -W_-1(-1/2e) of (r/a)^2, W Lambert's function.

    The cut along y touches the ring at r = a, wherever the samples lie.
    """
    a = 0.05
    x = np.linspace(-0.3, 0.3, 241)
    r2 = ((x - middle[0]) ** 2 + (x[:, None] - middle[1]) ** 2) / a**2
    source = bp.SourcePlane(x, x, r2 * np.exp(1 - r2))
    with (
        pytest.warns(RuntimeWarning, match="half level is met up to 4 times"),
        pytest.warns(RuntimeWarning, match="peak is a ring, .* farthest along x: fwhm_launch, fwhm_in, fwhm_out"),
    ):
        ds = bp.beam_width(THIN, source, FREQUENCY, rtol=rtol)
    inner, outer = (-float(lambertw(-0.5 / np.e, branch).real) for branch in (0, -1))
    assert float(ds.area_out) == pytest.approx(np.pi * a**2 * (outer - inner), rel=max(1e-7, rtol))
    widths = a * (np.sqrt(outer) - np.sqrt(inner)), 2 * a * np.sqrt(outer - 1)
    assert ds.fwhm_out.values == pytest.approx(widths, rel=max(1e-7, rtol))


@pytest.mark.parametrize("rtol", [1e-3, 1e-6])
def test_cuts_of_a_pistons_ring_are_those_of_rayleighs_integral(rtol):
    """The ring behind water has its radius, and both cuts through it, by Gauss's rule over a rigid piston."""
    piston, free = bp.Piston(0.01, z0=-0.01), bp.Slab.uniform(WATER, 5e-3, background=WATER)
    g, w = np.polynomial.legendre.leggauss(60)
    ring, turn = 0.005 * (g + 1), 2 * np.pi * np.arange(200) / 200
    k = 2 * np.pi * 1e6 / 1500.0

    def size(r):
        away = np.sqrt(r**2 + ring[:, None] ** 2 - 2 * r * ring[:, None] * np.cos(turn) + 0.015**2)
        return abs(k / 200 * np.sum((0.005 * w * ring)[:, None] * np.exp(1j * k * away) / away))

    best = minimize_scalar(lambda r: -size(r), bounds=(0.001, 0.0025), method="bounded", options={"xatol": 1e-10})
    inner, outer = (
        brentq(lambda r: size(r) + best.fun / 2, *ends, xtol=1e-13) for ends in ((0, best.x), (best.x, 0.01))
    )
    widths = outer - inner, 2 * np.sqrt(outer**2 - best.x**2)
    tolerance = 1e-6 if rtol < 1e-4 else rtol
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        ds, measures = (f(free, piston, 1e6, rtol=rtol) for f in (bp.beam_width, bp.beam_measures))
    assert sum("the peak is a ring" in str(w.message) for w in caught) == 2
    assert ds.fwhm_out.values == pytest.approx(widths, rel=tolerance)
    assert measures.fwhm.sel(side="transmitted").values == pytest.approx(widths, rel=tolerance)
    assert float(ds.peak_out) == pytest.approx(-best.fun, rel=tolerance)


def test_a_ring_with_one_maximum_keeps_it():
    """Brighter by a thousandth towards +y, it is cut there, by root finding in what was launched."""
    a = 0.05
    x = np.linspace(-0.25, 0.25, 201)

    def p(x, y):
        r2 = (x**2 + y**2) / a**2
        return r2 * np.exp(1 - r2) * (1 + 1e-3 * y / a)

    with pytest.warns(RuntimeWarning) as caught:
        ds = bp.beam_width(THIN, bp.SourcePlane(x, x, p(x, x[:, None])), FREQUENCY)
    assert not any("ring" in str(w.message) and "fwhm_out" in str(w.message) for w in caught)
    top = minimize_scalar(lambda y: -p(0.0, y), bounds=(0.04, 0.06), method="bounded", options={"xatol": 1e-12}).x
    half = p(0.0, top) / 2
    along_x = 2 * brentq(lambda x: p(x, top) - half, 0.02, 0.2)
    along_y = brentq(lambda y: p(0, y) - half, top, 0.2) - brentq(lambda y: p(0, y) - half, 0.001, top)
    assert ds.fwhm_out.values == pytest.approx([along_x, along_y], rel=1e-6)
