"""Functions of half a solid layer by which `solids` carries states through it: thin or thick, without cancelling where kx is beyond kT."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..media.solids import SolidLayers
from .layer import SCALE_FROM, entire

#: |a d/2|^2 and |b d/2|^2 up to which divided differences are taken by series.
THIN = 1.0
#: |a d/2|^2 up to which a sine over its argument is taken by its series: (exp(iw) - exp(-iw))/w loses digits there.
SMALL = 0.25
#: 1 - mu/(rho cL^2) of a solid that is not stable, and has P and S waves alike, at least: what is divided by it keeps half the digits.
APART = 1e-8


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
    twice_kx: np.ndarray
    k2: np.ndarray
    lateral: np.ndarray  # -rho + 2 e rho (1 - eta)
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
    lateral = k2 * (4 * (1 - eta) / compliance)
    lateral -= rho
    return Basis(rho, eta, compliance, w2 / modulus, kx, 2 * kx, k2, lateral, a2, b2, *functions)


def _functions(
    ua: np.ndarray, ub: np.ndarray, half: np.ndarray, apart: np.ndarray, kT2: np.ndarray
) -> tuple[Waves, Products, bool]:
    """The functions of half a layer of squared phases ua and ub, apart = 1 - eta: a^2 - b^2 = -kT^2 apart."""
    size_p, size_s = np.abs(ua), np.abs(ub)
    size = max(float(size_p.max(initial=0.0)), float(size_s.max(initial=0.0)))
    if size < THIN:
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
    thin = (size_p < THIN) & (size_s < THIN)
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
