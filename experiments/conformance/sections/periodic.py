"""Laminates: Bloch waves, stop bands, finite stacks."""

from __future__ import annotations

import cmath
import math

from scipy.optimize import brentq

import beamprop as bp

from ..formulas import periodic
from ..records import Row, Section, next_term, rounding
from .ask import AIR, HELIUM, OIL, STEEL, WATER, fluid, lateral, name_of, plane_wave, stack

RYTOV = "Rytov 1956"
STACK = "Abelès 1950; Born and Wolf 1999, 1.6.5"
PAIRS = ((WATER, STEEL, (1e-3, 2e-3), 3e5), (WATER, OIL, (0.8e-3, 0.5e-3), 4e5), (AIR, HELIUM, (0.02, 0.05), 1500.0))


def cell(first: tuple, second: tuple, thicknesses: tuple[float, float]) -> bp.Cell:
    """One period."""
    return bp.Cell([bp.Layer(fluid(f), d) for f, d in zip((first, second), thicknesses, strict=True)])


def of_bloch_waves() -> list[Row]:
    """cos(kz P) in and between bands, oblique and evanescent too."""
    out = []
    for first, second, thicknesses, frequency in PAIRS:
        period = cell(first, second, thicknesses)
        for times, angle in ((0.3, 0.0), (1.0, 0.0), (1.0, 25.0), (2.3, 70.0)):
            w, kx = lateral(first, times * frequency, angle)
            ours = cmath.cos(bp.bloch(period, times * frequency, kx=kx).kz.item() * period.thickness)
            exact = periodic.rytov_cosine(first, second, thicknesses, w, kx)
            name = f"cos(kz P), {name_of(first)} and {name_of(second)}, {times * frequency / 1e3:g} kHz, {angle:g}°"
            out.append(Row(name, RYTOV, ours, exact, rounding(10), scale=max(1, abs(exact))))
    return out


def of_stacks() -> list[Row]:
    """r and t of 7, 30 and 400 periods: the condition grows with their number."""
    out = []
    for (first, second, thicknesses, frequency), periods in zip(PAIRS, (30, 400, 7), strict=True):
        layers = list(zip((first, second), thicknesses, strict=True))
        for angle in (0.0, 25.0):
            w, kx = lateral(first, frequency, angle)
            r, t = plane_wave(stack(first, layers, first, periods), frequency, angle=angle)
            exact_r, exact_t = periodic.stack(first, second, thicknesses, periods, first, w, kx)
            name = f"{periods} periods of {name_of(first)} and {name_of(second)}, {angle:g}°"
            out.append(Row(f"r of {name}", STACK, r, exact_r, rounding(periods), scale=1))
            out.append(Row(f"t of {name}", STACK, t, exact_t, rounding(10 * periods)))
    return out


def of_quarter_waves() -> list[Row]:
    """Mirrors of quarter-wave pairs and the edges of their stop band."""
    first, second, centre, out = OIL, WATER, 1e6, []
    quarters = tuple(f[1] / centre / 4 for f in (first, second))
    layers = list(zip((first, second), quarters, strict=True))
    for periods in (1, 5, 25):
        r, _ = plane_wave(stack(first, layers, first, periods), centre, angle=0.0)
        exact = periodic.quarter_wave_mirror(first, first, second, periods)
        name = f"reflectivity of {periods} quarter-wave pairs of kerosene and water"
        out.append(Row(name, "Born and Wolf 1999, 1.6.5", abs(r) ** 2, exact, rounding(10)))
    period = cell(first, second, quarters)

    def beyond(frequency: float) -> float:
        """cos(kz P) + 1, from the package's Bloch wave: negative in the stop band."""
        return cmath.cos(bp.bloch(period, frequency, kx=0.0).kz.item() * period.thickness).real + 1

    edges = periodic.quarter_wave_gap(first, second, centre)
    for side, exact in zip(("lower", "upper"), edges, strict=True):
        ours = brentq(beyond, *sorted((centre, exact + 0.5 * (exact - centre))), xtol=1e-7)
        name = f"{side} edge (Hz) of their stop band"
        out.append(Row(name, "Macleod 2010, quarter-wave stacks", ours, exact, rounding(10)))
    kz = bp.bloch(period, centre, kx=0.0).kz.item()
    z1, z2 = (f[0] * f[1] for f in (first, second))
    exact = abs(math.log(z1 / z2)) / period.thickness
    out.append(Row("decay (1/m) in the middle of it", "Yariv and Yeh 1984", kz.imag, exact, rounding(10)))
    return out


def of_fine_laminates() -> list[Row]:
    """Mean media: of the package's effective fluid exactly, of a laminate a hundred times finer to the square of its phase."""
    out = []
    for first, second, thicknesses, frequency in PAIRS[1:]:
        w, kx = lateral(first, frequency, 30.0)
        exact, phase = periodic.mean_medium(first, second, thicknesses, w, kx)
        names = f"{name_of(first)} and {name_of(second)}, 30°"
        mean = bp.Cell([bp.Layer(bp.standard_emt(cell(first, second, thicknesses)), sum(thicknesses))])
        fine = cell(first, second, tuple(d / 100 for d in thicknesses))
        for name, period, tolerance in (
            (f"kz (1/m) of the mean medium of {names}", mean, rounding(10)),
            (f"kz (1/m) of fine layers of {names}", fine, next_term((phase / 100) ** 2)),
        ):
            ours = bp.bloch(period, frequency, kx=kx).kz.item()
            out.append(Row(name, f"{RYTOV}, long waves", ours, exact, tolerance))
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_bloch_waves() + of_stacks() + of_quarter_waves() + of_fine_laminates()


SECTION = Section("Laminates", "Layers that repeat: Bloch waves, finite stacks, mirrors and mean media.", rows)
