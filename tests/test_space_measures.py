"""`beam_measures` in three dimensions: conservation of energy, closed forms of moments, independent quadratures, symmetries, refusals."""

import warnings

import numpy as np
import pytest
import space_oracles as oracles
from scipy.special import jv

import beamprop as bp

FREQUENCY = 2500.0
K0 = 2 * np.pi * FREQUENCY / 343.0
LOSSLESS, LOSSY = bp.Slab(bp.lmmd_cell(0.05, 0), 450), bp.Slab(bp.lmmd_cell(), 450)
ELLIPSE = bp.GaussianBeam((0.3, 0.15), 45, 0.02, -0.1, azimuth=30.0, y0=-0.03)
WATER = bp.Fluid.from_speed(1000.0, 1500.0)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
_X = np.linspace(-0.05, 0.05, 51)
TRANSDUCERS = {
    "rigid": bp.Piston(0.01, z0=-0.03),
    "soft": bp.Piston(0.01, "soft", z0=-0.03),
    "bowl": bp.Bowl(0.064, 0.064, z0=-0.03),
    "array": bp.Array([(-0.01, 0), (0.01, 0.005)], bp.Piston(0.005, z0=-0.03), angle=10.0, azimuth=20.0),
    "hologram": bp.SourcePlane(_X, _X, np.exp(-(_X**2 + _X[:, None] ** 2) / 0.01**2) * (1 + 30j * _X), z0=-0.03),
}


