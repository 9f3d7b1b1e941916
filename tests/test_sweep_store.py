"""Stores of sweeps: what stands in them, how they go on, which studies are refused, whose block it is."""

import os
import subprocess
import sys
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import sweep_stores
import xarray as xr
from sweep_stores import VALUES, ask, counted, empty, in_memory, plane, store_of_small_blocks

import beamprop as bp
from beamprop.study import claims
from beamprop.study.differences import differences


@pytest.fixture
def path(tmp_path, monkeypatch):
    return store_of_small_blocks(tmp_path, monkeypatch)


# --- what stands in it ------------------------------------------------------------------------------------


def test_a_store_is_the_dataset(path):
    """By `load`, by xarray, and as it is returned, which reads it when it is used."""
    whole = in_memory()
    ds = ask(path)
    assert not ds.variables["y"]._in_memory
    assert ds.load().identical(whole)
    assert bp.load(path).identical(whole)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".* not part in the Zarr format 3 specification")  # of zarr 3.0
        opened = xr.open_zarr(path, consolidated=False)
    with opened:
        assert opened.load().identical(whole)


def test_each_block_is_one_chunk_of_each_array(path):
    ask(path)
    numbers = [str(k) for k in range(6)]
    assert sorted(os.listdir(path / "status" / "c")) == numbers
    assert sorted(p.relative_to(path / "y").as_posix() for p in (path / "y").rglob("0")) == [
        "c/0",
        *(f"c/{k}/0" for k in numbers),
    ]
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
    assert len(answered()) - len(first) == 19
    xr.testing.assert_equal(ds.load(), in_memory(question))


def test_a_changed_study_is_refused_and_says_what_differs(path, monkeypatch):
    before = ask(path).load()

    def changed(value):
        return plane(value).isel(x=slice(None))

    with pytest.raises(
        ValueError, match=r"(?s)^store: expected the study.*axes\['value'\]: 40 values from 0.0.*41 values"
    ):
        ask(path, values=np.arange(41.0))
    with pytest.raises(ValueError, match=r"(?s)question.source: def plane.*def changed"):
        ask(path, changed)
    with pytest.raises(ValueError, match=r"(?s)axes\['v'\]: nothing there"):
        bp.sweep(lambda v: plane(v), {"v": VALUES}, store=path, progress=False)
    with monkeypatch.context() as patch:
        patch.setattr(sweep_stores, "FACTOR", 4.0)
        with pytest.raises(ValueError, match=r"FACTOR: 3.0 there, 4.0 here$"):
            ask(path)
    assert ask(path).identical(before)


def test_axes_in_another_order_are_another_study(path):
    axes = {"a": [1.0, 2.0], "b": [1.0, 2.0, 3.0]}
    bp.sweep(lambda a, b: plane(a + b), axes, store=path, progress=False)
    with pytest.raises(ValueError, match=r"\n  the order of the axes$"):
        bp.sweep(lambda a, b: plane(a + b), dict(reversed(axes.items())), store=path, progress=False)


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
    with pytest.raises(ValueError, match=r"(?s)\n  slab.segments.1.layers.1.fluid.density: 125.0.* there, 62.5"):
        ask(path, question_of(slabs[1], 0.0))
    with pytest.raises(ValueError, match=r"\n  defaults\.1: 0\.0 there, 1\.0 here$"):
        ask(path, question_of(slabs[0], 1.0))


def test_a_changed_study_is_told_parameter_by_parameter():
    """The fields that differ, by the paths of a study file, and the lines of a source; a few of many, and of long texts the place."""
    wide = "x" * 500
    there = {
        "question.value": "Point(description={'question': {'name': 'field', 'rtol': 1e-08}, 'slab': {'periods': 20}}, paths={})",
        "question.source": "def f(eta):\n    a = 1\n    return a",
        "w.value": f"'{wide}a{wide}'",
        "d.value": "{'a': array float64 (3,) b0c45303f7f11848, 'b': (1, 2, 3)}",
        "o.value": "<no expression 1>",
        "gone.value": "1",
    }
    here = {
        "question.value": "Point(description={'question': {'name': 'field', 'rtol': 1e-06}, 'slab': {}, 'beam': {'fwhm': 0.1}}, paths={})",
        "question.source": "def f(eta):\n    a = 2\n    return a",
        "w.value": f"'{wide}b{wide}'",
        "d.value": "{'a': array float64 (3,) a68de4b5e96a60c8, 'b': (1, 2, 4)}",
        "o.value": "<no expression 2>",
    }
    lines = differences(there, here)
    assert lines[:5] == [
        "question.rtol: 1e-08 there, 1e-06 here",
        "slab.periods: 20 there, nothing here",
        "slab: nothing there, {} here",
        "beam.fwhm: nothing there, 0.1 here",
        "question.source: a = 1 there, a = 2 here",
    ]
    assert "xa" in lines[5]
    assert "xb" in lines[5]
    assert len(lines[5]) < 250
    assert lines[7:] == ["d.b.3: 3 there, 4 here", "and 2 more"]
    assert differences({"o.value": "<1>", "gone.value": "1"}, {"o.value": "<2>"}) == [
        "o: <1> there, <2> here",
        "gone: 1 there, nothing here",
    ]
    many = differences({"t.value": str(list(range(100)))}, {"t.value": str(list(range(1, 101)))})
    assert many[0] == "t.1: 0 there, 1 here"
    assert many[-1] == "and 92 more"
    assert differences(there, there) == []


# --- claims -------------------------------------------------------------------------------------------------


CLAIM = """
import sys, time
from pathlib import Path
from beamprop.study.differences import differences
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
