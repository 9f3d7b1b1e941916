"""What `field` answers and refuses where y is given."""

import warnings

import numpy as np
import pytest

import beamprop as bp
from beamprop.api.widths_of import widths_of

SLAB = bp.Slab(bp.lmmd_cell(), 45)
ROUND = bp.GaussianBeam(0.096, 20, z0=-0.05)
ELLIPSE = bp.GaussianBeam((0.2, 0.1), 20, z0=-0.05, azimuth=30.0)


def test_dimensions_are_frequency_angle_z_y_x():
    ds = bp.field(SLAB, ELLIPSE, [2400.0, 2500.0], [0, 0.1, 0.2], [0.1, 0.2], angle=[0, 10], y=[0.0, 0.1, 0.2, 0.3])
    assert ds.p.dims == ("frequency", "angle", "z", "y", "x")
    assert ds.error_estimate.dims == ("frequency", "angle")
    assert ds.azimuth.item() == 30.0
    assert ds.attrs["geometry"] == "3-D"
    assert {ds.y.attrs["units"], ds.azimuth.attrs["units"]} == {"m", "degree"}
    for i, angle in enumerate([0, 10]):
        single = bp.field(SLAB, ELLIPSE, 2500.0, 0.1, 0.2, angle=angle, y=0.3)
        assert single.p.dims == ()
        assert single.p.item() == pytest.approx(ds.p.values[1, i, 1, 3, 1], rel=1e-6)


def test_without_y_nothing_changes():
    ds = bp.field(SLAB, ROUND, 2500.0, [0, 0.1], [0.1])
    assert ds.p.dims == ("z", "x")
    assert ds.attrs["geometry"] == "2-D"
    assert "azimuth" not in ds.coords


def test_azimuth_overrides_the_beams():
    given = bp.field(SLAB, ELLIPSE, 2500.0, 0.1, 0.2, y=0.3, azimuth=75.0)
    own = bp.field(SLAB, bp.GaussianBeam((0.2, 0.1), 20, z0=-0.05, azimuth=75.0), 2500.0, 0.1, 0.2, y=0.3)
    assert given.p.item() == own.p.item()
    assert given.azimuth.item() == 75.0


def test_files_and_provenance_keep_the_beam(tmp_path):
    ds = bp.field(SLAB, ELLIPSE, 2500.0, [0, 0.1], [0.1, 0.2], y=[0.0, 0.1])
    bp.save(ds, tmp_path / "p.nc")
    loaded = bp.load(tmp_path / "p.nc")
    assert np.array_equal(loaded.p.values, ds.p.values)
    assert bp.provenance(loaded)["beam"] == ELLIPSE
    assert bp.provenance(loaded)["azimuth"] == 30.0


def test_widths_along_y_are_taken_of_a_cut():
    beam = bp.GaussianBeam((0.2, 0.1), z0=0.0)
    ds = bp.field(bp.Slab.uniform(bp.AIR, 0.1), beam, 2500.0, 0.0, 0.0, y=np.linspace(-0.15, 0.15, 61))
    assert float(bp.fwhm(ds.p, dim="y")) == pytest.approx(0.1, rel=1e-4)


@pytest.mark.parametrize("beam", [ELLIPSE, bp.GaussianBeam(0.1, azimuth=10.0), bp.GaussianBeam(0.1, y0=0.1)])
@pytest.mark.parametrize("ask", [
    lambda beam: bp.field(SLAB, beam, 2500.0, 0.0, 0.1),
    lambda beam: widths_of([SLAB], [beam], [2500.0]),
    lambda beam: bp.fem.field(SLAB, beam, 2500.0, np.linspace(-1, 1, 11), [0.1], 2.0),
])  # fmt: skip
def test_a_beam_of_three_dimensions_needs_y(beam, ask):
    with pytest.raises(ValueError, match=r"^beam: expected one on which nothing depends on y.*y="):
        ask(beam)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"boundary": "closed"}, "boundary: expected 'open' or 'periodic'"),
        ({"period": 2.0}, "period: expected none"),
        ({"variables": "power"}, "variables: expected some of p, v_x, v_y, v_z"),
        ({"average": "layer"}, "average: expected 'cell'"),
        ({"y": "wide"}, "y: expected"),
        ({"y": np.zeros((2, 2))}, "y: expected"),
        ({"y": np.nan}, "y: expected"),
        ({"azimuth": [0.0, 1.0]}, "azimuth: expected"),
        ({"azimuth": np.inf}, "azimuth: expected"),
        ({"z": -0.1}, "z: expected positions not in front of the launch plane"),
        ({"beam": bp.GaussianBeam(0.1, form="rotated")}, "form: expected 'launch' with y"),
        (
            {"beam": bp.Slits(0.01, 0.04, 2, -0.1)},
            "beam: expected a GaussianBeam, Piston, Bowl, SourcePlane or Array where y is given",
        ),
        ({"slab": bp.Slab.uniform(bp.Fluid(1.0, 1.4e5, density_x=2.0), 0.1)}, "density_x: expected none, or density"),
        ({"slab": bp.lmmd_emt_slab(SLAB)}, "density_x: expected none, or density"),
        (
            {"slab": bp.Slab.uniform(bp.AIR, 0.1, after=bp.Fluid(-1.0, -1.4e5))},
            "slab: expected half-spaces that carry forward waves in three dimensions",
        ),
    ],
)
def test_refusals_name_the_argument(changes, message):
    given = {"slab": SLAB, "beam": ROUND, "frequency": 2500.0, "x": 0.0, "z": 0.1, "y": 0.0} | changes
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.field(**given)


