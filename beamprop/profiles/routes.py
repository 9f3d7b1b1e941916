"""How a beam gets to the plane across which it is measured, at many frequencies, and what is measured there."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction

#: H(kx) at one plane for each frequency, (F, n) -> (F, n): what `TransferFunction` is at one frequency.
Plane = Callable[[np.ndarray], np.ndarray]


class Measures(NamedTuple):
    """Of a profile, (F,) each: full width [m], peak [Pa], centroid [m]; how often |p| crosses the level in the window, and error.

    The error is that of |p| over its peak.
    """

    width: np.ndarray
    peak: np.ndarray
    centroid: np.ndarray
    crossings: np.ndarray
    error: np.ndarray


def far_face(s: SampledSlab, z0: float) -> Plane:
    """Transfer from the launch plane z0 to the far face."""

    def plane(kx: np.ndarray) -> np.ndarray:
        return transfer_function.transmitted_at_face(s, kx, z0)

    return plane


def without(s: SampledSlab, distance: np.ndarray) -> Plane:
    """Transfer over distances (F,) in the medium in front."""

    def plane(kx: np.ndarray) -> np.ndarray:
        return transfer_function.over_distance(s, kx, distance)

    return plane


class Route(NamedTuple):
    """How a beam gets to the plane that is measured, at F frequencies."""

    slab: SampledSlab
    plane: Callable[[SampledSlab, np.ndarray], Plane]  #: of a slab and the lengths along z
    transfer: Callable[[SampledSlab], TransferFunction]  #: the same for the slab of one frequency
    z: np.ndarray  #: (F,) where that transfer meets the plane
    path: np.ndarray  #: (F,) length along z
    guided: bool  #: whether there is a slab on the way
