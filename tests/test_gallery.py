"""The studies of the gallery: every number that a page states is its own result, rounded as it stands there, and holds what it says."""

import ast
import importlib
import re
import runpy
import sys

import matplotlib.pyplot as plt
import numpy as np
import pytest
from gallery_results import GALLERY, result_of

import beamprop as bp

#: The numbers of each page in the order of its text, by their names in the result of `study`.
STATED = {
    "lateral_shift": "layers thickness_m fwhm_cm frequency_hz largest_centroid_mm largest_angle straight_ray_m least_width_cm "
    "largest_width_cm wide_fwhm_cm wide_angle wide_centroid_mm stationary_phase_mm",
    "layers_per_cell": "multiple_0 multiple_1 multiple_2 multiple_3 multiple_4 fwhm_cm least_multiple_width_cm periods first last "
    "least_width_cm largest_width_cm pressure_ratio mean_density inverse_density_12 spreading inverse_density_10 guiding",
    "two_slits": "periods separation_mm frequency_hz between_41_percent shorter_periods between_20_percent air_mm air_width_mm "
    "half_wave_periods between_lossy_percent",
    "fabrication": "deviation_percent periods phase_rad copies fwhm_cm width_spread_cm perfect_width_cm largest_density mean_density "
    "layers mean_error effective_phase_rad",
    "effective_media": "first last without_median_percent with_median_percent without_worst_percent with_worst_percent "
    "standard_median_percent",
    "goos_haenchen": "critical_angle frequency_khz wide wide_beyond angle_beyond artmann_beyond wide_critical narrow_critical narrow",
    "superlens": "sign limit_0.01 loss limit_0.1 loss_high pendry_0.01 pendry_0.1 between_0.001_percent loss_low between_0.1_percent "
    "loss_high",
    "fabry_perot": "periods maxima least_khz largest_khz peak_hz predicted_hz order fwhm_cm least_width_cm largest_width_cm "
    "lossy_percent design_khz least_lossy_cm largest_lossy_cm",
    "designed_profile": "mean paper_mean fwhm_cm periods paper_distortion_percent designed_distortion_percent least_khz largest_khz "
    "paper_width_change_percent designed_width_change_percent paper_density design_khz designed_density matched",
    "matching_layers": "centre_mhz none_percent ceramic_mrayl one_half_mhz closed_form_mhz two_half_mhz share_percent one_80_mhz "
    "two_80_mhz",
    "defect_state": "centre_mhz gap_mhz closed_form_gap_mhz periods peak_percent centre_mhz quality most_pairs sharpening "
    "pairs_before impedance_ratio_squared",
    "schoch": "angle mhz shift displacement_mm null null_at formula_shift error farther error_aluminium",
    "lattice": "periods steel_mm water_mm fwhm_mm khz lattice_mm angle water_fwhm_mm ray ray_mm peak peak_mm",
    "brass_plate": "waves thickness_mm frequencies least_mhz most_mhz apart end height mhz backward below leaky decibel",
    "plate": "mm mhz angle t_percent half_width_mm power_percent peak reflected_percent wide_mm wide_percent",
    "double_wall": "leaf_kg depth_cm resonance_hz formula_hz oblique_hz oblique_angle at_hz double_db single_db half_wave_hz "
    "half_wave_db wool_db",
    "transcranial": "khz BM1_kpa BM1_mm bone_mm BM3_kpa BM3_mm length_mm width_mm BM4_kpa BM4_mm profile_mm piston_BM1_kpa "
    "piston_BM3_kpa piston_BM4_kpa",
    "round_beams": "fwhm_cm first_khz last_khz least_lossless_round_cm largest_lossless_round_cm least_lossy_round_cm "
    "largest_lossy_round_cm least_air_cm largest_air_cm angle_45 least_lossy_x_cm largest_lossy_x_cm largest_lossless_x_cm angle_0 "
    "angle_45 angle_85 lossless_along_percent lossless_across_percent lossy_along_percent lossy_across_percent lossless_flat_percent "
    "lossy_flat_percent way_m air_growth",
}
#: A number in a text, with its sign; none of a name such as kx2.
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w])")


