"""Sums of exp(i k y) over even wavenumbers along one axis, by products of real matrices.

Wavenumbers come in pairs about their middle, and so do most positions:

    sum over +-k, v(k) exp(i k y) = cos(k y) (v(k) + v(-k)) + i sin(k y) (v(k) - v(-k)),

whose second term changes its sign with y. That is a quarter of the multiplications, and an eighth where v is even.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays.matmul import product


class Along(NamedTuple):
    """Cosines and sines between wavenumbers (K,) and positions (P,); both about their middles."""

    shape: tuple[int, int]  #: P, K
    cosines: np.ndarray  #: (P', K'), K' = K/2 rounded up, and P' likewise where positions are in pairs
    sines: np.ndarray
    before: np.ndarray | None  #: exp(i k ym) of the positions' middle (K, 1), None where that is 0
    after: np.ndarray | None  #: exp(i km y) of the wavenumbers' middle (P, 1), likewise

    @property
    def in_pairs(self) -> bool:
        """Whether positions are."""
        return len(self.cosines) < self.shape[0]

    def sum(self, values: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
        """The sum over k of contiguous values (K, N), into `out` or an array (P, N)."""
        (P, K), lower = self.shape, self.shape[1] // 2
        out = np.empty((P, values.shape[1]), complex) if out is None else out
        if self.before is not None:
            values = values * self.before
        above, below = values[lower:], values[K - lower - 1 :: -1]
        even, odd = above + below, 1j * (above - below)
        if K % 2:
            even[0] /= 2
        part, half = out[P - len(self.cosines) :], P // 2
        np.copyto(part, real_product(self.cosines, even))
        if not np.any(odd):
            if self.in_pairs:
                out[:half] = out[P - half :][::-1]
        else:
            change = real_product(self.sines, odd)
            if self.in_pairs:
                np.subtract(part[P % 2 :], change[P % 2 :], out=out[:half][::-1])
            part += change
        if self.after is not None:
            out *= self.after
        return out


def along(k: np.ndarray, y: np.ndarray) -> Along:
    """For even k and any y."""
    km, ym = (k[0] + k[-1]) / 2, (y[0] + y[-1]) / 2
    off = np.max(np.abs(y - ym + (y - ym)[::-1]))
    paired = y.size > 1 and off <= 4 * np.finfo(float).eps * np.max(np.abs(y))
    if not paired:
        ym = 0.0
    phases = np.multiply.outer((y - ym)[y.size // 2 if paired else 0 :], (k - km)[k.size // 2 :])
    before = np.exp(1j * (k - km) * ym)[:, None] if ym else None
    after = np.exp(1j * km * y)[:, None] if km else None
    return Along((y.size, k.size), np.cos(phases), np.sin(phases), before, after)


def real_product(real: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Real (P, K) by complex (K, N), as pairs of real columns."""
    return product(real, values.view(float)).view(complex)
