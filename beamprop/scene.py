"""A slab evaluated at one or several frequencies: the arrays that modes, fields and widths are computed from."""

from __future__ import annotations

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
    branches: tuple[Any, ...]  # |kx| of the branch points, shaped like k0


def scene(slab: Slab, frequency: float) -> Scene:
    """Evaluate a slab at one frequency; refuse half-spaces in which the question has no answer."""
    s = scenes(slab, np.array([frequency]))
    return s._replace(k0=float(s.k0[0]), branches=tuple(float(b[0]) for b in s.branches))


def scenes(slab: Slab, f: np.ndarray) -> Scene:
    """Evaluate a slab at frequencies (F,)."""
    branches = []
    for name, fluid in (("before", slab.before), ("after", slab.after)):
        k = fluid.wavenumber(f).real
        bad = (k < 0) | ((k == 0) | np.isinf(k) if name == "before" else False)
        if np.any(bad):
            raise ValueError(
                f"{name}: expected a half-space that carries forward waves at {f[bad][0]} Hz, got {fluid!r}"
            )
        if np.all((k > 0) & np.isfinite(k)):
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
        k0, branches = float(k0[0]), [float(b[0]) for b in branches]
    return Scene(segments, before, after, s.omega[rows], s.thickness, k0, tuple(branches))


def layers_at(layers: LayerValues, rows: np.ndarray) -> LayerValues:
    """Some frequencies of a cell's values."""
    mass, compliance, mobility, vanishing = (
        v[:, rows] for v in (layers.mass, layers.compliance, layers.mobility, layers.vanishing)
    )
    return LayerValues(mass, compliance, mobility, layers.thickness, vanishing)
