"""`widths_of`: `beam_width` at many points that differ in slab, beam and frequency, as arrays.

`beam_width` at a point spends most of its time around the numbers. Points whose slabs have the same layout fit into the same
arrays, a slab a row as elsewhere a frequency a row, and share that time. This is what a sweep calls on a block of its points;
`experiments/benchmarks/point.py` measures it.
"""

from __future__ import annotations

import functools
from collections.abc import Hashable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from .. import validate
from ..contour.error import ErrorBudget, uniform_budget
from ..media.structures import Slab
from ..media.values import layout
from ..profiles import sections
from ..response.fluid_slab import FluidSlab
from ..response.sampled_slab import sample_all
from ..sources.base import Beam, Tilted, moved_to_origin
from ..sources.in_space import check_on_a_line
from ..sources.rows import rows_of, taken
from . import hints

#: So many rows are computed together: more take no less time each.
ROWS_AT_A_TIME = 128


class Widths(NamedTuple):
    """What `beam_width` reports, and warns of, of P points."""

    row: sections.Row  #: by the names of its variables, (P,) each
    crossings: np.ndarray  #: how often |p| meets the half level in each of the four planes, (4, P)
    budget: ErrorBudget  #: of the plane with the largest estimated error, terms (P,)

    def at(self, i: int) -> Widths:
        """Those of point i alone."""
        part = slice(i, i + 1)
        return Widths(sections.Row(*(v[part] for v in self.row)), self.crossings[:, part], self.budget.taken(part))


def widths_of(
    slabs: Sequence[Slab],
    beams: Sequence[Beam],
    frequency: Any,
    rtol: float = 1e-8,
    air_distance: float | None = None,
) -> Widths:
    """`beam_width` of each slab with its own beam and frequency.

    Parameters
    ----------
    slabs, beams : sequences of P
        Copies from `tolerance` are made here, all of them: give as many at a time as may be held.
    frequency : array (P,), Hz
    rtol, air_distance : float
        As in `beam_width`.

    Returns
    -------
    Widths
        Those of `beam_width` to the same rtol, with an error estimated in the same way; `centroid_out`, a sum over samples, to
        1e-5 m. It warns of nothing.

    Raises
    ------
    ValueError
        As `beam_width` at any of the points; which, shows who asks for them one by one.

    Examples
    --------
    >>> from beamprop.api.widths_of import widths_of
    >>> slabs = [bp.Slab(bp.lmmd_cell(eta=eta), periods=45) for eta in (1 / 60, 1 / 50)]
    >>> together = widths_of(slabs, 2 * [bp.GaussianBeam(0.096)], [2500.0, 2500.0])
    >>> alone = [bp.beam_width(slab, bp.GaussianBeam(0.096), 2500.0).fwhm_out.item() for slab in slabs]
    >>> bool(np.allclose(together.row.fwhm_out, alone, rtol=1e-10))
    True
    """
    f = np.atleast_1d(validate.axis(frequency, "frequency", positive=True))
    rtol, slabs, beams = validate.rtol(rtol), list(slabs), list(beams)
    if air_distance is not None:
        air_distance = validate.as_number(air_distance, "air_distance", positive=True)
    for name, given in (("slabs", slabs), ("beams", beams)):
        if len(given) != f.size:
            raise ValueError(f"{name}: expected {f.size}, as many as frequencies, got {len(given)}")
    rows, met = np.empty((len(sections.Row._fields), f.size)), np.empty((4, f.size), int)
    terms = np.array(uniform_budget(f.size, 0.0))
    for points in _alike(slabs, beams, f):
        moved, origins = zip(*(moved_to_origin(check_on_a_line(beams[i])) for i in points), strict=True)
        source = rows_of(list(moved))
        for part, s in _sampled([slabs[i] for i in points], f[points]):
            row, crossings, budget = sections.rows(s, taken(source, part), rtol, air_distance)
            here = points[part]
            rows[:, here], met[:, here], terms[:, here] = row, crossings, budget
        rows[-1, points] += origins
    return Widths(sections.Row(*rows), met, ErrorBudget(*terms))


def _alike(slabs: Sequence[Slab], beams: Sequence[Beam], f: np.ndarray) -> Iterator[np.ndarray]:
    """Indices of points with the same layout of the slab and the same beam, or beams that differ in their angle alone, in blocks."""
    groups: dict[Hashable, list[int]] = {}
    upright = functools.cache(_upright)
    for i, (slab, beam) in enumerate(zip(slabs, beams, strict=True)):
        validate.instance(slab, Slab, "slabs")
        hints.warn_of_air(slab, f[i])
        hints.warn_of_solids(slab, f[i])
        same = upright(beam) if isinstance(beam, Hashable) else id(beam)
        groups.setdefault((same, layout(slab)), []).append(i)
    for points in groups.values():
        validate.instance(beams[points[0]], Beam, "beams")
        yield from np.array_split(points, -(-len(points) // ROWS_AT_A_TIME))


def _upright(beam: Beam) -> Beam:
    """The beam at normal incidence, where that is the same spectrum but for a shift."""
    return beam.at_angle(0.0) if isinstance(beam, Tilted) and beam.entire else beam


def _sampled(slabs: Sequence[Slab], f: np.ndarray) -> Iterator[tuple[np.ndarray, FluidSlab]]:
    """The slabs with loss and those without, for which modes are counted otherwise, and their indices."""
    s = sample_all(slabs, f)
    lossy = s.has_loss
    for part in (np.flatnonzero(lossy), np.flatnonzero(~lossy)):
        if part.size:
            yield part, s if part.size == f.size else s.take(part)
