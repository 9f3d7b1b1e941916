"""The plain formulas of the package, executable: what the fast kernels are tested against.

Each function is its formula, with no regard for speed, overflow or cancellation; those of layers and slabs work in extended
precision, so that cancellation costs digits that are not looked at. Nothing in the package calls them. Fast kernels name
the function here that they equal.

Matrices have shape (F, n, 2, 2) and act on states (p, q), q = (1/rho_z) dp/dz; omega is (F, 1), kx (n,) or (F, n).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..media.fluids import FluidValues
from ..media.values import LayerValues, SegmentValues

#: Numbers of the formulas of layers and slabs.
EXTENDED = np.clongdouble


# --- one layer, one cell ----------------------------------------------------------------------------------


def entire(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """cos(sqrt u) - 1 and sin(sqrt u)/sqrt u, for u other than 0."""
    w = np.sqrt(np.asarray(u, EXTENDED))
    return -2 * np.sin(w / 2) ** 2, np.sin(w) / w


def layer_matrix(layers: LayerValues, j: int, omega: np.ndarray, kx: np.ndarray, share: float = 1.0) -> np.ndarray:
    """[[C, A s], [-B s, C]] of the given share of layer j, from its near to its far face."""
    B = (omega**2 * layers.compliance[j][:, None] - kx**2 * layers.mobility[j][:, None]) * EXTENDED(share)
    A = np.broadcast_to(layers.mass[j][:, None] * share, B.shape)
    cosine, sine = entire(A * B)
    return np.stack([np.stack([1 + cosine, A * sine], -1), np.stack([-B * sine, 1 + cosine], -1)], -2)


def cell_matrix(layers: LayerValues, omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Product of the matrices of all layers, the last one on the left."""
    m = layer_matrix(layers, 0, omega, kx)
    for j in range(1, len(layers.thickness)):
        m = layer_matrix(layers, j, omega, kx) @ m
    return m


