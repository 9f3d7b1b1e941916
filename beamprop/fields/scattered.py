"""A field at scattered points, pairs (x, z) that form no grid: each point sums the plane waves itself.

N points cost N n exponentials and products, for n plane waves, where a grid of N depths by N positions would cost N times that;
depths that points share are passed through the slab once.
"""

from __future__ import annotations

import numpy as np

from ..response import transfer_function
from .evaluate import check_finite
from .question import Prepared

#: Terms of the sum, points by plane waves, that are held at a time: 20 MB for each of a few arrays.
TERMS = 1_250_000


def at_points(prepared: Prepared, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """p of all requested beams at points x (N,), from the source's middle, and z (N,): (A, N)."""
    s, beams, k = prepared.slab, prepared.beams, prepared.quadrature.contour.k
    right, left = prepared.quadrature.amplitudes_of(s.k0, beams)
    transfer = transfer_function.through(s, prepared.question.source.z0)
    summed = np.empty((right.shape[0], 1, x.size), complex)
    order, most = np.argsort(z, kind="stable"), max(1, TERMS // k.size)
    for start in range(0, x.size, most):
        points = order[start : start + most]
        depths, at = np.unique(z[points], return_inverse=True)
        h = transfer(k, depths)[at]
        turn = np.exp(1j * np.outer(x[points] - beams.beam.centre, k))
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused below
            summed[:, 0, points] = right @ (h * turn).T + left @ (h / turn).T
    check_finite(summed)
    return beams.interpolated_to(summed)[:, 0]
