"""What the command says of an answer, where nothing else is asked for: a question typed, or read from a study file."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection
from typing import TYPE_CHECKING

from .answer import table, units

if TYPE_CHECKING:
    import xarray as xr

#: So many places of a field are shown one by one, on one axis evenly spread where there are more.
PLACES = 20


def written(ds: xr.Dataset, variables: Collection[str]) -> str:
    """Of a field that is in a file alone: the axes of what is there, beside what is held."""
    sizes, there = ", ".join(f"{d} {n}" for d, n in ds.sizes.items()), [name for name in variables if name not in ds]
    return "\n".join(([f"{', '.join(there)} on ({sizes})"] if there and sizes else []) + [field(ds)])


def field(ds: xr.Dataset) -> str:
    """Magnitude and phase where the places are few or on one axis, else what there is; the largest values, the error."""
    names = [str(name) for name in ds.data_vars if not str(name).startswith("error_estimate")]
    dims = [d for d in ds.sizes if any(d in ds[name].dims for name in names)]
    places = 1
    for d in dims:
        places *= ds.sizes[d]
    if not dims:
        lines = [_at_one_place(name, ds[name]) for name in names]
    else:
        few = len(dims) == 1 or (len(dims) == 2 and places <= PLACES)
        lines = [_places(ds, names)] if few else _sizes(ds, names)
        lines += [f"largest |{n}| {float(abs(ds[n]).max()):.6g} {ds[n].attrs['units']}" for n in names]
    if "error_estimate" in ds:
        lines.append(f"estimated error {float(ds['error_estimate'].max()):.1e} of the largest |p| of a plane")
    return "\n".join(lines)


def _at_one_place(name: str, v: xr.DataArray) -> str:
    unit = v.attrs["units"]
    said = f"{name} {v.item():.6g} {unit}"
    if v.dtype.kind != "c":
        return said
    degrees = math.degrees(cmath.phase(v.item()))
    return f"{said}\n|{name}| {abs(v.item()):.6g} {unit}, arg {name} {degrees:.6g} degree"


def _sizes(ds: xr.Dataset, names: list[str]) -> list[str]:
    """The axes of variables, a line for those that have the same."""
    axes = {name: ", ".join(f"{d} {n}" for d, n in ds.sizes.items() if d in ds[name].dims) for name in names}
    return [f"{', '.join(n for n in names if axes[n] == on)} on ({on})" for on in dict.fromkeys(axes.values()) if on]


def _places(ds: xr.Dataset, names: list[str]) -> str:
    """A table of magnitude and phase, of real variables as they are, under a line with the units."""
    import numpy as np

    shown: dict[str, xr.DataArray] = {}
    for name in names:
        v = ds[name]
        if v.dtype.kind != "c":
            shown[name] = v
            continue
        shown[f"|{name}|"] = v.copy(data=np.abs(v.values))
        shown[f"arg {name}"] = v.copy(data=np.angle(v.values, deg=True)).assign_attrs(units="degree")
    tabled, columns = ds.assign(shown), tuple(shown)
    axes = tuple(str(d) for d in ds.sizes if any(d in v.dims for v in shown.values()))
    return f"{units(tabled, (*axes, *columns))}\n{table(tabled, columns, rows=PLACES)}"


def beam_width(ds: xr.Dataset) -> str:
    """Widths, in centimetres."""
    return "widths [cm]\n" + table(ds, ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air"), 100.0)


def beam_measures(ds: xr.Dataset) -> str:
    """What is measured of both beams, under a line with the units."""
    names = ("fwhm", "width_1e2", "centroid", "lateral_shift", "power", "divergence")
    return f"{units(ds, names)}\n{table(ds, names)}"


def scattering(ds: xr.Dataset) -> str:
    """Pressure ratios and shares of the power."""
    return table(ds, ("transmissivity", "reflectivity", "energy_transmission", "absorption"))


def bloch(ds: xr.Dataset) -> str:
    """The Bloch wavenumber."""
    kz = ds["kz_over_k0"]
    return table(ds.assign({"Re kz/k0": kz.real, "Im kz/k0": kz.imag}), ("Re kz/k0", "Im kz/k0"))


def guided_modes(ds: xr.Dataset) -> str:
    """The modes, where there are any."""
    if ds.sizes["mode"] == 0:
        return "no guided mode in the strip"
    k = ds["kx_over_k0"]
    return table(ds.assign({"Re kx/k0": k.real, "Im kx/k0": k.imag}), ("Re kx/k0", "Im kx/k0", "direction"))


#: Name of the question -> what is said of its answer.
SUMMARIES: dict[str, Callable[[xr.Dataset], str]] = {
    "field": field,
    "beam_width": beam_width,
    "beam_measures": beam_measures,
    "scattering": scattering,
    "bloch": bloch,
    "guided_modes": guided_modes,
}
