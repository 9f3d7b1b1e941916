"""The largest |p| of a plane where a first look did not expect it: far outside of the requested positions.

Errors are over the largest |p| of each plane. Beams that propagate are looked for where stationary phase lets them land (`survey.survey`).
What crosses a slab by evanescent or guided waves, or along the cones of an indefinite medium, lands elsewhere. Where an error is above
rtol the planes are therefore looked at once more, in a much wider window, with two shallow contours of low accuracy: a peak
counts if both see it.
"""

from __future__ import annotations

import math

import numpy as np

from ..modes.misplaced import MisplacedPoles
from ..response.sampled_slab import SampledSlab
from ..sources.angles import AngleInterpolation
from . import paths, sums
from .check_points import Checks, interpolated
from .paths import BentPlan, Extent
from .residues import add_residues
from .sums import beam_amplitudes

#: How much wider than what is requested, and than the way along z, the window is: waves land four times as far to the side as they
#: go along z if they are as steep as 76 degrees.
WIDER, ALONG = 6.0, 4.0
#: The accuracy of the look, the share by which both contours may differ, and the most plane waves and positions that it takes: a
#: peak is a scale, for which a tenth is enough.
ROUGH, AGREED, MOST_WAVES, MOST_POINTS = 1e-3, 0.1, 10_000, 2_001


def with_wider_look(s: SampledSlab, checks: Checks, extent: Extent, plan: BentPlan, poles: MisplacedPoles) -> Checks:
    """Checks that know of the peaks far outside; the same ones where the window would take too many plane waves."""
    across = WIDER * extent.across + ALONG * max(extent.path, 0.0)
    wide = paths.plan_bent(extent._replace(farthest=across, band=plan.band), ROUGH, sharp=plan.sharp)
    depth = min(wide.depth, plan.depth)  # no deeper than poles were looked for
    window = max(wide.window, 1.2 * across + 0.8 * math.log(10 / ROUGH) / depth)
    first = wide._replace(depth=depth, window=window, crossing=plan.crossing, gap=plan.gap)
    second = first.second_plan()
    if second.nodes > MOST_WAVES:
        return checks
    requested = checks.sources.requested
    chosen = checks.sources.spread(5)
    beams = AngleInterpolation(checks.sources.beam, requested[chosen])
    x = across * np.linspace(-1, 1, min(MOST_POINTS, 2 * math.ceil(across * min(plan.band, 3 * extent.k0)) + 1))
    peaks = []
    for i, p in enumerate((first, second)):
        contour = add_residues(s, paths.bent_contour(p), poles, across, extent.path, bool(i))
        right, left = beam_amplitudes(checks.k0, beams, contour)
        with np.errstate(over="ignore", invalid="ignore"):
            summed = sums.direct_sum(contour, checks.transfer(contour.k, checks.z), right, left, x)
            peaks.append(np.nan_to_num(np.max(np.abs(summed), axis=2), nan=0.0, posinf=0.0))
    less, more = np.minimum(*peaks), np.maximum(*peaks)
    peaks_outside = np.where(less > (1 - AGREED) * more, less, 0.0)
    return checks._replace(
        peaks_outside=np.maximum(checks.peaks_outside, interpolated(requested, requested[chosen], peaks_outside))
    )
