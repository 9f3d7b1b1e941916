"""The transfer function H(kx, z): total pressure, or particle velocity, at z per unit of the source's spectrum on the launch plane.

Free propagation in a half-space and the launch from a plane z0 in front of the slab stand here and nowhere else.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from .recursion import ON_FACE
from .sampled_slab import SampledSlab
from .slab import Response

#: Planes behind the slab whose waves are formed at a time: beside many planes no second array as large is held.
AT_A_TIME = 16


@dataclass(frozen=True)
class TransferFunction:
    """H(kx, z) of a slab at one frequency, for kx (n,) and depths z (Z,): (Z, n).

    `pressure(slab, kx, z)` gives the values; `through`, `free`, `reflected` and `transmitted` make the usual ones. All are even in
    kx: v_x is kx times its own, and belongs to a source whose spectrum is kx S(kx) (`sources.lateral.LateralGradient`).
    """

    slab: SampledSlab
    pressure: Callable[[SampledSlab, np.ndarray, np.ndarray], np.ndarray]

    def __call__(self, kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        """H(kx, z); with `shift` H at kx (1 + shift), w (1 - shift) and z (1 + shift/4): a second evaluation that shows rounding errors.

        That of z, a unit of its last place, shows in heavy layers, inside which p changes by more along z than a wave of k0 does. A depth on
        a membrane, over which p jumps, lies behind it, and there it stays.
        """
        return self.pressure(self.slab.perturbed(shift), kx * (1 + shift), z * (1 + shift / 4))


def through(s: SampledSlab, z0: float, quantity: str = "p") -> TransferFunction:
    """Total pressure in front of, inside and behind a slab, of a source on the launch plane z0; or "v_z", or "v_x" or "s_xz" over kx."""
    if quantity == "p":
        return TransferFunction(s, partial(total_pressure, z0=z0))
    return TransferFunction(s, partial(_total_velocity, z0=z0, quantity=quantity))


def of_velocity(transfer: TransferFunction) -> TransferFunction:
    """The same of a source whose normal velocity is given, times rho c of the medium in front: p is k/kz times it there."""

    def pressure(s: SampledSlab, kx: np.ndarray, z: np.ndarray) -> np.ndarray:
        return transfer.pressure(s, kx, z) * (s.branch_points[0] / s.kz_before(kx)[0])

    return TransferFunction(transfer.slab, pressure)


def of_depth(transfer: TransferFunction, factor: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> TransferFunction:
    """The same times a `factor` of kx and kz in front, (n,) each, which is no entire function of kx: that of a source with a depth."""

    def pressure(s: SampledSlab, kx: np.ndarray, z: np.ndarray) -> np.ndarray:
        return transfer.pressure(s, kx, z) * factor(kx, s.kz_before(kx)[0])

    return TransferFunction(transfer.slab, pressure)


def free(s: SampledSlab) -> TransferFunction:
    """Propagation over the distance z in the medium in front alone."""
    return TransferFunction(s, _without_slab)


def reflected(s: SampledSlab, z0: float) -> TransferFunction:
    """The reflected beam at the near face, whatever z."""
    return TransferFunction(s, lambda s, kx, z: np.broadcast_to(reflected_at_face(s, kx, z0)[0], (z.size, kx.size)))


def transmitted(s: SampledSlab, z0: float) -> TransferFunction:
    """The transmitted beam at the far face, whatever z."""
    return TransferFunction(s, lambda s, kx, z: np.broadcast_to(transmitted_at_face(s, kx, z0)[0], (z.size, kx.size)))


def propagation(kz: np.ndarray, distance: Any) -> np.ndarray:
    """exp(i kz distance): what an outgoing wave gains over a distance along its way in a half-space.

    On a contour that leaves the axis by too much for the distance it is not finite, which the comparison of two contours refuses.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        return np.exp(1j * (kz * distance))


def launched(s: SampledSlab, kx: np.ndarray, z0: float) -> np.ndarray:
    """Incident pressure at the near face per unit of the spectrum on the launch plane z0: (F, n)."""
    return propagation(s.kz_before(kx), -z0)


def reflected_at_face(s: SampledSlab, kx: np.ndarray, z0: float) -> np.ndarray:
    """Reflected pressure at the near face, of a source on z0: (F, n)."""
    return s.response(kx).r * launched(s, kx, z0)


def transmitted_at_face(s: SampledSlab, kx: np.ndarray, z0: float) -> np.ndarray:
    """Transmitted pressure at the far face, of a source on z0: (F, n)."""
    t = s.response(kx).t
    return t * launched(s, kx, z0) if z0 else t


