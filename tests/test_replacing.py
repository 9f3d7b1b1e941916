"""Files that take another's place: readers find the old or the new, kills leave one of them, and nobody else's things are touched."""

import ctypes
import errno
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import pytest
import xarray as xr
from versions import names, version, versions_in

import beamprop as bp
from beamprop.io.storage import settled, whole

pytestmark = pytest.mark.skipif(os.name == "nt", reason="POSIX signals and permissions")
NAMES = ["a.nc", "a.zarr"]
SLAB, BEAM = bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1)


@pytest.fixture(params=[True, False], ids=["exchange", "two renames"])
def exchange(request, monkeypatch):
    """With the system's exchange of names, and as where there is none."""
    if not request.param:
        monkeypatch.setattr(whole, "exchange", lambda a, b: False)
    return request.param


# --- readers and writers ----------------------------------------------------------------------------------


def _write_on(path, first, stop, alone):
    if alone:
        whole.exchange = lambda a, b: False
    number = first
    while not stop.is_set():
        begin = time.monotonic()
        bp.save(version(number), path)
        # a reader never sees the end of a file that is replaced without a pause, and takes longer on a busy machine
        time.sleep(0.02 + 3 * (time.monotonic() - begin))
        number += 2


@pytest.mark.parametrize("name", NAMES)
def test_a_reader_beside_two_writers_reads_one_version(tmp_path, name, exchange):
    """Never a mixture, never neither, as fast as files are replaced."""
    path = tmp_path / name
    bp.save(version(0), path)
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    writers = [context.Process(target=_write_on, args=(path, first, stop, not exchange)) for first in (1, 2)]
    for writer in writers:
        writer.start()
    seen, begin = set(), time.monotonic()
    try:
        while time.monotonic() < begin + 120 and (len(seen) < 8 or time.monotonic() < begin + 4):
            found = versions_in(bp.load(path))
            assert len(found) == 1
            seen |= found
    finally:
        stop.set()
        for writer in writers:
            writer.join(30)
            if writer.is_alive():
                writer.kill()
    assert [w.exitcode for w in writers] == [0, 0]
    assert len(seen) > 3
    assert names(tmp_path) == [name]


def test_load_begins_again_when_a_store_is_exchanged_under_it(tmp_path, monkeypatch):
    """Even if the new one were given the old one's number."""
    path = tmp_path / "a.zarr"
    bp.save(version(1), path)
    original, calls = xr.open_zarr, []

    def late(*arguments, **options):
        opened = original(*arguments, **options)
        calls.append(1)
        if len(calls) == 1:
            opened.v0.load()
            bp.save(version(2), path)
            bp.save(version(3), path)
        return opened

    monkeypatch.setattr(xr, "open_zarr", late)
    assert versions_in(bp.load(path)) == {3}
    assert len(calls) == 2


def test_a_file_that_never_stays_is_named(tmp_path, monkeypatch):
    """Not an endless loop."""
    path = tmp_path / "a.nc"
    path.write_text("")
    monkeypatch.setattr(settled, "TRIES", 3)

    def replaced(path):
        (path.parent / "b").write_text("")
        os.replace(path.parent / "b", path)
        return xr.Dataset()

    with pytest.raises(ValueError, match=r"a\.nc: expected a file that stays while it is read, got 3 replacements"):
        settled.read_settled(path, replaced)


def test_load_waits_between_the_two_renames(tmp_path):
    """Where names cannot be exchanged, there is neither for a moment: a reader waits while a writer is there."""
    path = tmp_path / "a.zarr"
    bp.save(version(1), tmp_path / "b.zarr")
    with whole.scratch_beside(path):
        later = threading.Timer(0.3, os.rename, (tmp_path / "b.zarr", path))
        later.start()
        assert versions_in(bp.load(path)) == {1}
        later.join()


