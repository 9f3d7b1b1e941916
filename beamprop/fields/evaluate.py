"""Spectrum x response -> p(z, x): the sums over the plane waves of a contour that was chosen, at one frequency."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

import numpy as np

from ..arrays import exponentials
from ..contour import sums
from ..contour.error import DARK
from ..contour.quadrature import Quadrature
from ..contour.straight import fft_is_cheaper
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation, single
from ..sources.base import Beam
from .low_rank import cross, row_weights


class Waves(Protocol):
    """Beams at positions on planes, as sums over the nodes of a contour."""

    @property
    def sources(self) -> AngleInterpolation:
        """The beams, and the requested angles."""

    @property
    def quadrature(self) -> Quadrature:
        """The contour."""

    @property
    def points(self) -> int:
        """Positions on a plane."""

    @property
    def searched_share(self) -> float:
        """Of the planes of a map, how many at most may be searched for rows: their h is a part of the work saved."""

    @property
    def across(self) -> float:
        """The largest distance from the beams' middle."""

    @property
    def strengths(self) -> np.ndarray:
        """Bounds of what each node adds to |p|, over |h|: (n,)."""

    def fill(self, h: np.ndarray, out: np.ndarray) -> None:
        """p of all requested beams on the planes of h (Z, n) into out (A, Z, points), of which (Z, points) is contiguous."""


class Superposition(NamedTuple):
    """Beams at positions x (X,), as sums of the plane waves of a contour."""

    k0: float
    sources: AngleInterpolation
    quadrature: Quadrature
    x: np.ndarray

    @property
    def amplitudes(self) -> tuple[np.ndarray, np.ndarray]:
        """w S(k) and w S(-k) of the beams that are summed, about their middle: (B, n) each."""
        return self.quadrature.amplitudes_of(self.k0, self.sources)

    @property
    def off_centre(self) -> np.ndarray:
        """x from the beams' middle (X,)."""
        return self.x - self.sources.beam.centre

    @property
    def points(self) -> int:
        """Positions on a plane."""
        return self.x.size

    @property
    def searched_share(self) -> float:
        """Half: the response of the planes takes about as long as their sums."""
        return 0.5

    @property
    def across(self) -> float:
        """The largest distance from the beams' middle."""
        return float(np.max(np.abs(self.off_centre)))

    @property
    def strengths(self) -> np.ndarray:
        """Bounds of what each plane wave adds to |p|, over |h|: (n,)."""
        right, left = self.amplitudes
        return np.asarray(np.max(np.abs(right) + np.abs(left), axis=0))

    def fill(self, h: np.ndarray, out: np.ndarray) -> None:
        """See `fill`."""
        fill(self, h, out)

    def up_to(self, count: int) -> Superposition:
        """Of the first plane waves of a contour alone."""
        contour = self.quadrature.contour
        if count >= contour.k.size:
            return self
        first = contour._replace(k=contour.k[:count], weight=contour.weight[:count])
        return self._replace(quadrature=self.quadrature._replace(contour=first, amplitudes=None))


