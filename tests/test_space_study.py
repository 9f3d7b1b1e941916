"""The random study of fields in three dimensions: some of its quick cases, and its report."""

import numpy as np
import pytest
import solid_oracles
import xarray as xr
from accuracy_study.case import SpaceCase
from accuracy_study.cases.in_space import KINDS, requested, space_case
from accuracy_study.reference import in_space as truth_in_space
from accuracy_study.reference.solid import SolidMedium
from accuracy_study.study import in_space

import beamprop as bp

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
K = 2 * np.pi * 0.2e6 / 1500.0


def dataset(rows):
    return xr.Dataset(
        {k: ("case", [r[k] for r in rows]) for k in rows[0] if k != "number"}, {"case": [r["number"] for r in rows]}
    )


def test_cases_keep_rtol():
    rows = [
        in_space.compare_in_space(number) for number in (4, 16, 429)
    ]  # of the last one rounding of z is what is seen
    for row in rows:
        assert row["status"] == "answered"
        assert row["error"] < row["rtol"]
        assert row["estimate"] > row["error"] / 3
    text = in_space.summary(dataset(rows))
    assert "| all | 3 | 0 | 0 | 0 | 0 | 3 | 0 | 0 |" in text


def test_what_is_wrong_is_counted():
    """A field that is off by more than rtol and its estimate is broken and too sure."""
    row = in_space.compare_in_space(4)
    text = in_space.summary(dataset([row | {"error": 10 * row["rtol"]}]))
    assert "| all | 1 | 0 | 0 | 0 | 0 | 1 | 1 | 1 |" in text
    assert "\n    4 uniform fluid, GaussianBeam: answered" in text


def test_every_class_is_drawn():
    cases = [space_case(number) for number in range(6 * len(KINDS))]
    assert {case.kind for case in cases} == set(KINDS)
    gaussian = [case.beam for case in cases if isinstance(case.beam, bp.GaussianBeam)]
    assert len({isinstance(beam.fwhm, tuple) for beam in gaussian}) == 2
    assert sum(beam.azimuth != 0 for beam in gaussian) > 30
    assert {type(case.beam).__name__ for case in cases} == set(in_space.SOURCES)
    volumes = [requested(number, case)[2].size for number, case in enumerate(cases)]
    assert min(volumes) < 5
    assert max(volumes) > 200


def case_of(beam, z, rtol=1e-9):
    """A question in water."""
    nothing = bp.Slab.uniform(WATER, 0.001, background=WATER)
    x, y = np.array([0.0, 0.02]), np.array([0.0, 0.01])
    return SpaceCase("water in front", nothing, beam, 0.2e6, x, y, np.asarray(z), rtol)


@pytest.mark.parametrize("fwhm", [0.01, (0.01, 0.02)])
def test_the_truth_of_a_beam_is_launched(fwhm):
    """On the launch plane in a homogeneous fluid, of the sum over directions and of the circular beam's at complex radii."""
    case = case_of(bp.GaussianBeam(fwhm, 20.0, azimuth=30.0, z0=-0.01), [-0.01])
    known = truth_in_space.truth(case)
    k, turn = K * np.sin(np.radians(20)), np.radians(30.0)
    u, v = np.meshgrid(case.x, case.y)
    wx, wy = fwhm if isinstance(fwhm, tuple) else (fwhm, fwhm)
    launched = np.exp(-4 * np.log(2) * ((u / wx) ** 2 + (v / wy) ** 2) + 1j * k * (u * np.cos(turn) + v * np.sin(turn)))
    assert np.max(np.abs(known.p[0] - launched.ravel())) < 1e-10


def test_the_truth_of_a_circular_beam_is_that_of_any():
    """At complex radii, and by the sum over directions, through a plate."""
    plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
    case = case_of(bp.GaussianBeam(0.01, 40.0, azimuth=30.0, z0=-0.01), [0.003, 0.02])._replace(slab=plate)
    circular = truth_in_space.truth(case)
    widths = (0.01, 0.01 * (1 + 1e-13))  # not quite circular
    elliptical = truth_in_space.truth(case._replace(beam=bp.GaussianBeam(widths, 40.0, azimuth=30.0, z0=-0.01)))
    assert np.max(np.abs(circular.p - elliptical.p)) < 1e-10 * np.max(np.abs(circular.p))


def on_the_axis(beam, z):
    """Closed forms in a homogeneous fluid, z from the middle of the piston or the apex of the bowl."""
    if isinstance(beam, bp.Bowl):
        rim = np.hypot(z - beam.depth, beam.aperture / 2)
        focus = beam.radius_of_curvature
        return (np.exp(1j * K * z) - np.exp(1j * K * rim)) * focus / (focus - z)
    rim = np.hypot(z, beam.radius)
    return np.exp(1j * K * z) - (1 if beam.baffle == "rigid" else z / rim) * np.exp(1j * K * rim)


@pytest.mark.parametrize(
    "beam", [bp.Piston(0.01, z0=-0.03), bp.Piston(0.01, "soft", z0=-0.03), bp.Bowl(0.04, 0.05, z0=-0.03)]
)
def test_the_truth_of_transducers_is_the_closed_form(beam):
    """On the axis; an array of two is the sum of both, each seen from beside."""
    z = np.array([-0.005, 0.005, 0.05])
    known = truth_in_space.truth(case_of(beam, z))
    assert known.p[:, 0] == pytest.approx(on_the_axis(beam, z + 0.03), rel=1e-9)
    pair = bp.Array([[0.0, 0.0], [0.02, 0.01]], beam, [2.0, 1j])
    both = truth_in_space.truth(case_of(pair, z))
    assert both.p[:, 0] == pytest.approx(2 * known.p[:, 0] + 1j * known.p[:, 3], rel=1e-8)


def test_the_truth_of_solids_is_that_of_many_digits():
    """r and t of two solids in contact by the global matrix, and by 4 x 4 matrices with 50 digits."""
    steel, glass = (7900.0, 5900.0, 3200.0), (2500.0, 5600.0, 3400.0)
    layers = [bp.Layer(bp.Solid(*steel), 0.002), bp.Layer(bp.Solid(*glass), 0.003)]
    medium = SolidMedium(bp.Slab(layers, 1, background=WATER), 0.2e6)
    kx = np.array([0.1, 0.7, 1.3]) * K * (1 - 0.05j)
    r, t = medium.r_and_t(kx)
    half_space = (1000.0, WATER.bulk_modulus)
    for i, k in enumerate(kx):
        known = solid_oracles.response([(*steel, 0.002), (*glass, 0.003)], 1, half_space, half_space, 0.2e6, complex(k))
        assert complex(known[0]) == pytest.approx(r[i], rel=1e-10)
        assert complex(known[1]) == pytest.approx(t[i], rel=1e-10)
