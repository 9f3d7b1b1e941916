"""Media against what others published, and against formulas of their own, slow and obvious."""

import math

import numpy as np
import pytest
from conformance import published

import beamprop as bp
from beamprop.media.air import Air, Water

# --- air and water ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(("temperature", "pressure", "humidity", "density", "speed"), published.IEC_AIR)
def test_air_as_iec_61094_2_prints_it(temperature, pressure, humidity, density, speed):
    """Its Table F.1: the speed to the last digit, the density to 1e-6, for it rounds the ratio of molar masses to 0.3780."""
    air = Air(temperature, humidity, pressure)
    assert air.sound_speed == pytest.approx(speed, abs=5e-6)
    assert air.density == pytest.approx(density, rel=1e-6)


def test_dry_air():
    """331.45 m/s at 0 Celsius (Cramer 1993)."""
    assert Air(0.0, 0.0).sound_speed == pytest.approx(331.45, abs=0.01)
    assert bp.materials()["air"].conditions == "20 Celsius, 50 % relative humidity, 101325 Pa"


def test_sound_speed_in_air_of_an_ideal_gas():
    """sqrt(gamma p / rho) with the gamma of dry air, 1.4 to 0.2 %, over the range of the fits."""
    for temperature in (0.0, 10.0, 20.0, 30.0):
        for pressure in (76e3, 101e3):
            air = Air(temperature, 0.0, pressure)
            assert air.sound_speed == pytest.approx(math.sqrt(1.4 * pressure / air.density), rel=2e-3)


@pytest.mark.parametrize(("temperature", "humidity", "db_per_km"), published.ISO_ABSORPTION)
def test_absorption_of_air_as_iso_9613_2_prints_it(temperature, humidity, db_per_km):
    """Its Table 2, from 63 Hz to 8 kHz: to the last printed digit, at the exact middles of the octaves.

    Its numbers are rounded from the three digits of ISO 9613-1 (4.151 there is 4.15, and 4.1 here): half a digit and a tenth of that.
    """
    f = 1000 * 10 ** (0.3 * np.arange(-4, 4))
    ours = (
        bp.material("air", temperature=temperature, humidity=humidity, attenuation=True).wavenumber(f).imag
        * 20
        / math.log(10)
        * 1000
    )
    digits = np.array([0.05] * 7 + [0.5 if db_per_km[-1] >= 100 else 0.05])
    assert np.all(np.abs(ours - db_per_km) <= digits * 1.1)


def test_water_against_other_fits():
    """Speeds by Bilaniuk and Wong (1993, 112 points); the densities that Kell's table prints; alpha/f^2 of Pinkerton (1949)."""
    for t in np.linspace(0, 95, 20):
        fit = sum(c * t**n for n, c in enumerate(published.WATER_SPEED))
        assert Water(t).sound_speed == pytest.approx(fit, abs=0.05)
    for t, density in published.WATER_DENSITY:
        assert Water(t).density == pytest.approx(density, abs=1e-4)
    for t, alpha in published.WATER_ABSORPTION:
        k = bp.material("water", temperature=t, attenuation=True).wavenumber(1e6)
        assert k.imag / 1e12 == pytest.approx(alpha, rel=0.02)


# --- the table --------------------------------------------------------------------------------------------


def test_speeds_of_solids_agree_with_those_of_rods():
    """sqrt(Young's modulus / density) from the longitudinal and shear speeds is the rod's speed, printed beside them, to 0.7 %."""
    table = bp.materials()
    assert {name for name, row in table.items() if row.shear_speed} == set(published.RODS)
    for name, rod in published.RODS.items():
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


# --- gas in rigid frames ----------------------------------------------------------------------------------

GAS = bp.Gas()


def mean_over(cross_section, lam, n=2000):
    """The mean of v with v - lap(v)/lam = 1 and v = 0 on the walls of a slit or a tube of half-width 1, by finite differences."""
    h = 1 / n
    y = (np.arange(n) + 0.5) * h  # middles of cells between the middle (or axis) and the wall
    faces = np.arange(n + 1) * h
    weight = np.where(faces > 0, 1.0, 0.0) if cross_section == "slit" else faces  # nothing crosses the middle
    volume = np.ones(n) if cross_section == "slit" else y
    low, high = weight[:-1] / h**2, weight[1:] / h**2
    high[-1] *= 2  # the wall is half a cell away
    diagonal = volume + (low + high) / lam
    # the Thomas algorithm, as it stands in textbooks
    c, d = np.zeros(n, complex), np.zeros(n, complex)
    for i in range(n):
        below = -low[i] / lam if i else 0.0
        pivot = diagonal[i] - below * (c[i - 1] if i else 0.0)
        c[i] = -high[i] / lam / pivot
        d[i] = (volume[i] - below * (d[i - 1] if i else 0.0)) / pivot
    v = np.zeros(n, complex)
    for i in reversed(range(n)):
        v[i] = d[i] - (c[i] * v[i + 1] if i + 1 < n else 0.0)
    return np.sum(v * volume) / np.sum(volume)


