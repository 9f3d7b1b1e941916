"""The studies of the gallery: every number that a page states is its own result, rounded as it stands there, and holds what it says."""

import ast
import importlib
import re
from functools import cache

import matplotlib.pyplot as plt
import pytest
from source_tree import CHECKOUT

GALLERY = CHECKOUT / "experiments" / "gallery"
#: The numbers of each page in the order of its text, by their names in the result of `study`.
STATED = {
    "lateral_shift": "layers thickness_m fwhm_cm frequency_hz largest_centroid_mm largest_angle straight_ray_m least_width_cm "
    "largest_width_cm wide_fwhm_cm wide_angle wide_centroid_mm stationary_phase_mm",
    "layers_per_cell": "multiple_0 multiple_1 multiple_2 multiple_3 multiple_4 fwhm_cm least_multiple_width_cm periods first last "
    "least_width_cm largest_width_cm pressure_ratio mean_density numerator mean_density inverse_density_12 twelve "
    "inverse_density_10 ten",
    "two_slits": "periods separation_mm frequency_hz between_41_percent shorter_periods between_20_percent air_mm air_width_mm "
    "half_wave_periods between_lossy_percent",
}
#: A number in a text, with its sign; none of a name such as kx2.
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")


@cache
def result_of(name):
    return importlib.import_module(name).study(quick=True)


def text_of(name):
    """The page's text below its title."""
    docstring = ast.get_docstring(ast.parse((GALLERY / f"{name}.py").read_text(encoding="utf-8")))
    title, underline, text = docstring.split("\n", 2)
    assert len(underline) >= len(title)
    assert set(underline) == {"="}
    return text


def rounded_as(text, value):
    """A value with the digits of a text."""
    mantissa, _, exponent = text.partition("e")
    digits = len(mantissa.partition(".")[2])
    return float(f"{value:.{digits}e}" if exponent else f"{value:.{digits}f}")


def test_every_study_is_held():
    """A script is a study with a row here, and the reverse."""
    scripts = {path.stem for path in GALLERY.glob("*.py")} - {"gallery_main"}
    assert scripts == set(STATED)


@pytest.mark.parametrize("name", STATED)
def test_numbers_of_a_page_are_its_results(name):
    """All of them, none left out: a finding that is not so fails here."""
    numbers, names = NUMBER.findall(text_of(name)), STATED[name].split()
    result = result_of(name)
    computed = [rounded_as(text, result[key]) for text, key in zip(numbers, names, strict=True)]
    assert dict(zip(names, computed, strict=True)) == dict(zip(names, map(float, numbers), strict=True))


@pytest.mark.parametrize("width", [88, 180])
@pytest.mark.parametrize("name", STATED)
def test_pictures_fit_their_paper(name, width):
    """Drawn at both widths, nothing is cut off at the figure's edge."""
    with plt.style.context("beamprop.plot.paper"):
        figure = importlib.import_module(name).picture(result_of(name), width)
        figure.draw_without_rendering()
        drawn, frame = figure.get_tightbbox().padded(-0.01), figure.bbox_inches
    assert frame.count_contains(drawn.corners()) == 4
    plt.close(figure)


# --- what the pages say of closed forms -------------------------------------------------------------------


def test_a_beam_leaves_where_it_entered():
    """Against the straight ray, and the small shift that is left against the stationary phase."""
    r = result_of("lateral_shift")
    assert 1e-3 * r["largest_centroid_mm"] < r["straight_ray_m"] / 1000
    assert r["wide_centroid_mm"] == pytest.approx(r["stationary_phase_mm"], rel=0.04)


def test_multiples_of_four_spread_the_beam():
    r = result_of("layers_per_cell")
    assert r["least_multiple_width_cm"] > 5 * r["largest_width_cm"]
    assert r["inverse_density_12"] == pytest.approx(r["closed_form_12"], rel=1e-5)


def test_two_slits_are_imaged_where_the_slab_is_half_a_wave():
    """Air against the Rayleigh-Sommerfeld integral; the resonance where the effective medium puts it."""
    r = result_of("two_slits")
    assert r["air_over_closed_form"] < 1e-5
    assert r["between_air_percent"] == pytest.approx(100, abs=1e-3)
    assert abs(r["half_wave_periods"] - r["periods"]) < 0.5
    gap = r["gaps"].no
    assert gap.idxmin() == r["periods"]
