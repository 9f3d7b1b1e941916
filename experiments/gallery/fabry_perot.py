"""
Fabry-Perot ripple of the lossless slab
=======================================

At normal incidence 450 lossless periods pass everything at 8 frequencies between 2 and 3 kHz, the whole half-waves kz L = m pi of
the effective medium, whose density grows with frequency squared: 2504.5 Hz by the layers, 2504.8 Hz by that formula for m = 11.
The width of a 9.6 cm beam ripples along, from 7.4 to 12.5 cm; with the paper's loss, which lets 3 % of the power through at 2.5 kHz,
it stays between 9.0 and 9.9 cm.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels
from scipy.signal import find_peaks

import beamprop as bp

BEAM = bp.GaussianBeam(0.096)


def half_waves(cell, length, frequency):
    """kz L / pi of the effective medium: rho_m + S (f/f0)^2, S the sum of 2 |b_n|^2/n^2 over the staircase's harmonics."""
    fluid = bp.lmmd_emt(cell).at(frequency)
    return 2 * frequency * length * np.sqrt((fluid.rho_z / fluid.bulk_modulus).real)


def study(quick=False):
    """Transmission at normal incidence and widths behind the slab, with and without loss, from 2 to 3 kHz."""
    slab, lossy = (bp.Slab(bp.lmmd_cell(lossless=without), periods=450) for without in (True, False))
    frequency = np.linspace(2000, 3000, 2001)
    waves = bp.scattering(slab, frequency, angle=0)
    peaks = frequency[find_peaks(waves.energy_transmission)[0]]
    orders = half_waves(slab.cell, slab.thickness, frequency)
    order = np.arange(np.ceil(orders[0]), np.floor(orders[-1]) + 1)
    predicted = np.interp(order, orders, frequency)
    widths = {name: bp.beam_width(s, BEAM, frequency[::10]) for name, s in (("lossless", slab), ("lossy", lossy))}
    return {
        "periods": 450,
        "maxima": len(peaks),
        "least_khz": 2,
        "largest_khz": 3,
        "peak_hz": peaks[list(order).index(11)],
        "predicted_hz": predicted[list(order).index(11)],
        "order": 11,
        "fwhm_cm": 9.6,
        "least_width_cm": 100 * float(widths["lossless"].fwhm_out.min()),
        "largest_width_cm": 100 * float(widths["lossless"].fwhm_out.max()),
        "lossy_percent": 100 * float(bp.scattering(lossy, 2500.0, angle=0).energy_transmission),
        "design_khz": 2.5,
        "least_lossy_cm": 100 * float(widths["lossy"].fwhm_out.min()),
        "largest_lossy_cm": 100 * float(widths["lossy"].fwhm_out.max()),
        "least_maximum": float(waves.energy_transmission.sel(frequency=peaks).min()),
        "largest_difference_hz": float(abs(peaks - predicted).max()),
        "waves": waves,
        "half_waves": xr.Dataset(coords={"frequency": predicted}),
        **widths,
    }


def picture(result, width=PAGE):
    """Transmission with the half-waves of the effective medium, and widths, by frequency."""
    figure, (left, right) = panels(2, width)
    bp.plot.scattering(result["waves"], "energy_transmission", ax=left, label="450 periods")
    left.plot(result["half_waves"].frequency, np.ones(result["maxima"]), "v", color="#BB5566", label="$k_z L = m\\pi$")
    left.set(ylim=(0.65, 1.12))
    left.legend(loc="upper center", ncols=2)
    for name in ("lossless", "lossy"):
        right.plot(result[name].frequency, 100 * result[name].fwhm_out, label=name)
    right.set(xlabel="frequency [Hz]", ylabel="width behind the slab [cm]", ylim=(7, 14))
    right.legend(loc="upper left", ncols=2)
    return figure


if __name__ == "__main__":
    main(study, picture)
