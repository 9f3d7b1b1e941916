"""What random calls found, by its cause: each a case that once gave another error, a warning of NumPy's, or took minutes."""

import warnings

import numpy as np
import pytest
import xarray as xr

import beamprop as bp
from beamprop.contour import check_points, stretches
from beamprop.contour.paths import Extent
from beamprop.fields import evaluate
from beamprop.response import transfer_function

SLAB = bp.Slab(bp.lmmd_cell(), 5)


@pytest.fixture
def quiet():
    """NumPy's warnings are errors."""
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=r"(overflow|underflow|invalid value|divide by zero) encountered")
        yield


EVEN = np.linspace(-1, 1, 33)


def _map(size=1.0, x=EVEN):
    p = np.exp(-((x / 0.4) ** 2) + 3j * x) * np.array([[1.0], [0.7]])
    return xr.Dataset({"p": (("z", "x"), size * p, {"units": "Pa"})}, {"x": x, "z": [0.0, 0.4]})


@pytest.mark.parametrize("path", [2.5, [1], None, np.zeros(2)], ids=repr)
def test_paths_that_are_none(path):
    """Save and load name the path."""
    for ask in (lambda: bp.save(_map(), path), lambda: bp.load(path)):
        with pytest.raises(ValueError, match=r"^path: expected the path of a file, got "):
            ask()


@pytest.mark.parametrize(
    ("name", "value"), [("compression", np.zeros(3)), ("split_complex", np.zeros(3)), ("split_complex", "a")], ids=repr
)
def test_options_of_save(tmp_path, name, value):
    """Arrays too are refused by name, and nothing is written."""
    with pytest.raises(ValueError, match=f"^{name}: expected "):
        bp.save(_map(), tmp_path / "a.nc", **{name: value})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("x0", [-2094.6, 1e6])
def test_measures_do_not_depend_on_the_origin(quiet, x0):
    """Positions move with the beam, all else stays."""
    beam = {"fwhm": 0.3, "angle": 47.0, "z0": -0.1}
    here, there = (bp.beam_measures(SLAB, bp.GaussianBeam(**beam, x0=at), 2500.0, window=3.0) for at in (0.0, x0))
    for name in here.data_vars:
        moved = x0 if name in ("centroid", "moments_from", "moments_to") else 0.0
        np.testing.assert_allclose(there[name] - moved, here[name], rtol=1e-9, atol=1e-9 + 1e-15 * abs(x0))


def test_a_period_in_which_nothing_is_launched(quiet):
    """Between two slits lies a gap: it is no beam of its own."""
    with pytest.raises(ValueError, match=r"^period: expected a grid wide enough .* is zero"):
        bp.field(SLAB, bp.Slits(0.05, 0.2), 2500.0, [0.0, 0.3], 0.1, boundary="periodic", period=0.02)


def test_launch_planes_that_no_contour_reaches(quiet):
    """A phase of 1e41 has no digit."""
    with pytest.raises(ValueError, match=r"^\w+: "):
        bp.beam_width(
            bp.Slab(bp.lmmd_cell(), 20),
            bp.GaussianBeam(1.4837585152304829, angle=-55.62800627101315, z0=-4.848487915832104e39),
            1689.0561999300808,
        )


@pytest.mark.parametrize(
    ("ours", "theirs"), [(1e200, 1e-100), (1e200, 1e200), (1e-200, 1e-200), (1.0, 1e200), (1.0, 1e-200)]
)
def test_compare_is_of_any_magnitude(quiet, ours, theirs):
    """Relative errors and the scale are right where squares of |p| overflow or vanish."""
    x = np.linspace(-0.9, 0.9, 20)
    one = bp.compare(_map(), _map(1.5, x))
    other = bp.compare(_map(ours), _map(1.5 * theirs, x))
    assert one["relative_l2"] == pytest.approx(0.5, rel=1e-3)
    for name in ("relative_l2_scaled", "interpolation_error"):
        assert float(other[name]) == pytest.approx(float(one[name]), rel=1e-6)
    assert complex(other["scale"] / (ours / theirs)) == pytest.approx(complex(one["scale"]))
    if ours == theirs:
        assert float(other["relative_l2"]) == pytest.approx(0.5, rel=1e-3)


def test_beams_that_only_huge_sums_would_find():
    """Refused with what they would take, plane waves or terms of sums, instead of summing for minutes."""
    said = r"^(slab: expected .* got one that takes \S+ \(\S+ plane waves at|rtol: .* needs more than \d+ plane waves .* has spread)"
    with pytest.raises(ValueError, match=said) as refused:
        bp.beam_width(bp.Slab.uniform(bp.AIR, 1e6), bp.GaussianBeam(0.096, 20, z0=-0.1), 2500.0)
    assert f"the slab {1e6 * 2500 / 343:.3g} thick (are all lengths in metres and the frequency" in str(refused.value)


def test_positions_as_many_as_plane_waves_need(monkeypatch):
    """A slit's edge has waves of a hundredth of a millimetre, which die on the way: the window has no positions for them."""
    sizes = []
    plain = evaluate.beam_sum
    monkeypatch.setattr(evaluate, "beam_sum", lambda s, b, sol, h, x: sizes.append(x.size) or plain(s, b, sol, h, x))
    bp.beam_width(SLAB, bp.Slits(0.05, 0.2, 1, z0=-0.2), 2306.0, rtol=1e-4)
    assert 0 < max(sizes) < 5000


def test_planes_that_span_more_half_wavelengths_than_an_integer_holds():
    """Darkness of planes beside those within a window; far apart each has no other beside it."""
    z = np.array([0.0, 1e-6, 1e15])
    size = np.array([1.0, 0.1, 1.0])
    np.testing.assert_array_equal(check_points._darkness(size, z, 1e-5), [1.0, 0.1, 1.0])
    np.testing.assert_array_equal(check_points._darkness(size, z, 1e-12), [1.0, 0.1, 1.0])


def test_a_plan_of_stretches_for_a_response_without_rounding():
    """A response may be exact at the points looked at, such as that of no layers."""
    extent = Extent(46.0, 46.0, 50.0, 1.0, 0.2, 0.5)
    assert stretches.plan_stretches(extent, 0.1, 1e-8, 0.0) == stretches.plan_stretches(extent, 0.1, 1e-8, 1e-17)


def test_widths_whose_way_without_the_slab_grows_beyond_all_numbers(quiet):
    """A medium in front of density 1e47 along z and -18 094 along x: refused by name, with nothing of NumPy's."""
    front = bp.Fluid(1.14254e47, 388849.0, density_x=-18094.1 + 5428.23j)
    slab = bp.Slab(bp.lmmd_cell(), 10, before=front, after=bp.AIR)
    with pytest.raises(ValueError, match=r"^(the field|before|slab|rtol)"):
        bp.beam_width(slab, bp.GaussianBeam(0.3, x0=-1.7, z0=-0.1), 1731.5, angle=[-60.0, 60.0], rtol=1e-5)


def test_a_rayleigh_angle_needs_a_fluid_that_carries_waves():
    """It divided by k0 = 0."""
    with pytest.raises(ValueError, match="fluid: expected one that carries forward waves"):
        bp.rayleigh_angle(bp.Fluid(-1000.0, 2.2e9), bp.Solid(7900.0, 5900.0, 3200.0))


def test_propagation_off_a_far_contour_overflows_without_words_of_numpy():
    """What is not finite there is refused by name, by the comparison of two contours."""
    grown = transfer_function.propagation(np.array([1 - 1000j, 1 - 1e300j]), 1e10)
    assert not np.isfinite(grown).any()
