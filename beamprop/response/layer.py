"""One layer: its matrix as entire functions, and a state carried back through it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..media.fluids import FluidValues
from ..media.solids import SolidBlock, SolidLayers
from ..media.values import LayerValues, SegmentValues

#: Growth in nepers from which a layer's matrix is scaled. Below, exp(2 * 30) is far from overflow.
SCALE_FROM = 30.0


class Entire(NamedTuple):
    """exp(-growth) times (1, cos(sqrt u) - 1, sin(sqrt u)/sqrt u); growth is None where it is zero everywhere."""

    a: np.ndarray | float
    c: np.ndarray
    s: np.ndarray
    growth: np.ndarray | None


class State(NamedTuple):
    """exp(log) (p, q)."""

    p: np.ndarray
    q: np.ndarray
    log: np.ndarray


def terms_for(size: float) -> int:
    """How many terms of the series in u full precision takes at |u| <= size < 1."""
    terms, last = 1, size / 2
    while last > 1e-17 and terms < 12:
        terms += 1
        last *= size / ((2 * terms - 1) * (2 * terms))
    return terms


def _series(u: np.ndarray, size: float) -> Entire:
    """Power series in u, in place; enough terms for full precision at |u| <= size < 1."""
    # c = -u/2! + u^2/4! - ...,  s = 1 - u/3! + u^2/5! - ...
    terms = terms_for(size)
    c = u * ((-1) ** terms / math.factorial(2 * terms))
    s = u * ((-1) ** terms / math.factorial(2 * terms + 1))
    for k in range(terms - 1, 0, -1):
        c += (-1) ** k / math.factorial(2 * k)
        c *= u
        s += (-1) ** k / math.factorial(2 * k + 1)
        s *= u
    s += 1
    return Entire(1.0, c, s, None)


def entire(u: np.ndarray) -> Entire:
    """cos(sqrt u) - 1 and sin(sqrt u)/sqrt u, scaled where they would overflow."""
    size = float(np.max(np.abs(u), initial=0.0))
    if size < 1.0:
        return _series(u, size)
    if not math.isfinite(size):
        raise ValueError(
            f"slab: expected layers whose phase squared, rho_z d^2 (w^2/K - kx^2/rho_x), is a finite number, got {size}"
        )
    w = np.sqrt(u)
    near = np.abs(w) < 1e-4
    safe, small = np.where(near, 1.0, w), np.where(near, u, 0.0)
    steep = np.abs(w.imag)
    if float(steep.max()) < SCALE_FROM:
        half = np.sin(w / 2)
        s = np.where(near, 1 - small / 6 + small * small / 120, 2 * half * np.cos(w / 2) / safe)
        return Entire(1.0, -2 * half * half, s, None)
    growth = np.where(steep < SCALE_FROM, 0.0, steep)
    calm = entire(np.where(growth > 0, 0.0, u))
    up, down = np.exp(1j * w - growth), np.exp(-1j * w - growth)
    a = np.exp(-growth)
    c = np.where(growth > 0, (up + down) / 2 - a, calm.c)
    s = np.where(growth > 0, (up - down) / (2j * safe), calm.s)
    return Entire(a, c, s, growth)


def one_layer(
    layers: LayerValues, j: int, omega2: np.ndarray, kx2: np.ndarray, share: np.ndarray | float = 1.0
) -> tuple:
    """(A, B, Entire) of `share` of layer j's thickness."""
    A = layers.mass[j][:, None] * share
    B = (omega2 * layers.compliance[j][:, None] - kx2 * layers.mobility[j][:, None]) * share
    return A, B, entire(A * B)


def several_layers(layers: LayerValues, part: slice, omega2: np.ndarray, kx2: np.ndarray) -> tuple:
    """(A, B, Entire) of several layers at once: (J, F, 1), (J, F, n)."""
    A = layers.mass[part][..., None]
    b0 = omega2 * layers.compliance[part][..., None]
    b1 = -layers.mobility[part][..., None]
    B = b1 * kx2
    B += b0
    return A, B, entire(A * B)


def layer_back(state: State, A: np.ndarray, B: np.ndarray, f: Entire) -> State:
    """Carry a state back through one layer."""
    p = f.a * state.p + (f.c * state.p - A * f.s * state.q)
    q = f.a * state.q + (f.c * state.q + B * f.s * state.p)
    if f.growth is None:
        return State(p, q, state.log)
    return normalised(State(p, q, state.log + f.growth))


