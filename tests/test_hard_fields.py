"""Fields that are hard to compute: each against a truth of its own, from plain matrices on contours or from closed forms."""

import mpmath as mp
import numpy as np
import pytest
import sided
from accuracy_study.reference import many_digits
from accuracy_study.reference.medium import Medium
from answers import field_and_warning, plane_errors, slab_of
from sided import AIR, BULK, K0, LAM, RHO, F

import beamprop as bp

X = np.linspace(-0.5, 0.5, 21)


# --- backward waves ---------------------------------------------------------------------------------------

#: Ordinary layers in front of a half-space of negative density. Its face to a heavier layer guides a wave whose power, most of it
#: in the half-space, runs against its phase; the layers guide a forward wave besides.
BACKWARD = {
    "one layer": ([(2.4 * RHO, 3 * BULK, 0.02 * LAM)], (-2 * RHO, BULK)),
    "two layers": ([(0.8 * RHO, 2 * BULK, 0.1 * LAM), (4.4 * RHO, 2 * BULK, 0.02 * LAM)], (-3 * RHO, 0.7 * BULK)),
}


def with_loss(case, loss):
    layers, after = BACKWARD[case]
    return ([sided.lossy(v, loss) for v in layers], sided.lossy(after, loss)) if loss else (layers, after)


@pytest.mark.parametrize("case", BACKWARD)
def test_backward_waves_that_a_half_space_guides(case):
    """Limiting absorption: the contour passes above those modes that a trace of loss moves below the axis.

    Without loss and with, and the field goes over from one to the other in proportion to a little loss.
    """
    known = sided.modes(*BACKWARD[case], 340.0)
    assert {side for _, side in known} == {1, -1}
    z = [-0.02, 0.0, 0.01, 0.06]
    k, w = sided.contour([*known, (K0, 1)], 330.0, 6.0)
    p = {}
    for loss in (0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2):
        layers, after = with_loss(case, loss)
        truth = sided.summed(k, w, sided.response(layers, after, k, z, -0.02), sided.gaussian(0.05, 20), X)
        ds, warned = field_and_warning(
            slab_of(layers, after=after), bp.GaussianBeam(0.05, 20, 0, -0.02), F, X, z, rtol=1e-8
        )
        p[loss] = ds.p.values
        assert plane_errors(p[loss], truth).max() < 1e-8
        assert not warned
    assert plane_errors(p[1e-5], p[0.0]).max() == pytest.approx(10 * plane_errors(p[1e-6], p[0.0]).max(), rel=0.05)


@pytest.mark.parametrize(
    "layers",
    [
        [(-0.6 * RHO, 2 * BULK, 0.04 * LAM), (RHO, BULK, 0.1 * LAM)],
        [(-0.6 * RHO, -2 * BULK, 0.1 * LAM), (RHO, BULK, 0.1 * LAM)],
        [(-0.6 * RHO, 2 * BULK, 0.1 * LAM), (RHO, BULK, 0.03 * LAM)],
    ],
)
def test_a_negative_layer_in_front_of_density_zero(layers):
    """A layer of density 0 is a soft wall, p = 0, to every plane wave but that of normal incidence; what is behind it is dark."""
    known = sided.modes(layers, None, 340.0)
    assert any(side < 0 for _, side in known)
    thickness = sum(d for *_, d in layers)
    z = [-0.02, -0.01, 0.0, 0.7 * thickness]
    k, w = sided.contour([*known, (K0, 1)], 330.0, 6.0)
    truth = sided.summed(k, w, sided.response(layers, None, k, z, -0.02), sided.gaussian(0.05, 20), X)
    wall = slab_of([*layers, (0.0, BULK, 0.1 * LAM)])
    ds, warned = field_and_warning(wall, bp.GaussianBeam(0.05, 20, 0, -0.02), F, X, z, rtol=1e-8)
    assert plane_errors(ds.p.values, truth).max() < 1e-8
    assert not warned


# --- resonances at normal incidence -----------------------------------------------------------------------

MIRRORS = {"steel": (7800.0, 5900.0), "water": (1000.0, 1480.0)}


