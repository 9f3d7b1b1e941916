"""The edges of plane waves: kz = 0, grazing and complex kx, very thin, very thick and opaque."""

import numpy as np
import pytest
from plane_waves import K0, OMEGA, F, inside, r_t, witness

import beamprop as bp
from beamprop.conventions import outgoing_kz

K_AIR = 1.25 * 343.0**2
FAST = bp.Fluid.from_speed(1.25, 500.0)
KZ_ZERO = OMEGA / 500  # kz = 0 in FAST
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
PAPER = bp.Slab(bp.lmmd_cell(), 450)
CLEAR = bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)

# --- kz = 0 and grazing -----------------------------------------------------------------------------------


@pytest.mark.parametrize("periods", [1, 7])
def test_kz_zero_inside_a_layer_is_no_special_case(periods):
    """Where kz vanishes the layer's matrix is [[1, rho d], [0, 1]]; neighbouring kx tend to it."""
    slab = bp.Slab([bp.Layer(FAST, 0.1 / periods)], periods)
    y = np.sqrt(complex(K0**2 - KZ_ZERO**2)) / 1.25
    t_exact = 2 / (2 - 1j * y * 1.25 * 0.1)
    r, t = r_t(slab, [KZ_ZERO, KZ_ZERO * (1 - 1e-9), KZ_ZERO * (1 + 1e-9)])
    np.testing.assert_allclose(t, t_exact, rtol=1e-7)
    np.testing.assert_allclose(t[0], t_exact, rtol=1e-12)
    np.testing.assert_allclose(r[0], 1 - t_exact, rtol=1e-12)


def test_the_field_is_linear_where_kz_is_zero():
    """p'' = 0 inside a layer at kz = 0: three equispaced values have no second difference."""
    p = inside(bp.Slab.uniform(FAST, 0.1), KZ_ZERO, [0.01, 0.05, 0.09])[:, 0]
    assert abs(p[0] - 2 * p[1] + p[2]) < 1e-12 * np.abs(p).max()
    assert abs(p[2] - p[0]) > 0.1 * np.abs(p).max()


def test_grazing_incidence_is_a_limit():
    """At kx = k0 exactly r = -1 and t = 0, with t going as kz."""
    for slab in (PAPER, CLEAR, bp.Slab.uniform(WATER, 0.01), bp.Slab(bp.lmmd_cell(), 20, after=WATER)):
        with pytest.warns(bp.AccuracyWarning, match="2 of 3 places"):  # kz has lost twelve digits
            r, t = r_t(slab, [K0, K0 * (1 - 1e-12), K0 * (1 - 4e-12)])
        assert r[0] == pytest.approx(-1, abs=1e-12)
        assert abs(t[0]) < 1e-12
        assert t[2] / t[1] == pytest.approx(2, rel=0.03)


def test_grazing_incidence_by_angle():
    """90 degrees is kx = k0 to the last bit, and the incident wave carries no power."""
    with pytest.warns(bp.AccuracyWarning, match=r"angle 89.999, and above 1e-06 at 1 of 3"):  # kz has lost ten digits
        ds = bp.scattering(PAPER, F, angle=[89.999, 90.0, -90.0])
    assert ds.kx.values[1] == pytest.approx(K0, rel=1e-15)
    np.testing.assert_allclose(ds.r.values[1:], -1, atol=1e-12)
    np.testing.assert_allclose(ds.transmissivity.values[1:], 0, atol=1e-12)
    assert np.isfinite(ds.energy_transmission.values).all()


@pytest.mark.parametrize("ratio", [0.0, 1.0, 10.0, 100.0, 1000.0])
@pytest.mark.parametrize("slab", [PAPER, CLEAR, bp.Slab.uniform(WATER, 0.05)], ids=["lossy", "lossless", "water"])
def test_kx_from_zero_to_a_thousand_k0(slab, ratio):
    """Finite everywhere; where 50 digits are cheap they agree."""
    r, t = r_t(slab, ratio * K0)
    assert np.isfinite(r)
    assert np.isfinite(t)
    if ratio not in (1.0, 1000.0):
        want_r, want_t = witness(slab, ratio * K0)
        assert complex(r) == pytest.approx(want_r, rel=1e-8)
        assert complex(t) == pytest.approx(want_t, rel=1e-8, abs=1e-250)


# --- complex kx -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slab", [PAPER, bp.Slab(bp.lmmd_cell(), 30, after=WATER)], ids=["air", "water"])
@pytest.mark.parametrize("ratio", [0.1, 0.24, 0.7, 0.99, 1.01, 1.6, 4.0])
@pytest.mark.parametrize("side", [1, -1])
def test_the_continued_response_tends_to_the_real_one(slab, ratio, side):
    """r and t on kx - i eps (kx + i eps on the left) tend to the real axis' values, linearly in eps."""
    kx = side * ratio * K0
    real = r_t(slab, kx)
    for part in (0, 1):
        steps = [abs(r_t(slab, kx - 1j * side * eps)[part] - real[part]) for eps in (1e-3, 1e-5, 1e-7)]
        assert steps[2] < 1e-4 * max(abs(real[part]), 1e-3)
        assert steps[1] < 0.03 * steps[0] + 1e-13


