"""Figure 3: log T of 100 periods for propagating and evanescent waves, three losses; exact and by three effective media."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import LOSSES, PAGE, Statement, in_style, run, slab
from fig2 import below, by_medium, draw_media


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """One dataset per loss, with the medium as a dimension; kx/k0 = 1 itself is left out (T = 0)."""
    ratio = np.delete(np.linspace(0, 5, 201 if quick else 2001), 40 if quick else 400)
    return {panel: by_medium(slab(100, loss), ratio) for panel, loss in LOSSES.items()}


def decades(ds: xr.Dataset, medium: str, evanescent: bool) -> float:
    """rms of log10(T_medium/T_exact), over the propagating or the evanescent waves."""
    part = ds.where((ds.kx_over_k0 > 1) == evanescent, drop=True).transmissivity
    return float(np.sqrt((np.log10(part.sel(medium=medium) / part.sel(medium="TMM")) ** 2).mean()))


@in_style
def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Three panels, four curves each, logarithmic."""
    fig, axes = plt.subplots(1, 3, figsize=(PAGE, 2.6), layout="constrained")
    for (panel, ds), ax in zip(data.items(), axes, strict=True):
        draw_media(ds, ax, log=True)
        rho_m, delta = LOSSES[panel]
        ax.set_title(f"({panel}) ρm = {rho_m:g}, δρ = {delta:g}", loc="left")
        low = float(ds.transmissivity.sel(medium=["TMM", "LMMD EMT"]).min())
        ax.set_ylim(max(low / 100, 1e-30), 10 * float(ds.transmissivity.sel(medium="TMM").max()))
    below(fig, axes[0])
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Good for propagating and evanescent waves at every loss; the standard one is not."""
    rows = []
    for panel, ds in data.items():
        lmmd, full, std = (
            [decades(ds, m, e) for e in (False, True)] for m in ("LMMD EMT", "LMMD EMT + interface", "standard EMT")
        )
        rows.append(
            Statement(
                f"3({panel})",
                f"Im ρm = {LOSSES[panel][0].imag:g}: LMMD EMT matches for propagating and evanescent waves, "
                "standard EMT fails",
                f"rms decades of T, propagating / evanescent: LMMD {lmmd[0]:.3f} / {lmmd[1]:.3f}, with the interface term "
                f"{full[0]:.3f} / {full[1]:.3f}, standard {std[0]:.2f} / {std[1]:.2f}",
                max(lmmd) < 0.25 and std[1] > 2 * lmmd[1] and std[0] > lmmd[0],
            )
        )
    return rows


if __name__ == "__main__":
    run("fig3", __doc__, compute, plot, statements)
