"""rtol is a promise: random cases against an independent quadrature, limits of small loss, and nothing that is not finite."""

import warnings

import accuracy
import numpy as np
import pytest
from panels import panels
from worse_contours import with_larger_errors

import beamprop as bp
from beamprop.contour import choose as contour_choice
from beamprop.contour import error as contour_error
from beamprop.contour import paths, survey
from beamprop.profiles import many_frequencies, routes
from beamprop.response import sampled_slab, transfer_function
from beamprop.sources import angles

F = 2500.0
#: Numbers of the study's cases, four of each kind of slab: the first whose truth takes about a second or less.
CASES = [
    (0, 15, 30, 45), (1, 16, 46, 61), (17, 47, 62, 77), (18, 48, 123, 138), (4, 19, 34, 49), (5, 20, 35, 50), (6, 21, 51, 66),
    (7, 22, 37, 67), (8, 23, 53, 68), (9, 24, 39, 54), (10, 40, 70, 115), (56, 86, 101, 116), (42, 117, 132, 147),
    (13, 43, 58, 73), (14, 29, 44, 59),
]  # fmt: skip
AIR_BULK = bp.AIR.bulk_modulus

# --- the study, shortened ---------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", list(accuracy.SLABS))
def test_four_cases_of_each_kind(kind):
    """No error above rtol without a warning; no estimate below a third of the error. Few are without a truth."""
    rows = [accuracy.compare_with_truth(n) for n in CASES[list(accuracy.SLABS).index(kind)]]
    assert {r["kind"] for r in rows} == {kind}
    compared = [r for r in rows if r["status"] == "answered"]
    assert len(compared) >= 3
    assert all(r["status"] in ("answered", "refused", "no truth") for r in rows), rows
    for r in compared:
        assert not r["reason"], r
        error = r["error"] - r["truth_error"]
        assert error <= r["rtol"] or r["warned"], r
        assert error <= 3 * r["estimate"], r


def test_the_worst_of_mixed_angles_is_seen_wherever_it_is_asked_for():
    """Slits that nearly cancel behind a fast fluid at the steepest angle, requested among angles that begin and end elsewhere.

    Those, and three between, are nodes of the interpolation over angles, where it is exact.
    """
    lam = 343 / F
    slab = bp.Slab.uniform(bp.AIR, 0.05, after=bp.Fluid.from_speed(1000.0, 34_300.0))
    beam, x, z = bp.Slits(0.05 * lam, 0.6 * lam, 2), np.linspace(-0.5, 0.5, 21), 0.05 + 5 * lam
    requested = np.degrees(np.arcsin(np.linspace(0, 1 / 1.2, 55)))
    summed = angles.interpolate_angles(beam, requested, 2 * np.pi / lam, 1e-7).angles
    requested = np.insert(requested, [0, 14, 28, 41, 55], summed[[0, 2, 4, 5, -1]])
    interpolated = bp.field(slab, beam, F, x, z, angle=requested, rtol=1e-3).isel(angle=-2)
    right = bp.field(slab, beam.at_angle(requested[-2]), F, x, z, rtol=1e-9)
    error = float(np.abs(interpolated.p - right.p).max() / np.abs(right.p).max())
    assert 1e-7 < error < interpolated.error_estimate  # interpolated to 1e-7 of what is launched


# --- limits of small loss ---------------------------------------------------------------------------------


def test_limiting_absorption():
    """The paper's slab with less and less loss tends to the lossless one, linearly, at 2000 and 2400 Hz."""
    apart = accuracy.limiting_absorption().apart.values
    assert apart[0].max() < 0.5
    np.testing.assert_allclose(apart[2:-1] / apart[3:], 10, rtol=0.02)
    np.testing.assert_allclose(apart[-2] / apart[-1], 10, rtol=2e-3)


def backward_medium(loss):
    """A thin layer of density -0.5 that of air, which guides a backward wave."""
    return bp.Slab.uniform(bp.Fluid(1.25 * (-0.5 + 0.5j * loss), AIR_BULK * (1 - 1j * loss)), 0.007)


