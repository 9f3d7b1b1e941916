"""
Two slits a tenth of a wavelength apart, imaged
===============================================

Behind 41 lossless periods two slits 13.7 mm apart, a tenth of the wavelength at 2500 Hz, are two peaks with 2 % of their pressure
between them; behind 20 periods 90 % is left there, and 94 mm of air, as much, makes one peak of them, 224 mm wide.
The slab has to be whole half-waves thick: kz hardly depends on kx, so that kz L = pi, at 41.1 periods by the effective medium,
passes all plane waves alike, evanescent ones too, and with the paper's loss still leaves 21 % between the peaks.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels
from scipy.special import hankel1

import beamprop as bp

FREQUENCY = 2500.0
WAVELENGTH = 343 / FREQUENCY
X = np.linspace(-0.12, 0.12, 1921)
APART = WAVELENGTH / 10


def image(medium, x=X):
    """p behind a medium, of two slits in phase."""
    return bp.field(medium, bp.Slits(APART / 4, APART), FREQUENCY, x, medium.thickness, rtol=1e-4).p


def between(p):
    """|p| in the middle over the largest; 1 where the slits are one peak."""
    return float(abs(p.sel(x=0, method="nearest")) / abs(p).max())


def rayleigh_sommerfeld(distance):
    """p of the slits across air: the integral of i k/2 (z/r) H1(k r) over both, by the midpoint rule."""
    k, points = 2 * np.pi / WAVELENGTH, 200
    inside = APART / 4 * ((np.arange(points) + 0.5) / points - 0.5)
    source = np.concatenate([inside - APART / 2, inside + APART / 2])
    r = np.hypot(X[:, None] - source, distance)
    return (0.5j * k * distance / r * hankel1(1, k * r)).sum(axis=1) * APART / 4 / points


def study(quick=False):
    """The pressure between the slits by the number of periods, without and with loss; four images."""
    lossless, lossy = bp.lmmd_cell(lossless=True), bp.lmmd_cell()
    air = bp.Slab.uniform(bp.AIR, 41 * lossless.thickness)
    rho = complex(bp.lmmd_emt(lossless).at(FREQUENCY).rho_z).real / 1.25
    media = {
        "air": air,
        "20 periods": bp.Slab(lossless, 20),
        "41 periods": bp.Slab(lossless, 41),
        "41 lossy periods": bp.Slab(lossy, 41),
    }
    images = xr.Dataset({name: image(medium).drop_vars("z") for name, medium in media.items()})
    periods = np.arange(5, 86, 18 if quick else 4)
    gaps = {
        loss: [between(image(bp.Slab(cell, n), X[::4])) for n in periods]
        for loss, cell in (("no", lossless), ("yes", lossy))
    }
    closed_form = rayleigh_sommerfeld(air.thickness)
    return {
        "periods": 41,
        "separation_mm": 1e3 * APART,
        "frequency_hz": FREQUENCY,
        "between_41_percent": 100 * between(images["41 periods"]),
        "shorter_periods": 20,
        "between_20_percent": 100 * between(images["20 periods"]),
        "air_mm": 1e3 * air.thickness,
        "air_width_mm": 1e3 * float(bp.fwhm(images.air)),
        "half_wave_periods": WAVELENGTH / 2 / np.sqrt(rho) / lossless.thickness,
        "between_lossy_percent": 100 * between(images["41 lossy periods"]),
        "air_over_closed_form": float(abs(images.air - closed_form).max() / abs(closed_form).max()),
        "between_air_percent": 100 * between(images.air),
        "images": images,
        "gaps": xr.Dataset({loss: ("periods", gap) for loss, gap in gaps.items()}, {"periods": periods}),
    }


def picture(result, width=PAGE):
    """Images over their peaks; the pressure between the slits by the number of periods."""
    figure, (left, right) = panels(2, width)
    for name, p in result["images"].items():
        left.plot(1e3 * p.x, abs(p) / abs(p).max(), label=name)
    left.set(xlabel="x [mm]", ylabel="|p| over its peak", xlim=(-40, 40), ylim=(0, 1.35))
    left.legend(loc="upper center", ncols=2)
    gaps = result["gaps"]
    right.plot(gaps.periods, 100 * gaps.no, label="lossless")
    right.plot(gaps.periods, 100 * gaps.yes, label="lossy")
    for order in (1, 2):
        right.axvline(order * result["half_wave_periods"], color="0.6", lw=0.6, zorder=0)
    right.set(xlabel="periods (grey: whole half-waves)", ylabel="pressure between the slits [%]", ylim=(0, 102))
    right.legend(loc=(0.53, 0.04))
    return figure


if __name__ == "__main__":
    main(study, picture)
