"""The response of a slab as a cascade of scattering matrices in a reference medium, periods by doubling."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

import beamprop as bp


class Scatter(NamedTuple):
    """Reflection from the left and the right, and log t, in a reference medium of admittance y."""

    left: np.ndarray
    right: np.ndarray
    log_t: np.ndarray


def _cascade(a: Scatter | None, b: Scatter) -> Scatter:
    if a is None:
        return b
    loop = 1 - a.right * b.left
    left = a.left + np.exp(2 * a.log_t) * b.left / loop
    right = b.right + np.exp(2 * b.log_t) * a.right / loop
    return Scatter(left, right, a.log_t + b.log_t - np.log(loop))


def power(cell: Any, periods: int, cascade: Callable[[Any, Any], Any] = _cascade) -> Any:
    """So many cells one behind the other, by squaring; None for none."""
    out, square = None, cell
    while periods:
        if periods & 1:
            out = cascade(out, square)
        periods >>= 1
        if periods:
            square = cascade(square, square)
    return out


def _up_to_soft_wall(segments: list) -> tuple[list, float]:
    """The segments before a layer of density 0, and its depth: there p = 0, for dp/dz = density * dv/dt and v stays finite."""
    kept: list = []
    depth = 0.0
    for layers, periods in segments:
        period = sum(v[3] for v in layers)
        for i, v in enumerate(layers):
            if v[0] == 0 and v[1] == 0:
                return [*kept, (layers[:i], 1)] if i else kept, depth + sum(u[3] for u in layers[:i])
        kept.append((layers, periods))
        depth += period * periods
    return kept, math.inf


def pieces(segments: list, start: float, stop: float) -> Iterator[tuple[list, int | tuple[float, float]]]:
    """What lies between two depths: layers, with the number of whole periods, or with both ends of a part of one from its begin.

    By fractions: the rounding of 100 000 periods times their thickness is 1e-11 of a period.
    """
    at = Fraction(0)
    for layers, periods in segments:
        period = sum((Fraction(v[3]) for v in layers), Fraction(0))
        lo, hi = max(Fraction(start) - at, Fraction(0)), min(Fraction(stop) - at, period * periods)
        if hi > lo:
            first, last = math.ceil(lo / period), math.floor(hi / period)
            if last < first:
                yield layers, (float(lo - last * period), float(hi - last * period))
            else:
                if first * period > lo:
                    yield layers, (float(lo - (first - 1) * period), float(period))
                if last > first:
                    yield layers, last - first
                if hi > last * period:
                    yield layers, (0.0, float(hi - last * period))
        at += period * periods


class Medium:
    """A slab at one frequency, with `loss` added to everything."""

    def __init__(self, slab: bp.Slab, frequency: float, loss: float = 0.0) -> None:
        f = np.array([frequency])
        self.omega = 2 * np.pi * frequency

        def values(fluid: bp.Fluid) -> tuple[complex, complex, complex]:
            rho_z, rho_x, K = (complex(v[0]) for v in fluid.at(f))
            more = 1j * loss
            rho_x = rho_x + more * abs(rho_x) if np.isfinite(rho_x) else rho_x
            return rho_z + more * abs(rho_z), rho_x, 1 / (1 / K + more * abs(1 / K))

        self.before, self.after = values(slab.before), values(slab.after)
        segments = [([(*values(y.fluid), y.thickness) for y in cell.layers], n) for cell, n in slab.segments]
        self.segments, self.wall = _up_to_soft_wall(segments)
        self.thickness = slab.thickness
        self.k0 = self.omega * np.sqrt(self.before[1] / self.before[2]).real

    def branch_points(self) -> list[complex]:
        """One of each pair +-b of branch points that the field knows: those of the half-spaces that it reaches."""
        seen = (self.before,) if self.wall < math.inf else (self.before, self.after)
        points = [self.omega * np.sqrt(complex(f[1] / f[2])) for f in seen if np.isfinite(f[1])]
        return [b for b in points if b != 0]

    def branches(self) -> list[float]:
        """|kx| of the branch points near the real axis: where waves turn evanescent."""
        return [b.real for b in self.branch_points() if b.real > abs(b.imag)]

    def kz(self, fluid: tuple, k: np.ndarray) -> np.ndarray:
        """The outgoing root below the right half of the axis, and above it: before the branch point, and beyond."""
        rho_z, rho_x, K = fluid[:3]
        square = rho_z * (self.omega**2 / K - (k**2 / rho_x if np.isfinite(rho_x) else 0)) + 0j
        root = np.exp(0.25j * np.pi) * np.sqrt(-1j * square)
        return np.where((k.imag > 0) & (square.real < 0), 1j * np.sqrt(-square), root)

    def layer(self, fluid: tuple, d: float, k: np.ndarray, y: np.ndarray) -> Scatter:
        """One layer between two reference media: 1/t = cos - (i/2) (y A + B/y) s, r/t = (i/2) (B/y - y A) s."""
        rho, kz = fluid[0], self.kz(fluid, k)
        kz = np.where(kz.imag < 0, -kz, kz)
        phase = kz * d
        thick = phase.imag > 15
        calm = np.where(thick, 1.0, phase)
        s = np.sinc(calm / np.pi) * d
        forward, back = y * rho * s, kz**2 / rho * s / y
        log_t = -np.log1p(-2 * np.sin(calm / 2) ** 2 - 0.5j * (forward + back))
        r = 0.5j * (back - forward) * np.exp(log_t)
        if np.any(thick):
            face = (y - kz / rho) / (y + kz / rho)
            loop = 1 - (face * np.exp(1j * phase)) ** 2
            log_t = np.where(thick, np.log((1 - face**2) / loop) + 1j * phase, log_t)
            r = np.where(thick, face * (1 - np.exp(2j * phase)) / loop, r)
        return Scatter(r, r, log_t)

    def part(self, k: np.ndarray, y: np.ndarray, start: float, stop: float) -> Scatter | None:
        """What lies between two depths."""
        out = None
        for layers, place in pieces(self.segments, start, stop):
            if isinstance(place, int):
                cell = None
                for v in layers:
                    cell = _cascade(cell, self.layer(v, v[3], k, y))
                out = _cascade(out, power(cell, place))
            else:
                out = self._part_of_period(out, layers, place, k, y)
        return out

    def _part_of_period(self, out: Any, layers: list, ends: tuple[float, float], k: np.ndarray, y: np.ndarray) -> Any:
        """Parts of the layers of one period, between depths from its begin."""
        at, (lo, hi) = 0.0, ends
        for v in layers:
            d = min(at + v[3], hi) - max(at, lo)
            if d > 0:
                out = _cascade(out, self.layer(v, d, k, y))
            at += v[3]
        return out

    def response(self, k: np.ndarray, z: np.ndarray, z0: float, velocity: bool = False) -> np.ndarray:
        """What a unit plane wave on z = z0 has become at z: (Z, n).

        With `velocity` v_z instead of p, in units in which the reference medium's waves have both alike: it is large where
        a standing wave's p has a node.
        """
        sign = -1 if velocity else 1
        y = np.sqrt(self.k0**2 + np.abs(k) ** 2) / abs(self.before[0])
        kz1, kz2 = self.kz(self.before, k), self.kz(self.after, k)
        y1, y2 = kz1 / self.before[0], kz2 / self.after[0]
        end = np.full(k.shape, -1 + 0j) if self.wall < math.inf else (y - y2) / (y + y2)

        def load(s: Scatter | None) -> np.ndarray:
            return end if s is None else s.left + np.exp(2 * s.log_t) * end / (1 - s.right * end)

        deepest = min(self.wall, self.thickness)
        gamma = load(self.part(k, y, 0, deepest))
        inward = 2 * y1 / (y1 * (1 + gamma) + y * (1 - gamma))
        r = inward * (1 + gamma) - 1
        launch = np.exp(-1j * kz1 * z0)
        out = np.empty((z.size, k.size), complex)
        for row, depth in zip(out, z, strict=True):
            if depth <= 0:
                row[:] = np.exp(1j * kz1 * (depth - z0)) + sign * r * np.exp(-1j * kz1 * (depth + z0))
                row *= y1 / y if velocity else 1
                continue
            if depth >= self.wall:
                row[:] = 0
                continue
            inside = min(depth, self.thickness)
            front = self.part(k, y, 0, inside)
            rest = load(self.part(k, y, inside, deepest) if inside < deepest else None)
            row[:] = inward * launch * (1 + sign * rest)
            if front is not None:
                row *= np.exp(front.log_t) / (1 - front.right * rest)
            row *= np.exp(1j * kz2 * (depth - inside))
        return out

    def log_t(self, k: np.ndarray) -> np.ndarray:
        """log t of the slab up to turns, whose poles are the modes; before a soft wall, of what arrives at it."""
        y = np.sqrt(self.k0**2 + np.abs(k) ** 2) / abs(self.before[0])
        y1, y2 = self.kz(self.before, k) / self.before[0], self.kz(self.after, k) / self.after[0]
        s = self.part(k, y, 0, min(self.wall, self.thickness))
        if s is None:  # nothing but a wall
            return np.zeros(k.shape, complex)
        end = np.full(k.shape, -1 + 0j) if self.wall < math.inf else (y - y2) / (y + y2)
        size = 2 * y if self.wall < math.inf else 1 + end  # at a soft wall, of the velocity: p vanishes for all kx
        gamma = s.left + np.exp(2 * s.log_t) * end / (1 - s.right * end)
        return s.log_t + np.log(2 * y1 * size / (y1 * (1 + gamma) + y * (1 - gamma)) / (1 - s.right * end))
