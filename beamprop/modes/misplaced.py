"""Misplaced poles: guided and leaky modes on the wrong side of a contour, located with discs for their residues.

By limiting absorption a forward mode belongs above the contour on the right half of the axis, and a backward mode (its energy
flows against its phase, which negative densities and moduli allow) below it. A contour below the axis leaves backward modes
above it. Up to MOST_WRONG of them get small circles, on which the contour's sum is their residue. Where more of them lie beyond all
forward ones, the contour crosses the axis between the two kinds instead.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..response.sampled_slab import SampledSlab, on_the_right
from .argument_principle import CLUSTER, Box, Dispersion, TooManyModes, outlines, refine, winding, windings, zeros
from .guided import BESIDE, LOSS, DispersionOf, Mode, dispersion_of, located, with_directions

#: Rounding may put a mode that lies nearer to the real axis than this, over k0, on either side (lossless layers beside lossy ones).
ON_AXIS = 1e-10
#: The most poles that may be misplaced: their circles take 24 x 32 = 768 nodes, as many as a usual contour has. And the most values of D
#: that an outline may take: 0.1 s for the LMMD cell, 0.4 s for ten thick layers.
MOST_WRONG = 24
MOST_VALUES = 100_000
#: A crossing is searched for if there are more circles than this: the search takes ten times as long as that for circles, and eight of
#: these are 256 nodes.
WITHOUT_CROSSING = 8
#: Steps along an outline that are shorter than this, over its largest Re kx, are not halved: a zero lies on it, to some rounding of D.
FINEST = 1e-12


class MisplacedPoles(NamedTuple):
    """Poles on the wrong side of a contour.

    The contour runs below the axis up to Re kx = `crossing` and above it beyond; no pole lies within `gap` of the crossing.
    """

    poles: tuple[complex, ...]
    radii: tuple[float, ...]  #: of discs around them that hold no other pole
    crossing: float = math.inf
    gap: float = math.inf


NONE = MisplacedPoles((), ())
#: The answer where there are more modes than a search can separate.
UNCLEAR = MisplacedPoles((complex("nan"),), (0.0,))


def misplaced(s: SampledSlab, depth: float, band: float, start: float) -> MisplacedPoles:
    """Poles on the wrong side of a contour that runs at `depth` below the axis, start < Re kx < band, or crosses it.

    Parameters
    ----------
    s : SampledSlab, of one frequency
    depth, band, start : float, rad/m

    Returns
    -------
    MisplacedPoles
        UNCLEAR where both circles and a crossing fail.
    """
    if not s.may_guide_backward:
        return NONE
    s = s.up_to_wall()
    circled = _with_circles_alone(s, depth, band, start)
    if s.backward_branch is not None or (circled is not UNCLEAR and len(circled.poles) <= WITHOUT_CROSSING):
        return circled
    try:
        return _with_crossing(s, depth, band, start) or circled
    except TooManyModes:
        return circled


def _with_circles_alone(s: SampledSlab, depth: float, band: float, start: float) -> MisplacedPoles:
    """Circles around the poles that a contour below the axis leaves above it; UNCLEAR if these are too many."""
    try:
        return with_discs(s, _below(s, depth, band, start))
    except TooManyModes:
        return UNCLEAR


def _below(s: SampledSlab, depth: float, band: float, start: float) -> list[Mode]:
    """Modes below the axis, or on it beyond the branch points, and above a contour at `depth` below it."""
    edge, above = s.last_branch * (1 + BESIDE), ON_AXIS * s.k0
    cut = s.backward_branch
    if s.lossless:
        above = depth
    if cut is not None:
        return _beside_cut(s, cut.real, (start, band, depth), (edge, above))
    if not s.lossless and not _any_mode(s, Box(start, band, -depth, 0.0), edge, above):
        return []
    modes = modes_in(s, Box(start, min(edge, band), -depth, 0.0))
    if band > edge:
        modes += modes_in(s, Box(edge, band, -depth, above))
    return modes


def _beside_cut(
    s: SampledSlab, cut: float, contour: tuple[float, float, float], lifted: tuple[float, float]
) -> list[Mode]:
    """`_below` where a branch cut leads downward from Re kx = `cut`: boxes end on either side of it."""
    (start, band, depth), (edge, above) = contour, lifted
    modes = []
    ends = [start, cut * (1 - BESIDE), cut * (1 + BESIDE), s.last_branch * (1 - BESIDE), edge, band]
    for left, right in itertools.pairwise(sorted({min(max(end, start), band) for end in ends})):
        if right - left > 3 * BESIDE * cut:
            modes += modes_in(s, Box(left, right, -depth, above if left >= edge else 0.0))
    return modes


def with_discs(
    s: SampledSlab, modes: list[Mode], forward: tuple[complex, ...] = (), of: DispersionOf = dispersion_of
) -> MisplacedPoles:
    """Discs around the backward modes among `modes`, and around misplaced `forward` modes (kx)."""
    groups = _grouped([*(m.kx for m in modes if m.direction < 0), *forward])
    middles = tuple(sum(group) / len(group) for group in groups)
    known = [*(m.kx for m in modes), *forward]
    discs = (_free_disc(s, of(s, 0.0), k, group, known) for k, group in zip(middles, groups, strict=True))
    return MisplacedPoles(middles, tuple(discs))


def _branch_beside(s: SampledSlab) -> float:
    """Re kx of the nearest branch point beside the axis, where outlines have additional nodes."""
    return min(s.real_branches, default=s.last_branch)


def _any_mode(s: SampledSlab, box: Box, edge: float, above: float) -> bool:
    """Whether there is a mode in a box whose upper side is raised by `above` to the right of `edge`: one outline, as mostly none is."""
    left, right, low, high, near, *lifted = (np.array([v]) for v in (*box, _branch_beside(s), edge, above))
    path = outlines(left, right, low, high, 48, near, lifted)[0]
    return winding(dispersion_of(s), path, FINEST * box.right, MOST_VALUES) > 0


def modes_in(s: SampledSlab, box: Box, of: DispersionOf = dispersion_of) -> list[Mode]:
    """All modes in a box; TooManyModes if there are more than MOST_WRONG, or if not all can be located.

    Of a lossless slab those may be missing that lie on the box's upper side, as next to a branch point, and are forward.
    """
    total = _count(s, box, of, 0.0)
    if total <= 0:
        return []
    modes = with_directions(s, located(s, box, total, MOST_WRONG, MOST_VALUES, of), of)
    if len(modes) < total:
        lifted = total - _count(s, box, of, LOSS) if s.lossless else 0  # by a small loss, as forward ones are
        if sum(not _lifted(mode) for mode in modes) < total - max(lifted, 0):
            raise TooManyModes
    return modes


def _count(s: SampledSlab, box: Box, of: DispersionOf, loss: float) -> int:
    return winding(of(s, loss), box.outline(48, _branch_beside(s)), FINEST * box.right, MOST_VALUES)


def _lifted(mode: Mode) -> bool:
    """Whether a mode lies on the axis, and goes up with a small loss."""
    return mode.direction > 0 and abs(mode.kx.imag) < 1e-9 * abs(mode.kx)


def _grouped(modes: list[complex]) -> list[list[complex]]:
    """Clusters of modes that share a circle, because their members are located to half the digits only."""
    groups: list[list[complex]] = []
    for k in modes:
        near = [group for group in groups if abs(k - group[0]) < 10 * CLUSTER * abs(k)]
        if near:
            near[0].append(k)
        else:
            groups.append([k])
    return groups


def _free_disc(s: SampledSlab, f: Dispersion, k: complex, group: list[complex], known: list[complex]) -> float:
    """Radius of a disc around a group of modes that holds no further mode, known or not, and no branch point.

    It ends at 0.4 of the way to the nearest known singularity: n nodes on it alias that by 0.4^n. Unknown modes are counted by the
    argument principle, and the radius halved until there is none.
    """
    branches = (complex(on_the_right(b)) for b in s.branch_points)
    radius = 0.4 * min((abs(k - point) for point in (*known, *branches) if point not in group), default=abs(k))
    radius = min(radius, 0.4 * abs(k))
    circle = np.exp(2j * np.pi * np.arange(24) / 24)
    least = max(1e-6 * abs(k), 4 * max(abs(k - mode) for mode in group))
    at_least = winding(f, k + least * circle, 1e-12 * abs(k), MOST_VALUES)
    while radius > least and winding(f, k + radius * circle, 1e-9 * radius, MOST_VALUES) > at_least:
        radius /= 2
    if len(group) > 1 and radius <= least:
        raise TooManyModes
    return radius


# --- a contour that crosses the axis ----------------------------------------------------------------------

#: Places for a crossing that are compared between the last branch point and the band's end: each takes two outlines.
PLACES = 24
#: Relative losses with which modes are counted for a crossing, in this order. A passive slab with loss has no pole on the axis. With more
#: loss modes stay on their side of it: 1e-8 is `guided.LOSS`, and 1e-5 is for modes that this leaves too near to the axis to be counted.
LOSSES = (1e-8, 1e-5)
#: The most values of D for an interval between two places: a fifth of MOST_VALUES, for there are 2 PLACES of them.
MOST_PER_INTERVAL = 20_000


def _with_crossing(s: SampledSlab, depth: float, band: float, start: float) -> MisplacedPoles | None:
    """The crossing of the axis that leaves the fewest poles misplaced; None if these are too many still."""
    edge = s.last_branch * (1 + 1e-3)  # outlines keep off the branch point, and fit between it and the band's end
    if band < 1.1 * edge:
        return None
    places = np.geomspace(edge, band, PLACES + 1)
    for loss in LOSSES:
        f = dispersion_of(s, loss)
        # modes left below the contour beyond a crossing, and above it before: at the places from 1 on
        below, above = _counted(f, places, -depth, 1), _counted(f, places, depth, -1)
        wrong = below[:-1] + above[1:]
        if np.min(wrong) <= MOST_WRONG:
            return _crossing_at(s, f, places, wrong, (depth, band, start))
    return None


def _counted(f: Dispersion, places: np.ndarray, height: float, onward: int) -> np.ndarray:
    """Number of modes between the axis and `height`, cumulative over the intervals between two places.

    Added up from the left (`onward` 1) or from the right (-1); inf from where there are more than MOST_WRONG.
    """
    counts = np.full(places.size - 1, np.inf)
    total = 0.0
    for i in range(counts.size)[::onward]:
        box = Box(float(places[i]), float(places[i + 1]), min(height, 0.0), max(height, 0.0))
        try:
            here = winding(f, box.outline(24), FINEST * float(places[-1]), MOST_PER_INTERVAL, thorough=True)
        except TooManyModes:
            break
        if here < 0:  # D has no poles: the outline has too few nodes for a cluster of modes
            break
        total += here
        if total > MOST_WRONG:
            break
        counts[i] = total
    return counts


def _crossing_at(
    s: SampledSlab, f: Dispersion, places: np.ndarray, wrong: np.ndarray, contour: tuple[float, float, float]
) -> MisplacedPoles:
    """The crossing in the longest run of places that leave the fewest poles misplaced, with discs around these."""
    depth, band, start = contour
    least = np.flatnonzero(wrong == wrong.min())
    runs = np.split(least, np.flatnonzero(np.diff(least) > 1) + 1)
    run = max(runs, key=lambda v: places[v[-1] + 1] / places[v[0] + 1])
    low, high = float(places[run[0] + 1]), float(places[run[-1] + 1])
    crossing, gap = _free_gap(f, low, high, depth, float(places[0]), band)
    known = _below(s, depth, crossing, start)
    box = Box(crossing, band, 0.0, depth)
    total = winding(f, box.outline(48), FINEST * band, MOST_VALUES, thorough=True)
    forward = _forward_modes(s, f, box, total)
    return with_discs(s, known, forward)._replace(crossing=crossing, gap=gap)


def _free_gap(f: Dispersion, low: float, high: float, depth: float, edge: float, band: float) -> tuple[float, float]:
    """A crossing of the axis between `low` and `high`, and the distance around it in which there is no mode."""
    crossing = math.sqrt(low * high)
    gap = min(crossing - edge, band - crossing) * (1.0 if high > low else 0.3)  # a single place has modes on both sides
    for _ in range(8):  # down to 1/128 of it
        box = Box(crossing - gap, crossing + gap, -max(depth, gap), max(depth, gap))
        if winding(f, box.outline(24), FINEST * band, MOST_VALUES) == 0:
            return crossing, gap
        gap /= 2
    raise TooManyModes


def _forward_modes(s: SampledSlab, f: Dispersion, box: Box, total: int) -> tuple[complex, ...]:
    """The `total` forward modes of a box above the axis, which a contour above the axis leaves below it."""
    if total <= 0:
        return ()
    with_loss = zeros(f, box, box.right, total, MOST_VALUES)
    if len(with_loss) < total:
        raise TooManyModes
    return tuple(refine(dispersion_of(s), k, 1e-4 * abs(k))[0] for k in with_loss)


#: Relative losses that a refusal may propose where poles cannot be separated, of each density and modulus.
REMEDIES = 10.0 ** np.arange(-6, 1)


def enough_loss(s: SampledSlab, depths: Sequence[float], band: float, start: float) -> float | None:
    """The least of REMEDIES with which the poles can be separated at any of `depths`; None if there is none.

    By circles alone, because a search for a crossing takes ten times as long. More loss moves more modes away from the axis: the
    largest is tried first, then by bisection.
    """

    def separates(loss: float) -> bool:
        lossy = s.with_loss(loss).up_to_wall()
        return any(_with_circles_alone(lossy, depth, band, start) is not UNCLEAR for depth in depths)

    if not separates(float(REMEDIES[-1])):
        return None
    too_little, enough = -1, REMEDIES.size - 1
    while enough - too_little > 1:
        middle = (too_little + enough) // 2
        if separates(float(REMEDIES[middle])):
            enough = middle
        else:
            too_little = middle
    return float(REMEDIES[enough])


# --- many frequencies -------------------------------------------------------------------------------------


def any_misplaced(s: SampledSlab, depth: np.ndarray, band: np.ndarray) -> np.ndarray:
    """Whether a contour at `depth` has misplaced poles, by the argument principle at F frequencies at once: (F,).

    Modes of a lossless slab lie on the axis, and a small loss moves the forward ones above it and the backward ones below. True, too, where
    counting takes too many values of D.
    """
    if not s.may_guide_backward:
        return np.zeros(depth.shape, bool)
    if s.has_wall:
        return np.ones(depth.shape, bool)
    on_axis = s.lossless
    s = s.with_loss(LOSS) if on_axis else s
    everyone, zero = np.arange(depth.size), np.zeros(depth.shape)
    start, near = np.minimum(1e-3 * s.k0, 0.1 * s.nearest_branch), np.minimum(s.k0, s.last_branch)
    lifted = s.last_branch * (1 + BESIDE), zero if on_axis else ON_AXIS * s.k0

    def evaluate(kx: np.ndarray, owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        part = s if owner.size == depth.size and np.array_equal(owner, everyone) else s.take(owner)
        return part.dispersion(kx)

    # the outline passes modes at a distance of LOSS, and needs as many nodes as one that is to tell how many there are
    paths = outlines(start, band, -depth, zero, 48 if on_axis else 12, near, lifted)
    try:
        return windings(evaluate, paths, FINEST * float(np.min(s.k0)), MOST_VALUES * depth.size, on_axis) > 0
    except TooManyModes:
        return np.ones(depth.shape, bool)
