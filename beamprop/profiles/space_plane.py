"""p(x, y) of a beam in three dimensions across one plane, as the plane waves of a lattice, in windows that grow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from .. import memory
from ..contour import summed
from ..contour.error import ErrorBudget, uniform_budget
from ..contour.space.choose import choose_in_space
from ..contour.stationary_phase import BRIGHT, shifts
from ..fields.in_space import driven_by
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import single
from ..sources.in_space import has_edge, unit_vector
from ..sources.sum_in_space import SumInSpace, parts_of
from .windows import EDGE, FAINT

#: A window is doubled along an axis while it does not hold what is measured, up to so many times, and while its lattice has no more points
#: than this: the next has up to four times as many, a second or so.
DOUBLINGS, MOST_POINTS = 5, 100_000
#: An axis on whose ends |p| is above this share of the largest is widened before one that has its tails alone left outside: all widths by a
#: level, down to 1/e, are known below it.
LEVELS = EDGE * math.exp(-1)
#: Rays in each direction by which the first window is chosen, and how far in front of grazing they end [k0].
RAYS, GRAZING = 41, 0.98
#: Positions of a grid for each turn of |p|^2 along it: three for each of |p|, which is sampled finely enough for its maxima to show.
FINER = 3
#: Values of exponentials that are held at a time: 64 MB.
BLOCK = 4_000_000


class Plane(NamedTuple):
    """p = sum waves exp(i kx x + i ky y) of positions from the source's middle, and its estimated error."""

    kx: np.ndarray  #: (Nx,)
    ky: np.ndarray  #: (Ny,)
    waves: np.ndarray  #: (Ny, Nx)
    budget: ErrorBudget

    def on_grid(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """p (Y, X) by two matrix products, in the cheaper order."""
        along_y, along_x = np.exp(1j * np.outer(y, self.ky)), np.exp(1j * np.outer(self.kx, x))
        x_first, y_first = self._terms(x.size, y.size)
        product = along_y @ (self.waves @ along_x) if x_first <= y_first else (along_y @ self.waves) @ along_x
        return np.asarray(product)

    def _terms(self, along_x: int, along_y: int) -> tuple[float, float]:
        """Of both products at so many positions, x first and y first."""
        of_y, of_x = self.waves.shape
        return float(along_x) * of_y * (of_x + along_y), float(along_y) * of_x * (of_y + along_x)

    def terms(self, along_x: int, along_y: int) -> float:
        """Of the products by which p is summed at so many positions along x and y."""
        return min(self._terms(along_x, along_y))

    def along(self, axis: int, across: float) -> Callable[[np.ndarray], np.ndarray]:
        """p on the line along x (0) or y (1) at the position `across` it, as a function of positions of any shape."""
        k, of_line = (self.kx, self.ky)[axis], np.exp(1j * across * (self.ky, self.kx)[axis])
        line = of_line @ (self.waves if axis == 0 else self.waves.T)
        return lambda at: np.exp(1j * np.multiply.outer(at, k)) @ line

    def taylor(self, places: np.ndarray, order: int) -> list[np.ndarray]:
        """p and its derivatives up to an order, as p, p_x, p_y, p_xx, p_xy, p_yy, at places (P, 2): (P,) each."""
        powers = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)][: (order + 1) * (order + 2) // 2]
        out = np.empty((len(powers), len(places)), complex)
        block = max(1, BLOCK // (self.kx.size + self.ky.size))
        for start in range(0, len(places), block):
            part = slice(start, start + block)
            along_x, along_y = (np.exp(1j * np.outer(places[part, i], k)) for i, k in enumerate((self.kx, self.ky)))
            rows = [(along_y * (1j * self.ky) ** n) @ self.waves for n in range(order + 1)]
            for value, (n, m) in zip(out, powers, strict=True):
                value[part] = np.einsum("pk,pk->p", rows[m], along_x * (1j * self.kx) ** n)
        return list(out)

    @property
    def points(self) -> int:
        """Of the lattice."""
        return self.waves.size

    @property
    def ends(self) -> np.ndarray:
        """The least and largest kx, then ky: (2, 2)."""
        return np.array([[k[0], k[-1]] for k in (self.kx, self.ky)])

    @property
    def strong_ends(self) -> np.ndarray:
        """Those of the strong plane waves; 0 where there are none."""
        strong = np.abs(self.waves) > FAINT * np.abs(self.waves).max()
        strongest = [k[strong.any(axis=i)] for i, k in enumerate((self.kx, self.ky))]
        return np.array([[k.min(initial=math.inf), k.max(initial=-math.inf)] for k in strongest])


class PlaneOfSum(NamedTuple):
    """p of a weighted sum of planes, each of positions from a place of its own, (2,) m; it serves as `Plane` does."""

    planes: tuple[Plane, ...]
    weights: tuple[complex, ...]
    at: tuple[np.ndarray, ...]
    budget: ErrorBudget

    def of_each(self, x: np.ndarray, y: np.ndarray) -> Iterator[np.ndarray]:
        """The weighted p (Y, X) of each plane."""
        for plane, weight, at in self._each:
            yield weight * plane.on_grid(x - at[0], y - at[1])

    def on_grid(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """p (Y, X)."""
        return np.asarray(sum(self.of_each(x, y)))

    def along(self, axis: int, across: float) -> Callable[[np.ndarray], np.ndarray]:
        """See `Plane.along`."""
        lines = [
            (plane.along(axis, across - float(at[1 - axis])), weight, float(at[axis]))
            for plane, weight, at in self._each
        ]
        return lambda places: np.asarray(sum(weight * line(places - start) for line, weight, start in lines))

    def taylor(self, places: np.ndarray, order: int) -> list[np.ndarray]:
        """See `Plane.taylor`."""
        each = (weight * np.array(plane.taylor(places - at, order)) for plane, weight, at in self._each)
        return list(np.asarray(sum(each)))

    def terms(self, along_x: int, along_y: int) -> float:
        """See `Plane.terms`."""
        return sum(plane.terms(along_x, along_y) for plane in self.planes)

    @property
    def _each(self) -> Iterator[tuple[Plane, complex, np.ndarray]]:
        return zip(self.planes, self.weights, self.at, strict=True)

    @property
    def points(self) -> int:
        """Of the largest lattice."""
        return max(plane.points for plane in self.planes)

    @property
    def ends(self) -> np.ndarray:
        """Around those of all planes."""
        return _around([plane.ends for plane in self.planes])

    @property
    def strong_ends(self) -> np.ndarray:
        """Around those of all planes."""
        return _around([plane.strong_ends for plane in self.planes])


def _around(ends: list[np.ndarray]) -> np.ndarray:
    low, high = np.moveaxis(np.array(ends), -1, 0)
    return np.stack([low.min(axis=0), high.max(axis=0)], axis=1)


class Way(NamedTuple):
    """How a source gets to the plane across which it is measured."""

    transfer: Callable[[float], TransferFunction]  #: H of a launch plane's z0
    z: float

    def of(self, source: Any) -> TransferFunction:
        """H of what drives a source."""
        return driven_by(source, self.transfer(source.z0))


class Window(NamedTuple):
    """A rectangle, from the source's middle: (2,) each [m]."""

    middle: np.ndarray
    half: np.ndarray
    chosen: bool = False  #: by the user


def _plane_of(s: SampledSlab, source: Any, way: Way, window: Window, rtol: float) -> Plane:
    """p of a single source across a plane on a contour that serves a window."""
    grid = tuple(m + h * np.linspace(-1, 1, 33) for m, h in zip(window.middle, window.half, strict=True))
    beams, planes, transfer = single(source), np.array([way.z]), way.of(source)
    quadrature = choose_in_space(s, beams, transfer, (grid[0], grid[1]), planes, rtol)
    contour = quadrature.contour
    lattice = contour.lattice
    (waves,) = lattice.planes(transfer(contour.k, planes))
    return Plane(lattice.kx, lattice.ky, waves * lattice.spectra(s.k0, beams)[0], quadrature.budget)


class Sampled(NamedTuple):
    """A plane, and p on a grid of a window."""

    plane: Plane | PlaneOfSum
    x: np.ndarray  #: (X,)
    y: np.ndarray  #: (Y,)
    p: np.ndarray  #: (Y, X)

    @property
    def rim(self) -> float:
        """The largest |p| on the window's rim over that inside; 0 where nothing arrives."""
        return float(self.rims.max())

    @property
    def rims(self) -> np.ndarray:
        """Those on the ends along x, and along y: (2,)."""
        size = np.abs(self.p)
        ends = np.array([size[:, [0, -1]].max(), size[[0, -1]].max()])
        return ends / size.max() if ends.any() else np.zeros(2)


def sampled(s: SampledSlab, source: Any, way: Way, window: Window, rtol: float) -> Sampled:
    """p across the plane of a way on a grid of a window that shows its maxima.

    A sum of sources has a plane for each, whose errors are added over the largest |p| of the sum; where they cancel,
    with a lower rtol.
    """
    if not isinstance(source, SumInSpace):
        plane = _plane_of(s, source, way, window, rtol)
        x, y = _grid(plane, window)
        return Sampled(plane, x, y, plane.on_grid(x, y))
    bright, wider = landing(s, source, way), None
    if np.any(np.abs(bright.middle - window.middle) + bright.half > window.half * (1 + 1e-9)):
        # the sources may be brightest outside of a window that was chosen
        wider = _sum_in(s, source, way, _joined([bright, window]), max(summed.ROUGH, rtol))[1]
    made_with = rtol
    while True:
        profile, scales, budgets = _sum_in(s, source, way, window, made_with)
        budget = summed.added(budgets, scales if wider is None else scales.larger(wider))
        lower = summed.lower_rtol(float(budget.total.max()), rtol, made_with)
        if lower is None:
            return profile._replace(plane=profile.plane._replace(budget=budget))
        made_with = lower


def _sum_in(
    s: SampledSlab, source: SumInSpace, way: Way, window: Window, rtol: float
) -> tuple[Sampled, summed.Scales, list[ErrorBudget]]:
    """p of a sum in a window, and the budgets of its sources."""
    moved = [window._replace(middle=window.middle - part.at) for part in source.parts]
    planes = [_plane_of(s, part.source, way, own, rtol) for part, own in zip(source.parts, moved, strict=True)]
    _, weights, at = zip(*source.parts, strict=True)
    plane = PlaneOfSum(tuple(planes), weights, at, uniform_budget(1, np.nan))
    x, y = _grid(plane, window)
    p, largest = np.zeros((y.size, x.size), complex), []
    for field in plane.of_each(x, y):
        p += field
        largest.append(np.abs(field).max())
    scales = summed.Scales(np.abs(p).max().reshape(1, 1), np.reshape(largest, (-1, 1, 1)))
    return Sampled(plane, x, y, p), scales, [each.budget for each in planes]


def _grid(plane: Plane | PlaneOfSum, window: Window) -> tuple[np.ndarray, np.ndarray]:
    """Positions of a window, even along x and y, on which |p|^2 shows its maxima."""
    low, high = plane.strong_ends.T
    steps = 2 * math.pi / (FINER * np.maximum(high - low, 1e-9))
    x, y = (
        m + h * np.linspace(-1, 1, 2 * max(48, math.ceil(h / step)) + 1)
        for m, h, step in zip(window.middle, window.half, steps, strict=True)
    )
    memory.check_products(plane.terms(x.size, y.size), plane.points, x.size * y.size, window.chosen)
    return x, y


def widened(s: SampledSlab, source: Any, way: Way, rtol: float, rim: float) -> Sampled:
    """p across the plane of a way, in the first of ever wider windows on whose rim |p| is below `rim` of the largest.

    They lie about where the source lands, and widen along the axes that need it: those of a line of elements across it, where each element's
    waves spread.
    """
    window = landing(s, source, way)
    doublings = np.zeros(2, int)
    while True:
        profile = sampled(s, source, way, window, rtol)
        wider = (profile.rims >= rim) & (doublings < DOUBLINGS)
        urgent = wider & (profile.rims >= LEVELS)
        wider = urgent if urgent.any() else wider
        # one axis alone doubles the lattice at first
        if not wider.any() or profile.plane.points > MOST_POINTS * (2 if urgent.sum() == 1 else 1):
            return profile
        doublings += wider
        window = window._replace(half=np.where(wider, 2, 1) * window.half)


def landing(s: SampledSlab, source: Any, way: Way) -> Window:
    """A window about the places where a source is bright; of a sum about those of all its sources."""
    return _joined(
        [
            own._replace(middle=own.middle + part.at)
            for part in parts_of(source)
            for own in [_landing(s, part.source, way.of(part.source), way.z)]
        ]
    )


def _joined(windows: list[Window]) -> Window:
    """The window around several."""
    if len(windows) == 1:
        return windows[0]
    low, high = (
        np.min([w.middle - w.half for w in windows], axis=0),
        np.max([w.middle + w.half for w in windows], axis=0),
    )
    return Window((low + high) / 2, (high - low) / 2)


def _landing(s: SampledSlab, source: Any, transfer: TransferFunction, z: float) -> Window:
    """A window about the places where a single source is bright, by stationary phase.

    H depends on |k| alone, so that a plane wave is carried along its own (kx, ky), by D = -d(arg H)/d|k|. |p| there is |S H| over the root of how
    far rays part, along and across the plane wave: dD/d|k| and D/|k|.
    """
    low, high = np.clip(_strong_box(source, s.k0), -GRAZING * s.k0, GRAZING * s.k0).T
    kx, ky = (np.linspace(a, b, RAYS) for a, b in zip(low, high, strict=True))
    k = np.hypot(kx, ky[:, None])
    radii, step = np.linspace(max(k.min(), 1e-3 * s.k0), max(k.max(), 2e-3 * s.k0), 4 * RAYS), 1e-4 * s.k0
    h = transfer(np.concatenate([radii - step, radii + step]).astype(complex), np.array([z]))[0]
    carried, strength = shifts(h[: radii.size], h[radii.size :], step)
    own = source.reach(0.1) ** 2
    parts = (np.abs(v) + own for v in (np.gradient(carried, radii), carried / radii))
    brightness = np.abs(source.spectrum_at(kx[None, :], ky[:, None], s.k0)) * np.interp(
        k, radii, np.nan_to_num(strength / np.sqrt(math.prod(parts)))
    )
    bright = brightness > BRIGHT * brightness.max()
    share = np.interp(k, radii, np.nan_to_num(carried)) / np.maximum(k, radii[0])
    places = np.stack([(share * of)[bright] for of in (kx[None, :], ky[:, None])])
    if not places.size:
        places = np.zeros((2, 1))
    least, most = places.min(axis=1), places.max(axis=1)
    reach = np.array(source.half_widths(1e-2))
    return Window((least + most) / 2, 1.5 * reach + 2 * math.pi / s.k0 + (most - least) / 2)


def _strong_box(source: Any, k0: float) -> np.ndarray:
    """The least and largest kx, then ky, of the strong plane waves; of a spectrum without end those of its main lobe."""
    if not has_edge(source):
        return np.asarray(source.box(k0, 0.3))
    low, high = source.band(k0, 0.3)
    middle = (low + high) / 2 * np.array(unit_vector(source.azimuth))
    return np.stack([middle - (high - low) / 2, middle + (high - low) / 2], axis=1)