def text_of(name):
    """The page's text below its title."""
    docstring = ast.get_docstring(ast.parse((GALLERY / f"{name}.py").read_text(encoding="utf-8")))
    title, underline, text = docstring.split("\n", 2)
    assert len(underline) >= len(title)
    assert set(underline) == {"="}
    assert len(re.findall(r"\.(?=\s|$)", text)) == 2, "a finding has two sentences"
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


def test_a_number_that_is_not_so_is_seen():
    """By its last digit, with its sign, in either form."""
    assert [rounded_as(*case) for case in (("0.013", 0.01349), ("-2", -2.4), ("3.0e-4", 2.96e-4))] == [0.013, -2, 3e-4]
    assert rounded_as("0.013", 0.01351) != 0.013
    assert NUMBER.findall("of 9.6 cm, -1 and 3e-4, kx2 at 80.") == ["9.6", "-1", "3e-4", "80"]


def test_a_script_prints_and_writes(tmp_path, monkeypatch, capsys):
    """As a user runs it: numbers, a picture, and data that `load` reads."""
    monkeypatch.setattr(
        sys, "argv", ["matching_layers.py", "--quick", "--width", "88", "--output", str(tmp_path / "out")]
    )
    runpy.run_path(str(GALLERY / "matching_layers.py"), run_name="__main__")
    assert "two_half_mhz = 0.93\n" in capsys.readouterr().out
    assert plt.imread(tmp_path / "out" / "matching_layers.png").shape[1] == pytest.approx(88 / 25.4 * 300, abs=1)
    assert bp.load(tmp_path / "out" / "matching_layers_shares.nc").sizes == {"frequency": 1601}
    plt.close("all")


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


def test_phases_spread_as_the_effective_medium_says():
    """Forty copies know their rms to 11 %."""
    r = result_of("fabrication")
    assert r["phase_rad"] == pytest.approx(r["effective_phase_rad"], rel=0.25)


def test_the_interface_term_mends_the_effective_medium():
    """At every number of periods, by half or more."""
    errors = result_of("effective_media")["errors"]
    assert bool((errors["with"] < errors["without"] / 2).all())
    assert bool((errors["without"] < 0.2).all())


def test_a_beam_is_shifted_as_artmann_says():
    r = result_of("goos_haenchen")
    assert r["wide_beyond"] == pytest.approx(r["artmann_beyond"], rel=0.01)
    assert r["narrow_critical"] < r["wide_critical"] < 6


def test_a_beam_is_shifted_as_a_sum_of_plane_waves_is():
    """At the critical angle, where Artmann's formula is infinite: the centroid of a plain sum over kx."""
    import goos_haenchen as shift

    k0, width = 2 * np.pi, 100.0  # lengths in wavelengths
    kx = k0 * np.sin(np.radians(shift.CRITICAL))
    k = np.linspace(kx - 0.2, min(kx + 0.2, k0), 4001)
    inside = np.emath.sqrt((k0 * np.sin(np.radians(shift.CRITICAL))) ** 2 - k**2 + 0j)
    front = 1900.0 / shift.WATER.at(shift.FREQUENCY).rho_z.real * np.sqrt(k0**2 - k**2)
    waves = np.exp(-((k - kx) ** 2) * width**2 / (16 * np.log(2))) * (front - inside) / (front + inside)
    x = np.linspace(-200, 350, 1101)  # the head wave trails behind
    p = np.array([abs(np.trapezoid(waves * np.exp(1j * k * place), k)) for place in x])
    bright = p > 0.01 * p.max()
    centroid = (x * p**2)[bright].sum() / (p**2)[bright].sum()
    assert result_of("goos_haenchen")["wide_critical"] == pytest.approx(centroid, rel=2e-3)


def lens_transmission(kx, k0, loss, thickness):
    """p behind a lens over p in front, from the sums of waves in three layers: nothing of the package."""
    outside, inside = (np.emath.sqrt(k2 - kx**2 + 0j) for k2 in (k0**2, k0**2 * (-1 + 1j * loss) / (-1 - 1j * loss)))
    inside = np.where(inside.imag < 0, -inside, inside)
    ratio = outside * (-1 + 1j * loss) / inside
    step = np.exp(1j * inside * thickness)
    return 4 * ratio * step / ((1 + ratio) ** 2 - (1 - ratio) ** 2 * step**2)


