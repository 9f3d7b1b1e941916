"""The power through planes in three dimensions: closed forms, far fields, sums over planes, absorption, refusals."""

import warnings

import numpy as np
import pytest
from scipy.special import dawsn, j0, j1
from test_space_measures import ELLIPSE, FREQUENCY, K0, PLATE, TRANSDUCERS, WATER, Layer, azimuthal_mean
from test_space_sums import PAIR, UNLIKE

import beamprop as bp

AIR = bp.Slab.uniform(bp.AIR, 0.05)
LOSSY, LOSSLESS = bp.Slab(bp.lmmd_cell(), 45), bp.Slab(bp.lmmd_cell(0.05, 0), 450)
OPEN_WATER = bp.Slab.uniform(WATER, 0.01, background=WATER)
STEEL = bp.Slab.uniform(bp.Solid(7900.0, 5900.0, 3200.0), 2e-3, background=WATER)


def power(slab, beam, frequency, z, **options):
    """Through planes z, with the stated error kept."""
    ds = bp.field(slab, beam, frequency, 0.0, z, y=0.0, variables="power_through", **options)
    assert np.all(ds.error_estimate_power_through < 1e-8)
    return ds.power_through.values


def gauss(ends, count=40):
    """Gauss's rule on panels between ends."""
    g, w = np.polynomial.legendre.leggauss(count)
    half, middle = np.diff(ends)[:, None] / 2, (ends[1:] + ends[:-1])[:, None] / 2
    return (middle + half * g).ravel(), (half * w).ravel()


# --- what is launched -------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", [0.03, 0.3])
def test_a_gaussian_beams_power_is_dawsons_integral(width):
    """(1/4 pi) (pi a^2)^2/(rho c) integral exp(-a^2 k^2/2) cos k dk over waves that propagate, on all planes of air."""
    beam = bp.GaussianBeam((width, width), x0=0.1, y0=-0.2, z0=-0.05)
    a = beam.radii[0]
    v = K0 * a / np.sqrt(2)
    known = np.pi * a**4 * K0**2 / (4 * 1.25 * 343.0) * (1 / (2 * v**2) - dawsn(v) / (2 * v**3))
    assert power(AIR, beam, FREQUENCY, [-0.05, -0.01, 0.0, 0.02, 0.05, 3.0]) == pytest.approx(known, rel=1e-12, abs=0)


@pytest.mark.parametrize("radius", [1e-4, 0.003, 0.02])
def test_a_rigid_pistons_power_is_that_of_its_radiation_resistance(radius):
    """|u|^2/2 rho c pi a^2 (1 - J1(2ka)/ka)."""
    k = 2 * np.pi * 0.5e6 / 1500.0
    v = k * radius
    resistance = 1 - j1(2 * v) / v if v > 0.1 else v**2 / 2 - v**4 / 12
    known = 2.0**2 / (2 * 1.5e6) * np.pi * radius**2 * resistance
    piston = bp.Piston(radius, pressure=2.0, z0=-0.03)
    assert power(OPEN_WATER, piston, 0.5e6, [-0.03, 0.0, 0.2]) == pytest.approx(
        known, rel=1e-7 if v < 0.1 else 1e-10, abs=0
    )


def on_a_disc(radius, count=16, directions=48):
    """Places and areas of Gauss's rule along the radius, and of even directions."""
    r, w = gauss(np.array([0.0, radius]), count)
    turn = 2 * np.pi * np.arange(directions) / directions
    weight = np.outer(w * r, np.full(directions, 2 * np.pi / directions))
    return r[:, None] * np.cos(turn), r[:, None] * np.sin(turn), weight


