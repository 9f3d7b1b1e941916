"""Maps of a field: what their pixels hold, and that no letter is cut or overlaps another."""

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
import xarray as xr
from drawn_texts import faults

import beamprop as bp
from beamprop.plot import maps
from beamprop.plot.quantities import QUANTITIES

mpl.use("agg")
X, Z = np.linspace(-0.3, 0.3, 61), np.linspace(-0.05, 0.5, 56)
SLAB = bp.Slab([bp.Layer(bp.AIR, 0.1), bp.Layer(bp.material("water"), 0.05)], periods=2)


@pytest.fixture(autouse=True)
def figures():
    yield
    plt.close("all")


def beam(x=X, z=Z, size=1.0, slab=SLAB):
    """A slanting Gaussian in closed form, as a dataset of `field` with its provenance."""
    ds = bp.field(slab, bp.GaussianBeam(0.096, z0=-1.0), 2500.0, [0.0, 0.1], [0.0, 0.1])
    across, along = x / np.ptp(x), (z[:, None] - z[0]) / np.ptp(z)
    p = size * np.exp(-(((across - across.mean() - 0.2 * along) / 0.15) ** 2) + 20j * (along + across**2))
    places = {n: (n, v, ds[n].attrs) for n, v in (("z", z), ("x", x))}
    return ds.drop_vars(["p", "x", "z"]).assign_coords(places).assign(p=(("z", "x"), p, ds.p.attrs))


def pixels(ax):
    return ax.collections[0].get_array()


# --- what the pixels hold ---------------------------------------------------------------------------------


def test_values_of_each_quantity():
    ds = beam(size=3.0)
    p = ds.p.values.T
    expected = {"abs": abs(p), "real": p.real, "phase": np.angle(p, deg=True), "intensity": abs(p) ** 2}
    for quantity, values in expected.items():
        np.testing.assert_allclose(pixels(bp.plot.field(ds, quantity)), values, rtol=1e-12, err_msg=quantity)
    level = pixels(bp.plot.field(ds, "dB"))
    np.testing.assert_allclose(level, 20 * np.log10(abs(p) / abs(p).max()), atol=1e-9)
    level = pixels(bp.plot.field(ds, "dB", limit=0.5))
    np.testing.assert_allclose(level, 20 * np.log10(abs(p) / 0.5), atol=1e-9)


@pytest.mark.parametrize(
    ("quantity", "ends"),
    [("abs", (0, 2)), ("real", (-2, 2)), ("phase", (-180, 180)), ("dB", (-25, 0)), ("intensity", (0, 4))],
)
def test_ends_of_the_colours(quantity, ends):
    mesh = bp.plot.field(beam(), quantity, limit=2.0, floor=-25).collections[0]
    assert mesh.get_clim() == ends


def test_intensity_of_the_dataset_is_drawn_where_it_is_there():
    ds = bp.field(SLAB, bp.GaussianBeam(0.096), 2500.0, X[::10], Z[5::10], variables=["intensity"])
    ax = bp.plot.field(ds, "intensity")
    np.testing.assert_allclose(pixels(ax), np.hypot(ds.intensity_x, ds.intensity_z).T, rtol=1e-12)
    assert ax.child_axes[0].get_ylabel() == "|I| [10⁻⁶ W/m²]"
    with pytest.raises(ValueError, match=r"^ds: expected a dataset with p, x, z"):
        bp.plot.field(ds)


def test_points_in_any_order_and_without_a_value():
    ds = beam()
    shuffled = ds.isel(z=np.random.default_rng(1).permutation(Z.size), x=slice(None, None, -1))
    np.testing.assert_array_equal(pixels(bp.plot.field(shuffled)), pixels(bp.plot.field(ds)))
    holes = ds.assign(p=ds.p.where(ds.z > 0.1))
    for quantity in QUANTITIES:
        drawn = np.ma.filled(pixels(bp.plot.field(holes, quantity, half_level=True)), np.nan)
        assert np.array_equal(np.isnan(drawn), np.isnan(holes.p.values.T)), quantity
    for dark in (0 * ds.p, np.nan * ds.p):
        for quantity in QUANTITIES:
            bp.plot.field(ds.assign(p=dark), quantity).figure.canvas.draw()


@pytest.mark.parametrize(
    ("quantity", "tip", "said"),
    [
        ("abs", "max", "2500 Hz, 0°\nvalues up to 1 Pa"),
        ("real", "both", "2500 Hz, 0°\nvalues from −1 to 1 Pa"),
        ("phase", "neither", "2500 Hz, 0°"),
        ("dB", "both", "2500 Hz, 0°\nvalues from −"),
        ("intensity", "max", "2500 Hz, 0°\nvalues up to 1 Pa²"),
    ],
)
def test_colours_that_end_early_are_told(quantity, tip, said):
    """A tip at the colour bar, and a line in the title; neither where the colours hold every value."""
    ax = bp.plot.field(beam(), quantity, limit=0.5)
    assert ax.get_title().startswith(said)
    assert ax.collections[0].colorbar.extend == tip
    ax = bp.plot.field(beam(), quantity, limit=1.1, floor=-300.0)
    assert ax.get_title() == "2500 Hz, 0°"
    assert ax.collections[0].colorbar.extend == "neither"
    assert bp.plot.field(beam(), "abs", colorbar=False, limit=0.5).get_title() == "2500 Hz, 0°"


