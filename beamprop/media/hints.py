"""Hints where a number is legitimate and likely a slip; docs/media.md lists the rules, which are narrow so that they seldom err."""

from __future__ import annotations

import sys
import warnings
from typing import Any


class HintWarning(UserWarning):
    """A number that is legitimate and likely a slip: a sound speed where a modulus is meant, periods per wavelength for `eta`.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", bp.HintWarning)  # if it is meant
    ...     odd = bp.Fluid(1.25, bulk_modulus=343.0)
    """


def hint(said: str) -> None:
    """Warn at the line that called the package, however deep in it the slip is seen."""
    package, level, frame = __name__.partition(".")[0], 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, level = frame.f_back, level + 1
    warnings.warn(said, HintWarning, stacklevel=level)


def warn_of_modulus(density: Any, bulk_modulus: Any) -> None:
    """A modulus [Pa] in the range of sound speeds [m/s], for a gas or for a liquid or solid."""
    if callable(density) or callable(bulk_modulus) or bulk_modulus.imag or density.imag:
        return
    rho, K = density.real, bulk_modulus.real
    if (0.05 <= rho <= 20 and 100 <= K <= 1500) or (rho >= 500 and 300 <= K <= 13_000):
        said = f"bulk_modulus: {K:g} Pa looks like a sound speed, which Fluid.from_speed({rho:g}, {K:g}) takes"
        hint(said)


def warn_of_eta(eta: float) -> None:
    """A whole number of wavelengths in a period, which is rather that of periods in a wavelength."""
    if eta >= 2 and eta == round(eta):
        said = f"eta: {eta:g} wavelengths a period; for {eta:g} periods a wavelength give eta=1/{eta:g}"
        hint(said)
