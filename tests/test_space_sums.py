"""`beam_width` and `beam_measures` of sums of sources in three dimensions: closed forms, quadratures, errors."""

import warnings

import numpy as np
import pytest
import space_oracles as oracles
from scipy.optimize import brentq, minimize
from scipy.special import j0, j1
from test_space_measures import Layer

import beamprop as bp
from beamprop.profiles.space_plane import Way, Window, sampled
from beamprop.response import transfer_function
from beamprop.response.sampled_slab import sample
from beamprop.sources.sum_in_space import in_space

FREQUENCY = 2500.0
LOSSY = bp.Slab(bp.lmmd_cell(), 20)
THIN = bp.Slab.uniform(bp.AIR, 1e-10)
WATER = bp.Fluid.from_speed(1000.0, 1500.0)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
UNLIKE = (
    bp.Piston(0.01, z0=-0.03)
    + 0.5j * bp.Piston(0.006, "soft", x0=0.02, z0=-0.03)
    + (-1 + 1j) * bp.Bowl(0.064, 0.03, y0=-0.01, z0=-0.03)
    + 2.0 * bp.GaussianBeam((0.02, 0.01), 20, azimuth=30, x0=-0.03, z0=-0.03)
)
#: Two beams that overlap, with directions of their own.
FIRST = bp.GaussianBeam((0.2, 0.15), 25, -0.05, -0.1, azimuth=30.0, y0=0.02)
SECOND = bp.GaussianBeam((0.15, 0.2), x0=0.08, z0=-0.1)
WEIGHT = 0.8 + 0.3j
PAIR = FIRST + WEIGHT * SECOND


