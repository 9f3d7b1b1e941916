"""A slab: r, t, the field inside, and the function whose zeros are its guided modes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..conventions import outgoing_kz
from ..media.fluids import FluidValues
from ..media.solids import SolidHalfSpace
from ..media.values import SegmentValues
from . import solid_half_space
from .interior import fill_interior
from .interior_velocity import fill_velocity
from .layer import State
from .recursion import Station, carry_back
from .solid_run import run_divisor, without_zero


class Response(NamedTuple):
    """r and t at the faces, and p(z) / (incident p at the near face) at the requested depths, (F, Z, n), or v/p.

    With a solid behind t is that of p = -s_zz, and `waves` (2, F, n) are the amplitudes of the P and the S wave there.
    """

    r: np.ndarray
    t: np.ndarray
    inside: np.ndarray
    waves: np.ndarray | None = None


class Waves(NamedTuple):
    """Amplitudes of the incident, the reflected and the transmitted wave, up to a common factor; the last without exp(-log)."""

    incident: np.ndarray
    reflected: np.ndarray
    transmitted: np.ndarray


def _near(
    segments: list[SegmentValues],
    front: FluidValues,
    behind: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray,
) -> tuple[np.ndarray, State, list[Station]]:
    """kz in front, and the state at the near face that leaves a unit outgoing wave behind, or two waves of solid without shear in front."""
    kz1 = outgoing_kz(kx, omega, *front)
    if isinstance(behind, SolidHalfSpace):
        exit_state = solid_half_space.near_state(behind, omega, kx + np.zeros_like(kz1))
    else:
        kz2 = kz1 if _alike(front, behind) else outgoing_kz(kx, omega, *behind)
        exit_state = State(np.ones_like(kz2), 1j * kz2 / behind.rho_z, np.zeros_like(kz2))
    near, stations = carry_back(segments, omega, kx, exit_state, z)
    return kz1, near, stations


def dispersion(
    segments: list[SegmentValues],
    before: FluidValues,
    after: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The function whose zeros in kx are the guided modes, as (value, logarithm): value exp(logarithm). (F, n) each.

    It is the incident amplitude that a unit outgoing wave behind the slab needs, times 2 i kz: the denominator of r and t.
    """
    front, behind = (as_columns(f) for f in (before, after))
    assert isinstance(front, FluidValues)
    kz1, near, _ = _near(segments, front, behind, omega, kx, np.empty(0))
    log = near.log
    for layers, periods in segments:  # the states' divisors have zeros, which the modes have not
        for _, run in layers.solids:
            log = log + periods * run_divisor(run, omega, np.broadcast_to(kx, near.p.shape))
    return 1j * kz1 * near.p + front.rho_z * near.q, log


def solve(
    segments: list[SegmentValues],
    before: FluidValues,
    after: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
    z: np.ndarray | None = None,
    quantity: str = "p",
) -> Response:
    """Response of a slab to a plane wave of unit pressure at the near face.

    Parameters
    ----------
    segments : from `media.values.slab_values`, F frequencies
    before, after : properties of the half-spaces, arrays (F,); the solids in contact with one of solid are its own, and not in `segments`
    omega : (F, 1), rad/s
    kx : (F, n) complex, rad/m
    z : (Z,) depths inside the slab [m], or None
    quantity : what is told inside, "p", "v_z", or "v_x" and "s_xz", which stand for v_x/kx and s_xz/kx

    Returns
    -------
    Response
    """
    kx = np.broadcast_to(kx, np.broadcast_shapes(omega.shape, np.shape(kx))).astype(complex, copy=False)
    front, behind = (as_columns(f) for f in (before, after))
    assert isinstance(front, FluidValues)
    z = np.empty(0) if z is None else np.asarray(z, float)
    solid = after if isinstance(after, SolidHalfSpace) else None
    if solid and quantity in OVER_KX:
        kx = without_zero(kx, omega)
    in_front = z < _depth(segments) if solid else np.ones(z.shape, bool)
    kz1, near, stations = _near(segments, front, behind, omega, kx, z[in_front])
    ikz = 1j * kz1
    by_p, by_q = ikz * near.p, front.rho_z * near.q
    waves = Waves(by_p + by_q, by_p - by_q, 2 * ikz)
    grazing = kz1 == 0
    if isinstance(behind, FluidValues) and np.any(grazing):
        waves = _at_grazing(waves, grazing, near, (front, behind), segments, omega)
    with np.errstate(all="ignore"):  # api/ refuses what is not finite
        per_incident = waves.transmitted / waves.incident
        t = per_incident * np.exp(-near.log)
        r = waves.reflected / waves.incident
        inside, both = np.empty((kx.shape[0], 0, kx.shape[1]), complex), None
        if z[in_front].size and quantity == "p":
            inside = fill_interior(stations, omega, kx, z[in_front], near.log, per_incident)
        elif z[in_front].size:
            inside = fill_velocity(stations, omega, kx, z[in_front], near.log, per_incident, quantity)
        if solid:
            both = solid_half_space.amplitudes(solid, omega, kx, near.log) * per_incident
            t = solid_half_space.total(solid, omega, kx, both, "p")
            joined = np.empty((kx.shape[0], z.size, kx.shape[1]), complex)
            joined[:, in_front] = inside
            depth = z[~in_front] - _depth(segments)
            joined[:, ~in_front] = (
                solid_half_space.inside(solid, omega, kx, depth, near.log, quantity) * per_incident[:, None]
            )
            inside = joined
        wall = _wall(segments, far=quantity != "p")
        if np.any(np.isfinite(wall)):
            blocked = np.isfinite(wall) & (kx != 0)
            t = np.where(blocked, 0.0, t)
            inside = np.where(blocked[:, None] & (z[:, None] >= wall[:, :, None]), 0.0, inside)
    return Response(r, t, inside, both)