def surface(source, k):
    """Places (3, n) of a source's surface, what each sends, and whether its far field has a pressure's cos."""
    if isinstance(source, bp.Piston):
        x, y, area = on_a_disc(source.radius)
        z, strength, by_pressure = np.zeros(x.shape), source.pressure * area, source.baffle == "soft"
    elif isinstance(source, bp.Bowl):
        x, y, area = on_a_disc(source.aperture / 2)
        z = source.radius_of_curvature - np.sqrt(source.radius_of_curvature**2 - x**2 - y**2)
        strength, by_pressure = source.pressure * area / (1 - z / source.radius_of_curvature), False
    else:
        (ax, ay), turn = source.radii, np.radians(source.azimuth)
        x, y = 6.5 * ax * np.linspace(-1, 1, 64), 6.5 * ay * np.linspace(-1, 1, 40)[:, None]
        tilt = k * np.sin(np.radians(source.angle)) * (x * np.cos(turn) + y * np.sin(turn))
        strength = np.exp(-((x / ax) ** 2) - (y / ay) ** 2 + 1j * tilt) * (x[1] - x[0]) * (y[1, 0] - y[0, 0])
        x, y = np.broadcast_arrays(x, y)
        z, by_pressure = np.zeros(x.shape), True
    at = np.stack([x + source.x0, y + source.y0, z + source.z0])
    return at.reshape(3, -1), strength.ravel(), by_pressure


def test_power_of_unlike_sources_is_that_of_their_far_field():
    """|p|^2/(2 rho c) over a half sphere, p of Rayleigh's integrals over their surfaces, with what they send together.

    Two pistons, a bowl with its depth, and a tilted elliptical beam, one field over the other.
    """
    frequency = 0.2e6
    k = 2 * np.pi * frequency / 1500.0
    cos, w = gauss(np.array([0.0, 1.0]), 48)
    turn = 2 * np.pi * np.arange(120) / 120
    sin = np.sqrt(1 - cos**2)
    towards = np.stack(
        [np.outer(sin, np.cos(turn)), np.outer(sin, np.sin(turn)), np.outer(cos, np.ones(turn.size))], -1
    )
    p = 0
    for source, weight in zip(UNLIKE.sources, UNLIKE.weights, strict=True):
        at, strength, by_pressure = surface(source, k)
        waves = np.array([np.exp(-1j * k * (row @ at)) @ strength for row in towards])
        p = p + weight * waves * (cos[:, None] if by_pressure else 1.0)
    known = (k / (2 * np.pi)) ** 2 / (2 * 1.5e6) * np.sum(w[:, None] * np.abs(p) ** 2) * (2 * np.pi / turn.size)
    found = power(OPEN_WATER, UNLIKE, frequency, [-0.02, 0.1])
    assert found == pytest.approx(known, rel=1e-9, abs=0)
    alone = [
        abs(w) ** 2 * power(OPEN_WATER, s, frequency, 0.1) for s, w in zip(UNLIKE.sources, UNLIKE.weights, strict=True)
    ]
    assert abs(sum(alone) - known) > 0.01 * known  # they interfere


@pytest.mark.parametrize("weight", [1.0, -1.0, 0.5j])
def test_two_pistons_share_a_mutual_resistance(weight):
    """Their |S|^2 has the mean 1 + |w|^2 + 2 Re(w) J0(k d); as a sum, and as an array, through the plate."""
    k0 = 2 * np.pi * 0.5e6 / 1500.0
    first, second = bp.Piston(0.002, z0=-0.03), bp.Piston(0.002, x0=0.003, y0=0.004, z0=-0.03)
    alpha, w = gauss(np.linspace(0, np.pi / 2, 30))
    k = k0 * np.sin(alpha)
    share = np.abs(Layer(1900.0, 1900.0 * 2800.0**2, 0.0065, (1000.0, 1500.0), 0.5e6).solved(k)[0][3]) ** 2
    mean = (1 + abs(weight) ** 2 + 2 * np.real(weight) * j0(k * 0.005)) * (np.pi * 0.002**2 * 2 * j1(k * 0.002)) ** 2
    known = np.sum(w * mean / (k * 0.002) ** 2 * share * k * k0) / (4 * np.pi * 1.5e6)
    array = bp.Array([(0, 0), (0.003, 0.004)], first, weights=[1, weight])
    for source in (first + weight * second, array):
        assert power(PLATE, source, 0.5e6, [-0.01, 0.003, 0.05]) == pytest.approx(known, rel=1e-10, abs=0)