@pytest.mark.skipif(sys.platform != "linux", reason="what this system offers")
def test_names_are_exchanged_at_once(tmp_path):
    """renameat2 does it, for folders and files alike."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").write_text("b")
    if not whole.exchange(tmp_path / "a", tmp_path / "b"):
        pytest.skip("not on this file system")
    assert (tmp_path / "a").read_text() == "b"
    assert (tmp_path / "b").is_dir()
    with pytest.raises(OSError, match="No such file"):
        whole.exchange(tmp_path / "a", tmp_path / "none")


# --- failures, Ctrl-C and kills ---------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("error", [OSError(errno.EIO, "broken"), KeyboardInterrupt()], ids=["failure", "Ctrl-C"])
@pytest.mark.parametrize("which", [1, 2])
def test_a_rename_that_fails_leaves_the_old_one(tmp_path, monkeypatch, name, error, which, exchange):
    """Whichever rename it is, and whatever the system offers."""
    path = tmp_path / name
    bp.save(version(1), path)
    calls = []

    def broken(original):
        def call(*arguments):
            if str(path) not in map(str, arguments) or "lock" in str(arguments[1]):
                return original(*arguments)
            calls.append(arguments)
            if len(calls) == which:
                raise error
            return original(*arguments)

        return call

    for call in ("rename", "replace"):
        monkeypatch.setattr(os, call, broken(getattr(os, call)))
    if exchange:
        monkeypatch.setattr(whole, "exchange", broken(whole.exchange))
    if which <= (2 if name == "a.zarr" and not exchange else 1):
        with pytest.raises(type(error)):
            bp.save(version(2), path)
        monkeypatch.undo()
        assert versions_in(bp.load(path)) == {1}
    else:
        bp.save(version(2), path)
        assert versions_in(bp.load(path)) == {2}
    assert names(tmp_path) == [name]


def test_what_cannot_be_put_back_is_kept(tmp_path, monkeypatch):
    """Both renames fail, and the way back too: the old store stays in the scratch folder, and the next run finds it."""
    path = tmp_path / "a.zarr"
    bp.save(version(1), path)
    original = os.rename

    def broken(a, b):
        if str(b) == str(path):
            raise OSError(errno.EIO, "broken")
        original(a, b)

    monkeypatch.setattr(whole, "exchange", lambda a, b: False)
    monkeypatch.setattr(os, "rename", broken)
    with pytest.raises(OSError, match="broken"):
        bp.save(version(2), path)
    monkeypatch.undo()
    (scratch,) = whole.scratch_of(path)
    assert versions_in(xr.open_zarr(scratch / whole.REPLACED, consolidated=False)) == {1}
    whole.remove_abandoned(scratch, path)
    assert versions_in(bp.load(path)) == {1}
    assert names(tmp_path) == ["a.zarr"]


KILLED = """
import signal, sys, time, numpy as np, beamprop as bp

signal.signal(signal.SIGINT, signal.default_int_handler)  # jobs in the background are started without

def slow(work):
    for k, item in enumerate(work):
        if k == 3:
            print("now", flush=True)
            time.sleep(60)
        yield item