def test_the_lens_images_two_slits():
    """The pressure between the images against a plain Fourier integral over kx; the transfer against Pendry's limit."""
    import superlens as lens

    r, k0 = result_of("superlens"), 2 * np.pi / lens.WAVELENGTH
    kx = np.linspace(0, 30 * k0, 60001)
    for loss in (0.1, 0.01):
        t = lens_transmission(kx, k0, loss, lens.THICKNESS) * np.exp(
            1j * np.emath.sqrt(k0**2 - kx**2 + 0j) * lens.THICKNESS
        )
        spectrum = np.sinc(kx * lens.APART / 20 / np.pi) * np.cos(kx * lens.APART / 2)
        x = r["images"].x.values
        p = np.abs([np.trapezoid(t * spectrum * np.cos(kx * place), kx) for place in x])
        between = 100 * p[x.size // 2] / p.max()
        assert r[f"between_{loss:g}_percent"] == pytest.approx(between, abs=0.05)
        assert r[f"limit_{loss:g}"] == pytest.approx(r[f"pendry_{loss:g}"], rel=0.02)
    assert r["between_lens_percent"] == pytest.approx(100, abs=1e-3)


def test_transmission_has_its_maxima_at_whole_half_waves():
    """To a hertz, within which the frequencies of the curve lie."""
    r = result_of("fabry_perot")
    assert r["largest_difference_hz"] < 1
    assert r["least_maximum"] == pytest.approx(1, abs=1e-4)


def test_the_design_distorts_less():
    """Less than half the distortion and change of width, by a slab that is nearer to matched."""
    r = result_of("designed_profile")
    for name in ("distortion_percent", "width_change_percent"):
        assert r[f"designed_{name}"] < r[f"paper_{name}"] / 2
    assert abs(r["designed_density"] - 1) < abs(r["paper_density"] - 1)


def test_one_quarter_wave_layer_has_the_band_of_its_closed_form():
    r = result_of("matching_layers")
    assert r["one_half_mhz"] == pytest.approx(r["closed_form_mhz"], abs=2e-3)
    assert r["one_centre_percent"] == pytest.approx(100)


def test_the_gap_and_its_defect_follow_the_impedances():
    r = result_of("defect_state")
    assert r["gap_mhz"] == pytest.approx(r["closed_form_gap_mhz"], abs=1e-3)
    assert r["sharpening"] == pytest.approx(r["impedance_ratio_squared"], rel=1e-3)


def test_the_double_wall_follows_its_closed_form():
    """At every frequency of the curve; the single leaf follows the mass law."""
    r = result_of("double_wall")
    assert r["largest_difference_db"] < 1e-6
    assert r["single_db"] == pytest.approx(r["mass_law_db"], abs=1e-9)
    assert max(r["resonance_db"], r["oblique_db"], r["half_wave_db"]) < 1e-6


def test_a_beam_is_displaced_by_a_leaky_rayleigh_wave():
    """Exact and by the pole alone; Schoch's displacement itself by the free solid's Rayleigh wave is 60.21 wavelengths."""
    r = result_of("schoch")
    wavelengths = 1e-3 * r["displacement_mm"] * 3e6 / 1480
    assert wavelengths == pytest.approx(60.21, rel=2e-3)
    assert r["shift"] == pytest.approx(r["formula_shift"], rel=3e-3)


def test_a_narrow_beam_does_not_pass_a_plate_as_a_plane_wave():
    """What is not transmitted is reflected, and wide beams approach |t|^2."""
    r = result_of("plate")
    assert r["power_percent"] + r["reflected_percent"] == pytest.approx(100, abs=1e-6)
    shares = r["shares"].transmitted
    assert bool((shares.diff("half_width") > 0).all())
    assert float(shares.max()) < 1e-4 * r["t_percent"] ** 2