def slab_matrix(segments: list[SegmentValues], omega: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Product of the powers of all cells."""
    m: np.ndarray = np.broadcast_to(np.eye(2, dtype=EXTENDED), (*np.broadcast_shapes(omega.shape, kx.shape), 2, 2))
    for layers, periods in segments:
        m = np.linalg.matrix_power(cell_matrix(layers, omega, kx), periods) @ m
    return m


def bloch_phase(trace: np.ndarray) -> np.ndarray:
    """The Bloch phase from cos(phase) = trace/2, with Im >= 0."""
    phase = np.arccos(np.asarray(trace, EXTENDED) / 2)
    return np.where(phase.imag < 0, -phase, phase)


# --- half-spaces ------------------------------------------------------------------------------------------


def root(w: np.ndarray) -> np.ndarray:
    """Square root of w, cut along -i."""
    return np.exp(0.25j * np.pi) * np.sqrt(np.asarray(w) * -1j)


def root_of_product(kx: np.ndarray, b: complex) -> np.ndarray:
    """sqrt(b - kx) sqrt(b + kx), with cuts upward from b and downward from -b."""
    return root(b - kx) * root(b + kx)


def kz_on_the_axis(kx: np.ndarray, omega: np.ndarray, fluid: FluidValues) -> np.ndarray:
    """kz = sqrt(rho_z (w^2/K - kx^2/rho_x)) on the real axis: the root with Im kz > 0 or, if real, with energy along +z."""
    kz = np.sqrt(fluid.rho_z * (omega**2 / fluid.bulk_modulus - kx**2 / fluid.rho_x).astype(EXTENDED))
    outward = np.where(kz.imag == 0, (kz / fluid.rho_z).real >= 0, kz.imag > 0)
    return np.where(outward, kz, -kz)


# --- a slab -----------------------------------------------------------------------------------------------


class Face(NamedTuple):
    """A half-space at its face with the slab: kz and rho_z."""

    kz: np.ndarray
    rho: np.ndarray

    @property
    def admittance(self) -> np.ndarray:
        """q/p of the wave that goes along +z."""
        return 1j * self.kz / self.rho


def reflection_and_transmission(m: np.ndarray, before: Face, after: Face) -> tuple[np.ndarray, np.ndarray]:
    """r and t from M (1 + r, Y_before (1 - r)) = t (1, Y_after), for a matrix M of determinant 1."""
    p = m[..., 1, 1] - m[..., 0, 1] * after.admittance  # M^-1 (1, Y_after)
    q = m[..., 0, 0] * after.admittance - m[..., 1, 0]
    incident, backward = (p + q / before.admittance) / 2, (p - q / before.admittance) / 2
    return backward / incident, 1 / incident


def pressure_inside(
    segments: list[SegmentValues], omega: np.ndarray, kx: np.ndarray, z: np.ndarray, before: Face, after: Face
) -> np.ndarray:
    """p at depths z over the incident p at the near face: (F, Z, n)."""
    log, p, q, inside = carried_back(segments, omega, kx, z, after)
    incident = (p + q / before.admittance) / 2
    return inside * np.exp(-log)[:, None] / incident[:, None]


def carried_back(
    segments: list[SegmentValues], omega: np.ndarray, kx: np.ndarray, z: np.ndarray, after: Face
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The state (1, Y_after) of the far face carried back through layer after layer of all periods.

    Returns log, p, q of the state exp(log) (p, q) at the near face, and the pressures (F, Z, n) at depths z.
    """
    layers = [(s.layers, j) for s in segments for _ in range(s.periods) for j in range(len(s.layers.thickness))]
    far = sum(s.periods * float(s.layers.thickness.sum()) for s in segments)
    log, p, q = 0 * after.kz.real, 1 + 0 * after.kz, after.admittance
    inside = np.empty((p.shape[0], z.size, p.shape[1]), EXTENDED)
    for values, j in reversed(layers):
        d = values.thickness[j]
        for i in np.flatnonzero((z <= far) & (z > far - d)):
            inside[:, i] = carried_through(layer_matrix(values, j, omega, kx, (far - z[i]) / d), p, q)[0] * np.exp(log)
        p, q = carried_through(layer_matrix(values, j, omega, kx), p, q)
        size = np.abs(p) + np.abs(q)
        log, p, q, far = log + np.log(size), p / size, q / size, far - d
    return log, p, q, inside


def carried_through(m: np.ndarray, p: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """M^-1 (p, q) of a matrix of determinant 1."""
    return m[..., 1, 1] * p - m[..., 0, 1] * q, m[..., 0, 0] * q - m[..., 1, 0] * p


# --- contours and sums over plane waves -------------------------------------------------------------------


def chi(k: np.ndarray, delta: float | np.ndarray) -> np.ndarray:
    """erfc(-k/delta)/2: the share of the spectrum that a contour for waves to the right takes, 1 on the right and 0 on the left."""
    from scipy.special import erfc

    return erfc(-k / delta) / 2


def plane_waves(k: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """exp(i k x) and exp(-i k x): (n, X) each."""
    return np.exp(1j * np.multiply.outer(k, x)), np.exp(-1j * np.multiply.outer(k, x))


def folded(values: np.ndarray, first: int, n: int) -> np.ndarray:
    """Values (..., count) of harmonics first, first + 1, ... added up modulo n: (..., n)."""
    out = np.zeros((*values.shape[:-1], n), values.dtype)
    for j in range(values.shape[-1]):
        out[..., (first + j) % n] += values[..., j]
    return out


def field(
    h: np.ndarray, right: np.ndarray, left: np.ndarray, k: np.ndarray, x: np.ndarray, order: int = 0
) -> np.ndarray:
    """The order-th derivative of p(x) = sum_k h (right e^{ikx} + left e^{-ikx}): (Z, X) of h (Z, n) and amplitudes (n,)."""
    forward, backward = plane_waves(k, x)
    ik = (1j * k[:, None]) ** order
    return h @ (ik * right[:, None] * forward + (-1) ** order * ik * left[:, None] * backward)


def over_waves(k: np.ndarray, amplitudes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """sum_k amplitudes exp(i k x): (Z, X) of amplitudes (Z, n)."""
    return amplitudes @ plane_waves(k, x)[0]


def over_positions(k: np.ndarray, weights: np.ndarray, x: np.ndarray) -> np.ndarray:
    """sum_x weights exp(-i k x): (n, B) of weights (X, B)."""
    return plane_waves(k, x)[1] @ weights


def logarithm(value: np.ndarray, log: np.ndarray) -> np.ndarray:
    """log D of D = value exp(log)."""
    return log + np.log(value)