# --- through slabs ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*TRANSDUCERS, "sum"])
def test_power_of_transducers_is_the_same_through_all_planes_of_a_plate(name):
    """And the transmitted share of what they launch, by `beam_measures`."""
    source, z = (TRANSDUCERS | {"sum": UNLIKE})[name], [-0.02, 0.0, 0.002, 0.004, 0.0065, 0.1]
    through = power(PLATE, source, 0.5e6, z)
    assert np.ptp(through) < 1e-11 * through[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        share = float(bp.beam_measures(PLATE, source, 0.5e6, window=0.02, rtol=1e-5).power.sel(side="transmitted"))
    assert through[-1] / power(OPEN_WATER, source, 0.5e6, 0.1) == pytest.approx(share, rel=1e-7, abs=0)


@pytest.mark.parametrize("after", [bp.AIR, bp.Fluid.from_speed(400.0, 500.0)])
@pytest.mark.parametrize("beam", [ELLIPSE, PAIR])
def test_power_of_beams_is_the_same_through_all_planes_of_layers(beam, after):
    slab = bp.Slab(bp.lmmd_cell(0.05, 0), 450, after=after)
    through = power(slab, beam, FREQUENCY, [-0.1, 0.0, 0.02, slab.thickness, 0.9])
    assert np.ptp(through) < 1e-12 * power(AIR, beam, FREQUENCY, 0.0)


@pytest.mark.parametrize("beam", [ELLIPSE, bp.GaussianBeam((0.05, 0.05), z0=-0.02)])
def test_what_is_missing_behind_is_absorbed(beam):
    """By a linear system of four plane waves for each radial wavenumber, and losses inside; power falls on the way.

    Of the narrow beam, 2 cm before the layer, a tenth of it is that of evanescent waves.
    """
    density, bulk = 2.0 + 0.3j, bp.AIR.bulk_modulus * (1 - 0.1j)
    slab, layer = bp.Slab.uniform(bp.Fluid(density, bulk), 0.08), Layer(density, bulk, 0.08)
    through = power(slab, beam, FREQUENCY, np.linspace(0.0, 0.08, 9), rtol=1e-9)
    assert np.all(np.diff(through) < 0)
    k, w = gauss(np.concatenate([K0 * np.sin(np.linspace(0, np.pi / 2, 30)), K0 + np.geomspace(1e-9, 400.0, 60)]))
    (r, _, _, t), kz, _ = layer.solved(k)
    arriving = w * azimuthal_mean(beam, k) * k * np.exp(2 * kz.imag * beam.z0) / (4 * np.pi)
    admittance = kz / (layer.omega * 1.25)
    assert through[0] == pytest.approx(
        np.sum(arriving * ((1 + r) * np.conj(admittance * (1 - r))).real), rel=1e-9, abs=0
    )
    assert through[0] - through[-1] == pytest.approx(np.sum(2 * arriving * layer.loss(k)), rel=1e-9, abs=0)
    assert through[-1] == pytest.approx(np.sum(arriving * np.abs(t) ** 2 * admittance.real), rel=1e-9, abs=0)
    evanescent = np.sum((2 * arriving * layer.loss(k))[k > K0])
    assert evanescent > (0.09 if beam is not ELLIPSE else 1e-3) * through[0]


def test_evanescent_waves_of_a_piston_feed_a_lossy_layer_close_to_it():
    """They carry none alone, but with their reflection: (1/4 pi) |S|^2 Re((1 + r) Y* (1 - r*)) exp(-2 kappa d) k."""
    density, bulk = 1900.0 * (1 + 0.2j), 1900.0 * 2800.0**2 * (1 - 0.2j)
    slab = bp.Slab.uniform(bp.Fluid(density, bulk), 0.002, background=WATER)
    layer, omega = Layer(density, bulk, 0.002, (1000.0, 1500.0), 0.5e6), 2 * np.pi * 0.5e6
    k0, radius, distance = omega / 1500.0, 0.002, 2e-4
    ends = [k0 * np.sin(np.linspace(0, np.pi / 2, 40)), k0 + np.geomspace(1e-9, 9e4, 300)]
    k, w = gauss(np.concatenate(ends), 20)
    r, kz, _ = layer.solved(k)[0][0], *layer.solved(k)[1:]
    at_face = (1 + r) * np.conj(kz / (omega * 1000.0) * (1 - r)) * np.exp(-2 * kz.imag * distance)
    strength = (np.pi * radius**2 * 2 * j1(k * radius) / (k * radius)) ** 2 * k
    for baffle, driven in (("soft", 1.0), ("rigid", np.abs(k0 / kz) ** 2)):
        density_of_k = w * strength * driven * at_face.real / (4 * np.pi)
        known = np.sum(density_of_k)
        assert abs(np.sum(density_of_k[k > k0])) > 1e-3 * known
        found = power(slab, bp.Piston(radius, baffle, z0=-distance), 0.5e6, [-distance, -1e-4, 0.0])
        assert found == pytest.approx(known, rel=1e-8, abs=0)


def test_in_a_lossy_half_space_power_falls_in_front_and_behind():
    """Evanescent waves are absorbed, too: near a piston they count, as far out as they arrive."""
    lossy = bp.Fluid(1000.0, 1000.0 * 1500.0**2 * (1 - 0.1j))
    slab = bp.Slab.uniform(lossy, 0.01, background=lossy)
    omega, radius, z = 2 * np.pi * 0.2e6, 0.002, [-0.0298, -0.0295, -0.02, 0.005, 0.03]
    square = omega**2 * 1000.0 / complex(lossy.bulk_modulus)
    ends = [np.linspace(0, 3 * omega / 1500.0, 200), 3 * omega / 1500.0 + np.geomspace(1, 2e5, 200)]
    k, w = gauss(np.unique(np.concatenate(ends)), 20)
    kz = np.sqrt(square - k**2)
    strength = (np.pi * radius**2 * 2 * j1(k * radius) / (k * radius)) ** 2 * k * (kz / (omega * 1000.0)).real
    known = [np.sum(w * strength * np.exp(-2 * kz.imag * (v + 0.03))) / (4 * np.pi) for v in z]
    assert power(slab, bp.Piston(radius, "soft", z0=-0.03), 0.2e6, z) == pytest.approx(known, rel=1e-8, abs=0)


# --- sums over planes -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("slab", "beam", "frequency", "length", "z"),
    [
        (LOSSY, bp.GaussianBeam((0.2, 0.1), 30, azimuth=40, z0=-0.05), FREQUENCY, 1.6, [-0.02, 0.0, 0.004, 0.03]),
        (PLATE, UNLIKE, 0.2e6, 0.12, [-0.01, 0.003, 0.05]),
        (PLATE, TRANSDUCERS["array"], 0.2e6, 0.12, [-0.01, 0.003, 0.05]),
    ],
)
def test_power_through_a_cell_is_the_sum_of_its_intensity(slab, beam, frequency, length, z):
    """Of sources on a lattice: a sum over an even grid that resolves it is exact."""
    x = np.linspace(-length / 2, length / 2, 128, endpoint=False)
    ds = bp.field(slab, beam, frequency, x, z, y=x, boundary="periodic", variables=("intensity_z", "power_through"))
    summed = ds.intensity_z.sum(("x", "y")) * (x[1] - x[0]) ** 2
    np.testing.assert_allclose(ds.power_through, summed, rtol=1e-12)
    assert "error_estimate_power_through" not in ds


