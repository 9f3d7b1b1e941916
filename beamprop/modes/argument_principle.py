"""Zeros of analytic functions in the plane of complex kx: counted by the argument principle, located by halving boxes.

A function is given as (value, logarithm), ``value exp(logarithm)``, so that it may grow without overflow.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

#: D(kx) as (value, logarithm) for an array of kx.
Dispersion = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
#: The same for several slabs or frequencies: kx (P, m), and the index of the slab that each row belongs to (P,).
ManyDispersions = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


class TooManyModes(ArithmeticError):
    """More modes in a box than a search may locate."""


class TooManyValues(TooManyModes):
    """A search needs more values of D than its limit."""


class UncertainCount(ArithmeticError):
    """Two counts of the same zeros differ."""


def winding(f: Dispersion, path: np.ndarray, finest: float, most: float = math.inf, thorough: bool = False) -> int:
    """Turns of D about 0 along a closed path."""

    def for_rows(k: np.ndarray, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = f(k.ravel())
        return value.reshape(k.shape), log.reshape(k.shape)

    return int(windings(for_rows, path[None], finest, most, thorough)[0])


def windings(
    f: ManyDispersions, paths: np.ndarray, finest: float, most: float = math.inf, thorough: bool = False
) -> np.ndarray:
    """Turns of several D about 0, each along its own closed path: paths (P, n), turns (P,).

    A step is halved until both halves change log D by small and nearly equal amounts that agree with D'/D at either end: D itself
    does not show whole turns between two points, and D of a slab many wavelengths thick makes many. Steps shorter than `finest` are
    not halved (a zero lies on the path). D'/D is evaluated at every point if `thorough`, or if it is large at any SPARSE-th point,
    which detects a D that turns fast along the whole path, and clusters of zeros. TooManyValues if more than `most` values are
    needed.
    """
    count, n = paths.shape
    onward = np.arange(1, n + 1) % n
    ahead = paths[:, onward]
    beside = FINE * (ahead - paths)
    checked = slice(None, None, 1 if thorough else SPARSE)
    most -= paths.size
    if most < 0:
        raise TooManyValues
    # in one call: the path's points, the middles of its steps, and a point just beyond each one where D'/D is checked
    points = np.concatenate([paths, (paths + ahead) / 2, (paths + beside)[:, checked]], axis=1)
    values = logarithm(*f(points, np.arange(count)))
    logs = values[:, :n]
    rates = _rate(logs[:, checked], values[:, 2 * n :], beside[:, checked])
    if not thorough and (thorough := bool(np.any(np.abs(rates * (ahead - paths)[:, checked]) > FAST))):
        rates = _rate(logs, logarithm(*f(paths + beside, np.arange(count))), beside)
    steps = _Steps(
        np.broadcast_to(np.arange(count)[:, None], paths.shape),
        (paths, points[:, n : 2 * n], ahead),
        (logs, values[:, n : 2 * n], logs[:, onward]),
        (rates, rates[:, onward]) if thorough else (),
    )
    total = np.zeros(count)
    while True:
        resolved, change = _resolved(steps, finest)
        total += np.bincount(steps.owner[resolved], change.imag[resolved], count)
        if np.all(resolved):
            return np.rint(total / (2 * np.pi)).astype(int)
        most -= 2 * np.count_nonzero(~resolved)
        if most < 0:
            raise TooManyValues
        steps = _halved(f, steps, ~resolved, count == 1)


#: D'/D is checked at every SPARSE-th point of a path, for a D that turns fast does so over neighbouring steps too. A change of log D by
#: 2 pi over a step may be taken for none; FAST leaves a third of that to D'/D at the step's end not being its mean.
SPARSE, FAST = 4, 4.0
#: Difference quotients for D'/D take these shares of a step. FINE is right up to a change of log D by pi/FINE = 1600 over a first step of a
#: path, COARSE up to 100 over a halved one: it magnifies rounding 16 times less, near clusters of zeros.
FINE, COARSE = 1 / 512, 1 / 32
#: Change of log D over a step, by D'/D, from which on its halves take the fine share: a tenth of what COARSE is right for.
WILD = 20
#: A step is resolved if log D changes by less than TURNED over it, a quarter of a turn, that of its halves differs by less than BENT, and
#: D'/D at its ends predicts it within TURNED. A zero at the distance d from a step of length l changes log D by 2 atan(l/2d): these resolve
#: d > l/2; a plain choice, as smaller ones halve more steps and larger ones may miss a turn. Counts of two outlines are compared in
#: `guided.find_modes`.
TURNED, BENT = 1.5, 0.4


class _Steps(NamedTuple):
    """Steps of paths: the path's index; start, middle and end; log D there; and D'/D at start and end, or nothing."""

    owner: np.ndarray
    points: tuple[np.ndarray, ...]
    logs: tuple[np.ndarray, ...]
    rates: tuple[np.ndarray, ...]


def _rate(at: np.ndarray, beyond: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """D'/D from log D at two points; 0 where they are the same."""
    return np.divide(_change(at, beyond), distance, out=np.zeros(at.shape, complex), where=distance != 0)


