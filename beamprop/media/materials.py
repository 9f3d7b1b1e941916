"""Materials by name: a small table whose every number has a source.

Solids stand here with both speeds: `Solid.from_material` takes them, and `material` the longitudinal one alone, which is what a beam near
the normal sees of a plate.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import Any

from .. import validate
from .air import Air, Water
from .attenuation import Attenuation, PowerLaw
from .fluids import Fluid

CRC = (
    "CRC Handbook of Chemistry and Physics, 'Velocity of sound in various media', after AIP Handbook (D. E. Gray, ed.)"
)
MAST = "T. D. Mast, Acoust. Res. Lett. Online 1, 37 (2000), Table 1"


@dataclass(frozen=True)
class Material:
    """A row of the table.

    Attributes
    ----------
    density : float, kg/m3
    sound_speed : float, m/s
        Longitudinal.
    source : str
    shear_speed : float, m/s, or None
        None in fluids, and where the source has none.
    attenuation : function of frequency, or None
        None where the source has none.
    conditions : str
    """

    density: float
    sound_speed: float
    source: str
    shear_speed: float | None = None
    attenuation: Attenuation | None = None
    conditions: str = "room temperature"


def _crc(
    density: float, sound_speed: float, shear_speed: float | None = None, at: str = "room temperature"
) -> Material:
    return Material(density, sound_speed, CRC, shear_speed, conditions=at)


def _mast(density: float, sound_speed: float, db_per_cm: float | None = None) -> Material:
    """A soft tissue; its attenuation is given at 1 MHz, and is taken as proportional to the frequency."""
    if db_per_cm is None:
        return Material(density, sound_speed, MAST, conditions="soft tissue")
    law = PowerLaw(db_per_cm, 1e6, 1.0)
    return Material(density, sound_speed, MAST, None, law, "soft tissue, attenuation proportional to frequency")


TABLE: dict[str, Material] = {
    "aluminium": _crc(2700, 6420, 3040),
    "beryllium": _crc(1870, 12890, 8880),
    "brass": _crc(8600, 4700, 2110),
    "copper": _crc(8930, 5010, 2270),
    "gold": _crc(19700, 3240, 1200),
    "iron": _crc(7850, 5960, 3240),
    "lead": _crc(11400, 2160, 700),
    "molybdenum": _crc(10100, 6250, 3350),
    "nickel": _crc(8900, 6040, 3000),
    "platinum": _crc(21400, 3260, 1730),
    "silver": _crc(10400, 3650, 1610),
    "steel": _crc(7850, 5960, 3235),
    "stainless steel": _crc(7900, 5790, 3100),
    "tin": _crc(7300, 3320, 1670),
    "titanium": _crc(4500, 6070, 3125),
    "tungsten": _crc(19300, 5220, 2890),
    "zinc": _crc(7100, 4210, 2440),
    "fused silica": _crc(2200, 5968, 3764),
    "pyrex": _crc(2320, 5640, 3280),
    "acrylic": _crc(1180, 2680, 1100),
    "nylon": _crc(1110, 2620, 1070),
    "polyethylene": _crc(900, 1950, 540),
    "butyl rubber": _crc(1070, 1830),
    "neoprene": _crc(1330, 1600),
    "castor oil": _crc(969, 1477, at="25 Celsius"),
    "glycerol": _crc(1260, 1904, at="25 Celsius"),
    "kerosene": _crc(810, 1324, at="25 Celsius"),
    "mercury": _crc(13500, 1450, at="25 Celsius"),
    "sea water": _crc(1025, 1531, at="25 Celsius"),
    "blood": _mast(1060, 1584),
    "brain": _mast(1040, 1560),
    "breast": _mast(1020, 1510, 0.75),
    "fat": _mast(950, 1478),
    "heart": _mast(1060, 1576, 0.52),
    "kidney": _mast(1050, 1560, 1.0),
    "liver": _mast(1060, 1595, 0.50),
    "muscle": _mast(1050, 1580),
    "skin": _mast(1090, 1615, 0.35),
    "spleen": _mast(1054, 1567, 0.40),
}
#: Further names.
ALSO = {"aluminum": "aluminium", "lucite": "acrylic", "pmma": "acrylic", "plexiglas": "acrylic", "glycerin": "glycerol"}


def materials() -> dict[str, Material]:
    """The table of materials by name: density, speeds, attenuation and the source of these numbers.

    Air and water stand in it at 20 Celsius.

    Examples
    --------
    >>> steel = bp.materials()["steel"]
    >>> steel.density, steel.sound_speed, steel.shear_speed
    (7850, 5960, 3235)
    """
    return {"air": _air(), "water": _water()} | TABLE


def material(
    name: str,
    *,
    temperature: float | None = None,
    humidity: float | None = None,
    pressure: float | None = None,
    attenuation: Attenuation | bool = False,
) -> Fluid:
    """A fluid by the name of its material.

    A solid is a fluid with its longitudinal speed: right at normal incidence, where nothing shears. `Solid.from_material` has both.

    Parameters
    ----------
    name : str
        A name of `materials`, in capitals or not.
    temperature : float, optional; Celsius
        Of air (0 to 30) and water (0 to 95); 20.
    humidity : float, optional; %
        Relative, of air; 50.
    pressure : float, optional; Pa
        Of air, 75 000 to 102 000; 101 325.
    attenuation : bool, float, or function of frequency; Np/m
        True for that of the table; otherwise lossless, as a half-space has to be for shares of energy, or what is given.

    Raises
    ------
    ValueError
        An unknown name, a condition that the material does not take, one outside of its range, or an attenuation that the
        table does not have.

    Sources: air by CIPM-2007 (density), O. Cramer (1993, speed) and ISO 9613-1 (attenuation); water by G. S. Kell (1975, density),
    W. Marczak (1997, speed) and R. E. Francois and G. R. Garrison (1982, attenuation); those of the others are told by
    `materials`.

    Examples
    --------
    >>> water = bp.material("water", temperature=25)
    >>> k = water.wavenumber(1e6)
    >>> round(float(2 * np.pi * 1e6 / k.real), 1)  # m/s
    1496.7
    >>> plate = bp.Slab.uniform(bp.material("steel"), 2e-3, background=water)
    >>> round(float(bp.material("liver", attenuation=True).wavenumber(1e6).imag), 3)  # Np/m, of 0.5 dB/cm
    5.756
    """
    if not isinstance(name, str):
        raise validate.refuse("name", "the name of a material", name)
    key = " ".join(name.lower().replace("_", " ").split())
    key = ALSO.get(key, key)
    conditions = {
        n: v for n, v in (("temperature", temperature), ("humidity", humidity), ("pressure", pressure)) if v is not None
    }
    takes = {"air": ("temperature", "humidity", "pressure"), "water": ("temperature",)}.get(key, ())
    row = _row(key, name) if not takes else None
    for given, value in conditions.items():
        if given not in takes:
            raise validate.refuse(given, f"nothing, for {key} is known at {materials()[key].conditions} only", value)
    if row is None:
        row = _air(**conditions) if key == "air" else _water(**conditions)
    if attenuation is True:
        attenuation = row.attenuation if row.attenuation is not None else _no_attenuation(key)
    return Fluid.from_speed(row.density, row.sound_speed, 0.0 if attenuation is False else attenuation)


def solid_numbers(name: str) -> tuple[float, float, float]:
    """Density, longitudinal and shear speed of a material."""
    material(name)  # refuses what is no name
    key = " ".join(name.lower().replace("_", " ").split())
    row = materials()[ALSO.get(key, key)]
    if row.shear_speed is None:
        solids = ", ".join(sorted(n for n, m in TABLE.items() if m.shear_speed is not None))
        raise validate.refuse("name", f"a material with a shear speed ({solids})", name)
    return row.density, row.sound_speed, row.shear_speed


def _no_attenuation(key: str) -> Attenuation:
    raise validate.refuse("attenuation", f"a number or a function, for the table has none of {key}", True)


def _row(key: str, name: str) -> Material:
    if key not in TABLE:
        names = ["air", "water", *TABLE]
        near = difflib.get_close_matches(key, [*names, *ALSO], n=1)
        hint = f"such as {near[0]!r}" if near else f"one of {', '.join(names)}"
        raise validate.refuse("name", f"a material of beamprop.materials(), {hint}", name)
    return TABLE[key]


def _air(**conditions: Any) -> Material:
    air = Air(**conditions)
    source = "CIPM-2007, Metrologia 45, 149 (2008); O. Cramer, J. Acoust. Soc. Am. 93, 2510 (1993); ISO 9613-1:1993"
    at = f"{air.temperature:g} Celsius, {air.humidity:g} % relative humidity, {air.pressure:g} Pa"
    return Material(air.density, air.sound_speed, source, None, air, at)


def _water(**conditions: Any) -> Material:
    water = Water(**conditions)
    source = (
        "G. S. Kell, J. Chem. Eng. Data 20, 97 (1975); W. Marczak, J. Acoust. Soc. Am. 102, 2776 (1997); "
        "R. E. Francois and G. R. Garrison, J. Acoust. Soc. Am. 72, 1879 (1982)"
    )
    # dB/km/kHz^2 is 10 dB/cm at 1 MHz: 1e6 kHz^2, over 1e5 cm
    law = PowerLaw(10 * water.attenuation_over_f2, 1e6, 2.0)
    return Material(water.density, water.sound_speed, source, None, law, f"{water.temperature:g} Celsius")
