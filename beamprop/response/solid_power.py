"""Many periods of a cell of solids alone: its maps of minors (5 x 5) and of states (4 x 4), squared log2(periods) times."""

from __future__ import annotations

from typing import TypeVar

import numpy as np

from ..media.solids import SolidBlock
from .solid_layer import Along, layers_back
from .solids import Minors, Vector, minors_back, vector_back

Carried = TypeVar("Carried", Minors, Vector)


def block_back(block: SolidBlock, omega: np.ndarray, kx: np.ndarray, far: Carried) -> Carried:
    """Carry minors, or a state, back through all periods of a block; growth is taken out at each squaring."""
    count: int = len(far) - 1
    shape: tuple[int, ...] = np.broadcast_shapes(omega.shape, kx.shape)
    units: np.ndarray = np.broadcast_to(np.eye(count)[:, :, None, None], (count, count, *shape)).astype(complex)
    # the map's columns: all units at once along a leading axis
    columns = type(far)._make([*units, np.zeros((count, *shape))])
    for _, y in layers_back(block.layers, omega, Along(kx)):
        columns = minors_back(columns, y) if isinstance(columns, Minors) else vector_back(columns, y)
    log = columns.log.max(axis=0)
    weight = np.exp(columns.log - log)
    power = np.stack([np.moveaxis(c * weight, 0, -1) for c in columns[:-1]], axis=-2)  # (F, n, row, column)
    state: np.ndarray = np.stack([np.broadcast_to(c, shape) for c in far[:-1]], axis=-1)[..., None]
    state_log, left = np.broadcast_to(far.log, shape), block.periods
    while left:
        if left & 1:
            state, state_log = _scaled(power @ state, state_log + log)
        left >>= 1
        if left:
            power, log = _scaled(power @ power, 2 * log)
    return type(far)._make([*(state[..., i, 0] for i in range(count)), state_log])


def _scaled(values: np.ndarray, log: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Size taken out into the logarithm."""
    size = np.abs(values).max(axis=(-2, -1))
    size = np.where((size > 0) & np.isfinite(size), size, 1.0)
    return values / size[..., None, None], log + np.log(size)
