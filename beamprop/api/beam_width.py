"""`beam_width`: widths of a beam against frequency and angle."""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..contour.error import ErrorBudget, uniform_budget
from ..io import datasets
from ..media.structures import Slab
from ..profiles import sections
from ..progress import Progress, watched
from ..response.sampled_slab import sample_all
from ..sources.base import Beam
from . import checks, hints
from .space_beams import is_in_space, space_beams, widths_in_space
from .together import Point, widths_known
from .widths_of import ROWS_AT_A_TIME


def beam_width(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-8,
    air_distance: float | None = None,
    progress: Progress = False,
    *,
    azimuth: float | None = None,
) -> xr.Dataset:
    """Widths of a beam: launched, at the near face, behind the slab, and after a distance without the slab.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
        In three dimensions a GaussianBeam, Piston, Bowl, SourcePlane or Array. Also a sum of these, ``a + 0.5j * b``.
    frequency : float or 1-D array, Hz
    angle : float or 1-D array, degree, optional
        Overrides the beam's.
    rtol : float
        Requested error of the fields over their largest |p|.
    air_distance : float, m, optional
        Of `fwhm_air`, in the fluid in front; two of its wavelengths at each frequency by default.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of blocks that is worked through.
    azimuth : float, degree, optional
        Makes it a question of three dimensions, as a beam of two widths, an azimuth or a y0 and transducers do by themselves; overrides the
        beam's, the direction of its tilt from x towards y. A circular beam has fwhm=(w, w).

    Returns
    -------
    Dataset
        On (frequency, angle): `fwhm_launch`, `fwhm_in` (near face, incident beam alone), `fwhm_out` (far face), `fwhm_air`
        [m]; `peak_out` [Pa] and `centroid_out` [m] at the far face. Widths are of |p|, or of |p|^2 for a beam
        whose `width_of` is "intensity": between the two places nearest to the peak where it is reached. The centroid is
        taken over the window in which the width was looked for.

        In three dimensions the four widths, of cuts through the peak of each plane, and the centroid have a dimension `axis`, "x" and "y". Beside
        them are `area_out` [m^2], the connected part of the far face around the peak where |p| (or |p|^2) is half of it or more, and
        `equivalent_out` [m], the diameter of a disc of that area. `fwhm_launch` of a source with a sharp edge is the edge's
        diameter, and that of a sum with such sources, or of an Array of several such elements, is left open, nan.

    Warns
    -----
    RuntimeWarning
        The half level is not met inside the window (nan), or is met more than twice in one of the four planes; the peak is a ring, in three
        dimensions, and cuts pass through its place farthest along x.
    AccuracyWarning
        The estimated error of |p| in one of the planes is above rtol.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
    >>> ds = bp.beam_width(slab, bp.GaussianBeam(0.096), [2000, 2500])
    >>> ds.fwhm_out.values.round(6)
    array([0.089805, 0.097446])
    >>> ds = bp.beam_width(slab, bp.GaussianBeam((0.096, 0.096), angle=45), 2500.0)
    >>> ds.fwhm_out.values.round(4), round(float(ds.equivalent_out), 4)
    (array([0.0895, 0.0881]), 0.0886)
    """
    validate.flag_or_function(progress, "progress")
    if air_distance is not None:
        air_distance = validate.as_number(air_distance, "air_distance", positive=True)
    if is_in_space(beam, azimuth):
        return widths_in_space(space_beams(slab, beam, frequency, angle, rtol, azimuth), air_distance, progress)
    beams = checks.beams(slab, beam, frequency, angle, rtol)
    flat, angles = beams.flat
    checks.warn_if_not_ended(beam, slab, flat, -beam.z0, beams.rtol)
    hints.warn_of_width_beside(slab, beam, flat)
    memory.check_table(flat.size * angles.size, 60.0)
    table, most, worst = _table(slab, beams, air_distance, progress)
    table["centroid_out"] += beams.origin
    checks.warn_if_inaccurate(worst, beams.rtol)
    missing = [name for name in table if np.any(np.isnan(table[name]))]
    if missing:
        warnings.warn(f"no half level inside the window: nan in {', '.join(missing)}", RuntimeWarning, stacklevel=2)
    many = (name for name, times in zip(table, most, strict=False) if times > 2)
    checks.warn_of_crossings(int(most.max()), ", ".join(many))
    dims, pick = checks.dims(**beams.axes)
    return datasets.make(
        {n: (dims, v[pick]) for n, v in table.items()},
        checks.coords(**beams.axes),
        "beam_width",
        flat,
        slab=slab,
        beam=beam,
        rtol=beams.rtol,
        air_distance=air_distance,
    )


def _table(
    slab: Slab, beams: checks.Beams, air_distance: float | None, progress: Progress
) -> tuple[dict[str, np.ndarray], np.ndarray, ErrorBudget]:
    """Each variable (F, A), how often |p| meets the half level at most in each plane, (4,), and the largest error."""
    flat, angles = beams.flat
    if flat.size == angles.size == 1:
        point = Point(slab, beams.source.at_angle(float(angles[0])), float(flat[0]), beams.rtol, air_distance)
        if (known := widths_known(point)) is not None:
            table = {name: values[:, None].copy() for name, values in known.row._asdict().items()}
            return table, known.crossings[:, 0], known.budget
    table = {name: np.empty((flat.size, angles.size)) for name in sections.Row._fields}
    most, worst = np.zeros(4, int), uniform_budget(1, 0.0)
    blocks = np.array_split(np.arange(flat.size), -(-flat.size // ROWS_AT_A_TIME))
    work = list(itertools.product(blocks, range(angles.size)))
    for rows, j in watched(progress, work, "widths"):
        s = sample_all(slab, flat[rows])
        row, met, budget = sections.rows(s, beams.source.at_angle(float(angles[j])), beams.rtol, air_distance)
        most = np.maximum(most, met.max(axis=1).astype(int))
        worst = worst.worse(budget)
        for name, values in row._asdict().items():
            table[name][rows, j] = values
    return table, most, worst
