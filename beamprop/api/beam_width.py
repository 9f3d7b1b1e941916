"""`beam_width`: widths of a beam against frequency and angle."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..io import datasets
from ..media.structures import Slab
from ..profiles import sections
from ..progress import Progress, watched
from ..response.sampled_slab import sample_all
from ..sources.base import Beam, moved_to_origin
from . import checks


def beam_width(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-8,
    air_distance: float | None = None,
    progress: Progress = False,
) -> xr.Dataset:
    """Widths of a beam: launched, at the near face, behind the slab, and after a distance without the slab.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
    frequency : float or 1-D array, Hz
    angle : float or 1-D array, degree, optional
        Overrides the beam's.
    rtol : float
        Asked error of the fields over their largest |p|.
    air_distance : float, m, optional
        Of `fwhm_air`, in the fluid in front; two of its wavelengths at each frequency by default.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of blocks that is worked through.

    Returns
    -------
    Dataset
        On (frequency, angle): `fwhm_launch`, `fwhm_in` (near face, incident beam alone), `fwhm_out` (far face), `fwhm_air`
        [m]; `peak_out` [Pa] and `centroid_out` [m] at the far face. Widths are of |p|, or of |p|^2 for a beam
        whose `width_of` is "intensity": between the two places nearest to the peak where it is reached. The centroid is
        taken over the window in which the width was looked for.

    Warns
    -----
    RuntimeWarning
        The half level is not met inside the window (nan), or is met more than twice in one of the four planes.
    AccuracyWarning
        The estimated error of |p| in one of the planes is above rtol.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
    >>> ds = bp.beam_width(slab, bp.GaussianBeam(0.096), [2000, 2500])
    >>> ds.fwhm_out.values.round(6)
    array([0.089805, 0.097446])
    """
    validate.flag_or_function(progress, "progress")
    validate.instance(slab, Slab, "slab")
    validate.instance(beam, Beam, "beam")
    f = validate.axis(frequency, "frequency", positive=True)
    checks.warn_of_air(slab, f)
    angles, rtol = checks.angles(angle, beam), validate.rtol(rtol)
    if air_distance is not None:
        air_distance = validate.as_number(air_distance, "air_distance", positive=True)
    flat, flat_angles = np.atleast_1d(f), np.atleast_1d(angles)
    memory.check_table(flat.size * flat_angles.size, 60.0)
    names = sections.Row._fields
    table = {name: np.empty((flat.size, flat_angles.size)) for name in names}
    most, worst = np.zeros(4, int), 0.0
    source, origin = moved_to_origin(beam)
    work = [
        (rows, j)
        for rows in np.array_split(np.arange(flat.size), -(-flat.size // 128))
        for j in range(flat_angles.size)
    ]
    for rows, j in watched(progress, work, "widths"):
        s = sample_all(slab, flat[rows])
        found, met, errors = sections.rows(s, source.at_angle(float(flat_angles[j])), rtol, air_distance)
        most = np.maximum(most, met.max(axis=1).astype(int))
        worst = max(worst, float(errors.max()))
        for name, values in found._asdict().items():
            table[name][rows, j] = values
    table["centroid_out"] += origin
    checks.warn_if_inaccurate(worst, rtol)
    missing = [name for name in names if np.any(np.isnan(table[name]))]
    if missing:
        warnings.warn(f"no half level inside the window: nan in {', '.join(missing)}", RuntimeWarning, stacklevel=2)
    if np.any(most > 2):
        many = ", ".join(name for name, times in zip(names, most, strict=False) if times > 2)
        warnings.warn(
            f"the half level is met up to {most.max()} times; the widths are between the two places nearest to the peak: "
            f"{many}",
            RuntimeWarning,
            stacklevel=2,
        )
    dims, pick = checks.dims(frequency=f, angle=angles)
    return datasets.make(
        {n: (dims, v[pick]) for n, v in table.items()},
        checks.coords(frequency=f, angle=angles),
        "beam_width",
        flat,
        slab=slab,
        beam=beam,
        rtol=rtol,
        air_distance=air_distance,
    )
