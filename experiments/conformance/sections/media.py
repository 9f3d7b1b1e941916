"""Media: printed values of air and water, models of porous and mixed media."""

from __future__ import annotations

import math

import numpy as np

import beamprop as bp

from .. import published
from ..formulas import media
from ..records import Row, Section, Tolerance, printed, rounding
from .ask import AIR, WATER, fluid

#: What the package's `Gas` holds by default, for the formulas.
GAS = (1.2, 101325.0, 1.81e-5, 1.4, 0.71)
DB = 20 / math.log(10)


def of_air() -> list[Row]:
    """Densities, speeds and attenuations to their printed digits."""
    out = []
    for temperature, pressure, humidity, density, speed in published.IEC_AIR:
        air = bp.material("air", temperature=temperature, humidity=humidity, pressure=pressure).at(1000.0)
        rho, c = air.rho_z.real, math.sqrt((air.bulk_modulus / air.rho_z).real)
        name = f"air, {temperature:g} °C, {pressure / 1000:g} kPa, {humidity:g} %"
        source = "IEC 61094-2:2009, Table F.1"
        # its density takes 0.3780 for a ratio of molar masses that CIPM-2007 has to five digits
        out.append(Row(f"density (kg/m3) of {name}", source, rho, density, Tolerance(1e-6, "digits of its constants")))
        out.append(Row(f"speed (m/s) in {name}", source, c, speed, printed(1e-5, speed)))
    air = bp.material("air", temperature=0.0, humidity=0.0).at(1000.0)
    c = math.sqrt((air.bulk_modulus / air.rho_z).real)
    out.append(Row("speed (m/s) in dry air, 0 °C", "Cramer 1993", c, 331.45, printed(0.01, 331.45)))
    f = 1000 * 10 ** (0.3 * np.arange(-4, 4))  # exact middles of the octaves
    for temperature, humidity, attenuations in published.ISO_ABSORPTION:
        air = bp.material("air", temperature=temperature, humidity=humidity, attenuation=True)
        for frequency, ours, theirs in zip(f, air.wavenumber(f).imag * DB * 1000, attenuations, strict=True):
            # rounded from the three digits of ISO 9613-1: half a digit, and a tenth of that
            digit = printed(1.1 if theirs >= 100 else 0.11, theirs)
            name = f"attenuation (dB/km) of air, {temperature:g} °C, {humidity:g} %, {frequency:.0f} Hz"
            out.append(Row(name, "ISO 9613-2:1996, Table 2", ours, theirs, digit))
    return out


def of_water() -> list[Row]:
    """Densities, speeds by another fit, absorption."""
    out = []
    for temperature, density in published.WATER_DENSITY:
        ours = bp.material("water", temperature=temperature).at(1e6).rho_z.real
        digit = printed(1e-4, density)
        out.append(Row(f"density (kg/m3) of water, {temperature:g} °C", "Kell 1975", ours, density, digit))
    for temperature in (5.0, 20.0, 37.0, 60.0, 90.0):
        values = bp.material("water", temperature=temperature).at(1e6)
        ours = math.sqrt((values.bulk_modulus / values.rho_z).real)
        theirs = sum(c * temperature**n for n, c in enumerate(published.WATER_SPEED))
        fits = Tolerance(0.05 / theirs, "scatter of measurements, 0.05 m/s")
        out.append(Row(f"speed (m/s) in water, {temperature:g} °C", "Bilaniuk and Wong 1993", ours, theirs, fits))
    for temperature, alpha in published.WATER_ABSORPTION:
        k = bp.material("water", temperature=temperature, attenuation=True).wavenumber(1e6)
        measured = Tolerance(0.02, "scatter of measurements")
        name = f"alpha/f² (s2/m) of water, {temperature:g} °C"
        out.append(Row(name, "Pinkerton 1949", float(k.imag) / 1e12, alpha, measured))
    return out


def of_rods() -> list[Row]:
    """Speeds in thin rods from the table's longitudinal and shear speeds: their columns agree to 0.7 %."""
    table = bp.materials()
    sources = Tolerance(0.007, "agreement of the source's columns")
    return [
        Row(
            f"speed (m/s) in a thin rod of {name}",
            "CRC Handbook",
            media.rod_speed(table[name].sound_speed, table[name].shear_speed),
            rod,
            sources,
        )
        for name, rod in published.RODS.items()
    ]


