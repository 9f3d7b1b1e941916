"""The question of a sum of sources in three dimensions: their fields added, errors over the largest |p| of the sum.

Each source is a question of its own, for their factors to the response differ. Where sources cancel, their fields are
made once more with a lower rtol.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from ..contour import summed
from ..contour.error import ErrorBudget, uniform_budget
from ..media.structures import Slab
from ..sources.in_space import unit_vector
from ..sources.sum_in_space import Part, SumInSpace
from .in_space import PreparedInSpace, SpaceQuestion, prepare

#: The most positions along x and along y of the fields that show the largest |p| of whole planes.
MOST = 48


@dataclasses.dataclass(frozen=True, eq=False)
class SumQuestion:
    """p of a weighted sum of sources on (frequency, angle, z, y, x): see `SpaceQuestion`."""

    questions: tuple[SpaceQuestion, ...]  #: of each source; z, rtol and period are those below
    weights: tuple[complex, ...]
    middles: tuple[np.ndarray, ...]  #: x and y of each source's middle, (2,) m
    z: np.ndarray  #: (Z,) m
    rtol: float
    period: tuple[float, float] | None = None

    @property
    def slab(self) -> Slab:
        """That of all."""
        return self.questions[0].slab

    @property
    def frequency(self) -> np.ndarray:
        """(F,) Hz."""
        return self.questions[0].frequency

    @property
    def angle(self) -> np.ndarray:
        """(A,) degree: of sources at angles of their own that of the first."""
        return self.questions[0].angle

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """F, A, Z, Y, X."""
        f, a, _, y, x = self.questions[0].shape
        return f, a, self.z.size, y, x

    def each(self, rtol: float) -> list[SpaceQuestion]:
        """The questions of the sources, with an rtol."""
        return [dataclasses.replace(q, z=self.z, rtol=rtol, period=self.period) for q in self.questions]

    def source_at(self, j: int) -> SumInSpace:
        """The sum at angle j, about the middle of its sources' middles."""
        middle = (np.min(self.middles, axis=0) + np.max(self.middles, axis=0)) / 2
        each: list[Any] = [q.source.at_angle(float(q.angle[j])) for q in self.questions]
        parts = tuple(Part(s, w, at - middle) for s, w, at in zip(each, self.weights, self.middles, strict=True))
        return SumInSpace(parts, each[0].angle, each[0].azimuth)

    def prepared(self, i: int, quantity: str = "p") -> PreparedSum:
        """The contours for frequency i, one for each source; see `PreparedInSpace`."""
        return PreparedSum(self, i, quantity)


class PreparedSum:
    """A question of a sum at one frequency, and the contours that answer it."""

    def __init__(self, question: SumQuestion, i: int, quantity: str) -> None:
        self.question, self.i, self.quantity = question, i, quantity
        self._make(question.rtol)
        self.wider: summed.Scales | None = None
        if question.period is None:
            around = _around(question)
            rough = [prepare(q, i, quantity) for q in around]
            _, angles, planes, *across = around[0].shape
            everything = slice(None)
            out = np.empty((angles, planes, *across), complex)
            self.wider = self._fill(rough, everything, everything, out)[1]

    def _make(self, rtol: float) -> None:
        self.made_with = rtol
        self.prepared = [prepare(question, self.i, self.quantity) for question in self.question.each(rtol)]

    def fill(self, planes: slice, angles: slice, out: np.ndarray) -> ErrorBudget:
        """The sum at planes and angles into out (A, Z, Y, X) or (A, Z, Y X): see `PreparedInSpace.fill`."""
        while True:
            budgets, scales = self._fill(self.prepared, planes, angles, out)
            if self.wider is None:
                return uniform_budget(out.shape[0], np.nan)
            budget = summed.added(budgets, scales.larger(self.wider.taken(angles, planes)))
            lower = summed.lower_rtol(float(budget.total.max()), self.question.rtol, self.made_with)
            if lower is None:
                return budget
            self._make(lower)

    def _fill(
        self, prepared: list[PreparedInSpace], planes: slice, angles: slice, out: np.ndarray
    ) -> tuple[list[ErrorBudget], summed.Scales]:
        """The weighted fields, added into out; their budgets, and the largest of the planes."""
        out[...] = 0
        field, largest, budgets = np.empty(out.shape, complex), [], []
        across = tuple(range(2, out.ndim))
        for of_source, weight in zip(prepared, self.question.weights, strict=True):
            budgets.append(of_source.fill(planes, angles, field))
            field *= weight
            out += field
            largest.append(np.max(np.abs(field), axis=across))
        return budgets, summed.Scales(np.max(np.abs(out), axis=across), np.array(largest))


def _around(question: SumQuestion) -> list[SpaceQuestion]:
    """Rough questions at common positions: about each source, where it points to, and among the requested ones."""
    questions = question.each(max(summed.ROUGH, question.rtol))
    axes: list[np.ndarray] = []
    for axis, name in enumerate("xy"):
        positions = [_spread(np.sort(getattr(questions[0], name)) + question.middles[0][axis], 9)]
        for each, middle in zip(questions, question.middles, strict=True):
            source: Any = each.source
            along = unit_vector(source.azimuth)[axis]
            way = float(each.z.max()) - source.z0
            own = source.half_widths(0.5)[axis] * np.linspace(-1, 1, 7)
            slopes = np.tan(np.radians(each.angle[[0, -1]])) * along * way
            positions += [middle[axis] + own + slope for slope in (0.0, *slopes)]
        axes.append(_spread(np.unique(np.concatenate(positions)), MOST))
    return [
        dataclasses.replace(each, x=axes[0] - middle[0], y=axes[1] - middle[1])
        for each, middle in zip(questions, question.middles, strict=True)
    ]


def _spread(ordered: np.ndarray, most: int) -> np.ndarray:
    """At most so many of them, with both ends."""
    return ordered[np.unique(np.linspace(0, ordered.size - 1, most).round().astype(int))]