def quietly(question, *args, **options):
    """An answer, whatever is said of lobes and of tails that are cut off."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return question(*args, **options)


def worst(p, known):
    return float(np.max(np.abs(p - known)) / np.max(np.abs(known)))


# --- widths -----------------------------------------------------------------------------------------------


def test_widths_of_two_beams_against_a_polar_quadrature():
    """Peak and edges of the sum of independent fields, by a general optimiser and root finder."""
    ds = bp.beam_width(LOSSY, PAIR, FREQUENCY)

    def p(x, y):
        at = np.atleast_1d(x), np.atleast_1d(y)
        first, second = (
            oracles.polar_field(LOSSY, FREQUENCY, beam, at, [LOSSY.thickness], panels=16, directions=120)[0]
            for beam in (FIRST, SECOND)
        )
        return first + WEIGHT * second

    def size(x, y):
        return abs(p(x, y)[0])

    peak, widths = oracles.peak_and_widths(size, ds.centroid_out.values)
    assert float(ds.peak_out) == pytest.approx(peak, rel=1e-9)
    assert ds.fwhm_out.values == pytest.approx(widths, rel=1e-6)


def test_areas_of_two_beams_are_those_of_many_samples():
    ds = bp.beam_width(LOSSY, PAIR, FREQUENCY)
    middle, half = ds.centroid_out.values, 0.8 * ds.fwhm_out.values.max()
    x, y = (m + half * np.linspace(-1, 1, 901) for m in middle)
    p = bp.field(LOSSY, PAIR, FREQUENCY, x, LOSSY.thickness, y=y, rtol=1e-6).p.values
    assert float(ds.area_out) == pytest.approx(oracles.area_of_samples(p, x, y), rel=2e-3)


@pytest.mark.parametrize("width_of", ["pressure", "intensity"])
def test_launched_twins_are_as_wide_as_their_profile(width_of):
    """Behind 0.1 nm of air: the half level of a sum of two Gaussians, by a root finder, and that of one along y."""
    twins = bp.GaussianBeam((0.2, 0.1), x0=0.05, y0=0.3, width_of=width_of)
    twins = twins + bp.GaussianBeam((0.2, 0.1), x0=-0.05, y0=0.3, width_of=width_of)
    a = twins.sources[0].radii[0]
    level = 0.5 if width_of == "pressure" else np.sqrt(0.5)

    def profile(x):
        return np.exp(-(((x - 0.05) / a) ** 2)) + np.exp(-(((x + 0.05) / a) ** 2))

    top = minimize(lambda x: -profile(x[0]), [0.0], method="Nelder-Mead", options={"xatol": 1e-10, "fatol": 1e-15})
    width = 2 * brentq(lambda x: profile(x) + level * top.fun, 0.05, 0.5, xtol=1e-14)
    ds = bp.beam_width(THIN, twins, FREQUENCY)
    for name in ("fwhm_launch", "fwhm_in", "fwhm_out"):
        assert ds[name].values == pytest.approx([width, 0.1], rel=1e-6)
    assert ds.centroid_out.values == pytest.approx([0.0, 0.3], abs=1e-6)
    assert float(ds.peak_out) == pytest.approx(-top.fun, rel=1e-6)


@pytest.mark.parametrize("question", [bp.beam_width, bp.beam_measures])
def test_two_halves_are_the_whole(question):
    beam = bp.GaussianBeam((0.2, 0.15), 25, -0.05, -0.1, azimuth=30.0, y0=0.02)
    array = bp.Array(
        [(-0.05, 0.02)], bp.GaussianBeam((0.2, 0.15), 25, 0.0, -0.1, azimuth=30.0), angle=25.0, azimuth=30.0
    )
    whole, halves = question(LOSSY, beam, FREQUENCY), question(LOSSY, 0.4 * beam + 0.6 * array, FREQUENCY)
    assert bp.provenance(halves)["beam"] == 0.4 * beam + 0.6 * array
    for name in whole:
        # launched widths of a single beam are known, those of a sum are measured
        tolerance = 1e-9 if name == "fwhm_launch" else 1e-12
        np.testing.assert_allclose(halves[name], whole[name], rtol=tolerance, atol=tolerance, err_msg=name)


def test_widths_of_unlike_sources_are_those_of_their_field():
    """Of cuts of `field`, through the peak of a fine plane; what is launched with sharp edges is left open."""
    ds = bp.beam_width(PLATE, UNLIKE, 0.2e6, rtol=1e-6, air_distance=0.04)
    assert np.all(np.isnan(ds.fwhm_launch))
    x, y = np.linspace(-0.04, 0.04, 401), np.linspace(-0.04, 0.04, 401)
    plane = bp.field(PLATE, UNLIKE, 0.2e6, x, 0.0065, y=y, rtol=1e-6).p
    peak = abs(plane).argmax(("y", "x"))
    assert float(ds.peak_out) == pytest.approx(float(abs(plane).max()), rel=1e-3)
    cuts = [bp.fwhm(plane.isel(y=peak["y"])), bp.fwhm(plane.isel(x=peak["x"]), "y")]
    assert ds.fwhm_out.values == pytest.approx([float(cut) for cut in cuts], rel=5e-3)


def test_air_behind_a_bowl_counts_from_its_rim():
    """As of the bowl alone, in a sum with a source of next to no strength."""
    bowl = bp.Bowl(0.064, 0.03, z0=-0.03)
    alone, beside = (
        quietly(bp.beam_width, PLATE, source, 0.5e6, rtol=1e-5, air_distance=0.03)
        for source in (bowl, bowl + 1e-9 * bp.Piston(0.005, z0=-0.03))
    )
    assert beside.fwhm_air.values == pytest.approx(alone.fwhm_air.values, rel=1e-6)


# --- measures ---------------------------------------------------------------------------------------------


def test_measures_of_launched_beams_are_those_of_their_profile():
    """Behind 0.1 nm of air in a window that holds all: moments of the closed form |p|^2, by plain sums."""
    beams = bp.GaussianBeam((0.2, 0.15), 20, -0.05, azimuth=30.0, y0=0.02), bp.GaussianBeam((0.15, 0.25), x0=0.1)
    ds = quietly(bp.beam_measures, THIN, beams[0] + WEIGHT * beams[1], FREQUENCY, window=1.2).sel(side="transmitted")
    x = np.linspace(-1, 1, 1001)
    p = 0
    for weight, beam in zip((1.0, WEIGHT), beams, strict=True):
        source = oracles.Gaussian(beam, 2 * np.pi * FREQUENCY / 343.0)
        p = p + weight * source.launched(x - beam.x0, x[:, None] - beam.y0)
    power = np.abs(p) ** 2 / np.sum(np.abs(p) ** 2)
    places = np.stack(np.broadcast_arrays(x, x[:, None])).reshape(2, -1)
    mean = places @ power.ravel()
    off = places - mean[:, None]
    covariance = off * power.ravel() @ off.T
    assert ds.centroid.values == pytest.approx(mean, abs=1e-7)
    assert ds.width_second_moment.values == pytest.approx(4 * np.sqrt(np.diag(covariance)), rel=1e-7)
    values, axes = np.linalg.eigh(covariance)
    assert float(ds.ellipticity) == pytest.approx(np.sqrt(values[0] / values[1]), rel=1e-7)
    direction = np.degrees(np.arctan2(*axes[::-1, 1]))
    assert (float(ds.orientation) - direction + 90) % 180 - 90 == pytest.approx(0, abs=1e-5)
    assert float(ds.peak) == pytest.approx(np.abs(p).max(), rel=1e-4)
    assert float(ds.area) == pytest.approx(oracles.area_of_samples(p, x, x), rel=5e-3)


def test_the_ray_of_a_sum_starts_in_the_middle_of_its_sources():
    """Of equal beams that share an angle and an azimuth: the rays' mean."""
    twins = bp.GaussianBeam((0.6, 0.4), 20, -0.3, -0.1, azimuth=30.0) + bp.GaussianBeam(
        (0.6, 0.4), 20, 0.5, -0.1, azimuth=30.0, y0=0.2
    )
    ds = quietly(bp.beam_measures, bp.Slab.uniform(bp.AIR, 0.2), twins, FREQUENCY, window=1.0)
    ray = 0.3 * np.tan(np.radians(20)) * np.array([np.cos(np.radians(30)), np.sin(np.radians(30))])
    far = ds.sel(side="transmitted")
    assert (far.centroid - far.lateral_shift).values == pytest.approx(ray + np.array([0.1, 0.1]), abs=1e-9)


