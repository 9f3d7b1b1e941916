"""Many periods of a cell in closed form: the Bloch phase, and the power of the cell's matrix."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .cell import Matrix
from .layer import State

TINY = 1e-300


class BlochPhase(NamedTuple):
    """Eigenvalues exp(+-i phase) of a cell matrix, Im(phase) >= 0.

    `reduced` is the phase less pi where `flip`: the eigenvalue nearest to +1 of +-M, the one that full precision is for.
    """

    reduced: np.ndarray
    flip: np.ndarray

    @property
    def phase(self) -> np.ndarray:
        return self.reduced + np.pi * self.flip if np.any(self.flip) else self.reduced


def bloch_phase(m: Matrix) -> BlochPhase:
    """The Bloch phase kB P from cos(kB P) = trace/2.

    ``sin(phase/2)^2 = -(trace/2 - 1)/2`` keeps full precision for thin cells; a scaled (opaque) cell has
    ``exp(-i phase) = x + sqrt(x^2 - 1)``, the larger root, with x = trace/2 taken with its growth.
    """
    h = m.e11 + m.e22
    h *= 0.5
    thick = np.zeros(h.shape, bool) if m.growth is None else np.broadcast_to(m.growth > 0, h.shape)
    calm = np.where(thick, 0.0, h) if m.growth is not None else h
    flip = ~thick & (calm.real < -1)
    reduced = 2 * np.arcsin(np.sqrt(np.where(flip, 2 + calm, -calm) / 2))
    reduced = np.where(reduced.imag < 0, -reduced, reduced)
    if m.growth is not None:
        x = m.a + h
        root = np.sqrt(x * x - np.exp(-2 * m.growth))
        larger = np.where(np.abs(x + root) >= np.abs(x - root), x + root, x - root)
        logarithm = m.growth + np.log(np.where(thick & (larger != 0), larger, 1.0))
        reduced = np.where(thick, 1j * logarithm, reduced)
    return BlochPhase(reduced, flip)


def faded(exponent: np.ndarray) -> np.ndarray:
    """Exponents raised to at least -100, in place: exp(-100) is negligible beside 1, and denormal numbers take 100 times as long."""
    np.maximum(exponent.real, -100.0, out=exponent.real)
    return exponent


def power_back(m: Matrix, b: BlochPhase, far: State, count: np.ndarray | int) -> State:
    """Carry a state back through `count` periods, in closed form.

    With Lambda = exp(i phase), |Lambda| <= 1: ``Lambda^n M^-n = g I + f (M^-1 - I)``,
    ``g = (Lambda + Lambda^2n)/(1 + Lambda)``, ``f = Lambda (1 - Lambda^2n)/(1 - Lambda^2)`` (n at the band edge): the
    Chebyshev form of `reference.powers_back` with its growth taken out and its cancellations done by hand.
    """
    z = 1j * b.reduced
    lam, x = np.exp(z), np.expm1(z)
    x2n = np.expm1(faded(z * (2 * count)))
    share = x2n / (1 + lam)
    edge = np.abs(x) < TINY
    ratio = np.where(edge, count, share / np.where(edge, 1.0, x)) if np.any(edge) else share / x
    f = ratio * (lam if m.growth is None else np.exp(z + m.growth))
    # f is kept multiplied by exp(growth), because E is kept divided by it
    p, q = m.e22 * far.p, m.e11 * far.q
    p -= m.e12 * far.q
    q -= m.e21 * far.p
    if np.any(b.flip):
        sign, twice = np.where(b.flip, -1.0, 1.0), np.where(b.flip, 2.0, 0.0)
        p, q = sign * p - twice * far.p, sign * q - twice * far.q
    g = 1 + share
    p, q = f * p, f * q
    p += g * far.p
    q += g * far.q
    return State(p, q, far.log - 1j * b.phase * count)
