"""Files: what is written is read back the same, by us and by others, and nothing is ever half-written."""

import json
import subprocess
import sys
import warnings

import h5py
import netCDF4
import numpy as np
import pytest
import xarray as xr
from saved import BEAM, DATASETS, SLAB, F, X
from versions import names

import beamprop as bp

#: What becomes of a netCDF file's variables, by hand: pairs of real ones for complex ones, codes for words.
WORDS = {"side": ["reflected", "transmitted"]}


@pytest.fixture(scope="module")
def datasets():
    return {name: make() for name, make in DATASETS.items()}


@pytest.fixture
def small():
    return bp.scattering(SLAB, F, kx_over_k0=[0.0, 0.5])


# --- round trips ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", DATASETS)
@pytest.mark.parametrize(
    "options",
    [
        {"path": "a.nc"},
        {"path": "a.zarr"},
        {"path": "a.nc", "split_complex": True},
        {"path": "a.nc", "split_complex": False},
        {"path": "a.zarr", "split_complex": True},
        {"path": "a.nc", "compression": 5},
        {"path": "a.mat"},
    ],
    ids=["nc", "zarr", "nc split", "nc compound", "zarr split", "nc compressed", "mat"],
)
def test_round_trip(tmp_path, datasets, name, options):
    """load gives back what save was given: values to the last bit, dims, coordinates and attributes."""
    ds = datasets[name]
    path = tmp_path / options["path"]
    bp.save(ds, path, **{k: v for k, v in options.items() if k != "path"})
    again = bp.load(path)
    xr.testing.assert_identical(again, ds)
    assert {n: v.dtype for n, v in again.variables.items()} == {n: v.dtype for n, v in ds.variables.items()}
    assert names(tmp_path) == [path.name]


@pytest.mark.parametrize("path", ["a.nc", "a.zarr"])
@pytest.mark.parametrize("split", [False, True])
def test_complex_coordinates_round_trip(tmp_path, path, split):
    """A line of complex kx is a complex coordinate, and stays the index of its dimension."""
    ds = bp.scattering(SLAB, F, kx=np.linspace(0, 50, 5) - 2j)
    bp.save(ds, tmp_path / path, split_complex=split)
    xr.testing.assert_identical(bp.load(tmp_path / path), ds)


@pytest.mark.parametrize("path", ["a.nc", "a.zarr"])
def test_the_structure_comes_back_from_the_file(tmp_path, path):
    """Slab, beam and settings are rebuilt from a loaded file."""
    slab = bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(), 3, after=bp.Fluid(2 + 1j, 1e5, np.inf)))
    bp.save(bp.field(slab, BEAM, F, X, 0.05, rtol=1e-6), tmp_path / path)
    record = bp.provenance(bp.load(tmp_path / path))
    assert (record["slab"], record["beam"], record["rtol"]) == (slab, BEAM, 1e-6)


def test_what_was_loaded_can_be_saved_again(tmp_path, datasets):
    """No encoding rides along that another format or a second write would stumble over."""
    for one, two in (("a.nc", "b.zarr"), ("c.zarr", "d.nc"), ("e.nc", "f.nc")):
        bp.save(datasets["field"], tmp_path / one, compression=4 if one == "a.nc" else 0)
        bp.save(bp.load(tmp_path / one), tmp_path / two)
        xr.testing.assert_identical(bp.load(tmp_path / two), datasets["field"])


def test_saving_leaves_the_dataset_alone(tmp_path, datasets):
    """The caller's dataset is not touched."""
    ds = datasets["field"]
    before = ds.copy(deep=True)
    bp.save(ds, tmp_path / "a.nc", split_complex=True)
    xr.testing.assert_identical(ds, before)


@pytest.mark.parametrize("name", DATASETS)
def test_attributes_are_what_every_format_takes(datasets, name):
    """Strings and finite numbers only: no None, bool, dict or list; the provenance is JSON without NaN."""
    ds = datasets[name]
    for attrs in (ds.attrs, *(v.attrs for v in ds.variables.values())):
        assert attrs
        for value in attrs.values():
            assert type(value) in (str, int, float)
            assert value == value

    def refuse(constant):
        raise AssertionError(constant)

    assert json.loads(ds.attrs["provenance"], parse_constant=refuse)["beamprop"] == bp.__version__


