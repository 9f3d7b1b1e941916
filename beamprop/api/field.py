"""`field`: the total pressure of a beam in front of, inside and behind a slab."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from .. import memory, validate
from ..media.structures import Slab
from ..progress import Progress, watched
from ..sources.base import Beam
from . import checks
from .cell_average import averaged_row
from .field_in_space import question_at
from .field_question import labelled
from .field_variables import bytes_held, kinds, no_errors, of_component, powers


def field(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    x: Any,
    z: Any,
    angle: Any = None,
    boundary: str = "open",
    period: float | tuple[float, float] | None = None,
    rtol: float = 1e-8,
    progress: Progress = False,
    *,
    variables: str | Sequence[str] = ("p",),
    average: str | None = None,
    y: Any = None,
    azimuth: float | None = None,
    component: str | None = None,
) -> xr.Dataset:
    """Total pressure of a beam in front of, inside and behind a slab; particle velocity, intensity and power on request.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
        With y a GaussianBeam, circular or elliptical, a Piston, Bowl, SourcePlane or Array. Also a sum of these, ``a + 0.5j * b``.
    frequency : float or 1-D array, Hz
    x, z : float or 1-D array, m
        Any positions; z not in front of the launch plane ``beam.z0``.
    angle : float or 1-D array, degree, optional
        Overrides the beam's. All angles share one response.
    boundary : "open" or "periodic"
        "open": one beam in open space, the limit of vanishing absorption. "periodic": an array of beams, `period`
        apart: the plain sum over real kx, which is what a calculation with periodic sides answers.
    period : float, or two of them, m
        For "periodic"; the length of the x grid (n dx) where it is even and no period is given. With y two of them, along x and y.
    rtol : float
        Requested error of the open field over the largest |p| of each plane, wherever on the plane that lies.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of frequencies that is worked through.

    variables : str or list of str
        Of the dataset, by default "p" alone. Others are

        * "v_x", "v_z" [m/s]: particle velocity. v_z is continuous; at an interface v_x, and with it intensity_x, is that of the
          medium behind it.
        * "u_x", "u_z" [m]: displacement, v = -i w u; "s_xz" [Pa]: shear stress, 0 in fluids. In solids p is -s_zz.
        * "intensity_x", "intensity_z" [W/m^2], all by "intensity": time-averaged intensity Re(p v*)/2. p and v keep half of rtol then.
          In solids, where shear stress has a part in it, it is refused.
        * with y, "v_y", "u_y", "s_yz" and "intensity_y" as well.
        * "power_through" [W/m], with y [W]: time-averaged power through each whole plane along z, without y for each
          metre along y (with a period: through one period or cell), on (frequency, angle, z). Without loss, what a beam
          feeds into guided modes, which run along the slab for ever, is left out; of two half-spaces and a slab without
          loss, all planes have the same.
    component : "p", "v_x", "v_z", "u_x", "u_z" or "s_xz", optional
        The one variable of the dataset, instead of `variables`. All are defined in fluids, too, where s_xz is 0.
    y : float or 1-D array, m, optional
        Makes it a question in three dimensions: see docs/three-dimensions.md.
    azimuth : float, degree, optional
        With y: overrides the beam's, the direction of its tilt from x towards y.

    average : "cell", optional
        Means over one cell about each plane that lies in a row of cells of several layers (near the ends of the row, over the first or the
        last cell), instead of values at the planes: inside a cell the pressure ripples by its own mean. Planes elsewhere, and
        power_through, are as without it.

    Returns
    -------
    Dataset
        `p` on (frequency, angle, z, x), with y on (frequency, angle, z, y, x), scalars as scalar coordinates, and `error_estimate` on (frequency, angle), of
        open fields: the largest difference between two contours of integration that share no error term, and what planes
        gain that are made of others. Each other variable has its own, ``error_estimate_v_x`` for v_x: over the largest |v_x| of
        the plane, of an intensity over half the product of the largest |p| and |v|, of a power over that of the incident
        beam.

    Warns
    -----
    AccuracyWarning
        The estimate is above rtol.
    HintWarning
        Many planes skip through the cells of the slab: a map of them shows stripes that are not there. `faces` makes planes that do not.

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
    >>> flow = bp.field(slab, beam, 2500.0, x=0.0, z=[-0.01, 0.0], variables=["v_z", "intensity", "power_through"])
    >>> list(flow)[:4], flow.v_z.attrs["units"]
    (['v_z', 'intensity_x', 'intensity_z', 'power_through'], 'm/s')
    >>> ellipse = bp.GaussianBeam(fwhm=(0.3, 0.15), angle=45, azimuth=30, z0=-0.1)
    >>> plane = bp.field(slab, ellipse, 2500.0, x=np.linspace(-1, 1, 65), z=slab.thickness, y=np.linspace(-1, 1, 49))
    >>> dict(plane.p.sizes)
    {'y': 49, 'x': 65}
    """
    validate.flag_or_function(progress, "progress")
    variables = of_component(component, variables)
    places, values_of, sides = (x, y, z, azimuth), (variables, average), (boundary, period)
    question, labels = question_at(places, slab, beam, (frequency, angle), sides, rtol, values_of)
    names, shape = labels.variables, question.shape
    memory.check_field((*shape[:3], math.prod(shape[3:])), values=bytes_held(names, question))
    values: dict[str, np.ndarray] = {name: np.empty(shape, kind) for name, kind in kinds(names).items()}
    errors = no_errors(names, shape)
    for i, _ in enumerate(watched(progress, question.frequency, "frequencies")):
        row = averaged_row(question, i, names, average)
        errors.add(i, slice(None), row.fill(slice(None), slice(None), {name: v[i] for name, v in values.items()}))
    if "power_through" in names:
        values["power_through"] = powers(question, errors)
    for budget, scale in errors.worst_by_scale:
        checks.warn_if_inaccurate(budget, question.rtol, scale)
    return labelled(labels, errors.total, values)
