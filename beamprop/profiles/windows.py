"""p sampled across one plane, in windows that grow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from .. import memory
from ..contour import choose
from ..fields import evaluate
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import single
from ..sources.base import Beam

#: A window holds the beam when |p| at its ends is below this share of the level of the width. Not lower: the guided waves of a
#: lossless slab run on along it without end. Not higher: |p| may rise to the level between the samples beside the ends.
EDGE = 0.8
#: The window of a beam as a whole ends where |p| has fallen to this share of its peak; second moments and centroids are taken inside.
#: A Gaussian beam loses 4e-4 of its second moment by it, 2e-4 of its width.
TAIL = 0.01


class Sampled(NamedTuple):
    """p across one plane, and the plane waves that it is the sum of."""

    x: np.ndarray  #: (n,) m
    p: np.ndarray  #: (n,)
    quadrature: choose.Quadrature
    h: np.ndarray  #: the transfer function on the quadrature's contour, (1, n)

    def evaluator(self, s: SampledSlab, beam: Beam) -> Callable[[np.ndarray], np.ndarray]:
        """p at any x on the plane."""
        return evaluate.evaluator(s, beam, self.quadrature, self.h)


def ends_over_peak(p: np.ndarray) -> float:
    """The larger |p| at the ends of a window over the largest; nan where nothing arrives."""
    size = np.abs(p)
    largest = float(size.max())
    return float(max(size[0], size[-1])) / largest if largest > 0 else math.nan


class Windows(NamedTuple):
    """Windows that are tried one after the other."""

    positions: Iterable[np.ndarray]  #: even ones of each
    hold: Callable[[np.ndarray], bool]  #: whether p there is all that is measured
    thin: bool = True  #: take fewer positions where the plane waves that arrive need no more


@np.errstate(over="ignore", invalid="ignore")  # a field that is not finite is refused by name
def widened(
    s: SampledSlab,
    beam: Beam,
    transfer: TransferFunction,
    z: float,
    windows: Windows,
    rtol: float,
    guided: bool = True,
) -> Sampled:
    """p across the plane z in the first of the windows whose p holds all that is measured, or in the last."""
    plane = np.array([z])
    for x in windows.positions:
        quadrature = choose.choose_contour(s, single(beam), transfer, x, plane, rtol, guided)
        h = transfer(quadrature.contour.k, plane)
        if windows.thin and not quadrature.fft:
            x = _needed(s, beam, quadrature, h, x)
        p = evaluate.beam_sum(s, beam, quadrature, h, x)[0]
        if windows.hold(p):
            break
    return Sampled(x, p, quadrature, h)


#: Plane waves below this share of the strongest move |p| between the samples by no more than that; the first positions of a window
#: are chosen by the same share of the beam's band.
FAINT = 1e-4


def _needed(s: SampledSlab, beam: Beam, quadrature: choose.Quadrature, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """As many even positions as the plane waves that arrive need: most of a sharp edge's decay on the way."""
    right, left = quadrature.amplitudes_of(s.k0, single(beam))
    strength = np.abs(h[0]) * (np.abs(right[0]) + np.abs(left[0]))
    largest = float(np.max(np.abs(quadrature.contour.k.real), where=strength > FAINT * strength.max(), initial=0.0))
    count = 2 * max(64, math.ceil((x[-1] - x[0]) * largest / np.pi)) + 1
    memory.check_terms(quadrature.contour.k.size, min(count, x.size))
    return x if count >= x.size else np.linspace(x[0], x[-1], count)
