"""Maps larger than memory: the file is the one that `save` would write, and no more than a block is held."""

import tracemalloc

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from saved import assert_in_blocks_as_whole

import beamprop as bp
from beamprop.cli import main

SLAB = bp.Slab(bp.lmmd_cell(), 60)
BEAM = bp.GaussianBeam(0.096, z0=-0.05)
X, Z = np.linspace(-0.5, 0.5, 65), np.linspace(-0.05, 0.2, 23)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("memory", [100, 5e3, 1e5, 1e9])
@pytest.mark.parametrize(
    ("frequency", "x", "z", "angle"),
    [
        (2500.0, X, Z, None),
        ([2400.0, 2500.0], X, Z, [0.0, 45.0, 60.0]),
        (2500.0, X, 0.05, np.linspace(-60, 60, 50)),
        ([2500.0], 0.1, Z, 45.0),
        (2500.0, 0.1, 0.05, None),
    ],
)
def test_a_file_in_blocks_is_the_file_of_the_whole(tmp_path, ending, memory, frequency, x, z, angle):
    assert_in_blocks_as_whole(tmp_path, ending, (SLAB, BEAM, frequency, x, z, angle), memory, 1e-11)


def test_a_periodic_map_in_blocks(tmp_path):
    arguments = SLAB, BEAM, 2500.0, X, Z, 0.0, "periodic", 2.0
    bp.save_field(tmp_path / "map.nc", *arguments, memory=1e4)
    np.testing.assert_allclose(bp.load(tmp_path / "map.nc").p, bp.field(*arguments).p, atol=1e-12)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_no_more_than_a_block_is_held(tmp_path, ending):
    """A map of 64 MB in blocks of 2 MB takes less than half of it, the sums and their tables included."""
    x, z = np.linspace(-0.5, 0.5, 2000), np.linspace(0, SLAB.thickness, 2000)
    bp.save_field(tmp_path / f"small.{ending}", SLAB, BEAM, 2500.0, x[:64], z[:8])
    tracemalloc.start()
    bp.save_field(tmp_path / f"map.{ending}", SLAB, BEAM, 2500.0, x, z, memory=2e6)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 16 * x.size * z.size / 2


def test_what_is_read_by_parts(tmp_path):
    bp.save_field(tmp_path / "map.nc", SLAB, BEAM, 2500.0, X, Z, memory=1e4)
    with xr.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as opened:
        part = opened.isel(z=slice(3, 5))
        part = part.p_real.values + 1j * part.p_imag.values
    np.testing.assert_allclose(part, bp.field(SLAB, BEAM, 2500.0, X, Z).p[3:5], rtol=0, atol=1e-11)


def test_nothing_half_written_is_left(tmp_path):
    """A refusal in the middle leaves the old file, and no new one."""
    path = tmp_path / "map.nc"
    path.write_text("old")

    def stop(work):
        yield from list(work)[:3]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bp.save_field(path, SLAB, BEAM, 2500.0, X, Z, memory=5e3, progress=stop)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("changed", "said"),
    [({"memory": 0}, "memory"), ({"memory": np.nan}, "memory"), ({"path": "map.txt"}, "path"), ({"z": -1.0}, "z")],
)
def test_wrong_arguments_are_named(tmp_path, changed, said):
    arguments = {"path": "map.nc", "slab": SLAB, "beam": BEAM, "frequency": 2500.0, "x": X, "z": Z} | changed
    arguments["path"] = tmp_path / arguments["path"]
    with pytest.raises(ValueError, match=f"^{said}: "):
        bp.save_field(**arguments)
    assert not list(tmp_path.iterdir())


def test_the_command_in_blocks(tmp_path):
    path = tmp_path / "map.zarr"
    common = ["field", "--periods", "60", "--x", "-0.5:0.5:65", "--z", "0:0.1:9", "--output", str(path)]
    result = CliRunner().invoke(main, [*common, "--memory", "0.01"])
    assert result.exit_code == 0, result.output
    assert "p on (z 9, x 65)" in result.stdout
    assert bp.load(path).p.shape == (9, 65)
    for wrong in (["--memory", "0"], ["--memory", "1", "--plot", str(tmp_path / "p.png")], ["--memory", "1", "--json"]):
        assert CliRunner().invoke(main, [*common, *wrong]).exit_code == 2
    assert CliRunner().invoke(main, [*common[:-2], "--memory", "1"]).exit_code == 2
