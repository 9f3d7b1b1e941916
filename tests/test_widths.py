"""Widths of profiles and of beams: closed forms of Gaussians, the field that they are measures of, and what is no width."""

import numpy as np
import pytest
import xarray as xr

import beamprop as bp

F = 2500.0
NAN, INF = float("nan"), float("inf")
CELL = bp.lmmd_cell()
SLAB = bp.Slab(CELL, 20)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)


def profile(size, x, **dims):
    return xr.DataArray(size, {"x": ("x", x, {"units": "m"}), **dims}, (*dims, "x"), attrs={"units": "Pa"})


@pytest.mark.parametrize(
    ("width_of", "factor"), [("pressure", 2 * np.sqrt(np.log(2))), ("intensity", np.sqrt(2 * np.log(2)))]
)
@pytest.mark.parametrize("points", [25, 200])
def test_fwhm_of_a_gaussian(width_of, factor, points):
    """2 a sqrt(ln 2) of |p|, a sqrt(2 ln 2) of |p|^2, to a part in 1000 with six samples in a width, 1e-6 with fifty."""
    a = 0.1
    x = np.linspace(-0.32, 0.3, points)
    p = profile(np.exp(-((x / a) ** 2) + 11j * x), x)
    got = bp.fwhm(p, width_of=width_of)
    assert got.item() == pytest.approx(a * factor, rel=2e-3 if points == 25 else 1e-6)
    assert got.attrs["units"] == "m"
    assert got.attrs["long_name"]


def test_fwhm_along_other_dimensions():
    """One width per row; the dimension can have any name and order."""
    x, a = np.linspace(-1, 1, 201), np.array([0.1, 0.2, 0.3])
    p = profile(np.exp(-((x / a[:, None]) ** 2)), x, z=("z", [0.0, 1.0, 2.0]))
    np.testing.assert_allclose(bp.fwhm(p), 2 * a * np.sqrt(np.log(2)), rtol=1e-5)
    assert bp.fwhm(p).dims == ("z",)
    np.testing.assert_allclose(bp.fwhm(p[:, ::-1].T), bp.fwhm(p), rtol=1e-12)
    renamed = bp.fwhm(p.rename(x="y"), "y")
    np.testing.assert_allclose(renamed, bp.fwhm(p))


def test_fwhm_beyond_the_window_is_nan_and_said():
    """The half level outside the window on one side is enough for nan; other rows keep their width."""
    x = np.linspace(-0.05, 0.5, 100)
    p = profile(np.exp(-((x / np.array([[0.1], [0.02]])) ** 2)), x, z=("z", [0.0, 1.0]))
    with pytest.warns(RuntimeWarning, match="half level"):
        got = bp.fwhm(p)
    assert np.isnan(got[0])
    assert got[1] == pytest.approx(0.04 * np.sqrt(np.log(2)), rel=1e-4)


def test_fwhm_is_between_the_places_nearest_to_the_peak():
    """A side lobe above half the peak does not count, and is warned of."""
    x = np.linspace(-1, 1, 801)
    p = profile(np.exp(-((x / 0.1) ** 2)) + 0.8 * np.exp(-(((x - 0.6) / 0.1) ** 2)), x)
    with pytest.warns(RuntimeWarning, match="4 times"):
        width = bp.fwhm(p)
    assert width == pytest.approx(0.2 * np.sqrt(np.log(2)), rel=1e-5)


@pytest.mark.parametrize(
    ("value", "name", "options"),
    [
        (3, "profile", {}),
        (profile(np.ones(9), np.arange(9.0)).to_dataset(name="p"), "profile", {}),
        (profile(np.ones(3), np.arange(3.0)), "profile", {}),
        (profile(np.full(9, NAN), np.arange(9.0)), "profile", {}),
        (profile(np.ones(9), np.arange(9.0)), "dim", {"dim": "y"}),
        (profile(np.ones(9), np.arange(9.0)), "width_of", {"width_of": "p"}),
    ],
)
def test_fwhm_refuses(value, name, options):
    """No DataArray, too few samples, NaN, an unknown dimension or option."""
    with pytest.raises(ValueError, match=rf"^{name}:"):
        bp.fwhm(value, **options)


