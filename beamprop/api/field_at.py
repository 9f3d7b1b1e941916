"""The field of `field` at scattered points, the nodes of a foreign mesh: what `compare` needs."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import memory
from ..contour.error import uniform_budget
from ..fields.question import prepare
from ..fields.scattered import TERMS, at_points
from . import checks
from .field_question import checked_question

#: Depths by which the contour is chosen, at most: they are searched for dark planes, with some waves on each.
MOST_DEPTHS = 2**15


def field_at(
    record: Mapping[str, Any], frequency: np.ndarray, angle: np.ndarray, x: np.ndarray, z: np.ndarray
) -> np.ndarray:
    """Total pressure at scattered points, pairs of x and z.

    Parameters
    ----------
    record : slab, beam, boundary, period and rtol, as `provenance` gives them of a dataset from `field`
    frequency : (F,) Hz
    angle : (A,) degree
    x, z : (N,) m

    Returns
    -------
    p, (F, A, N) [Pa]

    Warns
    -----
    AccuracyWarning
        As `field` does.
    """
    slab, beam, boundary, period, rtol = (record[n] for n in ("slab", "beam", "boundary", "period", "rtol"))
    question, _ = checked_question(slab, beam, frequency, x, z, angle, boundary, period, rtol)
    frequencies, angles = question.shape[:2]
    memory.check(
        "x",
        16.0 * frequencies * angles * x.size + 80.0 * TERMS,
        f"{frequencies * angles * x.size:.3g} values of p",
        "take fewer nodes",
    )
    depths = np.sort(z)[np.linspace(0, z.size - 1, min(z.size, MOST_DEPTHS)).round().astype(int)]
    chosen = dataclasses.replace(question, z=depths)
    p, worst = np.empty((frequencies, angles, x.size), complex), uniform_budget(1, 0.0)
    for i in range(frequencies):
        prepared = prepare(chosen, i)
        p[i] = at_points(prepared, question.x, question.z)
        worst = worst.worse(prepared.quadrature.budget)
    checks.warn_if_inaccurate(worst, question.rtol)
    return p
