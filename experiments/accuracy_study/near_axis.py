"""The response beside kx = 0 of a slab with very sharp resonances, from power series computed with 50 digits.

Next to a resonance at normal incidence a pole lies at kx^2 = k_p^2 with |k_p| << k0. There the response is N(u)/D(u),
u = kx^2, of two functions that are smooth in u; rounding spoils D(0) alone, in which almost everything cancels. So the
coefficients of both series are computed with many digits, and the quotient is taken in double precision.
"""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np

from .medium import Medium

#: Digits, and terms of the series.
DIGITS, TERMS = 50, 32
#: The series are computed on a circle: so much of the way to the nearest branch point, and |kx| times the thickness no more
#: than this (D grows as its cosh); they are used within so much of it.
COMPUTED, GROWTH, USED = 0.5, 12.0, 0.4


class NearAxis:
    """Series of the denominator D and, for each plane, of the numerator N in u = (kx / scale)^2."""

    def __init__(self, m: Medium, z: np.ndarray, z0: float) -> None:
        layers = [v for part, periods in m.segments for _ in range(periods) for v in part]
        waves = [abs(b) for b in m.branch_points()]  # layers are entire functions of u
        self.m, self.z0, self.z = m, z0, z
        self.scale = min(COMPUTED * min(waves), GROWTH / m.thickness)
        self.radius = USED * self.scale
        with mpmath.workdps(DIGITS):
            circle = [mpmath.expjpi(2 * mpmath.mpf(j) / TERMS) for j in range(TERMS)]
            values = [_states(m, layers, z, mpmath.mpf(self.scale) ** 2 * c) for c in circle]
            rows = np.array([_coefficients([v[i] for v in values], circle) for i in range(z.size + 1)])
        self.denominator, self.numerators = rows[0], rows[1:]
        roots = np.abs(np.roots(self.denominator[8::-1] / np.abs(self.denominator[:9]).max()))
        #: |kx| of the pole nearest to 0.
        self.smallest = float(self.scale * np.sqrt(min([r for r in roots if r > 0], default=1.0)))

    def response(self, k: np.ndarray) -> np.ndarray:
        """As `Medium.response`, for |kx| < radius."""
        u = (k / self.scale) ** 2
        launch = np.exp(-1j * self.m.kz(self.m.before, k) * self.z0)
        powers = u[None] ** np.arange(TERMS)[:, None]
        return (self.numerators @ powers) / (self.denominator @ powers) * launch


def _coefficients(values: list[Any], circle: list[Any]) -> np.ndarray:
    """Coefficients of a series from its values on the unit circle."""
    return np.array(
        [
            complex(mpmath.fsum(v * c ** (-n) for v, c in zip(values, circle, strict=True)) / len(circle))
            for n in range(len(circle))
        ]
    )


def _root(fluid: tuple, omega: Any, u: Any) -> Any:
    rho_z, rho_x, K = (mpmath.mpmathify(v) for v in fluid[:3])
    return mpmath.sqrt(rho_z * (omega**2 / K - u / rho_x))


def _step(state: tuple, fluid: tuple, d: Any, omega: Any, u: Any) -> tuple:
    """The state (p, q) at distance d in front of where it is known."""
    rho, kz = mpmath.mpmathify(fluid[0]), _root(fluid, omega, u)
    c, s = mpmath.cos(kz * d), mpmath.sin(kz * d)
    return state[0] * c - state[1] * rho * s / kz, state[0] * kz * s / rho + state[1] * c


def _states(m: Medium, layers: list, z: np.ndarray, u: Any) -> list[Any]:
    """D, and N at each plane, at one u, per unit of launched wave at z = 0."""
    omega = mpmath.mpf(m.omega)
    front, back = _root(m.before, omega, u), _root(m.after, omega, u)
    state = (mpmath.mpf(1), 1j * back / mpmath.mpmathify(m.after[0]))
    faces = np.concatenate([[0.0], np.cumsum([v[3] for v in layers])])
    inside: dict[int, Any] = {}
    exact = [mpmath.mpf(0)]
    for v in layers:
        exact.append(exact[-1] + mpmath.mpf(v[3]))
    order = [i for i in np.argsort(-z, kind="stable") if 0 < z[i] < m.thickness]
    for n in range(len(layers) - 1, -1, -1):
        for i in order:
            if faces[n] <= z[i] < faces[n + 1] or (n == len(layers) - 1 and z[i] >= faces[-1]):
                inside[i] = _step(state, layers[n], exact[n + 1] - mpmath.mpf(z[i]), omega, u)[0]
        state = _step(state, layers[n], mpmath.mpf(layers[n][3]), omega, u)
    y = 1j * front / mpmath.mpmathify(m.before[0])
    # state = s (1 + r, y (1 - r)): forward is s, backward s r
    forward, backward = (state[0] + state[1] / y) / 2, (state[0] - state[1] / y) / 2
    out = [forward]
    for i, depth in enumerate(z):
        at = mpmath.mpf(depth)
        if depth <= 0:
            out.append(forward * mpmath.expj(front * at) + backward * mpmath.expj(-front * at))
        elif i in inside:
            out.append(inside[i])
        else:
            out.append(mpmath.expj(back * (at - exact[-1])))
    return out
