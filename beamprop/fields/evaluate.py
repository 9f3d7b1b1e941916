"""Spectrum x response -> p(z, x): the sums over a line that was chosen.

Everything here is for one frequency; a `SampledSlab` holds what does not change from line to line.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

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
from .low_rank import cross, mixing


def evaluator(s: SampledSlab, beam: Beam, quadrature: Quadrature, h: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """p at any x on the one plane of h: plane waves are solved and their amplitudes formed once, whatever is asked then."""
    right, left = quadrature.amplitudes_of(s.k0, single(beam))
    return lambda at: np.asarray(sums.direct_sum(quadrature.contour, h, right[0], left[0], at - beam.centre))[0]


def beam_sum(s: SampledSlab, beam: Beam, quadrature: Quadrature, h: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p(z, x) of one beam by whichever of FFT and matrix product is cheaper."""
    out = np.empty((1, h.shape[0], x.size), complex)
    fill(s, single(beam), quadrature, h, x, out)
    return out[0]


#: Up to so many planes, sums by tables take less than exponentials that all planes share.
FEW_PLANES = 4


def fill(
    s: SampledSlab, sources: AngleInterpolation, quadrature: Quadrature, h: np.ndarray, x: np.ndarray, out: np.ndarray
) -> None:
    """p(z, x) of all requested beams into out (A, Z, X), of which (Z, X) must be contiguous."""
    contour, n = quadrature.contour, quadrature.fft
    right, left = quadrature.amplitudes_of(s.k0, sources)
    x = x - sources.beam.centre
    fast = n and fft_is_cheaper(n, contour.k.size, x.size)
    if sources.weights is not None:
        summed = (
            sums.grid_sum(contour, h, right, left, sums.grid_of(x), n)
            if fast
            else sums.direct_sum(contour, h, right, left, x)
        )
        _check_finite(summed)
        sources.interpolated_to(summed, out)
        return
    if fast:
        grid = sums.grid_of(x)
        for a, b, into in zip(right, left, out, strict=True):
            sums.grid_sum(contour, h, a, b, grid, n, into)
    elif h.shape[0] <= FEW_PLANES and x.size >= exponentials.MANY and (step := exponentials.even_step(x)):
        for a, b, into in zip(right, left, out, strict=True):
            into[...] = exponentials.over_waves(contour.k, a * h, float(x[0]), step, x.size)
            if np.any(b):
                into += exponentials.over_waves(-contour.k, b * h, float(x[0]), step, x.size)
    elif len(right) == 1 or h.shape[0] > 64:
        for a, b, into in zip(right, left, out, strict=True):
            into[...] = sums.direct_sum(contour, h, a, b, x)
    else:
        out[...] = sums.direct_sum(contour, h, right, left, x)
    _check_finite(out)


def _check_finite(p: np.ndarray) -> None:
    with np.errstate(over="ignore", invalid="ignore"):
        surely = np.isfinite(p.sum())  # then no term is not finite
    if not surely and not np.all(np.isfinite(p)):
        raise ValueError(
            "the field is not finite: a plane wave of the sum meets a guided mode of a lossless slab, or overflow"
        )


#: From how many planes and positions on most planes are made of a few; and the most that are looked at together.
MANY_PLANES, MANY_POINTS, TOGETHER = 200, 64, 2048
#: Among how many planes the few are looked for, and in each medium at least; how many they may be; and how many others are
#: summed in each medium to see that it is so.
SEARCHED, IN_EACH, MOST_ROWS, TRIED = 90, 40, 48, 5


def fill_map(
    s: SampledSlab,
    sources: AngleInterpolation,
    quadrature: Quadrature,
    transfer: TransferFunction,
    z: np.ndarray,
    x: np.ndarray,
    out: np.ndarray,
    rtol: float,
) -> np.ndarray:
    """p of all requested beams on planes z (Z,) into out (A, Z, X), of which (Z, X) must be contiguous.

    Returns what the error of each beam, over the largest |p| of a plane, gains by planes that are made of others: (A,).
    """
    gained = np.zeros(out.shape[0])
    for start in range(0, z.size, TOGETHER):
        part = slice(start, start + TOGETHER)
        more: Any = None
        if min(TOGETHER, z.size - start) >= MANY_PLANES and x.size >= MANY_POINTS:
            more = _fill_low_rank(s, sources, quadrature, transfer, z[part], x, out[:, part], rtol)
        if more is None:
            more = _fill_all(s, sources, quadrature, transfer, z[part], x, out[:, part])
        gained = np.maximum(gained, more)
    return gained