@pytest.mark.parametrize("shape", ["slit", "tube"])
@pytest.mark.parametrize("frequency", [5.0, 200.0, 5000.0])
def test_channels_by_finite_differences(shape, frequency):
    """Momentum and heat across a channel, solved on 2000 cells: -i w rho v = -p' + viscosity lap v, and so the temperature."""
    size, porosity = 0.4e-3, 0.3
    fluid = bp.narrow_slits(2 * size, porosity) if shape == "slit" else bp.narrow_tubes(size, porosity)
    lam = -2j * np.pi * frequency * GAS.density / GAS.viscosity * size**2
    velocity, temperature = mean_over(shape, lam), mean_over(shape, lam * GAS.prandtl)
    values = fluid.at(frequency)
    assert values.rho_z == pytest.approx(GAS.density / velocity / porosity, rel=2e-5)
    modulus = GAS.pressure * 1.4 / (1.4 - 0.4 * temperature) / porosity
    assert values.bulk_modulus == pytest.approx(modulus, rel=2e-5)
    assert values.rho_x == np.inf


@pytest.mark.parametrize("shape", ["slit", "tube"])
def test_channels_of_poiseuille_and_of_free_gas(shape):
    """Slow flow: resistivity 12 viscosity / width^2 and 8 viscosity / radius^2, inertia 6/5 and 4/3; fast: the free gas."""
    fluid = bp.narrow_slits(1e-3) if shape == "slit" else bp.narrow_tubes(1e-3)
    resistivity, inertia = (12 * GAS.viscosity / 1e-6, 1.2) if shape == "slit" else (8 * GAS.viscosity / 1e-6, 4 / 3)
    slow = fluid.at(1e-3)
    assert slow.rho_z == pytest.approx(GAS.density * inertia + 1j * resistivity / (2e-3 * np.pi), rel=1e-6)
    assert slow.rho_z.real == pytest.approx(GAS.density * inertia, rel=1e-6)
    assert slow.bulk_modulus == pytest.approx(GAS.pressure, rel=2e-5)
    fast = fluid.at(1e12)
    assert fast.rho_z == pytest.approx(GAS.density, rel=1e-5)
    assert fast.bulk_modulus == pytest.approx(1.4 * GAS.pressure, rel=1e-5)


def test_johnson_champoux_allard_of_tubes():
    """Its parameters of round tubes, resistivity 8 viscosity / (porosity R^2) and both lengths R, give the tubes to 4 %."""
    R, porosity = 0.3e-3, 0.6
    ours = bp.johnson_champoux_allard(8 * GAS.viscosity / (porosity * R**2), porosity, 1.0, R, R).at(
        np.geomspace(1, 1e5, 60)
    )
    exact = bp.narrow_tubes(R, porosity).at(np.geomspace(1, 1e5, 60))
    assert np.max(np.abs(ours.bulk_modulus / exact.bulk_modulus - 1)) < 0.04
    assert np.max(np.abs(ours.rho_z / exact.rho_z - 1)) < 0.12  # at low frequency its inertia is 5/4, not 4/3


def test_johnson_champoux_allard_in_the_literatures_signs():
    """The formulas as Allard and Atalla (2009) write them, Eqs. (5.50) and (5.55) over the porosity, for exp(+j w t): conjugated."""
    sigma, phi, a, vl, tl = 23e3, 0.94, 1.4, 60e-6, 160e-6
    fluid = bp.johnson_champoux_allard(sigma, phi, a, vl, tl)
    for f in (50.0, 700.0, 9000.0):
        w, j = 2 * math.pi * f, 1j
        G = (1 + 4 * j * a**2 * GAS.viscosity * GAS.density * w / (sigma**2 * vl**2 * phi**2)) ** 0.5
        rho = a * GAS.density * (1 + sigma * phi / (j * w * GAS.density * a) * G)
        H = (1 + j * GAS.density * w * GAS.prandtl * tl**2 / (16 * GAS.viscosity)) ** 0.5
        K = 1.4 * GAS.pressure / (1.4 - 0.4 / (1 + 8 * GAS.viscosity / (j * tl**2 * GAS.prandtl * w * GAS.density) * H))
        assert fluid.at(f).rho_z == pytest.approx((rho / phi).conjugate(), rel=1e-12)
        assert fluid.at(f).bulk_modulus == pytest.approx((K / phi).conjugate(), rel=1e-12)


