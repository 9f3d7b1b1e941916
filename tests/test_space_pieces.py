"""The pieces of fields in three dimensions: nodes, kernel, table, lattice; each against a slow and obvious sum."""

import math
import tracemalloc

import numpy as np
import pytest
from scipy.special import exp1, j0, jn_zeros, jv

from beamprop.contour.paths import BentPlan, bent_contour
from beamprop.contour.space import lattice, radial, sheet
from beamprop.contour.space.along import along
from beamprop.sources.angles import AngleInterpolation
from beamprop.sources.in_space import unit_vector


def test_nodes_are_bessels_zeros():
    places, weights = radial.bessel_zeros(0, 40)
    assert np.max(np.abs(math.pi * places / jn_zeros(0, 40) - 1)) < 1e-15
    later, shares = radial.bessel_zeros(30, 10)
    assert np.array_equal(later, places[30:])
    assert np.array_equal(shares, weights[30:])
    assert shares[-1] == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("r", [0.0, 0.7, 3.0])
def test_the_rule_integrates_a_hankel_pair(r):
    """integral exp(-k^2) J0(k r) k dk = exp(-r^2/4)/2 (Watson, 13.3), on the axis and on a bent contour."""
    for depth, window in ((0.0, 20.0), (0.5, 30.0)):
        contour = bent_contour(BentPlan(depth, window, 7.0, 2.0), radial.bessel_zeros)
        summed = np.sum(2 * math.pi * contour.k * contour.weight * np.exp(-(contour.k**2)) * jv(0, contour.k * r))
        assert abs(summed - math.exp(-(r**2) / 4) / 2) < 1e-12


def test_the_rule_holds_where_nodes_are_graded():
    plan = BentPlan(0.5, 30.0, 7.0, 2.0, sharp=0.01, grading=9.0)
    contour = bent_contour(plan, radial.bessel_zeros)
    pole = 0.01  # at k = +- 0.01i: k dk/(k^2 + pole^2) exp(-k^2) = -exp(pole^2) Ei(-pole^2)/2
    summed = np.sum(2 * math.pi * contour.k * contour.weight * np.exp(-(contour.k**2)) / (contour.k**2 + pole**2))
    assert abs(summed - math.exp(pole**2) * exp1(pole**2) / 2) < 1e-9


def test_lommels_integral():
    """integral_0^L J0(q r) J0(k r) r dr by Gauss panels, at complex q and beside q = k."""
    radius, q, k = 1.3, np.array([4 - 1j, 20 - 0.5j, 7 + 1e-3j]), np.array([0.0, 3.0, 7.0, 25.0])
    g, w = np.polynomial.legendre.leggauss(120)
    r = radius * (g + 1) / 2
    known = (jv(0, np.outer(q, r)) * (w * r * radius / 2)) @ j0(np.outer(r, k))
    assert np.max(np.abs(radial.lommel(q, k, radius) - known)) < 1e-12
    assert np.array_equal(radial.lommel(q, -k, radius), radial.lommel(q, k, radius))


@pytest.mark.parametrize(("positions", "error"), [(10, 2e-8), (12, 7e-10), (14, 3e-11), (16, 4e-14)])
def test_the_table_between_radii(positions, error):
    """Of functions that are as sharp in k as a cut at L makes them, J0(k r) for r up to L."""
    radius, k = 2.0, np.random.default_rng(0).uniform(0, 40, 500)
    table = lattice.interpolation(k, math.pi / (lattice.FINE * radius), positions)
    for r in (0.3, 1.0, 2.0):
        apart = np.max(np.abs(table.matrix @ j0(table.radii * r) - j0(k * r)))
        print(apart)
        assert apart < error


def test_a_filter_is_even_and_ends():
    k = np.array([0.5, 30.0, 60.0, 99.0]) - 0.7j
    b = radial.passed(k, 20.0, 80.0, 2.0)
    assert np.max(np.abs(b - [0, 1, 1, 0])) < 1e-8
    assert np.max(np.abs(radial.passed(-k, 20.0, 80.0, 2.0) - b)) < 1e-15


class Gaussian:
    """A spectrum of the lattice's own test, with its field."""

    angle = 0.0

    def spectrum_at(self, kx, ky, k0):
        return math.pi * 0.02 * np.exp(-(0.01 * kx**2 + 0.04 * ky**2) / 4) * 1.0

    def at_angle(self, angle):
        return self


def whole(x_side=4.0, y_side=5.0):
    """A lattice whose nodes are its radii: h_L is h."""
    kx, ky = lattice.multiples(-130.0, 130.0, x_side), lattice.multiples(-70.0, 70.0, y_side)
    radii, of_point = lattice.radii_of(kx, ky, np.array([x_side, y_side]), (0.0, 200.0))
    table = lattice.interpolation(radii, 1.0, 8)
    nodes = table.radii
    return lattice.Lattice(kx, ky, 1 / (x_side * y_side), of_point, table, np.eye(nodes.size) + 0j, {}), nodes


