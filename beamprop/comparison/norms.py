"""Errors of two sampled fields, on arrays (…, z, x) that are 0 where either field has no value."""

from __future__ import annotations

import functools
import warnings
from typing import Any

import numpy as np
import xarray as xr

from .grid import places_of


def cell_areas(p: xr.DataArray) -> np.ndarray:
    """Area, or volume, of the cell of each point of a grid (Z, X) or (Z, Y, X), each plane as a row: equal on an even one."""
    steps = [np.gradient(p[d].values) if p.sizes[d] > 1 else np.ones(1) for d in places_of(p)]
    return functools.reduce(np.outer, steps).reshape(steps[0].size, -1)


def weights(a: np.ndarray, b: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """Areas of the points, 0 where either field has no value."""
    good = np.isfinite(a) & np.isfinite(b)
    missing = good.size - np.count_nonzero(good)
    if missing == good.size:
        raise ValueError("b: expected values in the region that a covers, got NaN in one of them throughout")
    if missing:
        warnings.warn(f"{missing} of {good.size} points have no value in a or b and are left out", stacklevel=4)
    return good * areas


def _divide(top: np.ndarray, bottom: np.ndarray) -> np.ndarray:
    """NaN over nothing."""
    return np.where(bottom > 0, top / np.where(bottom > 0, bottom, 1), np.nan)


def _scaled_down(p: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> tuple[np.ndarray, np.ndarray]:
    """p over a power of two near its largest |p|, whose squares neither overflow nor vanish, and that power."""
    largest = np.abs(p).max(axes, keepdims=True)
    power = np.ldexp(1.0, np.frexp(largest)[1] - 1)
    return p / power, power


def norm(p: np.ndarray, w: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> np.ndarray:
    """sqrt(sum w |p|^2) over axes, scaled so that no square overflows."""
    small, power = _scaled_down(p, axes)
    return np.sqrt((w * np.abs(small) ** 2).sum(axes)) * power.squeeze(axes)


def best_scale(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> np.ndarray:
    """The complex factor that brings b nearest to a."""
    (a, of_a), (b, of_b) = _scaled_down(a), _scaled_down(b)
    scaled = _divide((w * np.conj(b) * a).sum((-2, -1)), (w * np.abs(b) ** 2).sum((-2, -1)))
    return scaled * (of_a / of_b).squeeze((-2, -1))


def relative_l2(a: np.ndarray, b: np.ndarray, w: np.ndarray, axes: tuple[int, ...] = (-2, -1)) -> np.ndarray:
    """Norm of a - b over that of a; NaN where a is 0 throughout."""
    return _divide(norm(a - b, w, axes), norm(a, w, axes))


def scaled_misfit(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Relative L2 error that the best scale factor leaves."""
    a, b = _scaled_down(a)[0], _scaled_down(b)[0]
    return relative_l2(a, best_scale(a, b, w)[..., None, None] * b, w)


def errors(a: np.ndarray, b: np.ndarray, w: np.ndarray, across: dict[str, np.ndarray], z: np.ndarray) -> dict[str, Any]:
    """Relative L2 errors of whole fields and by z, and the largest error and its place: z, and the axes of the points of a row."""
    off = np.where(w > 0, np.abs(a - b), -1.0)
    flat = off.reshape(*off.shape[:-2], -1)
    row, column = np.unravel_index(flat.argmax(-1), off.shape[-2:])
    places = np.unravel_index(column, tuple(at.size for at in across.values()))
    return {
        "relative_l2": relative_l2(a, b, w),
        "relative_l2_by_z": relative_l2(a, b, w, (-1,)),
        "largest_error": _divide(flat.max(-1), np.abs(a).max((-2, -1))),
        "largest_error_z": z[row],
    } | {f"largest_error_{name}": at[i] for (name, at), i in zip(across.items(), places, strict=True)}