def test_johnson_champoux_allard_limits():
    """Slowly the resistivity, isothermal; fast the tortuosity and Johnson's boundary layer, adiabatic."""
    sigma, phi, a, vl, tl = 23e3, 0.94, 1.4, 60e-6, 160e-6
    fluid = bp.johnson_champoux_allard(sigma, phi, a, vl, tl)
    slow, fast, w = fluid.at(1e-2), fluid.at(1e9), 2e9 * math.pi
    assert -2e-2j * math.pi * slow.rho_z == pytest.approx(sigma, rel=1e-4)
    assert slow.bulk_modulus * phi == pytest.approx(GAS.pressure, rel=1e-4)
    layer = math.sqrt(2 * GAS.viscosity / (w * GAS.density))
    assert fast.rho_z * phi / (a * GAS.density) - 1 == pytest.approx((1 + 1j) * layer / vl, rel=1e-2)
    layer /= math.sqrt(GAS.prandtl)
    assert 1 - fast.bulk_modulus * phi / (1.4 * GAS.pressure) == pytest.approx(0.4 * (1 + 1j) * layer / tl, rel=1e-2)


def test_delany_bazley_miki_as_published():
    """Miki (1990), Eqs. (33) and (34), for exp(+j w t), and near Delany and Bazley's own powers of rho f / sigma where both hold."""
    sigma, z0, c0 = 2e4, GAS.density * GAS.sound_speed, GAS.sound_speed
    fluid = bp.delany_bazley_miki(sigma)
    for f in (400.0, 2000.0, 12000.0):
        values, k = fluid.at(f), fluid.wavenumber(f)
        impedance = complex(values.rho_z * 2 * math.pi * f / k)
        x = f / sigma
        assert impedance == pytest.approx(z0 * (1 + 0.070 * x**-0.632 + 0.107j * x**-0.632), rel=1e-12)
        w_over_c = 2 * math.pi * f / c0
        assert complex(k) == pytest.approx(w_over_c * (1 + 0.109 * x**-0.618 + 0.160j * x**-0.618), rel=1e-12)
        x *= GAS.density
        theirs = z0 * (1 + 0.0571 * x**-0.754 + 0.087j * x**-0.732)
        assert abs(impedance / theirs - 1) < 0.1
        theirs = w_over_c * (1 + 0.0978 * x**-0.700 + 0.189j * x**-0.595)
        assert abs(complex(k) / theirs - 1) < 0.1


# --- mixtures and membranes -------------------------------------------------------------------------------


def test_woods_mixture():
    """Bubbly water: c = ((sum of rho)(sum of 1/K))^(-1/2), and the 24 m/s of half air and half water that textbooks have."""
    water, air = bp.Fluid.from_speed(998.0, 1482.0), bp.Fluid.from_speed(1.2, 343.0)
    for share in (1e-5, 0.001, 0.5, 0.9):
        fluid = bp.wood_mixture((water, 1 - share), (air, share))
        c = 2 * math.pi * 100 / float(fluid.wavenumber(100.0).real)
        rho = (1 - share) * 998 + share * 1.2
        compressibility = (1 - share) / (998 * 1482**2) + share / (1.2 * 343**2)
        assert c == pytest.approx((rho * compressibility) ** -0.5, rel=1e-12)
        assert share != 0.5 or c == pytest.approx(24, abs=0.5)
    assert bp.wood_mixture((water, 0.3), (water, 0.7)).at(1.0).bulk_modulus == pytest.approx(water.bulk_modulus)


def test_resonant_membranes_by_their_mechanics():
    """Newton's law of masses, springs and dashpots, solved as linear equations for exp(-i w t): the force over -w^2 u is the mass."""
    m, m1, f0, g = 0.2, 0.5, 700.0, 40.0
    assert bp.Membrane.lorentz(m, f0, m1, g).at(np.array([f0]))[0] == pytest.approx(m + 1j * m1 * f0 / g)
    w0, rate = 2 * math.pi * f0, 2 * math.pi * g
    for f in (100.0, 650.0, 2000.0):
        w = 2 * math.pi * f
        k = m1 * w0**2  # u of the membrane, v of a mass on a spring to it
        hidden = np.array([[k - w**2 * m, -k], [-k, k - w**2 * m1]])
        u, _ = np.linalg.solve(hidden, [1.0, 0.0])
        assert bp.Membrane.lorentz(m, f0, m1).at(np.array([f]))[0] == pytest.approx(-1 / (w**2 * u), rel=1e-9)
        # a spring k and a dashpot c in a row, from the membrane to a frame: v is the point between them
        k, c = m * w0**2, m * w0**2 / rate
        held = np.array([[-(w**2) * m + k, -k], [-k, k - 1j * w * c]])
        u, _ = np.linalg.solve(held, [1.0, 0.0])
        assert bp.Membrane.drude(m, f0, g).at(np.array([f]))[0] == pytest.approx(-1 / (w**2 * u), rel=1e-9)