# --- other readers ----------------------------------------------------------------------------------------


def plainly(ds):
    """What the file holds, by name: (dims, real numbers, units)."""
    plain = {}
    for name, v in ds.variables.items():
        if v.dtype.kind == "c":
            plain |= {
                f"{name}_{part}": (v.dims, getattr(v.values, part), v.attrs["units"]) for part in ("real", "imag")
            }
        else:
            values = v.values if v.dtype.kind != "U" else [WORDS[name].index(word) for word in v.values]
            plain[name] = (v.dims, values, v.attrs["units"])
    return plain


@pytest.mark.parametrize("name", DATASETS)
def test_other_readers_read_our_files(tmp_path, datasets, name):
    """Arrays of real numbers alone, with units: netCDF4, h5py, and xarray with either engine and by dask."""
    ds = datasets[name]
    bp.save(ds, tmp_path / "a.nc")
    with (
        netCDF4.Dataset(tmp_path / "a.nc") as nc,
        h5py.File(tmp_path / "a.nc") as h5,
        xr.open_dataset(tmp_path / "a.nc", engine="netcdf4") as other,
        xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf", chunks={}) as lazy,
    ):
        assert not nc.cmptypes
        assert set(plainly(ds)) == set(nc.variables) == set(lazy.variables)
        for variable, (dims, values, units) in plainly(ds).items():
            for theirs in (
                np.ma.getdata(nc[variable][...]),
                h5[variable][()],
                other[variable].values,
                lazy[variable].values,
            ):
                assert theirs.dtype.kind in "if"
                np.testing.assert_array_equal(theirs, values)
            assert nc[variable].dimensions == other[variable].dims == dims
            assert nc[variable].units == other[variable].units == lazy[variable].units == units
        assert nc.provenance == lazy.provenance == ds.attrs["provenance"]
        assert "side" not in ds.dims or other["side"].flag_meanings == "reflected transmitted"


@pytest.mark.parametrize("name", DATASETS)
def test_plain_zarr(tmp_path, datasets, name):
    """A plain open_zarr finds the metadata in one place and warns of nothing; complex numbers are what they were, words are codes."""
    bp.save(datasets[name], tmp_path / "a.zarr")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plain = xr.open_zarr(tmp_path / "a.zarr", consolidated=True).load()
    for variable, values in datasets[name].variables.items():
        wanted = values.values if values.dtype.kind != "U" else [WORDS[variable].index(word) for word in values.values]
        np.testing.assert_array_equal(plain[variable], wanted)
        assert plain[variable].dtype.kind in "ifc"
        assert plain[variable].attrs["units"] == values.attrs["units"]


def test_attributes_are_plain_text(tmp_path, datasets):
    """Text of a fixed length, netCDF's characters, which is what Octave reads; longer text than HDF5 takes is kept as it is."""
    long = "é" * 2**17
    bp.save(datasets["field"].assign_attrs(long=long, place="Ångström"), tmp_path / "a.nc")
    with h5py.File(tmp_path / "a.nc") as h5:
        assert h5py.check_string_dtype(h5["p_real"].attrs.get_id("units").dtype).length == 2
        assert h5py.check_string_dtype(h5.attrs.get_id("provenance").dtype).length > 100
    assert bp.load(tmp_path / "a.nc").attrs["long"] == long
    with netCDF4.Dataset(tmp_path / "a.nc") as nc:
        assert (nc.long, nc.place) == (long, "Ångström")


@pytest.mark.parametrize("name", ["field", "scalar field"])
def test_compound_types_on_request(tmp_path, datasets, name):
    """What 0.1.0 wrote, and split_complex=False writes: netCDF4 and h5py read it as complex numbers, and so does load."""
    bp.save(datasets[name], tmp_path / "a.nc", split_complex=False)
    with netCDF4.Dataset(tmp_path / "a.nc", auto_complex=True) as nc, h5py.File(tmp_path / "a.nc") as h5:
        np.testing.assert_array_equal(np.ma.getdata(nc["p"][...]), datasets[name].p)
        assert h5["p"].dtype == complex
    xr.testing.assert_identical(bp.load(tmp_path / "a.nc"), datasets[name])


