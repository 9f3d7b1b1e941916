"""`compare`: each number against what was put in, and against the plain formula."""

import comsol_writer as writer
import matplotlib
import numpy as np
import pytest
import xarray as xr
from slanted_beam import X, Z, gaussian, make, swept

from beamprop.comparison.fields import compare
from beamprop.io.comsol import read_comsol

matplotlib.use("Agg")

# --- the numbers -----------------------------------------------------------------------------------------------------


def test_a_field_with_itself():
    c = compare(make(), make())
    assert float(c.relative_l2) == 0
    assert float(c.largest_error) == 0
    assert float(c.interpolation_error) == 0
    assert np.all(c.relative_l2_by_z == 0)
    assert np.all(c.fwhm_difference == 0)
    assert np.all(c.peak_difference == 0)
    np.testing.assert_allclose(c.scale, 1, rtol=1e-14)
    np.testing.assert_array_equal(c.p_a, make().p)
    assert c.attrs["conjugate_fits_better"] == 0


def test_plain_formulas_on_an_even_grid():
    random = np.random.default_rng(0)
    a = make()
    b = make(values=a.p.values + 0.01 * random.normal(size=a.p.shape))
    c, off = compare(a, b), np.abs(a.p.values - b.p.values)
    norm = np.linalg.norm
    np.testing.assert_allclose(c.relative_l2, norm(off) / norm(a.p), rtol=1e-12)
    np.testing.assert_allclose(c.relative_l2_by_z, norm(off, axis=1) / norm(a.p, axis=1), rtol=1e-12)
    np.testing.assert_allclose(c.largest_error, off.max() / np.abs(a.p.values).max(), rtol=1e-12)
    row, column = np.unravel_index(off.argmax(), off.shape)
    assert (float(c.largest_error_z), float(c.largest_error_x)) == (Z[row], X[column])
    np.testing.assert_array_equal(c.error, off)


def test_cells_are_the_weights_on_an_uneven_grid():
    x = np.concatenate([np.linspace(-0.6, 0, 11), np.linspace(0, 0.6, 301)[1:]])
    a = make(x)
    b = make(x, values=a.p.values * (1 + 0.1 * (x > 0)))
    even = np.linspace(-0.6, 0.6, 2001)
    fine = gaussian(even[None, :], Z[:, None])
    want = 0.1 * np.linalg.norm(fine * (even > 0)) / np.linalg.norm(fine)
    assert float(compare(a, b).relative_l2) == pytest.approx(want, rel=0.02)  # 0.097 without weights, 0.07 with


@pytest.mark.parametrize("factor", [2.0, 0.5j, 1.1 * np.exp(0.3j), -1e-6])
def test_the_scale_factor(factor):
    a = make()
    b = make(values=a.p.values / factor)
    c = compare(a, b)
    np.testing.assert_allclose(c.scale, factor, rtol=1e-12)
    np.testing.assert_allclose(c.relative_l2, abs(1 - 1 / factor), rtol=1e-9)
    assert float(c.relative_l2_scaled) < 1e-12
    scaled = compare(a, b, rescale=True)
    assert float(scaled.relative_l2) < 1e-12
    np.testing.assert_allclose(scaled.scale, factor, rtol=1e-12)
    np.testing.assert_allclose(scaled.p_b, a.p, rtol=1e-12)
    np.testing.assert_allclose(scaled.peak_difference, 0, atol=1e-12)
    assert (c.attrs["rescaled"], scaled.attrs["rescaled"]) == (0, 1)


def test_the_scale_is_the_best_one():
    random = np.random.default_rng(1)
    a = make()
    b = make(values=(a.p.values + 0.1 * random.normal(size=a.p.shape)) * (0.7 + 0.2j))
    best = float(compare(a, b).relative_l2_scaled)
    scale = complex(compare(a, b).scale)
    for factor in (scale * 1.01, scale * 0.99, scale * np.exp(0.01j), scale * np.exp(-0.01j)):
        assert float(compare(a, make(values=b.p.values * factor)).relative_l2) > best
    np.testing.assert_allclose(compare(a, b, rescale=True).relative_l2, best, rtol=1e-12)