def test_a_cell_of_pistons_before_a_lossy_layer():
    """On their plane it is the power through the face: evanescent waves carry none through water between."""
    slab = bp.Slab.uniform(bp.Fluid(1900.0 * (1 + 0.2j), 1900.0 * 2800.0**2 * (1 - 0.2j)), 0.002, background=WATER)
    x, piston = np.linspace(-0.01, 0.01, 160, endpoint=False), bp.Piston(0.004, z0=-0.002)
    ask = {"y": x, "boundary": "periodic"}
    ds = bp.field(slab, piston, 0.2e6, x, 0.0, variables=("intensity_z", "power_through"), **ask)
    summed = float(ds.intensity_z.sum()) * (x[1] - x[0]) ** 2
    on_plane = bp.field(slab, piston, 0.2e6, x, [-0.002, 0.0], variables="power_through", **ask).power_through
    np.testing.assert_allclose(on_plane, summed, rtol=1e-11)


def test_in_solids_the_shear_stress_has_its_part():
    """Re(p v_z* - s_xz v_x* - s_yz v_y*)/2 over a cell, the same in the plate, in front and behind."""
    x, z = np.linspace(-0.02, 0.02, 100, endpoint=False), [-1e-3, 5e-4, 1.5e-3, 4e-3]
    beam = bp.GaussianBeam((4e-3, 3e-3), 10, azimuth=30, z0=-2e-3)
    names = ["p", "v_x", "v_y", "v_z", "s_xz", "s_yz", "power_through"]
    ds = bp.field(STEEL, beam, 0.7e6, x, z, y=x, boundary="periodic", variables=names)
    parts = ds.p * np.conj(ds.v_z), -ds.s_xz * np.conj(ds.v_x), -ds.s_yz * np.conj(ds.v_y)
    whole = sum(parts).real.sum(("x", "y")) / 2 * (x[1] - x[0]) ** 2
    np.testing.assert_allclose(ds.power_through, whole, rtol=1e-11)
    assert abs(float((parts[1] + parts[2]).real.sum(("x", "y"))[1])) > 0.01 * float(whole[1])
    through = power(STEEL, beam, 0.7e6, z)
    assert np.ptp(through) < 1e-10 * through[0]


