"""The lattice of real (kx, ky) on which a source's spectrum is summed, and h between the radii at which it is known.

    p(x, y) = sum S(kx, ky) h_L(|k|) exp(i kx x + i ky y) dkx dky/(2 pi)^2

is p0 * G_L, and its images in steps of 2 pi/dkx and 2 pi/dky: these lie farther off than L where the steps are fine enough.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...arrays.matmul import product
from ...sources.angles import AngleInterpolation

#: Steps of the table of h_L, over pi/L, and positions from which it is interpolated by rtol: h_L is an entire function of type L, and
#: Lagrange's polynomial through 8, 10, 12 and 14 positions errs by 6e-9, 9e-11, 1e-12 and 2e-14 (tests/test_space_pieces.py). That is over the
#: launched |p|, which may be a hundred times the largest on a plane; a goal that is missed takes more positions at the next try.
FINE = 12
POSITIONS = ((1e-5, 8), (1e-7, 10), (1e-9, 12), (0.0, 14))


class Lattice(NamedTuple):
    """Real wavenumbers, h_L at which is `table` of a contour's h, carried from a table of radii."""

    kx: np.ndarray  #: (Nx,)
    ky: np.ndarray  #: (Ny,)
    area: float  #: dkx dky/(2 pi)^2
    inside: np.ndarray  #: indices (m,) of the points with h_L, in an array (Ny, Nx)
    carried: Any  #: sparse (m, t), from radii of the table to these points
    kernel: np.ndarray | None  #: (n, t), from the contour's nodes to the radii; None where these are the nodes

    def spectra(self, k0: float, beams: AngleInterpolation) -> np.ndarray:
        """S dkx dky/(2 pi)^2 of all beams: (B, Ny, Nx)."""
        kx, ky = self.kx[None, :], self.ky[:, None]
        return np.stack([self.area * beams.at(float(a)).spectrum_at(kx, ky, k0) for a in beams.angles])  # type: ignore[attr-defined]

    def on_lattice(self, h: np.ndarray) -> np.ndarray:
        """h_L of h (Z, n) at the points inside: (Z, m)."""
        table = h if self.kernel is None else product(h, self.kernel)
        columns = np.ascontiguousarray(table.T).view(float)  # real pairs: half the products
        return np.ascontiguousarray((self.carried @ columns).view(complex).T)


def multiples(low: float, high: float, window: float) -> np.ndarray:
    """Multiples of 2 pi/window from low to high, one at least."""
    step = 2 * math.pi / window
    first = math.ceil(low / step)
    return step * np.arange(first, max(first, math.floor(high / step)) + 1)


def radii_inside(kx: np.ndarray, ky: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the lattice's points with low <= |k| <= high, and their |k|: (m,) each."""
    radii = np.hypot(kx[None, :], ky[:, None]).ravel()
    inside = np.flatnonzero((radii >= low) & (radii <= high))
    return inside, radii[inside]


def interpolation(radii: np.ndarray, step: float, positions: int) -> tuple[np.ndarray, Any]:
    """Even positions (t,), by `step`, and the sparse matrix (m, t) of Lagrange's polynomials through the nearest ones."""
    from scipy.sparse import csr_array

    base = np.floor(radii / step).astype(int) - positions // 2 + 1
    away = radii / step - base
    first, last = int(base.min(initial=0)), int(base.max(initial=0))
    differences = away - np.arange(positions)[:, None]
    weights = np.ones(differences.shape)
    np.cumprod(differences[:-1], axis=0, out=weights[1:])
    after = np.cumprod(differences[:0:-1], axis=0)[::-1]
    weights[:-1] *= after
    whole = np.arange(positions)
    scale = [(-1) ** (positions - 1 - j) * math.factorial(j) * math.factorial(positions - 1 - j) for j in whole]
    weights /= np.array(scale, float)[:, None]
    columns = (base - first)[:, None] + whole
    size = last - first + positions
    rows = np.arange(radii.size + 1) * positions
    matrix = csr_array((weights.T.ravel(), columns.ravel(), rows), shape=(radii.size, size))
    return step * (first + np.arange(size)), matrix


def positions_for(rtol: float) -> int:
    """How many positions the table is interpolated from."""
    return next(count for above, count in POSITIONS if rtol >= above)


def fields(lattice: Lattice, spectra: np.ndarray, h: np.ndarray, x: np.ndarray, y: np.ndarray, out: np.ndarray) -> None:
    """p of all beams on the planes of h (Z, n), at every (y, x), into out (B, Z, Y, X): two matrix products a plane."""
    along_x, along_y = np.exp(1j * np.outer(lattice.kx, x)), np.exp(1j * np.outer(y, lattice.ky))
    x_first = (
        lattice.ky.size * lattice.kx.size * (x.size - y.size) + y.size * x.size * (lattice.ky.size - lattice.kx.size)
        < 0
    )
    plane = np.zeros(lattice.ky.size * lattice.kx.size, complex)
    for i, values in enumerate(lattice.on_lattice(h)):
        plane[lattice.inside] = values
        for spectrum, into in zip(spectra, out[:, i], strict=True):
            waves = spectrum * plane.reshape(spectrum.shape)
            into[...] = along_y @ (waves @ along_x) if x_first else (along_y @ waves) @ along_x


def waves_at(lattice: Lattice, spectrum: np.ndarray, x: np.ndarray, y: float) -> np.ndarray:
    """What makes p(z, x) of h at one y, as h @ it: (n, X), summed over ky once for all planes."""
    weights = (spectrum * np.exp(1j * lattice.ky * y)[:, None]).ravel()[lattice.inside]
    table, columns = lattice.carried.shape[1], lattice.kx.size
    each = np.diff(lattice.carried.indptr)
    at = lattice.carried.indices * columns + np.repeat(lattice.inside % columns, each)
    summed = np.empty((table, columns), complex)
    for part, of in ((summed.real, weights.real), (summed.imag, weights.imag)):
        part[...] = np.bincount(at, lattice.carried.data * np.repeat(of, each), table * columns).reshape(table, columns)
    along = np.exp(1j * np.outer(lattice.kx, x))
    return product(summed, along) if lattice.kernel is None else product(product(lattice.kernel, summed), along)
