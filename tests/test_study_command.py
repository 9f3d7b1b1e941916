"""The command's run, check and init, and --save-study: the same answers as the questions of the command, wrong use, going on."""

import json
import shlex
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from command import good, run

import beamprop as bp
from beamprop.cli import study
from beamprop.study import files


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("example", study.EXAMPLES)
def test_every_example_checks_and_runs(example, here):
    """As `init` writes it: comments at every table, a prediction, an answer at each point, in the file that it names."""
    good("init", "--example", example)
    text = (here / "study.toml").read_text()
    assert text.count("#") >= 3
    assert "points    " in good("check", "study.toml").stdout
    good("run", "study.toml", "--workers", "1")
    ds = bp.load(here / f"{example}.nc")
    assert np.all(ds.status == 1)
    assert ds.status.size == json.loads(good("check", "study.toml", "--json").stdout)["points"] > 1
    assert all(np.all(np.isfinite(v)) for name, v in ds.data_vars.items() if name in ("fwhm_out", "t", "p"))


def test_init_leaves_files_as_they_are(here):
    (here / "study.toml").write_text("mine")
    ran = run("init")
    assert ran.exit_code == 2
    assert "FILE: expected a new name, got 'study.toml', which exists" in ran.stderr
    assert (here / "study.toml").read_text() == "mine"
    assert good("init", "-").stdout == (study._FILES / "width.toml").read_text()


#: Command lines of every question, with options of every kind.
LINES = [
    "field --periods 20 --x=-0.2:0.2:9 --z 0:0.2:5 --frequency 2.5kHz --angle 10 --plot p.png --quantity real",
    "field --layer 'steel 1mm' --layer 'water 2mm' --background water --frequency 1MHz --x 0,1mm --z 5mm --variables p,v_x",
    "field --periods 5 --x 0:1:9 --z 0 --boundary periodic --period 2 --z0=-0.1 --slits 1cm,5cm",
    "beam_width --periods 20 --frequency 2400:2600:3 --rtol 1e-6 --medium lmmd-emt --lossless",
    "width --periods 20 --frequency 2400:2600:3 --fwhm 12cm --width-of intensity --after water --plot w.png",
    "beam_measures --periods 5 --lossless --window 1 --z0=-5cm",
    "scattering --periods 20 --angle 0:80:9 --quantity absorption --log --plot s.png",
    "scattering --layers layers.csv --frequency 1kHz:2kHz:3 --kx 1",
    "bloch --eta 1/20 --kx-over-k0 0:2:5",
    "guided_modes --periods 20 --lossless --kx-over-k0-max 4",
]


@pytest.mark.parametrize("line", LINES)
def test_a_saved_study_is_the_command(line, here):
    """Written into another folder, run from a third: the same dataset, picture and file."""
    (here / "layers.csv").write_text("material,thickness_mm\nsteel,1\nwater,2\n")
    (here / "sub").mkdir()
    good(*shlex.split(line), "--output", "a.nc", "--save-study", "sub/saved.toml")
    of_command = bp.load("a.nc")
    pictures = {path.name: path.read_bytes() for path in here.glob("*.png")}
    for path in (here / "a.nc", *here.glob("*.png")):
        path.unlink()
    good("check", "sub/saved.toml")
    good("run", "sub/saved.toml")
    xr_same = bp.load("a.nc")
    assert xr_same.drop_attrs(deep=False).identical(of_command.drop_attrs(deep=False))
    assert bp.provenance(xr_same) == bp.provenance(of_command)
    assert {path.name for path in here.glob("*.png")} == set(pictures)


def test_a_saved_study_has_the_words_that_were_typed():
    good("beam_width", "--periods", "20", "--frequency", "2.4kHz:2.6kHz:3", "--fwhm", "9cm", "--save-study", "s.toml")
    assert Path("s.toml").read_text(encoding="utf-8") == (
        '[question]\nname = "beam_width"\nfrequency = "2.4kHz:2.6kHz:3"\n\n[slab]\nperiods = "20"\n\n[beam]\nfwhm = "9cm"\n'
    )


def test_nothing_is_saved_of_what_is_refused(here):
    ran = run("field", "--z", "-1", "--save-study", "s.toml")
    assert ran.exit_code == 2
    ran = run("field", "--memory", "10", "--output", "a.nc", "--save-study", "s.toml")
    assert "--save-study: expected to be left out beside --memory" in ran.stderr
    assert list(here.iterdir()) == []


