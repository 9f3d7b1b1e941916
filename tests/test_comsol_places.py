"""COMSOL exports: values and coordinates as files have them, in any order, with gaps, doubles and other units."""

import comsol_writer as writer
import numpy as np
import pytest
import xarray as xr
from comsol_wave import X, Z, expected, field_on_rows, points, wave

from beamprop.io.comsol import read_comsol


def test_nan_outside_the_domain_and_infinite_levels(tmp_path):
    values, level = field_on_rows(), np.full(24, -np.inf)
    values[[3, 10]] = np.nan
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), [("p (Pa)", values), ("acpr.Lp (dB)", level)]))
    assert np.isnan(ds.p.values.ravel()[[3, 10]]).all()
    assert np.isfinite(ds.p).sum() == 22
    assert np.all(ds.Lp == -np.inf)


def test_coordinates_with_rounding_errors_are_a_grid(tmp_path):
    at = points()
    noise = np.random.default_rng(0).uniform(-1, 1, (2, 24)) * 1e-16
    moved = {"x": at["x"] + noise[0], "y": at["y"] + noise[1]}
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", moved, [("p (Pa)", field_on_rows())]))
    np.testing.assert_array_equal(ds.p, expected())


def test_rows_in_any_order(tmp_path):
    order = np.random.default_rng(1).permutation(24)
    at = {n: v[order] for n, v in points().items()}
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", field_on_rows()[order])]))
    np.testing.assert_array_equal(ds.p, expected())


def test_rows_that_stand_twice(tmp_path):
    rows = [*range(24), 5, 7]
    at, values = {n: v[rows] for n, v in points().items()}, field_on_rows()[rows]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", values)]))
    np.testing.assert_array_equal(ds.p, expected())
    values[5] = np.nan  # the second of the pair still has a value
    ds = read_comsol(writer.spreadsheet(tmp_path / "c", at, [("p (Pa)", values)]))
    np.testing.assert_array_equal(ds.p, expected())
    values[5] = values[24]
    values[-1] += 1
    with pytest.warns(UserWarning, match="p has two values at 1 points"):
        ds = read_comsol(writer.spreadsheet(tmp_path / "b", at, [("p (Pa)", values)]))
    np.testing.assert_array_equal(ds.p, expected())


def test_a_grid_with_a_few_points_missing(tmp_path):
    keep = np.delete(np.arange(24), [0, 9])
    at = {n: v[keep] for n, v in points().items()}
    with pytest.warns(UserWarning, match="2 of the grid's 24 points are missing"):
        ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", field_on_rows()[keep])]))
    assert np.isnan(ds.p).sum() == 2


@pytest.mark.parametrize("names", [("x", "y"), ("X", "Y"), ("r", "z"), ("y", "z")])
def test_the_first_coordinate_is_x_and_the_arguments_choose(tmp_path, names):
    at = dict(zip(names, points().values(), strict=True))
    path = writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", field_on_rows())])
    ds = read_comsol(path)
    assert (ds.x.attrs["file_coordinate"], ds.z.attrs["file_coordinate"]) == names
    turned = read_comsol(path, x=names[1], z=names[0])
    np.testing.assert_array_equal(turned.p.values, expected().T)
    for half_given in (read_comsol(path, x=names[1]), read_comsol(path, z=names[0])):
        xr.testing.assert_equal(half_given, turned)


def test_three_coordinates_with_one_constant(tmp_path):
    at = points()
    rows = {"x": np.full(24, 0.3), "y": at["x"], "z": at["y"]}
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", rows, [("p (Pa)", field_on_rows())]))
    assert ds.x.attrs["file_coordinate"] == "y"
    np.testing.assert_array_equal(ds.p, expected())


def test_a_line(tmp_path):
    path = writer.spreadsheet(tmp_path / "a", {"x": X}, [("p (Pa)", np.conj(wave(X, 0)))])
    ds = read_comsol(path)
    assert ds.p.dims == ("x",)
    np.testing.assert_array_equal(ds.p, wave(X, 0))
    assert read_comsol(path, z="x").p.dims == ("z",)


def test_units_in_the_names_of_coordinates(tmp_path):
    at = points()
    at = {"x (mm)": at["x"], "y (cm)": at["y"]}
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", field_on_rows())], unit=None))
    np.testing.assert_allclose(ds.x, X / 1e3, atol=1e-18)
    np.testing.assert_allclose(ds.z, Z / 1e2, atol=1e-18)


@pytest.mark.parametrize("unit", [None, "null"])
def test_no_unit_of_length(tmp_path, unit):
    path = writer.spreadsheet(tmp_path / "a", points(), [("p (Pa)", field_on_rows())], unit=unit)
    with pytest.warns(UserWarning, match="no unit of length, metres taken"):
        ds = read_comsol(path)
    np.testing.assert_array_equal(ds.x, X)
    np.testing.assert_allclose(read_comsol(path, length_unit="mm").x, X / 1e3, atol=1e-18)
