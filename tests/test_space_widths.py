"""`beam_width` in three dimensions: closed forms, independent quadratures, brute counts of samples, symmetries, limits."""

import warnings

import numpy as np
import pytest
import space_oracles as oracles
from scipy.optimize import brentq

import beamprop as bp

FREQUENCY = 2500.0
LOSSLESS, LOSSY = bp.Slab(bp.lmmd_cell(0.05, 0), 450), bp.Slab(bp.lmmd_cell(), 450)
THIN = bp.Slab.uniform(bp.AIR, 1e-10)
ROUND = bp.GaussianBeam((0.096, 0.096))
ELLIPSE = bp.GaussianBeam((0.3, 0.15), 45, 0.02, -0.1, azimuth=30.0, y0=-0.03)
WATER = bp.Fluid.from_speed(1000.0, 1500.0)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
MHZ = 0.5e6


# --- what is known ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("width_of", ["pressure", "intensity"])
def test_a_launched_ellipse_is_as_wide_as_it_says(width_of):
    """Behind 0.1 nm of air it is what was launched: an ellipse whose axes are its widths, wherever it is and however tilted."""
    beam = bp.GaussianBeam((0.3, 0.15), 40, 0.02, azimuth=30.0, y0=-0.03, width_of=width_of)
    ds = bp.beam_width(THIN, beam, FREQUENCY)
    for name in ("fwhm_launch", "fwhm_in", "fwhm_out"):
        assert ds[name].values == pytest.approx([0.3, 0.15], rel=1e-6)
    assert float(ds.area_out) == pytest.approx(np.pi / 4 * 0.3 * 0.15, rel=1e-6)
    assert float(ds.equivalent_out) == pytest.approx(np.sqrt(0.3 * 0.15), rel=1e-6)
    assert float(ds.peak_out) == pytest.approx(1, rel=1e-6)
    assert ds.centroid_out.values == pytest.approx([0.02, -0.03], abs=1e-6)


@pytest.mark.parametrize("slab", [LOSSLESS, LOSSY])
def test_a_circular_beam_is_its_radial_profile(slab):
    """Twice the radius at which an independent radial integral is half of what it is on the axis, along both axes, and the disc's area."""
    ds = bp.beam_width(slab, ROUND, FREQUENCY)

    def size(r):
        beam = bp.GaussianBeam(0.096)
        return abs(oracles.round_profile(slab, FREQUENCY, beam, np.array([r]), [slab.thickness])[0, 0])

    width = 2 * brentq(lambda r: size(r) - size(0.0) / 2, 0.02, 0.1, xtol=1e-13)
    assert ds.fwhm_out.values == pytest.approx([width, width], rel=1e-8)
    assert float(ds.equivalent_out) == pytest.approx(width, rel=1e-8)
    assert float(ds.peak_out) == pytest.approx(size(0.0), rel=1e-9)


def test_a_tilted_ellipse_against_a_polar_quadrature():
    """Peak and edges of the independent field, by a general optimiser and root finder."""
    ds = bp.beam_width(LOSSY, ELLIPSE, FREQUENCY)

    def size(x, y):
        at = np.array([x]), np.array([y])
        return abs(
            oracles.polar_field(LOSSY, FREQUENCY, ELLIPSE, at, [LOSSY.thickness], panels=16, directions=120)[0, 0]
        )

    peak, widths = oracles.peak_and_widths(size, ds.centroid_out.values)
    assert float(ds.peak_out) == pytest.approx(peak, rel=1e-9)
    assert ds.fwhm_out.values == pytest.approx(widths, rel=1e-6)


# --- areas ------------------------------------------------------------------------------------------------


def test_where_guided_lobes_join_the_area_is_that_of_all():
    """With the mean density 0 the lossless slab guides lobes that join at half the peak."""
    slab, beam = bp.Slab(bp.lmmd_cell(0, 0), 450), bp.GaussianBeam((0.096, 0.096), 45)
    ds = bp.beam_width(slab, beam, FREQUENCY)
    x, y = np.linspace(-0.5, 0.5, 1001), np.linspace(-0.3, 0.3, 601)
    p = bp.field(slab, beam, FREQUENCY, x, slab.thickness, y=y).p.values
    assert float(ds.area_out) == pytest.approx(oracles.area_of_samples(p, x, y), rel=2e-3)


