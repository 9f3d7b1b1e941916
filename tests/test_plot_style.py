"""The style of the pictures: sizes, colours, units, and text that stays text."""

import itertools
import re
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from source_tree import CHECKOUT

from beamprop.plot import QUANTITIES, style, units
from beamprop.plot.quantities import drawn

mpl.use("agg")


@pytest.fixture(autouse=True)
def figures():
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


@pytest.mark.parametrize("width", [88, 180.0])
def test_figures_are_as_wide_as_columns(width):
    with style.drawing(None, width) as ax:
        ax.plot([0, 1], label="a")
        ax.legend()
        ax.set(xlabel="x", title="t")
    assert ax.figure.get_figwidth() * 25.4 == pytest.approx(width)
    texts = [*ax.get_xticklabels(), *ax.get_legend().get_texts(), ax.xaxis.label, ax.title]
    assert {text.get_fontsize() for text in texts} == {7}


def test_a_figure_of_another_style_keeps_its_own():
    import matplotlib.pyplot as plt

    own = plt.figure().add_subplot()
    with style.drawing(own, 88.0) as ax:
        assert ax is own
        assert mpl.rcParams["font.size"] == 10
    with style.drawing(None, 88.0) as ax:
        pass
    with style.drawing(ax, 88.0):
        assert mpl.rcParams["font.size"] == 7
    assert mpl.rcParams["font.size"] == 10


@pytest.mark.parametrize(
    ("width", "said"),
    [(0, "a finite number above zero"), (5, "at least 40 mm, got 5"), (1e6, "at most 2000 mm, got 1e"), ("a", "")],
)
def test_widths_that_hold_no_labels_are_refused(width, said):
    with pytest.raises(ValueError, match=f"^width: expected {said}"):
        style.new_figure(width)
    with pytest.raises(ValueError, match=r"^ax: expected Axes of matplotlib, got 3"):
        style.drawing(3, 88.0).__enter__()


def test_vector_pictures_hold_text(tmp_path):
    """Written outside of the style's context: letters of the SVG are text elements, fonts of the PDF are TrueType, not shapes."""
    with style.drawing(None, 88.0) as ax:
        ax.set_xlabel("depth of a slab")
    for name in ("a.svg", "a.pdf"):
        ax.figure.savefig(tmp_path / name)
    assert re.search(r"<text[^>]*>depth of a slab</text>", (tmp_path / "a.svg").read_text(encoding="utf-8"))
    pdf = (tmp_path / "a.pdf").read_bytes()
    assert b"/Type3" not in pdf
    assert b"/FontFile2" in pdf


def lightness(color):
    """CIE L* of an sRGB colour, 0 to 100."""
    rgb = np.array(mpl.colors.to_rgb(color))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    y = linear @ [0.2126, 0.7152, 0.0722]
    return 116 * np.cbrt(y) - 16 if y > 0.008856 else 903.3 * y


def test_curves_differ_in_grey():
    """Every two of eight curves differ in dashes, or by 15 of 100 in lightness; the lightest is 22 below white paper."""
    curves = list(style.settings()["axes.prop_cycle"])
    assert len({curve["color"] for curve in curves}) == 8
    for a, b in itertools.combinations(curves, 2):
        apart = abs(lightness(a["color"]) - lightness(b["color"]))
        assert a["linestyle"] != b["linestyle"] or apart >= 15, (a, b)
    assert max(lightness(curve["color"]) for curve in curves) < 78


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_maps_are_read_in_grey(quantity):
    """Their lightness rises from end to end; of the phase, which has no ends, it is that of both ends, and far from it half a turn off."""
    p = xr.DataArray([1.0, 1j], dims="x")
    colours = mpl.colormaps[drawn((p,), quantity).cmap](np.linspace(0, 1, 65))
    steps = np.diff([lightness(colour) for colour in colours])
    if quantity == "phase":
        assert lightness(colours[0]) == pytest.approx(lightness(colours[-1]), abs=1)
        assert lightness(colours[0]) - lightness(colours[32]) > 60
    else:
        assert np.all(steps > 0)
        assert steps.sum() > 70


@pytest.mark.parametrize(
    ("unit", "values", "expected"),
    [
        ("m", [-0.1, 0.5], ("m", 1.0)),
        ("m", [0.0999], ("mm", 1e3)),
        ("m", 2e-5, ("µm", 1e6)),
        ("m", [0.0, np.nan], ("m", 1.0)),
        ("Hz", 2500.0, ("Hz", 1.0)),
        ("Hz", [1e4, 9e5], ("kHz", 1e-3)),
        ("Hz", 1e6, ("MHz", 1e-6)),
        ("degree", 1e9, ("°", 1.0)),
        ("Pa", 3e-9, ("10⁻⁹ Pa", 1e9)),
        ("Pa²", 2e4, ("10³ Pa²", 1e-3)),
        ("W/m^2", 0.5, ("W/m²", 1.0)),
    ],
)
def test_units_by_size(unit, values, expected):
    assert units.scale(unit, values) == expected


def test_the_style_file_is_in_the_wheel(tmp_path):
    """The file lies inside the package that the wheel takes, and git knows it: the wheel holds what git does not ignore."""
    command = ["git", "ls-files", "beamprop/plot"]
    known = subprocess.run(command, cwd=CHECKOUT, capture_output=True, text=True, check=True).stdout
    assert "beamprop/plot/paper.mplstyle" in known
    code = "import matplotlib.style as s; s.use('beamprop.plot.paper'); import matplotlib; print(matplotlib.rcParams['font.size'])"
    done = subprocess.run([sys.executable, "-c", code], cwd=CHECKOUT, capture_output=True, text=True, check=True)
    assert done.stdout == "7.0\n"
