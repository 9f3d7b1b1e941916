"""Modes of one fluid layer between two half-spaces of another, by bisection of their textbook equations."""

from __future__ import annotations

import math
from collections.abc import Callable


def bisect(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that changes sign once does so, to the last bit."""
    rising = function(high) > 0
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (low, middle) if (function(middle) > 0) == rising else (middle, high)
    return (low + high) / 2


def guided(density: float, k: float, k0: float, thickness: float) -> list[float]:
    """kx of all modes of a layer of relative density and wavenumber k > k0, the slowest first.

    Even ones: tan(kz d/2) = rho kappa/kz, odd ones: -cot(kz d/2) = rho kappa/kz (Marcuse): kz d = m pi + 2 atan(rho kappa/kz).
    """

    def phase(kx: float) -> float:
        kz, kappa = math.sqrt(k * k - kx * kx), math.sqrt(kx * kx - k0 * k0)
        return kz * thickness - 2 * math.atan2(density * kappa, kz)

    count = 1 + int(math.sqrt(k * k - k0 * k0) * thickness / math.pi)
    return [bisect(lambda kx, m=m: phase(kx) - m * math.pi, k0, k) for m in range(count)]


def of_negative_density(density: float, k: float, k0: float, thickness: float) -> list[float]:
    """kx of the even and the odd wave along both faces of a layer of negative relative density (Economou).

    kappa1/|rho| tanh(kappa1 d/2) = kappa, and the same with coth; kappa1 inside, kappa outside.
    """

    def equation(kx: float, sign: int) -> float:
        inside, outside = math.sqrt(kx * kx + k * k), math.sqrt(kx * kx - k0 * k0)
        return inside / abs(density) * math.tanh(inside * thickness / 2) ** sign - outside

    return [bisect(lambda kx, s=s: equation(kx, s), k0, 60 * k0) for s in (1, -1)]


def of_a_negative_face(density: float, slowness: float, k0: float) -> float:
    """kx of the wave along one face: kappa + kappa1/rho = 0, of relative density and compressibility."""
    return k0 * math.sqrt((1 - slowness / density) / (1 - 1 / density**2))
