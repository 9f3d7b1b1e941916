"""Many periods of a cell in closed form: the Bloch phase, and the power of the cell's matrix."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays.exponentials import complex_expm1
from .cell import Matrix
from .layer import State

TINY = 1e-300
#: Exponents are raised to at least this: exp(-100) is negligible beside 1, and denormal numbers take 100 times as long.
FADED = -100.0


class BlochPhase(NamedTuple):
    """Eigenvalues exp(+-i phase) of a cell matrix, Im(phase) >= 0.

    `reduced` is the phase less pi where `flip`: the eigenvalue nearest to +1 of +-M, the one that full precision is for.
    `eigenvalue` is exp(i reduced) and `less_one` exp(i reduced) - 1, both to full precision of their own size.
    """

    reduced: np.ndarray
    flip: np.ndarray
    eigenvalue: np.ndarray
    less_one: np.ndarray

    @property
    def phase(self) -> np.ndarray:
        return self.reduced + np.pi * self.flip if np.any(self.flip) else self.reduced


def bloch_phase(m: Matrix) -> BlochPhase:
    """The Bloch phase kB P from cos(kB P) = trace/2.

    With h = trace/2 - 1 = cos(phase) - 1, sin(phase) = sqrt(-h (h + 2)) gives both parts of the phase by real functions:
    the real one by its tangent, the imaginary one by ``sinh(Im phase) = Im(sin) Re(cos) - Im(cos) Re(sin)`` over
    ``cosh(Im phase)``, two terms of one sign. Nothing cancels, in a thin cell (h -> 0) or without loss. A scaled (opaque) cell
    has ``exp(-i phase) = x + sqrt(x^2 - 1)``, the larger root, with x = trace/2 taken with its growth.
    """
    h = m.e11 + m.e22
    h *= 0.5
    if m.growth is None:
        return _calm_phase(h)
    thick = np.broadcast_to(m.growth > 0, h.shape)
    calm = _calm_phase(np.where(thick, 0.0, h))
    x = m.a + h
    root = np.sqrt(x * x - np.exp(-2 * m.growth))
    larger = np.where(np.abs(x + root) >= np.abs(x - root), x + root, x - root)
    logarithm = m.growth + np.log(np.where(thick & (larger != 0), larger, 1.0))
    reduced = np.where(thick, 1j * logarithm, calm.reduced)
    eigenvalue = np.where(thick, np.exp(-logarithm), calm.eigenvalue)
    return BlochPhase(reduced, calm.flip, eigenvalue, np.where(thick, np.expm1(-logarithm), calm.less_one))


def _calm_phase(h: np.ndarray) -> BlochPhase:
    """`bloch_phase` of cells that are not scaled, from trace/2 - 1."""
    flip = h.real < -1
    h = np.where(flip, -2 - h, h)
    sine = h + 2
    sine *= h
    np.negative(sine, out=sine)
    np.sqrt(sine, out=sine)
    cosine = 1 + h.real
    sinh = sine.imag * cosine
    sinh -= h.imag * sine.real
    sinh /= np.hypot(cosine, sine.real)
    sign = np.where(sinh < 0, -1.0, 1.0)
    reduced = np.empty(h.shape, complex)
    np.multiply(np.arctan2(sine.real, cosine), sign, out=reduced.real)
    np.multiply(np.arcsinh(sinh), sign, out=reduced.imag)
    sine *= -1j * sign
    larger = sine  # 1/eigenvalue - 1: the larger of both is the one that does not cancel
    larger += h
    eigenvalue = 1 / (1 + larger)
    return BlochPhase(reduced, flip, eigenvalue, -larger * eigenvalue)


def power_back(m: Matrix, b: BlochPhase, far: State, count: np.ndarray | int) -> State:
    """Carry a state back through `count` periods, in closed form.

    With Lambda = exp(i phase), |Lambda| <= 1: ``Lambda^n M^-n = g I + f (M^-1 - I)``,
    ``g = (Lambda + Lambda^2n)/(1 + Lambda)``, ``f = Lambda (1 - Lambda^2n)/(1 - Lambda^2)`` (n at the band edge): the
    Chebyshev form of `reference.powers_back` with its growth taken out and its cancellations done by hand.
    """
    exponent = b.reduced * (2j * count)
    np.maximum(exponent.real, FADED, out=exponent.real)
    x2n = complex_expm1(exponent)
    share = x2n / (1 + b.eigenvalue)
    edge = np.abs(b.less_one) < TINY
    ratio = np.where(edge, count, share / np.where(edge, 1.0, b.less_one)) if np.any(edge) else share / b.less_one
    f = ratio * (b.eigenvalue if m.growth is None else np.exp(1j * b.reduced + m.growth))
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
