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

In the basis above a layer is ``N -> F_P^-1 N F_S^-T`` for N = [[f1 g1, f1 g2], [f2 g1, f2 g2]], and f1 f2 stays as it is: growth is taken
out of products, so that nothing cancels, however thick a layer. Where both waves turn by little over a layer and kx is beyond kT the change of
basis cancels instead; there the layer's 4 x 4 matrix less 1 is formed from divided differences of its entire functions.

Errors: rounding, times e where a layer is thick and kx beyond kT; there little passes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..media.solids import SolidLayers
from .layer import entire

#: |a d|^2 and |b d|^2 up to which a layer is taken by divided differences: their series are exact there.
THIN = 4.0


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


class Basis(NamedTuple):
    """A layer at w and kx: what its matrix is made of."""

    rho: np.ndarray
    kappa: np.ndarray
    m: np.ndarray
    e: np.ndarray
    a2: np.ndarray
    b2: np.ndarray
    slowness2: np.ndarray  # kL^2/kT^2
    kT2: np.ndarray
    kx: np.ndarray
    d: np.ndarray
    cos_p: np.ndarray
    sin_p: np.ndarray  # S_a, over exp(growth_p)
    cos_s: np.ndarray
    sin_s: np.ndarray
    growth_p: np.ndarray
    growth_s: np.ndarray
    calm_p: np.ndarray  # cos - 1, where nothing grows
    calm_s: np.ndarray
    thin: np.ndarray
    less: Less | None  # its matrix less 1, where some of it is thin


def basis(layers: SolidLayers, j: int, omega: np.ndarray, kx: np.ndarray, share: np.ndarray | float = 1.0) -> Basis:
    """`share` of layer j at omega (F, 1) and kx (F, n)."""
    rho, modulus, mu = (v[j][:, None] for v in (layers.density, layers.longitudinal_modulus, layers.shear_modulus))
    d = np.asarray(layers.thickness[j] * share)
    w2, k2 = omega * omega, kx * kx
    kT2 = w2 * rho / mu
    a2, b2 = w2 * rho / modulus - k2, kT2 - k2
    ua, ub = a2 * d * d, b2 * d * d
    p, s = entire(ua), entire(ub)
    m, kappa = 2 * kx * mu / w2, kx / rho
    gp, gs = (np.zeros(ua.shape) if f.growth is None else f.growth for f in (p, s))
    thin = (np.abs(ua) < THIN) & (np.abs(ub) < THIN)
    y = Basis(
        rho, kappa, m, kappa * m, a2, b2, mu / modulus, kT2, kx, d, p.a + p.c, d * p.s, s.a + s.c, d * s.s, gp, gs, p.c, s.c, thin, None
    )  # fmt: skip
    return y._replace(less=less_one(y)) if thin.any() else y


# --- minors ----------------------------------------------------------------------------------------------------


def of_fluid(p: np.ndarray, q: np.ndarray, log: np.ndarray) -> Minors:
    """The solutions that a fluid of the state (p, q) behind allows: p and q of the fluid, T = 0, any X."""
    zero = np.zeros_like(p)
    return Minors(p, zero, zero, zero, -q, log)


def to_fluid(minors: Minors) -> tuple[np.ndarray, np.ndarray]:
    """p and q of the one solution whose T vanishes."""
    return minors.q12, minors.b


def minors_back(far: Minors, layer: Basis) -> Minors:
    """Carry minors back through a layer."""
    if layer.thin.all():
        return normalised(_thin_back(far, layer))
    thick = _thick_back(far, layer)
    if layer.thin.any():
        thin = _thin_back(far, layer)
        thick = Minors(*(np.where(layer.thin, x, y) for x, y in zip(thin, thick, strict=True)))
    return normalised(thick)


def normalised(minors: Minors) -> Minors:
    """Take the size out into the logarithm."""
    size = sum(np.abs(v) for v in minors[:5])
    usual = (size > 0) & np.isfinite(size)
    size = size if usual.all() else np.where(usual, size, 1.0)
    a, b, q11, q12, q21 = (v / size for v in minors[:5])
    return Minors(a, b, q11, q12, q21, minors.log + np.log(size))


def _thick_back(far: Minors, y: Basis) -> Minors:
    n11, n12, n21, n22, x = _to_waves(far, y)
    pa, pc = y.rho * y.sin_p, y.a2 / y.rho * y.sin_p
    n11, n21 = y.cos_p * n11 - pa * n21, pc * n11 + y.cos_p * n21
    n12, n22 = y.cos_p * n12 - pa * n22, pc * n12 + y.cos_p * n22
    sa, sb = y.b2 / y.rho * y.sin_s, y.rho * y.sin_s
    n11, n12 = y.cos_s * n11 - sa * n12, sb * n11 + y.cos_s * n12
    n21, n22 = y.cos_s * n21 - sa * n22, sb * n21 + y.cos_s * n22
    growth = y.growth_p + y.growth_s
    return from_waves((n11, n12, n21, n22), x * np.exp(-growth), y, far.log + growth)


