"""COMSOL exports that are damaged, or that are none: refused with the line and what was expected there."""

import comsol_writer as writer
import numpy as np
import pytest

from beamprop.io.comsol import read_comsol

GOOD = """% Model,slab.mph
% Dimension,2
% Nodes,4
% Expressions,2
% Length unit,m
% x,y,p (Pa) @ freq=100,p (Pa) @ freq=200
0,0,1+2i,2
1,0,1,2
0,1,1,2
1,1,1,2
"""
GRID = """% Dimension: 2
% Length unit: m
% Grid
0 1 2
0 1
% Data (p (Pa))
1 2 3
4 5 6
"""
SECTIONS = """% Dimension: 2
% Length unit: m
% Coordinates
0 0
1 0
0 1
% Elements (triangles)
1 2 3
% Data (p (Pa))
1
2
3
"""


def test_the_three_samples_are_good(tmp_path):
    for text in (GOOD, GRID, SECTIONS):
        assert "p" in read_comsol(writer.text_file(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "old", "new", "said"),
    [
        (GOOD, GOOD, "", "expected rows of numbers below the header, got none"),
        (GOOD, GOOD[GOOD.index("0,0,") :], "", "expected rows of numbers"),
        (GOOD, "1,0,1,2", "1,0,1", r"line 8: expected 4 values, got 3 in '1,0,1'"),
        (GOOD, "1,0,1,2", "1,0,1,2,3", r"line 8: expected 4 values, got 5"),
        (GOOD, "1,0,1,2", "1,0,one,2", r"line 8: expected a real or complex number, got 'one'"),
        (GOOD, "1+2i", "1+2k", r"line 7: expected a real or complex number, got '1\+2k'"),
        (GOOD, "1+2i", "1+2i3", r"line 7: expected a real or complex number"),
        (GOOD, "1,0,1,2", "1,0,,2", r"line 8: expected a real or complex number, got ''"),
        (GOOD, "1,1,1,2\n", "", r"expected 4 points, as '% Nodes' states \(was the file cut off\?\), got 3"),
        (GOOD, "% Nodes,4", "% Nodes,four", "expected a whole number after '% Nodes', got 'four'"),
        (GOOD, ",p (Pa) @ freq=200", "", r"line 6: expected 4 names, for the 4 columns below, got 3"),
        (GOOD, "% x,y,p (Pa) @ freq=100,p (Pa) @ freq=200\n", "", r"line 5: expected a line that names the columns"),
        (GOOD, GOOD[: GOOD.index("0,0,")], "", "expected a line that names the columns above the numbers, got none"),
        (GOOD, "freq=200", "freq=100", r"expected one column of p for each combination .* two at {'frequency': 100.0}"),
        (GOOD, "freq=200", "freq=2 mm", "expected real values of freq in Hz"),
        (GOOD, "freq=200", "freq=200, m=1", "expected the same parameters and unit in all columns of p"),
        (GOOD, "freq=200", "freq=a", "expected real values of freq in Hz"),
        (GOOD, "(Pa) @ freq=200", "(kPa) @ freq=200", "expected the same parameters and unit"),
        (
            GOOD,
            "@ freq=200",
            "@ 100 Hz",
            "line 6: expected parameters such as 'freq=100, theta=0' after @, got '100 Hz'",
        ),
        (GOOD, "unit,m\n", "unit,furlong\n", "expected a unit of length, one of m, mm, .* got 'furlong'"),
        (GOOD, "(Pa)", "(Pb)", "expected a unit of pressure for p, .* got 'Pb'"),
        (GOOD, "x,y,", "x (s),y,", r"line 6: expected a unit of length for x, got 's'"),
        (GOOD, "% Dimension,2", "% Dimension,7", r"line 6: expected one to three coordinates first"),
        (GOOD, "% Dimension,2", "% Dimension,3", r"line 6: expected one to three coordinates first"),
        (GOOD, "1,0,1,2", "NaN,0,1,2", "expected finite real positions in column x"),
        (GOOD, "1,0,1,2", "1+i2,0,1,2", "line 8: expected a real or complex number"),
        (GOOD, "1,0,1,2", "1+2i,0,1,2", "expected finite real positions in column x"),
        (GOOD, "1,0,1,2", "% x,y,p (Pa)", "line 8: expected numbers down to the file's end"),
        (GOOD, ",", ";", None),  # every comma of the file: the semicolon form, which is good
        (GRID, "0 1 2\n", "0 2 1\n", r"line 4: expected an axis of finite, strictly increasing positions"),
        (GRID, "4 5 6", "4 5", r"line 8: expected 3 values, got 2"),
        (GRID, "4 5 6\n", "", r"line 6: expected 2 rows of data, one for each point of the other axes, got 1"),
        (GRID, "% Data (p (Pa))\n", "", "expected one section '% Grid' and then '% Data', got '% Grid'"),
        (GRID, "4 5 6\n", "4 5 6\n% Data (q)\n", r"line 9: expected rows of numbers below '% Data', got none"),
        (GRID, "4 5 6\n", "4 5 6\n% Data\n1 2 3\n4 5 6\n", r"line 9: expected the name of the data"),
        (GRID, "Dimension: 2", "Dimension: 3", r"line 3: expected 3 coordinates, got 2"),
        (SECTIONS, "1\n2\n3\n", "1\n2\n", r"line 9: expected 3 values, one for each node, got 2"),
        (SECTIONS, "1 2 3\n", "1 2 4\n", r"line 7: expected numbers of nodes from 1 to 3 in the elements"),
        (SECTIONS, "1 2 3\n", "0 1 2\n", r"line 7: expected numbers of nodes from 1 to 3 in the elements"),
        (SECTIONS, "1 0\n", "1 0 0\n", r"line 5: expected 2 values, got 3"),
        (SECTIONS, "1 0\n", "1 NaN\n", r"line 3: expected finite real coordinates"),
        (SECTIONS, "1\n2\n3\n", "1\n2\nx\n", r"line 12: expected a real or complex number, got 'x'"),
        (SECTIONS, "1\n2\n3\n", "1\n2 5\n3\n", r"line 11: expected 1 values, got 2"),
    ],
)
def test_malformed_files_are_refused_with_the_line(tmp_path, text, old, new, said):
    assert old in text
    path = writer.text_file(tmp_path, text.replace(old, new))
    if said is None:
        assert read_comsol(path).p.sizes == {"frequency": 2, "z": 2, "x": 2}
        return
    with pytest.raises(ValueError, match=said) as caught:
        read_comsol(path)
    assert str(path) in str(caught.value)


