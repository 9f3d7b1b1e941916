"""COMSOL's exports as they are met, every form in every version from 5.1 to 6.4: what `comsol_writer` writes comes back."""

import comsol_writer as writer
import numpy as np
import pytest

from beamprop.io.comsol import read_comsol

X, Z = np.linspace(-0.2, 0.3, 6), np.linspace(-0.1, 0.4, 4)
K1, MODES = np.array([0.0, 0.0, 0.5, 0.5]), np.array([120.0, 340.0, 125.0, 335.0])


@pytest.fixture(params=writer.VERSIONS, ids=str)
def version(request):
    return f"COMSOL {writer.VERSIONS[request.param]}"


def wave(x, z, k=2.0):
    return np.exp(-(x**2) + 1j * k * z) * (1.5 - 0.3j)


def rows(x=X, z=Z):
    zz, xx = np.meshgrid(z, x, indexing="ij")
    return xx.ravel(), zz.ravel()


def written(k=2.0):
    """The wave as the file holds it: exp(+i w t)."""
    return np.conj(wave(*rows(), k))


def expected(k=2.0):
    return wave(X[None, :], Z[:, None], k)


def mesh(count=40):
    """Scattered nodes and their triangles."""
    from scipy.spatial import Delaunay

    nodes = np.random.default_rng(3).uniform(-0.3, 0.3, (count, 2))
    return nodes, Delaunay(nodes).simplices


# --- every form, every version -------------------------------------------------------------------------------------


@pytest.mark.parametrize("style", ["csv", "semicolon", "txt", "dat"])
def test_spreadsheets(tmp_path, version, style):
    x, z = rows()
    columns = [
        (f"acpr.p_t (Pa){writer.parameters({'freq': f, 'theta': '0 deg'})}", written(k))
        for f, k in ((100, 1), (200, 2))
    ]
    path = writer.spreadsheet(tmp_path / "a", {"x": x, "y": z}, columns, style=style, unit="mm", version=version)
    ds = read_comsol(path)
    np.testing.assert_array_equal(ds.p, [expected(1), expected(2)])
    np.testing.assert_allclose(ds.z, Z, rtol=1e-14, atol=1e-16)


@pytest.mark.parametrize("style", ["csv", "txt"])
@pytest.mark.parametrize("label", ["inside", "below"])
def test_grids(tmp_path, version, style, label):
    columns = [("acpr.p_t (Pa)", np.conj(expected())), ("acpr.Lp (dB)", expected().real)]
    ds = read_comsol(writer.grid(tmp_path / "a", (X, Z), columns, style=style, label=label, version=version))
    np.testing.assert_array_equal(ds.p, expected())
    np.testing.assert_array_equal(ds.Lp, expected().real)


@pytest.mark.parametrize("style", ["txt", "csv", "semicolon"])
@pytest.mark.parametrize("label", ["inside", "below"])
def test_sections_below_a_count_of_elements(tmp_path, version, style, label):
    nodes, triangles = mesh()
    columns = [(f"acpr.p_t (Pa) @ freq={f}", np.conj(wave(*nodes.T, k))) for f, k in ((100, 1.0), (200, 2.0))]
    path = writer.sectionwise(
        tmp_path / "a", nodes, triangles, columns, style=style, label=label, counted=True, version=version
    )
    assert f"% Elements:           {len(triangles)}\n" in path.read_text()
    ds = read_comsol(path)
    assert ds.p.dims == ("frequency", "node")
    for k, p in zip((1.0, 2.0), ds.p, strict=True):
        np.testing.assert_array_equal(p, wave(ds.x, ds.z, k))
    assert ds.elements.shape == triangles.shape
    corners = np.stack([ds.x.values[ds.elements], ds.z.values[ds.elements]], axis=-1)
    np.testing.assert_array_equal(corners, nodes[triangles])