def test_azimuth_without_y_is_refused():
    with pytest.raises(ValueError, match=r"^azimuth: expected none without y, got 30\.0"):
        bp.field(SLAB, ROUND, 2500.0, 0.0, 0.1, azimuth=30.0)


@pytest.mark.parametrize("fwhm", [(0.1, 0.2, 0.3), (0.1,), (0.1, -0.2), (0.1, "wide"), (0.1, np.nan)])
def test_widths_are_checked(fwhm):
    with pytest.raises(ValueError, match=r"^fwhm: expected"):
        bp.GaussianBeam(fwhm)


def test_density_x_that_is_density_passes():
    fluid = bp.Fluid(2.0, 1.4e5, density_x=2.0)
    same = [
        bp.field(bp.Slab.uniform(f, 0.1), ROUND, 2500.0, 0.1, 0.2, y=0.1).p.item()
        for f in (fluid, bp.Fluid(2.0, 1.4e5))
    ]
    assert same[0] == same[1]


def test_an_rtol_that_is_not_kept_is_warned_of():
    """A beam of 30 000 wavelengths of air: phases of 2e5 rad are known to 4e-11."""
    with pytest.warns(bp.AccuracyWarning, match="estimated error"):
        bp.field(bp.Slab.uniform(bp.AIR, 0.1), bp.GaussianBeam(20.0), 2500.0, 0.0, 4e3, y=0.0, rtol=1e-12)


def test_nothing_else_warns():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bp.field(SLAB, ELLIPSE, 2500.0, np.linspace(-1, 1, 21), [0.1, 0.2], y=[0.0, 0.5])


@pytest.mark.parametrize("beam", [bp.GaussianBeam(0.001), bp.Piston(0.1, z0=-1e-4)])
def test_too_many_plane_waves_are_refused(beam):
    """A beam of a hundredth of a wavelength forty metres aside, and a sharp edge next to its plane: at once, with what to do."""
    with pytest.raises(
        ValueError, match=r"^rtol: 1e-08 needs too many plane waves in three dimensions.*z a little behind z0"
    ):
        bp.field(SLAB, beam, 2500.0, [-40.0, 40.0], 0.0, y=0.0)


WATER = bp.Fluid.from_speed(1000.0, 1500.0)
PLATE = bp.Slab(bp.Layer(bp.Solid(7900.0, 5900.0, 3200.0), 5e-3), background=WATER)


@pytest.mark.parametrize(
    ("beam", "frequency", "x", "z", "said"),
    [
        (bp.Piston(0.0125, z0=-0.03), 1.0, 0.0, 0.02, "of 1.5e+03 m in front the source is 1.67e-05 wide"),
        (bp.Piston(12.5, z0=-30.0), 1e6, 0.0, 0.02, "of 0.0015 m in front the source is 1.67e+04 wide"),
        (bp.Piston(0.0125, z0=-0.03), 1e6, [-20.0, 20.0], 0.02, "the source is 16.7 wide, the farthest position 1.33e"),
    ],
    ids=["megahertz", "source in mm", "x in mm"],
)
def test_refusals_name_sizes_that_wrong_units_make(beam, frequency, x, z, said):
    with pytest.raises(ValueError, match=r"^rtol: 1e-08 needs too many plane waves in three dimensions") as refused:
        bp.field(PLATE, beam, frequency, x=x, z=z, y=0.0)
    assert said in str(refused.value)
    assert str(refused.value).endswith(" thick (are all lengths in metres and the frequency in hertz?)")


def test_refusals_of_usual_sizes_ask_for_no_units():
    """A piston's edge next to its plane, and positions 300 wavelengths away."""
    with pytest.raises(ValueError, match=r"the slab 0\.75 thick$"):
        bp.field(SLAB, bp.Piston(0.1, z0=-1e-4), 2500.0, [-40.0, 40.0], 0.0, y=0.0)