def test_an_arc_is_not_what_rays_from_its_peak_see():
    """A ridge of |p| along a half circle, on which rays from the peak meet the level once and leave it for good or come back."""
    x = np.linspace(-0.25, 0.25, 126)
    r, turn = np.hypot(x, x[:, None]), np.arctan2(x[:, None], x)
    p = np.exp(-(((r - 0.1) / 0.02) ** 2) - (turn / 1.9) ** 4)
    source = bp.SourcePlane(x, x, p)
    ds = bp.beam_width(THIN, source, FREQUENCY, rtol=1e-4, air_distance=1e-9)
    fine = np.linspace(-0.2, 0.2, 1001)
    q = bp.field(THIN, source, FREQUENCY, fine, 1e-10, y=fine, rtol=1e-5).p.values
    assert float(ds.area_out) == pytest.approx(oracles.area_of_samples(q, fine, fine), rel=2e-3)
    row, column = np.unravel_index(np.abs(q).argmax(), q.shape)
    angles, along = np.linspace(0, 2 * np.pi, 720, endpoint=False), np.arange(0, 0.19, 2e-4)[:, None]
    places = fine[row] + along * np.sin(angles), fine[column] + along * np.cos(angles)
    rows, columns = (np.clip(np.rint((v + 0.2) / 4e-4), 0, 1000).astype(int) for v in places)
    above = np.abs(q)[rows, columns] >= np.abs(q).max() / 2
    by_rays = np.sum(along[np.argmin(above, axis=0), 0] ** 2) * np.pi / 720
    assert by_rays < 0.8 * float(ds.area_out)


@pytest.mark.parametrize("beam", [ELLIPSE, bp.GaussianBeam((0.05, 0.4), 20)])
@pytest.mark.parametrize("slab", [LOSSLESS, LOSSY])
def test_areas_are_those_of_many_samples(slab, beam):
    ds = bp.beam_width(slab, beam, FREQUENCY)
    middle, half = ds.centroid_out.values, 0.8 * ds.fwhm_out.values.max()
    x, y = (m + half * np.linspace(-1, 1, 901) for m in middle)
    p = bp.field(slab, beam, FREQUENCY, x, slab.thickness, y=y, rtol=1e-6).p.values
    assert float(ds.area_out) == pytest.approx(oracles.area_of_samples(p, x, y), rel=2e-3)


# --- symmetries and limits --------------------------------------------------------------------------------


def test_turned_by_a_quarter_x_and_y_are_swapped():
    first = bp.beam_width(LOSSY, bp.GaussianBeam((0.2, 0.1), 30, z0=-0.1), FREQUENCY)
    turned = bp.beam_width(LOSSY, bp.GaussianBeam((0.1, 0.2), 30, z0=-0.1, azimuth=90.0), FREQUENCY)
    for name in ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air"):
        np.testing.assert_allclose(turned[name].values[::-1], first[name].values, rtol=1e-10)
    np.testing.assert_allclose(turned.centroid_out.values[::-1], first.centroid_out.values, atol=1e-10)
    assert float(turned.area_out) == pytest.approx(float(first.area_out), rel=1e-10)


@pytest.mark.parametrize("azimuth", [17.0, 45.0, 200.0])
def test_areas_do_not_depend_on_the_azimuth_of_a_circular_beam(azimuth):
    beams = (bp.GaussianBeam((0.096, 0.096), 45, z0=-0.1, azimuth=turn) for turn in (0.0, azimuth))
    areas = [float(bp.beam_width(LOSSY, beam, FREQUENCY).area_out) for beam in beams]
    assert areas[1] == pytest.approx(areas[0], rel=1e-9)


def test_ever_longer_ellipses_tend_to_the_width_in_two_dimensions():
    flat = bp.beam_width(LOSSY, bp.GaussianBeam(0.096, 20), FREQUENCY, rtol=1e-10).fwhm_out.item()
    apart = [
        bp.beam_width(LOSSY, bp.GaussianBeam((0.096, wy), 20), FREQUENCY, rtol=1e-9).fwhm_out.values[0] - flat
        for wy in (0.6, 1.2)
    ]
    assert apart[0] / apart[1] == pytest.approx(4, abs=0.15)


def test_wide_beams_keep_the_paraxial_law():
    """sqrt(2) times as wide at one Rayleigh distance, but for O(1/(k a)^2): each axis for itself."""
    k0 = 2 * np.pi * FREQUENCY / 343.0
    apart = []
    for ka in (11.0, 22.0):
        beam = bp.GaussianBeam((2 * ka / k0 * np.sqrt(np.log(2)),) * 2)
        ds = bp.beam_width(THIN, beam, FREQUENCY, air_distance=ka**2 / k0 / 2)
        apart.append((ds.fwhm_air.values[0] / beam.fwhm[0] / np.sqrt(2) - 1) * ka**2)
    assert apart[0] == pytest.approx(apart[1], rel=0.05)
    assert abs(apart[1]) < 2