def quietly(*args, **options):
    """The measures, whatever is said of lobes and of tails that are cut off."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return bp.beam_measures(*args, **options)


# --- power ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("beam", [ELLIPSE, bp.GaussianBeam((0.096, 0.096))])
@pytest.mark.parametrize("after", [bp.AIR, bp.Fluid.from_speed(400.0, 500.0)])
def test_power_is_conserved_without_loss(beam, after):
    slab = bp.Slab(bp.lmmd_cell(0.05, 0), 450, after=after)
    ds = quietly(slab, beam, FREQUENCY, window=0.5)
    assert float(ds.power.sum()) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("name", TRANSDUCERS)
def test_power_of_transducers_is_conserved(name):
    ds = quietly(PLATE, TRANSDUCERS[name], 0.5e6, window=0.02, rtol=1e-4)
    assert float(ds.power.sum()) == pytest.approx(1, abs=1e-12)


class Layer:
    """One fluid layer by its four boundary conditions, and what a plane wave of unit p at its face loses in it."""

    def __init__(self, density, bulk_modulus, thickness, outside=(1.25, 343.0), frequency=FREQUENCY):
        self.omega, self.rho, self.bulk, self.d = 2 * np.pi * frequency, density, bulk_modulus, thickness
        self.density, self.k0 = outside[0], self.omega / outside[1]

    def solved(self, k):
        """Reflected, forward, backward, transmitted: (4, n); and kz outside and in the layer."""
        air, q = np.sqrt(self.k0**2 - k**2 + 0j), np.sqrt(self.omega**2 * self.rho / self.bulk - k**2 + 0j)
        y, yl = air / self.density, q / self.rho
        e = np.exp(1j * q * self.d)
        one, none = np.ones_like(q), np.zeros_like(q)
        rows = [[one, -one, -one, none], [-y, -yl, yl, none], [none, e, 1 / e, -one], [none, yl * e, -yl / e, -y]]
        matrix = np.moveaxis(np.array(rows), -1, 0)
        known = np.stack([-one, -y, none, none], axis=-1)
        return np.linalg.solve(matrix, known[..., None])[..., 0].T, air, q

    def absorbed(self, k):
        """Loss over the incident flux."""
        return self.loss(k) / (np.sqrt(self.k0**2 - k**2) / (2 * self.omega * self.density))

    def loss(self, k):
        """The integral of omega (Im rho |v|^2 - Im(1/K) ... |p|^2)/2 over its thickness, for unit incident p."""
        (_, a, b, _), _, q = self.solved(k)
        g, w = np.polynomial.legendre.leggauss(60)
        z, w = (g[:, None] + 1) * self.d / 2, w[:, None] * self.d / 2
        forth, back = a * np.exp(1j * q * z), b * np.exp(-1j * q * z)
        p, along, across = forth + back, 1j * q * (forth - back), 1j * k * (forth + back)
        speed2 = (np.abs(along) ** 2 + np.abs(across) ** 2) / np.abs(self.omega * self.rho) ** 2
        loss = self.omega / 2 * (self.rho.imag * speed2 + np.imag(1 / self.bulk) * np.abs(p) ** 2)
        return np.sum(w * loss, axis=0)


def azimuthal_mean(beam, k, directions=600):
    """Of |S|^2, by the closed form of S."""
    turn = 2 * np.pi * np.arange(directions) / directions
    source = oracles.Gaussian(beam, K0)
    return np.mean(source.spectrum(np.outer(k, np.cos(turn)), np.outer(k, np.sin(turn))) ** 2, axis=1)


@pytest.mark.parametrize("beam", [ELLIPSE, bp.GaussianBeam((0.05, 0.05), z0=-0.02)])
def test_reflected_transmitted_and_absorbed_power_are_all(beam):
    """What is absorbed is the integral of the losses inside, by a linear system of four plane waves for each radial wavenumber."""
    lossy = bp.Fluid(2.0 + 0.3j, bp.AIR.bulk_modulus * (1 - 0.1j))
    ds = quietly(bp.Slab.uniform(lossy, 0.08), beam, FREQUENCY, rtol=1e-8)
    layer = Layer(2.0 + 0.3j, bp.AIR.bulk_modulus * (1 - 0.1j), 0.08)
    g, w = np.polynomial.legendre.leggauss(800)
    alpha = (g + 1) * np.pi / 4
    k = K0 * np.sin(alpha)
    incident = w * azimuthal_mean(beam, k) * k * (K0 * np.cos(alpha)) ** 2
    absorbed = np.sum(incident * layer.absorbed(k)) / np.sum(incident)
    reflected = np.sum(incident * np.abs(layer.solved(k)[0][0]) ** 2) / np.sum(incident)
    assert absorbed > 0.1
    assert float(ds.power.sum()) + absorbed == pytest.approx(1, abs=1e-10)
    assert float(ds.power.sel(side="reflected")) == pytest.approx(reflected, rel=1e-9)


def test_a_soft_pistons_power_by_its_own_integral():
    """|S|^2 = (2 J1(ka)/ka)^2, in water through a plate."""
    plate = Layer(1900.0, 1900.0 * 2800.0**2, 0.0065, (1000.0, 1500.0), 0.5e6)
    k0 = plate.k0
    ds = quietly(PLATE, TRANSDUCERS["soft"], 0.5e6, window=0.02, rtol=1e-8)
    g, w = np.polynomial.legendre.leggauss(3000)
    alpha = (g + 1) * np.pi / 4
    k = k0 * np.sin(alpha)
    incident = w * (2 * jv(1, k * 0.01) / (k * 0.01)) ** 2 * k * np.cos(alpha) ** 2
    share = np.abs(plate.solved(k)[0][3]) ** 2
    assert float(ds.power[1]) == pytest.approx(np.sum(incident * share) / np.sum(incident), rel=1e-7)


# --- moments and directions -------------------------------------------------------------------------------


def by_plane_waves(beam, distance, count=400):
    """Of a beam without evanescent waves after a distance in air: mean and covariance of x and y, by Parseval and rays (kx, ky)/kz, which are exact.

    With p(k) = S exp(i kz d) the mean of x is <d kx/kz> and its variance a^2/4 + <(d kx/kz)^2> less the mean's square, S being real.
    """
    source = oracles.Gaussian(beam, K0)
    g, w = np.polynomial.legendre.leggauss(count)
    (kx, wx), (ky, wy) = (
        (tilt + 8 / a * g, w * np.exp(-((8 * g) ** 2) / 2)) for tilt, a in zip(source.tilt, source.a, strict=True)
    )
    kz = np.sqrt(K0**2 - kx**2 - ky[:, None] ** 2)
    weight = np.outer(wy, wx)
    weight /= weight.sum()
    rays = np.stack(np.broadcast_arrays(kx / kz, ky[:, None] / kz)).reshape(2, -1) * distance
    mean = rays @ weight.ravel()
    off = rays - mean[:, None]
    return mean, off * weight.ravel() @ off.T + np.diag([a**2 / 4 for a in source.a]), (kx, ky[:, None], kz, weight)


@pytest.mark.parametrize("angle", [0.0, 35.0])
def test_moments_of_the_whole_plane_are_those_of_rays(angle):
    """In a window that holds all of it: centroid, second moments, ellipticity and orientation of an ellipse that spreads in air."""
    beam = bp.GaussianBeam((1.2, 1.8), angle, 0.1, -0.3, azimuth=20.0, y0=-0.2)
    air = bp.Slab.uniform(bp.AIR, 1.7)
    ds = quietly(air, beam, FREQUENCY, window=4.0).sel(side="transmitted")
    mean, covariance, _ = by_plane_waves(beam, 2.0)
    assert ds.centroid.values == pytest.approx(mean + np.array([0.1, -0.2]), abs=1e-8)
    assert ds.width_second_moment.values == pytest.approx(4 * np.sqrt(np.diag(covariance)), rel=1e-8)
    values, axes = np.linalg.eigh(covariance)
    assert float(ds.ellipticity) == pytest.approx(np.sqrt(values[0] / values[1]), rel=1e-8)
    direction = np.degrees(np.arctan2(*axes[::-1, 1]))
    assert (float(ds.orientation) - direction + 90) % 180 - 90 == pytest.approx(0, abs=1e-6)
    ray = 2.0 * np.tan(np.radians(angle)) * np.array([np.cos(np.radians(20)), np.sin(np.radians(20))])
    assert ds.lateral_shift.values == pytest.approx(mean - ray, abs=1e-8)


def test_the_part_above_a_hundredth_holds_nearly_all():
    """A Gaussian's second moments there are 4e-4 less than those of all of it."""
    beam = bp.GaussianBeam((0.5, 0.3), 20, azimuth=-40.0)
    with pytest.warns(RuntimeWarning, match="no beam on a side"):
        ds = bp.beam_measures(bp.Slab.uniform(bp.AIR, 0.05), beam, 4000.0).sel(side="transmitted")
    a = np.array(beam.radii)
    cut = (
        1 - 1e-4 * (1 + np.log(1e4)) - 1e-4
    )  # of r^2 exp(-2 r^2) beyond exp(-r^2) = 0.01, over that of all, less its share of the power
    assert ds.width_second_moment.values == pytest.approx(2 * a * np.sqrt(cut), rel=2e-3)
    assert ds.width_1e2.values == pytest.approx(2 * a, rel=5e-3)
    assert float(ds.area) == pytest.approx(np.pi / 4 * 0.5 * 0.3, rel=5e-3)
    assert ds.moments_to.values - ds.moments_from.values == pytest.approx(2 * a * np.sqrt(np.log(100)), rel=0.03)
    assert ds.crossings.values.tolist() == [2, 2]


