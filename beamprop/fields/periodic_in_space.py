"""p(z, y, x) of beams that repeat on a rectangular lattice: of the plane waves at 2 pi (m/Lx, n/Ly), without a contour.

h is wanted at the lattice's radii alone, of which a point and its images by signs share one.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ..arrays.matmul import product
from ..contour.choose import arriving
from ..contour.error import uniform_budget
from ..contour.paths import EPS, Contour
from ..contour.quadrature import Quadrature
from ..contour.space.lattice import multiples
from ..contour.space.sheet import spectrum_of
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation
from .evaluate import check_finite
from .periodic import FADED

#: Spectra are cut off where they are below rounding.
CUT = 1e-15
#: The most plane waves of a lattice: 16 bytes each for a few arrays.
MOST_WAVES = 4_000_000
#: A row y of all planes costs about as much as so many planes of all rows, as for the lattices of open space.
ROW_OVER_PLANE = 1.5


class Orders(NamedTuple):
    """Plane waves at all pairs of kx (Nx,) and ky (Ny,)."""

    kx: np.ndarray
    ky: np.ndarray
    area: float  #: 1/(Lx Ly)
    radii: np.ndarray  #: sqrt(kx^2 + ky^2), (n,), rising
    radius_of: np.ndarray  #: which of them a pair has, (Ny, Nx)

    def spectra(self, k0: float, beams: AngleInterpolation) -> np.ndarray:
        """S/(Lx Ly) of all beams that are summed: (B, Ny, Nx)."""
        kx, ky = self.kx[None, :], self.ky[:, None]
        each: list[Any] = [beams.at(float(a)) for a in beams.angles]
        return np.stack([self.area * beam.spectrum_at(kx, ky, k0) for beam in each])


class PeriodicWaves(NamedTuple):
    """Beams on a lattice at every (y, x): `evaluate.Waves`."""

    k0: float
    sources: AngleInterpolation
    quadrature: Quadrature
    y: np.ndarray
    x: np.ndarray
    orders: Orders

    @property
    def points(self) -> int:
        """Positions on a plane."""
        return self.x.size * self.y.size

    @property
    def searched_share(self) -> float:
        """Half: the response at all radii takes about as long as the sums."""
        return 0.5

    @property
    def across(self) -> float:
        """The largest distance from the source's middle."""
        return float(np.hypot(np.max(np.abs(self.x)), np.max(np.abs(self.y))))

    @property
    def strengths(self) -> np.ndarray:
        """The sum of |S| of the strongest beam over the plane waves of each radius: (n,)."""
        strongest = np.max(np.abs(self.orders.spectra(self.k0, self.sources)), axis=0)
        return np.bincount(self.orders.radius_of.ravel(), strongest.ravel(), self.orders.radii.size)

    def fill(self, h: np.ndarray, out: np.ndarray) -> None:
        """By rows y where there are fewer of them than planes, else by planes."""
        sources = self.sources
        by_interpolation = sources.weights is not None
        summed = np.empty((sources.angles.size, *out.shape[1:]), complex) if by_interpolation else out
        view = summed.reshape(*summed.shape[:2], self.y.size, self.x.size)
        by_rows = ROW_OVER_PLANE * self.y.size < h.shape[0]
        fill = _fill_rows if by_rows else _fill_planes
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is refused below
            for spectrum, into in zip(self.orders.spectra(self.k0, sources), view, strict=True):
                fill(self, spectrum, h, into)
        check_finite(summed)
        if by_interpolation:
            sources.interpolated_to(summed, out)


def _fill_planes(waves: PeriodicWaves, spectrum: np.ndarray, h: np.ndarray, out: np.ndarray) -> None:
    """Two matrix products a plane; out is (Z, Y, X)."""
    orders = waves.orders
    along_x = np.exp(1j * np.outer(orders.kx, waves.x))
    along_y = np.exp(1j * np.outer(waves.y, orders.ky))
    for values, into in zip(h, out, strict=True):
        into[...] = (along_y @ (spectrum * values[orders.radius_of])) @ along_x


def _fill_rows(waves: PeriodicWaves, spectrum: np.ndarray, h: np.ndarray, out: np.ndarray) -> None:
    """Of each y, the sum over ky once for all planes."""
    from scipy.sparse import csr_array

    orders = waves.orders
    along_x = np.exp(1j * np.outer(orders.kx, waves.x))
    columns = np.broadcast_to(np.arange(orders.kx.size), spectrum.shape).ravel()
    places, shape = (orders.radius_of.ravel(), columns), (orders.radii.size, orders.kx.size)
    for row, y in enumerate(waves.y):
        of_row = (spectrum * np.exp(1j * orders.ky * y)[:, None]).ravel()
        out[:, row] = product(h, csr_array((of_row, places), shape=shape) @ along_x)


def periodic_waves(
    s: SampledSlab,
    sources: AngleInterpolation,
    transfer: TransferFunction,
    places: tuple[np.ndarray, np.ndarray, np.ndarray],
    period: tuple[float, float],
) -> PeriodicWaves:
    """All plane waves that reach positions x, y and z: what is left out is below rounding."""
    x, y, z = places
    end = min(arriving(s, sources.beam.z0, z, math.exp(-FADED)), spectrum_of(sources, s.k0, CUT).high)
    while True:
        waves = _up_to(s, sources, (x, y), period, end)
        if end >= spectrum_of(sources, s.k0, CUT).high or _have_faded(waves, transfer, z):
            return waves
        end *= 2


def _up_to(
    s: SampledSlab,
    sources: AngleInterpolation,
    places: tuple[np.ndarray, np.ndarray],
    period: tuple[float, float],
    end: float,
) -> PeriodicWaves:
    orders = orders_within(np.clip(spectrum_of(sources, s.k0, CUT).box, -end, end), period, sources.beam.z0)
    contour = Contour(orders.radii + 0j, np.ones(orders.radii.size))
    quadrature = Quadrature(contour, uniform_budget(sources.requested.size, 0.0))
    return PeriodicWaves(s.k0, sources, quadrature, places[1], places[0], orders)


def orders_within(box: np.ndarray, period: tuple[float, float], z0: float) -> Orders:
    """The plane waves between the least and largest kx, then ky (2, 2), of a source on z0; too many are refused."""
    count = float(np.prod(1 + np.ptp(box, axis=1) * period / (2 * np.pi))) if np.all(np.isfinite(box)) else math.inf
    if count > MOST_WAVES:
        raise ValueError(
            f"period: expected at most {MOST_WAVES:.3g} plane waves of a lattice, got {count:.3g} for {period}: take shorter lengths, or z "
            f"farther behind the launch plane z0 = {z0:.9g}"
        )
    kx, ky = (multiples(low, high, length) for (low, high), length in zip(box, period, strict=True))
    squares, radius_of = np.unique(kx[None, :] ** 2 + ky[:, None] ** 2, return_inverse=True)
    return Orders(kx, ky, 1 / (period[0] * period[1]), np.sqrt(squares), radius_of.reshape(ky.size, kx.size))


def _have_faded(waves: PeriodicWaves, transfer: TransferFunction, z: np.ndarray) -> bool:
    """Whether, on the first and the last plane, the outer quarter of the radii sums to less than the rounding of the rms of |p|."""
    strengths, radii = waves.strengths, waves.orders.radii
    outer = radii > 0.75 * radii[-1]
    size = np.abs(transfer(radii + 0j, np.unique([z.min(), z.max()]))) * strengths
    return bool(np.all(size[:, outer].sum(axis=1) <= EPS * np.sqrt((size**2).sum(axis=1))))
