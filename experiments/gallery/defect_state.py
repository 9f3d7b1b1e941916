"""
A band gap of acrylic and water, and a defect state in it
=========================================================

Quarter-wave layers of acrylic and water at 1 MHz have a gap 0.472 MHz wide, as the closed form of their impedances says: 0.472 MHz.
Two such layers of water between 4 periods and their mirror image let 100 % through at 1 MHz, in the middle of the gap, with a
quality factor of 640; 7 pairs of periods make it 4.57 times as sharp as 6 do, and the square of the ratio of impedances is 4.57.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels
from scipy.optimize import brentq

import beamprop as bp

CENTRE = 1e6
WATER, ACRYLIC = bp.material("water"), bp.material("acrylic")
Z1, Z2 = (float(np.sqrt(m.at(CENTRE).rho_z * m.at(CENTRE).bulk_modulus).real) for m in (ACRYLIC, WATER))
QUARTERS = [bp.Layer(m, np.pi / 2 / float(m.wavenumber(CENTRE).real)) for m in (ACRYLIC, WATER)]


def cavity(periods):
    """Acrylic and water, and their mirror image: two water layers meet in the middle."""
    return bp.Slab(bp.Cell(QUARTERS), periods, WATER, WATER) + bp.Slab(bp.Cell(QUARTERS[::-1]), periods, WATER, WATER)


def transmission(periods, frequency):
    """Transmitted share of the power at normal incidence."""
    return bp.scattering(cavity(periods), frequency, angle=0).energy_transmission


def quality(periods):
    """Centre frequency over the width at half the power."""
    half = brentq(lambda offset: float(transmission(periods, CENTRE + offset)) - 0.5, 0, 0.1 * CENTRE)
    return CENTRE / (2 * half)


def study(quick=False):
    """The gap of the infinite stack, the transmission of three cavities, and their quality factors."""
    frequency = CENTRE + np.arange(-0.3e6, 0.3001e6, 3e3 if quick else 5e2)
    edges = np.linspace(0.7e6, 1.3e6, 1201)
    decay = bp.bloch(bp.Cell(QUARTERS), edges, kx=[0.0], background=WATER).kz.imag.squeeze()
    gap = decay.frequency[decay > 1e-9 * decay.max()]
    periods = np.arange(2, 8)
    sharp = np.array([quality(n) for n in periods])
    return {
        "centre_mhz": CENTRE / 1e6,
        "gap_mhz": float(gap.max() - gap.min()) / 1e6,
        "closed_form_gap_mhz": 4 / np.pi * np.arcsin(abs(Z1 - Z2) / (Z1 + Z2)) * CENTRE / 1e6,
        "periods": 4,
        "peak_percent": 100 * float(transmission(4, CENTRE)),
        "quality": sharp[2],
        "most_pairs": int(periods[-1]),
        "sharpening": sharp[-1] / sharp[-2],
        "pairs_before": int(periods[-2]),
        "impedance_ratio_squared": (Z1 / Z2) ** 2,
        **{f"cavity_{n}": transmission(n, frequency).to_dataset() for n in (2, 4, 6)},
        "sharpness": xr.Dataset({"quality": ("periods", sharp)}, {"periods": periods}),
    }


def picture(result, width=PAGE):
    """Transmission by frequency; quality factors by the number of periods."""
    figure, (left, right) = panels(2, width)
    for periods in (2, 4, 6):
        share = result[f"cavity_{periods}"].energy_transmission
        left.plot(share.frequency / 1e6, share, label=f"{periods} periods", zorder=8 - periods)
    left.axvspan(*(CENTRE / 1e6 + np.array([-0.5, 0.5]) * result["closed_form_gap_mhz"]), color="0.88", lw=0, zorder=0)
    left.set(xlabel="frequency [MHz] (grey: gap)", ylabel="transmitted share of power", yscale="log", ylim=(1e-7, 20))
    left.legend(loc="upper center", ncols=3)
    sharp = result["sharpness"]
    right.plot(sharp.periods, sharp.quality, "o", label="half power")
    limit = sharp.quality[-1] * (Z1 / Z2) ** (2.0 * (sharp.periods - sharp.periods[-1]))
    right.plot(sharp.periods, limit, "--", label="$(Z_1/Z_2)^2$ a pair")
    right.set(xlabel="periods on each side", ylabel="quality factor", yscale="log", xticks=sharp.periods)
    right.legend(loc="upper left")
    return figure


if __name__ == "__main__":
    main(study, picture)
