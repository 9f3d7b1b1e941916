"""What may be wrong with a comparison itself: sign convention, boundaries, samples that do not resolve a field."""

from __future__ import annotations

import warnings

import numpy as np
import xarray as xr

from ..io import datasets
from .grid import SAME_POSITION
from .norms import norm, scaled_misfit

#: Misfits below this are no question of a sign convention: fields that fit so well have the right one, or no direction.
NOTICEABLE = 1e-3


def warn_of_conjugate(a: np.ndarray, b: np.ndarray, w: np.ndarray) -> bool:
    """Whether conj(b), scaled, is much nearer to a than b, scaled."""
    sizes = norm(a, w)
    if not np.any(sizes > 0):
        return False
    power = (sizes / sizes.max()) ** 2
    as_it_is, turned = (
        float(np.sqrt(np.average(np.nan_to_num(scaled_misfit(a, p, w), nan=1.0) ** 2, weights=power)))
        for p in (b, np.conj(b))
    )
    better = as_it_is > NOTICEABLE and turned < as_it_is / 3
    if better:
        warnings.warn(
            f"b looks like exp(+i w t): conj(b) fits a with a relative L2 error of {turned:.2g}, b with "
            f"{as_it_is:.2g} (each with its best scale factor)",
            stacklevel=4,
        )
    return better


#: Errors of interpolation below this are not warned of: less than finite elements of the default size err.
TOLERATED = 3e-4


def warn_of_interpolation(between: float, error: np.ndarray) -> None:
    """Warn where the interpolation of b, error `between`, makes much of the relative error of the comparison."""
    if between > TOLERATED and between > 0.3 * np.max(error, initial=0.0, where=np.isfinite(error)):
        warnings.warn(
            f"b's points do not resolve its field: interpolating it makes a relative error of about "
            f"{between:.2g}; compare on the same x and z",
            stacklevel=4,
        )


def warn_of_layers(a: xr.Dataset, b: xr.Dataset, old: np.ndarray, new: np.ndarray) -> bool:
    """Whether b's z skip layers: such samples may look smooth, and only the structure tells that the field is not."""
    for ds in (a, b):
        slab = datasets.provenance(ds).get("slab") if "provenance" in ds.attrs else None
        if slab is None:
            continue
        layers = [layer.thickness for cell, _ in slab.segments for layer in cell.layers if hasattr(layer, "thickness")]
        inside = old[(old > 0) & (old < slab.thickness)]
        needed = np.any((new > 0) & (new < slab.thickness)) and (len(layers) > 1 or len(slab.segments) > 1)
        if needed and (inside.size < 2 or np.diff(inside).max() > min(layers) / 2):
            warnings.warn(
                f"the field changes from layer to layer ({min(layers):.3g} m), and b's z are too far apart "
                "to be interpolated inside of the slab: compare on the same z",
                stacklevel=4,
            )
            return True
    return False


def boundary_of(ds: xr.Dataset) -> tuple[str | None, np.ndarray | None]:
    """Boundary and periods [m] that a dataset states, along x or along x and y; a field in open space has no period."""
    boundary, period = ds.attrs.get("boundary"), ds.attrs.get("period")
    return boundary, None if period is None or boundary == "open" else np.atleast_1d(np.asarray(period, float))


def _said(period: np.ndarray, digits: int = 6) -> str:
    """Periods in words."""
    return " x ".join(f"{length:.{digits}g}" for length in period)


def _same(period: np.ndarray, second: np.ndarray) -> bool:
    return period.size == second.size and bool(np.all(np.abs(period - second) <= SAME_POSITION * period))


def warn_of_boundaries(a: xr.Dataset, b: xr.Dataset, wraparound: np.ndarray | None) -> None:
    """Warn where the boundaries or periods of a and b differ: the neighbouring beams are counted in the error then."""
    (kind_a, period_a), (kind_b, period_b) = boundary_of(a), boundary_of(b)
    if {kind_a, kind_b} == {"open", "periodic"}:
        which, period = ("a", period_a) if kind_a == "periodic" else ("b", period_b)
        text = f"{which} is periodic{'' if period is None else f' ({_said(period)} m)'} and the other in open space"
    elif period_a is not None and period_b is not None and not _same(period_a, period_b):
        text = f"a has the period {_said(period_a, 9)} m, b {_said(period_b, 9)} m"
    else:
        return
    share = "" if wraparound is None else f", estimated at {np.nanmax(wraparound):.2g} (wraparound)"
    warnings.warn(f"{text}: the wrap-around of the neighbouring beams is counted in the error{share}", stacklevel=4)
