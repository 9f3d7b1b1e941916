"""The lattice of real (kx, ky) on which a source's spectrum is summed, and h between the radii at which it is known.

    p(x, y) = sum S(kx, ky) h_L(|k|) exp(i kx x + i ky y) dkx dky/(2 pi)^2

is p0 * G_L, and its images in steps of 2 pi/dkx and 2 pi/dky: these lie farther off than L where the steps are fine enough.

h_L depends on |k| alone, and many points of a lattice have the same |k|: it is formed once for each of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...arrays.matmul import product
from ...sources.angles import AngleInterpolation
from .along import Along, along, real_product

#: Steps of the table of h_L, over pi/L, and positions from which it is interpolated by rtol: h_L is an entire function of type L, and
#: Lagrange's polynomial through 10, 12, 14 and 16 positions errs by 2e-9, 4e-11, 1e-12 and 3e-14 (tests/test_space_pieces.py). That is over the
#: launched |p|, which may be a hundred times the largest on a plane; a goal that is missed takes more positions at the next try.
FINE = 9
POSITIONS = ((1e-5, 10), (1e-7, 12), (1e-9, 14), (0.0, 16))

#: Radii whose weights are formed at a time, in the cache.
BLOCK = 2**11


class Table(NamedTuple):
    """Even radii, and Lagrange's polynomials through the nearest of them for each of others (u,)."""

    radii: np.ndarray  #: (t,)
    columns: np.ndarray  #: (u, q), indices of those that are used
    weights: np.ndarray  #: (u, q)

    @property
    def matrix(self) -> Any:
        """Sparse (u, t)."""
        return self._spread(self.columns, self.weights, self.radii.size)

    def by_columns(self, points: np.ndarray, groups: np.ndarray, count: int) -> Any:
        """What adds up values (p, ...) at radii `points`, in `count` groups, at the table's: sparse (t count, p)."""
        return self._spread(
            self.columns[points] * count + groups[:, None], self.weights[points], self.radii.size * count
        ).T

    @staticmethod
    def _spread(columns: np.ndarray, weights: np.ndarray, size: int) -> Any:
        from scipy.sparse import csr_array

        rows = np.arange(len(columns) + 1, dtype=columns.dtype) * columns.shape[1]
        return csr_array((weights.ravel(), columns.ravel(), rows), shape=(len(columns), size))


class Lattice(NamedTuple):
    """Real wavenumbers, h_L at which is `table` of a contour's h, carried from a table of radii."""

    kx: np.ndarray  #: (Nx,)
    ky: np.ndarray  #: (Ny,)
    area: float  #: dkx dky/(2 pi)^2
    of_point: np.ndarray  #: (Ny, Nx), index of the radius of each point, u where h_L is not needed
    table: Table  #: to u radii
    kernel: Any  #: (n, t), from the contour's nodes to the table; or a `radial.LommelSums`
    known: dict[
        float, np.ndarray
    ]  #: spectra by angle, kept for all sums on the lattice: those of arrays and pistons take longer than sums

    @property
    def by_rows(self) -> bool:
        """Whether `rows` serves it."""
        return True

    def spectra(self, k0: float, beams: AngleInterpolation) -> list[np.ndarray]:
        """S dkx dky/(2 pi)^2 of all beams of the lattice's source: (Ny, Nx) each."""
        return spectra(self, k0, beams)

    def strengths(self, k0: float, beams: AngleInterpolation) -> np.ndarray:
        """|w M| of each node at the radii of the strongest plane waves of the lattice, roughly: (n,)."""
        strongest = np.max(np.abs(self.spectra(k0, beams)), axis=0)
        at_radii = np.bincount(self.of_point.ravel(), strongest.ravel(), len(self.table.columns) + 1)
        by_radius = self.table.matrix.T @ at_radii[:-1]
        return np.asarray(np.sqrt((self.kernel.real**2 + self.kernel.imag**2) @ by_radius**2))

    def planes(self, h: np.ndarray) -> Iterator[np.ndarray]:
        """h_L at the points of the lattice for each plane of h (Z, n): (Ny, Nx) each."""
        return (values[self.of_point] for values in self.at_radii(h))

    def at_radii(self, h: np.ndarray) -> np.ndarray:
        """h_L of h (Z, n) at the radii, and 0: (Z, u + 1), to be taken at `of_point`."""
        at_table = product(h, self.kernel) if isinstance(self.kernel, np.ndarray) else self.kernel.at(h)
        columns = np.ascontiguousarray(at_table.T).view(float)  # real pairs: half the products
        out = np.zeros((len(h), len(self.table.columns) + 1), complex)
        out[:, :-1] = (self.table.matrix @ columns).view(complex).T
        return out


def spectra(grid: Any, k0: float, beams: AngleInterpolation) -> list[np.ndarray]:
    """S of all beams times the area of a grid's points: (Ny, Nx) each."""
    kx, ky = grid.kx[None, :], grid.ky[:, None]
    for angle in map(float, beams.angles):
        if angle not in grid.known:
            beam: Any = beams.at(angle)
            grid.known[angle] = grid.area * beam.spectrum_at(kx, ky, k0)
    return [grid.known[float(a)] for a in beams.angles]


def multiples(low: float, high: float, window: float) -> np.ndarray:
    """Multiples of 2 pi/window from low to high, one at least."""
    step = 2 * math.pi / window
    first = math.ceil(low / step)
    return step * np.arange(first, max(first, math.floor(high / step)) + 1)


