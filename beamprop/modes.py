"""Guided modes of a slab: zeros of the dispersion function in the plane of complex kx, found by the argument principle.

Loss moves a mode off the real axis: up if it carries energy along Re kx (forward), down if against it (backward, which
negative densities allow). A mode of a lossless slab lies on the axis, and is told apart by the way it moves when a
trace of loss is added. The path of integration of a field passes below the real axis on the right; the modes between the
axis and the path that belong below are on its wrong side, and small circles around them put that right.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from .response import dispersion
from .roots import CLUSTER, Box, Dispersion, TooManyModes, outlines, real_zeros, refine, winding, windings, zeros
from .scene import Scene, at_frequency
from .spectral import Line

#: Relative loss by which modes are told apart: rho -> rho + i LOSS |rho|, 1/K -> 1/K + i LOSS |1/K|. Small, for a slab
#: whose densities cancel feels it magnified.
LOSS = 1e-8
#: A box of the search begins this far (relative) to the right of the last branch point.
BESIDE = 1e-8

#: A mode nearer to the real axis than this, over k0, may be on either side by rounding: a layer without loss beside others with.
ON_AXIS = 1e-10

#: A path leaves at most so many modes on its wrong side, and the search for them takes at most so many values of D.
MOST_WRONG = 24
MOST_VALUES = 100_000


class Mode(NamedTuple):
    """One zero: kx [rad/m], +1 forward or -1 backward, and the last step of its refinement over kx."""

    kx: complex
    direction: int
    residual: float


def dispersion_of(s: Scene, loss: float = 0.0) -> Dispersion:
    """D of a scene at one frequency, its layers made more lossy by `loss`."""
    segments = [] if loss else s.segments
    for values in s.segments if loss else ():
        layers = values.layers
        lossy = layers._replace(
            mass=layers.mass + 1j * loss * np.abs(layers.mass),
            compliance=layers.compliance + 1j * loss * np.abs(layers.compliance),
            mobility=layers.mobility - 1j * loss * np.abs(layers.mobility),
        )
        segments.append(values._replace(layers=lossy))

    def evaluate(kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = dispersion(segments, s.before, s.after, s.omega, np.asarray(kx, complex)[None])
        return value[0], log[0]

    return evaluate


def may_guide_backward(s: Scene) -> bool:
    """Whether some layer has a negative density or modulus: without, every mode is a forward one."""
    return any(
        bool(np.any(v.real < 0))
        for values in s.segments
        for v in (values.layers.mass, values.layers.mobility, values.layers.compliance)
    ) and not any(bool(np.any(values.layers.vanishing)) for values in s.segments)


def is_lossless(s: Scene) -> bool:
    """Whether no layer and no half-space has loss."""
    values = [v for seg in s.segments for v in (seg.layers.mass, seg.layers.compliance, seg.layers.mobility)]
    return not any(np.any(v.imag) for v in (*values, *s.before, *s.after))


def find_modes(s: Scene, box: Box, most: float = math.inf) -> tuple[list[Mode], int]:
    """All modes in a box, and how many the argument principle counts; `most`: see `zeros`."""
    f = dispersion_of(s)
    total = winding(f, box.outline(48), 1e-9 * box.right, most)
    found = _located(s, box, total, most=most) if total > 0 else []
    modes = [m._replace(residual=refine(f, m.kx, 1e-3 * abs(m.kx), 2)[1] / abs(m.kx)) for m in _told(s, found)]
    return sorted(modes, key=lambda m: m.kx.real), total


def _located(s: Scene, box: Box, total: int, many: float = math.inf, most: float = math.inf) -> list[complex]:
    """The `total` zeros of a box, those of a lossless slab on the axis by changes of sign if that finds them all.

    TooManyModes where more than `many` have to be found otherwise, or it takes too long (`most`: see `zeros`).
    """
    f = dispersion_of(s)
    if is_lossless(s) and box.low < 0 < box.high:
        for samples in (600, 4800, 38_400):
            found = real_zeros(f, box.left, box.right, samples, 8 * many)
            if len(found) >= total:
                return found
    if total > many:
        raise TooManyModes
    return zeros(f, box, box.right, total, most)


def _told(s: Scene, found: list[complex]) -> list[Mode]:
    """Zeros as modes, forward or backward."""
    return [Mode(k, _direction(s, k, found.count(k) > 1), 0.0) for k in found]


def _direction(s: Scene, k: complex, cluster: bool = False) -> int:
    """+1 where the mode decays, or would with a trace of loss, along +Re kx."""
    # a cluster is known to half the digits only, and takes more loss to be told
    blur, loss = (1e-7, 1e3 * LOSS) if cluster else (1e-9, LOSS)
    if abs(k.imag) > blur * abs(k):
        return 1 if k.imag > 0 else -1
    moved, _ = refine(dispersion_of(s, loss), k, 1e-4 * abs(k))
    if cluster and abs((moved - k).imag) < blur * abs(k):
        raise TooManyModes
    return 1 if (moved - k).imag >= 0 else -1


class Between(NamedTuple):
    """Modes that a path below the axis on the right leaves on its wrong side, and the radii of discs that hold no other."""

    wrong: tuple[complex, ...]
    radii: tuple[float, ...]


NONE = Between((), ())
#: Steps along an outline, over its largest Re kx, that are not halved further: a zero lies on it.
FINEST = 1e-12
#: More modes than can be told apart.
UNCLEAR = Between((complex("nan"),), (0.0,))


def between(s: Scene, depth: float, band: float) -> Between:
    """Modes below the real axis (or on it, but backward) and above a path at `depth` below it, 0 < Re kx < band."""
    if not may_guide_backward(s):
        return NONE
    start, edge, above = 1e-3 * s.k0, max(s.branches) * (1 + BESIDE), ON_AXIS * s.k0
    try:
        if is_lossless(s):
            above = depth
        elif not _any_mode(s, Box(start, band, -depth, 0.0), edge, above):
            return NONE
        found = _few_modes(s, Box(start, min(edge, band), -depth, 0.0))
        if band > edge:
            found += _few_modes(s, Box(edge, band, -depth, above))
        groups = _grouped([m.kx for m in found if m.direction < 0])
        middles = tuple(sum(group) / len(group) for group in groups)
        discs = (_free_disc(s, k, group, [m.kx for m in found]) for k, group in zip(middles, groups, strict=True))
        return Between(middles, tuple(discs))
    except TooManyModes:
        return UNCLEAR


def _any_mode(s: Scene, box: Box, edge: float, above: float) -> bool:
    """Whether there is a mode in a box, its upper side raised by `above` to the right of `edge`: one search, mostly in vain."""
    values = (np.array([v]) for v in (*box, min(s.branches), edge, above))
    left, right, low, high, near, beyond, lift = values
    path = outlines(left, right, low, high, 48, near, (beyond, lift))[0]
    return winding(dispersion_of(s), path, FINEST * box.right, MOST_VALUES) > 0


def _few_modes(s: Scene, box: Box) -> list[Mode]:
    """All modes of a box, those on the axis by changes of sign; TooManyModes if they are many, or not all are found."""
    total = winding(dispersion_of(s), box.outline(48, min(s.branches)), FINEST * box.right, MOST_VALUES)
    if total <= 0:
        return []
    found = _located(s, box, total, MOST_WRONG, MOST_VALUES)
    if len(found) < total:
        raise TooManyModes
    return _told(s, found)


def _grouped(modes: list[complex]) -> list[list[complex]]:
    """Modes that lie so near to each other that one circle goes around them all: a cluster is found to half the digits only."""
    groups: list[list[complex]] = []
    for k in modes:
        near = [group for group in groups if abs(k - group[0]) < 10 * CLUSTER * abs(k)]
        if near:
            near[0].append(k)
        else:
            groups.append([k])
    return groups


def _free_disc(s: Scene, k: complex, group: list[complex], others: list[complex]) -> float:
    """Radius of a disc around a group of modes that holds no other mode, known or not, and no branch point."""
    radius = 0.4 * min((abs(k - other) for other in (*others, *s.branches) if other not in group), default=abs(k))
    f, circle = dispersion_of(s), np.exp(2j * np.pi * np.arange(24) / 24)
    least = max(1e-6 * abs(k), 4 * max(abs(k - one) for one in group))
    at_least = winding(f, k + least * circle, 1e-12 * abs(k), MOST_VALUES)
    while radius > least and winding(f, k + radius * circle, 1e-9 * radius, MOST_VALUES) > at_least:
        radius /= 2
    if len(group) > 1 and radius <= least:
        raise TooManyModes
    return radius


def some_between(s: Scene, depth: np.ndarray, band: np.ndarray) -> np.ndarray:
    """Whether a path at `depth` may leave modes on its wrong side, by the argument principle at F frequencies at once: (F,).

    Of a lossless slab any mode below or on the axis counts, forward or not.
    """
    if not may_guide_backward(s):
        return np.zeros(depth.shape, bool)

    def evaluate(kx: np.ndarray, owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        part = s if owner.size == depth.size and np.array_equal(owner, everyone) else at_frequency(s, owner)
        return dispersion(part.segments, part.before, part.after, part.omega, kx)

    def count(left: np.ndarray, right: np.ndarray, low: np.ndarray, high: np.ndarray, lifted: Any = None) -> np.ndarray:
        try:
            paths = outlines(left, right, low, high, 12, near, lifted)
            return windings(evaluate, paths, FINEST * float(np.min(s.k0)), MOST_VALUES * depth.size)
        except TooManyModes:
            return np.ones(depth.shape, int)

    everyone, near = np.arange(depth.size), np.min(np.stack(s.branches), axis=0)
    zero, start = np.zeros(depth.shape), 1e-3 * s.k0
    edge = np.max(np.stack(s.branches), axis=0) * (1 + BESIDE)
    if not is_lossless(s):
        return count(start, band, -depth, zero, (edge, ON_AXIS * s.k0)) > 0
    below = count(start, np.minimum(edge, band), -depth, zero) > 0
    return below | ((band > edge) & (count(edge, np.maximum(band, 1.001 * edge), -depth, depth) > 0))


def with_circles(s: Scene, line: Line, found: Between, across: float, along: float, second: bool = False) -> Line:
    """Add to a path small clockwise circles around the modes that lie above it and should lie below.

    Trapezoid rule on a circle in the disc that holds nothing else, so small that neither e^{ikx} (over the distance `across`)
    nor e^{i kz z} (over `along`) turns or grows much on it: aliasing falls with the number of nodes as 1/n!. The `second`
    of two paths that are compared takes other circles.
    """
    count, share = (36, 0.8) if second else (32, 1.0)
    nodes, weights = [], []
    turn = np.exp(-2j * np.pi * (np.arange(count) + 0.5) / count)
    for k, free in zip(found.wrong, found.radii, strict=True):
        if k.imag > np.interp(k.real, line.k.real, line.k.imag):
            slope = max(abs(k / np.sqrt(b * b - k * k + 0j)) for b in s.branches)  # |dkz/dkx|
            radius = share * min(free, 1.0 / (across + along * slope))
            nodes.append(k + radius * turn)
            weights.append(radius * turn * (-2j * np.pi / count) / (2 * np.pi))
    if not nodes:
        return line
    # in front, so that the path's end stays the last node
    return Line(np.concatenate([*nodes, line.k]), np.concatenate([*weights, line.weight]), circles=count * len(nodes))
