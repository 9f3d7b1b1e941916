"""Power that a beam carries through planes: by Parseval an integral over real kx of the flux of each plane wave along z.

``P(z) = (1/2) Re integral p v_z* dx = (1/4 pi) Re integral |S|^2 H_p H_v* dkx``, less s_xz v_x* in solids. Without loss a wave that propagates in neither half-space carries
none, but for guided modes: what a beam feeds into those runs along x for ever and is left out. With loss it is
absorbed on the way, and all kx of the source count. In three dimensions kx is the length of the wavevector in the
plane: see `space_power`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import memory
from ..contour.error import SHIFT
from ..contour.paths import periodic_contour
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..sources.base import Beam
from .power import COARSE, FINE, LEAST, MOST_PANELS, SHARE, PowerError, nodes_of, rule_of

#: kx (n,), real, and a shift of its last bits -> what waves of kx and -kx carry along z through each plane, per kx: (Z, n).
Flux = Callable[[np.ndarray, float], np.ndarray]
#: Planes whose waves are held at a time, and values of them.
PLANES, VALUES = 64, 2_000_000
#: The most nodes of a first sum, and of it times directions: a few seconds.
MOST_NODES, MOST_DIRECTIONS = 60_000, 200_000_000
#: Rounding of a sum of fluxes, whose real part alone is power, over the sum of their sizes.
ROUNDING = 1e-14


class Launched(NamedTuple):
    """What is asked of a source: plane waves by |kx|, or in three dimensions by |k|, their length in the plane."""

    #: |k| (n,), and a shift of last bits -> what power is the integral of, times a flux: (n,)
    strength: Callable[[np.ndarray, float], np.ndarray]
    z0: float
    #: tolerance -> |k| beyond which |S| is below it, over its largest value; infinite where it does not end
    ends: Callable[[float], float]
    reach: float
    directions: Callable[[float], int] = lambda k: 1  #: over how many a mean is taken at |k|
    entire: bool = True


def power_through_planes(
    s: SampledSlab, beam: Beam, z: np.ndarray, rtol: float, period: float | None
) -> tuple[np.ndarray, PowerError]:
    """Power through planes z (Z,) per metre along y [W/m], and its largest estimated error over the beam's incident power.

    Of a periodic array of beams it is the power through one period, a sum of its orders, and no error is known.
    """

    def strength(kx: np.ndarray, shift: float) -> np.ndarray:
        return np.asarray(sum(np.abs(beam.spectrum(v + 0j, s.k0)) ** 2 for v in (kx, -kx)) / (4 * math.pi))

    def ends(tolerance: float) -> float:
        return max(map(abs, beam.band(s.k0, tolerance)))

    if period is not None:
        contour = periodic_contour(period, ends(1e-8))  # of |S|^2
        kx = contour.k.real
        return through_orders(s, beam.z0, z, kx, 2 * math.pi * strength(kx, 0.0) * contour.weight)
    return through_planes(s, Launched(strength, beam.z0, ends, beam.reach(1e-6), entire=beam.entire), z, rtol)


def through_planes(s: SampledSlab, launched: Launched, z: np.ndarray, rtol: float) -> tuple[np.ndarray, PowerError]:
    """Power of what is launched through planes z (Z,), and its largest estimated error over the incident power."""
    return _by_parts(s, z, lambda planes: _through_planes(s, launched, planes, rtol))


def through_orders(
    s: SampledSlab, z0: float, z: np.ndarray, k: np.ndarray, strength: np.ndarray
) -> tuple[np.ndarray, PowerError]:
    """Power through planes z (Z,), a sum over plane waves |k| (n,) launched on z0, of which no error is known."""

    def summed(planes: np.ndarray) -> tuple[np.ndarray, PowerError]:
        return _carried(s, z0, planes, k, 0.0)[:-1].real @ strength, PowerError(math.nan)

    return _by_parts(s, z, summed)


def _by_parts(
    s: SampledSlab, z: np.ndarray, ask: Callable[[np.ndarray], tuple[np.ndarray, PowerError]]
) -> tuple[np.ndarray, PowerError]:
    """Power through planes, asked for some at a time."""
    planes, which = np.unique(where_it_changes(s, z), return_inverse=True)
    parts = [ask(planes[i : i + PLANES]) for i in range(0, planes.size, PLANES)]
    power = np.concatenate([part[0] for part in parts])
    return power[which], max((part[1] for part in parts), key=lambda error: error.total)


def where_it_changes(s: SampledSlab, z: np.ndarray) -> np.ndarray:
    """Planes that the same power passes as planes z (Z,): in a half-space without loss the face."""
    front, behind = s.lossless_outside
    return np.clip(z, 0.0 if front else -math.inf, s.thickness if behind else math.inf)


def _carried(s: SampledSlab, z0: float, z: np.ndarray, k: np.ndarray, shift: float) -> np.ndarray:
    """Flux of plane waves |k| (n,) of unit p on z0 through planes z (Z,), last of the incident ones: (Z + 1, n)."""
    out = np.empty((z.size + 1, k.size), complex)
    block = max(1, VALUES // out.shape[0])
    for start in range(0, k.size, block):
        part = slice(start, start + block)
        kx = k[part].astype(complex)
        out[:-1, part] = transfer_function.flux(s, kx, z, z0, shift)
        out[-1, part] = s.velocity(kx, "v_z")[0].real
    return out


def _through_planes(s: SampledSlab, launched: Launched, z: np.ndarray, rtol: float) -> tuple[np.ndarray, PowerError]:
    """`through_planes` for planes that are held together."""

    def flux(k: np.ndarray, shift: float) -> np.ndarray:
        return _carried(s, launched.z0, z, k, shift) * launched.strength(k, shift)

    end = last_k(s, launched, z, rtol)
    way = s.thickness + max(float(z[-1]) - s.thickness, 0.0) + max(-float(z[0]), 0.0)
    count = 200 + 2 * end * launched.reach + 2 * float(s.last_branch) * way
    if count > MOST_NODES:
        raise ValueError(
            f"variables: expected power_through of at most {MOST_NODES:.3g} plane waves, got {count:.2g}: "
            "take a thinner slab, or bring the launch plane of a source with sharp edges to a distance "
            "from a slab with loss"
        )
    if (waves := count * launched.directions(end)) > MOST_DIRECTIONS:
        raise ValueError(
            f"variables: expected power_through of at most {MOST_DIRECTIONS:.3g} plane waves in all directions, "
            f"got {waves:.2g}: take a narrower source or a thinner slab"
        )
    memory.check_contour(count * (FINE + COARSE) / FINE, planes=z.size)
    return _integrated(flux, end, [b for b in s.real_branches if b < end], count, rtol)


def last_k(s: SampledSlab, launched: Launched, z: np.ndarray, rtol: float) -> float:
    """|k| beyond which no plane wave carries power through planes z, or none of the source is left."""
    if not launched.entire:
        return float(s.k0)
    if s.lossless and len(s.real_branches) >= 2:
        return float(s.last_branch)
    # fluxes fall off as |S|^2, and as the square of what an evanescent wave has decayed by
    # at the slab, or at a plane in front with loss
    tolerance, last, way = 0.1 * math.sqrt(rtol), float(s.last_branch), min(float(z.min()), 0.0) - launched.z0
    arriving = math.hypot(last, math.log(tolerance) / way) if way > 0 else math.inf
    return max(min(launched.ends(tolerance), arriving), 1.0001 * last)


def _integrated(
    flux: Flux, end: float, breaks: list[float], count: float, rtol: float
) -> tuple[np.ndarray, PowerError]:
    """Real part of the integral of a flux from 0 to `end` on its planes (Z,), and the largest error over that of its last row.

    Panels are halved until two Gauss rules differ by no more than is allowed; see `power`, whose panels these are.
    """
    edges = np.arcsin(np.unique([0.0, *(b / end for b in breaks), 1.0]))
    even = np.linspace(0, 1, max(2, math.ceil(count / FINE)) + 1)
    start = np.add.outer(np.arange(edges.size - 1), even[:-1]).ravel()
    stop = np.add.outer(np.arange(edges.size - 1), even[1:]).ravel()

    def sums(start: np.ndarray, stop: np.ndarray) -> np.ndarray:
        """Integrals by the finer rule, what they differ by from the coarser one's, their change with the last bits, and sizes: (4, Z + 1, P)."""
        nodes, half = nodes_of(end, edges, start, stop), (stop - start) / 2
        values = flux(nodes.kx.ravel(), 0.0).reshape(-1, *nodes.kx.shape) * (nodes.slope * half[:, None])
        moved = flux(nodes.kx[:, :FINE].ravel(), SHIFT).reshape(values.shape[0], -1, FINE)
        moved = moved * (nodes.slope[:, :FINE] * half[:, None]) @ rule_of(FINE)[1]
        fine, coarse = values[..., :FINE] @ rule_of(FINE)[1], values[..., FINE:] @ rule_of(COARSE)[1]
        return np.stack([fine, fine - coarse, moved - fine, np.abs(values[..., :FINE]) @ rule_of(FINE)[1]])

    panels = sums(start, stop)
    while start.size < MOST_PANELS:
        incident = panels[0, -1].real.sum()
        allowed = max(SHARE * rtol, LEAST) * incident / math.sqrt(start.size)
        rounding = np.maximum(np.abs(panels[2]), ROUNDING * np.abs(panels[3]))
        split = np.any(np.abs(panels[1]) > np.maximum(allowed, rounding), axis=0)
        if not np.any(split):
            break
        middle = (start + stop)[split] / 2
        halves = np.concatenate([start[split], middle]), np.concatenate([middle, stop[split]])
        panels = np.concatenate([panels[..., ~split], sums(*halves)], axis=-1)
        start, stop = (np.concatenate([old[~split], new]) for old, new in zip((start, stop), halves, strict=True))
    total = panels[0].real.sum(axis=-1)
    rules, rounding = np.abs(panels[1].real).sum(axis=-1), np.abs(panels[2].real.sum(axis=-1))
    worst, incident = int(np.argmax(rules + rounding)), float(total[-1])
    scale = 1 / incident if incident > 0 else math.inf
    return total[:-1], PowerError(scale * float(rules[worst]), scale * float(rounding[worst]))