def test_infinite_parts_stay_apart(tmp_path):
    """1j times infinity would have a real part of NaN."""
    ds = xr.Dataset({"a": ("x", np.array([complex(2, np.inf), complex(-np.inf, 1), complex(-0.0, np.nan)]))})
    for name in ("a.nc", "a.zarr", "a.mat"):
        bp.save(ds, tmp_path / name)
        again = bp.load(tmp_path / name)
        np.testing.assert_array_equal(again.a.values.view(float), ds.a.values.view(float))
        assert "long_name" not in again.a.attrs
        assert np.signbit(again.a.values.real[2])


def test_a_name_that_a_part_would_take(tmp_path, datasets):
    """Nothing is overwritten by a part of another variable."""
    ds = datasets["field"]
    with pytest.raises(ValueError, match=r"^ds: .*'p_real'"):
        bp.save(ds.assign(p_real=ds.p.real), tmp_path / "a.nc")
    assert names(tmp_path) == []


@pytest.mark.parametrize("path", ["a.nc", "a.zarr", "a.mat"])
def test_words_of_all_kinds(tmp_path, path):
    """Blanks, letters of other languages, nothing at all, one word, two dimensions, objects and NumPy's text."""
    words = np.array([["a b", "", "größe"], ["x", "a b", "0"]])
    ds = xr.Dataset({"w": (("y", "x"), words), "one": ((), "alone")}, {"x": ["p", "q q", "r"], "y": [1, 2]})
    bp.save(ds.assign(w=ds.w.astype(object)), tmp_path / path)
    xr.testing.assert_identical(bp.load(tmp_path / path), ds)


@pytest.mark.filterwarnings("ignore:.*not part in the Zarr format 3")
def test_words_in_older_files(tmp_path):
    """Text as xarray writes it, and as save did before: NumPy's text comes back, of either type."""
    ds = xr.Dataset({"word": ("x", ["reflected", "größer"]), "one": ((), "alone")})
    ds.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    ds.astype(object).to_zarr(tmp_path / "a.zarr", consolidated=False)
    for name in ("a.nc", "a.zarr"):
        again = bp.load(tmp_path / name)
        xr.testing.assert_identical(again, ds)
        assert again.word.dtype.kind == again.one.dtype.kind == "U"


def test_attributes_that_look_like_ours(tmp_path):
    """A file of somebody else's, with our attributes and without their sense: read as it stands."""
    ds = xr.Dataset(
        {
            "a_real": ("x", [1.0, 2.0], {"part_of": "a"}),  # without its other part
            "b_real": ("x", [1.0, 2.0], {"part_of": "b"}),
            "b_imag": ("y", [1.0, 2.0, 3.0], {"part_of": "b"}),  # on another dimension
            "c_real": ("x", [1.0, 2.0], {"part_of": np.array([1, 2])}),
            "d": ("x", [0, 5], {"flag_words": '["one", "two"]'}),  # a code too large
            "e": ("x", [-1, 0], {"flag_words": '["one", "two"]'}),
            "f": ("x", [0.0, 1.0], {"flag_words": '["one", "two"]'}),
            "g": ("x", [0, 0], {"flag_words": '{"one": 1}'}),
            "h": ("x", [0, 1], {"flag_words": "[[[[["}),
            "i": ("x", [0, 1], {"flag_words": np.array([1, 2])}),
        }
    )
    ds.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    xr.testing.assert_identical(bp.load(tmp_path / "a.nc"), ds)


def test_endings_of_export_are_told(tmp_path, small):
    with pytest.raises(ValueError, match=r"^path: .*got 'a.csv' \(which export writes\)"):
        bp.save(small, tmp_path / "a.csv")


