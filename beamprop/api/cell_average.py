"""Variables as means over a cell about each plane: sums over planes inside the cell, with the error of such sums."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from ..contour.error import DARK, ErrorBudget
from ..fields.in_space import SpaceQuestion
from ..fields.question import FieldQuestion
from ..fields.sum_in_space import SumQuestion
from ..media.planes import CellMeans, cell_means
from .field_variables import Row, kinds, row_of

#: Nodes of Gauss-Legendre's rule in each layer, until the next rule agrees on the planes that are checked: three are enough for layers
#: of a tenth of a radian, (phase/2)^6/2016 = 1e-11, and 24 for four wavelengths.
NODES = (3, 6, 12, 24)
#: Planes on which two rules are compared, and the share of rtol that they may differ by.
CHECKED, SHARE = 5, 0.1
#: Nodes that are summed at a time, and the bytes that they may hold: from hundreds on, maps are made at low rank.
TOGETHER, BYTES = 4096, 2**26


class AveragedRow(NamedTuple):
    """A question at one frequency whose planes are means; `rule` is the error of those, over the largest value of a plane, (A,) each."""

    row: Row
    means: CellMeans
    rule: dict[str, np.ndarray]

    def fill(self, planes: slice, angles: slice, out: dict[str, np.ndarray]) -> dict[str, ErrorBudget]:
        """As `Row.fill`."""
        total: dict[str, ErrorBudget] = {}
        out = {name: v.reshape(*v.shape[:2], -1) for name, v in out.items()}
        ends = np.append(self.means.first, self.means.z.size)
        begin, stop, _ = planes.indices(self.means.first.size)
        start = begin
        while start < stop:
            last = min(stop, self._last(start, ends, out))
            part = {name: v[:, start - begin : last - begin] for name, v in out.items()}
            for name, budget in self._fill(ends[start : last + 1], angles, part).items():
                total[name] = budget if name not in total else _worse(total[name], budget)
            start = last
        return {
            name: budget._replace(low_rank=budget.low_rank + self.rule[name][angles]) for name, budget in total.items()
        }

    def _last(self, start: int, ends: np.ndarray, out: dict[str, np.ndarray]) -> int:
        """The plane after the last one whose nodes are held together with those from `start` on."""
        beams, _, points = next(iter(out.values())).shape
        nodes = min(TOGETHER, BYTES // (16 * len(out) * beams * points))
        return max(start + 1, int(np.searchsorted(ends, ends[start] + nodes, side="right")) - 1)

    def _fill(self, ends: np.ndarray, angles: slice, out: dict[str, np.ndarray]) -> dict[str, ErrorBudget]:
        """Means of the planes whose nodes lie between `ends`."""
        nodes, first = slice(ends[0], ends[-1]), ends[:-1] - ends[0]
        weight = self.means.weight[nodes, None]
        terms = {name: np.empty((v.shape[0], weight.size, v.shape[2]), v.dtype) for name, v in out.items()}
        budgets = self.row.fill(nodes, angles, terms)
        for name, term in terms.items():
            np.add.reduceat(term * weight, first, axis=1, out=out[name])
            # errors are over the largest value of each node's plane, and the mean may be smaller
            summed = np.add.reduceat(np.abs(term).max(axis=2) * weight[:, 0], first, axis=1)
            largest = np.abs(out[name]).max(axis=2)
            growth = np.max(np.where(largest > DARK, summed / np.where(largest > DARK, largest, 1.0), 1.0), axis=1)
            budgets[name] = ErrorBudget(*(value * np.maximum(growth, 1.0) for value in budgets[name]))
        return budgets


def averaged_row(
    question: FieldQuestion | SpaceQuestion | SumQuestion, i: int, variables: tuple[str, ...], average: str | None
) -> Row | AveragedRow:
    """The contours at frequency i, of the planes themselves or of the means over a cell."""
    on_map = tuple(kinds(variables))
    means = cell_means(question.slab, question.z, 1) if average and on_map else None
    if means is None or means.z.size == question.z.size:  # no plane lies in a cell
        return row_of(question, i, variables)
    inside = np.flatnonzero(np.diff(np.append(means.first, means.z.size)) > 1)
    checked = inside[np.unique(np.linspace(0, inside.size - 1, CHECKED).astype(int))]
    for nodes in NODES:
        means = cell_means(question.slab, question.z, nodes)
        finer = cell_means(question.slab, question.z[checked], nodes + 1)
        row = row_of(dataclasses.replace(question, z=np.concatenate([means.z, finer.z])), i, variables)
        rule = _difference(
            AveragedRow(row, means, {}), finer, checked, (question.angle.size, math.prod(question.shape[3:]))
        )
        if max(float(np.max(error)) for error in rule.values()) <= SHARE * question.rtol:
            break
    return AveragedRow(row, means, rule)


def _difference(
    coarse: AveragedRow, finer: CellMeans, checked: np.ndarray, shape: tuple[int, int]
) -> dict[str, np.ndarray]:
    """How far two rules differ on some planes, over the largest value of each, by variable and angle: the error of the coarser."""
    beams, points = shape
    at = coarse.means.z.size
    errors: dict[str, np.ndarray] = {}
    values: dict[str, np.ndarray] = {
        name: np.empty((beams, finer.z.size, points), kind) for name, kind in kinds(coarse.row.variables).items()
    }
    coarse.row.fill(slice(at, at + finer.z.size), slice(None), values)
    means = {name: np.add.reduceat(v * finer.weight[:, None], finer.first, axis=1) for name, v in values.items()}
    for j, plane in enumerate(checked):
        ends = np.append(coarse.means.first, at)[plane : plane + 2]
        out = {name: np.empty((beams, 1, points), v.dtype) for name, v in means.items()}
        coarse._fill(ends, slice(None), out)
        for name, v in out.items():
            largest = np.abs(v[:, 0]).max(axis=1)
            error = np.abs(v[:, 0] - means[name][:, j]).max(axis=1) / np.where(largest > DARK, largest, np.inf)
            errors[name] = np.maximum(errors.get(name, 0.0), error)
    return errors


def _worse(a: ErrorBudget, b: ErrorBudget) -> ErrorBudget:
    """The larger of each term; parts of a map share all but what their planes add."""
    return ErrorBudget(*(np.fmax(x, y) for x, y in zip(a, b, strict=True)))
