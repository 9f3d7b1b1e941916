"""The source whose spectrum is kx S(kx): -i times the derivative along x of a source's pressure, which v_x is driven by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base import Beam


@dataclass(frozen=True)
class LateralGradient:
    """A `Beam` with the spectrum kx S(kx) of another; what it says of places, directions and cuts is that one's."""

    beam: Beam

    def __getattr__(self, name: str) -> Any:
        if name == "beam":  # a copy that is being made has no fields yet
            raise AttributeError(name)
        return getattr(self.beam, name)

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """kx S(kx) [Pa]."""
        return np.asarray(kx) * self.beam.spectrum(kx, k0)

    @property
    def spectra(self) -> Callable[[np.ndarray, float, np.ndarray], np.ndarray] | None:
        """kx S(kx) at several angles, where the source has that."""
        spectra = getattr(self.beam, "spectra", None)
        return None if spectra is None else lambda kx, k0, sines: np.asarray(kx) * spectra(kx, k0, sines)

    @property
    def spectral_rounding(self) -> Callable[[np.ndarray, float], tuple[np.ndarray, ...]] | None:
        """What rounding of its samples leaves unknown, where the source says so."""
        rounding = getattr(self.beam, "spectral_rounding", None)
        return None if rounding is None else lambda kx, k0: tuple(np.abs(kx) * part for part in rounding(kx, k0))

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Interval of real kx outside which |kx S| is below tolerance times its largest value, about [rad/m].

        |S| may exceed its tolerance by as much as the largest |kx S| lies above the largest |S| times the band's end.
        """
        if not self.beam.entire:  # all that propagates
            return self.beam.band(k0, tolerance)
        strong = np.linspace(*self.beam.band(k0, 0.3), 65)
        size = np.abs(self.beam.spectrum(strong, k0))
        ratio = float(np.max(np.abs(strong) * size) / np.max(size))
        end = max(map(abs, self.beam.band(k0, tolerance)))
        return self.beam.band(k0, tolerance * min(1.0, ratio / end))

    def at_angle(self, angle: float) -> LateralGradient:
        """The same of the source at another angle [degree]."""
        return LateralGradient(self.beam.at_angle(angle))
