"""A quadrature: the contour that was chosen, and the estimated error of the field on it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..sources.angles import AngleInterpolation
from .error import ErrorBudget
from .paths import Contour
from .sums import beam_amplitudes


class Quadrature(NamedTuple):
    """A contour, and the estimated relative error of the field on it by requested beam."""

    contour: Contour
    budget: ErrorBudget
    fft: int = 0  #: FFT length if the contour fits the requested even grid, else 0
    circles: bool = False  #: whether it has circles around backward modes
    amplitudes: tuple[np.ndarray, np.ndarray] | None = None  #: of the beams for which it was chosen
    checked_planes: np.ndarray | None = None  #: the planes on which the error was estimated

    @property
    def error(self) -> np.ndarray:
        """The sum of the error's terms by requested beam, (A,)."""
        return self.budget.total

    @property
    def worst(self) -> float:
        """The largest error of all beams."""
        return float(self.error.max())

    def amplitudes_of(self, k0: float, sources: AngleInterpolation) -> tuple[np.ndarray, np.ndarray]:
        """w S(k) and w S(-k) of the beams that are summed, about their middle: (B, n) each."""
        if self.amplitudes is not None and self.amplitudes[0].shape[0] == sources.angles.size:
            return self.amplitudes
        return beam_amplitudes(k0, sources, self.contour)
