"""Datasets of a beam that fans out along z and slants, in closed form, for the tests of comparisons."""

import numpy as np
import xarray as xr

X, Z = np.linspace(-0.6, 0.6, 121), np.linspace(-0.1, 0.5, 31)
RADIUS, K = 0.1, 20.0


def gaussian(x, z, radius=RADIUS, k=K):
    """A beam that fans out along z, and slants."""
    a = radius * (1 + z**2)
    return np.exp(-(((x - 0.1 * z) / a) ** 2) + 1j * k * (z + x**2))


def make(x=X, z=Z, units="Pa", values=None, **attrs):
    p = gaussian(x[None, :], z[:, None]) if values is None else values
    labels = {
        "z": ("z", z, {"units": "m", "long_name": "depth"}),
        "x": ("x", x, {"units": "m", "long_name": "lateral"}),
    }
    return xr.Dataset({"p": (("z", "x"), p, {"units": units})}, labels, attrs)


def swept(frequencies=(2000.0, 2500.0), angles=(0.0, 30.0)):
    parts = [[make(values=gaussian(X[None, :], Z[:, None], k=f / 100 + t)) for t in angles] for f in frequencies]
    rows = [xr.concat(row, xr.DataArray(list(angles), dims="angle", name="angle")) for row in parts]
    return xr.concat(rows, xr.DataArray(list(frequencies), dims="frequency", name="frequency"))
