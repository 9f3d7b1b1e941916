"""The question of a field in three dimensions, and p(z, y, x) at one frequency, evaluated on the contour that was chosen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..contour.error import ErrorBudget, uniform_budget
from ..contour.quadrature import Quadrature
from ..contour.space import lattice
from ..contour.space.choose import choose_in_space
from ..media.structures import Slab
from ..response import transfer_function
from ..response.sampled_slab import sample
from ..response.transfer_function import TransferFunction
from ..sources.angles import AngleInterpolation, interpolate_angles
from ..sources.in_space import SpaceBeam
from ..sources.lateral import SpaceGradient
from ..sources.piston import driven_by_velocity
from . import evaluate
from .periodic_in_space import PeriodicWaves, periodic_waves


@dataclass(frozen=True, eq=False)
class SpaceQuestion:
    """p of one source on (frequency, angle, z, y, x)."""

    slab: Slab
    source: SpaceBeam
    frequency: np.ndarray  #: (F,) Hz
    angle: np.ndarray  #: (A,) degree
    z: np.ndarray  #: (Z,) m
    y: np.ndarray  #: (Y,) m from the source's middle
    x: np.ndarray  #: (X,) m from the source's middle
    rtol: float
    period: tuple[float, float] | None = None  #: along x and y, of a periodic array of beams [m]; None in open space

    @property
    def shape(self) -> tuple[int, int, int, int, int]:
        """F, A, Z, Y, X."""
        return self.frequency.size, self.angle.size, self.z.size, self.y.size, self.x.size

    def prepared(self, i: int, quantity: str = "p") -> PreparedInSpace:
        """The contour for frequency i of "p", a velocity or a shear stress: see `prepare`."""
        return prepare(self, i, quantity)


class SpaceWaves(NamedTuple):
    """Beams at every (y, x), by the lattice of a contour: `evaluate.Waves`."""

    k0: float
    sources: AngleInterpolation
    quadrature: Quadrature
    y: np.ndarray
    x: np.ndarray

    @property
    def points(self) -> int:
        """Positions on a plane."""
        return self.x.size * self.y.size

    @property
    def searched_share(self) -> float:
        """All but a tenth: h is a small part of a sum over a lattice."""
        return 0.9

    @property
    def across(self) -> float:
        """The largest distance from the source's middle."""
        return float(np.hypot(np.max(np.abs(self.x)), np.max(np.abs(self.y))))

    @property
    def strengths(self) -> np.ndarray:
        """By the lattice, or the means of |S| over directions."""
        grid = self.quadrature.contour.lattice
        return np.asarray(grid.strengths(self.k0, self.sources))

    def fill(self, h: np.ndarray, out: np.ndarray) -> None:
        """By rows y where there are fewer of them than planes, else by planes."""
        grid, sources = self.quadrature.contour.lattice, self.sources
        spectra = grid.spectra(self.k0, sources)
        by_interpolation = sources.weights is not None
        summed = np.empty((sources.angles.size, *out.shape[1:]), complex) if by_interpolation else out
        view = summed.reshape(*summed.shape[:2], self.y.size, self.x.size)
        fields = lattice.rows if grid.by_rows and ROW_OVER_PLANE * self.y.size < h.shape[0] else lattice.fields
        fields(grid, spectra, h, self.x, self.y, view)
        evaluate.check_finite(summed)
        if by_interpolation:
            sources.interpolated_to(summed, out)


#: A row y of all planes costs about as much as so many planes of all rows: experiments/benchmarks/space.py measures 4.9 to 7.2.
ROW_OVER_PLANE = 5


#: Quantities along x and y: whether it is y, and the one of a plane wave along x whose value over kx theirs over kx or ky is.
LATERAL = {"v_x": (False, "v_x"), "v_y": (True, "v_x"), "s_xz": (False, "s_xz"), "s_yz": (True, "s_xz")}


def prepare(question: SpaceQuestion, i: int, quantity: str = "p") -> PreparedInSpace:
    """Choose the contour for frequency i, of "p", "v_x", "v_y", "v_z", "s_xz" or "s_yz": each has its own.

    Waves along k have their velocity in the plane of k and z, so that v_x and v_y are kx and ky times the same function of |k|.
    """
    s = sample(question.slab, float(question.frequency[i]), backward=True)
    along_y, of_radius = LATERAL.get(quantity, (False, quantity))
    source: Any = SpaceGradient(question.source, along_y) if quantity in LATERAL else question.source
    beams = interpolate_angles(source, question.angle, s.k0, question.rtol * 1e-4)
    transfer = driven_by(question.source, transfer_function.through(s, question.source.z0, of_radius))
    if question.period is not None:
        places = question.x, question.y, question.z
        return PreparedInSpace(question, periodic_waves(s, beams, transfer, places, question.period), transfer)
    quadrature = choose_in_space(s, beams, transfer, (question.x, question.y), question.z, question.rtol)
    return PreparedInSpace(question, SpaceWaves(s.k0, beams, quadrature, question.y, question.x), transfer)


def driven_by(source: SpaceBeam, transfer: TransferFunction) -> TransferFunction:
    """A transfer function of pressure as that of what drives a source: a velocity, and what a depth makes of it."""
    if driven_by_velocity(source):
        transfer = transfer_function.of_velocity(transfer)
    factor = getattr(source, "radial_factor", None)
    return transfer if factor is None else transfer_function.of_depth(transfer, factor)


class PreparedInSpace(NamedTuple):
    """A question at one frequency, and the contour that answers it."""

    question: SpaceQuestion
    waves: SpaceWaves | PeriodicWaves
    transfer: TransferFunction

    def fill(self, planes: slice, angles: slice, out: np.ndarray) -> ErrorBudget:
        """p or another quantity at planes and angles into out (A, Z, Y, X) or (A, Z, Y X), of which all but A is contiguous.

        Returns
        -------
        Terms (A,) of the estimated error of an open field over the largest |p| of a plane; nan with a period.
        """
        waves = self.waves._replace(sources=self.waves.sources.taken(angles))
        flat = out.reshape(*out.shape[:2], -1)
        low_rank = evaluate.fill_map(waves, self.transfer, self.question.z[planes], flat, self.question.rtol)
        if self.question.period is not None:
            return uniform_budget(out.shape[0], np.nan)
        return self.waves.quadrature.budget.taken(angles)._replace(low_rank=low_rank)
