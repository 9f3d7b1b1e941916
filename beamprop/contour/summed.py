"""The error of a sum of fields that have contours of their own: their errors added, over the largest |p| of the sum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .error import ErrorBudget

#: Error of the fields that show the largest |p| of whole planes.
ROUGH = 1e-3
#: The least rtol that fields which cancel are made with, near to which rounding ends what a contour can keep, and the
#: share of rtol that is aimed at then.
LEAST, AIMED = 1e-11, 0.3


class Scales(NamedTuple):
    """The largest |p| of planes, of the sum (A, Z) and of its fields, weighted, (N, A, Z)."""

    of_sum: np.ndarray
    of_fields: np.ndarray

    def taken(self, angles: slice, planes: slice) -> Scales:
        """Of some angles and planes."""
        return Scales(self.of_sum[angles, planes], self.of_fields[:, angles, planes])

    def larger(self, wider: Scales) -> Scales:
        """The larger of each, of the same planes seen at different positions."""
        return Scales(*(np.maximum(a, b) for a, b in zip(self, wider, strict=True)))


def added(budgets: list[ErrorBudget], scales: Scales) -> ErrorBudget:
    """The budget (A,) of a sum, on its worst plane, of those of its N fields, (A,) each, over their own largest |p|.

    What the sum has more of because it is smaller than each of its fields counts as `cancelling`.
    """
    largest = scales.of_fields.max(axis=0)
    terms = np.array(budgets)[..., None]  # (N, terms, A, 1)
    errors = np.sum(terms * scales.of_fields[:, None], axis=0)  # (terms, A, Z) [Pa]
    total = errors.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        relative = np.where(errors == 0, 0.0, errors / np.maximum(scales.of_sum, largest))
        more = np.where(total == 0, 0.0, total / scales.of_sum - total / np.maximum(scales.of_sum, largest))
    budget = ErrorBudget(*relative)
    budget = budget._replace(cancelling=budget.cancelling + more)
    worst = np.argmax(budget.total, axis=1)
    return budget.taken((np.arange(worst.size), worst))


def lower_rtol(worst: float, rtol: float, made_with: float) -> float | None:
    """The lower rtol with which the fields of a sum that misses rtol have to be made.

    None where the sum keeps it, and where its fields were made with the least already.
    """
    if not worst > rtol:
        return None
    lower = max(LEAST, AIMED * rtol * made_with / worst)
    return lower if lower < made_with else None
