"""What the explorer answers is what the questions answer, and what it hands out asks the same again."""

import json
import shlex
import struct
import subprocess
import sys

import numpy as np
import pytest
from command import COMMAND

import beamprop as bp
from beamprop.explorer import cost, downloads, equivalents, panels, state, stored
from beamprop.explorer.controls import board
from beamprop.study import files, questions

# steel as a fluid is meant: its effective media are known, and the numbers compared are those of the same media
pytestmark = pytest.mark.filterwarnings("ignore:slab. steel is taken as a fluid:beamprop.HintWarning")

STACK = """
[question]
name = "field"
frequency = "100kHz"
[slab]
background = "water"
after = {density = 1100, sound_speed = "1600"}
[[slab.stack]]
layer = ["steel 1mm", "water 2mm"]
periods = 4
[[slab.stack]]
layer = [{model = "power-law", density = 1060, sound_speed = 1595, attenuation_db_per_cm = 0.5, reference_frequency = "1MHz", thickness = "5mm"}]
"""
OWN = """
[question]
name = "field"
frequency = "50kHz"
angle = 15
[slab]
density = 1000
sound_speed = 1480
layer = ["steel 1mm", {density = 1000, sound_speed = 1500, attenuation = 0.2, thickness = "2mm"}, "areal_density=0.3"]
periods = 5
after_density = 900
[beam]
slits = "5mm,20mm"
"""
COPIES = """
[question]
name = "beam_width"
[slab]
periods = 20
[tolerance]
thickness = 0.01
seed = 3
[sweep]
tolerance.sample = [0, 4]
slab.eta = "0.01:0.03:3"
"""


def board_of(folder, text):
    if not text:
        return board()
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return board(files.read(folder / "study.toml"))


def unpacked(answer):
    """The JSON and the arrays of an answer."""
    size = struct.unpack("<I", answer[:4])[0]
    meta, at = json.loads(answer[4 : 4 + size]), 4 + size
    for name, shape in meta["arrays"]:
        meta[name] = np.frombuffer(answer, "<f4", int(np.prod(shape)), at).reshape(shape)
        at += meta[name].nbytes
    assert at == len(answer)
    return meta


# --- answers ------------------------------------------------------------------------------------------------


def test_the_map_is_that_of_field():
    """On cell faces, from behind the launch plane to behind the slab, in single precision."""
    drawn = unpacked(panels.answer(board(), "field", {"question.angle": 30.0, "slab.periods": 100, "beam.z0": -0.1}))
    slab = bp.Slab(bp.lmmd_cell(), 100)
    in_cells = drawn["z"].astype(float) / slab.cell.thickness
    np.testing.assert_allclose(in_cells, in_cells.round(), atol=1e-4)
    z = in_cells.round() * slab.cell.thickness
    ds = bp.field(slab, bp.GaussianBeam(0.096, 30.0, z0=-0.1), 2500.0, np.linspace(-0.7, 0.7, 400), z)
    np.testing.assert_allclose(drawn["re"] + 1j * drawn["im"], ds.p.transpose("x", "z").values, atol=2e-7)
    assert -0.1 < drawn["z"][0] <= -0.1 + slab.cell.thickness
    assert drawn["z"][-1] >= slab.thickness + 0.1372
    assert drawn["thickness"] == pytest.approx(slab.thickness, rel=1e-12)


def test_faces_are_whole_cells_apart_where_cells_are_thin():
    """Of 450 periods every second one."""
    made = board()
    described = state.description(made, state.values_of(made, {}), "field")
    z = questions.field_arguments(described)["z"]
    steps = np.diff(z) / bp.lmmd_cell().thickness
    np.testing.assert_allclose(steps, 2.0, rtol=1e-9)
    assert np.abs(z).min() < 1e-12


def test_curves_are_those_of_the_questions():
    """T(kx), the contour and the widths, with the widths of the map's frequency beside them in full precision."""
    made, slab = board(), bp.Slab(bp.lmmd_cell(), 450)
    drawn = unpacked(panels.answer(made, "scattering", {"view.kx": 2.0}))
    ds = bp.scattering(slab, 2500.0, kx_over_k0=np.linspace(0, 2, 401))
    np.testing.assert_allclose(drawn["transmissivity"], ds.transmissivity, rtol=1e-6, atol=1e-30)
    drawn = unpacked(panels.answer(made, "bloch", {}))
    kz = bp.bloch(slab.cell, 2500.0, kx_over_k0=np.linspace(-10, 10, 401)).kz_over_k0
    np.testing.assert_allclose(drawn["re"] + 1j * drawn["im"], kz, rtol=1e-6)
    drawn = unpacked(panels.answer(made, "beam_width", {"question.frequency": 2300.0, "question.angle": 20.0}))
    beam = bp.GaussianBeam(0.096, 20.0)
    np.testing.assert_allclose(
        drawn["fwhm_out"], bp.beam_width(slab, beam, np.linspace(2000, 3000, 21)).fwhm_out, rtol=1e-6
    )
    assert drawn["here"]["fwhm_out"] == pytest.approx(float(bp.beam_width(slab, beam, 2300.0).fwhm_out), rel=1e-8)


