"""Where a beam lands, by stationary phase: a plane wave of transfer function H is shifted along x by -d(arg H)/dkx.

The derivative is a difference over a small step in kx. The least and the most shift of a beam's strong plane waves span its
footprint on a plane; after a long way, where plane waves part, those of the plane waves that are bright where they land.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..sources.rows import RowBeam

#: Below this |H| a difference over step H may overflow or lose digits: the smallest normal number, 2e-308, leaves 58 decades for the
#: step in kx and for H's rounding.
FAINT = 1e-250
#: Plane waves of more than this share of the largest |H| are strong. A plain choice: with less faint tails widen the footprint, and the
#: window that is sampled; with more its edges, where |p| is a tenth of its peak, are cut.
STRONG = 0.1


def _beside(h: Callable[[np.ndarray], np.ndarray], k: np.ndarray, step: Any) -> tuple[np.ndarray, np.ndarray]:
    """H a step below and a step above each kx, along the last axis."""
    low, high = np.split(h(np.concatenate([k - step, k + step], axis=-1).astype(complex)), 2, axis=-1)
    return low, high


def shifts(low: np.ndarray, high: np.ndarray, step: Any) -> tuple[np.ndarray, np.ndarray]:
    """How far each plane wave is carried along x, and 2 |H|; `low` and `high` are H a `step` below and above each kx."""
    twice = low + high
    size = np.abs(twice)
    with np.errstate(over="ignore", invalid="ignore"):  # where H has a zero, which is not strong
        return -np.imag((high - low) / np.where(size > FAINT, step * twice, 1.0)), size


def span(low: np.ndarray, high: np.ndarray, step: Any) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most shift of the strong plane waves along the last axis, 0 where there are none."""
    shift, size = shifts(low, high, step)
    strong = (size > STRONG * size.max(axis=-1, keepdims=True)) & (size > FAINT)
    return _extremes(shift, strong)


def _extremes(shift: np.ndarray, where: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most shift along the last axis among those with `where`; 0 if there is none, or no finite one."""
    least, most = shift.min(-1, where=where, initial=np.inf), shift.max(-1, where=where, initial=-np.inf)
    return np.where(np.isfinite(least), least, 0.0), np.where(np.isfinite(most), most, 0.0)


#: H(kx) on one plane for each frequency: (F, n) -> (F, n).
TransferToPlane = Callable[[np.ndarray], np.ndarray]

#: From a way along z of FAR/k0 on, 1600 wavelengths, the window is that of `_far_span`; before it waves land at most as far to the side:
#: a ray of kx = 0.98 k0 is shifted five times its way along z, and more only by delays in resonances.
FAR = 1e4
#: Plane waves across a beam's band for each side of the normal: their shifts are a smooth function, whose extremes 20 samples hit to a
#: few per cent of the span; a window is wider than it by 1.5 source's widths and a wavelength.
ACROSS = 20


def landing(k0: Any, beam: RowBeam, plane: TransferToPlane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half-width (F,) of windows that hold the beam after a way `path` (F,) along z.

    The beam's strong plane waves span the window.
    """
    lo, hi = beam.band(k0, 0.3)
    even = bool(np.all(lo == -hi))  # H is even in kx too: half of the plane waves show all
    k0_row = k0[:, None]
    count = 1 + (ACROSS if even else 2 * ACROSS)
    k = np.clip(np.linspace(0 * lo if even else lo, hi, count, axis=-1), -0.98 * k0_row, 0.98 * k0_row)
    step = 1e-4 * k0_row
    least, most = span(*_beside(plane, k, step), step)
    if even:
        least, most = np.minimum(least, -most), np.maximum(most, -least)
    least, most = (np.clip(v, -FAR / k0, FAR / k0) for v in (least, most))
    far = path > FAR / k0
    if np.any(far):
        pairs = zip(_far_span(k0, beam, plane, path), (least, most), strict=True)
        least, most = (np.where(far, *pair) for pair in pairs)
    return beam.centre + (most + least) / 2, 1.5 * beam.reach(1e-2) + 2 * np.pi / k0 + (most - least) / 2


#: Plane waves that sample a far field; and the share of the largest |p| down to which its window reaches: widths are measured at half the
#: peak, which lies well inside.
RAYS, BRIGHT = 401, 0.25


def _far_span(k0: Any, beam: RowBeam, plane: TransferToPlane, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The least and the most shift (F,) of the rays that are bright where they land.

    Rays part on a long way: |p| of a far field is |S H| / sqrt(2 pi |dx/dkx|), x(kx) being where a plane wave lands. Only part of the
    rays is nearly as bright as the brightest, so that this window is narrower than that of all plane waves of the beam.
    """
    lo, hi = (np.clip(v, -0.999 * k0, 0.999 * k0) for v in beam.band(k0, 1e-2))
    k0_row, k = k0[:, None], np.linspace(lo, hi, RAYS, axis=-1)
    step = np.minimum(1e-4 * k0_row, 0.01 * k0_row / (1 + k0_row * path[:, None]))  # phases turn little over a step
    x, size = shifts(*_beside(plane, k, step), step)
    spread = np.abs(np.gradient(x, axis=-1)) / (np.maximum(hi - lo, 1e-6 * k0)[:, None] / (RAYS - 1))
    brightness = size * np.abs(beam.spectrum(k, k0_row)) / np.sqrt(spread + beam.reach(0.1) ** 2)
    bright = brightness > BRIGHT * np.max(brightness, axis=-1, keepdims=True)
    bright[:, 1:] |= bright[:, :-1]
    bright[:, :-1] |= bright[:, 1:]
    return _extremes(x, bright)
