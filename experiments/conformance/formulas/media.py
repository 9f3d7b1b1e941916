"""Porous media, channels, mixtures and attenuation as their sources print them.

The sources of porous media and channels write exp(+j w t); what they give is conjugated in the last line. `gas` is (density, pressure,
viscosity, ratio of heat capacities, Prandtl number).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

from scipy.special import jv

from .layers import Fluid

#: Density, pressure, viscosity, ratio of heat capacities, Prandtl number.
Gas = tuple[float, float, float, float, float]


def johnson_champoux_allard(gas: Gas, w: float, parameters: tuple[float, ...]) -> tuple[complex, complex]:
    """Density and modulus over the porosity: Allard and Atalla 2009, Eqs. (5.50) and (5.55)."""
    rho0, p0, eta, gamma, prandtl = gas
    sigma, phi, a, viscous, thermal = parameters
    g = cmath.sqrt(1 + 4j * a * a * eta * rho0 * w / (sigma * viscous * phi) ** 2)
    rho = a * rho0 * (1 + sigma * phi / (1j * w * rho0 * a) * g)
    h = cmath.sqrt(1 + 1j * rho0 * w * prandtl * thermal**2 / (16 * eta))
    K = gamma * p0 / (gamma - (gamma - 1) / (1 + 8 * eta / (1j * thermal**2 * prandtl * w * rho0) * h))
    return (rho / phi).conjugate(), (K / phi).conjugate()


def miki(gas: Gas, frequency: float, sigma: float) -> tuple[complex, complex]:
    """Characteristic impedance and wavenumber: Miki 1990, Eqs. (33) and (34)."""
    rho0, p0, _, gamma, _ = gas
    c, x = math.sqrt(gamma * p0 / rho0), frequency / sigma
    impedance = rho0 * c * (1 + 0.070 * x**-0.632 - 0.107j * x**-0.632)
    k = 2 * math.pi * frequency / c * (1 + 0.109 * x**-0.618 - 0.160j * x**-0.618)
    return impedance.conjugate(), k.conjugate()


def channel(gas: Gas, s: complex, ratio: Callable[[complex], complex]) -> tuple[complex, complex]:
    """Density and modulus of gas between walls, from what friction and heat leave out of the mean flow, at s and s sqrt(Prandtl)."""
    rho0, p0, _, gamma, prandtl = gas
    rho = rho0 / (1 - ratio(s))
    K = gamma * p0 / (1 + (gamma - 1) * ratio(s * math.sqrt(prandtl)))
    return rho.conjugate(), K.conjugate()


def tube(gas: Gas, w: float, radius: float) -> tuple[complex, complex]:
    """Round ones, by Bessel functions: 2 J1(s)/(s J0(s)) (Stinson 1991)."""
    return channel(gas, radius * cmath.sqrt(-1j * w * gas[0] / gas[2]), lambda s: 2 * jv(1, s) / (s * jv(0, s)))


def slit(gas: Gas, w: float, width: float) -> tuple[complex, complex]:
    """Plane ones, by hyperbolic tangents: tanh(s)/s (Allard and Atalla 2009, section 4.7)."""
    return channel(gas, width / 2 * cmath.sqrt(1j * w * gas[0] / gas[2]), lambda s: cmath.tanh(s) / s)


def rigidly_backed_absorption(rho: complex, K: complex, w: float, thickness: float, around: Fluid) -> float:
    """1 - |r|^2 of a layer before a rigid wall: its impedance is i Z cot(k d) for exp(-i w t) (Allard and Atalla 2009, chapter 2)."""
    k, z = w * cmath.sqrt(rho / K), cmath.sqrt(rho * K)
    surface, z0 = 1j * z / cmath.tan(k * thickness), around[0] * around[1]
    return 1 - abs((surface - z0) / (surface + z0)) ** 2


def wood_speed(first: Fluid, second: Fluid, share: float) -> float:
    """Speed in a mixture with a share of the second fluid (density, sound speed): mean density, mean compressibility (Wood 1930)."""
    rho = (1 - share) * first[0] + share * second[0]
    compressibility = (1 - share) / (first[0] * first[1] ** 2) + share / (second[0] * second[1] ** 2)
    return (rho * compressibility) ** -0.5


def slowness_excess(exponent: float, alpha0: float, w0: float, w: float) -> float:
    """1/c - 1/c0 of a power law alpha0 (w/w0)^y: Waters et al. 2000, tan(pi y/2) or, for y = 1, the logarithm."""
    if exponent == 1:
        return -2 / math.pi * alpha0 / w0 * math.log(w / w0)
    return alpha0 / w0 * math.tan(math.pi * exponent / 2) * ((w / w0) ** (exponent - 1) - 1)


def rod_speed(longitudinal: float, shear: float) -> float:
    """sqrt(E / rho) of a thin rod from the speeds in the bulk."""
    l2, s2 = longitudinal**2, shear**2
    return shear * math.sqrt((3 * l2 - 4 * s2) / (l2 - s2))
