"""Peaks of |p| far outside of the requested positions, where stationary phase did not expect them.

Errors are over the largest |p| of each plane. `survey.survey` looks for beams where stationary phase says that they land. Waves that
cross a slab as evanescent or guided ones, or along the cones of an indefinite medium, land elsewhere. Where an error is above
rtol, p is therefore evaluated in a much wider window, on two shallow contours of low accuracy: a peak counts if both show it.
"""

from __future__ import annotations

import math

import numpy as np

from ..sources.angles import AngleInterpolation
from . import paths, sums
from .check_points import Checks, interpolated
from .paths import BentPlan
from .residues import add_residues
from .search import Planned, Search
from .sums import beam_amplitudes

#: The window over the requested one, and over the way along z: waves at up to 76 degrees land within four times their way along z. Six
#: requested windows are a plain choice, for a peak that guided waves carry farther stays unknown: estimates are larger then.
WIDER, ALONG = 6.0, 4.0
#: The accuracy of these contours, the share by which their peaks may differ, for a scale needs no more than a tenth; and the most plane
#: waves and positions: 2e7 exponentials, a second or so.
ROUGH, AGREED, MOST_WAVES, MOST_POINTS = 1e-3, 0.1, 10_000, 2_001


def with_wider_look(search: Search, planned: Planned, checks: Checks) -> Checks:
    """Checks with the peaks far outside; unchanged where the window would take too many plane waves."""
    plan, k0 = planned.plan, search.slab.k0
    across = WIDER * search.extent.across + ALONG * max(search.extent.path, 0.0)
    first = rough_plan(search, plan, across)
    extent, second = search.extent._replace(farthest=across, band=plan.band), first.second_plan()
    if second.nodes > MOST_WAVES:
        return checks
    requested = checks.sources.requested
    chosen = checks.sources.spread(5)
    beams = AngleInterpolation(checks.sources.beam, requested[chosen])
    # a position for each radian of the steepest plane waves, up to 3 k0
    x = across * np.linspace(-1, 1, min(MOST_POINTS, 2 * math.ceil(across * min(plan.band, 3 * k0)) + 1))
    peaks = []
    for p in (first, second):
        contour = add_residues(search.slab, paths.bent_contour(p), [planned.poles], extent, p is second)
        right, left = beam_amplitudes(k0, beams, contour)
        with np.errstate(over="ignore", invalid="ignore"):
            summed = sums.direct_sum(contour, checks.transfer(contour.k, checks.z), right, left, x)
            peaks.append(np.max(np.abs(summed), axis=2))
    return with_agreed(checks, chosen, peaks)


def rough_plan(search: Search, plan: BentPlan, across: float) -> BentPlan:
    """A shallow contour of low accuracy up to the same end, for positions as far as `across`."""
    wide = paths.plan_bent(search.extent._replace(farthest=across, band=plan.band), ROUGH, sharp=plan.sharp)
    depth = min(wide.depth, plan.depth)  # no deeper than poles were looked for
    window = max(wide.window, 1.2 * across + 0.8 * math.log(10 / ROUGH) / depth)
    return wide._replace(depth=depth, window=window, crossing=plan.crossing, gap=plan.gap)


def with_agreed(checks: Checks, chosen: np.ndarray, peaks: list[np.ndarray]) -> Checks:
    """Checks with the peaks (chosen, Z) of two contours of the requested beams at `chosen`, where both show them."""
    requested = checks.sources.requested
    finite = [np.nan_to_num(peak, nan=0.0, posinf=0.0) for peak in peaks]
    less, more = np.minimum(*finite), np.maximum(*finite)
    peaks_outside = interpolated(requested, requested[chosen], np.where(less > (1 - AGREED) * more, less, 0.0))
    return checks._replace(peaks_outside=np.maximum(checks.peaks_outside, peaks_outside))
