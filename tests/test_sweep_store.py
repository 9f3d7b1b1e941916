"""Stores of sweeps: what stands in them, how they go on, what is refused, what is noticed."""

import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop.study import blocks, claims, sweep

VALUES = np.arange(40.0)
FACTOR = 3.0


def plane(value):
    return xr.Dataset({"y": ("x", FACTOR * value * np.arange(3.0)), "c": 1j * value}, {"x": [1.0, 2.0, 4.0]})


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    """Blocks of seven points, whatever they take."""
    monkeypatch.setattr(sweep, "points_of_a_block", lambda seconds, bytes_each: 7)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "study.zarr"


def ask(path, question=plane, values=VALUES, **options):
    return bp.sweep(question, {"value": values}, store=path, progress=False, **options)


def in_memory(question=plane, values=VALUES):
    return bp.sweep(question, {"value": values}, workers=1, progress=False)


def empty(path, *numbers):
    """Make blocks empty ones, as a kill before their status leaves them."""
    for number in numbers:
        (path / "status" / "c" / str(number)).unlink()


def counted(folder):
    """A question that leaves a file for every point it answers, and the numbers of those files."""
    folder.mkdir()

    def question(value):
        (folder / f"{value}-{time.perf_counter_ns()}").touch()
        return plane(value)

    return question, lambda: sorted(float(name.split("-")[0]) for name in os.listdir(folder))


# --- what stands in it ------------------------------------------------------------------------------------


def test_a_store_is_the_dataset(path):
    """By `load`, by xarray, and as it is returned, which reads it when it is used."""
    whole = in_memory()
    ds = ask(path)
    assert not ds.variables["y"]._in_memory
    assert ds.load().identical(whole)
    assert bp.load(path).identical(whole)
    with xr.open_zarr(path, consolidated=False) as opened:
        assert opened.load().identical(whole)


def test_each_block_is_one_chunk_of_each_array(path):
    ask(path)
    numbers = [str(k) for k in range(6)]
    assert sorted(os.listdir(path / "status" / "c")) == numbers
    assert sorted(p.relative_to(path / "y").as_posix() for p in (path / "y").rglob("0")) == ["c/0", *(f"c/{k}/0" for k in numbers)]
    assert sorted(os.listdir(path / "records" / "c")) == numbers


def test_a_sweep_of_beams_survives_the_formats(path, tmp_path):
    """Provenance of a point after a store, a netCDF file and a copy."""

    def width(eta, frequency):
        return bp.beam_width(bp.Slab(bp.lmmd_cell(eta=eta), 5), bp.GaussianBeam(0.096), frequency)

    ds = bp.sweep(width, {"eta": [0.01, 0.02], "frequency": [2400.0, 2500.0]}, store=path, progress=False).load()
    for name in ("copy.nc", "copy.zarr"):
        bp.save(ds, tmp_path / name)
        copy = bp.load(tmp_path / name)
        xr.testing.assert_equal(copy, ds)
        assert bp.provenance(copy.sel(eta=0.02, frequency=2400.0))["slab"].cell == bp.lmmd_cell(eta=0.02)


# --- going on -----------------------------------------------------------------------------------------------


def test_nothing_that_is_done_is_done_again(path, tmp_path):
    question, answered = counted(tmp_path / "answers")
    first = ask(path, question).load()
    before = answered()
    assert set(before) == set(VALUES)
    assert ask(path, question).identical(first)
    assert answered() == before
    empty(path, 2, 5)
    assert ask(path, question).identical(first)
    assert sorted(answered()) == sorted([*before, *VALUES[14:21], *VALUES[35:]])


def test_shards_do_their_part(path, tmp_path):
    """Each a part of the blocks, together all; none twice."""
    question, answered = counted(tmp_path / "answers")
    ask(path, question, shard=(1, 2))
    assert np.count_nonzero(bp.load(path).status) == 21
    first = answered()
    ds = ask(path, question, shard=(2, 2))
    assert (ds.status == 1).all()
    assert sorted(set(answered()[len(first) :])) is not None
    assert len(answered()) - len(first) == 19
    xr.testing.assert_equal(ds.load(), in_memory(question))


def test_a_changed_study_is_refused_and_says_what_differs(path, monkeypatch):
    before = ask(path).load()

    def changed(value):
        return plane(value).isel(x=slice(None))

    with pytest.raises(ValueError, match=r"(?s)^store: expected the study.*axes\['value'\]: 40 values from 0.0.*41 values"):
        ask(path, values=np.arange(41.0))
    with pytest.raises(ValueError, match=r"(?s)question.source: def plane.*def changed"):
        ask(path, changed)
    with pytest.raises(ValueError, match=r"(?s)axes\['v'\]: nothing there"):
        bp.sweep(lambda v: plane(v), {"v": VALUES}, store=path, progress=False)
    with monkeypatch.context() as patch:
        patch.setattr(sys.modules[__name__], "FACTOR", 4.0)
        with pytest.raises(ValueError, match=r"FACTOR.value: 3.0 there, 4.0 here$"):
            ask(path)
    assert ask(path).identical(before)


