"""Identities of open fields: superposition, shifts, mirror images, continuity, and grids that do not matter."""

import numpy as np
import pytest
from plane_waves import K0, F, amplitudes

import beamprop as bp
from beamprop.contour import paths, sums

SLAB = bp.Slab(bp.lmmd_cell(), 60)
LOSSLESS = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60)
Z = np.array([-0.08, -0.02, 0.0, 0.0507, SLAB.thickness, 0.2])
RTOL = 1e-9


def pressure(beam, x, z=Z, slab=SLAB, **options):
    return bp.field(slab, beam, F, x, z, rtol=RTOL, **options).p.values


def assert_close(a, b, rtol=4 * RTOL):
    """Two fields agree to rtol of the largest |p| of each plane."""
    largest = np.abs(b).max(axis=-1, keepdims=True)
    assert np.max(np.abs(a - b) / largest) <= rtol


def test_superposition():
    """The field of a sum of profiles is the sum of their fields."""
    x = np.linspace(-0.4, 0.4, 161)
    left, right = np.exp(-((x / 0.06) ** 2)), 1j * np.exp(-(((x - 0.1) / 0.05) ** 2) + 20j * x)
    out = np.linspace(-0.5, 0.5, 40)
    parts = [pressure(bp.Profile(x, p, z0=-0.1), out) for p in (left, right)]
    whole = pressure(bp.Profile(x, 2 * left - (1 + 1j) * right, z0=-0.1), out)
    assert_close(whole, 2 * parts[0] - (1 + 1j) * parts[1])


@pytest.mark.parametrize("slab", [SLAB, LOSSLESS], ids=["lossy", "lossless"])
@pytest.mark.parametrize("angle", [0.0, 60.0])
def test_a_beam_moved_sideways_takes_its_field_along(slab, angle):
    """p of a beam at x0, taken at x + x0, is p of the beam at 0."""
    x = np.linspace(-0.3, 0.5, 33)
    centred = pressure(bp.GaussianBeam(0.08, angle, z0=-0.1), x, slab=slab)
    moved = pressure(bp.GaussianBeam(0.08, angle, x0=0.37, z0=-0.1), x + 0.37, slab=slab)
    assert_close(moved, centred)


@pytest.mark.parametrize("slab", [SLAB, LOSSLESS], ids=["lossy", "lossless"])
def test_a_gaussian_and_its_samples_are_one_beam(slab):
    """A sampled Gaussian launches the field of the Gaussian."""
    x = np.linspace(-0.36, 0.36, 181)
    beam = bp.GaussianBeam(0.09, z0=-0.1)
    sampled = bp.Profile(x, beam.profile(x, K0), z0=-0.1)
    out = np.linspace(-0.4, 0.4, 31)
    assert_close(pressure(sampled, out, slab=slab), pressure(beam, out, slab=slab))


def test_the_grid_of_x_does_not_matter():
    """Even, uneven, reversed and single positions give the same field."""
    beam = bp.GaussianBeam(0.08, 35.0, z0=-0.1)
    even = np.linspace(-0.5, 0.5, 512)
    want = pressure(beam, even)
    pick = np.sort(np.random.default_rng(0).choice(512, 40, replace=False))
    assert_close(pressure(beam, even[pick]), want[:, pick])
    assert_close(pressure(beam, even[pick][::-1]), want[:, pick][:, ::-1])
    largest = np.abs(want).max(axis=-1)
    assert np.all(np.abs(pressure(beam, float(even[200])) - want[:, 200]) <= 4 * RTOL * largest)


def test_the_set_of_z_does_not_matter():
    """Planes requested together, in any order, or one by one give the same field."""
    beam, x = bp.GaussianBeam(0.08, 20.0, z0=-0.1), np.linspace(-0.3, 0.3, 21)
    together = pressure(beam, x)
    assert_close(pressure(beam, x, Z[::-1])[::-1], together)
    assert_close(np.array([pressure(beam, x, float(z)) for z in Z]), together)


@pytest.mark.parametrize("boundary", ["open", "periodic"])
def test_angles_of_a_sweep_are_the_single_angles(boundary):
    """An angle sweep shares one response and changes no number."""
    x, angles = (np.arange(240) - 120) * 0.005, np.array([-70.0, 0.0, 30.0, 85.0])
    beam = bp.GaussianBeam(0.096, angle=12.0, z0=-0.1)
    sweep = pressure(beam, x, angle=angles, boundary=boundary)
    for row, angle in zip(sweep, angles, strict=True):
        assert_close(row, pressure(beam, x, angle=angle, boundary=boundary))
        assert_close(row, pressure(bp.GaussianBeam(0.096, angle, z0=-0.1), x, boundary=boundary))


def test_frequencies_and_angles_of_a_width_table_are_the_single_ones():
    """Every entry of a table of widths is what a call for it alone answers."""
    frequency, angle = np.array([2100.0, 2500.0, 2900.0]), np.array([0.0, 40.0])
    table = bp.beam_width(LOSSLESS, bp.GaussianBeam(0.096, z0=-0.05), frequency, angle, rtol=RTOL)
    for f in frequency:
        for a in angle:
            alone = bp.beam_width(LOSSLESS, bp.GaussianBeam(0.096, a, z0=-0.05), f, rtol=RTOL)
            for name in ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air", "peak_out"):
                assert table[name].sel(frequency=f, angle=a).item() == pytest.approx(alone[name].item(), rel=1e-7)


