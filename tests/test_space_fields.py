"""Fields in three dimensions against independent quadratures: polar, tensor, complex radius, Rayleigh's integral."""

import tracemalloc
import warnings

import numpy as np
import pytest
import space_oracles as oracles

import beamprop as bp

FREQUENCY = 2500.0
LOSSLESS, LOSSY = bp.Slab(bp.lmmd_cell(0.05, 0), 450), bp.Slab(bp.lmmd_cell(), 450)
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
X, Y = np.array([-0.8, -0.3, 0.0, 0.05, 0.4, 0.9]), np.array([-0.5, 0.0, 0.02, 0.6])
PLACES = tuple(v.ravel() for v in np.meshgrid(X, Y))
BEAMS = {
    "circular": bp.GaussianBeam(0.096, z0=-0.1),
    "tilted": bp.GaussianBeam(0.096, 45, 0.02, -0.1, azimuth=200.0, y0=-0.03),
    "elliptical": bp.GaussianBeam((0.3, 0.15), 45, z0=-0.1, azimuth=30.0),
}
SLABS = {
    "lossless": LOSSLESS,
    "lossy": LOSSY,
    "air": bp.Slab.uniform(bp.AIR, 0.1),
    "water behind": bp.Slab.uniform(bp.Fluid.from_speed(2.0, 500.0), 0.1, after=WATER),
    "water in front": bp.Slab.uniform(bp.Fluid.from_speed(800.0, 1200.0), 0.1, before=WATER),
}


def planes_of(slab):
    """In front, in the slab, at its far face and behind."""
    return np.array([-0.1, 0.3 * slab.thickness, slab.thickness, slab.thickness + 0.2])


def errors(p, reference):
    """By plane, over the largest |p| there; (Z, …)."""
    flat, known = p.reshape(len(p), -1), reference.reshape(len(p), -1)
    return np.abs(flat - known).max(axis=1) / np.abs(known).max(axis=1)


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-11])
@pytest.mark.parametrize("beam", BEAMS)
@pytest.mark.parametrize("slab", SLABS)
def test_rtol_is_kept_against_a_polar_quadrature(slab, beam, rtol):
    medium, source = SLABS[slab], BEAMS[beam]
    z = planes_of(medium)
    ds = bp.field(medium, source, FREQUENCY, X, z, y=Y, rtol=rtol)
    error = errors(ds.p.values, oracles.polar_field(medium, FREQUENCY, source, PLACES, z))
    print(error, float(ds.error_estimate))
    assert np.max(error) < rtol
    assert np.max(error) < 3 * float(ds.error_estimate) + 2e-12  # what the quadrature itself leaves
    assert float(ds.error_estimate) < rtol


def test_of_450_different_layers():
    slab = next(iter(bp.tolerance(bp.Slab(bp.lmmd_cell(), 45), thickness=0.01, count=1, seed=1)))
    p = bp.field(slab, BEAMS["tilted"], FREQUENCY, X, [0.05, slab.thickness], y=Y, rtol=1e-9).p.values
    reference = oracles.polar_field(slab, FREQUENCY, BEAMS["tilted"], PLACES, [0.05, slab.thickness])
    assert np.max(errors(p, reference)) < 1e-9


@pytest.mark.parametrize("beam", BEAMS)
def test_a_tensor_of_two_bent_contours_agrees(beam):
    z, source = planes_of(LOSSY)[[0, 2]], BEAMS[beam]
    p = bp.field(LOSSY, source, FREQUENCY, X, z, y=Y, rtol=1e-9).p.values
    assert np.max(errors(p, oracles.tensor_field(LOSSY, FREQUENCY, source, PLACES, z))) < 1e-9


def test_a_tilted_circular_beam_is_one_along_the_normal_at_complex_places():
    """exp(-r^2/a^2 + i K.x) = exp(-K^2 a^2/4) exp(-|x - i K a^2/2|^2/a^2), and the slab does not know where x lies."""
    source, z = BEAMS["tilted"], planes_of(LOSSY)
    p = bp.field(LOSSY, source, FREQUENCY, X, z, y=Y, rtol=1e-10).p.values
    k0 = 2 * np.pi * FREQUENCY / 343.0
    moved = oracles.Gaussian(source, k0)
    a = moved.a[0]
    u, v = (at - at0 - 0.5j * t * a**2 for at, at0, t in zip(PLACES, moved.at, moved.tilt, strict=True))
    along_normal = bp.GaussianBeam(0.096, z0=-0.1)
    reference = oracles.round_profile(LOSSY, FREQUENCY, along_normal, np.sqrt(u**2 + v**2), z)
    factor = np.exp(-(np.hypot(*moved.tilt) ** 2) * a**2 / 4)
    assert np.max(errors(p, factor * reference)) < 1e-10