def test_a_backward_mode_is_the_limit_of_small_losses():
    """Linear convergence; without the circle around the pole the field would be off by much more than the least loss."""
    beam = bp.GaussianBeam(0.03, 40.0, z0=-0.02)
    x, z = np.linspace(-0.5, 0.5, 41), np.array([-0.02, 0.0, 0.0035, 0.007, 0.03])
    modes = bp.guided_modes(backward_medium(0.0), F)
    assert -1 in modes.direction.values
    limit = bp.field(backward_medium(0.0), beam, F, x, z, rtol=1e-10).p.values
    apart = [
        np.abs(bp.field(backward_medium(loss), beam, F, x, z, rtol=1e-10).p.values - limit).max() / np.abs(limit).max()
        for loss in (1e-3, 1e-4, 1e-5, 1e-6)
    ]
    np.testing.assert_allclose(np.array(apart[1:-1]) / apart[2:], 10, rtol=0.02)
    assert apart[-1] < 1e-4


def test_backward_modes_without_number_are_answered_by_the_bands():
    """Case 33, 100 000 lossless periods that guide backward waves without number: the limit of small losses."""
    case = accuracy.make_case(33)
    ask = (case.beam, case.frequency, case.x, case.z)
    lossless = bp.field(case.slab, *ask, rtol=case.rtol)
    assert float(lossless.error_estimate) <= case.rtol
    cell, periods = case.slab.segments[0]
    apart = []
    for loss in (1e-7, 1e-8):
        layers = [
            bp.Layer(
                bp.Fluid(v.fluid.density + 1j * loss * abs(v.fluid.density), v.fluid.bulk_modulus * (1 - 1j * loss)),
                v.thickness,
            )
            for v in cell.layers
        ]
        p = bp.field(bp.Slab(layers, periods), *ask, rtol=1e-9).p.values
        apart.append(np.abs(p - lossless.p.values).max() / np.abs(p).max())
    assert apart[0] < 1e-5
    np.testing.assert_allclose(apart[0] / apart[1], 10, rtol=0.02)


# --- what an error is relative to -------------------------------------------------------------------------


@pytest.mark.parametrize("medium", ["air", "lossless"])
def test_errors_are_over_the_largest_pressure_of_the_plane_wherever_it_lies(medium):
    """A beam that lands far outside the window: the field there is small, and good enough for the plane.

    Its largest |p| is found where the beam does land, to a factor of 3.
    """
    slab = bp.Slab.uniform(bp.AIR, 0.1) if medium == "air" else bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)
    beam = bp.GaussianBeam(0.7, 60.0, z0=-20.0)
    x, far = np.linspace(-0.1, 0.1, 11), np.linspace(30, 40, 400)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        window = bp.field(slab, beam, F, x, slab.thickness)
        truth = bp.field(slab, beam, F, np.concatenate([x, far]), slab.thickness, rtol=1e-10)
    peak = float(np.abs(truth.p).max())
    assert np.abs(truth.p[: x.size]).max() < 1e-6 * peak
    allowed = 3 * float(window.error_estimate) + float(truth.error_estimate)
    assert np.abs(window.p - truth.p[: x.size]).max() < min(1e-8, allowed) * peak
    s = sampled_slab.sample(slab, F)
    reach = paths.Extent(s.k0, s.k0, 2 * s.k0, 0.1, 2.0, 20.0)
    planes = np.array([-20.0, slab.thickness])
    outside = survey.survey(
        s, angles.single(beam), transfer_function.through(s, beam.z0), x, planes, reach, 1e-8
    ).peaks_outside[0, 1]
    assert 0.3 * peak < outside < 1.1 * peak


def test_a_beam_that_lands_in_the_window_is_not_looked_for():
    s = sampled_slab.sample(bp.Slab.uniform(bp.AIR, 0.1), F)
    reach = paths.Extent(s.k0, s.k0, 2 * s.k0, 0.1, 2.0, 20.0)
    planes, x = np.array([0.0, 0.1]), np.linspace(-1, 1, 11)
    beam = bp.GaussianBeam(0.3, 30.0, z0=-1.0)
    assert not survey.survey(
        s, angles.single(beam), transfer_function.through(s, beam.z0), x, planes, reach, 1e-8
    ).peaks_outside.any()


