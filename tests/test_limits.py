"""The edges: kz = 0, grazing and complex kx, very thin and very thick, opaque, density zero, band edges."""

import numpy as np
import pytest
from oracles import slab_response

import beamprop as bp
from beamprop import response
from beamprop.conventions import outgoing_kz
from beamprop.media.values import slab_values
from beamprop.response import layer as layer_kernels

F = 2500.0
OMEGA = 2 * np.pi * F
K0 = OMEGA / 343
K_AIR = 1.25 * 343.0**2
FAST = bp.Fluid.from_speed(1.25, 500.0)
KZ_ZERO = OMEGA / 500  # kz = 0 in FAST
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
PAPER = bp.Slab(bp.lmmd_cell(), 450)
CLEAR = bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)


def r_t(slab, kx):
    ds = bp.scattering(slab, F, kx=kx)
    return ds.r.values, ds.t.values


def inside(slab, kx, z):
    """p at depths z per unit incident pressure, (Z, n)."""
    f, kx = np.array([F]), np.atleast_1d(np.asarray(kx, complex))
    return response.solve(
        slab_values(slab, f),
        slab.before.at(f),
        slab.after.at(f),
        np.array([[OMEGA]]),
        kx[None],
        np.asarray(z, float),
    ).inside[0]


def cells(slab):
    return [(layer.fluid.density, layer.fluid.bulk_modulus, layer.thickness) for layer in slab.cell.layers]


def witness(slab, kx):
    """r and t with 50 digits."""
    ends = [(v.density, v.bulk_modulus) for v in (slab.before, slab.after)]
    return [complex(v) for v in slab_response(cells(slab), slab.periods, *ends, F, kx)]


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


# --- extreme materials ------------------------------------------------------------------------------------


def test_isotropic_density_zero_blocks_all_but_normal_incidence():
    """r = -1, t = 0 off the normal; at kx = 0 the finite limit of a tiny density."""
    none, tiny = (bp.Slab([bp.Layer(bp.AIR, 0.01), bp.Layer(bp.Fluid(rho, 1.4e5), 0.01)], 3) for rho in (0.0, 1e-9))
    r, t = r_t(none, np.array([0.1, 0.9, 1.0, 2.0]) * K0)
    assert np.all(t == 0)
    assert r[2] == pytest.approx(-1, abs=1e-12)
    near = r_t(tiny, np.array([0.1, 0.9, 1.0, 2.0]) * K0)[0]
    np.testing.assert_allclose(r, near, rtol=1e-5)
    for a, b in zip(r_t(none, 0.0), r_t(tiny, 0.0), strict=True):
        assert a == pytest.approx(complex(b), rel=1e-7)
    assert abs(r_t(none, 0.0)[1]) > 0.1
    alone = r_t(bp.Slab.uniform(bp.Fluid(0, 1.4e5), 0.01), [0.5 * K0, 3 * K0])
    np.testing.assert_allclose(alone[0], -1, atol=1e-12)


ZERO = bp.Slab([bp.Layer(bp.AIR, 0.02), bp.Layer(bp.Fluid(0, 1.4e5), 0.01), bp.Layer(bp.AIR, 0.02)])


def beam_on_zero(z):
    return np.abs(bp.field(ZERO, bp.GaussianBeam(0.2, 30.0, z0=-0.1), F, np.linspace(-0.3, 0.3, 9), z).p)


def test_a_beam_meets_density_zero():
    """A layer of density 0 reflects a tilted beam whole: p vanishes at its face, and it is dark behind the slab."""
    p = beam_on_zero([-0.1, 0.01, 0.02 - 1e-9, 0.2]).max("x")
    assert np.all(p[:2] > 0.5)
    assert p[2] < 1e-6
    assert p[3] == 0


def test_the_dark_side_of_density_zero():
    """Inside such a layer, and between it and the far face, p = 0 is the answer and no reason to warn."""
    assert np.all(beam_on_zero([0.02, 0.025, 0.03, 0.04]) == 0)


