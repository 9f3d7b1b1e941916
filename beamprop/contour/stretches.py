"""Contours that pass below some stretches of the kx axis and above others.

A contour below the right half of the axis serves where all waves are forward ones. Two kinds of slabs need a different contour:

* A half-space behind that carries backward waves has its branch point on or below the axis, with a cut that leads downward.
  The contour comes up to the axis there, passes over the branch point and may go down again.
* A slab of very many periods without loss guides more modes than can be located singly. They fill the bands |T| < 1, T being half
  the trace of its cell's matrix. A relative loss e (density + i e |density|, 1/modulus likewise) moves a mode by
  -i e (dT/de)/(dT/dkx), to the same side throughout a stretch of kx. The contour passes above the stretches where modes move down.

Between stretches the contour meets the axis, in a branch point or where modes crowd. The integrand is bounded there: the
piece that is left out between the axis and the nearest panel contributes as the 3/2 power of its length.
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
from .paths import EPS, SLOPE, Contour, Extent
from .search import Search


class Stretch(NamedTuple):
    """The axis from lo to hi; side is -1 if the contour passes below it and +1 if it passes above."""

    lo: float
    hi: float
    side: int


class Plan(NamedTuple):
    """The numbers of a contour in stretches."""

    depth: float  #: below the axis
    height: float  #: above the axis, where waves grow along z
    slope: float  #: d Im kx / d Re kx where it leaves the axis
    band: float  #: Re kx of its end
    finer: float = 1.0  #: factor by which there are more panels than in the first plan
    nodes: int = 20  #: Gauss nodes of a panel
    closed: bool = False  #: whether the contour ends where the last spectrum does: see `Contour`

    def second_plan(self) -> Plan:
        """A plan to estimate this one's error by: lower, wider, of shorter panels with more nodes."""
        return self._replace(
            depth=self.depth * 0.83,
            height=self.height * 0.8,
            slope=self.slope * 0.8,
            band=self.band * 1.12,
            finer=self.finer * 1.15,
            nodes=self.nodes + 3,
        )


def plan_stretches(extent: Extent, outside: float, rtol: float, noise: float) -> Plan:
    """A first plan. `outside` is the distance along z in the half-spaces; `noise` the relative rounding of S h.

    exp(depth X) magnifies rounding, as does exp(height outside) above the axis, where waves in the half-spaces grow. The exponents are
    at most 6 and 2, so that the factors together stay below e^8 (`paths.DEEPEST`); the slope of 0.6 is that of a bent contour.
    """
    growth = min(max(1.5, math.log(rtol / (30 * max(noise, 2 * EPS)))), 6.0)
    depth = min(SLOPE * extent.k0, growth / extent.across)
    return Plan(depth, min(depth, growth / 3 / max(outside, 1e-3 / extent.k0)), 0.6, extent.band)


# --- which side -------------------------------------------------------------------------------------------

#: Samples along the axis that locate bands: evenly spaced, and 1000 a decade from k0/1000 to k0. A band narrower than a 60 000th of the
#: contour's band is missed, which the difference of two contours shows; twice as many take twice 30 ms.
SAMPLES, DECADES = 60_000, 3000
#: Relative imaginary step of derivatives: they are right to STEP^2 = 1e-14, for nothing is subtracted.
STEP = 1e-7
#: Derivatives of half the trace below this, some 5000 EPS, are rounding of the sum over a cell's layers.
UNSEEN = 1e-12


class Bands(NamedTuple):
    """The axis from 0 to the band's end for a periodic slab: the side to which a little loss moves its modes."""

    parts: list[Stretch]
    gaps: list[tuple[float, float]]  #: without modes of the cell; a face of the slab may have some