def test_widths_and_peaks():
    b = 2 * gaussian(X[None, :], Z[:, None], radius=0.15)
    c = compare(make(), make(values=b))
    fwhm = 2 * np.sqrt(np.log(2)) * (1 + Z**2)
    np.testing.assert_allclose(c.fwhm_a, 0.1 * fwhm, rtol=1e-5)
    np.testing.assert_allclose(c.fwhm_b, 0.15 * fwhm, rtol=1e-5)
    np.testing.assert_allclose(c.fwhm_difference, 0.05 * fwhm, rtol=1e-4)
    np.testing.assert_allclose(c.peak_a, 1, rtol=1e-5)
    np.testing.assert_allclose(c.peak_difference, 1, rtol=1e-5)


def test_a_width_that_the_window_does_not_hold_is_nan():
    x = np.linspace(-0.05, 0.6, 66)
    assert np.all(np.isnan(compare(make(x), make(x)).fwhm_a))


# --- grids -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("x", [np.linspace(-0.6, 0.6, 151), np.linspace(-0.55, 0.58, 140), X + 0.003])
@pytest.mark.parametrize("z", [Z, np.linspace(-0.1, 0.5, 61), np.linspace(-0.06, 0.45, 47)])
def test_another_grid(x, z):
    c = compare(make(), make(x, z))
    assert 0 < float(c.relative_l2) < 2e-4
    assert float(c.interpolation_error) < 1e-2
    assert c.x.min() >= x[0]
    assert c.x.max() <= x[-1]
    assert c.z.min() >= z[0] - 1e-12
    assert c.z.max() <= z[-1]
    np.testing.assert_allclose(c.p_a, gaussian(c.x.values[None, :], c.z.values[:, None]), rtol=1e-12)


def test_a_part_of_the_same_grid_is_picked_exactly():
    c = compare(make(), make(X[10:90], Z[5:20]))
    assert float(c.relative_l2) == 0
    assert c.p_a.shape == (15, 80)
    assert float(c.interpolation_error) == 0


def test_falling_axes_and_any_order_of_dims():
    b = make().isel(x=slice(None, None, -1), z=slice(None, None, -1)).transpose("x", "z")
    assert float(compare(make(), b).relative_l2) == 0
    assert float(compare(b, make()).relative_l2) == 0


def test_one_plane():
    a, b = make().isel(z=4), make().isel(z=[4])
    c = compare(a, b)
    assert float(c.relative_l2) == 0
    assert c.relative_l2_by_z.shape == (1,)


def test_coarse_points_are_told_from_a_wrong_field():
    coarse = X[::12]
    with pytest.warns(UserWarning, match="b's points do not resolve its field"):
        c = compare(make(), make(coarse))
    assert float(c.interpolation_error) > 0.3 * float(c.relative_l2) > 1e-3


def test_layers_cannot_be_interpolated_through():
    import beamprop as bp

    slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096, z0=-0.05)
    x = np.linspace(-0.3, 0.3, 61)

    def field(z):
        return bp.field(slab, beam, 2500.0, x=x, z=z)

    with pytest.warns(UserWarning, match="the field changes from layer to layer"):
        compare(field(np.linspace(-0.05, 0.1, 16)), field(np.linspace(-0.05, 0.1, 21)))
    behind = np.linspace(0.05, 0.2, 16), np.linspace(0.05, 0.2, 21)
    assert float(compare(*map(field, behind)).relative_l2) < 1e-4
    same = field(np.linspace(-0.05, 0.1, 16))
    assert float(compare(same, same).relative_l2) == 0


def test_points_without_a_value_are_left_out():
    values = make().p.values.copy()
    values[3, 60] = np.nan
    values[:, :4] = np.nan
    with pytest.warns(UserWarning, match=r"125 of 3751 points have no value"):
        c = compare(make(), make(values=values))
    assert float(c.relative_l2) == 0
    assert np.isnan(c.error).sum() == 125
    moved = np.linspace(-0.59, 0.59, 111)
    with pytest.warns(UserWarning, match="have no value"):
        c = compare(make(moved), make(values=values))
    assert 0 < float(c.relative_l2) < 1e-3
    with pytest.warns(UserWarning, match="have no value"):
        assert float(compare(make(values=values), make()).relative_l2) == 0
    with pytest.raises(ValueError, match="b: expected values in the region that a covers, got NaN"):
        compare(make(), make(values=values * np.nan))


@pytest.mark.parametrize(
    ("b", "said"),
    [
        (make(X + 3), r"b: expected x that covers points of a, -0.6 to 0.6 m, got 2.4 to 3.6 m"),
        (make(z=Z + 3), r"b: expected z that covers points of a, -0.1 to 0.5 m, got 2.9 to 3.5 m"),
    ],
)
def test_no_common_region(b, said):
    with pytest.raises(ValueError, match=said):
        compare(make(), b)


