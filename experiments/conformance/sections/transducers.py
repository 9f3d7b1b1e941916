"""Pistons and bowls: on the axis in one fluid, and through the layers of the transcranial intercomparison."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

import beamprop as bp

from ..formulas import transducers
from ..formulas.transducers import Layered, Tissue
from ..published import STRIDE_BOWL
from ..records import Row, Section, Tolerance, requested

RTOL, FREQUENCY, PRESSURE = 1e-9, 0.5e6, 60e3
#: Tissues and layers of the intercomparison (Aubry et al. 2022, tables I and II), and where they begin.
WATER, SKIN, CORTICAL = (1000.0, 1500.0, 0.0), (1090.0, 1610.0, 0.2), (1850.0, 2800.0, 4.0)
TRABECULAR, BRAIN = (1700.0, 2300.0, 8.0), (1040.0, 1560.0, 0.3)
BENCHMARKS = {
    "BM3": (0.03, ((CORTICAL, 0.0065),), WATER),
    "BM4": (0.026, ((SKIN, 0.004), (CORTICAL, 0.0015), (TRABECULAR, 0.004), (CORTICAL, 0.001)), BRAIN),
}
SPECTRA = {"piston": transducers.piston_spectrum(0.01), "bowl": transducers.bowl_spectrum(0.064, 0.064)}
#: The gallery's table of ten digits, which its test holds to the package.
TABLE = Path(__file__).parents[2] / "gallery" / "transcranial_table.csv"


def source_of(name: str, start: float) -> bp.Piston | bp.Bowl:
    """The intercomparison's sources, `start` before the layers."""
    if name == "piston":
        return bp.Piston(0.01, pressure=PRESSURE, z0=-start)
    return bp.Bowl(0.064, 0.064, pressure=PRESSURE, z0=-start)


def fluid(tissue: Tissue) -> bp.Fluid:
    """The package's fluid."""
    density, speed, loss = tissue
    return bp.Fluid.from_speed(density, speed, attenuation=bp.power_law(loss, FREQUENCY))


def on_the_axis() -> list[Row]:
    """Closed forms in water."""
    k, z = 2 * math.pi * FREQUENCY / WATER[1], np.array([0.02, 0.06, 0.12])
    nothing = bp.Slab.interface(fluid(WATER), fluid(WATER))
    known = {
        "piston": ("Pierce 1989, 5.7", transducers.piston_on_axis(k, 0.01, z)),
        "bowl": ("O'Neil 1949", transducers.bowl_on_axis(k, 0.064, 0.064, z)),
    }
    out = []
    for name, (source, reference) in known.items():
        p = bp.field(nothing, source_of(name, 0.015), FREQUENCY, 0.0, z - 0.015, y=0.0, rtol=RTOL).p.values
        for i, at in enumerate(z):
            quantity = f"p (Pa) on the axis of a {name}, {1e3 * at:g} mm"
            out.append(Row(quantity, source, p[i], PRESSURE * reference[i], requested(RTOL)))
    return out


def through_layers() -> list[Row]:
    """Standing waves before bone and what is behind, against panels of Gauss nodes and admittances."""
    out, x, z = [], np.array([0.0, 0.005, 0.02]), np.array([0.02, 0.06, 0.1])
    for name, (start, layers, after) in BENCHMARKS.items():
        cell = bp.Cell([bp.Layer(fluid(tissue), d) for tissue, d in layers])
        slab = bp.Slab(cell, before=fluid(WATER), after=fluid(after))
        for kind, spectrum in SPECTRA.items():
            layered = Layered(2 * math.pi * FREQUENCY, start, layers, WATER, after, spectrum)
            p = bp.field(slab, source_of(kind, start), FREQUENCY, x, z - start, y=0.0, rtol=RTOL).p.values
            for i, at in enumerate(z):
                reference = PRESSURE * layered.fields(x, at)[0]
                largest = float(np.abs(reference).max())
                quantity = f"p (Pa), {name}, {kind}, x = {1e3 * x[i]:g} mm, {1e3 * at:g} mm away"
                row = Row(quantity, "panels of Gauss nodes over kr", p[i, i], reference[i], requested(RTOL), largest)
                out.append(row)
    return out


def of_stride() -> list[Row]:
    """The focus of the bowl behind the layers, against a code of finite differences."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        ours = {
            row["quantity"]: float(row["value"])
            for row in csv.DictReader(file)
            if (row["benchmark"], row["source"]) == ("BM4", "bowl")
        }
    grid = "the step of its grid"
    out = []
    for quantity, unit in (("pressure", "Pa"), ("position", "m"), ("length", "m"), ("width", "m")):
        reference = STRIDE_BOWL[quantity]
        spread = Tolerance(0.1, "the codes differ by as much") if unit == "Pa" else Tolerance(5e-4 / reference, grid)
        name = f"{quantity} ({unit}) of the focus, BM4, bowl"
        out.append(Row(name, "Stride, in Aubry et al. 2022", ours[quantity], reference, spread))
    return out


def rows() -> list[Row]:
    """All of them."""
    return on_the_axis() + through_layers() + of_stride()


SECTION = Section(
    "Transducers",
    "A piston of 10 mm radius and a bowl of 64 mm in water and through the flat benchmarks of the transcranial intercomparison.",
    rows,
)
