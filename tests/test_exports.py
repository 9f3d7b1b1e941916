"""Exports: MATLAB, ParaView and tables hold the dataset's numbers, read here by other means; what they cannot hold is refused by name."""

import csv
import io
import re
import xml.etree.ElementTree as ET

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner
from scipy.io import loadmat, savemat
from versions import names

import beamprop as bp
from beamprop.cli import main
from beamprop.io.exports import vtk
from beamprop.io.storage import matlab

F = 2500.0
SLAB, BEAM = bp.Slab(bp.lmmd_cell(), 20), bp.GaussianBeam(0.096, z0=-0.05)
X, Z = np.linspace(-0.4, 0.4, 5), np.array([0.2, 0.0, 0.1])


@pytest.fixture(scope="module")
def field():
    return bp.field(SLAB, BEAM, [2400.0, F], X, Z, angle=[0.0, -30.5])


@pytest.fixture(scope="module")
def spectrum():
    return bp.scattering(SLAB, F, kx_over_k0=[0.0, 0.5, 1.5])


# --- ParaView ---------------------------------------------------------------------------------------------


def read_vtk(path):
    """(attributes of the grid, {group: {name: numbers or text}}) by the format's description: offsets count from behind the mark."""
    raw = path.read_bytes()
    head, mark, numbers = raw.partition(b'<AppendedData encoding="raw">\n_')
    root = ET.fromstring(head + b"</VTKFile>")
    assert mark
    assert (root.get("byte_order"), root.get("header_type")) == ("LittleEndian", "UInt64")
    types = {"Float64": "<f8", "Int64": "<i8", "String": "u1"}
    groups = {}
    for group in root.iter():
        for array in [*group.findall("DataArray"), *group.findall("Array")]:
            start = int(array.get("offset"))
            size = int.from_bytes(numbers[start : start + 8], "little")
            values = np.frombuffer(numbers[start + 8 : start + 8 + size], types[array.get("type")])
            if array.get("type") == "String":
                assert values[-1] == 0
                values = values[:-1].tobytes().decode()
            else:
                assert array.get("NumberOfTuples") in (None, str(values.size))
            groups.setdefault(group.tag, {})[array.get("Name")] = values
    return root[0], groups


@pytest.mark.parametrize("ending", ["vti", "vtr"])
def test_a_field_in_paraview(tmp_path, field, ending):
    """Every point of every frequency and angle, one by one: parts, magnitude and phase; depths in ascending order; x runs first."""
    bp.export(field, tmp_path / f"a.{ending}")
    grid, groups = read_vtk(tmp_path / f"a.{ending}")
    assert grid.tag == {"vti": "ImageData", "vtr": "RectilinearGrid"}[ending]
    assert grid.get("WholeExtent") == grid[-1].get("Extent") == "0 4 0 0 0 2"
    if ending == "vti":
        np.testing.assert_allclose([float(v) for v in grid.get("Origin").split()], [-0.4, 0, 0])
        np.testing.assert_allclose([float(v) for v in grid.get("Spacing").split()], [0.2, 1, 0.1])
    else:
        for name, values in {"x": X, "y": [0.0], "z": np.sort(Z)}.items():
            np.testing.assert_array_equal(groups["Coordinates"][name], values)
    points = groups["PointData"]
    assert len(points) == 16
    for f in (2400, 2500):
        for angle in ("0", "-30.5"):
            there = f" (frequency {f} Hz, angle {angle} degree)"
            for k, z in enumerate((0.0, 0.1, 0.2)):
                for i, x in enumerate(X):
                    p = complex(field.p.sel(frequency=f, angle=float(angle), z=z, x=x))
                    assert points["p_real" + there][5 * k + i] == p.real
                    assert points["p_imag" + there][5 * k + i] == p.imag
                    assert points["p_abs" + there][5 * k + i] == pytest.approx(abs(p), rel=1e-15)
                    assert points["p_phase" + there][5 * k + i] == pytest.approx(np.arctan2(p.imag, p.real), rel=1e-15)
    apart = groups["FieldData"]
    np.testing.assert_array_equal(apart["error_estimate"], field.error_estimate.values.ravel())
    np.testing.assert_array_equal(apart["angle"], [0.0, -30.5])
    assert apart["provenance"] == field.attrs["provenance"]
    assert "p: Pa, " in apart["units"]


