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

import math
from typing import Any, NamedTuple

import numpy as np

from ..media.solids import SolidLayers
from .layer import SCALE_FROM, entire

#: |a d/2|^2 and |b d/2|^2 up to which divided differences are taken by series.
THIN = 1.0
#: |a d/2|^2 up to which a sine over its argument is taken by its series: (exp(iw) - exp(-iw))/w loses digits there.
SMALL = 0.25
#: 1 - mu/(rho cL^2) of a solid that is not stable, and has P and S waves alike, at least: what is divided by it keeps half the digits.
APART = 1e-8


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


class Waves(NamedTuple):
    """cos and sin/. of P and S waves over half a layer, and (1 - eta) times their divided differences, over exp(growth)."""

    cos_p: np.ndarray
    sin_p: np.ndarray
    cos_s: np.ndarray
    sin_s: np.ndarray
    cos_ps: np.ndarray
    sin_ps: np.ndarray
    growth: np.ndarray | None


class Products(NamedTuple):
    """Products of both waves' functions over half a layer, over exp(growth)."""

    cos_cos: np.ndarray
    sin_sin: np.ndarray
    sin_cos: np.ndarray
    cos_sin: np.ndarray
    sigma: np.ndarray  # (1 - eta) (sin_cos - cos_sin)/(a^2 - b^2)
    growth: np.ndarray | None


class Basis(NamedTuple):
    """A layer at w and kx: what states are carried through it by."""

    rho: np.ndarray
    eta: np.ndarray
    compliance: np.ndarray  # w^2/mu
    stiffness: np.ndarray  # w^2/L
    kx: np.ndarray
    e: np.ndarray
    a2: np.ndarray
    b2: np.ndarray
    waves: Waves
    products: Products
    thin: bool  # throughout


def basis(layers: SolidLayers, j: int, omega: np.ndarray, kx: np.ndarray, share: np.ndarray | float = 1.0) -> Basis:
    """`share` of layer j at omega (F, 1) and kx (F, n)."""
    rho, modulus, mu = (v[j][:, None] for v in (layers.density, layers.longitudinal_modulus, layers.shear_modulus))
    modulus = np.where(np.abs(1 - mu / modulus) < APART, modulus * (1 + APART), modulus)
    half = np.asarray(layers.thickness[j] * share) / 2
    w2, k2 = omega * omega, kx * kx
    eta, compliance = mu / modulus, w2 / mu
    kT2 = rho * compliance
    a2, b2 = w2 * rho / modulus - k2, kT2 - k2
    functions = _functions(a2 * (half * half), b2 * (half * half), half, 1 - eta, kT2)
    return Basis(rho, eta, compliance, w2 / modulus, kx, k2 * (2 / kT2), a2, b2, *functions)


def _functions(
    ua: np.ndarray, ub: np.ndarray, half: np.ndarray, apart: np.ndarray, kT2: np.ndarray
) -> tuple[Waves, Products, bool]:
    """The functions of half a layer of squared phases ua and ub, apart = 1 - eta: a^2 - b^2 = -kT^2 apart."""
    size_p, size_s = np.abs(ua), np.abs(ub)
    thin = (size_p < THIN) & (size_s < THIN)
    if thin.all():
        size = max(float(size_p.max(initial=0.0)), float(size_s.max(initial=0.0)))
        return _thin_functions(_series(ua, ub, size), half, apart, kT2)
    (cos_p, sin_p, growth_p), (cos_s, sin_s, growth_s) = _wave(ua, size_p), _wave(ub, size_s)
    sin_p, sin_s, over = sin_p * half, sin_s * half, -1 / kT2
    sin_cos, cos_sin = sin_p * cos_s, cos_p * sin_s
    products = Products(cos_p * cos_s, sin_p * sin_s, sin_cos, cos_sin, (sin_cos - cos_sin) * over, None)
    growth = None
    if growth_p is not None or growth_s is not None:
        growth_p, growth_s = (np.zeros(ua.shape) if g is None else g for g in (growth_p, growth_s))
        growth, products = np.maximum(growth_p, growth_s), products._replace(growth=growth_p + growth_s)
        p, s = np.exp(growth_p - growth), np.exp(growth_s - growth)
        cos_p, sin_p, cos_s, sin_s = p * cos_p, p * sin_p, s * cos_s, s * sin_s
    waves = Waves(cos_p, sin_p, cos_s, sin_s, (cos_p - cos_s) * over, (sin_p - sin_s) * over, growth)
    if thin.any():
        at = (np.broadcast_to(v, thin.shape)[thin] for v in (half, apart, kT2))
        calm, both, _ = _thin_functions(_series(ua[thin], ub[thin], THIN), *at)
        waves.cos_ps[thin], waves.sin_ps[thin], products.sigma[thin] = calm.cos_ps, calm.sin_ps, both.sigma
    return waves, products, False


