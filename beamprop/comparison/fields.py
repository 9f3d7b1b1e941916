"""Two fields of the same problem, measured against each other: ours, finite elements, or a file's.

b is brought onto a's points in the region that both cover. With weights w (the grid's cells) and sums over z and x,

    relative_l2 = sqrt(sum w |a - b|^2 / sum w |a|^2),    scale = sum w conj(b) a / sum w |b|^2,

and the scale is the complex factor that brings b nearest to a.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..io import datasets
from ..io.labels import COMPARISON, COORDINATES, label
from .grid import matched, on_common_grid, pressure_of
from .norms import best_scale, errors, scaled_misfit, weights
from .period import wraparound
from .warn import warn_of_boundaries, warn_of_conjugate, warn_of_interpolation, warn_of_layers
from .widths import widths_and_peaks

_FIELDS = ("p_a", "p_b", "error")
_BY_Z = tuple(n for n in COMPARISON if n.startswith(("fwhm", "peak", "relative_l2_by")))


def compare(
    a: xr.Dataset, b: xr.Dataset, rescale: bool = False, *, open_reference: xr.Dataset | None = None
) -> xr.Dataset:
    """Measure field b against field a.

    Parameters
    ----------
    a, b : Dataset
        With the pressure `p` on (z, x), from `beamprop.field`, `fem.field` or `read_comsol`; further dims such as
        frequency and angle must be the same in both.
    rescale : bool
        Multiply b by the best complex scale factor first, for fields that were launched with different amplitudes.
    open_reference : Dataset, optional
        The same field in open space. Its difference to the periodic one of a and b (a, if both are) is reported as
        `wraparound`: that share of the error comes from the period, and not from either code.

    Returns
    -------
    Dataset
        By frequency and angle, if there are any: `relative_l2`, `relative_l2_scaled` and `scale`, `largest_error` (over
        the largest |a|) and where it is. By z too: `relative_l2_by_z` (over |a| at that z), `fwhm_a`, `fwhm_b` and
        `fwhm_difference` (NaN where the half level is not reached), `peak_a`, `peak_b` and `peak_difference`. The
        fields `p_a`, `p_b` and `error` = |a - b| on a's points in the region that both cover, in a's unit. The
        attribute `conjugate_fits_better` is 1 where conj(b) is much nearer to a than b.

    Raises
    ------
    ValueError
        No `p`, no common region, another frequency or angle, units that cannot be converted.

    Warns
    -----
    UserWarning
        Different boundaries or periods, b that looks like exp(+i w t), points without a value, a field that b's points
        do not resolve.

    Notes
    -----
    Between b's points, cubic splines of the complex field: b must resolve it, and `interpolation_error` estimates how
    well it does. Inside a slab of thin layers the field changes from layer to layer, so there both need the same z.
    Points that are NaN in either field are left out.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> x = np.linspace(-0.5, 0.5, 201)
    >>> one = bp.field(slab, beam, 2500.0, x, slab.thickness * np.array([0, 1]))
    >>> effective = bp.field(bp.lmmd_emt_slab(slab), beam, 2500.0, x, slab.thickness * np.array([0, 1]))
    >>> round(float(bp.compare(one, effective).relative_l2), 3)
    0.056
    """
    validate.flag(rescale, "rescale")
    with np.errstate(over="ignore", invalid="ignore"):  # a ratio of |p| that no double holds is infinite
        return _compared(a, b, bool(rescale), open_reference)


def _compared(a: xr.Dataset, b: xr.Dataset, rescale: bool, open_reference: xr.Dataset | None) -> xr.Dataset:
    p_a = pressure_of(a, "a")
    unit = p_a.attrs.get("units")
    p_b = matched(pressure_of(b, "b"), p_a, unit, "b")
    z_b = p_b["z"].values
    p_a, p_b, shares = on_common_grid(p_a, p_b, "b")
    between = np.hypot(shares["z"], shares["x"])
    w = weights(p_a, p_b)
    filled_a, filled_b = (np.where(w > 0, p.values, 0) for p in (p_a, p_b))
    scale = best_scale(filled_a, filled_b, w)
    misfit = scaled_misfit(filled_a, filled_b, w)
    out: dict[str, Any] = {"scale": scale, "relative_l2_scaled": misfit, "interpolation_error": between}
    conjugate = warn_of_conjugate(filled_a, filled_b, w)
    if open_reference is not None:
        out["wraparound"] = wraparound(a, b, open_reference)
    warn_of_boundaries(a, b, out.get("wraparound"))
    if rescale:
        p_b, filled_b = p_b * scale[..., None, None], filled_b * scale[..., None, None]
    out |= errors(filled_a, filled_b, w, p_a.x.values, p_a.z.values) | widths_and_peaks(p_a, p_b)
    if not (shares["z"] and warn_of_layers(a, b, z_b, p_a["z"].values)):
        warn_of_interpolation(between, out["relative_l2"])
    out |= {"p_a": p_a.values, "p_b": p_b.values, "error": np.abs(p_a.values - p_b.values)}
    return _dataset(out, p_a, unit, a, b, rescale=rescale, conjugate_fits_better=int(conjugate))


def _dataset(
    variables: dict[str, np.ndarray], p: xr.DataArray, unit: str | None, a: xr.Dataset, b: xr.Dataset, **settings: Any
) -> xr.Dataset:
    known = {n: (tuple(map(str, c.dims)), c.values) for n, c in p.coords.items() if n in COORDINATES}
    frequency = np.atleast_1d(np.asarray(p.coords["frequency"].values if "frequency" in p.coords else [], float))
    dims = tuple(map(str, p.dims))
    own = {**dict.fromkeys(_FIELDS, dims), **dict.fromkeys(_BY_Z, dims[:-1]), "interpolation_error": ()}
    arrays = {n: (own.get(n, dims[:-2]), v) for n, v in variables.items()}
    ds = datasets.make(
        arrays,
        {str(n): c for n, c in known.items()},
        "compare",
        frequency,
        a=a.attrs.get("provenance"),
        b=b.attrs.get("provenance"),
        **settings,
    )
    further = {n: c.variable for n, c in p.coords.items() if n not in known and set(c.dims) <= set(p.dims)}
    ds = ds.assign_coords(further)
    for name, variable in ds.data_vars.items():
        if COMPARISON[str(name)][0] == "Pa":
            variable.attrs["units"] = unit or "1"
    for name in ("z", "x"):
        ds[name].attrs = label(name) | p[name].attrs
    return ds.assign_attrs(
        {k: v for k, v in settings.items() if k == "conjugate_fits_better"}, rescaled=int(settings["rescale"])
    )
