"""Humid air and pure water by their conditions: published fits, each within its own range."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import validate
from ..conventions import real_or_complex

#: 0 degrees Celsius [K].
KELVIN = 273.15
#: Mole fraction of carbon dioxide in the air of a laboratory, as CIPM-2007 recommends it.
CARBON_DIOXIDE = 4e-4
#: The range of Cramer's fit, narrower than that of the others. [Celsius, %, Pa]
AIR_RANGE = {"temperature": (0.0, 30.0), "humidity": (0.0, 100.0), "pressure": (75e3, 102e3)}
#: Marczak's range. [Celsius]
WATER_RANGE = {"temperature": (0.0, 95.0)}


@dataclass(frozen=True)
class Air:
    """Air at a temperature [Celsius], relative humidity [%] and pressure [Pa].

    Sources: density by A. Picard et al., CIPM-2007, Metrologia 45, 149 (2008); sound speed by O. Cramer, J. Acoust. Soc. Am. 93,
    2510 (1993); absorption by ISO 9613-1:1993.
    """

    temperature: float = 20.0
    humidity: float = 50.0
    pressure: float = 101325.0

    def __post_init__(self) -> None:
        in_range(self, AIR_RANGE)

    @property
    def vapour(self) -> float:
        """Mole fraction of water vapour, CIPM-2007."""
        T = self.temperature + KELVIN
        saturation = math.exp(1.2378847e-5 * T**2 - 1.9121316e-2 * T + 33.93711047 - 6.3431645e3 / T)
        enhancement = 1.00062 + 3.14e-8 * self.pressure + 5.6e-7 * self.temperature**2
        return self.humidity / 100 * enhancement * saturation / self.pressure

    @property
    def density(self) -> float:
        """Density [kg/m3], CIPM-2007."""
        t, p, x = self.temperature, self.pressure, self.vapour
        p_over_T = p / (t + KELVIN)
        virial = 1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t**2
        virial += (5.707e-6 - 2.051e-8 * t) * x + (1.9898e-4 - 2.376e-6 * t) * x**2
        compressibility = 1 - p_over_T * virial + p_over_T**2 * (1.83e-11 - 0.765e-8 * x**2)
        molar_mass = 28.96546e-3 + 12.011e-3 * (CARBON_DIOXIDE - 4e-4)
        return p_over_T * molar_mass / (compressibility * 8.314472) * (1 - x * (1 - 18.01528e-3 / molar_mass))

    @property
    def sound_speed(self) -> float:
        """Sound speed at low frequency [m/s], Cramer's Eq. (15)."""
        t, p, x, c = self.temperature, self.pressure, self.vapour, CARBON_DIOXIDE
        speed = 331.5024 + 0.603055 * t - 0.000528 * t**2 + (51.471935 + 0.1495874 * t - 0.000782 * t**2) * x
        speed += (-1.82e-7 + 3.73e-8 * t - 2.93e-10 * t**2) * p + (-85.20931 - 0.228525 * t + 5.91e-5 * t**2) * c
        return speed - 2.835149 * x**2 - 2.15e-13 * p**2 + 29.179762 * c**2 + 0.000486 * x * p * c

    def __call__(self, frequency: Any) -> np.ndarray:
        """Attenuation [Np/m] at frequencies [Hz]: ISO 9613-1, whose range is 40 Hz to 1 MHz at one atmosphere."""
        f = real_or_complex(frequency)
        T, p = (self.temperature + KELVIN) / 293.15, self.pressure / 101325
        saturation = 10 ** (-6.8346 * (273.16 / (T * 293.15)) ** 1.261 + 4.6151)
        h = self.humidity * saturation / p  # molar concentration of vapour, %
        oxygen = p * (24 + 4.04e4 * h * (0.02 + h) / (0.391 + h))
        nitrogen = p / math.sqrt(T) * (9 + 280 * h * math.exp(-4.170 * (T ** (-1 / 3) - 1)))
        relaxation = 0.01275 * math.exp(-2239.1 / (T * 293.15)) / (oxygen + f**2 / oxygen)
        relaxation = relaxation + 0.1068 * math.exp(-3352.0 / (T * 293.15)) / (nitrogen + f**2 / nitrogen)
        return f**2 * (1.84e-11 / p * math.sqrt(T) + T**-2.5 * relaxation)


@dataclass(frozen=True)
class Water:
    """Pure water at a temperature [Celsius] and atmospheric pressure.

    Sources: density by G. S. Kell, J. Chem. Eng. Data 20, 97 (1975), Eq. (16); sound speed by W. Marczak, J. Acoust. Soc. Am.
    102, 2776 (1997); absorption by R. E. Francois and G. R. Garrison, J. Acoust. Soc. Am. 72, 1879 (1982), their term of pure
    water.
    """

    temperature: float = 20.0

    def __post_init__(self) -> None:
        in_range(self, WATER_RANGE)

    @property
    def density(self) -> float:
        """Density [kg/m3]."""
        t = self.temperature
        cubic = 999.83952 + 16.945176 * t - 7.9870401e-3 * t**2 - 46.170461e-6 * t**3
        return (cubic + 105.56302e-9 * t**4 - 280.54253e-12 * t**5) / (1 + 16.879850e-3 * t)

    @property
    def sound_speed(self) -> float:
        """Sound speed [m/s]."""
        t = self.temperature
        quadratic = 1402.385 + 5.038813 * t - 5.799136e-2 * t**2
        return quadratic + 3.287156e-4 * t**3 - 1.398845e-6 * t**4 + 2.787860e-9 * t**5

    @property
    def attenuation_over_f2(self) -> float:
        """Attenuation over the frequency squared [dB/km/kHz2]."""
        t = self.temperature
        if t <= 20:
            return 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t**2 - 1.50e-8 * t**3
        return 3.964e-4 - 1.146e-5 * t + 1.45e-7 * t**2 - 6.5e-10 * t**3


def in_range(conditions: Any, ranges: dict[str, tuple[float, float]]) -> None:
    """Turn the fields of a frozen record into numbers, and refuse what lies outside of the fits' ranges."""
    units = {"temperature": "Celsius", "humidity": "%", "pressure": "Pa"}
    for name, (least, most) in ranges.items():
        value = validate.as_number(getattr(conditions, name), name)
        if not least <= value <= most:
            raise validate.refuse(name, f"{least:g} to {most:g} {units[name]}, where the fits hold", value)
        object.__setattr__(conditions, name, value)


#: The functions of frequency made here: a file records them by their numbers, not as a table.
FUNCTIONS: tuple[type, ...] = (Air,)
