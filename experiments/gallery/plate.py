"""
A plate that lets a plane wave through, and not a beam
======================================================

Through a plate of steel of 1 mm at 3 MHz a plane wave passes at 13.91 degrees, where it runs along with a Lamb wave, with 99.999 percent of its
pressure; of a beam of 8 mm half-width 29.9 percent of the power passes, with a peak of 0.383, and 70.1 percent is reflected.
The Lamb wave leaks so little that it must gather over a wide beam, of which at 128 mm 94 percent pass.
"""

import warnings

import numpy as np
import xarray as xr
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY, ANGLE = 3e6, 13.91
WATER, STEEL = bp.Fluid.from_speed(1000.0, 1480.0), bp.Solid(7900.0, 5900.0, 3200.0)
PLATE = bp.Slab(bp.Layer(STEEL, 1e-3), background=WATER)


def beam_of(half_width):
    """Of the half-width at 1/e [m] along the plate."""
    return bp.GaussianBeam(2 * np.sqrt(np.log(2)) * half_width, angle=ANGLE)


def powers(half_width):
    """Reflected and transmitted share of a beam's power."""
    window = 4 * half_width + 0.1
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # the reflected beam has several strips; its width is not used
        return bp.beam_measures(PLATE, beam_of(half_width), FREQUENCY, window=window).power.values


def study(quick=False):
    """Plane waves by angle, and the power that passes by the beam's width."""
    angle = np.linspace(0, 40, 401 if quick else 2001)
    widths = 8e-3 * 2.0 ** np.arange(-1, 5, 1 if quick else 0.5)
    reflected, transmitted = np.transpose([powers(a) for a in widths])
    narrow = int(np.argmin(abs(widths - 8e-3)))
    return {
        "mm": 1e3 * PLATE.thickness,
        "mhz": FREQUENCY / 1e6,
        "angle": ANGLE,
        "t_percent": 100 * abs(complex(bp.scattering(PLATE, FREQUENCY, angle=ANGLE).t)),
        "half_width_mm": 1e3 * widths[narrow],
        "power_percent": 100 * transmitted[narrow],
        "peak": float(bp.beam_width(PLATE, beam_of(8e-3), FREQUENCY).peak_out),
        "reflected_percent": 100 * reflected[narrow],
        "wide_mm": 1e3 * widths[-1],
        "wide_percent": 100 * transmitted[-1],
        "waves": bp.scattering(PLATE, FREQUENCY, angle=angle),
        "shares": xr.Dataset({"transmitted": ("half_width", transmitted)}, {"half_width": widths}),
    }


def picture(result, width=PAGE):
    """Power that passes by angle, and by the beam's half-width."""
    figure, (left, right) = panels(2, width)
    left.plot(result["waves"].angle, result["waves"].transmissivity)
    left.axvline(result["angle"], ls=":")
    left.set(xlabel="angle [degree]", ylabel="$|t|^2$", xlim=(0, 40), ylim=(0, 1.05))
    shares = result["shares"]
    right.semilogx(1e3 * shares.half_width, shares.transmitted, "o-", base=2)
    right.axhline((result["t_percent"] / 100) ** 2, ls=":", label="plane wave")
    right.set(xlabel="half-width of the beam [mm]", ylabel="power that passes", ylim=(0, 1.05))
    right.set_xticks([4, 8, 16, 32, 64, 128], labels=["4", "8", "16", "32", "64", "128"])
    right.legend()
    return figure


if __name__ == "__main__":
    main(study, picture)
