"""Beams in space far beside their axis: their kernel on a grid of the differences between positions and source.

A lattice that serves all distances up to L has windows of about 2 L, but positions far to a side differ from the source by
vectors of a smaller box. On it the kernel G(r) is sampled, tapered beyond, and transformed by an FFT,

    p(x, y) = sum S(kx, ky) G^(kx, ky) exp(i kx x + i ky y) dkx dky/(2 pi)^2,

whose windows are as long as the box and its tapers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...arrays import fft
from ...sources.angles import AngleInterpolation
from ...sources.in_space import mean_size
from . import lattice
from .bessel_sums import BesselSums, bessel_sums, terms

#: Positions from which G is interpolated, over the fewest that determine it, and how many of them: Lagrange's polynomials err by 4e-14.
FINE, POSITIONS = 64, 8
#: The most points of a grid; so many of them are interpolated at a time, 150 bytes each, for planes with so many values along ky.
MOST_POINTS, BLOCK, HELD = 400_000, 2**13, 2**17


class Axis(NamedTuple):
    """Differences along x or y, by a step from the first, and where the lattice of their transform ends."""

    start: float
    step: float
    points: int
    low: float  #: ends of the untapered part
    high: float
    width: float  #: of the taper, an error function
    ends: tuple[float, float]  #: of k

    @property
    def places(self) -> np.ndarray:
        """Differences (points,), exactly mirrored about a middle at 0."""
        return (self.low + self.high) / 2 + self.step * (np.arange(self.points) - (self.points - 1) / 2)

    @property
    def taper(self) -> np.ndarray:
        """1 between `low` and `high`, and 0 at the ends: (points,)."""
        from scipy.special import erf

        gap, places = (self.low - self.start) / 2, self.places
        return (
            np.asarray(erf((places - self.low + gap) / self.width) - erf((places - self.high - gap) / self.width)) / 2
        )


def axis(low: float, high: float, ends: np.ndarray, band: float, u: float) -> Axis:
    """For differences from `low` to `high`, a spectrum between `ends` and a kernel up to `band`; u is as for `sheet.fall`.

    A taper over a margin m is m/2u wide, and its spectrum 4 u^2/m; the number of points is least at the root of both terms' ratio.
    """
    margin = math.sqrt(u**2 * (high - low) / band)
    blur = 4 * u**2 / margin
    ends = np.clip(ends, -band - blur, band + blur)
    window = high - low + 2 * margin
    count = fft.fast_length(math.ceil(window * (float(np.max(np.abs(ends))) + band + blur) / (2 * math.pi)))
    return Axis(low - margin, window / count, count, low, high, margin / (2 * u), (float(ends[0]), float(ends[1])))


class Differences(NamedTuple):
    """A kernel on a grid of differences, and the lattice of its transform; it serves as `lattice.Lattice` does."""

    kx: np.ndarray  #: (Nx,)
    ky: np.ndarray  #: (Ny,)
    area: np.ndarray  #: exp(-i k d0) of the first difference over the number of points, (Ny, Nx)
    axes: tuple[Axis, Axis]
    rows: np.ndarray  #: (R,), the |y| of the grid, each once
    folded: np.ndarray  #: (Gy,), which of these is that of each row of the grid
    extent: tuple[float, float]  #: least and largest radius
    kernel: BesselSums  #: G at Chebyshev's positions of a contour's h
    known: dict[float, np.ndarray]  #: see `Lattice`

    @property
    def by_rows(self) -> bool:
        """No: a transform takes as long for one row."""
        return False

    def spectra(self, k0: float, beams: AngleInterpolation) -> list[np.ndarray]:
        """S of all beams times what makes the field of a transform: (Ny, Nx) each."""
        return lattice.spectra(self, k0, beams)

    def strengths(self, k0: float, beams: AngleInterpolation) -> np.ndarray:
        """|w J0| of each node over the positions, times the largest mean of |S| over directions: (n,)."""
        means = [mean_size(beams.at(float(a)), self.kernel.k.real, k0) for a in beams.angles]
        return np.asarray(np.max(means, axis=0) * self.kernel.strengths)

    def planes(self, h: np.ndarray) -> Iterator[np.ndarray]:
        """G^ on the lattice of each plane of h (Z, n): (Ny, Nx) each."""
        along_x, along_y = (
            np.rint(-k * a.step * a.points / (2 * math.pi)).astype(int) % a.points
            for k, a in zip((self.kx, self.ky), self.axes, strict=True)
        )
        along, x_first = self.axes[1].taper, max(1, HELD // (self.rows.size * along_x.size))
        step = max(1, BLOCK // along.size)
        for start in range(0, len(h), x_first):
            for over_x in self._over_x(self.kernel.at(h[start : start + x_first]), along_x):
                plane = np.empty((along_x.size, along_y.size), complex)
                for i in range(0, along_x.size, step):
                    part = np.ascontiguousarray(over_x[:, i : i + step].T)
                    plane[i : i + step] = fft.transform(part[:, self.folded] * along)[:, along_y]
                yield plane.T

    def _over_x(self, values: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Of the kernels at Chebyshev's positions (Z, N), the `columns` of their transforms over x: (Z, R, Nx)."""
        x, angles = self.axes[0], _angles(values.shape[1])
        across, places = x.taper, x.places
        fine = np.stack([fft.cosine_series(v, angles) for v in values], axis=1).view(float)
        middle, half = (self.extent[0] + self.extent[1]) / 2, (self.extent[1] - self.extent[0]) / 2
        out = np.empty((len(values), self.rows.size, columns.size), complex)
        step = max(1, BLOCK // x.points)
        for i in range(0, self.rows.size, step):
            radii = np.hypot(places, self.rows[i : i + step, None]).ravel()
            matrix, at = _block(np.arccos(np.clip((radii - middle) / half, -1, 1)), angles)
            g = (matrix @ fine[at]).view(complex).reshape(-1, x.points, len(values))
            for plane, into in zip(np.moveaxis(g, 2, 0), out[:, i : i + step], strict=True):
                into[...] = fft.transform(plane * across)[:, columns]
        return out


def _angles(count: int) -> int:
    """Even angles between 0 and pi from which so many Chebyshev polynomials are interpolated."""
    return fft.fast_length(FINE * count)


def differences(k: np.ndarray, weight: np.ndarray, axes: tuple[Axis, Axis], band: float) -> Differences:
    """The grid for the nodes k (n,) of a radial contour and their weights."""
    x, y = axes
    rows, folded = np.unique(np.abs(y.places), return_inverse=True)
    radii = [np.hypot(x.places, row) for row in (rows[0], rows[-1])]
    extent = float(radii[0].min()), float(radii[1].max())
    middle, half = (extent[0] + extent[1]) / 2, (extent[1] - extent[0]) / 2
    count = terms(band * half)
    at = middle + half * np.cos((np.arange(count) + 0.5) * math.pi / count)
    kernel = bessel_sums(k, weight / (2 * math.pi), at, extent)
    kx, ky = (lattice.multiples(*a.ends, a.step * a.points) for a in axes)
    phases: Any = np.multiply.outer(np.exp(-1j * ky * y.places[0]), np.exp(-1j * kx * x.places[0]))
    return Differences(kx, ky, phases / (x.points * y.points), axes, rows, folded, extent, kernel, {})


def _block(turn: np.ndarray, angles: int) -> tuple[Any, np.ndarray]:
    """The matrix that interpolates between even angles, so many up to pi, at angles `turn`; and which they are, mirrored at 0 and pi."""
    table = lattice.interpolation(turn, math.pi / angles, POSITIONS)
    at = np.abs(np.rint(table.radii * angles / math.pi).astype(int))
    return table.matrix, np.where(at > angles, 2 * angles - at, at)