@pytest.mark.parametrize("normal", ["x", "y", "z"])
@pytest.mark.parametrize("size", [1e-6, 1.0])
def test_a_plane_whose_third_coordinate_is_noise(tmp_path, version, normal, size):
    """A cut plane that was turned in space: 1e-22 m beside 1e-6 m."""
    x, z = (size * v for v in rows())
    noise = np.random.default_rng(0).uniform(-1, 1, x.size) * 1e-16 * size
    inside = iter((x, z))
    at = {name: noise if name == normal else next(inside) for name in "xyz"}
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", written())], style="txt", version=version))
    np.testing.assert_array_equal(ds.p, expected())
    assert normal not in (ds.x.attrs["file_coordinate"], ds.z.attrs["file_coordinate"])


def test_sections_of_a_plane_whose_third_coordinate_is_noise(tmp_path, version):
    nodes, triangles = mesh()
    noise = np.random.default_rng(0).uniform(-1, 1, len(nodes)) * 1e-17
    turned = np.stack([noise, nodes[:, 0], nodes[:, 1]], axis=-1)
    p = np.conj(wave(*nodes.T))
    path = writer.sectionwise(tmp_path / "a", turned, triangles, [("p (Pa)", p)], counted=True, version=version)
    ds = read_comsol(path)
    assert (ds.x.attrs["file_coordinate"], ds.z.attrs["file_coordinate"]) == ("y", "z")
    np.testing.assert_array_equal(ds.p, wave(ds.x, ds.z))
    assert ds.sizes["node"] == 40


