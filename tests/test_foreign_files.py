"""Files of others: what would run code, leave the file or ask for much memory is refused before it is opened."""

import importlib.metadata
import json
import os
import subprocess
import sys

import h5netcdf
import h5py
import netCDF4
import numpy as np
import pytest
import xarray as xr
import zarr

import beamprop as bp
from beamprop.io.storage import netcdf


@pytest.fixture
def small():
    return bp.scattering(bp.Slab(bp.lmmd_cell(), 5), 2500.0, kx_over_k0=[0.0, 0.5])


@pytest.fixture
def store(tmp_path, small):
    """A store without checksums, as earlier versions and xarray write it, that only wants to be made hostile."""
    small.to_zarr(tmp_path / "a.zarr", consolidated=False)
    return tmp_path / "a.zarr"


def change(file, **items):
    """Change the metadata of a Zarr node."""
    file.write_text(json.dumps(json.loads(file.read_text()) | items))


# --- Zarr -------------------------------------------------------------------------------------------------


def test_a_store_of_format_2_with_a_pickle_filter_runs_nothing(tmp_path):
    """Its filter would call any function on load: here, one that makes a file."""
    code = f"open({str(tmp_path / 'ran')!r}, 'w').close()"
    payload = f"cbuiltins\nexec\n(V{code}\ntR.".encode()  # a pickle, protocol 0
    array = tmp_path / "a.zarr" / "p"
    array.mkdir(parents=True)
    (tmp_path / "a.zarr" / ".zgroup").write_text('{"zarr_format": 2}')
    (tmp_path / "a.zarr" / ".zattrs").write_text("{}")
    (array / ".zarray").write_text(
        json.dumps(
            {
                "zarr_format": 2,
                "shape": [1],
                "chunks": [1],
                "dtype": "|O",
                "compressor": None,
                "fill_value": "",
                "filters": [{"id": "vlen-utf8"}, {"id": "pickle", "protocol": 0}],
                "order": "C",
            }
        )
    )
    (array / ".zattrs").write_text('{"_ARRAY_DIMENSIONS": ["x"]}')
    (array / "0").write_bytes(payload)
    with pytest.raises(ValueError, match=r"a\.zarr: expected a Zarr store of format 3, got format 2"):
        bp.load(tmp_path / "a.zarr")
    assert not (tmp_path / "ran").exists()
    allowed = os.environ | {"NUMCODECS_ALLOW_UNSAFE_PICKLE_DECODE": "1"}  # as earlier versions of numcodecs are
    unsafe = [int(v) for v in importlib.metadata.version("numcodecs").split(".")[:2]] < [
        0,
        17,
    ]  # what zarr itself would do
    for package, read, runs in (
        ("beamprop", "beamprop.load({!r})", False),
        ("zarr", "zarr.open({!r}, mode='r')['p'][:]", unsafe),
    ):
        code = f"import {package}; {read.format(str(tmp_path / 'a.zarr'))}"
        subprocess.run([sys.executable, "-c", code], capture_output=True, check=False, env=allowed)
        assert (tmp_path / "ran").exists() == runs


@pytest.mark.parametrize("inner", [".zgroup", ".zarray", ".zattrs"])
def test_format_2_anywhere_in_a_store(store, inner):
    """Beside the metadata of format 3, too."""
    (store / "t" / inner).write_text("{}")
    with pytest.raises(ValueError, match=r"a\.zarr: .*format 2"):
        bp.load(store)


@pytest.mark.parametrize(
    "codec",
    [
        "numcodecs.pickle",
        "gzip",
        "blosc",
        "sharding_indexed",
        "numcodecs.zstd",
        {"name": "numcodecs.pickle"},
        {"name": "transpose"},
    ],
)
def test_codecs_that_save_does_not_write(store, codec):
    """Named, with the variable."""
    about = json.loads((store / "t" / "zarr.json").read_text())
    change(store / "t" / "zarr.json", codecs=[*about["codecs"], codec])
    name = codec if isinstance(codec, str) else codec["name"]
    with pytest.raises(ValueError, match=rf"a\.zarr: 't': expected the codecs .*, got '{name}'"):
        bp.load(store)


def test_codecs_in_inner_groups_and_consolidated_metadata(store):
    """Whoever reads them, they are looked at."""
    about = json.loads((store / "t" / "zarr.json").read_text())
    hostile = about | {"codecs": [{"name": "numcodecs.pickle"}]}
    (store / "inner" / "t").mkdir(parents=True)
    (store / "inner" / "zarr.json").write_text('{"zarr_format": 3, "node_type": "group", "attributes": {}}')
    (store / "inner" / "t" / "zarr.json").write_text(json.dumps(hostile))
    with pytest.raises(ValueError, match=r"'inner/t': expected the codecs"):
        bp.load(store)
    (store / "inner" / "t" / "zarr.json").write_text(json.dumps(about))
    for name, what in (("t", hostile), ("../t", about)):
        change(
            store / "zarr.json",
            consolidated_metadata={"kind": "inline", "must_understand": False, "metadata": {name: what}},
        )
        with pytest.raises(
            ValueError, match=r"expected the codecs|expected consolidated metadata of what is in the store"
        ):
            bp.load(store)


