"""Power that a source in three dimensions carries through planes.

``P(z) = (1/8 pi^2) Re integral |S|^2 H_p H_v* dkx dky = (1/4 pi) Re integral <|S|^2> H_p H_v* k dk``, < > the mean over
directions: the integral of `plane_power`, with that mean, times k, as the strength of plane waves.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..fields.periodic_in_space import orders_within
from ..response.sampled_slab import SampledSlab
from ..sources.sum_in_space import parts_of
from .directions import Directions
from .plane_power import Launched, last_k, through_orders, through_planes, where_it_changes
from .power import PowerError

#: What is left out of |S| on a lattice, over its largest value: 1e-16 of |S|^2.
LEFT_OUT = 1e-8
#: A plane is on a rim that it misses by so much, over the rim's z.
ROUNDED = 8 * float(np.finfo(float).eps)


def power_through_planes_in_space(
    s: SampledSlab, source: Any, z: np.ndarray, rtol: float, period: tuple[float, float] | None
) -> tuple[np.ndarray, PowerError]:
    """Power through planes z (Z,) [W], and its largest estimated error over the source's incident power.

    Of sources on a lattice it is the power through one cell, a sum of its orders, and no error is known.
    """
    if z.min() < source.z0 - ROUNDED * abs(source.z0):
        raise ValueError(
            f"z: expected positions not in front of the rim of a bowl, z = {source.z0:.9g}, for power_through, "
            f"got {float(z.min()):.9g}"
        )
    z = np.maximum(z, source.z0)
    directions = Directions(source, s, {})

    def ends(tolerance: float) -> float:
        return max(part.source.rings(s.k0, tolerance)[1] for part in parts_of(source))

    def strength(k: np.ndarray, shift: float) -> np.ndarray:
        return directions.sent(k, shift) * k / (4 * math.pi)

    launched = Launched(strength, source.z0, ends, source.reach(1e-8), directions.count)
    if period is not None:
        return _of_a_cell(directions, launched, z, period)
    return through_planes(s, launched, z, rtol)


def _of_a_cell(
    directions: Directions, launched: Launched, z: np.ndarray, period: tuple[float, float]
) -> tuple[np.ndarray, PowerError]:
    """The power through one cell of a lattice: (1/2 Lx Ly) Re sum |S|^2 H_p H_v* over its orders."""
    s, source = directions.slab, directions.source
    end = last_k(s, launched, where_it_changes(s, z), (LEFT_OUT / 0.1) ** 2)
    orders = orders_within(np.clip(source.box(s.k0, LEFT_OUT), -end, end), period, source.z0)
    kx, ky = (v.ravel() for v in np.broadcast_arrays(orders.kx[None, :], orders.ky[:, None]))
    radii = orders.radii[orders.radius_of.ravel()]
    driven = directions.drive(orders.radii.astype(complex), np.zeros(1))[0][orders.radius_of.ravel()]
    sent = np.abs(driven * directions.spectrum(radii, kx[:, None], ky[:, None], 0.0)[:, 0]) ** 2
    strength = np.bincount(orders.radius_of.ravel(), sent, orders.radii.size) * orders.area / 2
    return through_orders(s, source.z0, z, orders.radii, strength)
