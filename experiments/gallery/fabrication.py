"""
Fabrication tolerance: densities to a percent
=============================================

Errors of 1 % in the density of each layer, each its own, shift the phase behind 100 periods by 0.09 rad (rms over 40 copies) and
the width of a 9.6 cm beam by 0.3 cm, from 9.7 cm.
Densities are up to 60 times that of air and their mean is 0.05 times it: such errors of 1000 layers are one of 0.013 in the mean,
a quarter of it, which the effective medium turns into 0.10 rad, k0 L d(sqrt rho).
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY, PERIODS, COPIES, BEAM = 2500.0, 100, 40, bp.GaussianBeam(0.096)
#: Relative standard deviations of the layers' densities.
DEVIATIONS = (0.003, 0.01, 0.03)


def copies(slab, deviation):
    """Phase at normal incidence [rad], less the perfect slab's, and width [m] behind random copies."""
    perfect = bp.scattering(slab, FREQUENCY, angle=0).t
    phases, widths = [], []
    for copy in bp.tolerance(slab, density=deviation, count=COPIES):
        phases.append(np.angle(bp.scattering(copy, FREQUENCY, angle=0, estimate=False).t / perfect))
        widths.append(bp.beam_width(copy, BEAM, FREQUENCY, rtol=1e-5).fwhm_out)
    return xr.Dataset({"phase": ("copy", np.array(phases)), "width": ("copy", np.array(widths))})


def phase_of_mean(slab, deviation):
    """rms of k0 L d(sqrt rho_eff) when each layer's density has an error of its own; and the rms of the mean density."""
    density = np.array([layer.fluid.density for layer in slab.cell.layers]) / 1.25
    effective = complex(bp.lmmd_emt(slab.cell).at(FREQUENCY).rho_z) / 1.25
    error = deviation * np.sqrt(np.mean(abs(density) ** 2) / (PERIODS * len(density)))
    return 2 * np.pi * FREQUENCY / 343 * slab.thickness * error * (0.5 / np.sqrt(effective)).real, error


def study(quick=False):
    """Spread of phase and width over random copies, by the standard deviation of the layers' densities."""
    slab = bp.Slab(bp.lmmd_cell(), PERIODS)
    samples = {100 * d: copies(slab, d) for d in ((0.01,) if quick else DEVIATIONS)}
    percent = samples[1.0]
    phase, error = phase_of_mean(slab, 0.01)
    layer = slab.cell.layers[0]
    return {
        "deviation_percent": 1,
        "periods": PERIODS,
        "phase_rad": float(np.sqrt((percent.phase**2).mean())),
        "copies": percent.sizes["copy"],
        "fwhm_cm": 9.6,
        "width_spread_cm": 100 * float(percent.width.std()),
        "perfect_width_cm": 100 * float(bp.beam_width(slab, BEAM, FREQUENCY).fwhm_out),
        "largest_density": layer.fluid.density.real / 1.25,
        "mean_density": np.mean([each.fluid.density.real for each in slab.cell.layers]) / 1.25,
        "layers": PERIODS * len(slab.cell.layers),
        "mean_error": error,
        "effective_phase_rad": phase,
        "samples": xr.concat(samples.values(), xr.DataArray(list(samples), dims="deviation", name="deviation")),
    }


def picture(result, width=PAGE):
    """Phases and widths of the copies, by the standard deviation of the densities."""
    figure, (left, right) = panels(2, width)
    ds, percent = result["samples"], np.linspace(0, 3.3, 12)
    predicted = percent * result["effective_phase_rad"]
    left.fill_between(percent, -predicted, predicted, color="0.85", lw=0, label="rms by the effective medium")
    for ax, values in ((left, ds.phase), (right, 100 * ds.width)):
        for deviation, row in values.groupby("deviation"):
            ax.plot(np.full(row.size, deviation), row.values.ravel(), "_", color="#004488", ms=6, mew=0.6)
        ax.set(xlabel="standard deviation of densities [%]", xlim=(0, 3.3))
    left.set(ylabel="change of phase [rad]")
    left.legend(loc="upper left")
    right.axhline(result["perfect_width_cm"], color="k", ls="--", label="no errors")
    right.set(ylabel="width behind the slab [cm]")
    right.legend(loc="upper left")
    return figure


if __name__ == "__main__":
    main(study, picture)
