"""Datasets that are lazy, empty, or written by several threads."""

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr

import beamprop as bp


@pytest.fixture(scope="module")
def field():
    return bp.field(
        bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1), [2400.0, 2500.0], np.linspace(-0.4, 0.4, 11), [0.0, 0.1]
    )


@pytest.mark.parametrize("path", ["a.nc", "a.zarr"])
def test_values_that_are_still_to_be_computed(tmp_path, field, path):
    """dask's arrays are written like any."""
    pytest.importorskip("dask")
    bp.save(field.chunk({"x": 3}), tmp_path / path)
    xr.testing.assert_identical(bp.load(tmp_path / path), field)


@pytest.mark.parametrize("path", ["a.nc", "a.zarr"])
def test_dimensions_without_length(tmp_path, path):
    """No mode was found: there is nothing to check, and nothing to miss."""
    ds = xr.Dataset(
        {"kx": ("mode", np.empty(0, complex)), "m": (("mode", "x"), np.empty((0, 3)))}, {"x": [1.0, 2.0, 3.0]}
    )
    bp.save(ds, tmp_path / path)
    xr.testing.assert_identical(bp.load(tmp_path / path), ds)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_threads_write_and_read_at_once(tmp_path, field, ending):
    """Each its own file, and all the same one."""

    def work(k):
        for name in (f"own{k}.{ending}", f"same.{ending}"):
            bp.save(field, tmp_path / name)
            xr.testing.assert_identical(bp.load(tmp_path / name), field)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(work, range(8)))
    assert sorted(os.listdir(tmp_path)) == sorted([f"own{k}.{ending}" for k in range(8)] + [f"same.{ending}"])
