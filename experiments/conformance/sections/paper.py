"""The paper: its equations, and its statements as numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import fig2
import fig3
import fig4
import fig5
import numpy as np
from common import DESIGN, FWHM, LOSSES, LOSSLESS, WAVELENGTH, slab

import beamprop as bp

from ..formulas import periodic
from ..records import Row, Section, Tolerance, rounding


def reading(value: float) -> Tolerance:
    """What the reproduction takes the statement's words to mean."""
    return Tolerance(value, "our reading of the words")


def of_equations() -> list[Row]:
    """Effective densities of the staircase and transmissivities of the effective slab."""
    out = []
    for layers in (6, 10, 14):
        ours = complex(bp.lmmd_emt(bp.lmmd_cell(*LOSSLESS, layers)).at(DESIGN).rho_z) / bp.AIR.density
        exact = 0.05 + periodic.staircase_sum(layers)
        # the series is cut off after 4000 pairs of orders, which fall as n^-4
        left_out = Tolerance(1e-11, "next term")
        out.append(Row(f"effective density, N = {layers}", "Eqs. (9), (10)", ours, exact, left_out))
    cell = bp.lmmd_cell(*LOSSES["a"])
    for periods in (20, 100):
        structure = bp.lmmd_emt_slab(bp.Slab(cell, periods), interface=False)
        rho_eff = complex(bp.lmmd_emt(cell).at(DESIGN).rho_z) / bp.AIR.density
        for angle in (0.0, 30.0, 60.0, 85.0):
            ours = float(bp.scattering(structure, DESIGN, angle=angle).transmissivity)
            exact = periodic.paper_transmissivity(rho_eff, angle, 2 * math.pi / WAVELENGTH * structure.thickness)
            name = f"transmissivity of {periods} effective periods, {angle:g}°"
            out.append(Row(name, "Eq. (11)", ours, exact, rounding(10)))
    return out


def of_transmissivities() -> list[Row]:
    """Figures 2 and 3: how far the effective medium is from the exact result."""
    out = []
    for panel, ds in fig2.compute().items():
        name = f"rms of T/T_exact - 1, {fig2.PERIODS[panel]} periods"
        ours = fig2.deviation(ds, "LMMD EMT")
        out.append(Row(name, f"Fig. 2({panel}), match", ours, 0.0, reading(0.15), scale=1))
    for panel, ds in fig3.compute().items():
        for evanescent, kind in ((False, "propagating"), (True, "evanescent")):
            ours = fig3.decades(ds, "LMMD EMT", evanescent)
            name = f"rms decades of T/T_exact, {kind}, Im ρm = {LOSSES[panel][0].imag:g}"
            out.append(Row(name, f"Fig. 3({panel}), agree", ours, 0.0, reading(0.25), scale=1))
    return out


def of_contours() -> list[Row]:
    """Figure 4: how flat the contours are."""
    data = fig4.compute()
    flat = data["a"].kz_over_k0.sel(inverse_eta=100)
    name = "largest departure of Re kz up to 10 k0, η = 1/100"
    out = [Row(name, "Fig. 4(a), almost constant", fig4.departure(flat, 10), 0.0, reading(0.02), scale=1)]
    by_layers = [fig4.departure(data["b"].kz_over_k0.sel(n_layers=n), 10) for n in (14, 6)]
    name = "largest departure of Re kz, N = 14 less N = 6"
    row = Row(
        name, "Fig. 4(b), flatter for larger N", max(0.0, by_layers[0] - by_layers[1]), 0.0, reading(1e-3), scale=1
    )
    return [*out, replace(row, refuted=True)]


def of_beams() -> list[Row]:
    """Figures 5 and 6: widths inside the slab by its depth, and behind it by frequency."""
    out = []
    half, near = WAVELENGTH / 2, np.linspace(-WAVELENGTH / 20, WAVELENGTH / 20, 25)
    for name, loss, panels in (("lossless", LOSSLESS, "bcd"), ("lossy", LOSSES["a"], "efg")):
        structure = slab(450, loss)
        beam = bp.GaussianBeam(FWHM, z0=fig5.LAUNCH)
        places = {"near": half + near, "far": structure.thickness - half + near}
        fields = {
            f"{name} {where}": bp.field(structure, beam, DESIGN, np.linspace(-1, 1, 1024), z, angle=fig5.ANGLES)
            for where, z in places.items()
        }
        for angle, panel in zip(fig5.ANGLES, panels, strict=True):
            first, last = fig5.inside_widths(fields, name, angle)
            row_name = f"last width over first inside the {name} slab, {angle:g}°"
            out.append(Row(row_name, f"Fig. 5({panel}), no visible divergence", last / first, 1.0, reading(0.15)))
    for name, loss, limit in (("lossy", LOSSES["a"], 0.1), ("lossless", LOSSLESS, 0.2)):
        ds = bp.beam_width(slab(450, loss), bp.GaussianBeam(FWHM), np.linspace(2000, 3000, 21))
        ratio = (ds.fwhm_out / ds.fwhm_in).values
        extreme = float(ratio[np.abs(ratio - 1).argmax()])
        row_name = f"extreme width behind the {name} slab over the launched one, 2 to 3 kHz"
        row = Row(row_name, "Fig. 6, almost unchanged", extreme, 1.0, reading(limit))
        out.append(replace(row, refuted=name == "lossless"))
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_equations() + of_transmissivities() + of_contours() + of_beams()


SECTION = Section(
    "The paper",
    "Equations and statements of the paper that the package reproduces; [the reproduction](reproduction.md) has all statements.",
    rows,
)
