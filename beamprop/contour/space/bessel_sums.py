"""Sums of J0(k r) over the nodes of a contour, at positions r far from 0, by Chebyshev polynomials in k.

J0 is the sum of two waves exp(+-i k m) about the middle m of the positions, times Hankel functions that turn with k by half of their
extent alone. On pieces of the contour's band these are Chebyshev series of few terms, and the nodes add up to moments,

    sum w h J0(k r) = sum over q of A_q(r) sum w h exp(i k m) T_q(x) k^(-1/2) + the same of conj(A_q) and exp(-i k m),

x between -1 and 1 on a piece. A contour far aside has tens of nodes for each term, and a table of all of J0 would be as many times larger.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...arrays import fft
from ...arrays.matmul import product

#: Bessel functions of the orders beyond c + AIRY (c/2)^(1/3) are below 1e-15 at c, as Ai(AIRY) is (DLMF 9.7.5, 10.19.8).
AIRY = 14.0
#: How far the Hankel functions turn on a piece, about, and over the number of positions at least: longer ones take fewer terms in all, and
#: more products.
TURNS, LONG = 120.0, 0.25
#: How far a series reaches beyond its nodes, over the piece: T_q grows less with the distance from the axis there.
BEYOND = 0.07
#: A piece begins at this part of its end at least, for Hankel functions are singular at 0.
NEAREST = 0.25
#: Least k r of a piece, about: below it few nodes are left, on circles about poles at most.
LEAST = 1.0
#: A node may lie so far off the axis that T_q has grown by exp(GROWTH), or is summed by itself.
GROWTH = 4.0
#: Nodes whose polynomials are held at a time, and positions from which strengths are formed.
BLOCK, FEW = 2**10, 32


class Piece(NamedTuple):
    """Nodes on a part of the band, and the Chebyshev series of their Hankel functions."""

    nodes: np.ndarray  #: (b,), which they are
    middle: float  #: of k
    half: float
    series: np.ndarray  #: (R, N)


class BesselSums(NamedTuple):
    """J0 times weights of nodes (n,) at positions (N,)."""

    k: np.ndarray  #: (n,)
    weight: np.ndarray  #: (n,)
    positions: np.ndarray  #: (N,)
    middle: float  #: of the positions
    pieces: list[Piece]
    alone: np.ndarray  #: (a,), nodes that are summed by themselves
    table: np.ndarray  #: (a, N), what they add

    def at(self, h: np.ndarray) -> np.ndarray:
        """The sums over the nodes of each row of h (Z, n), at the positions: (Z, N)."""
        out = product(h[:, self.alone], self.table)
        for piece in self.pieces:
            forward, backward = self._moments(piece, h)
            out += product(forward, piece.series)
            out += np.conj(product(np.conj(backward), piece.series))
        return np.asarray(out)

    @property
    def strengths(self) -> np.ndarray:
        """The norms of what each node adds at a few of the positions: (n,)."""
        from scipy.special import jv

        some = self.positions[:: max(1, self.positions.size // FEW)]
        return np.asarray(np.abs(self.weight) * np.linalg.norm(jv(0, np.multiply.outer(self.k, some)), axis=1))

    def _moments(self, piece: Piece, h: np.ndarray) -> np.ndarray:
        """Those of waves with exp(i k m), and with exp(-i k m): (2, Z, R)."""
        out = np.zeros((2 * len(h), len(piece.series)), complex)
        for start in range(0, piece.nodes.size, BLOCK):
            nodes = piece.nodes[start : start + BLOCK]
            k = self.k[nodes]
            phase, values = np.exp(1j * self.middle * k), h[:, nodes] * (self.weight[nodes] / np.sqrt(k))
            waves = np.concatenate([values * phase, values / phase])
            out += product(waves, _polynomials((k - piece.middle) / piece.half, len(piece.series)).T)
        return out.reshape(2, len(h), -1)


def _polynomials(x: np.ndarray, count: int) -> np.ndarray:
    """T_q(x) of q < count: (count, b)."""
    t = np.ones((count, x.size), complex)
    t[1] = x
    for q in range(2, count):
        np.multiply(2 * x, t[q - 1], out=t[q])
        t[q] -= t[q - 2]
    return t


def terms(turns: float) -> int:
    """Of the Chebyshev series of exp(i turns x), to rounding."""
    return math.ceil(turns + AIRY * (turns / 2) ** (1 / 3)) + 20


def bessel_sums(k: np.ndarray, weight: np.ndarray, positions: np.ndarray, extent: tuple[float, float]) -> BesselSums:
    """For nodes k (n,) and their weights, at positions inside an `extent`."""
    from scipy.special import jv

    middle, half = (extent[0] + extent[1]) / 2, (extent[1] - extent[0]) / 2
    pieces, alone, high = [], np.ones(k.size, bool), float(k.real.max())
    while high * middle > LEAST:
        low = max(high - max(TURNS, LONG * positions.size) / half, NEAREST * high)
        reach = (0.5 + BEYOND) * (high - low)
        count = terms(reach * half)
        inside = (k.real > low) & (k.real <= high)
        if np.count_nonzero(k.real <= high) < 2 * count:
            break
        nodes = np.flatnonzero(inside & (np.abs(k.imag) < GROWTH * reach / count))
        if nodes.size > 2 * count:
            pieces.append(
                Piece(nodes, (low + high) / 2, reach, _series((low + high) / 2, reach, count, (positions, middle)))
            )
            alone[nodes] = False
        high = low
    left = np.flatnonzero(alone)
    table = np.multiply.outer(k[left], positions)
    jv(0, table, out=table)
    table *= weight[left, None]
    return BesselSums(k, weight, positions, middle, pieces, left, table)


def _series(center: float, reach: float, count: int, places: tuple[np.ndarray, float]) -> np.ndarray:
    """Chebyshev coefficients in k of sqrt(k) H0(k r) exp(-i k m)/2, at positions and for their middle m: (count, N)."""
    from scipy.special import hankel1e

    positions, middle = places
    k: Any = (center + reach * np.cos((np.arange(count) + 0.5) * math.pi / count))[:, None]
    values = hankel1e(0, k * positions) * (np.sqrt(k) / 2)
    values *= np.exp(1j * k * (positions - middle))
    return fft.cosine_coefficients(values)