def normalised(state: State) -> State:
    """Take the state's size out into its logarithm."""
    size = np.abs(state.p) + np.abs(state.q)
    usual = (size > 0) & np.isfinite(size)
    if not usual.all():
        size = np.where(usual, size, 1.0)
    scale = 1 / size
    return State(state.p * scale, state.q * scale, state.log + np.log(size))


def at_frequencies(layers: LayerValues, rows: slice | np.ndarray, single: bool = False) -> LayerValues:
    """Some frequencies of a cell's values; a `single` one has the thickness (N,)."""
    mass, compliance, mobility, thickness, vanishing = (v[:, rows] if v.ndim == 2 else v for v in layers[:5])
    taken = LayerValues(mass, compliance, mobility, thickness, vanishing)
    taken = with_solids(taken, layers, lambda v, kind: v[:, rows])
    return taken._replace(thickness=taken.thickness.reshape(-1)) if single else taken


def with_solids(
    values: LayerValues, layers: LayerValues, change: Callable[[np.ndarray, int], np.ndarray]
) -> LayerValues:
    """Values with the solids of `layers`, changed: `change(v, kind)` of the density (0), longitudinal (1) and shear modulus (2)."""
    if not layers.solids:
        return values
    solids = []
    for slot, run in layers.solids:
        solids.append((slot, changed_run(run, change)))
    return values._replace(solids=tuple(solids))


def changed_run(run: tuple[SolidBlock, ...], change: Callable[[np.ndarray, int], np.ndarray]) -> tuple[SolidBlock, ...]:
    """A run of solids with its values changed."""
    blocks = []
    for block in run:
        density, modulus, shear = (change(v, kind) for kind, v in enumerate(block.layers[:3]))
        blocks.append(block._replace(layers=SolidLayers(density, modulus, shear, block.layers.thickness)))
    return tuple(blocks)


def properties(layers: LayerValues) -> list[np.ndarray]:
    """Masses, compliances and mobilities, and densities and moduli of solids: (N, F) each."""
    solids = [v for _, run in layers.solids for block in run for v in block.layers[:3]]
    return [*layers[:3], *solids]


def with_loss(layers: LayerValues, loss: float) -> LayerValues:
    """More loss in every layer: rho -> rho + i loss |rho|, 1/K -> 1/K + i loss |1/K|."""
    mass, compliance, mobility = layers[:3]
    changed = layers._replace(
        mass=mass + 1j * loss * np.abs(mass),
        compliance=compliance + 1j * loss * np.abs(compliance),
        mobility=mobility - 1j * loss * np.abs(mobility),
    )

    return with_solids(changed, layers, solid_with_loss(loss))


def solid_with_loss(loss: float) -> Callable[[np.ndarray, int], np.ndarray]:
    """The change of a solid's density and moduli by `loss`: see `with_solids`."""
    return lambda v, kind: v + 1j * loss * np.abs(v) if kind == 0 else 1 / (1 / v + 1j * loss / np.abs(v))


def half_space_with_loss(f: FluidValues, loss: float) -> FluidValues:
    """As `with_loss`; an infinite lateral density stays infinite."""
    lateral = np.where(np.isfinite(f.rho_x), np.abs(f.rho_x), 0.0)
    rho_z, compliance = f.rho_z + 1j * loss * np.abs(f.rho_z), 1 / f.bulk_modulus
    return FluidValues(rho_z, f.rho_x + 1j * loss * lateral, 1 / (compliance + 1j * loss * np.abs(compliance)))


def perturbed(segment: SegmentValues, shift: float) -> SegmentValues:
    """Each layer's mass, compliance and mobility moved by `shift` (relative) in any direction of the complex plane.

    Directions, not signs: real changes of several properties cancel now and then, complex ones hardly ever.
    """
    layers = segment.layers
    turn = np.exp(2j * np.pi * np.random.default_rng(0).random((3, len(layers.thickness), 1)))
    mass, compliance, mobility = (
        v * (1 + shift * c) for v, c in zip((layers.mass, layers.compliance, layers.mobility), turn, strict=True)
    )
    changed = layers._replace(mass=mass, compliance=compliance, mobility=mobility)
    return segment._replace(layers=with_solids(changed, layers, solid_perturbed(shift)))


def solid_perturbed(shift: float) -> Callable[[np.ndarray, int], np.ndarray]:
    """The same of a solid's density and moduli: see `with_solids`."""
    turns = np.random.default_rng(2)
    return lambda v, kind: v * (1 + shift * np.exp(2j * np.pi * turns.random((len(v), 1))))