@pytest.mark.parametrize("along", ["x", "z"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_a_line_whose_other_coordinates_are_noise(tmp_path, version, along, dimension):
    random, position = np.random.default_rng(0), 1e-3 * X
    at = {"x": position} | {name: 1e-19 * random.uniform(-1, 1, X.size) for name in "yz"[: dimension - 1]}
    if along == "z":
        at = dict(zip(at, (at["y"], position, *(at[n] for n in list(at)[2:])), strict=True))
    path = writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", wave(X, 0.0))], version=version)
    ds = read_comsol(path, z="y") if along == "z" else read_comsol(path)
    other = "z" if along == "x" else "x"
    assert ds.p.sizes == {along: X.size, other: 1}
    np.testing.assert_array_equal(ds[along], position)
    assert float(ds[other][0]) == 0
    np.testing.assert_array_equal(ds.p.squeeze(), np.conj(wave(X, 0.0)))


@pytest.mark.parametrize("style", ["csv", "semicolon", "txt"])
def test_a_sweep_over_what_is_no_place(tmp_path, version, style):
    """Modes over a wavenumber: two rows to each value of k1, and all of them stay."""
    columns = [("freq (Hz)", MODES), ("abs(acpr.p_t) (Pa)", 2 * MODES)]
    path = writer.spreadsheet(tmp_path / "a", {"k1 (rad/m)": K1}, columns, style=style, unit="mm", version=version)
    path.write_text(path.read_text().replace(writer.real(500.0), "0.5"))  # k1 is no length: the writer took it for one
    chosen = read_comsol(path, expression="abs(acpr.p_t)")
    np.testing.assert_array_equal(chosen.p, 2 * MODES)
    ds = read_comsol(path)
    assert dict(ds.sizes) == {"row": 4}
    for name, values, unit in (("k1", K1, "rad/m"), ("freq", MODES, "Hz"), ("abs_p_t", 2 * MODES, "Pa")):
        np.testing.assert_array_equal(ds[name], values)
        assert ds[name].attrs["units"] == unit


@pytest.mark.parametrize("style", ["csv", "semicolon", "txt"])
def test_curves_of_a_plot(tmp_path, version, style):
    """Two curves over one R, rising and falling again: no row is lost or moved."""
    r, height = np.array([0.0, 0.1, 0.2, 0.2, 0.1, 0.0]), np.arange(6.0)
    path = writer.spreadsheet(tmp_path / "a", {"R": r}, [("Height", height)], style=style, unit="cm", version=version)
    ds = read_comsol(path)
    assert dict(ds.sizes) == {"row": 6}
    np.testing.assert_array_equal(ds.R, 100 * r)
    np.testing.assert_array_equal(ds.Height, height)
    assert (ds.R.attrs["units"], ds.Height.attrs["units"]) == ("cm", "1")
    with pytest.warns(UserWarning, match=r"Height has two values at 3 points|no unit of Height"):
        assert read_comsol(path, expression="Height").p.dims == ("x",)  # a line of places, if the user says so


@pytest.mark.parametrize("style", ["csv", "txt"])
def test_tables(tmp_path, version, style):
    p = np.array([1 + 2j, 2.0, 3 - 1j])
    titles = ["freq (Hz)", "Total pressure, a (Pa), Point: (0.1, 0)", "Lift Coeff (1/m^2)", "x (m)", "Count"]
    if style == "txt":
        titles[1] = "Total p, a (Pa)"
    values = [np.array([1.0, 2.0, 2.0]), p, np.arange(3.0), np.ones(3), np.zeros(3)]
    path = writer.table(tmp_path / "a", list(zip(titles, values, strict=True)), style, version=version)
    ds = read_comsol(path)
    assert dict(ds.sizes) == {"row": 3}
    pressure = "Total_p_a" if style == "txt" else "Total_pressure_a_Point_0_1_0"
    names = ["freq", pressure, "Lift_Coeff", "x", "Count"]
    assert set(ds.data_vars) == set(names)
    for name, value, unit in zip(names, values, ["Hz", "Pa", "1/m^2", "m", "1"], strict=True):
        np.testing.assert_array_equal(ds[name], np.conj(value))
        assert ds[name].attrs["units"] == unit


@pytest.mark.parametrize("style", ["csv", "semicolon", "txt", "dat"])
def test_angles_in_radians(tmp_path, version, style):
    x, z = rows()
    columns = [(f"p (Pa) @ freq=100, theta={writer.real(t)}", written(k)) for t, k in ((0.0, 1), (np.pi / 6, 2))]
    path = writer.spreadsheet(tmp_path / "a", {"x": x, "y": z}, columns, style=style, version=version)
    with pytest.warns(UserWarning, match=r"no unit of the angle, degrees taken \(angle_unit= or --angle-unit says"):
        read_comsol(path)
    ds = read_comsol(path, angle_unit="rad")
    np.testing.assert_allclose(ds.angle, [0, 30], rtol=1e-14)
    np.testing.assert_array_equal(ds.p, [expected(1), expected(2)])


# --- edges of these forms ------------------------------------------------------------------------------------------


def test_a_thin_field_is_no_noise(tmp_path):
    """A film a million times thinner than wide has two coordinates."""
    x, z = rows(X, 1e-6 * Z)
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", {"x": x, "y": z}, [("p (Pa)", written())]))
    assert ds.p.sizes == {"z": 4, "x": 6}
    at = {"x": x, "y": z, "z": np.random.default_rng(0).uniform(size=x.size) * 1e-6}
    with pytest.raises(ValueError, match="expected a plane"):
        read_comsol(writer.spreadsheet(tmp_path / "a", at, [("p (Pa)", written())]))


def test_a_count_of_elements_that_differs_is_warned_about(tmp_path):
    nodes, triangles = mesh()
    path = writer.sectionwise(tmp_path / "a", nodes, triangles, [("p (Pa)", np.ones(40))], counted=True)
    path.write_text(path.read_text().replace(f"{len(triangles)}\n% Expr", "7\n% Expr"))
    with pytest.warns(UserWarning, match=rf"'% Elements' states 7 elements, there are {len(triangles)}"):
        read_comsol(path)


def test_no_length_is_missed_in_a_table(tmp_path):
    """A table has no places, so that no unit of length is assumed (warnings are errors here)."""
    ds = read_comsol(writer.table(tmp_path / "a", [("Time (s)", np.ones(1))]))
    assert ds.Time.item() == 1
    assert ds.attrs["convention"].endswith("units as in the file")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("% Time (s) Lift Coeff (1)\n1 2\n", "line 2: expected 2 names, for the 2 columns below, got 3 in .*'% Table'"),
        ("% Time (s)   p (Pa)\n1 2 3\n", "line 2: expected 3 names.*'% Table' export, 'T1'"),
        ("% Time (s)   p (Pa)\n1 2\n1\n", "line 4: expected 2 values, got 1 .*'% Table' export"),
        ("% Time (s)   p (Pa)\n1 b\n", "line 3: expected a real or complex number, got 'b' .*'% Table' export"),
        ("", "expected rows of numbers below the header, got none .*'% Table' export"),
    ],
)
def test_tables_that_cannot_be_read_for_certain(tmp_path, text, said):
    path = tmp_path / "a.txt"
    path.write_text(f"% Table: T1\n{text}")
    with pytest.raises(ValueError, match=said):
        read_comsol(path)