def bands_of(s: SampledSlab, end: float) -> Bands:
    """The bands of a periodic slab, by derivatives of half the trace: its imaginary parts at complex kx and densities.

    The side changes in the middle of a gap.
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
    borders = np.flatnonzero(np.diff(inside))  # a gap is at least two samples wide
    runs = np.split(np.arange(k.size), borders + 1)
    gaps = [(float(k[run[0]]), float(k[run[-1]])) for run in runs if not inside[run[0]] and run.size > 1]
    side = (np.sign(by_k) * np.sign(by_loss)).astype(int)[at]
    change = np.flatnonzero(np.diff(side))
    ends = [0.0, *((k[at[change]] + k[at[change + 1]]) / 2), end]
    sides = zip(itertools.pairwise(ends), [*side[change], side[-1]], strict=True)
    return Bands([Stretch(float(lo), float(hi), int(v)) for (lo, hi), v in sides], gaps)


def misplaced_in_gaps(s: SampledSlab, bands: Bands, away: float) -> list[MisplacedPoles]:
    """Modes of the slab's faces in the gaps, no farther than `away` from the axis, on the wrong side of the contour.

    First those that belong below a contour below the axis, then those that belong above a contour above it.
    """
    modes: dict[int, list[Mode]] = {-1: [], 1: []}
    at = sorted(float(abs(b.real)) for b in s.branch_points)
    cuts = [b * (1 + side * BESIDE) for b in at for side in (-1, 1)]
    for lo, hi in bands.gaps:
        ends = sorted({lo, hi, *(v for v in (*cuts, *(part.lo for part in bands.parts)) if lo < v < hi)})
        for left, right in itertools.pairwise(ends):
            if right - left > 3 * BESIDE * right:
                side = next(part.side for part in bands.parts if part.lo <= (left + right) / 2 <= part.hi)
                here = misplaced.modes_in(s, Box(left, right, -away, away), _without_growth)
                modes[side] += [mode._replace(direction=-side * mode.direction) for mode in here]
    above, below = (misplaced.with_discs(s, modes[side], of=_without_growth) for side in (1, -1))
    return [below, above._replace(crossing=0.0)]


def _without_growth(s: SampledSlab, loss: float) -> Dispersion:
    """D of a periodic slab with loss added, divided by the growth of Bloch waves across it, which is analytic without zeros in a gap.

    D of very many periods winds around 0 with that growth on any outline off the axis. The quotient winds with the modes of the
    faces alone.
    """
    lossy, f = s.with_loss(loss), dispersion_of(s, loss)

    def evaluate(kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = f(kx)
        return value, log + 1j * lossy.bloch_phase_across(kx)[0]

    return evaluate


def met_at_branches(s: SampledSlab, parts: list[Stretch]) -> list[Stretch]:
    """Stretches cut at the branch points that lie on the wrong side of the axis, or on it."""
    for b in s.branch_points:
        point, side = complex(on_the_right(b)), 1 if b.real < 0 else -1  # the side on which the contour may pass it
        if point.real > abs(point.imag):
            parts = [piece for part in parts for piece in _cut(part, point.real, side)]
    return parts


def _cut(part: Stretch, at: float, side: int = 0) -> list[Stretch]:
    lo, hi, own = part
    return [Stretch(lo, at, own), Stretch(at, hi, own)] if lo < at < hi and own != side else [part]


def met_at_ends(parts: list[Stretch], ends: np.ndarray) -> list[Stretch]:
    """Stretches cut where spectra end. A spectrum is analytic up to its end, which is defined on the axis.

    A contour that ended off the axis would lack the piece from there up to the axis, which is as large as the integrand.
    """
    for end in ends:
        parts = [piece for part in parts for piece in _cut(part, float(end))]
    return parts


# --- the contour ------------------------------------------------------------------------------------------

#: Panels towards an end on the axis shorten by this ratio: the end is 3.9 half-lengths from their middles, and n Gauss nodes err by
#: 7.6^-2n. The piece that is left out, SHORTEST over k0, contributes 1e-15.
RATIO, SHORTEST = 1.7, 1e-10
#: Length of a panel over its distance from the axis: poles there are 1.7 half-lengths off, and n Gauss nodes err by 3.6^-2n. And phase
#: over a panel [rad], which 20 nodes integrate to rounding (J_40(4.5)). Both leave room for poles between the contour and the axis.
FLAT, TURN = 1.2, 9.0


def stretched_contour(s: SampledSlab, parts: list[Stretch], plan: Plan, across: float, along: float) -> Contour:
    """Gauss panels along a contour.

    Parameters
    ----------
    s : SampledSlab
    parts : list of Stretch
        From 0, without gaps; the last goes on to the band's end, off the axis.
    plan : Plan
    across, along : float, m
        Distances along x, and along z in the half-spaces, of the farthest points.
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
    """Corners of a stretch's contour: away from the axis, along it, and back or on to the band's end."""
    last, hi = part.hi >= plan.band, min(part.hi, plan.band)
    room = hi - part.lo if last else (hi - part.lo) / 2
    away = min(plan.height if part.side > 0 else plan.depth, 0.95 * room * plan.slope)  # a piece along the axis is left
    turn, lift = away / plan.slope, 1j * part.side * away
    corners = [part.lo + 0j, part.lo + turn + lift]
    return [*corners, hi + lift] if last else [*corners, hi - turn + lift, hi + 0j]


