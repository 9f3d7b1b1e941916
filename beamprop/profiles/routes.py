"""How a beam gets to the plane across which it is measured, at many frequencies, and what is measured there."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from ..contour.error import ErrorBudget
from ..contour.stationary_phase import TransferToPlane
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction


class Measures(NamedTuple):
    """Of profiles, (F,) each: full width [m], peak [Pa], centroid [m]; how often |p| crosses the level in the window."""

    width: np.ndarray
    peak: np.ndarray
    centroid: np.ndarray
    crossings: np.ndarray
    budget: ErrorBudget  #: terms of the estimated error of |p| over its peak

    @property
    def table(self) -> np.ndarray:
        """Everything as rows of an array, the terms of the error last: (R, F)."""
        return np.array([*self[:4], *self.budget], float)


def measures_of(table: np.ndarray) -> Measures:
    """The measures of which `table` is the table."""
    width, peak, centroid, crossings, *terms = table
    return Measures(width, peak, centroid, crossings, ErrorBudget(*terms))


def far_face(s: SampledSlab, z0: float) -> TransferToPlane:
    """H from the launch plane z0 to the far face."""
    return partial(transfer_function.transmitted_at_face, s, z0=z0)


def without(s: SampledSlab, distance: np.ndarray) -> TransferToPlane:
    """H over distances (F,) in the medium in front."""
    return partial(transfer_function.over_distance, s, distance=distance)


class Route(NamedTuple):
    """How a beam gets to the plane that is measured, at F frequencies."""

    slab: SampledSlab
    plane: Callable[[SampledSlab, np.ndarray], TransferToPlane]  #: of a slab and the lengths along z
    transfer: Callable[[SampledSlab], TransferFunction]  #: the same for the slab of one frequency
    z: np.ndarray  #: (F,) where that transfer meets the plane
    path: np.ndarray  #: (F,) length along z
    guided: bool  #: whether there is a slab on the way
