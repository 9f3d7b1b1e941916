"""Pieces of contours and of what chooses them, each by itself: grids, graded and crossing contours, losses, bands."""

import numpy as np
import pytest
from sided import BULK, K0, RHO, F

import beamprop as bp
from beamprop.contour import error, paths, search, sums, survey
from beamprop.response.sampled_slab import sample
from beamprop.sources.angles import AngleInterpolation, single


def test_a_grid_and_what_positions_are_off_it():
    x = np.linspace(-1, 1, 101)
    assert sums.grid_of(x).offsets is None
    assert sums.grid_of(x).even == pytest.approx(x, abs=1e-15)
    moved = x + 1e-4 * np.sin(np.arange(101)) * (x[1] - x[0])
    grid = sums.grid_of(moved)
    assert grid.even + grid.offsets == pytest.approx(moved, abs=1e-15)
    assert grid.unevenness == np.abs(moved - grid.even).max() > 0
    assert sums.grid_of(np.geomspace(1, 2, 101)).step == 0
    assert sums.grid_of(np.array([0.3])).step == 0


def test_a_sum_by_ffts_is_one_at_the_positions_themselves():
    """Of a few plane waves, term by term; what offsets of 1e-9 m cost, (k offset)^2/2, is 2e-13 here."""
    n, dx, rng = 256, 1 / 128, np.random.default_rng(1)
    x = dx * (np.arange(200) - 100) + 1e-9 * rng.standard_normal(200)
    grid = sums.grid_of(x)
    step = 2 * np.pi / (n * grid.step)
    k = step * np.arange(-20, 60) - 0.3j
    line = paths.Contour(k, np.ones(k.size), step, -20, 0.3)
    h = rng.standard_normal((3, k.size)) + 0j
    right, left = rng.standard_normal((2, k.size)) + 0j
    turn = np.exp(1j * np.outer(k, x))
    truth = (h * right) @ turn + (h * left) @ (1 / turn)
    assert grid.offsets is not None
    p = sums.grid_sum(line, h, right, left, grid, n)
    assert np.abs(p - truth).max() < 3e-12 * np.abs(truth).max()


def half_line(line, f):
    return np.sum(line.weight * f(line.k)) * 2 * np.pi


@pytest.mark.parametrize("pole", [1e-6, 1e-4, 1e-2])
def test_a_graded_contour_integrates_what_is_sharp_at_the_origin(pole):
    """The integral over s > 0 of 2b/(b^2 + s^2) exp(-s^2/2), b = pole: pi erfc(b/sqrt 2) exp(b^2/2)."""
    from scipy.special import erfcx

    plan = paths.BentPlan(1.0, 60.0, 9.0, 1.0 / paths.SLOPE, sharp=pole / 2, grading=12.0)
    found = half_line(paths.bent_contour(plan), lambda k: 2 * pole / (pole**2 + k**2) * np.exp(-(k**2) / 2))
    assert found == pytest.approx(np.pi * erfcx(pole / np.sqrt(2)), rel=1e-10)


def test_a_contour_that_crosses_passes_poles_on_both_sides():
    """2 k/(k^2 - a^2) exp(-k^2/8) has residue exp(-a^2/8) at a: half the difference between passing above and below is pi i of it."""

    def f(k, a):
        return 2 * k / (k**2 - a**2) * np.exp(-(k**2) / 8)

    plan = paths.BentPlan(0.6, 400.0, 18.0, 1.5, crossing=5.0, gap=1.0)
    straight = plan._replace(crossing=np.inf, gap=np.inf)
    crossing, below = paths.bent_contour(plan), paths.bent_contour(straight)
    assert np.all(crossing.k.imag[crossing.k.real < 3.5] < 0)
    assert np.all(crossing.k.imag[crossing.k.real > 6.5] > 0)
    near, far = 3.0, 7.0
    one, two = half_line(crossing, lambda k: f(k, near)), half_line(below, lambda k: f(k, near))
    assert one == pytest.approx(two, abs=1e-10)
    one, two = half_line(crossing, lambda k: f(k, far)), half_line(below, lambda k: f(k, far))
    assert two - one == pytest.approx(2j * np.pi * np.exp(-(far**2) / 8), abs=1e-10)