def test_density_zero_along_z_alone_transmits():
    """rho_z = 0 beside a finite rho_x: the matrix is [[1, 0], [-B, 1]]."""
    kx, d = 0.6 * K0, 0.01
    r, t = r_t(bp.Slab.uniform(bp.Fluid(0, 1.4e5, density_x=1.25), d), kx)
    B = (OMEGA**2 / 1.4e5 - kx**2 / 1.25) * d
    y = 1j * np.sqrt(K0**2 - kx**2) / 1.25
    want = 2 * y / (2 * y + B)
    assert complex(t) == pytest.approx(want, rel=1e-12)
    assert complex(r) == pytest.approx(want - 1, rel=1e-12)


def test_infinite_density_along_x_is_the_limit_of_a_large_one():
    """No motion along x: kz does not depend on kx, and a density_x of 1e12 says the same."""
    inf, large = (bp.Slab.uniform(bp.Fluid(0.5 + 0.02j, 1.4e5, rho_x), 0.1) for rho_x in (np.inf, 1e12))
    kx = np.array([0.0, 0.5, 0.99, 1.5, 8.0]) * K0
    for a, b in zip(r_t(inf, kx), r_t(large, kx), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-8)


def test_a_half_space_may_have_infinite_density_along_x():
    """Behind: every wave propagates there. In front: kx_over_k0 has no meaning and is refused by name."""
    rigid = bp.Fluid(1.0, 1e5, density_x=np.inf)
    slab = bp.Slab(bp.lmmd_cell(), 10, after=rigid)
    kx = 0.4 * K0
    ds = bp.scattering(slab, F, kx=kx)
    y1, y2 = np.sqrt(K0**2 - kx**2) / 1.25, OMEGA * np.sqrt(1 / 1e5)
    assert ds.energy_transmission.item() == pytest.approx(abs(ds.t.item()) ** 2 * y2 / y1, rel=1e-12)
    with pytest.raises(ValueError, match="before"):
        bp.scattering(bp.Slab(bp.lmmd_cell(), 10, before=rigid), F, kx_over_k0=0.4)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.9, 2.0])
def test_no_loss_is_the_limit_of_little_loss(ratio):
    """Loss 1e-9 changes r and t by about as much, away from guided modes."""
    clear, hazy = (bp.Slab(bp.lmmd_cell(0.05 + loss, 0.0), 60) for loss in (0, 1e-9j))
    for a, b in zip(r_t(clear, ratio * K0), r_t(hazy, ratio * K0), strict=True):
        assert 0 < abs(a - b) < 1e-6


@pytest.mark.parametrize(("rho", "K"), [(-1.5, 1.4e5), (1.5, -1.4e5), (-1.5 + 0.1j, 1.4e5), (-1.5, -1.4e5)])
@pytest.mark.parametrize("ratio", [0.0, 0.8, 2.1])
@pytest.mark.parametrize("periods", [1, 9])
def test_negative_density_and_modulus(rho, K, ratio, periods):
    """Against 50 digits: evanescent layers, and backward waves where both are negative."""
    slab = bp.Slab([bp.Layer(bp.Fluid(rho, K), 0.01), bp.Layer(bp.AIR, 0.004)], periods)
    r, t = r_t(slab, ratio * K0)
    want_r, want_t = witness(slab, ratio * K0)
    assert complex(r) == pytest.approx(want_r, rel=1e-10)
    assert complex(t) == pytest.approx(want_t, rel=1e-10)


@pytest.mark.parametrize(
    "after",
    [WATER, bp.Fluid(1.9 + 0.2j, 9e4 - 2e3j), bp.Fluid(1.25, -K_AIR), bp.Fluid(-3.0, 1e5)],
    ids=["water", "lossy", "K<0", "rho<0"],
)
@pytest.mark.parametrize("ratio", [0.0, 0.3, 0.9, 2.0])
def test_half_spaces_behind(after, ratio):
    """Water, a lossy fluid, and fluids in which nothing propagates, against 50 digits."""
    slab = bp.Slab(bp.lmmd_cell(), 20, after=after)
    r, t = r_t(slab, ratio * K0)
    want_r, want_t = witness(slab, ratio * K0)
    assert complex(r) == pytest.approx(want_r, rel=1e-10)
    assert complex(t) == pytest.approx(want_t, rel=1e-10)


