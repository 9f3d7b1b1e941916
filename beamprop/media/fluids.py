"""Fluids: density and bulk modulus, as numbers or functions of frequency, checked when they are made or evaluated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .. import validate
from ..conventions import branch_wavenumber, real_or_complex
from ..validate import as_complex

Property = complex | Callable[[np.ndarray], np.ndarray]


def check_property(
    values: Any, name: str, *, gain_sign: int, active: bool, infinite: bool = False, zero: bool = True
) -> None:
    """Refuse NaN, infinity and zero (unless legitimate), gain, and what double precision cannot compute with."""
    values = np.atleast_1d(np.asarray(values, dtype=complex))
    allowed = np.isfinite(values) | (np.isinf(values) if infinite else False)
    if not np.all(allowed):
        raise ValueError(f"{name}: expected finite values, got {values[~allowed][0]}")
    if not zero and np.any(values == 0):
        raise ValueError(f"{name}: expected a value other than zero, got 0")
    validate.within(values[values != 0], name)
    gain = np.isfinite(values) & (gain_sign * values.imag < 0)
    if not active and np.any(gain):
        relation = ">= 0" if gain_sign > 0 else "<= 0"
        raise ValueError(
            f"{name}: expected a passive medium, Im({name}) {relation} with exp(-i w t), got {values[gain][0]}; "
            "pass active=True for a medium with gain"
        )


def property_values(prop: Property, frequency: np.ndarray, name: str) -> np.ndarray:
    """A property at real or complex frequencies [Hz], as complex numbers of their shape; a function gets a copy, to overwrite."""
    if not callable(prop):
        return np.full(frequency.shape, prop, dtype=complex)
    out = validate.numeric(prop(frequency.copy()), name, "a function that returns numbers").astype(complex)
    if out.shape != frequency.shape:
        raise ValueError(
            f"{name}: expected a function that returns an array of shape {frequency.shape}, got {out.shape}"
        )
    return out


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
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        for name in ("density", "bulk_modulus", "density_x"):
            value = getattr(self, name)
            if not callable(value) and not (name == "density_x" and value is None):
                object.__setattr__(self, name, as_complex(value, name))
        numbers = {
            n: v
            for n in ("density", "bulk_modulus", "density_x")
            if (v := getattr(self, n)) is not None and not callable(v)
        }
        self._check(self.active, **numbers)

    def _check(self, active: bool, density: Any = None, bulk_modulus: Any = None, density_x: Any = None) -> None:
        if density is not None:
            check_property(density, "density", gain_sign=1, active=active)
        if bulk_modulus is not None:
            check_property(bulk_modulus, "bulk_modulus", gain_sign=-1, active=active, zero=False)
        if density_x is not None:
            check_property(density_x, "density_x", gain_sign=1, active=active, infinite=True)
            if np.any(np.asarray(density_x) == 0):
                raise ValueError("density_x: zero beside a density that is given apart has no finite limit, got 0")

    @classmethod
    def from_speed(cls, density: complex, sound_speed: complex, *, active: bool = False) -> Fluid:
        """A fluid by its density [kg/m3] and speed of sound [m/s]: bulk modulus ``density * sound_speed**2``."""
        rho, c = as_complex(density, "density"), as_complex(sound_speed, "sound_speed")
        if not (np.isfinite(rho) and rho != 0):
            raise ValueError(f"density: expected a finite number other than zero beside a speed, got {density!r}")
        if not (np.isfinite(c) and c != 0):
            raise ValueError(f"sound_speed: expected a finite number other than zero, got {sound_speed!r}")
        for name, value in (("density", rho), ("sound_speed", c), ("sound_speed", rho * c * c)):
            validate.within(value, name)
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


#: Air as in the paper: 1.25 kg/m3, 343 m/s.
AIR = Fluid.from_speed(1.25, 343.0)
