"""Solids: density and two wave speeds, or moduli; checked when they are made or evaluated."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .. import validate
from ..conventions import real_or_complex
from ..validate import as_complex
from .properties import PROPERTY, Property, check_property, property_values


class SolidValues(NamedTuple):
    """A solid at given frequencies: arrays of frequency's shape."""

    density: np.ndarray
    longitudinal_modulus: np.ndarray  # rho cL^2
    shear_modulus: np.ndarray  # rho cT^2


class SolidLayers(NamedTuple):
    """N solid layers in contact at F frequencies, from the near side on: arrays (N, F), thickness (N,)."""

    density: np.ndarray
    longitudinal_modulus: np.ndarray
    shear_modulus: np.ndarray
    thickness: np.ndarray


class SolidBlock(NamedTuple):
    """Solid layers in contact, and how often they repeat."""

    layers: SolidLayers
    periods: int

    @property
    def thickness(self) -> float:
        """Of all periods [m]."""
        return self.periods * float(self.layers.thickness.sum())


class SolidHalfSpace(NamedTuple):
    """A half-space of solid at F frequencies, arrays (F,), and the solid layers in contact with it, from the near side on."""

    density: np.ndarray
    longitudinal_modulus: np.ndarray
    shear_modulus: np.ndarray
    run: tuple[SolidBlock, ...]


@dataclass(frozen=True)
class Solid:
    """An isotropic elastic solid, which carries longitudinal and shear waves.

    Parameters
    ----------
    density : complex, or function of frequency; kg/m3
    longitudinal_speed, shear_speed : complex, or function of frequency; m/s
        A function takes an array of frequencies [Hz] and returns an array of the same shape. Loss is a negative
        imaginary part of a speed (``exp(-i w t)``). A shear speed of 0 is a `Fluid`.
    active : bool
        Allow gain, and speeds of a solid that is not stable, which are refused otherwise.

    Raises
    ------
    ValueError
        NaN, infinite or vanishing values, gain (Im(shear modulus) > 0 or Im(bulk modulus) > 0), and speeds with
        longitudinal_speed^2 <= 4/3 shear_speed^2: a bulk modulus that is not positive.

    Examples
    --------
    >>> steel = bp.Solid(7900.0, longitudinal_speed=5900.0, shear_speed=3200.0)
    >>> plate = bp.Slab(bp.Layer(steel, 1e-3), background=bp.Fluid.from_speed(1000.0, 1480.0))
    >>> ds = bp.scattering(plate, 3e6, angle=[0.0, 20.0])
    >>> bool((abs(ds.reflectivity + ds.transmissivity - 1) < 1e-12).all())
    True
    """

    density: Property
    longitudinal_speed: Property
    shear_speed: Property
    active: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        for name in ("density", "longitudinal_speed", "shear_speed"):
            value = getattr(self, name)
            if not callable(value):
                object.__setattr__(self, name, as_complex(value, name, PROPERTY))
        if not self.dispersive:
            self.at(np.zeros(()))

    @classmethod
    def from_moduli(
        cls, density: Property, bulk_modulus: Property, shear_modulus: Property, *, active: bool = False
    ) -> Solid:
        """A solid by its bulk and shear modulus [Pa], numbers or functions of frequency.

        Examples
        --------
        >>> rubber = bp.Solid.from_moduli(1100.0, 2.4e9 - 1e7j, 1e6 - 2e5j)
        >>> bool(abs(rubber.longitudinal_speed.real - 1477.5) < 0.1)
        True
        """
        given = {"density": density, "bulk_modulus": bulk_modulus, "shear_modulus": shear_modulus}
        numbers = [v if callable(v) else as_complex(v, name, PROPERTY) for name, v in given.items()]
        for name, value in zip(given, numbers, strict=True):
            if value == 0:
                raise ValueError(f"{name}: expected a number other than zero, got 0")
        rho, bulk, shear = numbers
        speeds = SpeedOfModuli(rho, bulk, shear, 4 / 3), SpeedOfModuli(rho, 0j, shear, 1.0)
        if any(callable(v) for v in numbers):
            return cls(rho, *speeds, active=active)
        _check_moduli(np.asarray(bulk), np.asarray(shear), ("bulk_modulus", "shear_modulus"), active)
        return cls(rho, *(complex(speed(np.zeros(()))) for speed in speeds), active=active)

    @classmethod
    def from_material(cls, name: str) -> Solid:
        """A solid of `materials` by its name, without loss.

        Examples
        --------
        >>> bp.Solid.from_material("steel")
        Solid(density=7850, longitudinal_speed=5960, shear_speed=3235)
        """
        from .materials import solid_numbers

        return cls(*solid_numbers(name))

    @property
    def dispersive(self) -> bool:
        """Whether any property is a function of frequency."""
        return any(callable(v) for v in (self.density, self.longitudinal_speed, self.shear_speed))

    def at(self, frequency: Any) -> SolidValues:
        """Density and moduli at frequencies [Hz], real or complex, as complex arrays of frequency's shape."""
        frequency = real_or_complex(frequency)
        names = ("density", "longitudinal_speed", "shear_speed")
        rho, c_l, c_t = (property_values(getattr(self, name), frequency, name) for name in names)
        active = self.active or np.iscomplexobj(frequency)
        for name, v in zip(names, (rho, c_l, c_t), strict=True):
            check_property(v, name, gain_sign=1, active=active or name != "density", zero=False)
        if not active and np.any(rho.real <= 0):
            given = rho[rho.real <= 0].flat[0].real
            raise ValueError(f"density: expected a value above zero, got {given:g}; active=True allows it")
        shear, modulus = rho * c_t * c_t, rho * c_l * c_l
        _check_moduli(modulus - 4 / 3 * shear, shear, ("longitudinal_speed", "shear_speed"), active)
        return SolidValues(rho, modulus, shear)

    def __repr__(self) -> str:
        def show(v: Any) -> str:
            if callable(v):
                return getattr(v, "__name__", None) or repr(v)
            return f"{v.real:.6g}" if v.imag == 0 else f"{v:.6g}"

        names = ("density", "longitudinal_speed", "shear_speed")
        return f"Solid({', '.join(f'{name}={show(getattr(self, name))}' for name in names)})"


