"""Planes that no plane wave of a contour reaches, although others beyond its end do.

Deep in a slab that lets nothing through, |p| may be 1e-50 of the launched one and still be known to rtol. Where the contour's waves have
all decayed below the smallest numbers there, its field is 0, both contours agree, and neither knows of a band of evanescent waves, beyond
the end of both, that the slab carries. Such waves are looked for on the real axis.
"""

from __future__ import annotations

import math

import numpy as np

from ..response.sampled_slab import SampledSlab
from .check_points import Checks
from .error import DARK
from .quadrature import Quadrature

#: Fewer radians through the slab than this cannot take a wave below `DARK`, 668 nepers, unless each radian takes several.
THIN = 100.0
#: Values of kx on each plane: a band of evanescent waves in a periodic slab is about k0 wide, and hundreds of k0 are looked at.
LOOKED_AT = 4000


def with_unseen_bands(s: SampledSlab, checks: Checks, quadrature: Quadrature) -> Quadrature:
    """The quadrature, with an infinite error where a plane is reached by waves beyond the contour alone."""
    if s.k0 * s.thickness < THIN or not checks.guided or quadrature.contour.closed:
        return quadrature
    end = float(np.max(quadrature.contour.k.real))
    inside = _strongest(checks, np.linspace(0.0, end, LOOKED_AT // 10))
    dark = inside <= DARK
    if not dark.any():
        return quadrature
    way = -checks.sources.beam.z0 + max(0.0, -float(checks.z.min()))
    farthest = -math.log(DARK) / way if way > 0 else math.inf
    farthest = min(max(farthest, end), 200 * s.k0)
    beyond = _strongest(checks._replace(z=checks.z[dark]), np.linspace(end, farthest, LOOKED_AT))
    if not np.any(beyond > DARK):
        return quadrature
    budget = quadrature.budget
    return quadrature._replace(budget=budget._replace(band_end=np.full(budget.band_end.shape, np.inf)))


def _strongest(checks: Checks, kx: np.ndarray) -> np.ndarray:
    """The largest |S H| of plane waves at real kx, or -kx, of the strongest of three beams, on each plane: (Z,)."""
    h = np.nan_to_num(np.abs(checks.transfer(kx + 0j, checks.z)), nan=0.0, posinf=0.0)
    sources = checks.sources
    beams = [sources.at(float(angle)) for angle in sources.requested[sources.spread(3)]]
    size = np.max([np.abs(beam.spectrum(way * kx, checks.k0)) for beam in beams for way in (1, -1)], axis=0)
    return np.asarray(np.max(h * size, axis=1))
