"""
Round beams do not diffract, either
===================================

Launched 9.6 cm wide on the near face at 2 to 3 kHz, circular beams leave the lossless layers 6.8 to 10.9 cm wide and the lossy ones 8.2
to 9.6 cm, where two wavelengths of air make them 25.5 to 47.1 cm wide; at 45 degrees the lossy ones are 8.4 to 9.2 cm wide along x and y,
while without loss, between resonances, they trail guided waves and are up to 39 cm wide along x.
Launched before the face at 0, 45 or 85 degrees, they widen inside by at most 23 % along the tilt and 15 % across it without loss, and by 8
and 6 % with it, less than beams of which nothing depends on y (29 and 9 %); on the same way of 0.89 m air makes a beam 5.2 times as wide.
"""

import warnings

import numpy as np
import xarray as xr
from gallery_main import PAGE, main

import beamprop as bp
from beamprop.plot.style import new_figure

FWHM, DESIGN, WAVELENGTH = 0.096, 2500.0, 343.0 / 2500.0
#: The paper's figure 5 launches beams so far before the layers [m], at these angles.
LAUNCH, ANGLES = -0.73 * WAVELENGTH, (0.0, 45.0, 85.0)
MEDIA = {"lossless": bp.Slab(bp.lmmd_cell(lossless=True), 450), "lossy": bp.Slab(bp.lmmd_cell(), 450)}
THICKNESS = MEDIA["lossy"].thickness
#: Half a wavelength behind the near face and before the far face, on faces of cells [m].
INSIDE = np.array([30, 420]) * THICKNESS / 450
AIR = bp.Slab.uniform(bp.AIR, THICKNESS)
X, Y = np.linspace(-0.8, 1.6, 601), np.linspace(-0.8, 0.8, 401)
RTOL = 1e-6


def widths_by_frequency(frequency):
    """FWHM [m] behind both media, launched on the near face: at 0 degrees, beside two dimensions and air; at 45 along x and y through the peak."""
    x, y, near = np.linspace(-0.35, 0.85, 161), np.linspace(-0.3, 0.3, 41), np.linspace(-0.1, 0.2, 31)
    straight, tilted = bp.GaussianBeam(FWHM), bp.GaussianBeam(FWHM, 45.0)
    out = {}
    for name, slab in MEDIA.items():
        question = {"frequency": frequency, "z": slab.thickness, "rtol": RTOL}
        out[f"{name}_round"] = bp.fwhm(bp.field(slab, straight, x=x, y=0.0, **question).p)
        out[f"{name}_flat"] = bp.fwhm(bp.field(slab, straight, x=x, **question).p)
        with warnings.catch_warnings():
            warnings.filterwarnings(
                "ignore", "the half level is met"
            )  # by what trails without loss: the width is that of the peak
            out[f"{name}_x"] = bp.fwhm(bp.field(slab, tilted, x=x, y=0.0, **question).p)
        planes = bp.field(slab, tilted, x=near, y=y, **question).p
        out[f"{name}_y"] = bp.fwhm(planes.isel(x=abs(planes).max("y").argmax("x")), dim="y")
    air = [bp.field(AIR, straight, f, X, 2 * 343.0 / f, y=0.0, rtol=RTOL).p for f in frequency]
    out["air"] = [bp.fwhm(p) for p in air]
    return xr.Dataset({key: ("frequency", np.asarray(w)) for key, w in out.items()}, {"frequency": frequency})


def growth(slab, angle):
    """Width before the far face over that behind the near one: along x, along y, and where nothing depends on y."""
    beam = bp.GaussianBeam(FWHM, angle, z0=LAUNCH)
    cut = bp.field(slab, beam, DESIGN, X, INSIDE, y=0.0, rtol=RTOL).p
    rows = [
        bp.field(slab, beam, DESIGN, float(x), float(z), y=Y, rtol=RTOL).p
        for x, z in zip(abs(cut).idxmax("x"), INSIDE, strict=True)
    ]
    across = [float(bp.fwhm(row, dim="y")) for row in rows]
    along, flat = bp.fwhm(cut).values, bp.fwhm(bp.field(slab, beam, DESIGN, X, INSIDE, rtol=RTOL).p).values
    return along[1] / along[0], across[1] / across[0], flat[1] / flat[0]


def maps(slab, quick):
    """The cut y = 0 and the exit plane, over the angles."""
    beam, count = bp.GaussianBeam(FWHM, z0=LAUNCH), 61 if quick else 241
    x, y = np.linspace(-0.3, 0.5, count), np.linspace(-0.4, 0.4, count)
    z = bp.faces(slab, count, before=-LAUNCH, after=0.2)
    return {
        "cut": bp.field(slab, beam, DESIGN, x, z, angle=ANGLES, y=0.0, rtol=1e-4),
        "exit": bp.field(slab, beam, DESIGN, x, slab.thickness, angle=ANGLES, y=y, rtol=1e-4),
    }