# --- lines on the map -------------------------------------------------------------------------------------


def vertical(ax, style):
    return sorted(line.get_xdata()[0] for line in ax.lines if line.get_linestyle() == style)


def test_slab_and_layers_are_outlined():
    ax = bp.plot.field(beam())
    assert vertical(ax, "--") == pytest.approx([0.0, 0.3])
    assert vertical(ax, "-") == pytest.approx([0.1, 0.15, 0.25])
    stacked = bp.Slab(bp.lmmd_cell(), periods=40) + SLAB
    start = 40 * bp.lmmd_cell().thickness
    ax = bp.plot.field(beam(slab=stacked))  # cells of 2.3 mm have no room; where the parts meet is drawn
    assert vertical(ax, "-") == pytest.approx([start, start + 0.1, start + 0.15, start + 0.25])
    foreign = beam()
    foreign.attrs = {"slab_thickness": 0.3}
    assert vertical(bp.plot.field(foreign), "--") == pytest.approx([0.0, 0.3])
    foreign.attrs = {"provenance": "{broken"}
    assert vertical(bp.plot.field(foreign), "--") == [0.0]


def test_layers_cells_or_segments_by_room():
    cells = [0.15]
    assert maps.inner_faces(SLAB, 0.04) == pytest.approx([0.1, 0.15, 0.25])
    assert maps.inner_faces(SLAB, 0.06) == pytest.approx(cells)
    assert maps.inner_faces(SLAB, 0.2) == []


def test_half_level_is_that_of_fwhm():
    """Both lines: their distance is `fwhm`, and a cubic spline of |p| has half its largest there, to the grid's accuracy."""
    ds = beam()
    left, right = (np.array(line.get_ydata()) for line in bp.plot.field(ds, half_level=True).lines[-2:])
    np.testing.assert_allclose(right - left, bp.fwhm(ds.p), rtol=1e-12)
    for i in (0, 20, 55):
        size = np.abs(ds.p.values[i])
        np.testing.assert_allclose(np.interp([left[i], right[i]], X, size), size.max() / 2, rtol=0.02)
    with pytest.raises(ValueError, match=r"^ds: expected at least 4 samples along x"):
        bp.plot.field(ds.isel(x=slice(3)), half_level=True)


# --- the picture ------------------------------------------------------------------------------------------

#: x and z whose pictures are not like those of the others: thin, broad, tall, of micrometres, far away.
GRIDS = {
    "square": (X, Z),
    "stripe along z": (np.linspace(-0.1, 0.1, 41), np.linspace(0.0, 9.0, 31)),
    "stripe along x": (np.linspace(-3.0, 3.0, 41), np.linspace(-0.01, 0.04, 31)),
    "broad": (np.linspace(-0.4, 0.4, 41), np.linspace(0.0, 2.0, 31)),
    "tall": (np.linspace(-0.9, 0.9, 41), np.linspace(0.0, 0.5, 31)),
    "two by two": (np.array([-0.2, 0.2]), np.array([0.0, 0.3])),
    "micrometres": (np.linspace(-3e-6, 2e-6, 41), np.linspace(-1e-6, 4e-6, 31)),
    "far away": (np.linspace(-1234.5, -1233.0, 41), np.linspace(1000.0, 1001.0, 31)),
}


@pytest.mark.parametrize(
    ("grid", "quantity", "width"),
    [
        *((grid, quantity, 88) for grid in GRIDS for quantity in QUANTITIES),
        *(("square", quantity, 180) for quantity in QUANTITIES),
    ],
)
def test_no_letter_is_cut_or_overlaps(grid, quantity, width, monkeypatch):
    ds = beam(*GRIDS[grid], size={"square": 1.0, "broad": 3e-8, "tall": 2e7, "micrometres": 1e-30}.get(grid, 123.4))
    ax = bp.plot.field(ds, quantity, width=width)
    assert faults(ax.figure, monkeypatch) == []
    bar, box = ax.child_axes[0], ax.get_window_extent()
    colours = bar.get_window_extent()
    tips = {"neither": 1.0, "both": 1 / 1.1}.get(ax.collections[0].colorbar.extend, 1 / 1.05)
    assert colours.height == pytest.approx(tips * box.height, rel=1e-6)  # with its tips exactly as high as the map
    sheet = ax.figure.bbox
    left, right = (v / sheet.width for v in (box.x0, sheet.width - box.x1))
    assert left < 0.35
    assert right < 0.35
    assert ax.figure.get_figwidth() * 25.4 == pytest.approx(width)
    assert "scale" in ax.get_title() or box.height / box.width == pytest.approx(
        np.ptp(ax.get_ylim()) / np.ptp(ax.get_xlim())
    )


