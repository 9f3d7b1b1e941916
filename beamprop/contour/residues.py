"""Residues of poles on the wrong side of a contour, by small circles around them."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..modes.misplaced import MisplacedPoles
from ..response.sampled_slab import SampledSlab
from .paths import Contour, Extent


def add_residues(
    s: SampledSlab, contour: Contour, misplaced: Iterable[MisplacedPoles], extent: Extent, second: bool = False
) -> Contour:
    """Add to a contour small circles around the poles on its wrong side.

    Trapezoid rule on a circle inside the pole's own disc, so small that e^{ikx} and e^{i kz z} change by no more than a factor e
    on it: aliasing of n nodes falls as 1/n! for these and as 0.4^n for known singularities (`misplaced.with_discs`), 2e-13 at 32.
    The `second` of two contours that are compared takes smaller circles with more nodes. They go clockwise where the contour passes
    below the pole, counter-clockwise where it passes above.
    """
    count, share = (36, 0.8) if second else (32, 1.0)
    nodes, weights = [], []
    for poles in misplaced:
        for k, free in zip(poles.poles, poles.radii, strict=True):
            sense = 1 if k.real < poles.crossing else -1
            if sense * (k.imag - np.interp(k.real, contour.k.real, contour.k.imag)) > 0:
                turn = np.exp(-2j * np.pi * sense * (np.arange(count) + 0.5) / count)
                slope = max(abs(k / np.sqrt(b * b - k * k + 0j)) for b in s.branch_points)  # |dkz/dkx|
                radius = share * min(free, 1.0 / (extent.across + extent.path * slope))
                nodes.append(k + radius * turn)
                weights.append(radius * turn * (-2j * np.pi * sense / count) / (2 * np.pi))
    if not nodes:
        return contour
    # in front, so that the contour's end stays the last node
    return contour._replace(
        k=np.concatenate([*nodes, contour.k]),
        weight=np.concatenate([*weights, contour.weight]),
        circles=count * len(nodes),
    )
