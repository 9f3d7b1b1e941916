"""Contours for sources of propagating waves alone, whose spectra end at k0."""

from __future__ import annotations

import math

from .. import memory
from ..modes import misplaced
from ..response.sampled_slab import SampledSlab
from ..sources.base import Beam
from . import error, paths
from .check_points import Checks
from .paths import Extent
from .quadrature import Quadrature
from .search import MOST_PLANE_WAVES

#: The largest depth of the contour of propagating waves, over k0: about `paths.SLOPE`, that of bent contours.
DEEPEST_DIP = 0.3


def _dip(s: SampledSlab, extent: Extent, rtol: float, sharp: float) -> float:
    """Depth of a contour of propagating waves over k0: 0 without a singularity near the axis, and where there are backward modes."""
    growth = min(paths.DEEPEST, max(0.0, math.log(rtol / (100 * paths.EPS))))
    dip = min(DEEPEST_DIP, growth / (extent.k0 * extent.across))
    if not math.isfinite(sharp):
        return 0.0
    backward = misplaced.misplaced(s, 1.05 * dip * extent.k0, (1 - 1e-6) * extent.k0, 1e-6 * extent.k0)
    return dip if not backward.poles else 0.0


#: The most plane waves of a rotated beam whose width is measured: estimating their error takes seconds, and so does the sum at a hundred
#: positions (6e7 exponentials).
MOST_OF_WIDTHS = 600_000


def _rays(k0: float, length: float) -> int:
    """The first number of Gauss nodes over the propagating waves, 24 for 40 rad of phase (`paths.PANEL`) over `length` along x and z."""
    return int(60 + 0.6 * k0 * length)


def check_rays(s: SampledSlab, beam: Beam, path: float, extent: float) -> None:
    """Refuse the width of a beam of propagating waves alone whose phases turn too often over its way."""
    if not beam.entire and (waves := 1.4 * _rays(s.k0, path + extent)) > MOST_OF_WIDTHS:
        raise ValueError(
            f"z0: expected a way that beams of propagating waves alone go with at most {MOST_OF_WIDTHS} plane waves, got {path:.3g} m of "
            f"it, which take {waves:.2g}: take a launch plane and a slab's far face that are nearer, or form='launch', which takes fewer"
        )


#: The most numbers of nodes that are tried, each 1.8 times the one before: up to 1.8^5 = 19 times the first.
ROUNDS = 6


def propagating_quadrature(s: SampledSlab, checks: Checks, extent: Extent, rtol: float, sharp: float) -> Quadrature:
    """Gauss nodes over the propagating waves, raised until two numbers of them, on contours of different depth, agree."""
    count = _rays(extent.k0, extent.across + extent.path)
    dip = _dip(s, extent, rtol, sharp) if checks.guided else 0.0
    for _ in range(ROUNDS):
        memory.check_contour(1.4 * count, checks.sources.angles.size, checks.z.size)
        coarse, fine = (
            paths.propagating_contour(s.k0, s.real_branches, int(more * count), share * dip, share * sharp)
            for more, share in ((1.0, 0.7), (1.4, 1.0))
        )
        _, second, estimate, checks = error.compare(checks, (coarse, fine), rtol)
        if estimate.worst <= rtol or count > MOST_PLANE_WAVES // 4:
            break
        count = int(1.8 * count)
    return Quadrature(fine, estimate.budget, amplitudes=second.amplitudes)
