"""What pictures of curves and sweeps show: the numbers of their datasets, on the axes that were asked for."""

import itertools

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from drawn_datasets import AXES, made, widths

import beamprop as bp
from beamprop.io.labels import label
from beamprop.plot import panels, spread

mpl.use("agg")


@pytest.fixture(autouse=True)
def figures():
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


# --- curves, maps and panels ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("dims", "along", "expected"),
    [
        (("frequency",), "frequency", (None, False)),
        (("eta", "frequency"), "frequency", (None, False)),
        (("frequency", "kx_over_k0"), "kx_over_k0", (None, True)),
        (("frequency", "kx_over_k0", "eta"), "kx_over_k0", ("eta", True)),
        (("eta", "angle", "frequency"), "frequency", ("eta", False)),
        (("eta", "angle", "frequency", "kx_over_k0"), "frequency", None),
        (("frequency", "sample", "kx_over_k0"), "kx_over_k0", None),
    ],
)
def test_the_number_of_axes_decides(dims, along, expected):
    """Eight curves, a map of two axes, eight panels; beyond that a refusal that names the sizes."""
    v = made(*dims).transmissivity
    if expected is not None:
        assert spread.plan(v, along) == expected
        return
    with pytest.raises(ValueError, match=r"^ds: expected at most 8 curves or panels beside \w+, got eta 3|sample 25"):
        bp.plot.sweep(made(*dims), along=along)


def test_the_horizontal_axis_is_a_long_one():
    """The lateral one, unless it is short and frequency long; or the one that is asked for; words last."""
    long, short = made("frequency", "kx_over_k0"), made("frequency", "angle")
    assert bp.plot.scattering(long).get_xlabel() == "$k_x/k_0$"
    assert bp.plot.scattering(long, along="frequency").get_xlabel() == "frequency [Hz]"
    assert bp.plot.scattering(short).get_xlabel() == "frequency [Hz]"
    assert bp.plot.scattering(short, along="angle").get_xlabel() == "angle [°]"
    assert bp.plot.scattering(short.isel(frequency=[0, 1])).get_xlabel() == "angle [°]"
    sides = made("eta", "angle").assign_coords(eta=["reflected", "transmitted", "other"])
    assert bp.plot.sweep(sides).get_xlabel() == "angle [°]"
    assert [t.get_text() for t in bp.plot.sweep(sides).get_legend().get_texts()] == [
        "reflected",
        "transmitted",
        "other",
    ]


def test_curves_are_the_numbers():
    """Each curve has its values, in the order of the axis, and the name of its own; data stay in SI units."""
    ds = made("frequency", "angle").isel(frequency=slice(None, None, -1))
    ax = bp.plot.scattering(ds, label="slab")
    assert [line.get_label() for line in ax.lines] == [f"slab, {10 * i}°" for i in range(7)]
    for i, line in enumerate(ax.lines):
        np.testing.assert_array_equal(line.get_xdata(), AXES["frequency"])
        np.testing.assert_array_equal(line.get_ydata(), ds.transmissivity.values[::-1, i])
    looks = {(line.get_color(), line.get_linestyle()) for line in ax.lines}
    assert len(looks) == 7
    assert ax.lines[0].get_marker() == ""
    assert bp.plot.scattering(ds.isel(frequency=[0, 1, 2]), along="frequency").lines[0].get_marker() == "o"


def test_a_map_has_the_numbers_and_the_grazing_waves():
    """Frequency upwards, kx to the right; a dotted line at |kx| = k0, also where kx is in rad/m and it is oblique."""
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.5, 300.0), 0.1)
    f, kx = np.linspace(2000.0, 3000.0, 21), np.linspace(0.0, 80.0, 41)
    ds = bp.scattering(slab, f, kx=kx)
    ax = bp.plot.scattering(ds)
    np.testing.assert_array_equal(ax.collections[0].get_array(), ds.transmissivity)
    linear = (50.0 / 2000.0) ** 2 / 4  # of the interpolation of 1/f between rows 50 Hz apart
    grazing = np.concatenate([path.vertices for path in ax.collections[1].get_paths()])
    np.testing.assert_allclose(grazing[:, 0], 2 * np.pi * grazing[:, 1] / 343.0, rtol=linear)
    ax = bp.plot.scattering(bp.scattering(slab, f, angle=np.linspace(0, 80, 9)))
    assert len([c for c in ax.collections if isinstance(c, mpl.contour.ContourSet)]) == 0


