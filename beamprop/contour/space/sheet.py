"""Positions in the plane (x, y) at which contours of beams in space are compared, and the contours that serve them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...response.transfer_function import TransferFunction
from ...sources.angles import AngleInterpolation
from ...sources.in_space import mean_size, unit_vector
from .. import paths, peak_outside
from ..check_points import Amplitudes, Checks
from ..paths import BentPlan, Contour
from ..residues import add_residues
from ..search import Planned, Search
from ..survey import Rays
from . import lattice, radial
from .differences import MOST_POINTS as MOST_DIFFERENCES
from .differences import Axis, axis, differences
from .lattice import Lattice

#: Tolerance over rtol with which source and spectrum are cut off, and that of the second contour: both show in their difference. A beam
#: that has spread, or that little of has passed, needs less: it falls with this power of the window over the first one, which is widened
#: where the error is too large.
CUT, SECOND_CUT, POWER = 1e-3, 1e-5, 12
#: What sets a second contour apart beside `BentPlan.second_plan`: the distance L, the lattice's windows, the width of the filter.
FARTHER, WIDER, SOFTER = 1.03, 1.06, 1.25
#: Of the filter's fall, u = sqrt(ln(10/rtol)) widths on either side of its middle, the part inside the band: there S has fallen already.
INSIDE = 0.3
#: The most points of a lattice: 8 or 16 bytes each for six arrays.
MOST_POINTS = 4_000_000
#: A lattice of so many points gives way to a grid of differences where positions lie aside.
WORTH_IT = 100_000
#: Positions lie aside where their gap to the source is so many times as wide as both, and so many radians: the scale is looked for apart then.
ASIDE, GAP = 2.0, 200.0


def fall(rtol: float) -> float:
    """Widths from the filter's middle to where it is rtol/10 from 1 or 0."""
    return math.sqrt(math.log(10 / rtol))


class Spectrum(NamedTuple):
    """Where the spectra of all beams lie, at a tolerance."""

    box: np.ndarray  #: (2, 2): least and largest kx, then ky
    low: float  #: least and largest |k|
    high: float

    def wider(self, more: float) -> Spectrum:
        """Around the same middle; the spectrum of a sharp edge has no end."""
        if more == 1 or not np.isfinite(self.box).all():
            return self
        middle, half = self.box.mean(axis=1), np.ptp(self.box, axis=1) / 2
        box = np.stack([middle - more * half, middle + more * half], axis=1)
        return Spectrum(box, 0.0, more * self.high)


def spectrum_of(sources: AngleInterpolation, k0: float, tolerance: float) -> Spectrum:
    """That of the beams that are summed."""
    beams: list[Any] = [sources.at(float(a)) for a in sources.angles]
    boxes = np.stack([beam.box(k0, tolerance) for beam in beams])
    low, high = np.transpose([beam.rings(k0, tolerance) for beam in beams])
    box = np.stack([boxes[:, :, 0].min(axis=0), boxes[:, :, 1].max(axis=0)], axis=1)
    return Spectrum(box, float(low.min()), float(high.max()))


class Reached(NamedTuple):
    """What a lattice is made of."""

    spectrum: Spectrum
    windows: np.ndarray  #: 2 pi over its steps along x and y
    radius: float  #: L, at which G is cut off
    high: float  #: middle of the filter by which it ends before the spectra do, and its width, infinite without one
    softness: float

    @property
    def points(self) -> float:
        """Of the lattice."""
        return float(np.prod(np.ptp(self.spectrum.box, axis=1) * self.windows / (2 * math.pi)))


def margin_of(length: float, arriving: float, end: float, u: float) -> float:
    """How much farther out than `length` G is cut off, for a filter of the lattice beyond |k| = `arriving`; 0 where there is none.

    The source's spectrum ends at |k| = `end`, and what arrives of it before; but h_L does not, for G is cut off sharply. A filter of width
    D blurs that cut by 2u/D. The number of points is least, for a lattice (2 length + 2 margin)(arriving + 2 (1 + INSIDE) u^2/margin), at
    the root of both terms' ratio.
    """
    extra = 2 * (1 + INSIDE) * u**2
    margin = math.sqrt(length * extra / arriving)
    return margin if (length + margin) * (arriving + extra / margin) < length * end else 0.0


