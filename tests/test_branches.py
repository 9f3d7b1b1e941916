"""Dispersion curves of plates: branches that are followed, against free plates (Rayleigh and Lamb) and by their own continuity."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import beamprop as bp
from beamprop.modes.branches import branches

STEEL = 7900.0, 5900.0, 3200.0
MM = 1e-3


def plate_in(density, frequency, **options):
    """Leaky modes of 1 mm of steel in a fluid of water's speed."""
    fluid = bp.Fluid.from_speed(density, 1480.0)
    slab = bp.Slab(bp.Layer(bp.Solid(*STEEL), MM), background=fluid)
    return bp.guided_modes(slab, frequency, 2.0, options.pop("strip", 0.05), leaky=True)


def curve(ds, number):
    """Frequencies and kx/k0 of a branch."""
    i, j = np.nonzero(ds.branch.values == number)
    return ds.frequency.values[i], ds.kx_over_k0.values[i, j]


def rayleigh_lamb(f, kx):
    """Of symmetric and of antisymmetric waves of a free plate: 0 on their curves, over the larger of its two terms."""
    _, cl, ct = STEEL
    p, q = (np.sqrt((2 * np.pi * f / c) ** 2 - kx**2 + 0j) for c in (cl, ct))
    a, b = (q**2 - kx**2) ** 2, 4 * kx**2 * p * q
    half = MM / 2
    terms = [
        (a * np.cos(p * half) * np.sin(q * half), b * np.sin(p * half) * np.cos(q * half)),
        (a * np.sin(p * half) * np.cos(q * half), b * np.cos(p * half) * np.sin(q * half)),
    ]
    return [abs(u + v) / np.maximum(abs(u), abs(v)) for u, v in terms]


def test_the_slow_end_of_s0_is_the_speed_of_a_thin_plate():
    """2 cT sqrt(1 - cT^2/cL^2) = 5376.9 m/s at 0.01 MHz mm in a fluid of a millionth of water's density."""
    ds = plate_in(1e-3, [1e4, 1.2e4])
    f, k = curve(ds, int(ds.branch.values[0, 0]))
    assert f.tolist() == [1e4, 1.2e4]
    _, cl, ct = STEEL
    assert 1480 / k[0].real == pytest.approx(5376.88, abs=0.01)
    assert 1480 / k[0].real == pytest.approx(2 * ct * np.sqrt(1 - (ct / cl) ** 2), rel=1e-5)


def test_branches_keep_their_symmetry_through_crossings():
    """Two branches cross at 5.4 MHz mm; each solves the one of Rayleigh and Lamb's two equations that it began with."""
    ds = plate_in(1e-3, np.linspace(5.1e6, 5.7e6, 7))
    assert (ds.branch.values[0] != ds.branch.values[-1]).sum() == 2
    for number in range(int(ds.branch.max()) + 1):
        f, k = curve(ds, number)
        symmetric, antisymmetric = rayleigh_lamb(f, 2 * np.pi * f / 1480 * k.real)
        assert min(symmetric.max(), antisymmetric.max()) < 1e-3
        assert max(symmetric.min(), antisymmetric.min()) > 1e-3
        assert f.size == 7


def test_branches_in_water_are_continuous_from_end_to_end():
    """A0, S0, A1 of a steel plate leak, and two Scholte waves lie close together: one curve each, without steps."""
    f = np.linspace(1.8e6, 2.5e6, 8)
    ds = plate_in(1000.0, f, strip=0.1)
    assert set(ds["count"].values) == {5}
    assert int(ds.branch.max()) == 4
    for number in range(5):
        at, k = curve(ds, number)
        np.testing.assert_array_equal(at, f)
        assert abs(np.diff(k, 2)).max() < 0.02


def test_a_mode_without_a_predecessor_begins_a_branch():
    k0 = np.array([1.0, 2.0, 3.0])
    kx = np.array([[1.0, np.nan], [2.1, 8.0], [3.2, np.nan]], complex)
    np.testing.assert_array_equal(branches(k0, kx), [[0, -1], [0, 1], [0, -1]])
    # whichever way frequencies are asked, and for branches that cross
    crossing = np.array([[1.0, 2.6], [2.0, 2.9], [3.0, 3.2], [3.5, 4.0]], complex)
    k0 = np.array([1.0, 2.0, 3.0, 4.0])
    expected = [[0, 1], [0, 1], [0, 1], [1, 0]]
    np.testing.assert_array_equal(branches(k0, crossing), expected)
    backwards = branches(k0[::-1], crossing[::-1])[::-1]
    np.testing.assert_array_equal(backwards, expected)


def test_branches_are_drawn_as_lines():
    ds = plate_in(1000.0, [2.0e6, 2.1e6])
    assert "branch" not in plate_in(1000.0, 2.0e6)
    lines = bp.plot.modes(ds).lines[2:]
    assert len(lines) == int(ds.branch.max()) + 1
    for number, line in enumerate(lines):
        f, k = curve(ds, number)
        np.testing.assert_array_equal(line.get_xydata(), np.transpose([f, k.real]))
    plt.close("all")


def test_branches_are_followed_beside_zero_group_velocity():
    """A backward wave of a brass plate in water (S2b) and a forward one (S1) part at 1.93 MHz mm, where they move by twice a step of k0 each."""
    plate = bp.Slab(bp.Layer(bp.Solid(8400.0, 4400.0, 2200.0), MM), background=bp.Fluid.from_speed(1000.0, 1480.0))
    ds = bp.guided_modes(plate, np.linspace(1.95e6, 2.25e6, 7), 1.3, 0.12, leaky=True)
    backward = ds.branch.values[ds.direction.values < 0]
    assert backward.size == 5
    assert np.unique(backward).size == 1
    _, k = curve(ds, int(backward[0]))
    assert np.all(np.diff(k.real) < 0)
    assert np.all(np.diff(k.imag) > 0)
    kept = [curve(ds, number)[0].size for number in range(int(ds.branch.max()) + 1)]
    assert sorted(kept) == [
        1,
        5,
        *6 * [7],
    ]  # the first is the backward wave once more, which runs forward from k = 0 on
