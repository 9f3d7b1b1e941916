"""A half-space of solid behind a slab: its outgoing P and S waves, carried back through the solids in contact with it.

The two outgoing waves are the two solutions whose minors are carried back; of their sum that leaves no shear stress on the face of
the fluid in front the amplitudes are T of the S wave and -T of the P wave there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..conventions import branch_wavenumber, outgoing_kz
from ..media.solids import SolidHalfSpace
from .layer import State, changed_run, solid_perturbed, solid_with_loss
from .solid_run import interior, quantity_of, through, without_zero
from .solids import Minors, Split, Vector, from_waves, normalised, to_fluid, vector_of


class Exit(NamedTuple):
    """What splits the state of the half-space, its density, and kz of its P and of its S wave: (F, n)."""

    split: Split
    rho: np.ndarray
    a: np.ndarray
    b: np.ndarray


def exit_of(h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray) -> Exit:
    """The waves that leave the slab at omega (F, 1) and kx (F, n)."""
    rho, modulus, mu = (v[:, None] for v in h[:3])
    m, kappa = 2 * kx * mu / (omega * omega), kx / rho
    a, b = (outgoing_kz(kx, omega, rho, rho, v) for v in (modulus, mu))
    return Exit(Split(kappa, m, kappa * m), rho, a, b)


def far_minors(e: Exit) -> Minors:
    """Minors of the P and the S wave at the half-space."""
    ia, ib = 1j * e.a / e.rho, 1j * e.b / e.rho
    one = np.ones_like(ia)
    return normalised(from_waves((-ib, one, -ia * ib, ia), 0.0, e.split, 0.0 * one.real))


def near_state(h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray) -> State:
    """The state of the fluid in front of the half-space and of the solids in contact with it."""
    (minors,), _ = through(h.run, omega, kx, (far_minors(exit_of(h, omega, kx)),), ())
    return State(*to_fluid(minors), minors.log)


def amplitudes(h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray, log: np.ndarray) -> np.ndarray:
    """Amplitudes of the P and the S wave at the half-space, rho w^2 times their potentials, in units of exp(log) of `near_state`: (2, F, n)."""
    e = exit_of(h, omega, kx)
    zero = np.zeros_like(e.a)
    one = zero + 1
    starts = (one, zero, 1j * e.a / e.rho, zero), (zero, -1j * e.b / e.rho, zero, one)
    vectors = tuple(vector_of(waves, e.split, zero.real) for waves in starts)
    _, (p, s) = through(h.run, omega, kx, (), vectors)
    return np.stack([s.T * np.exp(s.log - log), -p.T * np.exp(p.log - log)])


def waves(
    h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray, both: np.ndarray, quantity: str
) -> list[tuple[np.ndarray, np.ndarray]]:
    """kz, and `quantity` at the half-space, of the P and the S wave of amplitudes `both` (2, F, n)."""
    k = without_zero(kx, omega)
    e = exit_of(h, omega, k)
    zero = np.zeros_like(e.a)
    parts = (both[0], zero, 1j * e.a / e.rho * both[0], zero), (zero, -1j * e.b / e.rho * both[1], zero, both[1])
    states = [vector_of(part, e.split, zero.real) for part in parts]
    return [(kz, quantity_of(v, quantity, omega, k)) for kz, v in zip((e.a, e.b), states, strict=True)]


def total(h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray, both: np.ndarray, quantity: str) -> np.ndarray:
    """`quantity` at the half-space: (F, n)."""
    return sum(part for _, part in waves(h, omega, kx, both, quantity))  # type: ignore[return-value]


def inside(
    h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray, depth: np.ndarray, log: np.ndarray, quantity: str
) -> np.ndarray:
    """`quantity` at depths (Z,) behind the first solid of those in contact, in units of exp(log) of `near_state`: (F, Z, n)."""
    thickness = sum(block.thickness for block in h.run)
    k = without_zero(kx, omega)
    out = np.empty((kx.shape[0], depth.size, kx.shape[1]), complex)
    for i in range(kx.shape[0] if depth.size else 0):
        one, w, at = taken(h, np.array([i])), omega[i : i + 1], k[i : i + 1]
        v = interior(one.run, w, at, far_minors(exit_of(one, w, at)), np.maximum(thickness - depth, 0.0))
        out[i] = quantity_of(v, quantity, w, at) * np.exp(v.log - log[i])
    return out


def flux(h: SolidHalfSpace, omega: np.ndarray, kx: np.ndarray, both: np.ndarray) -> np.ndarray:
    """Im(p* q + X* T), w times twice the power along z, of the waves behind at the half-space: (F, n)."""
    e = exit_of(h, omega, kx)
    parts = both[0], -1j * e.b / e.rho * both[1], 1j * e.a / e.rho * both[0], both[1]
    v: Vector = vector_of(parts, e.split, np.zeros(e.a.shape))
    return np.asarray((np.conj(v.p) * v.q + np.conj(v.X) * v.T).imag)


def branches(h: SolidHalfSpace, omega: np.ndarray) -> list[np.ndarray]:
    """kL and kT at omega (F,)."""
    return [branch_wavenumber(omega, h.density, v) for v in h[1:3]]


def changed(h: SolidHalfSpace, change: Callable[[np.ndarray, int], np.ndarray]) -> SolidHalfSpace:
    """The half-space, and the solids in contact with it, changed as in `layer.with_solids`."""
    density, modulus, shear = (change(v[None], kind)[0] for kind, v in enumerate(h[:3]))
    return SolidHalfSpace(density, modulus, shear, changed_run(h.run, change))


def moved(h: SolidHalfSpace, shift: float) -> SolidHalfSpace:
    """Its own values moved by a trace of loss, which keeps their branches, and those of the solids in contact in any direction."""
    own = changed(h, solid_with_loss(shift))
    return own._replace(run=changed_run(h.run, solid_perturbed(shift)))


def taken(h: SolidHalfSpace, rows: np.ndarray) -> SolidHalfSpace:
    """Frequencies `rows`."""
    return changed(h, lambda v, kind: v[:, rows])