@pytest.mark.parametrize("weight", [0.0, 0.8 + 0.3j])
def test_power_is_the_sum_over_a_wide_plane(weight):
    """Of Re(p v_z*)/2 of open fields, in front of, inside and behind a layer with loss."""
    beam = bp.GaussianBeam((0.25, 0.35), 20, azimuth=30, z0=-0.05)
    if weight:
        beam = beam + weight * bp.GaussianBeam((0.3, 0.25), x0=0.1, z0=-0.05)
    x, z = np.linspace(-1.5, 1.7, 129), [-0.02, 0.05, 0.2]
    slab = bp.Slab.uniform(bp.Fluid(1.5, 1.2e5 * (1 - 0.1j)), 0.1)
    ds = bp.field(slab, beam, FREQUENCY, x, z, y=x, variables=["p", "v_z"])
    summed = (ds.p * np.conj(ds.v_z)).real.sum(("x", "y")) / 2 * (x[1] - x[0]) ** 2
    assert power(slab, beam, FREQUENCY, z) == pytest.approx(summed.values, rel=1e-7, abs=0)


# --- axes, files, refusals --------------------------------------------------------------------------------


def test_dimensions_units_and_files(tmp_path):
    beam, z, angles = bp.GaussianBeam((0.2, 0.1), z0=-0.05, azimuth=30.0), [-0.01, 0.02], [10.0, 40.0]
    names = ["p", "power_through"]
    ask = (LOSSY, beam, [2400.0, 2500.0], [0.0, 0.1], z, angles)
    ds = bp.field(*ask, y=[0.0, 0.2], variables=names, average="cell")
    assert ds.power_through.dims == ("frequency", "angle", "z")
    assert ds.error_estimate_power_through.dims == ("frequency", "angle")
    assert ds.power_through.attrs == {"units": "W", "long_name": "time-averaged power through the plane along z"}
    alone = power(LOSSY, beam.at_angle(40.0), 2400.0, z)
    np.testing.assert_allclose(ds.power_through[0, 1], alone, rtol=1e-12)
    rest = bp.save_field(tmp_path / "a.nc", *ask, y=[0.0, 0.2], variables=names)
    for saved in (rest, bp.load(tmp_path / "a.nc")):
        assert saved.power_through.attrs["units"] == "W"
        np.testing.assert_array_equal(saved.power_through, ds.power_through)
    single = bp.field(LOSSY, beam, 2400.0, 0.0, 0.02, y=0.0, variables="power_through").power_through
    assert single.attrs["units"] == "W"
    flat = bp.field(LOSSY, bp.GaussianBeam(0.1), 2400.0, 0.0, 0.02, variables="power_through").power_through
    assert flat.attrs["units"] == "W/m"


