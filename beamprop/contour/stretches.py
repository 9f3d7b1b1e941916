"""Contours that pass below some stretches of the kx axis and above others.

A contour below the right half of the axis serves where all waves are forward ones. Two kinds of slabs need another:

* A half-space behind that carries backward waves has its branch point on or below the axis, with a cut that leads downward.
  The contour comes up to the axis there, passes over the branch point and may go down again.
* A slab of very many periods without loss guides more modes than can be found one by one. They fill the bands |trace/2| < 1 of
  its cell's matrix, and a trace of loss moves all modes of a stretch of kx to one side: by i e -(dT/de)/(dT/dkx) for half the
  trace T and density + i e |density|, 1/modulus likewise. The contour passes above the stretches where they move down.

Where the side changes the contour meets the axis, in a branch point or where modes crowd. The integrand is bounded there: what
is left out between the axis and the nearest panel goes as the 3/2 power of its length.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from ..modes import misplaced
from ..modes.argument_principle import Box, Dispersion, TooManyModes
from ..modes.guided import BESIDE, Mode, dispersion_of
from ..modes.misplaced import MisplacedPoles
from ..response.sampled_slab import SampledSlab, on_the_right
from . import residues
from .paths import SLOPE, Contour, Extent


class Stretch(NamedTuple):
    """Of the axis from lo to hi, -1 where the contour passes below it and +1 where it passes above."""

    lo: float
    hi: float
    side: int


class Plan(NamedTuple):
    """The numbers of a contour in stretches."""

    depth: float  #: below the axis
    height: float  #: above it, where waves grow along z
    slope: float  #: with which it leaves the axis
    band: float  #: Re kx of its end
    finer: float = 1.0  #: panels are this much shorter than they are first planned
    nodes: int = 20  #: Gauss nodes of a panel

    def second_plan(self) -> Plan:
        """A plan that shares no number with this one, to estimate its error by."""
        return Plan(
            self.depth * 0.83, self.height * 0.8, self.slope * 0.8, self.band * 1.12, self.finer * 1.15, self.nodes + 3
        )


def plan_stretches(extent: Extent, outside: float, rtol: float, noise: float) -> Plan:
    """A first plan. `outside` is the distance along z in the half-spaces; `noise` the relative rounding of S h.

    exp(depth X) magnifies rounding and what lies on the other side, as does exp(height Z) above the axis, where waves in the
    half-spaces grow.
    """
    growth = min(max(1.5, math.log(rtol / (30 * noise))), 6.0)
    depth = min(SLOPE * extent.k0, growth / extent.across)
    return Plan(depth, min(depth, growth / 3 / max(outside, 1e-3 / extent.k0)), 0.6, extent.band)


# --- which side -------------------------------------------------------------------------------------------

#: Samples along the axis by which bands are found, evenly spaced and by decade; and the step for derivatives, over k0 or 1.
SAMPLES, DECADES = 60_000, 3000
STEP = 1e-7
#: Derivatives of half the trace below this are rounding.
UNSEEN = 1e-12


class Bands(NamedTuple):
    """A periodic slab's axis from 0 to the band's end, by the side to which a trace of loss moves the modes there."""

    parts: list[Stretch]
    gaps: list[tuple[float, float]]  #: where the cell has no modes, but a face of the slab may


def bands_of(s: SampledSlab, end: float) -> Bands:
    """The bands of a periodic slab: derivatives are imaginary parts of half the trace at complex kx and densities.

    The side changes half-way through a gap.
    """
    k = np.linspace(0, end, SAMPLES + 1)[1:]
    k = np.unique(np.concatenate([k, np.geomspace(1e-3, 1, DECADES) * min(s.k0, end)]))
    by_k = s.half_trace(k * (1 + 1j * STEP))[0].imag / STEP
    by_loss = s.half_trace(k, STEP)[0].imag / STEP
    inside = np.abs(s.half_trace(k)[0].real) < 1
    clear = inside & (np.minimum(np.abs(by_k), np.abs(by_loss)) > UNSEEN)
    at = np.flatnonzero(clear)
    if not at.size:
        return Bands([Stretch(0.0, end, -1)], [(float(k[0]), end)])
    borders = np.flatnonzero(np.diff(inside))  # gaps end between two samples; those of less than two samples are none
    runs = np.split(np.arange(k.size), borders + 1)
    gaps = [(float(k[run[0]]), float(k[run[-1]])) for run in runs if not inside[run[0]] and run.size > 1]
    side = (np.sign(by_k) * np.sign(by_loss)).astype(int)[at]
    change = np.flatnonzero(np.diff(side))
    ends = [0.0, *((k[at[change]] + k[at[change + 1]]) / 2), end]
    sides = zip(itertools.pairwise(ends), [*side[change], side[-1]], strict=True)
    return Bands([Stretch(float(lo), float(hi), int(v)) for (lo, hi), v in sides], gaps)


def misplaced_in_gaps(s: SampledSlab, bands: Bands, away: float) -> list[MisplacedPoles]:
    """Modes of the slab's faces in the gaps, no farther than `away` from the axis, on the wrong side of the contour.

    Those that belong below a contour that passes below, and those that belong above one that passes above.
    """
    found: dict[int, list[Mode]] = {-1: [], 1: []}
    at = sorted(float(abs(b.real)) for b in s.branch_points)
    cuts = [b * (1 + side * BESIDE) for b in at for side in (-1, 1)]
    for lo, hi in bands.gaps:
        ends = sorted({lo, hi, *(v for v in (*cuts, *(part.lo for part in bands.parts)) if lo < v < hi)})
        for left, right in itertools.pairwise(ends):
            if right - left > 3 * BESIDE * right:
                side = next(part.side for part in bands.parts if part.lo <= (left + right) / 2 <= part.hi)
                here = misplaced.modes_in(s, Box(left, right, -away, away), _without_growth)
                found[side] += [mode._replace(direction=-side * mode.direction) for mode in here]
    above, below = (misplaced.with_discs(s, found[side], of=_without_growth) for side in (1, -1))
    return [below, above._replace(crossing=0.0)]


def _without_growth(s: SampledSlab, loss: float) -> Dispersion:
    """D of a periodic slab, made more lossy, over the growth of Bloch waves across it: an analytic function without zeros in a gap.

    Of very many periods D turns as often as they do along any outline off the axis; what is left turns as the faces have it.
    """
    lossy, f = s.with_loss(loss), dispersion_of(s, loss)

    def evaluate(kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = f(kx)
        return value, log + 1j * lossy.bloch_phase_across(kx)[0]

    return evaluate


def met_at_branches(s: SampledSlab, parts: list[Stretch]) -> list[Stretch]:
    """Stretches cut at the branch points that lie on the other side of the axis than where they belong, or on it."""
    for b in s.branch_points:
        point, side = complex(on_the_right(b)), 1 if b.real < 0 else -1  # the side on which it may be passed
        if point.real > abs(point.imag):
            parts = [piece for part in parts for piece in _cut(part, point.real, side)]
    return parts


#: Of spectra that are not cut off.
NO_ENDS = np.empty(0)


def _cut(part: Stretch, at: float, side: int = 0) -> list[Stretch]:
    lo, hi, own = part
    return [Stretch(lo, at, own), Stretch(at, hi, own)] if lo < at < hi and own != side else [part]


def met_at_ends(parts: list[Stretch], ends: np.ndarray) -> list[Stretch]:
    """Stretches cut where spectra end: up to there they are analytic, and on the axis it is said where they end.

    A contour that stayed off the axis would lack the way from it up to the axis, which is as large as the integrand.
    """
    for end in ends:
        parts = [piece for part in parts for piece in _cut(part, float(end))]
    return parts


# --- the contour ------------------------------------------------------------------------------------------

#: Panels towards an end on the axis shorten by this ratio, down to a length over k0 at which what is left out vanishes.
RATIO, SHORTEST = 1.7, 1e-10
#: Length of a panel over its distance from the axis, and phase over a panel [rad].
FLAT, TURN = 1.2, 9.0


def stretched_contour(s: SampledSlab, parts: list[Stretch], plan: Plan, across: float, along: float) -> Contour:
    """Gauss panels along a contour.

    Parameters
    ----------
    s : SampledSlab
    parts : list of Stretch
        From 0, each beginning where the one before it ends; the last goes on to the band's end, off the axis.
    plan : Plan
    across, along : float, m
        Distance along x, and along z in the half-spaces, over which phases turn.
    """
    edges = np.concatenate(
        [_edges(s, _corners(part, plan), (across, along), plan.finer) for part in parts if part.lo < plan.band]
    )
    starts, stops = edges[:, 0], edges[:, 1]
    g, w = np.polynomial.legendre.leggauss(plan.nodes)
    half = (stops - starts) / 2
    k = (starts + half)[:, None] + half[:, None] * g
    return Contour(k.ravel(), (half[:, None] * w).ravel() / (2 * math.pi))


def _corners(part: Stretch, plan: Plan) -> list[complex]:
    """Where a stretch's contour turns: from the axis out, along it, and back, or on to the band's end if the stretch goes so far."""
    last, hi = part.hi >= plan.band, min(part.hi, plan.band)
    room = hi - part.lo if last else (hi - part.lo) / 2
    away = min(plan.height if part.side > 0 else plan.depth, 0.95 * room * plan.slope)
    turn, lift = away / plan.slope, 1j * part.side * away
    corners = [part.lo + 0j, part.lo + turn + lift]
    return [*corners, hi + lift] if last else [*corners, hi - turn + lift, hi + 0j]


def _edges(s: SampledSlab, corners: list[complex], lengths: tuple[float, float], finer: float) -> np.ndarray:
    """Ends of the panels along the straight pieces of a stretch, (panels, 2)."""
    across, along = lengths
    out = [_graded(corners[0], corners[1], s.k0), _even(corners[1], corners[2], FLAT)]
    if len(corners) == 4:
        out.append(_graded(corners[3], corners[2], s.k0)[::-1, ::-1])
    edges = np.concatenate(out)
    length, middle = np.abs(edges[:, 1] - edges[:, 0]), edges.mean(axis=1)
    steep = np.max([np.abs(middle / np.sqrt(b * b - middle * middle)) for b in s.branch_points], axis=0)  # |dkz/dkx|
    pieces = np.ceil(finer * np.maximum(1.0, length * (across + along * steep) / TURN)).astype(int)
    shares = [np.linspace(a, b, n + 1) for (a, b), n in zip(edges, pieces, strict=True)]
    return np.concatenate([np.stack([v[:-1], v[1:]], axis=1) for v in shares])


def _graded(end: complex, corner: complex, k0: float) -> np.ndarray:
    """Panels from an end on the axis outward, each longer than the one before."""
    count = max(2, math.ceil(math.log(abs(corner - end) / (SHORTEST * k0), RATIO)))
    share = np.concatenate([[0.0], RATIO ** -np.arange(count, -1.0, -1.0)])
    at = end + share * (corner - end)
    return np.stack([at[:-1], at[1:]], axis=1)


def _even(start: complex, stop: complex, flat: float) -> np.ndarray:
    """Equal panels, no longer than a share of their distance from the axis."""
    count = max(1, math.ceil(abs(stop - start) / (flat * abs(start.imag))))
    at = np.linspace(start, stop, count + 1)
    return np.stack([at[:-1], at[1:]], axis=1)


def pair_of_contours(
    s: SampledSlab,
    extent: Extent,
    plan: Plan,
    start: float,
    crowded: bool,
    ends: np.ndarray = NO_ENDS,
    closed: bool = False,
) -> tuple[Contour, Contour] | None:
    """A contour in stretches and another to estimate its error by, circles around what they leave on the wrong side.

    Parameters
    ----------
    s : SampledSlab
    extent : Extent
    plan : Plan
    start : float
        Re kx from which poles are searched for.
    crowded : bool
        Whether the slab is periodic and guides more modes than can be found: its bands say where the contour passes.
    ends : array, rad/m
        |kx| where spectra are cut off; `closed` says whether all are, at the last of these or before.

    Returns
    -------
    pair of Line
        None where poles cannot be told apart.
    """
    end = plan.second_plan().band
    try:
        if crowded:
            bands = bands_of(s, end)
            parts, found = bands.parts, misplaced_in_gaps(s, bands, max(plan.depth, plan.height))
        else:
            found = [misplaced.misplaced(s, 1.05 * plan.depth, end, start)]
            crossing = found[0].crossing
            parts = [Stretch(0.0, crossing, -1), *([Stretch(crossing, math.inf, 1)] if crossing < end else [])]
    except TooManyModes:
        return None
    if misplaced.UNCLEAR in found:
        return None
    parts = met_at_ends(met_at_branches(s, parts), ends)
    if closed:
        parts = [part for part in parts if part.hi <= ends[-1]]
    across = extent.across
    contours = []
    for second, p in ((False, plan), (True, plan.second_plan())):
        contour = stretched_contour(s, parts, p, across, extent.path - s.thickness)
        both = [residues.add_residues(s, contour, poles, across, extent.path, second) for poles in found]
        around = sum(circled.circles for circled in both)
        k = np.concatenate([*(circled.k[: circled.circles] for circled in both), contour.k])
        weight = np.concatenate([*(circled.weight[: circled.circles] for circled in both), contour.weight])
        contours.append(Contour(k, weight, circles=around, closed=closed))
    return contours[0], contours[1]