@pytest.mark.parametrize("ratio", [0.0, 0.5, 0.9])
def test_nothing_is_transmitted_into_a_medium_without_waves(ratio):
    """|r| = 1 where the lossless half-space behind carries no waves."""
    slab = bp.Slab(bp.lmmd_cell(0.05, 0.0), 20, after=bp.Fluid(1.25, -K_AIR))
    ds = bp.scattering(slab, F, kx_over_k0=ratio)
    assert ds.reflectivity.item() == pytest.approx(1, abs=1e-10)
    assert ds.energy_transmission.item() == pytest.approx(0, abs=1e-14)


# --- Bloch waves ------------------------------------------------------------------------------------------


def product(cell, kx, f=F):
    """The cell's matrix as a plain numpy product."""
    m, w = np.eye(2, dtype=complex), 2 * np.pi * f
    for layer in cell.layers:
        rho, K, d = layer.fluid.density, layer.fluid.bulk_modulus, layer.thickness
        kz = np.sqrt(rho * (w**2 / K - kx**2 / rho) + 0j)
        m = np.array([[np.cos(kz * d), rho * np.sin(kz * d) / kz], [-kz * np.sin(kz * d) / rho, np.cos(kz * d)]]) @ m
    return m


TWO = bp.Cell([bp.Layer(bp.AIR, 0.03), bp.Layer(bp.Fluid.from_speed(5.0, 343.0), 0.03)])


@pytest.mark.parametrize(
    "cell",
    [bp.lmmd_cell(), bp.lmmd_cell(0.05, 0.0, 8), bp.lmmd_cell(0.05, 0, 14, 1 / 20), TWO],
    ids=["paper", "N=8", "N=14", "two"],
)
@pytest.mark.parametrize("ratio", [0.0, 0.7, 1.0 + 1e-7, 3.0, 9.5])
def test_bloch_waves_are_eigenvalues_of_the_cell_matrix(cell, ratio):
    """exp(i kz P) is an eigenvalue of the product matrix, the one that does not grow."""
    kz = bp.bloch(cell, F, kx=ratio * K0).kz.item()
    values = np.linalg.eigvals(product(cell, ratio * K0))
    eigenvalue = np.exp(1j * kz * cell.thickness)
    assert np.min(np.abs(values - eigenvalue)) < 1e-9 * np.abs(values).max()
    assert abs(eigenvalue) <= 1 + 1e-12


def test_bloch_wavenumber_of_the_lossless_medium_at_normal_incidence():
    """0.7308 k0, the root of the effective density 0.05 + S at leading order."""
    assert bp.bloch(bp.lmmd_cell(0.05, 0.0), F, kx=0.0).kz_over_k0.item() == pytest.approx(0.7308, abs=5e-5)


@pytest.mark.parametrize(("eta", "leaves"), [(1 / 20, True), (1 / 100, False)])
def test_contours_are_flat_as_far_as_the_period_is_short(eta, leaves):
    """Beyond 5 k0 the contour of eta = 1/20 departs from its flat value by over 5 %, that of 1/100 stays within 1 %."""
    ratio = np.linspace(0, 10, 201)
    kz = bp.bloch(bp.lmmd_cell(0.05, 0.0, eta=eta), F, kx_over_k0=ratio).kz_over_k0.values.real
    departure = np.abs(kz / kz[0] - 1)
    if leaves:
        assert np.all(departure[ratio > 5] > 0.05)
        assert departure[-1] > 0.2
    else:
        assert np.all(departure < 0.01)


