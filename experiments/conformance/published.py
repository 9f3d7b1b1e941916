"""Numbers that others printed, each table once: the page and the tests take them from here."""

from __future__ import annotations

#: IEC 61094-2, Table F.1: temperature (Celsius), pressure (Pa), humidity (%), density (kg/m3), speed (m/s).
IEC_AIR = ((23.0, 101325.0, 50.0, 1.1860848, 345.86652), (20.0, 80000.0, 65.0, 0.9441589, 344.38267))

#: ISO 9613-2, Table 2: temperature (Celsius), humidity (%), attenuation (dB/km) in the octaves from 63 Hz to 8 kHz.
ISO_ABSORPTION = (
    (10.0, 70.0, (0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117.0)),
    (20.0, 70.0, (0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6)),
    (30.0, 70.0, (0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3)),
    (15.0, 20.0, (0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202.0)),
    (15.0, 50.0, (0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129.0)),
    (15.0, 80.0, (0.1, 0.3, 1.1, 2.4, 4.1, 8.3, 23.7, 82.8)),
)

#: Kell 1975: Celsius and kg/m3, air-free water.
WATER_DENSITY = ((0.0, 999.8395), (4.0, 999.9720), (20.0, 998.2041), (25.0, 997.0449), (40.0, 992.2158))

#: Pinkerton 1949: Celsius and alpha/f^2 (s2/m) of water.
WATER_ABSORPTION = ((0.0, 56.9e-15), (20.0, 25.3e-15), (40.0, 14.6e-15))

#: Bilaniuk and Wong 1993, 112 points: powers of the temperature (Celsius) of the speed in water (m/s).
WATER_SPEED = (1402.38744, 5.03836171, -5.81172916e-2, 3.34638117e-4, -1.48259672e-6, 3.16585020e-9)

#: CRC Handbook, "Velocity of sound in various media": speeds in thin rods (m/s).
RODS = {
    "aluminium": 5000,
    "beryllium": 12870,
    "brass": 3480,
    "copper": 3750,
    "gold": 2030,
    "iron": 5200,
    "lead": 1190,
    "molybdenum": 5400,
    "nickel": 4900,
    "platinum": 2800,
    "silver": 2680,
    "steel": 5200,
    "stainless steel": 5000,
    "tin": 2730,
    "titanium": 5080,
    "tungsten": 4620,
    "zinc": 3850,
    "fused silica": 5760,
    "pyrex": 5170,
    "acrylic": 1840,
    "nylon": 1800,
    "polyethylene": 920,
}
