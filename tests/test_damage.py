"""Damage is noticed: every bit of a file, what is missing, what is cut off; the message names file, variable and what is wrong."""

import json
import random
import shutil
import zlib

import h5py
import netCDF4
import numpy as np
import pytest
import zarr

import beamprop as bp
from beamprop.io.storage import seal


@pytest.fixture(scope="module")
def ds():
    """Complex and real variables, coordinates, scalars, attributes, and one variable of NaN alone."""
    field = bp.field(
        bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.1), [2400.0, 2500.0], np.linspace(-0.4, 0.4, 11), [0.0, 0.1]
    )
    nothing = (field.p.real * np.nan).assign_attrs(field.p.attrs)
    return field.assign(nothing=nothing, scalar=((), 2.5, {"units": "m"}))


def outcome(path, ds):
    """What load says of a file: None if it gives the dataset."""
    try:
        loaded = bp.load(path)
    except ValueError as error:
        return str(error)
    return None if loaded.identical(ds) else "another dataset, silently"


def files_of(path):
    return [path] if path.is_file() else sorted(f for f in path.rglob("*") if f.is_file())


@pytest.mark.parametrize(
    "options",
    [
        {"path": "a.nc"},
        {"path": "a.nc", "compression": 3},
        {"path": "a.zarr"},
        {"path": "a.nc", "split_complex": False},
    ],
    ids=str,
)
def test_every_flipped_bit_is_noticed_or_changes_nothing(tmp_path, ds, options):
    """400 bits drawn from all files, headers and checksums among them: a ValueError with the file's name, or the same dataset."""
    path = tmp_path / options["path"]
    bp.save(ds, **(options | {"path": path}))
    rng, files = random.Random(7), files_of(path)
    refused = 0
    for _ in range(400):
        file = rng.choices(files, [f.stat().st_size for f in files])[0]
        good = file.read_bytes()
        bit = rng.randrange(8 * len(good))
        bad = bytearray(good)
        bad[bit // 8] ^= 1 << bit % 8
        file.write_bytes(bad)
        refusal = outcome(path, ds)
        assert refusal is None or str(path) in refusal, (file.name, bit)
        refused += refusal is not None
        file.write_bytes(good)
    assert refused > 390
    assert bp.load(path).identical(ds)


def test_every_flipped_bit_of_a_mat_file_is_noticed_or_changes_nothing(tmp_path, ds):
    """400 bits behind the 128 bytes of text with which the format begins; zlib's checksums tell, and some bits of zlib's mean nothing."""
    path = tmp_path / "a.mat"
    bp.save(ds, path)
    rng, good, refused = random.Random(8), path.read_bytes(), 0
    for _ in range(400):
        bit = rng.randrange(8 * 128, 8 * len(good))
        path.write_bytes(good[: bit // 8] + bytes([good[bit // 8] ^ 1 << bit % 8]) + good[bit // 8 + 1 :])
        refusal = outcome(path, ds)
        assert refusal is None or str(path) in refusal, bit
        refused += refusal is not None
    assert refused > 390
    path.write_bytes(good)
    assert outcome(path, ds) is None


def test_bytes_of_the_root_of_a_store(tmp_path, ds):
    """The list of checksums is itself checked, and its name: every fifth byte, all kinds of bits."""
    path = tmp_path / "a.zarr"
    bp.save(ds[["scalar"]], path)
    good = (path / "zarr.json").read_bytes()
    for k in range(0, len(good), 5):
        bad = bytearray(good)
        bad[k] ^= 1 << k % 7
        (path / "zarr.json").write_bytes(bad)
        refusal = outcome(path, ds[["scalar"]])
        assert refusal is None or str(path) in refusal, k


@pytest.mark.parametrize("kind", ["nc", "zarr"])
def test_damage_is_named_with_its_variable(tmp_path, ds, kind):
    """Which variable, and that its checksum is wrong."""
    path = tmp_path / f"a.{kind}"
    bp.save(ds, path)
    wanted = ds.p.values.real.tobytes()[:8]
    if kind == "nc":
        raw = bytearray(path.read_bytes())
        raw[raw.index(wanted)] ^= 1
        path.write_bytes(raw)
        said = r"a\.nc: .*damage in the values of variable 'p_real' \(wrong checksum\)"
    else:
        chunk = next(f for f in files_of(path / "p") if f.name != "zarr.json")
        raw = bytearray(chunk.read_bytes())
        raw[-1] ^= 1
        chunk.write_bytes(raw)
        said = r"a\.zarr: .*damage in variable 'p': its chunk 'c/.*' is not as it was written \(wrong checksum\)"
    with pytest.raises(ValueError, match=said):
        bp.load(path)


def test_attributes_are_guarded(tmp_path, ds):
    """A unit that became another one."""
    bp.save(ds, tmp_path / "a.nc")
    raw = (tmp_path / "a.nc").read_bytes()
    assert b"exp(-i w t)" in raw
    (tmp_path / "a.nc").write_bytes(raw.replace(b"exp(-i w t)", b"exp(+i w t)"))
    with pytest.raises(ValueError, match=r"a\.nc: .*damage in the names, attributes or layout"):
        bp.load(tmp_path / "a.nc")
    bp.save(ds, tmp_path / "a.zarr")
    about = tmp_path / "a.zarr" / "x" / "zarr.json"
    text = about.read_text()
    assert '"m"' in text
    about.write_text(text.replace('"m"', '"k"'))
    with pytest.raises(ValueError, match=r"a\.zarr: .*damage in variable 'x': its dimensions, type or attributes"):
        bp.load(tmp_path / "a.zarr")


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.9, 0.99])
def test_files_that_were_cut_off(tmp_path, ds, share):
    """With the name, and without a traceback of h5py."""
    bp.save(ds, tmp_path / "a.nc")
    raw = (tmp_path / "a.nc").read_bytes()
    end = raw.index(b'{"names"')  # of what HDF5 knows
    (tmp_path / "a.nc").write_bytes(raw[: int(share * end)])
    with pytest.raises(
        ValueError, match=r"a\.nc: expected a netCDF file, got one that cannot be read, damaged or cut off"
    ):
        bp.load(tmp_path / "a.nc")


def test_a_file_without_its_checksums_is_read(tmp_path, ds):
    """As those of earlier versions; HDF5's own checksums remain."""
    bp.save(ds, tmp_path / "a.nc")
    raw = (tmp_path / "a.nc").read_bytes()
    end = raw.index(b'{"names"')
    (tmp_path / "a.nc").write_bytes(raw[:end])
    assert bp.load(tmp_path / "a.nc").identical(ds)
    bad = bytearray(raw[:end])
    bad[bad.index(ds.p.values.real.tobytes()[:8])] ^= 1
    (tmp_path / "a.nc").write_bytes(bad)
    with pytest.raises(ValueError, match=r"a\.nc: expected the values of variable 'p_real', got damaged ones"):
        bp.load(tmp_path / "a.nc")


def test_bytes_that_were_put_in(tmp_path, ds):
    """The length is checked, too."""
    bp.save(ds, tmp_path / "a.nc")
    raw = (tmp_path / "a.nc").read_bytes()
    end = raw.index(b'{"names"')
    (tmp_path / "a.nc").write_bytes(raw[:end] + b"0" + raw[end:])
    with pytest.raises(ValueError, match=r"a\.nc: .*another length"):
        bp.load(tmp_path / "a.nc")


def test_a_variable_that_is_missing(tmp_path, ds):
    """Taken out by a library that knows nothing of the list of variables."""
    bp.save(ds, tmp_path / "a.nc")
    with h5py.File(tmp_path / "a.nc", "a") as h5:
        del h5["scalar"]
    with pytest.raises(ValueError, match=r"a\.nc: expected the variable 'scalar', which was written, got"):
        bp.load(tmp_path / "a.nc")
    bp.save(ds, tmp_path / "a.zarr")
    shutil.rmtree(tmp_path / "a.zarr" / "scalar")
    with pytest.raises(ValueError, match=r"a\.zarr: .*damage in variable 'scalar': it is missing"):
        bp.load(tmp_path / "a.zarr")


def test_a_variable_of_another_shape(tmp_path, ds):
    """Written anew, shorter, under the old name."""
    bp.save(ds, tmp_path / "a.nc")
    with h5py.File(tmp_path / "a.nc", "a") as h5:
        del h5["scalar"]
        h5["scalar"] = np.float32(1)
    with pytest.raises(ValueError, match=r"a\.nc: expected variable 'scalar' of shape and type .*float64.*float32"):
        bp.load(tmp_path / "a.nc")


def test_a_chunk_that_is_missing(tmp_path, ds):
    """Zarr would read NaN; a chunk that was never written because it is NaN is none that is missing."""
    bp.save(ds, tmp_path / "a.zarr")
    assert bp.load(tmp_path / "a.zarr").identical(ds)
    chunk = next(f for f in files_of(tmp_path / "a.zarr" / "p") if f.name != "zarr.json")
    chunk.unlink()
    with pytest.raises(ValueError, match=r"a\.zarr: .*damage in variable 'p': its chunk 'c/.*' is missing"):
        bp.load(tmp_path / "a.zarr")


@pytest.mark.parametrize("kind", ["nc", "zarr"])
def test_maps_in_blocks_are_guarded(tmp_path, kind):
    """By the same checksums."""
    path = tmp_path / f"map.{kind}"
    bp.save_field(
        path,
        bp.Slab(bp.lmmd_cell(), 5),
        bp.GaussianBeam(0.1),
        2500.0,
        np.linspace(-1, 1, 50),
        np.linspace(0, 0.2, 9),
        memory=2e3,
    )
    whole = bp.load(path)
    file = path if kind == "nc" else sorted(f for f in files_of(path / "p") if f.name != "zarr.json")[3]
    good = file.read_bytes()
    where = good.index(whole.p.values[3].imag.tobytes()[:16]) if kind == "nc" else len(good) // 2
    file.write_bytes(good[:where] + bytes([good[where] ^ 4]) + good[where + 1 :])
    with pytest.raises(ValueError, match=rf"map\.\w+: .*variable '{'p_imag' if kind == 'nc' else 'p'}'"):
        bp.load(path)
    if kind == "zarr":
        file.unlink()
        with pytest.raises(ValueError, match=r"map\.zarr: .*variable 'p': its chunk .* is missing"):
            bp.load(path)


def test_the_formats_own_checksums_are_on(tmp_path, ds):
    """Fletcher-32 and CRC-32C guard those who read by parts, with other programs."""
    bp.save(ds, tmp_path / "a.nc")
    with h5py.File(tmp_path / "a.nc") as h5:
        assert [n for n, v in h5.items() if isinstance(v, h5py.Dataset) and v.shape and not v.fletcher32] == []
    with netCDF4.Dataset(tmp_path / "a.nc") as nc:
        assert nc["p_real"].filters()["fletcher32"]
    bp.save(ds, tmp_path / "a.zarr")
    for about in (tmp_path / "a.zarr").rglob("zarr.json"):
        record = json.loads(about.read_text())
        assert record["node_type"] == "group" or record["codecs"][-1]["name"] == "crc32c", about
    array = zarr.open_group(tmp_path / "a.zarr", mode="r")["p"]
    chunk = next(f for f in files_of(tmp_path / "a.zarr" / "p") if f.name != "zarr.json")
    raw = bytearray(chunk.read_bytes())
    raw[-1] ^= 1
    chunk.write_bytes(raw)
    with pytest.raises(ValueError, match="checksum"):
        array[...]


def test_stretches_cover_the_file(tmp_path):
    """Whatever lies where, each byte is in one."""
    path = tmp_path / "a"
    path.write_bytes(bytes(range(100)))
    seal.seal(path, [(10, 20, "b"), (20, 30, "b"), (30, 40, "a"), (90, 100, "b"), (50, 50, "c")])
    raw = path.read_bytes()
    record = json.loads(raw[100 : 100 + int(raw[-seal.FOOT : -seal.FOOT + 16], 16)])
    lengths, crcs, names = zip(*record["stretches"], strict=True)
    assert lengths == (10, 20, 10, 50, 10)
    assert [record["names"][k] for k in names] == ["", "b", "a", "", "b"]
    assert crcs[1] == zlib.crc32(bytes(range(10, 30)))
    seal.check_seal(path)


def test_damage_in_an_old_file_is_named(tmp_path, ds):
    """A file of an earlier version has no checksums, yet what cannot be read says so."""
    old = ds[["p", "x"]]
    old.to_netcdf(tmp_path / "a.nc", engine="h5netcdf", encoding={"p": {"zlib": True, "complevel": 4}})
    with h5py.File(tmp_path / "a.nc") as h5:
        chunk = h5["p"].id.get_chunk_info(0)
    raw = bytearray((tmp_path / "a.nc").read_bytes())
    raw[chunk.byte_offset : chunk.byte_offset + 20] = bytes(20)
    (tmp_path / "a.nc").write_bytes(raw)
    with pytest.raises(ValueError, match=r"a\.nc: expected the values of variable 'p', got damaged ones"):
        bp.load(tmp_path / "a.nc")