def test_the_continued_response_has_no_jump_at_k0():
    """On a line below the right half of the axis t is smooth past k0; on the axis itself it has a root there."""
    s = np.linspace(0.8, 1.2, 401) * K0
    below, axis = (r_t(PAPER, s - 1j * sigma)[1] for sigma in (0.05 * K0, 0.0))
    for values, most in ((below, 0.2), (axis, np.inf)):
        first = np.abs(np.diff(values)).max() / np.ptp(np.abs(values))
        second = np.abs(np.diff(values, 2)).max() / np.abs(np.diff(values)).max()
        assert first < 0.2
        assert second < most
    assert np.abs(np.diff(axis, 2)).max() > 3 * np.abs(np.diff(below, 2)).max()


def test_half_space_wavenumbers_are_continued_as_loss_would():
    """Below the right half of the axis kz has no cut, and is minus the value that a cut along the axis would give."""
    kx = np.linspace(0.2, 3, 300) * K0 - 0.3j
    kz = outgoing_kz(kx, OMEGA, 1.25, 1.25, K_AIR)
    np.testing.assert_allclose(kz**2, K0**2 - kx**2, rtol=1e-12)
    assert np.abs(np.diff(kz)).max() < 0.2 * K0
    lossy = outgoing_kz(kx.real, OMEGA, 1.25, 1.25, K_AIR * (1 - 1e-7j))
    flat = outgoing_kz(kx.real - 1e-7j, OMEGA, 1.25, 1.25, K_AIR)
    assert np.abs(lossy - flat).max() < 1e-4 * K0
    np.testing.assert_allclose(outgoing_kz(-kx, OMEGA, 1.25, 1.25, K_AIR), kz, rtol=1e-14)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("ratio", [0.3, 0.99, 1.01, 3.0])
def test_the_cuts_leave_the_axis_upward_at_k0_and_downward_at_minus_k0(side, ratio):
    """From above and below kz tends to the real axis' value; beside the cut above +k0 (below -k0) its sign turns."""
    kx = side * ratio * K0
    real = outgoing_kz(kx, OMEGA, 1.25, 1.25, K_AIR)
    for eps in (1e-9, -1e-9):
        assert outgoing_kz(kx + 1j * eps * K0, OMEGA, 1.25, 1.25, K_AIR) == pytest.approx(complex(real), rel=1e-6)
    right, left = outgoing_kz(side * (K0 * np.array([1 - 1e-9, 1 + 1e-9]) + 5j), OMEGA, 1.25, 1.25, K_AIR)
    assert right == pytest.approx(-left, rel=1e-6)


@pytest.mark.parametrize(
    ("rho", "K", "want"),
    [(1.25, K_AIR, 1), (-1.25, -K_AIR, -1), (1.25, -K_AIR, 1j), (-1.25, K_AIR, 1j)],
    ids=["air", "backward", "K<0", "rho<0"],
)
def test_outgoing_waves_carry_energy_away_or_decay(rho, K, want):
    """At normal incidence kz/k0 is 1 in air, -1 where density and modulus are negative, i where one of them is."""
    kz = complex(outgoing_kz(0.0, OMEGA, rho, rho, K))
    assert kz == pytest.approx(want * K0, rel=1e-13)
    assert (kz / rho).real >= -1e-12 * K0


# --- thin, thick, opaque ----------------------------------------------------------------------------------


@pytest.mark.parametrize("thickness", [1e-300, 1e-15, 1e-9])
@pytest.mark.parametrize("ratio", [0.0, 0.9, 3.0])
def test_a_very_thin_layer_does_next_to_nothing(thickness, ratio):
    """To first order in d: t - 1 = i d/2 (rho y + B/y), with y = kz/rho in front."""
    fluid = bp.Fluid(2 + 0.1j, 2e5)
    r, t = r_t(bp.Slab.uniform(fluid, thickness), ratio * K0)
    y = outgoing_kz(ratio * K0, OMEGA, 1.25, 1.25, K_AIR) / 1.25
    B = OMEGA**2 / 2e5 - (ratio * K0) ** 2 / (2 + 0.1j)
    first = 0.5j * thickness * ((2 + 0.1j) * y + B / y)
    assert t - 1 == pytest.approx(first, rel=1e-5, abs=1e-15)
    assert r == pytest.approx(0.5j * thickness * (B / y - (2 + 0.1j) * y), rel=1e-5, abs=1e-15)


