"""Where a beam lands: windows on x that hold it after its way along z, by stationary phase."""

from __future__ import annotations

import numpy as np

from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import FAINT as DARK
from ..response.transfer_function import shifts
from ..sources.beams import Beam
from .routes import Plane

#: From a way along z of so many 1/k0 on the window is that of `_far_landing`; before, waves land at most so far to the side.
FAR = 1e4


def landing(s: SampledSlab, beam: Beam, plane: Plane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half-width (F,) of windows that hold the beam after a way `path` (F,) along z, by stationary phase.

    The beam's strong plane waves span the window.
    """
    lo, hi = beam.band(s.k0, 0.3)
    even = bool(np.all(lo == -hi))  # h is even in kx too: half of the plane waves show all
    k0 = s.k0[:, None]
    k = np.clip(np.linspace(0 * lo if even else lo, hi, 21 if even else 41, axis=-1), -0.98 * k0, 0.98 * k0)
    small = 1e-4 * k0
    low, high = np.split(plane(np.concatenate([k - small, k + small], axis=-1).astype(complex)), 2, axis=-1)
    least, most = shifts(low, high, small)
    if even:
        least, most = np.minimum(least, -most), np.maximum(most, -least)
    least, most = (np.clip(v, -FAR / s.k0, FAR / s.k0) for v in (least, most))
    far = path > FAR / s.k0
    if np.any(far):
        least, most = (
            np.where(far, *pair) for pair in zip(_far_landing(s, beam, plane, path), (least, most), strict=True)
        )
    return beam.centre + (most + least) / 2, 1.5 * beam.reach(1e-2) + 2 * np.pi / s.k0 + (most - least) / 2


#: Plane waves by which a far field is looked at, and what share of the largest |p| the window of a far field holds.
RAYS, BRIGHT = 401, 0.25


def _far_landing(s: SampledSlab, beam: Beam, plane: Plane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most shift (F,) along x of the rays that are bright where they land.

    Rays part on a long way: |p| of a far field is |S h| / sqrt(2 pi |dx/dkx|), x(kx) being where a plane wave lands (stationary
    phase). Few are as bright as the strongest, so that the window is narrower than all the plane waves of the beam would span it.
    """
    lo, hi = (np.clip(v, -0.999 * s.k0, 0.999 * s.k0) for v in beam.band(s.k0, 1e-2))
    k0, k = s.k0[:, None], np.linspace(lo, hi, RAYS, axis=-1)
    small = np.minimum(1e-4 * k0, 0.01 * k0 / (1 + k0 * path[:, None]))  # phases turn little over a step
    low, high = np.split(plane(np.concatenate([k - small, k + small], axis=-1).astype(complex)), 2, axis=-1)
    twice = np.where(np.abs(low + high) > DARK, low + high, 1.0)
    x = -np.imag((high - low) / (small * twice))
    spread = np.abs(np.gradient(x, axis=-1)) / (np.maximum(hi - lo, 1e-6 * s.k0)[:, None] / (RAYS - 1))
    strength = np.abs(low + high) * np.abs(beam.spectrum(k, k0))
    size = strength / np.sqrt(spread + beam.reach(0.1) ** 2)
    bright = size > BRIGHT * np.max(size, axis=-1, keepdims=True)
    bright[:, 1:] |= bright[:, :-1]
    bright[:, :-1] |= bright[:, 1:]
    least, most = np.min(x, axis=-1, where=bright, initial=np.inf), np.max(x, axis=-1, where=bright, initial=-np.inf)
    good = np.isfinite(least) & np.isfinite(most)
    return np.where(good, least, 0.0), np.where(good, most, 0.0)
