"""COMSOL's text: what is made of a file is bounded by the file, and numbers that no double holds are named."""

import itertools
import time
import tracemalloc

import numpy as np
import pytest
from comsol_writer import text_file

import beamprop as bp

HEAD = "% Length unit: m\n"


def refused_within(path, match, memory=2**26, seconds=20.0):
    """Refused by a message, before much is asked of the machine."""
    tracemalloc.start()
    begin = time.monotonic()
    try:
        with pytest.raises(ValueError, match=match):
            bp.read_comsol(path)
        assert tracemalloc.get_traced_memory()[1] < memory
        assert time.monotonic() - begin < seconds
    finally:
        tracemalloc.stop()


def test_parameters_that_never_meet(tmp_path):
    """Nine columns, each at values of eight parameters that no other has: 9^8 combinations in less than a kilobyte."""
    columns = [", ".join(f"{name}={k}" for name in "abcdefgh") for k in range(9)]
    text = (
        HEAD + "% x, y, " + ", ".join(f"p (Pa) @ {c}" for c in columns) + "\n" + ",".join(["0", "0", *"1" * 9]) + "\n"
    )
    assert len(text) < 1000
    refused_within(
        text_file(tmp_path, text), r"export\.txt: expected values for at least one in 16 .*got 9 of 43046721"
    )


def test_a_parameter_of_each_row(tmp_path):
    """Rows each at another point and another value of two parameters: points times values would be 1e12."""
    rows = "".join(f"{k} {k % 7} {k}.5 {k}.25 1\n" for k in range(10_000))
    refused_within(
        text_file(tmp_path, HEAD + "% x y freq t p (Pa)\n" + rows),
        r"export\.txt: expected values for at least one in 16",
    )


def test_two_parameters_in_columns_come_back(tmp_path):
    """Each row in its place, whatever the order of the rows."""
    x, freq, t = [0.0, 1.0, 2.0], [100.0, 200.0], [0.0, 0.5, 1.0, 1.5]
    rows = list(itertools.product(x, freq, t))
    np.random.default_rng(1).shuffle(rows)
    text = HEAD + "% x freq (Hz) t (s) p (Pa)\n" + "".join(f"{a} {f} {s} {a + 10 * f + 1e4 * s}\n" for a, f, s in rows)
    ds = bp.read_comsol(text_file(tmp_path, text))
    assert ds.p.dims == ("frequency", "time", "x")
    want = ds.x + 10 * ds.frequency + 1e4 * ds.time
    np.testing.assert_array_equal(ds.p.real, want.transpose(*ds.p.dims))


def test_a_sweep_with_gaps_is_read(tmp_path):
    """One in sixteen is enough; small datasets are read whatever their gaps."""
    columns = ", ".join(f"p (Pa) @ a={k}, b={k}" for k in range(20))
    text = HEAD + f"% x, {columns}\n" + ",".join(["0", *"1" * 20]) + "\n"
    with pytest.warns(UserWarning, match="380 of 400 combinations"):
        assert bp.read_comsol(text_file(tmp_path, text)).p.shape == (20, 20, 1)


def test_thousands_of_expressions(tmp_path):
    """In a time that grows with their number, not with its square."""
    count = 3000
    names = ", ".join(f"u{k}" for k in range(count))
    path = text_file(tmp_path, HEAD + f"% x, {names}\n" + ",".join(["0", *["1"] * count]) + "\n")
    begin = time.monotonic()
    assert len(bp.read_comsol(path).data_vars) == count
    assert time.monotonic() - begin < 20


@pytest.mark.parametrize("number", ["1e400", "-1E+400", "1e400-2i", "1-1e999i"])
@pytest.mark.parametrize("place", ["data", "coordinate", "grid"])
def test_numbers_beyond_doubles(tmp_path, number, place):
    """The file, the line and the number."""
    if place == "data":
        text = HEAD + f"% x, y, p (Pa)\n0,0,1\n1,0,{number}\n"
    elif place == "coordinate":
        text = HEAD + f"% x, y, p (Pa)\n0,0,1\n{number},0,1\n"
    else:
        text = HEAD + f"% Grid\n0 1\n0 {number}\n% Data (p (Pa))\n1 2\n1 2\n"
    line = 4
    with pytest.raises(ValueError, match=rf"export\.txt, line {line}: expected numbers within 1e308.*{number[:3]}"):
        bp.read_comsol(text_file(tmp_path, text))


@pytest.mark.parametrize("value", ["freq=1e400", "a=1e400", "freq=1e400[kHz]", "a=1e400 Hz", "a=-1e400-1i"])
def test_parameters_beyond_doubles(tmp_path, value):
    """In the header, too."""
    text = HEAD + f"% x, p (Pa) @ {value}\n0,1\n"
    with pytest.raises(ValueError, match=r"export\.txt, line 2: expected numbers within 1e308"):
        bp.read_comsol(text_file(tmp_path, text))
