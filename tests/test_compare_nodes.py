"""`compare` on the nodes of a mesh: our field is evaluated there; each number against what was put in."""

import json
import re

import comsol_writer as writer
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

import beamprop as bp
from beamprop.cli import main
from beamprop.comparison import nodes as nodes_module

SLAB, BEAM = bp.Slab(bp.lmmd_cell(), 30), bp.GaussianBeam(0.096, angle=20, z0=-0.05)
X, Z = np.linspace(-0.3, 0.4, 36), np.linspace(-0.05, 0.15, 9)


@pytest.fixture(scope="module")
def ours():
    return bp.field(SLAB, BEAM, 2500.0, X, Z)


@pytest.fixture(scope="module")
def mesh():
    """Nodes (N, 2) that share no depth, triangles, and the field at each node by a question of its own."""
    from scipy.spatial import Delaunay

    at = np.random.default_rng(0).uniform([-0.2, -0.05], [0.3, 0.15], (60, 2))
    # each depth asked with the whole width, so that rtol is over the largest |p| of the plane
    p = [bp.field(SLAB, BEAM, 2500.0, [x, *X], [z]).p.values[0, 0] for x, z in at]
    return at, Delaunay(at).simplices, np.array(p)


def dataset(at, p, triangles=None, **coords):
    """Nodes as `read_comsol` gives them."""
    ds = xr.Dataset({"p": ("node", p, {"units": "Pa"})}, {"x": ("node", at[:, 0]), "z": ("node", at[:, 1])} | coords)
    return ds if triangles is None else ds.assign(elements=(("element", "corner"), triangles))


