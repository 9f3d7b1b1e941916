"""How much work a question takes: plane waves, windows and sums are counted, not timed; and what is refused before the work."""

import re

import numpy as np
import pytest
from accuracy_study.study import comparison

import beamprop as bp
from beamprop.contour import choose as contour_choice
from beamprop.contour import search, stretches
from beamprop.fields import evaluate
from beamprop.modes import misplaced
from beamprop.modes.guided import dispersion_of
from beamprop.profiles import fwhm, one_frequency
from beamprop.response.fluid_slab import FluidSlab
from beamprop.response.sampled_slab import sample
from beamprop.response.transfer_function import through

F = 2500.0
K0 = float(bp.AIR.wavenumber(F).real)


@pytest.fixture
def chosen(monkeypatch):
    """The solutions of every contour that is chosen."""
    found = []
    choose = contour_choice.choose_contour

    def watched(*arguments, **options):
        found.append(choose(*arguments, **options))
        return found[-1]

    monkeypatch.setattr(contour_choice, "choose_contour", watched)
    return found


# --- widths of a profile ----------------------------------------------------------------------------------


def test_a_width_takes_few_values_of_p():
    """Half a hundred on either side of the peak, for the eleven digits that a Gaussian's width is known to."""
    asked = []

    def gaussian(x):
        asked.append(np.size(x))
        return np.exp(-((np.asarray(x) - 0.013) ** 2)) * np.exp(3j * np.asarray(x))

    x = np.linspace(-4, 4, 41)
    found = fwhm.full_width(x, gaussian(x), 0.5, gaussian)
    assert found.width == pytest.approx(2 * np.sqrt(np.log(2)), rel=1e-11)
    assert found.position == pytest.approx(0.013, abs=1e-6)
    assert found.peak == pytest.approx(1.0, rel=1e-11)
    assert sum(asked) - x.size < 110


def test_the_edges_of_slits_are_found():
    """|p| jumps there."""
    x = np.linspace(-1, 1, 64)
    step = lambda at: (np.abs(np.asarray(at) - 0.1) < 0.3) * (1 + 0j)  # noqa: E731
    assert fwhm.full_width(x, step(x), 0.5, step).width == pytest.approx(0.6, rel=1e-10)


def test_many_widths_at_once_are_those_of_each():
    """Of sums of Gaussian beams and tilted waves: by the function itself, by splines, in blocks, and where a part is masked."""
    rng = np.random.default_rng(3)
    x, waves = np.linspace(-4, 4, 81), rng.normal(size=(6, 40, 3, 2))
    amplitude, k, at = waves[0, ..., 0] + 1j * waves[0, ..., 1], 3 * waves[1, ..., 0], waves[1, ..., 1] / 2

    def profile(rows):
        def p(x):
            x = x[..., None]
            a, kx, x0 = (v[rows] if isinstance(rows, int) else v[rows][:, None] for v in (amplitude, k, at))
            return np.sum(a * np.exp(1j * kx * x - (x - x0) ** 2), axis=-1)

        return p

    together = profile(slice(None))(np.broadcast_to(x, (40, 81)))
    inside = np.abs(x) < 1.5
    for level in fwhm.HALF_LEVEL.values():
        exact = fwhm.full_width(x, together, level, profile(slice(None)))
        splines = fwhm.of_samples(x, together, level)
        masked = fwhm.full_width(x, together, level, profile(slice(None)), np.broadcast_to(inside, together.shape))
        for i in range(40):
            alone = fwhm.full_width(x, together[i], level, profile(i))
            np.testing.assert_allclose([v[i] for v in exact], alone, rtol=1e-11, atol=1e-11)
            alone = fwhm.full_width(x, together[i], level)
            np.testing.assert_allclose([v[i] for v in splines], alone, rtol=1e-11, atol=1e-11)
            if np.argmax(np.abs(together[i, inside])) not in (0, np.count_nonzero(inside) - 1):
                alone = fwhm.full_width(x[inside], together[i, inside], level, profile(i))
                np.testing.assert_allclose([masked.left[i], masked.right[i]], alone[:2], rtol=1e-11, atol=1e-11)
        ends = np.stack([exact.left, exact.right], axis=-1)
        np.testing.assert_allclose(
            np.abs(profile(slice(None))(ends)), level * exact.peak[:, None] + 0 * ends, rtol=1e-9
        )
        assert np.all(exact.peak >= np.abs(together).max(axis=-1))


