"""
Beams through the skull, to ten digits
======================================

A bowl focuses 500 kHz in water to 1094.4 kPa at 61.9 mm, behind 6.5 mm of bone to 420.5 kPa at 55.5 mm, and behind skin and three layers
of bone, where the focus is 27.4 mm long and 4.36 mm wide, to 313.8 kPa at 57.1 mm.
What a piston sends 60 mm far falls in the same way, from 91.5 kPa to 42.2 and 31.4 kPa; the table has ten digits of each, by which
codes for whole heads can be judged.
"""

import numpy as np
import xarray as xr
from gallery_main import PAGE, main
from numpy.polynomial import Chebyshev

import beamprop as bp
from beamprop.plot.style import new_figure

#: The flat benchmarks of the transcranial intercomparison that have layers or none (Aubry et al., J. Acoust. Soc. Am. 152, 1003 (2022)).
#: Frequency [Hz], rho c v of the sources [Pa], radius of the piston [m], radius of curvature and aperture of the bowl [m].
FREQUENCY, PRESSURE, RADIUS, BOWL = 0.5e6, 60e3, 0.01, 0.064
#: Density [kg/m3], speed [m/s], attenuation at the frequency [dB/cm].
TISSUES = {
    "water": (1000.0, 1500.0, 0.0),
    "skin": (1090.0, 1610.0, 0.2),
    "cortical bone": (1850.0, 2800.0, 4.0),
    "trabecular bone": (1700.0, 2300.0, 8.0),
    "brain": (1040.0, 1560.0, 0.3),
}
#: Thicknesses [m]; where the first layer begins, as seen from the piston or the bowl's apex [m]; and what lies behind.
LAYERS = {
    "BM1": (("water", 0.0065),),
    "BM3": (("cortical bone", 0.0065),),
    "BM4": (("skin", 0.004), ("cortical bone", 0.0015), ("trabecular bone", 0.004), ("cortical bone", 0.001)),
}
START = {"BM1": 0.03, "BM3": 0.03, "BM4": 0.026}
BEHIND = {"BM1": "water", "BM3": "water", "BM4": "brain"}
SOURCES = ("bowl", "piston")
CASES = [(name, source) for source in SOURCES for name in LAYERS]
#: Where a piston, which has no focus, is measured; the axis is searched, and across it, between these [m].
PROFILE, AXIS, ACROSS = 0.06, (0.037, 0.089), (-0.03, 0.03)
#: Points of the table [m].
X, Z = np.array([0.0, 0.005, 0.02]), np.array([0.02, 0.04, 0.06, 0.08, 0.1])
RTOL, DEGREE = 1e-10, 100


def fluid(tissue):
    """A tissue."""
    density, speed, loss = TISSUES[tissue]
    return bp.Fluid.from_speed(density, speed, attenuation=bp.power_law(loss, FREQUENCY) if loss else 0.0)


def problem(name, source):
    """The layers and the source of a benchmark; their z = 0 is the first layer's face."""
    cell = bp.Cell([bp.Layer(fluid(tissue), thickness) for tissue, thickness in LAYERS[name]])
    slab = bp.Slab(cell, before=fluid("water"), after=fluid(BEHIND[name]))
    if source == "piston":
        return slab, bp.Piston(RADIUS, pressure=PRESSURE, z0=-START[name])
    return slab, bp.Bowl(BOWL, BOWL, pressure=PRESSURE, z0=-START[name])


def pressure(name, source, x, z, rtol=RTOL):
    """p at y = 0, with z from the source."""
    slab, beam = problem(name, source)
    return bp.field(slab, beam, FREQUENCY, x, z + beam.z0, y=0.0, rtol=rtol).p


def line(name, source, window, place):
    """|p|^2 along a window, which is smooth, as a polynomial through Chebyshev's nodes: to rounding, with derivative and roots."""
    return Chebyshev.interpolate(lambda s: np.abs(pressure(name, source, *place(s)).values) ** 2, DEGREE, window)


def roots_of(curve):
    """Real roots inside its window, in order."""
    roots = curve.roots()
    real = roots[np.abs(roots.imag) < 1e-9].real
    return np.sort(real[(real > curve.domain[0]) & (real < curve.domain[1])])


def size_of(curve, middle):
    """Between the places nearest to `middle` where |p| is half as large as there."""
    roots = roots_of(curve - curve(middle) / 4)
    return roots[roots > middle].min() - roots[roots < middle].max()


def measures(name, source):
    """|p| at the focus, where it lies, and the -6 dB sizes; of a piston at `PROFILE`, across the axis only."""
    axis = line(name, source, AXIS, lambda z: (0.0, z))
    z, length = PROFILE, np.nan
    if source == "bowl":
        extremes = roots_of(axis.deriv())
        z = extremes[np.argmax(axis(extremes))]
        length = size_of(axis, z)
    return np.sqrt(axis(z)), z, length, size_of(line(name, source, ACROSS, lambda x: (x, z)), 0.0)


