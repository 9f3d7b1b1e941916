"""COMSOL exports: parameters in the names of columns, with units, numbers and gaps."""

import comsol_writer as writer
import numpy as np
import pytest
from comsol_wave import expected, field_on_rows, points

from beamprop.io.comsol import read_comsol


@pytest.mark.parametrize(
    ("text", "hertz"),
    [
        ("freq=1E2", 100.0),
        ("freq=1.7889E14", 1.7889e14),
        ("freq=2.5[kHz]", 2500.0),
        ("freq=2.5 kHz", 2500.0),
        ("freq[kHz]=2.5", 2500.0),
        ("freq=2500 Hz", 2500.0),
        ("freq = 2500", 2500.0),
        ("f=3[MHz]", 3e6),
    ],
)
@pytest.mark.parametrize("style", ["csv", "txt", "semicolon"])
def test_value_of_a_frequency(tmp_path, text, hertz, style):
    columns = [(f"acpr.p_t (Pa) @ {text}, theta=0", field_on_rows())]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns, style=style))
    assert float(ds.frequency) == pytest.approx(hertz, rel=1e-14)
    assert ds.frequency.attrs["units"] == "Hz"
    np.testing.assert_array_equal(ds.p, expected())


@pytest.mark.parametrize("style", ["csv", "txt", "dat", "semicolon"])
@pytest.mark.parametrize("gap", [1, 4])
def test_numbered_solutions_with_units_after_a_blank(tmp_path, style, gap):
    angles = [-45.0, 0.0, 30.5]
    columns = []
    for k, t in enumerate(angles, 1):
        where = writer.parameters({"freq": "10000 Hz", "theta0": f"{t} deg"}, "indexed", k)
        columns += [(f"pelw.p_t (Pa){where}", field_on_rows(k)), (f"pelw.Lp (dB){where}", np.full(24, float(k)))]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns, style=style, gap=gap))
    np.testing.assert_array_equal(ds.angle, angles)
    assert float(ds.frequency) == 10000
    assert ds.Lp.attrs["units"] == "dB"
    assert not np.iscomplexobj(ds.Lp)
    for k, t in enumerate(angles, 1):
        np.testing.assert_array_equal(ds.p.sel(angle=t), expected(k))
        assert np.all(ds.Lp.sel(angle=t) == k)


def test_a_name_after_a_blank_that_could_be_a_unit(tmp_path):
    """One blank between the columns of txt: 's' may be seconds, but its own unit and parameters say otherwise."""
    columns = [
        (f"{name} @ freq={f}", v) for f in (1, 2) for name, v in (("p (Pa)", field_on_rows()), ("s (1)", np.ones(24)))
    ]
    columns += [(f"m @ freq={f}", np.zeros(24)) for f in (1, 2)]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns, style="txt", gap=1))
    assert set(ds.data_vars) == {"p", "s", "m"}
    np.testing.assert_array_equal(ds.frequency, [1, 2])
    assert np.all(ds.s == 1)


def test_negative_parameters_are_sorted_and_others_keep_their_names(tmp_path):
    values = {(h, m): field_on_rows(h + m) for h in (0.5, -0.25) for m in (3.0, -1.0, 2.0)}
    columns = [(f"p (Pa) @ h={h}[mm], m={m}", v) for (h, m), v in values.items()]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns))
    assert ds.p.dims == ("h", "m", "z", "x")
    np.testing.assert_array_equal(ds.m, [-1, 2, 3])
    np.testing.assert_allclose(ds.h, [-0.25e-3, 0.5e-3])
    assert ds.h.attrs["units"] == "m"
    np.testing.assert_array_equal(ds.p.isel(h=0).sel(m=2.0), expected(1.75))


def test_radians_become_degrees(tmp_path):
    columns = [(f"p (Pa) @ theta={t}[rad]", field_on_rows(t)) for t in (0.0, np.pi / 4)]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", points(), columns))
    np.testing.assert_allclose(ds.angle, [0, 45])


def test_an_angle_without_a_unit_is_warned_about(tmp_path):
    columns = [(f"p (Pa) @ theta={t}", field_on_rows(t)) for t in (0.0, 0.7854)]
    path = writer.spreadsheet(tmp_path / "a", points(), columns)
    with pytest.warns(UserWarning, match="no unit of the angle"):
        assert float(read_comsol(path).angle[1]) == 0.7854
    assert float(read_comsol(path, angle_unit="rad").angle[1]) == pytest.approx(45, rel=1e-4)
    assert float(read_comsol(path, angle_unit="deg").angle[1]) == 0.7854


def test_missing_combinations_are_nan_and_counted(tmp_path):
    columns = [(f"acpr.p_t (Pa) @ freq={f}, m={m}", field_on_rows(f + m)) for f in (1, 2) for m in (0, 1, 2)]
    path = writer.spreadsheet(tmp_path / "a", points(), columns[:-1])
    with pytest.warns(UserWarning, match=r"1 of 6 combinations of parameters are missing for acpr\.p_t"):
        ds = read_comsol(path)
    assert np.all(np.isnan(ds.p.sel(frequency=2, m=2)))
    np.testing.assert_array_equal(ds.p.sel(frequency=1, m=2), expected(3))
    assert np.isfinite(ds.p).sum() == 5 * 24


@pytest.mark.parametrize("unit", ["Hz", "kHz"])
def test_a_frequency_that_is_a_column(tmp_path, unit):
    at, factor = points(), {"Hz": 1.0, "kHz": 1e-3}[unit]
    rows = {n: np.tile(v, 2) for n, v in at.items()}
    columns = [
        (f"freq ({unit})", np.repeat([2000.0, 2500.0], 24) * factor),
        ("acpr.p_t (Pa)", np.concatenate([field_on_rows(2.0), field_on_rows(2.5)])),
    ]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", rows, columns, style="txt"))
    np.testing.assert_allclose(ds.frequency, [2000, 2500])
    np.testing.assert_array_equal(ds.p, [expected(2.0), expected(2.5)])
