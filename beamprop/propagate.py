"""Spectrum x response -> p(z, x): the choice of a line for an rtol, and the sums over it.

Everything here is for one frequency; a `Scene` holds what does not change from line to line.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from . import judge, modes, spectral
from .beam import Beam
from .fan import Fan, single
from .judge import Checks
from .planes import cross, mixing
from .scene import Scene
from .spectral import BentPlan, Line, Reach
from .transfers import Transfer, free, through

__all__ = [
    "Solution",
    "Transfer",
    "beam_sum",
    "choose_line",
    "even_spacing",
    "fill_map",
    "free",
    "periodic_solution",
    "point_sum",
    "through",
]

#: The most modes that a line may have, and how often a plan is widened before the asked rtol is given up.
MOST_MODES = 200_000
ATTEMPTS = 14


def even_spacing(x: np.ndarray) -> float:
    """Spacing of an even grid, 0 for any other."""
    if x.size < 8:
        return 0.0
    dx = (x[-1] - x[0]) / (x.size - 1)
    even = dx > 0 and np.max(np.abs(x - (x[0] + dx * np.arange(x.size)))) <= 1e-12 * max(abs(x[0]), abs(x[-1]))
    return float(dx) if even else 0.0


def _reach(s: Scene, fan: Fan, x: np.ndarray, z: np.ndarray, rtol: float) -> Reach:
    tolerance = rtol * 1e-3
    beam = fan.beam
    source = beam.reach(tolerance)
    extent = float(np.max(np.abs(x - beam.centre), initial=0.0))
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    band = min(fan.band(s.k0, tolerance), _arriving(s, beam.z0, z, tolerance))
    return Reach(s.k0, min(s.branches), band, max(extent, source), source, path)


def _arriving(s: Scene, z0: float, z: np.ndarray, tolerance: float) -> float:
    """|kx| beyond which waves have decayed to `tolerance` on their way, in the half-spaces, to the nearest plane.

    What a slab does to them is not known here: it shows in the band's edge.
    """
    nearest = float(z.min())
    way = min(nearest, 0.0) - z0 + max(0.0, nearest - s.thickness)
    return math.hypot(max(s.branches), math.log(1 / tolerance) / way) if way > 0 else math.inf


class Solution(NamedTuple):
    """A line that serves, and the estimated relative error by asked angle."""

    line: Line
    error: np.ndarray
    fft: int = 0  #: FFT length if the line fits the asked even grid, else 0
    circles: bool = False  #: whether it has circles around backward modes


def choose_line(
    s: Scene,
    fan: Fan,
    transfer: Transfer,
    x: np.ndarray,
    z: np.ndarray,
    rtol: float,
    guided: bool = True,
) -> Solution:
    """The cheapest line on which the field keeps rtol, judged by a second line of other parameters.

    An even grid of many points gets a pair of straight lines for FFTs, judged by a bent path; any other a bent path, judged
    by a second one. `guided` says whether the transfer knows guided modes (none without a slab).
    """
    reach = _reach(s, fan, x, z, rtol)
    points, planes = judge.check_points(x, z, fan.beam.centre, reach.source, s.thickness)
    noise, bright = judge.survey(s, fan, transfer, points, planes, reach)
    checks = Checks(fan, transfer, points, planes, guided, bright)
    if not fan.beam.entire:
        return _propagating_solution(s, checks, reach, rtol)
    search = _Search(s, checks, reach, rtol, noise)
    straight = None if search.too_wide() else _straight_solution(search, x)
    if straight:
        return straight
    bent = _bent_solution(search)
    return _straight_solution(search, x) or bent


class _Search:
    """The search for a line: what is known of the modes on its wrong side, and the plan that has come so far."""

    def __init__(self, s: Scene, checks: Checks, reach: Reach, rtol: float, noise: float) -> None:
        self.scene, self.checks, self.reach, self.rtol, self.noise = s, checks, reach, rtol, noise
        self.plan: BentPlan = spectral.plan_bent(reach, rtol, self.noise)
        if self.too_wide():  # the spectrum of a sharp edge, but a slab lets little of it through
            self.reach = reach._replace(band=judge.arriving_band(s, checks, reach, rtol * 1e-3))
            self.plan = spectral.plan_bent(self.reach, rtol, self.noise)
        self.found, self.searched = modes.NONE, 0.0 if checks.guided else math.inf
        self.judged_by: BentPlan | None = None  # the last plan by which a straight line was judged

    def too_wide(self) -> bool:
        """Whether the present plan takes too many plane waves."""
        second = self.plan.other()
        return second.band * second.window > 2 * np.pi * MOST_MODES

    def look(self) -> modes.Between:
        """Modes above the path of the present plan, searched for as far as its band goes."""
        if self.plan.band > self.searched:
            self.searched = 1.15 * self.plan.band
            self.found = modes.between(self.scene, 1.05 * self.plan.depth, self.searched)
        return self.found

    def lines(self) -> tuple[Line, Line]:
        """The path of the present plan and a second one to judge it by, circles around what they leave on the wrong side."""
        reach = self.reach
        one, two = (
            modes.with_circles(
                self.scene, spectral.bent_line(p), self.found, max(reach.extent, reach.source), reach.path, bool(i)
            )
            for i, p in enumerate((self.plan, self.plan.other()))
        )
        return one, two

    def shallower(self, depth: float) -> None:
        """Plan again, nearer to the axis: there are fewer modes between them."""
        deepest = self.reach._replace(band=self.plan.band)
        self.plan = spectral.plan_bent(deepest, self.rtol, self.noise, depth)
        self.searched = 0.0


def _bent_solution(search: _Search) -> Solution:
    """Widen the window, or the band where its edge is what is missing, until two bent paths agree."""
    s, checks, rtol = search.scene, search.checks, search.rtol
    best: Solution | None = None
    shrinks = 2 if modes.is_lossless(s) else 6  # on the axis itself their number does not fall
    in_vain = 0
    for _ in range(ATTEMPTS):
        plan = search.plan
        if search.too_wide():
            break
        found = search.look()
        if found is modes.UNCLEAR and shrinks == 0:
            break
        if found is modes.UNCLEAR:
            shrinks -= 1
            search.shallower(plan.depth / 3)
            continue
        line, second = search.lines()
        one, two = judge.sampled(checks, line, False), judge.sampled(checks, second, True)
        error, edge = judge.difference(s, checks, one, two)
        stuck = best is not None and error.max() > 0.5 * best.error.max()
        if best is None or error.max() < best.error.max():
            best = Solution(line, error, circles=bool(found.wrong))
        in_vain = in_vain + 1 if stuck else 0
        if error.max() <= rtol or in_vain > 3:
            break
        if edge > 0.3 * rtol:
            search.plan = plan._replace(band=plan.band * 1.5)
        elif stuck:  # wider does not help: rounding, magnified by exp(depth X)
            search.plan = plan._replace(depth=plan.depth * .6, window=plan.window * 1.3)
        else:  # images fall as exp(-depth W)
            more = math.log(min(float(error.max()), 1e6) / (0.3 * rtol)) / plan.depth
            search.plan = plan._replace(window=plan.window + min(max(more, 0.5 * plan.window), plan.window))
    if best is None and search.found is modes.UNCLEAR:
        raise ValueError("slab: it guides more backward waves than can be told from the forward ones; add loss")
    if best is None:
        raise ValueError(
            f"rtol: {rtol:g} needs more than {MOST_MODES} plane waves for this source and window (the spectrum of a sharp "
            "edge does not end on its own launch plane: ask for z a little behind z0)"
        )
    return best


#: What share of its window a straight line is tried with first, and how much more of everything it is given then.
TRIES = ((0.78, 1.0), (0.9, 1.0), (1.0, 1.4))


def _straight_solution(search: _Search, x: np.ndarray) -> Solution | None:
    """Straight lines for an FFT where that is cheaper than a matrix product over the bent path, and as good.

    They are judged by the second bent path of the present plan, once for each plan.
    """
    s, checks, rtol, plan = search.scene, search.checks, search.rtol, search.plan
    dx = even_spacing(x)
    if not dx or search.judged_by == plan:
        return None
    search.judged_by = plan
    size, second = plan.band * plan.window / (2 * np.pi), None
    for share, tighten in TRIES:
        straight = spectral.plan_open(search.reach, rtol, tighten, search.noise)
        n = spectral.fast_length(max(math.ceil(share * straight.window / dx), x.size))
        if not _fft_is_cheaper(n, size, x.size) or search.look().wrong:
            return None
        if second is None:
            second = judge.sampled(checks, search.lines()[1], True)
        line = spectral.open_line(straight._replace(window=n * dx))
        error, _ = judge.difference(s, checks, judge.sampled(checks, line, False), second)
        if error.max() <= rtol:
            return Solution(line, error, n)
    return None


def _fft_is_cheaper(n: int, modes: float, points: int) -> bool:
    """Whether two FFTs of length n cost less than a row of a matrix product (in units that were measured)."""
    return 5.5 * n * math.log2(n) < modes * points


def _propagating_solution(s: Scene, checks: Checks, reach: Reach, rtol: float) -> Solution:
    """Gauss nodes over the propagating waves, doubled until two numbers of nodes agree."""
    count = int(60 + 0.6 * reach.k0 * (reach.extent + reach.path))
    for _ in range(6):
        lines = [spectral.propagating_line(s.k0, list(s.branches), c) for c in (count, int(1.4 * count))]
        one, two = (judge.sampled(checks, line, bool(moved)) for moved, line in enumerate(lines))
        error, _ = judge.difference(s, checks, one, two)
        if error.max() <= rtol or count > MOST_MODES // 4:
            break
        count = int(1.8 * count)
    return Solution(lines[1], error)


def point_sum(s: Scene, beam: Beam, line: Line, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) at any x by a matrix product."""
    right, left = judge.amplitudes(s, single(beam), line)
    return spectral.direct_sum(line, h, right[0], left[0], x - beam.centre)