@pytest.mark.parametrize("beside", [0.0, 1e-12, 1e-9, 1e-7, 1e-5])
@pytest.mark.parametrize("mirror", MIRRORS)
def test_a_cavity_between_quarter_wave_mirrors(mirror, beside):
    """Half a wavelength of air between quarter waves of what is 3500 and 100 000 times as hard: resonances down to 1e-9 wide.

    Their poles lie next to kx = 0. Right to rtol with no warning, or with a warning and an estimate that holds.
    """
    rho, speed = MIRRORS[mirror]
    plate = (rho, rho * speed**2, speed / F / 4)
    layers = [plate, (RHO, BULK, LAM / 2), plate]
    frequency, x = F * (1 + beside), np.linspace(-1, 1, 21)
    k0, z = 2 * np.pi * frequency / 343.0, [-0.05, sum(d for *_, d in layers)]
    k, w = sided.contour([(k0, 1)], 88.0, 2.0, finest=1e-8, panel=4.0, order=12)
    medium = Medium(slab_of(layers), frequency)
    h = np.array([many_digits.response(medium, kx, z, -0.1, digits=30) for kx in k]).T
    truth = sided.summed(k, w, h, sided.gaussian(0.5, 3, k0), x)
    ds, warned = field_and_warning(slab_of(layers), bp.GaussianBeam(0.5, 3, 0, -0.1), frequency, x, z, rtol=1e-8)
    error, estimate = plane_errors(ds.p.values, truth).max(), float(ds.error_estimate)
    assert error < 3 * estimate
    assert warned == (estimate > 1e-8)
    assert estimate < 1e-4  # no worse than what rounding leaves of the sharpest
    assert error < 1e-8 or beside < 1e-7


# --- dark planes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("widths", [3, 30, 300])
def test_planes_at_nodes_in_front_of_a_soft_wall(widths):
    """An image of the other sign behind the wall: 2i sin(kz z). Among many planes some are at nodes, where |p| is small."""
    beam = bp.GaussianBeam(widths * LAM, 0, 0, -2.3 * LAM)
    nodes = -0.5 * LAM * np.arange(1, 5)
    z = np.unique(np.concatenate([np.linspace(-2.3 * LAM, 0, 24), nodes, nodes - 1e-6 * LAM, nodes - 1e-3 * LAM]))
    x = np.linspace(-1, 1, 41)
    k, w = sided.contour([(K0, 1)], 120.0, min(2.0, 4 / (widths * LAM)))
    kz = np.sqrt(K0**2 - k**2)
    h = np.array([2j * np.sin(kz * depth) * np.exp(-1j * kz * beam.z0) for depth in z])
    truth = sided.summed(k, w, h, sided.gaussian(beam.fwhm), x)
    ds, warned = field_and_warning(slab_of([(0.0, BULK, 0.1)]), beam, F, x, z, rtol=1e-8)
    p = ds.p.values
    assert np.all(np.abs(p[z == 0]) < 1e-13)
    assert plane_errors(p[z < 0], truth[z < 0]).max() < 1e-8
    assert not warned


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("wall", ["soft", "hard"])
def test_nodes_between_the_planes_that_stand_for_all(wall, rtol):
    """A plane every quarter wavelength: every second one is a node, and an even choice of a few takes antinodes alone.

    Errors are over the largest |p| of each plane, so that the nodes decide.
    """
    hard = (1e9 * RHO, 1e9 * BULK, 0.1)
    z = -LAM / 4 * np.arange(24 + (wall == "soft"), -1 + (wall == "soft"), -1)
    beam = bp.GaussianBeam(30 * LAM, 0, 0, z[0] - 0.02 * LAM)
    x, wide = beam.fwhm * np.linspace(-1, 1, 41), beam.fwhm * np.linspace(-4, 4, 201)
    k, w = sided.contour([(K0, 1)], 20.0, 1 / beam.fwhm)
    if wall == "hard":
        h = sided.response([hard], AIR, k, z, beam.z0)
    else:
        kz = np.sqrt(K0**2 - k**2)
        h = np.array([2j * np.sin(kz * depth) * np.exp(-1j * kz * beam.z0) for depth in z])
    spectrum = sided.gaussian(beam.fwhm)
    truth = sided.summed(k, w, h, spectrum, x)
    largest = np.abs(sided.summed(k, w, h, spectrum, wide)).max(axis=1)
    assert largest[1::2].max() < 1e-2 * largest[::2].min()
    ds, warned = field_and_warning(slab_of([hard if wall == "hard" else (0.0, BULK, 0.1)]), beam, F, x, z, rtol=rtol)
    error = (np.abs(ds.p.values - truth).max(axis=1) / largest).max()
    assert error < rtol
    assert error < 3 * float(ds.error_estimate)
    assert not warned