def test_directions_are_means_over_plane_waves():
    beam = bp.GaussianBeam((1.2, 1.8), 35, azimuth=20.0)
    ds = quietly(bp.Slab.uniform(bp.AIR, 1.0), beam, FREQUENCY, window=3.0).sel(side="transmitted")
    _, _, (kx, ky, kz, weight) = by_plane_waves(beam, 1.0)
    flux = weight * kz / np.sum(weight * kz)
    x, y, z = (float(np.sum(flux * k / K0)) for k in (kx, ky, kz))
    assert float(ds.far_angle) == pytest.approx(np.degrees(np.arctan2(np.hypot(x, y), z)), abs=1e-8)
    assert float(ds.far_azimuth) == pytest.approx(np.degrees(np.arctan2(y, x)), abs=1e-8)
    spreads = []
    for k in (kx, ky):
        angle = np.degrees(np.arcsin(k / K0)) + 0 * flux
        spreads.append(2 * np.sqrt(np.sum(flux * angle**2) - np.sum(flux * angle) ** 2))
    assert ds.divergence.values == pytest.approx(spreads, rel=1e-8)


def test_goos_haenchen_shift_is_along_the_azimuth():
    """Total reflection at 60 degrees of a wide beam: the phase's slope (Artmann), towards the azimuth."""
    fast = bp.Fluid.from_speed(1.0, 600.0)
    slab = bp.Slab.uniform(fast, 0.5, after=fast)
    k = K0 * np.sin(np.radians(60))
    r = bp.scattering(slab, FREQUENCY, kx=np.array([k - 1e-3, k, k + 1e-3])).r.values
    artmann = -np.imag((r[2] - r[0]) / (2e-3 * r[1]))
    ds = quietly(slab, bp.GaussianBeam((4.0, 4.0), 60, azimuth=25.0), FREQUENCY).sel(side="reflected")
    direction = np.array([np.cos(np.radians(25)), np.sin(np.radians(25))])
    assert ds.lateral_shift.values @ direction == pytest.approx(artmann, rel=2e-2)
    across = ds.lateral_shift.values @ np.array([-direction[1], direction[0]])
    assert abs(across) < 0.02 * artmann


# --- symmetries and limits --------------------------------------------------------------------------------


def test_turned_by_a_quarter_x_and_y_are_swapped():
    first = bp.beam_measures(LOSSY, bp.GaussianBeam((0.2, 0.1), 30, z0=-0.1), FREQUENCY)
    turned = bp.beam_measures(LOSSY, bp.GaussianBeam((0.1, 0.2), 30, z0=-0.1, azimuth=90.0), FREQUENCY)
    for name in first:
        a, b = first[name].values, turned[name].values
        if "axis" in first[name].dims:
            np.testing.assert_allclose(b[:, ::-1], a, rtol=1e-9, atol=1e-9, err_msg=name)
        elif name in ("orientation", "far_azimuth"):
            np.testing.assert_allclose((b - a) % 180, 90, rtol=1e-8, err_msg=name)
        else:
            np.testing.assert_allclose(b, a, rtol=1e-9, err_msg=name)


