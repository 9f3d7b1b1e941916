"""Attenuation by frequency, and the bulk modulus of a fluid that has it.

A plane wave decays as exp(-alpha x), so that ``k = w/c + i alpha`` with exp(-i w t). The density stays real, and the bulk modulus
is ``rho w^2 / k^2``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import validate
from ..conventions import real_or_complex
from .properties import property_values

#: Np/m in one dB/cm: a pressure ratio of e is 20 log10(e) dB.
NEPERS_IN_DB_PER_CM = 100 / (20 * math.log10(math.e))

Attenuation = float | Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class PowerLaw:
    """Attenuation as a power of frequency, as `power_law` makes it; called with frequencies [Hz] it gives Np/m."""

    db_per_cm: float
    reference_frequency: float
    exponent: float = 2.0
    dispersion: bool = False

    def __post_init__(self) -> None:
        given = {name: validate.as_number(getattr(self, name), name) for name in ("db_per_cm", "exponent")}
        given["reference_frequency"] = validate.as_number(
            self.reference_frequency, "reference_frequency", positive=True
        )
        if given["db_per_cm"] < 0:
            raise validate.refuse("db_per_cm", "a number of at least 0", self.db_per_cm)
        dispersion = validate.flag(self.dispersion, "dispersion")
        if not (0 < given["exponent"] <= 2 if dispersion else 0 <= given["exponent"] <= 4):
            expected = "a number above 0, of at most 2, with dispersion" if dispersion else "a number from 0 to 4"
            raise validate.refuse("exponent", expected, self.exponent)
        for name, value in (given | {"dispersion": dispersion}).items():
            object.__setattr__(self, name, value)

    def __call__(self, frequency: Any) -> np.ndarray:
        """Attenuation [Np/m] at frequencies [Hz]."""
        share = real_or_complex(frequency) / self.reference_frequency
        return self.db_per_cm * NEPERS_IN_DB_PER_CM * share**self.exponent

    def excess(self, frequency: np.ndarray) -> np.ndarray:
        """What the wavenumber has beyond w/c [rad/m], with c the speed at `reference_frequency`.

        With dispersion the exponent y adds ``tan(pi y/2) (alpha - alpha0 w/w0)`` to the real part, and its limit for y = 1,
        ``-(2/pi) alpha0 (w/w0) ln(w/w0)``: with them k(w) is analytic for Im w > 0 (Szabo, J. Acoust. Soc. Am. 97, 14 (1995);
        Waters et al., ibid. 108, 556 (2000)).
        """
        alpha = self(frequency)
        if not self.dispersion:
            return 1j * alpha
        share, beyond = real_or_complex(frequency) / self.reference_frequency, self.exponent - 1
        growth = np.log(share)
        # tan(pi y/2) = -1/tan(pi (y-1)/2), whose pole at y = 1 the difference of powers takes away
        slope = -2 / np.pi * growth if beyond == 0 else -np.expm1(beyond * growth) / math.tan(math.pi * beyond / 2)
        return 1j * alpha + self.db_per_cm * NEPERS_IN_DB_PER_CM * share * slope


def power_law(
    db_per_cm: float, reference_frequency: float, exponent: float = 2.0, dispersion: bool = False
) -> PowerLaw:
    """Attenuation by a power law, ``alpha = alpha0 (f / f0)**y``, for `Fluid.from_speed`.

    Parameters
    ----------
    db_per_cm : float, dB/cm
        alpha0, at `reference_frequency`.
    reference_frequency : float, Hz
        f0.
    exponent : float
        y: 2 in water and other simple liquids, 1 to 1.5 in tissues. 0 to 4, with `dispersion` up to 2.
    dispersion : bool
        Let the speed change with frequency as causality asks (Kramers-Kronig relations): the speed that
        `Fluid.from_speed` is given is the phase velocity at `reference_frequency`, ``1/c = 1/c0 + alpha0/w0 tan(pi y/2)
        ((w/w0)**(y-1) - 1)``, and for y = 1 ``1/c = 1/c0 - (2/pi) alpha0/w0 ln(w/w0)``.

    Returns
    -------
    PowerLaw
        A function from frequency [Hz] to attenuation [Np/m], which files record by its four numbers.

    Sources: T. L. Szabo, J. Acoust. Soc. Am. 97, 14 (1995); K. R. Waters et al., J. Acoust. Soc. Am. 108, 556 (2000).

    Examples
    --------
    >>> liver = bp.Fluid.from_speed(1060.0, 1595.0, attenuation=bp.power_law(0.5, 1e6, exponent=1.1, dispersion=True))
    >>> k = liver.wavenumber(2e6)
    >>> round(float(k.imag), 3), round(float(2 * np.pi * 2e6 / k.real), 2)  # Np/m; m/s, a little faster than at 1 MHz
    (12.339, 1596.06)
    """
    return PowerLaw(db_per_cm, reference_frequency, exponent, dispersion)


@dataclass(frozen=True)
class LossyModulus:
    """The bulk modulus rho w^2/k^2 of a fluid with attenuation, as a function of frequency."""

    density: float
    sound_speed: float
    attenuation: Attenuation
    active: bool = False

    def __call__(self, frequency: Any) -> np.ndarray:
        f = real_or_complex(frequency)
        omega = 2 * np.pi * f
        with np.errstate(all="ignore"):  # what is not finite then is refused by name
            k = omega / self.sound_speed + self._excess(f)
            if not np.iscomplexobj(f) and np.any(k.real <= 0):
                raise ValueError(
                    f"attenuation: expected a dispersion that leaves a phase velocity above zero, got {self.attenuation!r} "
                    f"at {np.atleast_1d(f)[np.atleast_1d(k.real <= 0)][0]:g} Hz"
                )
            return self.density * (omega / k) ** 2

    def _excess(self, f: np.ndarray) -> np.ndarray:
        if isinstance(self.attenuation, PowerLaw):
            return self.attenuation.excess(f)
        alpha = property_values(self.attenuation, f, "attenuation")
        if not (self.active or np.iscomplexobj(f)) and np.any(alpha.real < 0):
            raise ValueError(
                f"attenuation: expected values of at least 0 Np/m, got {alpha.real.min():.6g}; "
                "pass active=True for a medium with gain"
            )
        return 1j * alpha


#: The functions of frequency made here: a file records them by their numbers, not as a table.
FUNCTIONS: tuple[type, ...] = (PowerLaw, LossyModulus)