slab, beam = bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1)
bp.save_field(sys.argv[1], slab, beam, 2500.0, np.linspace(-1, 1, 64), np.linspace(0, 0.2, 20), memory=2e3, progress=slow)
"""


def start(path):
    """A process that is in the middle of a map."""
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "now\n"
    return process


@pytest.mark.parametrize("name", NAMES)
def test_what_killed_runs_leave_is_removed_by_the_next(tmp_path, name):
    """Not what a living process works on, nor what belongs to another file."""
    path, other = tmp_path / name, tmp_path / f"other-{name}"
    bp.save(version(1), path)
    living, killed, elsewhere = start(path), start(path), start(other)
    try:
        for process in (killed, elsewhere):
            process.kill()
            process.communicate()
        assert len(whole.scratch_of(path)) == 2
        assert versions_in(bp.load(path)) == {1}
        bp.save(version(2), path)
        assert len(whole.scratch_of(path)) == 1
        assert len(whole.scratch_of(other)) == 1
        assert versions_in(bp.load(path)) == {2}
        assert living.poll() is None
        living.send_signal(signal.SIGINT)
        _, said = living.communicate(timeout=30)
        assert "KeyboardInterrupt" in said
        assert living.returncode not in (-signal.SIGSEGV, -signal.SIGABRT)
        assert whole.scratch_of(path) == []
        assert versions_in(bp.load(path)) == {2}
    finally:
        for process in (living, killed, elsewhere):
            process.kill()
            process.communicate()


def test_a_run_killed_between_the_two_renames(tmp_path):
    """The next run puts the old store back before anything else."""
    path = tmp_path / "a.zarr"
    bp.save(version(1), path)
    scratch = tmp_path / (whole._prefix(path) + "killed")
    scratch.mkdir()
    (scratch / whole.LOCK).write_text("")
    os.rename(path, scratch / whole.REPLACED)
    whole.remove_abandoned(scratch, path)
    assert versions_in(bp.load(path)) == {1}
    assert names(tmp_path) == ["a.zarr"]


@pytest.mark.parametrize("age", [0, 2 * whole.FORGOTTEN])
def test_folders_without_a_lock_are_left_alone_for_a_while(tmp_path, age):
    """They may have been made this moment; with something in them, they are left alone for ever."""
    path = tmp_path / "a.nc"
    fresh, full = (tmp_path / (whole._prefix(path) + name) for name in ("fresh", "full"))
    for folder in (fresh, full):
        folder.mkdir()
    (full / "draft.nc").write_text("")
    for folder in (fresh, full):
        os.utime(folder, (time.time() - age,) * 2)
    bp.save(version(1), path)
    assert fresh.exists() == (age == 0)
    assert full.exists()


def test_ctrl_c_waits_for_hdf5(tmp_path, monkeypatch):
    """It takes effect when HDF5 has returned, and leaves the old file."""
    path = tmp_path / "a.nc"
    bp.save(version(1), path)
    original, after = xr.Dataset.dump_to_store, []

    def interrupted(self, store, **options):
        os.kill(os.getpid(), signal.SIGINT)
        original(self, store, **options)
        after.append(True)

    monkeypatch.setattr(xr.Dataset, "dump_to_store", interrupted)
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            bp.save(version(2), path)
    finally:
        signal.signal(signal.SIGINT, usual)
    assert after == [True]
    assert versions_in(bp.load(path)) == {1}
    assert names(tmp_path) == ["a.nc"]


@pytest.mark.parametrize("name", NAMES)
def test_files_are_on_the_disk_before_they_get_their_name(tmp_path, monkeypatch, name):
    """Every file and folder of the draft, and after the rename the folder that it is in."""
    synced, original = [], os.fsync

    def fsync(handle):
        synced.append((os.fstat(handle).st_ino, (tmp_path / name).exists()))
        original(handle)

    monkeypatch.setattr(os, "fsync", fsync)
    bp.save(version(1), tmp_path / name)
    path = tmp_path / name
    parts = [path, *path.rglob("*")] if path.is_dir() else [path]
    assert {(p.stat().st_ino, False) for p in parts} <= set(synced)
    assert synced[-1] == (tmp_path.stat().st_ino, True)


def test_where_the_system_has_no_exchange(tmp_path, monkeypatch):
    """No such function in the library, or a file system that refuses it: False, and nothing moved."""
    (tmp_path / "a").write_text("a")
    (tmp_path / "b").write_text("b")

    class Library:
        def __init__(self, *arguments, **options):
            pass

    monkeypatch.setattr(ctypes, "CDLL", Library)
    assert not whole.exchange(tmp_path / "a", tmp_path / "b")
    Library.renameat2 = Library.renamex_np = staticmethod(lambda *a: ctypes.set_errno(errno.EINVAL) or -1)
    assert not whole.exchange(tmp_path / "a", tmp_path / "b")
    assert (tmp_path / "a").read_text() == "a"