@pytest.mark.parametrize("target", ["outside", "inside"])
def test_links_in_a_store(store, target):
    """A chunk that is a link could show any file of the machine."""
    chunk = store / "t" / "c" / "0"
    aim = store.parent / "secret" if target == "outside" else store / "r" / "c" / "0"
    aim.write_bytes(chunk.read_bytes())
    chunk.unlink()
    chunk.symlink_to(aim)
    with pytest.raises(ValueError, match=r"a\.zarr: expected a Zarr store without links, got the link"):
        bp.load(store)


@pytest.mark.parametrize(
    ("change_to", "said"),
    [
        ({"storage_transformers": [{"name": "x"}]}, "storage transformers"),
        ({"chunk_grid": {"name": "rectangular", "configuration": {}}}, "regular grid"),
        ({"chunk_key_encoding": {"name": "v2", "configuration": {"separator": "/"}}}, "default names"),
        ({"chunk_key_encoding": {"name": "default", "configuration": {"separator": "."}}}, "parted by '/'"),
        ({"codecs": None}, "metadata of an array"),
        ({"shape": [-1]}, "lengths"),
        ({"shape": [10**12]}, "of which .* are stored"),
        ({"extra": 1}, "'extra'"),
        ({"zarr_format": 2}, "format 3"),
        ({"attributes": [1]}, "attributes with names"),
    ],
)
def test_other_metadata_that_save_does_not_write(store, change_to, said):
    """With the store and the variable."""
    change(store / "t" / "zarr.json", **change_to)
    with pytest.raises(ValueError, match=rf"a\.zarr: 't': expected .*{said}"):
        bp.load(store)


@pytest.mark.parametrize("text", ["", "{", "[1]", "[" * 100_000, "null"])
def test_metadata_that_are_none(store, text):
    """No traceback of a parser."""
    (store / "t" / "zarr.json").write_text(text)
    with pytest.raises(ValueError, match=r"t.zarr\.json: expected the metadata"):
        bp.load(store)


def test_a_store_that_is_a_file(tmp_path):
    """A zip, say."""
    (tmp_path / "a.zarr").write_text("PK")
    with pytest.raises(ValueError, match=r"a\.zarr: expected a Zarr store, which is a folder"):
        bp.load(tmp_path / "a.zarr")


@pytest.mark.filterwarnings("ignore:Consolidated metadata")
@pytest.mark.parametrize("consolidated", [False, True])
def test_plain_stores_of_xarray_are_read(tmp_path, small, consolidated):
    """Written without checksums, as by earlier versions."""
    small.to_zarr(tmp_path / "a.zarr", consolidated=consolidated)
    xr.testing.assert_identical(bp.load(tmp_path / "a.zarr"), small)


def test_a_store_in_blocks_of_an_earlier_version_is_read(tmp_path):
    """Chunks that were never written are fill values there."""
    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    array = group.create_array(
        "p", shape=(4,), dtype=complex, chunks=(2,), fill_value=complex(np.nan, np.nan), dimension_names=["x"]
    )
    array[:2] = [1j, 2]
    np.testing.assert_array_equal(
        bp.load(tmp_path / "a.zarr").p, [1j, 2, complex(np.nan, np.nan), complex(np.nan, np.nan)]
    )


# --- netCDF -----------------------------------------------------------------------------------------------


def test_a_link_into_another_file(tmp_path):
    """An external link could show any HDF5 file of the machine."""
    with h5py.File(tmp_path / "secret.h5", "w") as h5:
        h5["x"] = [1.0]
    with h5py.File(tmp_path / "a.nc", "w") as h5:
        h5["x"] = h5py.ExternalLink(str(tmp_path / "secret.h5"), "x")
    with pytest.raises(
        ValueError, match=r"a\.nc: expected variables that lie in the file, got a link at '/x' \(ExternalLink\)"
    ):
        bp.load(tmp_path / "a.nc")


def test_values_in_another_file(tmp_path):
    """External storage could show any file."""
    (tmp_path / "secret").write_bytes(bytes(16))
    with h5py.File(tmp_path / "a.nc", "w") as h5:
        h5.create_dataset("x", (2,), "f8", external=[(str(tmp_path / "secret"), 0, 16)])
    with pytest.raises(ValueError, match=r"a\.nc: expected variables that lie in the file, got '/x' with values in"):
        bp.load(tmp_path / "a.nc")


