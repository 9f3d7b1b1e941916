"""Sums by tables are the plain sums."""

import numpy as np
import pytest

import beamprop as bp
from beamprop.arrays import exponentials


@pytest.mark.parametrize("count", [1, 2, 3, 128, 1001])
@pytest.mark.parametrize("waves", [1, 7, 5000])
def test_both_sums(count, waves, monkeypatch):
    """To rounding, with complex k, at any number of positions, in one block or in many."""
    monkeypatch.setattr(exponentials, "BLOCK", 2**12)
    rng = np.random.default_rng(count)
    k = rng.uniform(-50, 50, waves) - 0.3j * rng.uniform(0, 1, waves)
    x = -1.3 + 0.004 * np.arange(count)
    waves_of, weights = (rng.normal(size=n) + 1j * rng.normal(size=n) for n in ((2, waves), (count, 3)))
    plain = np.exp(1j * np.multiply.outer(k, x))
    found = exponentials.over_waves(k, waves_of, x[0], 0.004, count)
    np.testing.assert_allclose(found, waves_of @ plain, rtol=0, atol=1e-13 * np.abs(waves_of).sum())
    found = exponentials.over_positions(k, weights, x[0], 0.004)
    np.testing.assert_allclose(found, (1 / plain) @ weights, rtol=0, atol=3e-13 * np.abs(weights).sum())


def test_even_positions():
    """Positions that are even to their own rounding, and no others."""
    x = 7.3 + 0.1 * np.linspace(-1, 1, 999)
    assert exponentials.even_step(x) == pytest.approx(0.2 / 998)
    x[5] += 1e-12
    assert exponentials.even_step(x) == 0
    assert exponentials.even_step(x[:1]) == 0


def test_spectrum_and_field_go_through_tables(monkeypatch):
    """A profile's spectrum and a row of a field are the same without tables."""
    x = np.linspace(-0.4, 0.4, 301)
    beam = bp.Profile(x, np.exp(-((x / 0.1) ** 2)) * (1 + 0.2 * np.sin(30 * x)), z0=-0.2, angle=20.0)
    slab = bp.Slab(bp.lmmd_cell(), 3)
    at = np.linspace(-1, 1, 2001)
    calls = []
    for name in ("over_waves", "over_positions"):
        plain = getattr(exponentials, name)
        monkeypatch.setattr(exponentials, name, lambda *a, _f=plain, _n=name: calls.append(_n) or _f(*a))
    with_tables = bp.field(slab, beam, 2500.0, at, 0.1).p.values
    assert set(calls) == {"over_waves", "over_positions"}
    monkeypatch.setattr(exponentials, "MANY", 10**9)
    calls.clear()
    plainly = bp.field(slab, beam, 2500.0, at, 0.1).p.values
    assert not calls
    assert np.max(np.abs(with_tables - plainly)) < 1e-12 * np.max(np.abs(plainly))