SWEEP = """
[question]
name = "scattering"
angle = 0
[slab]
periods = 20
[sweep]
question.frequency = "2kHz:3kHz:40"
slab.eta = "1/60:1/30:25"
[output]
store = "s.zarr"
plot = "s.png"
quantity = "transmissivity"
"""


def test_a_store_is_gone_on_with(here, monkeypatch):
    """A part, then the rest, then nothing: each point is answered once; the same values as in memory."""
    text = SWEEP.replace("40", "8").replace("25", "5")
    (here / "s.toml").write_text(text)
    monkeypatch.setattr("beamprop.study.blocks.OVERHEAD", 1e-5)
    assert "--shard: expected k/n" in run("run", "s.toml", "--shard", "3/2").stderr
    good("run", "s.toml", "--shard", "1/2", "--workers", "1")
    part = bp.load("s.zarr").status.values.copy()
    assert 0 < np.count_nonzero(part == 1) < part.size
    stamps = {p: p.stat().st_mtime_ns for p in here.glob("s.zarr/status/c/*/*")}
    good("run", "s.toml", "--workers", "1")
    ds = bp.load("s.zarr")
    assert np.all(ds.status == 1)
    assert stamps.items() <= {p: p.stat().st_mtime_ns for p in here.glob("s.zarr/status/c/*/*")}.items()
    (here / "m.toml").write_text(text.replace('store = "s.zarr"\n', ""))
    whole = files.read("m.toml").answer(workers=1)
    np.testing.assert_array_equal(ds.t, whole.t)
    assert (here / "s.png").stat().st_size > 5000


def test_a_changed_study_is_refused(here):
    (here / "s.toml").write_text(SWEEP.replace("40", "4").replace("25", "2"))
    good("run", "s.toml", "--workers", "1")
    (here / "s.toml").write_text(SWEEP.replace("40", "4").replace("25", "2").replace("angle = 0", "angle = 1"))
    ran = run("run", "s.toml")
    assert ran.exit_code == 2
    assert "s.toml: 1 mistake\n  output.store: expected" in ran.stderr
    assert "angle" in ran.stderr.partition("output.store: ")[2]


def test_processes_and_clusters_give_the_same(here, monkeypatch):
    """Two processes, and the executor of a scheduler's client (here one of threads), as this process alone."""
    text = SWEEP.replace("40", "4").replace("25", "4").replace('store = "s.zarr"\nplot = "s.png"', 'file = "s.nc"')
    (here / "s.toml").write_text(text)
    good("run", "s.toml", "--workers", "1")
    alone = bp.load("s.nc").t
    monkeypatch.setattr("beamprop.study.sweep.START", 0.0)
    good("run", "s.toml", "--workers", "2")
    np.testing.assert_array_equal(bp.load("s.nc").t, alone)
    with ThreadPoolExecutor(2) as pool:
        client = SimpleNamespace(Client=lambda address: SimpleNamespace(get_executor=lambda: pool, address=address))
        monkeypatch.setitem(sys.modules, "distributed", client)
        good("run", "s.toml", "--scheduler", "tcp://host:8786")
    np.testing.assert_array_equal(bp.load("s.nc").t, alone)


def test_wrong_use(here):
    (here / "s.toml").write_text("[question]\nname = 'bloch'\nfrequenzy = 1\n[output]\nplot = 'a.gif'")
    for command in ("run", "check"):
        ran = run(command, "s.toml")
        assert (ran.exit_code, ran.stdout) == (2, "")
        assert (
            "s.toml: 1 mistake\n  question.frequenzy: expected a name that question has, got 1; did you mean"
            in ran.stderr
        )
    assert run("run", "none.toml").exit_code == 2
    (here / "s.toml").write_text("[question]\nname = 'bloch'")
    assert "--shard: expected a study with a sweep" in run("run", "s.toml", "--shard", "1/2").stderr


def test_stated_memory_is_the_limit(here):
    """Stated in the file; the environment is afterwards as it was."""
    (here / "s.toml").write_text(SWEEP.replace('store = "s.zarr"\nplot = "s.png"', 'memory = "10kB"'))
    for command in ("check", "run"):
        ran = CliRunner(env={"BEAMPROP_MEMORY": None}).invoke(bp.cli.main, [command, "s.toml"])
        assert ran.exit_code == 2
        assert "fits into 10 kB of memory, got 1000 points that take about" in ran.stderr
