"""Fields where there is no wheel of pyfftw: the same by scipy's FFT."""

import sys
import threading

import numpy as np
import pytest

import beamprop as bp
from beamprop.arrays import fft


@pytest.fixture
def without_pyfftw(monkeypatch):
    """As where pyfftw is not installed, for plans that are made from here on."""
    monkeypatch.setitem(sys.modules, "pyfftw", None)


def in_a_new_thread(work):
    """What work() returns, with plans of its own: those that this thread has made are not used."""
    results = []
    thread = threading.Thread(target=lambda: results.append(work()))
    thread.start()
    thread.join()
    return results[0]


@pytest.mark.parametrize("n", [8, 45, 1280])
def test_both_directions_without_pyfftw(n, without_pyfftw):
    """Sums over m of c_m e^{+-2 pi i m j/n}, unscaled, of two rows at once."""
    rng = np.random.default_rng(n)
    c = rng.normal(size=(2, n)) + 1j * rng.normal(size=(2, n))
    waves = np.exp(2j * np.pi * np.outer(np.arange(n), np.arange(n)) / n)

    def both():
        plan = fft.plan_for(2, n)
        assert type(plan.run[0]).__module__ != "pyfftw"
        plan.source[0], plan.source[1] = c, c
        plan.run[0]()
        plan.run[1]()
        return plan.result.copy()

    backward, forward = in_a_new_thread(both)
    np.testing.assert_allclose(backward, c @ waves, rtol=0, atol=1e-13 * n)
    np.testing.assert_allclose(forward, c @ waves.conj(), rtol=0, atol=1e-13 * n)


def test_a_field_without_pyfftw(monkeypatch):
    """A map that is summed by FFTs is the same to rounding."""
    slab, beam = bp.Slab(bp.lmmd_cell(), 450), bp.GaussianBeam(0.096, 30.0)
    x, z = np.linspace(-1.4, 1.4, 1024, endpoint=False), np.linspace(0, slab.thickness, 12)
    lengths, scipy_plan = [], fft._scipy_plan
    monkeypatch.setattr(fft, "_scipy_plan", lambda rows, n: lengths.append(n) or scipy_plan(rows, n))

    def field():
        return bp.field(slab, beam, 2500.0, x, z).p.values

    with_pyfftw = in_a_new_thread(field)
    assert not lengths
    monkeypatch.setitem(sys.modules, "pyfftw", None)
    without = in_a_new_thread(field)
    assert lengths
    # exp(sigma X) magnifies the rounding of either transform; the plan keeps that below a hundredth of rtol, 1e-8
    assert np.abs(without - with_pyfftw).max() < 1e-10 * np.abs(with_pyfftw).max()


def test_a_cosine_series_through_values():
    """Of a polynomial of Chebyshev polynomials, at angles between: exact."""
    at = (np.arange(9) + 0.5) * np.pi / 9

    def of(turn):
        return 2 + 1j * np.cos(turn) - 3 * np.cos(8 * turn)

    assert np.max(np.abs(fft.cosine_series(of(at), 50) - of(np.arange(51) * np.pi / 50))) < 1e-13