def test_widths_of_samples_are_measured_in_blocks(monkeypatch):
    """The same numbers, whatever the block."""
    x = np.linspace(-1, 1, 101)
    p = np.exp(-((x / np.linspace(0.1, 0.4, 7)[:, None]) ** 2))
    whole = fwhm.of_samples(x, p)
    monkeypatch.setattr(fwhm, "MOST_SAMPLES", 250)
    np.testing.assert_array_equal(fwhm.of_samples(x, p), whole)
    np.testing.assert_allclose(whole.width, np.linspace(0.1, 0.4, 7) * 2 * np.sqrt(np.log(2)), rtol=1e-4)


def test_spectra_are_formed_once_for_all_positions(monkeypatch):
    """A search for edges asks for p at many positions, one after the other."""
    beam = bp.Profile(np.linspace(-0.3, 0.3, 61), np.exp(-((np.linspace(-0.3, 0.3, 61) / 0.1) ** 2)))
    s = sample(bp.Slab.uniform(bp.AIR, 0.1), F)
    transfer, z = through(s, 0.0), np.array([0.1])
    solution = contour_choice.choose_contour(s, evaluate.single(beam), transfer, np.linspace(-1, 1, 31), z, 1e-8)
    p = evaluate.evaluator(s, beam, solution, transfer(solution.contour.k, z))
    monkeypatch.setattr(bp.Profile, "spectrum", None)
    assert np.all(np.isfinite(p(np.array([0.0, 0.1]))))
    assert np.all(np.isfinite(p(np.array([0.05]))))


# --- spectra that are cut off -----------------------------------------------------------------------------


def jagged(z0, angle=0.0):
    """A profile whose samples' spectrum is cut off where it is large, among waves that evaluate."""
    x = np.linspace(-0.8, 0.8, 17)
    return bp.Profile(x, np.cos(40 * x) + 0.7j * np.sin(7 * x) + (np.arange(17) % 3 == 0), z0, angle)


def on_the_axis(beam, slab, x, z):
    """p by Gauss panels over the real axis up to where the spectrum ends: nothing has a pole there."""
    s, k0 = sample(slab, F), K0
    lo, hi = beam.spectrum_ends(k0)
    near = [b + side * np.geomspace(1e-9, 1, 4000) for b in (-k0, k0) for side in (-1, 1)]
    stops = np.unique(np.concatenate([np.linspace(lo, hi, 20_001), *near, [-k0, k0]]))
    stops = stops[(stops >= lo) & (stops <= hi)]
    g, w = np.polynomial.legendre.leggauss(16)
    half = np.diff(stops)[:, None] / 2
    k, weight = (stops[:-1, None] + half * (g + 1)).ravel(), (half * w).ravel() / (2 * np.pi)
    h = through(s, beam.z0)(np.abs(k) + 0j, np.atleast_1d(z))
    return (h * weight * beam.spectrum(k, k0)) @ np.exp(1j * np.outer(k, x))


@pytest.mark.parametrize("z0", [0.0, -300.0])
@pytest.mark.parametrize("angle", [0.0, 35.0])
def test_a_spectrum_that_is_cut_off_is_met_on_the_axis(chosen, z0, angle):
    """Against a quadrature on the axis. On a long way what is cut off arrives, though on a contour below the axis it has died."""
    beam, slab = jagged(z0, angle), bp.Slab.uniform(bp.Fluid(2.0 + 0.1j, 200_000.0), 0.07)
    x, z = np.linspace(-1, 1, 11), np.array([0.07, 0.2])
    ds = bp.field(slab, beam, F, x, z, rtol=1e-8)
    want = on_the_axis(beam, slab, x, z)
    assert np.abs(ds.p.values - want).max() < 1e-8 * np.abs(want).max()
    assert float(ds.error_estimate) < 1e-8
    assert max(solution.contour.k.size for solution in chosen) < (8000 if z0 == 0 else 30_000)  # phases turn over 300 m