def areas(at, triangles):
    """A third of every triangle to each of its corners, one by one."""
    out = np.zeros(len(at))
    for corners in triangles:
        (x0, z0), (x1, z1), (x2, z2) = at[corners]
        out[corners] += abs((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / 2 / 3
    return out


# --- the numbers -----------------------------------------------------------------------------------------------------


def test_a_sectionwise_file_against_our_field(tmp_path, ours, mesh):
    """Exact where it is evaluated; interpolated, the same file is percents off."""
    at, triangles, p = mesh
    name = "acpr.p_t (kPa) @ freq=2500, theta=20[deg]"
    path = writer.sectionwise(tmp_path / "a", at, triangles, [(name, np.conj(p) / 1e3)], unit="mm", counted=True)
    read = bp.read_comsol(path)
    c = bp.compare(ours, read)
    assert c.p_a.dims == ("node",)
    assert float(c.relative_l2) < 1e-9
    assert float(c.interpolation_error) == 0
    assert c.attrs["compared_on"] == "nodes of b; a evaluated there; weighed by the areas of the elements"
    x, z = np.linspace(-0.1, 0.2, 31), np.linspace(0.0, 0.1, 11)
    interpolated = bp.compare(bp.field(SLAB, BEAM, 2500.0, x, z), bp.to_grid(read, x, z))
    assert float(interpolated.relative_l2) > 0.01
    assert interpolated.attrs["compared_on"].startswith("points of a")


@pytest.mark.parametrize("with_elements", [True, False])
@pytest.mark.parametrize("mesh_first", [True, False])
def test_errors_that_were_put_in(ours, mesh, with_elements, mesh_first):
    at, triangles, p = mesh
    random = np.random.default_rng(1)
    moved = p * 1.5j + 0.02 * random.normal(size=p.size)
    theirs = dataset(at, moved, triangles if with_elements else None)
    a, b, c = (moved, p, bp.compare(theirs, ours)) if mesh_first else (p, moved, bp.compare(ours, theirs))
    w = areas(at, triangles)  # Delaunay's triangles of the nodes are the elements here
    size_a, left_over = (np.sqrt(np.sum(w * np.abs(v) ** 2)) for v in (a, a - b))
    scale = np.sum(w * np.conj(b) * a) / np.sum(w * np.abs(b) ** 2)
    assert float(c.relative_l2) == pytest.approx(left_over / size_a, rel=1e-7)
    assert complex(c.scale) == pytest.approx(scale, rel=1e-7)
    unscaled = np.sqrt(np.sum(w * np.abs(a - scale * b) ** 2))
    assert float(c.relative_l2_scaled) == pytest.approx(unscaled / size_a, rel=1e-6)
    assert float(c.largest_error) == pytest.approx(np.abs(a - b).max() / np.abs(a).max(), rel=1e-7)
    worst = np.abs(a - b).argmax()
    assert (float(c.largest_error_x), float(c.largest_error_z)) == tuple(at[worst])
    np.testing.assert_allclose(c.error, np.abs(a - b), atol=1e-8)
    assert ("elements" in c.attrs["compared_on"]) == with_elements
    rescaled = bp.compare(ours, theirs, rescale=True)
    assert float(rescaled.relative_l2) == pytest.approx(float(rescaled.relative_l2_scaled), rel=1e-9)


def test_nodes_on_an_oblique_line(ours):
    """No triangles: each node counts alike."""
    at = np.stack([np.linspace(-0.1, 0.2, 13), np.linspace(0.0, 0.12, 13)], axis=-1)
    c = bp.compare(ours, dataset(at, np.zeros(13) + 0j))
    assert float(c.relative_l2) == 1
    assert c.attrs["compared_on"].endswith("each node alike")


def test_sweeps(ours, mesh):
    """Frequencies and angles are compared one by one, in whatever order the file has its dims."""
    at, _, _ = mesh
    frequency, angle = [2000.0, 2500.0], [0.0, 20.0]
    swept = bp.field(SLAB, BEAM, frequency, X, Z, angle=angle)
    alike = bp.compare(swept, on_mesh := _swept(at, frequency, angle))
    assert alike.relative_l2.dims == ("frequency", "angle")
    assert float(alike.relative_l2.max()) < 1e-9
    on_mesh.p[:, 0, 1] *= 2
    off = bp.compare(swept, on_mesh.transpose("node", "angle", "frequency")).relative_l2.values
    np.testing.assert_allclose(off, [[0, 1], [0, 0]], atol=1e-9)
    one = bp.compare(swept.isel(frequency=1, angle=[1]), on_mesh.isel(frequency=1, angle=1))
    assert float(one.relative_l2) < 1e-9


def _swept(at, frequency, angle):
    p = [bp.field(SLAB, BEAM, frequency, [x, *X], [z], angle=angle).p.values[..., 0, 0] for x, z in at[:8]]
    return xr.Dataset(
        {"p": (("node", "frequency", "angle"), p, {"units": "Pa"})},
        {"frequency": frequency, "angle": angle, "x": ("node", at[:8, 0]), "z": ("node", at[:8, 1])},
    )


def test_a_saved_field_is_evaluated_too(tmp_path, ours, mesh):
    """The file records what it is made of; of the comparison, every variable has units, and files take it."""
    at, _, p = mesh
    bp.save(ours, tmp_path / "a.nc")
    c = bp.compare(bp.load(tmp_path / "a.nc"), dataset(at, p))
    assert float(c.relative_l2) < 1e-9
    for name in c.variables:
        assert {"units", "long_name"} <= set(c[name].attrs), name
    bp.save(c, tmp_path / "c.nc")
    xr.testing.assert_identical(bp.load(tmp_path / "c.nc").p_b, c.p_b)


def test_a_field_of_few_digits_is_evaluated_with_all(ours, mesh):
    """A file that keeps two digits states so; one that does not is refused as changed."""
    at, _, p = mesh
    step = 0.01 * float(np.abs(ours.p).max())
    rounded = ours.assign(p=((ours.p.real / step).round() * step + 1j * (ours.p.imag / step).round() * step))
    rounded.p.attrs = ours.p.attrs | {"rounding_error": step / 2}
    assert float(bp.compare(rounded, dataset(at, p)).relative_l2) < 1e-9
    del rounded.p.attrs["rounding_error"]
    with pytest.raises(ValueError, match="expected p as its provenance records it"):
        bp.compare(rounded, dataset(at, p))


def test_periodic_fields_are_evaluated_with_their_period(mesh):
    at, _, _ = mesh
    slab = bp.Slab(bp.lmmd_cell(), 30)
    periodic = bp.field(slab, BEAM, 2500.0, X, Z, boundary="periodic", period=1.0)
    p = [bp.field(slab, BEAM, 2500.0, [x], [z], boundary="periodic", period=1.0).p.item() for x, z in at]
    assert float(bp.compare(periodic, dataset(at, np.array(p))).relative_l2) < 1e-12
    with pytest.warns(UserWarning, match="a is periodic"):
        bp.compare(periodic, dataset(at, np.array(p)).assign_attrs(boundary="open"))


# --- what is left out, warned of or refused ----------------------------------------------------------------------------


def test_nodes_that_have_no_value_or_lie_in_front_of_the_launch_plane(ours, mesh):
    at, _, p = mesh
    moved, gappy = at.copy(), p.copy()
    moved[:5, 1] = -0.2
    gappy[7] = np.nan
    with pytest.warns(UserWarning, match="nodes lie in front|have no value") as caught:
        c = bp.compare(ours, dataset(moved, gappy))
    said = " ".join(str(w.message) for w in caught)
    assert "5 of 60 nodes lie in front of the launch plane z0 = -0.05 m and are left out" in said
    assert "1 of 55 points have no value" in said
    assert all(w.filename == __file__ for w in caught)
    assert c.sizes["node"] == 55
    assert float(c.relative_l2) < 1e-9
    moved[:, 1] = -0.2 - at[:, 1]
    with pytest.raises(ValueError, match=r"b: expected nodes behind the launch plane z0 = -0\.05 m, got z up to"):
        bp.compare(ours, dataset(moved, p))


def test_a_launch_plane_with_rounding_noise(ours):
    """-0.05 less 1e-17 is on the plane."""
    at = np.array([[-0.1, BEAM.z0 - 1e-17], [0.1, BEAM.z0], [0.0, 0.1]])
    p = bp.field(SLAB, BEAM, 2500.0, at[:, 0], [BEAM.z0, 0.1]).p.values
    c = bp.compare(ours, dataset(at, np.array([p[0, 0], p[0, 1], p[1, 2]])))
    assert float(c.relative_l2) < 1e-7


def test_conjugates_are_noticed(ours, mesh):
    at, _, p = mesh
    with pytest.warns(UserWarning, match=r"b looks like exp\(\+i w t\)") as caught:
        c = bp.compare(ours, dataset(at, np.conj(p)))
    assert c.attrs["conjugate_fits_better"] == 1
    assert caught[0].filename == __file__


def cases(ours, at, p):
    """What is refused: arguments, and the message."""
    mesh = dataset(at, p)
    foreign = xr.Dataset({"p": ours.p}, ours.coords)
    own = bp.field(SLAB, Own(0.096, z0=-0.05), 2500.0, X, Z)
    return {
        "both": ((mesh, mesh), "a, b: expected a grid at least on one side, got scattered nodes in both: .* to_grid"),
        "foreign": ((foreign, mesh), "b: expected p .* field of beamprop .* got one of no known origin: .* to_grid"),
        "mesh first": ((mesh, foreign), "a: expected p .* field of beamprop .* got one of no known origin"),
        "own": ((own, mesh), "b: expected p .* got one of a source of the user's own"),
        "scaled": (
            (ours.assign(p=ours.p.copy(data=1.001 * ours.p.values)), mesh),
            r"a: expected p as its provenance records it, got one that is off by 0\.0005",
        ),
        "moved": ((ours.assign_coords(z=ours.z + 0.01), mesh), "a: expected p as its provenance records it"),
        "no places": ((ours, mesh.drop_vars("z")), "b: expected coordinates x and z of the nodes, got none for z"),
        "no number": ((ours, dataset(at + np.nan, p)), "b: expected a 1-D array of finite positions"),
        "no field": ((ours.rename(p="q"), mesh), "a: expected a dataset with the pressure p"),
        "not one": ((ours.expand_dims(case=2), mesh), r"b: expected the dims .* select one case"),
        "open": ((ours, mesh, False), "open_reference: expected none for scattered nodes"),
        "frequency": ((ours, mesh.assign_coords(frequency=2400.0)), "b: expected the same frequency as a"),
        "unit": ((ours, mesh.assign(p=mesh.p.assign_attrs(units="m/s"))), "b: expected p in 'Pa'"),
    }


class Own(bp.GaussianBeam):
    """A source that no file can bring back."""


@pytest.mark.parametrize(
    "case",
    ["both", "foreign", "mesh first", "own", "scaled", "moved", "no places", "no number", "no field", "not one", "open",
     "frequency", "unit"],
)  # fmt: skip
def test_refusals(ours, mesh, case, monkeypatch):
    (a, b, *rescale), said = cases(ours, mesh[0], mesh[2])[case]
    if case not in ("scaled", "moved"):  # nothing is computed before it is refused
        monkeypatch.setattr(nodes_module, "field_at", None)
    with pytest.raises(ValueError, match=said):
        bp.compare(a, b, *rescale, open_reference=ours if case == "open" else None)


# --- the command -----------------------------------------------------------------------------------------------------


@pytest.fixture
def files(tmp_path, ours, mesh):
    """ours.nc, nodes.txt (no units stated) and mm.txt (millimetres and radians, not stated)."""
    at, triangles, p = mesh
    bp.save(ours, tmp_path / "ours.nc")
    name = f"p (Pa) @ freq=2500, theta={np.radians(20)}"
    writer.sectionwise(tmp_path / "nodes.txt", at, triangles, [("p (Pa) @ freq=2500, theta=20[deg]", np.conj(p))])
    writer.sectionwise(tmp_path / "mm.txt", 1e3 * at, triangles, [(name, np.conj(p))], leave_out=("Length unit",))
    return tmp_path


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def test_command_on_nodes(files):
    ran = run("compare", files / "ours.nc", files / "nodes.txt", "--tolerance", "1e-8", "--output", files / "c.nc")
    assert ran.exit_code == 0, ran.output
    assert "compared on          nodes of b; a evaluated there" in ran.output
    assert "widths" not in ran.output
    assert bp.load(files / "c.nc").p_b.dims == ("node",)


def test_command_with_units(files):
    ran = run("convert", files / "mm.txt", files / "wrong.nc")
    assert ran.exit_code == 0
    assert "--length-unit" in ran.output
    assert "--angle-unit" in ran.output
    options = ["--length-unit", "mm", "--angle-unit", "rad"]
    ran = run("compare", files / "ours.nc", files / "mm.txt", *options, "--json", "-q")
    assert ran.exit_code == 0, ran.output
    assert json.loads(ran.stdout)["data_vars"]["relative_l2"]["data"] < 1e-9
    ran = run("convert", files / "mm.txt", files / "mm.nc", *options, "-q")
    assert (ran.exit_code, ran.output) == (0, "")
    converted = bp.load(files / "mm.nc")
    assert float(converted.angle) == pytest.approx(20, rel=1e-12)
    xr.testing.assert_allclose(converted.x, bp.read_comsol(files / "nodes.txt").x, rtol=1e-12)


def test_command_on_a_grid(files):
    grid = ["--grid", "-0.1:0.2:13", "0:0.1:11"]
    ran = run("compare", files / "nodes.txt", files / "nodes.txt", *grid, "--json", "-q", "-p", files / "c.png")
    assert ran.exit_code == 0, ran.output
    data = json.loads(ran.stdout)
    assert (data["dims"]["z"], data["dims"]["x"]) == (11, 13)
    assert data["data_vars"]["relative_l2"]["data"] == 0
    ran = run("convert", files / "nodes.txt", files / "grid.nc", *grid)
    assert ran.exit_code == 0, ran.output
    want = bp.to_grid(bp.read_comsol(files / "nodes.txt"), np.linspace(-0.1, 0.2, 13), np.linspace(0, 0.1, 11))
    xr.testing.assert_allclose(bp.load(files / "grid.nc").p, want.p)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["compare", "nodes.txt", "nodes.txt"], "a, b: expected a grid at least on one side"),
        (["compare", "ours.nc", "ours.nc", "--grid", "0:1:3", "0:1:3"], "grid: expected none"),
        (["compare", "ours.nc", "ours.nc", "--angle-unit", "rad"], "--angle-unit: expected none"),
        (["compare", "ours.nc", "nodes.txt", "--angle-unit", "gon"], "--angle-unit: expected one of deg"),
        (["compare", "ours.nc", "nodes.txt", "--length-unit", "furlong"], "--length-unit: expected one of m, mm"),
        (["compare", "ours.nc", "nodes.txt", "--grid", "0:1:3"], "'--grid' requires 2 arguments"),
        (["compare", "ours.nc", "nodes.txt", "--grid", "1:0:3", "0:1:3"], "--grid: expected"),
        (["compare", "ours.nc", "nodes.txt", "--output", "c.nc", "--plot", "c.png"], "plot: expected .* on a grid"),
        (["convert", "ours.nc", "c.nc", "--length-unit", "mm"], "--length-unit: expected none"),
        (["convert", "ours.nc", "c.nc", "--grid", "0:1:3", "0:1:3"], "grid: expected none"),
    ],
)
def test_wrong_commands_exit_2_and_leave_nothing(files, monkeypatch, arguments, said):
    monkeypatch.chdir(files)
    before = set(files.iterdir())
    ran = run(*arguments)
    assert ran.exit_code == 2, ran.output
    assert re.search(said, " ".join(ran.output.split())), ran.output
    assert set(files.iterdir()) == before
