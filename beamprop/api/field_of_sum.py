"""`field` with y of a sum of sources: their fields added, and errors over the largest |p| of the sum."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..fields.in_space import SpaceQuestion, prepare
from ..media.planes import warn_of_stripes
from ..media.structures import Slab
from ..progress import Progress, watched
from ..sources.in_space import unit_vector
from ..sources.source_sum import SourceSum
from . import checks
from .field_in_space import question_in_space
from .field_question import labelled

#: Error of the fields that show the largest |p| of whole planes, and the most positions along x and along y of these.
ROUGH, MOST = 1e-3, 48
#: The least rtol that sources which cancel are asked with, near to which rounding ends what a contour can keep, and the share of rtol that is aimed at then.
LEAST, AIMED = 1e-11, 0.3


def refuse_options(boundary: str, period: Any, variables: Any, average: Any) -> None:
    """Refuse what a sum of sources is not asked in three dimensions yet."""
    validate.word(boundary, "boundary", "open", "periodic")
    if boundary != "open":
        raise ValueError(
            "boundary: expected 'open' of a sum of sources where y is given, got 'periodic': not available yet"
        )
    if period is not None:
        raise validate.refuse("period", "none with boundary='open'", period)
    if average is not None:
        raise validate.refuse("average", "none of a sum of sources where y is given (not available yet)", average)
    names = [variables] if isinstance(variables, str) else variables
    if not isinstance(names, list | tuple) or list(names) != ["p"]:
        wanted = "'p' alone of a sum of sources where y is given (velocities and intensity: not available yet)"
        raise validate.refuse("variables", wanted, variables)


def field_of_sum(
    slab: Slab,
    beam: SourceSum,
    frequency: Any,
    angle: Any,
    rtol: float,
    places: tuple[Any, Any, Any, Any],
    progress: Progress,
) -> xr.Dataset:
    """The sum of the fields of each source, which its slab answers by itself, for their factors to the response differ.

    Where sources cancel, their fields are computed once more with a lower rtol.
    """
    checks.unmoved_beams(slab, beam, frequency, angle, rtol)
    asked = [question_in_space(slab, source, frequency, angle, rtol, places) for source in beam.sources]
    questions, labels = [question for question, _ in asked], asked[0][1]
    warn_of_stripes(slab, questions[0].z, questions[0].frequency, averages=False)
    azimuth = beam.azimuth if places[3] is None else labels.azimuth
    angles = labels.axes["angle"] if angle is not None else np.asarray(beam.angle)
    labels = labels._replace(beam=beam, azimuth=azimuth, axes=labels.axes | {"angle": angles})
    shape = questions[0].shape
    memory.check_field((*shape[:3], shape[3] * shape[4]), values=(16, 16))
    around = _around(questions, _middles(beam))
    p, errors = np.empty(shape, complex), np.empty(shape[:2])
    for i, _ in enumerate(watched(progress, questions[0].frequency, "frequencies")):
        scales = _Scales(*_added(around, beam, i, np.empty((*shape[1:3], *around[0].shape[3:]), complex)))
        errors[i] = _kept(questions, beam, i, p[i], scales)
    worst = float(errors.max())
    if worst > labels.rtol:
        warnings.warn(
            f"estimated error {worst:.1e} of the largest |p|, above the requested rtol {labels.rtol:.1e}, mostly: "
            "sources of the sum that cancel each other",
            checks.AccuracyWarning,
            stacklevel=3,
        )
    return labelled(labels, {"p": errors}, {"p": p})


@dataclasses.dataclass(frozen=True)
class _Scales:
    """The largest |p| of planes, and what is known of errors."""

    of_sum: np.ndarray  #: (A, Z)
    of_sources: np.ndarray  #: (N, A, Z), weighted
    errors: np.ndarray  #: (N, A) of each source over its own largest |p|

    def error_of_sum(self, wider: _Scales) -> np.ndarray:
        """Of each angle, on the worst plane: errors added, over the largest |p| here or on a wider grid; (A,)."""
        sources, total = np.maximum(self.of_sources, wider.of_sources), np.maximum(self.of_sum, wider.of_sum)
        added = np.sum(self.errors[..., None] * sources, axis=0)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.max(np.where(added == 0, 0.0, added / total), axis=1)


def _kept(questions: list[SpaceQuestion], beam: SourceSum, i: int, out: np.ndarray, wider: _Scales) -> np.ndarray:
    """The field at frequency i into out, with its error (A,): at a lower rtol for each source where the sum needs that."""
    error = _Scales(*_added(questions, beam, i, out)).error_of_sum(wider)
    rtol, worst = questions[0].rtol, float(error.max())
    lower = max(LEAST, AIMED * rtol * rtol / worst) if worst > rtol else rtol
    if lower < rtol:
        closer = [dataclasses.replace(question, rtol=lower) for question in questions]
        error = _Scales(*_added(closer, beam, i, out)).error_of_sum(wider)
    return error


def _added(
    questions: list[SpaceQuestion], beam: SourceSum, i: int, out: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The weighted fields at frequency i, summed into out (A, Z, Y, X); what `_Scales` holds."""
    out[...] = 0
    field, largest, errors = np.empty_like(out), [], []
    for question, weight in zip(questions, beam.weights, strict=True):
        errors.append(prepare(question, i).fill(slice(None), slice(None), field).total)
        field *= weight
        out += field
        largest.append(np.max(np.abs(field), axis=(2, 3)))
    return np.max(np.abs(out), axis=(2, 3)), np.array(largest), np.array(errors)


def _middles(beam: SourceSum) -> list[np.ndarray]:
    """x0 and y0 of each source, (2,) [m]."""
    sources: list[Any] = list(beam.sources)
    return [np.array([s.x0, s.y0]) for s in sources]


def _around(questions: list[SpaceQuestion], middles: list[np.ndarray]) -> list[SpaceQuestion]:
    """Rough questions at common positions: about each source, where it points to, and among the requested ones."""
    axes: list[np.ndarray] = []
    for axis, name in enumerate("xy"):
        positions = [_spread(np.sort(getattr(questions[0], name)) + middles[0][axis], 9)]
        for question, middle in zip(questions, middles, strict=True):
            along = unit_vector(question.source.azimuth)[axis]
            way = float(question.z.max()) - question.source.z0
            own = question.source.half_widths(0.5)[axis] * np.linspace(-1, 1, 7)
            slopes = np.tan(np.radians(question.angle[[0, -1]])) * along * way
            positions += [middle[axis] + own + slope for slope in (0.0, *slopes)]
        axes.append(_spread(np.unique(np.concatenate(positions)), MOST))
    rough = max(ROUGH, questions[0].rtol)
    return [
        dataclasses.replace(q, x=axes[0] - middle[0], y=axes[1] - middle[1], rtol=rough)
        for q, middle in zip(questions, middles, strict=True)
    ]


def _spread(ordered: np.ndarray, most: int) -> np.ndarray:
    """At most so many of them, with both ends."""
    return ordered[np.unique(np.linspace(0, ordered.size - 1, most).round().astype(int))]