@pytest.mark.parametrize("n_layers", [4, 8, 12])
def test_a_layer_where_the_cosine_is_zero_ends_non_diffraction(n_layers):
    """N a multiple of 4 has a layer of density rho_m, and its contour is no longer flat; N = 6, 10, 14 are."""
    ratio = [0.0, 1.0]
    bent, flat = (
        bp.bloch(bp.lmmd_cell(n_layers=n), F, kx_over_k0=ratio).kz_over_k0.values for n in (n_layers, n_layers + 2)
    )
    assert abs(bent[1] - bent[0]) > 1
    assert abs(flat[1] - flat[0]) < 2e-3


def test_bloch_wavenumber_of_eight_layers():
    """The numbers for N = 8 at kx = k0: |Re kz/k0| = 1.61 and Im kz/k0 = 2.40."""
    kz = bp.bloch(bp.lmmd_cell(n_layers=8), F, kx_over_k0=1.0).kz_over_k0.item()
    assert abs(kz.real) == pytest.approx(1.605, abs=0.01)
    assert kz.imag == pytest.approx(2.403, abs=0.01)


@pytest.mark.parametrize(
    "cell",
    [
        bp.lmmd_cell(),
        bp.lmmd_cell(0.05, 0.0, eta=1 / 20),
        bp.lmmd_cell(n_layers=8),
        bp.Cell([bp.Layer(bp.Fluid(1.25, K_AIR * (1 - 0.02j)), 0.15), bp.Layer(bp.Fluid.from_speed(5.0, 343.0), 0.15)]),
    ],
    ids=["paper", "coarse", "N=8", "many zones"],
)
def test_the_branch_is_continuous(cell):
    """On grids ten times finer the largest step of kz falls about ten times: nothing jumps."""
    coarse, fine = (
        np.abs(np.diff(bp.bloch(cell, F, kx_over_k0=np.linspace(-3, 3, n)).kz.values)).max() for n in (2001, 20001)
    )
    assert fine < 0.35 * coarse
    assert fine * cell.thickness < 0.1


def test_the_contour_is_even_and_does_not_depend_on_the_grid():
    """kz(-kx) = kz(kx); a single kx gives the same value as a grid, up to whole turns."""
    ratio = np.linspace(-4, 4, 161)
    kz = bp.bloch(bp.lmmd_cell(), F, kx_over_k0=ratio).kz.values
    np.testing.assert_allclose(kz, kz[::-1], rtol=1e-12)
    np.testing.assert_allclose(
        [bp.bloch(bp.lmmd_cell(), F, kx_over_k0=q).kz.item() for q in ratio[::40]], kz[::40], rtol=1e-12
    )
    assert np.all(kz.imag >= 0)


@pytest.mark.parametrize(
    ("cell", "frequency", "ratio"),
    [(TWO, 800.0, 0.0), (TWO, 5500.0, 0.0), (TWO, 7000.0, 0.0), (bp.lmmd_cell(0.05, 0.0, 4), F, 1.0)],
    ids=["first band", "second band", "third band", "N=4"],
)
def test_without_loss_the_sign_of_kz_is_that_of_a_little_loss(cell, frequency, ratio):
    """The wave that carries energy along +z is the one that decays there when a little loss is added: backward bands too."""
    hazy = bp.Cell(
        [bp.Layer(bp.Fluid(v.fluid.density, v.fluid.bulk_modulus * (1 - 1e-7j)), v.thickness) for v in cell.layers]
    )
    kx = ratio * 2 * np.pi * frequency / 343
    clear, damped = (bp.bloch(c, frequency, kx=kx).kz.item() * cell.thickness for c in (cell, hazy))
    assert clear.imag == 0
    assert 0 < damped.imag < 1e-3
    assert np.exp(1j * clear) == pytest.approx(np.exp(1j * damped.real), abs=1e-4)
    assert abs(np.sin(clear)) > 0.1  # the two signs differ