def beam_sum(s: Scene, beam: Beam, solution: Solution, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) of one beam by whichever of FFT and matrix product is cheaper."""
    out = np.empty((1, h.shape[0], x.size), complex)
    fill(s, single(beam), solution, h, x, out)
    return out[0]


def fill(s: Scene, fan: Fan, solution: Solution, h: np.ndarray, x: np.ndarray, out: np.ndarray) -> None:
    """p(z, x) of all asked beams into out (A, Z, X), of which (Z, X) must be contiguous."""
    line, n = solution.line, solution.fft
    right, left = judge.amplitudes(s, fan, line)
    x = x - fan.beam.centre
    fast = n and _fft_is_cheaper(n, line.k.size, x.size)
    if fan.mix is not None:
        summed = spectral.fft_sum(line, h, right, left, x, n) if fast else spectral.direct_sum(line, h, right, left, x)
        fan.mixed(summed, out)
    elif fast:
        for a, b, into in zip(right, left, out, strict=True):
            spectral.fft_sum(line, h, a, b, x, n, into)
    elif len(right) == 1 or h.shape[0] > 64:
        for a, b, into in zip(right, left, out, strict=True):
            into[...] = spectral.direct_sum(line, h, a, b, x)
    else:
        out[...] = spectral.direct_sum(line, h, right, left, x)


#: From how many planes and positions on most planes are made of a few; and the most that are looked at together.
MANY_PLANES, MANY_POINTS, TOGETHER = 200, 64, 2048
#: Among how many planes the few are looked for, and in each medium at least; how many they may be; and how many others are
#: summed in each medium to see that it is so.
SEARCHED, IN_EACH, MOST_ROWS, TRIED = 90, 40, 40, 5


def fill_map(
    s: Scene, fan: Fan, solution: Solution, transfer: Transfer, z: np.ndarray, x: np.ndarray, out: np.ndarray, rtol: float
) -> np.ndarray:
    """p of all asked beams on planes z (Z,) into out (A, Z, X), of which (Z, X) must be contiguous.

    Returns what the error of each beam, over the largest |p| of a plane, gains by planes that are made of others: (A,).
    """
    gained = np.zeros(out.shape[0])
    for start in range(0, z.size, TOGETHER):
        part = slice(start, start + TOGETHER)
        more = None
        if min(TOGETHER, z.size - start) >= MANY_PLANES and x.size >= MANY_POINTS:
            more = _fill_from_few(s, fan, solution, transfer, z[part], x, out[:, part], rtol)
        if more is None:
            more = _fill_all(s, fan, solution, transfer, z[part], x, out[:, part])
        gained = np.maximum(gained, more)
    return gained


def _fill_all(
    s: Scene, fan: Fan, solution: Solution, transfer: Transfer, z: np.ndarray, x: np.ndarray, out: np.ndarray
) -> float:
    """Every plane by itself, in blocks: of the response, and with many angles of the fields that are mixed."""
    k = solution.line.k
    row = max(1, k.size, 0 if fan.mix is None else fan.angles.size * x.size)
    block = max(1 if row > 80_000 else 16, 20_000_000 // (16 * row))
    for start in range(0, z.size, block):
        rows = slice(start, start + block)
        fill(s, fan, solution, transfer(k, z[rows]), x, out[:, rows])
    return 0.0


def _some_planes(s: Scene, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes, as indices of z, that are spread over each medium, and some that lie between them."""
    faces = np.cumsum([0.0, *(values.periods * values.layers.thickness.sum() for values in s.segments)])
    order = np.argsort(z, kind="stable")
    parts = np.split(order, np.searchsorted(z[order], faces))
    searched, tried = [], []
    for part in parts:
        if part.size:
            count = min(part.size, max(IN_EACH, SEARCHED * part.size // z.size))
            turn = (1 - np.cos(np.linspace(0, np.pi, count))) / 2  # denser at the faces, where what decays is seen
            at = np.unique(((part.size - 1) * turn).round().astype(int))
            between = (at[:-1] + at[1:]) // 2
            between = np.setdiff1d(between, at)
            searched.append(part[at])
            tried.append(part[between[np.unique(np.linspace(0, between.size - 1, TRIED).astype(int))]] if between.size else [])
    return np.concatenate(searched), np.concatenate(tried).astype(int)


def _fill_from_few(
    s: Scene, fan: Fan, solution: Solution, transfer: Transfer, z: np.ndarray, x: np.ndarray, out: np.ndarray, rtol: float
) -> np.ndarray | None:
    """Planes made of a few, found among some with all plane waves; None where that is not good enough.

    That is seen on others, between those, which are summed themselves. exp(|Im k| X) magnifies errors of h.
    """
    k, x0 = solution.line.k, x - fan.beam.centre
    right, left = judge.amplitudes(s, fan, solution.line)
    strength = np.max(np.abs(right) + np.abs(left), axis=0)
    searched, tried = _some_planes(s, z)
    if 2 * searched.size > z.size:
        return None
    h = transfer(k, z[np.concatenate([searched, tried])])
    weighted = h[: searched.size] * strength
    size = np.linalg.norm(weighted, axis=1)
    if not np.all(size > judge.DARK):
        return None
    growth = float(np.max(np.abs(k.imag)) * np.max(np.abs(x0)))
    weighted /= size[:, None]
    found = cross(weighted, max(0.01 * rtol * math.exp(-growth), 3e-15), MOST_ROWS)
    if found is None:
        return None
    rows, columns = found
    mix = mixing(transfer(k[columns], z), h[rows][:, columns])
    summed = np.empty((out.shape[0], rows.size + tried.size, x.size), complex)
    fill(s, fan, solution, h[np.concatenate([rows, searched.size + np.arange(tried.size)])], x, summed)
    error = np.empty(out.shape[0])
    for one, into, i in zip(summed, out, range(error.size), strict=True):
        np.matmul(mix, one[: rows.size], out=into)
        scale = np.max(np.abs(one[rows.size :]), axis=1)
        apart = np.max(np.abs(into[tried] - one[rows.size :]), axis=1)
        error[i] = 2 * np.max(apart / np.where(scale > judge.DARK, scale, np.inf))
    return error if np.max(error) <= 0.1 * rtol else None  # a nan is not


def periodic_solution(s: Scene, fan: Fan, x: np.ndarray, period: float) -> Solution:
    """The plain sum over the real orders of a stated period."""
    band = min(fan.band(s.k0, 1e-15), 2 * np.pi * MOST_MODES / period)
    line = spectral.periodic_line(period, band)
    dx = even_spacing(x)
    n = round(period / dx) if dx else 0
    fits = n and abs(n * dx - period) < 1e-12 * period and spectral.fast_length(n) == n
    error = np.zeros(fan.angles.size if fan.mix is None else fan.mix.shape[0])
    return Solution(line, error, n if fits and n >= x.size else 0)
