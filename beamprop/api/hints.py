"""Hints at what is likely a slip in a question: half-spaces left at air, a beam beside its grid. docs/media.md lists the rules."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..media.fluids import Fluid
from ..media.hints import hint
from ..media.materials import TABLE
from ..media.solids import Solid
from ..media.structures import UNSTATED, Layer, Slab
from ..sources.base import Beam

#: Ultrasound: where a half-space of air behind water reflects all, and who asks has seldom meant it [Hz].
ULTRASOUND = 20e3
#: Density [kg/m3] and sound speed [m/s] of water and what is like it.
WATER_LIKE = ((850.0, 1200.0), (1300.0, 1700.0))

#: Shear waves faster than sound in water are met by waves in it at real angles, and guide waves in plates that those excite: of metals and
#: glasses the shear carries all that passes beyond the critical angle, where that of plastics is a correction [m/s].
FAST_SHEAR = 1500.0
#: The solids with such waves: density, longitudinal speed and name.
SOLIDS = [
    (float(m.density), float(m.sound_speed), name) for name, m in TABLE.items() if (m.shear_speed or 0) > FAST_SHEAR
]
DENSITIES = frozenset(density for density, _, _ in SOLIDS)


def warn_of_solids(slab: Slab, frequency: np.ndarray) -> None:
    """A hint that a metal or glass of the table stands as a fluid, without its shear waves."""
    layers: Any = (layer for cell, _ in slab.segments for layer in cell.layers if isinstance(layer, Layer))
    for fluid in (slab.before, slab.after, *(layer.fluid for layer in layers)):
        if isinstance(fluid, Fluid) and not callable(fluid.density) and fluid.density in DENSITIES:
            speed = 2 * np.pi * np.max(frequency) / abs(complex(fluid.wavenumber(np.max(frequency))).real)
            alike = [n for rho, c, n in SOLIDS if fluid.density == rho and abs(c - speed) <= 1e-6 * c]
            if alike:
                name = alike[-1]  # iron's numbers are steel's, which is meant more often
                hint(
                    f"slab: {name} is taken as a fluid, without shear waves; "
                    f"bp.Solid.from_material({name!r}) has them (--layer 'solid {name} 5mm')"
                )
                return


def warn_of_air(slab: Slab, frequency: np.ndarray) -> None:
    """A hint that both half-spaces are air because none was given, around water at ultrasonic frequencies."""
    if slab.before is not UNSTATED or slab.after is not UNSTATED or np.max(frequency) < ULTRASOUND:
        return
    faces = slab.segments[0][0].layers[0], slab.segments[-1][0].layers[-1]
    if all(isinstance(layer, Layer) and _is_like_water(layer.fluid, frequency) for layer in faces):
        hint(
            "before, after: air, for none was given, around layers like water; background= sets both (bp.AIR if it is meant)"
        )


def _is_like_water(fluid: Fluid | Solid, frequency: np.ndarray) -> bool:
    if isinstance(fluid, Solid):
        return False
    values = fluid.at(np.max(frequency))
    density, speed = abs(complex(values.rho_z)), abs(complex(values.bulk_modulus / values.rho_z)) ** 0.5
    return all(least <= v <= most for v, (least, most) in zip((density, speed), WATER_LIKE, strict=True))


def warn_of_width(slab: Slab, beam: Beam, frequency: np.ndarray, x: np.ndarray) -> None:
    """A hint that a beam of many wavelengths does not fit into the grid that its field is asked on."""
    span = float(np.ptp(x))
    if x.size >= 100:
        _warn_of_metres(slab, beam, frequency, 2 * span, f"x spans {span:g} m")


def warn_of_width_beside(slab: Slab, beam: Beam, frequency: np.ndarray) -> None:
    """A hint that a beam of many wavelengths is much wider than the slab is thick, where there is no grid to compare it with."""
    if slab.thickness > 0:
        _warn_of_metres(slab, beam, frequency, 4 * slab.thickness, f"the slab is {slab.thickness:.3g} m thick")


def _warn_of_metres(slab: Slab, beam: Beam, frequency: np.ndarray, wide: float, beside: str) -> None:
    fwhm = float(np.max(getattr(beam, "fwhm", 0.0)))
    if fwhm < 1 or fwhm <= wide:
        return
    wavelengths = fwhm * float(np.max(np.abs(slab.before.wavenumber(np.max(frequency))))) / (2 * np.pi)
    if 20 < wavelengths < np.inf:
        hint(f"fwhm: {fwhm:g} m is {wavelengths:.3g} wavelengths, and {beside}: is it in metres?")
