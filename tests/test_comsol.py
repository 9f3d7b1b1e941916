"""COMSOL exports: what `comsol_writer` writes comes back, whatever the form, the locale and the traps."""

import comsol_writer as writer
import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from beamprop.io.comsol import read_comsol, to_grid

X, Z = np.linspace(-0.2, 0.3, 6), np.linspace(-0.1, 0.4, 4)


def wave(x, z, k=2.0):
    return np.exp(-(x**2) + 1j * k * z) * (1.5 - 0.3j)


def points(x=X, z=Z):
    """Rows of a spreadsheet, x fastest: coordinates and where each row stands on the (z, x) grid."""
    zz, xx = np.meshgrid(z, x, indexing="ij")
    return {"x": xx.ravel(), "y": zz.ravel()}


def field_on_rows(k=2.0):
    at = points()
    return np.conj(wave(at["x"], at["y"], k))  # COMSOL's exp(+i w t)


def expected(k=2.0, x=X, z=Z):
    return wave(x[None, :], z[:, None], k)


# --- round trips ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("style", ["csv", "txt", "dat", "semicolon"])
@pytest.mark.parametrize("imaginary", ["i", "j", "*i"])
@pytest.mark.parametrize("unit", ["m", "mm", "cm", "um", "\N{MICRO SIGN}m", "in"])
def test_spreadsheet_in_every_style_and_unit(tmp_path, style, imaginary, unit):
    path = writer.spreadsheet(
        tmp_path / f"a.{style}",
        points(),
        [("acpr.p_t (Pa)", field_on_rows())],
        style=style,
        imaginary=imaginary,
        unit=unit,
    )
    ds = read_comsol(path)
    assert ds.p.dims == ("z", "x")
    assert ds.p.dtype == complex
    np.testing.assert_allclose(ds.x, X, rtol=1e-14, atol=1e-16)
    np.testing.assert_allclose(ds.z, Z, rtol=1e-14, atol=1e-16)
    np.testing.assert_array_equal(ds.p, expected())


@pytest.mark.parametrize(
    "options",
    [
        {"style": "semicolon", "comma": True},
        {"style": "txt", "comma": True},
        {"style": "csv", "comma": True},
        {"style": "csv", "quote": True},
        {"style": "csv", "percent": False},
        {"style": "txt", "percent": False},
        {"style": "csv", "crlf": True},
        {"style": "txt", "encoding": "utf-8-sig"},
        {"style": "csv", "encoding": "utf-16"},
        {"style": "csv", "encoding": "latin-1", "unit": "\N{MICRO SIGN}m"},
        {"style": "txt", "gap": 1},
        {"style": "csv", "leave_out": ("Model", "Version", "Date", "Nodes", "Expressions", "Description", "Dimension")},
    ],
    ids=str,
)
def test_locales_and_versions(tmp_path, options):
    columns = [(f"acpr.p_t (Pa) @ freq={f}", field_on_rows(k)) for f, k in ((100, 1.0), (200, 2.0))]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a.x", points(), columns, **options))
    np.testing.assert_array_equal(ds.frequency, [100, 200])
    np.testing.assert_allclose(ds.z, Z, rtol=1e-14, atol=1e-16)
    for f, k in ((100, 1.0), (200, 2.0)):
        np.testing.assert_array_equal(ds.p.sel(frequency=f), expected(k))


finite = st.floats(-1e6, 1e6, allow_subnormal=False)
axis = st.lists(st.integers(-999, 999), min_size=1, max_size=5, unique=True).map(lambda v: np.sort(v) / 64)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    data=st.data(),
    style=st.sampled_from(["csv", "txt", "semicolon"]),
    comma=st.booleans(),
    x=axis,
    z=axis,
    frequency=st.lists(st.floats(1e-3, 1e15), min_size=1, max_size=3, unique=True),
    theta=st.lists(st.floats(-89, 89), min_size=1, max_size=3, unique=True),
)
def test_any_sweep_comes_back(tmp_path, data, style, comma, x, z, frequency, theta):
    comma = comma and style != "csv"
    at = points(x, z)
    values = {
        (f, t): np.array(
            data.draw(st.lists(st.builds(complex, finite, finite), min_size=at["x"].size, max_size=at["x"].size))
        )
        for f in frequency
        for t in theta
    }
    columns = [
        ("pabe.p_t (Pa)" + writer.parameters({"freq": f, "theta": f"{writer.real(t)} deg"}), v)
        for (f, t), v in values.items()
    ]
    path = writer.spreadsheet(tmp_path / "a", at, data.draw(st.permutations(columns)), style=style, comma=comma)
    p = read_comsol(path).p
    p = p.expand_dims([d for d in ("frequency", "angle") if d not in p.dims])
    assert set(p.dims) == {"frequency", "angle", "z", "x"}
    for (f, t), v in values.items():
        got = p.sel(frequency=f, angle=t).transpose("z", "x").values
        np.testing.assert_array_equal(got, np.conj(v).reshape(z.size, x.size))


