"""The fast kernels of sums, angles and low rank against plain sums, over random cases; those of layers: test_reference.py."""

import math

import numpy as np
import pytest
from closeness import RTOL, close

import beamprop as bp
from beamprop.arrays import fft, matmul
from beamprop.contour import error as contour_error
from beamprop.contour import paths, sums
from beamprop.profiles import many_frequencies
from beamprop.response import reference
from beamprop.sources import angles as source_angles

SEEDS = range(12)


# --- sums -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 3, 2), (7, 146, 72), (300, 20, 500), (4, 7, 20_000), (40, 3000, 30)])
def test_products_in_pieces(shape):
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=shape[:2]) + 1j, rng.normal(size=shape[1:]) - 2j
    close(matmul.small_product(a, b), a @ b)
    close(matmul.product(a, b), a @ b)
    close(matmul.small_product(a.real, b), a.real @ b)


def random_sum(rng):
    n = int(rng.choice([8, 30, 64, 144, 400]))
    size, first = int(rng.integers(1, 3 * n)), -int(rng.integers(0, 40))
    dx = 0.01
    step = 2 * np.pi / (n * dx)
    k = step * (first + np.arange(size)) - 0.7j
    x = rng.uniform(-1, 0) + dx * np.arange(rng.integers(1, n + 1))
    line = paths.Contour(k, np.ones(size), step, first, 0.7, 1.0)
    h, right, left = (
        rng.normal(size=s) + 1j * rng.normal(size=s) for s in ((int(rng.integers(1, 90)), size), size, size)
    )
    return line, h, right, left * rng.integers(0, 2), x, n


@pytest.mark.parametrize("seed", range(40))
def test_sums_over_a_line(seed):
    rng = np.random.default_rng(seed)
    line, h, right, left, x, n = random_sum(rng)
    wanted = reference.field(h, right, left, line.k, x)
    scale = math.sqrt(line.k.size) * np.abs(h).max() * np.exp(0.7)
    phases = np.abs(line.k).max() * np.abs(x).max()  # whose rounding no order of sums avoids
    assert np.abs(sums.fft_sum(line, h, right, left, x, n) - wanted).max() < (RTOL + 4e-16 * phases) * scale
    assert np.abs(sums.direct_sum(line, h, right, left, x) - wanted).max() < (RTOL + 4e-16 * phases) * scale