def test_virtual_datasets_in_groups(tmp_path):
    """They could show any HDF5 file; groups are looked at, too, and a group that holds itself is no trap."""
    layout = h5py.VirtualLayout((2,), "f8")
    layout[:] = h5py.VirtualSource(str(tmp_path / "secret.h5"), "x", (2,))
    with h5py.File(tmp_path / "a.nc", "w") as h5:
        h5["inner/again"] = h5["/"]
        h5["inner"].create_virtual_dataset("x", layout)
    with pytest.raises(ValueError, match=r"a\.nc: expected .*, got '/inner/x' made of others"):
        bp.load(tmp_path / "a.nc")


def test_filters_that_would_be_loaded(tmp_path):
    """HDF5 loads a filter that it does not know from a plug-in."""
    with h5py.File(tmp_path / "a.nc", "w") as h5:
        plist = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
        plist.set_chunk((2,))
        plist.set_filter(32015, h5py.h5z.FLAG_OPTIONAL, (3,))
        h5py.h5d.create(h5.id, b"x", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((2,)), plist)
    with pytest.raises(ValueError, match=r"a\.nc: expected the filters deflate, .*, got '/x' with filter 32015"):
        bp.load(tmp_path / "a.nc")


def test_few_bytes_do_not_ask_for_gigabytes(tmp_path):
    """A variable whose values were never stored reads as fill values."""
    with h5netcdf.File(tmp_path / "a.nc", "w") as file:
        file.dimensions = {"x": 10**11}
        file.create_variable("p", ("x",), float, chunks=(1000,))
    with pytest.raises(ValueError, match=r"a\.nc: expected values, got '/p' of 8e\+11 bytes"):
        bp.load(tmp_path / "a.nc")


@pytest.mark.parametrize(
    "text", [b"", b"CDF\x01" + bytes(40), b"\x89HDF\r\n\x1a\n" + bytes(200), b"no file of netCDF at all"]
)
def test_files_that_are_none(tmp_path, text):
    """No traceback of h5py."""
    (tmp_path / "a.nc").write_bytes(text)
    with pytest.raises(ValueError, match=r"a\.nc: expected a netCDF file, got one that cannot be read"):
        bp.load(tmp_path / "a.nc")


@pytest.mark.parametrize(
    "options", [{}, {"zlib": True, "complevel": 4}, {"compression": "lzf"}, {"fletcher32": True, "shuffle": True}]
)
def test_files_of_earlier_versions_are_read(tmp_path, small, options):
    """Compound complex numbers, zlib or not, no checksums: written as they were."""
    small.to_netcdf(
        tmp_path / "a.nc", engine="h5netcdf", encoding={n: options for n, v in small.variables.items() if v.ndim}
    )
    xr.testing.assert_identical(bp.load(tmp_path / "a.nc"), small)


@pytest.mark.parametrize("engine", ["h5netcdf", "netcdf4"])
def test_plain_files_of_xarray_are_read(tmp_path, engine):
    """Numbers, strings and times."""
    ds = xr.Dataset(
        {"w": ("x", [1.0, np.nan, 3.0]), "n": ((), 7), "s": ("x", ["a", "bc", ""])},
        {"x": [0.0, 1.0, 2.0], "t": ("x", np.array(["2020-01-01", "2020-01-02", "2021-01-01"], "M8[ns]"))},
        {"note": "é", "list": [1, 2, 3]},
    )
    ds.to_netcdf(tmp_path / "a.nc", engine=engine)
    xr.testing.assert_equal(bp.load(tmp_path / "a.nc"), ds)


def test_what_another_library_changed_is_read(tmp_path, small):
    """Attributes and variables that were added on purpose, by netCDF-C or xarray, are no damage."""
    bp.save(small, tmp_path / "a.nc")
    with netCDF4.Dataset(tmp_path / "a.nc", "a") as nc:
        nc.note = "measured again"
    assert bp.load(tmp_path / "a.nc").attrs["note"] == "measured again"
    xr.Dataset({"more": ("y", [1.0, 2.0])}).to_netcdf(tmp_path / "a.nc", mode="a", engine="h5netcdf")
    assert set(bp.load(tmp_path / "a.nc").data_vars) == {*small.data_vars, "more"}


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_what_xarray_made_of_our_file_is_read(tmp_path, small, ending):
    """A part of a dataset, written by xarray with all attributes: the lists of what was in the first file are not copied, or not believed."""
    bp.save(small, tmp_path / f"a.{ending}")
    if ending == "nc":
        with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as opened:
            assert netcdf.RECORD in opened.attrs
            opened.drop_vars(["t_real", "t_imag"]).isel(kx_over_k0=[0]).to_netcdf(tmp_path / "b.nc", engine="h5netcdf")
    else:
        with xr.open_zarr(tmp_path / "a.zarr") as opened:
            assert opened.attrs == small.attrs
            opened.drop_vars("t").isel(kx_over_k0=[0]).to_zarr(tmp_path / "b.zarr", consolidated=False)
    xr.testing.assert_identical(bp.load(tmp_path / f"b.{ending}"), small.drop_vars("t").isel(kx_over_k0=[0]))
