"""Figure 6: width of the beam behind the slab against frequency, lossy and lossless, and after two wavelengths of air."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import FWHM, LOSSES, LOSSLESS, PAGE, Statement, in_style, run, slab

import beamprop as bp


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """Widths of both media, launched at the near face; the structure is that for 2.5 kHz throughout."""
    frequency = np.linspace(2000, 3000, 21 if quick else 101)
    beam = bp.GaussianBeam(FWHM)
    data = {
        name: bp.beam_width(slab(450, loss), beam, frequency)
        for name, loss in (("lossy", LOSSES["a"]), ("lossless", LOSSLESS))
    }
    data["fem"] = by_fem(slab(450), beam, (2500.0,) if quick else (2000.0, 2500.0, 3000.0))
    return data


def by_fem(structure: bp.Slab, beam: bp.GaussianBeam, frequencies: tuple[float, ...]) -> xr.Dataset:
    """Widths behind the lossy slab by finite elements in a window of 16.3 wavelengths, and by plane waves at that period."""
    rows = []
    for f in frequencies:
        period = 16.3 * 343 / f
        x = np.linspace(-0.3, 0.3, 601)
        z = np.array([structure.thickness])
        fem = bp.fem.field(structure, beam, f, x, z, period)
        ours = bp.field(structure, beam, f, x, z, boundary="periodic", period=period)
        rows.append([float(bp.fwhm(ds.p.isel(z=0))) for ds in (fem, ours)])
    ds = xr.Dataset(
        {name: ("frequency", np.array(rows)[:, i]) for i, name in enumerate(("fwhm_fem", "fwhm_plane_waves"))},
        {"frequency": ("frequency", list(frequencies), {"units": "Hz", "long_name": "frequency"})},
    )
    for name in ds.data_vars:
        ds[name].attrs = {"units": "m", "long_name": f"width behind the slab, {name[5:].replace('_', ' ')}, periodic"}
    return ds


@in_style
def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Incident and air once, both media, finite elements as markers."""
    fig, ax = plt.subplots(figsize=(PAGE, 4.0), layout="constrained")
    bp.plot.width(data["lossy"], ax=ax)
    ax.lines[1].set_label("behind the lossy slab")
    ds = data["lossless"]
    ax.plot(ds.frequency, ds.fwhm_out * 100, "C1-.", label="behind the lossless slab")
    ax.plot(data["fem"].frequency, data["fem"].fwhm_fem * 100, "C2+", ms=9, label="lossy slab, finite elements")
    ax.get_legend().remove()
    fig.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Kept in the slab from 2 to 3 kHz, about 40 cm in air."""
    rows = []
    for name, limit in (("lossy", 0.1), ("lossless", 0.2)):
        ds = data[name]
        ratio = (ds.fwhm_out / ds.fwhm_in).values
        rows.append(
            Statement(
                "6",
                f"widths behind the {name} slab almost unchanged from 2 to 3 kHz",
                f"{100 * float(ds.fwhm_out.min()):.2f} to {100 * float(ds.fwhm_out.max()):.2f} cm for "
                f"{100 * float(ds.fwhm_in[0]):.2f} cm launched ({100 * (ratio.min() - 1):+.1f} to {100 * (ratio.max() - 1):+.1f} %)",
                bool(np.all(np.abs(ratio - 1) < limit)),
            )
        )
    air = data["lossy"].fwhm_air
    at40 = np.interp(0.4, air.values[::-1], air.frequency.values[::-1])
    rows.append(
        Statement(
            "6",
            "air reaches 40 cm after only two wavelengths",
            f"{100 * float(air[0]):.1f} cm at 2 kHz, {100 * float(air[-1]):.1f} cm at 3 kHz; 40 cm below {at40:.0f} Hz only",
            bool(air.max() >= 0.4),
        )
    )
    fem = data["fem"]
    apart = float(np.abs(fem.fwhm_fem / fem.fwhm_plane_waves - 1).max())
    exact = data["lossy"].fwhm_out.interp(frequency=fem.frequency)
    wrap = float(np.abs(fem.fwhm_plane_waves / exact - 1).max())
    rows.append(
        Statement(
            "6",
            "plane waves against FEM: widths behind the lossy slab",
            f"at the same period apart by {apart:.1e}; the period itself (16.3 wavelengths) changes them by {wrap:.1e}",
            apart < 1e-3,
        )
    )
    return rows


if __name__ == "__main__":
    run("fig6", __doc__, compute, plot, statements)
