"""Branches of dispersion curves: which mode at a frequency continues which at the frequency before."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

#: A mode left over continues a branch left over up to so many steps of k0 away, as a group speed of a quarter of c needs, if the next of
#: both that are left is more than so many times as far, so that neither is taken for its neighbour.
SLOW, ALONE = 4, 2


def branches(k0: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Number of the branch of each mode kx (F, m) at wavenumbers k0 (F,) of the medium in front: (F, m), -1 for nan.

    Along growing k0 a branch is continued with its last slope, at first with its phase speed, and branches are given to modes so that the
    sum of their distances is least. A mode farther from its branch than the step of k0, or of the branch itself, begins a new branch,
    unless it continues a branch of which nothing else is left near: a wave of little group speed moves by several steps of k0, and its
    slope changes at once where a wave that runs forward or backward becomes one that leaks. Branches that cross keep their slopes, as
    symmetric and antisymmetric waves of a plate do.
    """
    number = np.full(kx.shape, -1)
    lines: dict[int, tuple[float, complex, complex]] = {}  # k0, kx and slope of the branches that go on
    count = 0
    for i in np.argsort(k0, kind="stable"):
        there = np.flatnonzero(np.isfinite(kx[i]))
        number[i, there] = _continued(lines, k0[i], kx[i, there])
        new = there[number[i, there] < 0]
        number[i, new] = count + np.arange(new.size)
        count += new.size
        lines = {int(number[i, j]): _line(lines.get(int(number[i, j])), float(k0[i]), complex(kx[i, j])) for j in there}
    return number


def _continued(lines: dict[int, tuple[float, complex, complex]], k0: float, kx: np.ndarray) -> np.ndarray:
    """The branch that each mode continues, or -1."""
    number = np.full(kx.size, -1)
    if not lines or not kx.size:
        return number
    last_k0, last, slope = (np.array(v) for v in zip(*lines.values(), strict=True))
    step = slope * (k0 - last_k0)
    apart, names = abs(kx[:, None] - (last + step)), np.array(list(lines))
    mode, line = _pairs(apart, apart <= np.maximum(abs(step), k0 - last_k0))
    number[mode] = names[line]
    modes, others = np.setdiff1d(np.arange(kx.size), mode), np.setdiff1d(np.arange(names.size), line)
    left = apart[np.ix_(modes, others)]
    mode, line = _pairs(left, (left <= SLOW * (k0 - last_k0[others])) & (ALONE * left <= _rival(left)))
    number[modes[mode]] = names[others[line]]
    return number


def _pairs(apart: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Modes and branches that belong together, of those that are near: the sum of their distances is least."""
    dearer = 1 + apart.size * apart.max(initial=0.0)  # than all pairs that are near
    mode, line = linear_sum_assignment(np.where(near, apart, dearer))
    return mode[near[mode, line]], line[near[mode, line]]


def _rival(apart: np.ndarray) -> np.ndarray:
    """The least distance (modes, branches) from each mode to the other branches, and from each branch to the other modes."""
    rival = np.full(apart.shape, np.inf)
    for i, j in np.ndindex(apart.shape):
        rival[i, j] = min(np.delete(apart[i], j).min(initial=np.inf), np.delete(apart[:, j], i).min(initial=np.inf))
    return rival


def _line(before: tuple[float, complex, complex] | None, k0: float, kx: complex) -> tuple[float, complex, complex]:
    """k0, kx and the slope with which a branch goes on."""
    if before is None or before[0] == k0:
        return k0, kx, kx / k0
    return k0, kx, (kx - before[1]) / (k0 - before[0])
