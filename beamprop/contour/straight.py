"""A pair of straight contours for FFTs, where that is cheaper than a matrix product over the bent contour, and as accurate."""

from __future__ import annotations

import math

import numpy as np

from ..arrays.fft import fast_length
from . import error, paths, sums
from .quadrature import Quadrature
from .search import Planned, Search, pair_of_contours, with_poles

#: Grids of fewer points are never worth an FFT; above, `fft_is_cheaper` decides.
FEWEST = 8
#: Shares of the planned window, and factors on the exponents of the error terms, that are tried in turn. These terms are bounds, so
#: that most fields keep rtol with 0.78 of the window, and FFTs that much shorter; a second and a third try cost a response
#: each. With 1.4 times the exponents rtol^1.4 is planned for.
TRIES = ((0.78, 1.0), (0.9, 1.0), (1.0, 1.4))
#: Time of two FFTs over n log2 n, over that of a multiplication in a matrix product. `experiments/benchmarks/steps.py` measures the
#: row "straight contours and FFTs where they are cheaper" again.
FFT_STEP = 5.5


def spacing_for_fft(x: np.ndarray, band: float, rtol: float) -> float:
    """Spacing of a grid that is even enough for an FFT, 0 for any other: `sums.grid_sum` errs by (band offset)^2/2, 0.005 rtol."""
    grid = sums.grid_of(x)
    moved = band * grid.unevenness
    return grid.step if x.size >= FEWEST and moved * moved < 0.01 * rtol else 0.0


def fft_is_cheaper(n: int, plane_waves: float, points: int) -> bool:
    """Whether two FFTs of length n cost less than a row of a matrix product."""
    return FFT_STEP * n * math.log2(n) < plane_waves * points


def quadrature_on_straight_contours(
    search: Search, planned: Planned, x: np.ndarray
) -> tuple[Quadrature | None, Planned]:
    """A straight contour that keeps rtol, None where none does or none is cheaper; and the plan, with its poles.

    It is compared with the plan's second bent contour, whose field is summed once for all tries.
    """
    plan, rtol = planned.plan, search.rtol
    dx = spacing_for_fft(x, plan.band, rtol)
    if not dx or plan.grading or plan.low:
        return None, planned
    plane_waves, second = plan.band * plan.window / (2 * np.pi), None
    for share, tighten in TRIES:
        straight = paths.plan_straight(search.extent, rtol, tighten, search.noise)
        n = fast_length(max(math.ceil(share * straight.window / dx), x.size))
        if not fft_is_cheaper(n, plane_waves, x.size):
            break
        planned = with_poles(search, planned)
        if planned.any_misplaced:
            break
        if second is None:
            second = error.sampled(search.checks, pair_of_contours(search, planned)[1], True)
            second = second._replace(fields=error.fields_of(search.checks, second))
        contour = paths.straight_contour(straight._replace(window=n * dx))
        first = error.sampled(search.checks, contour, False)
        budget = error.estimate(search.checks, first, second).budget
        if budget.total.max() <= rtol:
            return Quadrature(contour, budget, n, amplitudes=first.amplitudes), planned
    return None, planned
