"""Questions about beams: the field, the widths."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..fields.question import FieldMap
from ..io import datasets
from ..media.sampled import scenes
from ..media.structures import Slab
from ..profiles import fwhm as profile_width
from ..profiles import sections
from ..sources.beams import Beam, moved_to_origin
from . import checks
from .checks import Progress


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
    progress: Progress = iter,
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
        Asked error of the open field over the largest |p| of each plane, wherever on the plane that lies.
    progress : function
        Wraps the list of frequencies that is worked through (``tqdm.tqdm``, say).

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
    """
    validate.function(progress, "progress")
    asked = FieldMap(slab, beam, frequency, x, z, angle, boundary, period, rtol)
    memory.check_field(asked.shape)
    p = np.empty(asked.shape, complex)
    for i, _ in enumerate(progress(asked.frequency)):
        asked.choose(i)
        asked.fill(slice(None), slice(None), p[i])
    asked.announce()
    return asked.dataset(p)


def beam_width(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-8,
    air_distance: float | None = None,
    progress: Progress = iter,
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
    progress : function
        Wraps the list of blocks that is worked through (``tqdm.tqdm``, say).

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
    """
    validate.function(progress, "progress")
    validate.instance(slab, Slab, "slab")
    validate.instance(beam, Beam, "beam")
    f = validate.axis(frequency, "frequency", positive=True)
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
    for rows, j in progress(work):
        s = scenes(slab, flat[rows])
        found, met, errors = sections.rows(s, source.at_angle(float(flat_angles[j])), rtol, air_distance)
        most = np.maximum(most, met.max(axis=1).astype(int))
        worst = max(worst, float(errors.max()))
        for name, values in found._asdict().items():
            table[name][rows, j] = values
    table["centroid_out"] += origin
    checks.announce(worst, rtol)
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


def fwhm(profile: xr.DataArray, dim: str = "x", width_of: str = "pressure") -> xr.DataArray:
    """Full width at half maximum of a profile along a dimension.

    Parameters
    ----------
    profile : DataArray
        Complex pressure (or \\|p\\|).
    dim : str
    width_of : "pressure" or "intensity"
        Width of \\|p\\|, or of \\|p\\|^2.

    Returns
    -------
    DataArray
        In the units of `dim`, located on a cubic spline of the samples; nan with a warning where the half level is not
        reached inside the window, and a warning where it is met more than twice.
    """
    validate.instance(profile, xr.DataArray, "profile")
    if not isinstance(dim, str) or dim not in profile.dims:
        raise ValueError(f"dim: expected one of {', '.join(map(str, profile.dims))}, got {dim!r}")
    validate.word(width_of, "width_of", *profile_width.HALF_LEVEL)
    if profile.sizes[dim] < 4:
        raise ValueError(f"profile: expected at least 4 samples along {dim}, got {profile.sizes[dim]}")
    ordered = profile.sortby(dim)
    x = np.asarray(ordered[dim], float)
    if not np.all(np.isfinite(ordered)):
        raise ValueError("profile: expected finite values, got NaN or infinity")

    level, crossings = profile_width.HALF_LEVEL[width_of], [0]

    def one(p: np.ndarray) -> float:
        found = profile_width.full_width(x, p, level)
        crossings.append(int(np.count_nonzero(np.diff(np.abs(p) > level * found.peak))))
        return found.width

    out = xr.apply_ufunc(one, ordered, input_core_dims=[[dim]], vectorize=True, output_dtypes=[float])
    if np.any(np.isnan(out)):
        warnings.warn("fwhm: the half level is not reached inside the window: nan", RuntimeWarning, stacklevel=2)
    if max(crossings) > 2:
        warnings.warn(
            f"fwhm: the half level is met up to {max(crossings)} times; the width is between the two places nearest to "
            "the peak",
            RuntimeWarning,
            stacklevel=2,
        )
    out.attrs = {"units": profile[dim].attrs.get("units", "m"), "long_name": "full width at half maximum"}
    return out.rename("fwhm")