@pytest.mark.parametrize("rtol", [1e-4, 1e-8])
@pytest.mark.parametrize("half", [0.01, 1.0])
@pytest.mark.parametrize(("width", "angle", "z0"), [(0.2, 45.0, -300.0), (5.0, 60.0, -1000.0), (0.7, 85.0, -30.0)])
def test_beams_from_far_away(width, angle, z0, half, rtol):
    """Launched hundreds of wavelengths in front, seen beside the axis: no warning, against a quadrature over real kx."""
    wavelength = 343 / F
    k0, a = 2 * np.pi / wavelength, width * wavelength / (2 * np.sqrt(np.log(2)))
    beam = bp.GaussianBeam(width * wavelength, angle, z0=z0 * wavelength)
    x, far = half * wavelength * np.linspace(-1, 1, 7), -beam.z0 * np.tan(np.radians(np.linspace(0, angle, 40)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ds = bp.field(bp.Slab.uniform(bp.AIR, 0.1), beam, F, x, 0.0, rtol=rtol)
    # kx = k0 sin(u) below k0, and k0 cosh(v) beyond, as far as waves arrive; weights dkx
    u, w = panels(np.linspace(-np.pi / 2, np.pi / 2, int(11 - 4 * z0)))
    v, dv = panels(np.linspace(0, np.arcsinh(40 / abs(k0 * beam.z0)), 41))
    k = k0 * np.concatenate([np.sin(u), np.cosh(v), -np.cosh(v)])
    kz = k0 * np.concatenate([np.cos(u), 1j * np.sinh(v), 1j * np.sinh(v)])
    weight = k0 * np.concatenate([np.cos(u) * w, np.sinh(v) * dv, np.sinh(v) * dv]) / (2 * np.pi)
    S = a * np.sqrt(np.pi) * np.exp(-((a * (k - k0 * np.sin(np.radians(angle))) / 2) ** 2))
    sent = S * weight * np.exp(-1j * kz * beam.z0)
    near, there = (np.exp(1j * np.outer(at, k)) @ sent for at in (x, far))
    peak = max(np.abs(near).max(), np.abs(there).max())
    assert np.abs(ds.p.values - near).max() < 3 * float(ds.error_estimate) * peak
    assert float(ds.error_estimate) <= rtol


@pytest.mark.parametrize("medium", ["twelve layers", "water"])
def test_beams_from_far_away_through_a_slab(medium):
    """Little is left of them on the contour but near kx = 0, where a window for the positions alone would take too few plane waves."""
    wavelength, water = 343 / F, bp.Fluid.from_speed(1000.0, 1480.0)
    slab, width, angle, z0 = {
        "twelve layers": (bp.Slab(bp.lmmd_cell(n_layers=12), 450), 0.2, 45.0, -300.0),
        "water": (bp.Slab.uniform(bp.Fluid(500.0, 1e9), 0.5, before=water, after=water), 5.0, 60.0, -1000.0),
    }[medium]
    beam = bp.GaussianBeam(width * wavelength, angle, z0=z0 * wavelength)
    x, z = 0.05 * width * wavelength * np.linspace(-1, 1, 11), slab.thickness * np.array([0.0, 0.5, 1.0, 1.3])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rough, fine = (bp.field(slab, beam, F, x, z, rtol=rtol) for rtol in (1e-4, 1e-9))
    apart = np.abs(rough.p - fine.p).max("x") / np.abs(fine.p).max("x")
    assert apart.max() < 1e-3  # of the window's largest |p|, a part of the plane's


# --- work and what is requested ---------------------------------------------------------------------------


@pytest.mark.parametrize("points", [41, 1024])
@pytest.mark.parametrize("loss", [(0.05, 0.0), (0.05 + 0.05j, 0.025)])
def test_lower_accuracy_is_cheaper(loss, points):
    """Plane waves of the contour that is chosen: fewer the larger rtol is."""
    s = sampled_slab.sample(bp.Slab(bp.lmmd_cell(*loss), 450), F)
    x, z = np.linspace(-1, 1, points), np.linspace(0, s.thickness, 9)
    sizes = []
    for rtol in (1e-3, 1e-5, 1e-7, 1e-9, 1e-11):
        quadrature = contour_choice.choose_contour(
            s, angles.single(bp.GaussianBeam(0.096, 30.0)), transfer_function.through(s, 0.0), x, z, rtol
        )
        assert quadrature.error[0] <= rtol
        sizes.append(quadrature.contour.k.size)
    assert sizes == sorted(sizes)
    assert sizes[0] < 0.6 * sizes[-1]


@pytest.mark.parametrize("ask", [bp.beam_width, bp.beam_measures])
def test_widths_and_measures_say_when_rtol_is_not_reached(ask, monkeypatch):
    """As `field` does: one category of warning, with the estimate."""

    def none_trusted(first, *_):
        count = len(first.right)
        return routes.Measures(*4 * [np.zeros(count)], contour_error.uniform_budget(count, 0.0)), np.zeros(count, bool)

    with_larger_errors(monkeypatch, by=3e-4)
    monkeypatch.setattr(many_frequencies, "_measured", none_trusted)
    with pytest.warns(bp.AccuracyWarning, match=r"3\.0e-04 .* above the requested rtol 1\.0e-07"):
        ask(bp.Slab(bp.lmmd_cell(), 20), bp.GaussianBeam(0.2), F, rtol=1e-7)


# --- sources ----------------------------------------------------------------------------------------------


def test_fields_of_many_waves_and_points_take_bounded_memory():
    """100 000 waves on 2048 points: the matrix of their phases, 3 GB, is never whole."""
    from beamprop.contour import sums

    k = np.linspace(0, 100, 5000).astype(complex)
    x = np.linspace(-1, 1, 999)
    h, right = np.exp(-k)[None], np.exp(-k / 10)
    line = paths.Contour(k, np.ones(k.size))
    whole = (h * right) @ np.exp(1j * np.outer(k, x)) + (h * right) @ np.exp(-1j * np.outer(k, x))
    np.testing.assert_allclose(sums.direct_sum(line, h, right, right, x), whole, rtol=1e-12)


# --- nothing that is not finite ---------------------------------------------------------------------------


def random_slab(rng):
    """Any of: uniform or modulated, positive, negative or zero density, thin or thick, other half-spaces."""

    def density():
        size = np.exp(rng.uniform(-6, 6)) * rng.choice([1, 1, 1, -1])
        return (
            0.0
            if rng.random() < 0.05
            else 1.25 * complex(size, rng.choice([0, abs(size) * np.exp(rng.uniform(-8, 0))]))
        )

    def fluid():
        K = AIR_BULK * np.exp(rng.uniform(-3, 5)) * rng.choice([1, 1, 1, -1])
        return bp.Fluid(density(), K) if rng.random() < 0.8 else bp.Fluid(density() or 1.0, K, density_x=np.inf)

    water = bp.Fluid.from_speed(1000.0, 1480.0)
    before, after = (water if rng.random() < 0.2 else bp.AIR for _ in range(2))
    if rng.random() < 0.3:
        loss = rng.choice([0, np.exp(rng.uniform(-9, 0))])
        cell = bp.lmmd_cell(rng.uniform(-1, 1) + 1j * loss, loss / 2, int(rng.integers(2, 15)), 1 / rng.uniform(2, 100))
        return bp.Slab(cell, int(np.exp(rng.uniform(0, 14))), before, after)
    layers = [bp.Layer(fluid(), np.exp(rng.uniform(-20, 7))) for _ in range(rng.integers(1, 5))]
    return bp.Slab(layers, int(np.exp(rng.uniform(0, 10))), before, after)


def test_a_hundred_thousand_plane_waves():
    """No nan, no infinity, no floating-point error but underflow, from kx = 0 to 1000 k0; few that rounding decides."""
    rng = np.random.default_rng(5)
    count = doubtful = 0
    with np.errstate(all="raise", under="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore", bp.AccuracyWarning)
        for _ in range(500):
            slab, f = random_slab(rng), rng.uniform(100, 10_000)
            ratio = np.concatenate([[0.0, 1.0], rng.uniform(0, 2, 98), np.exp(rng.uniform(-7, np.log(1e3), 100))])
            ds = bp.scattering(slab, f, kx_over_k0=ratio)
            for name in ("r", "t", "transmissivity", "reflectivity"):
                assert np.all(np.isfinite(ds[name])), (slab, f, name)
            assert not np.any(np.isnan(ds.error_estimate))
            count += ratio.size
            doubtful += int((ds.error_estimate > 1e-6).sum())
    assert count == 100_000
    assert doubtful < 300  # most of them in one slab, 16 000 km thick
