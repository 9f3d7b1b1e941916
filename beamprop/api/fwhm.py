"""`fwhm`: the width of a profile."""

from __future__ import annotations

import warnings

import numpy as np
import xarray as xr

from .. import validate
from ..profiles import fwhm as profile_width
from . import checks


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

    Examples
    --------
    >>> import xarray as xr
    >>> x = np.linspace(-1, 1, 201)
    >>> profile = xr.DataArray(np.exp(-((x / 0.2) ** 2)), {"x": x}, "x")
    >>> round(float(bp.fwhm(profile)), 4)
    0.333
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

    rows = ordered.transpose(..., dim)
    measured = profile_width.of_samples(x, rows.values.reshape(-1, x.size), profile_width.HALF_LEVEL[width_of])
    first_sample = rows.drop_vars([name for name, c in rows.coords.items() if dim in c.dims]).isel({dim: 0})
    out = first_sample.copy(data=measured.width.reshape(rows.shape[:-1]))
    if np.any(np.isnan(out)):
        warnings.warn("fwhm: the half level is not reached inside the window: nan", RuntimeWarning, stacklevel=2)
    checks.warn_of_crossings(int(measured.crossings.max(initial=0)))
    out.attrs = {"units": profile[dim].attrs.get("units", "m"), "long_name": "full width at half maximum"}
    return out.rename("fwhm")
