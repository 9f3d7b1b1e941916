"""Sources whose spectra end slowly or not at all, slits and coarse profiles: rtol is kept, refused or warned of."""

import warnings

import numpy as np
import pytest
from panels import panels

import beamprop as bp

F = 2500.0


def test_slits_launched_in_front_keep_rtol():
    """The spectrum of a sharp edge falls as 1/kx, but waves beyond k0 decay on the way: any rtol is reachable."""
    slits = bp.Slits(0.05, 0.1, 2, z0=-0.05)
    x, z = np.linspace(-0.5, 0.5, 51), np.array([0.0, 0.1, 0.5])
    slab = bp.Slab.uniform(bp.Fluid(2.0, 2e5), 0.05)
    rough, fine = (bp.field(slab, slits, F, x, z, rtol=rtol) for rtol in (1e-4, 1e-10))
    difference = np.abs(rough.p - fine.p).max("x") / np.abs(fine.p).max("x")
    assert difference.max() < 1e-4
    assert float(fine.error_estimate) < 1e-10


@pytest.mark.parametrize("periods", [1, 20])
def test_slits_on_the_face_of_a_slab_are_seen_behind_it(periods):
    """No air between them and the slab: the band is what the slab lets through."""
    slab, slits = bp.Slab(bp.lmmd_cell(0.05, 0.0), periods), bp.Slits(0.02, 0.05)
    x, z = np.linspace(-0.1, 0.1, 21), [slab.thickness, 0.2]
    rough, fine = (bp.field(slab, slits, F, x, z, rtol=rtol) for rtol in (1e-4, 1e-10))
    apart = np.abs(rough.p - fine.p).max("x") / np.abs(fine.p).max("x")
    assert apart.max() < 1e-4
    assert fine.error_estimate < 1e-10


def test_slits_on_their_own_plane_are_refused():
    """On the launch plane itself nothing decays: |S| falls as 1/kx, and rtol = 1e-3 would take millions of waves."""
    with pytest.raises(ValueError, match="plane waves"):
        bp.field(bp.Slab.uniform(bp.AIR, 0.1), bp.Slits(0.05, 0.1), F, np.linspace(-0.2, 0.2, 9), [0.0, 0.1], rtol=1e-3)


@pytest.mark.parametrize("spacing", [0.1, 0.33, 1.0])
@pytest.mark.parametrize("z0", [0.0, -0.1])
def test_profiles_too_coarse_for_themselves_say_so(spacing, z0):
    """White noise: its spectrum is cut off at pi/dx, which no smooth contour serves; warned of, with an honest estimate."""
    rng = np.random.default_rng(0)
    wavelength = 343 / F
    k0, dx = 2 * np.pi / wavelength, spacing * wavelength
    x = np.arange(40) * dx
    beam = bp.Profile(x - x.mean(), rng.normal(size=40) + 1j * rng.normal(size=40), z0)
    xs = np.linspace(beam.x[0], beam.x[-1], 37)
    p, estimate = warned_field(beam, xs)
    # the truth: real kx in panels, kx = k0 sin(a) below k0 and k0 cosh(u) beyond
    K = np.pi / dx
    u, w = panels(np.linspace(-1, 1, 151))
    top = np.arcsin(min(K / k0, 1))
    k, weight = k0 * np.sin(top * u), k0 * np.cos(top * u) * w * top
    if k0 < K:
        top = np.arccosh(K / k0)
        v = k0 * np.cosh(top * (u + 1) / 2)
        dv = k0 * np.sinh(top * (u + 1) / 2) * w * top / 2
        k, weight = np.concatenate([k, v, -v]), np.concatenate([weight, dv, dv])
    S = dx * np.exp(-1j * np.outer(k, beam.x)) @ beam.p
    want = np.exp(1j * np.outer(xs, k)) @ (S * np.exp(-1j * np.sqrt(k0**2 - k**2 + 0j) * z0) * weight) / (2 * np.pi)
    error = np.abs(p - want).max() / np.abs(want).max()
    assert error <= 3 * estimate
    assert error < 0.1


def warned_field(beam, xs):
    """p on z = 0 in air and its estimate; a warning is due where the estimate is above rtol, and only there."""
    slab = bp.Slab.uniform(bp.AIR, 0.1)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ds = bp.field(slab, beam, F, xs, 0.0, rtol=1e-6)
    assert bool(caught) == (float(ds.error_estimate) > 1e-6)
    return ds.p.values, float(ds.error_estimate)


@pytest.mark.parametrize("z0", [0.0, -0.02])
def test_slits_on_their_own_launch_plane_are_refused_with_the_reason(z0):
    """The spectrum of a sharp edge does not end there; a centimetre behind it, it does."""
    slab = bp.Slab(bp.lmmd_cell(), 20)
    with pytest.raises(ValueError, match="sharp edge"):
        bp.field(slab, bp.Slits(0.02, 0.05, z0=z0), F, 0.0, z0, rtol=1e-3)
    assert bp.field(slab, bp.Slits(0.02, 0.05, z0=-0.02), F, 0.0, -0.01).error_estimate < 1e-8
