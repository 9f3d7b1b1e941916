"""Datasets of random numbers on any axes, labelled as the package labels its own: what pictures are drawn of in their tests."""

import numpy as np
import xarray as xr

from beamprop.io.labels import label

AXES = {
    "frequency": np.linspace(2000.0, 3000.0, 21),
    "kx_over_k0": np.linspace(0.0, 3.0, 31),
    "angle": np.linspace(0.0, 60.0, 7),
    "eta": np.array([0.01, 0.02, 0.05]),
    "sample": np.arange(25),
    "mode": np.arange(2),
}


def made(*dims, names=("transmissivity",), **axes):
    """A dataset of random positive numbers on some axes, labelled as the package labels its own."""
    axes = {d: axes.get(d, AXES[d]) for d in dims}
    known = {d: (d, v, label(d) if d != "sample" else {}) for d, v in axes.items()}
    shape, draw = tuple(map(len, axes.values())), np.random.default_rng(1)
    return xr.Dataset({n: (dims, draw.uniform(0.1, 0.4, shape), label(n)) for n in names}, known)


def widths(*dims, **axes):
    return made(*dims, names=("fwhm_in", "fwhm_out", "fwhm_air"), **axes)
