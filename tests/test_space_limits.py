"""Limits and symmetries of fields in three dimensions: wide ellipses, vanishing loss, rotation, the paraxial law."""

import numpy as np
import pytest

import beamprop as bp

FREQUENCY = 2500.0
LOSSY = bp.Slab(bp.lmmd_cell(), 450)


def largest(a, b):
    """The largest difference over the largest |b| of each plane."""
    flat = np.abs(np.asarray(a) - np.asarray(b)).reshape(len(a), -1)
    return float(np.max(flat.max(axis=1) / np.abs(b).reshape(len(b), -1).max(axis=1)))


def test_ever_wider_ellipses_tend_to_the_beam_on_which_nothing_depends_on_y():
    """The difference falls with 1/ay^2: a quarter for each doubling."""
    x, z = np.linspace(-0.5, 0.5, 41), np.array([0.3, LOSSY.thickness])
    flat = bp.field(LOSSY, bp.GaussianBeam(0.096, 20, z0=-0.1), FREQUENCY, x, z, rtol=1e-10).p.values
    apart = []
    for wy in (0.8, 1.6, 3.2):
        beam = bp.GaussianBeam((0.096, wy), 20, z0=-0.1)
        apart.append(largest(bp.field(LOSSY, beam, FREQUENCY, x, z, y=0.0, rtol=1e-9).p.values, flat))
    ratios = np.array(apart[:-1]) / apart[1:]
    print(apart, ratios)
    assert ratios[0] == pytest.approx(4, abs=0.01)
    assert ratios[1] == pytest.approx(4, abs=0.002)


def test_fields_tend_to_the_lossless_one_in_proportion_to_the_loss():
    """Losses a tenth each: differences a tenth each. Without loss modes lie on the axis, and open space is this limit."""
    x, y, z = np.linspace(-0.6, 0.6, 9), np.linspace(-0.5, 0.5, 7), np.array([0.3, 1.0])
    beam = bp.GaussianBeam(0.096, 30, z0=-0.1, azimuth=20.0)

    def p(loss):
        slab = bp.Slab(bp.lmmd_cell(0.05 + 1j * loss, 0), 450)
        return bp.field(slab, beam, FREQUENCY, x, z, y=y, rtol=1e-10).p.values

    lossless = p(0.0)
    apart = [largest(p(loss), lossless) for loss in (1e-4, 1e-5, 1e-6)]
    assert apart[0] / apart[1] == pytest.approx(10, abs=0.05)
    assert apart[1] / apart[2] == pytest.approx(10, abs=0.005)


@pytest.mark.parametrize("azimuth", [90.0, 180.0, 270.0, -90.0])
def test_turned_by_quarters_a_field_is_the_same(azimuth):
    """A beam with its widths swapped, on axes swapped or reversed: the same numbers are summed in another order."""
    x, y, z = np.linspace(-0.6, 0.5, 9), np.linspace(-0.3, 0.7, 9), np.array([0.3, 1.0])
    p = bp.field(LOSSY, bp.GaussianBeam((0.2, 0.1), 30, z0=-0.1), FREQUENCY, x, z, y=y, rtol=1e-11).p.values
    quarters = round(azimuth / 90) % 4
    widths = (0.1, 0.2) if quarters % 2 else (0.2, 0.1)
    turned = {1: (-y, x), 2: (-x, -y), 3: (y, -x)}[quarters]  # where the positions have been turned to
    beam = bp.GaussianBeam(widths, 30, z0=-0.1, azimuth=azimuth)
    q = bp.field(LOSSY, beam, FREQUENCY, turned[0], z, y=turned[1], rtol=1e-11).p.values
    assert largest(np.swapaxes(q, 1, 2) if quarters % 2 else q, p) < 1e-14


def test_a_circular_beam_is_the_same_at_every_azimuth():
    """At positions turned with it, on a line through its middle: lattices, tables and L differ. Rounding alone, which exp(depth L) magnifies."""
    r, z = np.linspace(-0.6, 0.6, 9), np.array([0.3, 1.0])
    p = bp.field(LOSSY, bp.GaussianBeam(0.096, 30, z0=-0.1), FREQUENCY, r, z, y=0.0, rtol=1e-12).p.values
    turn = np.radians(37.0)
    x, y = r * np.cos(turn), r * np.sin(turn)
    beam = bp.GaussianBeam(0.096, 30, z0=-0.1, azimuth=37.0)
    q = bp.field(LOSSY, beam, FREQUENCY, x, z, y=y, rtol=1e-12).p.values
    assert largest(np.diagonal(q, axis1=1, axis2=2), p) < 1e-13


def test_where_it_is_does_not_matter():
    x, y, z = np.linspace(-0.5, 0.5, 7), np.linspace(-0.4, 0.4, 5), [0.2, 1.0]
    p = bp.field(LOSSY, bp.GaussianBeam(0.096, 30, z0=-0.1, azimuth=20.0), FREQUENCY, x, z, y=y).p.values
    moved = bp.GaussianBeam(0.096, 30, 100.0, -0.1, azimuth=20.0, y0=-3000.0)
    q = bp.field(LOSSY, moved, FREQUENCY, x + 100.0, z, y=y - 3000.0).p.values
    assert largest(q, p) < 1e-9


def test_wide_beams_keep_the_paraxial_law():
    """On the axis at one Rayleigh distance |p| is 1/sqrt(2) of the launched, but for O(1/(k a)^2) (Siegman, Lasers, 1986, section 16.3)."""
    k0 = 2 * np.pi * FREQUENCY / 343.0
    apart = []
    for ka in (11.0, 44.0):
        a = ka / k0
        beam = bp.GaussianBeam(2 * a * np.sqrt(np.log(2)))
        air = bp.Slab.uniform(bp.AIR, 0.01)
        p = bp.field(air, beam, FREQUENCY, 0.0, k0 * a**2 / 2, y=0.0, rtol=1e-9).p.values
        q = np.exp(1j * k0 * k0 * a**2 / 2) / (1 + 1j)
        apart.append(abs(p - q) / abs(q) * ka**2)
    assert apart == pytest.approx([1.0, 1.0], abs=0.02)


def test_the_launched_pressure_is_the_beams_own():
    """In a homogeneous fluid, on the launch plane itself."""
    x, y = np.linspace(-0.2, 0.2, 9), np.linspace(-0.1, 0.1, 5)
    beam = bp.GaussianBeam((0.2, 0.1), 40, 0.02, -0.1, azimuth=30.0, y0=0.01)
    p = bp.field(bp.Slab.uniform(bp.AIR, 0.1), beam, FREQUENCY, x, -0.1, y=y, rtol=1e-10).p.values
    u, v = np.meshgrid(x - 0.02, y - 0.01)
    kt = 2 * np.pi * FREQUENCY / 343.0 * np.sin(np.radians(40))
    phase = kt * (u * np.cos(np.radians(30)) + v * np.sin(np.radians(30)))
    launched = np.exp(-4 * np.log(2) * ((u / 0.2) ** 2 + (v / 0.1) ** 2) + 1j * phase)
    assert np.max(np.abs(p - launched)) < 1e-10