def test_what_does_not_change_a_study(path):
    """A lambda on another line, other options."""
    ask(path, lambda value: plane(value))
    same = lambda value: plane(value)  # noqa: E731  # and a comment
    ask(path, same, workers=1)
    with pytest.raises(ValueError, match=r"question.source: plane\(value\) there, plane\(value \+ 1\) here"):
        ask(path, lambda value: plane(value + 1))


def test_closures_and_defaults_belong_to_the_study(path):
    def question_of(slab, shift):
        def question(value, shift=shift):
            return plane(value + shift).assign(d=slab.thickness)

        return question

    slabs = [bp.Slab(bp.lmmd_cell(eta=eta), 5) for eta in (0.01, 0.02)]
    ask(path, question_of(slabs[0], 0.0))
    ask(path, question_of(bp.Slab(bp.lmmd_cell(eta=0.01), 5), 0.0))
    with pytest.raises(ValueError, match=r"\n  slab.value: Slab\(.*there, Slab\(.*here$"):
        ask(path, question_of(slabs[1], 0.0))
    with pytest.raises(ValueError, match=r"\n  defaults.value: "):
        ask(path, question_of(slabs[0], 1.0))


# --- claims -------------------------------------------------------------------------------------------------


CLAIM = """
import sys, time
from pathlib import Path
from beamprop.study.claims import Claims
claims = Claims(Path(sys.argv[1]))
print([claims.take(k) for k in (0, 3)], flush=True)
time.sleep(60)
"""


def test_claims_end_with_their_process(path):
    """Another run leaves them alone, until it is killed."""
    ask(path)
    other = subprocess.Popen([sys.executable, "-c", CLAIM, str(path)], stdout=subprocess.PIPE, text=True)
    try:
        assert other.stdout.readline() == "[True, True]\n"
        own = claims.Claims(path)
        assert [own.take(k) for k in range(5)] == [False, True, True, False, True]
    finally:
        other.kill()
        other.wait()
        other.stdout.close()
    assert [own.take(k) for k in range(5)] == [True] * 5
    own.close()


def test_a_run_waits_for_blocks_of_another_and_takes_them_over(path, tmp_path):
    question, answered = counted(tmp_path / "answers")
    before = ask(path, question).load()
    count = len(answered())
    empty(path, 0, 1)
    other = subprocess.Popen([sys.executable, "-c", CLAIM, str(path)], stdout=subprocess.PIPE, text=True)
    assert other.stdout.readline() == "[True, True]\n"
    with ThreadPoolExecutor(1) as thread:
        run = thread.submit(ask, path, question, executor=ThreadPoolExecutor(1))
        time.sleep(1.0)
        assert not run.done()
        assert len(answered()) == count + 7
        other.kill()
        other.wait()
        other.stdout.close()
        assert run.result(10).identical(before)
    assert len(answered()) == count + 14


def test_without_locks_everything_is_done(path, monkeypatch):
    """As on Windows."""
    monkeypatch.setattr(claims, "fcntl", None)
    assert ask(path).identical(in_memory())


# --- damage, and what stands in the way -----------------------------------------------------------------------


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
        with pytest.raises(ValueError, match=rf"^store: .*damage in 1 of 6 blocks, the first: {chunk} is .*repair=True"):
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
import resource, sys
import numpy as np, xarray as xr, beamprop as bp
limit, path = int(sys.argv[1]), sys.argv[2]
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
rng = np.random.default_rng(1)
values = rng.standard_normal((4, 3000))
try:
    bp.sweep(lambda k: xr.Dataset({"v": ("x", values[k, : 300 + 2700 * (k > 1)])}) if False else xr.Dataset({"v": ("x", values[k] * (k > 1))}),
             {"k": [0, 1, 2, 3]}, store=path, progress=False)
except OSError as error:
    print(type(error).__name__, error.errno, error.filename)
"""


def test_a_full_disk_leaves_a_store_that_goes_on(path):
    """The blocks before it are kept, an error names the store, and nothing wrong is in it."""
    import errno

    def run(limit):
        done = subprocess.run([sys.executable, "-c", FULL, str(limit), str(path)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    assert run(20_000) == ["OSError", str(errno.EFBIG), str(path)]
    part = bp.load(path)
    assert set(part.status.values.tolist()) == {0, 1} or (part.status == 0).all()
    assert np.isnan(part.v.values[part.status.values == 0]).all()
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


def test_axes_of_zeros_and_of_words(path):
    """Chunks of fill values are written too; a zero is no missing axis."""

    def question(word, value):
        return plane(value).assign(n=len(word)).assign_coords(side=("x", ["a", "bc", "d"]))

    def dropped(word, value):
        return question(word, value).drop_vars("side")

    axes = {"word": ["near", "far away"], "value": [0.0]}
    with pytest.raises(ValueError, match=r"^question: expected variables of numbers, got side"):
        bp.sweep(question, axes, store=path, progress=False)
    ds = bp.sweep(dropped, axes, store=path, progress=False)
    assert ds.load().identical(bp.sweep(dropped, axes, progress=False))
    assert bp.load(path).identical(bp.sweep(dropped, axes, store=path, progress=False).load())
    assert ds.n.sel(word="far away", value=0.0) == 8