def _to_waves(f: Minors, y: Basis) -> tuple[np.ndarray, ...]:
    """N and f1 f2 of minors."""
    one = 1 - y.e
    x = (one - y.e) * f.q11 + y.kappa * f.q12 + y.m * one * f.q21
    n12 = f.q12 - 2 * y.m * f.q11 - y.m * y.m * f.q21
    n21 = 2 * y.kappa * one * f.q11 + y.kappa * y.kappa * f.q12 - one * one * f.q21
    return f.a, n12, n21, f.b, x


def from_waves(n: tuple[np.ndarray, ...], x: np.ndarray | float, y: Basis | Split, log: np.ndarray) -> Minors:
    """Minors of N = n11, n12, n21, n22 and f1 f2."""
    n11, n12, n21, n22 = n
    one = 1 - y.e
    q11 = (one - y.e) * x - y.kappa * one * n12 + y.m * n21
    q12 = 2 * y.m * one * x + one * one * n12 + y.m * y.m * n21
    q21 = 2 * y.kappa * x - y.kappa * y.kappa * n12 - n21
    return Minors(n11, n22, q11, q12, q21, log)


# --- the 4 x 4 matrix ------------------------------------------------------------------------------------------


class Less(NamedTuple):
    """The matrix of a layer, near to far face, less 1: blocks (p X, p X), (p X, q T), (q T, p X), (q T, q T), each [11, 12, 21, 22].

    (q T, q T) is the transpose of (p X, p X) with its signs as in W.
    """

    pp: tuple[np.ndarray, ...]
    pq: tuple[np.ndarray, ...]
    qp: tuple[np.ndarray, ...]
    qq: tuple[np.ndarray, ...]


def less_one(y: Basis) -> Less:
    """The matrix less 1 where a layer is thin: from divided differences, so that nothing cancels for kx beyond kT."""
    ua, ub = (v * (y.d * y.d) for v in (y.a2, y.b2))
    if not y.thin.all():
        ua, ub = np.where(y.thin, ua, 0.0), np.where(y.thin, ub, 0.0)
    cosines, sines = _divided_differences(ua, ub)
    # (a^2 - b^2) d^2 = -kT^2 d^2 (1 - kL^2/kT^2), so that what is divided by kT^2 needs no division
    d2 = y.d * y.d * (y.slowness2 - 1)
    dc, ds = d2 * cosines, d2 * y.d * sines  # (cos ad - cos bd)/kT^2, (S_a - S_b)/kT^2
    k, e, rho, sa, sb = y.kx, y.e, y.rho, y.sin_p, y.sin_s
    k2 = k * k
    full, part = y.kT2 * dc, 2 * k2 * dc  # cos ad - cos bd, and e times it
    first, last = y.calm_s + (full - part), y.calm_s + part
    shear, turn = 2 * rho * k * dc * (1 - e), y.kappa * full
    slow, k2ds = y.slowness2 * sa, k2 * ds
    pq12 = k * (y.kT2 * ds - 2 * k2ds - sb)
    pq = (rho * (sa - 2 * (2 - e) * k2ds), pq12, pq12, y.kT2 / rho * (sb + k2ds))
    # e^2 (S_a - S_b) = 2 k^2 e ds;  kL^2 S_a = kL^2/kT^2 kT^2 S_a
    qp12 = k * (sb - 2 * (slow - k2ds))
    qp = (-y.kT2 / rho * (slow - k2ds), qp12, qp12, -rho * (sb + 2 * e * (slow - sb - k2ds)))
    return Less((first, shear, turn, last), pq, qp, (first, turn, shear, last))


