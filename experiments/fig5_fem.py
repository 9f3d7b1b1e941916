"""Figure 5 by full-wave finite elements: the seven panels beside the plane waves' at the same period, and their difference."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import DESIGN, FWHM, LOSSES, LOSSLESS, WAVELENGTH, Statement, run, slab
from fig5 import ANGLES, LAUNCH

import beamprop as bp

#: Not a whole number of wavelengths: no order travels along the faces.
PERIOD = 16.3 * WAVELENGTH


def cases(quick: bool) -> dict[str, tuple[str, bp.Slab, float]]:
    """Panel letter -> name, slab, angle; two of the seven with `quick`."""
    lossless, lossy = slab(450, LOSSLESS), slab(450, LOSSES["a"])
    out = {"a": ("air", bp.Slab.uniform(bp.AIR, lossy.thickness), 0.0)}
    out |= {letter: ("lossless", lossless, angle) for letter, angle in zip("bcd", ANGLES, strict=True)}
    out |= {letter: ("lossy", lossy, angle) for letter, angle in zip("efg", ANGLES, strict=True)}
    return {letter: out[letter] for letter in ("c", "e")} if quick else out


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """Comparison of every panel: p_a plane waves, p_b finite elements, relative L2 errors."""
    data = {}
    for letter, (name, structure, angle) in cases(quick).items():
        beam = bp.GaussianBeam(FWHM, angle=angle, z0=LAUNCH)
        x = np.linspace(-PERIOD / 2, PERIOD / 2, 327)
        # faces of periods: inside a cell the pressure ripples by about its own mean
        z = np.unique(
            np.concatenate(
                [
                    np.linspace(LAUNCH, 0, 20),
                    structure.thickness * np.arange(0, 451, 3) / 450,
                    structure.thickness + np.linspace(0, WAVELENGTH, 20),
                ]
            )
        )
        ours = bp.field(structure, beam, DESIGN, x, z, boundary="periodic", period=PERIOD)
        fem = bp.fem.field(structure, beam, DESIGN, x, z, PERIOD)
        ds = bp.compare(ours, fem)
        behind = ds.relative_l2_by_z.z >= 0
        a, b = (ds[n].where(behind, drop=True) for n in ("p_a", "p_b"))
        error = float(np.linalg.norm(a - b) / np.linalg.norm(a))
        data[letter] = ds.assign_attrs(
            case=name,
            angle_of_incidence=angle,
            slab_thickness=structure.thickness,
            error_behind_near_face=error,
            seconds=fem.attrs["seconds"],
            dofs=fem.attrs["dofs"],
            residual=fem.attrs["residual"],
        )
    return data


def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """Re p of both, and the difference on its own scale; one row a panel."""
    fig, axes = plt.subplots(len(data), 3, figsize=(10, 3.1 * len(data)), layout="constrained", squeeze=False)
    for (letter, ds), row in zip(data.items(), axes, strict=True):
        title = f"({letter}) {ds.attrs['case']}, {ds.attrs['angle_of_incidence']:g}°"
        for ax, name, what in zip(
            row, ("p_a", "p_b", "error"), ("plane waves", "finite elements", "difference"), strict=True
        ):
            values = ds[name].transpose("x", "z")
            if name == "error":
                mesh = ax.pcolormesh(ds.z, ds.x, np.abs(values), cmap="viridis", rasterized=True, shading="nearest")
            else:
                top = float(np.percentile(np.abs(ds.p_a), 99.8))
                mesh = ax.pcolormesh(
                    ds.z, ds.x, values.real, cmap="RdBu_r", vmin=-top, vmax=top, rasterized=True, shading="nearest"
                )
            for face in (0.0, ds.attrs["slab_thickness"]):
                ax.axvline(face, color="white" if name == "error" else "black", ls="--", lw=0.8)
            fig.colorbar(mesh, ax=ax, label="|difference| [Pa]" if name == "error" else "Re p [Pa]")
            ax.set_title(f"{title}: {what}", loc="left", fontsize="small")
            ax.set(xlabel="z [m]", ylabel="x [m]")
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """Plane waves against finite elements at the same period."""
    return [
        Statement(
            f"5({letter})",
            f"plane waves against FEM: {ds.attrs['case']}, {ds.attrs['angle_of_incidence']:g}°",
            f"relative L2 {ds.attrs['error_behind_near_face']:.1e} in and behind the slab; "
            f"{ds.attrs['dofs']:,} unknowns, residual {ds.attrs['residual']:.0e}",
            ds.attrs["error_behind_near_face"] < 1e-3 and ds.attrs["residual"] < 1e-10,
        )
        for letter, ds in data.items()
    ]


if __name__ == "__main__":
    run("fig5_fem", __doc__, compute, plot, statements)
