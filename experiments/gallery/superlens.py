"""
A super-lens, and the resolution that its loss leaves
=====================================================

A lens of density and bulk modulus -1 times those of air, a tenth of a wavelength thick, carries evanescent waves to its image up to
kx/k0 = 8.46 at a loss of 0.01, and only to 4.81 at 0.1: there the transfer is half, and Pendry's limit says 8.49 and 4.87.
Two slits a sixth of a wavelength apart, half a thickness in front, are imaged half a thickness behind: 1 % of their pressure lies
between them at a loss of 0.001, but 36 % at 0.1, and without the lens they are one peak.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY, WAVELENGTH = 1000.0, 0.343
THICKNESS, APART = WAVELENGTH / 10, WAVELENGTH / 6
LOSSES = (0.1, 0.01, 0.001)


def lens_of(loss):
    """A slab of density -1 + i loss and bulk modulus -1 - i loss, relative to air's."""
    fluid = bp.Fluid(1.25 * (-1 + 1j * loss), bp.AIR.bulk_modulus * (-1 - 1j * loss))
    return bp.Slab.uniform(fluid, THICKNESS)


def transfer(slab, ratio):
    """|p| in the image over that in the source: t, and a thickness of air in all before and behind."""
    kz = 2 * np.pi / WAVELENGTH * np.sqrt(1 - ratio.astype(complex) ** 2)
    return abs(bp.scattering(slab, FREQUENCY, kx_over_k0=ratio).t * np.exp(1j * kz * THICKNESS))


def pendry(loss):
    """kx/k0 where the lens's growth, 2/loss at most, is used up: kappa d = log(2/loss), kappa^2 = kx^2 - k0^2."""
    return np.hypot(1, np.log(2 / loss) * WAVELENGTH / (2 * np.pi * THICKNESS))


def image(slab, x):
    """|p| half a thickness behind a slab, of two slits half a thickness in front."""
    slits = bp.Slits(APART / 10, APART, z0=-THICKNESS / 2)
    return abs(bp.field(slab, slits, FREQUENCY, x, 1.5 * THICKNESS, rtol=1e-4).p)


def study(quick=False):
    """Transfer by kx and images of two slits, for three losses and for air."""
    ratio, x = np.linspace(0, 16, 3201), np.linspace(-0.07, 0.07, 281)
    slabs = {f"loss {loss:g}": lens_of(loss) for loss in LOSSES}
    transfers = xr.Dataset({name: transfer(slab, ratio) for name, slab in slabs.items()})
    images = xr.Dataset({n: image(s, x) for n, s in {"no lens": bp.Slab.uniform(bp.AIR, THICKNESS), **slabs}.items()})
    result = {"sign": -1, "loss_low": 0.001, "loss": 0.01, "loss_high": 0.1}
    for loss in LOSSES:
        carried = transfers[f"loss {loss:g}"]
        result[f"limit_{loss:g}"] = float(carried.kx_over_k0.where(carried > 0.5).max())
        result[f"pendry_{loss:g}"] = pendry(loss)
    for name, p in images.items():
        result[f"between_{name.split()[-1]}_percent"] = 100 * float(p.sel(x=0, method="nearest") / p.max())
    return result | {"transfers": transfers, "images": images}


def picture(result, width=PAGE):
    """Transfer of plane waves with Pendry's limits, and images of two slits."""
    figure, (left, right) = panels(2, width)
    for name, carried in result["transfers"].items():
        left.plot(carried.kx_over_k0, carried, label=name)
    limits = [result[f"pendry_{loss:g}"] for loss in LOSSES]
    left.plot(limits, [0.5] * 3, "o", color="k", mfc="none", ms=4, label="Pendry")
    left.set(xlabel="$k_x/k_0$", ylabel="|p| in the image over the source", ylim=(0, 1.5))
    left.legend(loc="upper right", ncols=2)
    for name, p in result["images"].items():
        right.plot(100 * p.x, p / p.max(), label=name, ls="-" if name.startswith("loss") else "--")
    right.set(xlabel="x [cm]", ylabel="|p| in the image over its peak", ylim=(0, 1.5))
    right.legend(loc="upper center", ncols=2)
    return figure


if __name__ == "__main__":
    main(study, picture)
