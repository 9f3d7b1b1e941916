"""The open-space field at its plainest: the trapezoid rule on one bent contour.

The contour passes below the poles and the branch point on the right and above those on the left.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import beamprop as bp

from .medium import Medium
from .quadrature import field_sum


def bent_contour(k0: float, bend: float = 3.0, band: float = 220.0, count: int = 3001) -> tuple[np.ndarray, np.ndarray]:
    """The right half of kx = s - i bend tanh(2 s/k0), below the axis, and its weights dkx/ds ds: the trapezoid rule from 0."""
    s = np.linspace(0, band, count)
    slope = 1 - 1j * bend * (2 / k0) / np.cosh(np.minimum(2 * s / k0, 300)) ** 2
    weight = slope * (s[1] - s[0])
    weight[0] /= 2
    return s - 1j * bend * np.tanh(2 * s / k0), weight


def open_field(
    slab: bp.Slab, frequency: float, spectrum: Callable, z0: float, x: Any, z: Any, **contour: float
) -> np.ndarray:
    """p(z, x) in open space: the trapezoid rule on the bent contour, with the accuracy study's cascade of scattering matrices.

    spectrum: S(kx) of the pressure on the launch plane z0; contour: bend, band and count of `bent_contour`.
    """
    medium = Medium(slab, frequency)
    kx, weight = bent_contour(medium.k0, **contour)

    def response(k: np.ndarray) -> np.ndarray:
        return medium.response(k, np.asarray(z), z0)

    return field_sum(lambda k, kz: spectrum(k), response, kx, weight, None, np.asarray(x))
