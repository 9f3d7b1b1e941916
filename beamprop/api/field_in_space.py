"""What `field` and `save_field` ask, in two dimensions or with y in three: checked."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from .. import validate
from ..contour import sums
from ..fields.in_space import SpaceQuestion
from ..fields.question import FieldQuestion
from ..fields.sum_in_space import SumQuestion
from ..media.fluids import Fluid
from ..media.planes import warn_of_stripes
from ..media.structures import Layer, Slab
from ..sources.base import Beam
from ..sources.source_sum import SourceSum
from ..sources.sum_in_space import in_space, middle_of
from . import checks, hints
from .field_question import Labels, checked_question
from .field_variables import IN_SPACE, checked_variables

#: The largest |p| over the beam's at which neighbouring beams of a lattice may meet.
SEAM = 1e-2


def question_at(
    places: tuple[Any, Any, Any, Any],
    slab: Slab,
    beam: Beam,
    waves: tuple[Any, Any],
    sides: tuple[str, Any],
    rtol: float,
    values: tuple[Any, str | None],
) -> tuple[FieldQuestion | SpaceQuestion | SumQuestion, Labels]:
    """The question of a field, or a ValueError that names the argument.

    Parameters
    ----------
    places : x, y or None, z, and the azimuth or None
    slab, beam
    waves : frequency and angle
    sides : boundary and period
    rtol
    values : variables and average
    """
    (x, y, z, azimuth), (frequency, angle), (boundary, period), (variables, average) = places, waves, sides, values
    if y is None:
        if azimuth is not None:
            raise validate.refuse("azimuth", "none without y", azimuth)
        return checked_question(slab, beam, frequency, x, z, angle, boundary, period, rtol, variables, average)
    in_three = _question_of_sum if isinstance(beam, SourceSum) else question_in_space
    question, labels = in_three(slab, beam, frequency, angle, rtol, places)
    validate.word(boundary, "boundary", "open", "periodic")
    if boundary == "periodic":
        period = _lengths(period, labels.axes, in_space(beam, azimuth))
    elif period is not None:
        raise validate.refuse("period", "none with boundary='open'", period)
    if average is not None:
        validate.word(average, "average", "cell")
    else:
        warn_of_stripes(slab, question.z, question.frequency)
    names = checked_variables(variables, slab, question.z, IN_SPACE)
    labels = labels._replace(boundary=boundary, period=period, variables=names, average=average)
    return dataclasses.replace(question, period=period), labels


def question_in_space(
    slab: Slab, beam: Beam, frequency: Any, angle: Any, rtol: float, places: tuple[Any, Any, Any, Any]
) -> tuple[SpaceQuestion, Labels]:
    """The question of an open field of p at `places`, x, y, z and the azimuth or None, or a ValueError that names the argument."""
    beams = checks.unmoved_beams(slab, beam, frequency, angle, rtol)
    x, y, z = (validate.axis(v, name) for v, name in zip(places, "xyz", strict=False))
    if not hasattr(beam, "in_space"):
        raise validate.refuse("beam", "a GaussianBeam, Piston, Bowl, SourcePlane or Array where y is given", beam)
    source_beam: Any = beam
    azimuth = source_beam.azimuth if places[3] is None else validate.as_number(places[3], "azimuth")
    z = checks.from_launch_plane(z, beam)
    refuse_directions(slab, np.atleast_1d(beams.frequency))
    hints.warn_of_width(slab, beam, beams.frequency, x)
    frequencies, angles = beams.flat
    checks.warn_if_not_ended(beam, slab, frequencies, min(float(np.min(z)), 0.0) - beam.z0, beams.rtol)
    flat_z, flat_y, flat_x = np.atleast_1d(z), np.atleast_1d(y) - source_beam.y0, np.atleast_1d(x) - source_beam.x0
    question = SpaceQuestion(
        slab, source_beam.in_space(azimuth), frequencies, angles, flat_z, flat_y, flat_x, beams.rtol
    )
    axes = beams.axes | {"z": z, "y": y, "x": x}
    return question, Labels(axes, slab, beam, "open", None, beams.rtol, ("p",), azimuth=azimuth)


def _question_of_sum(
    slab: Slab, beam: Any, frequency: Any, angle: Any, rtol: float, places: tuple[Any, Any, Any, Any]
) -> tuple[SumQuestion, Labels]:
    """The same of a sum: the question of each of its sources, at angles of their own where none is given."""
    checks.unmoved_beams(slab, beam, frequency, angle, rtol)
    questions, labels = zip(
        *(question_in_space(slab, source, frequency, angle, rtol, places) for source in beam.sources), strict=True
    )
    first = labels[0]
    azimuth = beam.azimuth if places[3] is None else first.azimuth
    angles = first.axes["angle"] if angle is not None else np.asarray(beam.angle)
    middles = tuple(middle_of(source) for source in beam.sources)
    question = SumQuestion(questions, beam.weights, middles, questions[0].z, first.rtol)
    return question, first._replace(beam=beam, azimuth=azimuth, axes=first.axes | {"angle": angles})


def _lengths(period: Any, axes: dict[str, np.ndarray], source: Any) -> tuple[float, float]:
    """The lattice's lengths along x and y; refused where neighbouring beams overlap."""
    if period is None:
        x, y = (np.atleast_1d(axes[name]) for name in "xy")
        grids = [sums.grid_of(v) for v in (x, y)]
        if not all(grid.step for grid in grids):
            raise ValueError(
                "period: expected two lengths (Lx, Ly) [m] with boundary='periodic' and an uneven x or y, got None"
            )
        period = tuple(grid.step * v.size for grid, v in zip(grids, (x, y), strict=True))
    if not isinstance(period, tuple | list | np.ndarray) or len(period) != 2:
        raise validate.refuse("period", "two lengths (Lx, Ly) [m] where y is given", period)
    lengths = tuple(validate.as_number(v, "period", positive=True) for v in period)
    for axis, length, half in zip("xy", lengths, source.half_widths(SEAM), strict=True):
        if half > length / 2:
            raise ValueError(
                f"period: expected a grid wide enough for the beam, got {length:.6g} m along {axis}, at whose ends the launched |p| is "
                f"still above {SEAM:.2g} of its largest"
            )
    return lengths[0], lengths[1]


def refuse_directions(slab: Slab, frequency: np.ndarray) -> None:
    """Refuse fluids whose density differs along x, which leaves open what it is along y."""
    layers = (layer for cell, _ in slab.segments for layer in cell.layers)
    fluids = [slab.before, slab.after, *(layer.fluid for layer in layers if isinstance(layer, Layer))]
    for fluid in fluids:
        anisotropic = isinstance(fluid, Fluid) and fluid.density_x is not None
        if anisotropic and np.any(np.not_equal(*fluid.at(frequency)[:2])):
            raise ValueError(
                f"density_x: expected none, or density itself, in three dimensions, got {fluid!r}: a density along x says nothing of that along y"
            )
