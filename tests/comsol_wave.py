"""A wave on rows and on a grid, as the tests of COMSOL's exports write and expect it."""

import numpy as np

X, Z = np.linspace(-0.2, 0.3, 6), np.linspace(-0.1, 0.4, 4)


def wave(x, z, k=2.0):
    return np.exp(-(x**2) + 1j * k * z) * (1.5 - 0.3j)


def points(x=X, z=Z):
    """Rows of a spreadsheet, x fastest: coordinates and where each row stands on the (z, x) grid."""
    zz, xx = np.meshgrid(z, x, indexing="ij")
    return {"x": xx.ravel(), "y": zz.ravel()}


def field_on_rows(k=2.0):
    at = points()
    return np.conj(wave(at["x"], at["y"], k))  # COMSOL's exp(+i w t)


def expected(k=2.0, x=X, z=Z):
    return wave(x[None, :], z[:, None], k)
