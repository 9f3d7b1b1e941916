"""COMSOL exports: what `comsol_writer` writes comes back, in every form, style, unit and locale."""

import comsol_writer as writer
import numpy as np
import pytest
import xarray as xr
from comsol_wave import X, Z, expected, field_on_rows, points, wave
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from beamprop.io.comsol import read_comsol, to_grid


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