def table_of(focus, points):
    """As CSV: ten digits, of p at points down to 1e-10 of the largest of each case."""
    lines = ["benchmark,source,quantity,x [m],z [m],value,unit"]
    for name, source in CASES:
        case = {"benchmark": name, "source": source}
        for quantity in MEASURES if source == "bowl" else ("pressure", "width"):
            value = float(focus[quantity].sel(case))
            lines.append(f"{name},{source},{quantity},,,{value:.9e},{MEASURES[quantity][0]}")
        p = points.p.sel(case)
        decimals = 9 - int(np.log10(np.abs(p).max()))
        for place in ((x, z) for z in Z for x in X):
            value = p.sel(dict(zip(("x", "z"), place, strict=True))).item()
            for part, number in (("Re p", value.real), ("Im p", value.imag)):
                lines.append(f"{name},{source},{part},{place[0]:g},{place[1]:g},{number:.{decimals}f},Pa")
    return "\n".join(lines) + "\n"


#: Quantities of the table: unit, and what they are.
MEASURES = {
    "pressure": ("Pa", "|p| at the focus; of the piston at 60 mm"),
    "position": ("m", "of the focus, from the bowl's apex"),
    "length": ("m", "-6 dB size along the axis"),
    "width": ("m", "-6 dB size across the axis"),
}


def study(quick=False):
    """Foci and points of three benchmarks with two sources, their table, and maps."""
    both = {"source": list(SOURCES), "benchmark": list(LAYERS)}
    answers = np.array([[measures(name, source) for name in LAYERS] for source in SOURCES])
    focus = xr.Dataset({key: (tuple(both), answers[:, :, i]) for i, key in enumerate(MEASURES)}, both)
    for key, (unit, meaning) in MEASURES.items():
        focus[key].attrs = {"units": unit, "long_name": meaning}
    x, z = np.linspace(-0.035, 0.035, 57 if quick else 141), np.linspace(0.012, 0.12, 73 if quick else 217)
    points, maps = (fields_of(*where) for where in ((X, Z, RTOL), (x, z, 1e-4)))
    bowl, piston = 1e-3 * focus.pressure.sel(source="bowl"), 1e-3 * focus.pressure.sel(source="piston")
    behind = focus.sel(source="bowl", benchmark="BM4")
    kpa = {f"{name}_kpa": float(bowl.sel(benchmark=name)) for name in LAYERS}
    kpa |= {f"piston_{name}_kpa": float(piston.sel(benchmark=name)) for name in LAYERS}
    at = {f"{name}_mm": 1e3 * float(focus.position.sel(source="bowl", benchmark=name)) for name in LAYERS}
    return {
        "khz": FREQUENCY / 1e3,
        "bone_mm": 1e3 * LAYERS["BM3"][0][1],
        "profile_mm": 1e3 * PROFILE,
        "length_mm": 1e3 * float(behind.length),
        "width_mm": 1e3 * float(behind.width),
        **kpa,
        **at,
        "focus": focus,
        "points": points,
        "table": table_of(focus, points),
        "maps": maps,
    }


def fields_of(x, z, rtol):
    """p of all cases at x and z, from the source."""
    values = np.array([[pressure(name, source, x, z, rtol).values for name in LAYERS] for source in SOURCES])
    places = {"source": list(SOURCES), "benchmark": list(LAYERS), "z": z, "x": x}
    return xr.Dataset({"p": (tuple(places), values, {"units": "Pa", "long_name": "pressure"})}, places)


def picture(result, width=PAGE):
    """|p| over that of the sources, rho c v, with the layers' faces: sources side by side in a column, one below another on a page."""
    wide = width == PAGE
    figure = new_figure(width, 82.0 if wide else 100.0)
    axes = figure.subplots(*((2, 3) if wide else (3, 2)), sharex=True, sharey=True)
    for ax, (name, source) in zip((axes if wide else axes.T).flat, CASES, strict=True):
        p = abs(result["maps"].p.sel(benchmark=name, source=source)) / PRESSURE
        level = 20 * np.log10(np.maximum(p, 1e-3)).T
        mesh = ax.pcolormesh(1e3 * p.z, 1e3 * p.x, level, shading="nearest", vmin=-24, vmax=24, rasterized=True)
        faces = START[name] + np.cumsum([0.0, *(d for _, d in LAYERS[name])])
        for face in faces if name != "BM1" else ():
            ax.axvline(1e3 * face, color="w", lw=0.4)
        ax.set(title=f"{name}, {source}", aspect="equal")
        ax.set(xlabel="z from the source [mm]", ylabel="x [mm]")
        ax.label_outer()
    figure.colorbar(mesh, ax=axes, label="|p| [dB of 60 kPa]", location="right" if wide else "bottom")
    return figure


if __name__ == "__main__":
    main(study, picture)
