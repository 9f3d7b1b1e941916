"""Sums over the nodes of a contour: p at any x by matrix products, on even grids by FFTs."""

from __future__ import annotations

import functools
from typing import Any, NamedTuple

import numpy as np

from ..arrays.fft import plan_for
from ..arrays.matmul import product
from ..memory import POINTS_AT_A_TIME
from ..sources.angles import AngleInterpolation
from .paths import EPS, Contour


def amplitudes(contour: Contour, spectrum: Any, centre: float) -> tuple[np.ndarray, np.ndarray]:
    """w S(k) and w S(-k) about x = centre; `spectrum` is a function of kx about x = 0."""
    right, left = contour.weight * spectrum(contour.k), contour.weight * spectrum(-contour.k)
    if centre == 0:
        return right, left
    turn = np.exp(1j * contour.k * centre)
    return right * turn, left / turn


def beam_amplitudes(k0: float, sources: AngleInterpolation, contour: Contour) -> tuple[np.ndarray, np.ndarray]:
    """w S(k) and w S(-k) about the source's middle: (B, n) each."""
    return amplitudes(contour, lambda k: sources.spectra(k, k0), sources.beam.centre)


#: The most exponentials that are held at a time: 64 MB for each direction.
MOST_PHASES = 4_000_000


def direct_sum(contour: Contour, h: np.ndarray, right: np.ndarray, left: np.ndarray, x: np.ndarray) -> np.ndarray:
    """`response.reference.field` at any x (relative to the centre): one matrix product, (Z, n) by (n, X).

    With amplitudes (B, n) of B beams the answer is (B, Z, X), for no more exponentials than one beam takes.
    """
    if x.size > POINTS_AT_A_TIME:
        whole = np.empty((*right.shape[:-1], h.shape[0], x.size), complex)
        for start in range(0, x.size, POINTS_AT_A_TIME):
            columns = slice(start, start + POINTS_AT_A_TIME)
            whole[..., columns] = direct_sum(contour, h, right, left, x[columns])
        return whole
    block = max(1, MOST_PHASES // max(1, x.size))
    if contour.k.size > block:
        parts = [slice(start, start + block) for start in range(0, contour.k.size, block)]
        sums = (
            direct_sum(Contour(contour.k[p], contour.weight[p]), h[:, p], right[..., p], left[..., p], x) for p in parts
        )
        return functools.reduce(np.add, sums)
    forth, back = _phases(contour.k, x, bool(np.any(left)))
    if right.ndim == 1 and h.shape[0] > 2:
        both = right[:, None] * forth
        if back is not None:
            both += left[:, None] * back
        return product(h, both)
    rows = (*right.shape[:-1], h.shape[0])
    out = product((right[..., None, :] * h).reshape(-1, h.shape[1]), forth)
    if back is not None:
        out += product((left[..., None, :] * h).reshape(-1, h.shape[1]), back)
    return out.reshape(*rows, x.size)


class Grid(NamedTuple):
    """Positions x = start + step j + offsets, an even grid and what they are off it; step 0 where they are not nearly even.

    `offsets` is None where the positions are even to their own rounding. A grid that was typed or read from a file is even to
    its printed digits only.
    """

    start: float
    step: float
    points: int
    offsets: np.ndarray | None

    @property
    def even(self) -> np.ndarray:
        """The even grid's own positions."""
        return self.start + self.step * np.arange(self.points)

    @property
    def unevenness(self) -> float:
        """The largest offset [m]."""
        return 0.0 if self.offsets is None else float(np.max(np.abs(self.offsets)))


#: A grid is uneven from this share of the step on. A plane wave moved by its slope errs by (k offset)^2/2, at the shortest wavelength
#: that the grid resolves by (pi/100)^2/2 = 5e-4; `straight.spacing_for_fft` compares smaller offsets with rtol.
UNEVEN = 1e-2


def grid_of(x: np.ndarray) -> Grid:
    """The even grid from the first to the last position, and the offsets from it."""
    if x.size < 2 or not x[-1] > x[0]:
        return Grid(float(x[0]), 0.0, x.size, None)
    grid = Grid(float(x[0]), float((x[-1] - x[0]) / (x.size - 1)), x.size, None)
    offsets = x - grid.even
    largest = float(np.max(np.abs(offsets)))
    if largest > UNEVEN * grid.step:
        return grid._replace(step=0.0)
    return grid if largest <= 4 * EPS * float(max(abs(x[0]), abs(x[-1]))) else grid._replace(offsets=offsets)


#: On even grids of at least TABLE points exponentials are products of two tables, one of every STEP-th point: n/32 + 32 exponentials and n
#: products, half as many exponentials at 64 points, and a 16th at 1024, where STEP = sqrt(n) is best.
TABLE, STEP = 64, 32


def _phases(k: np.ndarray, x: np.ndarray, both: bool) -> tuple[np.ndarray, np.ndarray | None]:
    """`response.reference.plane_waves`, e^{ikx} and, if `both`, e^{-ikx}: (n, X) each. The choice of |Im k| keeps both finite."""
    ik = 1j * k[:, None]
    grid = grid_of(x) if x.size >= TABLE else None
    if grid is None or not grid.step or (grid.unevenness * float(np.max(np.abs(k)))) ** 2 > EPS:
        forth = np.exp(ik * x)
        return forth, 1 / forth if both else None
    starts = grid.start + grid.step * np.arange(0, x.size, STEP)
    coarse, fine = np.exp(ik * starts), np.exp(ik * (grid.step * np.arange(STEP)))
    forth = _outer(coarse, fine, x.size)
    back = _outer(1 / coarse, 1 / fine, x.size) if both else None
    if grid.offsets is not None:  # exp(+-i k offset) to first order, the rest being rounding
        turn = ik * grid.offsets
        if back is not None:
            back -= back * turn
        forth += forth * turn
    return forth, back


def _outer(coarse: np.ndarray, fine: np.ndarray, count: int) -> np.ndarray:
    out = coarse[:, :, None] * fine[:, None, :]
    return out.reshape(coarse.shape[0], -1)[:, :count]


def _fold(h: np.ndarray, amplitude: np.ndarray, first: int, out: np.ndarray) -> None:
    """`response.reference.folded` of h (rows, count) times each amplitude (2, rows or 1, count), into out (2, rows, n).

    Exact, for a window has n points of x. The remaining bins are left as they are.
    """
    n, count, start = out.shape[2], h.shape[1], 0
    while start < count:
        here = (first + start) % n
        part = slice(start, min(count, start + n - here, n if start < n else count))
        into = out[..., here : here + part.stop - part.start]
        if start < n:
            np.multiply(h[:, part], amplitude[..., part], out=into)
        else:
            into += h[:, part] * amplitude[..., part]
        start = part.stop


#: Numbers in a block of FFTs: two sources and two results of 16 bytes each, 1 MB, stay in a core's second-level cache.
IN_CACHE = 2**14


def fft_sum(
    contour: Contour,
    h: np.ndarray,
    right: np.ndarray,
    left: np.ndarray,
    x: np.ndarray,
    n: int,
    out: np.ndarray | None = None,
) -> np.ndarray:
    """`response.reference.field` at even x = x_0 + j dx (relative to the centre), contour.step = 2 pi/(n dx): two FFTs a plane.

    With k = m ds - i sigma it is e^{sigma x} times an inverse FFT of h right plus e^{-sigma x} times an FFT of h left. With
    amplitudes (B, n) of B beams the answer is (B, Z, X); `out`, of its shape and contiguous, is filled if given.
    """
    shape = (*right.shape[:-1], h.shape[0], x.size)
    turn = np.exp(1j * (contour.first + np.arange(contour.k.size)) * contour.step * x[0])
    amplitude = np.stack([np.atleast_2d(right) * turn, np.atleast_2d(left) / turn])  # (2, B, n)
    grow = np.exp(contour.sigma * x)
    scale = np.repeat([grow, 1 / grow], 2, axis=1)  # real factors times complex numbers as pairs: half the products
    leftward = bool(np.any(left))
    planes, total = h.shape[0], amplitude.shape[1] * h.shape[0]
    flat = np.empty((total, x.size), complex) if out is None else out.reshape(-1, x.size)
    real = flat.view(float)
    rows = max(1, min(total, IN_CACHE // n))
    plan = plan_for(rows, n)
    plan.source[...] = 0
    result = plan.result[..., : x.size].view(float)
    for start in range(0, total, rows):
        stop = min(start + rows, total)
        if amplitude.shape[1] == 1:
            part, weights = h[start:stop], amplitude
        else:
            beam, plane = np.divmod(np.arange(start, stop), planes)
            part, weights = h[plane], amplitude[:, beam]
        _fold(part, weights, contour.first, plan.source[:, : stop - start])
        plan.run[0]()
        if leftward:
            plan.run[1]()
            np.einsum("srx,sx->rx", result[:, : stop - start], scale, out=real[start:stop])
        else:
            np.multiply(result[0, : stop - start], scale[0], out=real[start:stop])
    return flat.reshape(shape)


#: Numbers in a block of slopes, by which fields are moved from an even grid to the requested positions: 16 MB beside the answer.
SLOPES = 2**20


def grid_sum(
    contour: Contour,
    h: np.ndarray,
    right: np.ndarray,
    left: np.ndarray,
    grid: Grid,
    n: int,
    out: np.ndarray | None = None,
) -> np.ndarray:
    """`fft_sum` at the requested positions: p + offset dp/dx where they lie off the even grid, to (k offset)^2/2 of a plane wave."""
    p = fft_sum(contour, h, right, left, grid.even, n, out)
    if grid.offsets is None:
        return p
    ik = 1j * contour.k
    beams = right.size // right.shape[-1]
    rows = max(1, SLOPES // (grid.points * beams))
    for start in range(0, h.shape[0], rows):
        part = slice(start, start + rows)
        slope = fft_sum(contour, h[part], right * ik, -left * ik, grid.even, n)
        slope *= grid.offsets
        p[..., part, :] += slope
    return p
