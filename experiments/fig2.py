"""Figure 2: transmissivity of slabs of 20, 40, 80 and 100 periods for propagating waves; exact and by three effective media."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, PAGE, Statement, in_style, run, slab, three_media

import beamprop as bp

PERIODS = {"a": 20, "b": 40, "c": 80, "d": 100}


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """One dataset per panel, with the medium as a dimension."""
    ratio = np.linspace(0, 0.999, 101 if quick else 1000)
    return {panel: by_medium(slab(periods), ratio) for panel, periods in PERIODS.items()}


def by_medium(exact: bp.Slab, ratio: np.ndarray) -> xr.Dataset:
    """Scattering of the exact slab and its effective media on one axis."""
    media = three_media(exact)
    parts = [bp.scattering(s, DESIGN, kx_over_k0=ratio) for s in media.values()]
    return xr.concat(parts, xr.Variable("medium", list(media)), combine_attrs="override", join="exact")


def deviation(ds: xr.Dataset, medium: str) -> float:
    """rms of T_medium/T_exact - 1."""
    T = ds.transmissivity
    return float(np.sqrt(((T.sel(medium=medium) / T.sel(medium="TMM") - 1) ** 2).mean()))


@in_style
def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Four panels, four curves each."""
    fig, axes = plt.subplots(2, 2, figsize=(PAGE, 4.8), layout="constrained")
    for (panel, ds), ax in zip(data.items(), axes.flat, strict=True):
        draw_media(ds, ax)
        ax.set(ylim=(0, None), xlim=(0, 1))
        ax.set_title(f"({panel}) {PERIODS[panel]} periods", loc="left")
    below(fig, axes.flat[0])
    return fig


def below(fig: plt.Figure, ax: plt.Axes) -> None:
    """One legend for all panels, below them."""
    fig.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=4)


def draw_media(ds: xr.Dataset, ax: plt.Axes, log: bool = False) -> None:
    """TMM solid, effective media in the paper's line styles."""
    for medium, style in zip(ds.medium.values, ("-", "--", ":", "-."), strict=True):
        bp.plot.scattering(ds.sel(medium=medium), ax=ax, log=log, label=medium)
        ax.lines[-1].set_linestyle(style)
    ax.get_legend().remove()
    ax.set_ylabel("T")


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """LMMD EMT matches, the standard one does not."""
    rows = []
    for panel, ds in data.items():
        bare, full, std = (deviation(ds, m) for m in ("LMMD EMT", "LMMD EMT + interface", "standard EMT"))
        rows.append(
            Statement(
                f"2({panel})",
                f"{PERIODS[panel]} periods: LMMD EMT matches the exact result, standard EMT does not",
                f"rms of T/T_exact - 1: LMMD {bare:.3f}, with the interface term {full:.3f}, standard {std:.2f}",
                bare < 0.15 and std > 2 * bare,
            )
        )
    return rows


if __name__ == "__main__":
    run("fig2", __doc__, compute, plot, statements)
