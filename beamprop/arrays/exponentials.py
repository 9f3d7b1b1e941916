"""Sums of exponentials at even positions: each exponential is the product of an entry of a coarse table and one of a fine table.

With x_j = start + (c S + f) step, exp(i k x_j) = exp(i k (start + c S step)) exp(i k f step). N positions take 2 sqrt(N)
exponentials for each k instead of N, and the sum over k or over j is a matrix product of the tables.
"""

from __future__ import annotations

import math

import numpy as np

from .matmul import product

#: Number of positions from which on tables are used: with 3001 samples of a profile, a field at 2001 positions takes half the time.
MANY = 128
#: Complex numbers that the tables of a block of k hold.
BLOCK = 2**20


def complex_expm1(z: np.ndarray) -> np.ndarray:
    """exp(z) - 1 by the real functions, which NumPy has in vector form: 1.5 times as fast as its own for complex numbers."""
    return expm1_of_parts(np.expm1(z.real), np.sin(z.imag / 2), np.cos(z.imag / 2))


def expm1_of_parts(less_one: np.ndarray, sine: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """exp(a + 2ib) - 1 from exp(a) - 1, sin b and cos b."""
    out = np.empty(sine.shape, complex)
    twice = 2 * (less_one + 1) * sine
    np.multiply(twice, cosine, out=out.imag)
    np.subtract(less_one, twice * sine, out=out.real)
    return out


def even_step(x: np.ndarray) -> float:
    """The step of positions that are even to their own rounding, 0 for others."""
    if x.size < 2:
        return 0.0
    step = float((x[-1] - x[0]) / (x.size - 1))
    off = np.max(np.abs(x - (x[0] + step * np.arange(x.size))))
    return step if off <= 4 * np.finfo(float).eps * float(np.max(np.abs(x))) else 0.0


def over_waves(k: np.ndarray, amplitudes: np.ndarray, start: float, step: float, count: int) -> np.ndarray:
    """sum_k amplitudes exp(i k (start + j step)) for j < count: (Z, count) of amplitudes (Z, n).

    `response.reference.over_waves` at even positions.
    """
    fine = math.isqrt(count - 1) + 1
    coarse = -(-count // fine)
    out = np.zeros((amplitudes.shape[0], coarse, fine), complex)
    block = max(1, BLOCK // (coarse + fine))
    for first in range(0, k.size, block):
        part = slice(first, first + block)
        ik = 1j * k[part]
        outer = np.exp(np.multiply.outer(start + step * fine * np.arange(coarse), ik))
        inner = np.exp(np.multiply.outer(ik, step * np.arange(fine)))
        for row, total in zip(amplitudes[:, part], out, strict=True):
            total += product(outer * row, inner)
    return out.reshape(amplitudes.shape[0], -1)[:, :count]


def over_positions(k: np.ndarray, weights: np.ndarray, start: float, step: float) -> np.ndarray:
    """sum_j weights_j exp(-i k (start + j step)): (n, B) of weights (J, B) and k (n,).

    `response.reference.over_positions` at even positions.
    """
    count, beams = weights.shape
    fine = math.isqrt(count - 1) + 1
    coarse = -(-count // fine)
    padded = np.zeros((coarse * fine, beams), complex)
    padded[:count] = weights
    by_fine = padded.reshape(coarse, fine, beams).swapaxes(0, 1).reshape(fine, coarse * beams)
    out = np.empty((k.size, beams), complex)
    block = max(1, BLOCK // (fine + coarse * (beams + 1)))
    for first in range(0, k.size, block):
        part = slice(first, first + block)
        ik = -1j * k[part]
        inner = product(np.exp(np.multiply.outer(ik, step * np.arange(fine))), by_fine)
        outer = np.exp(np.multiply.outer(ik, start + step * fine * np.arange(coarse)))
        out[part] = (outer[:, None, :] @ inner.reshape(-1, coarse, beams))[:, 0]
    return out
