"""Nodes and weights of the study's contours: Gauss-Legendre on panels, graded towards what is near."""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from .medium import Medium

GAUSS = np.polynomial.legendre.leggauss(20)


def panels(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on the panels between edges."""
    half = np.diff(edges) / 2
    return (edges[:-1, None] + half[:, None] * (GAUSS[0] + 1)).ravel(), (half[:, None] * GAUSS[1]).ravel()


class Contour(NamedTuple):
    """start -> corner - i depth -> end - i depth, straight between; start and end where the source's spectrum is negligible."""

    depth: float
    corner: float
    start: float
    end: float

    def at(self, s: np.ndarray) -> np.ndarray:
        """kx at Re kx = s."""
        return s - 1j * self.depth * np.minimum(s / self.corner, 1.0)


class Grading(NamedTuple):
    """What makes the integrand turn fast along a contour."""

    length: float  #: distance along x over which it is summed
    path: float  #: and along z
    near: tuple[complex, ...]  #: branch points and poles whose distance is known
    floor: float  #: how near to kx = 0 poles may lie


def bent_nodes(c: Contour, g: Grading, branches: list[complex]) -> tuple[np.ndarray, np.ndarray]:
    """Panels along a contour, short where the integrand turns fast and where poles or branch points are near."""
    nodes, weights = [], []
    for lo, hi, slope in ((c.start, min(c.corner, c.end), c.depth / c.corner), (max(c.corner, c.start), c.end, 0.0)):
        if hi <= lo:
            continue
        s = _samples(lo, hi, g, slope != 0)
        k = c.at(s)
        distance = np.maximum(-k.imag, g.floor) if slope else np.full(s.shape, c.depth)
        for feature in g.near:
            distance = np.minimum(distance, np.maximum(np.abs(k - feature), 1e-15 * abs(feature)))
        with np.errstate(divide="ignore"):
            fast = g.length + g.path * np.max([np.abs(k / np.sqrt(b**2 - k**2)) for b in branches], axis=0)
        density = np.minimum(fast, 1e12) / 7 + 0.7 / distance
        total = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(s))])
        u, w = panels(np.interp(np.linspace(0, 1, math.ceil(total[-1]) + 2) * total[-1], total, s))
        nodes.append(c.at(u))
        weights.append(w * (1 - 1j * slope))
    return np.concatenate(nodes), np.concatenate(weights)


def _samples(lo: float, hi: float, g: Grading, ray: bool) -> np.ndarray:
    """Where the density of panels is looked at: evenly, and by powers towards 0 and towards what is near."""
    parts = [np.linspace(lo, hi, 4001)]
    if ray:
        parts.append(np.geomspace(max(0.03 * g.floor, 1e-18 * hi), hi, 1500))
    steps = (hi - lo) * np.geomspace(1e-12, 1, 300)
    parts += [f.real + side * steps for f in g.near for side in (-1, 1)]
    s = np.concatenate(parts)
    return np.unique(np.concatenate([s[(s >= lo) & (s <= hi)], [lo, hi]]))


def real_nodes(
    m: Medium, length: float, finer: float, pinch: float = math.inf
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Panels over 0 < kx < k0 in alpha, kx = k0 sin(alpha), graded towards the branch points inside; and kz.

    Towards 0 too, where a pole or branch point is as near to it as `pinch`. Finer panels are finer there as well: two numbers
    of panels that share their graded ends agree on the same error at a resonance between them.

    Not towards k0, where alpha itself takes the root out: a kx that rounds to k0 has no response.
    """
    stops = np.arcsin(np.unique(np.clip([0, *(b / m.k0 for b in m.branches() if b < m.k0 * (1 - 1e-12)), 1], 0, 1)))
    nodes, weights, across = [], [], []
    for lo, hi in itertools.pairwise(stops):
        fine = np.linspace(lo, hi, math.ceil(finer * (4 + m.k0 * length / 6)))
        ratio = 2 ** (1 / finer)  # of neighbouring panels
        end = min(2.0**-26, 1e-3 * pinch / m.k0)
        steep = (hi - lo) * ratio ** -np.arange(math.log(2, ratio), math.log(1 / end, ratio))
        graded = [lo + steep] * int(lo > 0 or pinch < math.inf) + [hi - steep] * int(hi < stops[-1])
        a, w = panels(np.unique(np.concatenate([fine, *graded])))
        nodes.append(m.k0 * np.sin(a))
        weights.append(m.k0 * np.cos(a) * w)
        across.append(m.k0 * np.cos(a))
    return np.concatenate(nodes).astype(complex), np.concatenate(weights).astype(complex), np.concatenate(across)
