"""One question of the study: slab, beam, frequency, positions and planes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

import beamprop as bp


class Case(NamedTuple):
    """One question, the class that it belongs to, and its rtol."""

    kind: str
    source: str
    slab: bp.Slab
    beam: Any
    frequency: float
    x: np.ndarray
    z: np.ndarray
    rtol: float


class SpaceCase(NamedTuple):
    """A question in three dimensions, the class that it belongs to, and its rtol."""

    kind: str
    slab: bp.Slab
    beam: Any
    frequency: float
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    rtol: float
