"""Curves through a field, and its motion in time."""

import sys

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawn_texts import faults
from matplotlib.animation import FFMpegWriter
from PIL import Image, ImageSequence
from slanted_beam import X, Z, make

import beamprop as bp
from beamprop.plot.animate import motion
from beamprop.plot.quantities import QUANTITIES

mpl.use("agg")


@pytest.fixture(autouse=True)
def figures(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield
    plt.close("all")


def curves(ax):
    """Name -> values of the curves, without the faces' lines."""
    return {line.get_label(): np.array(line.get_ydata()) for line in ax.lines if len(line.get_xdata()) > 2}


# --- cuts -------------------------------------------------------------------------------------------------


def test_values_along_both_axes():
    """Of the planes and lines of the grid that are nearest, by name."""
    ds = make()
    along_x = curves(bp.plot.cut(ds, z=[0.0, 0.413]))
    np.testing.assert_allclose(along_x["z = 0 m"], abs(ds.p.sel(z=0.0, method="nearest")), rtol=1e-12)
    np.testing.assert_allclose(along_x["z = 0.42 m"], abs(ds.p.sel(z=0.42, method="nearest")), rtol=1e-12)
    along_z = curves(bp.plot.cut(ds, x=0.1, quantity="real", label="exact"))
    np.testing.assert_allclose(along_z["exact, x = 0.1 m"], ds.p.sel(x=0.1, method="nearest").real, rtol=1e-12)
    on_a_line = curves(bp.plot.cut(ds.isel(z=5), label="a"))
    np.testing.assert_allclose(on_a_line["a"], abs(ds.p[5]), rtol=1e-12)


def test_values_of_levels_and_phases():
    """A level is over the largest of all that is given; a phase has gaps where it jumps by a turn."""
    ds = make()
    (level,) = curves(bp.plot.cut(ds, z=0.4, quantity="dB")).values()
    largest = np.abs(ds.p.values).max()
    np.testing.assert_allclose(level, 20 * np.log10(np.abs(ds.p.sel(z=0.4, method="nearest")) / largest), atol=1e-9)
    (phase,) = curves(bp.plot.cut(ds, x=0.1, quantity="phase")).values()
    drawn = np.isfinite(phase)
    np.testing.assert_allclose(phase[drawn], np.angle(ds.p.sel(x=0.1, method="nearest"), deg=True)[drawn], rtol=1e-12)
    assert 0 < np.count_nonzero(~drawn) < 5
    assert np.all(np.abs(np.diff(phase)[np.isfinite(np.diff(phase))]) < 180)


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({}, "z, x: expected either of them, got neither"),
        ({"z": 0.0, "x": 0.0}, "z, x: expected either of them, got z and x"),
        ({"z": 3.0}, "z: expected positions from -0.1 to 0.5 m, got 3"),
        ({"x": np.linspace(0, 0.1, 9)}, "x: expected at most 8 curves, got 9"),
        ({"z": 0.0, "quantity": "p"}, "quantity: expected 'abs', 'real', 'phase', 'dB' or 'intensity', got 'p'"),
        ({"z": 0.0, "ax": 3}, "ax: expected Axes of matplotlib, got 3"),
    ],
)
def test_wrong_cuts_are_refused(wanted, said):
    with pytest.raises(ValueError, match=f"^{said}"):
        bp.plot.cut(make(), **wanted)
    with pytest.raises(ValueError, match=r"^z, x: expected none for a field on one axis, got z"):
        bp.plot.cut(make().isel(z=0), z=0.0)


@pytest.mark.parametrize("width", [88, 180])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_no_letter_of_a_cut_is_cut_or_overlaps(quantity, width, monkeypatch):
    ds = make(values=3e-7 * make().p.values, slab_thickness=0.3)
    for place in ({"z": np.linspace(0, 0.5, 8)}, {"x": [-0.1, 0.1]}):
        ax = bp.plot.cut(ds, **place, quantity=quantity, width=width)
        assert faults(ax.figure, monkeypatch) == []


# --- films ------------------------------------------------------------------------------------------------


def test_motion_is_that_of_the_time_convention():
    """Re(p exp(-i w t)), at even times of a period."""
    p, w, count = make().p.values, 2 * np.pi * 2500.0, 6
    times = np.arange(count) / count / 2500.0
    for t, frame in zip(times, motion(p, count), strict=True):
        np.testing.assert_allclose(frame, (p * np.exp(-1j * w * t)).real, atol=1e-12)


def test_frames_of_the_file():
    """Pixels of the GIF at points of the grid: the colours of Re(p exp(-i w t)), to what 256 colours hold."""
    ds = make(X[::6], Z[::3], values=make().p.values[::3, ::6])
    ax = bp.plot.animate(ds, "beam.gif", frames=4, limit=1.0)
    with Image.open("beam.gif") as film:
        assert film.info["duration"] == pytest.approx(1000 / 12, abs=10)
        assert film.info["loop"] == 0
        frames = [np.asarray(frame.convert("RGB"), float) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == 4
    colours = mpl.colormaps["cividis"]
    for index, shown in enumerate(frames):
        expected = (ds.p.values * np.exp(-2j * np.pi * index / 4)).real
        for i, j in ((2, 10), (5, 9), (8, 12)):
            across, up = ax.transData.transform((ds.z.values[i], ds.x.values[j])) * (150 / ax.figure.dpi)
            pixel = shown[shown.shape[0] - 1 - round(up), round(across)]
            np.testing.assert_allclose(pixel, 255 * np.array(colours((expected[i, j] + 1) / 2)[:3]), atol=12)


def test_films_tell_how_far_the_colours_go_at_any_time():
    ds = make()
    quarter = ds.assign(p=(ds.p * 1j).assign_attrs(ds.p.attrs))
    for turned in (ds, quarter):
        ax = bp.plot.animate(turned, "beam.gif", frames=2, limit=0.5)
        assert ax.get_title() == "values from −1 to 1 Pa"
        assert ax.collections[0].colorbar.extend == "both"


@pytest.mark.parametrize(
    ("path", "more", "said"),
    [
        ("a.mov", {}, "path: expected a name ending in .gif or .mp4, got 'a.mov'"),
        ("none/a.gif", {}, "path: expected a file in an existing folder, got 'none/a.gif'"),
        ("a.gif", {"frames": 1}, "frames: expected a whole number of at least 2, got 1"),
        ("a.gif", {"rate": 0}, "rate: expected a finite number above zero"),
        ("a.gif", {"limit": -1}, "limit: expected a finite number above zero"),
    ],
)
def test_wrong_films_are_refused(path, more, said):
    with pytest.raises(ValueError, match=f"^{said}"):
        bp.plot.animate(make(), path, **more)


def test_mp4_needs_ffmpeg(monkeypatch, tmp_path):
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(
        ValueError, match=r"^path: expected a name ending in .gif, for the program ffmpeg is not installed"
    ):
        bp.plot.animate(make(), "a.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="the program ffmpeg is not installed")
def test_mp4(tmp_path):
    bp.plot.animate(make(), "a.mp4", frames=3, width=91)
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"


def test_a_film_that_fails_leaves_nothing(monkeypatch, tmp_path):
    def broken(p, frames):
        yield p.real
        raise OSError("no space")

    monkeypatch.setattr(sys.modules["beamprop.plot.animate"], "motion", broken)
    (tmp_path / "a.gif").write_bytes(b"before")
    with pytest.raises(OSError, match="no space"):
        bp.plot.animate(make(), "a.gif", frames=3)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {"a.gif": b"before"}
