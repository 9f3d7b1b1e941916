"""Plane waves through layers with any number of digits: 2 x 2 matrices of the state (p, q = p'/density), layer by layer.

Fluids are (density, density_x, bulk modulus); layers have their thickness as a fourth number, as in `Medium.segments`. All take
kx^2, of which what happens inside a slab is an entire function, and work with mpmath's present precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np

from .medium import Medium


def kz_of(fluid: Sequence, omega: Any, kx2: Any) -> Any:
    """The principal root of kz^2 = density (omega^2/K - kx^2/density_x)."""
    rho, rho_x, K = (mp.mpmathify(v) for v in fluid[:3])
    return mp.sqrt(rho * (omega**2 / K - kx2 / rho_x))


def outgoing(fluid: Sequence, omega: Any, kx2: Any) -> Any:
    """The root that decays along +z with a trace of loss in the fluid: half the digits below 1."""
    rho, rho_x, K = (mp.mpmathify(v) for v in fluid[:3])
    trace = 1j * mp.mpf(10) ** -(mp.mp.dps // 2)
    kz = kz_of(fluid, omega, kx2)
    lossy = mp.sqrt((rho + trace * abs(rho)) * (omega**2 / K * (1 + trace) - kx2 / (rho_x + trace * abs(rho_x))))
    lossy = lossy if lossy.imag > 0 else -lossy
    return kz if abs(kz - lossy) < abs(kz + lossy) else -kz


def layer(fluid: Sequence, d: Any, omega: Any, kx2: Any) -> Any:
    """The state a distance d behind, or in front for d < 0, from the state here."""
    rho, kz = mp.mpmathify(fluid[0]), kz_of(fluid, omega, kx2)
    if kz == 0:
        return mp.matrix([[1, rho * d], [0, 1]])
    c, s = mp.cos(kz * d), mp.sin(kz * d)
    return mp.matrix([[c, rho * s / kz], [-kz * s / rho, c]])


def product(layers: Sequence, omega: Any, kx2: Any) -> Any:
    """The matrix of layers, near face first."""
    out = mp.eye(2)
    for fluid in layers:
        out = layer(fluid, mp.mpmathify(fluid[3]), omega, kx2) * out
    return out


def power(m: Any, n: int) -> Any:
    """m to the n, by repeated squaring."""
    out = mp.eye(2)
    while n:
        if n & 1:
            out = m * out
        m = m * m
        n >>= 1
    return out


def states(layers: Sequence, far: Any, z: np.ndarray, omega: Any, kx2: Any) -> tuple[Any, dict[int, Any]]:
    """From the state at the far face: the state at the near face, and p at the planes z inside, by their index."""
    faces = [mp.mpf(0)]
    for fluid in layers:
        faces.append(faces[-1] + mp.mpf(fluid[3]))
    of_layer = np.clip(np.searchsorted([float(f) for f in faces], z, side="right") - 1, 0, len(layers) - 1)
    inside: dict[int, Any] = {}
    state = far
    for n in reversed(range(len(layers))):
        for i in np.flatnonzero((of_layer == n) & (z > 0) & (z <= float(faces[-1]))):
            inside[int(i)] = (layer(layers[n], mp.mpf(float(z[i])) - faces[n + 1], omega, kx2) * state)[0]
        state = layer(layers[n], -mp.mpf(layers[n][3]), omega, kx2) * state
    return state, inside


def response(m: Medium, k: complex, z: np.ndarray, z0: float, digits: int = 60) -> np.ndarray:
    """As `Medium.response` at one kx, (Z,), with so many digits; layer by layer, without powers of periods."""
    with mp.workdps(digits):
        omega, kx2 = mp.mpf(m.omega), mp.mpmathify(complex(k)) ** 2
        layers = [fluid for part, periods in m.segments for _ in range(periods) for fluid in part]
        kz1, kz2 = outgoing(m.before, omega, kx2), outgoing(m.after, omega, kx2)
        soft = m.wall < np.inf
        far = mp.matrix([0, 1] if soft else [1, 1j * kz2 / mp.mpmathify(m.after[0])])
        (p, q), inside = states(layers, far, np.asarray(z, float), omega, kx2)
        y = 1j * kz1 / mp.mpmathify(m.before[0])
        forward, backward = (p + q / y) / 2, (p - q / y) / 2
        deepest = mp.fsum(mp.mpf(fluid[3]) for fluid in layers)
        out = np.empty(len(z), complex)
        for i, depth in enumerate(float(v) for v in z):
            if depth <= 0:
                there = forward * mp.expj(kz1 * depth) + backward * mp.expj(-kz1 * depth)
            elif i in inside:
                there = inside[i]
            else:
                there = mp.mpf(0) if soft else mp.expj(kz2 * (depth - deepest))
            out[i] = complex(there / forward * mp.expj(-kz1 * z0))
        return out