def test_one_field_keeps_its_name(tmp_path):
    """One frequency and angle: nothing behind the names. Uneven depths, and a row at one depth, along a third axis too."""
    ds = bp.field(SLAB, BEAM, F, X, [0.0, 0.1, 0.25])
    bp.export(ds, tmp_path / "a.vtr")
    _, groups = read_vtk(tmp_path / "a.vtr")
    assert list(groups["PointData"]) == ["p_real", "p_imag", "p_abs", "p_phase"]
    np.testing.assert_array_equal(groups["PointData"]["p_imag"], ds.p.values.imag.ravel())
    with pytest.raises(ValueError, match=r"^path: expected \.vtr .*got \.vti and z"):
        bp.export(ds, tmp_path / "a.vti")
    row = ds.isel(z=2).assign_coords(y=0.5)
    bp.export(row, tmp_path / "row.vti")
    grid, _ = read_vtk(tmp_path / "row.vti")
    assert (grid.get("Origin"), grid.get("WholeExtent")) == ("-0.4 0.5 0.25", "0 4 0 0 0 0")
    cube = ds.expand_dims(y=[1.0, 2.0]).transpose("z", "x", "y")
    cube = cube.assign(profile=("y", [7, 8]), p=cube.p * cube.y)
    bp.export(cube, tmp_path / "cube.vtr")
    grid, groups = read_vtk(tmp_path / "cube.vtr")
    assert grid.get("WholeExtent") == "0 4 0 1 0 2"
    shaped = groups["PointData"]["p_real"].reshape(3, 2, 5)
    np.testing.assert_array_equal(shaped[:, 1], 2 * ds.p.values.real)
    np.testing.assert_array_equal(groups["PointData"]["profile"].reshape(3, 2, 5)[2, 1], [8] * 5)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda ds: ds.isel(x=0, z=0), "got the dimensions frequency, angle: write"),
        (lambda ds: ds.assign_coords(x=[0, 1, 2, 3, np.nan]), "expected positions x"),
        (lambda ds: ds.assign_coords(x=[0, 1, 2, 3, 3]), "expected positions x"),
        (lambda ds: ds.assign_coords(x=list("abcde")), "expected positions x"),
        (lambda ds: ds.assign(words=("x", list("abcde"))), "expected numbers on x, y, z, .*'words'"),
    ],
)
def test_what_paraview_does_not_draw(tmp_path, field, change, said):
    with pytest.raises(ValueError, match=f"^ds: .*{said}"):
        bp.export(change(field), tmp_path / "a.vtr")
    assert names(tmp_path) == []


def test_too_many_arrays(tmp_path, field, monkeypatch):
    monkeypatch.setattr(vtk, "MOST", 15)
    with pytest.raises(ValueError, match=r"^ds: expected at most 15 arrays"):
        bp.export(field, tmp_path / "a.vtr")


# --- tables -----------------------------------------------------------------------------------------------


def test_a_table(tmp_path, spectrum):
    """All digits, complex numbers in two columns, units in the header, a scalar in each row; read by pandas."""
    bp.export(spectrum, tmp_path / "a.csv")
    frame = pd.read_csv(tmp_path / "a.csv", float_precision="round_trip")
    assert frame.columns[0] == "kx_over_k0 (1)"
    np.testing.assert_array_equal(frame["t_real (1)"] + 1j * frame["t_imag (1)"], spectrum.t)
    np.testing.assert_array_equal(frame["absorption (1)"], spectrum.absorption)  # NaN behind the edge
    np.testing.assert_array_equal(frame["frequency (Hz)"], [F, F, F])
    assert len(frame.columns) == len(spectrum.variables) + sum(v.dtype.kind == "c" for v in spectrum.variables.values())


def test_words_counts_and_what_is_no_number(tmp_path):
    ds = xr.Dataset(
        {"n": ("side", [3, 4]), "a": ("side", [np.inf, -np.inf], {"units": "m, s"}), "c": ((), 1 + np.nan * 1j)},
        {"side": ["reflected", 'said "so"'], "f": 2.5},
    )
    bp.export(ds.expand_dims(row=[7]), tmp_path / "a.csv")
    table = list(csv.reader(io.StringIO((tmp_path / "a.csv").read_text())))
    header, *rows = [dict(zip(table[0], row, strict=True)) for row in table]
    assert set(header) == {"side", "n", "a (m, s)", "c_real", "c_imag", "f", "row"}
    assert rows[0] == {
        "side": "reflected",
        "n": "3",
        "a (m, s)": "Inf",
        "c_real": "NaN",
        "c_imag": "NaN",
        "f": "2.5",
        "row": "7",
    }
    assert (rows[1]["a (m, s)"], rows[1]["side"]) == ("-Inf", 'said "so"')


