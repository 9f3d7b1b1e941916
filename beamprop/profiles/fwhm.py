"""Measures of a beam's profile, on arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Level of |p| at half maximum, by what the width is of.
HALF_LEVEL = {"pressure": 0.5, "intensity": np.sqrt(0.5)}

#: Positions by which the interval between two samples is looked at before the search inside; and how far the peak and the edges are
#: known then, over the distance of the samples. |p| is flat at its peak: half the digits serve.
SUBSAMPLES, PEAK_TOLERANCE, EDGE_TOLERANCE = 17, 1e-6, 1e-11

Evaluate = Callable[[np.ndarray], np.ndarray]


class Width(NamedTuple):
    """Full width [m] (nan where the level is not reached inside the window), place [m] and size of the peak."""

    width: float
    position: float
    peak: float


def spline(x: np.ndarray, p: np.ndarray) -> Evaluate:
    """Cubic-spline interpolation of a complex profile."""
    from scipy.interpolate import CubicSpline

    return CubicSpline(x, p)


def full_width(x: np.ndarray, p: np.ndarray, level: float = 0.5, evaluate: Evaluate | None = None) -> Width:
    """Distance between the two places nearest to the largest |p| where |p| has fallen to `level` times it.

    Parameters
    ----------
    x : (n,) increasing, m
    p : (n,) complex
    level : float
        0.5 for the width of |p|, sqrt(0.5) for that of |p|^2.
    evaluate : function of an array of positions, optional
        p between the samples; a cubic spline of p by default.

    Returns
    -------
    Width
    """
    evaluate = evaluate or spline(x, p)
    size = np.abs(p)
    top = int(np.argmax(size))
    position, peak = _peak(x, size, top, evaluate)
    sides = []
    for step in (-1, 1):
        edge = _crossing(x, size, top, step, level * peak, position, evaluate)
        if edge is None:
            return Width(np.nan, position, peak)
        sides.append(edge)
    return Width(sides[1] - sides[0], position, peak)


def _peak(x: np.ndarray, size: np.ndarray, top: int, evaluate: Evaluate) -> tuple[float, float]:
    """Place and size of the largest |p|, between the samples beside the largest one (repeated narrowing)."""
    if top in (0, x.size - 1):
        return float(x[top]), float(size[top])
    lo, hi = float(x[top - 1]), float(x[top + 1])
    from scipy.optimize import minimize_scalar

    fine = np.linspace(lo, hi, SUBSAMPLES)
    values = np.abs(evaluate(fine))
    best = int(np.clip(np.argmax(values), 1, SUBSAMPLES - 2))
    bounds = float(fine[best - 1]), float(fine[best + 1])
    found = minimize_scalar(
        lambda at: -_size(evaluate, at), bounds=bounds, method="bounded", options={"xatol": PEAK_TOLERANCE * (hi - lo)}
    )
    if -found.fun > values[best]:
        return float(found.x), float(-found.fun)
    return float(fine[best]), float(values[best])


def _size(evaluate: Evaluate, at: float) -> float:
    """|p| at one position."""
    return float(np.abs(evaluate(np.array([at])))[0])


def _crossing(
    x: np.ndarray, size: np.ndarray, top: int, step: int, target: float, position: float, evaluate: Evaluate
) -> float | None:
    """Where |p| first falls to the target beyond the peak, in one direction."""
    side = np.arange(top, x.size if step > 0 else -1, step)
    below = np.flatnonzero(size[side] < target)
    if below.size == 0:
        return None
    inner = x[side[below[0] - 1]] if below[0] else position
    if (position - inner) * step > 0:  # the peak lies beyond that sample
        inner = position
    outer = float(x[side[below[0]]])
    from scipy.optimize import brentq

    fine = np.linspace(inner, outer, SUBSAMPLES)
    excess = np.nan_to_num(np.abs(evaluate(fine)) - target, nan=0.0)
    # the ends are known to rounding: the sample within is above the level, the one beyond is below
    excess[0], excess[-1] = max(excess[0], 0.0), min(excess[-1], -np.finfo(float).tiny)
    first = int(np.argmax(excess < 0))
    if excess[first - 1] == 0:
        return float(fine[first - 1])
    ends = {float(fine[i]): float(excess[i]) for i in (first - 1, first)}
    return float(
        brentq(
            lambda at: ends[at] if at in ends else _size(evaluate, at) - target,
            fine[first - 1],
            fine[first],
            xtol=EDGE_TOLERANCE * abs(outer - inner),
        )
    )


def crossings(p: np.ndarray, target: float) -> int:
    """How often the samples of |p| cross a level; 2 for a plain beam."""
    return int(np.count_nonzero(np.diff(np.abs(p) > target)))


def centroid(x: np.ndarray, p: np.ndarray) -> float:
    """Centroid of |p|^2 over the sampled window (trapezoid rule) [m]."""
    power = np.abs(p) ** 2
    total = np.trapezoid(power, x)
    return float(np.trapezoid(power * x, x) / total) if total > 0 else np.nan
