"""`field` and `save_field` of sums of sources in three dimensions: single sources added, products of sums, blocks."""

import numpy as np
import pytest
import xarray as xr

import beamprop as bp

FREQUENCY = 2500.0
LOSSY = bp.Slab(bp.lmmd_cell(), 20)
#: Two beams that overlap, with directions of their own.
FIRST = bp.GaussianBeam((0.2, 0.15), 25, -0.05, -0.1, azimuth=30.0, y0=0.02)
SECOND = bp.GaussianBeam((0.15, 0.2), x0=0.08, z0=-0.1)
WEIGHT = 0.8 + 0.3j
PAIR = FIRST + WEIGHT * SECOND
X, Y, Z = np.linspace(-0.5, 0.5, 17), np.linspace(-0.4, 0.4, 13), np.linspace(0.15, 0.4, 11)
SAME = bp.GaussianBeam((0.2, 0.2), z0=-0.1)


def nearly(share):
    """Two beams whose difference is `share` of one of them, but for a share squared."""
    return bp.GaussianBeam((0.2 * (1 + share),) * 2, z0=-0.1) - SAME


def assert_as_whole(path, memory, *arguments):
    """What `save_field` writes is the answer of `field`; errors are over the largest |p|, which rounds by blocks."""
    whole, rest = bp.field(*arguments, y=Y), bp.save_field(path, *arguments, memory=memory, y=Y)
    loaded = bp.load(path)
    xr.testing.assert_identical(loaded.drop_vars("p"), rest)
    xr.testing.assert_allclose(loaded.error_estimate, whole.error_estimate, rtol=1e-9, atol=0)
    assert loaded.attrs == whole.attrs
    assert all(loaded[name].equals(whole[name]) for name in whole.coords)
    assert loaded.p.dims == whole.p.dims
    assert loaded.p.attrs == whole.p.attrs
    assert worst(loaded.p.values, whole.p.values) < 1e-12


def worst(p, known):
    return float(np.max(np.abs(p - known)) / np.max(np.abs(known)))


@pytest.mark.parametrize("variable", ["v_x", "v_y", "v_z"])
def test_velocities_are_sums(variable):
    both = FIRST + 0.5j * bp.Piston(0.1, z0=-0.1)
    ds = bp.field(LOSSY, both, FREQUENCY, X, Z[:3], y=Y, variables=["p", variable], rtol=1e-7)
    each = [
        bp.field(LOSSY, source, FREQUENCY, X, Z[:3], y=Y, variables=variable, rtol=1e-10)[variable].values
        for source in both.sources
    ]
    assert worst(ds[variable].values, each[0] + 0.5j * each[1]) < 1e-7
    assert float(ds[f"error_estimate_{variable}"]) < 1e-7


def test_intensities_are_products_of_sums():
    names = ["p", "v_x", "v_y", "v_z", "intensity"]
    ds = bp.field(LOSSY, PAIR, FREQUENCY, X, Z[:3], y=Y, variables=names)
    for axis in "xyz":
        known = np.real(ds.p * np.conj(ds[f"v_{axis}"])) / 2
        np.testing.assert_allclose(ds[f"intensity_{axis}"], known, rtol=1e-12, atol=1e-300)


def test_means_over_a_cell_are_sums():
    z = np.array([0.011, 0.02])
    ds = bp.field(LOSSY, PAIR, FREQUENCY, X, z, y=Y, average="cell", rtol=1e-7)
    each = [
        bp.field(LOSSY, source, FREQUENCY, X, z, y=Y, average="cell", rtol=1e-10).p.values for source in PAIR.sources
    ]
    assert worst(ds.p.values, each[0] + WEIGHT * each[1]) < 1e-7
    assert float(ds.error_estimate) < 1e-7


def test_lattices_of_sums_are_sums():
    period = {"boundary": "periodic", "period": (2.5, 2.0)}
    ds = bp.field(LOSSY, PAIR, FREQUENCY, X, Z, y=Y, **period)
    each = [bp.field(LOSSY, source, FREQUENCY, X, Z, y=Y, **period).p.values for source in PAIR.sources]
    assert worst(ds.p.values, each[0] + WEIGHT * each[1]) < 1e-12
    assert "error_estimate" not in ds
    assert ds.attrs["period"] == (2.5, 2.0)
    with pytest.raises(ValueError, match=r"^period: expected a grid wide enough for the beam, got 0\.6 m along x"):
        bp.field(LOSSY, PAIR, FREQUENCY, X, Z, y=Y, boundary="periodic", period=(0.6, 2.0))


@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("memory", [100, 2e4, 1e9])
@pytest.mark.parametrize(
    ("beam", "frequency", "z"),
    [(PAIR, [2400.0, 2500.0], Z[:4]), (FIRST + 2j * bp.Piston(0.1, z0=-0.1), FREQUENCY, Z)],
)
def test_a_file_in_blocks_is_the_file_of_the_whole(tmp_path, ending, memory, beam, frequency, z):
    assert_as_whole(tmp_path / f"map.{ending}", memory, LOSSY, beam, frequency, X, z)


def test_a_file_in_blocks_of_several_angles(tmp_path):
    sources = bp.GaussianBeam((0.2, 0.1), z0=-0.1) + 1j * bp.GaussianBeam((0.1, 0.1), x0=0.2, z0=-0.1)
    assert_as_whole(tmp_path / "map.nc", 2e4, LOSSY, sources, FREQUENCY, X, Z, [0.0, 30.0])
    assert bp.provenance(bp.load(tmp_path / "map.nc"))["beam"] == sources


def test_files_of_what_cancels_are_warned_of(tmp_path):
    with pytest.warns(bp.AccuracyWarning, match="sources of the sum that cancel"):
        bp.save_field(tmp_path / "map.nc", LOSSY, nearly(1e-9), FREQUENCY, X, Z, y=Y, memory=2e4)


def test_blocks_of_sources_that_nearly_cancel_keep_rtol(tmp_path):
    """Each block is asked once more with a lower rtol, or made with that of a block before it."""
    rest = bp.save_field(tmp_path / "map.nc", LOSSY, nearly(1e-4), FREQUENCY, X, Z, y=Y, memory=2e4, rtol=1e-6)
    known = bp.field(LOSSY, nearly(1e-4), FREQUENCY, X, Z, y=Y, rtol=1e-9).p.values
    assert worst(bp.load(tmp_path / "map.nc").p.values, known) < 1e-6
    assert float(rest.error_estimate) < 1e-6