class Sheet(NamedTuple):
    """Positions x (X,) and y (Y,) of a grid from the source's middle: `check_points.Places`."""

    x: np.ndarray
    y: np.ndarray
    far: tuple[float, float]  #: the largest |x| and |y|, also of requested positions
    first: BentPlan | None = None  #: the first plan, over which later ones grow
    rays: Rays | None = None
    around: tuple[np.ndarray, np.ndarray] | None = (
        None  #: positions x and y about the source, where those of the grid lie aside
    )
    once: bool = (
        False  #: whether a field is summed on a contour but once: its table from nodes to the lattice is not held then
    )

    @property
    def on_a_line(self) -> bool:
        """No."""
        return False

    @property
    def across(self) -> float:
        """The largest distance."""
        return math.hypot(*self.far)

    def lengths(self, sources: AngleInterpolation, tolerance: float) -> np.ndarray:
        """The largest distances along x and y between a position and the source, (2,)."""
        beam: Any = sources.beam
        return np.array(self.far) + np.array(beam.half_widths(tolerance))

    def goal(self, rtol: float, plan: BentPlan) -> float:
        """What source, spectrum and table are to keep for a plan."""
        return rtol * min(1.0, (self.first or plan).window / plan.window) ** POWER

    def contour(self, search: Search, planned: Planned, second: bool) -> Contour:
        """Bessel's zeros on a bent contour, with weights times 2 pi k b(k), and its lattice."""
        plan, u = planned.plan.second_plan() if second else planned.plan, fall(search.rtol)
        width = plan.depth * (SOFTER if second else 1.0)
        high, low = plan.band - u * width, plan.low + u * width
        reached = self._reached(search, planned.plan, second)
        if not plan.low or low + INSIDE * u * width > reached.spectrum.low:
            plan, low = plan._replace(low=0.0), 0.0
        bent = paths.bent_contour(plan, radial.bessel_zeros)
        bent = bent._replace(falling=int(np.count_nonzero(bent.k.real > high)))
        contour = add_residues(search.slab, bent, [planned.poles], search.extent, second)
        filtered = radial.passed(contour.k, low, high, width)
        contour = contour._replace(weight=2 * math.pi * contour.k * filtered * contour.weight)
        axes = self._grid(search, planned.plan, reached, second)
        if axes is not None:
            return contour._replace(lattice=differences(contour.k, contour.weight, axes, plan.band))
        return contour._replace(lattice=_lattice(contour, reached, self.goal(search.rtol, planned.plan), self.once))

    def _grid(self, search: Search, plan: BentPlan, reached: Reached, second: bool) -> tuple[Axis, Axis] | None:
        """The grid of differences between positions and source, where positions lie aside and the lattice is large."""
        if self.around is None or reached.points < WORTH_IT or not np.isfinite(reached.spectrum.box).all():
            return None
        tolerance = self.goal(search.rtol, plan) * (SECOND_CUT if second else CUT)
        beam: Any = search.checks.sources.beam
        u, band = fall(search.rtol) * (SOFTER if second else 1.0), plan.second_plan().band if second else plan.band
        x, y = (
            axis(float(v.min()) - half, float(v.max()) + half, ends, band, u)
            for v, half, ends in zip((self.x, self.y), beam.half_widths(tolerance), reached.spectrum.box, strict=True)
        )
        return (x, y) if x.points * y.points <= MOST_DIFFERENCES else None

    def _reached(self, search: Search, plan: BentPlan, second: bool) -> Reached:
        """Where the spectra lie, and lengths, of a plan: wider with its band and its window than those of the first plan."""
        sources, first, u = search.checks.sources, self.first or plan, fall(search.rtol)
        tolerance = self.goal(search.rtol, plan) * (SECOND_CUT if second else CUT)
        spectrum = spectrum_of(sources, search.slab.k0, tolerance).wider(max(1.0, plan.band / first.band))
        lengths = self.lengths(sources, tolerance) * (FARTHER if second else 1.0)
        length, arriving = math.hypot(*lengths), plan.band - (1 + INSIDE) * u * plan.depth
        margin = margin_of(length, arriving, spectrum.high, u) * (SOFTER if second else 1.0)
        softness = 2 * u / margin if margin else math.inf
        end = min(spectrum.high, arriving + (1 + INSIDE) * u * softness)
        windows = (length + 2 * margin + lengths) * (WIDER if second else 1.0)
        spectrum = spectrum._replace(box=np.clip(spectrum.box, -end, end), high=end)
        return Reached(spectrum, windows, length + margin, arriving + INSIDE * u * softness, softness)

    def too_large(self, search: Search, plan: BentPlan) -> bool:
        """Whether the second contour's lattice has too many points."""
        reached = self._reached(search, plan, True)
        return not reached.points <= MOST_POINTS and self._grid(search, plan, reached, True) is None

    def amplitudes(self, k0: float, sources: AngleInterpolation, contour: Contour) -> Amplitudes:
        """Bounds of what each node adds to |p|: |w| times the mean of |S| over directions, once; (B, n) each."""
        beams: list[Any] = [sources.at(float(a)) for a in sources.angles]
        means = [mean_size(beam, contour.k.real, k0) for beam in beams]
        right = np.abs(contour.weight) * np.array(means) / (2 * np.pi)
        return right, np.zeros(right.shape)

    def fields(
        self, k0: float, beams: AngleInterpolation, contour: Contour, h: np.ndarray, amplitudes: Amplitudes
    ) -> np.ndarray:
        """See `lattice.fields`."""
        out = np.empty((beams.angles.size, h.shape[0], self.y.size, self.x.size), complex)
        lattice.fields(contour.lattice, contour.lattice.spectra(k0, beams), h, self.x, self.y, out)
        return out.reshape(*out.shape[:2], -1)

    def with_wider_look(self, search: Search, planned: Planned, checks: Checks) -> Checks:
        """Peaks where rays land, and on a rough grid far around, on two shallow contours of low accuracy that agree on them."""
        requested, sources, k0 = checks.sources.requested, checks.sources, search.slab.k0
        chosen = sources.spread(3)
        wide = self._wide(search, checks)
        beams = AngleInterpolation(sources.beam, requested[chosen])
        rough = search._replace(rtol=peak_outside.ROUGH, checks=checks._replace(sources=beams))
        length = math.hypot(*wide.lengths(sources, CUT * rough.rtol))
        plan = peak_outside.rough_plan(search, planned.plan, length)
        if plan.second_plan().nodes > peak_outside.MOST_WAVES or wide.too_large(rough, plan):
            return checks
        peaks = []
        for second in (False, True):
            contour = wide.contour(rough, planned._replace(plan=plan), second)
            with np.errstate(over="ignore", invalid="ignore"):
                h = checks.transfer(contour.k, checks.z)
                peaks.append(np.max(np.abs(wide.fields(k0, beams, contour, h, NO_AMPLITUDES)), axis=2))
        return peak_outside.with_agreed(checks, chosen, peaks)

    def _wide(self, search: Search, checks: Checks) -> Sheet:
        """Positions far around, or about the source, and where rays land."""
        reach = peak_outside.WIDER * np.array(self.far) + max(search.extent.path, 0.0)
        around = tuple(np.linspace(-1, 1, AROUND) * reach[:, None]) if self.around is None else self.around
        x, y = around if self.rays is None else landed(self.rays, checks.sources, checks.transfer, checks.z)
        x, y = (np.unique(np.concatenate([a, b])) for a, b in zip(around, (x, y), strict=True))
        return Sheet(x, y, (float(np.abs(x).max()), float(np.abs(y).max())), once=True)