@pytest.mark.parametrize("seed", SEEDS)
def test_many_beams_at_once(seed):
    rng = np.random.default_rng(seed)
    line, h, right, left, x, n = random_sum(rng)
    rights, lefts = np.stack([right, 2j * right, right * right]), np.stack([left, left * 0, 3 * left])
    each = zip(rights, lefts, strict=True)
    wanted = np.stack([sums.direct_sum(line, h, a, b, x) for a, b in each])
    close(sums.direct_sum(line, h, rights, lefts, x), wanted, rtol=1e-11)
    close(sums.fft_sum(line, h, rights, lefts, x, n), wanted, rtol=1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_straight_contour(seed):
    """The weights are chi at every node, for one frequency and for several."""
    rng = np.random.default_rng(seed)
    sigma, delta, window, band = rng.uniform(0.1, 15, 3), rng.uniform(1, 15, 3), rng.uniform(1, 5, 3), np.full(3, 150.0)
    plans = [paths.StraightPlan(*(float(v[i]) for v in (sigma, delta, window, band))) for i in range(3)]
    for plan in (paths.StraightPlan(sigma, delta, window, band), *plans):
        line = paths.straight_contour(plan)
        d, w = (np.asarray(v)[..., None] for v in (plan.delta, plan.window))
        np.testing.assert_allclose(line.weight, reference.chi(line.k, d) / w, rtol=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_plan_has_come_to_rest(seed):
    """The same numbers as after all 30 rounds."""
    rng = np.random.default_rng(seed)
    k, extent, source, path = (rng.uniform(*ends, 4) for ends in ((20, 80), (0.2, 3), (0.1, 0.5), (0.0, 5)))
    branch, rtol = k * rng.uniform(0.2, 1, 4), 10 ** rng.uniform(-11, -2)
    found = paths.plan_straight(paths.Extent(k, branch, 3 * k, extent, source, path), rtol)
    decades, rounding = math.log(20 / rtol), max(2.0, math.log(rtol / (100 * paths.EPS)))
    Z, X = np.maximum(path, 1e-3 / k), np.maximum(extent, source)
    delta, sigma, window = branch / math.sqrt(decades), rounding / (X + 30 / k), X
    for _ in range(30):
        guard = np.sqrt(4 / delta**2 + (Z * delta / k) ** 2) * np.sqrt(sigma * window + decades)
        window = np.maximum(X + source + guard, decades / sigma)
        sigma = np.minimum(np.minimum(decades / window, rounding / X), 3.0 * k / (Z * delta))
        delta = np.minimum(branch / np.sqrt(decades + Z * np.sqrt(branch * sigma)), np.sqrt(2 * k / Z))
    for got, want in zip(found[:3], (sigma, delta, np.maximum(window, decades / sigma)), strict=True):
        close(got, want)


def test_fast_lengths():
    lengths = sorted(2**a * 3**b * 5**c for a in range(13) for b in range(9) for c in range(6))
    for n in (1, 2, 7, 11, 97, 1025, 1331, 2049, 4000):
        assert fft.next_smooth(n) == min(m for m in lengths if m >= n)
        assert n <= fft.fast_length(n) <= max(1.125 * n, fft.next_smooth(n))
    assert [fft.fast_length(n) for n in (1, 2, 5, 1020, 1100, 1199, 1300, 1440)] == [
        1,
        2,
        5,
        1024,
        1125,
        1280,
        1350,
        1440,
    ]


# --- widths -----------------------------------------------------------------------------------------------


def random_modes(rng):
    """Amplitudes on even lines, the same m for three frequencies."""
    ds, sigma, first = rng.uniform(1, 3, 3), rng.uniform(0, 2, 3), -int(rng.integers(0, 20))
    n = int(rng.integers(1, 60))
    k = ds[:, None] * (first + np.arange(n)) - 1j * sigma[:, None]
    right, left = (rng.normal(size=k.shape) + 1j * rng.normal(size=k.shape) for _ in range(2))
    return many_frequencies.PlaneWaves(paths.Contour(k, np.ones(k.shape), ds, first, sigma), right, left)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_profile_at_any_position(seed):
    """By tables of exponentials, and by the sum over plane waves."""
    rng = np.random.default_rng(seed)
    plane_waves, x = random_modes(rng), rng.uniform(-1, 1, (3, 4))
    h = np.ones((1, plane_waves.contour.k.shape[-1]))
    rows = zip(plane_waves.right, plane_waves.left, plane_waves.contour.k, x, strict=True)
    close(plane_waves.evaluator()(x), np.concatenate([reference.field(h, *row) for row in rows]))


# --- many angles ------------------------------------------------------------------------------------------

PROFILE_X = np.linspace(-0.2, 0.2, 200)
SOURCES = {
    "gaussian": bp.GaussianBeam(0.096, x0=0.3, z0=-0.1),
    "wide": bp.GaussianBeam(3.0),
    "slits": bp.Slits(0.02, 0.05, 3, z0=-0.02),
    "profile": bp.Profile(PROFILE_X, np.exp(-((PROFILE_X / 0.03) ** 2)) * (1 + 0.3j * np.sin(50 * PROFILE_X))),
    "coarse profile": bp.Profile(PROFILE_X[::5], np.exp(-((PROFILE_X[::5] / 0.1) ** 2)), z0=-0.2),
    "rotated": bp.GaussianBeam(0.096, form="rotated"),
}


@pytest.mark.parametrize("name", SOURCES)
def test_spectra_of_many_angles_are_those_of_each(name):
    beam, rng = SOURCES[name], np.random.default_rng(3)
    angles, kx = rng.uniform(-89, 89, 7), rng.uniform(-300, 300, 50) - 3j * rng.random(50)
    wanted = np.stack([beam.at_angle(float(a)).spectrum(kx, 45.0) for a in angles])
    close(source_angles.AngleInterpolation(beam, angles).spectra(kx, 45.0), wanted, rtol=1e-11)


@pytest.mark.parametrize("name", SOURCES)
def test_many_angles_are_mixed_from_a_few(name):
    """A fan's spectra are, to the tolerance, the mixture of those at its nodes: at the ends and between."""
    beam, rng, k0 = SOURCES[name], np.random.default_rng(4), 45.0
    angles = np.concatenate([[-89.9, 89.9, 0.0], rng.uniform(-89.9, 89.9, 150)])
    found = source_angles.interpolate_angles(beam, angles, k0, 1e-12)
    assert (found.weights is None) == (name in ("wide", "rotated", "coarse profile"))
    kx = np.linspace(-100, 100, 41) + 0j
    wanted = np.stack([beam.at_angle(float(a)).spectrum(kx, k0) for a in angles])
    close(found.interpolated_to(found.spectra(kx, k0)), wanted, rtol=3e-12 * angles.size)


@pytest.mark.parametrize("x", [[0.1], np.linspace(-1, 1, 101)])
def test_many_angles_at_one_position_and_plane(x):
    """What is summed there need not lie in one piece: one plane, one position."""
    slab, angles = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), np.linspace(-60, 60, 50)
    many = bp.field(slab, bp.GaussianBeam(0.096), 2500.0, x, 0.1, angle=angles)
    one = bp.field(slab, bp.GaussianBeam(0.096, angles[7]), 2500.0, x, 0.1)
    assert np.abs(many.p[7].values - one.p.values).max() < 1e-8


@pytest.mark.parametrize("count", [65, 200])
def test_errors_of_many_angles_are_judged_by_some(count, monkeypatch):
    """No angle has a smaller error estimate than it has alone among all, but for the worse of its neighbours."""
    slab, beam = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), bp.GaussianBeam(0.096)
    x, z, angles = (
        np.linspace(-1, 1, 51),
        slab.thickness,
        np.linspace(-85, 85, count)[np.random.default_rng(0).permutation(count)],
    )
    some = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    monkeypatch.setattr(contour_error, "ESTIMATED", 1000)
    all_of_them = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    np.testing.assert_array_equal(some.p, all_of_them.p)
    assert np.all(some.error_estimate > 0.5 * all_of_them.error_estimate)