def of_gas_in_frames() -> list[Row]:
    """Densities and moduli of porous models and channels, and what a layer of them absorbs."""
    foam, wide = (23e3, 0.94, 1.4, 60e-6, 160e-6), 0.4e-3
    models = {
        "foam": (
            bp.johnson_champoux_allard(*foam),
            "Allard and Atalla 2009, Eqs. (5.50), (5.55)",
            lambda w: media.johnson_champoux_allard(GAS, w, foam),
        ),
        "tubes": (bp.narrow_tubes(wide), "Stinson 1991", lambda w: media.tube(GAS, w, wide)),
        "slits": (bp.narrow_slits(wide), "Allard and Atalla 2009, 4.7", lambda w: media.slit(GAS, w, wide)),
    }
    out = []
    for name, (model, source, formula) in models.items():
        for f in (50.0, 700.0, 9000.0):
            values, (rho, K) = model.at(f), formula(2 * math.pi * f)
            out.append(Row(f"density (kg/m3) of {name}, {f:g} Hz", source, values.rho_z, rho, rounding(10)))
            out.append(Row(f"bulk modulus (Pa) of {name}, {f:g} Hz", source, values.bulk_modulus, K, rounding(10)))
    wool = bp.delany_bazley_miki(2e4)
    for f in (400.0, 2000.0, 12000.0):
        impedance, k = media.miki(GAS, f, 2e4)
        values, ours = wool.at(f), complex(wool.wavenumber(f))
        ours_z = complex(values.rho_z) * 2 * math.pi * f / ours
        out.append(Row(f"impedance (Pa s/m) of wool, {f:g} Hz", "Miki 1990, Eq. (33)", ours_z, impedance, rounding(10)))
        out.append(Row(f"wavenumber (1/m) of wool, {f:g} Hz", "Miki 1990, Eq. (34)", ours, k, rounding(10)))
    rigid = (AIR[0] * 1e12, AIR[1])
    for f in (250.0, 1000.0, 4000.0):
        slab = bp.Slab.uniform(bp.johnson_champoux_allard(*foam), 0.04, fluid(AIR), fluid(rigid))
        ours = 1 - float(bp.scattering(slab, f, angle=0.0).reflectivity)
        rho, K = media.johnson_champoux_allard(GAS, 2 * math.pi * f, foam)
        exact = media.rigidly_backed_absorption(rho, K, 2 * math.pi * f, 0.04, AIR)
        name = f"absorption of 4 cm of foam on a rigid wall, {f:g} Hz"
        out.append(
            Row(name, "Allard and Atalla 2009, chapter 2", ours, exact, Tolerance(1e-10, "the wall: 1e12 of air"))
        )
    return out


def of_mixtures_and_losses() -> list[Row]:
    """Bubbly water, and speeds that attenuation implies."""
    out = []
    for share in (1e-5, 1e-3, 0.5, 0.9):
        mixture = bp.wood_mixture((fluid(WATER), 1 - share), (fluid(AIR), share))
        ours = 2 * math.pi * 100 / float(mixture.wavenumber(100.0).real)
        name = f"speed (m/s) in water with {100 * share:g} % of air"
        out.append(Row(name, "Wood 1930", ours, media.wood_speed(WATER, AIR, share), rounding()))
    f0, db = 1e6, 0.7
    alpha0 = 100 * db / DB
    for exponent in (0.5, 1.0, 1.1, 1.5):
        tissue = bp.Fluid.from_speed(1000.0, 1500.0, bp.power_law(db, f0, exponent, dispersion=True))
        for times in (0.25, 4.0):
            w = 2 * math.pi * f0 * times
            ours = w / float(tissue.wavenumber(times * f0).real)
            exact = 1 / (1 / 1500.0 + media.slowness_excess(exponent, alpha0, 2 * math.pi * f0, w))
            name = f"speed (m/s) at {times:g} MHz, 0.7 dB/cm MHz^-{exponent:g}, 1500 m/s at 1 MHz"
            out.append(Row(name, "Szabo 1995; Waters et al. 2000", ours, exact, rounding()))
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_air() + of_water() + of_rods() + of_gas_in_frames() + of_mixtures_and_losses()


SECTION = Section(
    "Media", "Printed values of air, water and solids; porous, mixed and lossy media by their sources' formulas.", rows
)
