"""p(z, x) of a periodic array of beams: on each plane, of the orders that reach it.

A source with sharp edges has orders without end, 200 000 of which are summed on its own plane. Evanescent ones fade on their way through
the half-spaces, so that planes a few millimetres away take a hundredth of them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..contour.paths import EPS
from ..response.transfer_function import TransferFunction
from .evaluate import Superposition, fill_map

#: Every plane has so many orders: fewer do not make a map quicker.
FEWEST = 512
#: exp(-FADED), 1e-30, is what is left of orders that are left out: a slab would have to amplify them 1e14 times to let them be seen.
FADED = 69.0
#: Numbers of the transfer function that are looked at together: 16 MB.
TOGETHER = 2**20


def fill_by_reach(
    waves: Superposition, transfer: TransferFunction, z: np.ndarray, out: np.ndarray, rtol: float
) -> None:
    """As `evaluate.fill_map`, of the orders that reach each plane; what is left out is below rounding."""
    orders = _orders(waves, transfer, z)
    edges = [0, *(np.flatnonzero(np.diff(orders)) + 1).tolist(), z.size]
    for run in (slice(*ends) for ends in pairwise(edges)):
        fill_map(waves.up_to(int(orders[run.start])), transfer, z[run], out[:, run], rtol)


def _orders(waves: Superposition, transfer: TransferFunction, z: np.ndarray) -> np.ndarray:
    """How many orders each plane takes: a power of two by which they have faded, as the last quarter of them shows."""
    contour, s = waves.quadrature.contour, transfer.slab
    total, count = contour.k.size, FEWEST
    if waves.quadrature.fft:
        return np.full(z.size, total)
    way = np.minimum(z, 0.0) - waves.sources.beam.z0 + np.maximum(0.0, z - s.thickness)
    with np.errstate(divide="ignore"):
        enough = np.minimum(np.hypot(s.last_branch, FADED / way) / contour.step, total)
    orders = np.minimum(np.exp2(np.ceil(np.log2(np.maximum(enough, FEWEST)))), total).astype(int)
    while count < total:
        here = np.flatnonzero(orders == count)
        more = here[~_have_faded(waves.up_to(count), transfer, z[here])]
        count = min(2 * count, total)
        orders[more] = count
    return orders


def _have_faded(waves: Superposition, transfer: TransferFunction, z: np.ndarray) -> np.ndarray:
    """Whether, on each plane and of every beam, the last quarter of the orders sums to less than the rounding of the rms of |p|."""
    k, amplitudes = waves.quadrature.contour.k, np.abs(waves.amplitudes)  # (2, B, n)
    last, rows = slice(3 * k.size // 4, None), max(1, TOGETHER // k.size)
    faded = np.empty(z.size, bool)
    for start in range(0, z.size, rows):
        h = np.abs(transfer(k, z[start : start + rows]))
        h /= np.maximum(h.max(axis=1, keepdims=True), np.finfo(float).tiny)  # squares of what is dark would vanish
        rms = np.sqrt(h**2 @ np.sum(amplitudes**2, axis=0).T)
        faded[start : start + rows] = np.all(h[:, last] @ np.sum(amplitudes, axis=0)[:, last].T <= EPS * rms, axis=1)
    return faded
