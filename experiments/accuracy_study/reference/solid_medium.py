"""The response of a slab with solids as a cascade of scattering matrices of two waves, layers and periods by doubling.

The state is (p, X | q, T): p = -s_zz, X = -i w^2 u_x, q = w^2 u_z and T = -i s_xz; (p, X) = a + b and (q, T) = i Y (a - b) split it into
waves of a reference medium of admittances Y. A thin sheet of a layer is a power series, the layer the sheet doubled again and again.
In a fluid T = 0: to the second wave it is a face that sends all of it back.
"""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

import beamprop as bp

from .medium import Medium, pieces, power

#: The most that a sheet's generator times its thickness may be, and the terms that its series takes for that: 2^28/28! is 1e-21.
SHEET, TERMS = 2.0, 14
EYE = np.eye(2, dtype=complex)[:, :, None]


class Scatter2(NamedTuple):
    """Reflection from either side and transmission either way, (2, 2, n) each, and the logarithm of the determinant of the block of the transfer matrix
    whose zeros are the poles of all four."""

    left: np.ndarray
    right: np.ndarray
    there: np.ndarray
    back: np.ndarray
    log_d: np.ndarray


def _times(*factors: np.ndarray) -> np.ndarray:
    out = factors[0]
    for m in factors[1:]:
        out = np.stack([[out[i, 0] * m[0, j] + out[i, 1] * m[1, j] for j in range(m.shape[1])] for i in (0, 1)])
    return out


def _determinant(m: np.ndarray) -> np.ndarray:
    return m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]


def _inverse(m: np.ndarray) -> np.ndarray:
    return np.stack([[m[1, 1], -m[0, 1]], [-m[1, 0], m[0, 0]]]) / _determinant(m)