@pytest.mark.parametrize("label", ["inside", "below"])
@pytest.mark.parametrize("style", ["txt", "csv"])
def test_grid_form(tmp_path, style, label):
    values = [(f"acpr.p_t (Pa) @ freq={f}, theta=0", np.conj(expected(k))) for f, k in ((100, 1.0), (300, 3.0))]
    ds = read_comsol(writer.grid(tmp_path / "a", (X, Z), values, unit="mm", style=style, label=label))
    assert ds.p.dims == ("frequency", "z", "x")
    assert float(ds.angle) == 0
    np.testing.assert_array_equal(ds.p, [expected(1.0), expected(3.0)])
    np.testing.assert_allclose(ds.z, Z, rtol=1e-14, atol=1e-16)


def test_grid_form_in_three_dimensions_of_one_plane(tmp_path):
    path = writer.grid(tmp_path / "a", (X, np.array([0.7]), Z), [("p (Pa)", np.conj(expected()))])
    ds = read_comsol(path)
    assert ds.z.attrs["file_coordinate"] == "z"
    np.testing.assert_array_equal(ds.p, expected())


def test_grid_form_without_a_name(tmp_path):
    path = writer.grid(tmp_path / "a", (X, Z), [("", np.conj(expected()))], label="none")
    with pytest.warns(UserWarning, match="does not name its data"):
        ds = read_comsol(path)
    np.testing.assert_array_equal(ds.p, expected())


@pytest.fixture
def mesh():
    random = np.random.default_rng(3)
    corners = [[-1, -1], [1, -1], [-1, 1], [1, 1]]
    nodes = np.concatenate([corners, random.uniform(-1, 1, (60, 2))])
    from scipy.spatial import Delaunay

    return nodes, Delaunay(nodes).simplices


@pytest.mark.parametrize("label", ["inside", "below"])
def test_sectionwise_form(tmp_path, mesh, label):
    nodes, elements = mesh
    values = wave(*nodes.T)
    columns = [("acpr.p_t (Pa)", np.conj(values)), ("abs(acpr.p_t) (Pa)", np.abs(values))]
    ds = read_comsol(writer.sectionwise(tmp_path / "a.txt", nodes, elements, columns, unit="cm", label=label))
    assert ds.p.dims == ("node",)
    order = np.lexsort((ds.x.values, ds.z.values))
    there = np.lexsort(nodes.T)
    np.testing.assert_allclose(ds.x.values[order], nodes[there, 0], rtol=1e-14)
    np.testing.assert_array_equal(ds.p.values[order], values[there])
    corners = np.stack([ds.x, ds.z], axis=-1)[ds.elements.values]
    np.testing.assert_allclose(corners, nodes[elements], rtol=1e-14)  # the same triangles
    np.testing.assert_array_equal(np.abs(ds.p), ds.abs_p_t)


def test_scattered_spreadsheet_and_to_grid(tmp_path, mesh):
    nodes, _ = mesh
    linear = np.conj(2 + nodes[:, 0] - 3j * nodes[:, 1])
    columns = [(f"acpr.p_t (Pa) @ freq={f}", f * linear) for f in (100, 200)]
    ds = read_comsol(writer.spreadsheet(tmp_path / "a.txt", {"x": nodes[:, 0], "y": nodes[:, 1]}, columns, style="txt"))
    assert ds.p.dims == ("frequency", "node")
    grid = to_grid(ds, np.linspace(-0.9, 0.9, 7), np.linspace(-2.0, 0.9, 5))
    assert grid.p.dims == ("frequency", "z", "x")
    want = grid.frequency * (2 + grid.x - 3j * grid.z).transpose("z", "x")
    assert np.all(np.isnan(grid.p.sel(z=-2.0)))
    np.testing.assert_allclose(grid.p[:, 2:], want[:, 2:], rtol=1e-12)
    assert grid.p.attrs["units"] == "Pa"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"ds": xr.Dataset({"p": ("x", [1.0])})}, "ds: expected a dataset with the dim 'node'"),
        ({"x": [1.0, 0.0]}, "x: expected a 1-D array of finite, strictly increasing"),
        ({"z": [[0.0]]}, "z: expected a 1-D array"),
    ],
)
def test_to_grid_refuses(change, said):
    nodes = xr.Dataset({"p": ("node", [1.0, 2, 3])}, {"x": ("node", [0.0, 1, 0]), "z": ("node", [0.0, 0, 1])})
    with pytest.raises(ValueError, match=said):
        to_grid(**({"ds": nodes, "x": [0.0, 1.0], "z": [0.0, 1.0]} | change))


# --- traps: parameters ---------------------------------------------------------------------------------------------


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


# --- traps: values and coordinates ---------------------------------------------------------------------------------


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
    for given_one in (read_comsol(path, x=names[1]), read_comsol(path, z=names[0])):
        xr.testing.assert_equal(given_one, turned)


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


# --- traps: expressions --------------------------------------------------------------------------------------------


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