def test_power_of_unlike_sources_is_conserved():
    ds = quietly(bp.beam_measures, PLATE, UNLIKE, 0.2e6, window=0.05, rtol=1e-4)
    assert float(ds.power.sum()) == pytest.approx(1, abs=1e-10)


@pytest.mark.parametrize("weight", [1.0, -1.0, 0.5j])
def test_power_of_a_rigid_and_a_soft_piston_by_its_own_integral(weight):
    """The mean over directions of |S1 k0/kz + w S2 exp(-i k.d)|^2 has a cross term with J0(k d)."""
    a, b, apart, plate = 0.004, 0.003, 0.006, Layer(1900.0, 1900.0 * 2800.0**2, 0.0065, (1000.0, 1500.0), 0.5e6)
    both = bp.Piston(a, z0=-0.03) + weight * bp.Piston(b, "soft", x0=apart, z0=-0.03)
    ds = quietly(bp.beam_measures, PLATE, both, 0.5e6, window=0.02, rtol=1e-8)
    g, w = np.polynomial.legendre.leggauss(500)
    alpha = (g + 1) * np.pi / 4
    k, cos = plate.k0 * np.sin(alpha), np.cos(alpha)
    first, second = (r**2 * 2 * j1(k * r) / (k * r) for r in (a, b))
    mean = (
        first**2
        + np.abs(weight) ** 2 * (second * cos) ** 2
        + 2 * np.real(weight) * first * second * cos * j0(k * apart)
    )
    incident = w * mean * k  # kz dk = k0^2 cos^2 dalpha
    share = np.abs(plate.solved(k)[0][3]) ** 2
    assert float(ds.power[1]) == pytest.approx(np.sum(incident * share) / np.sum(incident), rel=1e-7)
    z = float(np.sum(incident * share * cos) / np.sum(incident * share))  # the mean direction's part along z
    x = float(np.tan(np.radians(ds.far_angle[1]))) * z
    assert abs(x) < 1e-6 if np.isreal(weight) else abs(x) > 1e-3


# --- errors -----------------------------------------------------------------------------------------------

SAME = bp.GaussianBeam((0.2, 0.2), z0=-0.1)


def nearly(share):
    """Two beams whose difference is `share` of one of them, but for a share squared."""
    return bp.GaussianBeam((0.2 * (1 + share),) * 2, z0=-0.1) - SAME