def _resolved(steps: _Steps, finest: float) -> tuple[np.ndarray, np.ndarray]:
    """Which steps need not be halved, and the change of log D over each."""
    first, second = _change(steps.logs[0], steps.logs[1]), _change(steps.logs[1], steps.logs[2])
    change, length = first + second, steps.points[2] - steps.points[0]
    resolved = (np.abs(change) < TURNED) & (np.abs(first - second) < BENT)
    for rate in steps.rates:
        resolved &= np.abs(rate * length - change) < TURNED
    return resolved | (np.abs(length) < finest), change


def _halved(f: ManyDispersions, steps: _Steps, coarse: np.ndarray, single: bool) -> _Steps:
    """Both halves of the steps where `coarse`; `single` if all belong to one path."""
    (a, m, b), (at_a, at_m, at_b) = ([v[coarse] for v in group] for group in steps[1:3])
    start, stop = np.concatenate([a, m]), np.concatenate([m, b])
    owner, middle = np.tile(steps.owner[coarse], 2), (start + stop) / 2
    beside, extra = COARSE * (b - m), 0
    if steps.rates:  # D'/D at the middles, where the second halves start, takes a point just beyond each
        rate_a, rate_b = (rate[coarse] for rate in steps.rates)
        wild = np.maximum(np.abs(rate_a), np.abs(rate_b)) * np.abs(b - a) > WILD
        beside, extra = np.where(wild, FINE / COARSE, 1.0) * beside, m.size
    points = np.concatenate([middle, (m + beside)[:extra]])
    owners = np.concatenate([owner, owner[:extra]])
    rows = (points[None], owners[:1]) if single else (points[:, None], owners)
    values = logarithm(*f(*rows)).ravel()
    rates: tuple[np.ndarray, ...] = ()
    if extra:
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


