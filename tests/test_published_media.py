"""Media against what others published, and against formulas of their own, slow and obvious."""

import math

import numpy as np
import pytest

import beamprop as bp
from beamprop.media.air import Air, Water

# --- air and water ----------------------------------------------------------------------------------------


def test_air_of_iec_61094():
    """IEC 61094-2, Table F.1, prints 1,186 08 kg/m3 and 345,87 m/s for 23 Celsius, 101 325 Pa, 50 %; dry air of 0 Celsius is 331.45 m/s (Cramer)."""
    air = bp.materials()["air"]
    assert air.conditions == "20 Celsius, 50 % relative humidity, 101325 Pa"
    assert Air(23.0, 50.0, 101325.0).density == pytest.approx(1.18608, abs=1e-5)
    assert Air(23.0, 50.0, 101325.0).sound_speed == pytest.approx(345.87, abs=0.005)
    assert Air(0.0, 0.0).sound_speed == pytest.approx(331.45, abs=0.01)


def test_sound_speed_in_air_of_an_ideal_gas():
    """sqrt(gamma p / rho) with the gamma of dry air, 1.4 to 0.2 %, over the range of the fits."""
    for temperature in (0.0, 10.0, 20.0, 30.0):
        for pressure in (76e3, 101e3):
            air = Air(temperature, 0.0, pressure)
            assert air.sound_speed == pytest.approx(math.sqrt(1.4 * pressure / air.density), rel=2e-3)


@pytest.mark.parametrize(
    ("temperature", "humidity", "db_per_km"),
    [
        (10.0, 70.0, (0.1, 0.4, 1.0, 1.9, 3.7, 9.7, 32.8, 117.0)),
        (20.0, 70.0, (0.1, 0.3, 1.1, 2.8, 5.0, 9.0, 22.9, 76.6)),
        (30.0, 70.0, (0.1, 0.3, 1.0, 3.1, 7.4, 12.7, 23.1, 59.3)),
        (15.0, 20.0, (0.3, 0.6, 1.2, 2.7, 8.2, 28.2, 88.8, 202.0)),
        (15.0, 50.0, (0.1, 0.5, 1.2, 2.2, 4.2, 10.8, 36.2, 129.0)),
        (15.0, 80.0, (0.1, 0.3, 1.1, 2.4, 4.1, 8.3, 23.7, 82.8)),
    ],
)
def test_absorption_of_air_as_iso_9613_2_prints_it(temperature, humidity, db_per_km):
    """Its Table 2, from 63 Hz to 8 kHz: to the last printed digit, at the exact middles of the octaves.

    Its numbers are rounded from the three digits of ISO 9613-1 (4.151 there is 4.15, and 4.1 here): half a digit and a tenth of that.
    """
    f = 1000 * 10 ** (0.3 * np.arange(-4, 4))
    ours = bp.material("air", temperature=temperature, humidity=humidity).wavenumber(f).imag * 20 / math.log(10) * 1000
    digits = np.array([0.05] * 7 + [0.5 if db_per_km[-1] >= 100 else 0.05])
    assert np.all(np.abs(ours - db_per_km) <= digits * 1.1)


def test_water_against_other_fits():
    """Speeds by Bilaniuk and Wong (1993, 112 points); the densities that Kell's table prints; alpha/f^2 of Pinkerton (1949)."""
    for t in np.linspace(0, 95, 20):
        other = 1402.38744 + 5.03836171 * t - 5.81172916e-2 * t**2 + 3.34638117e-4 * t**3
        other += -1.48259672e-6 * t**4 + 3.16585020e-9 * t**5
        assert Water(t).sound_speed == pytest.approx(other, abs=0.05)
    for t, density in ((0.0, 999.8395), (4.0, 999.9720), (20.0, 998.2041), (25.0, 997.0449), (40.0, 992.2158)):
        assert Water(t).density == pytest.approx(density, abs=1e-4)
    for t, alpha in ((0.0, 56.9e-15), (20.0, 25.3e-15), (40.0, 14.6e-15)):
        k = bp.material("water", temperature=t).wavenumber(1e6)
        assert k.imag / 1e12 == pytest.approx(alpha, rel=0.02)


# --- the table --------------------------------------------------------------------------------------------

#: What the same table prints for thin rods [m/s].
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


def test_speeds_of_solids_agree_with_those_of_rods():
    """sqrt(Young's modulus / density) from the longitudinal and shear speeds is the rod's speed, printed beside them, to 0.7 %."""
    table = bp.materials()
    assert {name for name, row in table.items() if row.shear_speed} == set(RODS)
    for name, rod in RODS.items():
        cl, cs = table[name].sound_speed, table[name].shear_speed
        assert cs * math.sqrt((3 * cl**2 - 4 * cs**2) / (cl**2 - cs**2)) == pytest.approx(rod, rel=0.007), name


# --- attenuation ------------------------------------------------------------------------------------------


def test_decibels():
    """A wave of 3 dB/cm at 2 MHz loses 3 dB in a centimetre there, and 12 dB at 4 MHz with the exponent 2."""
    fluid = bp.Fluid.from_speed(1000.0, 1500.0, bp.power_law(3.0, 2e6))
    k = fluid.wavenumber([2e6, 4e6])
    np.testing.assert_allclose(-20 * np.log10(np.abs(np.exp(1j * k * 0.01))), [3.0, 12.0], rtol=1e-12)
    np.testing.assert_allclose(k.real, 2 * np.pi * np.array([2e6, 4e6]) / 1500.0, rtol=1e-12)


@pytest.mark.parametrize("exponent", [0.5, 0.999, 1.0, 1.001, 1.1, 1.5, 1.9, 2.0])
def test_dispersion_by_the_kramers_kronig_integral(exponent):
    """1/c at two frequencies from the attenuation alone, by a plain sum.

    k(w)/w is analytic for Im w > 0, so that ``1/c(w) - 1/c(w0) = (2/pi) P int alpha(u) [1/(u^2 - w^2) - 1/(u^2 - w0^2)] du``;
    on midpoints of an even grid of log u that has log w and log w0 among its points the principal values take care of themselves.
    """
    f0, db = 1e6, 0.7
    w = np.array([0.25, 4.0])
    step = math.log(4) / 4000
    u = np.exp((np.arange(-100_000, 100_000) + 0.5) * step)
    kernel = 1 / (u**2 - w[:, None] ** 2) - 1 / (u**2 - 1)
    excess = 2 / math.pi * np.sum(u ** (exponent + 1) * kernel, axis=1) * step
    fluid = bp.Fluid.from_speed(1000.0, 1500.0, bp.power_law(db, f0, exponent, dispersion=True))
    k = fluid.wavenumber(w * f0)
    alpha0 = db * 100 / 8.685889638065037
    np.testing.assert_allclose(k.imag, alpha0 * w**exponent, rtol=1e-9)
    slowness = k.real / (2 * np.pi * f0 * w) - 1 / 1500.0
    np.testing.assert_allclose(slowness / (alpha0 / (2 * np.pi * f0)), excess, rtol=1e-5, atol=1e-5)
