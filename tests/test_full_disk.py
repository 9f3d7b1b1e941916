"""Full disks and limits of file sizes: an OSError that names the file, a process that lives on, and nothing half-written."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop.io.storage import netcdf
from beamprop.io.storage.guarded import GuardedFile

resource = pytest.importorskip("resource")

#: Written in a process of its own, since a failure here used to end the process.
WRITER = """
import os, resource, sys
import numpy as np, xarray as xr, beamprop as bp

path, limit, how, reserve = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4]
if reserve == "no" and hasattr(os, "posix_fallocate"):
    del os.posix_fallocate
rng = np.random.default_rng(1)
values = rng.standard_normal((300, 200)) + 1j
ds = xr.Dataset({"p": (("z", "x"), values), "q": ("x", values[0].real)}, {"x": np.arange(200.0)})
if limit:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
started = []

def blocks(work):
    for item in work:
        started.append(item)
        yield item

try:
    if how == "save":
        bp.save(ds, path)
    elif how == "compressed":
        bp.save(ds, path, compression=1)
    else:
        slab, beam = bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1)
        bp.save_field(path, slab, beam, 2500.0, np.linspace(-1, 1, 200), np.linspace(0, 0.3, 300), memory=1e5, progress=blocks)
except OSError as error:
    print(type(error).__name__, error.errno, error.filename, len(started))
"""


def write(path, limit, how="save", reserve="yes"):
    """The writer's answer; it must end as a process does that has nothing left to say."""
    arguments = [sys.executable, "-c", WRITER, str(path), str(limit), how, reserve]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (done.returncode, done.stderr[-500:])
    return done.stdout.split()


@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("how", ["save", "blocks"])
@pytest.mark.parametrize("reserve", ["yes", "no"])
def test_a_limit_of_file_sizes(tmp_path, ending, how, reserve):
    """From the first byte to the last: an OSError with the file's name, the old file left as it was."""
    path = tmp_path / f"a.{ending}"
    old = xr.Dataset({"q": ("x", [1.0, 2.0])})
    bp.save(old, path)
    for limit in (20_000,) if ending == "zarr" else (300, 955_000):
        kind, number, name, _ = write(path, limit, how, reserve)
        assert (kind, int(number), name) == ("OSError", errno.EFBIG, str(path))
        assert os.listdir(tmp_path) == [path.name]
        assert bp.load(path).identical(old)
    assert write(path, 2**21, how, reserve) == []
    assert bp.load(path).p.shape == (300, 200)


def test_a_limit_met_by_compressed_values(tmp_path):
    """Their size is not known before: the failing write is found on the way."""
    assert write(tmp_path / "a.nc", 400_000, "compressed")[:2] == ["OSError", str(errno.EFBIG)]
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="no reservations here")
def test_the_space_of_a_map_is_reserved_before_the_work(tmp_path):
    """Not one block is computed for a file that has no room."""
    *_, started = write(tmp_path / "a.nc", 900_000, "blocks")
    assert started == "0"


@pytest.mark.skipif(sys.platform != "linux", reason="mounts a small disk of memory")
@pytest.mark.parametrize("ending", ["nc", "zarr"])
@pytest.mark.parametrize("how", ["save", "blocks"])
@pytest.mark.parametrize("reserve", ["yes", "no"])
def test_a_full_disk(tmp_path, ending, how, reserve):
    """The real thing, where the tests may mount one."""
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", str(disk)], capture_output=True, check=False
    ).returncode:
        pytest.skip("may not mount")
    try:
        kind, number, name, _ = write(disk / f"a.{ending}", 0, how, reserve)
        assert (kind, int(number), name) == ("OSError", errno.ENOSPC, str(disk / f"a.{ending}"))
        assert os.listdir(disk) == []
    finally:
        subprocess.run(["umount", str(disk)], check=True)


class Full:
    """A file that takes so many bytes and no more."""

    def __init__(self, file, room):
        self._file, self._room = file, room

    def write(self, data):
        self._room -= len(data)
        if self._room < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return self._file.write(data[: max(1, len(data) // 2)])  # systems may write less than asked

    def __getattr__(self, name):
        return getattr(self._file, name)


@pytest.mark.parametrize("room", [0, 100, 3000, 50_000])
def test_hdf5_sees_what_it_wrote_although_the_disk_is_full(tmp_path, room):
    """Bytes that could not be written are read back; the failure is told afterwards."""
    values = np.arange(20_000.0)
    guarded = GuardedFile(tmp_path / "a.h5")
    guarded._file = Full(guarded._file, room)
    with h5py.File(guarded, "w") as h5:
        for k in range(20):
            h5.create_dataset(f"v{k}", data=values + k, chunks=(1000,), fletcher32=True)
        for k in range(20):
            np.testing.assert_array_equal(h5[f"v{k}"], values + k)
    with pytest.raises(OSError, match="No space"):
        guarded.finish()
    guarded.close()


def test_a_guarded_file_is_the_file(tmp_path):
    """Where nothing fails, what h5py writes is on the disk, and what was reserved is given back."""
    guarded = GuardedFile(tmp_path / "a.h5", reserve=10**6)
    if hasattr(os, "posix_fallocate"):
        assert (tmp_path / "a.h5").stat().st_size == 10**6
    with h5py.File(guarded, "w") as h5:
        h5["v"] = np.arange(1000.0)
    guarded.finish()
    guarded.close()
    assert (tmp_path / "a.h5").stat().st_size < 20_000
    with h5py.File(tmp_path / "a.h5") as h5:
        np.testing.assert_array_equal(h5["v"], np.arange(1000.0))


def test_the_command_says_it(tmp_path):
    """Exit 1 with the name of the file: nothing that was typed is wrong."""
    code = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000)); from beamprop.cli import main; main()"
    for options in (["-o", str(tmp_path / "a.nc")], ["-p", str(tmp_path / "a.png")]):
        done = subprocess.run(
            [sys.executable, "-c", code, "bloch", *options],
            capture_output=True,
            text=True,
            check=False,
            cwd=Path(bp.__file__).parents[1],
        )
        assert done.returncode == 1, done.stderr
        assert "Error" in done.stderr
        assert options[1] in done.stderr
        assert "Traceback" not in done.stderr
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("shape", [(), (5,), (300_000,), (17, 61_000), (3, 0, 4), (2, 3, 5, 70_000), (1500, 1500)])
def test_what_is_reserved_is_what_is_written(tmp_path, shape):
    """Nearly: enough for the values and the tables, and not much more than the values."""
    ds = xr.Dataset({"v": ([f"d{k}" for k in range(len(shape))], np.ones(shape))})
    chunks = netcdf._chunks(ds.v.variable)
    assert 8 * np.prod(chunks, dtype=int) <= netcdf.CHUNK
    stored = netcdf._stored(shape, chunks, 8)
    assert ds.v.nbytes <= stored <= 1.2 * ds.v.nbytes
    bp.save(ds, tmp_path / "a.nc")
    taken = (tmp_path / "a.nc").stat().st_size
    assert stored <= taken <= stored * (1 + netcdf.FOR_VALUES) + netcdf.FOR_FILE + netcdf.FOR_VARIABLE
