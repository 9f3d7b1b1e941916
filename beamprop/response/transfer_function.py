"""What becomes of a plane wave of the source on its way: the response in front of, inside and behind a slab.

Everything here is for one frequency; a `SampledSlab` holds what does not change from line to line.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .sampled_slab import SampledSlab

#: h(kx, z): what a plane wave of the source's spectrum has become at z; (Z, n).
#: h(kx, z, shift): the same at kx (1 + shift) and w (1 - shift), to see what rounding does.
TransferFunction = Callable[..., np.ndarray]


def factors(s: SampledSlab, kx: np.ndarray, z: np.ndarray, z0: float) -> np.ndarray:
    """h(z, kx): total pressure at z per unit of the source's spectrum on z = z0; (Z, n)."""
    out = np.empty((z.size, kx.size), complex)
    front, behind = z <= 0, z >= s.thickness
    inside = ~front & ~behind
    kz = s.kz_before(kx)[0]
    launch = np.exp(-1j * kz * z0)
    res = s.response(kx, z[inside])
    with np.errstate(under="ignore"):
        if front.any():
            depth = z[front][:, None]
            out[front] = np.exp(1j * kz * (depth - z0)) + res.r[0] * launch * np.exp(-1j * kz * depth)
        if inside.any():
            out[inside] = res.inside[0] * launch if z0 else res.inside[0]
        if behind.any():
            kz2 = s.kz_after(kx)[0]
            out[behind] = res.t[0] * launch * np.exp(1j * kz2 * (z[behind] - s.thickness)[:, None])
    return out


def through(s: SampledSlab, z0: float) -> TransferFunction:
    """The transfer through a slab from the launch plane z0."""

    def transfer(kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        return factors(s.perturbed(shift), kx * (1 + shift), z, z0)

    return transfer


def free(s: SampledSlab) -> TransferFunction:
    """The transfer through the medium in front alone, over the distance z."""

    def transfer(kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        kz = s.perturbed(shift).kz_before(kx * (1 + shift))[0]
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # over 1e39 m no contour is flat enough: refused by its plane waves
            return np.exp(1j * np.multiply.outer(z, kz))

    return transfer
