"""Zeros of analytic functions in the plane of complex kx: counted by the argument principle, found by halving boxes.

A function is given as (value, logarithm), ``value exp(logarithm)``, so that it may grow without overflow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: D(kx) as (value, logarithm) for an array of kx.
Dispersion = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
#: The same for several slabs or frequencies: kx (P, m), and which of them each row belongs to (P,).
ManyDispersions = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class TooManyModes(ArithmeticError):
    """A search that would take too long."""


class TooManyValues(TooManyModes):
    """A search that takes more values than it may."""


class UncertainCount(ArithmeticError):
    """Two counts of the same zeros that differ."""


def winding(f: Dispersion, path: np.ndarray, finest: float, most: float = math.inf, thorough: bool = False) -> int:
    """Turns of D about 0 along a closed path."""

    def one(k: np.ndarray, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = f(k.ravel())
        return value.reshape(k.shape), log.reshape(k.shape)

    return int(windings(one, path[None], finest, most, thorough)[0])


def windings(
    f: ManyDispersions, paths: np.ndarray, finest: float, most: float = math.inf, thorough: bool = False
) -> np.ndarray:
    """Turns of several D about 0, each along its own closed path: paths (P, n), turns (P,).

    A step is halved until both halves change log D by little and alike, and as D'/D at either end says: whole turns between two
    points do not show in D itself, and a slab of many waves' thickness makes many. Steps shorter than `finest` are left alone (a
    zero lies on the path). D'/D is taken everywhere if `thorough`, or if it is large at one of every SPARSE points: that sees
    slabs that turn fast all along, and zeros that crowd. TooManyValues where that takes more than `most` steps.
    """
    count, n = paths.shape
    onward = np.arange(1, n + 1) % n
    ahead = paths[:, onward]
    beside = FINE * (ahead - paths)
    some = slice(None, None, 1 if thorough else SPARSE)
    most -= paths.size
    if most < 0:
        raise TooManyValues
    # the path's points, the middles of its steps and points just behind some of the first in one call
    ask = np.concatenate([paths, (paths + ahead) / 2, (paths + beside)[:, some]], axis=1)
    values = logarithm(*f(ask, np.arange(count)))
    logs = values[:, :n]
    rates = _rate(logs[:, some], values[:, 2 * n :], beside[:, some])
    if not thorough and (thorough := bool(np.any(np.abs(rates * (ahead - paths)[:, some]) > FAST))):
        rates = _rate(logs, logarithm(*f(paths + beside, np.arange(count))), beside)
    steps = _Steps(
        np.broadcast_to(np.arange(count)[:, None], paths.shape),
        (paths, ask[:, n : 2 * n], ahead),
        (logs, values[:, n : 2 * n], logs[:, onward]),
        (rates, rates[:, onward]) if thorough else (),
    )
    total = np.zeros(count)
    while True:
        calm, change = _calm(steps, finest)
        total += np.bincount(steps.owner[calm], change.imag[calm], count)
        if np.all(calm):
            return np.rint(total / (2 * np.pi)).astype(int)
        most -= 2 * np.count_nonzero(~calm)
        if most < 0:
            raise TooManyValues
        steps = _halved(f, steps, ~calm, count == 1)


#: Of so many points of a path one is looked at for how fast D turns, and this change of log D over a step is fast: less is no whole turn.
SPARSE, FAST = 4, 4.0
#: D'/D is taken over these shares of a step. The fine one shows no whole turns where D turns by less than 1600 in a step (a path's
#: first steps), the coarse one magnifies rounding less, which small circles close around a cluster of zeros feel.
FINE, COARSE = 1 / 512, 1 / 32
#: Change of log D over a step, by D'/D, from which on its halves take the fine share.
WILD = 20


class _Steps(NamedTuple):
    """Steps of paths: whose they are, start, middle and end, log D there, and D'/D at start and end (or nothing)."""

    owner: np.ndarray
    points: tuple[np.ndarray, ...]
    logs: tuple[np.ndarray, ...]
    rates: tuple[np.ndarray, ...]


