"""Densities of zero, infinity and either sign, half-spaces without waves: limits, closed forms and 50 digits."""

import numpy as np
import pytest
from plane_waves import K0, OMEGA, F, r_t, witness

import beamprop as bp

K_AIR = 1.25 * 343.0**2
WATER = bp.Fluid.from_speed(1000.0, 1480.0)


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
