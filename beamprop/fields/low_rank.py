"""A field on many planes as combinations of rows, by the low rank of H(z, kx).

The plane waves of a beam at one depth are a row of the matrix H(z, kx). A medium has two waves for each kx, whose phases depend on
kx smoothly, so that H has a low rank: some tens for a beam that crosses ten wavelengths of air, ten for 450 periods whose
contours are flat. Cross approximation (M. Bebendorf, Numer. Math. 86, 565 (2000)) chooses rows and columns from which all
rows follow. The fields on the planes of those rows are summed, all others are combinations of them.
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
    square, imaginary = np.empty(h.shape), np.empty(h.shape)
    for r in range(most):
        np.square(h.real, out=square)
        square += np.square(h.imag, out=imaginary)
        i, j = divmod(int(np.argmax(square)), h.shape[1])
        size = math.sqrt(square[i, j])
        if not size > tolerance:
            return Cross(rows[:r], columns[:r], pivots[:r])
        rows[r], columns[r], pivots[r] = i, j, size
        h -= np.multiply.outer(h[:, j] / h[i, j], h[i])
    return Cross(rows, columns, pivots)


def row_weights(h: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """The matrix (Z, r) that makes all rows of the chosen ones: h (Z, r) and `chosen` (r, r) are both at the columns of `cross`.

    That `chosen` is close to singular does not matter: what its inverse magnifies meets rows that are as small.
    """
    size = np.linalg.norm(chosen, axis=1)
    return np.linalg.solve((chosen / size[:, None]).T, h.T).T / size