def test_panels_of_maps_share_their_colours():
    ds = made("frequency", "kx_over_k0", "eta")
    axes = bp.plot.sweep(ds, along="kx_over_k0", width=180)
    assert [ax.get_title() for ax in axes] == ["eta = 0.01", "eta = 0.02", "eta = 0.05"]
    for i, ax in enumerate(axes):
        np.testing.assert_array_equal(ax.collections[0].get_array(), ds.transmissivity.values[..., i])
    assert len({ax.collections[0].get_clim() for ax in axes}) == 1
    with pytest.raises(ValueError, match=r"^ax: expected none for a figure of 3 panels, got Axes"):
        bp.plot.sweep(ds, along="kx_over_k0", ax=axes[0])


@pytest.mark.parametrize(
    ("values", "log", "ends", "extend", "note"),
    [
        ([0.2, 0.5], False, (0.0, 0.5), "neither", ""),
        ([-3.0, 1.0], False, (-3.0, 3.0), "neither", ""),
        ([*np.linspace(0, 1, 999), 4.5e8], False, (0.0, 0.996), "max", "; largest 4.5e08"),
        ([0.0, 0.0], False, (0.0, 1.0), "neither", ""),
        ([1e-3, 10.0], True, (1e-3, 10.0), "neither", ""),
        ([0.0, 1e-30, 10.0], True, (1e-11, 10.0), "min", ""),
        ([0.0, np.nan], True, (0.1, 0.2), "min", ""),
    ],
)
def test_colour_scales(values, log, ends, extend, note):
    """From 0, or symmetric, or over twelve decades; where colours end early the bar says so."""
    scale = panels.colours(np.array(values), log)
    norm = scale.options.get("norm") or mpl.colors.Normalize(scale.options["vmin"], scale.options["vmax"])
    np.testing.assert_allclose((norm.vmin, norm.vmax), ends, rtol=1e-3)
    assert (scale.extend, scale.note) == (extend, note)


def test_zero_has_the_lowest_colour_of_a_logarithmic_map_and_nan_none():
    ds = made("frequency", "kx_over_k0")
    ds.transmissivity[0, 0], ds.transmissivity[0, 1] = 0.0, np.nan
    mesh = bp.plot.scattering(ds, log=True).collections[0]
    colours = mesh.to_rgba(mesh.get_array())
    np.testing.assert_array_equal(colours[0, 0], mesh.cmap(0.0))
    assert colours[0, 1, 3] == 0
    assert colours[1, 1, 3] == 1


def test_a_clipped_scale_is_in_the_unit_of_what_it_shows():
    """Not in that of the resonance that it does not show."""
    ds = made("frequency", "kx_over_k0")
    ds.transmissivity[3, 3] = 4e8
    ax = bp.plot.scattering(ds)
    assert ax.figure.axes[1].get_ylabel().replace("\n", " ") == "transmissivity |t|²; largest 4e08"
    small = made("eta", "frequency", eta=np.array([0.001, 0.0025]))
    assert [line.get_label() for line in bp.plot.sweep(small).lines] == ["eta = 0.001", "eta = 0.0025"]


def test_axes_of_even_ratios_are_logarithmic():
    axis = made("frequency", frequency=np.geomspace(5e4, 5e5, 12))
    ax = bp.plot.sweep(axis)
    ax.figure.canvas.draw()
    assert (ax.get_xscale(), ax.get_xlabel()) == ("log", "frequency [kHz]")
    assert {"50", "100", "200", "500"} <= {text.get_text() for text in ax.get_xticklabels()}
    assert bp.plot.sweep(made("frequency")).get_xscale() == "linear"


