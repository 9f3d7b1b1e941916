"""Contours for periodic slabs with little loss or none: on either side of the axis, as the modes there ask for.

The modes of many periods fill the bands |trace/2| < 1 of the cell's matrix. A trace of loss e, density -> density + i e |density|
and 1/modulus likewise, moves a mode by i e -(dtrace/de)/(dtrace/dkx), to one side for a whole stretch of kx. (For negative
media without dispersion this is not what a group velocity says.) The contour passes below the stretches where they move up
and above those where they move down, and meets the axis where that changes, and at the branch points.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .contour import panels
from .medium import Medium

#: Samples of the trace along the axis.
SAMPLES = 60_001


class Stretch(NamedTuple):
    """Of the axis from lo to hi: -1 where the contour passes below, +1 above."""

    lo: float
    hi: float
    side: int


def half_trace(m: Medium, k: np.ndarray, more: float = 0.0) -> np.ndarray:
    """Half the trace of one period's matrix, without loss, |density| and |1/modulus| increased by `more` of themselves."""
    omega = m.omega
    a, b, c, d = np.ones(k.size), np.zeros(k.size), np.zeros(k.size), np.ones(k.size)
    for fluid in m.segments[0][0]:
        rho_z, rho_x, soft = (v.real + more * abs(v.real) for v in (fluid[0], fluid[1], 1 / fluid[2]))
        square = (rho_z * (omega**2 * soft - k**2 / rho_x)).astype(complex)
        phase = np.sqrt(square) * fluid[3]
        cosine, sine = np.cos(phase).real, (np.sinc(phase / np.pi) * fluid[3]).real
        up, down = rho_z * sine, -square.real * sine / rho_z
        a, b, c, d = cosine * a + up * c, cosine * b + up * d, down * a + cosine * c, down * b + cosine * d
    return (a + d) / 2


def stretches(m: Medium, end: float, slab_end: float) -> list[Stretch]:
    """Which side of the axis the contour passes on, from 0 to `end`; beyond `slab_end` nothing of the slab is seen."""
    k = np.linspace(0, slab_end, SAMPLES)[1:]
    k = np.unique(np.concatenate([k, np.geomspace(1e-3, 1, 3000) * min(m.k0, slab_end)]))
    step = 1e-4
    by_k = half_trace(m, k * (1 + step)) - half_trace(m, k * (1 - step))
    by_loss = half_trace(m, k, step) - half_trace(m, k, -step)
    clear = (np.abs(half_trace(m, k)) < 1) & (np.minimum(np.abs(by_k), np.abs(by_loss)) > 1e-13)  # above rounding
    side = np.where(clear, np.sign(by_k) * np.sign(by_loss), 0).astype(int)
    known = np.flatnonzero(side)
    if not known.size:
        return _cut(m, [Stretch(0.0, end, -1)])
    out: list[Stretch] = []
    lo = 0.0
    changes = np.flatnonzero(np.diff(side[known]))
    for i in changes:  # half-way through the gap between bands, if there is one
        hi = float(k[known[i]] + k[known[i + 1]]) / 2
        out.append(Stretch(lo, hi, int(side[known[i]])))
        lo = hi
    return _cut(m, [*out, Stretch(lo, end, int(side[known[-1]]))])


def _cut(m: Medium, parts: list[Stretch]) -> list[Stretch]:
    """Stretches above the axis cut at the branch points, which lie on it and are passed below or met."""
    for b in m.branches():
        parts = [
            piece
            for s in parts
            for piece in (
                [Stretch(s.lo, b, s.side), Stretch(b, s.hi, s.side)] if s.side > 0 and s.lo < b < s.hi else [s]
            )
        ]
    return parts


class Tent(NamedTuple):
    """A way over or under a stretch: up to `height` within `slope` of its ends."""

    part: Stretch
    height: float
    slope: float

    def lift(self, s: np.ndarray) -> np.ndarray:
        return self.part.side * np.minimum(self.height, self.slope * np.minimum(s - self.part.lo, self.part.hi - s))


def sided_nodes(
    m: Medium, tents: list[Tent], length: float, path: float, finer: float
) -> tuple[np.ndarray, np.ndarray]:
    """Gauss panels over all tents, short where the integrand turns fast; graded towards where they meet the axis."""
    nodes, weights = [], []
    for tent in tents:
        lo, hi = tent.part.lo, tent.part.hi
        turn = min(tent.height / tent.slope, (hi - lo) / 2)
        for start, stop in ((lo, lo + turn), (lo + turn, hi - turn), (hi - turn, hi)):
            if stop - start > 1e-14 * hi:
                u, w = panels(_edges(m, tent, start, stop, (length, path, finer)))
                slope = (1 if start == lo else -1 if stop == hi else 0) * tent.slope if start != lo + turn else 0.0
                nodes.append(u + 1j * tent.lift(u))
                weights.append(w * (1 + 1j * tent.part.side * slope))
    return np.concatenate(nodes), np.concatenate(weights)


def _edges(m: Medium, tent: Tent, start: float, stop: float, fast: tuple[float, float, float]) -> np.ndarray:
    length, path, finer = fast
    span = stop - start
    graded = span * np.geomspace(1e-13, 0.5, 600)
    s = np.unique(np.concatenate([np.linspace(start, stop, 3001), start + graded, stop - graded]))
    lift = np.abs(tent.lift(s))
    branches = m.branches()
    with np.errstate(divide="ignore", invalid="ignore"):
        along_z = np.max([s / np.sqrt(np.abs(b**2 - (s + 1j * lift) ** 2)) for b in branches], axis=0)
    t = half_trace(m, s)
    # the waves inside turn with the Bloch phase, where they have not decayed on their way through
    period = sum(v[3] for v in m.segments[0][0])
    phase = np.abs(np.gradient(np.arccos(np.clip(t, -1, 1)), s)) / period
    through = np.where(phase * lift * m.thickness < 40, phase * m.thickness, 0.0)
    ends = np.minimum(s - start, stop - s) if tent.height > 0 else np.inf
    apart = np.maximum(lift, 1e-9 * m.k0)
    if any(abs(b - e) < 1e-12 * b for b in branches for e in (start, stop)):
        apart = np.minimum(apart, np.maximum(ends, 1e-13 * m.k0) + 0.0 * lift)
    rate = finer * (length + np.minimum(path * along_z, 1e12) + np.minimum(through, 1e12)) / 7 + 0.7 / apart
    total = np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(s))])
    return np.interp(np.linspace(0, 1, math.ceil(total[-1]) + 2) * total[-1], total, s)