@pytest.mark.parametrize("by_rows", [False, True])
def test_rows_and_planes_are_the_sum_over_the_lattice(by_rows):
    grid, nodes = whole()
    beams = AngleInterpolation(Gaussian(), np.array([0.0]))
    spectrum = grid.spectra(1.0, beams)
    x, y, h = np.linspace(-0.3, 0.2, 5), np.linspace(-0.1, 0.4, 4), np.stack([np.ones(nodes.size), nodes**2 / 100]) + 0j
    p = np.empty((1, 2, 4, 5), complex)
    (lattice.rows if by_rows else lattice.fields)(grid, spectrum, h, x, y, p)
    kx, ky = np.meshgrid(grid.kx, grid.ky)
    for i, values in enumerate((np.ones(kx.shape), (kx**2 + ky**2) / 100)):
        for j, b in enumerate(y):
            for m, a in enumerate(x):
                plain = np.sum(spectrum[0] * values * np.exp(1j * (kx * a + ky * b)))
                assert abs(p[0, i, j, m] - plain) < 1e-12 * np.abs(p[0, i]).max() + 1e-13
    u, v = np.meshgrid(x, y)
    assert np.max(np.abs(p[0, 0] - np.exp(-(u**2) / 0.01 - v**2 / 0.04))) < 1e-12


@pytest.mark.parametrize("ends", [(-6, 6), (-6, 5), (3, 11), (0, 0)])
@pytest.mark.parametrize(
    "y", [np.linspace(-2, 2, 8), np.linspace(0.3, 2.3, 7), np.array([0.4, -1.0, 2.0]), np.array([0.7])]
)
def test_sums_by_cosines_and_sines_are_the_plain_ones(ends, y):
    """Of values that are neither even nor odd, of even and of odd ones."""
    k = 0.7 * np.arange(ends[0], ends[1] + 1)
    rng = np.random.default_rng(1)
    values = rng.normal(size=(k.size, 3)) + 1j * rng.normal(size=(k.size, 3))
    for v in (values, values + values[::-1], values - values[::-1]):
        assert np.max(np.abs(along(k, y).sum(v) - np.exp(1j * np.outer(y, k)) @ v)) < 2e-14 * k.size
    assert along(k, y).in_pairs == (y.size > 3)


@pytest.mark.parametrize("windows", [(3.0, 3.0), (4.0, 5.123)])
def test_radii_are_formed_once(windows):
    kx, ky = lattice.multiples(-30.0, 50.0, windows[0]), lattice.multiples(-20.0, 20.0, windows[1])
    radii, of_point = lattice.radii_of(kx, ky, np.array(windows), (7.0, 45.0))
    plain = np.hypot(kx, ky[:, None])
    inside = (plain >= 7.0) & (plain <= 45.0)
    assert np.array_equal(of_point < radii.size, inside)
    assert np.max(np.abs(radii[of_point[inside]] - plain[inside])) < 1e-13
    assert radii.size == np.unique(plain[inside].round(9)).size


def test_directions_are_exact_at_quarters():
    assert unit_vector(0.0) == (1.0, 0.0)
    assert unit_vector(90.0) == (0.0, 1.0)
    assert unit_vector(-90.0) == (0.0, -1.0)
    assert unit_vector(540.0) == (-1.0, 0.0)
    assert unit_vector(30.0) == pytest.approx((math.sqrt(3) / 2, 0.5), abs=1e-15)
    assert unit_vector(-150.0) == pytest.approx((-math.sqrt(3) / 2, -0.5), abs=1e-15)


def test_a_spectrum_without_end_stays_so_when_it_is_widened():
    endless = sheet.Spectrum(np.array([[-np.inf, np.inf], [-np.inf, np.inf]]), 0.0, np.inf)
    assert np.array_equal(endless.wider(1.5).box, endless.box)


def test_the_mean_over_directions_follows_narrow_spectra():
    """Wide beams have spectra of few directions; against a hundred times as many directions as are taken."""
    from beamprop.sources.in_space import EllipticalGaussian, mean_size

    k = np.linspace(30.0, 50.0, 5)
    turn = 2 * np.pi * np.arange(20_000) / 20_000
    for radii in ((0.06, 0.06), (0.4, 0.2)):
        beam = EllipticalGaussian(radii, 45.0, 20.0, 0.0)
        plain = np.abs(beam.spectrum_at(np.outer(k, np.cos(turn)), np.outer(k, np.sin(turn)), 50.0)).mean(axis=1)
        assert mean_size(beam, k, 50.0) == pytest.approx(plain, rel=1e-9)


def test_the_mean_over_directions_in_parts():
    """Each wavenumber by itself, and 6000 of them, more than are averaged at a time, within 10 MiB."""
    from beamprop.sources.in_space import AT_A_TIME, AVERAGED, EllipticalGaussian, mean_size

    k, beam = np.linspace(0.0, 50.0, 6000), EllipticalGaussian((0.4, 0.2), 45.0, 20.0, 0.0)
    assert k.size * AVERAGED[0] > 2 * AT_A_TIME
    tracemalloc.start()
    means = mean_size(beam, k, 50.0)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10 * 2**20
    for i in (0, 2999, 5999):
        assert means[i] == pytest.approx(float(mean_size(beam, k[[i, -1]], 50.0)[0]), rel=1e-12)
