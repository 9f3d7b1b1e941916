"""Finite elements against plane waves: the error falls with the element size h as h^(order + 1).

Two slabs at the same period: the paper's, whose layers are far thinner than an element is wide, and two layers as thick as
the elements, one of negative density. Elements shrink along x and z together.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, FWHM, WAVELENGTH, Statement, run, slab

import beamprop as bp
from beamprop import fem

PERIOD = 6.3 * WAVELENGTH
#: Elements along x of the coarsest mesh, about 0.1, 0.2, 0.4 and 0.5 wavelengths wide, and how they are divided.
COARSEST = {1: 63, 2: 32, 3: 16, 4: 12}
DIVISIONS = (1.0, 1.5, 2.0, 3.0, 4.0)
#: Rows of elements in a layer of the coarsest mesh.
ROWS = {"paper": {1: 1, 2: 1, 3: 1, 4: 1}, "thick": {1: 5, 2: 4, 3: 2, 4: 2}}


def slabs() -> dict[str, bp.Slab]:
    """The paper's lossy slab, and two thick layers with densities of both signs."""
    bulk = bp.AIR.bulk_modulus
    layers = [bp.Layer(bp.Fluid(2.5 + 0.1j, bulk), 0.02), bp.Layer(bp.Fluid(-1 + 0.1j, bulk), 0.02)]
    return {"paper": slab(450), "thick": bp.Slab(layers)}


def errors(name: str, structure: bp.Slab, divisions: tuple[float, ...]) -> xr.Dataset:
    """Relative L2 error inside and behind one slab, and seconds: (order, division), with h beside them."""
    beam = bp.GaussianBeam(FWHM, angle=45, z0=-0.1)
    # positions that share no step with a mesh
    x = np.linspace(-PERIOD / 2, PERIOD / 2, 601)
    z = np.linspace(0, structure.thickness + 0.1, 62)[1:]
    exact = bp.field(structure, beam, DESIGN, x, z, boundary="periodic", period=PERIOD).p.values
    shape = (len(COARSEST), len(divisions))
    h, error, seconds = np.empty(shape), np.empty(shape), np.empty(shape)
    for i, (order, coarsest) in enumerate(COARSEST.items()):
        for j, division in enumerate(divisions):
            n, rows = round(coarsest * division), round(ROWS[name][order] * division)
            ds = fem.field(structure, beam, DESIGN, x, z, PERIOD, order=order, elements_x=n, layer_rows=rows)
            h[i, j] = PERIOD / WAVELENGTH / n
            error[i, j] = np.linalg.norm(ds.p.values - exact) / np.linalg.norm(exact)
            seconds[i, j] = ds.seconds
    dims = ("order", "division")
    axes = {"order": list(COARSEST), "division": list(divisions), "h": (dims, h)}
    out = xr.Dataset({"error": (dims, error), "seconds": (dims, seconds)}, axes)
    out.h.attrs = {"units": "1", "long_name": "element width over the wavelength"}
    out.error.attrs = {"units": "1", "long_name": "relative L2 error inside and behind the slab"}
    out.seconds.attrs = {"units": "s", "long_name": "time of a solve"}
    return out


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """Errors of both slabs, over a factor of four in h (two meshes with `quick`)."""
    divisions = DIVISIONS[2::2] if quick else DIVISIONS
    return {name: errors(name, structure, divisions) for name, structure in slabs().items()}


def rates(ds: xr.Dataset) -> np.ndarray:
    """Measured order of convergence over the last halving of h, by order."""
    last, before = ds.isel(division=-1), ds.sel(division=ds.division[-1] / 2)
    return (np.log(before.error / last.error) / np.log(before.h / last.h)).values


def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Error against h, with the measured rate at every line."""
    fig, axes = plt.subplots(1, 2, figsize=(9, 4.2), sharey=True, layout="constrained")
    titles = {"paper": "the paper's slab, lossy, 45°", "thick": "two thick layers, one of negative density"}
    for ax, (name, ds) in zip(axes, data.items(), strict=True):
        for order, rate, marker in zip(ds.order.values, rates(ds), "os^D", strict=True):
            h, error = (ds[name].sel(order=order) for name in ("h", "error"))
            line = ax.loglog(h, error, marker=marker, ms=4, label=f"order {order}: rate {rate:.2f}")[0]
            guide = error[-1] * (h / h[-1]) ** (order + 1)
            ax.loglog(h, guide, ":", lw=0.8, color=line.get_color())
        ax.set(title=titles[name], xlabel="element width / wavelength", xticks=(0.03, 0.05, 0.1, 0.2, 0.5))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_formatter("")
        ax.grid(alpha=0.3, which="both", lw=0.4)
        ax.legend(fontsize="small", title="dotted: order + 1", title_fontsize="small")
    axes[0].set_ylabel("relative L2 error")
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Measured rates beside order + 1."""
    rows = []
    for name, ds in data.items():
        measured = rates(ds)
        text = ", ".join(f"{rate:.2f}" for rate in measured)
        holds = bool(np.all(np.abs(measured - ds.order.values - 1) < 0.3))
        rows.append(Statement(f"FEM, {name}", "rates 2, 3, 4, 5 for orders 1 to 4, within 0.3", text, holds))
    return rows


if __name__ == "__main__":
    run("fem_convergence", __doc__, compute, plot, statements)
