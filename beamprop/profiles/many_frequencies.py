"""Profiles across one plane measured at all frequencies at once.

p is sampled on the whole window of a straight contour by one small FFT a frequency; the width is found on that grid and on the
exact sum over the plane waves. A second contour of other parameters gives the error.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fft
from ..contour import near_normal, paths, sums
from ..contour.error import MARGIN, uniform_budget
from ..contour.paths import Contour, Extent, StraightPlan
from ..contour.stationary_phase import TransferToPlane, landing
from ..modes.misplaced import any_misplaced
from ..sources.rows import RowBeam, repeated, taken
from .fwhm import Evaluate, full_width
from .routes import Measures, Route, measures_of
from .windows import EDGE

#: Exponentials on an even contour are products of two tables of n/STEP and STEP entries: fewest for sqrt(n), of some 150 nodes.
STEP = 12


class PlaneWaves(NamedTuple):
    """p(x) = sum right e^{ikx} + left e^{-ikx} over even straight contours, x from the beam's centre; arrays (F, n)."""

    contour: Contour
    right: np.ndarray
    left: np.ndarray

    def evaluator(self) -> Evaluate:
        """A function of positions (F, m) -> p there, (F, m)."""
        # `response.reference.field` is the plain sum. With k = m ds - i sigma, e^{ikx} is e^{sigma x} times a power of
        # e^{i ds x}, the product of a coarse and a fine one, by which the sum is taken in two steps. What goes to the left has
        # their conjugates.
        contour, (count, n) = self.contour, self.right.shape
        coarse_size = -(-n // STEP)
        padded = np.zeros((count, 2, coarse_size * STEP), complex)
        padded[:, 0, :n], padded[:, 1, :n] = self.right, np.conj(self.left)
        by_fine = np.ascontiguousarray(padded.reshape(count, 2 * coarse_size, STEP).swapaxes(1, 2))
        sigma = np.asarray(contour.sigma)[:, None]

        def value(x: np.ndarray) -> np.ndarray:
            angle = 1j * (np.asarray(contour.step)[:, None] * x)[..., None]
            coarse = np.exp(angle * (contour.first + STEP * np.arange(coarse_size)))
            inner = np.exp(angle * np.arange(STEP)) @ by_fine
            sums = inner.reshape(*x.shape, 2, coarse_size) @ coarse[..., None]
            right, left = np.moveaxis(sums[..., 0], -1, 0)
            grow = np.exp(sigma * x)
            return np.asarray(right * grow + np.conj(left) / grow)

        return value


class _Rows(NamedTuple):
    """Routes side by side, R rows: those of the first one's frequencies, then those of the second one's."""

    k0: Any
    branch: np.ndarray  #: the nearest one
    path: np.ndarray
    plane: TransferToPlane  #: (R, n) -> (R, n)
    guided: bool  #: whether there is a slab on any way


def _side_by_side(routes: Sequence[Route]) -> _Rows:
    """All rows of routes with the same frequencies."""
    k0, branch, path = (
        np.concatenate(v) for v in zip(*((r.slab.k0, r.slab.nearest_branch, r.path) for r in routes), strict=True)
    )
    planes = [route.plane(route.slab, route.path) for route in routes]

    def plane(k: np.ndarray) -> np.ndarray:
        return np.concatenate([h(part) for h, part in zip(planes, np.split(k, len(planes)), strict=True)])

    return _Rows(k0, branch, path, plane if len(routes) > 1 else planes[0], any(route.guided for route in routes))


def _both_contours(rows: _Rows, beam: RowBeam, plan: StraightPlan) -> tuple[PlaneWaves, PlaneWaves, np.ndarray]:
    """The plane waves at the plane, on a contour and on a second one for the error, and H near kx = 0; one response for all."""
    contours = paths.straight_contour(plan), paths.straight_contour(plan.second_plan())
    k, weight = (np.concatenate([contour[i] for contour in contours], axis=-1) for i in (0, 1))
    near = [near_normal.around(np.asarray(plan.delta)[:, None] * ROUND)] if rows.guided else []
    h, h_near = np.split(rows.plane(np.concatenate([k, *near], axis=-1)), [k.shape[-1]], axis=-1)
    right, left = sums.amplitudes(Contour(k, weight), lambda k: beam.spectrum(k, rows.k0[:, None]), beam.centre)
    right, left, n = right * h, left * h, contours[0].k.shape[-1]
    first, second = (
        PlaneWaves(c, right[:, v], left[:, v]) for c, v in zip(contours, (slice(n), slice(n, None)), strict=True)
    )
    return first, second, h_near


def _plan(rows: _Rows, beam: RowBeam, middle: np.ndarray, half: np.ndarray, rtol: float) -> StraightPlan:
    lo, hi = beam.band(rows.k0, rtol * 1e-2)  # what is left out of the beam stays far below rtol
    farthest = np.abs(middle - beam.centre) + half
    extent = Extent(rows.k0, rows.branch, np.maximum(-lo, hi), farthest, beam.reach(rtol * 1e-2), rows.path)
    return paths.plan_straight(extent, rtol)


#: The most plane waves of all frequencies at a time (an array of them takes 4 MB), and of a single frequency: beyond, a bent contour,
#: measured by itself, takes fewer (experiments/benchmarks/constants.py).
MOST_TOGETHER, MOST_OF_A_FREQUENCY = 2**18, 20_000
#: Poles nearer to kx = 0 than this share of delta count about half on either side of a straight contour, whatever its delta: the share
#: chi = erfc(-k/delta)/2 of the contour for waves to the right is 0.36 to 0.64 there.
ROUND = 0.25


#: Up to so many frequencies all routes are measured side by side, for the time goes around the numbers (experiments/benchmarks/point.py);
#: more gain nothing by it.
FEW = 8


@np.errstate(over="ignore", invalid="ignore")  # rows that are not finite are not trusted
def measured_together(
    routes: Sequence[Route], beam: RowBeam, rtol: float, level: float
) -> list[tuple[Measures, np.ndarray]]:
    """Of each route measures at all frequencies, (F,) each, and which of them can be trusted, (F,).

    None can of a beam whose spectrum is not entire, or where that many plane waves are needed that a bent contour is faster. Routes
    are parted, and then frequencies halved, until their plane waves fit.
    """
    count = np.size(routes[0].slab.k0)
    if not beam.entire:
        return [_nothing(count)] * len(routes)
    if len(routes) > 1 and count > FEW:
        return _parted(routes, beam, rtol, level)
    rows, each = _side_by_side(routes), repeated(beam, len(routes))
    middle, half = landing(rows.k0, each, rows.plane, rows.path)
    plan = _plan(rows, each, middle, half, rtol)
    size = float(np.max(plan.band * plan.window)) / (2 * np.pi)
    many = rows.k0.size * min(size, MOST_OF_A_FREQUENCY) > MOST_TOGETHER
    if len(routes) > 1 and (many or size >= MOST_OF_A_FREQUENCY):
        return _parted(routes, beam, rtol, level)
    if count > 1 and many:
        (low, good_low), (high, good_high) = (
            measured_together([_taken(routes[0], part)], taken(beam, part), rtol, level)[0]
            for part in np.array_split(np.arange(count), 2)
        )
        return [(measures_of(np.concatenate([low.table, high.table], -1)), np.concatenate([good_low, good_high]))]
    if size >= MOST_OF_A_FREQUENCY:
        return [_nothing(count)]
    first, second, h_near = _both_contours(rows, each, plan)
    measures, good = _measured(first, second, plan, (middle - beam.centre, half), level, rtol)
    table = measures._replace(centroid=measures.centroid + beam.centre).table
    for route, part in zip(routes, np.split(np.arange(rows.k0.size), len(routes)), strict=True):
        if route.guided:
            calm = near_normal.is_calm(h_near[part], max(0.01 * rtol, 1e-12))[:, 0]
            good[part] &= calm & ~any_misplaced(route.slab, 1.1 * plan.sigma[part], plan.band[part])
    return [
        (measures_of(v), g) for v, g in zip(np.split(table, len(routes), -1), np.split(good, len(routes)), strict=True)
    ]


def _nothing(count: int) -> tuple[Measures, np.ndarray]:
    """No measures that can be trusted."""
    unknown = np.full(count, np.nan)
    return Measures(unknown, unknown, unknown, unknown, uniform_budget(count, np.nan)), np.zeros(count, bool)


def _parted(routes: Sequence[Route], beam: RowBeam, rtol: float, level: float) -> list[tuple[Measures, np.ndarray]]:
    """Routes one by one."""
    return [measured for route in routes for measured in measured_together([route], beam, rtol, level)]


def _taken(route: Route, rows: np.ndarray) -> Route:
    """The route at the frequencies with those indices."""
    return route._replace(slab=route.slab.take(rows), z=route.z[rows], path=route.path[rows])


def _sampled(plane_waves: PlaneWaves, plan: StraightPlan) -> tuple[np.ndarray, np.ndarray]:
    """p on an even grid over each whole window: x and p, (F, n)."""
    contour = plane_waves.contour
    m = contour.first + np.arange(contour.k.shape[-1])
    n = fft.fast_length(3 * int(np.max(np.abs(m))) + 1)
    x = plan.window[:, None] * ((np.arange(n) - n // 2) / n)
    bins = np.zeros((2, *contour.k.shape[:-1], n), complex)
    turn = np.where(m % 2, -1.0, 1.0) if n % 2 == 0 else np.exp(-2j * np.pi * m * (n // 2) / n)
    bins[0][:, m % n] = plane_waves.right * turn
    bins[1][:, -m % n] = plane_waves.left * np.conj(turn)
    right, left = fft.transform(bins)
    grow = np.exp(contour.sigma[:, None] * x)
    return x, right * grow + left / grow


def _measured(
    first: PlaneWaves,
    second: PlaneWaves,
    plan: StraightPlan,
    window: tuple[np.ndarray, np.ndarray],
    level: float,
    rtol: float,
) -> tuple[Measures, np.ndarray]:
    """Measures from the samples in windows, given by middle and half-width, and where they can be trusted."""
    x, p = _sampled(first, plan)
    middle, half = (v[:, None] for v in window)
    inside = np.abs(x - middle) <= half
    exact = first.evaluator()
    section = full_width(x, p, level, exact, inside, subsamples=0)
    peak = section.peak
    size = np.abs(p)
    ends = np.argmax(inside, axis=-1), inside.shape[-1] - 1 - np.argmax(inside[:, ::-1], axis=-1)
    largest_end = np.max([np.take_along_axis(size, end[:, None], -1)[:, 0] for end in ends], axis=0)
    good = (largest_end < EDGE * level * peak) & (peak > 0) & np.isfinite(section.width)
    check = np.stack([section.left, section.right, section.position], axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = MARGIN * np.max(np.abs(exact(check) - second.evaluator()(check)), axis=-1) / peak
        # each sample stands for a step, and those at the ends of the window for their share inside it
        power = size**2 * np.clip((half - np.abs(x - middle)) / (x[:, 1:2] - x[:, :1]) + 0.5, 0.0, 1.0)
        centroid = (power * x).sum(-1) / power.sum(-1)
    error = np.nan_to_num(error, nan=1.0)
    good &= error <= rtol
    budget = uniform_budget(error.size, 0.0)._replace(difference=error)
    return Measures(section.width, peak, centroid, section.crossings, budget), good
