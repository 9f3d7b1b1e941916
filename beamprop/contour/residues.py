"""Poles on the wrong side of a contour, put right by small circles around them: their residues."""

from __future__ import annotations

import numpy as np

from ..modes.misplaced import MisplacedPoles
from ..response.sampled_slab import SampledSlab
from .paths import Contour


def add_residues(
    s: SampledSlab, contour: Contour, found: MisplacedPoles, across: float, along: float, second: bool = False
) -> Contour:
    """Add to a contour small circles around the poles on its wrong side.

    Trapezoid rule on a circle in the disc that holds nothing else, so small that neither e^{ikx} (over the distance `across`)
    nor e^{i kz z} (over `along`) turns or grows much on it: aliasing falls with the number of nodes as 1/n!. The `second`
    of two contours that are compared takes other circles. Clockwise where the contour passes below the pole, counter-clockwise
    where it passes above.
    """
    count, share = (36, 0.8) if second else (32, 1.0)
    nodes, weights = [], []
    for k, free in zip(found.poles, found.radii, strict=True):
        sense = 1 if k.real < found.crossing else -1
        if sense * (k.imag - np.interp(k.real, contour.k.real, contour.k.imag)) > 0:
            turn = np.exp(-2j * np.pi * sense * (np.arange(count) + 0.5) / count)
            slope = max(abs(k / np.sqrt(b * b - k * k + 0j)) for b in s.branch_points)  # |dkz/dkx|
            radius = share * min(free, 1.0 / (across + along * slope))
            nodes.append(k + radius * turn)
            weights.append(radius * turn * (-2j * np.pi * sense / count) / (2 * np.pi))
    if not nodes:
        return contour
    # in front, so that the contour's end stays the last node
    return Contour(
        np.concatenate([*nodes, contour.k]), np.concatenate([*weights, contour.weight]), circles=count * len(nodes)
    )