def _divided_differences(u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(cos sqrt u - cos sqrt v)/(u - v) and the same of sin(sqrt u)/sqrt u, by their series: |u|, |v| < THIN."""
    size = float(max(np.max(np.abs(u), initial=0.0), np.max(np.abs(v), initial=0.0)))
    count, last = 3, size * size / 360  # 2 u/4! and 3 u^2/6! are in, over the first one, 1/2!
    while last > 1e-17 and count < 14:
        count += 1
        last *= 1.5 * size / ((2 * count - 1) * 2 * count)
    out = []
    for first in (0, 1):
        coefficient, coefficients = 1.0, [1.0]
        for n in range(1, count + 1):
            coefficient *= -1.0 / ((2 * n - 1 + first) * (2 * n + first))
            coefficients.append(coefficient)
        difference: np.ndarray = np.array(coefficients[-1])
        value = difference * v + coefficients[-2]
        for c in reversed(coefficients[:-2]):
            difference = difference * u + value
            value = value * v + c
        out.append(difference)
    return out[0], out[1]


def _thin_back(far: Minors, y: Basis) -> Minors:
    """P + E P + P E^T + E P E^T for P the antisymmetric matrix of minors and E the matrix back less 1."""
    assert y.less is not None
    (A11, A12, A21, A22), (B11, B12, _, B22), (C11, C12, _, C22), _ = y.less
    a, b, q11, q12, q21 = far[:5]
    # the matrix back less 1 is [[A, -B], [-C, A^T]], that of minors [[a J, Q], [-Q^T, b J]], J = [[0, 1], [-1, 0]]; of E P
    # the rows 0, 1 and 2 and two entries of the last
    e00, e01 = B11 * q11 + B12 * q12 - A12 * a, A11 * a + B11 * q21 - B12 * q11
    e02, e03 = A11 * q11 + A12 * q21 + B12 * b, A11 * q12 - A12 * q11 - B11 * b
    e10, e11 = B12 * q11 + B22 * q12 - A22 * a, A21 * a + B12 * q21 - B22 * q11
    e12, e13 = A21 * q11 + A22 * q21 + B22 * b, A21 * q12 - A22 * q11 - B12 * b
    e20, e21 = C12 * a - A11 * q11 - A21 * q12, A21 * q11 - C11 * a - A11 * q21
    e22, e23 = -C11 * q11 - C12 * q21 - A21 * b, C12 * q11 - C11 * q12 + A11 * b
    e30, e32 = C22 * a - A12 * q11 - A22 * q12, -C12 * q11 - C22 * q21 - A22 * b
    # P E^T = -(E P)^T
    return Minors(
        a + (e01 - e10 + (e00 * A21 + e01 * A22 - e02 * B12 - e03 * B22)),
        b + (e23 - e32 + (e22 * A12 + e23 * A22 - e20 * C12 - e21 * C22)),
        q11 + (e02 - e20 + (e02 * A11 + e03 * A21 - e00 * C11 - e01 * C12)),
        q12 + (e03 - e30 + (e02 * A12 + e03 * A22 - e00 * C12 - e01 * C22)),
        q21 + (e12 - e21 + (e12 * A11 + e13 * A21 - e10 * C11 - e11 * C12)),
        far.log,
    )


# --- one solution ----------------------------------------------------------------------------------------------


def vector_back(v: Vector, y: Basis) -> Vector:
    """Carry one solution back through a layer."""
    return _carried(v, y, -1.0)


def _carried(v: Vector, y: Basis, way: float) -> Vector:
    thick = None if y.thin.all() else _thick_vector(v, y, way)
    if not y.thin.any():
        assert thick is not None
        return _vector_normalised(thick)
    f = y.less
    assert f is not None
    p = v.p + (f.pp[0] * v.p + f.pp[1] * v.X + way * (f.pq[0] * v.q + f.pq[1] * v.T))
    X = v.X + (f.pp[2] * v.p + f.pp[3] * v.X + way * (f.pq[2] * v.q + f.pq[3] * v.T))
    q = v.q + (f.qq[0] * v.q + f.qq[1] * v.T + way * (f.qp[0] * v.p + f.qp[1] * v.X))
    T = v.T + (f.qq[2] * v.q + f.qq[3] * v.T + way * (f.qp[2] * v.p + f.qp[3] * v.X))
    thin = Vector(p, X, q, T, v.log + 0 * y.growth_p)
    if thick is None:
        return _vector_normalised(thin)
    return _vector_normalised(Vector(*(np.where(y.thin, a, b) for a, b in zip(thin, thick, strict=True))))


def _thick_vector(v: Vector, y: Basis, way: float) -> Vector:
    one = 1 - y.e
    f1, g1 = v.p + y.m * v.X, one * v.X - y.kappa * v.p
    f2, g2 = one * v.q + y.kappa * v.T, v.T - y.m * v.q
    growth = np.maximum(y.growth_p, y.growth_s)
    P, S = np.exp(y.growth_p - growth), np.exp(y.growth_s - growth)
    sp, ss = way * y.sin_p, way * y.sin_s
    f1, f2 = P * (y.cos_p * f1 + y.rho * sp * f2), P * (y.cos_p * f2 - y.a2 / y.rho * sp * f1)
    g1, g2 = S * (y.cos_s * g1 + y.b2 / y.rho * ss * g2), S * (y.cos_s * g2 - y.rho * ss * g1)
    return vector_of((f1, g1, f2, g2), y, v.log + growth)


def vector_of(waves: tuple[Any, ...], y: Basis | Split, log: np.ndarray) -> Vector:
    """The state of (f1, g1 | f2, g2)."""
    (f1, g1, f2, g2), one = waves, 1 - y.e
    return Vector(one * f1 - y.m * g1, y.kappa * f1 + g1, f2 - y.kappa * g2, y.m * f2 + one * g2, log)


def _vector_normalised(v: Vector) -> Vector:
    size = sum(np.abs(c) for c in v[:4])
    usual = (size > 0) & np.isfinite(size)
    size = size if usual.all() else np.where(usual, size, 1.0)
    return Vector(v.p / size, v.X / size, v.q / size, v.T / size, v.log + np.log(size))
