"""Guided modes of one layer."""

from __future__ import annotations

import math

import beamprop as bp

from ..formulas import modes
from ..records import Row, Section, Tolerance, rounding
from .ask import AIR

FREQUENCY = 2500.0
K0 = 2 * math.pi * FREQUENCY / AIR[1]
BULK = AIR[0] * AIR[1] ** 2
#: The search ends where a step is below 1e-10 of k0, and roots are polished from there on.
POLISHED = rounding(10)


def of(density: float, compressibility: float, thickness: float) -> list[complex]:
    """kx of the package's modes of a layer of relative density and compressibility, largest first."""
    fluid = bp.Fluid(density * AIR[0], BULK / compressibility)
    ds = bp.guided_modes(bp.Slab.uniform(fluid, thickness, bp.Fluid(AIR[0], BULK), bp.Fluid(AIR[0], BULK)), FREQUENCY)
    return sorted(ds.kx.values, key=lambda kx: -kx.real)


def rows() -> list[Row]:
    """Dense and compressible layers, layers of negative density, both faces and one."""
    out = []
    for density, compressibility, thickness in ((5.0, 1.0, 0.05), (3.0, 1.0, 0.15), (1.0, 4.0, 0.1)):
        k = K0 * math.sqrt(density * compressibility)
        exact = modes.guided(density, k, K0, thickness)
        ours = of(density, compressibility, thickness)
        if len(ours) != len(exact):
            raise ValueError(f"modes: expected {len(exact)}, got {len(ours)}")
        for m, (a, b) in enumerate(zip(ours, exact, strict=True)):
            name = f"kx (1/m) of mode {m}, density {density:g}, compressibility {compressibility:g}, {100 * thickness:g} cm"
            out.append(Row(name, "Marcuse 1974, tan equations", a, b, POLISHED))
    for density, thickness in ((-2.0, 0.01), (-4.0, 0.02)):
        k = K0 * math.sqrt(-density)
        name = f"kx (1/m) of a layer of density {density:g}, {100 * thickness:g} cm"
        exact = sorted(modes.of_negative_density(density, k, K0, thickness), reverse=True)
        for a, b, wave in zip(of(density, 1.0, thickness), exact, ("slow", "fast"), strict=True):
            out.append(Row(f"{name}, {wave} wave", "Economou 1969", a, b, POLISHED))
    face = modes.of_a_negative_face(-2.0, 3.0, K0)
    ours = min(of(-2.0, 3.0, 0.3), key=lambda kx: abs(kx - face))
    # the waves of both faces are one root, twice, which moves by the square root of what moves the equation
    twice = Tolerance(10 * 2.0**-26, "rounding, double root", noise=True)
    out.append(Row("kx (1/m) along a face of density -2, compressibility 3", "Economou 1969", ours, face, twice))
    return out


SECTION = Section(
    "Guided modes", "Waves that a layer in air carries along, from the textbook's transcendental equations.", rows
)