def test_a_table_has_no_axes_to_choose(tmp_path):
    path = writer.table(tmp_path / "a", [("x (m)", np.ones(2)), ("p (Pa)", np.ones(2))])
    with pytest.raises(ValueError, match=r"z: expected none, for the rows of .* are no points, got 'x'"):
        read_comsol(path, z="x")


def test_a_power_called_p_in_a_table_is_no_pressure(tmp_path):
    ds = read_comsol(writer.table(tmp_path / "a", [("t (s)", np.arange(3.0)), ("p (W)", np.ones(3))]))
    assert "p" not in ds
    assert ds.v_p.attrs["units"] == "W"
    ds = read_comsol(writer.table(tmp_path / "b", [("t (s)", np.arange(3.0)), ("p (kPa)", np.ones(3))]))
    np.testing.assert_array_equal(ds.p, 1e3 * np.ones(3))


def test_a_cut_line_in_its_own_coordinate_is_a_line(tmp_path):
    ds = read_comsol(writer.spreadsheet(tmp_path / "a", {"cln1x": X}, [("p (Pa)", np.conj(wave(X, 0.0)))]))
    np.testing.assert_array_equal(ds.p, wave(X, 0.0))
    np.testing.assert_array_equal(ds.x, X)


@pytest.mark.parametrize("table", [True, False])
def test_curves_of_one_name_and_legends_in_prose(tmp_path, table):
    """Both curves stay, under names that differ; a legend may end with a comma, as those of plots do."""
    text = "% Table: T\n" if table else "% Dimension: 1\n% Nodes: 2\n% Description: Global\n"
    path = tmp_path / "a.txt"
    path.write_text(
        text
        + "% freq (Hz)             Absorption, total       Absorption, total       \\sigma_b, \n80 1 2 3\n90 4 5 6\n"
    )
    ds = read_comsol(path)
    for name, values in (
        ("freq", [80, 90]),
        ("Absorption_total", [1, 4]),
        ("Absorption_total_2", [2, 5]),
        ("sigma_b", [3, 6]),
    ):
        np.testing.assert_array_equal(ds[name], values)


def test_particles_by_number(tmp_path):
    """Rows by an index, with columns x of their own at each time: 'x' is a variable here, in the file's unit."""
    path = tmp_path / "a.csv"
    path.write_text(
        "% Dimension,1\n% Index,x (mm) @ t=0,p (Pa) @ t=0,x (mm) @ t=0.5,p (Pa) @ t=0.5\n1,-3,1,-2,1.5\n2,NaN,NaN,4,5\n"
    )
    ds = read_comsol(path)
    np.testing.assert_array_equal(ds.x, [[-3, np.nan], [-2, 4]])
    assert ds.x.dims == ds.p.dims == ("time", "row")
    assert ds.x.attrs["units"] == "mm"
