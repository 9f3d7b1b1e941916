"""Slits in a row: sources with sharp edges, for the test of sub-wavelength imaging."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import memory
from ..validate import as_count, as_number
from .base import Tilted, spectral_sum


@dataclass(frozen=True)
class Slits(Tilted):
    """`count` slits, each `width` wide and driven in phase with 1 Pa, `separation` apart from middle to middle.

    The test of sub-wavelength imaging. Lengths in m; z0 <= 0 is the launch plane; `angle` [degree] tilts the phase.

    Examples
    --------
    >>> slits = bp.Slits(width=0.01, separation=0.04, count=2, z0=-0.005)
    >>> slits.positions
    array([-0.02,  0.02])
    """

    width: float
    separation: float
    count: int = 2
    z0: float = 0.0
    angle: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", as_number(self.width, "width", positive=True))
        object.__setattr__(self, "count", as_count(self.count, "count"))
        memory.check("count", 50.0 * self.count, f"{self.count:.3g} slits", "take fewer")
        object.__setattr__(self, "separation", as_number(self.separation, "separation", positive=True))
        self._check_launch()
        if self.count > 1 and self.separation < self.width:
            raise ValueError(f"separation: expected at least the slits' width {self.width}, got {self.separation}")

    @property
    def positions(self) -> np.ndarray:
        """Middles of the slits [m]."""
        return (np.arange(self.count) - (self.count - 1) / 2) * self.separation

    @property
    def centre(self) -> float:
        """0 m."""
        return 0.0

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        half = np.asarray(k) * self.width / 2
        small = np.abs(half) < 1e-4  # half^4/120, the next term of the series, is below 1e-18
        safe = np.where(small, 1.0, half)
        sinc = np.where(small, 1 - half**2 / 6, np.sin(safe) / safe)
        return self.width * sinc * spectral_sum(k, self.positions, np.ones(self.count))

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """1 Pa inside the slits, 0 elsewhere, tilted."""
        x = np.asarray(x, dtype=float)
        inside = np.zeros(x.shape, bool)
        middle = (self.count - 1) / 2
        below = np.floor(x / self.separation + middle)
        for number in (below, below + 1):  # the two nearest slits
            nearest = (np.clip(number, 0, self.count - 1) - middle) * self.separation
            inside |= np.abs(x - nearest) <= self.width / 2
        return inside * np.exp(1j * self._tilt(k0) * x)

    def reach(self, tolerance: float) -> float:
        """Half width of the launch profile, whatever the level: to the outermost edges [m]."""
        return float(self.positions[-1]) + self.width / 2

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Where the envelope 2/(k width) of the spectrum falls below the tolerance: wide, for edges are sharp."""
        middle, half = self._tilt(k0), 2 / (self.width * tolerance)
        return middle - half, middle + half
