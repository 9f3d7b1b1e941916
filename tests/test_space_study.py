"""The random study of fields in three dimensions: some of its quick cases, and its report."""

import numpy as np
import xarray as xr
from accuracy_study.cases.in_space import KINDS, space_case
from accuracy_study.reference import in_space as truth_in_space
from accuracy_study.study import in_space


def dataset(rows):
    return xr.Dataset(
        {k: ("case", [r[k] for r in rows]) for k in rows[0] if k != "number"}, {"case": [r["number"] for r in rows]}
    )


def test_cases_keep_rtol():
    rows = [in_space.compare_in_space(number) for number in (5, 19)]
    for row in rows:
        assert row["status"] == "answered"
        assert row["error"] < row["rtol"]
        assert row["estimate"] > row["error"] / 3
    text = in_space.summary(dataset(rows))
    assert "| all | 2 | 0 | 0 | 0 | 0 | 2 | 0 | 0 |" in text


def test_what_is_wrong_is_counted():
    """A field that is off by more than rtol and its estimate is broken and too sure."""
    row = in_space.compare_in_space(5)
    text = in_space.summary(dataset([row | {"error": 10 * row["rtol"]}]))
    assert "| all | 1 | 0 | 0 | 0 | 0 | 1 | 1 | 1 |" in text
    assert "\n    5 negative density or modulus: answered" in text


def test_every_class_is_drawn():
    assert {space_case(number).kind for number in range(len(KINDS))} == set(KINDS)
    beams = [space_case(number).beam for number in range(60)]
    assert len({isinstance(beam.fwhm, tuple) for beam in beams}) == 2
    assert sum(beam.azimuth != 0 for beam in beams) > 30


def test_the_truth_is_that_of_air():
    """On the launch plane of a beam in air the truth is the launched pressure."""
    case = space_case(0)._replace(z=np.array([0.0]))
    case = case._replace(
        beam=case.beam.__class__(0.1, 20.0, azimuth=30.0), x=np.array([0.0, 0.05]), y=np.array([0.02]), rtol=1e-9
    )
    known = truth_in_space.truth(case)
    k = 2 * np.pi * case.frequency / 343.0 * np.sin(np.radians(20))
    a = 0.1 / (2 * np.sqrt(np.log(2)))
    turn = np.radians(30.0)
    launched = np.exp(-(case.x**2 + 0.02**2) / a**2 + 1j * k * (case.x * np.cos(turn) + 0.02 * np.sin(turn)))
    assert np.max(np.abs(known.p[0] - launched)) < 1e-10