def _wave(u: np.ndarray, size: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """exp(-growth) times cos(sqrt u) and sin(sqrt u)/sqrt u: `entire` where they grow, else by a single exponential."""
    w = np.sqrt(u) if np.isfinite(size).all() else u
    if not np.abs(w.imag).max() < SCALE_FROM:
        f = entire(u)
        return f.a + f.c, f.s, f.growth
    small = size < SMALL
    up = np.exp(1j * w)
    down = 1 / up
    w[small] = 1
    s = (up - down) / w
    s *= -0.5j
    if small.any():
        s[small] = _series(u[small], u[small], SMALL)[1]
    up += down
    up *= 0.5
    return up, s, None


def _thin_functions(
    series: tuple[np.ndarray, ...], half: np.ndarray, apart: np.ndarray, kT2: np.ndarray
) -> tuple[Waves, Products, bool]:
    cos_s, sin_s, cos_ps, sin_ps = series
    sin_s, step = half * sin_s, half * half * apart
    cos_ps, sin_ps = step * cos_ps, step * half * sin_ps
    cos_p, sin_p = cos_s - kT2 * cos_ps, sin_s - kT2 * sin_ps
    sigma = sin_ps * cos_s - cos_ps * sin_s
    products = Products(cos_p * cos_s, sin_p * sin_s, sin_p * cos_s, cos_p * sin_s, sigma, None)
    return Waves(cos_p, sin_p, cos_s, sin_s, cos_ps, sin_ps, None), products, True


def _series(u: np.ndarray, v: np.ndarray, size: float) -> tuple[np.ndarray, ...]:
    """f(v) = cos sqrt v and sin(sqrt v)/sqrt v, and (f(u) - f(v))/(u - v) of both, by their series: |u|, |v| <= size <= THIN."""
    # the first of the divided difference that is left out, over 1/2!
    count = next(n for n in range(1, 20) if 2 * (n + 1) * size**n < 3e-17 * math.factorial(2 * n + 2))
    values, differences = [], []
    for first in (0, 1):
        coefficients = [(-1) ** n / math.factorial(2 * n + first) for n in range(count + 1)]
        value, difference = coefficients[-1] * v, np.full(np.shape(v), coefficients[-1], complex)
        value += coefficients[-2]
        for c in reversed(coefficients[:-2]):
            difference *= u
            difference += value
            value *= v
            value += c
        values.append(value)
        differences.append(difference)
    return *values, *differences


# --- minors ----------------------------------------------------------------------------------------------------


def of_fluid(p: np.ndarray, q: np.ndarray, log: np.ndarray) -> Minors:
    """The solutions that a fluid of the state (p, q) behind allows: p and q of the fluid, T = 0, any X."""
    zero = np.zeros_like(p)
    return Minors(p, zero, zero, zero, -q, log)


def to_fluid(minors: Minors) -> tuple[np.ndarray, np.ndarray]:
    """p and q of the one solution whose T vanishes."""
    return minors.q12, minors.b


def minors_back(far: Minors, y: Basis) -> Minors:
    """Carry minors back through a layer."""
    f, eta, e_rho = y.products, y.eta, y.rho * y.e
    c, sigma = f.cos_cos, f.sigma * (1 / (1 - eta))
    ac, bc, a_sigma, b_sigma = y.a2 * f.sin_sin, y.b2 * f.sin_sin, y.a2 * sigma, y.b2 * sigma
    s = f.cos_sin + a_sigma
    lateral, coupling = e_rho * (2 * (1 - eta)) - y.rho, 1 - 2 * eta
    a, b, q11, q12, q21 = far[:5]
    turn = 2 * y.kx * q11
    da = y.compliance * q12 - y.rho * q21 - turn
    db = -(y.stiffness * q12 + lateral * q21 + coupling * turn)
    # twice (a, b) at the middle
    a_middle = 2 * (c * a + bc * b - s * da - b_sigma * db)
    b_middle = 2 * (c * b + ac * a - s * db - a_sigma * da)
    if f.growth is not None:
        a, b, q11, q12, q21 = (v * np.exp(-2 * f.growth) for v in (a, b, q11, q12, q21))
    a_sum, b_sum = s * a_middle + b_sigma * b_middle, s * b_middle + a_sigma * a_middle
    near = Minors(
        c * a_middle + bc * b_middle - a,
        c * b_middle + ac * a_middle - b,
        q11 - y.kx * (coupling * a_sum + b_sum),
        q12 - (lateral * a_sum + y.rho * b_sum),
        q21 - (y.stiffness * a_sum - y.compliance * b_sum),
        far.log if f.growth is None else far.log + 2 * f.growth,
    )
    return normalised(near)


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


def vector_back(v: Vector, y: Basis) -> Vector:
    """Carry one solution back through a layer."""
    f, k, coupling = y.waves, y.kx, y.kx * (1 - 2 * y.eta)
    e_rho = y.rho * y.e
    lateral, shear = e_rho * (2 * (1 - y.eta)) - y.rho, e_rho - y.rho
    p, X, q, T = v[:4]
    dq, dT = coupling * X - y.stiffness * p, coupling * p + lateral * X
    # B A + b^2 is of rank 1: -(1 - eta) (w^2/mu, 2 k) times (shear, -k)
    turn = f.cos_ps * (shear * q - k * T) - f.sin_ps * (shear * dq - k * dT)
    # twice (q, T) at the middle
    q_middle = 2 * (f.cos_s * q - f.sin_s * dq + y.compliance * turn)
    T_middle = 2 * (f.cos_s * T - f.sin_s * dT + 2 * k * turn)
    turn = shear * q_middle - k * T_middle
    cosine, sine = f.cos_ps * turn, f.sin_ps * turn
    q_sum, T_sum = f.sin_s * q_middle + y.compliance * sine, f.sin_s * T_middle + 2 * k * sine
    if f.growth is not None:
        p, X, q, T = (c * np.exp(-2 * f.growth) for c in (p, X, q, T))
    near = (
        p - (y.rho * q_sum - k * T_sum),
        X - (y.compliance * T_sum - k * q_sum),
        f.cos_s * q_middle + y.compliance * cosine - q,
        f.cos_s * T_middle + 2 * k * cosine - T,
    )
    scale, log = _sizes(near)
    log = log + v.log if f.growth is None else log + v.log + 2 * f.growth
    p, X, q, T = (c * scale for c in near)
    return Vector(p, X, q, T, log)


def vector_of(waves: tuple[Any, ...], y: Split, log: np.ndarray) -> Vector:
    """The state of (f1, g1 | f2, g2)."""
    (f1, g1, f2, g2), one = waves, 1 - y.e
    return Vector(one * f1 - y.m * g1, y.kappa * f1 + g1, f2 - y.kappa * g2, y.m * f2 + one * g2, log)