def test_the_estimate_knows_what_many_angles_lack():
    """More beams than a contour meets the ends of: the error is estimated no smaller than it is."""
    beam, slab = jagged(-300.0), bp.Slab.uniform(bp.Fluid(2.0 + 0.1j, 200_000.0), 0.07)
    x, angles = np.linspace(-1, 1, 11), np.linspace(-30, 30, search.MOST_CUT + 1)
    with pytest.warns(bp.AccuracyWarning):
        ds = bp.field(slab, beam, F, x, [0.2], angle=angles, rtol=1e-6)
    for i in (0, 5):
        want = on_the_axis(beam.at_angle(float(angles[i])), slab, x, 0.2)
        error = np.abs(ds.p.values[i] - want).max() / np.abs(want).max()
        assert error < float(ds.error_estimate[i])


# --- windows ----------------------------------------------------------------------------------------------


def test_a_far_beam_is_looked_for_where_it_lands(chosen):
    """980 m of air: one window, where a clipped one was doubled five times."""
    beam = bp.GaussianBeam(0.3, 49.6)
    ds = bp.beam_width(bp.Slab.uniform(bp.AIR, 980.0), beam, 1000.0, rtol=1e-6)
    assert len(chosen) == 1
    assert float(ds.fwhm_out) == pytest.approx(far_width(beam, 1000.0, 980.0), rel=2e-3)


def far_width(beam, f, z):
    """The width of |S(k0 sin)| cos/sqrt(r) on a plane far away (stationary phase)."""
    k0 = float(bp.AIR.wavenumber(f).real)
    x = np.linspace(-3 * z, 20 * z, 400_001)
    r = np.hypot(x, z)
    size = np.abs(beam.spectrum(k0 * x / r, k0)) * z / r / np.sqrt(r)
    above = np.flatnonzero(size > size.max() / 2)
    return x[above[-1]] - x[above[0]]


def test_the_way_to_the_slab_is_no_part_of_the_way_without_it(chosen):
    """`fwhm_launch` of a rotated beam from afar is that of its waist, for no more plane waves than the same beam at the slab takes."""
    slab = bp.Slab.uniform(bp.AIR, 0.1)
    far, near = (
        bp.beam_width(slab, bp.GaussianBeam(0.3, 20.0, z0=z0, form="rotated"), F, rtol=1e-6) for z0 in (-200.0, 0.0)
    )
    assert float(far.fwhm_launch) == pytest.approx(float(near.fwhm_launch), rel=1e-9)
    assert float(far.fwhm_air) == pytest.approx(float(near.fwhm_air), rel=1e-9)
    count = [solution.contour.k.size for solution in chosen]
    assert count[0] < 500
    assert max(count) > 5000  # at the slab


def test_a_rotated_beam_from_too_far_is_refused_before_the_work(chosen):
    """By its plane waves; a distance that takes fewer is not."""
    slab = bp.Slab.uniform(bp.AIR, 0.1)
    beam = bp.GaussianBeam(0.3, -28.8, z0=-41_968.0, form="rotated")
    for ask in (bp.beam_width, bp.beam_measures):
        with pytest.raises(ValueError, match=r"^z0: expected a way .* at most 600000 plane waves, got 4.2e\+04 m"):
            ask(slab, beam, F)
    assert all(solution.contour.k.size < 500 for solution in chosen)


LOSSLESS = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), 20)


def test_a_guided_wave_that_runs_on_widens_no_window(chosen):
    """Two windows show the same peak, edges on both sides and a wave beside it that does not fall: seven more show nothing else."""
    x = np.linspace(-0.6, 0.6, 137)
    rng = np.random.default_rng(4)
    beam = bp.Profile(x, rng.normal(size=137) + 1j * rng.normal(size=137))
    with pytest.warns(RuntimeWarning, match="the half level is met up to"):
        ds = bp.beam_width(LOSSLESS, beam, F, rtol=1e-6)
    width = float(ds.fwhm_out)
    x = np.linspace(-8, 8, 32_001)
    p = np.abs(bp.field(LOSSLESS, beam, F, x, LOSSLESS.thickness, rtol=1e-6).p.values)
    top = int(np.argmax(p))
    assert max(p[0], p[-1]) > 0.4 * p.max()
    below = np.flatnonzero(p < p[top] / 2)
    assert width == pytest.approx(
        x[below[below > top][0]] - x[below[below < top][-1]], abs=1e-3
    )  # the grid of both ends
    windows = [solution for solution in chosen[:-1] if solution.contour.k.imag.any()]
    assert len(windows) <= 5  # launch, near, far and air


