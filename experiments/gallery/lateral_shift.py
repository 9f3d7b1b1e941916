"""
A beam that leaves where it entered, at any angle
=================================================

Behind 4500 lossless layers, 1.03 m of them, the centroid of a 9.6 cm beam at 2500 Hz lies within 1.3 mm of the axis at every
angle up to 80 degrees, where the straight ray has gone 5.84 m sideways; the width stays between 9.3 and 9.8 cm.
The small shift that is left is that of multiple reflection: a 40 cm beam at 40 degrees is shifted by 1.8 mm, and the stationary
phase of the effective medium's transmission, -d(arg t)/dkx, says 1.8 mm.
"""

import numpy as np
from gallery_main import PAGE, main, panels

import beamprop as bp

FREQUENCY = 2500.0
DEGREES = range(-80, 81, 40)


def stationary_phase(slab, angle):
    """-d(arg t)/dkx [m] of the effective medium, whose t = 1/(cos kz L - i F sin kz L): the paper's Eq. (11)."""
    k0 = 2 * np.pi * FREQUENCY / 343
    rho = complex(bp.lmmd_emt(slab.cell).at(FREQUENCY).rho_z).real / 1.25
    phase = np.sqrt(rho) * k0 * slab.thickness

    def arg_t(kx):
        admittance = np.sqrt(rho) * np.sqrt(1 - (kx / k0) ** 2)
        return -np.angle(np.cos(phase) - 0.5j * (admittance + 1 / admittance) * np.sin(phase))

    kx, step = k0 * np.sin(np.radians(angle)), 1e-5 * k0
    return -(arg_t(kx + step) - arg_t(kx - step)) / (2 * step)


def study(quick=False):
    """Widths and centroids of a 9.6 cm and of a 40 cm beam from -80 to 80 degrees, and the narrow beam itself."""
    slab = bp.Slab(bp.lmmd_cell(lossless=True), periods=450)
    angle = np.linspace(-80, 80, 81)
    narrow, wide = (bp.beam_width(slab, bp.GaussianBeam(fwhm), FREQUENCY, angle) for fwhm in (0.096, 0.4))
    x = np.linspace(-0.4, 0.4, 101 if quick else 401)
    behind = bp.field(slab, bp.GaussianBeam(0.096), FREQUENCY, x, slab.thickness, angle=angle)
    return {
        "layers": sum(len(cell.layers) * periods for cell, periods in slab.segments),
        "thickness_m": slab.thickness,
        "fwhm_cm": 9.6,
        "frequency_hz": FREQUENCY,
        "largest_centroid_mm": 1e3 * float(abs(narrow.centroid_out).max()),
        "largest_angle": angle[-1],
        "straight_ray_m": slab.thickness * np.tan(np.radians(angle[-1])),
        "least_width_cm": 1e2 * float(narrow.fwhm_out.min()),
        "largest_width_cm": 1e2 * float(narrow.fwhm_out.max()),
        "wide_fwhm_cm": 40,
        "wide_angle": 40,
        "wide_centroid_mm": 1e3 * float(wide.centroid_out.sel(angle=40)),
        "stationary_phase_mm": 1e3 * stationary_phase(slab, 40.0),
        "behind": behind,
        "narrow": narrow,
        "wide": wide,
    }


def picture(result, width=PAGE):
    """The beam behind the slab by angle, with the straight ray; centroids of both beams."""
    figure, (left, right) = panels(2, width)
    p = result["behind"]
    mesh = left.pcolormesh(p.angle, 100 * p.x, abs(p.p).T, shading="nearest", vmin=0, rasterized=True)
    ray = result["thickness_m"] * np.tan(np.radians(p.angle))
    left.plot(p.angle, 100 * ray.where(abs(ray) < 0.4), "w--", label="straight ray")
    left.legend(loc="upper left", labelcolor="w", frameon=False)
    figure.colorbar(mesh, ax=left, label="|p| behind the slab [Pa]")
    left.set(xlabel="angle [degree]", ylabel="x [cm]", xticks=DEGREES, yticks=range(-40, 41, 20))
    for name, label in (("narrow", "9.6 cm beam"), ("wide", "40 cm beam")):
        right.plot(result[name].angle, 1e3 * result[name].centroid_out, label=label)
    right.set(xlabel="angle [degree]", ylabel="centroid behind the slab [mm]", xticks=DEGREES, ylim=(-11, 11))
    right.legend()
    return figure


if __name__ == "__main__":
    main(study, picture)
