"""The response beside kx = 0 of a slab with very sharp resonances, from power series computed with 50 digits.

Next to a resonance at normal incidence a pole lies at kx^2 = k_p^2 with |k_p| << k0. There the response is N(u)/D(u),
u = kx^2, of two functions that are smooth in u; rounding spoils D(0) alone, in which almost everything cancels. So the
coefficients of both series are computed with many digits, and the quotient is taken in double precision.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

from .many_digits import kz_of, states
from .medium import Medium

#: Digits, and terms of the series.
DIGITS, TERMS = 50, 32
#: The series are computed on a circle: so much of the way to the nearest branch point, and |kx| times the thickness no more
#: than this (D grows as its cosh); they are used within so much of it.
COMPUTED, GROWTH, USED = 0.5, 12.0, 0.4


class NearAxis:
    """Series in u = (kx / scale)^2 of the waves (forward, backward) at the near face and of p at planes inside.

    All for p = 1 at the far face, so that forward is the denominator of every response.
    """

    def __init__(self, m: Medium, z: np.ndarray, z0: float) -> None:
        layers = [v for part, periods in m.segments for _ in range(periods) for v in part]
        nearest = min(abs(b) for b in m.branch_points())  # layers are entire functions of u
        self.m, self.z0, self.z = m, z0, z
        self.scale = min(COMPUTED * nearest, GROWTH / m.thickness)
        self.radius = USED * self.scale
        self.inside = np.flatnonzero((z > 0) & (z < m.thickness))
        with mpmath.workdps(DIGITS):
            circle = [mpmath.expjpi(2 * mpmath.mpf(j) / TERMS) for j in range(TERMS)]
            values = [_waves(m, layers, z[self.inside], mpmath.mpf(self.scale) ** 2 * c) for c in circle]
            self.series = np.array([_coefficients(list(row), circle) for row in zip(*values, strict=True)])
        leading = self.series[0, :9]
        roots = np.abs(np.roots(leading[::-1] / np.abs(leading).max()))
        #: |kx| of the pole nearest to 0.
        self.smallest = float(self.scale * np.sqrt(min([r for r in roots if r > 0], default=1.0)))

    def response(self, k: np.ndarray) -> np.ndarray:
        """As `Medium.response`, for |kx| < radius."""
        forward, backward, *inside = self.series @ ((k / self.scale) ** 2)[None] ** np.arange(TERMS)[:, None]
        kz1, kz2 = self.m.kz(self.m.before, k), self.m.kz(self.m.after, k)
        out = np.empty((self.z.size, k.size), complex)
        for row, depth in zip(out, self.z, strict=True):
            if depth <= 0:
                row[:] = np.exp(1j * kz1 * depth) + backward / forward * np.exp(-1j * kz1 * depth)
            else:
                row[:] = np.exp(1j * kz2 * (depth - self.m.thickness)) / forward
        for i, p in zip(self.inside, inside, strict=True):
            out[i] = p / forward
        return out * np.exp(-1j * kz1 * self.z0)


def _coefficients(values: list[Any], circle: list[Any]) -> np.ndarray:
    """Coefficients of a series from its values on the unit circle."""
    return np.array(
        [
            complex(mpmath.fsum(v * c ** (-n) for v, c in zip(values, circle, strict=True)) / len(circle))
            for n in range(len(circle))
        ]
    )


def _waves(m: Medium, layers: list, z: np.ndarray, u: Any) -> list[Any]:
    """Forward and backward wave at the near face, and p at planes inside, at one u = kx^2."""
    omega = mpmath.mpf(m.omega)
    far = mpmath.matrix([1, 1j * kz_of(m.after, omega, u) / mpmath.mpmathify(m.after[0])])
    (p, q), inside = states(layers, far, z, omega, u)
    y = 1j * kz_of(m.before, omega, u) / mpmath.mpmathify(m.before[0])
    return [(p + q / y) / 2, (p - q / y) / 2, *(inside[i] for i in range(z.size))]
