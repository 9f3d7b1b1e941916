"""The two open sides: exact Dirichlet-to-Neumann maps by Fourier order, and the beam that enters in front.

With ``C[i, m] = (1/W) integral phi_i exp(i kx_m x) dx`` the order m of a line's field is ``(C^H p)_m``, and
the outgoing wave of a half-space has the flux ``q = i kz_m/rho_z`` per unit of it. In front, with the
incident order c_m at the near face, the total field gives ``q_m = i kz_m/rho_z (2 c_m - p_m)``. Together, for
the slab's matrix A,

    A p - W C diag(i kz/rho_z) C^H p (on both faces) = -W C (2 i kz/rho_z c) (on the near face).

The orders are those that the mesh resolves: |m| below half the number of unknowns on a line, a set that is
symmetric about 0. Components of a line's field beyond them (a single alternating one at most) see no flux.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..conventions import outgoing_kz
from ..media.fluids import Fluid
from ..media.structures import Slab
from ..sources.base import Beam
from .strip import Strip, line_basis, line_dofs


class Orders(NamedTuple):
    """The Fourier orders: kx, kz in front and behind, and the incident amplitudes on z0 and on the near face."""

    kx: np.ndarray
    before: np.ndarray
    after: np.ndarray
    launched: np.ndarray
    incident: np.ndarray


class Ends(NamedTuple):
    """Flux per pressure on the two outer lines (n, n), and the flux that the beam adds on the near one (n,)."""

    near: np.ndarray
    far: np.ndarray
    source: np.ndarray
    transform: np.ndarray  # C, (n, orders)
    scale: float  # a typical flux per pressure, |k/rho| in front


def half_space_kz(fluid: Fluid, frequency: float, kx: np.ndarray) -> tuple[np.ndarray, complex]:
    """kz of the outgoing wave at kx, and the density along z."""
    rho_z, rho_x, K = (complex(v) for v in fluid.at(frequency))
    return outgoing_kz(kx, 2 * math.pi * frequency, rho_z, rho_x, K), rho_z


def orders(slab: Slab, beam: Beam, frequency: float, period: float, count: int) -> Orders:
    """The orders |m| <= count of the beam repeated every `period`: ``c_m = S(kx_m)/period`` on z = z0."""
    kx = 2 * np.pi / period * np.arange(-count, count + 1)
    before, _ = half_space_kz(slab.before, frequency, kx)
    assert isinstance(slab.after, Fluid)
    after, _ = half_space_kz(slab.after, frequency, kx)
    k0 = float(slab.before.wavenumber(frequency).real)
    launched = np.asarray(beam.spectrum(kx, k0), dtype=complex) / period
    return Orders(kx, before, after, launched, launched * np.exp(-1j * before * beam.z0))


def transform(strip: Strip, kx: np.ndarray) -> np.ndarray:
    """C[i, m] = (1/W) integral phi_i exp(i kx_m x) dx, (n, orders), by Gauss points of ample number."""
    ends = np.linspace(0, strip.period, strip.elements_x + 1)
    basis = line_basis(ends, strip.order, 2 * (strip.order + 12))
    x = basis.global_coordinates()[0]  # (elements, points)
    left = basis.mesh.p[0, basis.mesh.t].min(axis=0)
    dofs = line_dofs(strip.order, strip.elements_x)[:, np.argsort(np.argsort(left))]
    C = np.zeros((strip.n, kx.size), dtype=complex)
    waves = np.exp(1j * np.multiply.outer(x + strip.origin, kx))
    for function, dof in zip(basis.basis, dofs, strict=True):
        np.add.at(C, dof, np.einsum("eq,eqm->em", np.asarray(function[0]) * basis.dx, waves))
    return C / strip.period


def ends(strip: Strip, slab: Slab, frequency: float, incident_orders: Orders) -> Ends:
    """The boundary operators and the beam's injection."""
    C = transform(strip, incident_orders.kx)
    near = 1j * incident_orders.before / complex(slab.before.at(frequency).rho_z)
    assert isinstance(slab.after, Fluid)
    far = 1j * incident_orders.after / complex(slab.after.at(frequency).rho_z)
    source = strip.period * C @ (2 * near * incident_orders.incident)
    normal, rho = half_space_kz(slab.before, frequency, np.zeros(1))
    return Ends(
        strip.period * (C * near) @ C.conj().T,
        strip.period * (C * far) @ C.conj().T,
        source,
        C,
        abs(complex(normal[0]) / rho),
    )
