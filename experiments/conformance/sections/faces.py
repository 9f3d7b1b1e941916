"""One face between two fluids."""

from __future__ import annotations

import cmath
import math

from scipy.optimize import brentq

import beamprop as bp

from ..formulas import layers
from ..records import Row, Section, rounding
from .ask import AIR, BRAIN, OIL, STEEL, WATER, fluid, name_of, plane_wave

RAYLEIGH = "Rayleigh 1896, section 270"
SNELL = "Brekhovskikh 1980"


def reflection(before: tuple, after: tuple, angle: float) -> complex:
    """r of a face."""
    return plane_wave(bp.Slab.interface(fluid(before), fluid(after)), 1e6, angle=angle)[0]


def intromission(before: tuple, after: tuple) -> float:
    """The angle, below the critical one, at which the package's r changes sign."""
    critical = math.degrees(math.asin(min(before[1] / after[1], 1.0)))
    return brentq(lambda angle: reflection(before, after, angle).real, 1.0, 0.999 * critical, xtol=1e-13)


def rows() -> list[Row]:
    """Coefficients below and beyond the critical angle, angles without reflection, shares of energy."""
    pairs = ((WATER, STEEL), (STEEL, WATER), (WATER, OIL), (AIR, WATER), (BRAIN, WATER))
    out = []
    for before, after in pairs:
        name = f"r of {name_of(before)} to {name_of(after)}"
        w = 2e6 * math.pi
        out.append(
            Row(
                f"{name}, 0°",
                RAYLEIGH,
                reflection(before, after, 0.0),
                layers.face(before, after, w, 0.0),
                rounding(),
            )
        )
        for angle in (10.0, 40.0, 80.0):
            exact = layers.face_by_angle(before, after, angle)
            out.append(Row(f"{name}, {angle:g}°", SNELL, reflection(before, after, angle), exact, rounding(), scale=1))
    for before, after in ((WATER, (500.0, 1700.0)), ((1000.0, 1500.0), (1500.0, 1200.0)), (OIL, (700.0, 1400.0))):
        name = f"angle of intromission (degree), {name_of(before)} to {name_of(after)}"
        out.append(Row(name, SNELL, intromission(before, after), layers.intromission_angle(before, after), rounding()))
    for before, after in ((WATER, STEEL), (AIR, WATER), (OIL, STEEL)):
        slab = bp.Slab.interface(fluid(before), fluid(after))
        energy = float(bp.scattering(slab, 1e6, angle=0.0).energy_transmission)
        z1, z2 = before[0] * before[1], after[0] * after[1]
        name = f"share of energy through {name_of(before)} to {name_of(after)}, 0°"
        out.append(Row(name, "Rayleigh 1896, 4 Z1 Z2/(Z1 + Z2)²", energy, 4 * z1 * z2 / (z1 + z2) ** 2, rounding()))
    for angle in (20.0, 60.0):
        exact = cmath.phase(layers.face_by_angle(WATER, STEEL, angle))
        ours = cmath.phase(reflection(WATER, STEEL, angle))
        out.append(Row(f"phase (rad) of total reflection, water to steel, {angle:g}°", SNELL, ours, exact, rounding()))
    return out


SECTION = Section(
    "Faces",
    "Plane waves at the face of two half-spaces. Solids stand as fluids with their longitudinal speed.",
    rows,
)