def evaluator(s: SampledSlab, beam: Beam, quadrature: Quadrature, h: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """p at any x on the one plane of h; amplitudes are formed once, for all x."""
    right, left = quadrature.amplitudes_of(s.k0, single(beam))
    return lambda at: np.asarray(sums.direct_sum(quadrature.contour, h, right[0], left[0], at - beam.centre))[0]


def beam_sum(s: SampledSlab, beam: Beam, quadrature: Quadrature, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) of one beam by whichever of FFT and matrix product is cheaper."""
    out = np.empty((1, h.shape[0], x.size), complex)
    fill(Superposition(s.k0, single(beam), quadrature, x), h, out)
    return out[0]


# The constants of this file are measured again by experiments/benchmarks/constants.py.

#: Up to so many planes of one beam, sums by tables take less (to a third) than exponentials that all planes share.
TABLE_PLANES = 16
#: Up to so many planes, all beams share exponentials in one product, whose operand is h times the number of beams; with more planes
#: that would be large, and exponentials are a small part of a product.
PLANES_OF_A_BEAM = 64


def fill(waves: Superposition, h: np.ndarray, out: np.ndarray) -> None:
    """p(z, x) of all requested beams into out (A, Z, X), of which (Z, X) must be contiguous; h is (Z, n)."""
    sources, contour, n = waves.sources, waves.quadrature.contour, waves.quadrature.fft
    (right, left), x = waves.amplitudes, waves.off_centre
    single_beam = len(right) == 1
    grid = sums.grid_of(x) if n and fft_is_cheaper(n, contour.k.size, x.size) else None
    if sources.weights is not None:
        summed = (
            sums.direct_sum(contour, h, right, left, x)
            if grid is None
            else sums.grid_sum(contour, h, right, left, grid, n)
        )
        check_finite(summed)
        sources.interpolated_to(summed, out)
        return
    if grid is not None:
        for a, b, into in zip(right, left, out, strict=True):
            sums.grid_sum(contour, h, a, b, grid, n, into)
    elif (
        single_beam
        and h.shape[0] <= TABLE_PLANES
        and x.size >= exponentials.MANY
        and (step := exponentials.even_step(x))
    ):
        out[0] = exponentials.over_waves(contour.k, right * h, float(x[0]), step, x.size)
        if np.any(left):
            out[0] += exponentials.over_waves(-contour.k, left * h, float(x[0]), step, x.size)
    elif single_beam or h.shape[0] > PLANES_OF_A_BEAM:
        for a, b, into in zip(right, left, out, strict=True):
            into[...] = sums.direct_sum(contour, h, a, b, x)
    else:
        out[...] = sums.direct_sum(contour, h, right, left, x)
    check_finite(out)


def check_finite(p: np.ndarray) -> None:
    """Refuse a field that is not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        surely = np.isfinite(p.sum())  # then no term is not finite
    if not surely and not np.all(np.isfinite(p)):
        raise ValueError(
            "the field is not finite: a plane wave of the sum meets a guided mode of a lossless slab, or overflow"
        )


#: A map is made from rows of low rank from so many planes on (of which `searched_share` may be searched) and so many positions (with fewer,
#: the response of the planes takes longer than their sums), so many planes at a time: (2048, n) of h at the chosen columns.
MANY_PLANES, MANY_POINTS, TOGETHER = 200, 64, 2048
#: Among how many planes the rows are chosen, and in each medium at least: about twice and once as many as may be chosen, which is a
#: quarter of the fewest planes, since sums of more would save little; and on how many further planes in each medium the result is
#: compared with their own sums.
SEARCHED, IN_EACH, MOST_ROWS, COMPARED = 90, 40, 48, 5
#: The worst of all planes may err by so many times the worst of those that are compared: experiments/accuracy.py counts the estimates
#: below a third of the error, its maps of 250 planes and more apart.
UNSEEN = 5


def fill_map(waves: Waves, transfer: TransferFunction, z: np.ndarray, out: np.ndarray, rtol: float) -> np.ndarray:
    """p of all requested beams on planes z (Z,) into out (A, Z, X), of which (Z, X) must be contiguous.

    Returns the term of low rank in each beam's error, over the largest |p| of a plane: (A,).
    """
    low_rank = np.zeros(out.shape[0])
    for start in range(0, z.size, TOGETHER):
        part = slice(start, start + TOGETHER)
        error = None
        if min(TOGETHER, z.size - start) >= MANY_PLANES and waves.points >= MANY_POINTS:
            error = _fill_low_rank(waves, transfer, z[part], out[:, part], rtol)
        if error is None:
            _fill_all(waves, transfer, z[part], out[:, part])
        else:
            low_rank = np.maximum(low_rank, error)
    return low_rank


def _fill_all(waves: Waves, transfer: TransferFunction, z: np.ndarray, out: np.ndarray) -> None:
    """Every plane by itself, in blocks: of the response, and with many angles of the fields that are interpolated."""
    k, sources = waves.quadrature.contour.k, waves.sources
    row = max(1, k.size, 0 if sources.weights is None else sources.angles.size * waves.points)
    block = max(1 if row > 80_000 else 16, 20_000_000 // (16 * row))
    for start in range(0, z.size, block):
        rows = slice(start, start + block)
        waves.fill(transfer(k, z[rows]), out[:, rows])


def _spread_planes(faces: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes, as indices of z, that are spread over each medium, and planes between them to compare on."""
    order = np.argsort(z, kind="stable")
    searched, compared = [], [np.empty(0, int)]
    for part in np.split(order, np.searchsorted(z[order], faces)):
        if part.size:
            count = min(part.size, max(IN_EACH, SEARCHED * part.size // z.size))
            turn = (1 - np.cos(np.linspace(0, np.pi, count))) / 2  # denser at the faces, where evanescent waves show
            at = np.unique(((part.size - 1) * turn).round().astype(int))
            between = np.setdiff1d((at[:-1] + at[1:]) // 2, at)
            searched.append(part[at])
            if between.size:
                compared.append(part[between[np.unique(np.linspace(0, between.size - 1, COMPARED).astype(int))]])
    return np.concatenate(searched), np.concatenate(compared)


def _fill_low_rank(
    waves: Waves, transfer: TransferFunction, z: np.ndarray, out: np.ndarray, rtol: float
) -> np.ndarray | None:
    """Planes as combinations of rows that are chosen among spread planes; None where that is not accurate enough.

    The error is measured on planes between those, which are summed themselves. exp(|Im k| X) magnifies errors of h.
    """
    quadrature = waves.quadrature
    k = quadrature.contour.k
    searched, compared = _spread_planes(transfer.slab.faces, z)
    if quadrature.checked_planes is not None:  # among them those that are nearly dark, where small errors count
        compared = np.union1d(compared, np.flatnonzero(np.isin(z, quadrature.checked_planes)))
    if searched.size > waves.searched_share * z.size:
        return None
    h = transfer(k, z[np.concatenate([searched, compared])])
    with np.errstate(over="ignore", invalid="ignore"):  # a plane wave of a periodic sum may meet a guided mode
        weighted = h[: searched.size] * waves.strengths
        size = np.linalg.norm(weighted, axis=1)
    if not np.all((size > DARK) & np.isfinite(size)):
        return None
    growth = float(np.max(np.abs(k.imag))) * waves.across
    weighted /= size[:, None]
    chosen = cross(weighted, max(0.01 * rtol * math.exp(-growth), 3e-15), MOST_ROWS)
    rows, columns = chosen.rows, chosen.columns
    at_columns = transfer(k[columns], z)
    own = np.concatenate([rows, searched.size + np.arange(compared.size)])
    _fill_planes(waves, h[own], np.concatenate([searched[rows], compared]), out)
    room = rtol - quadrature.worst  # what the contour has left of rtol, if it keeps it
    allowed = min(0.1 * rtol, room) if room > 0 else 0.1 * rtol
    for count in sorted({chosen.within(2e-4 * rtol), rows.size}):  # most fields are not magnified by the growth's bound
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # what is not finite is not allowed
            weights = row_weights(at_columns[:, :count], h[rows[:count]][:, columns[:count]])
            error = UNSEEN * _apart(weights[compared], searched[rows[:count]], compared, out)
        error = np.maximum(error, 3e-4 * rtol)
        if np.max(error) <= allowed:
            for beam, part in _parts(out):
                np.matmul(weights, beam[searched[rows[:count]], part], out=beam[:, part])
            return error
    return None


#: Values of the sums that are held at a time beside the map, 8 MB, where a plane has so many positions that what its sums share is little;
#: and of a part of all planes, whose products stay in the cache.
HELD, LARGE_PLANE, PART = 2**19, 2**13, 2**18


def _fill_planes(waves: Waves, h: np.ndarray, planes: np.ndarray, out: np.ndarray) -> None:
    """Sums on planes (P,), whose h is (P, n), into their places in a map: no memory for all of them beside it."""
    block = max(1, HELD // (out.shape[0] * waves.points)) if waves.points > LARGE_PLANE else max(1, planes.size)
    for start in range(0, planes.size, block):
        part = planes[start : start + block]
        summed = np.empty((out.shape[0], part.size, waves.points), complex)
        waves.fill(h[start : start + block], summed)
        out[:, part] = summed


def _parts(out: np.ndarray) -> Iterator[tuple[np.ndarray, slice]]:
    """Maps (Z, X) of each beam, and parts of their positions."""
    size = max(256, PART // out.shape[1])
    for beam in out:
        for start in range(0, out.shape[2], size):
            yield beam, slice(start, start + size)


def _apart(weights: np.ndarray, rows: np.ndarray, compared: np.ndarray, out: np.ndarray) -> np.ndarray:
    """How far combinations of the rows of a map are from its planes `compared`, over the largest |p| of a plane: (A,)."""
    apart, scale = np.zeros((2, out.shape[0], compared.size))
    for i, fields in enumerate(out):
        for _, part in _parts(out[i : i + 1]):
            reference = fields[compared, part]
            difference = weights @ fields[rows, part] - reference
            apart[i] = np.maximum(apart[i], np.max(np.abs(difference), axis=1))
            scale[i] = np.maximum(scale[i], np.max(np.abs(reference), axis=1))
    return np.asarray(np.max(apart / np.where(scale > DARK, scale, np.inf), axis=1))
