"""
Four layers a cell, and every multiple of four, break the guide
===============================================================

Cells of 4, 8, 12, 16 or 20 layers widen a 9.6 cm beam to 71 cm or more behind 450 periods; with any other number from 5 to 19 it
comes out between 9.6 and 12.5 cm wide, with at least 4.9 times the pressure.
Where the number is a multiple of four, two layers of the cell have a cosine of zero and the small mean density 0.05 alone, so that
the mean inverse density, which lets waves run sideways, is 3.33 at 12 layers, where it is -0.00007 at 10.
"""

import numpy as np
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY, MEAN, LAUNCHED = 2500.0, 0.05, 0.096


def behind(n_layers):
    """Width and peak behind 450 periods of the lossy cell of this number of layers."""
    slab = bp.Slab(bp.lmmd_cell(n_layers=n_layers), periods=450)
    return bp.beam_width(slab, bp.GaussianBeam(LAUNCHED), FREQUENCY)[["fwhm_out", "peak_out"]]


def mean_inverse_density(n_layers):
    """<1/rho> over the lossless cell, relative to the background's."""
    cell = bp.lmmd_cell(MEAN, 0, n_layers=n_layers)
    return 1.25 * np.mean([1 / layer.fluid.density for layer in cell.layers])


def study(quick=False):
    """Beams behind cells of 4 to 20 layers, and the contours of four of them."""
    widths = bp.sweep(behind, {"n_layers": np.arange(4, 21)}, workers=1, progress=False)
    multiple = widths.where(widths.n_layers % 4 == 0, drop=True)
    rest = widths.where(widths.n_layers % 4 > 0, drop=True)
    kx = np.linspace(0, 3, 61 if quick else 601)
    contours = {f"contour_{n}": bp.bloch(bp.lmmd_cell(n_layers=n), FREQUENCY, kx_over_k0=kx) for n in (8, 10, 12, 14)}
    return {
        **{f"multiple_{i}": n for i, n in enumerate(multiple.n_layers.values)},
        "fwhm_cm": 100 * LAUNCHED,
        "least_multiple_width_cm": 100 * float(multiple.fwhm_out.min()),
        "periods": 450,
        "first": rest.n_layers.values[0],
        "last": rest.n_layers.values[-1],
        "least_width_cm": 100 * float(rest.fwhm_out.min()),
        "largest_width_cm": 100 * float(rest.fwhm_out.max()),
        "pressure_ratio": float(rest.peak_out.min() / multiple.peak_out.max()),
        "mean_density": MEAN,
        "inverse_density_12": mean_inverse_density(12).real,
        "spreading": 12,
        "inverse_density_10": mean_inverse_density(10).real,
        "guiding": 10,
        "closed_form_12": 2 / (12 * MEAN),
        "widths": widths,
        **contours,
    }


def picture(result, width=PAGE):
    """Widths by number of layers; equifrequency contours of four cells."""
    figure, (left, right) = panels(2, width)
    widths = result["widths"]
    left.bar(widths.n_layers, 100 * widths.fwhm_out, color=np.where(widths.n_layers % 4, "#004488", "#BB5566"))
    left.axhline(100 * LAUNCHED, color="k", ls="--", label="launched")
    left.set(xlabel="layers in a cell", ylabel="width behind the slab [cm]", xticks=widths.n_layers[::2])
    left.legend(loc="upper right")
    for n in (8, 10, 12, 14):
        ds = result[f"contour_{n}"]
        right.plot(ds.kx_over_k0, abs(ds.kz_over_k0.real), label=f"{n} layers", ls="--" if n % 4 else "-")
    right.set(xlabel="$k_x/k_0$", ylabel="$|\\mathrm{Re}\\,k_z|/k_0$")
    right.legend()
    return figure


if __name__ == "__main__":
    main(study, picture)
