"""Free plates of solids at long waves and where energy stands still, and plates in a fluid; media as in `solids`.

Frequencies are those times thickness, fd in Hz m. Below, x = kx d/2, y = w d/(2 cT), and P and Q are half the plate's
thickness times kz of its longitudinal and shear waves. Waves in a free plate are zeros of
S = (x^2 - Q^2)^2 cos P sin Q + 4 x^2 P Q sin P cos Q, or of A, with sine and cosine changed (Lamb 1917).
"""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

import mpmath as mp

from .solids import Solid


def zero_group_velocity(solid: Solid) -> tuple[float, float]:
    """Fd and kx d at which S1 carries no energy: S = 0 and dS/d(kx^2) = 0, to thirty digits.

    Taken over Q, S is an entire function of kx^2 and real.
    """
    with mp.workdps(30):
        ratio = mp.mpf(solid[2]) / mp.mpf(solid[1])

        def symmetric(x2: mp.mpf, y: mp.mpf) -> mp.mpf:
            P, Q = mp.sqrt((ratio * y) ** 2 - x2), mp.sqrt(y**2 - x2)
            return mp.re((x2 - Q**2) ** 2 * mp.cos(P) * mp.sinc(Q) + 4 * x2 * P * mp.sin(P) * mp.cos(Q))

        def conditions(x2: mp.mpf, y: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
            return symmetric(x2, y), mp.diff(lambda v: symmetric(v, y), x2)

        x2, y = mp.findroot(conditions, (0.8, 0.94 * min(mp.pi / 2 / ratio, mp.pi)))
        return float(y * solid[2] / mp.pi), float(2 * mp.sqrt(x2))


class CutOff(NamedTuple):
    """A wave of a free plate at kx = 0: which, its fd, and how fd grows with (kx d)^2 from there."""

    name: str
    fd: float
    curvature: float


def cut_offs(solid: Solid, lengthwise: int, shear: int) -> list[CutOff]:
    """The first resonances across a free plate, n cL/2 and n cT/2 (Lamb 1917), and S or A = 0 to the next order.

    Where cos P = 0 or sin Q = 0 it is S that vanishes, otherwise A. One speed must be no multiple of half the other's.
    """
    r, out = solid[2] / solid[1], []
    for n in range(1, lengthwise + 1):
        fd, y = n * solid[1] / 2, n * math.pi / 2 / r
        coupling = 1 / math.tan(y) if n % 2 else -math.tan(y)
        out.append(CutOff(f"{n} cL/2", fd, fd * (1 + 8 * r * r * coupling / y) / (8 * (r * y) ** 2)))
    for n in range(1, shear + 1):
        fd, y = n * solid[2] / 2, n * math.pi / 2
        coupling = 1 / math.tan(r * y) if n % 2 else -math.tan(r * y)
        out.append(CutOff(f"{n} cT/2", fd, fd * (1 + 8 * r * coupling / y) / (8 * y * y)))
    return out


def cone(solid: Solid) -> float:
    """Group velocity of the two waves that meet at kx = 0 if cL = 2 cT: 2 cT/pi, of S = pi^3 dy^2/2 - 2 pi x^2."""
    return 2 * solid[2] / math.pi


def in_fluid(solid: Solid, fluid: tuple[float, float], fd: float, angle: float) -> tuple[complex, complex]:
    """R and t of a plate in a fluid: half the sum and difference of what even and odd motion reflect (Schoch 1952).

    Each reflects (Z - Zf)/(Z + Zf), Zf = rho_f c_f/cos(angle). Potentials that leave no shear on the faces give its
    Z = p/v, i rho cT^4/w^3 times S/(kz sin P sin Q) and -A/(kz cos P cos Q), with kz of the longitudinal wave; in S and
    A kx and kz themselves stand for x, P and Q, unless as arguments of sines and cosines.
    """
    w = 2 * math.pi * fd  # of a plate 1 m thick: r and t are those of any thickness at the same fd
    k = w / fluid[1] * math.sin(math.radians(angle))
    p, q = (cmath.sqrt((w / c) ** 2 - k * k) for c in solid[1:])
    (sin_p, cos_p), (sin_q, cos_q) = ((cmath.sin(v / 2), cmath.cos(v / 2)) for v in (p, q))
    squared, coupled = (k * k - q * q) ** 2, 4 * k * k * p * q
    scale = 1j * solid[0] * solid[2] ** 4 / w**3
    even = scale * (squared * cos_p * sin_q + coupled * sin_p * cos_q), p * sin_p * sin_q
    odd = -scale * (squared * sin_p * cos_q + coupled * cos_p * sin_q), p * cos_p * cos_q
    z = fluid[0] * fluid[1] / math.cos(math.radians(angle))
    r_even, r_odd = ((over - z * under) / (over + z * under) for over, under in (even, odd))
    return (r_even + r_odd) / 2, (r_even - r_odd) / 2