def test_measures_of_sources_that_nearly_cancel_keep_rtol():
    """The difference is a ring, whose peak has no one place, but a size and an area."""
    exact = quietly(bp.beam_measures, LOSSY, nearly(1e-3), FREQUENCY, rtol=1e-9)
    ds = quietly(bp.beam_measures, LOSSY, nearly(1e-3), FREQUENCY, rtol=1e-6)
    for name in ("area", "peak"):
        np.testing.assert_allclose(ds[name], exact[name], rtol=1e-5, err_msg=name)


@pytest.mark.parametrize("question", [bp.beam_width, bp.beam_measures])
def test_what_cancels_too_far_is_warned_of(question):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        with pytest.warns(bp.AccuracyWarning, match="sources of the sum that cancel"):
            question(LOSSY, nearly(1e-8), FREQUENCY, rtol=1e-8)


def test_a_window_beside_sources_that_cancel_keeps_rtol():
    """Two strong beams cancel; a weak one aside is alone in the window, where of the strong ones only errors show."""
    strong = bp.GaussianBeam((0.2, 0.2), z0=-0.1), bp.Array([(0.0, 0.0)], SAME)
    weak = bp.GaussianBeam((0.2, 0.2), x0=1.5, z0=-0.1)
    source = in_space(strong[0] - strong[1] + 1e-5 * weak, None)
    s = sample(LOSSY, FREQUENCY)
    way = Way(lambda z0: transfer_function.through(s, z0), LOSSY.thickness)
    window = Window(np.array([0.75, 0.0]), np.array([0.3, 0.3]))  # from the middle of the sum, 0.75 m from both
    profile = sampled(s, source, way, window, 1e-5)
    alone = bp.field(LOSSY, weak, FREQUENCY, profile.x + 0.75, LOSSY.thickness, y=profile.y, rtol=1e-9).p.values
    assert worst(profile.p, 1e-5 * alone) < 1e-5
    errors = np.array([float(plane.budget.total[0]) for plane in profile.plane.planes])
    known = (errors[0] + errors[1]) / 1e-5 + errors[
        2
    ]  # over the weak beam's peak, which is as large as theirs times 1e-5
    assert float(profile.plane.budget.total[0]) == pytest.approx(known, rel=0.02)
    assert known < 1e-5


# --- what is asked, and what comes ------------------------------------------------------------------------


def test_dimensions_and_labels():
    sources = bp.GaussianBeam((0.2, 0.1), z0=-0.1) + 1j * bp.GaussianBeam((0.1, 0.1), x0=0.2, z0=-0.1)
    for question in (bp.beam_width, bp.beam_measures):
        ds = quietly(question, LOSSY, sources, [2400.0, 2500.0], [0, 30.0])
        single = quietly(question, LOSSY, sources, 2500.0, 30.0)
        assert ds.attrs["geometry"] == "3-D"
        for name in ds:
            np.testing.assert_allclose(
                ds[name].isel(frequency=1, angle=1).values, single[name].values, rtol=1e-12, err_msg=name
            )
    turned = quietly(bp.beam_width, LOSSY, sources, FREQUENCY, 30.0, azimuth=90.0)
    assert turned.azimuth.item() == 90.0
    assert turned.centroid_out.values[1] > 0.01 > abs(ds.centroid.values[1, 0, 1, 1])


@pytest.mark.parametrize("question", [bp.beam_width, bp.beam_measures])
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"beam": SAME + bp.Slits(0.01, 0.04, 2, -0.1)}, "beam: expected one GaussianBeam, Piston, Bowl, SourcePlane"),
        ({"beam": bp.Piston(0.05) + bp.GaussianBeam((0.1, 0.1))}, "beam: expected a sharp edge in front of the near"),
        ({"angle": 10.0}, "angle: expected none with a sum of sources at angles of their own, got 10"),
        ({"azimuth": "north"}, "azimuth: expected"),
        ({"rtol": 0.0}, "rtol: expected"),
    ],
)
def test_refusals_name_the_argument(question, changes, message):
    given = {"slab": LOSSY, "beam": PAIR, "frequency": FREQUENCY} | changes
    with pytest.raises(ValueError, match=f"^{message}"):
        question(**given)
