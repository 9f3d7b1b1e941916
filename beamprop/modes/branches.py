"""Branches of dispersion curves: which mode at a frequency continues which at the frequency before."""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment


def branches(k0: np.ndarray, kx: np.ndarray) -> np.ndarray:
    """Number of the branch of each mode kx (F, m) at wavenumbers k0 (F,) of the medium in front: (F, m), -1 for nan.

    Along growing k0 a branch is continued with its last slope, at first with its phase speed, and branches are given to modes so that the
    sum of their distances is least. A mode farther from its branch than the step of k0, or of the branch itself, has no predecessor
    and begins a new branch. Branches that cross keep their slopes, as symmetric and antisymmetric waves of a plate do.
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
    apart = abs(kx[:, None] - (last + step))
    reach = np.maximum(abs(step), k0 - last_k0)
    cost = np.where(apart <= reach, apart, (1 + kx.size) * reach.max())  # dearer than any that continue
    mode, line = linear_sum_assignment(cost)
    close = apart[mode, line] <= reach[line]
    number[mode[close]] = np.array(list(lines))[line[close]]
    return number


def _line(before: tuple[float, complex, complex] | None, k0: float, kx: complex) -> tuple[float, complex, complex]:
    """k0, kx and the slope with which a branch goes on."""
    if before is None or before[0] == k0:
        return k0, kx, kx / k0
    return k0, kx, (kx - before[1]) / (k0 - before[0])
