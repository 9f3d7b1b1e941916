"""Beam measures against closed forms, and what is said of beams with several humps."""

import numpy as np
import pytest

import beamprop as bp

F = 2500.0
K0 = 2 * np.pi * F / 343
BULK = bp.AIR.bulk_modulus


def test_a_wide_gaussian_in_air():
    """2 a, 2/(k a), all of the power, no shift."""
    beam = bp.GaussianBeam(0.5, angle=20.0)
    a = beam.radius
    with pytest.warns(RuntimeWarning, match="no beam on a side"):
        both = bp.beam_measures(bp.Slab.uniform(bp.AIR, 0.05), beam, 4000.0)
    ds = both.sel(side="transmitted")
    k = 2 * np.pi * 4000 / 343
    assert ds.fwhm == pytest.approx(0.5, rel=2e-3)
    assert ds.width_1e2 == pytest.approx(2 * a, rel=2e-3)
    assert ds.width_second_moment == pytest.approx(2 * a, rel=3e-3)
    assert ds.power == pytest.approx(1.0, abs=1e-9)
    assert ds.far_angle == pytest.approx(20.0, abs=0.1)
    assert ds.divergence == pytest.approx(np.degrees(2 / (k * a)) / np.cos(np.radians(20)), rel=5e-3)
    assert abs(ds.lateral_shift) < 2e-3 * 0.5
    assert ds.crossings == 2


def test_power_is_conserved_without_loss():
    """Reflected and transmitted shares add up, with water behind too."""
    for after in (bp.AIR, bp.Fluid.from_speed(400.0, 500.0)):
        slab = bp.Slab(bp.Cell([bp.Layer(bp.Fluid(3.0, BULK), 0.03), bp.Layer(bp.Fluid(0.4, BULK), 0.05)]), after=after)
        ds = bp.beam_measures(slab, bp.GaussianBeam(0.4), F)
        assert float(ds.power.sum()) == pytest.approx(1.0, abs=1e-6)


def test_goos_haenchen_shift_is_the_phase_slope():
    """Total reflection at 60 degrees of a wide beam: shift = -d(arg r)/dkx (Artmann)."""
    fast = bp.Fluid.from_speed(1.0, 600.0)
    slab = bp.Slab.uniform(fast, 0.5, after=fast)
    k = K0 * np.sin(np.radians(60))
    r = bp.scattering(slab, F, kx=np.array([k - 1e-3, k, k + 1e-3])).r.values
    assert abs(r[1]) == pytest.approx(1.0, abs=1e-9)
    artmann = -np.imag((r[2] - r[0]) / (2e-3 * r[1]))
    with pytest.warns(RuntimeWarning, match="far_angle"):  # nothing radiates behind
        both = bp.beam_measures(slab, bp.GaussianBeam(8.0, angle=60.0), F)
    ds = both.sel(side="reflected")
    assert ds.lateral_shift == pytest.approx(artmann, rel=2e-3)


def test_several_crossings_are_said():
    """Two slits: the half level is met four times."""
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.5, 343.0), 0.01)
    x = np.linspace(-0.3, 0.3, 601)
    two = np.exp(-(((x - 0.12) / 0.03) ** 2)) + np.exp(-(((x + 0.12) / 0.03) ** 2))
    with pytest.warns(RuntimeWarning, match="half level is met"):
        ds = bp.beam_measures(slab, bp.Profile(x, two), 8000.0)
    assert ds.crossings.sel(side="transmitted") == 4


def two_humps():
    x = np.linspace(-0.3, 0.3, 601)
    return bp.Profile(x, np.exp(-(((x - 0.12) / 0.03) ** 2)) + np.exp(-(((x + 0.12) / 0.03) ** 2)))


@pytest.mark.parametrize("beam", [two_humps(), bp.Slits(0.08, 0.3, z0=-0.02)])  # slits: one frequency at a time
def test_widths_of_two_humps_say_so(beam):
    """As often as a field on a fine grid crosses it; all four planes are named."""
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.3, 343.0), 0.01)
    with pytest.warns(RuntimeWarning, match="half level is met up to") as said:
        ds = bp.beam_width(slab, beam, [8000.0, 9000.0], rtol=1e-5)
    (message,) = [str(w.message) for w in said]
    x = np.linspace(-0.4, 0.4, 4001)
    planes = {"fwhm_launch": beam.z0, "fwhm_in": 0.0, "fwhm_out": 0.01}
    met = []
    for name, z in planes.items():
        free = bp.Slab.uniform(bp.AIR, 0.01) if name == "fwhm_in" else slab
        for f in ds.frequency.values:
            p = beam.profile(x, K0) if z == beam.z0 else bp.field(free, beam, f, x, z, rtol=1e-5).p.values
            met.append(np.count_nonzero(np.diff(np.abs(p) > np.abs(p).max() / 2)))
    assert max(met) > 2
    assert f"up to {max(met)} times" in message
    assert message.endswith(": fwhm_launch, fwhm_in, fwhm_out, fwhm_air")


def test_a_plain_beam_says_nothing():
    """The paper's lossy slab and one without loss meet the half level twice (a warning is an error here)."""
    for cell in (bp.lmmd_cell(), bp.lmmd_cell(0.05, 0.0)):
        bp.beam_width(bp.Slab(cell, 450), bp.GaussianBeam(0.096), [2300.0, 2500.0, 2700.0])


def test_crossings_alone_and_together():
    """Sampled on one window at once, and in a window that grows: the same number."""
    from beamprop.profiles import one_frequency, routes, sections
    from beamprop.response import transfer_function
    from beamprop.response.sampled_slab import sample_all

    slab, beam = bp.Slab.uniform(bp.Fluid.from_speed(1.3, 343.0), 0.01), two_humps()
    s = sample_all(slab, np.array([2000.0, 8000.0, 12_000.0]))
    face = np.full(3, slab.thickness)
    route = routes.Route(
        s,
        lambda slab, _: routes.far_face(slab, 0.0),
        lambda single: transfer_function.through(single, 0.0),
        face,
        face,
        True,
    )
    (together,) = sections.measure([route], beam, 1e-6)
    for i in range(3):
        single = s.take(i)
        alone = one_frequency.measured_alone(
            single, beam, transfer_function.through(single, 0.0), (slab.thickness, slab.thickness), 1e-6, 0.5, True
        )
        assert alone[3] == together.crossings[i] == 4
        assert alone[0] == pytest.approx(together.width[i], rel=1e-5)
