"""COMSOL exports: which expression becomes p, in which unit and with which sign of time."""

import comsol_writer as writer
import numpy as np
import pytest
from comsol_wave import expected, field_on_rows, points

from beamprop.io.comsol import read_comsol


@pytest.mark.parametrize("name", ["acpr.p_t", "pabe.p_t", "comp1.acpr2.p_t", "p", "acpr.p", "p_t"])
@pytest.mark.parametrize(("unit", "pascal"), [("Pa", 1.0), ("kPa", 1e3), ("mPa", 1e-3), ("\N{MICRO SIGN}Pa", 1e-6)])
def test_pressure_by_any_name_in_pascal(tmp_path, name, unit, pascal):
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), [(f"{name} ({unit})", field_on_rows())]))
    np.testing.assert_allclose(ds.p, expected() * pascal, rtol=1e-14)
    assert ds.p.attrs["units"] == "Pa"
    assert ds.p.attrs["expression"] == name


@pytest.mark.parametrize("style", ["csv", "txt", "dat", "semicolon"])
@pytest.mark.parametrize("gap", [1, 3])
def test_several_expressions(tmp_path, style, gap):
    f, speed = field_on_rows(), 3 * field_on_rows(1.0)
    kinds = [
        ("abs(acpr.p_t) (Pa)", np.abs(f)),
        ("acpr.p_t (Pa)", f),
        ("acpr.p_b (Pa)", 2 * f),
        ("acpr.v_x (m/s)", speed),
        ("int1(x, y) (kg/(m^2*s))", np.arange(24.0)),
        ("acpr.Lp (dB)", f.real),
        ("at2(0, acpr.p) (Pa)", f.imag),
    ]
    columns = [(f"{name} @ freq={q}, theta=0", v * q) for q in (100, 200) for name, v in kinds]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns, style=style, gap=gap))
    assert set(ds.data_vars) == {"p", "abs_p_t", "p_b", "v_x", "int1_x_y", "Lp", "at2_0_p"}
    np.testing.assert_array_equal(ds.p.sel(frequency=200), 200 * expected())
    np.testing.assert_array_equal(ds.p_b, 2 * ds.p)
    np.testing.assert_array_equal(ds.abs_p_t.sel(frequency=100), (100 * np.abs(f)).reshape(4, 6))
    np.testing.assert_allclose(ds.v_x.sel(frequency=100), 300 * expected(1.0), rtol=1e-14)
    assert not np.iscomplexobj(ds.abs_p_t)
    assert ds.v_x.attrs["units"] == "m/s"
    assert ds.int1_x_y.attrs["units"] == "kg/(m^2*s)"


def test_expression_chooses_p(tmp_path):
    columns = [("acpr.p_t (Pa)", field_on_rows(1.0)), ("acpr.p_s (Pa)", field_on_rows(2.0))]
    path = writer.spreadsheet(tmp_path / "a", points(), columns)
    np.testing.assert_array_equal(read_comsol(path).p, expected(1.0))
    ds = read_comsol(path, expression="acpr.p_s")
    np.testing.assert_array_equal(ds.p, expected(2.0))
    np.testing.assert_array_equal(ds.p_t, expected(1.0))
    with pytest.raises(ValueError, match=r"expression: expected one of acpr\.p_t, acpr\.p_s .* got 'acpr\.p_b'"):
        read_comsol(path, expression="acpr.p_b")


def test_two_pressures_must_be_chosen_from(tmp_path):
    columns = [("acpr.p_t (Pa)", field_on_rows()), ("pabe.p_t (Pa)", field_on_rows(1.0))]
    path = writer.spreadsheet(tmp_path / "a", points(), columns)
    with pytest.raises(ValueError, match=r"expression: expected one to be chosen of acpr\.p_t, pabe\.p_t"):
        read_comsol(path)
    ds = read_comsol(path, expression="pabe.p_t")
    np.testing.assert_array_equal(ds.p_t, expected())


def test_real_and_imaginary_parts_become_p(tmp_path):
    f = field_on_rows()
    columns = [("real(acpr.p_t) (kPa)", f.real), ("imag(acpr.p_t) (kPa)", f.imag)]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns))
    np.testing.assert_allclose(ds.p, 1e3 * expected(), rtol=1e-14)
    assert not np.iscomplexobj(ds.imag_p_t)


def test_names_that_are_taken(tmp_path):
    columns = [
        ("acpr.p_t (Pa)", field_on_rows()),
        ("x (m)", points()["x"]),
        ("acpr.v (m/s)", np.ones(24)),
        ("aco.v (m/s)", np.zeros(24)),
        ("acpr.p (Pa)", field_on_rows(1.0)),
    ]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns))
    assert set(ds.data_vars) == {"p", "v_x", "acpr_v", "aco_v", "acpr_p"}
    np.testing.assert_array_equal(ds.acpr_p, expected(1.0))


def test_no_pressure_in_the_file(tmp_path):
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), [("abs(acpr.p_t) (Pa)", np.ones(24))]))
    assert list(ds.data_vars) == ["abs_p_t"]


def test_pressure_without_a_unit(tmp_path):
    path = writer.spreadsheet(tmp_path / "a", points(), [("nate.p_t", field_on_rows())])
    with pytest.warns(UserWarning, match=r"no unit of nate\.p_t, Pa taken"):
        np.testing.assert_array_equal(read_comsol(path).p, expected())


def test_conjugation_is_stated_and_optional(tmp_path):
    columns = [("acpr.p_t (Pa)", field_on_rows()), ("acpr.v_x (m/s)", field_on_rows(1.0))]
    path = writer.spreadsheet(tmp_path / "a", points(), columns)
    ours, theirs = read_comsol(path), read_comsol(path, conjugate=False)
    np.testing.assert_array_equal(ours.p, np.conj(theirs.p))
    np.testing.assert_array_equal(ours.v_x, np.conj(theirs.v_x))
    assert ours.attrs["convention"].startswith("exp(-i w t), conjugated")
    assert theirs.attrs["convention"].startswith("exp(+i w t)")
    assert "exp(+i w t)" in theirs.p.attrs["long_name"]


def test_a_lossy_outgoing_wave_decays_along_its_phase(tmp_path):
    """exp(-i k x) with Im k < 0 is the outgoing wave of exp(+i w t); with exp(-i w t) it is exp(+i k x), Im k > 0."""
    at = points()
    outgoing = np.exp(-1j * (3 - 0.4j) * at["y"])
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", outgoing)]))
    slope = np.gradient(np.log(ds.p.values[:, 0]), ds.z) / 1j
    np.testing.assert_allclose(slope, 3 + 0.4j, rtol=1e-10)


def test_every_variable_has_units_and_the_file_is_recorded(tmp_path):
    columns = [("acpr.p_t (Pa) @ freq=100, m=1", field_on_rows()), ("acpr.p_t (Pa) @ freq=100, m=2", field_on_rows())]
    path = writer.spreadsheet(tmp_path / "a", points(), columns)
    ds = read_comsol(path)
    for name in ds.variables:
        assert {"units", "long_name"} <= set(ds[name].attrs), name
    from beamprop.io.datasets import provenance

    record = provenance(ds)
    assert record["question"] == "read_comsol"
    assert record["file"] == str(path)
    assert record["expression"] == "acpr.p_t"
    assert record["comsol"] == "COMSOL 6.0.0.354"