@pytest.mark.parametrize("distance", [1e-5, 1e-3, 3e-2])
def test_how_near_a_pole_lies_to_the_origin(distance):
    """A response with poles at +-distance exp(i pi/4): the search ends between a sixteenth of that and all of it."""
    beam, x, z = bp.GaussianBeam(0.5, 0, 0, -0.1), np.linspace(-1, 1, 31), np.array([0.1])
    s = sample(bp.Slab.uniform(bp.AIR, 0.1), F)
    reach = paths.Extent(s.k0, s.k0, 12.0, 1.0, 1.0, 0.2)

    def sharp(square):
        def transfer(k, z, shift=0.0):
            return np.broadcast_to(square / (square - k**2) if square else np.cos(k), (np.size(z), k.size)) + 0j

        return survey.survey(s, single(beam), transfer, x, z, reach, 1e-8).sharp

    assert sharp(0) == np.inf
    assert distance / 16 < sharp(1j * distance**2) <= distance


def test_loss_is_added_to_everything():
    s = sample(bp.Slab([bp.Layer(bp.Fluid(-2 * RHO, BULK), 0.1)], 3, after=bp.Fluid(RHO, 4 * BULK)), F)
    lossy = s.with_loss(1e-3)
    assert s.lossless
    assert s.with_loss(0.0) is s
    layers = lossy.segments[0].layers
    assert layers.mass / np.abs(s.segments[0].layers.mass) == pytest.approx(-1 + 1e-3j)
    assert layers.compliance / np.abs(s.segments[0].layers.compliance) == pytest.approx(1 + 1e-3j)
    for fluid, before in ((lossy.before, s.before), (lossy.after, s.after)):
        assert fluid.rho_z == pytest.approx(before.rho_z * (1 + 1e-3j))
        assert 1 / fluid.bulk_modulus == pytest.approx((1 + 1e-3j) / before.bulk_modulus)


def test_nothing_is_left_behind_the_first_wall():
    air, wall = bp.Layer(bp.AIR, 0.1), bp.Layer(bp.Fluid(0, BULK), 0.1)
    s = sample(bp.Slab([air, wall, air], 5), F)
    kept = s.up_to_wall().segments
    assert len(kept) == 1
    assert kept[0].periods == 1
    assert kept[0].layers.mass.shape[0] == 2
    plain = sample(bp.Slab([air], 5), F)
    assert plain.up_to_wall() is plain


def test_a_wide_tilted_beam_has_no_plane_waves_near_the_normal():
    """|S| = exp(-(a (k - k0 sin)/2)^2) is 1e-12 at k0 sin - 2 sqrt(ln 1e12)/a; beams at several angles count together."""
    beam = bp.GaussianBeam(5.0, 30)
    a = 5.0 / 2 / np.sqrt(np.log(2))
    low = K0 / 2 - 2 / a * np.sqrt(np.log(1e12))
    assert single(beam).low(K0, 1e-12) == pytest.approx(low, rel=1e-6)
    assert single(beam.at_angle(-30)).low(K0, 1e-12) == pytest.approx(low, rel=1e-6)
    assert AngleInterpolation(beam, np.array([-30.0, 30.0])).low(K0, 1e-12) == 0
    assert single(beam.at_angle(0)).low(K0, 1e-12) == 0


def test_a_wide_tilted_beam_takes_its_own_plane_waves_alone(monkeypatch):
    """730 wavelengths wide at 60 degrees: from the normal on it took 6270."""
    contours = []
    compare = error.compare
    monkeypatch.setattr(
        error, "compare", lambda checks, pair, rtol: contours.append(pair[0]) or compare(checks, pair, rtol)
    )
    slab, beam = bp.Slab.uniform(bp.Fluid(2.0, 3e5), 0.3), bp.GaussianBeam(100.0, 60, z0=-0.1)
    given = slab, beam, 2500.0, np.array([-30.0, 0.0, 20.0]), 0.5
    p = bp.field(*given).p
    assert contours[-1].k.size < 200
    assert contours[-1].k.real.min() > 0.9 * contours[-1].k.real.max()
    monkeypatch.setattr(search, "MANY_PLANE_WAVES", 10**6)
    apart = np.abs(p - bp.field(*given).p).max()
    assert contours[-1].k.size > 5000
    assert apart < 1e-8 * np.abs(p).max()
