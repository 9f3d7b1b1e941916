"""The pictures of the command: every question, every ending, the axis and the size that are asked for."""

import matplotlib as mpl
import pytest
from command import good, run
from matplotlib.image import imread

import beamprop as bp
from beamprop import parameters
from beamprop.plot import style

mpl.use("agg")
P = ["--periods", "5", "--lossless"]
#: A line of every question, and what its picture says of its axes.
LINES = {
    "beam_width --angle 0,20 --frequency 2500": ("angle [°]", "full width at half maximum [cm]"),
    "beam_measures --angle 0,20,40 --rtol 1e-4 --quantity power": ("angle [°]", "share of the launched"),
    "scattering --frequency 500:5000:9 --angle 0": ("frequency [Hz]", "transmissivity |t|²"),
    "scattering --frequency 2000:3000:3 --kx-over-k0 0:2:5 --along frequency": ("frequency [Hz]", "= 0.5"),
    "guided_modes": ("Re ", "Im "),
}


@pytest.mark.parametrize("line", LINES)
def test_every_question_is_drawn(line, tmp_path):
    """Real text in the .svg tells what is on the axes; a .pdf and a .png come from the same line."""
    command, *options = line.split()
    said = good(command, *P, *options, "--plot", tmp_path / "a.svg").stdout
    assert f"wrote {tmp_path / 'a.svg'}" in said
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "<text" in text
    for words in LINES[line]:
        assert words in text


def test_bands_against_frequency_are_drawn(tmp_path):
    good("bloch", "--kx-over-k0", "0", "--frequency", "100:5000:50", "--plot", tmp_path / "a.pdf")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(("width", "pixels"), [("88", 1039), ("180", 2126)])
def test_a_picture_is_as_wide_as_it_is_asked_for(width, pixels, tmp_path):
    """At 300 dots an inch."""
    good("scattering", *P, "--angle", "0:60:7", "--plot", tmp_path / "a.png", "--plot-width", width)
    assert imread(tmp_path / "a.png").shape[1] == pytest.approx(pixels, abs=1)


@pytest.mark.parametrize("question", parameters.QUANTITIES)
def test_the_quantities_of_the_command_are_those_of_the_pictures(question):
    """The first is the default, and another word is refused by both."""
    ds = {
        "field": lambda: bp.field(bp.Slab.interface(), bp.GaussianBeam(0.1), 2500.0, [0.0, 0.1], [0.0, 0.1]),
        "scattering": lambda: bp.scattering(bp.Slab.interface(), 2500.0, angle=[0.0, 10.0]),
        "beam_measures": lambda: bp.beam_measures(
            bp.Slab(bp.lmmd_cell(), 2), bp.GaussianBeam(0.1), 2500.0, [0.0, 9.0], window=1.0
        ),
    }[question]()
    draw = {"field": bp.plot.field, "scattering": bp.plot.scattering, "beam_measures": bp.plot.sweep}[question]
    for quantity in parameters.QUANTITIES[question]:
        assert draw(ds, quantity) is not None
        mpl.pyplot.close("all")
    with pytest.raises(ValueError, match="expected"):
        draw(ds, "colour")
    assert run(question, "--quantity", "colour").exit_code == 2


def test_the_narrowest_and_the_widest_picture_are_those_of_the_style():
    assert (parameters.pictures.NARROWEST, parameters.pictures.WIDEST) == (style.NARROWEST, style.WIDEST)


TOLERANCE = """
[question]
name = "scattering"
angle = 0
[slab]
periods = 5
[tolerance]
thickness = 0.02
[sweep]
tolerance.sample = "0:8:9"
question.frequency = "2kHz:3kHz:5"
[output]
plot = "a.svg"
quantity = "transmissivity"
band = "sample"
"""


def test_the_picture_of_a_study_has_a_band(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s.toml").write_text(TOLERANCE)
    good("check", "s.toml")
    good("run", "s.toml", "--workers", "1")
    text = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert "5th to 95th percentile" in text
    assert "frequency [Hz]" in text


def test_panels_are_written(tmp_path, monkeypatch):
    """An array of Axes has one figure."""
    monkeypatch.chdir(tmp_path)
    options = ["--frequency", "2000:3000:3", "--angle", "0:40:4", "--rtol", "1e-4"]
    good("beam_width", *P, *options, "--plot", "a.svg", "--save-study", "s.toml")
    first = (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert all(f">{angle}</text>" in first for angle in ("0°", "13.33°", "26.67°", "40°"))
    (tmp_path / "a.svg").unlink()
    good("run", "s.toml")
    assert ">13.33°</text>" in (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_options_of_a_picture_without_one_are_told(tmp_path):
    """The answer is printed as ever."""
    line = ["scattering", *P, "--angle", "0"]
    plain, told = good(*line), good(*line, "--quantity", "absorption", "--plot-width", "88")
    assert told.stdout == plain.stdout
    assert plain.stderr == ""
    assert told.stderr == "warning: --quantity, --plot-width: of a picture, and there is no --plot: nothing is drawn\n"


def test_measures_are_drawn_against_the_angle_by_default(tmp_path, monkeypatch):
    """And the study that is saved beside the picture draws the same."""
    monkeypatch.chdir(tmp_path)
    good(
        "beam_measures",
        *P,
        "--rtol",
        "1e-4",
        "--window",
        "1",
        "--plot",
        "a.svg",
        "--save-study",
        "s.toml",
        "-o",
        "a.nc",
    )
    with bp.load("a.nc") as ds:
        assert ds.angle.values.tolist() == [5.0 * i for i in range(13)]
    assert "angle [°]" in (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert 'angle = "0:60:13"' in (tmp_path / "s.toml").read_text()
    assert run("beam_measures", *P, "--angle", "30", "--plot", "b.svg").exit_code == 2