# --- rounded ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["a.nc", "a.zarr", "a.mat"])
@pytest.mark.parametrize("digits", [1, 4, 6, 9, 15])
@pytest.mark.parametrize("name", ["field", "scattering", "measures"])
def test_rounded_storage_states_its_error(tmp_path, datasets, path, digits, name):
    """At most half of the last digit of the largest value in either part, and what the attribute says; coordinates are exact."""
    ds = datasets[name]
    bp.save(ds, tmp_path / path, digits=digits)
    again = bp.load(tmp_path / path)
    assert {n: v.dtype for n, v in again.variables.items()} == {n: v.dtype for n, v in ds.variables.items()}
    for variable, v in ds.data_vars.items():
        if v.dtype.kind == "i":
            assert again[variable].identical(v)
            continue
        stated = again[variable].attrs["rounding_error"]
        off = again[variable].values - v.values
        assert max(np.nanmax(np.abs(off.real)), np.nanmax(np.abs(off.imag))) <= stated
        assert stated <= 0.5 * 10.0**-digits * np.nanmax(np.abs(v.values))
        np.testing.assert_array_equal(np.isnan(again[variable]), np.isnan(v))
    for coordinate in ds.coords:
        xr.testing.assert_equal(again[coordinate], ds[coordinate])


def test_rounded_files_are_smaller(tmp_path):
    """Four digits of a field take less than a third; errors of two roundings add up."""
    ds = bp.field(SLAB, BEAM, F, np.linspace(-0.5, 0.5, 300), bp.faces(SLAB, 200))
    bp.save(ds, tmp_path / "a.nc")
    bp.save(ds, tmp_path / "b.nc", digits=4)
    assert 3 * (tmp_path / "b.nc").stat().st_size < (tmp_path / "a.nc").stat().st_size
    once = bp.load(tmp_path / "b.nc")
    bp.save(once, tmp_path / "c.nc", digits=2)
    assert bp.load(tmp_path / "c.nc").p.attrs["rounding_error"] > 10 * once.p.attrs["rounding_error"]
    assert (
        float(abs(bp.load(tmp_path / "c.nc").p - ds.p).max())
        <= 2**0.5 * bp.load(tmp_path / "c.nc").p.attrs["rounding_error"]
    )


def test_rounding_what_has_no_digits(tmp_path):
    """Zeros, infinities and magnitudes at the ends of double precision pass; each is what it was or within the stated error."""
    for largest in (0.0, 5e-324, 1e-300, 1e-40, 1e38, 1e39, 1.7e308):
        ds = xr.Dataset({"a": ("x", np.array([largest, -largest / 3, np.inf, -np.inf, np.nan, 0.0]))})
        bp.save(ds, tmp_path / "a.nc", digits=3)
        again = bp.load(tmp_path / "a.nc").a
        np.testing.assert_array_equal(again[2:], ds.a[2:])
        assert float(abs(again[:2] - ds.a[:2]).max()) <= again.attrs["rounding_error"]


def test_we_read_what_xarray_and_netcdf4_wrote(tmp_path, datasets):
    """A netCDF file of the other library loads as complex too."""
    ds = datasets["scattering"]
    ds.to_netcdf(tmp_path / "a.nc", engine="netcdf4", auto_complex=True)
    again = bp.load(tmp_path / "a.nc")
    np.testing.assert_array_equal(again.t, ds.t)
    assert again.t.dtype == complex
    assert bp.provenance(again)["slab"] == SLAB


def run_without(blocked, code):
    """Run code in a fresh interpreter that cannot import `blocked`."""
    head = f"import sys; sys.modules.update(dict.fromkeys({list(blocked)!r}))\n"
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", head + code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_files_work_without_netcdf4(tmp_path, datasets):
    """Written and read with netCDF4 out of reach, the file is the same; without zarr a store is refused with advice."""
    bp.save(datasets["field"], tmp_path / "a.nc")
    run_without(
        ["netCDF4", "zarr"],
        f"""
import beamprop as bp, xarray as xr
ds = bp.load({str(tmp_path / "a.nc")!r})
assert bp.provenance(ds)["slab"].periods == 20
bp.save(ds, {str(tmp_path / "b.nc")!r})
bp.save(ds, {str(tmp_path / "c.nc")!r}, split_complex=True)
for name in ("b.nc", "c.nc"):
    xr.testing.assert_identical(bp.load({str(tmp_path)!r} + "/" + name), ds)
try:
    bp.save(ds, {str(tmp_path / "d.zarr")!r})
except ImportError as error:
    assert 'pip install -e ".[zarr]" in the checkout' in str(error), error
else:
    raise AssertionError("saved without zarr")
""",
    )
    assert names(tmp_path) == ["a.nc", "b.nc", "c.nc"]
    xr.testing.assert_identical(bp.load(tmp_path / "b.nc"), datasets["field"])