def test_the_checker_sees_faults(monkeypatch):
    """Letters beyond the sheet, on each other and on the picture."""
    figure = plt.subplots(figsize=(2, 2))[0]
    figure.text(0.95, 0.95, "beyond the sheet")
    figure.text(0.1, 0.02, "one text")
    figure.text(0.12, 0.02, "on another")
    figure.text(0.4, 0.5, "on the picture")
    said = faults(figure, monkeypatch)
    assert "'beyond the sheet' is cut" in said
    assert "'one text' overlaps 'on another'" in said
    assert "'on the picture' lies on the picture" in said


def test_given_axes_are_drawn_in_and_their_figure_left_alone():
    figure, axes = plt.subplots(1, 2, figsize=(5, 3), layout="constrained")
    assert bp.plot.field(beam(), ax=axes[1]) is axes[1]
    assert tuple(figure.get_size_inches()) == (5, 3)
    assert axes[1].xaxis.label.get_fontsize() == 10
    assert not axes[0].collections


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"z": 3}, "ds: expected a field on .z, x., got one along x for plot.cut"),
        ({"z": [3]}, "ds: expected a field on .z, x., got one along x for plot.cut"),
        ({"z": 3, "x": 0}, "got one point for plot.cut"),
    ],
)
def test_what_is_no_map_is_refused(parts, said):
    with pytest.raises(ValueError, match=said):
        bp.plot.field(beam().isel(parts))
    several = beam().expand_dims(frequency=[1.0, 2.0])
    with pytest.raises(ValueError, match=r"^ds: expected a field on \(z, x\); select one of frequency"):
        bp.plot.field(several)


# --- planes of a volume -----------------------------------------------------------------------------------


def volume():
    """Three different counts, so that a swapped axis cannot go unseen."""
    y = np.linspace(0.0, 0.4, 21)
    ds = beam(X[::3], Z[::4])
    there = xr.DataArray(np.exp(-((y / 0.2) ** 2) + 3j * y), dims="y", coords={"y": ("y", y, {"units": "m"})})
    return ds.assign(p=(ds.p * there).transpose("z", "y", "x").assign_attrs(ds.p.attrs))


@pytest.mark.parametrize(
    ("at", "upright", "level", "title"),
    [("z", "y", "x", "z = 0.15 m"), ("x", "y", "z", "x = 0.15 m"), ("y", "x", "z", "y = 0.2 m")],
)
def test_planes_of_a_volume(at, upright, level, title, monkeypatch):
    """Each pixel is the value at its place; faces stand where z is on an axis."""
    ds = volume().sel({at: float(title.split()[2])}, method="nearest")
    ax = bp.plot.field(ds)
    np.testing.assert_allclose(pixels(ax), abs(ds.p.transpose(upright, level)), rtol=1e-12)
    assert (ax.get_ylabel(), ax.get_xlabel()) == (f"{upright} [m]", f"{level} [m]")
    assert title in ax.get_title()
    assert bool(vertical(ax, "--")) == (level == "z")
    assert faults(ax.figure, monkeypatch) == []


@pytest.mark.parametrize(("far", "across"), [(0.1, "m"), (0.09, "mm"), (2.0, "m"), (3.0, "mm")])
def test_both_axes_of_a_map_have_a_unit_unless_sizes_differ_widely(far, across):
    """x reaches 4 cm: beside 10 cm of z it was in mm, and z in m."""
    ds = beam(np.linspace(-0.04, 0.04, 9), np.linspace(0.0, far, 7))
    ax = bp.plot.field(ds)
    assert (ax.get_ylabel(), ax.get_xlabel()) == (f"x [{across}]", f"z [{'m' if far >= 0.1 else 'mm'}]")


def test_the_planes_of_a_volume_have_the_same_unit():
    """The plane (y, x) alone reaches less than a decimetre."""
    ds = volume()
    small = ds.assign_coords(x=0.05 * ds.x, y=0.05 * ds.y)
    assert max(float(abs(small.x).max()), float(abs(small.y).max())) < 0.1 <= float(small.z.max())
    assert {label[-3:] for ax in bp.plot.field(small) for label in (ax.get_xlabel(), ax.get_ylabel())} == {"[m]"}


def test_what_volumes_are_refused_for(tmp_path):
    with pytest.raises(ValueError, match=r"^ds: .* in a volume: select one of y, x or z$"):
        bp.plot.animate(volume(), tmp_path / "a.gif")
    with pytest.raises(ValueError, match=r"^half_level: expected False for a volume, got True"):
        bp.plot.field(volume(), half_level=True)
    with pytest.raises(ValueError, match=r"^half_level: expected False for a plane at one z"):
        bp.plot.field(volume().isel(z=3), half_level=True)
