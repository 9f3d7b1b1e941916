"""Plane waves at faces, layers, sheets and stacks of fluids (density, sound speed); densities and speeds may be complex."""

from __future__ import annotations

import cmath
import math

#: Density and sound speed.
Fluid = tuple[complex, complex]


def along_z(fluid: Fluid, w: float, kx: float) -> complex:
    """kz of a wave that goes or decays along +z."""
    k = w / complex(fluid[1])
    return cmath.sqrt(k * k - kx * kx)


def impedance(fluid: Fluid, w: float, kx: float) -> complex:
    """w rho / kz: Z / cos(angle)."""
    return w * fluid[0] / along_z(fluid, w, kx)


def face(before: Fluid, after: Fluid, w: float, kx: float) -> complex:
    """Reflection by a face: (Z2 - Z1) / (Z2 + Z1) (Rayleigh, section 270)."""
    z1, z2 = impedance(before, w, kx), impedance(after, w, kx)
    return (z2 - z1) / (z2 + z1)


def face_by_angle(before: Fluid, after: Fluid, angle: float) -> complex:
    """The same by Snell's law: (m cos a - sqrt(n^2 - sin^2 a)) / (m cos a + sqrt(n^2 - sin^2 a)) (Brekhovskikh)."""
    m, n = after[0] / before[0], before[1] / after[1]
    a = math.radians(angle)
    root = cmath.sqrt(n * n - math.sin(a) ** 2)
    return (m * math.cos(a) - root) / (m * math.cos(a) + root)


def intromission_angle(before: Fluid, after: Fluid) -> float:
    """Where nothing is reflected: sin^2 = (m^2 - n^2) / (m^2 - 1), degrees (Brekhovskikh)."""
    m, n = after[0] / before[0], before[1] / after[1]
    return math.degrees(math.asin(math.sqrt((m * m - n * n) / (m * m - 1))))


def layer(before: Fluid, fluid: Fluid, after: Fluid, w: float, kx: float, thickness: float) -> tuple[complex, complex]:
    """r by the input impedance of a layer (Brekhovskikh), t by summing the waves that go to and fro (Airy)."""
    z1, z2, z3 = (impedance(medium, w, kx) for medium in (before, fluid, after))
    phase = along_z(fluid, w, kx) * thickness
    tangent = cmath.tan(phase)
    entrance = z2 * (z3 - 1j * z2 * tangent) / (z2 - 1j * z3 * tangent)
    r12, r23 = face(before, fluid, w, kx), face(fluid, after, w, kx)
    t = 2 * z2 / (z1 + z2) * 2 * z3 / (z2 + z3) * cmath.exp(1j * phase) / (1 + r12 * r23 * cmath.exp(2j * phase))
    return (entrance - z1) / (entrance + z1), t


def airy(reflectivity: float, phase: float) -> float:
    """Transmitted share of energy of a lossless layer: 1 / (1 + F sin^2 phase), F = 4R/(1 - R)^2 (Born and Wolf 7.6.1)."""
    return 1 / (1 + 4 * reflectivity / (1 - reflectivity) ** 2 * math.sin(phase) ** 2)


def sheet(mass: float, fluid: Fluid, w: float, kx: float) -> complex:
    """Transmission of a limp sheet: 1 / (1 - i w m / 2Z) (mass law)."""
    return 1 / (1 - 1j * w * mass / (2 * impedance(fluid, w, kx)))


def double_wall(mass: float, gap: float, fluid: Fluid, w: float, kx: float) -> complex:
    """Two limp sheets with fluid between them (London): 1 / (1 + 2b + b^2 (1 - e^(2 i kz d))), b = -i w m / 2Z, times e^(i kz d)."""
    b, phase = -1j * w * mass / (2 * impedance(fluid, w, kx)), along_z(fluid, w, kx) * gap
    return cmath.exp(1j * phase) / (1 + 2 * b + b * b * (1 - cmath.exp(2j * phase)))


def negative_slab_transfer(density: complex, kx: float, thickness: float) -> float:
    """|p behind| e^(-kx d) / |p launched| of a slab of relative density, kx far above k0 (Pendry's quasi-static limit)."""
    decay = cmath.exp(-kx * thickness)
    return abs(4 * density * decay**2 / ((density + 1) ** 2 - (density - 1) ** 2 * decay**2))