# --- Bloch waves and modes --------------------------------------------------------------------------------

LIGHT, HEAVY = bp.AIR, bp.Fluid.from_speed(5.0, 600.0)
CELL = bp.Cell((bp.Layer(LIGHT, 0.05), bp.Layer(HEAVY, 0.03)))


def cosine(frequency, kx):
    """cos(kz d) of two lossless layers: Rytov (1956)."""
    phases, impedances = [], []
    for density, speed, thickness in ((1.25, 343.0, 0.05), (5.0, 600.0, 0.03)):
        kz = np.emath.sqrt((2 * np.pi * frequency / speed) ** 2 - kx**2)
        phases.append(kz * thickness)
        impedances.append(density / kz)
    (a, b), ratio = phases, impedances[0] / impedances[1]
    return np.cos(a) * np.cos(b) - (ratio + 1 / ratio) / 2 * np.sin(a) * np.sin(b)


@pytest.mark.parametrize("kx", [0.0, 7.0])
def test_bands_against_frequency(kx):
    """Re and Im of kz d/pi solve Rytov's equation; the real part is in the first zone, with gaps at its edges alone."""
    f = np.linspace(100.0, 6000.0, 700)
    ax = bp.plot.bloch(bp.bloch(CELL, f, kx=kx))
    real, imaginary = ax.lines
    assert (ax.get_ylabel(), imaginary.get_linestyle()) == (r"$k_z d/\pi$ (dotted: imaginary part)", ":")
    x, y = real.get_data()
    kept = ~np.isnan(y)
    np.testing.assert_array_equal(x[kept], f)
    np.testing.assert_allclose(np.cos(np.pi * (y[kept] + 1j * imaginary.get_ydata())), cosine(f, kx), atol=1e-6)
    assert np.all((y[kept] > -1) & (y[kept] <= 1 + 1e-6))
    assert np.nanmax(np.abs(np.diff(y))) < 0.5
    assert 1 <= np.sum(~kept) <= 4
    assert np.any(imaginary.get_ydata() > 0.1)


def test_contours_and_their_mirror():
    ds = bp.bloch(CELL, [500.0, 900.0], kx_over_k0=np.linspace(-2, 2, 41))
    ax = bp.plot.bloch(ds, mirror=True, imaginary=False)
    assert [line.get_label() for line in ax.lines if line.get_label()[0] != "_"] == ["500 Hz", "900 Hz"]
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), ds.kz_over_k0.real.values[1])
    np.testing.assert_array_equal(ax.lines[3].get_ydata(), -ds.kz_over_k0.real.values[1])
    assert ax.lines[3].get_color() == ax.lines[1].get_color() != ax.lines[0].get_color()


def test_bloch_maps():
    """|Re| and Im of kz d/pi over kx and frequency, both of Rytov's equation; one of them in given Axes."""
    f, kx = np.linspace(100.0, 6000.0, 60), np.linspace(0.0, 40.0, 31)
    ds = bp.bloch(CELL, f, kx=kx)
    axes = bp.plot.bloch(ds)
    real, imaginary = (np.asarray(ax.collections[0].get_array()) for ax in axes)
    np.testing.assert_allclose(
        np.cos(np.pi * real).real * np.cosh(np.pi * imaginary), cosine(f[:, None], kx).real, rtol=1e-5, atol=1e-6
    )
    assert real.min() >= 0
    with pytest.raises(ValueError, match=r"^imaginary: expected False for maps in given Axes"):
        bp.plot.bloch(ds, ax=axes[0])
    assert bp.plot.bloch(ds, ax=axes[0], imaginary=False, along="frequency") is axes[0]


def test_a_sweep_of_cells_has_kz():
    """Cells of different thickness have no common d."""
    ds = bp.sweep(
        lambda eta, frequency: bp.bloch(bp.lmmd_cell(eta=eta), frequency, kx=0.0),
        {"eta": [0.01, 0.02], "frequency": np.linspace(2000, 3000, 9)},
        workers=1,
        progress=False,
    )
    assert bp.plot.bloch(ds, imaginary=False).get_ylabel() == "$k_z$ [rad/m]"


