"""Beams in one fluid, at a face, behind slits."""

from __future__ import annotations

import math
import warnings

import numpy as np

import beamprop as bp

from ..formulas import beams
from ..records import Row, Section, next_term, requested
from .ask import AIR, HELIUM, fluid, name_of

RTOL = 1e-9
PARAXIAL = "Lax et al. 1975"


def of_gaussians() -> list[Row]:
    """On the axis with the next term, and widths."""
    out, air = [], fluid(AIR)
    for fwhm, frequency, rayleigh_lengths in (
        (0.3, 5000.0, 0.2),
        (0.3, 5000.0, 1.0),
        (0.3, 5000.0, 4.0),
        (1.5, 2500.0, 1.0),
    ):
        k = 2 * math.pi * frequency / AIR[1]
        a = fwhm / (2 * math.sqrt(math.log(2)))
        z = rayleigh_lengths * k * a * a / 2
        slab, beam = bp.Slab.uniform(air, z, air, air), bp.GaussianBeam(fwhm)
        p = complex(bp.field(slab, beam, frequency, 0.0, z, rtol=RTOL).p.item())
        _, exact, term = beams.gaussian_on_axis(k, a, z)
        name = f"{fwhm / AIR[1] * frequency:.1f} wavelengths wide, {rayleigh_lengths:g} Rayleigh lengths away"
        out.append(Row(f"p on the axis, {name}", f"{PARAXIAL}, next term", p, exact, next_term(term)))
        width, left_out = beams.gaussian_width(fwhm, k, z)
        ours = float(bp.beam_width(slab, beam, frequency, rtol=1e-7).fwhm_out)
        out.append(Row(f"FWHM (m), {name}", "Kogelnik and Li 1966", ours, width, next_term(left_out)))
    return out


def of_slits() -> list[Row]:
    """Near slits by Rayleigh and Sommerfeld's integral, far away by Fraunhofer's."""
    out, air, frequency = [], fluid(AIR), 10e3
    k = 2 * math.pi * frequency / AIR[1]
    slits = bp.Slits(width=0.01, separation=0.04)
    apertures = [(m - 0.005, m + 0.005) for m in (-0.02, 0.02)]
    x, z = np.array([0.0, 0.02, 0.05, 0.2]), np.array([0.005, 0.05])
    p = bp.field(bp.Slab.interface(air, air), slits, frequency, x, z, rtol=RTOL).p.values
    for i, j in np.ndindex(p.shape):
        exact = [beams.rayleigh_sommerfeld(apertures, k, at, z[i]) for at in x]
        name = f"p behind two slits, x = {x[j]:g} m, z = {z[i]:g} m"
        row = Row(
            name,
            "Rayleigh-Sommerfeld integral, Born and Wolf 1999, 8.11",
            p[i, j],
            exact[j],
            requested(RTOL),
            scale=max(map(abs, exact)),
        )
        out.append(row)
    far = 400.0
    for angle in (10.0, 25.0, 50.0):
        s, c = far * math.sin(math.radians(angle)), far * math.cos(math.radians(angle))
        ours = [
            abs(complex(bp.field(bp.Slab.interface(air, air), slits, frequency, at, d, rtol=1e-7).p.item()))
            for at, d in ((s, c), (0.0, far))
        ]
        # the phase over the aperture that Fraunhofer leaves out, k x^2/2r
        term = next_term((k * 0.025**2 / (2 * far)) ** 2 + k * 0.025**2 / (2 * far))
        exact = beams.fraunhofer(0.01, 0.04, k, angle)
        out.append(
            Row(
                f"amplitude {far:g} m behind the slits, {angle:g}° over 0°",
                "Fraunhofer, Born and Wolf 1999, 8.5",
                ours[0] / ours[1],
                exact,
                term,
            )
        )
    return out


def of_displacements() -> list[Row]:
    """Goos-Hänchen shifts of wide beams: centroids of the reflected beam."""
    out, frequency, width = [], 2500.0, 8.0
    k = 2 * math.pi * frequency / AIR[1]
    a = width / (2 * math.sqrt(math.log(2)))
    for after, angle in (((1.0, 600.0), 50.0), ((1.0, 600.0), 60.0), ((1.0, 600.0), 75.0), (HELIUM, 40.0)):
        slab = bp.Slab.interface(fluid(AIR), fluid(after))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # nothing radiates behind
            both = bp.beam_measures(slab, bp.GaussianBeam(width, angle=angle), frequency, rtol=1e-8, window=60.0)
        ours = float(both.lateral_shift.sel(side="reflected"))

        def shift(kx: float, after: tuple = after) -> float:
            return beams.total_reflection_shift(AIR, after, k, kx)

        name = f"lateral shift (m) of total reflection, air to {name_of(after)}, {angle:g}°"
        exact = beams.mean_shift(shift, k, a, angle)
        # the field is right to 1e-8 of its peak over a width 100 times the shift
        out.append(Row(f"{name}, mean over the beam", "Artmann 1948", ours, exact, requested(1e-6)))
        middle = k * math.sin(math.radians(angle))
        h = 1e-2
        curvature = (shift(middle + h) - 2 * shift(middle) + shift(middle - h)) / h**2
        term = next_term(curvature / (a * a) / shift(middle))
        out.append(Row(f"{name}, of its middle", "Artmann 1948", ours, shift(middle), term))
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_gaussians() + of_slits() + of_displacements()


SECTION = Section(
    "Beams",
    "Bounded beams in two dimensions against expansions, integrals over the aperture and ray displacements.",
    rows,
)