def transmitted_flux(
    before: FluidValues,
    after: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
    response: Any,
) -> np.ndarray:
    """2 w times the power along z behind, at real kx, for unit incident p: (F, n)."""
    kx = np.broadcast_to(kx, response.t.shape)
    if isinstance(after, SolidHalfSpace):
        assert response.waves is not None
        return solid_half_space.flux(after, omega, kx, response.waves)
    fluid = FluidValues(*(v[:, None] for v in (before if _alike(before, after) else after)))
    return np.asarray(np.abs(response.t) ** 2 * (outgoing_kz(kx, omega, *fluid) / fluid.rho_z).real)


#: Quantities that are odd in kx, and told over kx.
OVER_KX = ("v_x", "s_xz")


def as_columns(half_space: FluidValues | SolidHalfSpace) -> FluidValues | SolidHalfSpace:
    """A fluid's values as (F, 1)."""
    return FluidValues(*(v[:, None] for v in half_space)) if isinstance(half_space, FluidValues) else half_space


def _depth(segments: list[SegmentValues]) -> float:
    return float(sum(s.periods * s.layers.thickness.sum() for s in segments))


def _alike(front: FluidValues, behind: FluidValues) -> bool:
    """Whether both half-spaces are the same at all frequencies."""
    return all(bool((a == b).all()) for a, b in zip(front, behind, strict=True))


def _wall(segments: list[SegmentValues], far: bool = False) -> np.ndarray:
    """(F, 1): depth of the first layer whose isotropic density is exactly zero: p = 0 from there on unless kx = 0; or inf.

    In it dp/dz = rho q = 0, while dq/dz = (kx^2/rho - w^2/K) p is finite for p = 0 alone: the velocity ends at its `far` face,
    for p/rho is finite in a fluid without mass, which flows as a potential does.
    """
    wall, start = np.full(1, np.inf), 0.0
    for layers, periods in segments:
        d = layers.thickness.reshape(len(layers.thickness), -1)
        faces = start + np.cumsum(np.concatenate([0 * d[:1], d]), axis=0)
        wall = np.minimum(wall, np.min(np.where(layers.vanishing, faces[1:] if far else faces[:-1], np.inf), axis=0))
        start = start + periods * layers.thickness.sum(axis=0)
    return wall[:, None]


def _at_grazing(
    waves: Waves,
    grazing: np.ndarray,
    near: State,
    half_spaces: tuple[FluidValues, FluidValues],
    segments: list[SegmentValues],
    omega: np.ndarray,
) -> Waves:
    """The waves at kz_before = 0 exactly, where r and t may be 0/0.

    In general q at the near face is not zero, and r = -1, t = 0 follow from the formulas. Where q vanishes with kz (no
    slab, or one matched at grazing, with equal half-spaces) the matrix is [[P, .], [0, 1/P]] and
    ``t = 2/(P + 1/P)``, ``r = (P - 1/P)/(P + 1/P)``. q counts as zero where it is within its rounding error.
    """
    rounding = sum(s.periods * np.abs(s.layers.compliance).sum(axis=0) for s in segments)[:, None] * np.abs(omega) ** 2
    equal = np.all([np.equal(a, b) for a, b in zip(*half_spaces, strict=True)], axis=0)
    zero = grazing & equal & (np.abs(near.q) <= 1e-12 * rounding * np.abs(near.p))
    with np.errstate(over="ignore"):
        inverse = np.where(zero, np.exp(-2 * near.log) / np.where(near.p == 0, 1.0, near.p), 0)
    return Waves(
        np.where(zero, near.p + inverse, waves.incident),
        np.where(zero, near.p - inverse, waves.reflected),
        np.where(zero, 2.0, waves.transmitted),
    )
