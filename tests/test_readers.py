"""Every reader that is in the tests' environment opens every kind of file: all numbers, or a refusal; and the comparison sees what is wrong."""

import sys

import pytest
import readers

NAMES = (
    "xarray, h5netcdf",
    "xarray, netCDF4",
    "xarray, by dask",
    "netCDF4-python",
    "h5py",
    "xarray.open_zarr",
    "zarr-python",
)


def test_readers_of_the_environment(tmp_path):
    """No cell of the table of docs/files.md is another's numbers, or nothing without a word."""
    present = [reader for reader in readers.python_readers(sys.executable) if readers.here(reader)]
    assert {reader.name for reader in present} >= {*NAMES, "scipy.io.loadmat", "pandas.read_csv"}
    rows, errors = readers.table(present, tmp_path)
    assert errors == []
    cells = {row.split("|")[1].strip(): [cell.strip() for cell in row.split("|")[2:-1]] for row in rows[2:]}
    for name in NAMES[:5]:
        assert cells[name][:6] == ["numbers"] * 6
    assert [
        cells[name][column]
        for name, column in zip((*NAMES[5:], "scipy.io.loadmat", "pandas.read_csv"), (6, 6, 7, 10), strict=True)
    ] == ["numbers"] * 4


@pytest.mark.parametrize(
    ("printed", "said", "cell"),
    [
        ("a\t1.0 nan\nb\t2.0\n", "", "numbers"),
        ("a\t0.0 0.0\nb\t2.0\n", "", "**other numbers: a**"),  # as Octave read compound types
        ("a\t1.0\nb\t2.0\n", "", "**other numbers: a**"),
        ("a\t1.0 words\nb\t2.0\n", "", "**other numbers: a**"),
        ("a\t1.0 nan\n", "", "**without, silently: b**"),
        ("a\t1.0 nan\n", "warning: b is left out", "part"),
        ("", "", "**nothing, silently**"),
        ("", "cannot be read", "refusal"),
        ("!OSError: no such format\n", "", "refusal"),
        ("?ended with -11", "", "**ended with -11**"),
    ],
)
def test_the_comparison_sees_what_is_wrong(printed, said, cell):
    reader = readers.Reader("", [], [])
    assert readers.verdict(reader, printed, said, {"a": [1.0, float("nan")], "b": [2.0]}, set()) == cell