@pytest.mark.parametrize("beam", BEAMS)
def test_rayleighs_integral_in_air(beam):
    air, source, z = bp.Slab.uniform(bp.AIR, 0.1), BEAMS[beam], np.array([0.2, 1.0, 5.0])
    p = bp.field(air, source, FREQUENCY, X, z, y=Y, rtol=1e-9).p.values
    assert np.max(errors(p, oracles.rayleigh_field(2 * np.pi * FREQUENCY / 343.0, source, PLACES, z))) < 1e-9


@pytest.mark.parametrize("shape", ["cut", "plane", "volume"])
def test_cuts_planes_and_volumes_are_the_same_field(shape):
    """By rows, by planes and by low rank, at positions that they share."""
    source, x, y = BEAMS["elliptical"], np.linspace(-0.7, 0.7, 15), np.linspace(-0.6, 0.6, 13)
    z = bp.faces(LOSSLESS, 210, after=0.2)
    grids = {"cut": (x, y[7], z), "plane": (x, y, z[70]), "volume": (x, y, z)}
    gx, gy, gz = grids[shape]
    ds = bp.field(LOSSLESS, source, FREQUENCY, gx, gz, y=gy, rtol=1e-9)
    assert float(ds.error_estimate) < 1e-9
    p = np.atleast_1d(ds.p.sel(z=z[70]) if shape != "plane" else ds.p)
    rows = y if shape != "cut" else y[7:8]
    at = tuple(v.ravel() for v in np.meshgrid(x, rows))
    reference = oracles.polar_field(LOSSLESS, FREQUENCY, source, at, z[70:71])
    peak = np.abs(oracles.polar_field(LOSSLESS, FREQUENCY, source, (x, 0 * x), z[70:71])).max()
    assert np.max(np.abs(p.ravel() - reference.ravel())) < 1e-9 * peak


def test_many_angles_are_interpolated():
    angles = np.linspace(-30, 50, 41)
    source = bp.GaussianBeam((0.2, 0.1), azimuth=70.0, z0=-0.1)
    ds = bp.field(LOSSY, source, FREQUENCY, X, [0.5], angle=angles, y=Y, rtol=1e-8)
    for i in (0, 20, 33):
        tilted = bp.GaussianBeam((0.2, 0.1), angles[i], azimuth=70.0, z0=-0.1)
        reference = oracles.polar_field(LOSSY, FREQUENCY, tilted, PLACES, [0.5])
        assert np.max(errors(ds.p.values[i], reference)) < 1e-8
    assert np.all(ds.error_estimate < 1e-8)


def test_a_backward_mode_on_the_wrong_side_is_put_right():
    """A plate of negative density: its backward mode lies 2.4/m below the axis, above the contour and below that of the quadrature."""
    slab = bp.Slab.uniform(bp.Fluid(1.25 * (-0.6 + 0.006j), bp.AIR.bulk_modulus), 0.01)
    source, z = bp.GaussianBeam(0.05, z0=-0.02), np.array([0.005, 0.02])
    modes = bp.guided_modes(slab, FREQUENCY)
    assert modes.kx.values[modes.direction.values < 0].imag == pytest.approx(-2.35, abs=0.01)
    ds = bp.field(slab, source, FREQUENCY, X, z, y=Y, rtol=1e-9)
    reference = oracles.round_profile(slab, FREQUENCY, source, np.hypot(*PLACES), z, depth=1.0, panels=300)
    assert np.max(errors(ds.p.values, reference)) < 1e-9
    assert float(ds.error_estimate) < 1e-9


def test_a_volume_is_made_in_its_own_memory():
    """Beside the answer less than half of it is held at a time, at the rtol and the angle that take the most."""
    x, z = np.linspace(-0.7, 0.7, 160), np.linspace(-0.1, 1.3, 220)
    question = LOSSLESS, bp.GaussianBeam(0.137, 45, z0=-0.1), FREQUENCY, x, z
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bp.HintWarning)
        tracemalloc.start()
        ds = bp.field(*question, y=x, rtol=1e-11)
        held = tracemalloc.get_traced_memory()[1] - ds.p.nbytes
        tracemalloc.stop()
    print(held / 2**20, ds.p.nbytes / 2**20)
    assert float(ds.error_estimate) < 1e-11
    assert held < 40 * 2**20
