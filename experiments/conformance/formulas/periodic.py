"""Laminates of two fluids (density, sound speed), and layers that repeat."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

from .layers import Fluid, along_z, impedance

Matrix = tuple[tuple[complex, complex], tuple[complex, complex]]


def rytov_cosine(first: Fluid, second: Fluid, thicknesses: tuple[float, float], w: float, kx: float) -> complex:
    """cos(K P) = cos a cos b - (Z1/Z2 + Z2/Z1)/2 sin a sin b (Rytov 1956)."""
    a, b = (along_z(fluid, w, kx) * d for fluid, d in zip((first, second), thicknesses, strict=True))
    ratio = impedance(first, w, kx) / impedance(second, w, kx)
    return cmath.cos(a) * cmath.cos(b) - (ratio + 1 / ratio) / 2 * cmath.sin(a) * cmath.sin(b)


def stack(
    first: Fluid, second: Fluid, thicknesses: tuple[float, float], periods: int, around: Fluid, w: float, kx: float
) -> tuple[complex, complex]:
    """r and t of periods between half-spaces: the cell's matrix, its power by Chebyshev polynomials (Abeles; Born and Wolf 1.6.5)."""
    m = ((1, 0), (0, 1))
    for fluid, d in zip((first, second), thicknesses, strict=True):
        phase, z = along_z(fluid, w, kx) * d, impedance(fluid, w, kx)
        c, s = cmath.cos(phase), cmath.sin(phase)
        # (p, v) on the near side from those on the far side
        m = product(m, ((c, -1j * z * s), (-1j * s / z, c)))
    half_trace = (m[0][0] + m[1][1]) / 2
    phi = cmath.acos(half_trace)
    u1, u2 = (cmath.sin((periods - k) * phi) / cmath.sin(phi) for k in (0, 1))
    (a, b), (c, d) = ([m[i][j] * u1 - (i == j) * u2 for j in (0, 1)] for i in (0, 1))
    z = impedance(around, w, kx)
    sums = a + b / z + z * c + d
    return (a + b / z - z * c - d) / sums, 2 / sums


def product(m: Matrix, n: Matrix) -> Matrix:
    """Of two 2 x 2 matrices."""
    return tuple(tuple(sum(m[i][k] * n[k][j] for k in (0, 1)) for j in (0, 1)) for i in (0, 1))


def quarter_wave_mirror(around: Fluid, first: Fluid, second: Fluid, periods: int) -> float:
    """Reflectivity of quarter-wave pairs: ((Z0 - Y)/(Z0 + Y))^2, Y = Z0 (Z1/Z2)^(2N) (Born and Wolf 1.6.5)."""
    z1, z2 = (fluid[0] * fluid[1] for fluid in (first, second))
    q = (z1 / z2) ** (2 * periods)
    return ((1 - q) / (1 + q)) ** 2


def quarter_wave_gap(first: Fluid, second: Fluid, centre: float) -> tuple[float, float]:
    """Edges of the stop band of quarter-wave pairs: centre (1 -+ (2/pi) asin |Z1 - Z2|/(Z1 + Z2))."""
    z1, z2 = (fluid[0] * fluid[1] for fluid in (first, second))
    half = 2 / math.pi * math.asin(abs(z1 - z2) / (z1 + z2))
    return centre * (1 - half), centre * (1 + half)


def mean_medium(
    first: Fluid, second: Fluid, thicknesses: tuple[float, float], w: float, kx: float
) -> tuple[complex, float]:
    """kz of infinitely thin layers, <rho> (w^2 <1/K> - kx^2 <1/rho>) (Rytov 1956), and the phase |kz| d across both as they are."""

    def mean(property_of: Callable[[Fluid], complex]) -> complex:
        terms = (property_of(fluid) * d for fluid, d in zip((first, second), thicknesses, strict=True))
        return sum(terms) / sum(thicknesses)

    squared = w * w * mean(lambda f: 1 / (f[0] * f[1] ** 2)) - kx * kx * mean(lambda f: 1 / f[0])
    phase = sum(abs(along_z(fluid, w, kx)) * d for fluid, d in zip((first, second), thicknesses, strict=True))
    return cmath.sqrt(mean(lambda f: f[0]) * squared), phase


def staircase_sum(layers: int, orders: int = 4000) -> float:
    """2 sum |b_n|^2 / n^2 of the paper's staircase of a cosine: |b_n| = sin(pi n/N)/(2 pi n/N) for n = +-1 mod N, 0 otherwise."""
    terms = (
        (math.sin(math.pi * n / layers) / (2 * math.pi * n / layers)) ** 2 / n**2
        for m in range(orders)
        for n in ((1,) if m == 0 else (m * layers - 1, m * layers + 1))
    )
    return 2 * math.fsum(terms)


def paper_transmissivity(rho_eff: complex, angle: float, k0_length: float) -> float:
    """The paper's Eq. (11) with its F for the relative density and k0 L."""
    kz, a = cmath.sqrt(rho_eff), cmath.sqrt(rho_eff) * math.cos(math.radians(angle))
    return abs(cmath.cos(kz * k0_length) - 0.5j * (a + 1 / a) * cmath.sin(kz * k0_length)) ** -2
