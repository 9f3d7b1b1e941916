"""Gas in rigid frames: porous materials, slits and tubes as fluids, by models that have names.

All are written for exp(-i w t): what the literature writes for exp(+j w t) is conjugated here. Each model is a frozen record with the
methods `density` and `bulk_modulus`; `OfModel` makes of either the function of frequency that a `Fluid` takes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from .. import validate
from ..conventions import real_or_complex
from .fluids import Fluid


@dataclass(frozen=True)
class Gas:
    """The gas in pores, slits and tubes; air at 20 Celsius by default.

    Parameters
    ----------
    density : float, kg/m3
    pressure : float, Pa
        Static.
    viscosity : float, Pa s
        Shear viscosity.
    heat_capacity_ratio : float
    prandtl : float
        Prandtl number.

    Sources of the defaults: density, pressure and viscosity are those of IEC 61094-2, Annex F, at 20 Celsius and 50 %, rounded; 1.4 and
    0.71 as J.-F. Allard and N. Atalla, Propagation of Sound in Porous Media (2009), have them.

    Examples
    --------
    >>> round(bp.Gas().sound_speed, 1)
    343.8
    """

    density: float = 1.2
    pressure: float = 101325.0
    viscosity: float = 1.81e-5
    heat_capacity_ratio: float = 1.4
    prandtl: float = 0.71

    def __post_init__(self) -> None:
        _make_positive(self)
        if self.heat_capacity_ratio < 1:
            raise validate.refuse("heat_capacity_ratio", "a number of at least 1", self.heat_capacity_ratio)

    @property
    def sound_speed(self) -> float:
        """Of the free gas, without loss [m/s]."""
        return float(np.sqrt(self.heat_capacity_ratio * self.pressure / self.density))


def _make_positive(record: Any) -> None:
    """Turn a frozen record's numbers into floats above zero; a porosity is at most 1."""
    for name in (f.name for f in fields(record) if f.name != "gas"):
        value = validate.as_number(getattr(record, name), name, positive=True)
        if name == "porosity" and value > 1:
            raise validate.refuse(name, "a number above 0, of at most 1", value)
        object.__setattr__(record, name, value)
    if hasattr(record, "gas"):
        validate.instance(record.gas, Gas, "gas")


@dataclass(frozen=True)
class JohnsonChampouxAllard:
    """The model behind `johnson_champoux_allard`."""

    flow_resistivity: float
    porosity: float
    tortuosity: float
    viscous_length: float
    thermal_length: float
    gas: Gas = field(default_factory=Gas)

    def __post_init__(self) -> None:
        _make_positive(self)
        if self.tortuosity < 1:
            raise validate.refuse("tortuosity", "a number of at least 1", self.tortuosity)

    def density(self, frequency: np.ndarray) -> np.ndarray:
        """Johnson's: the flow resistivity at low frequency, tortuosity and a boundary layer at high frequency."""
        w, inertia = 2 * np.pi * frequency, self.tortuosity * self.gas.density / self.porosity
        bend = 4 * inertia * self.tortuosity * self.gas.viscosity / self.porosity
        root = np.sqrt(1 - 1j * w * bend / (self.flow_resistivity * self.viscous_length) ** 2)
        return inertia + 1j * self.flow_resistivity / w * root

    def bulk_modulus(self, frequency: np.ndarray) -> np.ndarray:
        """Champoux and Allard's: isothermal at low frequency, adiabatic at high frequency."""
        ratio = self.gas.heat_capacity_ratio
        across = (
            2 * np.pi * frequency * self.gas.density * self.gas.prandtl * self.thermal_length**2 / self.gas.viscosity
        )
        exchange = 1 + 8j / across * np.sqrt(1 - 1j * across / 16)
        return ratio * self.gas.pressure / self.porosity / (ratio - (ratio - 1) / exchange)