def edge(lo, hi):
    """A band edge of TWO by bisection: where trace/2 of the product matrix passes -1."""
    for _ in range(100):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if np.trace(product(TWO, 0.0, middle)).real / 2 > -1 else (lo, middle)
    return lo, hi


def test_band_edges():
    """At the edge of a stop band the powers are degenerate; r and t pass it smoothly and agree with 50 digits."""
    for f in (*edge(1000.0, 2600.0), edge(1000.0, 2600.0)[0] * (1 + 1e-10)):
        slab = bp.Slab(TWO, 12)
        ds = bp.scattering(slab, f, kx=0.0)
        ends = [(bp.AIR.density, bp.AIR.bulk_modulus)] * 2
        r, t = slab_response(cells(slab), 12, *ends, f, 0.0)
        assert ds.t.item() == pytest.approx(complex(t), rel=1e-7)
        assert ds.r.item() == pytest.approx(complex(r), rel=1e-7)


def test_a_stop_band_decays_with_kz_on_the_zone_edge():
    """Inside the stop band |Re kz| P = pi and |t| falls by Im kz; in the pass bands of the lossless cell Im kz = 0."""
    low = edge(1000.0, 2600.0)[0]
    kz = bp.bloch(TWO, [low - 100, low + 200], kx=0.0).kz.values * TWO.thickness
    assert kz[0].imag == 0
    assert abs(kz[1].real) == pytest.approx(np.pi, abs=1e-9)
    assert kz[1].imag > 0.1
    t = [abs(bp.scattering(bp.Slab(TWO, n), low + 200, kx=0.0).t.item()) for n in (20, 30)]
    assert np.log(t[0] / t[1]) == pytest.approx(10 * kz[1].imag, rel=1e-6)


def test_a_single_kx_is_answered_in_the_first_zone():
    """|Re kz| P <= pi at the kx nearest to 0, and the sign is that of the wave that carries energy along +z."""
    low = edge(1000.0, 2600.0)[0]
    kz = bp.bloch(TWO, [0.3 * low, 0.7 * low, 0.95 * low], kx=0.0).kz.values * TWO.thickness
    assert np.all(np.abs(kz.real) <= np.pi)
    assert np.all(np.diff(kz.real) > 0)


# --- cost -------------------------------------------------------------------------------------------------


def layer_work(monkeypatch, ask):
    """How many numbers the layers' functions are evaluated at while `ask` runs."""
    work = []
    original = layer_kernels.entire

    def counted(u):
        work.append(np.size(u))
        return original(u)

    with monkeypatch.context() as patch:
        patch.setattr(layer_kernels, "entire", counted)
        ask()
    return sum(work)


@pytest.mark.parametrize("depths", [None, [0.001, 0.002, 0.0035]])
def test_the_work_does_not_grow_with_the_periods(monkeypatch, depths):
    """The layers of one cell are evaluated once, for 2 periods as for a million; once more for the estimate."""
    kx = np.linspace(0, 3, 50) * K0

    def ask(periods, estimate=False):
        slab = bp.Slab(bp.lmmd_cell(0.05 + 0.05j, 0.025, 10, 1 / 60), periods)
        return lambda: inside(slab, kx, depths) if depths else bp.scattering(slab, F, kx=kx, estimate=estimate)

    few, many = (layer_work(monkeypatch, ask(n)) for n in (2, 1_000_000))
    assert few == many > 0
    if depths is None:
        assert many == 10 * kx.size
        assert layer_work(monkeypatch, ask(450, estimate=True)) == 2 * many


def test_one_response_serves_every_angle(monkeypatch):
    """An angle sweep at one frequency evaluates the layers hardly more often than one angle."""

    def ask(angle):
        return lambda: bp.field(PAPER, bp.GaussianBeam(0.096, z0=-0.1), F, np.linspace(-1, 1, 64), [0.5, 1.0], angle)

    one, nine = layer_work(monkeypatch, ask(80.0)), layer_work(monkeypatch, ask(np.linspace(-80, 80, 9)))
    assert nine < 2 * one
