"""Questions to the package, in the pairs (density, sound speed) that the closed forms take."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import beamprop as bp

AIR, WATER, STEEL = (1.25, 343.0), (998.0, 1482.0), (7850.0, 5960.0)
OIL, BRAIN, HELIUM = (810.0, 1324.0), (1040.0, 1560.0), (0.17, 1007.0)
NAMES = {AIR: "air", WATER: "water", STEEL: "steel", OIL: "kerosene", BRAIN: "brain", HELIUM: "helium"}


def name_of(pair: tuple[float, float]) -> str:
    """A fluid's name, or its numbers."""
    return NAMES.get(pair, f"{pair[0]:g} kg/m3 and {pair[1]:g} m/s")


def fluid(pair: tuple[complex, float]) -> bp.Fluid:
    """The package's fluid of a density and a speed."""
    return bp.Fluid(pair[0], pair[0] * pair[1] ** 2)


def stack(before: tuple, layers: Sequence[tuple[tuple, float]], after: tuple, periods: int = 1) -> bp.Slab:
    """The package's slab of (fluid, thickness)."""
    cell = bp.Cell([bp.Layer(fluid(pair), d) for pair, d in layers])
    return bp.Slab(cell, periods, before=fluid(before), after=fluid(after))


def plane_wave(slab: bp.Slab, frequency: float, **lateral: float) -> tuple[complex, complex]:
    """r and t."""
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", bp.HintWarning
        )  # steel as a fluid is meant: the closed forms are those of fluids
        ds = bp.scattering(slab, frequency, **lateral)
    return complex(ds.r), complex(ds.t)


def lateral(before: tuple, frequency: float, angle: float) -> tuple[float, float]:
    """w and kx of a plane wave at an angle."""
    w = 2 * math.pi * frequency
    return w, w / before[1] * math.sin(math.radians(angle))
