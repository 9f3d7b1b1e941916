"""What the command takes and answers: layers and sources of the user's own, numbers, defaults by the wavelength, tables."""

import json
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from command import COMMAND, from_json, good
from versions import names

import beamprop as bp
from beamprop import parameters
from beamprop.cli import main

PROCESS = [sys.executable, "-c", COMMAND]
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
LAYERS = ["--layer", "density=1000 speed=1480 2mm", "--layer", "acrylic 5 mm", "--layer", "areal_density=0.3"]
OWN = [bp.Layer(WATER, 0.002), bp.Layer(bp.material("acrylic"), 0.005), bp.Membrane(0.3)]
IN_WATER = ["--density", "1000", "--sound-speed", "1480"]


def data(*arguments):
    record = json.loads(good(*arguments, "--json").stdout)
    return record["coords"] | record["data_vars"]


# --- layers and sources of the user's own -----------------------------------------------------------------


def test_layers_in_words():
    """--layer, repeated, from the near face on; one period unless --periods says otherwise; the spectrum of frequency."""
    for more, periods in ((), 1), (("--periods", "3"), 3):
        got = data("scattering", *LAYERS, *more, "--frequency", "10kHz,20kHz", "--angle", "0")
        want = bp.scattering(bp.Slab(OWN, periods), [1e4, 2e4], angle=0.0)
        np.testing.assert_allclose(from_json(got["t"]["data"]), want.t.values, rtol=1e-12)


@pytest.mark.parametrize(
    ("words", "layer"),
    [
        ("water 5mm", bp.Layer(bp.material("water"), 0.005)),
        ("Stainless steel 0.5 cm", bp.Layer(bp.material("stainless steel"), 0.005)),
        ("5mm air", bp.Layer(bp.material("air"), 0.005)),
        ("density=1000 speed=1480 attenuation=5 2mm", bp.Layer(bp.Fluid.from_speed(1000.0, 1480.0, 5.0), 0.002)),
        ("density=1000 speed=1480 2mm", bp.Layer(WATER, 0.002)),
        ("density=1000, sound_speed=1480, thickness=0.002", bp.Layer(WATER, 0.002)),
        ("rho=1000 c=1480 1/500", bp.Layer(WATER, 0.002)),
        ("density=2+0.1j bulk_modulus=1e5 3um", bp.Layer(bp.Fluid(2 + 0.1j, 1e5), 3e-6)),
        ("density=2 bulk_modulus=1e5 density_x=7 1km", bp.Layer(bp.Fluid(2, 1e5, 7), 1000.0)),
        ("areal_density=0.3", bp.Membrane(0.3)),
        ({"density": 1000, "sound_speed": 1480, "thickness": "2mm"}, bp.Layer(WATER, 0.002)),
    ],
)
def test_one_layer_in_words(words, layer):
    assert parameters.layer(words) == layer


def test_layers_of_a_file(tmp_path):
    """--layers reads a CSV file, as Slab.from_table does."""
    path = tmp_path / "lens.csv"
    path.write_text("thickness_mm,material,density,sound_speed\n2,acrylic,,\n0.2,,1250,1900\n")
    got = data("scattering", "--layers", path, "--background", "water", "--frequency", "1MHz", "--angle", "10")
    want = bp.scattering(bp.Slab.from_table(path, background=bp.material("water")), 1e6, angle=10.0)
    assert from_json(got["t"]["data"]) == pytest.approx(want.t.item(), rel=1e-12)


@pytest.mark.parametrize(
    ("options", "before", "after"),
    [
        (["--background", "water"], bp.material("water"), bp.material("water")),
        (["--after", "water"], bp.AIR, bp.material("water")),
        (
            ["--background", "water", "--after-density", "1.2", "--after-speed", "340"],
            bp.material("water"),
            bp.Fluid.from_speed(1.2, 340.0),
        ),
    ],
)
def test_half_spaces_by_material(options, before, after):
    got = data("scattering", *LAYERS, *options, "--frequency", "20kHz", "--angle", "0")
    want = bp.scattering(bp.Slab(OWN, before=before, after=after), 2e4, angle=0.0)
    assert from_json(got["t"]["data"]) == pytest.approx(want.t.item(), rel=1e-12)


def test_the_paper_s_cell_in_water():
    """--background is the fluid that the densities are relative to, and sets the wavelength."""
    got = data("scattering", "--background", "water", "--design-frequency", "1MHz", "--periods", "5", "--angle", "10")
    water = bp.material("water")
    slab = bp.Slab(bp.lmmd_cell(design_frequency=1e6, background=water), 5, background=water)
    assert from_json(got["t"]["data"]) == pytest.approx(bp.scattering(slab, 1e6, angle=10.0).t.item(), rel=1e-12)
    assert parameters.design({"background": "water"}, water).wavelength == pytest.approx(1482.38 / 2500, rel=1e-5)


