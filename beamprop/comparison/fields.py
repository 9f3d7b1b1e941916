"""Two fields of the same problem, measured against each other: ours, finite elements, or a file's.

b is brought onto a's points in the region that both cover, or a field of ours is evaluated at the nodes of the other's mesh. With
weights w (the grid's cells, the areas around nodes) and sums over z and x,

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
from .grid import PLACES, as_rows, matched, on_common_grid, places_of, pressure_of
from .nodes import on_nodes, scattered
from .norms import best_scale, cell_areas, errors, scaled_misfit, weights
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
        With the pressure `p` on (z, x), or with y on (y, x), (z, y) or (z, y, x), from `beamprop.field`, `fem.field` or `read_comsol`; further dims such as
        frequency and angle must be the same in both. Either may be on scattered nodes, the other being from `field`.
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
        attribute `conjugate_fits_better` is 1 where conj(b) is much nearer to a than b; `compared_on` says which points
        those are, and what was interpolated. On nodes there are no quantities by z. With y, norms are over planes and volumes,
        places have `largest_error_y`, and widths, along x and along y through the largest \\|p\\| of each plane, an `axis`.

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

    Nodes of a mesh: the field of ours is not interpolated but evaluated there, from the slab, the beam and the rtol that its
    dataset records. N nodes cost N times the plane waves of the field (hundreds to thousands) in exponentials, in blocks of bounded
    memory. Two meshes, or a mesh and a field that `field` did not make, are brought onto one grid with `to_grid`.

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
    compared = _compared_on_nodes if scattered(a) or scattered(b) else _compared_on_grid
    with np.errstate(over="ignore", invalid="ignore"):  # a ratio of |p| that no double holds is infinite
        return compared(a, b, bool(rescale), open_reference)


def _compared_on_grid(a: xr.Dataset, b: xr.Dataset, rescale: bool, open_reference: xr.Dataset | None) -> xr.Dataset:
    p_a = pressure_of(a, "a")
    unit = p_a.attrs.get("units")
    p_b = matched(pressure_of(b, "b"), p_a, unit, "b")
    z_b = p_b["z"].values
    p_a, p_b, shares = on_common_grid(p_a, p_b, "b")
    between = float(np.linalg.norm(list(shares.values())))
    rows_a, rows_b = as_rows(p_a.values, p_a), as_rows(p_b.values, p_a)
    w = weights(rows_a, rows_b, cell_areas(p_a))
    out, filled_a, filled_b = _scaled(rows_a, rows_b, w, rescale)
    conjugate = warn_of_conjugate(filled_a, filled_b, w)
    if open_reference is not None:
        out["wraparound"] = wraparound(a, b, open_reference)
    warn_of_boundaries(a, b, out.get("wraparound"))
    if rescale:
        p_b = p_b * np.expand_dims(out["scale"], tuple(range(-len(places_of(p_a)), 0)))
    across = {d: p_a[d].values for d in places_of(p_a) if d != "z"}
    out |= errors(filled_a, filled_b, w, across, p_a.z.values) | widths_and_peaks(p_a, p_b)
    if not (shares["z"] and warn_of_layers(a, b, z_b, p_a["z"].values)):
        warn_of_interpolation(between, out["relative_l2"])
    out |= {"interpolation_error": between} | _fields_of(p_a, p_b)
    how = "points of a; b by cubic splines where it has other points"
    return _dataset(out, p_a, (a, b), rescale, conjugate_fits_better=int(conjugate), compared_on=how)


def _compared_on_nodes(a: xr.Dataset, b: xr.Dataset, rescale: bool, open_reference: xr.Dataset | None) -> xr.Dataset:
    if open_reference is not None:
        raise ValueError("open_reference: expected none for scattered nodes, got one")
    p_a, p_b, areas, how = on_nodes(a, b)
    p_b = matched(p_b, p_a, p_a.attrs.get("units"), "b")
    row_a, row_b = (p.values[..., None, :] for p in (p_a, p_b))  # as one row of a grid
    w = weights(row_a, row_b, areas)
    out, filled_a, filled_b = _scaled(row_a, row_b, w, rescale)
    conjugate = warn_of_conjugate(filled_a, filled_b, w)
    warn_of_boundaries(a, b, None)
    if rescale:
        p_b = p_b * out["scale"][..., None]
    out |= errors(filled_a, filled_b, w, {"x": np.arange(areas.size)}, np.zeros(1)) | {"interpolation_error": 0.0}
    worst = out["largest_error_x"]
    out |= {f"largest_error_{n}": p_a[n].values[worst] for n in ("x", "z")} | _fields_of(p_a, p_b)
    del out["relative_l2_by_z"]
    return _dataset(out, p_a, (a, b), rescale, conjugate_fits_better=int(conjugate), compared_on=how)


def _scaled(
    a: np.ndarray, b: np.ndarray, w: np.ndarray, rescale: bool
) -> tuple[dict[str, Any], np.ndarray, np.ndarray]:
    """The best scale and what it leaves, and both fields, 0 where either has no value; b times the scale if asked for."""
    a, b = (np.where(w > 0, p, 0) for p in (a, b))
    scale, misfit = best_scale(a, b, w), scaled_misfit(a, b, w)
    return {"scale": scale, "relative_l2_scaled": misfit}, a, b * scale[..., None, None] if rescale else b


def _fields_of(p_a: xr.DataArray, p_b: xr.DataArray) -> dict[str, np.ndarray]:
    return {"p_a": p_a.values, "p_b": p_b.values, "error": np.abs(p_a.values - p_b.values)}


def _dataset(
    variables: dict[str, Any], p: xr.DataArray, compared: tuple[xr.Dataset, xr.Dataset], rescale: bool, **attrs: Any
) -> xr.Dataset:
    known = {n: (tuple(map(str, c.dims)), c.values) for n, c in p.coords.items() if n in COORDINATES}
    frequency = np.atleast_1d(np.asarray(p.coords["frequency"].values if "frequency" in p.coords else [], float))
    dims = tuple(map(str, p.dims))
    lead = tuple(d for d in dims if d not in PLACES)
    own = {**dict.fromkeys(_FIELDS, dims), **dict.fromkeys(_BY_Z, (*lead, "z")), "interpolation_error": ()}
    if "y" in dims:
        own |= dict.fromkeys([n for n in _BY_Z if n.startswith("fwhm")], (*lead, "z", "axis"))
        known["axis"] = (("axis",), np.array(["x", "y"]))
    arrays = {n: (own.get(n, lead), v) for n, v in variables.items()}
    ds = datasets.make(
        arrays,
        {str(n): c for n, c in known.items()},
        "compare",
        frequency,
        a=compared[0].attrs.get("provenance"),
        b=compared[1].attrs.get("provenance"),
        rescale=rescale,
        **attrs,
    )
    further = {n: c.variable for n, c in p.coords.items() if n not in known and set(c.dims) <= set(p.dims)}
    ds = ds.assign_coords(further)
    for name, variable in ds.data_vars.items():
        if COMPARISON[str(name)][0] == "Pa":
            variable.attrs["units"] = p.attrs.get("units") or "1"
    for name in (n for n in PLACES if n in ds.coords and n in p.coords and n != "node"):
        ds[name].attrs = label(name) | p[name].attrs
    return ds.assign_attrs(attrs, rescaled=int(rescale))
