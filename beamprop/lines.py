"""The choice of a line of integration for a field and an rtol, and the judgement that it serves.

Everything here is for one frequency; a `Scene` holds what does not change from line to line.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from . import elsewhere, judge, memory, misplaced, spectral, stretches
from .beam import Beam
from .fan import Fan
from .judge import Checks
from .scene import Scene, backward_branch, is_lossless, last_branch, nearest_branch, real_branches
from .spectral import BentPlan, Line, Reach
from .transfers import Transfer

#: The most modes that a line may have, and how often a plan is widened before the asked rtol is given up.
MOST_MODES = 200_000
ATTEMPTS = 14


#: FFTs are for even grids of at least this many points.
FEWEST = 8


def spacing_for_fft(x: np.ndarray, band: float, rtol: float) -> float:
    """Spacing of a grid that is even as far as an FFT needs it (see `spectral.grid_sum`), 0 for any other."""
    grid = spectral.grid_of(x)
    moved = band * grid.unevenness
    return grid.step if x.size >= FEWEST and moved * moved < 0.01 * rtol else 0.0


def _reach(s: Scene, fan: Fan, x: np.ndarray, z: np.ndarray, rtol: float) -> Reach:
    tolerance = rtol * 1e-3
    beam = fan.beam
    source = beam.reach(tolerance)
    extent = float(np.max(np.abs(x - beam.centre), initial=0.0))
    path = max(float(z.max()), s.thickness) - beam.z0 + max(0.0, -float(z.min()))
    band = min(fan.band(s.k0, tolerance), _arriving(s, beam.z0, z, tolerance))
    return Reach(s.k0, nearest_branch(s), band, max(extent, source), source, path)


def _arriving(s: Scene, z0: float, z: np.ndarray, tolerance: float) -> float:
    """|kx| beyond which waves have decayed to `tolerance` on their way, in the half-spaces, to the nearest plane.

    What a slab does to them is not known here: it shows in the band's edge.
    """
    nearest = float(z.min())
    way = min(nearest, 0.0) - z0 + max(0.0, nearest - s.thickness)
    return math.hypot(last_branch(s), math.log(1 / tolerance) / way) if way > 0 else math.inf


class Solution(NamedTuple):
    """A line that serves, and the estimated relative error by asked angle."""

    line: Line
    error: np.ndarray
    fft: int = 0  #: FFT length if the line fits the asked even grid, else 0
    circles: bool = False  #: whether it has circles around backward modes
    amplitudes: tuple[np.ndarray, np.ndarray] | None = None  #: of the beams that it was chosen for
    judged: np.ndarray | None = None  #: the planes on which the error was estimated

    def amplitudes_of(self, k0: float, fan: Fan) -> tuple[np.ndarray, np.ndarray]:
        """w S(k) and w S(-k) of the beams that are summed, about their middle: (B, n) each."""
        if self.amplitudes is not None and self.amplitudes[0].shape[0] == fan.angles.size:
            return self.amplitudes
        return judge.amplitudes(k0, fan, self.line)


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
    many = fan.mix is not None and fan.asked.size > judge.JUDGED
    points, planes = judge.check_points(x, z, fan.beam.centre, reach.source, s.thickness, many)
    if z.size > planes.size:
        planes = np.union1d(planes, judge.darkest_planes(fan, s.k0, transfer, z))
    seen = judge.survey(s, fan, transfer, points, planes, reach, rtol)
    checks = Checks(fan, s.k0, transfer, points, planes, guided, seen.bright, None)
    return _chosen(s, checks, reach, seen, x, rtol)._replace(judged=planes)


def _chosen(s: Scene, checks: Checks, reach: Reach, seen: judge.Survey, x: np.ndarray, rtol: float) -> Solution:
    if not checks.fan.beam.entire:
        return _propagating_solution(s, checks, reach, rtol, seen)
    search = _Search(s, checks, reach, rtol, seen)
    if backward_branch(s) is not None and checks.guided:
        return _solution_in_stretches(search)
    straight = None if search.too_wide() or search.ends.size else _straight_solution(search, x)
    if straight:
        return straight
    bent = _bent_solution(search)
    return bent if search.ends.size else _straight_solution(search, x) or bent


#: The most beams whose spectra's ends a contour meets on the axis.
MOST_CUT = 8
#: From how many plane waves on those nearer to the normal than a beam's own are left out.
MANY_MODES = 20_000


class _Search:
    """The search for a contour: what is known of the poles on its wrong side, and the plan that has come so far."""

    def __init__(self, s: Scene, checks: Checks, reach: Reach, rtol: float, seen: judge.Survey) -> None:
        self.scene, self.checks, self.reach, self.rtol = s, checks, reach, rtol
        self.noise, self.sharp = seen.noise, seen.sharp
        self.plan: BentPlan = self._planned(math.inf)
        if self.too_wide():  # the spectrum of a sharp edge, but a slab lets little of it through
            self.reach = reach._replace(band=judge.arriving_band(s, checks, reach, rtol * 1e-3))
            self.plan = self._planned(math.inf)
        if self.plan.nodes > MANY_MODES:
            low = checks.fan.low(s.k0, 1e-6 * rtol)
            if low > 0 and judge.wide_enough(checks.transfer, checks.z, low, self.reach.band):
                self.reach = self.reach._replace(low=low)
                self.plan = self._planned(math.inf)
        self.found, self.searched = misplaced.NONE, 0.0 if checks.guided else math.inf
        self.judged_by: BentPlan | None = None  # the last plan by which a straight line was judged

        self.ends = np.empty(0)  # where spectra are cut off that matter
        if checks.fan.asked.size <= MOST_CUT:
            self.ends = judge.cut_spectra(s, checks, self.reach, 0.1 * rtol)

    def _planned(self, deepest: float) -> BentPlan:
        return spectral.plan_bent(self.reach, self.rtol, self.noise, deepest, self.sharp)

    def too_wide(self) -> bool:
        """Whether the present plan takes too many plane waves."""
        return self.plan.other().nodes > MOST_MODES

    @property
    def start(self) -> float:
        """Re kx from which poles are searched for."""
        return min(1e-3 * self.scene.k0, 0.1 * min(self.sharp, self.reach.branch))

    def look(self) -> misplaced.MisplacedPoles:
        """Poles on the wrong side of the contour of the present plan, searched for as far as its band goes."""
        if self.plan.band > self.searched:
            self.searched = 1.15 * self.plan.band
            self.found = misplaced.misplaced(self.scene, 1.05 * self.plan.depth, self.searched, self.start)
            self._cross()
        return self.found

    def refusal(self) -> str:
        """Why poles cannot be put right, and what would do."""
        plan = self._planned(math.inf)
        # the first, third and fifth of the depths that are tried with loss, if the contour may have so many plane waves there
        shallower = [plan, *(self._planned(plan.depth * share)._replace(band=plan.band) for share in (1 / 9, 1 / 81))]
        depths = [1.05 * p.depth for p in shallower if p is plan or p.other().nodes < MOST_MODES / 4]
        loss = misplaced.enough_loss(self.scene, depths, 1.15 * plan.band, self.start)
        remedy = (
            ", or take a thinner slab or fewer periods: of losses up to 1, over each density and modulus, none would do"
            if loss is None
            else (
                f": a relative loss of {loss:.0e} would do, density + {loss:.0e}j |density| and bulk modulus - {loss:.0e}j |bulk modulus| "
                "in every layer and half-space"
            )
        )
        return f"slab: it guides more backward waves than can be told from the forward ones; add loss{remedy}"

    def _cross(self) -> None:
        """Let the contour cross the axis where it has to, no steeper than it leaves the origin."""
        if not math.isfinite(self.found.crossing):
            return
        gap = self.found.gap / 2
        if self.plan.depth > 0.5 * gap:
            self.plan = self._planned(0.5 * gap)._replace(band=self.plan.band)
        self.plan = self.plan._replace(crossing=self.found.crossing, gap=gap)

    def lines(self) -> tuple[Line, Line]:
        """The path of the present plan and a second one to judge it by, circles around what they leave on the wrong side."""
        reach = self.reach
        one, two = (
            misplaced.with_residues(
                self.scene, spectral.bent_line(p), self.found, max(reach.extent, reach.source), reach.path, bool(i)
            )
            for i, p in enumerate((self.plan, self.plan.other()))
        )
        return one, two

    def shallower(self, depth: float) -> None:
        """Plan again, nearer to the axis: there are fewer modes between them."""
        self.plan = self._planned(depth)._replace(band=self.plan.band)
        self.searched = 0.0


def _bent_solution(search: _Search) -> Solution:
    """Widen the window, or the band where its edge is what is missing, until two bent paths agree.

    Errors are over the largest |p| of each plane. Where that lies far outside of the window, what is asked for is still made as
    right by its own size as some thousand plane waves make it.
    """
    s, checks, rtol = search.scene, search.checks, search.rtol
    best: Solution | None = None
    shrinks = 2 if is_lossless(s) else 6  # on the axis itself their number does not fall
    in_vain, asked = 0, None
    for _ in range(ATTEMPTS):
        if search.too_wide():
            break
        found = search.look()
        plan = search.plan
        if found is misplaced.UNCLEAR and shrinks == 0:
            break
        if found is misplaced.UNCLEAR:
            shrinks -= 1
            search.shallower(plan.depth / 3)
            continue
        if search.ends.size and best is None:
            best = _in_stretches(search).best
            if best is not None and best.error.max() <= rtol:
                return best
        line, second = search.lines()
        one, two = judge.sampled(checks, line, False), judge.sampled(checks, second, True)
        error, edge = judge.difference(checks, one, two)
        if error.max() > rtol and checks.dark is None:
            checks = judge.with_dark_planes(checks)
            error, edge = judge.difference(checks, one, two)
        if error.max() > rtol and best is not None:  # a wider window alone did not do
            if asked is None:
                asked, checks = checks, elsewhere.with_wider_look(s, checks, search.reach, plan, found)
            error, edge = judge.difference(checks, one, two)
        stuck = best is not None and error.max() > 0.5 * best.error.max()
        if best is None or error.max() < best.error.max():
            best = Solution(line, error, circles=bool(found.poles), amplitudes=one.amplitudes)
        in_vain = in_vain + 1 if stuck else 0
        if error.max() <= rtol and asked is not None:
            return _good_by_itself(search, asked, best)
        if error.max() <= rtol or in_vain > 3:
            break
        if edge > 0.3 * rtol:
            search.plan = plan._replace(band=plan.band * 1.5)
        elif stuck:  # wider does not help: rounding, magnified by exp(depth X)
            search.plan = plan._replace(depth=plan.depth * 0.6, window=plan.window * 1.3)
        else:  # images fall as exp(-depth W)
            more = math.log(min(float(error.max()), 1e6) / (0.3 * rtol)) / plan.depth
            search.plan = plan._replace(window=plan.window + min(max(more, 0.5 * plan.window), plan.window))
    if best is None and search.found is misplaced.UNCLEAR:
        if stretches.is_periodic(s):
            return _solution_in_stretches(search)
        raise ValueError(search.refusal())
    if best is None:
        raise ValueError(_too_many(rtol))
    return best


#: How often a contour that serves by a peak far outside is widened for what is asked for, and the most plane waves it may have then.
WIDENED, MOST_WIDENED = 5, 5_000


def _good_by_itself(search: _Search, checks: Checks, best: Solution) -> Solution:
    """Widen a contour that serves by the plane's peak far outside of the window until it serves by the largest |p| inside, if it
    soon does."""
    before = math.inf
    for _ in range(WIDENED):
        line, second = search.lines()
        one, two = judge.sampled(checks, line, False), judge.sampled(checks, second, True)
        error, edge = judge.difference(checks, one, two)
        size = float(error.max())
        if size <= search.rtol:
            return Solution(line, error, circles=bool(search.found.poles), amplitudes=one.amplitudes)
        plan = search.plan
        more = 1.5 * math.log(min(size, 1e6) / (0.1 * search.rtol)) / plan.depth
        if (size < 1 and size > 0.1 * before) or edge > 0.3 * search.rtol:
            break
        if size < before:
            best = best._replace(line=line, circles=bool(search.found.poles), amplitudes=one.amplitudes)
        before, search.plan = size, plan._replace(window=plan.window + more)
        if search.plan.other().nodes > MOST_WIDENED:
            break
    return best


def _too_many(rtol: float) -> str:
    return (
        f"rtol: {rtol:g} needs more than {MOST_MODES} plane waves for this source and window (the spectrum of a sharp "
        "edge does not end on its own launch plane: ask for z a little behind z0; and a beam that has spread over very many "
        "wavelengths takes as many plane waves: ask for a shorter way or a higher rtol)"
    )


#: How often a contour in stretches is planned again: each has shorter panels and another depth, or a wider band.
TRIES_IN_STRETCHES = 7


class _Tried(NamedTuple):
    """The best of the contours in stretches that were tried, if any served, and whether poles were unclear."""

    best: Solution | None
    unclear: bool


def _solution_in_stretches(search: _Search) -> Solution:
    """A contour in stretches, or the refusal of a question for which there is none."""
    best, unclear = _in_stretches(search)
    if best is None:
        raise ValueError(search.refusal() if unclear else _too_many(search.rtol))
    if search.found is misplaced.UNCLEAR and best.error.max() > 1:  # no digit is known
        raise ValueError(search.refusal())
    return best


def _in_stretches(search: _Search) -> _Tried:
    """Shorten the panels, or widen the band where its edge is what is missing, until two contours in stretches agree."""
    s, checks, rtol, ends = search.scene, search.checks, search.rtol, search.ends
    plan = stretches.plan_stretches(search.reach, search.reach.path - s.thickness, rtol, search.noise)
    closed = bool(ends.size) and bool(ends[-1] == np.max(checks.fan.spectrum_ends(s.k0)))
    if closed:
        plan = plan._replace(band=1.01 * float(ends[-1]))
    best, unclear, in_vain = None, False, 0
    for _ in range(TRIES_IN_STRETCHES):
        crowded = search.found is misplaced.UNCLEAR
        pair = stretches.pair_of_lines(s, search.reach, plan, search.start, crowded, ends, closed)
        if pair is None:
            plan, unclear = plan._replace(depth=plan.depth / 3, height=plan.height / 3), True
            continue
        if max(line.k.size for line in pair) > MOST_MODES:
            break
        one, two = (judge.sampled(checks, line, moved) for line, moved in zip(pair, (False, True), strict=True))
        error, edge = judge.difference(checks, one, two)
        if error.max() > rtol and checks.dark is None:
            checks = judge.with_dark_planes(checks)
            error, edge = judge.difference(checks, one, two)
        in_vain = in_vain + 1 if best is not None and error.max() > 0.5 * best.error.max() else 0
        if best is None or error.max() < best.error.max():
            best = Solution(pair[0], error, circles=True, amplitudes=one.amplitudes)
        if error.max() <= rtol or in_vain > 1:
            break
        wider = 1.5 if edge > 0.3 * rtol else 1.0
        plan = plan._replace(band=plan.band * wider)
        if wider == 1.0:
            plan = plan._replace(depth=plan.depth * 0.7, height=plan.height * 0.75, finer=plan.finer * 1.4)
    return _Tried(best, unclear)


#: What share of its window a straight line is tried with first, and how much more of everything it is given then.
TRIES = ((0.78, 1.0), (0.9, 1.0), (1.0, 1.4))


def _straight_solution(search: _Search, x: np.ndarray) -> Solution | None:
    """Straight lines for an FFT where that is cheaper than a matrix product over the bent path, and as good.

    They are judged by the second bent path of the present plan, once for each plan.
    """
    checks, rtol, plan = search.checks, search.rtol, search.plan
    dx = spacing_for_fft(x, plan.band, rtol)
    if not dx or search.judged_by == plan or plan.grading or plan.low:
        return None
    search.judged_by = plan
    size, second = plan.band * plan.window / (2 * np.pi), None
    for share, tighten in TRIES:
        straight = spectral.plan_open(search.reach, rtol, tighten, search.noise)
        n = spectral.fast_length(max(math.ceil(share * straight.window / dx), x.size))
        if not fft_is_cheaper(n, size, x.size) or _is_misplaced(search.look()):
            return None
        if second is None:
            second = judge.sampled(checks, search.lines()[1], True)
            second = second._replace(sums=judge.summed(checks, second))
        line = spectral.open_line(straight._replace(window=n * dx))
        first = judge.sampled(checks, line, False)
        error, _ = judge.difference(checks, first, second)
        if error.max() <= rtol:
            return Solution(line, error, n, amplitudes=first.amplitudes)
    return None


def _is_misplaced(found: misplaced.MisplacedPoles) -> bool:
    """Whether a contour below the axis alone leaves any pole on its wrong side."""
    return bool(found.poles) or math.isfinite(found.crossing)


def fft_is_cheaper(n: int, modes: float, points: int) -> bool:
    """Whether two FFTs of length n cost less than a row of a matrix product (in units that were measured)."""
    return 5.5 * n * math.log2(n) < modes * points


#: How far the contour of propagating waves dips below the axis, over k0.
DEEPEST_DIP = 0.3


def _dip(s: Scene, reach: Reach, rtol: float, sharp: float) -> float:
    """How far a contour of propagating waves dips below the axis, over k0: 0 where nothing is sharp, or backward waves are there."""
    growth = min(spectral.DEEPEST, max(0.0, math.log(rtol / (100 * spectral.EPS))))
    dip = min(DEEPEST_DIP, growth / (reach.k0 * max(reach.extent, reach.source)))
    if not math.isfinite(sharp):
        return 0.0
    found = misplaced.misplaced(s, 1.05 * dip * reach.k0, (1 - 1e-6) * reach.k0, 1e-6 * reach.k0)
    return dip if not found.poles else 0.0


#: The most plane waves of a rotated beam whose width is asked for: a contour of so many is judged within some seconds, and then
#: summed at some hundred positions.
MOST_OF_WIDTHS = 600_000


def _rays(k0: float, length: float) -> int:
    """Gauss nodes over the propagating waves by which a field is tried first, `length` being the way along x and z."""
    return int(60 + 0.6 * k0 * length)


def check_rays(s: Scene, beam: Beam, path: float, extent: float) -> None:
    """Refuse the width of a beam of propagating waves alone whose phases turn too often over its way."""
    if not beam.entire and (waves := 1.4 * _rays(s.k0, path + extent)) > MOST_OF_WIDTHS:
        raise ValueError(
            f"z0: expected a way that beams of propagating waves alone go with at most {MOST_OF_WIDTHS} plane waves, got {path:.3g} m of "
            f"it, which take {waves:.2g}: take a launch plane and a slab's far face that are nearer, or form='launch', which takes fewer"
        )


def _propagating_solution(s: Scene, checks: Checks, reach: Reach, rtol: float, seen: judge.Survey) -> Solution:
    """Gauss nodes over the propagating waves, doubled until two numbers of nodes, on contours that dip differently, agree."""
    count = _rays(reach.k0, reach.extent + reach.path)
    dip = _dip(s, reach, rtol, seen.sharp) if checks.guided else 0.0
    for _ in range(6):
        memory.check_contour(1.4 * count, checks.fan.angles.size, checks.z.size)
        lines = [
            spectral.propagating_line(s.k0, real_branches(s), int(more * count), share * dip, share * seen.sharp)
            for more, share in ((1.0, 0.7), (1.4, 1.0))
        ]
        one, two = (judge.sampled(checks, line, bool(moved)) for moved, line in enumerate(lines))
        error, _ = judge.difference(checks, one, two)
        if error.max() > rtol and checks.dark is None:
            checks = judge.with_dark_planes(checks)
            error, _ = judge.difference(checks, one, two)
        if error.max() <= rtol or count > MOST_MODES // 4:
            break
        count = int(1.8 * count)
    return Solution(lines[1], error, amplitudes=two.amplitudes)


def periodic_solution(s: Scene, fan: Fan, x: np.ndarray, period: float) -> Solution:
    """The plain sum over the real orders of a stated period."""
    band = min(fan.band(s.k0, 1e-15), 2 * np.pi * MOST_MODES / period)
    line = spectral.periodic_line(period, band)
    dx = spacing_for_fft(x, band, spectral.EPS)
    n = round(period / dx) if dx else 0
    fits = n and abs(n * dx - period) < 4 * spectral.EPS * period and spectral.fast_length(n) == n
    error = np.zeros(fan.angles.size if fan.mix is None else fan.mix.shape[0])
    return Solution(line, error, n if fits and n >= x.size else 0)
