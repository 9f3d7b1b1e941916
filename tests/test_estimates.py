"""Error terms that both contours of an estimate share, each against a reference that does not."""

import warnings

import numpy as np
import pytest
from accuracy_study.cases.numbering import make_case
from panels import panels

import beamprop as bp

FREQUENCY = 2000.0
K0 = float(bp.AIR.wavenumber(FREQUENCY).real)


def _far_face(layer, thickness, kx):
    """p at the far face of a uniform layer in air for a wave of 1 Pa at its near face, textbook formula (Brekhovskikh)."""
    omega = 2 * np.pi * FREQUENCY
    rho0, rho = bp.AIR.density, layer.density
    kz0 = np.sqrt((K0 - kx) * (K0 + kx) + 0j)
    kz = np.sqrt(omega**2 * rho / layer.bulk_modulus - kx**2 + 0j)
    ratio = kz * rho0 / (kz0 * rho)
    return 1 / (np.cos(kz * thickness) - 0.5j * (ratio + 1 / ratio) * np.sin(kz * thickness)), kz0


def _tilted_profile_behind_layer(x, p, angle, layer, thickness, z0, positions):
    """The field on the far face: panels on the real axis, the spectrum of evenly spaced samples in long double."""
    real, kind = np.longdouble, np.clongdouble
    towards_0 = np.pi / 2 * 1.3 ** -np.arange(1.0, 120)
    turn, w1 = panels(np.unique(np.concatenate([np.linspace(0, np.pi / 2, 120), towards_0])))
    rise, w2 = panels(np.linspace(0, np.arcsinh(6.0), 120))
    kx = K0 * np.concatenate([np.sin(turn), np.cosh(rise)])
    weight = K0 * np.concatenate([np.cos(turn) * w1, np.sinh(rise) * w2]) / (2 * np.pi)
    h, kz0 = _far_face(layer, thickness, kx)
    h = h * np.exp(-1j * kz0 * z0) * weight
    spacing = (real(x[-1]) - real(x[0])) / (x.size - 1)
    xi = (np.arange(x.size) - real(x.size - 1) / 2) * spacing
    tilted = p * np.exp(kind(1j) * real(K0) * np.sin(real(np.pi) / 180 * real(angle)) * xi)
    wave = np.exp(kind(-1j) * np.outer(kx.astype(real), xi))
    forth, back = ((e @ tilted * spacing).astype(complex) for e in (wave, 1 / wave))
    away = np.exp(1j * np.outer(kx, positions - (x[0] + x[-1]) / 2))
    return (h * forth) @ away + (h * back) @ (1 / away)


@pytest.mark.parametrize(("density", "angle"), [(1e-4, 70.0), (1e-6, 50.0), (1e-6, 70.0)])
@pytest.mark.parametrize("middle", [0.0, 6.3])
def test_the_rounding_of_samples_is_in_the_estimate_where_a_layer_lets_little_of_them_through(density, angle, middle):
    x = np.linspace(-1.5, 1.5, 201) + middle
    p = np.exp(-(((x - middle) / 0.3) ** 2)) + 0j
    layer, positions = bp.Fluid(density, 1.47e5), middle + np.linspace(-0.5, 0.5, 21)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bp.AccuracyWarning)
        found = bp.field(
            bp.Slab.uniform(layer, 0.1), bp.Profile(x, p, -0.05, angle), FREQUENCY, positions, [0.1], rtol=1e-12
        )
    expected = _tilted_profile_behind_layer(x, p, angle, layer, 0.1, -0.05, positions)
    error = np.max(np.abs(found.p.values[0] - expected)) / np.max(np.abs(expected))
    assert 1e-13 < error < 3 * float(found.error_estimate)


def test_images_between_far_ends_of_a_grid_are_in_the_estimate():
    # The images of the beam are a metre wide and come to 2 m from the ends of a grid of 131 m.
    x = np.linspace(-65.758772, 65.758772, 2**16)
    slab = bp.Slab.uniform(bp.Fluid(0.249314 + 0.000763359j, 465003 - 1423.76j), 0.332368)
    beam = bp.GaussianBeam(0.12822524)
    found = bp.field(slab, beam, 3322.2056556, x, [0.332368], rtol=3.4e-4)
    some = x[64_000:65_536:7]
    expected = bp.field(slab, beam, 3322.2056556, some, [0.332368], rtol=1e-12).p.values
    error = np.max(np.abs(found.p.sel(x=some).values - expected)) / np.max(np.abs(found.p.values))
    assert 1e-11 < error < 3 * float(found.error_estimate)


def test_a_plane_that_only_waves_beyond_the_contour_reach_is_warned_of():
    """Slits in front of 671 m of a slab that is opaque but for a band of evanescent waves: |p| is 5e-61 deep inside, not 0."""
    case = make_case(5883)
    with pytest.warns(bp.AccuracyWarning, match="estimated error inf .* mostly: the end of the band of plane waves"):
        ds = bp.field(case.slab, case.beam, case.frequency, case.x, case.z, rtol=case.rtol)
    assert np.isinf(ds.error_estimate)
    front = bp.field(case.slab, case.beam, case.frequency, case.x, case.z[:2], rtol=case.rtol)
    assert float(front.error_estimate) < case.rtol


def test_a_plane_that_nothing_reaches_is_not_warned_of():
    """Behind a kilometre of a fluid that carries no waves, of a Gaussian beam: 0, and right."""
    slab = bp.Slab.uniform(bp.Fluid(-1.25, 1.4e5), 1000.0)
    ds = bp.field(slab, bp.GaussianBeam(0.3, z0=-0.1), 2500.0, [0.0, 0.1], [slab.thickness])
    assert float(ds.error_estimate) < 1e-8
    assert np.all(ds.p == 0)


@pytest.mark.parametrize("z", [0.700123, 0.900123])
def test_the_last_place_of_a_depth_inside_heavy_layers_is_in_the_estimate(z):
    """p changes by 7e-13 of its largest value with it: more than with the last places of kx and w."""
    slab, beam, x = bp.Slab(bp.lmmd_cell(), 450), bp.GaussianBeam(0.2, z0=-0.1), np.linspace(-0.1, 0.1, 9)
    here, beside = (bp.field(slab, beam, 2500.0, x, at, rtol=1e-9) for at in (z, np.nextafter(z, 1.0)))
    change = float(np.abs(here.p - beside.p).max() / np.abs(here.p).max())
    assert 1e-13 < change < float(here.error_estimate)