@pytest.mark.parametrize(
    ("slab", "angle", "widths"),
    [
        (LOSSLESS, 0, (9.77, 9.77)),
        (LOSSY, 0, (9.12, 9.12)),
        (LOSSLESS, 45, (9.46, 9.66)),
        (LOSSY, 45, (8.95, 8.81)),
    ],
)
def test_the_papers_beam(slab, angle, widths):
    """9.6 cm behind 4500 layers, by throwaway code that located edges on rays of a kernel sum; 33.6 cm without them."""
    ds = bp.beam_width(slab, ROUND, FREQUENCY, angle)
    assert 100 * ds.fwhm_out.values == pytest.approx(widths, abs=0.0051)
    if not angle:
        assert 100 * ds.fwhm_air.values == pytest.approx([33.6, 33.6], abs=0.051)


# --- rtol -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-10])
def test_widths_settle_with_rtol(rtol):
    exact = bp.beam_width(LOSSLESS, ELLIPSE, FREQUENCY, rtol=1e-11)
    ds = bp.beam_width(LOSSLESS, ELLIPSE, FREQUENCY, rtol=rtol)
    for name in ("fwhm_out", "fwhm_air", "area_out", "peak_out"):
        np.testing.assert_allclose(ds[name].values, exact[name].values, rtol=10 * rtol)


def test_an_rtol_that_is_not_kept_is_warned_of():
    """A beam of 30 000 wavelengths of air: phases of 2e5 rad are known to 4e-11."""
    with pytest.warns(bp.AccuracyWarning, match="estimated error"):
        bp.beam_width(
            bp.Slab.uniform(bp.AIR, 10.0), bp.GaussianBeam((20.0, 20.0)), FREQUENCY, rtol=1e-12, air_distance=4e3
        )


# --- transducers ------------------------------------------------------------------------------------------

ROW = np.stack([0.003 * np.arange(-8, 9), np.zeros(17)], axis=1)
_X = np.linspace(-0.05, 0.05, 101)
TRANSDUCERS = {
    "piston": bp.Piston(0.01, x0=0.002, z0=-0.03),
    "soft piston": bp.Piston(0.01, "soft", z0=-0.03),
    "array": bp.Array(ROW, bp.Piston(0.0012, z0=-0.03), focus=(0.01, 0.0, 0.02)),
    "hologram": bp.SourcePlane(_X, _X, np.exp(-(_X**2 + _X[:, None] ** 2) / 0.01**2) * (1 + 30j * _X), z0=-0.03),
}


@pytest.mark.parametrize("name", TRANSDUCERS)
def test_widths_of_transducers_are_those_of_their_fields(name):
    """Of cuts of `field`, through the peak of a fine plane."""
    source = TRANSDUCERS[name]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # side lobes: the half level is met more than twice
        ds = bp.beam_width(PLATE, source, MHZ, rtol=1e-5, air_distance=0.06)
    nothing = bp.Slab.uniform(WATER, 0.001, background=WATER)
    x = np.linspace(-0.03, 0.03, 241)
    for slab, z, width in ((PLATE, 0.0065, ds.fwhm_out), (nothing, 0.03, ds.fwhm_air)):
        plane = bp.field(slab, source, MHZ, x, z, y=x, rtol=1e-5).p
        peak = abs(plane).argmax(("y", "x"))
        if z == 0.0065:
            assert float(ds.peak_out) == pytest.approx(float(abs(plane).max()), rel=2e-3)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            cuts = [bp.fwhm(plane.isel(y=peak["y"])), bp.fwhm(plane.isel(x=peak["x"]), "y")]
        for cut, along in zip(cuts, width.values, strict=True):
            if np.isfinite(cut):  # within the plane that was sampled
                assert along == pytest.approx(float(cut), rel=5e-3)


def test_launched_widths_of_transducers_are_their_diameters():
    """Of several sharp edges it is left open, without a warning."""
    piston = bp.Piston(0.01, z0=-0.03)
    for source, width in (
        (piston, 0.02),
        (bp.Bowl(0.064, 0.05, z0=-0.03), 0.05),
        (bp.Array(ROW, bp.Piston(0.0012, z0=-0.03)), np.nan),
        (bp.Array([[0.001, 0.002]], bp.Piston(0.0012, z0=-0.03)), 0.0024),
    ):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            warnings.filterwarnings("error", ".*nan in .*fwhm_launch")
            ds = bp.beam_width(PLATE, source, MHZ, rtol=1e-4)
        assert ds.fwhm_launch.values == pytest.approx([width, width], nan_ok=True)


