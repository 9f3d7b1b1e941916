"""Positions, origins, widths and slabs as users ask for them: answered to rtol, and not refused or warned of without need."""

import numpy as np
import pytest
import sided
from answers import field_and_warning, plane_errors, slab_of
from sided import AIR, BULK, K0, LAM, RHO, F

import beamprop as bp

PAPER = bp.Slab(bp.lmmd_cell(), 450)


# --- positions --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("points", "digits"), [(100, 12), (2**10, 12), (2**12, 12), (2**14, 12), (2**16, 13)])
def test_positions_that_are_even_to_printed_digits(points, digits):
    """Typed or read from a file, an even grid is even to some digits: the answer is for the positions, not for the grid.

    Of a uniform slab, against a direct sum at some of the positions.
    """
    span = 20.0
    x = np.round(np.linspace(-0.5, 0.5, points), digits) * span
    layers, beam, z = [(0.7 * RHO, 1.6 * BULK, 0.2)], bp.GaussianBeam(0.2, 20, 0, -0.1), [-0.05, 0.1, 0.3]
    slab = slab_of(layers)
    some = np.unique(np.concatenate([np.linspace(0, points - 1, 41).astype(int), points // 2 + np.arange(-20, 21)]))
    k, w = sided.contour([(K0, 1)], 120.0, 0.4, panel=2.0)
    truth = sided.summed(k, w, sided.response(layers, AIR, k, z, -0.1), sided.gaussian(0.2, 20), x[some])
    ds, warned = field_and_warning(slab, beam, F, x, z, rtol=1e-11)
    assert plane_errors(ds.p.values[:, some], truth).max() < 1e-11
    assert not warned


@pytest.mark.parametrize("x0", [60.0, 1024.0, 2.0**17])
def test_answers_do_not_depend_on_the_origin(x0):
    """All positions and x0 are sums of few powers of two, so that nothing is rounded but phases."""
    x, z = np.arange(-64, 64) / 64, [0.0, 0.5, 1.2]
    y = np.linspace(-1, 1, 257)
    profile = np.exp(-((y / 0.1) ** 2) + 3j * y)
    for here, there in (
        (bp.GaussianBeam(0.096, 20, 0.0, -0.1), bp.GaussianBeam(0.096, 20, x0, -0.1)),
        (bp.Profile(y, profile), bp.Profile(y + x0, profile)),
    ):
        for more in ({}, {"boundary": "periodic", "period": 16.0}):
            p, q = (
                bp.field(PAPER, beam, F, x + beam.centre - here.centre, z, **more).p.values for beam in (here, there)
            )
            assert plane_errors(q, p).max() < 1e-11
        one, two = bp.beam_width(PAPER, here, F), bp.beam_width(PAPER, there, F)
        for width in ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air", "peak_out"):
            assert float(two[width] / one[width]) == pytest.approx(1, abs=1e-11)
        assert float(two.centroid_out - x0) == pytest.approx(float(one.centroid_out), abs=1e-11 * max(x0, 1))
        one, two = bp.beam_measures(PAPER, here, F), bp.beam_measures(PAPER, there, F)
        for measure in ("fwhm", "peak", "power", "lateral_shift"):
            np.testing.assert_allclose(two[measure], one[measure], rtol=1e-9, atol=1e-11 * max(x0, 1))


# --- widths and half-spaces -------------------------------------------------------------------------------


def test_a_gaussian_of_20_000_wavelengths_at_45_degrees():
    """Its Rayleigh length is 1e9 wavelengths: one wavelength on it is its own profile, moved along z by tan(45) z.

    Fresnel's second-order term, z/(2 kz^3) (dk)^2 k0^2, turns phases by 1e-9 and is taken along.
    """
    beam, z = bp.GaussianBeam(20_000 * LAM, 45), 10 * LAM
    a = beam.fwhm / 2 / np.sqrt(np.log(2))
    x = np.linspace(-2 * a, 2 * a, 41)
    kx, kz = K0 / np.sqrt(2), K0 / np.sqrt(2)
    spread = 1 + 2j * z * K0**2 / kz**3 / a**2
    truth = np.exp(1j * (kx * x + kz * z) - (x - z * kx / kz) ** 2 / a**2 / spread) / np.sqrt(spread)
    ds, warned = field_and_warning(bp.Slab.uniform(bp.AIR, 0.1), beam, F, x, [0.0, z], rtol=1e-8)
    assert plane_errors(ds.p.values, np.array([np.exp(1j * kx * x - (x / a) ** 2), truth])).max() < 1e-8
    assert not warned


@pytest.mark.parametrize(("density", "speed"), [(1.0, 1e9), (1.0, 1e7), (30.0, 1e8), (1e4, 1e9)])
def test_half_spaces_nearly_rigid_or_of_huge_speed(density, speed):
    """Its branch point next to kx = 0 takes a contour that is graded towards the origin."""
    after = (RHO * density, RHO * density * speed**2)
    layers, z = [(2 * RHO, 3 * BULK, 0.3 * LAM)], [-0.05, 0.0, 0.02]
    x = np.linspace(-1, 1, 41)
    near = 2 * np.pi * F / speed
    slab = slab_of(layers, after=after)
    k, w = sided.contour([(K0, 1)], 120.0, 2.0, finest=1e-3 * near, panel=1.0)
    truth = sided.summed(k, w, sided.response(layers, after, k, z, -0.1), sided.gaussian(0.2, 10), x)
    ds, warned = field_and_warning(slab, bp.GaussianBeam(0.2, 10, 0, -0.1), F, x, z, rtol=1e-8)
    assert plane_errors(ds.p.values, truth).max() < 1e-8
    assert not warned


# --- slits in front of the paper's slab -------------------------------------------------------------------


@pytest.mark.parametrize("gap", [0.01, 0.05])
def test_slits_in_front_of_the_paper_s_slab_with_little_loss(gap):
    """Hundreds of backward modes beyond the forward ones: answered, and continuous as the loss goes."""
    beam, x = bp.Slits(LAM / 20, LAM / 5, 2, z0=-gap * LAM), np.linspace(-0.3, 0.3, 61)
    p = {}
    for loss in (0.0, 1e-6, 1e-5, 1e-4):
        slab = bp.Slab(bp.lmmd_cell(0.05 + 1j * loss, loss / 2), 450)
        ds, warned = field_and_warning(slab, beam, F, x, [0.0, slab.thickness], rtol=1e-6)
        assert not warned
        p[loss] = ds.p.values
    assert plane_errors(p[1e-6], p[0.0]).max() < 1e-3
    assert plane_errors(p[1e-5], p[0.0]).max() == pytest.approx(10 * plane_errors(p[1e-6], p[0.0]).max(), rel=0.1)
    assert plane_errors(p[1e-4], p[0.0]).max() == pytest.approx(100 * plane_errors(p[1e-6], p[0.0]).max(), rel=0.5)


def test_100_000_periods_without_loss():
    """Thousands of modes: answered, and a loss in every fluid changes the field in proportion."""
    cell, x, p = bp.lmmd_cell(0.05, 0.0), np.linspace(-0.3, 0.3, 31), {}

    def lossy(fluid, loss):
        return bp.Fluid(*sided.lossy((complex(fluid.density), complex(fluid.bulk_modulus)), loss))

    for loss in (0.0, 1e-8, 1e-7):
        layers = [bp.Layer(lossy(layer.fluid, loss), layer.thickness) for layer in cell.layers]
        slab = bp.Slab(layers, 100_000, lossy(bp.AIR, loss), lossy(bp.AIR, loss))
        ds, warned = field_and_warning(
            slab, bp.GaussianBeam(0.012, 0, 0, -0.005), F, x, [0.0, slab.thickness], rtol=1e-6
        )
        assert not warned
        p[loss] = ds.p.values
    little, more = (plane_errors(p[loss], p[0.0]).max() for loss in (1e-8, 1e-7))
    assert 1e-6 < little < 1e-2
    assert more == pytest.approx(10 * little, rel=0.05)