@pytest.mark.parametrize("width_of", ["pressure", "intensity"])
def test_a_beam_is_as_wide_as_it_says(width_of):
    """fwhm is the width at launch of what width_of names, by field and by beam_width alike."""
    beam = bp.GaussianBeam(0.2, 25.0, z0=-0.1, width_of=width_of)
    x = np.linspace(-0.5, 0.5, 201)
    # far in front of a slab of air: the incident beam alone
    p = bp.field(bp.Slab.uniform(bp.AIR, 0.1), beam, F, x, -0.1).p
    assert bp.fwhm(p, width_of=width_of) == pytest.approx(0.2, rel=1e-6)
    ds = bp.beam_width(SLAB, beam, F)
    assert ds.fwhm_launch.item() == pytest.approx(0.2, rel=1e-9)


def test_widths_are_those_of_the_field():
    """fwhm_in, fwhm_out, fwhm_air and peak_out against the fields they are measures of."""
    beam = bp.GaussianBeam(0.096, 20.0, x0=0.05, z0=-0.1)
    ds = bp.beam_width(SLAB, beam, F, air_distance=0.3)
    x = np.linspace(-0.6, 0.9, 1501)
    nothing = bp.field(bp.Slab.uniform(bp.AIR, 0.5), beam, F, x, [0.0, 0.2]).p
    behind = bp.field(SLAB, beam, F, x, SLAB.thickness).p
    assert ds.fwhm_in.item() == pytest.approx(bp.fwhm(nothing[0]).item(), rel=1e-6)
    assert ds.fwhm_air.item() == pytest.approx(bp.fwhm(nothing[1]).item(), rel=1e-6)
    assert ds.fwhm_out.item() == pytest.approx(bp.fwhm(behind).item(), rel=1e-6)
    assert ds.peak_out.item() == pytest.approx(np.abs(behind).max().item(), rel=1e-4)
    power = np.abs(behind) ** 2
    assert ds.centroid_out.item() == pytest.approx(((power * behind.x).sum() / power.sum()).item(), abs=2e-3)


def test_a_beam_through_air_lands_where_it_aims():
    """centroid_out = x0 + (L - z0) tan(theta) for a wide beam through a slab of air."""
    slab = bp.Slab.uniform(bp.AIR, 0.4)
    ds = bp.beam_width(slab, bp.GaussianBeam(1.0, 30.0, x0=0.3, z0=-0.1), F)
    assert ds.centroid_out.item() == pytest.approx(0.3 + 0.5 * np.tan(np.deg2rad(30)), abs=2e-3)


def test_air_distance_is_two_wavelengths_by_default():
    """At each frequency of its own."""
    f = np.array([2000.0, 2500.0])
    default = bp.beam_width(SLAB, BEAM, f).fwhm_air
    for i, frequency in enumerate(f):
        stated = bp.beam_width(SLAB, BEAM, frequency, air_distance=2 * 343 / frequency).fwhm_air
        assert default[i].item() == pytest.approx(stated.item(), rel=1e-9)


def test_no_beam_behind_is_nan_and_said():
    """Behind an opaque slab there is no half level: nan with a warning, and the other widths stay."""
    with pytest.warns(RuntimeWarning, match="fwhm_out"):
        ds = bp.beam_width(bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 50_000), BEAM, F)
    assert np.isnan(ds.fwhm_out)
    assert ds.fwhm_launch == pytest.approx(0.096)


@pytest.mark.filterwarnings("ignore:the half level:RuntimeWarning")
def test_the_centroid_does_not_depend_on_what_else_is_asked():
    """At a frequency alone the window has other samples than beside higher frequencies."""
    slab, frequency = bp.Slab(bp.lmmd_cell(), 90), np.array([1500.0, 2000.0, 2500.0, 4000.0])
    many = bp.beam_width(slab, bp.GaussianBeam(0.1, 60.0), frequency).centroid_out
    alone = [bp.beam_width(slab, bp.GaussianBeam(0.1, 60.0), f).centroid_out.item() for f in frequency[:3]]
    assert np.abs(many.values[:3] - alone).max() < 2e-6