# --- sweeps -------------------------------------------------------------------------------------------------------------


def test_sweeps_are_compared_one_by_one():
    a = swept()
    b = a.copy(deep=True)
    b["p"] = b.p * xr.DataArray([1.0, 1.5], dims="angle")
    b.p.attrs = a.p.attrs
    c = compare(a, b.transpose("x", "angle", "z", "frequency").isel(frequency=[1, 0]).sortby("frequency"))
    assert c.relative_l2.dims == ("frequency", "angle")
    assert c.fwhm_difference.dims == ("frequency", "angle", "z")
    np.testing.assert_allclose(c.relative_l2, [[0, 0.5], [0, 0.5]], rtol=1e-12)
    np.testing.assert_allclose(c.scale, [[1, 1 / 1.5], [1, 1 / 1.5]], rtol=1e-12)
    single = compare(a.isel(frequency=1, angle=1), b.isel(frequency=[1], angle=1))
    for name in ("largest_error", "largest_error_x", "largest_error_z", "relative_l2_scaled"):
        np.testing.assert_allclose(c[name][1, 1], single[name], rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize(
    ("b", "said"),
    [
        (swept().isel(angle=0, drop=True), "b: expected the dims .* select one angle"),
        (swept(angles=(0.0, 31.0)), "b: expected the same angle as a, .*30.*31"),
        (swept(frequencies=(2000.0, 2500.0, 2600.0)), "b: expected the same frequency as a"),
    ],
)
def test_other_sweeps_are_refused(b, said):
    with pytest.raises(ValueError, match=said):
        compare(swept(), b)


def test_other_single_frequencies_are_refused():
    a, b = (make().assign_coords(frequency=f) for f in (2500.0, 2400.0))
    with pytest.raises(ValueError, match=r"b: expected the same frequency as a, 2500.*2400"):
        compare(a, b)
    compare(a, make().assign_coords(frequency=2500.01))  # a file's header holds five digits
    compare(a, make())


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((make(), 3), "b: expected a dataset with the pressure p, got int"),
        ((make().rename(p="q"), make()), "a: expected a dataset with the pressure p, got q"),
        ((make().drop_vars("x"), make()), "a: expected p on"),
        ((make(), make().stack(node=("z", "x"), create_index=False)), "b: expected p on .* scattered nodes"),
        ((make(np.sort(np.r_[X, X[:1]])), make()), "a: expected finite and distinct positions x"),
        ((make(), make(), "yes"), "rescale: expected True or False, got 'yes'"),
    ],
)
def test_arguments_are_checked(arguments, said):
    with pytest.raises(ValueError, match=said):
        compare(*arguments)


def test_every_variable_has_units_and_the_file_format_takes_it(tmp_path):
    c = compare(make(boundary="open"), make(boundary="open"))
    for name in c.variables:
        assert {"units", "long_name"} <= set(c[name].attrs), name
    c.to_netcdf(tmp_path / "c.nc", engine="h5netcdf")


def test_a_comsol_file_against_our_field(tmp_path):
    """From the file's text to the numbers: centimetres, kilopascals, exp(+i w t), another grid."""
    import beamprop as bp

    slab, beam = bp.Slab.uniform(bp.Fluid(2.5, 1.5e5), 0.1), bp.GaussianBeam(0.2, angle=10, z0=-0.1)
    x, z = np.linspace(-0.4, 0.4, 81), np.linspace(-0.1, 0.2, 31)
    ours = bp.field(slab, beam, 2500.0, x=x[3:-3], z=z)
    theirs = bp.field(slab, beam, 2500.0, x=x, z=z)
    zz, xx = np.meshgrid(z, x, indexing="ij")
    path = writer.spreadsheet(
        tmp_path / "a.txt",
        {"x": zz.ravel(), "y": xx.ravel()},
        [("acpr.p_t (kPa) @ freq=2500, theta=10[deg]", np.conj(theirs.p.values.ravel()) / 1e3)],
        style="txt",
        unit="cm",
    )
    c = compare(ours, read_comsol(path, x="y", z="x"))
    assert float(c.relative_l2) < 1e-12
    with pytest.warns(UserWarning, match=r"b looks like exp\(\+i w t\)"):
        compare(ours, read_comsol(path, x="y", z="x", conjugate=False))
