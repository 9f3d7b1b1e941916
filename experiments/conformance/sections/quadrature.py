"""Open-space fields and widths against the plainest quadrature of plane waves: no formula, but no code in common either."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from accuracy_study.reference.plain import open_field
from common import DESIGN, FWHM, LOSSES, LOSSLESS, slab
from scipy.optimize import brentq

import beamprop as bp

from ..records import Row, Section, requested
from .ask import WATER, fluid

SOURCE = "trapezoid rule on a bent contour, cascaded scattering matrices"
RTOL = 1e-8


def gaussian(frequency: float, fwhm: float, angle: float = 0.0) -> Callable[[np.ndarray], np.ndarray]:
    """S(kx) of a Gaussian on its launch plane."""
    a = fwhm / (2 * math.sqrt(math.log(2)))
    middle = 2 * math.pi * frequency / 343 * math.sin(math.radians(angle))
    return lambda kx: a * math.sqrt(math.pi) * np.exp(-((a * (kx - middle) / 2) ** 2))


def of_fields() -> list[Row]:
    """p in front of slabs, inside and behind."""
    water = bp.Slab(bp.lmmd_cell(0.2, 0.0, 6, 1 / 35), 60, after=fluid(WATER))
    cases = (
        ("lossless, 45°", slab(450, LOSSLESS), 45.0, 2500.0),
        ("lossy, 85°", slab(450, LOSSES["a"]), 85.0, 2500.0),
        ("lossless before water, 20°", water, 20.0, 2200.0),
    )
    out, x = [], np.array([-0.3, 0.05, 0.4])
    for name, structure, angle, frequency in cases:
        z = np.array([-0.05, structure.thickness / 3, structure.thickness, structure.thickness + 0.2])
        beam = bp.GaussianBeam(FWHM, angle, z0=-0.1)
        p = bp.field(structure, beam, frequency, x, z, rtol=RTOL).p.values
        contour = {"bend": 2.0, "band": 420.0, "count": 6001}
        exact = open_field(structure, frequency, gaussian(frequency, FWHM, angle), -0.1, x, z, **contour)
        largest = np.abs(exact).max(axis=1)
        for i, j in ((0, 0), (1, 1), (2, 1), (3, 2)):
            place = f"{name}, x = {x[j]:g} m, z = {z[i]:.4g} m"
            out.append(Row(f"p, {place}", SOURCE, p[i, j], exact[i, j], requested(RTOL), scale=largest[i]))
    return out


def of_widths() -> list[Row]:
    """The paper's figure 6: FWHM behind both slabs and after two wavelengths of air, by a root of the quadrature."""
    out, beam = [], bp.GaussianBeam(FWHM)
    for frequency in (2000.0, 2400.0, DESIGN):
        spectrum = gaussian(frequency, FWHM)
        air = bp.Slab.uniform(bp.AIR, 2 * 343.0 / frequency)
        for name, structure in (("lossless", slab(450, LOSSLESS)), ("lossy", slab(450, LOSSES["a"])), ("air", air)):

            def above_half(
                x: float, structure: bp.Slab = structure, f: float = frequency, s: Callable = spectrum
            ) -> float:
                p = np.abs(open_field(structure, f, s, 0.0, [0.0, x], [structure.thickness], count=1501)[0])
                return p[1] / p[0] - 0.5

            exact = 2 * brentq(above_half, 0.02, 0.3, xtol=1e-12)
            ours = float(bp.beam_width(structure, beam, frequency, rtol=RTOL).fwhm_out)
            # |p| falls by about itself over half a width where it is half
            out.append(Row(f"FWHM (m) behind, {name}, {frequency:g} Hz", SOURCE, ours, exact, requested(2 * RTOL)))
    return out


def rows() -> list[Row]:
    """Fields and widths."""
    return of_fields() + of_widths()


SECTION = Section(
    "Open-space fields by quadrature",
    "What no closed form reaches: beams through 4500 layers. The [accuracy study](accuracy.md) has 3000 cases more.",
    rows,
)
