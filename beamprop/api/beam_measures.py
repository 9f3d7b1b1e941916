"""`beam_measures`: a beam as a whole, reflected and transmitted."""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..contour.error import uniform_budget
from ..io import datasets
from ..media.structures import Slab
from ..profiles import measures
from ..profiles.power import PowerError
from ..progress import Progress, watched
from ..response.sampled_slab import sample
from ..sources.base import Beam
from . import checks
from .space_beams import is_in_space, measures_in_space, space_beams, warn_of_cut_moments

#: Variables that are positions on x.
PLACES = ("centroid", "moments_from", "moments_to")


def beam_measures(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-6,
    progress: Progress = False,
    window: float | None = None,
    *,
    azimuth: float | None = None,
) -> xr.Dataset:
    """The reflected beam at the near face and the transmitted beam at the far face, measured.

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
    progress : function
        Wraps the list of (frequency, angle) pairs that is worked through.
    window : float, optional, m
        Half-width of a window about the geometric ray of each side: everything on x is measured in it, and moments are
        integrals over all of it. For slabs without loss, whose guided waves run along for ever: without them the centroid is
        that of the beam alone, with them it depends on how far one looks. By default the window is widened until |p| falls
        to a hundredth of its peak on both sides; in three dimensions along each axis, as far as lattices of plane waves stay small.
    azimuth : float, degree, optional
        Makes it a question of three dimensions, as a beam of two widths, an azimuth or a y0 and transducers do by themselves; overrides the
        beam's, the direction of its tilt from x towards y.

    Returns
    -------
    Dataset
        On (frequency, angle, side):

        * `fwhm`, `width_1e2` [m]: between the places nearest to the peak where |p| is half, |p|^2 is 1/e^2 of the largest;
        * `width_second_moment` (four standard deviations of |p|^2; 2 a of a Gaussian of 1/e radius a) and `centroid` [m],
          inside the part around the peak where |p| exceeds a hundredth of it, or inside the whole window if one is given or
          |p| does not fall so far;
        * `moments_from`, `moments_to` [m]: the interval over which these were taken, and `rim`, the larger |p| at its ends over
          the peak: a hundredth or less, unless the beam is cut off there;
        * `lateral_shift` [m]: centroid less the geometric ray: for the reflected beam the ray that meets the near face (the
          Goos-Haenchen shift), for the transmitted one the same ray carried straight on to the far face;
        * `peak` [Pa]; `power`: radiated share of the launched power (plane waves that propagate; evanescent and guided
          waves carry none away along z);
        * `divergence` and `far_angle` [degree]: two standard deviations and mean of the direction of the radiated power, in a solid
          behind by the wavenumber of its S waves;
        * `crossings`: how often |p| crosses the half level inside the window; 2 for a plain beam.

        In three dimensions these have a dimension `axis`, "x" and "y", but for `peak`, `power`, `far_angle` and `rim`. Widths by a level are
        those of cuts through the peak, the `divergence` that of the angles to the planes x = 0 and y = 0, `far_angle` that of the mean direction
        from the normal. Beside them are `far_azimuth` [degree], `area` [m^2], the connected part around the peak where |p| is half of it
        or more, `ellipticity`, the smaller over the larger width by second moments along their principal axes (as in ISO 11146), and
        `orientation` [degree], the direction of the larger. Second moments are taken over the connected part around the peak where |p| exceeds
        a hundredth of it, or over the `window` on both axes, a square. The geometric ray of a sum starts in the middle
        of its sources, along the angle that they share or else the normal; `power` has their terms of interference.

    Warns
    -----
    RuntimeWarning
        A level is not reached inside the window, or nothing goes that way (nan); the half level is met more than twice; |p|
        does not fall to a hundredth in the widest window that is tried, and none was given; the peak is a ring, in three dimensions, and cuts
        pass through its place farthest along x.
    AccuracyWarning
        The estimated error of a beam's |p|, over the largest, or of its power, over that power, is above rtol.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> ds = bp.beam_measures(slab, bp.GaussianBeam(0.3, angle=30), 2500.0)
    >>> ds.side.values.tolist()
    ['reflected', 'transmitted']
    >>> bool(ds.power.sum("side") < 1)  # the rest is absorbed
    True
    >>> ellipse = bp.GaussianBeam((0.3, 0.15), angle=30, azimuth=20)
    >>> ds = bp.beam_measures(slab, ellipse, 2500.0).sel(side="transmitted")
    >>> dict(ds.lateral_shift.sizes), bool(ds.ellipticity < 0.6)
    ({'axis': 2}, True)
    """
    validate.flag_or_function(progress, "progress")
    half = None if window is None else validate.as_number(window, "window", positive=True)
    if is_in_space(beam, azimuth):
        return measures_in_space(space_beams(slab, beam, frequency, angle, rtol, azimuth), half, progress)
    beams = checks.beams(slab, beam, frequency, angle, rtol)
    flat, angles = beams.flat
    checks.warn_if_not_ended(beam, slab, flat, -beam.z0, beams.rtol)
    memory.check_table(flat.size * angles.size, 280.0)
    table = {name: np.full((flat.size, angles.size, 2), np.nan) for name in measures.Beamlet._fields}
    worst, worst_power = uniform_budget(1, 0.0), PowerError()
    each = list(itertools.product(range(flat.size), range(angles.size)))
    for i, j in watched(progress, each, "beams"):
        s = sample(slab, float(flat[i]))
        both = measures.reflected_and_transmitted(s, beams.source.at_angle(float(angles[j])), beams.rtol, half)
        for side, (beamlet, budget, of_power) in enumerate(both):
            worst, worst_power = worst.worse(budget), max(worst_power, of_power, key=lambda error: error.total)
            for name, value in beamlet._asdict().items():
                table[name][i, j, side] = value
    for name in PLACES:
        table[name] += beams.origin
    checks.warn_if_inaccurate(worst, beams.rtol)
    checks.warn_if_inaccurate(worst_power, beams.rtol, of="a power")
    _warn_of_missing(table)
    warn_of_cut_moments(table["rim"], window is not None)
    checks.warn_of_crossings(int(table["crossings"].max()))
    dims, pick = checks.dims(**beams.axes)
    coords = checks.coords(**beams.axes) | {"side": (("side",), list(measures.SIDES))}
    variables = {n: ((*dims, "side"), v[pick]) for n, v in table.items()}
    variables["crossings"] = (variables["crossings"][0], variables["crossings"][1].astype(int))
    return datasets.make(variables, coords, "beam_measures", flat, slab=slab, beam=beam, rtol=beams.rtol, window=half)


def _warn_of_missing(table: dict[str, np.ndarray]) -> None:
    missing = [name for name, values in table.items() if np.any(np.isnan(values))]
    if missing:
        warnings.warn(
            f"no beam on a side, or a level not reached inside the window: nan in {', '.join(missing)}",
            RuntimeWarning,
            stacklevel=3,
        )