# --- what is asked, and what comes ------------------------------------------------------------------------


def test_dimensions_and_labels():
    ds = bp.beam_width(LOSSY, ELLIPSE, [2400.0, 2500.0], [0, 30.0])
    assert ds.fwhm_out.dims == ("frequency", "angle", "axis")
    assert ds.area_out.dims == ("frequency", "angle")
    assert ds.axis.values.tolist() == ["x", "y"]
    assert ds.azimuth.item() == 30.0
    assert ds.attrs["geometry"] == "3-D"
    assert {ds.area_out.attrs["units"], ds.equivalent_out.attrs["units"]} == {"m^2", "m"}
    assert all(v.attrs["long_name"] for v in ds.variables.values())
    single = bp.beam_width(LOSSY, ELLIPSE, 2500.0, 30.0)
    assert single.fwhm_out.values == pytest.approx(ds.fwhm_out.values[1, 1], rel=1e-12)


def test_an_azimuth_makes_it_three_dimensional():
    one_width = bp.GaussianBeam(0.096)
    assert "axis" not in bp.beam_width(LOSSY, one_width, FREQUENCY).dims
    ds = bp.beam_width(LOSSY, one_width, FREQUENCY, azimuth=0.0)
    assert ds.fwhm_out.values == pytest.approx(bp.beam_width(LOSSY, ROUND, FREQUENCY).fwhm_out.values, rel=1e-12)
    given = bp.beam_width(LOSSY, ELLIPSE, FREQUENCY, azimuth=75.0)
    own = bp.beam_width(LOSSY, bp.GaussianBeam((0.3, 0.15), 45, 0.02, -0.1, azimuth=75.0, y0=-0.03), FREQUENCY)
    assert given.equals(own)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"azimuth": [0.0, 1.0]}, "azimuth: expected"),
        ({"azimuth": np.nan}, "azimuth: expected"),
        ({"beam": bp.GaussianBeam(0.1, form="rotated")}, "form: expected 'launch'"),
        (
            {"beam": bp.Slits(0.01, 0.04, 2, -0.1)},
            "beam: expected one GaussianBeam, Piston, Bowl, SourcePlane or Array in",
        ),
        ({"slab": bp.lmmd_emt_slab(LOSSY)}, "density_x: expected none, or density"),
        ({"beam": TRANSDUCERS["piston"], "angle": 10.0}, "angle: expected 0 with a Piston"),
        ({"air_distance": -1.0}, "air_distance: expected"),
        ({"rtol": 0.0}, "rtol: expected"),
    ],
)
def test_refusals_name_the_argument(changes, message):
    given = {"slab": LOSSY, "beam": ROUND, "frequency": FREQUENCY, "azimuth": 0.0} | changes
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.beam_width(**given)


def test_samples_that_have_not_ended_are_warned_of():
    x = np.linspace(-0.1, 0.1, 41)
    cut_off = bp.SourcePlane(x, x, np.exp(-(x**2 + x[:, None] ** 2) / 0.05**2), z0=-0.05)
    with pytest.warns(bp.AccuracyWarning, match="at the rim"):
        bp.beam_width(THIN, cut_off, FREQUENCY, rtol=1e-3)


def test_files_sweeps_and_pictures_take_them(tmp_path):
    ds = bp.sweep(
        lambda eta: bp.beam_width(bp.Slab(bp.lmmd_cell(eta=eta), 45), ROUND, [2400.0, 2500.0]),
        {"eta": [1 / 60, 1 / 50]},
        workers=1,
    )
    assert ds.fwhm_out.dims == ("eta", "frequency", "axis")
    bp.save(ds, tmp_path / "w.nc")
    loaded = bp.load(tmp_path / "w.nc")
    assert loaded.fwhm_out.equals(ds.fwhm_out)
    assert loaded.axis.values.tolist() == ["x", "y"]
    ax = bp.plot.width(bp.beam_width(LOSSY, ELLIPSE, [2400.0, 2450.0, 2500.0]))
    texts = [text.get_text() for text in ax.get_legend().get_texts()]
    assert len(ax.lines) == 6
    assert any("x" in text for text in texts)