def test_windows_of_a_beam_that_falls_are_widened():
    """|p| of a beam in open space falls by more than a guided wave's, and a peak that changes is another."""
    rim = one_frequency._Rim
    assert not one_frequency._runs_on([rim(1.0, 0.8, True)], True)
    assert not one_frequency._runs_on([rim(1.0, 0.8, True), rim(1.0, 0.56, True)], True)
    assert not one_frequency._runs_on([rim(1.0, 0.8, True), rim(1.2, 0.8, True)], True)
    assert not one_frequency._runs_on([rim(1.0, 0.8, False), rim(1.0, 0.8, True)], True)
    assert one_frequency._runs_on([rim(1.0, 0.8, True), rim(1.0, 0.8, True)], False)
    assert one_frequency._runs_on(4 * [rim(1.0, 0.8, False)], True)
    assert not one_frequency._runs_on(4 * [rim(1.0, 0.8, False)], False)


# --- backward waves ---------------------------------------------------------------------------------------


def with_loss(slab, loss):
    """A slab with the loss that a refusal names."""

    def lossy(fluid):
        rho, K = fluid.density, fluid.bulk_modulus
        return bp.Fluid(rho + 1j * loss * abs(rho), K - 1j * loss * abs(K))

    segments = [(bp.Cell([bp.Layer(lossy(y.fluid), y.thickness) for y in c.layers]), n) for c, n in slab.segments]
    return bp.Slab.stack(segments, lossy(slab.before), lossy(slab.after))


def test_the_loss_that_a_refusal_names_does(monkeypatch):
    """And it is found by the count of modes at a few losses."""
    losses, make, search, searching = set(), FluidSlab.with_loss, misplaced.enough_loss, []

    def searched(*given):
        searching.append(True)
        return search(*given)

    monkeypatch.setattr(misplaced, "enough_loss", searched)
    monkeypatch.setattr(FluidSlab, "with_loss", lambda s, loss: (losses.add(loss) if searching else 0) or make(s, loss))
    slab = bp.Slab.uniform(bp.Fluid(-3.0, -100_000.0), 50.0) + bp.Slab.uniform(bp.Fluid(2.0, 200_000.0), 0.03)
    question = bp.GaussianBeam(0.05, 20.0, z0=-0.01), F, np.linspace(-0.3, 0.3, 31), [0.0, slab.thickness]
    with pytest.raises(ValueError, match="slab: it guides more backward waves") as refused:
        bp.field(slab, *question, rtol=1e-6)
    assert len({loss for loss in losses if loss in misplaced.REMEDIES}) <= 4
    assert f"away, the slab {50.03 * K0 / (2 * np.pi):.3g} thick" in str(refused.value)
    loss = float(re.search(r"loss of (\S+) would do", str(refused.value))[1])
    ds = bp.field(with_loss(slab, loss), *question, rtol=1e-6)
    assert float(ds.error_estimate) < 1e-6


def test_in_a_gap_the_faces_modes_do_not_depend_on_the_periods():
    """D without the growth of Bloch waves is the same for 1000 and for 100 000 periods; with it it varies by hundreds of e-folds."""
    cell = bp.Cell([bp.Layer(bp.AIR, 0.02), bp.Layer(bp.Fluid(2.0, 150_000.0), 0.03)])
    many, more = (sample(bp.Slab(cell, n), F) for n in (1000, 100_000))
    lo, hi = stretches.bands_of(many, 2 * K0).gaps[-1]
    k = np.linspace(lo + 0.2 * (hi - lo), hi, 50) + 0.01j * (hi - lo)
    one, two = (value * np.exp(log) for value, log in (stretches._without_growth(s, 0.0)(k) for s in (many, more)))
    assert np.abs(one / two - 1).max() < 1e-6
    _, log = dispersion_of(many, 0.0)(k)
    assert np.ptp(np.real(log)) > 100


def test_a_hundred_thousand_periods_with_gaps_are_answered():
    """A question of the accuracy study that was refused; there it is compared with the truth."""
    row = comparison.compare_with_truth(2331)
    assert row["status"] == "answered"
    assert row["error"] < row["rtol"]
    assert row["estimate"] < row["rtol"]