def _rate(at: np.ndarray, beyond: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """D'/D from log D at two points; 0 where they are the same."""
    return np.divide(_change(at, beyond), distance, out=np.zeros(at.shape, complex), where=distance != 0)


def _calm(steps: _Steps, finest: float) -> tuple[np.ndarray, np.ndarray]:
    """Which steps may stay as they are, and the change of log D over each."""
    first, second = _change(steps.logs[0], steps.logs[1]), _change(steps.logs[1], steps.logs[2])
    change, length = first + second, steps.points[2] - steps.points[0]
    calm = (np.abs(change) < 1.5) & (np.abs(first - second) < 0.4)
    for rate in steps.rates:
        calm &= np.abs(rate * length - change) < 1.5
    return calm | (np.abs(length) < finest), change


def _halved(f: ManyDispersions, steps: _Steps, some: np.ndarray, alone: bool) -> _Steps:
    """Both halves of some steps."""
    (a, m, b), (at_a, at_m, at_b) = ([v[some] for v in group] for group in steps[1:3])
    start, stop = np.concatenate([a, m]), np.concatenate([m, b])
    owner, middle = np.tile(steps.owner[some], 2), (start + stop) / 2
    beside, more = COARSE * (b - m), 0
    if steps.rates:  # points just behind the middles, which start the second halves
        rate_a, rate_b = (rate[some] for rate in steps.rates)
        wild = np.maximum(np.abs(rate_a), np.abs(rate_b)) * np.abs(b - a) > WILD
        beside, more = np.where(wild, FINE / COARSE, 1.0) * beside, m.size
    ask, whose = np.concatenate([middle, (m + beside)[:more]]), np.concatenate([owner, owner[:more]])
    rows = (ask[None], whose[:1]) if alone else (ask[:, None], whose)
    values = logarithm(*f(*rows)).ravel()
    rates: tuple[np.ndarray, ...] = ()
    if more:
        rate_m = _rate(at_m, values[middle.size :], beside)
        rates = (np.concatenate([rate_a, rate_m]), np.concatenate([rate_m, rate_b]))
    logs = (np.concatenate([at_a, at_m]), values[: middle.size], np.concatenate([at_m, at_b]))
    return _Steps(owner, (start, middle, stop), logs, rates)


def logarithm(value: np.ndarray, log: np.ndarray) -> np.ndarray:
    """log D of D = value exp(log), its imaginary part up to whole turns.

    `response.reference.logarithm` in real functions, which are three times as fast.
    """
    out = np.empty(value.shape, complex)
    out.real = np.log(np.maximum(np.abs(value), 1e-300)) + np.real(log)
    out.imag = np.angle(value) + np.imag(log)
    return out


def _change(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Change of log D from one point to another, its imaginary part within half a turn."""
    change = two - one
    change.imag -= 2 * np.pi * np.rint(change.imag / (2 * np.pi))
    return change


class Box(NamedTuple):
    """A rectangle in the plane of kx."""

    left: float
    right: float
    low: float
    high: float

    def outline(self, nodes: int = 24, near: float | None = None) -> np.ndarray:
        """Its outline, counter-clockwise: see `outlines`."""
        left, right, low, high = (np.array([v]) for v in self)
        return outlines(left, right, low, high, nodes, None if near is None else np.array([near]))[0]

    def halves(self) -> tuple[Box, Box]:
        """Two parts, not quite equal so that no symmetry puts a zero on the cut."""
        if self.right - self.left > self.high - self.low:
            cut = self.left + 0.4871 * (self.right - self.left)
            return self._replace(right=cut), self._replace(left=cut)
        cut = self.low + 0.4871 * (self.high - self.low)
        return self._replace(high=cut), self._replace(low=cut)

    def holds(self, k: complex, slack: float) -> bool:
        """Whether k lies inside, or within `slack` of it."""
        return (self.left - slack <= k.real <= self.right + slack) and (self.low - slack <= k.imag <= self.high + slack)


#: Where a side of a box passes a branch point, nodes are added at these distances from it, over its own.
BESIDE_BRANCH = np.array([-0.2, -0.06, -0.02, 0.0, 0.02, 0.06, 0.2])


def outlines(
    left: np.ndarray,
    right: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    nodes: int,
    near: np.ndarray | None = None,
    lifted: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """Outlines of boxes (P,), counter-clockwise, (P, n): `nodes` on the longer sides, a quarter on sides half as long or less.

    With `near` (P,) there are more nodes on the horizontal sides beside that Re kx: a branch point. `lifted` raises the upper
    side, to the right of Re kx = lifted[0], by lifted[1].
    """
    width, height = right - left, high - low
    across, up = (
        nodes if (2 * side > other).any() else max(2, nodes // 4) for side, other in ((width, height), (height, width))
    )
    left, right, low, high = (v[:, None] for v in (left, right, low, high))
    x = left + width[:, None] * (np.arange(across) / across)
    if near is not None:
        more = np.minimum(np.maximum(near[:, None] * (1 + BESIDE_BRANCH), left), right)
        x = np.sort(np.concatenate([x, more], axis=1), axis=1)
    y = height[:, None] * (np.arange(up) / up)
    n = x.shape[1]
    out = np.empty((x.shape[0], 2 * (n + up)), complex)
    out.real[:, :n], out.imag[:, :n] = x, low
    out.real[:, n : n + up], out.imag[:, n : n + up] = right, low + y
    out.real[:, n + up], out.real[:, n + up + 1 : -up], out.imag[:, n + up : -up] = right[:, 0], x[:, :0:-1], high
    if lifted is not None:
        top = out[:, n + up : -up]
        top.imag += np.where(top.real > lifted[0][:, None], lifted[1][:, None], 0.0)
    out.real[:, -up:], out.imag[:, -up:] = left, high - y
    return out


#: Zeros of D that lie nearer to each other than this, relative to them, are one cluster: modes of two faces that do not feel
#: each other, which rounding does not tell apart.
CLUSTER = 1e-6


def zeros(f: Dispersion, box: Box, scale: float, total: int, most: float = math.inf) -> list[complex]:
    """The `total` zeros of D inside a box, by halving it until Newton's method has one to find; of a cluster, its middle.

    TooManyValues where that takes more than `most` values of D along one outline, or more than `most` / 200 outlines.
    """
    found: list[complex] = []
    outlines = 0
    todo = [(box, total)] if total > 0 else []
    while todo:
        part, count = todo.pop()
        size = max(part.right - part.left, part.high - part.low)
        middle = complex((part.left + part.right) / 2, (part.low + part.high) / 2)
        small = size < min(1e-6 * scale, CLUSTER * abs(middle))
        if count == 1 or small:
            k, step = refine(f, middle, size / 8)
            if step < 1e-9 * scale and part.holds(k, 1e-9 * scale) and _is_new(k, found, 1e-9 * scale):
                found += count * [k]
                continue
            if small:  # a double zero is known to half the digits only; boxes may have cut it in two
                k = k if part.holds(k, size) else middle
                found += count * [next((other for other in found if abs(k - other) < CLUSTER * abs(k)), k)]
                continue
        for half in part.halves():
            inside = winding(f, half.outline(), 1e-9 * scale, most, thorough=math.isinf(most))
            outlines += 1
            if outlines > most / 200:
                raise TooManyValues
            if inside > 0:
                todo.append((half, inside))
    return found


def _is_new(k: complex, found: list[complex], apart: float) -> bool:
    return all(abs(k - other) > apart for other in found)


def refine(f: Dispersion, k: complex, reach: float, steps: int = 40) -> tuple[complex, float]:
    """Newton's method with a numerical derivative, steps of at most `reach`: the zero, and the size of the last step."""
    step = complex(reach)
    for _ in range(steps):
        h = max(1e-6 * abs(step), 1e-9 * abs(k), 1e-300)
        value, log = f(np.array([k, k + h, k - h]))
        value = value * np.exp(log - log[0])
        slope = (value[1] - value[2]) / (2 * h)
        if slope == 0 or not np.isfinite(slope):
            return k, math.inf
        step = -value[0] / slope
        step *= min(1.0, reach / abs(step)) if step else 1.0
        k += step
        if abs(step) < 1e-13 * abs(k):
            break
    return complex(k), abs(step)


def real_zeros(f: Dispersion, left: float, right: float, samples: int = 600, many: float = math.inf) -> list[complex]:
    """Zeros of a lossless slab on the axis beyond the branch points, where D is real but for a constant phase.

    TooManyModes where there are more than `many`.
    """
    k = left + (right - left) * (np.arange(samples) + 0.5) / samples
    value, log = f(k.astype(complex))
    angle = np.angle(value) + np.imag(log)
    sign = np.cos(angle - angle[0]) > 0
    at = np.flatnonzero(sign[1:] != sign[:-1])
    if at.size > many:
        raise TooManyModes
    found = ((i, *refine(f, complex(k[i] + k[i + 1]) / 2, (k[i + 1] - k[i]) / 2)) for i in at)
    # one that has left its interval is its neighbour's
    return [
        complex(zero.real)
        for i, zero, step in found
        if step < 1e-9 * right and abs(zero.imag) < 1e-9 * right and k[i] <= zero.real <= k[i + 1]
    ]
