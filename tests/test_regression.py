"""Numbers of the paper's medium that the package gave before: each test states them, and is what computes them again."""

import numpy as np
import pytest

import beamprop as bp

F = 2500.0


def test_the_interface_term_brings_the_effective_slab_nearer():
    """The rms error of T at 20 periods, 0.126, falls to 0.034 with the interface term."""
    slab, ratio = bp.Slab(bp.lmmd_cell(), 20), np.linspace(0, 0.99, 100)

    def error(s):
        exact = bp.scattering(slab, F, kx_over_k0=ratio).transmissivity
        return float(np.sqrt(((bp.scattering(s, F, kx_over_k0=ratio).transmissivity / exact - 1) ** 2).mean()))

    bare, corrected = error(bp.lmmd_emt_slab(slab, interface=False)), error(bp.lmmd_emt_slab(slab))
    assert bare == pytest.approx(0.126, abs=0.002)
    assert corrected == pytest.approx(0.034, abs=0.002)


def test_bloch_wavenumber_of_the_lossless_medium_at_normal_incidence():
    """0.7308 k0; at leading order it is the root of the effective density 0.05 + S, 0.7307."""
    assert bp.bloch(bp.lmmd_cell(0.05, 0.0), F, kx=0.0).kz_over_k0.item() == pytest.approx(0.7308, abs=5e-5)


def test_bloch_wavenumber_of_eight_layers():
    """The numbers for N = 8 at kx = k0: |Re kz/k0| = 1.61 and Im kz/k0 = 2.40."""
    kz = bp.bloch(bp.lmmd_cell(n_layers=8), F, kx_over_k0=1.0).kz_over_k0.item()
    assert abs(kz.real) == pytest.approx(1.605, abs=0.01)
    assert kz.imag == pytest.approx(2.403, abs=0.01)


def test_lossless_width_at_2400_hz():
    """0.0880510 m where the half level is interpolated linearly between samples 2.68 mm apart; 0.0880340 m exactly."""
    slab = bp.Slab(bp.lmmd_cell(0.05, 0.0), 450)
    x = (np.arange(1024) - 512) * 20 * 0.1372 / 1024
    size = np.abs(bp.field(slab, bp.GaussianBeam(0.096), 2400.0, x, slab.thickness, rtol=1e-10).p.values)
    top = np.argmax(size)
    above = np.flatnonzero(size > size[top] / 2)
    left, right = above[above <= top].min(), above[above >= top].max()
    assert np.all(np.diff(above) == 1)
    half = size[top] / 2
    a = x[left] - (size[left] - half) / (size[left] - size[left - 1]) * (x[1] - x[0])
    b = x[right] + (size[right] - half) / (size[right] - size[right + 1]) * (x[1] - x[0])
    assert b - a == pytest.approx(0.0880510, abs=5e-8)
    exact = bp.beam_width(slab, bp.GaussianBeam(0.096), 2400.0, rtol=1e-10).fwhm_out.item()
    assert exact == pytest.approx(0.0880340, abs=5e-8)


def test_mode_of_twenty_lossless_periods():
    """At 1.598146 k0; finite elements at the same period show its resonance at 1.598."""
    (mode,) = bp.guided_modes(bp.Slab(bp.lmmd_cell(0.05, 0.0), 20), F).kx_over_k0.values
    assert mode == pytest.approx(1.598146, abs=1e-6)
