"""
Critical angle and Goos-Haenchen shift over a sandy sea bed
===========================================================

Past the critical angle, 64.0 degrees from water to sand at 100 kHz, a beam of 100 wavelengths is reflected 2.27 wavelengths further
along at 69.0 degrees, where Artmann's formula -d(arg r)/dkx says 2.26.
At the critical angle itself the formula is infinite and the beam's shift is not: 4.8 wavelengths, and 3.0 of a beam of 30.
"""

import numpy as np
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY = 1e5
WATER, SAND = bp.material("water"), bp.Fluid.from_speed(1900.0, 1650.0)
WAVELENGTH = 2 * np.pi / float(WATER.wavenumber(FREQUENCY).real)
CRITICAL = np.degrees(np.arcsin(FREQUENCY * WAVELENGTH / 1650.0))


def artmann(angle):
    """-d(arg r)/dkx [wavelengths] of total reflection, r = (m cos - i s)/(m cos + i s), s^2 = sin^2 - n^2."""
    m, n = 1900.0 / WATER.at(FREQUENCY).rho_z.real, np.sin(np.radians(CRITICAL))
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    s = np.sqrt(sine**2 - n**2)
    slope = (sine / (s * m * cosine) + s * sine / (m * cosine**3)) / (1 + (s / (m * cosine)) ** 2)
    return 2 * slope / (2 * np.pi)


def shifts(width, angle):
    """Lateral shift of the reflected beam [wavelengths], `width` wavelengths wide."""
    beam = bp.GaussianBeam(width * WAVELENGTH)
    measured = bp.beam_measures(bp.Slab.interface(WATER, SAND), beam, FREQUENCY, angle=angle)
    return measured.lateral_shift.sel(side="reflected", drop=True) / WAVELENGTH


def study(quick=False):
    """Shifts of two beams about the critical angle, beside Artmann's."""
    beyond = CRITICAL + 5
    near = np.linspace(-1, 1, 7 if quick else 31)  # denser about the critical angle
    angle = np.unique([beyond, *(CRITICAL + 12 * near * abs(near))])
    narrow, wide = shifts(30, angle), shifts(100, angle)
    return {
        "critical_angle": CRITICAL,
        "frequency_khz": FREQUENCY / 1000,
        "wide": 100,
        "wide_beyond": float(wide.sel(angle=beyond, method="nearest")),
        "angle_beyond": beyond,
        "artmann_beyond": artmann(beyond),
        "wide_critical": float(wide.sel(angle=CRITICAL, method="nearest")),
        "narrow_critical": float(narrow.sel(angle=CRITICAL, method="nearest")),
        "narrow": 30,
        "shifts": narrow.to_dataset(name="narrow").assign(wide=wide),
    }


def picture(result, width=PAGE):
    """Shifts by angle, of 30 and 100 wavelengths, and Artmann's."""
    figure, (ax,) = panels(1, width / 2 if width == PAGE else width)
    ds = result["shifts"]
    ax.plot(ds.angle, ds.narrow, label="30 wavelengths")
    ax.plot(ds.angle, ds.wide, label="100 wavelengths")
    angle = np.linspace(CRITICAL + 0.05, 76, 400)
    ax.plot(angle, artmann(angle), "--", label="Artmann")
    ax.axvline(CRITICAL, color="0.6", lw=0.6, zorder=0)
    ax.set(xlabel="angle [degree] (grey: critical)", ylabel="shift [wavelengths]", ylim=(-0.3, 7))
    ax.legend(loc="upper left")
    return figure


if __name__ == "__main__":
    main(study, picture)
