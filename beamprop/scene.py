"""A slab evaluated at one or several frequencies: the arrays that modes, fields and widths are computed from."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np

from .media import FluidValues, LayerValues, SegmentValues, Slab, slab_values


class Scene(NamedTuple):
    """One slab at F frequencies, as arrays; most functions here take F = 1."""

    segments: list[SegmentValues]
    before: FluidValues
    after: FluidValues
    omega: np.ndarray  # (F, 1)
    thickness: float
    k0: Any  # float for one frequency, (F,) for several
    branches: tuple[Any, ...]  # complex kx of the branch points, Im >= 0 (Re < 0: backward waves), shaped like k0


def scene(slab: Slab, frequency: float, backward: bool = False) -> Scene:
    """Evaluate a slab at one frequency; refuse half-spaces in which the question has no answer: see `scenes`."""
    s = scenes(slab, np.array([frequency]), backward)
    return s._replace(k0=float(s.k0[0]), branches=tuple(complex(b[0]) for b in s.branches))


def scenes(slab: Slab, f: np.ndarray, backward: bool = False) -> Scene:
    """Evaluate a slab at frequencies (F,); `backward` says whether the half-space behind may carry backward waves."""
    branches = []
    for name, fluid in (("before", slab.before), ("after", slab.after)):
        k = fluid.wavenumber(f)
        # waves that decay within a wavelength run neither way: any contour passes their branch point alike
        behind = (-k.real > k.imag) & (not backward)
        bad = (k.real <= 0) | np.isinf(k) if name == "before" else behind
        if np.any(bad):
            raise ValueError(
                f"{name}: expected a half-space that carries forward waves at {f[bad][0]} Hz, got {fluid!r}"
            )
        if np.all(np.isfinite(k)):
            branches.append(k)
    return Scene(
        slab_values(slab, f),
        slab.before.at(f),
        slab.after.at(f),
        2 * np.pi * f[:, None],
        slab.thickness,
        slab.before.wavenumber(f).real,
        tuple(branches),
    )


def at_frequency(s: Scene, i: Any) -> Scene:
    """Frequency i of a scene (an index: k0 and branches become floats), or frequencies i (an array: they stay arrays)."""
    rows = np.atleast_1d(i)
    segments = [SegmentValues(layers_at(seg.layers, rows), seg.periods) for seg in s.segments]
    before, after = (FluidValues(*(v[rows] for v in f)) for f in (s.before, s.after))
    k0, branches = s.k0[rows], [b[rows] for b in s.branches]
    if np.ndim(i) == 0:
        k0, branches = float(k0[0]), [complex(b[0]) for b in branches]
    return Scene(segments, before, after, s.omega[rows], s.thickness, k0, tuple(branches))


def layers_at(layers: LayerValues, rows: np.ndarray) -> LayerValues:
    """Some frequencies of a cell's values."""
    mass, compliance, mobility, vanishing = (
        v[:, rows] for v in (layers.mass, layers.compliance, layers.mobility, layers.vanishing)
    )
    return LayerValues(mass, compliance, mobility, layers.thickness, vanishing)


def on_the_right(branch: Any) -> Any:
    """Of the branch points b and -b the one with Re kx >= 0: it lies below the axis for a half-space of backward waves."""
    return np.where(np.real(branch) < 0, -branch, branch)


def backward_branch(s: Scene) -> complex | None:
    """The branch point, with Re kx > 0, of a half-space that carries backward waves; its cut leads downward. Of one frequency."""
    return next((-b for b in s.branches if -b.real > b.imag), None)


def nearest_branch(s: Scene) -> Any:
    """Distance of the nearest branch point from kx = 0; shaped like k0."""
    return np.min(np.abs(np.stack(s.branches)), axis=0)


def last_branch(s: Scene) -> Any:
    """The largest Re kx of a branch point: guided modes lie beyond; shaped like k0."""
    return np.max(np.abs(np.real(np.stack(s.branches))), axis=0)


def real_branches(s: Scene) -> list[float]:
    """Re kx of the branch points that lie nearer to the real axis than to the imaginary one; of one frequency."""
    return [abs(b.real) for b in s.branches if abs(b.real) > abs(b.imag)]


