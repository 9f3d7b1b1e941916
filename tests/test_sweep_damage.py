"""Stores of sweeps with damage, of other versions, on full disks and in folders that cannot be written to."""

import errno
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from sweep_stores import ask, empty, in_memory, plane, store_of_small_blocks

import beamprop as bp
from beamprop.study import blocks, claims


@pytest.fixture
def path(tmp_path, monkeypatch):
    return store_of_small_blocks(tmp_path, monkeypatch)


def damage(file, how):
    data = bytearray(file.read_bytes())
    if how == "missing":
        file.unlink()
    elif how == "cut off":
        file.write_bytes(data[: len(data) // 2])
    elif how == "emptied":
        file.write_bytes(b"")
    else:
        data[len(data) // 2] ^= 4
        file.write_bytes(data)


@pytest.mark.parametrize("how", ["missing", "cut off", "emptied", "bit"])
@pytest.mark.parametrize("name", ["y", "c", "message", "record", "records", "status"])
def test_damage_is_noticed_named_and_repaired(path, name, how):
    """A status that is missing is a block to do."""
    before = ask(path).load()
    chunk = f"{name}/c/3/0" if name == "y" else f"{name}/c/3"
    damage(path / chunk, how)
    if (name, how) != ("status", "missing"):
        with pytest.raises(
            ValueError, match=rf"^store: .*damage in 1 of 6 blocks, the first: {chunk} is .*repair=True"
        ):
            ask(path)
        with pytest.raises(ValueError, match=name):
            bp.load(path)
    assert ask(path, repair=True).identical(before)
    assert bp.load(path).identical(before)


@pytest.mark.parametrize("name", ["value", "x"])
def test_missing_coordinates_are_noticed(path, name):
    ask(path)
    damage(path / name / "c" / "0", "missing")
    with pytest.raises(ValueError, match=name):
        bp.load(path)
    with pytest.raises(ValueError, match=name):
        ask(path)


def test_failed_points_are_asked_again_by_repair(path, tmp_path):
    switch = tmp_path / "switch"

    def question(value):
        if value == 20 and not switch.exists():
            raise OSError("no licence today")
        return plane(value)

    for _ in range(2):
        with pytest.warns(RuntimeWarning, match=r"^1 of 40 points failed.*OSError: no licence today"):
            assert ask(path, question).status.sel(value=20) == 2
    switch.touch()
    assert ask(path, question, repair=True).load().equals(in_memory(question))


def test_a_store_of_another_format_is_refused(path):
    ask(path)
    root = json.loads((path / "zarr.json").read_text())
    about = json.loads(root["attributes"]["_nc_beamprop_study"])
    root["attributes"]["_nc_beamprop_study"] = json.dumps(about | {"format": 0})
    text = json.dumps(root)
    (path / "zarr.json").write_text(text)
    with pytest.raises(ValueError, match=r"^store: expected a store of format 1.*got .*format 0 of 0"):
        ask(path)
    assert (path / "zarr.json").read_text() == text


def test_other_things_are_left_alone(path, tmp_path):
    bp.save(plane(1.0), path)
    (tmp_path / "thesis.zarr").mkdir()
    (tmp_path / "thesis.zarr" / "text").write_text("years")
    for target in (path, tmp_path / "thesis.zarr"):
        with pytest.raises(ValueError, match=r"^store: expected a new name, or a store that a sweep has begun"):
            ask(target)
    assert bp.load(path).identical(plane(1.0))
    with pytest.raises(ValueError, match=r"^store: expected a name that ends in .zarr"):
        ask(tmp_path / "study.nc")
    with pytest.raises(ValueError, match=r"^store: expected a file in an existing folder"):
        ask(tmp_path / "nowhere" / "study.zarr")


def test_a_store_that_cannot_be_written_to(path, monkeypatch):
    """Is read if it is complete, refused if it is not."""
    before = ask(path).load()

    def refuse(store):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(claims.Claims, "__init__", lambda self, store: refuse(store))
    assert ask(path).identical(before)
    empty(path, 1)
    with pytest.raises(ValueError, match=r"^store: expected one that can be written to, got .*Read-only"):
        ask(path)


FULL = """
import resource, sys, time
import numpy as np, xarray as xr, beamprop as bp
limit, path = int(sys.argv[1]), sys.argv[2]
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
values = np.random.default_rng(1).standard_normal((4, 3000))
def question(k):
    time.sleep(0.42)  # blocks of one point
    return xr.Dataset({"v": ("x", values[k] * (k > 1))})
try:
    bp.sweep(question, {"k": [0, 1, 2, 3]}, store=path, workers=1, progress=False)
except OSError as error:
    print(type(error).__name__, error.errno, error.filename)
"""


def test_a_full_disk_leaves_a_store_that_goes_on(path):
    """The blocks before it are kept, an error names the store, and nothing wrong is in it."""

    def run(limit):
        done = subprocess.run(
            [sys.executable, "-c", FULL, str(limit), str(path)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    assert run(20_000) == ["OSError", str(errno.EFBIG), str(path)]
    part = bp.load(path)
    assert part.status.values.tolist() == [1, 1, 0, 0]
    assert np.isnan(part.v.values[2:]).all()
    assert run(0) == []
    whole = bp.load(path)
    assert (whole.status == 1).all()
    np.testing.assert_array_equal(whole.v[3], np.random.default_rng(1).standard_normal((4, 3000))[3])


def test_no_clock_decides():
    """Whose block it is, and whether it is done, is read from locks and files: the rooms' files ask for intervals alone."""
    for file in Path(blocks.__file__).parent.glob("*.py"):
        text = file.read_text(encoding="utf-8")
        assert "time.time(" not in text
        assert "st_mtime" not in text


def test_clocks_that_jump_change_no_value(path, monkeypatch):
    """They leap to and fro, by years, while points are measured, answered and written: blocks may be of any size, values are right."""
    rng = np.random.default_rng(0)
    for name in ("time", "monotonic", "perf_counter"):
        monkeypatch.setattr(time, name, lambda: float(rng.uniform(-1e9, 1e9)))
    values = np.arange(60.0)

    def square(value):
        return xr.Dataset({"y": value**2})

    for store in (path, None):
        ds = bp.sweep(square, {"value": values}, store=store, workers=1, progress=False)
        assert (ds.status == 1).all()
        np.testing.assert_array_equal(ds.y, values**2)