def test_the_field_at_many_angles_is_that_of_each():
    slab, beam = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), bp.GaussianBeam(0.096)
    x, z, angles = np.linspace(-1, 1, 101), [0.0, 0.05, slab.thickness], np.linspace(-85, 85, 90)
    many = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    for i in (0, 1, 44, 89):
        one = bp.field(slab, beam, 2500.0, x, z, angle=angles[i])
        apart = np.abs(one.p - many.p[i].drop_vars("angle")).max("x") / np.abs(one.p).max("x")
        assert apart.max() <= one.error_estimate + many.error_estimate[i].drop_vars("angle")


# --- what lies beyond a band -----------------------------------------------------------------------------


def test_the_end_of_a_path_is_not_that_of_its_circles():
    """What lies beyond a band is judged by the path's last nodes, however strong the nodes around single modes are."""
    k = np.linspace(1, 50, 60).astype(complex)
    line = paths.Contour(k, np.ones(60))
    with_discs = paths.Contour(np.concatenate([np.full(400, 5.0 + 0j), k]), np.ones(460), circles=400)
    right = np.exp(-k / 2)[None]
    strong = np.concatenate([np.full((1, 400), 1e9 + 0j), right], axis=1)
    alone = contour_error._beyond(contour_error.Sampled(line, np.ones((1, 60)), (right, right)))
    beside = contour_error._beyond(contour_error.Sampled(with_discs, np.ones((1, 460)), (strong, strong)))
    np.testing.assert_allclose(beside, alone, rtol=1e-12)
    assert alone > 0
