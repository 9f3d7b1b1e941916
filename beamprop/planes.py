"""A field on many planes, made of those on a few.

The plane waves of a beam at one depth are a row of the matrix h(z, kx). Between two depths little happens to it: a medium has
two waves for each kx, whose phases depend on kx smoothly. So all rows are combinations of a few of them, found by cross
approximation: some tens for a beam that crosses ten wavelengths of air, ten for one in 450 periods whose contours are flat.
The fields on those few planes are summed, all others are combinations of them.
"""

from __future__ import annotations

import numpy as np


def cross(h: np.ndarray, tolerance: float, most: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Rows and columns of h (Z, n), whose rows have norm 1, from which every entry follows to `tolerance`: (r,) each.

    Gaussian elimination with complete pivoting; h is overwritten. None where it takes more than `most` of them.
    """
    rows: list[int] = []
    columns: list[int] = []
    square, other = np.empty(h.shape), np.empty(h.shape)
    while True:
        np.square(h.real, out=square)
        square += np.square(h.imag, out=other)
        i, j = np.unravel_index(int(np.argmax(square)), square.shape)
        if square[i, j] <= tolerance * tolerance:
            return np.array(rows, int), np.array(columns, int)
        if len(rows) == most:
            return None
        rows.append(int(i))
        columns.append(int(j))
        h -= np.multiply.outer(h[:, j] / h[i, j], h[i])


def mixing(h: np.ndarray, few: np.ndarray) -> np.ndarray:
    """The matrix (Z, r) that makes all rows of the few: h (Z, r) and few (r, r) are both at the columns of `cross`.

    That `few` is close to singular does not matter: what its inverse magnifies meets rows that are as small.
    """
    size = np.linalg.norm(few, axis=1)
    return np.linalg.solve((few / size[:, None]).T, h.T).T / size
