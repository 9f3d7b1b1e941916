"""A profile across one plane measured at one frequency, in a window that grows until it holds the beam."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..contour import choose
from ..contour.stationary_phase import landing
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.base import Beam
from .fwhm import centroid, full_width
from .routes import Measures
from .windows import EDGE, Windows, ends_over_peak, widened

#: So many windows are tried, each twice as wide as the one before: to 256 times the first.
WINDOWS = 9


def measured_alone(
    s: SampledSlab,
    beam: Beam,
    transfer: TransferFunction,
    way: tuple[float, float],
    rtol: float,
    level: float,
    guided: bool,
) -> Measures:
    """`Measures` (1,) at one frequency, across the plane z; `way` is z and the distance along z."""
    z, path = way
    plane = np.array([z])
    middle, half = (
        float(v[0]) for v in landing(np.array([s.k0]), beam, lambda k: transfer(k[0], plane), np.array([path]))
    )
    choose.check_rays(s, beam, path, half)
    seen: list[_Rim] = []

    def holds(p: np.ndarray) -> bool:
        if ends_over_peak(p) < EDGE * level:
            return True
        seen.append(_rim(np.abs(p), level))
        return guided and _runs_on(seen, s.lossless)

    profile = widened(s, beam, transfer, z, Windows(_windows(s, beam, middle, half), holds), rtol, guided)
    section = full_width(profile.x, profile.p, level, profile.evaluator(s, beam))
    numbers = section.width, section.peak, centroid(profile.x, profile.p), section.crossings
    width, peak, place, crossings = (np.array([v], float) for v in numbers)
    return Measures(width, peak, place, crossings, profile.quadrature.budget)


def _windows(s: SampledSlab, beam: Beam, middle: float, half: float) -> Iterator[np.ndarray]:
    """Positions of windows, each twice as wide as the one before."""
    finest = np.pi / (2 * max(abs(k) for k in beam.band(s.k0, 1e-4)))
    for _ in range(WINDOWS):
        step = min(finest, half / 64)
        yield middle + half * np.linspace(-1, 1, 2 * min(math.ceil(half / step), 50_000) + 1)
        half *= 2


class _Rim(NamedTuple):
    """What a window shows of a wave that runs on beyond it: the peak, the largest |p| in its outer tenths, and whether the level
    is met on both sides of the peak."""

    peak: float
    outer: float
    met: bool


#: A guided wave is what still has this share of its |p| in the outer tenths of a window that is twice as wide: a beam in open space
#: falls as 1/sqrt(distance), to 0.7 of it, or faster. The peak is the same one if it is within this share. And in so many windows more a wave without loss
#: that lies above the level on one side is looked at before the width is said to have no end there.
UNDIMINISHED, SAME, MORE = 0.9, 0.02, 3


def _rim(size: np.ndarray, level: float) -> _Rim:
    top, tenth = int(np.argmax(size)), max(1, size.size // 10)
    below = size < level * size[top]
    outer = max(size[:tenth].max(), size[-tenth:].max())
    return _Rim(float(size[top]), float(outer), bool(np.any(below[:top]) and np.any(below[top:])))


def _runs_on(seen: list[_Rim], lossless: bool) -> bool:
    """Whether windows, each twice as wide as the one before, show the same peak and a guided wave beside it that no window holds."""
    steady = [
        abs(now.peak - before.peak) < SAME * now.peak and UNDIMINISHED * before.outer < now.outer < now.peak
        for before, now in itertools.pairwise(seen)
    ]
    if all(rim.met for rim in seen[-2:]):
        return steady[-1:] == [True]
    return lossless and len(steady) >= MORE and all(steady[-MORE:])