def test_a_model_is_no_export(tmp_path):
    path = tmp_path / "slab.mph"
    path.write_bytes(b"PK\x03\x04 and so on")
    with pytest.raises(ValueError, match="expected a text export, got a binary file"):
        read_comsol(path)


def test_points_and_commas_mixed(tmp_path):
    path = writer.text_file(tmp_path, "% Length unit: m\n% x;y;p (Pa)\n0,5;1;1\n0,7;1.25;1\n")
    with pytest.raises(ValueError, match=r"line 4: expected decimal commas throughout"):
        read_comsol(path)


def test_unquoted_decimal_commas_in_csv_are_never_guessed(tmp_path):
    path = writer.text_file(tmp_path, "% Length unit,m\n% x,y,p (Pa)\n0,5,1,5,2,5\n")
    with pytest.raises(ValueError, match="line 2: expected 6 names, for the 6 columns below, got 3"):
        read_comsol(path)


def test_space_has_three_dimensions(tmp_path):
    random = np.random.default_rng(0).uniform(size=(3, 8))
    path = writer.spreadsheet(tmp_path / "a", dict(zip("xyz", random, strict=True)), [("p (Pa)", np.ones(8))])
    with pytest.raises(ValueError, match="x, z: expected a plane"):
        read_comsol(path)
    with pytest.raises(ValueError, match="x, z: expected a plane"):
        read_comsol(path, x="x", z="z")


def test_wrong_count_of_expressions_is_warned_about(tmp_path):
    path = writer.text_file(tmp_path, GOOD.replace("% Expressions,2", "% Expressions,5"))
    with pytest.warns(UserWarning, match="states 5 columns of values, there are 2"):
        read_comsol(path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"x": "w"}, "x: expected one of the coordinates x, y of .*, got 'w'"),
        ({"z": "w"}, "z: expected one of the coordinates"),
        ({"x": "y", "z": "y"}, "z: expected another coordinate than x"),
        ({"x": 3}, "x: expected a name, got 3"),
        ({"expression": ""}, "expression: expected a name"),
        ({"conjugate": "yes"}, "conjugate: expected True or False, got 'yes'"),
        ({"length_unit": "furlong"}, "length_unit: expected one of m, "),
        ({"angle_unit": "gon"}, "angle_unit: expected one of deg"),
    ],
)
def test_arguments_are_checked(tmp_path, change, said):
    path = writer.text_file(tmp_path, GOOD)
    with pytest.raises(ValueError, match=said):
        read_comsol(path, **change)


def test_no_such_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_comsol(tmp_path / "none.txt")
