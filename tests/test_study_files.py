"""Study files: what they may hold, every mistake at a time, what they amount to, and what is predicted of them."""

import time
from types import SimpleNamespace

import numpy as np
import pytest
from source_tree import CHECKOUT
from study_texts import written, wrong

import beamprop as bp
from beamprop.study import files, predict

TWENTY = """
colour = 3
[question]
name = "beam_width"
frequncy = 2500
angle = "ten"
rtol = "x"
[slab]
perods = 3
periods = 0
eta = "1/0"
lossless = "maybe"
medium = "exakt"
background = "watr"
after = {model = "drud", densty = 3}
design_frequency = "2 parsecs"
[[slab.layer]]
material = "water"
thicknes = "2mm"
[[slab.layer]]
areal_density = [1]
[beam]
fwhm = "wide"
width_of = "power"
[sweep]
slab.layer.3.thickness = "1mm:2mm:3"
[output]
fil = "a.nc"
workers = 0
"""
#: Their paths, and what each message has to say.
SAID = {
    "colour": "got 3",
    "question.frequncy": "did you mean frequency?",
    "question.angle": "start:stop:count, got 'ten'",
    "question.rtol": "expected a number such as",
    "slab.perods": "got 3; did you mean periods?",
    "slab.periods": "expected a whole number of at least 1, got 0",
    "slab.eta": "got '1/0'",
    "slab.lossless": "expected True or False, got 'maybe'",
    "slab.medium": "expected 'exact', 'lmmd-emt'",
    "slab.background": "got 'watr'",
    "slab.after.model": "expected 'mass-law', 'drude'",
    "slab.after.densty": "did you mean density?",
    "slab.design_frequency": "2500 or 2.5kHz, got '2 parsecs'",
    "slab.layer.1.thicknes": "did you mean thickness?",
    "slab.layer.2.areal_density": "got [1]",
    "beam.fwhm": "0.002 or 2mm, got 'wide'",
    "beam.width_of": "expected 'pressure' or 'intensity', got 'power'",
    "sweep.slab.layer.3.thickness": "expected the path of a value in the file",
    "output.fil": "did you mean file?",
    "output.workers": "expected a whole number of at least 1, got 0",
}


def test_twenty_mistakes_give_twenty_messages(tmp_path):
    said = wrong(tmp_path, TWENTY)
    assert said.keys() == SAID.keys()
    assert len(said) == 20
    assert {path: text for path, text in SAID.items() if text not in said[path]} == {}
    assert all(text.startswith("expected ") and ", got " in text for text in said.values())


@pytest.mark.parametrize(
    ("text", "path", "message"),
    [
        ("", "question", "expected a table, got none"),
        ("question = 3", "question", "expected a table of names and values, got 3"),
        ("[question]", "question.name", "expected 'field' or 'beam_width' or"),
        ("[question", "TOML", "expected a file in its form, got: Expected"),
        ("[question]\nname = 'bloch'\n[beam]", "beam", "expected a name that a study has"),
        ("[question]\nname = 'field'\n[slab]\nlayer = 'air 1mm'", "question.frequency", "expected a frequency [Hz]"),
        ("[question]\nname = 'field'\n[slab]\nrho_m = 0.05", "slab.rho_m, delta_rho", "expected a passive medium"),
        (
            "[question]\nname = 'field'\n[slab]\nlayers = 'no.csv'",
            "slab.layers",
            "expected a CSV file that can be read",
        ),
        (
            "[question]\nname = 'field'\n[beam]\nslits = [1, 2]\nfwhm = 1",
            "beam.fwhm",
            "expected to be left out beside slits",
        ),
        (
            "[question]\nname = 'scattering'\nkx = 1\nangle = 1",
            "question.kx, angle",
            "expected exactly one of them, got 2",
        ),
        ("[question]\nname = 'field'\n[output]\nfile = 'a.xls'", "output.file", "expected a name ending in .nc or"),
        (
            "[question]\nname = 'field'\n[output]\nfile = 'no/a.nc'",
            "output.file",
            "expected a file in an existing folder",
        ),
        ("[question]\nname = 'field'\n[output]\nstore = 'a.zarr'", "output.store", "expected a sweep"),
        ("[question]\nname = 'field'\n[sweep]\n\"slab.ета\" = [1]", "sweep.slab.ета", "expected the path of a value"),
        ("[question]\nname = 'field'\n[sweep]\nslab.etaa = [1]", "sweep.slab.etaa", "did you mean slab.eta?"),
        ("[question]\nname = 'field'\n[sweep]\nslab.eta = []", "sweep.slab.eta", "expected a list, start:stop:count"),
        ("[question]\nname = 'field'\n[sweep]\nslab.eta = [1, 1]", "sweep.slab.eta", "expected values that differ"),
        ("[question]\nname = 'field'\n[sweep]\nslab.eta = '0:1:3:log'", "sweep.slab.eta", "start:stop:count, got"),
        ("[question]\nname = 'field'\n[sweep]\nslab.medium = ['exakt']", "sweep.slab.medium", "expected 'exact'"),
        (
            "[question]\nname = 'field'\nfrequency = 1\n[[slab.stack]]\nlayer = 'air 1mm'\n[[slab.stack]]\neta = -1",
            "slab.stack.2.eta",
            "expected a finite number above zero",
        ),
    ],
)
def test_a_mistake_has_its_path(text, path, message, tmp_path):
    said = wrong(tmp_path, text)
    assert list(said) == [path]
    assert message in said[path]