# --- behind a quarter-wave mirror -------------------------------------------------------------------------


def behind_periods_of_quarter_waves(f, contrast, periods, x, distances, digits=30, count=600):
    """p at x and at distances behind periods of air and what is `contrast` times as hard, each a quarter wave of air at F.

    The trapezoid rule on k = s - 2i tanh(s/8) with 30 digits: the plane waves there cancel to 1e-14 and less.
    """
    with mp.workdps(digits):
        k0, a, d = 2 * mp.pi * mp.mpf(f) / 343, mp.mpf("0.25") / mp.sqrt(mp.log(2)), mp.mpf(LAM) / 4
        step, p = mp.mpf(50) / count, mp.zeros(len(distances), len(x))
        for i in range(count):
            s = (i + mp.mpf("0.5")) * step
            k, slope = s - 2j * mp.tanh(s / 8), 1 - 0.25j * mp.sech(s / 8) ** 2
            kz = mp.sqrt(k0**2 - k**2)
            cos, sin = mp.cos(kz * d), mp.sin(kz * d)
            air, hard = (mp.matrix([[cos, m * sin / kz], [-kz * sin / m, cos]]) for m in (1, contrast))
            m = (hard * air) ** periods
            t = 2j * kz / (-m[1, 0] + 1j * kz * (m[0, 0] + m[1, 1]) + kz**2 * m[0, 1])
            weight = t * a * mp.sqrt(mp.pi) * mp.exp(-((a * k / 2) ** 2)) * slope * step / mp.pi
            for j, distance in enumerate(distances):
                for n, at in enumerate(x):  # even in x
                    p[j, n] += weight * mp.exp(1j * kz * (mp.mpf("0.1") + mp.mpf(distance))) * mp.cos(k * mp.mpf(at))
        return np.array(p.tolist(), complex)


@pytest.mark.parametrize(("near", "middle", "lands"), [(0.01, 8.78177057e-9, 6.25), (0.05, 1.98567289e-16, 7.5)])
def test_behind_a_quarter_wave_mirror_near_its_band_edge(near, middle, lands):
    """What its stop band lets through of normal incidence is 1e-8 to 1e-16; oblique waves pass, and land some metres off.

    Both planes are right to rtol of the |p| out there, with no warning; and in front of the beam four digits of the faint
    field itself are right.
    """
    f, x, behind = F * (1 - (1 - near) / 3), np.linspace(-1, 1, 5), [0.0, 0.1]
    truth = behind_periods_of_quarter_waves(f, 3, 100, [*x, lands], behind)
    truth, largest = truth[:, :-1], np.abs(truth[:, -1])
    assert abs(truth[0, 2]) == pytest.approx(middle, rel=1e-8)
    assert np.all(largest > 0.01)
    cell = [bp.Layer(bp.AIR, LAM / 4), bp.Layer(bp.Fluid(3 * RHO, 3 * BULK), LAM / 4)]
    z = [50 * LAM + d for d in behind]
    ds, warned = field_and_warning(bp.Slab(cell, 100), bp.GaussianBeam(0.5, z0=-0.1), f, x, z, rtol=1e-8)
    error = np.abs(ds.p.values - truth).max(axis=1)
    assert (error / largest).max() < 1e-8
    assert (error / np.abs(truth).max(axis=1)).max() < 1e-4
    assert float(ds.error_estimate) < 1e-8
    assert not warned
