"""What transducers along the normal share: a sharp edge, whose spectrum does not end."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from .. import validate
from ..validate import as_complex, as_number
from .base import Summable

_Source = TypeVar("_Source", bound="OnNormal")


class OnNormal(Summable):
    """A round source of three dimensions alone, along the normal, whose spectrum about its middle does not end."""

    pressure: complex
    x0: float
    y0: float
    z0: float
    angle = 0.0
    azimuth = 0.0
    entire = True
    in_space_only = True

    def _check_place(self) -> None:
        """Pressure, middle and plane as numbers, or the error that says what is wrong with them."""
        pressure = as_complex(self.pressure, "pressure", "a finite number")
        if not (math.isfinite(abs(pressure)) and pressure != 0):
            raise validate.refuse("pressure", "a finite number other than 0", self.pressure)
        object.__setattr__(self, "pressure", pressure)
        for name in ("x0", "y0", "z0"):
            object.__setattr__(self, name, as_number(getattr(self, name), name))
        if self.z0 > 0:
            raise ValueError(f"z0: expected a plane in front of the slab, z0 <= 0, got {self.z0!r}")

    @property
    def centre(self) -> float:
        """x0 [m]."""
        return self.x0

    def in_space(self: _Source, azimuth: float) -> _Source:
        """The source about (0, 0)."""
        return replace(self, x0=0.0, y0=0.0)  # type: ignore[type-var]

    def at_angle(self: _Source, angle: float) -> _Source:
        """Itself, along the normal alone."""
        if angle:
            name = type(self).__name__
            wanted = (
                f"0 with a {name}, which is not steered (an Array of them is; tilted transducers are not available)"
            )
            raise validate.refuse("angle", wanted, angle)
        return self

    def reach(self, tolerance: float) -> float:
        """The radius of its edge [m]."""
        raise NotImplementedError

    def spectrum_at(self, kx: np.ndarray, ky: Any, k0: float) -> np.ndarray:
        """S(kx, ky) about the middle."""
        raise NotImplementedError

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx, 0) about the middle."""
        return self.spectrum_at(np.asarray(kx), 0.0, k0)

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """The pressure, or rho c times the velocity, along x through the middle."""
        return np.where(np.abs(np.asarray(x) - self.x0) <= self.reach(0.5), self.pressure, 0.0)

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """The radius of its edge, twice."""
        return self.reach(tolerance), self.reach(tolerance)

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """Without end: what arrives ends before."""
        return np.array([[-np.inf, np.inf], [-np.inf, np.inf]])

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Without end."""
        return 0.0, math.inf