def over_distance(s: SampledSlab, kx: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Free propagation in the medium in front over a distance (F,) for each frequency: (F, n)."""
    return propagation(s.kz_before(kx), distance[:, None])


def total_pressure(s: SampledSlab, kx: np.ndarray, z: np.ndarray, z0: float) -> np.ndarray:
    """Total pressure at depths z (Z,) of a source on z0, at one frequency: (Z, n)."""
    out = np.empty((z.size, kx.size), complex)
    front, behind = z <= 0, z + ON_FACE * np.abs(z) >= s.thickness
    inside = ~front & ~behind
    kz = s.kz_before(kx)[0]
    launch = propagation(kz, -z0)
    response = s.response(kx, z[inside])
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        if front.any():
            depth = z[front][:, None]
            out[front] = propagation(kz, depth - z0) + response.r[0] * launch * propagation(kz, -depth)
        if inside.any():
            out[inside] = response.inside[0] * launch if z0 else response.inside[0]
        rows = np.flatnonzero(behind)
        for i in range(0, rows.size, AT_A_TIME):
            part = rows[i : i + AT_A_TIME]
            out[part] = _behind(s, kx, response, np.maximum(z[part] - s.thickness, 0.0), "p") * launch
    return out


def _total_velocity(s: SampledSlab, kx: np.ndarray, z: np.ndarray, z0: float, quantity: str) -> np.ndarray:
    """v_z, or v_x or s_xz over kx, at depths z (Z,) of a source on z0, at one frequency: (Z, n).

    v_x jumps at an interface: there it is that of the medium behind, so places are told apart a few units of the last place
    behind z. v_z is continuous.
    """
    out = np.empty((z.size, kx.size), complex)
    at = z + ON_FACE * np.maximum(np.abs(z), s.thickness) if quantity == "v_x" else z
    front, behind = at <= 0, at >= s.thickness
    inside = ~front & ~behind
    response = s.response(kx, at[inside], quantity)
    kz = s.kz_before(kx)[0]
    launch = propagation(kz, -z0)
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        if front.any():
            depth, back = z[front][:, None], response.r[0] * launch
            forth = propagation(kz, depth - z0)
            back = back * propagation(kz, -depth)
            out[front] = s.velocity(kx, quantity)[0] * (forth - back if quantity == "v_z" else forth + back)
        if inside.any():
            out[inside] = response.inside[0] * launch
        if behind.any():
            out[behind] = _behind(s, kx, response, np.maximum(z[behind] - s.thickness, 0.0), quantity) * launch
        if quantity == "s_xz" and not s.far_face_shears:  # P and S waves cancel there, to their rounding
            out[np.abs(z - s.thickness) <= ON_FACE * s.thickness] = 0
    return out


def _behind(s: SampledSlab, kx: np.ndarray, response: Response, distance: np.ndarray, quantity: str) -> np.ndarray:
    """The waves behind, at distances (Z,) from the far face: (Z, n)."""
    parts = (
        amplitude[0] * propagation(kz[0], distance[:, None]) for kz, amplitude in s.waves_behind(kx, response, quantity)
    )
    return functools.reduce(np.add, parts)


def flux(s: SampledSlab, kx: np.ndarray, z: np.ndarray, z0: float, shift: float = 0.0) -> np.ndarray:
    """p v_z* - s_xz v_x*, whose real part is twice the power along z, at real kx and depths z (Z,) of a source on z0: (Z, n)."""
    p, v_z = (through(s, z0, quantity)(kx, z, shift) for quantity in ("p", "v_z"))
    along = p * np.conj(v_z)
    if s.carries_shear:
        s_xz, v_x = (through(s, z0, quantity)(kx, z, shift) for quantity in ("s_xz", "v_x"))
        along -= (kx * kx) * s_xz * np.conj(v_x)
    return along


def transmitted_power(s: SampledSlab, kx: np.ndarray, z0: float, shift: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """The transmitted p at the far face, and 2 w times the power along z behind, at real kx of a source on z0: (n,) each."""
    moved, k = s.perturbed(shift), kx * (1 + shift)
    response, launch = moved.response(k), launched(moved, k, z0)
    return (response.t * launch)[0], (s.transmitted_flux(kx, response) * np.abs(launch) ** 2)[0]


def _without_slab(s: SampledSlab, kx: np.ndarray, z: np.ndarray) -> np.ndarray:
    # beyond 1e39 m the phase overflows; no contour is flat enough for such a distance, and its plane waves are refused
    return propagation(s.kz_before(kx)[0], z[:, None])
