"""`field` with y: the question in three dimensions checked, and its answer labelled."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..contour.error import ErrorBudget
from ..fields.in_space import SpaceQuestion, prepare
from ..media.fluids import Fluid
from ..media.planes import warn_of_stripes
from ..media.structures import Layer, Slab
from ..progress import Progress, watched
from ..sources.base import Beam
from . import checks, hints
from .field_question import Labels, labelled


def question_in_space(
    slab: Slab, beam: Beam, frequency: Any, angle: Any, rtol: float, places: tuple[Any, Any, Any, Any]
) -> tuple[SpaceQuestion, Labels]:
    """The question of a field at `places`, x, y, z and the azimuth or None, or a ValueError that names the argument."""
    beams = checks.unmoved_beams(slab, beam, frequency, angle, rtol)
    x, y, z = (validate.axis(v, name) for v, name in zip(places, "xyz", strict=False))
    in_space: Any = getattr(beam, "in_space", None)
    if in_space is None:
        raise validate.refuse("beam", "a GaussianBeam, Piston, Bowl, SourcePlane or Array where y is given", beam)
    source_beam: Any = beam
    azimuth = source_beam.azimuth if places[3] is None else validate.as_number(places[3], "azimuth")
    z = checks.from_launch_plane(z, beam)
    refuse_directions(slab, np.atleast_1d(beams.frequency))
    hints.warn_of_width(slab, beam, beams.frequency, x)
    frequencies, angles = beams.flat
    warn_of_stripes(slab, np.atleast_1d(z), frequencies, averages=False)
    checks.warn_if_not_ended(
        beam, np.max(checks.k0(slab, frequencies)), min(float(np.min(z)), 0.0) - beam.z0, beams.rtol
    )
    flat_z, flat_y, flat_x = np.atleast_1d(z), np.atleast_1d(y) - source_beam.y0, np.atleast_1d(x) - source_beam.x0
    question = SpaceQuestion(slab, in_space(azimuth), frequencies, angles, flat_z, flat_y, flat_x, beams.rtol)
    axes = beams.axes | {"z": z, "y": y, "x": x}
    return question, Labels(axes, slab, beam, "open", None, beams.rtol, ("p",), azimuth=azimuth)


def refuse_options(boundary: str, period: Any, variables: Any, average: Any) -> None:
    """Refuse what is not available in three dimensions yet."""
    validate.word(boundary, "boundary", "open", "periodic")
    if boundary != "open":
        raise ValueError(
            "boundary: expected 'open' where y is given, got 'periodic': not available in three dimensions yet"
        )
    if period is not None:
        raise validate.refuse("period", "none with boundary='open'", period)
    if average is not None:
        raise validate.refuse("average", "none where y is given (not available in 3-D yet)", average)
    names = [variables] if isinstance(variables, str) else variables
    if not isinstance(names, list | tuple) or list(names) != ["p"]:
        raise validate.refuse(
            "variables",
            "'p' alone where y is given (velocities, intensity and power: not available in 3-D yet)",
            variables,
        )


def refuse_directions(slab: Slab, frequency: np.ndarray) -> None:
    """Refuse fluids whose density differs along x, which leaves open what it is along y."""
    layers = (layer for cell, _ in slab.segments for layer in cell.layers)
    fluids = [slab.before, slab.after, *(layer.fluid for layer in layers if isinstance(layer, Layer))]
    for fluid in fluids:
        anisotropic = isinstance(fluid, Fluid) and fluid.density_x is not None
        if anisotropic and np.any(np.not_equal(*fluid.at(frequency)[:2])):
            raise ValueError(
                f"density_x: expected none, or density itself, where y is given, got {fluid!r}: a density along x says nothing of that along y"
            )


def field_in_space(question: SpaceQuestion, labels: Labels, progress: Progress) -> xr.Dataset:
    """The answer of a question in three dimensions, as a dataset; warns where its estimated error is above rtol."""
    frequencies, angles, planes, rows, points = question.shape
    memory.check_field((frequencies, angles, planes, rows * points))
    p, errors = np.empty(question.shape, complex), np.empty(question.shape[:2])
    worst: ErrorBudget | None = None
    for i, _ in enumerate(watched(progress, question.frequency, "frequencies")):
        budget = prepare(question, i).fill(slice(None), slice(None), p[i])
        errors[i] = budget.total
        worst = budget.worst if worst is None else worst.worse(budget)
    assert worst is not None
    checks.warn_if_inaccurate(worst, question.rtol)
    return labelled(labels, {"p": errors}, {"p": p})