@pytest.mark.parametrize("thickness", [1e2, 1e6, 1e12])
@pytest.mark.parametrize("ratio", [0.0, 0.5, 3.0, 1000.0])
def test_a_very_thick_lossy_layer_is_a_half_space(thickness, ratio):
    """t = 0 and r is that of the face alone, (y1 - y2)/(y1 + y2)."""
    fluid = bp.Fluid(2 + 0.1j, 2e5)
    r, t = r_t(bp.Slab.uniform(fluid, thickness), ratio * K0)
    y1 = outgoing_kz(ratio * K0, OMEGA, 1.25, 1.25, K_AIR) / 1.25
    y2 = outgoing_kz(ratio * K0, OMEGA, 2 + 0.1j, 2 + 0.1j, 2e5) / (2 + 0.1j)
    assert abs(t) < 1e-30
    assert r == pytest.approx((y1 - y2) / (y1 + y2), rel=1e-12)


@pytest.mark.parametrize("periods", [5_000, 100_000, 10**9])
@pytest.mark.parametrize("ratio", [0.3, 5.0, 30.0])
def test_an_opaque_slab_transmits_zero_and_not_nan(periods, ratio):
    """|t| < 1e-300 is 0; r is that of the half-infinite stack, whatever the number of periods."""
    cell = bp.lmmd_cell(0.05 + 0.5j, 0.25)
    r, t = r_t(bp.Slab(cell, periods), ratio * K0)
    more = r_t(bp.Slab(cell, 2 * periods), ratio * K0)[0]
    assert abs(t) < 1e-70
    if periods > 5000:
        assert t == 0
    assert r == pytest.approx(complex(more), rel=1e-10)


def test_transmission_falls_through_the_underflow_without_a_break():
    """log|t| goes down steadily by the Bloch decay until t is 0 for good."""
    cell = bp.lmmd_cell(0.05 + 0.5j, 0.25)
    periods = np.array([3000, 4000, 5000, 6000, 20_000, 50_000])
    t = np.array([abs(complex(r_t(bp.Slab(cell, int(n)), 0.3 * K0)[1])) for n in periods])
    decay = bp.bloch(cell, F, kx=0.3 * K0).kz.item().imag * cell.thickness
    alive = t > 1e-300
    assert 2 <= alive.sum() < periods.size
    np.testing.assert_allclose(np.diff(np.log(t[alive])), -decay * np.diff(periods[alive]), rtol=1e-9)
    assert np.all(t[-1:] == 0)
    assert np.all(np.diff(t) <= 0)


@pytest.mark.parametrize(
    "slab",
    [
        bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 50_000),
        bp.Slab.uniform(WATER, 40.0),
        bp.Slab(bp.lmmd_cell(), 2000) + bp.Slab.uniform(WATER, 40.0),
    ],
    ids=["periods", "layer", "stack"],
)
def test_the_field_inside_an_opaque_slab_is_finite(slab):
    """From the incident size at the near face down to 0 at the far one, never nan, continuous with r and t."""
    z = np.concatenate([[0.0, 1e-6], np.geomspace(1e-4, slab.thickness, 60)])
    for kx in (0.3 * K0, 2.0 * K0, 20 * K0):
        p = inside(slab, kx, z)[:, 0]
        r, t = r_t(slab, kx)
        assert np.all(np.isfinite(p))
        assert p[0] == pytest.approx(1 + complex(r), rel=1e-9)
        assert p[-1] == pytest.approx(complex(t), rel=1e-10, abs=1e-300)
        assert np.abs(p).max() < 10 * abs(p[0]) + 10


def test_a_beam_on_an_opaque_slab():
    """The field is finite before, inside and behind, and dark behind."""
    slab = bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 50_000)
    z = [-0.1, 0.0, 0.1, slab.thickness / 2, slab.thickness, slab.thickness + 1]
    p = bp.field(slab, bp.GaussianBeam(0.096, z0=-0.1), F, np.linspace(-0.3, 0.3, 9), z).p.values
    assert np.all(np.isfinite(p))
    assert np.abs(p[:2]).max() > 0.5
    assert np.all(p[3:] == 0)


@pytest.mark.parametrize("kx", [0.2 * K0, 1.3 * K0])
@pytest.mark.parametrize("scale", [0.5, 40.0, 2000.0])
def test_the_field_in_one_layer_is_two_plane_waves(kx, scale):
    """Inside a uniform slab p = t (cos(kz (L - z)) - i (y2/y) sin(kz (L - z))), thin or opaque."""
    rho, K = 2 + 0.05j, 2e5
    L = scale / K0
    z = np.array([0.0, 0.1, 0.5, 0.93, 1.0]) * L
    slab = bp.Slab.uniform(bp.Fluid(rho, K), L)
    y2 = complex(outgoing_kz(kx, OMEGA, 1.25, 1.25, K_AIR)) / 1.25
    kz = complex(outgoing_kz(kx, OMEGA, rho, rho, K))
    y = kz / rho
    # p = A (e^{ikz z} + s e^{ikz (2L - z)}), from the near face on, with nothing that grows
    s = (y - y2) / (y + y2)
    shape = np.exp(1j * kz * z) + s * np.exp(1j * kz * (2 * L - z))
    loop = s * np.exp(2j * kz * L)
    A = 2 * y2 / (y2 * (1 + loop) + y * (1 - loop))
    np.testing.assert_allclose(inside(slab, kx, z)[:, 0], A * shape, rtol=1e-9)