def is_lossless(s: Scene) -> bool:
    """Whether no layer and no half-space has loss."""
    values = [v for seg in s.segments for v in (seg.layers.mass, seg.layers.compliance, seg.layers.mobility)]
    return not any(np.any(v.imag) for v in (*values, *s.before, *s.after))


def with_loss(s: Scene, loss: float) -> Scene:
    """More loss in every layer and half-space: rho -> rho + i loss |rho|, 1/K -> 1/K + i loss |1/K|."""
    if not loss:
        return s
    segments = []
    for values in s.segments:
        layers = values.layers
        lossy = layers._replace(
            mass=layers.mass + 1j * loss * np.abs(layers.mass),
            compliance=layers.compliance + 1j * loss * np.abs(layers.compliance),
            mobility=layers.mobility - 1j * loss * np.abs(layers.mobility),
        )
        segments.append(values._replace(layers=lossy))
    before, after = (
        FluidValues(
            f.rho_z + 1j * loss * np.abs(f.rho_z),
            f.rho_x + 1j * loss * np.where(np.isfinite(f.rho_x), np.abs(f.rho_x), 0.0),
            1 / (1 / f.bulk_modulus + 1j * loss * np.abs(1 / f.bulk_modulus)),
        )
        for f in (s.before, s.after)
    )
    return s._replace(segments=segments, before=before, after=after)


def up_to_wall(s: Scene) -> Scene:
    """A scene of one frequency without what lies behind its first layer of density 0, which no plane wave off the normal passes."""
    for i, (layers, _) in enumerate(s.segments):
        walls = np.flatnonzero(np.any(layers.vanishing, axis=1))
        if walls.size:
            return s._replace(segments=[*s.segments[:i], _cut(s.segments[i], 0, walls[0] + 1)])
    return s


def parts_between_walls(s: Scene) -> list[tuple[Scene, int]]:
    """The parts into which layers of density 0 divide a slab off the normal, of one frequency, and how often each is there.

    Such a layer is a soft wall, p = 0, on both sides. The first part has the half-space in front, the last one that behind; the
    others are closed, and those of a cell that is repeated are alike. Each keeps the walls that bound it; of a half-space
    behind a wall nothing is felt, and its branch point is left out.
    """
    found: list[tuple[list[SegmentValues], int]] = []
    current: list[SegmentValues] = []
    for segment in s.segments:
        walls = [int(i) for i in np.flatnonzero(np.any(segment.layers.vanishing, axis=1))]
        if not walls:
            current.append(segment)
            continue
        front, back = _cut(segment, 0, walls[0] + 1), _cut(segment, walls[-1], None)
        found.append(([*current, front], 1))
        found += [([_cut(segment, a, b + 1)], segment.periods) for a, b in itertools.pairwise(walls)]
        if segment.periods > 1:
            found.append(([back, front], segment.periods - 1))
        current = [back]
    if not found:
        return [(s, 1)]
    unfelt = FluidValues(*np.ones((3, 1)))
    parts = [(s._replace(segments=segments, before=unfelt, after=unfelt, branches=()), n) for segments, n in found]
    parts[0] = parts[0][0]._replace(before=s.before, branches=s.branches[:1]), 1
    parts.append((s._replace(segments=current, before=unfelt, branches=s.branches[1:]), 1))
    return [(part, n) for part, n in parts if not all(np.all(values.layers.vanishing) for values in part.segments)]


def _cut(segment: SegmentValues, start: int, stop: int | None) -> SegmentValues:
    """Some layers of a cell, once."""
    return SegmentValues(LayerValues(*(v[start:stop] for v in segment.layers)), 1)


def may_guide_backward(s: Scene) -> bool:
    """Whether some layer or half-space has a negative density or modulus: without, every mode is a forward one."""
    layers = (v for seg in s.segments for v in (seg.layers.mass, seg.layers.mobility, seg.layers.compliance))
    return any(bool(np.any(v.real < 0)) for v in (*layers, *s.before, *s.after))
