"""Figure 5: the beam in air (a), through the lossless slab at 0, 45, 85 degrees (b, c, d) and through the lossy one (e, f, g)."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, FWHM, LOSSES, LOSSLESS, PAGE, WAVELENGTH, Statement, in_style, run, slab

import beamprop as bp

LAUNCH = -0.73 * WAVELENGTH
ANGLES = (0.0, 45.0, 85.0)


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """Fields in open space, of air and of both media along the angle: maps on faces of cells, and all planes about two depths inside."""
    nx, nz = (201, 201) if quick else (1024, 1000)
    lossless, lossy = slab(450, LOSSLESS), slab(450, LOSSES["a"])
    x = np.linspace(-1.0, 1.0, nx)
    z = bp.faces(lossy, nz, before=-LAUNCH, after=WAVELENGTH)  # inside a cell the pressure ripples
    about = WAVELENGTH / 10 * (np.arange(97) / 96 - 0.5)  # 16 planes in each of six cells
    inside = np.concatenate([depth + about for depth in depths(lossy.thickness)])
    beam = bp.GaussianBeam(FWHM, z0=LAUNCH)
    media = {
        "air": (bp.Slab.uniform(bp.AIR, lossy.thickness), 0.0),
        "lossless": (lossless, ANGLES),
        "lossy": (lossy, ANGLES),
    }
    return {
        name + part: bp.field(s, beam, DESIGN, x, planes, angle=angles)
        for name, (s, angles) in media.items()
        for part, planes in (("", z), ("_inside", inside))
    }


def depths(thickness: float) -> tuple[float, float]:
    """Half a wavelength behind the near face and half a wavelength before the far one."""
    return WAVELENGTH / 2, thickness - WAVELENGTH / 2


def panels(data: dict[str, xr.Dataset], part: str = "") -> dict[str, xr.Dataset]:
    """The paper's seven panels by letter, or what is `_inside` of each."""
    out = {"a": data["air" + part]}
    for letters, name in (("bcd", "lossless"), ("efg", "lossy")):
        out |= {letter: data[name + part].sel(angle=angle) for letter, angle in zip(letters, ANGLES, strict=True)}
    return out


@in_style
def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Seven maps on one scale per medium, Re p and |p| side by side."""
    fig, axes = plt.subplots(4, 4, figsize=(PAGE, 9.0), layout="compressed")
    titles = {"a": "air", "b": "lossless", "c": "lossless", "d": "lossless", "e": "lossy", "f": "lossy", "g": "lossy"}
    places = {"a": 0, "b": 4, "c": 8, "d": 12, "e": 6, "f": 10, "g": 14}
    for letter, ds in panels(data).items():
        for shift, what in enumerate(("real", "abs")):
            ax = axes.flat[places[letter] + shift]
            bp.plot.field(ds, what, ax=ax, colorbar=what == "abs")
            angle = float(ds.angle)
            ax.set_title("")
            ax.set_title(f"({letter}) {titles[letter]}, {angle:g}°", loc="left")
    for ax in axes.flat[2:4]:
        ax.axis("off")
    return fig


def inside_widths(ds: xr.Dataset) -> tuple[float, float]:
    """Widths of |p| half a wavelength behind the near face and half a wavelength before the far face [m].

    |p| ripples within a cell by about its own mean; the mean of |p|^2 over a tenth of a wavelength is taken.
    """
    out = []
    for depth in depths(ds.attrs["slab_thickness"]):
        part = ds.p.sel(z=slice(depth - WAVELENGTH / 20, depth + WAVELENGTH / 20))
        out.append(float(bp.fwhm(np.sqrt((np.abs(part) ** 2).mean("z")))))
    return out[0], out[1]


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Broadening in air, none in the slab."""
    rows = []
    first, last = inside_widths(data["air_inside"])
    rows.append(
        Statement(
            "5(a)",
            "in air the beam broadens appreciably",
            f"width {100 * first:.1f} cm to {100 * last:.1f} cm over the slab's length",
            last > 2 * first,
        )
    )
    for letter, ds in panels(data, "_inside").items():
        if letter == "a":
            continue
        first, last = inside_widths(ds)
        medium = "lossless" if letter in "bcd" else "lossy"
        change = 100 * (last / first - 1)
        rows.append(
            Statement(
                f"5({letter})",
                f"{medium}, {float(ds.angle):g}°: no visible divergence inside the slab",
                f"width {100 * first:.1f} cm to {100 * last:.1f} cm ({change:+.0f} %)",
                abs(change) < 15,
            )
        )
    return rows


if __name__ == "__main__":
    run("fig5", __doc__, compute, plot, statements)
