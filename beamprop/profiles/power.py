"""Power that plane waves carry into a half-space: integrals over real kx, resolved wherever the response is sharp.

|h|^2 is not an analytic function of kx, so that no contour passes its resonances at a distance: panels on the real axis are
halved towards them. Each panel is summed by two Gauss rules. Even where neither has a node inside of a narrow resonance they
tell of it, for its tails, a pole next to the axis, are not the polynomial that both integrate. |h|^2 may have no such tails, in a
narrow minimum of the reflection say, but h does.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import memory
from ..contour.paths import slow_ends

#: kx (n,), real and >= 0 -> what waves of kx and of -kx carry, per kx, the response h weighted by what was launched, and whatever else is to
#: be integrated: (3 + m, n).
Density = Callable[[np.ndarray], np.ndarray]

#: Nodes of both rules on a panel (experiments/benchmarks/constants.py: fewer or more take about the same time).
FINE, COARSE = 24, 17
#: Panels are halved until the two rules differ by this share of the requested accuracy, since tails show less than what they are of;
#: the least it may be, what rounding leaves of a sum; and the most panels there may be.
SHARE, LEAST, MOST_PANELS = 1e-3, 1e-13, 5_000


class PowerError(NamedTuple):
    """The estimated relative error of a power by its terms."""

    rules: float = 0.0  #: difference of two Gauss rules
    rounding: float = 0.0  #: change with the last bits of the input

    @property
    def total(self) -> float:
        """The sum of all terms."""
        return sum(self)

    @property
    def largest(self) -> str:
        """The largest term in words."""
        return ("the difference between two quadrature rules", "the rounding of the response")[self.index(max(self))]

    def plus(self, second: PowerError) -> PowerError:
        """The error of a ratio of two powers."""
        return PowerError(self.rules + second.rules, self.rounding + second.rounding)


class Radiated(NamedTuple):
    """Power, but for a constant, mean and standard deviation of its direction [degree], and the power's estimated error; the m further
    integrals over the power."""

    total: float
    mean: float
    deviation: float
    error: PowerError
    means: np.ndarray = np.empty(0)


NOTHING = Radiated(0.0, math.nan, math.nan, PowerError())


class _Nodes(NamedTuple):
    """Nodes of both rules on panels, (P, FINE + COARSE) each, kx = k sin(alpha)."""

    kx: np.ndarray
    alpha: np.ndarray  #: [rad]
    slope: np.ndarray  #: dkx/du

    @property
    def fine(self) -> np.ndarray:
        """Which of all nodes belong to the finer rule, (P (FINE + COARSE),)."""
        return np.tile(np.arange(FINE + COARSE) < FINE, self.kx.shape[0])


class _Sums(NamedTuple):
    """Sums on panels."""

    moments: (
        np.ndarray
    )  #: power, first and second moment of its direction about a reference, and further integrals, (3 + m, P)
    apart: np.ndarray  #: by how much both rules for the power and for the response differ, (2, P)
    rounding: np.ndarray  #: by how much the power and the response move with the last bits of the input, (2, P)
    response: np.ndarray  #: sum of the response, (P,)


def radiated(density: Density, moved: Density, k: float, breaks: list[float], count: float, rtol: float) -> Radiated:
    """The integral of a density over all plane waves that propagate, |kx| < k.

    `moved` is the density with the last bits of what it depends on moved; `breaks` are branch points below k; `count` is how many
    nodes the density needs where nothing is sharp.
    """
    memory.check_contour(count * (FINE + COARSE) / FINE)
    edges = np.arcsin(np.unique([0.0, *(b / k for b in breaks if 0 < b < k), 1.0]))
    even = np.linspace(0, 1, max(2, math.ceil(count / FINE)) + 1)
    start = np.add.outer(np.arange(edges.size - 1), even[:-1]).ravel()
    stop = np.add.outer(np.arange(edges.size - 1), even[1:]).ravel()

    def values(start: np.ndarray, stop: np.ndarray) -> tuple[_Nodes, np.ndarray, np.ndarray, np.ndarray]:
        nodes = nodes_of(k, edges, start, stop)
        return nodes, density(nodes.kx.ravel()), moved(nodes.kx.ravel()[nodes.fine]), stop - start

    panels = values(start, stop)
    first_look = _summed(*panels, 0.0).moments.sum(axis=1)
    reference = float(first_look[1] / first_look[0]) if first_look[0] > 0 else 0.0
    sums = _summed(*panels, reference)
    while start.size < MOST_PANELS:
        sizes = np.array([[sums.moments[0].sum()], [np.abs(sums.response).sum()]])
        allowed = max(SHARE * rtol, LEAST) * sizes / math.sqrt(start.size)
        split = np.any(sums.apart > np.maximum(allowed, np.abs(sums.rounding)), axis=0)
        if not np.any(split):
            break
        middle = (start + stop)[split] / 2
        halves = np.concatenate([start[split], middle]), np.concatenate([middle, stop[split]])
        more = _summed(*values(*halves), reference)
        start, stop = (np.concatenate([old[~split], new]) for old, new in zip((start, stop), halves, strict=True))
        sums = _Sums(*(np.concatenate([old[..., ~split], new], -1) for old, new in zip(sums, more, strict=True)))
    total, first, second, *more = sums.moments.sum(axis=1)
    if not total > 0:
        return NOTHING
    mean = first / total
    error = PowerError(float(sums.apart[0].sum() / total), float(abs(sums.rounding[0].sum()) / total))
    return Radiated(
        float(total),
        float(reference + mean),
        math.sqrt(max(second / total - mean**2, 0.0)),
        error,
        np.array(more) / total,
    )


def nodes_of(k: float, edges: np.ndarray, start: np.ndarray, stop: np.ndarray) -> _Nodes:
    """Nodes on panels that are parts of i < i + u < i + 1, which maps to alpha between edges i and i + 1.

    Next to branch points alpha goes as u^2, which takes out their square roots.
    """
    first = np.floor(start).astype(int)
    g = np.concatenate([rule_of(FINE)[0], rule_of(COARSE)[0]])
    u = (start - first)[:, None] + (stop - start)[:, None] * (g + 1) / 2
    alpha, slope = np.empty(u.shape), np.empty(u.shape)
    for i in range(edges.size - 1):
        own, width = first == i, edges[i + 1] - edges[i]
        share, steep = slow_ends(u[own], i > 0, i < edges.size - 2)
        alpha[own], slope[own] = edges[i] + width * share, width * steep
    return _Nodes(k * np.sin(alpha), alpha, k * np.cos(alpha) * slope)


def rule_of(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss's rule on -1 to 1."""
    g, v = np.polynomial.legendre.leggauss(count)
    return g, v


def _summed(nodes: _Nodes, plain: np.ndarray, moved: np.ndarray, width: np.ndarray, about: float) -> _Sums:
    """Sums of densities, plain at all nodes and moved in their last bits at those of the finer rule, (3 + m, n)."""
    right, left, response, *more = plain.reshape(-1, *nodes.kx.shape) * nodes.slope
    right, left = right.real, left.real
    angle = np.degrees(nodes.alpha)
    off, across = angle - about, -angle - about
    v, half = rule_of(FINE)[1], width / 2
    of_direction = right + left, right * off + left * across, right * off**2 + left * across**2
    moments = np.stack([*of_direction, *(values.real for values in more)])[..., :FINE] @ v * half
    both = np.stack([right + left, response])
    fine, coarse = both[..., :FINE] @ v * half, both[..., FINE:] @ rule_of(COARSE)[1] * half
    changed = moved[:3].reshape(3, -1, FINE) * nodes.slope[:, :FINE]
    changed = np.stack([changed[0] + changed[1], changed[2]]) @ v * half - fine
    rounding = np.stack([changed[0].real, np.abs(changed[1])])
    return _Sums(moments, np.abs(fine - coarse), rounding, fine[1])