def _loop(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """1 - a b; between two fluids nothing of the second wave goes round, which is exactly 0 there and stands as 1."""
    out = EYE - _times(a, b)
    out[1, 1] = np.where(out[1, 1] == 0, 1.0, out[1, 1])
    return out


def _cascade(a: Scatter2 | None, b: Scatter2) -> Scatter2:
    if a is None:
        return b
    there, back = _loop(a.right, b.left), _loop(b.left, a.right)
    in_there, in_back = _inverse(there), _inverse(back)
    return Scatter2(
        a.left + _times(a.back, b.left, in_there, a.there),
        b.right + _times(b.there, a.right, in_back, b.back),
        _times(b.there, in_there, a.there),
        _times(a.back, in_back, b.back),
        a.log_d + b.log_d + np.log(_determinant(there)),
    )


def _doubled(a: Scatter2) -> Scatter2:
    """A symmetrical sheet twice."""
    loop = EYE - _times(a.left, a.left)
    around = _times(_inverse(loop), a.there)
    r, t = a.left + _times(a.there, a.left, around), _times(a.there, around)
    return Scatter2(r, r, t, t, 2 * a.log_d + np.log(_determinant(loop)))


class SolidMedium(Medium):
    """A slab with solids at one frequency, with `loss` added to everything; solids are (density, density, L, thickness, mu)."""

    def __init__(self, slab: bp.Slab, frequency: float, loss: float = 0.0) -> None:
        f = np.array([frequency])
        self.omega = 2 * np.pi * frequency

        def values(medium: Any, thickness: float) -> tuple:
            rho, *moduli = (complex(v[0]) for v in medium.at(f) if v is not None)
            rho += 1j * loss * abs(rho)
            if isinstance(medium, bp.Solid):
                L, mu = (1 / (1 / v + 1j * loss * abs(1 / v)) for v in moduli)
                return rho, rho, L, thickness, mu
            K = moduli[-1]
            return rho, rho, 1 / (1 / K + 1j * loss * abs(1 / K)), thickness

        self.before, self.after = values(slab.before, math.inf), values(slab.after, math.inf)
        self.segments = [([values(y.fluid, y.thickness) for y in cell.layers], n) for cell, n in slab.segments]
        self.wall = math.inf
        self.thickness = slab.thickness
        self.k0 = self.omega * np.sqrt(self.before[1] / self.before[2]).real
        solids = [v for layers, _ in [*self.segments, ([self.after], 1)] for v in layers if len(v) == 5]
        densities, shears = (sorted(abs(v[i]) for v in solids) for i in (0, 4))
        #: Of the reference medium: of the middle one among the solids, so that waves inside are split into few that come back.
        self.heavy, self.stiff = densities[len(densities) // 2], shears[len(shears) // 2]

    def branch_points(self) -> list[complex]:
        """One of each pair of branch points: two of a half-space of solid."""
        squares = [
            self.before[0] / self.before[2],
            self.after[0] / self.after[2],
            *(self.after[0] / v for v in self.after[4:]),
        ]
        return [self.omega * np.sqrt(complex(v)) for v in squares]

    def reference(self, k: np.ndarray) -> np.ndarray:
        """Admittances (2, n) of the reference medium."""
        shear = self.omega**2 * self.heavy / self.stiff
        return np.stack(
            [np.sqrt(self.k0**2 + np.abs(k) ** 2) / self.heavy, self.heavy / np.sqrt(shear + np.abs(k) ** 2)]
        )

    def sheet(self, layer: tuple, k: np.ndarray, y: np.ndarray) -> tuple[Scatter2, np.ndarray]:
        """A sheet of a solid layer, and how often it is doubled to the layer, (n,): no oftener than needed, for it doubles rounding."""
        rho, _, L, d, mu = layer
        w2, zero = self.omega**2, np.zeros(k.shape, complex)
        a = np.stack([[rho + zero, -k], [-k, w2 / mu + zero]]) * y[None]
        b = (
            np.stack(
                [
                    [-w2 / L + zero, k * (1 - 2 * mu / L)],
                    [k * (1 - 2 * mu / L), 4 * mu * (1 - mu / L) * k**2 / w2 - rho],
                ]
            )
            / y[:, None]
        )
        size = np.sqrt(np.sum(np.abs(a) ** 2, axis=(0, 1)) * np.sum(np.abs(b) ** 2, axis=(0, 1))) ** 0.5 * d
        doublings = np.maximum(0, np.ceil(np.log2(size / SHEET))).astype(int)
        d = d / 2.0**doublings
        # (p, X) of the far face is even (p, X) + odd_a (q, T)/Y, and (q, T)/Y there even' (q, T)/Y + odd_b (p, X)
        (even, odd_a), (other, odd_b) = self._series(_times(a, b), a, d), self._series(_times(b, a), b, d)
        # of the waves a = ((p, X) - i (q, T)/Y)/2 and b with +: b of the far face from a and b of the near one
        from_a, from_b = (even - other + 1j * (odd_a + odd_b)) / 2, (even + other - 1j * (odd_a - odd_b)) / 2
        t = _inverse(from_b)
        r = -_times(t, from_a)
        return Scatter2(r, r, t, t, np.log(_determinant(from_b))), doublings

    @staticmethod
    def _series(square: np.ndarray, first: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """cosh and sinh: sums of square^j d^2j/(2j)! and square^j d^(2j+1)/(2j+1)! first."""
        even = odd = term = EYE + 0 * square
        for j in range(1, TERMS):
            term = _times(term, square) * (d * d / (2 * j * (2 * j - 1)))
            even = even + term
            odd = odd + term / (2 * j + 1)
        return even, _times(odd, first) * d

    def scatter(self, layer: tuple, d: float, k: np.ndarray, y: np.ndarray) -> Scatter2:
        """One layer of thickness d, a solid or a fluid."""
        if len(layer) == 5:
            out, doublings = self.sheet((*layer[:3], d, layer[4]), k, y)
            for count in range(int(doublings.max(initial=0))):
                out = Scatter2(
                    *(np.where(count < doublings, twice, once) for twice, once in zip(_doubled(out), out, strict=True))
                )
            return out
        s = super().layer(layer, d, k, y[0])
        r, t = (np.zeros((2, 2, k.size), complex) for _ in range(2))
        r[0, 0], r[1, 1], t[0, 0] = s.left, 1.0, np.exp(s.log_t)
        return Scatter2(r, r, t, t, -s.log_t)

    def part2(self, k: np.ndarray, y: np.ndarray, start: float, stop: float) -> Scatter2 | None:
        """What lies between two depths."""
        out = None
        for layers, place in pieces(self.segments, start, stop):
            if isinstance(place, int):
                whole = [self.scatter(v, v[3], k, y) for v in layers]
                out = _cascade(out, power(functools.reduce(_cascade, whole, None), place, _cascade))
            else:
                out = self._part_of_period2(out, layers, place, k, y)
        return out

    def _part_of_period2(self, out: Any, layers: list, ends: tuple[float, float], k: np.ndarray, y: np.ndarray) -> Any:
        """Parts of the layers of one period, between depths from its begin."""
        at = 0.0
        for v in layers:
            d = min(at + v[3], ends[1]) - max(at, ends[0])
            if d > 0:
                out = _cascade(out, self.scatter(v, d, k, y))
            at += v[3]
        return out

    def _behind(self, k: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, list[np.ndarray], np.ndarray, np.ndarray]:
        """What is reflected from behind (2, 2, n), kz of each wave there, and p and q of each per unit of what arrives, (waves, 2, n)."""
        rho = self.after[0]
        kz, zero = self.kz(self.after, k), np.zeros(k.shape, complex)
        if len(self.after) == 4:
            y2, one = kz / rho, zero + 1
            p = 2 * y[0] / (y[0] + y2)
            return (
                np.stack([[(y[0] - y2) / (y[0] + y2), zero], [zero, one]]),
                [kz],
                np.stack([[p, zero]]),
                np.stack([[1j * y2 * p, zero]]),
            )
        mu, w2 = self.after[4], self.omega**2
        ks = self.kz((rho, rho, mu), k)
        # u = grad phi + (-d psi/dz, d psi/dx), of phi = 1/(rho w^2) and of psi = 1/(rho w^2)
        soft = mu / (rho * w2)
        square = 1 - 2 * k**2 * soft
        p, q = np.stack([square, 2 * k * ks * soft]), np.stack([1j * kz / rho, 1j * k / rho])
        s = np.stack([p, np.stack([k / rho, -ks / rho])])
        v = np.stack([q, np.stack([2j * k * kz * soft, -1j * square])]) / y[:, None]
        shares = _inverse((s - 1j * v) / 2)
        return _times((s + 1j * v) / 2, shares), [kz, ks], p[:, None] * shares, q[:, None] * shares

    def _loads(self, k: np.ndarray, y: np.ndarray, end: np.ndarray, start: float) -> np.ndarray:
        """What is reflected at a depth, (2, 2, n), of all that lies behind."""
        s = self.part2(k, y, start, self.thickness) if start < self.thickness else None
        return end if s is None else s.left + _times(s.back, end, _inverse(_loop(s.right, end)), s.there)

    def response(self, k: np.ndarray, z: np.ndarray, z0: float, velocity: bool = False) -> np.ndarray:
        """As `Medium.response`: p = -s_zz, or v_z."""
        sign, y = -1 if velocity else 1, self.reference(k)
        kz1 = self.kz(self.before, k)
        y1 = kz1 / self.before[0]
        end, waves, *far = self._behind(k, y)
        arriving, gamma = self._arriving(self._loads(k, y, end, 0.0))
        inward = 2 * y1 / (y1 * (1 + gamma) + y[0] * (1 - gamma))
        r, launch = inward * (1 + gamma) - 1, np.exp(-1j * kz1 * z0)
        out = np.empty((z.size, k.size), complex)
        for row, depth in zip(out, z, strict=True):
            if depth <= 0:
                row[:] = np.exp(1j * kz1 * (depth - z0)) + sign * r * np.exp(-1j * kz1 * (depth + z0))
                row *= y1 / y[0] if velocity else 1
                continue
            inside, there = min(depth, self.thickness), (arriving * inward * launch)[:, None]
            front = self.part2(k, y, 0, inside)
            rest = self._loads(k, y, end, inside)
            if front is not None:
                there = _times(_inverse(_loop(front.right, rest)), front.there, there)
            if depth >= self.thickness:
                of_waves = far[velocity] * (-1j / y[0] if velocity else 1)
                row[:] = sum(
                    (w[0] * there[0, 0] + w[1] * there[1, 0]) * np.exp(1j * kz * (depth - inside))
                    for kz, w in zip(waves, of_waves, strict=True)
                )
            else:
                row[:] = (1 + sign * rest[0, 0]) * there[0, 0] + sign * rest[0, 1] * there[1, 0]
        return out

    @staticmethod
    def _arriving(load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Both waves at the near face over the first one, which its fluid sends, and what comes back of that: T = 0 there."""
        closed = 1 - load[1, 1]
        second = load[1, 0] / np.where(closed == 0, 1.0, closed)
        return np.stack([np.ones_like(second), second]), load[0, 0] + load[0, 1] * second

    def log_t(self, k: np.ndarray) -> np.ndarray:
        """- log of a function without poles whose zeros are the modes, up to turns."""
        y = self.reference(k)
        end = self._behind(k, y)[0]
        s = self.part2(k, y, 0, self.thickness)
        loads = self._loads(k, y, end, 0.0)
        y1 = self.kz(self.before, k) / self.before[0]
        _, gamma = self._arriving(loads)
        closed = 1 - loads[1, 1]
        log = np.log(np.where(closed == 0, 1.0, closed)) + np.log((y1 * (1 + gamma) + y[0] * (1 - gamma)) / (2 * y[0]))
        return -log if s is None else -(log + s.log_d + np.log(_determinant(_loop(s.right, end))))


def medium_of(slab: bp.Slab, frequency: float) -> Medium:
    """A slab at one frequency, with solids or without."""
    return (SolidMedium if has_solid(slab) else Medium)(slab, frequency)


def has_solid(slab: bp.Slab) -> bool:
    """Whether a layer, or what is behind, is a solid."""
    media = [slab.after, *(layer.fluid for cell, _ in slab.segments for layer in cell.layers)]
    return any(isinstance(m, bp.Solid) for m in media)
