"""The source whose spectrum is kx S(kx): -i times the derivative along x of a source's pressure, which v_x is driven by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .base import Beam
from .in_space import mean_size


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

    @property
    def rounding_of_values(self) -> Callable[[np.ndarray, float], np.ndarray] | None:
        """The same of the values of its samples alone."""
        rounding = getattr(self.beam, "rounding_of_values", None)
        return None if rounding is None else lambda kx, k0: np.abs(kx) * rounding(kx, k0)

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


#: Wavenumbers along x and along y at which the largest |k S| is looked for.
LOOKED_AT = 33


@dataclass(frozen=True)
class SpaceGradient(LateralGradient):
    """A `SpaceBeam` with the spectrum kx S(kx, ky) or ky S(kx, ky) of another; along its azimuth it has |k| S(k), which bounds both."""

    along_y: bool

    def spectrum_at(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """kx S or ky S [Pa m]."""
        return np.asarray((ky if self.along_y else kx) * self.beam.spectrum_at(kx, ky, k0))  # type: ignore[attr-defined]

    def mean_size(self, k: np.ndarray, k0: float) -> np.ndarray:
        """At most |k| times the mean of |S|."""
        return np.abs(k) * mean_size(self.beam, k, k0)

    def _tolerance(self, k0: float, tolerance: float) -> float:
        """That of S at which kx S or ky S is below `tolerance` of its largest value: see `LateralGradient.band`."""
        beam: Any = self.beam
        strong = beam.box(k0, 0.3)
        if not np.all(np.isfinite(strong)):  # sharp edges: no tolerance ends them, but the way to the positions
            return tolerance
        kx, ky = np.linspace(strong[:, 0], strong[:, 1], LOOKED_AT).T
        size = np.abs(beam.spectrum_at(kx[None, :], ky[:, None], k0))
        own = np.abs(ky[:, None] if self.along_y else kx[None, :]) * size
        end = float(np.max(np.abs(beam.box(k0, tolerance)[int(self.along_y)])))
        return tolerance * min(1.0, float(own.max() / size.max()) / end)

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """See `SpaceBeam.box`."""
        return np.asarray(self.beam.box(k0, self._tolerance(k0, tolerance)))  # type: ignore[attr-defined]

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """See `SpaceBeam.rings`."""
        return self.beam.rings(k0, self._tolerance(k0, tolerance))  # type: ignore[attr-defined]

    def at_angle(self, angle: float) -> SpaceGradient:
        """The same of the source at another angle [degree]."""
        return SpaceGradient(self.beam.at_angle(angle), self.along_y)
