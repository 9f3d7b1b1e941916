"""`field`: the total pressure of a beam in front of, inside and behind a slab."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..contour.error import uniform_budget
from ..fields.question import fill, prepare
from ..media.structures import Slab
from ..progress import Progress, watched
from ..sources.base import Beam
from . import checks
from .field_question import checked_question, labelled


def field(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    x: Any,
    z: Any,
    angle: Any = None,
    boundary: str = "open",
    period: float | None = None,
    rtol: float = 1e-8,
    progress: Progress = False,
) -> xr.Dataset:
    """Total pressure of a beam in front of, inside and behind a slab.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
    frequency : float or 1-D array, Hz
    x, z : float or 1-D array, m
        Any positions; z not in front of the launch plane ``beam.z0``.
    angle : float or 1-D array, degree, optional
        Overrides the beam's. All angles share one response.
    boundary : "open" or "periodic"
        "open": one beam in open space, the limit of vanishing absorption. "periodic": an array of beams, `period`
        apart: the plain sum over real kx, which is what a calculation with periodic sides answers.
    period : float, m
        For "periodic"; the length of the x grid (n dx) where it is even and no period is given.
    rtol : float
        Requested error of the open field over the largest |p| of each plane, wherever on the plane that lies.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of frequencies that is worked through.

    Returns
    -------
    Dataset
        `p` on (frequency, angle, z, x), scalars as scalar coordinates, and `error_estimate` on (frequency, angle), of
        open fields: the largest difference between two contours of integration that share no error term, and what planes
        gain that are made of others.

    Warns
    -----
    AccuracyWarning
        The estimate is above rtol.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came; also for what does not fit into memory.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
    >>> beam = bp.GaussianBeam(fwhm=0.096, angle=45, z0=-0.1)
    >>> ds = bp.field(slab, beam, 2500.0, x=np.linspace(-1, 1, 501), z=[0.0, slab.thickness])
    >>> dict(ds.p.sizes), bool(ds.error_estimate < 1e-8)
    ({'z': 2, 'x': 501}, True)
    """
    validate.flag_or_function(progress, "progress")
    question, labels = checked_question(slab, beam, frequency, x, z, angle, boundary, period, rtol)
    memory.check_field(question.shape)
    p, errors = np.empty(question.shape, complex), np.empty(question.shape[:2])
    worst = uniform_budget(1, 0.0)
    for i, _ in enumerate(watched(progress, question.frequency, "frequencies")):
        budget = fill(prepare(question, i), slice(None), slice(None), p[i])
        errors[i], worst = budget.total, worst.worse(budget)
    checks.warn_if_inaccurate(worst, question.rtol)
    return labelled(labels, errors, p)