def test_the_answer_is_that_of_python(tmp_path):
    """Layers of three kinds, half-spaces, and axes at paths in each table: all points as calls give them."""
    (tmp_path / "layers.csv").write_text("material,thickness_mm\nacrylic,1\nwater,2\n")
    text = """
    [question]
    name = "scattering"
    frequency = ["100kHz", "0.2MHz"]
    angle = 10
    [slab]
    background = {density = 1000, sound_speed = "1500"}
    after = "acrylic"
    [[slab.stack]]
    layers = "layers.csv"
    periods = 2
    [[slab.stack]]
    layer = [{model = "drude", areal_density = 2, cutoff_frequency = "50kHz"}, "glycerol 1mm"]
    [sweep]
    "slab.stack.2.layer.1.areal_density" = [1.0, 2.0]
    slab.stack.1.periods = "1:3:2"
    """
    ds = files.read(written(tmp_path, text)).answer(workers=1)
    water = bp.Fluid.from_speed(1000.0, 1500.0)
    coated = bp.Slab.from_table(tmp_path / "layers.csv", 1).cell
    for density in (1.0, 2.0):
        for periods in (1, 3):
            sheet = bp.Cell([bp.Membrane.drude(density, 5e4), bp.Layer(bp.material("glycerol"), 1e-3)])
            slab = bp.Slab.stack([(coated, periods), (sheet, 1)], water, bp.material("acrylic"))
            expected = bp.scattering(slab, [1e5, 2e5], angle=10.0)
            point = ds.sel(stack_2_layer_1_areal_density=density, stack_1_periods=periods)
            np.testing.assert_array_equal(point.t, expected.t)
            assert bp.provenance(point)["slab"] == slab


def test_words_and_switches_are_axes(tmp_path):
    text = """
    [question]
    name = "scattering"
    angle = 0
    [slab]
    periods = 20
    [sweep]
    slab.lossless = [true, false]
    slab.medium = ["exact", "lmmd-emt"]
    question.frequency = "2kHz:3kHz:2:log"
    """
    ds = files.read(written(tmp_path, text)).answer(workers=1)
    assert ds.transmissivity.dims == ("lossless", "medium", "frequency")
    slab = bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(lossless=True), 20))
    expected = bp.scattering(slab, 3000.0, angle=0.0).transmissivity
    assert ds.transmissivity.sel(lossless="true", medium="lmmd-emt", frequency=3000.0) == expected


def test_random_copies_are_those_of_python(tmp_path):
    text = """
    question = {name = "scattering", frequency = 2500, angle = 0}
    slab = {periods = 5}
    tolerance = {thickness = 0.02, density = 0.01, seed = 3}
    sweep = {tolerance.sample = "0:3:4"}
    """
    ds = files.read(written(tmp_path, text)).answer(workers=1)
    copies = bp.tolerance(bp.Slab(bp.lmmd_cell(), 5), 0.02, 0.01, 4, 3)
    expected = [bp.scattering(copy, 2500.0, angle=0.0).t.item() for copy in copies]
    np.testing.assert_array_equal(ds.t, expected)
    assert len(set(expected)) == 4
    said = wrong(tmp_path, text.replace("0.02", "0.5").replace("0.01", "0.1"))
    assert said["tolerance.thickness"].startswith("expected a relative standard deviation")


# --- predictions ------------------------------------------------------------------------------------------------

MILLION = """
[question]
name = "scattering"
angle = 0
[slab]
periods = 20
[sweep]
slab.eta = "1/60:1/30:1000"
question.frequency = "2kHz:3kHz:1000"
[output]
store = "million.zarr"
"""


def test_a_million_points_are_predicted_from_a_few(tmp_path, monkeypatch):
    study, seen, ask = files.read(written(tmp_path, MILLION)), [], files.questions.ask
    monkeypatch.setattr(files.questions, "ask", lambda *args: seen.append(args) or ask(*args))
    cost = predict.predict(study)
    assert 0 < len(seen) < 100
    number, largest = cost.blocks
    assert cost.points == 10**6 <= number * largest < 1.1e6
    assert number > 10
    # r, t, four real numbers, two error estimates and two wavenumbers or more
    assert 100e6 < cost.file < 400e6
    assert cost.seconds > 10
    assert list(tmp_path.iterdir()) == [tmp_path / "study.toml"]


