"""Full-wave finite elements against plane waves at the same period."""

from __future__ import annotations

import numpy as np
from common import DESIGN, FWHM, LOSSES, LOSSLESS, WAVELENGTH, slab

import beamprop as bp

from ..records import Row, Section, Tolerance
from .ask import AIR, HELIUM, OIL, WATER, fluid, stack

#: Not a whole number of wavelengths: no order travels along the faces.
PERIOD = 6.3


def rows() -> list[Row]:
    """p at four places before, in and behind a slab."""
    plates = stack(WATER, [(OIL, 0.4e-3), ((1200.0, 2500.0), 0.9e-3)], WATER, 3)
    cases = (
        ("20 lossless periods, 45°", slab(20, LOSSLESS), 45.0, DESIGN, WAVELENGTH),
        ("20 lossy periods, 0°", slab(20, LOSSES["a"]), 0.0, DESIGN, WAVELENGTH),
        ("plates in water, 20°", plates, 20.0, 1e6, 1482e-6),
        (
            "5 cm of helium in air, 30°",
            bp.Slab.uniform(fluid(HELIUM), 0.05, fluid(AIR), fluid(AIR)),
            30.0,
            DESIGN,
            WAVELENGTH,
        ),
    )
    out = []
    for name, structure, angle, frequency, wavelength in cases:
        beam = bp.GaussianBeam(FWHM / WAVELENGTH * wavelength, angle, z0=-0.5 * wavelength)
        depth = structure.thickness
        x, z = (
            np.linspace(-1, 1, 21) * wavelength,
            np.array([-0.2 * wavelength, depth / 2, depth, depth + 0.3 * wavelength]),
        )
        period = PERIOD * wavelength
        ours = bp.field(structure, beam, frequency, x, z, boundary="periodic", period=period).p.values
        theirs = bp.fem.field(structure, beam, frequency, x, z, period).p.values
        discretised = Tolerance(1e-3, "elements of order 3")
        for i, place in enumerate(("before", "in the middle of", "on the far face of", "behind")):
            row = Row(
                f"p on the axis {place} {name}",
                "beamprop.fem",
                ours[i, 10],
                theirs[i, 10],
                discretised,
                np.abs(theirs[i]).max(),
            )
            out.append(row)
    return out


SECTION = Section(
    "Finite elements",
    "Periodic arrays of beams by `bp.fem.field`, which knows nothing of layer matrices; all 4500 layers are in [the reproduction](reproduction.md).",
    rows,
)