def test_first_widths_are_those_of_the_study(tmp_path):
    """The launch plane is that of the question: the near face for widths, in front of the slab for a study's map, what it says where it does."""
    drawn = unpacked(panels.answer(board(), "beam_width", {}))
    alone = bp.beam_width(bp.Slab(bp.lmmd_cell(), 450), bp.GaussianBeam(0.096), 2500.0)
    assert drawn["here"]["fwhm_out"] == pytest.approx(float(alone.fwhm_out), rel=1e-8)
    assert board_of(tmp_path, COPIES).at("beam.z0").value == 0.0
    chosen = state.values_of(board(), {"beam.source": "slits"})
    assert chosen["beam.z0"] == -0.1
    for beam in ("", "[beam]\nz0 = -0.2\n"):
        made = board_of(tmp_path, f'[question]\nname = "field"\n{beam}')
        assert made.at("beam.z0").value == questions.field_arguments(made.document)["beam"].z0 < 0


def test_what_is_not_finite_is_said():
    """A width that is missing is null on the page, with the package's warning."""
    drawn = unpacked(panels.packed({"width": float("nan"), "warnings": ["no half level"]}, {"y": np.array([np.nan])}))
    assert drawn["width"] is None
    assert np.isnan(drawn["y"][0])


# --- the study's values -------------------------------------------------------------------------------------


def test_every_number_of_a_study_has_a_slider(tmp_path):
    """Layers, parts, half-spaces, models, errors of manufacture; those of a sweep over its values."""
    paths = {control.path for control in board_of(tmp_path, STACK).controls}
    assert {
        "slab.stack.1.periods",
        "slab.stack.1.layer.2.thickness",
        "slab.stack.2.layer.1.sound_speed",
        "slab.after.density",
    } <= paths
    paths = {control.path for control in board_of(tmp_path, OWN).controls}
    assert {
        "slab.layer.2.attenuation",
        "slab.layer.3.areal_density",
        "slab.after_density",
        "beam.slits.separation",
    } <= paths
    made = board_of(tmp_path, COPIES)
    eta, sample = made.at("slab.eta"), made.at("tolerance.sample")
    assert (eta.low, eta.high, eta.value, sample.high) == (0.01, 0.03, 0.01, 4)
    paths = {control.path for control in board().controls}
    named = "question.angle question.frequency slab.eta slab.n_layers slab.rho_m.im slab.periods beam.fwhm beam.z0 beam.source"
    assert set(named.split()) <= paths


def test_a_moved_value_is_where_the_study_file_has_it(tmp_path):
    """Both parts of a complex number together, layers by their number; what was not moved is as the file has it."""
    made = board_of(tmp_path, OWN)
    described = state.description(made, state.values_of(made, {"slab.layer.2.thickness": 0.003}), "scattering")
    assert described["slab"]["layer"][1]["thickness"] == 0.003
    assert described["slab"]["layer"][0] == {"material": "steel", "thickness": "1mm"}
    made = board()
    described = state.description(made, state.values_of(made, {"slab.rho_m.im": 0.04}), "bloch")
    assert described["slab"]["rho_m"] == "0.05+0.04j"


@pytest.mark.parametrize(
    ("moved", "said"),
    [
        ({"slab.rho_m.im": 0.01}, "rho_m, delta_rho: expected a passive medium"),
        ({"slab.eta": 1e308}, "slab.eta: expected a"),
        ({"slab.layers": "x.csv"}, "state: expected paths of values of this study, got 'slab.layers'"),
        ({"slab.medium": "lead"}, "slab.medium: expected"),
        ({"question.angle": 89.95}, "question.angle: expected a number from -89.9 to 89.9, got 89.95"),
        ([], "state: expected a table"),
    ],
)
def test_refusals_name_the_value(moved, said):
    with pytest.raises(ValueError, match=said.replace("[", r"\[")):
        panels.answer(board(), "field", moved)


def test_what_takes_too_long_is_refused_with_its_cost(tmp_path):
    """Before the work, in much less than it would take."""
    with pytest.raises(ValueError, match=r"at most 5 s, got one that takes about 15 s for 5e\+04 layers that differ"):
        panels.answer(board(), "beam_width", {"slab.n_layers": 50_000})
    with pytest.raises(ValueError, match="takes about"):
        panels.answer(board_of(tmp_path, COPIES), "beam_width", {"slab.periods": 100_000})
    described = {"question": {"name": "field"}, "slab": {"stack": [{"layer": [{}, {}], "periods": 9}, {"n_layers": 5}]}}
    assert cost.layers_of(described) == 7
    assert cost.layers_of(described | {"tolerance": {"sample": 1}}) == 2 * (18 + 5)


# --- what is handed out -------------------------------------------------------------------------------------