def test_a_million_points_are_checked_in_a_second(tmp_path):
    """By processor time, for other programs may run; a check measures for 0.2 s, and twice as much for the records."""
    path = written(tmp_path, MILLION)
    predict.predict(files.read(path))  # what is imported once
    start = time.process_time()
    predict.predict(files.read(path))
    assert time.process_time() - start < 1.0


def test_the_size_of_a_store_is_predicted(tmp_path):
    """The sum of its files, within a factor of two; the prediction itself writes nothing."""
    study = files.read(written(tmp_path, MILLION.replace("1000", "20")))
    cost = predict.predict(study)
    assert not (tmp_path / "million.zarr").exists()
    study.answer(workers=1)
    size = sum(path.stat().st_size for path in (tmp_path / "million.zarr").rglob("*") if path.is_file())
    assert size / 2 < cost.file < 2 * size


def test_what_does_not_fit_is_refused_with_its_cost(tmp_path, monkeypatch):
    """A million points in memory: more than is stated; block by block in a store they fit."""
    monkeypatch.setenv("BEAMPROP_MEMORY", "50M")
    with pytest.raises(
        files.Mistakes,
        match=r"output.store: expected .* 52.4 MB of memory, got 1000000 points .* MB, and .*; name a .zarr",
    ):
        predict.predict(files.read(written(tmp_path, MILLION.replace('store = "million.zarr"', ""))))
    assert predict.predict(files.read(written(tmp_path, MILLION))).held < 50e6


def test_the_time_of_a_long_question_is_measured_in_part(tmp_path, monkeypatch):
    """2000 frequencies: predicted from a part of them, exactly where each adds the same to a fixed time. By a clock of its own."""
    text = "[question]\nname = 'beam_width'\nfrequency = '2000:3000:2000'\n[slab]\nperiods = 20"
    study = files.read(written(tmp_path, text))
    ds = study.answer()
    clock, measured, ask = [0.0], [], predict.questions.ask

    def timed(description):
        measured.append(len(description["question"]["frequency"]))
        clock[0] += 3.0 + 0.25 * measured[-1]
        return ask(description)

    monkeypatch.setattr(predict.questions, "ask", timed)
    monkeypatch.setattr(predict, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    cost = predict.predict(study)
    assert sum(measured) < 100
    assert cost.seconds == pytest.approx(3.0 + 0.25 * 2000)
    assert cost.file == pytest.approx(ds.nbytes, rel=0.2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name = 'beam_measures'", "output.plot: expected an axis for frequency or angle, got one value"),
        (
            "name = 'scattering'\nangle = [0, 1]\n[output]\nquantity = 'p'",
            "output.quantity: expected 'transmissivity' or 'reflectivity'",
        ),
        (
            "name = 'scattering'\nangle = [0, 1]\n[output]\nalong = 'frequency'",
            "output.along: expected angle, got 'frequency'",
        ),
        ("name = 'field'\nfrequency = [1000, 2000]", "output.plot: expected one frequency and one angle"),
        (
            "name = 'beam_width'\nfrequency = 2500",
            "output.plot: expected an axis for frequency or angle, got one value",
        ),
        (
            "name = 'scattering'\nangle = '0:1:9'\n[sweep]\nslab.eta = '1/60:1/50:9'\nslab.periods = [1,2,3,4,5,6,7,8,9]",
            "output.plot: expected at most 8 curves or panels beside eta, got periods 9, angle 9",
        ),
        (
            "name = 'scattering'\nangle = 0\n[sweep]\nslab.eta = ['1/9', '1/8']\n[output]\nband = 'sample'",
            "output.band: expected eta, got 'sample'",
        ),
        (
            "name = 'scattering'\nangle = 0\n[sweep]\nslab.eta = ['1/9', '1/8']\n[output]\nquantity = 'q'",
            "output.quantity: expected r or t",
        ),
    ],
)
def test_a_picture_that_cannot_be_is_refused_before_the_work(text, message, tmp_path):
    text = text if "[output]" in text else text + "\n[output]"
    study = files.read(written(tmp_path, f"[question]\n{text}\nplot = 'a.png'"))
    with pytest.raises(files.Mistakes, match=message):
        predict.before(study)


def test_the_table_of_the_documentation_is_good(tmp_path):
    """What docs/study-files.md shows of a slab."""
    page = (CHECKOUT / "docs" / "study-files.md").read_text(encoding="utf-8")
    table = page.partition("```toml\n")[2].partition("```")[0]
    study = files.read(written(tmp_path, f"[question]\nname = 'scattering'\nfrequency = '1MHz'\nangle = 0\n{table}"))
    slab = bp.provenance(study.answer())["slab"]
    assert [periods for _, periods in slab.segments] == [4, 1]
    assert slab.before == bp.material("water")
    assert slab.after == bp.Fluid.from_speed(1100.0, 1600.0)
