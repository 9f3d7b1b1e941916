"""The spectrum of each source against the plain integral of its launched profile, at real and complex kx."""

import numpy as np
import pytest
from panels import panels

import beamprop as bp

F = 2500.0
K0 = 2 * np.pi * F / 343
LINES = [np.linspace(-60, 60, 13), np.linspace(-60, 60, 13) - 2j]


def integral(p, lo, hi, kx, count=4000):
    """integral p(x) exp(-i kx x) dx by Gauss-Legendre nodes."""
    x, weight = panels(np.linspace(lo, hi, count // 50 + 1), 50)
    return np.exp(-1j * np.outer(kx, x)) @ (p(x) * weight)


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize("angle", [0.0, 40.0])
def test_spectrum_of_a_gaussian(kx, angle):
    """S(kx) is the integral of the launched profile, off centre and tilted."""
    beam = bp.GaussianBeam(0.09, angle, x0=0.2)
    np.testing.assert_allclose(
        beam.spectrum(kx, K0), integral(lambda x: beam.profile(x, K0), -0.5, 0.9, kx), atol=1e-12
    )
    a = 0.09 / (2 * np.sqrt(np.log(2)))
    x = np.array([0.2, 0.25, 0.3])
    want = np.exp(-(((x - 0.2) / a) ** 2) + 1j * K0 * np.sin(np.deg2rad(angle)) * (x - 0.2))
    np.testing.assert_allclose(beam.profile(x, K0), want, rtol=1e-12)


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize(("count", "angle"), [(1, 0.0), (2, 0.0), (5, 30.0)])
def test_spectrum_of_slits(kx, count, angle):
    """The integral over every slit, exactly, tilted by the phase."""
    slits = bp.Slits(0.03, 0.08, count, angle=angle)
    tilt = K0 * np.sin(np.deg2rad(angle))
    want = sum(
        integral(lambda x: np.exp(1j * tilt * x), c - 0.015, c + 0.015, kx, 100)
        for c in (np.arange(count) - (count - 1) / 2) * 0.08
    )
    np.testing.assert_allclose(slits.spectrum(kx, K0), want, atol=1e-13)
    assert slits.spectrum(np.array([tilt]), K0)[0] == pytest.approx(count * 0.03)


@pytest.mark.parametrize("kx", LINES, ids=["real", "complex"])
@pytest.mark.parametrize("even", [True, False])
@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_spectrum_of_a_profile(kx, even, angle):
    """The integral of a smooth sampled profile, on even or uneven samples, tilted about its middle."""

    def p(x):
        return (1 + 3 * x) * np.exp(-((x / 0.1) ** 2) + 7j * x)

    x = np.linspace(-0.7, 0.8, 301)
    x = x if even else x + 0.001 * np.sin(9 * x)
    tilt = K0 * np.sin(np.deg2rad(angle))
    middle = (x[0] + x[-1]) / 2
    want = integral(lambda u: p(u) * np.exp(1j * tilt * (u - middle)), -0.7, 0.8, kx)
    got = bp.Profile(x, p(x), angle=angle).spectrum(kx, K0)
    np.testing.assert_allclose(got, want, atol=1e-12 if even else 1e-6)


def test_a_profile_is_interpolated_between_its_samples():
    """profile() returns the samples at the samples, and the smooth curve between."""
    x = np.linspace(-0.5, 0.5, 101)
    beam = bp.Profile(x, np.exp(-((x / 0.1) ** 2)))
    np.testing.assert_allclose(beam.profile(x, K0), beam.p, atol=1e-14)
    np.testing.assert_allclose(
        beam.profile(x[30:70] + 0.003, K0), np.exp(-(((x[30:70] + 0.003) / 0.1) ** 2)), atol=1e-9
    )


@pytest.mark.parametrize("angle", [0.0, 45.0, -60.0])
def test_a_rotated_beam_has_its_waist_across_its_axis(angle):
    """On the line through (x0, z0) across the axis |p| is the Gaussian of the stated width."""
    beam = bp.GaussianBeam(0.5, angle, x0=0.1, z0=-0.2, form="rotated")
    theta = np.deg2rad(angle)
    xi = -np.sign(angle) * np.array([0.0, 0.125, 0.25, 0.4])  # the side that lies behind the launch plane
    a = 0.5 / (2 * np.sqrt(np.log(2)))
    for s in xi if angle else np.array([0.0, 0.25, -0.4]):
        p = bp.field(bp.Slab.uniform(bp.AIR, 1.0), beam, F, 0.1 + s * np.cos(theta), -0.2 - s * np.sin(theta)).p
        assert abs(p.item()) == pytest.approx(np.exp(-((s / a) ** 2)), abs=1e-5)
