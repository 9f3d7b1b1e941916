"""Full widths of profiles p(x) at a share of their largest |p|: of many profiles at once, the last axis being x."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Level of |p| at half maximum, by what the width is of.
HALF_LEVEL = {"pressure": 0.5, "intensity": np.sqrt(0.5)}

#: Positions at which p is evaluated between two samples before the search there: a cubic spline's |p|^2 is of degree six, with at
#: most three maxima in the interval, which 16 steps tell apart.
SUBSAMPLES = 17
#: Parabolas through |p| by which the peak is placed, each this many times narrower than the one before. The error of a vertex goes
#: with the square of the parabola's width: 1e-8 samples after three, and |p| is flat there.
PARABOLAS, NARROWER = 3, 16
#: How far the edges are known, over the interval of samples in which they lie: 1e-12 of a width of ten samples.
EDGE_TOLERANCE = 1e-11
#: Bisection alone gets from an interval of samples to that tolerance in log2(1e11) = 37 steps; interpolation that fails takes more.
MOST_STEPS = 60
#: Samples of profiles that are interpolated at a time: their splines take 64 bytes each, 64 MB.
MOST_SAMPLES = 2**20

#: Positions (..., m) of each profile -> p there, (..., m).
Evaluate = Callable[[np.ndarray], np.ndarray]


class Width(NamedTuple):
    """Of each profile (...): places [m] of both edges (nan where the level is not reached), place and size of the peak, and how often
    the samples of |p| cross the level (2 for a plain beam)."""

    left: np.ndarray
    right: np.ndarray
    position: np.ndarray
    peak: np.ndarray
    crossings: np.ndarray

    @property
    def width(self) -> np.ndarray:
        """Full width [m]; nan where the level is not reached on one side."""
        return self.right - self.left


def full_width(
    x: np.ndarray,
    p: np.ndarray,
    level: float = 0.5,
    evaluate: Evaluate | None = None,
    inside: np.ndarray | None = None,
    subsamples: int = SUBSAMPLES,
) -> Width:
    """Where |p| has fallen to `level` times its largest, nearest to that peak on both sides.

    Parameters
    ----------
    x : (n,) or (..., n) increasing, m
    p : (..., n) complex
    level : float
        0.5 for the width of |p|, sqrt(0.5) for that of |p|^2.
    evaluate : function, optional
        p between the samples; cubic splines of p by default.
    inside : (..., n) bool, optional
        The samples among which peak and edges are looked for.
    subsamples : int
        By how many positions the interval between two samples is looked at first; 0 where the samples resolve p.

    Returns
    -------
    Width
    """
    evaluate = evaluate or spline(x, p)
    x = np.broadcast_to(x, p.shape)
    inside = np.ones(p.shape, bool) if inside is None else inside
    size = np.where(inside, np.abs(p), 0.0)
    position, peak = _peak(x, size, evaluate, subsamples)
    target = level * peak
    edges = _edges(x, size, inside, (position, peak), target, evaluate, subsamples)
    crossings = np.count_nonzero(np.diff(size > target[..., None], axis=-1), axis=-1)
    return Width(edges[..., 0], edges[..., 1], position, peak, np.asarray(crossings))


def of_samples(x: np.ndarray, p: np.ndarray, level: float = 0.5) -> Width:
    """`full_width` of profiles (R, n) that are known by samples alone, in blocks."""
    rows = max(1, MOST_SAMPLES // x.size)
    parts = [full_width(x, p[start : start + rows], level) for start in range(0, max(1, len(p)), rows)]
    return Width(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def spline(x: np.ndarray, p: np.ndarray) -> Evaluate:
    """Cubic splines of complex profiles (..., n) over x (n,), each at positions of its own."""
    from scipy.interpolate import CubicSpline

    coefficients = CubicSpline(x, p, axis=-1).c  # (4, n - 1, ...)

    def evaluate(at: np.ndarray) -> np.ndarray:
        piece = np.clip(np.searchsorted(x, at, side="right") - 1, 0, x.size - 2)
        profiles = np.ix_(*map(np.arange, (*at.shape[:-1], 1)))[:-1]
        c, off = coefficients[(slice(None), piece, *profiles)], at - x[piece]
        return np.asarray(((c[0] * off + c[1]) * off + c[2]) * off + c[3])

    return evaluate


def _pick(values: np.ndarray, index: np.ndarray) -> np.ndarray:
    """values[..., index] of each profile; index (...)."""
    return np.take_along_axis(values, index[..., None], -1)[..., 0]


def _between(start: np.ndarray, stop: np.ndarray, count: int) -> np.ndarray:
    """Even positions from start to stop, (..., count)."""
    share = np.linspace(0.0, 1.0, count)
    return start[..., None] * (1 - share) + stop[..., None] * share


# --- the peak ---------------------------------------------------------------------------------------------


def _peak(x: np.ndarray, size: np.ndarray, evaluate: Evaluate, subsamples: int) -> tuple[np.ndarray, np.ndarray]:
    """Place and size of the largest |p|, between the samples beside the largest one."""
    last = size.shape[-1] - 1
    top = np.argmax(size, axis=-1)
    at_the_end = (top == 0) | (top == last)
    nearest = np.clip(top[..., None] + np.array([-1, 0, 1]), 0, last)
    at, values = np.take_along_axis(x, nearest, -1), np.take_along_axis(size, nearest, -1)
    low, high, peak, position = at[..., 0], at[..., 2], values[..., 1], at[..., 1]
    step = (high - low) / 2
    if subsamples:
        fine = _between(low, high, subsamples)
        looked = np.abs(evaluate(fine))
        best = np.clip(np.argmax(looked, axis=-1), 1, subsamples - 2)[..., None] + np.array([-1, 0, 1])
        at, values = np.take_along_axis(fine, best, -1), np.take_along_axis(looked, best, -1)
        step = (high - low) / (subsamples - 1)
        position, peak = _better(position, peak, at, values)
    guess = np.clip(_vertex(at[..., 1], step, values, position), low, high)
    for _ in range(PARABOLAS):
        step = step / NARROWER
        at = guess[..., None] + step[..., None] * np.array([-1, 0, 1])
        values = np.abs(evaluate(at))
        position, peak = _better(position, peak, at, values)
        guess = np.clip(_vertex(guess, step, values, position), low, high)
    position, peak = _better(position, peak, guess[..., None], np.abs(evaluate(guess[..., None])))
    return np.where(at_the_end, _pick(x, top), position), np.where(at_the_end, _pick(size, top), peak)


def _better(
    position: np.ndarray, peak: np.ndarray, at: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The place and size of the largest |p| known, once those at further positions are known."""
    largest = np.argmax(values, axis=-1)
    larger = _pick(values, largest) > peak
    return np.where(larger, _pick(at, largest), position), np.where(larger, _pick(values, largest), peak)


