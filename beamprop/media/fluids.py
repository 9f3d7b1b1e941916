"""Fluids: density and bulk modulus, checked when they are made or evaluated."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .. import validate
from ..conventions import branch_wavenumber, real_or_complex
from ..validate import as_complex
from .attenuation import Attenuation, LossyModulus
from .hints import warn_of_modulus
from .properties import PROPERTY, Property, check_property, property_values


class FluidValues(NamedTuple):
    """A fluid at given frequencies: arrays of frequency's shape."""

    rho_z: np.ndarray
    rho_x: np.ndarray
    bulk_modulus: np.ndarray


@dataclass(frozen=True)
class Fluid:
    """A fluid with a scalar bulk modulus and a density that may differ along x and z.

    Parameters
    ----------
    density : complex, or function of frequency; kg/m3
        Along z, and along x too unless `density_x` is given. A function takes an array of frequencies [Hz]
        and returns an array of the same shape.
    bulk_modulus : complex, or function of frequency; Pa
    density_x : complex, or function of frequency, optional; kg/m3
        ``inf`` is legitimate: no motion along x at all.
    active : bool
        Allow gain, which is refused otherwise (Im(density) < 0 or Im(bulk_modulus) > 0).

    Raises
    ------
    ValueError
        NaN or infinite values, bulk_modulus 0, gain, or density_x = 0 beside another density.

    Examples
    --------
    >>> water = bp.Fluid(1000.0, bulk_modulus=2.19e9)
    >>> round(float(water.wavenumber(2500.0).real), 2)
    10.61
    >>> foam = bp.Fluid(lambda f: 2.0 + 500j / f, 1.2e5)  # by frequency [Hz], with loss
    >>> foam.dispersive
    True
    """

    density: Property
    bulk_modulus: Property
    density_x: Property | None = None
    active: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        if self._is_plain():
            warn_of_modulus(self.density, self.bulk_modulus)
            return
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        for name in ("density", "bulk_modulus", "density_x"):
            value = getattr(self, name)
            if not callable(value) and not (name == "density_x" and value is None):
                object.__setattr__(self, name, as_complex(value, name, PROPERTY))
        given = (self.density, self.bulk_modulus, self.density_x)
        self._check(self.active, *(None if callable(v) else v for v in given))
        if self.density_x is None:
            warn_of_modulus(self.density, self.bulk_modulus)

    def _is_plain(self) -> bool:
        """Whether there is nothing to convert or to refuse: a shorter way to the same, for a slab has many layers."""
        return (
            self.active is False
            and self.density_x is None
            and type(self.density) is type(self.bulk_modulus) is complex
            and validate.is_usual(self.density)
            and validate.is_usual(self.bulk_modulus)
            and self.density.imag >= 0 >= self.bulk_modulus.imag
        )

    def _check(self, active: bool, density: Any = None, bulk_modulus: Any = None, density_x: Any = None) -> None:
        if density is not None:
            check_property(density, "density", gain_sign=1, active=active)
        if bulk_modulus is not None:
            check_property(bulk_modulus, "bulk_modulus", gain_sign=-1, active=active, zero=False)
        if density_x is not None:
            check_property(density_x, "density_x", gain_sign=1, active=active, infinite=True)
            if np.any(np.asarray(density_x) == 0):
                raise ValueError(
                    "density_x: expected a value other than zero, which has no finite limit beside a density, got 0"
                )

    @classmethod
    def from_speed(
        cls, density: complex, sound_speed: complex, attenuation: Attenuation = 0.0, *, active: bool = False
    ) -> Fluid:
        """A fluid by its density, speed of sound and attenuation.

        Parameters
        ----------
        density : complex, kg/m3
        sound_speed : complex, m/s
            Phase velocity; real, like the density, beside an attenuation.
        attenuation : float, or function of frequency; Np/m
            Of the pressure, as exp(-attenuation x): at every frequency the same, or `power_law`, a `Tabulated` or any
            function of the frequency [Hz]. The bulk modulus is ``density w^2 / (w/sound_speed + i attenuation)^2``.
        active : bool
            Allow gain.

        Raises
        ------
        ValueError
            Zero, NaN or infinite values, gain, and complex numbers beside an attenuation.

        Examples
        --------
        >>> gel = bp.Fluid.from_speed(1020.0, 1510.0, attenuation=5.0)
        >>> float(gel.wavenumber(1e6).imag.round(9))
        5.0
        """
        rho, c = as_complex(density, "density"), as_complex(sound_speed, "sound_speed")
        if not (np.isfinite(rho) and rho != 0):
            raise ValueError(f"density: expected a finite number other than zero beside a speed, got {density!r}")
        if not (np.isfinite(c) and c != 0):
            raise ValueError(f"sound_speed: expected a finite number other than zero, got {sound_speed!r}")
        for name, value in (("density", rho), ("sound_speed", c), ("sound_speed", rho * c * c)):
            validate.within(value, name)
        active = validate.flag(active, "active")
        if callable(attenuation) or validate.as_number(attenuation, "attenuation") != 0:
            return cls(rho, _lossy_modulus(rho, c, attenuation, active), active=active)
        if not active and (rho * c * c).imag > 0 and rho.imag >= 0:
            raise ValueError(
                f"{'density' if rho.imag else 'sound_speed'}: expected a passive medium, Im(bulk_modulus) <= 0 with exp(-i w t) "
                f"and bulk_modulus = density * sound_speed^2, got {density if rho.imag else sound_speed!r}; "
                "pass active=True for a medium with gain"
            )
        return cls(rho, rho * c * c, active=active)

    @property
    def dispersive(self) -> bool:
        """Whether any property is a function of frequency."""
        return any(callable(v) for v in (self.density, self.bulk_modulus, self.density_x))

    def at(self, frequency: Any) -> FluidValues:
        """The properties at frequencies [Hz], as complex arrays of frequency's shape.

        Complex frequencies reach functions of frequency as they are. A passive medium may show Im(density) < 0 at them, so
        that gain is refused at real ones only.
        """
        frequency = real_or_complex(frequency)
        rho_z = property_values(self.density, frequency, "density")
        K = property_values(self.bulk_modulus, frequency, "bulk_modulus")
        rho_x = rho_z if self.density_x is None else property_values(self.density_x, frequency, "density_x")
        if self.dispersive:
            active = self.active or np.iscomplexobj(frequency)
            self._check(active, rho_z, K, None if self.density_x is None else rho_x)
        return FluidValues(rho_z, rho_x, K)

    def wavenumber(self, frequency: Any) -> np.ndarray:
        """The lateral wavenumber at which waves turn evanescent, w sqrt(rho_x / K) [rad/m]; frequency [Hz] real or complex."""
        frequency = real_or_complex(frequency)
        v = self.at(frequency)
        return branch_wavenumber(2 * np.pi * frequency, v.rho_x, v.bulk_modulus)

    def __repr__(self) -> str:
        def show(v: Any) -> str:
            if callable(v):
                return getattr(v, "__name__", None) or repr(v)
            return f"{v.real:.6g}" if v.imag == 0 else f"{v:.6g}"

        along_x = "" if self.density_x is None else f", density_x={show(self.density_x)}"
        return f"Fluid(density={show(self.density)}, bulk_modulus={show(self.bulk_modulus)}{along_x})"


def _lossy_modulus(density: complex, sound_speed: complex, attenuation: Attenuation, active: bool) -> LossyModulus:
    """The bulk modulus of a fluid with attenuation, its numbers checked."""
    for name, value in (("density", density), ("sound_speed", sound_speed)):
        if value.imag != 0 or value.real <= 0:
            raise validate.refuse(name, "a real number above zero beside an attenuation", value)
    if not callable(attenuation):
        attenuation = validate.as_number(attenuation, "attenuation")
        if attenuation < 0 and not active:
            expected = "at least 0 Np/m (active=True allows gain)"
            raise validate.refuse("attenuation", expected, attenuation)
    return LossyModulus(density.real, sound_speed.real, attenuation, active)


#: Air as in the paper: 1.25 kg/m3, 343 m/s.
AIR = Fluid.from_speed(1.25, 343.0)
