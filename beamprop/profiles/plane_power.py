"""Power that a beam carries through planes: by Parseval an integral over real kx of the flux of each plane wave along z.

``P(z) = (1/2) Re integral p v_z* dx = (1/4 pi) Re integral |S|^2 H_p H_v* dkx``, less s_xz v_x* in solids. Without loss a wave that propagates in neither half-space carries
none, but for guided modes: what a beam feeds into those runs along x for ever and is left out. With loss it is
absorbed on the way, and all kx of the source count.
"""

from __future__ import annotations

import math
from collections.abc import Callable

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
#: The most nodes of a first sum: a few seconds.
MOST_NODES = 60_000
#: Rounding of a sum of fluxes, whose real part alone is power, over the sum of their sizes.
ROUNDING = 1e-14


def power_through_planes(
    s: SampledSlab, beam: Beam, z: np.ndarray, rtol: float, period: float | None
) -> tuple[np.ndarray, PowerError]:
    """Power through planes z (Z,) per metre along y [W/m], and its largest estimated error over the beam's incident power.

    Of a periodic array of beams it is the power through one period, a sum of its orders, and no error is known.
    """
    # in a half-space without loss it does not change with z
    front, behind = s.lossless_outside
    z = np.clip(z, 0.0 if front else -math.inf, s.thickness if behind else math.inf)
    planes, which = np.unique(z, return_inverse=True)
    parts = [_through_planes(s, beam, planes[i : i + PLANES], rtol, period) for i in range(0, planes.size, PLANES)]
    power = np.concatenate([part[0] for part in parts])
    return power[which], max((part[1] for part in parts), key=lambda error: error.total)


def _through_planes(
    s: SampledSlab, beam: Beam, z: np.ndarray, rtol: float, period: float | None
) -> tuple[np.ndarray, PowerError]:
    """`power_through_planes` for planes that are held together."""

    def flux(kx: np.ndarray, shift: float) -> np.ndarray:
        k = kx.astype(complex)
        launched = sum(np.abs(beam.spectrum(sign * k, s.k0)) ** 2 for sign in (1, -1)) / (4 * math.pi)
        out = np.empty((z.size + 1, k.size), complex)
        block = max(1, VALUES // out.shape[0])
        for start in range(0, k.size, block):
            part = slice(start, start + block)
            out[:-1, part] = transfer_function.flux(s, k[part], z, beam.z0, shift)
        out[-1] = s.velocity(k, "v_z")[0].real  # of the incident beam on its launch plane
        return out * launched

    if period is not None:
        contour = periodic_contour(period, max(map(abs, beam.band(s.k0, 1e-8))))  # of |S|^2
        total = 2 * math.pi * (flux(contour.k.real, 0.0)[:-1].real @ contour.weight)
        return total, PowerError(math.nan)
    end = _last_kx(s, beam, rtol)
    way = s.thickness + max(float(z[-1]) - s.thickness, 0.0) + max(-float(z[0]), 0.0)
    count = 200 + 2 * end * beam.reach(1e-6) + 2 * float(s.last_branch) * way
    if count > MOST_NODES:
        raise ValueError(
            f"variables: expected power_through of at most {MOST_NODES:.3g} plane waves, got {count:.2g}: take a thinner slab, or bring the "
            "launch plane of a source with sharp edges to a distance from a slab with loss"
        )
    memory.check_contour(count * (FINE + COARSE) / FINE, planes=z.size)
    return _integrated(flux, end, [b for b in s.real_branches if b < end], count, rtol)


def _last_kx(s: SampledSlab, beam: Beam, rtol: float) -> float:
    """|kx| beyond which no plane wave carries power, or none of the source is left."""
    if not beam.entire:
        return float(s.k0)
    if s.lossless and len(s.real_branches) >= 2:
        return float(s.last_branch)
    # fluxes fall off as |S|^2, and as the square of what an evanescent wave has decayed by at the slab
    tolerance, last = 0.1 * math.sqrt(rtol), float(s.last_branch)
    arriving = math.hypot(last, math.log(tolerance) / beam.z0) if beam.z0 else math.inf
    return max(min(max(map(abs, beam.band(s.k0, tolerance))), arriving), 1.0001 * last)


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