def _vertex(middle: np.ndarray, step: np.ndarray, values: np.ndarray, best: np.ndarray) -> np.ndarray:
    """The vertex of parabolas through three values a step apart, or the best place known where they have none nearby."""
    below, at, above = np.moveaxis(values, -1, 0)
    bend = 2 * at - below - above
    concave = (bend > 0) & (np.abs(above - below) < NARROWER * bend)  # no farther off than half the parabola before
    return np.where(concave, middle + step * (above - below) / np.where(concave, 2 * bend, 1.0), best)


# --- the edges --------------------------------------------------------------------------------------------


def _edges(
    x: np.ndarray,
    size: np.ndarray,
    inside: np.ndarray,
    top: tuple[np.ndarray, np.ndarray],
    target: np.ndarray,
    evaluate: Evaluate,
    subsamples: int,
) -> np.ndarray:
    """Where |p| first falls to the target on both sides of the peak, (..., 2); nan where it does not. `top` is its place and size."""
    position, peak = (v[..., None] for v in top)
    target = target[..., None]
    index = np.arange(x.shape[-1])
    below = inside & (size < target)
    left = np.max(np.where(below & (x < position), index, -1), axis=-1)
    right = np.min(np.where(below & (x > position), index, index.size), axis=-1)
    met = np.stack([left >= 0, right < index.size], axis=-1)
    ends = np.where(met, np.stack([left, right], axis=-1), np.array([0, index.size - 1]))
    beside = np.clip(ends + np.array([1, -1]), 0, index.size - 1)
    inner, outer = np.take_along_axis(x, beside, -1), np.take_along_axis(x, ends, -1)
    beyond = (inner - position) * np.array([1, -1]) > 0  # the peak lies between the two samples
    inner = np.where(beyond, position, inner)
    above = np.maximum(np.where(beyond, peak, np.take_along_axis(size, beside, -1)) - target, 0.0)
    under = np.minimum(np.take_along_axis(size, ends, -1) - target, -np.finfo(float).tiny)
    tolerance = EDGE_TOLERANCE * np.abs(outer - inner)
    if subsamples:
        fine = _between(inner, outer, subsamples)
        looked = np.abs(evaluate(fine.reshape(*fine.shape[:-2], -1))).reshape(fine.shape)
        excess = np.nan_to_num(looked - target[..., None], nan=0.0)
        # both ends are known: the search must not miss the crossing by rounding
        excess[..., 0], excess[..., -1] = above, under
        first = np.maximum(np.argmax(excess < 0, axis=-1), 1)
        inner, outer = _pick(fine, first - 1), _pick(fine, first)
        above, under = _pick(excess, first - 1), _pick(excess, first)
    edges = _zero(lambda at: np.abs(evaluate(at)) - target, (inner, above), (outer, under), tolerance)
    return np.where(met, edges, np.nan)