def test_variables_of_a_field():
    """--variables: velocity, intensity and power, as in Python."""
    options = ["--periods", "5", "--x", "-0.1:0.1:5", "--z", "0,0.02", "--rtol", "1e-6"]
    got = data("field", *options, "--variables", "p, v_z,power_through")
    beam = bp.GaussianBeam(0.096, z0=-0.1)
    names = ["p", "v_z", "power_through"]
    want = bp.field(
        bp.Slab(bp.lmmd_cell(), 5), beam, 2500.0, np.linspace(-0.1, 0.1, 5), [0, 0.02], rtol=1e-6, variables=names
    )
    for name in names:
        np.testing.assert_allclose(from_json(got[name]["data"]), want[name].values, rtol=1e-12)
    assert "largest |v_z|" in good("field", *options, "--variables", "v_z").stdout


def test_bloch_of_layers():
    got = data("bloch", *LAYERS, "--frequency", "3000", "--kx-over-k0", "0,0.5")
    want = bp.bloch(bp.Cell(OWN), 3000.0, kx_over_k0=[0.0, 0.5])
    np.testing.assert_allclose(from_json(got["kz"]["data"]), want.kz.values, rtol=1e-12)


def test_slits():
    """--slits width,separation,count, with units."""
    got = data(
        "field", "--periods", "5", "--slits", "10mm,40mm,3", "--x", "-0.1:0.1:5", "--z", "0.02", "--rtol", "1e-6"
    )
    beam = bp.Slits(0.01, 0.04, 3, z0=-0.1)
    want = bp.field(bp.Slab(bp.lmmd_cell(), 5), beam, 2500.0, np.linspace(-0.1, 0.1, 5), 0.02, rtol=1e-6)
    np.testing.assert_allclose(from_json(got["p"]["data"]), want.p.values, rtol=1e-12)


def test_profile(tmp_path):
    """--profile reads a text file of columns."""
    x = np.linspace(-0.2, 0.2, 201)
    np.savetxt(tmp_path / "p.txt", np.column_stack([x, np.exp(-((x / 0.05) ** 2))]))
    got = data("beam_width", "--periods", "5", "--frequency", "2500", "--profile", tmp_path / "p.txt")
    beam = bp.Profile.from_file(tmp_path / "p.txt")
    want = bp.beam_width(bp.Slab(bp.lmmd_cell(), 5), beam, 2500.0)
    assert got["fwhm_out"]["data"] == pytest.approx(want.fwhm_out.item(), rel=1e-12)


@pytest.mark.parametrize(
    ("typed", "number"),
    [
        ("1/60", 1 / 60),
        ("2mm", 0.002),
        ("2 mm", 0.002),
        ("1/4cm", 0.0025),
        ("-3um", -3e-6),
        ("7", 7.0),
        ("1e-3km", 1.0),
    ],
)
def test_lengths(typed, number):
    """Fractions and units, to the last bit."""
    assert parameters.length(typed, "x") == number


def test_fractions_and_units_where_numbers_go():
    """Of the cell, of axes and of the beam."""
    got = data(
        "beam_width", "--periods", "5", "--eta", "1/40", "--fwhm", "96mm", "--frequency", "2.5kHz", "--angle", "90/9"
    )
    slab = bp.Slab(bp.lmmd_cell(eta=1 / 40), 5)
    want = bp.beam_width(slab, bp.GaussianBeam(0.096), 2500.0, angle=10.0)
    assert got["fwhm_out"]["data"] == pytest.approx(want.fwhm_out.item(), rel=1e-12)


# --- defaults ---------------------------------------------------------------------------------------------


def test_defaults_go_with_the_wavelength():
    """A slab in water at 1 MHz: beam, launch plane, positions and depths are as many wavelengths as in the paper."""
    ratio = (1480.0 / 1e6) / (343.0 / 2500.0)
    layers = ["--layer", "density=1200 speed=2000 1mm", *IN_WATER]
    got = data("field", *layers, "--frequency", "1MHz", "--rtol", "1e-6")
    x, z = np.array(got["x"]["data"]), np.array(got["z"]["data"])
    assert x[[0, -1]] == pytest.approx([-0.7 * ratio, 0.7 * ratio], rel=1e-12)
    assert z[[0, -1]] == pytest.approx([-0.1 * ratio, 0.001 + 2 * 1480e-6], rel=1e-12)
    width = data("beam_width", *layers, "--frequency", "1MHz")
    assert width["fwhm_launch"]["data"] == pytest.approx(0.096 * ratio, rel=1e-6)


def test_the_design_frequency_moves_the_question():
    """The paper's cell for 1 MHz in water is asked about 1 MHz."""
    options = ["--design-frequency", "1MHz", *IN_WATER, "--periods", "5"]
    assert data("scattering", *options, "--angle", "0")["frequency"]["data"] == 1e6
    frequency = data("beam_width", *options, "--rtol", "1e-6")["frequency"]["data"]
    assert (frequency[0], frequency[-1], len(frequency)) == (0.8e6, 1.2e6, 101)


