"""The commands compare, convert and modes."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import beamprop as bp
from beamprop.cli import main


@pytest.fixture
def fields(tmp_path):
    """The same field twice, the second off by one part in a thousand."""
    x, z = np.linspace(-0.2, 0.2, 41), np.array([0.0, 0.01])
    ds = bp.field(bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.05), 2500.0, x, z)
    bp.save(ds, tmp_path / "a.nc")
    bp.save(ds.assign(p=(ds.p * 1.001).assign_attrs(ds.p.attrs)), tmp_path / "b.nc")
    return tmp_path


@pytest.mark.parametrize(("tolerance", "code"), [("1e-2", 0), ("1e-4", 1)])
def test_compare_exits_by_its_tolerance(fields, tolerance, code):
    """0 below the tolerance, 1 above it; the number either way, and the picture."""
    picture = fields / "c.png"
    result = CliRunner().invoke(
        main,
        ["compare", str(fields / "a.nc"), str(fields / "b.nc"), "--tolerance", tolerance, "--json", "-p", str(picture)],
    )
    assert result.exit_code == code, result.output
    record = json.loads(result.stdout)
    assert record["data_vars"]["relative_l2"]["data"] == pytest.approx(1e-3, rel=1e-6)
    assert picture.stat().st_size > 1000


def test_compare_wants_files_that_exist(tmp_path):
    """Exit 2, as for any wrong use."""
    assert CliRunner().invoke(main, ["compare", str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]).exit_code == 2


def test_convert_and_back(fields):
    """netCDF to Zarr and split netCDF: the same dataset."""
    want = bp.load(fields / "a.nc")
    for target, options in (("c.zarr", []), ("c.nc", ["--split-complex"])):
        result = CliRunner().invoke(main, ["convert", str(fields / "a.nc"), str(fields / target), *options])
        assert result.exit_code == 0, result.output
        assert bp.load(fields / target).identical(want)


def test_convert_refuses_text_that_is_no_export(tmp_path):
    """The message names the file; nothing is written."""
    (tmp_path / "a.txt").write_text("no header, no numbers\n")
    result = CliRunner().invoke(main, ["convert", str(tmp_path / "a.txt"), str(tmp_path / "a.nc")])
    assert result.exit_code == 2
    assert "a.txt" in result.stderr
    assert not (tmp_path / "a.nc").exists()


def test_modes(tmp_path):
    """As guided_modes answers."""
    result = CliRunner().invoke(
        main, ["modes", "--lossless", "--periods", "20", "--json", "-o", str(tmp_path / "m.nc")]
    )
    assert result.exit_code == 0, result.output
    (mode,) = json.loads(result.stdout)["data_vars"]["kx_over_k0"]["data"]
    want = bp.guided_modes(bp.Slab(bp.lmmd_cell(0.05, 0.0), 20), 2500.0)
    assert mode["re"] == pytest.approx(want.kx_over_k0.values[0].real)
    assert bp.load(tmp_path / "m.nc").identical(want)
