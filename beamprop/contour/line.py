"""Positions along x at which contours are compared, where nothing depends on y."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..sources.angles import AngleInterpolation
from . import paths, peak_outside, residues, sums
from .check_points import Amplitudes, Checks
from .paths import BentPlan, Contour
from .search import Planned, Search


class Line(NamedTuple):
    """Positions x (X,) from the source's middle: `check_points.Places`."""

    x: np.ndarray

    @property
    def on_a_line(self) -> bool:
        """Yes."""
        return True

    @property
    def across(self) -> float:
        """The largest |x|."""
        return float(np.max(np.abs(self.x)))

    def too_large(self, search: Search, plan: BentPlan) -> bool:
        """Its nodes are all that is summed."""
        return False

    def contour(self, search: Search, planned: Planned, second: bool) -> Contour:
        """The trapezoid rule on a bent contour."""
        plan = planned.plan.second_plan() if second else planned.plan
        bent = paths.bent_contour(plan)
        return residues.add_residues(search.slab, bent, [planned.poles], search.extent, second)

    def amplitudes(self, k0: float, sources: AngleInterpolation, contour: Contour) -> Amplitudes:
        """See `sums.beam_amplitudes`."""
        return sums.beam_amplitudes(k0, sources, contour)

    def fields(
        self, k0: float, beams: AngleInterpolation, contour: Contour, h: np.ndarray, amplitudes: Amplitudes
    ) -> np.ndarray:
        """One matrix product."""
        return np.asarray(sums.direct_sum(contour, h, *amplitudes, self.x))

    def with_wider_look(self, search: Search, planned: Planned, checks: Checks) -> Checks:
        """See `peak_outside.with_wider_look`."""
        return peak_outside.with_wider_look(search, planned, checks)
