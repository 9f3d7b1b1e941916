"""Matrix products of moderate size, kept on one thread.

A threaded BLAS divides even small products among all cores; on a machine that is busy with something else, each one then
waits for a time slice: (7, 146) by (146, 72) was measured at 10 ms instead of 0.02 ms.
"""

from __future__ import annotations

import numpy as np

#: Numbers in a block that stays in the cache with its temporaries.
BLOCK = 2**14
#: OpenBLAS takes threads from 2^16 multiplications of complex numbers on, and four times as many of real ones.
UNTHREADED = 2**16
#: From this size on threads pay.
LARGE = 2**25


def small_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """``a @ b`` for (m, k) by (k, n), in pieces that the BLAS does not divide among threads."""
    (m, k), n = a.shape, b.shape[1]
    if m == 1:  # matrix by vector is divided much sooner than matrix by matrix
        return small_product(np.concatenate([a, a]), b)[:1]
    if n == 1:
        return small_product(a, np.concatenate([b, b], axis=1))[:, :1]
    out_type = np.result_type(a, b)
    most = UNTHREADED if out_type.kind == "c" else 4 * UNTHREADED
    if m * k * n <= most:
        return a @ b
    out = np.empty((m, n), out_type)
    columns = min(n, max(16, most // (k * min(m, 32))))
    rows = max(1, most // (k * columns))
    for j in range(0, n, columns):
        part = np.ascontiguousarray(b[:, j : j + columns])
        for i in range(0, m, rows):
            np.matmul(a[i : i + rows], part, out=out[i : i + rows, j : j + columns])
    return out


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """``a @ b``: in small pieces where that costs less than what waking the threads may."""
    (m, k), n = a.shape, b.shape[1]
    return small_product(a, b) if m * k * n < LARGE else a @ b
