"""`compare` of fields with other time dependences, units and boundaries: what is converted, and what is warned of."""

import matplotlib
import numpy as np
import pytest
from slanted_beam import X, Z, gaussian, make

from beamprop.comparison.fields import compare

matplotlib.use("Agg")


def test_a_conjugate_is_noticed():
    b = make(values=0.8 * np.conj(make().p.values))
    with pytest.warns(UserWarning, match=r"b looks like exp\(\+i w t\)"):
        c = compare(make(), b)
    assert c.attrs["conjugate_fits_better"] == 1
    assert float(c.relative_l2) > 0.5


def test_fields_that_are_their_own_conjugates_raise_no_suspicion():
    a = make(values=np.abs(make().p.values) + 0j)
    b = make(values=a.p.values * (1 + 0.01j))
    assert compare(a, b).attrs["conjugate_fits_better"] == 0
    slanted = make(values=a.p.values * np.exp(0.01j * X))
    noisy = a.p.values * np.exp(-0.01j * X) + 0.05 * np.random.default_rng(0).normal(size=a.p.shape)
    assert compare(slanted, make(values=noisy)).attrs["conjugate_fits_better"] == 0  # conj(b) is nearer, by a little


@pytest.mark.parametrize(("units", "pascal"), [("kPa", 1e3), ("mPa", 1e-3), ("Pa", 1.0)])
def test_units_are_converted(units, pascal):
    b = make(values=make().p.values / pascal, units=units)
    assert float(compare(make(), b).relative_l2) < 1e-14
    back = compare(b, make())
    assert float(back.relative_l2) < 1e-14
    assert back.p_a.attrs["units"] == back.peak_difference.attrs["units"] == units


@pytest.mark.parametrize("units", ["m/s", "dB", None])
def test_units_that_are_no_pressure(units):
    b = make()
    b.p.attrs = {"units": units} if units else {}
    with pytest.raises(ValueError, match="b: expected p in 'Pa' as a has it, or in a unit of pressure"):
        compare(make(), b)
    assert float(compare(b, b).relative_l2) == 0


@pytest.mark.parametrize(
    ("of_a", "of_b", "said"),
    [
        (
            {"boundary": "open"},
            {"boundary": "periodic", "period": 2.24},
            r"b is periodic \(2.24 m\) and the other in open",
        ),
        ({"boundary": "periodic", "period": 2.24}, {"boundary": "open"}, r"a is periodic \(2.24 m\)"),
        (
            {"boundary": "periodic", "period": 2.24},
            {"boundary": "periodic", "period": 2.25},
            "a has the period 2.24 m, b 2.25 m",
        ),
    ],
)
def test_different_boundaries_are_warned_about(of_a, of_b, said):
    with pytest.warns(UserWarning, match=f"{said}.*the wrap-around of the neighbouring beams is counted in the error"):
        compare(make(**of_a), make(**of_b))


@pytest.mark.parametrize(
    ("of_a", "of_b"),
    [
        ({"boundary": "periodic", "period": 2.24}, {"boundary": "periodic", "period": 2.24}),
        ({"boundary": "open"}, {"boundary": "open"}),
        ({"boundary": "periodic", "period": 2.24}, {}),
        ({}, {}),
    ],
)
def test_same_or_unknown_boundaries_are_not(of_a, of_b):
    compare(make(**of_a), make(**of_b))  # a warning would fail the test


def test_wraparound_is_estimated_apart():
    neighbour = 0.01 * gaussian(X[None, :] - 0.3, Z[:, None])
    open_space = make(boundary="open")
    periodic = make(values=open_space.p.values + neighbour, boundary="periodic", period=2.0)
    scaled = make(values=periodic.p.values * 1.001, boundary="periodic", period=2.0)
    c = compare(periodic, scaled, open_reference=open_space)
    assert float(c.relative_l2) == pytest.approx(1e-3, rel=1e-6)
    want = np.linalg.norm(neighbour) / np.linalg.norm(periodic.p)
    assert float(c.wraparound) == pytest.approx(want, rel=1e-6)
    assert "wraparound" not in compare(periodic, scaled)
    with pytest.warns(UserWarning, match=r"estimated at 0\.0\d+ \(wraparound\)"):
        c = compare(open_space, scaled, open_reference=open_space)
    assert float(c.wraparound) == pytest.approx(want, rel=0.2)
    with pytest.raises(ValueError, match="open_reference: expected a field in open space"):
        compare(periodic, scaled, open_reference=periodic)
    with pytest.raises(ValueError, match="open_reference: expected a or b to be periodic"):
        compare(open_space, open_space, open_reference=open_space)
