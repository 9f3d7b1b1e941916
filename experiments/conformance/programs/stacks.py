"""The problems that other programs are asked: layers (density, bulk modulus, thickness) between two half-spaces of one fluid.

Plane acoustics maps to optics of TM waves: pressure to the magnetic field, relative density to permittivity, inverse relative modulus to
permeability. Programs without permeability get stacks of one modulus.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

AIR = (1.25, 1.25 * 343.0**2)
#: The air that pymls has built in: density, static pressure, viscosity, ratio of heat capacities, Prandtl number.
PYMLS_GAS = (1.213, 101325.0, 1.839e-5, 1.4, 0.71)
PYMLS_AIR = (1.213, 1.4 * 101325.0)
#: Porosity, flow resistivity, tortuosity, thermal and viscous length of a foam.
FOAM = {"phi": 0.94, "sigma": 23e3, "alpha": 1.4, "Lambda_prime": 160e-6, "Lambda": 60e-6}


@dataclass(frozen=True)
class Stack:
    """Layers from the near face on; a layer of the foam is its thickness alone."""

    around: tuple[float, float]
    layers: tuple[tuple[complex, complex, float] | float, ...]
    frequency: float


def paper_cell(rho_m: complex, delta_rho: float) -> tuple[tuple[complex, complex, float], ...]:
    """Eq. (10) of the paper, N = 10, eta = 1/60, in air at 2.5 kHz."""
    thickness = 343.0 / 2500.0 / 600
    cosines = [math.cos(2 * math.pi * j / 10) for j in range(10)]
    return tuple((AIR[0] * (rho_m + (60 + 1j * delta_rho) * c), AIR[1], thickness) for c in cosines)


def of_speed(density: float, speed: float, thickness: float) -> tuple[complex, complex, float]:
    """A layer by its sound speed."""
    return density, density * speed**2, thickness


STACKS = {
    "20 lossy periods of the paper's cell": Stack(AIR, paper_cell(0.05 + 0.05j, 0.025) * 20, 2500.0),
    "20 lossless periods of the paper's cell": Stack(AIR, paper_cell(0.05, 0.0) * 20, 2500.0),
    "three dense layers": Stack(
        AIR, tuple((AIR[0] * r, AIR[1], d) for r, d in ((2, 0.03), (5, 0.02), (0.5, 0.05))), 2500.0
    ),
    "plates in water": Stack(
        (998.0, 998.0 * 1482.0**2), (of_speed(1200.0, 2500.0, 9e-4), of_speed(810.0, 1324.0, 4e-4)) * 3, 1e6
    ),
    "two fluids in air": Stack(PYMLS_AIR, (of_speed(2.0, 500.0, 0.03), of_speed(5.0, 200.0, 0.02)), 2000.0),
    "foam": Stack(PYMLS_AIR, (0.04,), 700.0),
    "foam beside a fluid": Stack(PYMLS_AIR, (0.02, of_speed(2.0, 500.0, 0.01)), 3000.0),
}
ANGLES = (0.0, 60.0)
#: Stacks of one modulus.
OPTICAL = ("20 lossy periods of the paper's cell", "20 lossless periods of the paper's cell", "three dense layers")


@dataclass(frozen=True)
class Program:
    """A package on PyPI, what it can be asked, what it needs and does not declare, and the oldest Python that it installs on."""

    name: str
    version: str
    stacks: tuple[str, ...]
    undeclared: tuple[str, ...] = ()
    python: tuple[int, int] = (3, 11)


PROGRAMS = {
    program.name: program
    for program in (
        Program("tmm", "0.2.0", OPTICAL, ("numpy",)),
        Program("pymls", "1.8.1", ("two fluids in air", "foam", "foam beside a fluid")),
        Program("acoustotreams", "0.2.50", (*OPTICAL[1:], "plates in water")),
        Program("PyMoosh", "4.0.1", (*OPTICAL, "plates in water")),
        Program("pyElli", "0.23.1", OPTICAL, ("packaging",)),
        Program("navette", "0.8.0", OPTICAL, python=(3, 12)),
    )
}


def question(name: str, angle: float) -> str:
    """What an answer is filed under."""
    return f"{name}, {angle:g}°"


def questions(program: Program) -> dict[str, dict]:
    """All that a program is asked, as its adapter takes it."""
    out = {}
    for name in program.stacks:
        stack = STACKS[name]
        layers = [v if isinstance(v, float) else [*map(pair, v[:2]), v[2]] for v in stack.layers]
        for angle in ANGLES:
            entry = {
                "around": stack.around,
                "layers": layers,
                "frequency": stack.frequency,
                "angle": angle,
                "foam": FOAM,
            }
            out[question(name, angle)] = entry
    return out


def pair(value: complex) -> list[float]:
    """A complex number for JSON."""
    return [complex(value).real, complex(value).imag]