def even_error(beam, z, rtol):
    """Largest |p(x) - p(-x)| over the largest |p| of each plane."""
    x = np.linspace(0.0, 0.4, 21)
    right, left = (bp.field(SLAB, beam, F, way * x, z, rtol=rtol).p.values for way in (1, -1))
    return np.max(np.abs(right - left) / np.abs(right).max(axis=-1, keepdims=True))


def test_mirror_symmetry_at_normal_incidence():
    """An even source at normal incidence has an even field."""
    assert even_error(bp.GaussianBeam(0.08, z0=-0.1), Z, RTOL) < 4 * RTOL


def test_mirror_symmetry_of_slits():
    """Two slits have an even field behind the slab, at the default rtol."""
    assert even_error(bp.Slits(0.02, 0.05, z0=-0.02), SLAB.thickness, 1e-8) < 4e-8


def test_opposite_angles_are_mirror_images():
    """p(x) at -theta is p(-x) at theta."""
    x = np.linspace(-0.4, 0.4, 41)
    plus, minus = (pressure(bp.GaussianBeam(0.08, a, z0=-0.1), x) for a in (55.0, -55.0))
    assert_close(minus[:, ::-1], plus)


def faces(slab):
    """The near and far face, the first layer faces and some in the middle, with the densities on both sides."""
    layers = slab.cell.layers
    inner = np.concatenate([[0.0], np.cumsum([layer.thickness for layer in layers])])
    rho = [layer.fluid.density for layer in layers]
    out = [(0.0, slab.before.density, rho[0]), (slab.thickness, rho[-1], slab.after.density)]
    for period in (0, slab.periods // 2):
        start = period * slab.cell.thickness
        out += [(start + inner[j + 1], rho[j], rho[(j + 1) % len(rho)]) for j in (0, 4, len(rho) - 1)]
    return out


@pytest.mark.parametrize("slab", [SLAB, LOSSLESS], ids=["lossy", "lossless"])
def test_pressure_and_velocity_are_continuous_at_every_face(slab):
    """p and (1/rho) dp/dz agree on the two sides of the near face, the far face and the layers' faces."""
    x, h = np.linspace(-0.2, 0.2, 9), 2e-7
    for face, rho_front, rho_behind in faces(slab):
        z = face + h * np.array([-2, -1, -1e-5, 0, 1e-5, 1, 2])
        p = pressure(bp.GaussianBeam(0.08, 30.0, z0=-0.1), x, z, slab=slab)
        assert_close(p[2:3], p[4:5], 2e-8)
        assert_close(p[3:4], p[4:5], 2e-8)
        front = (3 * p[3] - 4 * p[1] + p[0]) / (2 * h) / rho_front
        behind = (-3 * p[3] + 4 * p[5] - p[6]) / (2 * h) / rho_behind
        assert np.max(np.abs(front - behind)) < 1e-3 * np.max(np.abs(behind))


def line_and_sums():
    """A straight contour that fits an FFT of 720 points, a slab's response on it, and amplitudes on both sides of kx = 0."""
    reach = paths.Extent(K0, K0, 2.2 * K0, 0.8, 0.2, 0.3)
    n, dx = 720, 0.005
    line = paths.straight_contour(paths.plan_straight(reach, 1e-8)._replace(window=n * dx))
    h = amplitudes(LOSSLESS, line.k, np.linspace(0.001, 0.05, 5))[2]
    beam = bp.GaussianBeam(0.05, 50.0, x0=0.1)
    return line, h, *sums.amplitudes(line, lambda k: beam.spectrum(k, K0), 0.1), (np.arange(240) - 130) * dx, n


def test_the_fast_sum_is_the_matrix_product():
    """Two FFTs a plane and the plain sum over the same nodes give the same field."""
    line, h, right, left, x, n = line_and_sums()
    assert np.any(left)
    fast, slow = sums.fft_sum(line, h, right, left, x, n), sums.direct_sum(line, h, right, left, x)
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-12 * np.abs(slow).max())


def test_the_fast_sum_folds_a_band_wider_than_its_grid():
    """Fewer points than plane waves: what falls beyond the grid's band is folded back exactly."""
    line, h, right, left, x, n = line_and_sums()
    coarse, length = x[::20], n // 20
    assert line.k.size > length
    fast = sums.fft_sum(line, h, right, left, coarse, length)
    slow = sums.direct_sum(line, h, right, left, coarse)
    np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-12 * np.abs(slow).max())


def test_a_wide_period_and_enough_loss_are_open_space():
    """The periodic sum tends to the open field where the slab is lossy; a narrow period does not."""
    slab = bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 60)
    x = np.linspace(-0.3, 0.3, 31)
    beam = bp.GaussianBeam(0.096)
    z = np.array([slab.thickness])
    open_field = pressure(beam, x, z, slab)
    errors = [np.abs(pressure(beam, x, z, slab, boundary="periodic", period=w) - open_field).max() for w in (0.8, 40.0)]
    assert errors[1] < 1e-4 * np.abs(open_field).max()
    assert errors[0] > 10 * errors[1]