def extremes(widths, key, *more):
    """The least and the largest width [cm] of curves."""
    values = 100 * np.array([widths[name] for name in (key, *more)])
    return {f"least_{key}_cm": values.min(), f"largest_{key}_cm": values.max()}


def study(quick=False):
    """Widths against frequency, growth inside, and maps of both media."""
    widths = widths_by_frequency(np.linspace(2000, 3000, 51))
    percent = {}
    for name, slab in MEDIA.items():
        most = 100 * (np.max([growth(slab, angle) for angle in ANGLES], axis=0) - 1)
        percent |= {f"{name}_{axis}_percent": most[i] for i, axis in enumerate(("along", "across", "flat"))}
    fields = {f"{name}_{key}": ds for name, slab in MEDIA.items() for key, ds in maps(slab, quick).items()}
    return {
        "fwhm_cm": 100 * FWHM,
        "first_khz": float(widths.frequency.min()) / 1e3,
        "last_khz": float(widths.frequency.max()) / 1e3,
        **extremes(widths, "lossless_round"),
        **extremes(widths, "lossy_round"),
        **extremes(widths, "air"),
        **extremes(widths, "lossy_x", "lossy_y"),
        **extremes(widths, "lossless_x"),
        **{f"angle_{angle:g}": angle for angle in ANGLES},
        **percent,
        "way_m": INSIDE[1] - INSIDE[0],
        "air_growth": growth(AIR, 0.0)[0],
        "widths": widths,
        **fields,
    }


def picture(result, width=PAGE):
    """|p| over its largest value at each z, on cuts and exit planes at three angles, and widths against frequency."""
    wide = width == PAGE
    figure = new_figure(width, 115.0 if wide else 225.0)
    upper, lower = figure.subfigures(2, 1, height_ratios=(1.15, 1) if wide else (1.8, 1))
    grid = {"width_ratios": (1.4, 0.8) * (3 if wide else 1)}
    axes = upper.subplots(*((2, 6) if wide else (6, 2)), sharey=True, gridspec_kw=grid).reshape(6, 2)
    for pair, (name, angle) in zip(axes, ((name, angle) for name in MEDIA for angle in ANGLES), strict=True):
        for ax, plane, across in zip(pair, ("cut", "exit"), ("z", "y"), strict=True):
            p = abs(result[f"{name}_{plane}"].p.sel(angle=angle))
            size = (p / p.max("x") if plane == "cut" else p / p.max()).transpose("x", across)
            ax.pcolormesh(p[across], p.x, size, shading="nearest", vmin=0, vmax=1, rasterized=True)
            if name == "lossy" and (wide or angle == ANGLES[-1]):
                ax.set_xlabel(f"{across} [m]")
        pair[0].set_title(f"{name}, {angle:g}°")
        pair[1].set(title="exit", aspect="equal", xticks=(-0.3, 0.3))
    upper.supylabel("x [m]")
    draw_widths(lower.subplots(1, 2, sharey=True) if wide else lower.subplots(2, 1), result["widths"])
    return figure


def draw_widths(axes, widths):
    """At normal incidence beside two dimensions and air; at 45 degrees along x and y."""
    khz, cm = widths.frequency / 1e3, 100 * widths
    left, right = axes
    for color, name in zip(("C0", "C1"), MEDIA, strict=True):
        left.plot(khz, cm[f"{name}_round"], color=color, label=f"{name}, round")
        left.plot(khz, cm[f"{name}_flat"], "--", color=color, lw=0.8, label=f"{name}, 2-D")
        right.plot(khz, cm[f"{name}_x"], color=color, label=f"{name}, along x")
        right.plot(khz, cm[f"{name}_y"], ":", color=color, label=f"{name}, along y")
    left.plot(khz, cm.air, "C2-.", label="air, two wavelengths")
    for ax, angle in ((left, 0), (right, 45)):
        ax.set(xlabel="frequency [kHz]", yscale="log", ylim=(6, 300), title=f"launched at {angle}°", ylabel="FWHM [cm]")
        ax.set_yticks((10, 20, 50, 100), ("10", "20", "50", "100"))
        ax.minorticks_off()
        ax.legend(ncols=2, loc="upper right")
    if left.get_position().y0 == right.get_position().y0:
        right.set_ylabel("")


if __name__ == "__main__":
    main(study, picture)
