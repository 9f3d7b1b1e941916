"""Sweeps through kills: of the main process, of workers, by Ctrl-C and SIGTERM; two runs on one store."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import study_kills
import xarray as xr

import beamprop as bp
from beamprop.study import run, sweep

pytestmark = pytest.mark.skipif(not os.path.exists("/proc/self/task"), reason="children are looked up in /proc")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """An empty store, and one filled without a disturbance."""
    path = tmp_path_factory.mktemp("studies")
    study_kills.prepare(path)
    return path


@pytest.mark.parametrize(
    ("kill", "fraction"),
    [(study_kills.kill_main, 0.0), (study_kills.kill_main, 0.6), (study_kills.kill_worker, 0.3)],
    ids=["main, at once", "main", "worker"],
)
def test_a_killed_study_goes_on(folder, kill, fraction):
    """Every file equal to the undisturbed store's; twice only what was under way; no worker outlives its main process."""
    equal, twice, points, left = study_kills.trial(folder, fraction, kill)
    assert equal
    assert points == study_kills.POINTS
    assert twice <= study_kills.AHEAD * study_kills.WORKERS
    assert left == 0


def begun(folder, name, log):
    """A study under way in a copy of the empty store, after its first points."""
    path = folder / name
    subprocess.run(["cp", "-r", str(folder / "empty.zarr"), str(path)], check=True)
    log.write_bytes(b"")
    process = study_kills.started(path, log)
    end = time.monotonic() + 60
    while len(log.read_bytes().splitlines()) < 30 and time.monotonic() < end:
        time.sleep(0.01)
    return path, process


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it_within_two_seconds(folder, number):
    """Main process and workers; the store is one that goes on."""
    log = folder / "log"
    path, process = begun(folder, f"{number.name}.zarr", log)
    workers = study_kills.children(process.pid)
    assert len(workers) == study_kills.WORKERS
    process.send_signal(number)
    start = time.monotonic()
    errors = process.communicate(timeout=30)[1]
    assert time.monotonic() - start < 2.0
    assert process.returncode in (-number, 1 if number == signal.SIGINT else -number)
    assert errors.count("Traceback") - errors.count("During handling of the above exception") <= 1
    assert "leaked" not in errors
    assert study_kills.living(workers) == 0
    status = bp.load(path).status.values
    assert 0 < np.count_nonzero(status) < status.size
    again = study_kills.started(path, log)
    assert again.communicate(timeout=60)[1] == ""
    assert study_kills.contents(path) == study_kills.contents(folder / "whole.zarr")


def test_two_runs_on_one_store(folder):
    """Begun together, each waits for the whole; no point is answered twice."""
    path, log = folder / "both.zarr", folder / "log"
    subprocess.run(["cp", "-r", str(folder / "empty.zarr"), str(path)], check=True)
    log.write_bytes(b"")
    runs = [study_kills.started(path, log) for _ in range(2)]
    for process in runs:
        assert process.communicate(timeout=120)[1] == ""
        assert process.returncode == 0
    assert len(log.read_text().splitlines()) == study_kills.POINTS
    assert study_kills.contents(path) == study_kills.contents(folder / "whole.zarr")


#: No `if __name__ == "__main__"`, a lambda, a name of the script, a new store made by two processes at once.
SCRIPT = """
import sys
import numpy as np, xarray as xr, beamprop as bp
from beamprop.study import run, sweep
sweep.START = 0.0
SHIFT = 2.0
ds = bp.sweep(lambda v: xr.Dataset({"y": v + SHIFT}), {"v": np.arange(2000.0)}, store=sys.argv[1], workers=2, progress=False)
assert np.array_equal(ds.y, ds.v + SHIFT)
print("done")
"""


def test_scripts_as_people_write_them(tmp_path):
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, str(tmp_path / "script.py"), str(tmp_path / "study.zarr")]
    runs = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    for process in runs:
        assert process.communicate(timeout=120) == ("done\n", "")
    assert os.listdir(tmp_path / "study.zarr" / "status" / "c") != []
    assert sorted(os.listdir(tmp_path)) == ["script.py", "study.zarr"]


def test_a_point_that_kills_its_worker_fails_alone(monkeypatch):
    """The others are answered; its block has failed, and says so."""

    def question(value):
        if value == 5 and os.getpid() != parent:
            os._exit(1)
        return xr.Dataset({"y": float(value)})

    parent = os.getpid()
    monkeypatch.setattr(sweep, "START", 0.0)
    monkeypatch.setattr(sweep, "PLACES", 1)
    monkeypatch.setattr(sweep, "points_of_a_block", lambda seconds, bytes_each: 2)
    with pytest.warns(RuntimeWarning, match=r"^2 of 8 points failed.*the process that answered it died"):
        ds = bp.sweep(question, {"value": np.arange(8)}, workers=2, progress=False)
    assert ds.status.values.tolist() == [1, 1, 1, 1, 2, 2, 1, 1]


def test_workers_that_cannot_live_are_an_error(monkeypatch):
    """Rather than a study of failed points."""

    def question(value):
        if os.getpid() != parent:
            os._exit(1)
        return xr.Dataset({"y": float(value)})

    parent = os.getpid()
    monkeypatch.setattr(sweep, "START", 0.0)
    monkeypatch.setattr(sweep, "PLACES", 1)
    monkeypatch.setattr(run, "HOPELESS", 2)
    monkeypatch.setattr(sweep, "points_of_a_block", lambda seconds, bytes_each: 1)
    with pytest.raises(RuntimeError, match=r"^workers: expected processes that live"):
        bp.sweep(question, {"value": np.arange(8)}, workers=2, progress=False)