def test_steered_sums_and_arrays_take_many_angles():
    beams = bp.GaussianBeam((0.2, 0.15), z0=-0.1) + 0.5j * bp.GaussianBeam((0.15, 0.2), x0=0.08, z0=-0.1)
    many = power(LOSSY, beams, FREQUENCY, [0.01], angle=[0.0, 35.0])
    assert many[1] == pytest.approx(power(LOSSY, beams.at_angle(35.0), FREQUENCY, [0.01]), rel=1e-12, abs=0)
    turned = power(LOSSY, beams, FREQUENCY, [0.01], angle=35.0, azimuth=70.0)
    first, second = (s.at_angle(35.0) for s in beams.sources)
    known = sum(abs(w) ** 2 * power(LOSSY, s, FREQUENCY, [0.01], azimuth=70.0) for s, w in ((first, 1), (second, 0.5j)))
    assert 0.01 < abs(turned / known - 1) < 1  # they overlap


def test_sums_far_from_the_origin_take_no_longer():
    """The same power, by as many plane waves: 50 km aside they would be too many."""
    near, far = (
        bp.GaussianBeam((0.2, 0.15), x0=x0, z0=-0.1) + 0.5j * bp.GaussianBeam((0.15, 0.2), x0=x0 + 0.0625, z0=-0.1)
        for x0 in (0.0, 65536.0)
    )
    known = power(LOSSY, near, FREQUENCY, [0.01, 0.1])
    np.testing.assert_allclose(power(LOSSY, far, FREQUENCY, [0.01, 0.1]), known, rtol=1e-11)


def test_a_wide_lossy_question_is_answered_to_rtol():
    """Against the same at a lower rtol."""
    exact = power(LOSSY, PAIR, FREQUENCY, [-0.05, 0.01, 0.3], rtol=1e-11)
    ds = bp.field(LOSSY, PAIR, FREQUENCY, 0.0, [-0.05, 0.01, 0.3], y=0.0, variables="power_through", rtol=1e-4)
    assert np.abs(ds.power_through.values / exact - 1).max() < 1e-4
    assert 0 < float(ds.error_estimate_power_through) < 1e-4


MANY = "variables: expected power_through of at most"


@pytest.mark.parametrize(
    ("beam", "z", "more", "said"),
    [
        (bp.Piston(0.05), 0.5, {}, rf"{MANY} 6e\+04 plane waves, got inf: take a thinner"),
        (bp.Piston(0.05, z0=-1e-6), 0.5, {}, rf"{MANY} 6e\+04 plane waves, got"),
        (bp.GaussianBeam((60.0, 60.0), 80, z0=-0.1), 0.5, {}, rf"{MANY} 2e\+08 plane waves in all directions, got"),
        (
            bp.Bowl(0.2, 0.2, z0=-0.1),
            -0.09,
            {},
            r"z: expected positions not in front of the rim .*0\.0732.*, got -0\.09",
        ),
        (bp.Piston(0.05, z0=-1e-6), 0.5, {"boundary": "periodic", "period": (1.0, 2.0)}, "period: expected at most 4e"),
    ],
)
def test_refusals_name_the_argument(beam, z, more, said):
    with pytest.raises(ValueError, match=f"^{said}"):
        bp.field(LOSSY, beam, FREQUENCY, 0.0, z, y=0.0, variables="power_through", **more)


def test_a_piston_on_a_face_without_loss_is_answered():
    """No evanescent wave carries power there: as if it lay before the face."""
    on, before = (power(PLATE, bp.Piston(0.01, z0=z0), 0.5e6, [0.003, 0.05]) for z0 in (0.0, -1e-9))
    assert on == pytest.approx(before, rel=1e-5, abs=0)