def _fill_all(
    s: SampledSlab,
    sources: AngleInterpolation,
    quadrature: Quadrature,
    transfer: TransferFunction,
    z: np.ndarray,
    x: np.ndarray,
    out: np.ndarray,
) -> float:
    """Every plane by itself, in blocks: of the response, and with many angles of the fields that are mixed."""
    k = quadrature.contour.k
    row = max(1, k.size, 0 if sources.weights is None else sources.angles.size * x.size)
    block = max(1 if row > 80_000 else 16, 20_000_000 // (16 * row))
    for start in range(0, z.size, block):
        rows = slice(start, start + block)
        fill(s, sources, quadrature, transfer(k, z[rows]), x, out[:, rows])
    return 0.0


def _some_planes(s: SampledSlab, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Planes, as indices of z, that are spread over each medium, and some that lie between them."""
    order = np.argsort(z, kind="stable")
    parts = np.split(order, np.searchsorted(z[order], s.faces))
    searched, tried = [], []
    for part in parts:
        if part.size:
            count = min(part.size, max(IN_EACH, SEARCHED * part.size // z.size))
            turn = (1 - np.cos(np.linspace(0, np.pi, count))) / 2  # denser at the faces, where what decays is seen
            at = np.unique(((part.size - 1) * turn).round().astype(int))
            between = (at[:-1] + at[1:]) // 2
            between = np.setdiff1d(between, at)
            searched.append(part[at])
            tried.append(
                part[between[np.unique(np.linspace(0, between.size - 1, TRIED).astype(int))]] if between.size else []
            )
    return np.concatenate(searched), np.concatenate(tried).astype(int)


def _fill_low_rank(
    s: SampledSlab,
    sources: AngleInterpolation,
    quadrature: Quadrature,
    transfer: TransferFunction,
    z: np.ndarray,
    x: np.ndarray,
    out: np.ndarray,
    rtol: float,
) -> np.ndarray | None:
    """Planes made of a few, found among some with all plane waves; None where that is not good enough.

    That is seen on others, between those, which are summed themselves. exp(|Im k| X) magnifies errors of h.
    """
    k, x0 = quadrature.contour.k, x - sources.beam.centre
    right, left = quadrature.amplitudes_of(s.k0, sources)
    strength = np.max(np.abs(right) + np.abs(left), axis=0)
    searched, tried = _some_planes(s, z)
    if quadrature.checked_planes is not None:  # among them those that are nearly dark, where small errors count
        tried = np.union1d(tried, np.flatnonzero(np.isin(z, quadrature.checked_planes)))
    if 2 * searched.size > z.size:
        return None
    h = transfer(k, z[np.concatenate([searched, tried])])
    with np.errstate(over="ignore", invalid="ignore"):  # a plane wave of a periodic sum may meet a guided mode
        weighted = h[: searched.size] * strength
        size = np.linalg.norm(weighted, axis=1)
    if not np.all((size > DARK) & np.isfinite(size)):
        return None
    growth = float(np.max(np.abs(k.imag)) * np.max(np.abs(x0)))
    weighted /= size[:, None]
    found = cross(weighted, max(0.01 * rtol * math.exp(-growth), 3e-15), MOST_ROWS)
    rows, columns = found.rows, found.columns
    there = transfer(k[columns], z)
    summed = np.empty((out.shape[0], rows.size + tried.size, x.size), complex)
    fill(s, sources, quadrature, h[np.concatenate([rows, searched.size + np.arange(tried.size)])], x, summed)
    ours, theirs = summed[:, : rows.size], summed[:, rows.size :]
    scale = np.max(np.abs(theirs), axis=2)
    scale = np.where(scale > DARK, scale, np.inf)
    room = rtol - quadrature.worst  # what the line has left of rtol, if it keeps it
    allowed = min(0.1 * rtol, room) if room > 0 else 0.1 * rtol
    for count in sorted({found.within(2e-4 * rtol), rows.size}):  # mostly the growth is not met
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # what is not finite is not allowed
            weights = mixing(there[:, :count], h[rows[:count]][:, columns[:count]])
            for some, into in zip(ours, out, strict=True):
                np.matmul(weights, some[:count], out=into)
            # some planes stand for all: the worst of the others may be a few times worse
            error = 5 * np.max(np.max(np.abs(out[:, tried] - theirs), axis=2) / scale, axis=1)
        error = np.maximum(error, 3e-4 * rtol)
        if np.max(error) <= allowed:
            return error
    return None
