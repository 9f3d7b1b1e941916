"""Properties of media: a number, or a function of frequency; checked where they are made or evaluated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .. import validate
from ..conventions import real_or_complex

#: What a property is expected to be, in messages.
PROPERTY = "a number or a function of frequency"
Property = complex | Callable[[np.ndarray], np.ndarray]


def check_property(
    values: Any, name: str, *, gain_sign: int, active: bool, infinite: bool = False, zero: bool = True
) -> None:
    """Refuse NaN, infinity and zero (unless legitimate), gain, and what double precision cannot compute with."""
    if isinstance(values, complex) and validate.is_usual(values) and gain_sign * values.imag >= 0:
        return
    values = np.atleast_1d(np.asarray(values, dtype=complex))
    allowed = np.isfinite(values) | (np.isinf(values) if infinite else False)
    if not np.all(allowed):
        raise validate.refuse(name, "finite values", values[~allowed][0].item())
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


@dataclass(frozen=True)
class Tabulated:
    """A measured property as a function of frequency: linear between the rows of a table, refused outside of it.

    Wherever a property may be a function of frequency: density, bulk modulus, areal density, attenuation.

    Parameters
    ----------
    frequency : 1-D array, Hz
        Increasing.
    values : 1-D array of float or complex
        In the property's own unit, with the signs of exp(-i w t).

    Raises
    ------
    ValueError
        Wrong arrays when it is made; a frequency outside of the table, or a complex one, when it is called.

    Examples
    --------
    >>> alpha = bp.Tabulated([1e6, 2e6, 5e6], [5.0, 11.0, 30.0])  # Np/m
    >>> float(alpha(1.5e6).real)
    8.0
    >>> gel = bp.Fluid.from_speed(1020.0, 1510.0, attenuation=alpha)
    """

    frequency: ArrayLike
    values: ArrayLike

    def __post_init__(self) -> None:
        frequency = validate.positions(self.frequency, "frequency", increasing=True)
        values = validate.axis(self.values, "values", kind=complex)
        if frequency[0] <= 0:
            raise validate.refuse("frequency", "frequencies above zero", float(frequency[0]))
        if values.shape != frequency.shape:
            raise ValueError(f"values: expected one for each of {frequency.size} frequencies, got shape {values.shape}")
        object.__setattr__(self, "frequency", tuple(frequency.tolist()))
        object.__setattr__(self, "values", tuple(values.tolist()))

    def __call__(self, frequency: Any) -> np.ndarray:
        """The property at real frequencies [Hz], complex, of their shape."""
        f, known = real_or_complex(frequency), np.asarray(self.frequency)
        if np.iscomplexobj(f):
            raise validate.refuse("frequency", "real frequencies of a tabulated medium", f)
        if np.any((f < known[0]) | (f > known[-1])):
            raise ValueError(f"frequency: this medium is known from {known[0]} to {known[-1]} Hz only, got {f}")
        values = np.asarray(self.values)
        return np.interp(f, known, values.real) + 1j * np.interp(f, known, values.imag)
