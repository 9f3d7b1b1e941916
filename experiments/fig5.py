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
    """Fields in open space: air, and both media along the angle."""
    nx, nz = (201, 201) if quick else (1024, 1000)
    lossless, lossy = slab(450, LOSSLESS), slab(450, LOSSES["a"])
    x = np.linspace(-1.0, 1.0, nx)
    z = np.linspace(LAUNCH, lossy.thickness + WAVELENGTH, nz)
    beam = bp.GaussianBeam(FWHM, z0=LAUNCH)
    air = bp.Slab.uniform(bp.AIR, lossy.thickness)
    data = {}
    for name, s, angles in (("air", air, 0.0), ("lossless", lossless, ANGLES), ("lossy", lossy, ANGLES)):
        maps = bp.faces(s, nz // 2, before=-LAUNCH, after=WAVELENGTH)  # on faces of cells, so that they show no stripes
        data[name] = bp.field(s, beam, DESIGN, x, maps, angle=angles)
        for where, depth in (("near", WAVELENGTH / 2), ("far", s.thickness - WAVELENGTH / 2)):
            planes = z[np.abs(z - depth) <= WAVELENGTH / 20]
            data[f"{name} {where}"] = bp.field(s, beam, DESIGN, x, planes, angle=angles)
    return data


def panels(data: dict[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """The paper's seven panels by letter."""
    out = {"a": data["air"]}
    for letters, name in (("bcd", "lossless"), ("efg", "lossy")):
        out |= {letter: data[name].sel(angle=angle) for letter, angle in zip(letters, ANGLES, strict=True)}
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


def inside_widths(data: dict[str, xr.Dataset], name: str, angle: float) -> tuple[float, float]:
    """Widths of |p| half a wavelength behind the near face and half a wavelength before the far face [m].

    |p| ripples within a cell by about its own mean; the mean of |p|^2 over a tenth of a wavelength is taken.
    """
    out = []
    for where in ("near", "far"):
        p = data[f"{name} {where}"].p
        part = p.sel(angle=angle) if "angle" in p.dims else p
        out.append(float(bp.fwhm(np.sqrt((np.abs(part) ** 2).mean("z")))))
    return out[0], out[1]


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Broadening in air, none in the slab."""
    rows = []
    first, last = inside_widths(data, "air", 0.0)
    rows.append(
        Statement(
            "5(a)",
            "in air the beam broadens appreciably",
            f"width {100 * first:.1f} cm to {100 * last:.1f} cm over the slab's length",
            last > 2 * first,
        )
    )
    for letter, ds in panels(data).items():
        if letter == "a":
            continue
        medium = "lossless" if letter in "bcd" else "lossy"
        first, last = inside_widths(data, medium, float(ds.angle))
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
