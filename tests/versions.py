"""Datasets that tell which version they are, for tests of files that take another's place."""

import os

import numpy as np
import xarray as xr


def version(number):
    """A dataset in which every value and attribute tells its version."""
    parts = {f"v{k}": ("x", np.full(50, float(number)), {"version": number}) for k in range(6)}
    return xr.Dataset(parts, {"x": np.arange(50.0)}, {"version": number})


def versions_in(ds):
    """Every version that a dataset tells: more than one of them is a mixture."""
    return {ds.attrs["version"], *(v.attrs["version"] for v in ds.data_vars.values()), *np.unique(ds.to_array())}


def names(folder):
    """What lies in a folder, hidden files too."""
    return sorted(os.listdir(folder))
