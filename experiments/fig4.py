"""Figure 4: equifrequency contours for four eta (a) and for three numbers of layers in the cell (b)."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, LOSSES, PAGE, Statement, in_style, run

import beamprop as bp

ETAS = (100, 60, 40, 20)
LAYERS = (14, 10, 6)


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """Contours along 1/eta, and along N."""
    ratio = np.linspace(-10, 10, 81 if quick else 801)

    def contour(**cell: float) -> xr.Dataset:
        return bp.bloch(bp.lmmd_cell(*LOSSES["a"], **cell), DESIGN, kx_over_k0=ratio)

    a = xr.concat([contour(eta=1 / n) for n in ETAS], xr.Variable("inverse_eta", list(ETAS)), combine_attrs="override")
    b = xr.concat(
        [contour(n_layers=n) for n in LAYERS], xr.Variable("n_layers", list(LAYERS)), combine_attrs="override"
    )
    return {"a": a, "b": b}


@in_style
def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Both signs of kz, as in the paper; thin dotted lines are the decay."""
    fig, axes = plt.subplots(1, 2, figsize=(PAGE, 3.2), layout="constrained")
    names = {"a": ("inverse_eta", "η = 1/{}"), "b": ("n_layers", "N = {}")}
    for (panel, ds), ax in zip(data.items(), axes, strict=True):
        dim, text = names[panel]
        for value in ds[dim].values:
            bp.plot.bloch(ds.sel({dim: value}), ax=ax, label=text.format(value), mirror=True)
        ax.set_title(f"({panel})", loc="left")
    return fig


def departure(kz: xr.DataArray, upto: float) -> float:
    """Largest |Re kz(kx) / Re kz(0) - 1| for |kx| <= upto k0."""
    middle = kz.real.sel(kx_over_k0=0.0, method="nearest")
    part = kz.real.where(np.abs(kz.kx_over_k0) <= upto + 1e-9)
    return float(np.abs(part / middle - 1).max())


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Flatter for smaller eta and larger N."""
    a, b = data["a"].kz_over_k0, data["b"].kz_over_k0
    by_eta = [departure(a.sel(inverse_eta=n), 10) for n in ETAS]
    by_layers = [departure(b.sel(n_layers=n), 10) for n in LAYERS]
    at5 = [departure(a.sel(inverse_eta=n), 5) for n in (20, 100)]

    def show(names: tuple[int, ...], values: list[float]) -> str:
        return ", ".join(f"{n}: {100 * v:.1f} %" for n, v in zip(names, values, strict=True))

    return [
        Statement(
            "4(a)",
            "contours are flatter for smaller η; at 1/100 almost constant",
            f"largest departure of Re kz up to 10 k0, by 1/η: {show(ETAS, by_eta)}",
            bool(np.all(np.diff(by_eta) > 0) and by_eta[0] < 0.02),
        ),
        Statement(
            "4(a)",
            "η = 1/20 leaves the constant value beyond about 5 k0",
            f"at 5 k0 {100 * at5[0]:.1f} %, at 10 k0 {100 * by_eta[-1]:.1f} % (1/100: {100 * at5[1]:.1f} %, "
            f"{100 * by_eta[0]:.1f} %)",
            at5[0] < 0.1 and by_eta[-1] > 0.2,
        ),
        Statement(
            "4(b)",
            "contours are flatter for larger N",
            f"largest departure of Re kz up to 10 k0, by N: {show(LAYERS, by_layers)}",
            bool(np.all(np.diff(by_layers) > 0)),
        ),
    ]


if __name__ == "__main__":
    run("fig4", __doc__, compute, plot, statements)
