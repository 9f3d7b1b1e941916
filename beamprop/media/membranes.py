"""Membranes: mass without thickness, and areal densities that resonate, Drude's and Lorentz's."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from .. import validate
from ..conventions import real_or_complex
from .properties import PROPERTY, Property, check_property, property_values


@dataclass(frozen=True)
class DrudeMass:
    """``m (1 - fc^2 / (f^2 + i f g))``: negative below the cut-off frequency."""

    areal_density: float
    cutoff_frequency: float
    linewidth: float

    def __post_init__(self) -> None:
        _check(self)

    def __call__(self, frequency: Any) -> np.ndarray:
        f = real_or_complex(frequency)
        with np.errstate(all="ignore"):  # what is not finite then is refused by name
            return self.areal_density * (1 - self.cutoff_frequency**2 / (f * (f + 1j * self.linewidth)))


@dataclass(frozen=True)
class LorentzMass:
    """``m + m1 f0^2 / (f0^2 - f^2 - i f g)``: a mass on a spring, hidden in the membrane."""

    areal_density: float
    resonance_frequency: float
    resonator_density: float
    linewidth: float

    def __post_init__(self) -> None:
        _check(self)

    def __call__(self, frequency: Any) -> np.ndarray:
        f, f0 = real_or_complex(frequency), self.resonance_frequency
        with np.errstate(
            divide="ignore", invalid="ignore"
        ):  # a resonance without loss is infinite: refused by name later
            return self.areal_density + self.resonator_density * f0**2 / ((f0 - f) * (f0 + f) - 1j * self.linewidth * f)


def _check(record: Any) -> None:
    """Turn a frozen record's numbers into floats: above zero, a linewidth of at least zero."""
    for name in (f.name for f in fields(record)):
        value = validate.as_number(getattr(record, name), name, positive=name != "linewidth")
        if value < 0:
            raise validate.refuse(name, "a number of at least 0", value)
        object.__setattr__(record, name, value)


@dataclass(frozen=True)
class Membrane:
    """A surface without thickness that carries mass: p jumps by ``areal_density * q`` across it.

    A limp membrane of `areal_density` kg/m2 (complex, or a function of frequency); the interface term of the
    effective medium is one, with a negative value on one face.

    Examples
    --------
    >>> sheet = bp.Slab([bp.Membrane(0.3), bp.Layer(bp.AIR, 0.01)])
    >>> T = float(bp.scattering(sheet, 1000.0, angle=0).transmissivity)
    >>> mass_law = 1 / (1 + (2 * np.pi * 1000.0 * 0.3 / (2 * 1.25 * 343)) ** 2)
    >>> bool(np.isclose(T, mass_law))
    True
    """

    areal_density: Property
    active: bool = field(default=False, kw_only=True)
    thickness = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        if not callable(self.areal_density):
            value = validate.as_complex(self.areal_density, "areal_density", PROPERTY)
            object.__setattr__(self, "areal_density", value)
            check_property(value, "areal_density", gain_sign=1, active=self.active)

    @classmethod
    def drude(cls, areal_density: float, cutoff_frequency: float, linewidth: float = 0.0) -> Membrane:
        """A membrane whose mass is negative below a cut-off, ``areal_density (1 - fc^2 / (f^2 + i f linewidth))``.

        A membrane in a grid that holds it (S. H. Lee et al., Phys. Lett. A 373, 4464 (2009)); `areal_density` [kg/m2] is its own,
        `cutoff_frequency` [Hz] the resonance on its grid, `linewidth` [Hz] the damping rate over 2 pi.

        Examples
        --------
        >>> sheet = bp.Membrane.drude(0.1, cutoff_frequency=700.0)
        >>> sheet.at(np.array([350.0, 700.0])).real.round(12).tolist()
        [-0.3, 0.0]
        """
        return cls(DrudeMass(areal_density, cutoff_frequency, linewidth))

    @classmethod
    def lorentz(
        cls, areal_density: float, resonance_frequency: float, resonator_density: float, linewidth: float = 0.0
    ) -> Membrane:
        """A membrane with resonators, ``areal_density + resonator_density f0^2 / (f0^2 - f^2 - i f linewidth)``.

        Masses of `resonator_density` [kg/m2] on springs (H. H. Huang, C. T. Sun and G. L. Huang, Int. J. Eng. Sci. 47, 610 (2009)),
        which ring at `resonance_frequency` [Hz]; `linewidth` [Hz] is the damping rate over 2 pi.

        Examples
        --------
        >>> sheet = bp.Membrane.lorentz(0.1, 500.0, resonator_density=0.3)
        >>> sheet.at(np.array([1.0, 550.0])).real.round(3).tolist()
        [0.4, -1.329]
        """
        return cls(LorentzMass(areal_density, resonance_frequency, resonator_density, linewidth))

    def at(self, frequency: np.ndarray) -> np.ndarray:
        """Areal density at frequencies [Hz], checked; gain is refused at real ones only, as in `Fluid.at`."""
        values = property_values(self.areal_density, frequency, "areal_density")
        if callable(self.areal_density):
            active = self.active or np.iscomplexobj(frequency)
            check_property(values, "areal_density", gain_sign=1, active=active)
        return values


#: The functions of frequency made here: a file records them by their numbers, not as a table.
FUNCTIONS: tuple[type, ...] = (DrudeMass, LorentzMass)