def radii_of(
    kx: np.ndarray, ky: np.ndarray, windows: np.ndarray, ends: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """The |k| between both `ends` of the lattice's points, each once, (u,); and their indices for all points, u outside, (Ny, Nx).

    Points that are mirrored at an axis have the same |k|, and where both windows are equal all those with the same nx^2 + ny^2.
    """
    nx, ny = (np.abs(np.rint(k * w / (2 * math.pi)).astype(int)) for k, w in zip((kx, ky), windows, strict=True))
    if windows[0] == windows[1]:
        key = nx**2 + ny[:, None] ** 2
        size = 2 * math.pi / windows[0] * np.sqrt(np.arange(key.max() + 1))
    else:
        columns = int(nx.max()) + 1
        key = nx + columns * ny[:, None]
        along_x, along_y = (2 * math.pi / w * np.arange(n.max() + 1) for w, n in zip(windows, (nx, ny), strict=True))
        size = np.hypot(along_x, along_y[:, None]).ravel()
    needed = np.zeros(size.size, bool)
    needed[key] = True
    needed &= (size >= ends[0]) & (size <= ends[1])
    index = np.where(needed, np.cumsum(needed) - 1, np.count_nonzero(needed))
    return size[needed], index[key]


def interpolation(radii: np.ndarray, step: float, positions: int) -> Table:
    """Even positions by `step`, and Lagrange's polynomials through so many nearest ones of each radius."""
    base = np.floor(radii / step).astype(np.int32) - positions // 2 + 1
    whole, weights = np.arange(positions, dtype=np.int32), np.empty((radii.size, positions))
    scale = [
        (-1) ** (positions - 1 - j) * math.factorial(j) * math.factorial(positions - 1 - j) for j in range(positions)
    ]
    for start in range(0, radii.size, BLOCK):
        part = slice(start, start + BLOCK)
        differences = radii[part] / step - base[part] - whole[:, None]
        products = np.ones(differences.shape)
        np.cumprod(differences[:-1], axis=0, out=products[1:])
        products[:-1] *= np.cumprod(differences[:0:-1], axis=0)[::-1]
        weights[part] = (products / np.array(scale, float)[:, None]).T
    first, last = int(base.min(initial=0)), int(base.max(initial=0))
    nodes = step * (first + np.arange(last - first + positions))
    return Table(nodes, (base - first)[:, None] + whole, weights)


def positions_for(rtol: float) -> int:
    """How many positions the table is interpolated from."""
    return next(count for above, count in POSITIONS if rtol >= above)


def fields(
    lattice: Any, spectra: list[np.ndarray], h: np.ndarray, x: np.ndarray, y: np.ndarray, out: np.ndarray
) -> None:
    """p of all beams on the planes of h (Z, n), at every (y, x), into out (B, Z, Y, X): two matrix products a plane."""
    over_x, over_y = along(lattice.kx, x), along(lattice.ky, y)
    for i, plane in enumerate(lattice.planes(h)):
        for spectrum, into in zip(spectra, out[:, i], strict=True):
            _plane(spectrum * plane, over_x, over_y, into)


def _plane(waves: np.ndarray, over_x: Along, over_y: Along, into: np.ndarray) -> None:
    """p(y, x) of plane waves (Ny, Nx): the sum that lessens them more comes first."""
    (Y, Ny), (X, Nx) = over_y.shape, over_x.shape
    if Nx * X * Ny + Ny * Y * X <= Ny * Y * Nx + Nx * X * Y:
        over_y.sum(np.ascontiguousarray(over_x.sum(np.ascontiguousarray(waves.T)).T), into)
    else:
        into[...] = over_x.sum(np.ascontiguousarray(over_y.sum(waves).T)).T


def rows(
    lattice: Lattice, spectra: list[np.ndarray], h: np.ndarray, x: np.ndarray, y: np.ndarray, out: np.ndarray
) -> None:
    """What `fields` gives, by rows: at each y the lattice is summed over ky once for all planes."""
    over_x, few = along(lattice.kx, x), len(h) < len(lattice.kernel)
    left = np.ascontiguousarray((product(h, lattice.kernel) if few else lattice.kernel).T)
    for spectrum, beam in zip(spectra, out, strict=True):
        for j, at in enumerate(y):
            carried = np.ascontiguousarray(_over_ky(lattice, spectrum, float(at)).T)
            waves = product(carried, left) if np.iscomplexobj(carried) else real_product(carried, left)
            summed = over_x.sum(waves).T
            beam[:, j] = summed if few else product(h, summed)


def _over_ky(lattice: Lattice, spectrum: np.ndarray, y: float) -> np.ndarray:
    """What makes plane waves along x of a table of h_L, as table @ it: (t, Nx), real where waves of +-ky add to that."""
    waves, columns = spectrum * np.exp(1j * lattice.ky * y)[:, None], lattice.kx.size
    distinct, at = np.unique(np.abs(lattice.ky), return_inverse=True)
    folded, of_point = np.zeros((distinct.size, columns), complex), np.empty((distinct.size, columns), int)
    of_point[at] = lattice.of_point
    for side in (lattice.ky >= 0, lattice.ky < 0):
        folded[at[side]] += waves[side]
    inside = np.flatnonzero(of_point < len(lattice.table.columns))
    carried = lattice.table.by_columns(of_point.ravel()[inside], inside % columns, columns)
    of_table = folded.ravel()[inside]
    if not of_table.imag.any():
        return np.asarray(carried @ of_table.real).reshape(-1, columns)
    summed = carried @ of_table.view(float).reshape(-1, 2)
    return np.ascontiguousarray(summed).view(complex).reshape(-1, columns)
