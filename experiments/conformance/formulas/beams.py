"""Beams in two dimensions: paraxial expansions, Rayleigh-Sommerfeld integrals, displacements of wide beams."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable

import numpy as np
from scipy.special import hankel1

from .layers import Fluid


def gaussian_on_axis(k: float, a: float, z: float) -> tuple[complex, complex, float]:
    """exp(-x^2/a^2) launched, at distance z on the axis: paraxial, the next term (Lax et al.), and the size of the one after it.

    exp(i kz z) = exp(i k z - i z kx^2/2k) (1 - i z kx^4/8k^3 - i z kx^6/16k^5 - z^2 kx^8/128k^6 ...), and the mean of kx^2n over
    exp(-q kx^2) is (2n - 1)!!/(2q)^n.
    """
    q = a * a / 4 + 0.5j * z / k
    paraxial = cmath.exp(1j * k * z) * a / (2 * cmath.sqrt(q))
    first = -1j * z / (8 * k**3) * 3 / (2 * q) ** 2
    second = 15 * z / (16 * k**5 * abs(2 * q) ** 3) + 105 * z**2 / (128 * k**6 * abs(2 * q) ** 4)
    return paraxial, paraxial * (1 + first), second


def gaussian_width(fwhm: float, k: float, z: float) -> tuple[float, float]:
    """FWHM sqrt(1 + (2 z/k a^2)^2) of a paraxial beam, and the relative size 1/(k a)^2 of what that leaves out."""
    a = fwhm / (2 * math.sqrt(math.log(2)))
    return fwhm * math.sqrt(1 + (2 * z / (k * a * a)) ** 2), (k * a) ** -2


def panels(low: float, high: float, count: int, order: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on `count` panels."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    edges = np.linspace(low, high, count + 1)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()


def rayleigh_sommerfeld(apertures: Iterable[tuple[float, float]], k: float, x: float, z: float) -> complex:
    """p(x, z) of unit pressure on intervals of z = 0: (i k z/2) integral H1(k r)/r dx' (first integral of Rayleigh and Sommerfeld)."""
    total = 0
    for low, high in apertures:
        s, weight = panels(low, high, 60)
        r = np.hypot(x - s, z)
        total += np.sum(weight * 0.5j * k * z * hankel1(1, k * r) / r)
    return complex(total)


def fraunhofer(width: float, separation: float, k: float, angle: float) -> float:
    """|p(angle)|/|p(0)| far behind two slits: cos(angle) sinc(k w sin/2) cos(k s sin/2)."""
    s = math.sin(math.radians(angle))
    half = k * width * s / 2
    return abs(math.cos(math.radians(angle)) * math.sin(half) / half * math.cos(k * separation * s / 2))


def total_reflection_shift(before: Fluid, after: Fluid, k: float, kx: float) -> float:
    """-d(arg r)/dkx of total reflection, arg r = -2 atan(rho1 kappa/(rho2 kz)) (Artmann 1948); fluids (density, sound speed)."""
    kz = math.sqrt(k * k - kx * kx)
    kappa = math.sqrt(kx * kx - (k * before[1] / after[1]) ** 2)
    g = before[0] * kappa / (after[0] * kz)
    slope = g * (kx / kappa**2 + kx / kz**2)
    return 2 * slope / (1 + g * g)


def mean_shift(shift: Callable[[float], float], k: float, a: float, angle: float) -> float:
    """A shift(kx), averaged over the spectrum's |S|^2 of a wide Gaussian: exact for beams that are reflected totally."""
    middle = k * math.sin(math.radians(angle))
    s, weight = panels(-6, 6, 8)
    kx = middle + s / a
    share = weight * np.exp(-(s**2) / 2)
    return sum(w * shift(v) for w, v in zip(share, kx, strict=True)) / np.sum(share)
