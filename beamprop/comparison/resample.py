"""A sampled field at other positions, by cubic splines along one axis, and the error that this makes."""

from __future__ import annotations

import numpy as np


def resample(old: np.ndarray, values: np.ndarray, new: np.ndarray, near: float) -> tuple[np.ndarray, float]:
    """Values along the last axis at new positions: picked where they are the old ones, else by cubic splines."""
    nearest = np.abs(old[:, None] - new[None, :]).argmin(axis=0) if old.size * new.size < 1e7 else _nearest(old, new)
    if np.all(np.abs(old[nearest] - new) <= near):
        return values[..., nearest], 0.0
    from scipy.interpolate import CubicSpline

    if np.all(np.isfinite(values)):
        return CubicSpline(old, values, axis=-1)(new), _interpolation_error(old, values, new)
    moved = np.apply_along_axis(lambda line: _through_gaps(old, line, new), -1, values)
    whole = np.isfinite(values).all(-1)
    return moved, _interpolation_error(old, values[whole], new) if np.any(whole) else 0.0


def _interpolation_error(old: np.ndarray, values: np.ndarray, new: np.ndarray) -> float:
    """Relative L2 error of splines through the samples, from those through every second and every fourth of them.

    The error falls from the fourth to the second as it falls from the second to all: 16 times for smooth fields.
    Where the second still miss the field, the samples may not resolve it either, and no fall is counted on.
    """
    second, fourth = (_misfit_of_every(stride, old, values, new) for stride in (2, 4))
    return second / float(np.clip(fourth / second, 1, 16)) if 0 < second < 0.1 else second


def _misfit_of_every(stride: int, old: np.ndarray, values: np.ndarray, new: np.ndarray) -> float:
    """Relative L2 error at the midpoints of a spline through every `stride`-th sample, where the new positions lie."""
    from scipy.interpolate import CubicSpline

    half = stride // 2
    middle = np.arange(half, old.size - half, stride)
    middle = middle[(old[middle + half] >= new[0]) & (old[middle - half] <= new[-1])]
    if old.size < 2 * stride or middle.size == 0:
        return 0.0
    values = values / (np.abs(values).max() or 1.0)
    misfit = CubicSpline(old[::stride], values[..., ::stride], axis=-1)(old[middle]) - values[..., middle]
    return float(np.linalg.norm(misfit) / (np.linalg.norm(values[..., middle]) or 1.0))


def _nearest(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    right = np.clip(np.searchsorted(old, new), 1, old.size - 1)
    return np.where(new - old[right - 1] <= old[right] - new, right - 1, right)


def _through_gaps(old: np.ndarray, line: np.ndarray, new: np.ndarray) -> np.ndarray:
    """A spline over each run of finite values; NaN between the runs."""
    from scipy.interpolate import CubicSpline

    out = np.full(new.size, complex(np.nan, np.nan))
    good = np.flatnonzero(np.isfinite(line))
    for run in np.split(good, np.flatnonzero(np.diff(good) > 1) + 1):
        if run.size > 1:
            inside = (new >= old[run[0]]) & (new <= old[run[-1]])
            out[inside] = CubicSpline(old[run], line[run])(new[inside])
    return out