@dataclass(frozen=True)
class SpeedOfModuli:
    """sqrt((bulk modulus + share shear modulus)/density) as a function of frequency."""

    density: Property
    bulk_modulus: Property
    shear_modulus: Property
    share: float

    def __call__(self, frequency: Any) -> np.ndarray:
        names = ("density", "bulk_modulus", "shear_modulus")
        f = real_or_complex(frequency)
        rho, bulk, shear = (property_values(getattr(self, name), f, name) for name in names)
        return np.sqrt((bulk + self.share * shear) / rho)


def _check_moduli(bulk: np.ndarray, shear: np.ndarray, names: tuple[str, str], active: bool) -> None:
    """Refuse gain, a bulk modulus that is not positive, and a negative shear modulus without the loss of a resonance."""
    if active:
        return
    rounding = 1e-13 * (np.abs(bulk) + np.abs(shear))
    for name, modulus, values in ((names[1], "shear modulus", shear), (names[0], "bulk modulus", bulk)):
        gain = values.imag > rounding
        if np.any(gain):
            raise ValueError(
                f"{name}: expected a passive solid, Im({modulus}) <= 0 with exp(-i w t), got {values[gain].flat[0]} Pa; "
                "pass active=True for a solid with gain"
            )
    unstable = (shear.real < 0) & (shear.imag > -rounding)
    if np.any(unstable):
        raise ValueError(
            f"{names[1]}: expected a stable solid, with a shear modulus above zero, got {shear[unstable].flat[0].real:g} Pa; "
            "active=True allows it"
        )
    unstable = bulk.real <= 0
    if np.any(unstable):
        raise ValueError(
            f"{names[0]}: expected a stable solid, longitudinal_speed^2 > 4/3 shear_speed^2, got a bulk modulus of "
            f"{bulk[unstable].flat[0].real:g} Pa; active=True allows it"
        )