def _change(start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Change of log D between two points, its imaginary part within half a turn."""
    change = stop - start
    change.imag -= 2 * np.pi * np.rint(change.imag / (2 * np.pi))
    return change


#: Where a box is halved: not in the middle, on which symmetry may put a zero, nor at a simple fraction.
CUT = 0.4871


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
        """Two parts of slightly unequal size, CUT and the rest."""
        if self.right - self.left > self.high - self.low:
            cut = self.left + CUT * (self.right - self.left)
            return self._replace(right=cut), self._replace(left=cut)
        cut = self.low + CUT * (self.high - self.low)
        return self._replace(high=cut), self._replace(low=cut)

    def holds(self, k: complex, slack: float) -> bool:
        """Whether k lies inside, or within `slack` of it."""
        return (self.left - slack <= k.real <= self.right + slack) and (self.low - slack <= k.imag <= self.high + slack)


#: Beside a branch point a side of a box has additional nodes, at these distances over that of the branch point from 0: kz goes as the root
#: of the distance, and factors of 3 follow it.
BESIDE_BRANCH = np.array([-0.2, -0.06, -0.02, 0.0, 0.02, 0.06, 0.2])


def outlines(
    left: np.ndarray,
    right: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
    nodes: int,
    near: np.ndarray | None = None,
    lifted: Sequence[np.ndarray] | None = None,
) -> np.ndarray:
    """Outlines of boxes (P,), counter-clockwise, (P, n): `nodes` on the longer sides, a quarter on sides half as long or less.

    `windings` adds nodes where D turns fast. With `near` (P,), Re kx of a branch point, there are additional
    nodes on the horizontal sides beside it. `lifted` raises the upper side, to the right of Re kx = lifted[0], by lifted[1].
    """
    width, height = right - left, high - low
    across, up = (
        nodes if (2 * side > crosswise).any() else max(2, nodes // 4)
        for side, crosswise in ((width, height), (height, width))
    )
    left, right, low, high = (v[:, None] for v in (left, right, low, high))
    x = left + width[:, None] * (np.arange(across) / across)
    if near is not None:
        beside = np.minimum(np.maximum(near[:, None] * (1 + BESIDE_BRANCH), left), right)
        x = np.sort(np.concatenate([x, beside], axis=1), axis=1)
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


#: Zeros of D at relative distances below this are one cluster, for instance modes of two faces that are not coupled: a double zero rounds
#: to the square root of D's relative rounding: 1e-8, and 1e-6 where that is 1e-12.
CLUSTER = 1e-6


def zeros(f: Dispersion, box: Box, scale: float, total: int, most: float = math.inf) -> list[complex]:
    """The `total` zeros of D inside a box, halved until each part holds a single one for Newton's method; of a cluster, its middle.

    TooManyValues if an outline needs more than `most` values of D, or the boxes more than `most` / 200 outlines: an outline takes some
    200 values.
    """
    located: list[complex] = []
    outlined = 0
    todo = [(box, total)] if total > 0 else []
    while todo:
        part, count = todo.pop()
        if (zero := _located(f, part, count, scale, located)) is not None:
            located += count * [zero]
            continue
        for half in part.halves():
            inside = winding(f, half.outline(), 1e-9 * scale, most, thorough=math.isinf(most))
            outlined += 1
            if outlined > most / 200:
                raise TooManyValues
            if inside > 0:
                todo.append((half, inside))
    return located


def _located(f: Dispersion, box: Box, count: int, scale: float, known: list[complex]) -> complex | None:
    """The zero of a box with a single one, or the middle of the cluster in a small box; None if the box has to be halved."""
    size = max(box.right - box.left, box.high - box.low)
    middle = complex((box.left + box.right) / 2, (box.low + box.high) / 2)
    small = size < min(1e-6 * scale, CLUSTER * abs(middle))
    if count != 1 and not small:
        return None
    k, step = refine(f, middle, size / 8)
    if step < 1e-9 * scale and box.holds(k, 1e-9 * scale) and all(abs(k - zero) > 1e-9 * scale for zero in known):
        return k
    if not small:
        return None
    # a double zero is located to half the digits only, and sides of boxes may have parted it: all of a cluster get the same value
    k = k if box.holds(k, size) else middle
    return next((zero for zero in known if abs(k - zero) < CLUSTER * abs(k)), k)


def refine(f: Dispersion, k: complex, longest: float, steps: int = 40) -> tuple[complex, float]:
    """Newton's method with a numerical derivative, steps of at most `longest`: the zero, and the size of the last step."""
    step = complex(longest)
    for _ in range(steps):
        h = max(1e-6 * abs(step), 1e-9 * abs(k), 1e-300)  # D at k + h keeps 7 digits of a difference; its error is h^2
        value, log = f(np.array([k, k + h, k - h]))
        value = value * np.exp(log - log[0])
        slope = (value[1] - value[2]) / (2 * h)
        if slope == 0 or not np.isfinite(slope):
            return k, math.inf
        step = -value[0] / slope
        step *= min(1.0, longest / abs(step)) if step else 1.0
        k += step
        if abs(step) < 1e-13 * abs(k):
            break
    return complex(k), abs(step)


def real_zeros(f: Dispersion, left: float, right: float, samples: int = 600, many: float = math.inf) -> list[complex]:
    """Zeros of a lossless slab's D on the axis beyond the branch points, by its changes of sign: it is real up to a constant phase.

    TooManyModes if there are more than `many`.
    """
    k = left + (right - left) * (np.arange(samples) + 0.5) / samples
    value, log = f(k.astype(complex))
    angle = np.angle(value) + np.imag(log)
    sign = np.cos(angle - angle[0]) > 0
    changes = np.flatnonzero(sign[1:] != sign[:-1])
    if changes.size > many:
        raise TooManyModes
    refined = ((i, *refine(f, complex(k[i] + k[i + 1]) / 2, (k[i + 1] - k[i]) / 2)) for i in changes)
    # a zero outside the interval where it was started belongs to a neighbouring interval
    return [
        complex(zero.real)
        for i, zero, step in refined
        if step < 1e-9 * right and abs(zero.imag) < 1e-9 * right and k[i] <= zero.real <= k[i + 1]
    ]
