"""Waves along solids by the textbook's equations, with density, longitudinal and shear speed, in a fluid of density and speed."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

from .modes import bisect

Solid = tuple[float, float, float]


def rayleigh_of_poisson_solid() -> float:
    """Speed of Rayleigh's wave over that of shear waves for cL^2 = 3 cT^2 (Rayleigh 1885): sqrt(2 - 2/sqrt(3))."""
    return math.sqrt(2 - 2 / math.sqrt(3))


def rayleigh(solid: Solid) -> float:
    """Rayleigh's wave: x = (c/cT)^2 of x^3 - 8 x^2 + (24 - 16 m) x - 16 (1 - m) = 0, m = (cT/cL)^2 (Rayleigh 1885)."""
    m = (solid[2] / solid[1]) ** 2
    return solid[2] * math.sqrt(bisect(lambda x: x**3 - 8 * x**2 + (24 - 16 * m) * x - 16 * (1 - m), 0.0, 1.0))


def loaded_face(slowness: complex, solid: Solid, fluid: tuple[float, float], leaky: bool) -> complex:
    """0 for the wave of the face of a solid below a fluid: (2 s^2 - t^2)^2 - 4 s^2 A B + (rho_f/rho) t^4 A/F = 0.

    A, B, F are sqrt(s^2 - 1/c^2) of P, S and the fluid; into the fluid a leaky wave radiates, F = -i sqrt(1/c^2 - s^2) (Viktorov 1967).
    """
    rho, c_l, c_t = solid
    a, b = (cmath.sqrt(slowness**2 - 1 / c**2) for c in (c_l, c_t))
    f = -1j * cmath.sqrt(1 / fluid[1] ** 2 - slowness**2) if leaky else cmath.sqrt(slowness**2 - 1 / fluid[1] ** 2)
    load = fluid[0] / rho * a / f / c_t**4
    return (2 * slowness**2 - 1 / c_t**2) ** 2 - 4 * slowness**2 * a * b + load


def scholte(solid: Solid, fluid: tuple[float, float]) -> float:
    """Slowness of the Scholte wave, by bisection between the slowest body wave and a third of its speed."""
    slow = 1 / min(fluid[1], solid[2])
    return bisect(lambda s: loaded_face(s, solid, fluid, False).real, slow * (1 + 1e-12), 3 * slow)


def newton(function: Callable[[complex], complex], at: complex) -> complex:
    """The nearest zero, by Newton's method with differences."""
    for _ in range(60):
        step = 1e-6 * abs(at)
        slope = (function(at + step) - function(at - step)) / (2 * step)
        at -= function(at) / slope
    return at


def leaky_rayleigh(solid: Solid, fluid: tuple[float, float]) -> complex:
    """Slowness of the leaky Rayleigh wave, from that of Rayleigh's wave by Viktorov's formula."""
    nu = (solid[1] ** 2 / 2 - solid[2] ** 2) / (solid[1] ** 2 - solid[2] ** 2)
    return newton(lambda s: loaded_face(s, solid, fluid, True), (1 + nu) / (0.87 + 1.12 * nu) / solid[2])


def rayleigh_lamb(slowness: float, fd: float, solid: Solid, symmetric: bool) -> float:
    """0 for a wave of a free plate (Lamb 1917): 4 s^2 a b sin(A) cos(B) + (t^2 - 2 s^2)^2 cos(A) sin(B), A and B changed if antisymmetric."""
    a, b = (cmath.sqrt(1 / c**2 - slowness**2) for c in solid[1:])
    A, B = (math.pi * fd * v for v in (a, b))
    if symmetric:
        value = 4 * slowness**2 * a * b * cmath.sin(A) * cmath.cos(B) + (b**2 - slowness**2) ** 2 * cmath.cos(
            A
        ) * cmath.sin(B)
        return (value / b).real
    value = 4 * slowness**2 * a * b * cmath.cos(A) * cmath.sin(B) + (b**2 - slowness**2) ** 2 * cmath.sin(
        A
    ) * cmath.cos(B)
    return (value / a).real


def lamb(fd: float, solid: Solid) -> list[float]:
    """Slownesses of the propagating waves of a free plate, the slowest first; fd in Hz m."""
    grid = [(i + 0.5) / 4000 * 1.5 / solid[2] for i in range(4000)]
    zeros = []
    for symmetric in (True, False):
        values = [rayleigh_lamb(s, fd, solid, symmetric) for s in grid]
        pairs = zip(grid, grid[1:], values, values[1:], strict=False)
        zeros += [
            bisect(lambda s, k=symmetric: rayleigh_lamb(s, fd, solid, k), lo, hi) for lo, hi, u, v in pairs if u * v < 0
        ]
    return sorted(zeros, reverse=True)


def thin_plate(solid: Solid) -> float:
    """Speed of the symmetric wave of a thin plate: 2 cT sqrt(1 - cT^2/cL^2)."""
    return 2 * solid[2] * math.sqrt(1 - (solid[2] / solid[1]) ** 2)
