"""Functions of half a solid layer by which `solids` carries states through it: thin or thick, without cancelling where kx is beyond kT."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..media.solids import SolidLayers
from .layer import SCALE_FROM, entire

#: |a d/2|^2 and |b d/2|^2 up to which divided differences are taken by series.
THIN = 1.0
#: |kT d/2|^2 + |kx d/2|^2 up to which all functions are taken by powers of kx^2: cosh(sqrt 2) is little above 1, so that none cancel.
POLYNOMIAL = 2.0
#: kx of a frequency from which their coefficients, which take microseconds, save more than a fifth of a stack's time
#: (`experiments/benchmarks/solids.py` with COUNT kx).
MANY = 256
#: Powers that full precision takes there: 2^11/22! is below the rounding of 1.
POWERS = 11
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


class Medium(NamedTuple):
    """A layer at w, whatever kx: (F, 1) each."""

    rho: np.ndarray
    eta: np.ndarray
    compliance: np.ndarray  # w^2/mu
    stiffness: np.ndarray  # w^2/L
    coupling: np.ndarray  # 1 - 2 eta
    per_apart: np.ndarray  # 1/(1 - eta)
    shear: np.ndarray  # 2 mu/w^2
    kL2: np.ndarray
    kT2: np.ndarray
    half: np.ndarray  # of its thickness
    coefficients: np.ndarray | None  # of its functions in powers of kx^2, (F, 6, N), where these serve


class Basis(NamedTuple):
    """A layer at w and kx: what states are carried through it by."""

    medium: Medium
    kx: np.ndarray
    twice_kx: np.ndarray
    k2: np.ndarray
    lateral: np.ndarray  # -rho + 2 e rho (1 - eta)
    a2: np.ndarray
    b2: np.ndarray
    waves: Waves
    products: Products
    thin: bool  # throughout


@dataclass(frozen=True)
class Along:
    """What all layers have in common at kx (F, n)."""

    kx: np.ndarray

    @cached_property
    def twice(self) -> np.ndarray:
        """2 kx."""
        return 2 * self.kx

    @cached_property
    def k2(self) -> np.ndarray:
        """kx^2."""
        return self.kx * self.kx

    @cached_property
    def largest(self) -> float:
        """The largest |kx^2|."""
        return float(np.abs(self.k2).max(initial=0.0))

    @cached_property
    def powers(self) -> np.ndarray:
        """Powers of kx^2 over the largest: (F, POWERS, n), or (POWERS, n) of kx (n,)."""
        shape = (*self.kx.shape[:-1], POWERS, self.kx.shape[-1])
        out = np.ones(shape, complex)
        out[..., 1, :] = self.k2 / (self.largest or 1.0)
        for n in range(2, POWERS):
            np.multiply(out[..., n - 1, :], out[..., 1, :], out=out[..., n, :])
        return out


def media(
    layers: SolidLayers, part: slice, omega: np.ndarray, along: Along, share: np.ndarray | float = 1.0
) -> list[Medium]:
    """`share` of several layers at omega (F, 1): all at once, for such small arrays take as long as their calls."""
    rho, modulus, mu = (v[part][..., None] for v in layers[:3])
    modulus = np.where(np.abs(1 - mu / modulus) < APART, modulus * (1 + APART), modulus)
    half = layers.thickness[part][:, None, None] * share / 2
    w2, eta = omega * omega, mu / modulus
    compliance, stiffness, apart, square = w2 / mu, w2 / modulus, 1 - eta, half * half
    kL2, kT2 = rho * stiffness, rho * compliance
    values = (rho, eta, compliance, stiffness, 1 - 2 * eta, 1 / apart, 2 / compliance, kL2, kT2, half)
    sizes = ((np.maximum(np.abs(kL2), np.abs(kT2)) + along.largest) * square).max(axis=(1, 2), initial=0.0)
    shared = layers.thickness.size > 1  # for a plate the powers take longer than they save
    serve = (sizes < POLYNOMIAL) & shared & (along.kx.shape[-1] >= MANY)
    coefficients: list[np.ndarray | None] = [None] * len(sizes)
    if serve.any():
        u, v, largest = ((w * square)[serve] for w in (kL2, kT2, along.largest))
        for j, c in zip(np.flatnonzero(serve), _coefficients(u, v, largest, half[serve], apart[serve]), strict=True):
            coefficients[j] = c
    return [Medium._make([*(v[j] for v in values), coefficients[j]]) for j in range(len(sizes))]


def basis(m: Medium, along: Along) -> Basis:
    """A layer at kx (F, n)."""
    k2 = along.k2
    a2, b2 = m.kL2 - k2, m.kT2 - k2
    if m.coefficients is not None:
        functions = _by_powers(m.coefficients, along)
    else:
        square = m.half * m.half
        functions = _functions(a2 * square, b2 * square, m.half, 1 - m.eta, m.kT2)
    lateral = k2 * (2 * m.shear * (1 - m.eta))
    lateral -= m.rho
    return Basis(m, along.kx, along.twice, k2, lateral, a2, b2, *functions)


#: Layers that are taken at once; each of those that powers serve grows by less than 6 nepers, so that all are far from overflow.
TOGETHER = 16
#: Layers ahead among which a like one is looked for: so many are kept at most.
ALIKE = 4


def layers_back(layers: SolidLayers, omega: np.ndarray, along: Along) -> Iterator[tuple[int, Basis]]:
    """Layers from the far side on; what is made of a layer serves for its like among the next, as in a lattice."""
    keys = [tuple(v[j].tobytes() for v in layers) for j in range(layers.thickness.size)]
    made: dict[tuple, Basis] = {}
    for stop in range(len(keys), 0, -TOGETHER):
        first = max(0, stop - TOGETHER)
        of_part = media(layers, slice(first, stop), omega, along)
        for j in reversed(range(first, stop)):
            y = made.pop(keys[j]) if keys[j] in made else basis(of_part[j - first], along)
            if keys[j] in keys[max(0, j - ALIKE) : j]:
                made[keys[j]] = y
            yield j, y


def _tables() -> tuple[np.ndarray, np.ndarray]:
    """What makes, of powers of y, the coefficients in x of cos and sin/. of sqrt(y - x); and of those of two y that of their divided differences."""
    values, differences = np.zeros((POWERS, 2, POWERS)), np.zeros((POWERS, POWERS, 2, POWERS))
    for first in (0, 1):
        for m in range(POWERS):
            for k in range(POWERS - m):
                c = (-1) ** k * math.comb(m + k, m) / math.factorial(2 * (m + k) + first)
                values[k, first, m] = c
                for i in range(k):  # of y^k that of u and v is the sum of u^i v^(k - 1 - i)
                    differences[i, k - 1 - i, first, m] = c
    return values, differences


VALUES, DIFFERENCES = _tables()


def _coefficients(u: np.ndarray, v: np.ndarray, largest: np.ndarray, half: np.ndarray, apart: np.ndarray) -> np.ndarray:
    """Coefficients of `Waves` in powers of kx^2 over its largest, for J layers: (J, F, 6, N).

    `largest` is that of |kx d/2|^2, u and v are (kL d/2)^2 and (kT d/2)^2: (J, F, 1) each.
    """
    size = float((np.maximum(np.abs(u), np.abs(v)) + largest).max())
    count = next(n for n in range(2, POWERS + 1) if n == POWERS or size**n < 1e-17 * math.factorial(2 * n))
    each = np.arange(count)
    u, v, shape = u**each, v**each, (*u.shape[:2], 2, count)
    values, differences = VALUES[:count, :, :count], DIFFERENCES[:count, :count, :, :count]
    pairs = (u[..., :, None] * v[..., None, :]).reshape(*shape[:2], -1)
    p, s = ((w @ values.reshape(count, -1)).reshape(shape) for w in (u, v))
    ps = (pairs @ differences.reshape(count * count, -1)).reshape(shape) * (half * half * apart)[..., None]
    both = np.concatenate([p, s, ps], axis=2) * (largest**each)[..., None, :]
    both[..., 1::2, :] *= half[..., None]
    return both if both.imag.any() else np.ascontiguousarray(both.real)


def _by_powers(coefficients: np.ndarray, along: Along) -> tuple[Waves, Products, bool]:
    """All functions as polynomials in kx^2; a quarter of the work where there is no loss, whose coefficients are real."""
    powers = along.powers[..., : coefficients.shape[-1], :]
    real = coefficients.dtype == float
    values = (coefficients @ powers.view(float)).view(complex) if real else coefficients @ powers
    cos_p, sin_p, cos_s, sin_s, cos_ps, sin_ps = (values[:, i] for i in range(6))
    sigma = sin_ps * cos_s
    sigma -= cos_ps * sin_s
    products = Products(cos_p * cos_s, sin_p * sin_s, sin_p * cos_s, cos_p * sin_s, sigma, None)
    return Waves(cos_p, sin_p, cos_s, sin_s, cos_ps, sin_ps, None), products, True


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
