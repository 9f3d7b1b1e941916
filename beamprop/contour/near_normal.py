"""Singularities near kx = 0: a pole or branch point there pinches every contour through the origin.

The response is an even function of kx, and on a half circle kx^2 goes once around 0: the mean over it is the value at 0 if
the response is analytic inside (Cauchy), and differs by the share of poles inside it otherwise. Two contours with nodes farther
apart than the pole is from the origin would both miss it.
"""

from __future__ import annotations

import math

import numpy as np

from ..response.transfer_function import TransferFunction

#: Points on the half circle around kx = 0 over which a response is averaged: a singularity outside, at R radii, changes their mean by
#: R^-32, 2e-10 at two radii.
AROUND = 16
#: Singularities nearer to kx = 0 than this, over k0, are below rounding: (kx/k0)^2 = 1e-18.
NEAREST = 1e-9


def around(radii: np.ndarray) -> np.ndarray:
    """A point next to kx = 0, and `AROUND` points on the upper half circle of each radius; radii (..., R) -> (..., 1 + R AROUND)."""
    turn = np.exp(1j * np.pi * (np.arange(AROUND) + 0.5) / AROUND)
    circles = (radii[..., None] * turn).reshape(*radii.shape[:-1], -1)
    return np.concatenate([1e-9 * radii.min(axis=-1, keepdims=True), circles], axis=-1)


def is_calm(h: np.ndarray, allowed: float) -> np.ndarray:
    """Whether each circle holds no singularity, (Z, R), from the response at `around`, (Z, 1 + R AROUND).

    `allowed` is the difference of the mean from the value in the middle, over the larger of both, that is still rounding.
    """
    at_0, circles = h[:, :1], h[:, 1:].reshape(h.shape[0], -1, AROUND)
    size = np.maximum(np.abs(at_0), np.max(np.abs(circles), axis=2))
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(circles.mean(axis=2) - at_0) / np.where(size > 0, size, 1.0)
    return np.nan_to_num(apart, nan=np.inf) <= allowed


def nearest_singularity(transfer: TransferFunction, z: np.ndarray, radius: float, k0: float, allowed: float) -> float:
    """The largest radius of a sequence of ratio 4 that, with all smaller ones, holds no singularity on any plane; inf if all do."""
    count = max(2, math.ceil(math.log(radius / (NEAREST * k0), 4)) + 1)
    radii = radius * 4.0 ** -np.arange(count)
    with np.errstate(over="ignore", invalid="ignore"):
        calm = np.all(is_calm(transfer(around(radii), z), allowed), axis=0)
    disturbed = np.flatnonzero(~calm)
    return float(radii[min(disturbed[-1] + 1, count - 1)]) if disturbed.size else math.inf