def _zero(
    excess: Callable[[np.ndarray], np.ndarray],
    inner: tuple[np.ndarray, np.ndarray],
    outer: tuple[np.ndarray, np.ndarray],
    tolerance: np.ndarray,
) -> np.ndarray:
    """Zeros of a function between places where it is >= 0 and places where it is < 0, each given with its value.

    Inverse quadratic interpolation where it is safe, bisection elsewhere: T. R. Chandrupatla, Adv. Eng. Softw. 28, 145 (1997).
    """
    (a, of_a), (b, of_b) = inner, outer
    with np.errstate(divide="ignore", invalid="ignore", over="ignore", under="ignore"):
        share = np.clip(np.nan_to_num(of_a / (of_a - of_b), nan=0.5), 0.01, 0.99)
        for _ in range(MOST_STEPS):
            at = a + share * (b - a)
            value = excess(at)
            same = (value >= 0) == (of_a >= 0)
            c, of_c = np.where(same, a, b), np.where(same, of_a, of_b)
            b, of_b = np.where(same, b, a), np.where(same, of_b, of_a)
            a, of_a = at, value
            wide = np.abs(b - a)
            done = (wide <= 2 * tolerance) | (of_a == 0) | ~np.isfinite(of_a)
            if np.all(done):
                break
            xi, phi = (a - b) / (c - b), (of_a - of_b) / (of_c - of_b)
            smooth = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
            inverse = of_a / (of_b - of_a) * of_c / (of_b - of_c)
            inverse = inverse + (c - a) / (b - a) * of_a / (of_c - of_a) * of_b / (of_c - of_b)
            least = np.minimum(np.nan_to_num(tolerance / wide, nan=0.5, posinf=0.5), 0.5)
            share = np.clip(np.where(smooth & np.isfinite(inverse), inverse, 0.5), least, 1 - least)
            share = np.where(done, 0.0, share)  # stays, so that no profile's width depends on the others
    return np.where(np.abs(of_a) <= np.abs(of_b), a, b)


def centroid(x: np.ndarray, p: np.ndarray) -> float:
    """Centroid of |p|^2 over the sampled window (trapezoid rule) [m]."""
    power = np.abs(p) ** 2
    total = np.trapezoid(power, x)
    return float(np.trapezoid(power * x, x) / total) if total > 0 else np.nan