def _edges(s: SampledSlab, corners: list[complex], lengths: tuple[float, float], finer: float) -> np.ndarray:
    """Ends of the panels along the straight pieces of a stretch, (panels, 2)."""
    across, along = lengths
    out = [_graded(corners[0], corners[1], s.k0), _even(corners[1], corners[2])]
    if len(corners) == 4:
        out.append(_graded(corners[3], corners[2], s.k0)[::-1, ::-1])
    edges = np.concatenate(out)
    length, middle = np.abs(edges[:, 1] - edges[:, 0]), edges.mean(axis=1)
    steep = np.max([np.abs(middle / np.sqrt(b * b - middle * middle)) for b in s.branch_points], axis=0)  # |dkz/dkx|
    pieces = np.ceil(finer * np.maximum(1.0, length * (across + along * steep) / TURN)).astype(int)
    shares = [np.linspace(a, b, n + 1) for (a, b), n in zip(edges, pieces, strict=True)]
    return np.concatenate([np.stack([v[:-1], v[1:]], axis=1) for v in shares])


def _graded(end: complex, corner: complex, k0: float) -> np.ndarray:
    """Panels from an end on the axis outward, each RATIO times as long as the one before."""
    count = max(2, math.ceil(math.log(abs(corner - end) / (SHORTEST * k0), RATIO)))
    share = np.concatenate([[0.0], RATIO ** -np.arange(count, -1.0, -1.0)])
    at = end + share * (corner - end)
    return np.stack([at[:-1], at[1:]], axis=1)


def _even(start: complex, stop: complex) -> np.ndarray:
    """Equal panels along the axis, no longer than FLAT times their distance from it."""
    count = max(1, math.ceil(abs(stop - start) / (FLAT * abs(start.imag))))
    at = np.linspace(start, stop, count + 1)
    return np.stack([at[:-1], at[1:]], axis=1)


def pair_of_contours(search: Search, plan: Plan, crowded: bool) -> tuple[Contour, Contour] | None:
    """A contour in stretches and a second one to estimate its error by, with circles around the poles on their wrong side.

    `crowded` says whether the slab is periodic and guides more modes than can be located, so that its bands decide where the contour
    passes. None where poles cannot be separated.
    """
    s, extent, end = search.slab, search.extent, plan.second_plan().band
    try:
        if crowded:
            bands = bands_of(s, end)
            parts, wrong = bands.parts, misplaced_in_gaps(s, bands, max(plan.depth, plan.height))
        else:
            wrong = [misplaced.misplaced(s, 1.05 * plan.depth, end, search.start)]
            crossing = wrong[0].crossing
            parts = [Stretch(0.0, crossing, -1), *([Stretch(crossing, math.inf, 1)] if crossing < end else [])]
    except TooManyModes:
        return None
    if misplaced.UNCLEAR in wrong:
        return None
    parts = met_at_ends(met_at_branches(s, parts), search.ends)
    if plan.closed:
        parts = [part for part in parts if part.hi <= search.ends[-1]]
    contours = []
    for second, p in ((False, plan), (True, plan.second_plan())):
        contour = stretched_contour(s, parts, p, extent.across, extent.path - s.thickness)._replace(closed=plan.closed)
        contours.append(residues.add_residues(s, contour, wrong, extent, second))
    return contours[0], contours[1]
