"""Files appear whole or not at all, replace only what they may, and wrong paths and arguments are refused."""

import os

import pytest
import xarray as xr
from saved import DATASETS, SLAB, F
from versions import names

import beamprop as bp


@pytest.fixture(scope="module")
def datasets():
    return {name: make() for name, make in DATASETS.items()}


@pytest.fixture
def small():
    return bp.scattering(SLAB, F, kx_over_k0=[0.0, 0.5])


# --- whole or not at all ----------------------------------------------------------------------------------


class Stop(Exception):
    """Raised by a writer that fails half-way."""


@pytest.fixture(params=["a.nc", "a.zarr"])
def failing(request, monkeypatch):
    """A file name, and a writer of its kind that fails after it has written something."""
    method = "dump_to_store" if request.param.endswith("nc") else "to_zarr"
    original = getattr(xr.Dataset, method)

    def half(self, target, **options):
        original(self, target, **options)
        raise Stop

    def switch_on():
        monkeypatch.setattr(xr.Dataset, method, half)

    return request.param, switch_on


def test_a_writer_that_fails_leaves_nothing(tmp_path, small, failing):
    """No file under the name, no scratch beside it."""
    name, switch_on = failing
    switch_on()
    with pytest.raises(Stop):
        bp.save(small, tmp_path / name)
    assert names(tmp_path) == []


def test_a_writer_that_fails_leaves_the_old_file(tmp_path, small, datasets, failing):
    """What stood there stays as it was."""
    name, switch_on = failing
    bp.save(datasets["widths"], tmp_path / name)
    switch_on()
    with pytest.raises(Stop):
        bp.save(small, tmp_path / name)
    assert names(tmp_path) == [name]
    xr.testing.assert_identical(bp.load(tmp_path / name), datasets["widths"])


def test_the_name_appears_when_the_file_is_complete(tmp_path, small, monkeypatch):
    """While it is being written the file has another name."""
    seen = []
    original = xr.Dataset.dump_to_store

    def watched(self, target, **options):
        original(self, target, **options)
        seen.append((tmp_path / "a.nc").exists())

    monkeypatch.setattr(xr.Dataset, "dump_to_store", watched)
    bp.save(small, tmp_path / "a.nc")
    assert seen == [False]
    assert (tmp_path / "a.nc").exists()


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_overwriting(tmp_path, small, datasets, name):
    """The newer dataset takes the older one's place, wholly."""
    bp.save(datasets["field"], tmp_path / name)
    bp.save(small, str(tmp_path / name))
    xr.testing.assert_identical(bp.load(tmp_path / name), small)
    assert names(tmp_path) == [name]


def test_overwriting_what_is_loaded(tmp_path, small):
    """load closes its file: the same name can be written from what was loaded."""
    bp.save(small, tmp_path / "a.nc")
    ds = bp.load(tmp_path / "a.nc")
    bp.save(ds.assign_attrs(note="again"), tmp_path / "a.nc")
    assert bp.load(tmp_path / "a.nc").attrs["note"] == "again"


@pytest.mark.skipif(os.name == "nt", reason="POSIX permissions")
def test_files_have_the_usual_permissions(tmp_path, small):
    """Readable by whom the umask lets, not by the writer alone."""
    old = os.umask(0o022)
    try:
        bp.save(small, tmp_path / "a.nc")
    finally:
        os.umask(old)
    assert (tmp_path / "a.nc").stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_a_folder_of_other_things_is_not_overwritten(tmp_path, small, name):
    """A folder by that name which is no Zarr store holds somebody's files: refused, and left alone."""
    (tmp_path / name).mkdir()
    (tmp_path / name / "thesis.txt").write_text("years of work")
    with pytest.raises((ValueError, OSError)):
        bp.save(small, tmp_path / name)
    assert (tmp_path / name / "thesis.txt").read_text() == "years of work"
    assert names(tmp_path) == [name]


# --- refused ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["a.txt", "a", "a.npz", ".nc", "nc"])
def test_unknown_endings(tmp_path, small, name):
    """A ValueError that names the path and lists the endings, by save and load alike."""
    for ask in (lambda: bp.save(small, tmp_path / name), lambda: bp.load(tmp_path / name)):
        with pytest.raises(ValueError, match=r"^path:.*\.nc.*\.zarr"):
            ask()
    assert names(tmp_path) == []


@pytest.mark.parametrize("name", ["a.nc", "a.zarr"])
def test_missing_folders_and_files(tmp_path, small, name):
    """Folders are not made, and a missing file is a ValueError."""
    with pytest.raises(ValueError, match=r"^path:.*existing folder"):
        bp.save(small, tmp_path / "none" / name)
    with pytest.raises(ValueError, match=r"^path:.*existing file"):
        bp.load(tmp_path / name)
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"ds": 3}, "^ds:"),
        ({"compression": 10}, "^compression:"),
        ({"compression": -1}, "^compression:"),
        ({"compression": "a"}, "^compression:"),
        ({"digits": 0}, "^digits:"),
        ({"digits": 16}, "^digits:"),
        ({"digits": 2.5}, "^digits:"),
        ({"digits": True}, "^digits:"),
    ],
)
def test_wrong_arguments_of_save(tmp_path, small, change, match):
    """No dataset, or a compression that zlib does not have."""
    with pytest.raises(ValueError, match=match):
        bp.save(**({"ds": small, "path": tmp_path / "a.nc"} | change))
    assert names(tmp_path) == []


@pytest.mark.parametrize("name", ["A.NC", "a.nc4", "a.netcdf", "a.h5"])
def test_other_endings_of_netcdf(tmp_path, small, name):
    """Capital letters and the other common endings work too."""
    bp.save(small, tmp_path / name)
    xr.testing.assert_identical(bp.load(tmp_path / name), small)
