"""Solid layers: P and SV waves carried back through layers in contact, by the minors of two solutions.

In a solid the state is ``(p, X | q, T)`` with p = -s_zz, q = w^2 u_z (the p and q of a fluid), X = -i w^2 u_x and T = -i s_xz. All is
real for real kx without loss and entire in kx and w. A change of basis of determinant 1 splits a layer into two that are like fluids,
one of P and one of S waves, ::

    (p, X) = V (f1, g1),   (q, T) = W (f2, g2),   V = [[1 - e, -m], [kappa, 1]],   W = [[1, -kappa], [m, 1 - e]],

kappa = kx/rho, m = 2 kx mu/w^2, e = kappa m = 2 kx^2/kT^2. Within a layer f gains ``[[cos ad, rho S_a], [-a^2 S_a/rho, cos ad]]`` and g
``[[cos bd, b^2 S_b/rho], [-rho S_b, cos bd]]``, with a^2 = kL^2 - kx^2, b^2 = kT^2 - kx^2, S_a = sin(ad)/a.

What a far face allows is a space of two solutions. Carried back one by one they become parallel in a thick layer; their minors do not
(compound matrices: Abo-Zena 1979, Dunkin 1965). Of the six minors two are opposite, as the flux between solutions vanishes: ::

    a = pX,   b = qT,   Q = [[pq, pT], [Xq, -pq]].

Within a layer they obey a system that couples (a, b) to (q11, q12, q21) alone: with primes along z, lambda = 1 - 2 eta, eta = mu/(rho cL^2)
and y = -rho + 2 e rho (1 - eta), ::

    q11' = k (lambda a + b),   q12' = y a + rho b,   q21' = w^2/L a - w^2/mu b,
    a' = w^2/mu q12 - rho q21 - 2 k q11,   b' = -w^2/L q12 - y q21 - 2 k lambda q11,

so that (a, b)'' = H (a, b) with H = -(a^2 + b^2) + 2 [[0, b^2], [a^2, 0]], of eigenvalues -(a +- b)^2. From (a, b) at the middle of a layer, which
takes cos and sin/. of H by half of it, the values at both faces follow by symmetry. One solution goes the same way, (p, X)' = A (q, T) and
(q, T)' = B (p, X), where B A has the eigenvalues -a^2 and -b^2. Functions of matrices take divided differences of cos and sin/. between a^2 and
b^2: of their series where both waves turn by little, so that nothing cancels for kx beyond kT. Growth is taken out of products, so that nothing
cancels, however thick a layer.

Errors: rounding, times e where a layer is thick and kx beyond kT; there little passes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .solid_layer import Basis


class Minors(NamedTuple):
    """exp(log) times the minors of two solutions."""

    a: np.ndarray
    b: np.ndarray
    q11: np.ndarray
    q12: np.ndarray
    q21: np.ndarray
    log: np.ndarray


class Vector(NamedTuple):
    """exp(log) (p, X | q, T)."""

    p: np.ndarray
    X: np.ndarray
    q: np.ndarray
    T: np.ndarray
    log: np.ndarray


class Split(NamedTuple):
    """What splits the state of a medium into P and S waves."""

    kappa: np.ndarray
    m: np.ndarray
    e: np.ndarray


# --- minors ----------------------------------------------------------------------------------------------------


def of_fluid(p: np.ndarray, q: np.ndarray, log: np.ndarray) -> Minors:
    """The solutions that a fluid of the state (p, q) behind allows: p and q of the fluid, T = 0, any X."""
    zero = np.zeros_like(p)
    return Minors(p, zero, zero, zero, -q, log)


def to_fluid(minors: Minors) -> tuple[np.ndarray, np.ndarray]:
    """p and q of the one solution whose T vanishes."""
    return minors.q12, minors.b


def minors_back(far: Minors, y: Basis, sized: bool = True) -> Minors:
    """Carry minors back through a layer; their size goes into the logarithm if they are to be `sized`."""
    f, m = y.products, y.medium
    sigma = f.sigma * m.per_apart
    cosine, a_cosine, b_cosine = f.cos_cos, y.a2 * f.sin_sin, y.b2 * f.sin_sin
    a_sine, b_sine = y.a2 * sigma, y.b2 * sigma
    sine = f.cos_sin + a_sine
    a, b, q11, q12, q21, log = far
    # a' and -b'; what follows adds in place, for fresh arrays take as long as the sums
    turn = y.twice_kx * q11
    rise = m.compliance * q12
    rise -= m.rho * q21
    rise -= turn
    turn *= m.coupling
    turn += m.stiffness * q12
    turn += y.lateral * q21
    # twice a and b at the middle, about which they are even, and q11, q12 and q21 odd
    a_middle = cosine * a
    a_middle += b_cosine * b
    a_middle -= sine * rise
    a_middle += b_sine * turn
    a_middle += a_middle
    b_middle = cosine * b
    b_middle += a_cosine * a
    b_middle += sine * turn
    b_middle -= a_sine * rise
    b_middle += b_middle
    a_sum = sine * a_middle
    a_sum += b_sine * b_middle
    b_sum = sine * b_middle
    b_sum += a_sine * a_middle
    if f.growth is not None:
        a, b, q11, q12, q21 = (v * np.exp(-2 * f.growth) for v in (a, b, q11, q12, q21))
        log = log + 2 * f.growth
    near_a = cosine * a_middle
    near_a += b_cosine * b_middle
    near_a -= a
    near_b = cosine * b_middle
    near_b += a_cosine * a_middle
    near_b -= b
    q12 = q12 - y.lateral * a_sum
    q12 -= m.rho * b_sum
    q21 = q21 - m.stiffness * a_sum
    q21 += m.compliance * b_sum
    a_sum *= m.coupling
    a_sum += b_sum
    near = Minors(near_a, near_b, q11 - y.kx * a_sum, q12, q21, log)
    return normalised(near) if sized else near


def normalised(minors: Minors) -> Minors:
    """Take the size out into the logarithm."""
    scale, log = _sizes(minors[:5])
    a, b, q11, q12, q21 = (v * scale for v in minors[:5])
    return Minors(a, b, q11, q12, q21, minors.log + log)


def _sizes(values: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """What brings values to a size of 1, and the logarithm of their size."""
    size = sum(np.abs(v) for v in values)
    usual = (size > 0) & np.isfinite(size)
    size = size if usual.all() else np.where(usual, size, 1.0)
    return 1 / size, np.log(size)


def from_waves(n: tuple[np.ndarray, ...], x: np.ndarray | float, y: Split, log: np.ndarray) -> Minors:
    """Minors of N = n11, n12, n21, n22 and f1 f2."""
    n11, n12, n21, n22 = n
    one = 1 - y.e
    q11 = (one - y.e) * x - y.kappa * one * n12 + y.m * n21
    q12 = 2 * y.m * one * x + one * one * n12 + y.m * y.m * n21
    q21 = 2 * y.kappa * x - y.kappa * y.kappa * n12 - n21
    return Minors(n11, n22, q11, q12, q21, log)


# --- one solution ----------------------------------------------------------------------------------------------


def vector_back(v: Vector, y: Basis, sized: bool = True) -> Vector:
    """Carry one solution back through a layer; its size as in `minors_back`."""
    f, m, k = y.waves, y.medium, y.kx
    coupling, shear = k * m.coupling, y.k2 * m.shear
    shear -= m.rho
    p, X, q, T, log = v
    dq = coupling * X
    dq -= m.stiffness * p
    dT = coupling * p
    dT += y.lateral * X
    # B A + b^2 is of rank 1: -(1 - eta) (w^2/mu, 2 k) times (shear, -k)
    turn = f.cos_ps * _turn(shear, q, k, T)
    turn -= f.sin_ps * _turn(shear, dq, k, dT)
    # twice q and T at the middle, about which they are even, and p and X odd
    q_middle = f.cos_s * q
    q_middle -= f.sin_s * dq
    q_middle += m.compliance * turn
    q_middle += q_middle
    T_middle = f.cos_s * T
    T_middle -= f.sin_s * dT
    T_middle += y.twice_kx * turn
    T_middle += T_middle
    turn = _turn(shear, q_middle, k, T_middle)
    sine, cosine = f.sin_ps * turn, f.cos_ps * turn
    q_sum, T_sum = f.sin_s * q_middle, f.sin_s * T_middle
    q_sum += m.compliance * sine
    T_sum += y.twice_kx * sine
    if f.growth is not None:
        p, X, q, T = (c * np.exp(-2 * f.growth) for c in (p, X, q, T))
        log = log + 2 * f.growth
    q_middle *= f.cos_s
    q_middle += m.compliance * cosine
    q_middle -= q
    T_middle *= f.cos_s
    T_middle += y.twice_kx * cosine
    T_middle -= T
    p = p - m.rho * q_sum
    p += k * T_sum
    X = X - m.compliance * T_sum
    X += k * q_sum
    near = Vector(p, X, q_middle, T_middle, log)
    if not sized:
        return near
    scale, size = _sizes(near[:4])
    p, X, q, T = (c * scale for c in near[:4])
    return Vector(p, X, q, T, near.log + size)


def _turn(shear: np.ndarray, q: np.ndarray, k: np.ndarray, T: np.ndarray) -> np.ndarray:
    """shear q - k T."""
    out = shear * q
    out -= k * T
    return out


def vector_of(waves: tuple[Any, ...], y: Split, log: np.ndarray) -> Vector:
    """The state of (f1, g1 | f2, g2)."""
    (f1, g1, f2, g2), one = waves, 1 - y.e
    return Vector(one * f1 - y.m * g1, y.kappa * f1 + g1, f2 - y.kappa * g2, y.m * f2 + one * g2, log)
