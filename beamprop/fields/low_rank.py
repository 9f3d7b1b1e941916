"""A field on many planes, made of those on a few.

The plane waves of a beam at one depth are a row of the matrix h(z, kx). Between two depths little happens to it: a medium has
two waves for each kx, whose phases depend on kx smoothly. So all rows are combinations of a few of them, found by cross
approximation: some tens for a beam that crosses ten wavelengths of air, ten for one in 450 periods whose contours are flat.
The fields on those few planes are summed, all others are combinations of them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Cross(NamedTuple):
    """Rows and columns of a matrix, by falling size of their pivots; (r,) each."""

    rows: np.ndarray
    columns: np.ndarray
    pivots: np.ndarray

    def within(self, tolerance: float) -> int:
        """How many of them leave no pivot above a tolerance: all, where the last one is above it."""
        return int(np.count_nonzero(self.pivots > tolerance))


def cross(h: np.ndarray, tolerance: float, most: int) -> Cross:
    """The rows and columns of h (Z, n), whose rows have norm 1, from which every entry follows to `tolerance`, or `most` of them.

    Gaussian elimination with complete pivoting; h is overwritten.
    """
    rows, columns, pivots = np.empty(most, int), np.empty(most, int), np.empty(most)
    square, other = np.empty(h.shape), np.empty(h.shape)
    for r in range(most):
        np.square(h.real, out=square)
        square += np.square(h.imag, out=other)
        i, j = divmod(int(np.argmax(square)), h.shape[1])
        size = math.sqrt(square[i, j])
        if not size > tolerance:
            return Cross(rows[:r], columns[:r], pivots[:r])
        rows[r], columns[r], pivots[r] = i, j, size
        h -= np.multiply.outer(h[:, j] / h[i, j], h[i])
    return Cross(rows, columns, pivots)


def mixing(h: np.ndarray, few: np.ndarray) -> np.ndarray:
    """The matrix (Z, r) that makes all rows of the few: h (Z, r) and few (r, r) are both at the columns of `cross`.

    That `few` is close to singular does not matter: what its inverse magnifies meets rows that are as small.
    """
    size = np.linalg.norm(few, axis=1)
    return np.linalg.solve((few / size[:, None]).T, h.T).T / size
