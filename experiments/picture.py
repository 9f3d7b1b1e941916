"""The picture at the head of the README: one oblique beam in air and through the paper's lossless slab.

The README's first lines make the same picture; `tests/test_docs.py` holds the two to each other, pixel by pixel.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, FWHM, LOSSLESS, run, slab

import beamprop as bp


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """|p| at 45 degrees, with and without the slab."""
    n = 151 if quick else 451
    exact = slab(450, LOSSLESS)
    x = np.linspace(-0.45, 0.75, n)
    # on the cells' faces: inside a cell the pressure ripples by about its own mean
    z = bp.faces(exact, 142 if quick else 568, before=0.1, after=0.17)
    beam = bp.GaussianBeam(FWHM, angle=45, z0=-0.1)
    return {
        "air": bp.field(bp.Slab.uniform(bp.AIR, exact.thickness), beam, DESIGN, x, z),
        "slab": bp.field(exact, beam, DESIGN, x, z),
    }


def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Two maps on one scale."""
    fig, axes = plt.subplots(1, 2, figsize=(8.6, 3.6), layout="compressed")
    for ax, (name, title) in zip(axes, {"air": "air", "slab": "4500 layers"}.items(), strict=True):
        bp.plot.field(data[name], ax=ax, colorbar=name == "slab", limit=0.9).set_title(f"{title}, 45°, 2500 Hz")
        ax.label_outer()
    return fig


if __name__ == "__main__":
    run("beam", __doc__, compute, plot, lambda data: [])