def test_modes_in_the_complex_plane_and_against_frequency():
    k = np.array([[1.2 + 0.1j, 1.5 - 0.2j], [1.3 + 0j, np.nan]])
    ds = xr.Dataset(
        {"kx_over_k0": (("frequency", "mode"), k), "direction": (("frequency", "mode"), [[1, -1], [1, 0]])},
        {"frequency": ("frequency", [2e6, 3e6], label("frequency"))},
    )
    ax = bp.plot.modes(ds.isel(frequency=0), label="plate")
    assert [(line.get_label(), line.get_fillstyle()) for line in ax.lines[:2]] == [
        ("plate: forward", "full"),
        ("plate: backward", "none"),
    ]
    np.testing.assert_array_equal([line.get_xydata()[0] for line in ax.lines[:2]], [[1.2, 0.1], [1.5, -0.2]])
    ax = bp.plot.modes(ds)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("frequency [MHz]", "Re $k_x/k_0$")
    np.testing.assert_array_equal(ax.lines[0].get_xydata(), [[2e6, 1.2], [3e6, 1.3]])
    ax = bp.plot.modes(ds.isel(frequency=0, mode=slice(0)))
    assert [text.get_text() for text in ax.texts] == ["no guided mode"]


# --- refusals ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: bp.plot.scattering(made("frequency"), along="angle"), "along: expected frequency, got 'angle'"),
        (
            lambda: bp.plot.scattering(made("frequency").isel(frequency=0)),
            "ds: expected an axis of several values, such",
        ),
        (lambda: bp.plot.scattering(made("kx_over_k0", kx_over_k0=[0, 1j])), "ds: expected real values of kx_over_k0"),
        (lambda: bp.plot.width(widths("eta").isel(eta=0)), "ds: expected an axis of several values, such as frequency"),
        (lambda: bp.plot.sweep(made("frequency"), band="sample"), "band: expected frequency, got 'sample'"),
        (lambda: bp.plot.sweep(made("sample"), band="sample"), "ds: expected an axis of several values, got one value"),
        (
            lambda: bp.plot.sweep(made("sample", "frequency"), band="sample", percentiles=(9, 5)),
            "percentiles: expected two",
        ),
        (lambda: bp.plot.sweep(made("sample", "frequency"), band="sample", percentiles=3), "percentiles: expected two"),
        (
            lambda: bp.plot.sweep(made("sample", "frequency", "kx_over_k0"), band="sample"),
            "band: expected at most 8 bands",
        ),
        (lambda: bp.plot.sweep(made("frequency"), width=10), "width: expected at least 40 mm, got 10"),
        (lambda: bp.plot.sweep(made("frequency"), band=["sample"]), "band: expected a word, got"),
        (lambda: bp.plot.sweep(made("frequency").astype(str)), "quantity: expected a variable of numbers, got 'trans"),
        (
            lambda: bp.plot.sweep(made("frequency").drop_vars("transmissivity")),
            "ds: expected a dataset with a variable",
        ),
        (lambda: bp.plot.sweep(3), "ds: expected a Dataset, got 3"),
        (lambda: bp.plot.scattering(made("frequency"), label=3), "label: expected a word, got 3"),
        (lambda: bp.plot.scattering(made("frequency"), along=3), "along: expected a word, got 3"),
        (lambda: bp.plot.modes(made("frequency")), "ds: expected a dataset with kx_over_k0, direction"),
    ],
)
def test_what_cannot_be_drawn_is_refused(call, message, figures):
    """In one line that names the argument, and no figure is left behind."""
    with pytest.raises(ValueError, match=f"^{message}"):
        call()
    assert figures.get_fignums() == []


def test_every_two_of_eight_curves_differ():
    ax = bp.plot.scattering(made("frequency", "kx_over_k0", frequency=np.linspace(2e3, 3e3, 8)))
    for a, b in itertools.combinations(ax.lines, 2):
        assert (a.get_color(), a.get_linestyle()) != (b.get_color(), b.get_linestyle())