@dataclass(frozen=True)
class DelanyBazleyMiki:
    """The model behind `delany_bazley_miki`."""

    flow_resistivity: float
    gas: Gas = field(default_factory=Gas)

    def __post_init__(self) -> None:
        _make_positive(self)

    def density(self, frequency: np.ndarray) -> np.ndarray:
        """Impedance times wavenumber over w."""
        impedance, index = self._impedance_and_index(frequency)
        return self.gas.density * impedance * index

    def bulk_modulus(self, frequency: np.ndarray) -> np.ndarray:
        """Impedance times w over wavenumber."""
        impedance, index = self._impedance_and_index(frequency)
        return self.gas.heat_capacity_ratio * self.gas.pressure * impedance / index

    def _impedance_and_index(self, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Miki's powers of f / flow_resistivity, over those of the free gas, within the range of the measurements."""
        least, most = 0.01 * self.flow_resistivity, self.flow_resistivity
        outside = (frequency.real < least) | (frequency.real > most)
        if np.any(outside):
            raise ValueError(
                f"frequency: expected {least:g} to {most:g} Hz, where delany_bazley_miki holds for this flow resistivity, "
                f"got {np.atleast_1d(frequency)[np.atleast_1d(outside)][0]:g}"
            )
        share = frequency / self.flow_resistivity
        return 1 + (0.070 + 0.107j) * share**-0.632, 1 + (0.109 + 0.160j) * share**-0.618


#: From so many boundary layers on a channel's mean is that of its walls apart, 1e-12 beside it; Bessel functions end at 1e9.
WIDE = 1e6


@dataclass(frozen=True)
class Channels:
    """The model behind `narrow_slits` (half a slit's width for the size) and `narrow_tubes` (the radius)."""

    size: float
    round: bool
    porosity: float
    gas: Gas = field(default_factory=Gas)

    def density(self, frequency: np.ndarray) -> np.ndarray:
        """Of the gas, over the mean of the velocity that it would have without viscosity."""
        return self.gas.density / self._mean(frequency, 1.0) / self.porosity

    def bulk_modulus(self, frequency: np.ndarray) -> np.ndarray:
        """Adiabatic where the gas keeps its heat, isothermal at the walls."""
        ratio = self.gas.heat_capacity_ratio
        mean = self._mean(frequency, self.gas.prandtl)
        return ratio * self.gas.pressure / (ratio - (ratio - 1) * mean) / self.porosity

    def _mean(self, frequency: np.ndarray, prandtl: float) -> np.ndarray:
        """1 - tanh(s)/s in a slit, 1 - 2 I1(s)/(s I0(s)) in a tube: ratios of Bessel functions, which lose no digits."""
        from scipy.special import ive

        s = self.size * np.sqrt(-2j * np.pi * frequency * prandtl * self.gas.density / self.gas.viscosity)
        order = 0.0 if self.round else -0.5
        wide = np.abs(s) > WIDE
        near = np.where(wide, 1.0, s)
        return np.where(wide, 1 - 2 * (order + 1) / s, ive(order + 2, near) / ive(order, near))


@dataclass(frozen=True)
class OfModel:
    """The density or the bulk modulus of a model as a function of frequency."""

    model: JohnsonChampouxAllard | DelanyBazleyMiki | Channels
    name: str

    def __call__(self, frequency: Any) -> np.ndarray:
        with np.errstate(all="ignore"):  # what is not finite then is refused by the name of the property
            return getattr(self.model, self.name)(real_or_complex(frequency))


def _fluid(model: JohnsonChampouxAllard | DelanyBazleyMiki | Channels, density_x: float | None = None) -> Fluid:
    return Fluid(OfModel(model, "density"), OfModel(model, "bulk_modulus"), density_x)


def johnson_champoux_allard(
    flow_resistivity: float,
    porosity: float,
    tortuosity: float,
    viscous_length: float,
    thermal_length: float,
    gas: Gas | None = None,
) -> Fluid:
    """A porous material with a rigid frame as a fluid, by Johnson, Champoux and Allard.

    Parameters
    ----------
    flow_resistivity : float, Pa s/m2
        Static.
    porosity : float
        Above 0, at most 1.
    tortuosity : float
        At high frequency; at least 1.
    viscous_length, thermal_length : float, m
        Characteristic lengths.
    gas : Gas, optional
        In the pores; air.

    Returns
    -------
    Fluid
        Pressure and mean velocity over the whole cross-section (not over that of the pores alone).

    Raises
    ------
    ValueError
        Names the argument.

    Sources: D. L. Johnson, J. Koplik and R. Dashen, J. Fluid Mech. 176, 379 (1987); Y. Champoux and J.-F. Allard, J. Appl.
    Phys. 70, 1975 (1991).

    Examples
    --------
    >>> foam = bp.johnson_champoux_allard(10e3, 0.97, 1.1, viscous_length=100e-6, thermal_length=200e-6)
    >>> wall = bp.Slab.uniform(foam, 0.05)
    >>> round(float(bp.scattering(wall, 1000.0, angle=0).absorption), 2)
    0.62
    """
    return _fluid(
        JohnsonChampouxAllard(
            flow_resistivity, porosity, tortuosity, viscous_length, thermal_length, Gas() if gas is None else gas
        )
    )


def delany_bazley_miki(flow_resistivity: float, gas: Gas | None = None) -> Fluid:
    """A fibrous absorber of porosity near 1 as a fluid, by Delany and Bazley's measurements with Miki's powers.

    Parameters
    ----------
    flow_resistivity : float, Pa s/m2
    gas : Gas, optional
        In the pores; air.

    Raises
    ------
    ValueError
        Names the argument; and when the fluid is asked for frequencies outside of 0.01 to 1 times `flow_resistivity` (in Hz),
        where nothing was measured.

    Sources: M. E. Delany and E. N. Bazley, Appl. Acoust. 3, 105 (1970); Y. Miki, J. Acoust. Soc. Jpn. (E) 11, 19 (1990).

    Examples
    --------
    >>> wool = bp.Slab.uniform(bp.delany_bazley_miki(20e3), 0.05)
    >>> bool(0 < bp.scattering(wool, 1000.0, angle=0).absorption < 1)
    True
    """
    return _fluid(DelanyBazleyMiki(flow_resistivity, Gas() if gas is None else gas))


def narrow_slits(width: float, porosity: float = 1.0, gas: Gas | None = None) -> Fluid:
    """Gas in parallel slits along z between rigid walls, with viscous and thermal losses.

    Parameters
    ----------
    width : float, m
        Of a slit.
    porosity : float
        The slits' share of the cross-section; 1 for walls without thickness.
    gas : Gas, optional
        Air.

    Returns
    -------
    Fluid
        With ``density_x = inf``, for nothing moves across the walls; the slits have to be narrow beside the wavelength.

    Raises
    ------
    ValueError
        Names the argument.

    Sources: C. Zwikker and C. W. Kosten, Sound Absorbing Materials (1949); M. R. Stinson, J. Acoust. Soc. Am. 89, 550 (1991).

    Examples
    --------
    >>> grid = bp.Slab.uniform(bp.narrow_slits(0.2e-3, porosity=0.2), 0.01)
    >>> round(float(bp.scattering(grid, 500.0, angle=0).absorption), 2)
    0.36
    """
    return _channels("width", width, 0.5, False, porosity, gas)


def narrow_tubes(radius: float, porosity: float = 1.0, gas: Gas | None = None) -> Fluid:
    """Gas in parallel round tubes along z, with viscous and thermal losses: as `narrow_slits`, of a `radius` [m].

    Examples
    --------
    >>> plate = bp.Slab.uniform(bp.narrow_tubes(0.2e-3, porosity=0.05), 1e-3)  # perforated
    >>> round(float(bp.scattering(plate, 500.0, angle=0).absorption), 2)
    0.15
    """
    return _channels("radius", radius, 1.0, True, porosity, gas)


def _channels(name: str, size: float, share: float, is_round: bool, porosity: float, gas: Gas | None) -> Fluid:
    size = validate.as_number(size, name, positive=True)
    porosity = validate.as_number(porosity, "porosity", positive=True)
    if porosity > 1:
        raise validate.refuse("porosity", "a number above 0, of at most 1", porosity)
    gas = validate.instance(Gas() if gas is None else gas, Gas, "gas")
    return _fluid(Channels(size * share, is_round, porosity, gas), np.inf)


#: The functions of frequency made here, and what they are made of: a file records them by their numbers, not as a table.
FUNCTIONS: tuple[type, ...] = (Gas, JohnsonChampouxAllard, DelanyBazleyMiki, Channels, OfModel)
