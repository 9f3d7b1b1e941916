"""Profiles from text: what parts the columns and what the decimal mark is, read rightly or refused."""

import numpy as np
import pytest

import beamprop as bp


def read(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "profile.csv"
    path.write_bytes(text.encode(encoding))
    return bp.Profile.from_file(path)


@pytest.mark.parametrize(
    "text",
    [
        "-0.5;1.5\n0;2\n0.5;1.25\n",
        "-0,5;1,5\n0;2\n0,5;1,25\n",
        "# x; p\n-0,5 ; 1,5;\n0 ; 2;\n0,5 ; 1,25;\n",
        "-0,5\t1,5\n0\t2\n0,5\t1,25\n",
        "-5,0e-1;15e-1\n0;2\n,5;1,25\n",
        "-0.5,1.5\n0,2\n0.5,1.25\n",
        "-0.5, 1.5\n0, 2\n0.5, 1.25\n",
        "-0.5,1.5\n0, 2\n0.5,1.25,\n",
        "-0.5 1.5\n0\t2\n0.5   1.25\n",
    ],
)
def test_what_can_be_read_one_way(tmp_path, text):
    """Points with any delimiter, decimal commas between semicolons or tabs."""
    profile = read(tmp_path, text)
    np.testing.assert_array_equal(profile.x, [-0.5, 0, 0.5])
    np.testing.assert_array_equal(profile.p, [1.5, 2, 1.25])


def test_three_columns_of_decimal_commas(tmp_path):
    """Re p and Im p."""
    profile = read(tmp_path, "0,5;1,5;-2,5\n1,5;0;1e-3\n")
    np.testing.assert_array_equal(profile.x, [0.5, 1.5])
    np.testing.assert_array_equal(profile.p, [1.5 - 2.5j, 1e-3j])


def test_whole_numbers_with_commas_between(tmp_path):
    """A CSV of whole numbers is one of two or three columns."""
    np.testing.assert_array_equal(read(tmp_path, "0,5,1\n1,6,2\n").p, [5 + 1j, 6 + 2j])


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("0,5 1\n1,5 2\n", 1),  # (0, 5, 1) or (0.5, 1)
        ("0 1\n0,5 2\n", 2),
        ("0,5, 1\n1,5, 2\n", 1),
        ("1.234,5;2\n2.234,5;3\n", 1),  # thousands
        ("0.5;1,0\n1;2\n", 1),
        ("0,5;a\n1;2\n", 1),
        ("1,234.5 2\n2,234.5 3\n", 1),
        ("0,5,1,2\n1,5,1,3\n", 1),
        ("0.5,1\n1,2\n1,5,1,3\n", 3),
    ],
)
def test_what_could_be_read_two_ways_is_refused(tmp_path, text, line):
    """With the file, the line and what would be plain."""
    with pytest.raises(ValueError, match=rf"profile\.csv, line {line}: expected .*commas are decimal"):
        read(tmp_path, text)


@pytest.mark.parametrize("number", ["1e400", "-1e400", "nan", "inf"])
def test_numbers_that_are_not_finite_are_named_with_their_line(tmp_path, number):
    """1e400 is no double."""
    with pytest.raises(ValueError, match=r"profile\.csv, line 2: expected finite numbers"):
        read(tmp_path, f"0 1\n1 {number}\n2 1\n")


def test_a_file_that_is_no_text(tmp_path):
    """UTF-16, as spreadsheet programs write it, is named rather than a codec."""
    with pytest.raises(ValueError, match=r"profile\.csv: expected text"):
        read(tmp_path, "0;1\n1;2\n", "utf-16")