def test_a_table_of_one_row_and_of_none(tmp_path, spectrum):
    bp.export(spectrum.isel(kx_over_k0=1), tmp_path / "a.csv")
    assert float(pd.read_csv(tmp_path / "a.csv")["t_imag (1)"].iloc[0]) == pytest.approx(float(spectrum.t[1].imag))
    bp.export(spectrum.isel(kx_over_k0=[]), tmp_path / "a.csv")
    assert len(pd.read_csv(tmp_path / "a.csv")) == 0


def test_more_dimensions_than_a_table_has(tmp_path, field):
    (tmp_path / "a.csv").write_text("old")
    with pytest.raises(
        ValueError, match=r"^ds: expected one dimension.*frequency 2, angle 2, z 3, x 5.*ds\.isel\(frequency=0\)"
    ):
        bp.export(field, tmp_path / "a.csv")
    assert (tmp_path / "a.csv").read_text() == "old"
    assert names(tmp_path) == ["a.csv"]


# --- MATLAB -----------------------------------------------------------------------------------------------


def test_a_field_in_matlab(tmp_path, field):
    """Arrays by name with the dimensions in the dataset's order, and a struct with what they mean."""
    bp.export(field, tmp_path / "a.mat")
    content = loadmat(tmp_path / "a.mat", simplify_cells=True)
    np.testing.assert_array_equal(content["p"], field.p)
    assert content["p"].dtype == complex
    about = content["about"]
    assert (about["p"]["units"], about["p"]["dims"], about["frequency"]["units"]) == ("Pa", "frequency angle z x", "Hz")
    assert about["dataset"]["provenance"] == field.attrs["provenance"]
    assert loadmat(tmp_path / "a.mat")["x"].shape == (5, 1)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda ds: ds.rename(p="p.t"), "the variable 'p.t'"),
        (lambda ds: ds.rename(p="_p"), "the variable '_p'"),
        (lambda ds: ds.rename(p="about"), "'about'"),
        (lambda ds: ds.assign_attrs(no=None), "'no' of the dataset: None"),
        (lambda ds: ds.assign_attrs({"1a": 3}), "the attribute '1a'"),
        (lambda ds: ds.assign(q=((), 1.0, {"dims": 2})), "'dims'"),
        (lambda ds: ds.assign_coords(day=np.datetime64("2020-01-01", "ns")), "'day' of type datetime64"),
    ],
)
def test_what_matlab_does_not_hold(tmp_path, field, change, said):
    with pytest.raises(ValueError, match=f"^ds: .*{re.escape(said)}"):
        bp.save(change(field), tmp_path / "a.mat")
    assert names(tmp_path) == []


def test_variables_larger_than_the_format(tmp_path, field, monkeypatch):
    monkeypatch.setattr(matlab, "MOST", 500)
    with pytest.raises(ValueError, match=r"^ds: expected variables below 2 GiB.*'p'"):
        bp.save(field, tmp_path / "a.mat")


def test_foreign_and_changed_mat_files(tmp_path, field):
    """Without the struct, with a variable less or of another size, or no such file: refused by the file's name."""
    path = tmp_path / "a.mat"
    savemat(path, {"p": field.p.values})
    with pytest.raises(ValueError, match=r"a\.mat: expected a \.mat file that save wrote.*'about'"):
        bp.load(path)
    bp.save(field, path)
    content = {k: v for k, v in loadmat(path).items() if not k.startswith("_")}
    for change in ({"p": content["p"][..., :4]}, {"p": "words"}):
        savemat(path, content | change, long_field_names=True)
        with pytest.raises(ValueError, match=r"a\.mat: expected variable 'p' as it was written"):
            bp.load(path)
    savemat(path, {k: v for k, v in content.items() if k != "p"}, long_field_names=True)
    with pytest.raises(ValueError, match=r"a\.mat: expected variable 'p' as it was written"):
        bp.load(path)
    for raw in (b"", b"MATLAB 5.0 MAT-file", bytes(200), b"\x89HDF\r\n\x1a\n" + bytes(600)):
        path.write_bytes(raw)
        with pytest.raises(ValueError, match=r"a\.mat: expected a \.mat file"):
            bp.load(path)


