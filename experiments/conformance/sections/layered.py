"""One layer, sheets, and slabs of negative density."""

from __future__ import annotations

import math

from scipy.optimize import brentq, minimize_scalar

import beamprop as bp

from ..formulas import layers
from ..records import Row, Section, next_term, rounding
from .ask import AIR, BRAIN, HELIUM, OIL, STEEL, WATER, fluid, lateral, name_of, plane_wave, stack

LAYER = "Brekhovskikh 1980, input impedance of a layer"
AIRY = "Born and Wolf 1999, 7.6.1"
MASS = "mass law, Fahy and Gardonio 2007"
LONDON = "London 1950"
LENS = "Pendry 2000"


def of_layers() -> list[Row]:
    """r by impedances and t by Airy's sum, from normal to grazing incidence."""
    cases = (
        (WATER, STEEL, WATER, 4e-3),
        (WATER, OIL, BRAIN, 0.7e-3),
        (AIR, HELIUM, AIR, 0.2),
        (WATER, AIR, STEEL, 1e-4),
    )
    out = []
    for before, middle, after, thickness in cases:
        frequency = 1500.0 if before == AIR else 1e6
        name = f"{name_of(middle)} {1e3 * thickness:g} mm, {name_of(before)} to {name_of(after)}"
        for angle in (0.0, 12.0, 50.0):
            w, kx = lateral(before, frequency, angle)
            r, t = plane_wave(stack(before, [(middle, thickness)], after), frequency, angle=angle)
            exact_r, exact_t = layers.layer(before, middle, after, w, kx, thickness)
            out.append(Row(f"r, {name}, {angle:g}°", LAYER, r, exact_r, rounding(), scale=1))
            out.append(Row(f"t, {name}, {angle:g}°", AIRY, t, exact_t, rounding(10)))
    return out


def of_resonances() -> list[Row]:
    """Half-wave and quarter-wave layers, the lines between."""
    half = STEEL[1] / 1e6 / 2
    plate, out = stack(WATER, [(STEEL, half)], WATER), []
    r, t = plane_wave(plate, 1e6, angle=0.0)
    out.append(
        Row("r of a half-wave plate of steel in water", "Rayleigh 1896, section 271", r, 0.0, rounding(), scale=1)
    )
    out.append(Row("t of it", "Rayleigh 1896, section 271", t, -1.0, rounding()))
    quarter = (math.sqrt(WATER[0] * WATER[1] * STEEL[0] * STEEL[1]) / 2500.0, 2500.0)
    r, _ = plane_wave(stack(WATER, [(quarter, 2500.0 / 4e6)], STEEL), 1e6, angle=0.0)
    name = "r of a quarter-wave layer of impedance sqrt(Z1 Z2), water to steel"
    out.append(Row(name, "Brekhovskikh 1980", r, 0.0, rounding(), scale=1))
    R = ((STEEL[0] * STEEL[1] - WATER[0] * WATER[1]) / (STEEL[0] * STEEL[1] + WATER[0] * WATER[1])) ** 2
    for frequency in (0.25e6, 0.95e6, 3.5e6):
        ours = float(bp.scattering(plate, frequency, angle=0.0).energy_transmission)
        exact = layers.airy(R, 2 * math.pi * frequency / STEEL[1] * half)
        out.append(Row(f"energy through the plate at {frequency / 1e6:g} MHz", AIRY, ours, exact, rounding()))
    return out


def of_sheets() -> list[Row]:
    """Limp sheets in air: transmission loss, two of them, their resonance."""
    out, air = [], fluid(AIR)
    for mass, angle in ((0.3, 0.0), (5.0, 0.0), (5.0, 60.0), (20.0, 80.0)):
        w, kx = lateral(AIR, 500.0, angle)
        _, t = plane_wave(bp.Slab(bp.Membrane(mass), background=air), 500.0, angle=angle)
        ours, exact = (-20 * math.log10(abs(v)) for v in (t, layers.sheet(mass, AIR, w, kx)))
        out.append(Row(f"transmission loss (dB), {mass:g} kg/m2, 500 Hz, {angle:g}°", MASS, ours, exact, rounding()))
    wall = bp.Slab([bp.Membrane(5.0), bp.Layer(air, 0.1), bp.Membrane(5.0)], background=air)
    for frequency, angle in ((60.0, 0.0), (400.0, 30.0), (2000.0, 70.0)):
        w, kx = lateral(AIR, frequency, angle)
        exact = layers.double_wall(5.0, 0.1, AIR, w, kx)
        _, t = plane_wave(wall, frequency, angle=angle)
        out.append(
            Row(
                f"t of two sheets of 5 kg/m2, 10 cm apart, {frequency:g} Hz, {angle:g}°", LONDON, t, exact, rounding(10)
            )
        )
    out.append(resonance(wall))
    return out


def resonance(wall: bp.Slab) -> Row:
    """Where the two sheets and the air between them let most through: phi tan phi = 2 rho d/m, phi the phase across the gap."""

    def loss(frequency: float) -> float:
        return -float(bp.scattering(wall, frequency, angle=0.0, estimate=False).transmissivity)

    ours = minimize_scalar(loss, bounds=(110.0, 130.0), method="bounded", options={"xatol": 1e-7}).x
    phase2 = 2 * AIR[0] * 0.1 / 5.0
    exact = AIR[1] / (2 * math.pi * 0.1) * math.sqrt(phase2) * (1 - phase2 / 6)
    return Row(
        "frequency (Hz) of the mass-air-mass resonance", f"{LONDON}, thin gap", ours, exact, next_term(phase2**2)
    )


def of_lenses() -> list[Row]:
    """Slabs of density -1 + i loss: what reaches the image of evanescent waves far above k0, and where it is halved."""
    out, d, frequency = [], 0.02, 50.0
    k0 = 2 * math.pi * frequency / AIR[1]

    def transfer(loss: float, kx: float) -> float:
        slab = stack(AIR, [((AIR[0] * (-1 + 1j * loss), 1j * AIR[1]), d)], AIR)
        _, t = plane_wave(slab, frequency, kx=kx)
        return abs(t) * math.exp(-kx * d)

    for loss in (1e-2, 1e-4):
        cutoff = math.log(2 / loss) / d

        def left_out(kx: float, loss: float = loss) -> float:
            """The quasi-static limit is off by x = (k0/kx)^2 in the density that matches air, and by x kx d in the decay."""
            x = (k0 / kx) ** 2
            return (x / loss) ** 2 + x * (1 + kx * d)

        for ratio in (0.6, 1.0, 1.4):
            kx = ratio * cutoff
            exact = layers.negative_slab_transfer(-1 + 1j * loss, kx, d)
            term = next_term(left_out(kx))
            name = f"transfer at {ratio:g} of the cutoff, loss {loss:g}"
            out.append(Row(name, LENS, transfer(loss, kx), exact, term))
        halved = brentq(lambda kx, loss=loss: transfer(loss, kx) - 0.5, 0.5 * cutoff, 2 * cutoff)
        term = next_term((loss**2 + left_out(cutoff)) / math.log(2 / loss))
        out.append(
            Row(f"kx (1/m) where half is left, loss {loss:g}", f"{LENS}; Smith et al. 2003", halved, cutoff, term)
        )
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_layers() + of_resonances() + of_sheets() + of_lenses()


SECTION = Section(
    "Layers, sheets and lenses",
    "One layer between half-spaces, limp sheets, and slabs of negative density that carry evanescent waves to an image.",
    rows,
)
