"""The question of a field map, frozen once it is checked, and its answer at one frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..contour import choose
from ..contour.error import ErrorBudget, uniform_budget
from ..contour.quadrature import Quadrature
from ..media.structures import Slab
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab, sample
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation, interpolate_angles
from ..sources.base import Beam
from ..sources.lateral import LateralGradient
from . import evaluate
from .periodic import fill_by_reach


@dataclass(frozen=True, eq=False)
class FieldQuestion:
    """p of one source on (frequency, angle, z, x)."""

    slab: Slab
    source: Beam  #: moved to the origin
    frequency: np.ndarray  #: (F,) Hz
    angle: np.ndarray  #: (A,) degree
    z: np.ndarray  #: (Z,) m
    x: np.ndarray  #: (X,) m from the source's middle
    period: float | None  #: of a periodic array of beams [m]; None in open space
    rtol: float

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """F, A, Z, X."""
        return self.frequency.size, self.angle.size, self.z.size, self.x.size

    def prepared(self, i: int, quantity: str = "p") -> Prepared:
        """The contour for frequency i of "p", a velocity or a shear stress: see `prepare`."""
        return prepare(self, i, quantity)


class Prepared(NamedTuple):
    """A question at one frequency, and the contour that answers it."""

    question: FieldQuestion
    slab: SampledSlab
    beams: AngleInterpolation
    transfer: TransferFunction
    quadrature: Quadrature

    def fill(self, planes: slice, angles: slice, out: np.ndarray) -> ErrorBudget:
        """p or a velocity at planes and angles into out (A, Z, X), whose (Z, X) is contiguous.

        Returns
        -------
        Terms (A,) of the estimated error of an open field over the largest |p| of a plane; nan with a period.
        """
        question, s, beams, transfer, quadrature = self
        waves = evaluate.Superposition(s.k0, beams.taken(angles), quadrature, question.x)
        if question.period is not None:
            fill_by_reach(waves, transfer, question.z[planes], out, question.rtol)
            return uniform_budget(out.shape[0], np.nan)
        low_rank = evaluate.fill_map(waves, transfer, question.z[planes], out, question.rtol)
        return quadrature.budget.taken(angles)._replace(low_rank=low_rank)


def prepare(question: FieldQuestion, i: int, quantity: str = "p") -> Prepared:
    """Choose the contour of integration for frequency i, of "p", "v_x", "v_z" or "s_xz": each has its own.

    v_x, as s_xz, is odd in kx where contours need what is even: its factor kx goes to the source.
    """
    s = sample(question.slab, float(question.frequency[i]), backward=True)
    source: Any = LateralGradient(question.source) if quantity in ("v_x", "s_xz") else question.source
    beams = interpolate_angles(source, question.angle, s.k0, question.rtol * 1e-4)
    transfer = transfer_function.through(s, question.source.z0, quantity)
    if question.period is not None:
        quadrature = choose.periodic_quadrature(s, beams, question.x, question.period)
    else:
        quadrature = choose.choose_contour(s, beams, transfer, question.x, question.z, question.rtol)
    return Prepared(question, s, beams, transfer, quadrature)