def test_what_matlab_wrote_again_is_read(tmp_path, field):
    """Values that were changed there come back with the names and units of before."""
    bp.save(field, tmp_path / "a.mat")
    content = {k: v for k, v in loadmat(tmp_path / "a.mat").items() if not k.startswith("_")}
    savemat(tmp_path / "a.mat", content | {"p": 2 * content["p"]}, long_field_names=True)
    xr.testing.assert_identical(bp.load(tmp_path / "a.mat"), field.assign(p=(field.p * 2).assign_attrs(field.p.attrs)))


# --- every kind -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.nc", "a.txt", "a", "csv"])
def test_endings_that_export_does_not_write(tmp_path, spectrum, name):
    with pytest.raises(ValueError, match=r"^path: .*\.mat, \.vti, \.vtr, \.csv"):
        bp.export(spectrum, tmp_path / name)
    assert names(tmp_path) == []


@pytest.mark.parametrize("ending", ["mat", "vti", "vtr", "csv"])
def test_folders_and_wrong_datasets(tmp_path, field, ending):
    ds = field.isel(frequency=0, angle=0, z=0)
    with pytest.raises(ValueError, match=r"^path: .*existing folder"):
        bp.export(ds, tmp_path / "none" / f"a.{ending}")
    with pytest.raises(ValueError, match=r"^ds: "):
        bp.export(ds.p, tmp_path / f"a.{ending}")
    assert names(tmp_path) == []
    (tmp_path / f"a.{ending}").write_text("old")
    bp.export(ds, tmp_path / f"A.{ending.upper()}")
    bp.export(ds, tmp_path / f"a.{ending}")
    assert (tmp_path / f"A.{ending.upper()}").read_bytes()[128:] == (tmp_path / f"a.{ending}").read_bytes()[128:]


def test_the_command_writes_every_kind(tmp_path):
    """--output and convert; what a kind does not hold is wrong use, and nothing is left."""
    beam = ["field", "--periods", "10", "--x", "-0.2:0.2:9", "--z", "0:0.1:3", "--quiet", "--output"]
    for ending in ("nc", "zarr", "mat", "vti", "vtr"):
        assert CliRunner().invoke(main, [*beam, str(tmp_path / f"a.{ending}")]).exit_code == 0
    ds = bp.load(tmp_path / "a.nc")
    wanted = read_vtk(tmp_path / "a.vti")[1]["PointData"]
    for ending in ("zarr", "mat"):
        xr.testing.assert_identical(bp.load(tmp_path / f"a.{ending}"), ds)
        result = CliRunner().invoke(
            main, ["convert", str(tmp_path / f"a.{ending}"), str(tmp_path / f"from_{ending}.vti")]
        )
        assert result.exit_code == 0, result.output
        _, groups = read_vtk(tmp_path / f"from_{ending}.vti")
        assert [a.tobytes() for a in groups["PointData"].values()] == [a.tobytes() for a in wanted.values()]
    before = names(tmp_path)
    wrong = [
        ([*beam, str(tmp_path / "b.csv")], "--output: expected one axis for a .csv, got --x and --z"),
        (["convert", str(tmp_path / "a.nc"), str(tmp_path / "b.csv")], "one dimension"),
        (["convert", str(tmp_path / "a.nc"), str(tmp_path / "b.vti"), "--digits", "4"], "--digits: expected"),
        (["convert", str(tmp_path / "a.nc"), str(tmp_path / "b.txt")], ".csv"),
    ]
    for words, said in wrong:
        result = CliRunner().invoke(main, words)
        assert (result.exit_code, said in result.stderr) == (2, True), result.stderr
    assert names(tmp_path) == before
    widths = ["beam_width", "--periods", "10", "--frequency", "2400:2500:3", "--output", str(tmp_path / "w.csv")]
    assert CliRunner().invoke(main, widths).exit_code == 0
    assert list(pd.read_csv(tmp_path / "w.csv")["frequency (Hz)"]) == [2400, 2450, 2500]
    rounded = ["convert", str(tmp_path / "a.nc"), str(tmp_path / "r.nc"), "--digits", "4"]
    assert CliRunner().invoke(main, rounded).exit_code == 0
    assert "rounding_error" in bp.load(tmp_path / "r.nc").p.attrs