def test_a_circular_beam_on_the_normal_has_no_orientation():
    ds = bp.beam_measures(LOSSY, bp.GaussianBeam(0.096), FREQUENCY, azimuth=0.0)
    assert ds.ellipticity.values == pytest.approx([1, 1], abs=1e-9)
    assert ds.orientation.values.tolist() == [0, 0]
    assert ds.far_azimuth.values.tolist() == [0, 0]
    assert ds.centroid.values == pytest.approx(np.zeros((2, 2)), abs=1e-12)


def test_ever_longer_ellipses_tend_to_two_dimensions():
    """Powers and directions, by 4 a doubling."""
    flat = quietly(LOSSY, bp.GaussianBeam(0.096, 20), FREQUENCY, rtol=1e-9)
    apart = []
    for wy in (0.6, 1.2):
        ds = quietly(LOSSY, bp.GaussianBeam((0.096, wy), 20), FREQUENCY, rtol=1e-6)
        apart.append(
            [
                float(np.max(abs(ds.power - flat.power))),
                float(np.max(abs(ds.divergence.sel(axis="x") - flat.divergence))),
            ]
        )
    assert np.array(apart[0]) / apart[1] == pytest.approx([4, 4], abs=0.2)


# --- what is said, and refused ----------------------------------------------------------------------------


def test_guided_waves_that_are_cut_off_are_said():
    """Those of the slab with the mean density 0 run along for ever, falling as 1/sqrt(r)."""
    slab = bp.Slab(bp.lmmd_cell(0, 0), 45)
    with pytest.warns(RuntimeWarning) as said:
        ds = bp.beam_measures(slab, bp.GaussianBeam((0.096, 0.096), 45), FREQUENCY, rtol=1e-4)
    assert any("of its peak only, in the widest window tried" in str(w.message) for w in said)
    assert float(ds.rim.max()) > 0.01
    assert float(ds.power.sum()) == pytest.approx(1, abs=1e-9)


def test_a_window_is_a_square_about_the_ray():
    ds = quietly(LOSSLESS, ELLIPSE, FREQUENCY, window=0.4)
    ray = 0.1 * np.tan(np.radians(45)) * np.array([np.cos(np.radians(30)), np.sin(np.radians(30))]) + [0.02, -0.03]
    near = ds.sel(side="reflected")
    assert (near.moments_from.values + near.moments_to.values) / 2 == pytest.approx(ray, abs=1e-9)
    assert near.moments_to.values - near.moments_from.values == pytest.approx([0.8, 0.8], rel=1e-9)


def test_dimensions_and_labels():
    ds = bp.beam_measures(LOSSY, ELLIPSE, [2400.0, 2500.0], [0, 45.0])
    assert ds.fwhm.dims == ("frequency", "angle", "side", "axis")
    assert ds.area.dims == ("frequency", "angle", "side")
    assert ds.attrs["geometry"] == "3-D"
    assert ds.azimuth.item() == 30.0
    assert all(v.attrs["long_name"] for v in ds.variables.values())
    alone = bp.beam_measures(LOSSY, ELLIPSE, 2500.0)
    for name in ds:
        np.testing.assert_allclose(ds[name].isel(frequency=1, angle=1).values, alone[name].values, rtol=1e-12)
    assert "axis" not in bp.beam_measures(LOSSY, bp.GaussianBeam(0.2), FREQUENCY).dims


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"beam": bp.Piston(0.05)}, "beam: expected a sharp edge in front of the near face"),
        (
            {"beam": bp.Slits(0.01, 0.04, 2, -0.1)},
            "beam: expected one GaussianBeam, Piston, Bowl, SourcePlane or Array in",
        ),
        ({"window": -1.0}, "window: expected"),
        ({"azimuth": "north"}, "azimuth: expected"),
        ({"slab": bp.lmmd_emt_slab(LOSSY)}, "density_x: expected none, or density"),
    ],
)
def test_refusals_name_the_argument(changes, message):
    given = {"slab": LOSSY, "beam": ELLIPSE, "frequency": FREQUENCY, "azimuth": 0.0} | changes
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.beam_measures(**given)


@pytest.mark.parametrize("question", [bp.beam_width, bp.beam_measures])
def test_both_refuse_in_their_own_words(question):
    """Not in those of a field, whose y and z nobody gave."""
    backward = bp.Slab(bp.lmmd_cell(), 5, after=bp.Fluid(-1.2 + 0.001j, -1.4e5 - 1j))
    for slab, beam, message in (
        (LOSSY, bp.Piston(0.05), "beam: expected a sharp edge in front of the near face"),
        (backward, ELLIPSE, "after: expected a half-space that carries forward waves"),
        (bp.lmmd_emt_slab(LOSSY), ELLIPSE, "density_x: expected none, or density itself, in three dimensions"),
    ):
        with pytest.raises(ValueError, match=f"^{message}"):
            question(slab, beam, FREQUENCY)
