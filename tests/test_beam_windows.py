"""Beam measures where |p| does not fall: windows of the user's choice, and what is said of the widest one tried."""

import warnings

import numpy as np
import pytest

import beamprop as bp

LOSSLESS = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), 450)
BEAM = bp.GaussianBeam(0.096, angle=20)
MOMENTS = ("centroid", "lateral_shift", "width_second_moment", "rim", "moments_from", "moments_to")


def quiet(*args, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return bp.beam_measures(*args, **options)


def test_no_nan_where_guided_waves_run_along():
    """The moments are those of the interval that is stated, with what is cut off at its ends; and that is said."""
    with pytest.warns(RuntimeWarning, match=r"of its peak only, in the widest window tried: .* choose a window"):
        ds = bp.beam_measures(LOSSLESS, BEAM, 2200.0)
    for name in MOMENTS:
        assert np.all(np.isfinite(ds[name]))
    assert np.all(ds.rim > 0.01)
    assert np.all(ds.moments_from < ds.centroid)
    assert np.all(ds.centroid < ds.moments_to)


@pytest.mark.parametrize("frequency", [2000.0, 2200.0, 2400.0])
def test_moments_of_a_window_are_those_of_the_field(frequency):
    """About the geometric ray of each side, against sums over the field on a fine grid."""
    half = 1.0
    ds = quiet(LOSSLESS, BEAM, frequency, window=half)
    rays = {"reflected": 0.0, "transmitted": LOSSLESS.thickness * np.tan(np.radians(20))}
    z = LOSSLESS.thickness
    for side, ray in rays.items():
        one = ds.sel(side=side)
        np.testing.assert_allclose([one.moments_from, one.moments_to], [ray - half, ray + half], atol=1e-12)
        assert one.lateral_shift == pytest.approx(float(one.centroid) - ray)
    x = rays["transmitted"] + half * np.linspace(-1, 1, 20_001)
    p = np.abs(bp.field(LOSSLESS, BEAM, frequency, x, z).p.values)
    weight = p**2
    centre = np.trapezoid(weight * x, x) / np.trapezoid(weight, x)
    spread = np.sqrt(np.trapezoid(weight * (x - centre) ** 2, x) / np.trapezoid(weight, x))
    out = ds.sel(side="transmitted")
    assert float(out.centroid) == pytest.approx(centre, abs=1e-5)
    assert float(out.width_second_moment) == pytest.approx(4 * spread, rel=1e-5)
    assert float(out.rim) == pytest.approx(max(p[0], p[-1]) / p.max(), rel=1e-4)


def test_a_window_that_holds_the_beam_changes_nothing():
    """Where |p| falls, moments over a wide window are those of the part around the peak, but for its tails."""
    slab = bp.Slab.uniform(bp.Fluid(1.25 * 2, bp.AIR.bulk_modulus * 3), 0.1)
    beam = bp.GaussianBeam(1.0, angle=10)
    plain, wide = bp.beam_measures(slab, beam, 2500.0), bp.beam_measures(slab, beam, 2500.0, window=6.0)
    assert np.all(plain.rim <= 0.01)
    for name in ("fwhm", "width_1e2", "power", "divergence", "peak"):
        np.testing.assert_allclose(wide[name], plain[name], rtol=1e-5)
    np.testing.assert_allclose(wide.centroid, plain.centroid, atol=2e-3)
    np.testing.assert_allclose(wide.width_second_moment, plain.width_second_moment, rtol=5e-3)
    assert bp.provenance(wide)["window"] == 6.0


@pytest.mark.parametrize("wrong", [0.0, -1.0, np.nan, "wide"])
def test_wrong_windows(wrong):
    with pytest.raises(ValueError, match="window: expected"):
        bp.beam_measures(LOSSLESS, BEAM, 2500.0, window=wrong)