def landed(
    rays: Rays, sources: AngleInterpolation, transfer: TransferFunction, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the places where the rays of three beams land on planes, in the middle and to its sides."""
    beam: Any = sources.beam
    middle, half = rays.landing(sources, transfer(rays.beside, z))
    along = (middle[..., None] + half[..., None] * np.array([-0.4, 0.0, 0.4])).ravel()
    x, y = unit_vector(beam.azimuth)
    return x * along, y * along


#: Positions along x and y of the rough grid around.
AROUND = 41
#: What `Sheet.fields` does not need.
NO_AMPLITUDES = (np.empty(0), np.empty(0))


def _lattice(contour: Contour, reached: Reached, goal: float, once: bool) -> Lattice:
    """The lattice of a contour: it ends where the source's spectrum does, or by a filter. For one sum alone its kernel is not held."""
    spectrum, windows, radius, high, softness = reached
    kx, ky = (lattice.multiples(ends[0], ends[1], float(w)) for ends, w in zip(spectrum.box, windows, strict=True))
    radii, of_point = lattice.radii_of(kx, ky, windows, (spectrum.low, spectrum.high))
    table = lattice.interpolation(radii, math.pi / (lattice.FINE * radius), lattice.positions_for(goal))
    passed = radial.passed(table.radii, 0.0, high, softness) if math.isfinite(softness) else 1.0
    kernel: Any = radial.LommelSums(contour.k, table.radii, radius, contour.weight, passed)
    if not once:
        kernel = radial.lommel(contour.k, table.radii, radius, contour.weight)
        kernel *= passed
    return Lattice(kx, ky, 1 / float(np.prod(windows)), of_point, table, kernel, {})