def test_the_defaults_of_the_paper_are_the_paper():
    """To the last bit."""
    design = parameters.design({}, bp.AIR)
    assert design.scale == 1.0
    assert np.array_equal(design.band, parameters.axis("2000:3000:101", "frequency"))
    assert np.array_equal(design.x, parameters.axis("-0.7:0.7:561", "x"))
    assert parameters.beam({}, design.scale) == bp.GaussianBeam(0.096)


def test_a_question_far_from_the_paper_s_design_is_told_so():
    """A hint; none at frequencies near it, with a frequency of one's own, or with layers."""
    far = ["scattering", "--periods", "5", "--angle", "0", "--frequency", "1MHz"]
    assert (
        "warning: --design-frequency: the cell is the paper's, designed for 2500 Hz; give one near 1e+06 Hz"
        in good(*far).stderr
    )
    for options in (
        [*far, "--design-frequency", "1MHz"],
        [*far[:-1], "250:25000:3"],
        ["scattering", *LAYERS, *far[3:]],
    ):
        assert "design" not in good(*options).stderr


# --- answers ----------------------------------------------------------------------------------------------


def test_two_axes_make_a_table_each():
    """Rows by the first axis, columns by the last; the numbers are those of the call."""
    out = good("scattering", "--periods", "5", "--frequency", "2000,2500", "--angle", "0,30,60").stdout
    first = out.split("\n\n")[0].splitlines()
    assert first[0] == "transmissivity"
    assert first[1].split() == ["frequency", "angle", "0", "angle", "30", "angle", "60"]
    want = bp.scattering(bp.Slab(bp.lmmd_cell(), 5), [2000.0, 2500.0], angle=[0.0, 30.0, 60.0]).transmissivity
    got = [[float(v) for v in line.split()[1:]] for line in first[2:]]
    np.testing.assert_allclose(got, want, rtol=1e-5)
    assert [part.splitlines()[0] for part in out.split("\n\n")[1:]] == [
        "reflectivity",
        "energy_transmission",
        "absorption",
    ]


def test_the_frequency_of_an_answer_is_said():
    assert good("scattering", "--periods", "5", "--angle", "0").stdout.startswith("frequency 2500 Hz, angle 0 degree\n")


def test_spectra_by_frequency_are_drawn(tmp_path):
    good("scattering", *LAYERS, "--frequency", "1kHz:9kHz:5", "--angle", "0", "--plot", tmp_path / "a.png", "--quiet")
    assert names(tmp_path) == ["a.png"]


def test_an_answer_that_cannot_be_drawn_is_not_written(tmp_path, monkeypatch):
    """The picture comes first: where it fails, there is no file."""
    monkeypatch.setattr(
        "beamprop.plot.bloch", lambda ds, **_o: (_ for _ in ()).throw(ValueError("ds: expected what is not there"))
    )
    arguments = ["bloch", "--kx-over-k0", "0,1", "-o", str(tmp_path / "a.nc"), "-p", str(tmp_path / "a.png")]
    assert CliRunner().invoke(main, arguments).exit_code == 2
    assert names(tmp_path) == []


@pytest.mark.parametrize("option", ["--output=a.nc", "--plot=a.png"])
def test_an_empty_folder_is_not_replaced_by_a_file(option, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / option.partition("=")[2]
    folder.mkdir()
    result = CliRunner().invoke(main, ["bloch", option])
    assert result.exit_code == 2
    assert f"{option.partition('=')[0]}: expected a file or a new name, got a folder: '{folder.name}'" in result.stderr
    assert folder.is_dir()


def test_what_is_read_is_not_overwritten(tmp_path):
    path = tmp_path / "lens.csv"
    path.write_text("thickness_mm,material\n2,acrylic\n")
    options = ["--layers", str(path), "--frequency", "1MHz", "--angle", "0:10:3", "--output", str(path)]
    result = CliRunner().invoke(main, ["scattering", *options])
    assert result.exit_code == 2
    assert f"--output: expected a file other than that of --layers, got '{path}'" in result.stderr
    assert path.read_text().endswith("acrylic\n")


def test_what_is_compared_is_not_overwritten(tmp_path):
    bp.save(bp.field(bp.Slab(OWN), bp.GaussianBeam(0.05), 2500.0, [0.0, 0.1], [0.0, 0.1]), tmp_path / "a.nc")
    before = (tmp_path / "a.nc").read_bytes()
    path = str(tmp_path / "a.nc")
    result = CliRunner().invoke(main, ["compare", path, path, "-o", path])
    assert result.exit_code == 2
    assert f"--output: expected a file other than those compared, got '{path}'" in result.stderr
    assert (tmp_path / "a.nc").read_bytes() == before
    assert "relative L2 error    0.0000e+00\n" in good("compare", path, path, "--tolerance", "0").stdout
