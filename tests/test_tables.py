"""Where sums by tables are taken, and that fields and spectra do not change with them; the sums themselves: test_reference.py."""

import numpy as np
import pytest

import beamprop as bp
from beamprop.arrays import exponentials


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
