"""The radial integral of a beam in space: its nodes, and the spectrum of its kernel cut off at a distance.

Of a slab that is the same in all directions of its plane the field is a convolution of the launched p(x, y) with

    G(r) = (1/2 pi) integral_0^inf b(k) h(k) J0(k r) k dk,

on the contour of `paths`. Points and source are at most L apart, so that G may be cut off there. Its spectrum at real k is then an
entire function (Lommel's integral; Watson, Theory of Bessel Functions, 5.11):

    h_L(k) = integral_0^inf b(q) h(q) M(q, k) q dq,   M = L [q J1(q L) J0(k L) - k J0(q L) J1(k L)] / (q^2 - k^2).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ...arrays.matmul import product

#: Numbers in a block that stays in the cache with its temporaries; and of a table that is formed in parts.
BLOCK, HELD = 2**14, 2**17


def bessel_zeros(first: int, count: int) -> tuple[np.ndarray, Any]:
    """A `paths.Rule` for integrals of v g(v) dv over 0 < v, g even: the zeros of J0(pi v).

    The trapezoid rule is of second order here, for v g(v) is odd; this one converges as it does for even functions (Ogata, Publ. RIMS
    41, 949 (2005)).
    """
    from scipy.special import j0, j1

    far = (np.arange(first, first + count) + 0.75) * math.pi
    zeros = far + 1 / (8 * far)
    for _ in range(4):  # McMahon's expansion begins within 2e-3, and Newton's method squares that
        zeros = zeros + j0(zeros) / j1(zeros)
    return zeros / math.pi, 2 / (math.pi * zeros * j1(zeros) ** 2)


def lommel(q: np.ndarray, k: np.ndarray, radius: float, weight: np.ndarray | float = 1.0) -> np.ndarray:
    """M(q, k) of complex q (n,) and real k (t,), even in both, times a weight of each q: (n, t)."""
    from scipy.special import j0, j1, jv

    scale = radius * np.broadcast_to(weight, q.shape)
    along_q = np.stack([scale * q * jv(1, radius * q), -scale * jv(0, radius * q)], axis=1)
    along_k = np.stack([j0(radius * k), k * j1(radius * k)])
    out, square, block = np.empty((q.size, k.size), complex), q * q, max(1, BLOCK // k.size)
    for start in range(0, q.size, block):  # by real numbers: Im(q^2 - k^2) depends on q alone
        part = slice(start, start + block)
        real, imag = along_q[part].real @ along_k, along_q[part].imag @ along_k
        across, above = np.subtract.outer(square[part].real, k * k), square[part].imag[:, None]
        size = 1 / (across**2 + above**2)
        np.multiply(real * across + imag * above, size, out=out[part].real)
        np.multiply(imag * across - real * above, size, out=out[part].imag)
    return out


class LommelSums(NamedTuple):
    """What `lommel` makes of h, without holding it: for a contour on which a field is summed but once."""

    q: np.ndarray  #: (n,)
    k: np.ndarray  #: (t,)
    radius: float
    weight: np.ndarray  #: (n,)
    filtered: np.ndarray | float  #: a factor of each k

    def at(self, h: np.ndarray) -> np.ndarray:
        """h (Z, n) summed over q: (Z, t)."""
        out, block = np.zeros((len(h), self.k.size), complex), max(1, HELD // self.k.size)
        for start in range(0, self.q.size, block):
            part = slice(start, start + block)
            out += product(h[:, part], lommel(self.q[part], self.k, self.radius, self.weight[part]))
        return np.asarray(out * self.filtered)


def passed(q: np.ndarray, low: float, high: float, width: float) -> np.ndarray:
    """A filter b(q), even and entire: 1 between `low` and `high`, and 0 a few widths beyond; (n,)."""
    from scipy.special import erf

    b = (erf((q + high) / width) - erf((q - high) / width)) / 2
    return np.asarray(b - (erf((q + low) / width) - erf((q - low) / width)) / 2 if low > 0 else b)
