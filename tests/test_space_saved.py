"""`save_field` with y: the file is the one that `save` would write of `field`, and no more than a block is held."""

import tracemalloc

import numpy as np
import pytest
from saved import assert_in_blocks_as_whole

import beamprop as bp

SLAB = bp.Slab(bp.lmmd_cell(), 60)
BEAM = bp.GaussianBeam((0.2, 0.1), 20, z0=-0.05, azimuth=30.0)
X, Y, Z = np.linspace(-0.5, 0.5, 17), np.linspace(-0.4, 0.4, 13), np.linspace(0.15, 0.4, 11)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("memory", [100, 2e4, 1e9])
@pytest.mark.parametrize(
    ("frequency", "z", "angle", "y"),
    [
        (2500.0, Z, None, Y),
        ([2400.0, 2500.0], Z[:4], [0.0, 45.0], Y),
        (2500.0, 0.15, None, Y),
        ([2500.0], Z, 45.0, 0.1),
    ],
)
def test_a_file_in_blocks_is_the_file_of_the_whole(tmp_path, ending, memory, frequency, z, angle, y):
    assert_in_blocks_as_whole(tmp_path, ending, (SLAB, BEAM, frequency, X, z, angle), memory, 1e-12, y=y)


def test_many_planes_keep_the_stated_error(tmp_path):
    """`field` makes a volume of 210 planes of few; blocks of fewer are summed: they differ by what is stated for it."""
    z = np.linspace(0.15, 0.4, 210)
    bp.save_field(tmp_path / "map.nc", SLAB, BEAM, 2500.0, X, z, y=Y, memory=1e5)
    ds = bp.field(SLAB, BEAM, 2500.0, X, z, y=Y)
    peak = float(abs(ds.p).max())
    assert float(abs(bp.load(tmp_path / "map.nc").p - ds.p).max()) < 2 * float(ds.error_estimate) * peak


def test_velocities_and_periodic_volumes(tmp_path):
    names = ["p", "v_y", "intensity_z"]
    for more in ({}, {"boundary": "periodic", "period": (2.0, 1.5), "azimuth": 70.0}):
        bp.save_field(tmp_path / "map.zarr", SLAB, BEAM, 2500.0, X, Z, y=Y, variables=names, memory=1e4, **more)
        ds, loaded = bp.field(SLAB, BEAM, 2500.0, X, Z, y=Y, variables=names, **more), bp.load(tmp_path / "map.zarr")
        assert set(loaded) == set(ds)
        assert bp.provenance(loaded)["period"] == bp.provenance(ds)["period"]
        for name in names:
            np.testing.assert_allclose(loaded[name], ds[name], rtol=0, atol=1e-12 * float(abs(ds[name]).max()))


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_no_more_than_a_block_is_held(tmp_path, ending):
    """A volume of 112 MB in blocks of 4 MB takes a third of it, lattices and their tables included."""
    x, y, z = np.linspace(-0.5, 0.5, 250), np.linspace(-0.5, 0.5, 200), np.linspace(0.15, 0.4, 140)
    bp.save_field(tmp_path / f"small.{ending}", SLAB, BEAM, 2500.0, x[:64], z[:8], y=0.0)
    tracemalloc.start()
    bp.save_field(tmp_path / f"map.{ending}", SLAB, BEAM, 2500.0, x, z, y=y, memory=4e6)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(peak / 1e6)
    assert peak < 16 * x.size * y.size * z.size / 3


def test_nothing_half_written_is_left(tmp_path):
    path = tmp_path / "map.nc"
    path.write_text("old")

    def stop(work):
        yield from list(work)[:3]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        bp.save_field(path, SLAB, BEAM, 2500.0, X, Z, y=Y, memory=5e3, progress=stop)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("changed", "said"), [({"y": "wide"}, "y"), ({"azimuth": 1.0, "y": None}, "azimuth"), ({"z": -1.0}, "z")]
)
def test_wrong_arguments_are_named(tmp_path, changed, said):
    asked = {"slab": SLAB, "beam": BEAM, "frequency": 2500.0, "x": X, "z": Z, "y": Y} | changed
    with pytest.raises(ValueError, match=f"^{said}: "):
        bp.save_field(tmp_path / "map.nc", **asked)
    assert not list(tmp_path.iterdir())