CASES = {
    "paper": ("", {"question.angle": 20.0, "slab.rho_m.im": 0.06, "slab.density": 1.1}),
    "effective": ("", {"slab.medium": "lmmd-emt", "beam.source": "slits", "slab.periods": 20}),
    "layers": (OWN, {"slab.layer.1.thickness": 0.0015}),
    "stack": (STACK, {"slab.stack.1.periods": 2}),
    "copies": (COPIES, {"tolerance.sample": 2}),
}


def same(ds, expected):
    """Whether two answers have the same numbers, but for the last digits of axes that are spaced in two ways."""
    for name, v in expected.data_vars.items():
        if not str(name).startswith("error_estimate"):
            scale = float(np.nanmax(np.abs(v.values)))
            np.testing.assert_allclose(ds[name].values, v.values, rtol=1e-7, atol=1e-9 * scale, err_msg=name)


@pytest.mark.filterwarnings("ignore:the half level is met up to")  # of slits
@pytest.mark.parametrize("name", state.NAMES)
@pytest.mark.parametrize("case", CASES)
def test_python_and_study_file_give_the_same_numbers(case, name, tmp_path, monkeypatch):
    """They run as they are, and answer what the page shows."""
    text, moved = CASES[case]
    made = board_of(tmp_path, text)
    if (case, name) == ("stack", "bloch"):
        with pytest.raises(ValueError, match="expected one cell"):
            equivalents.texts(made, name, moved)
        return
    monkeypatch.chdir(tmp_path)
    expected = questions.ask(state.description(made, state.values_of(made, moved), name))
    for each in equivalents.texts(made, name, moved):
        (tmp_path / each["file"]).write_text(each["text"], encoding="utf-8")
    exec(compile((tmp_path / f"{name}.py").read_text(encoding="utf-8"), f"{name}.py", "exec"), {})
    same(bp.load(f"{name}.nc"), expected)
    same(files.read(tmp_path / f"{name}.toml").answer(), expected)


@pytest.mark.filterwarnings("ignore:the half level is met up to")
@pytest.mark.parametrize(
    ("case", "name"), [("paper", "field"), ("effective", "beam_width"), ("layers", "scattering"), ("stack", "field")]
)
def test_command_lines_give_the_same_numbers(case, name, tmp_path, monkeypatch):
    """As typed in a shell, in a folder where the study file lies too."""
    text, moved = CASES[case]
    made = board_of(tmp_path, text)
    monkeypatch.chdir(tmp_path)
    described = state.description(made, state.values_of(made, moved), name)
    (tmp_path / f"{name}.toml").write_text(equivalents.study(described), encoding="utf-8")
    line = equivalents.command(described)
    assert line.startswith("beamprop ")
    ours = shlex.join([sys.executable, "-c", COMMAND]) + line.removeprefix("beamprop")
    done = subprocess.run(ours, shell=True, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    same(bp.load(f"{name}.nc"), questions.ask(described))


@pytest.mark.parametrize(
    ("kind", "begins"), [("png", b"\x89PNG"), ("pdf", b"%PDF"), ("svg", b"<?xml"), ("nc", b"\x89HDF")]
)
def test_files_are_of_their_kind(kind, begins, tmp_path):
    made = downloads.file(board(), "scattering", {}, kind, "abs")
    assert made.startswith(begins)
    if kind == "nc":
        (tmp_path / "a.nc").write_bytes(made)
        expected = bp.scattering(bp.Slab(bp.lmmd_cell(), 450), 2500.0, kx_over_k0=np.linspace(0, 5, 401))
        same(bp.load(tmp_path / "a.nc"), expected)


# --- stored results -----------------------------------------------------------------------------------------


def test_a_page_of_stored_results_needs_an_answer(tmp_path):
    """And says how to get it; more than a browser takes is refused with its size."""
    (tmp_path / "study.toml").write_text(COPIES + '[output]\nfile = "a.nc"\n', encoding="utf-8")
    with pytest.raises(
        ValueError,
        match=r"export: expected the stored answer of the study in a\.nc, got none; run it first: beamprop run",
    ):
        stored.page(files.read(tmp_path / "study.toml"))
    ds = bp.scattering(bp.Slab(bp.lmmd_cell(), 2), 2500.0, kx_over_k0=[0.0, 1.0])
    with pytest.raises(ValueError, match="got 80 MB"):
        stored.data_of(ds[["transmissivity"]].isel(kx_over_k0=np.zeros(20_000_000, int)))


def test_a_dataset_cannot_end_the_script_that_holds_it():
    """Names of a file are text on the page."""
    ds = bp.scattering(bp.Slab(bp.lmmd_cell(), 2), 2500.0, kx_over_k0=[0.0, 1.0])
    ds["transmissivity"].attrs["long_name"] = "</script><script>alert(1)</script>"
    page = stored.html_of("<b>&", stored.data_of(ds))
    assert "alert(1)</script>" not in page
    assert "<title>&lt;b&gt;&amp;, beamprop</title>" in page
    assert page.count("<script") == 4
