"""Kernels at complex frequencies: analytic in frequency, and held to 50 digits; questions take real frequencies only."""

import warnings

import mpmath as mp
import numpy as np
import pytest

import beamprop as bp
from beamprop.conventions import branch_wavenumber, outgoing_kz
from beamprop.media.properties import Tabulated
from beamprop.response.sampled_slab import sample, sample_all

RHO, C = 1.25, 343.0
K = RHO * C**2
F0 = 2500.0
RELAXATION, RESONANCE = 900.0, 1800.0
WATER = bp.Fluid(1000.0, 2.2e9)
ABOVE, BELOW = F0 + 120j, F0 - 80j


def relaxing(f):
    """A bulk modulus with loss that is analytic in f; passive with exp(-i w t)."""
    return K * (1 + 0.3 * f / (f + 1j * RELAXATION))


def resonant(f):
    """A density without loss on the real axis, negative below RESONANCE sqrt(2)."""
    return 2 * RHO * (1 - 2 * (RESONANCE / f) ** 2)


CELL = (bp.Layer(bp.Fluid(resonant, K), 0.011), bp.Layer(bp.Fluid(3 * RHO, relaxing), 0.017))
SLABS = {
    "dispersive": bp.Slab(CELL, 12, after=WATER),
    "one period": bp.Slab((*CELL, bp.Membrane(lambda f: 0.4 + 30j / f)), 1),
    "backward layer": bp.Slab((bp.Layer(bp.Fluid(-2 * RHO, -K), 0.02), CELL[1]), 7),
    "paper": bp.Slab(bp.lmmd_cell(), 40),
    "paper's medium": bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(0.05, 0), 40)),
}


def r_t(slab, frequency, kx):
    """r and t at one frequency and kx, and p in the middle of the slab."""
    answer = sample(slab, frequency).response(np.array([kx], complex), np.array([0.4 * slab.thickness]))
    return np.array([answer.r[0, 0], answer.t[0, 0], answer.inside[0, 0, 0]])


# --- against an independent product ------------------------------------------------------------------------


def mp_root(w):
    """The square root that is cut along the negative imaginary axis."""
    return mp.exp(mp.mpc(0, mp.pi / 4)) * mp.sqrt(mp.mpc(0, -1) * w)


def mp_admittance(fluid, w, f, kx):
    """kz/rho of a half-space: outgoing on the real axis, a root for each of the two cuts off it."""
    rho, modulus = (mp.mpmathify(v(f) if callable(v) else v) for v in (fluid.density, fluid.bulk_modulus))
    k = mp_root(w * rho) * mp_root(w / modulus)
    return mp_root(k - kx) * mp_root(k + kx) / rho


def mp_r_t(slab, f, kx):
    """r and t by plain 50-digit matrices, layer after layer."""
    with mp.workdps(50):
        f, kx = mp.mpmathify(f), mp.mpmathify(kx)
        w = 2 * mp.pi * f
        m = mp.eye(2)
        for cell, periods in slab.segments:
            for layer in cell.layers * periods:
                if isinstance(layer, bp.Membrane):
                    mass = layer.areal_density(f) if callable(layer.areal_density) else layer.areal_density
                    m = mp.matrix([[1, mass], [0, 1]]) * m
                    continue
                rho, modulus = (
                    mp.mpmathify(v(f) if callable(v) else v) for v in (layer.fluid.density, layer.fluid.bulk_modulus)
                )
                kz, d = mp.sqrt(rho * w**2 / modulus - kx**2), mp.mpf(layer.thickness)
                c, s = mp.cos(kz * d), mp.sin(kz * d)
                m = mp.matrix([[c, rho * s / kz], [-kz * s / rho, c]]) * m
        front, behind = (1j * mp_admittance(fluid, w, f, kx) for fluid in (slab.before, slab.after))
        # [t; behind t] = m [1 + r; front (1 - r)], det m = 1
        still, moved = m[1, 0] - behind * m[0, 0], (m[1, 1] - behind * m[0, 1]) * front
        r = -(still + moved) / (still - moved)
        return complex(r), complex(2 * front / (moved - still))


@pytest.mark.parametrize("name", ["dispersive", "one period", "backward layer", "paper"])
@pytest.mark.parametrize("frequency", [ABOVE, BELOW, complex(F0)])
@pytest.mark.parametrize("kx", [0.0, 20.0, 70.0, 30 + 8j])
def test_the_response_against_a_product_of_50_digits(name, frequency, kx):
    """r and t at complex frequency, above and below the real axis, for propagating, evanescent and complex kx."""
    got = r_t(SLABS[name], frequency, kx)[:2]
    np.testing.assert_allclose(got, mp_r_t(SLABS[name], frequency, kx), rtol=1e-10)


# --- analytic in frequency ---------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SLABS)
@pytest.mark.parametrize("frequency", [ABOVE, BELOW])
@pytest.mark.parametrize("kx", [0.0, 25.0, 75.0])
def test_the_response_is_analytic(name, frequency, kx):
    """Cauchy-Riemann by central differences, and no step at the real axis: the mean over a circle is the middle's value."""
    slab, h = SLABS[name], 0.01
    along, across = (
        (r_t(slab, frequency + step, kx) - r_t(slab, frequency - step, kx)) / (2 * step) for step in (h, 1j * h)
    )
    np.testing.assert_allclose(across, along, rtol=1e-5)
    circle = [r_t(slab, F0 + 5 * np.exp(2j * np.pi * (i + 0.5) / 64), kx) for i in range(64)]
    np.testing.assert_allclose(np.mean(circle, axis=0), r_t(slab, F0, kx), rtol=1e-9)


@pytest.mark.parametrize("name", SLABS)
def test_the_real_axis_is_the_limit(name):
    """Frequencies with no imaginary part answer as real ones do, whatever their type."""
    for kx in (0.0, 25.0, 75.0):
        np.testing.assert_allclose(r_t(SLABS[name], complex(F0), kx), r_t(SLABS[name], F0, kx), rtol=1e-10)


def test_many_waves_at_complex_frequencies():
    """Many kx at once, as a polynomial in kx^2, and several frequencies, answer as each by itself."""
    slab, kx = SLABS["paper"], np.linspace(0, 60, 4001).astype(complex)
    both = sample_all(slab, np.array([ABOVE, BELOW])).response(kx)
    for i, frequency in enumerate((ABOVE, BELOW)):
        for j in (0, 1234, 4000):
            np.testing.assert_allclose([both.r[i, j], both.t[i, j]], r_t(slab, frequency, kx[j])[:2], rtol=1e-9)


# --- media and half-spaces -----------------------------------------------------------------------------------


@pytest.mark.parametrize("frequency", [ABOVE, BELOW])
def test_lmmd_density_off_the_real_axis(frequency):
    """Eq. (9) without loss: <rho> + S rho0 (f/f0)^2 with S of the staircase of ten steps, at complex f as at real f."""
    eta, n = 1 / 60, 10
    steps = np.cos(2 * np.pi * np.arange(n) / n)
    # S = 2 sum |b_n|^2/n^2 over the harmonics of the staircase: those of its samples, times sinc(n/N)
    order = np.arange(1, 200_001)  # the terms fall as n^-4
    b = steps @ np.exp(-2j * np.pi * np.outer(np.arange(n), np.arange(n)) / n) / n
    harmonics = 2 * np.sum((np.abs(b[order % n]) * np.abs(np.sinc(order / n)) / order) ** 2)
    assert harmonics == pytest.approx(0.48388, abs=1e-5)
    fluid = bp.lmmd_emt(bp.lmmd_cell(0.05, 0, n, eta, F0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rho = complex(fluid.at(frequency).rho_z) / RHO
    assert rho == pytest.approx(0.05 + harmonics * (frequency / F0) ** 2, rel=1e-9)
    assert abs(rho.imag) > 0.02


def test_dispersive_cells_at_complex_frequencies():
    """The effective media of a dispersive cell take its layers at the complex frequency itself."""
    cell = bp.Cell(CELL)
    share = np.array([0.011, 0.017]) / 0.028
    standard = bp.standard_emt(cell).at(BELOW)
    assert complex(standard.rho_z) == pytest.approx(share @ [resonant(BELOW), 3 * RHO], rel=1e-13)
    assert complex(standard.bulk_modulus) == pytest.approx(1 / (share @ [1 / K, 1 / relaxing(BELOW)]), rel=1e-13)
    h = 1e-3
    density = bp.lmmd_emt(cell).at
    along, across = ((density(BELOW + s).rho_z - density(BELOW - s).rho_z) / (2 * s) for s in (h, 1j * h))
    np.testing.assert_allclose(across, along, rtol=1e-7)


@pytest.mark.parametrize("rho", [RHO, -RHO, RHO * (1 + 0.3j), -RHO * (1 - 0.3j)])
@pytest.mark.parametrize("modulus", [K, -K, K * (1 - 0.2j), -K * (1 + 0.2j)])
def test_half_spaces_are_continued_from_the_real_axis(rho, modulus):
    """k is w n, n of real frequencies, for a fluid without dispersion; and kz(kx = 0) = k."""
    w = 2 * np.pi * F0
    real = branch_wavenumber(w, rho, modulus)
    for turn in (1 + 0.05j, 1 - 0.05j, 1 + 0j):
        k = branch_wavenumber(w * turn, rho, modulus)
        assert k == pytest.approx(complex(real) * turn, rel=1e-13)
        assert complex(outgoing_kz(0.0, w * turn, rho, rho, modulus)) == pytest.approx(complex(k), rel=1e-13)


def test_the_wavenumber_in_front_keeps_its_imaginary_part():
    """k0 = w/c of air, for one frequency, several, and one of several."""
    k0 = 2 * np.pi * ABOVE / C
    assert sample(SLABS["paper"], ABOVE).k0 == pytest.approx(k0, rel=1e-14)
    several = sample_all(SLABS["paper"], np.array([BELOW, ABOVE]))
    assert several.k0[1] == pytest.approx(k0, rel=1e-14)
    assert several.take(1).k0 == several.k0[1]


def test_gain_is_refused_at_real_frequencies_only():
    """Passivity says Im(w density) >= 0 above the real axis, and nothing of the sign of Im(density) at a complex w."""
    fluid = bp.Fluid(resonant, K)
    assert fluid.at(BELOW).rho_z.imag < 0
    with pytest.raises(ValueError, match="density: expected a passive medium"):
        bp.Fluid(lambda f: RHO - 1j + 0 * f, K).at(F0)


# --- refusals ------------------------------------------------------------------------------------------------


def test_a_table_is_known_at_real_frequencies():
    """Between its frequencies a table is linear; off the real axis it says nothing."""
    table = Tabulated((1000.0, 3000.0), (1.0, 2.0))
    assert table(np.array(2000.0)) == 1.5
    with pytest.raises(ValueError, match="frequency: expected real frequencies of a tabulated medium, got"):
        table(np.array(ABOVE))


SLAB, BEAM, X = bp.Slab(bp.lmmd_cell(), 2), bp.GaussianBeam(0.1), np.linspace(-0.1, 0.1, 3)


@pytest.mark.parametrize(
    "question",
    [
        lambda f: bp.field(SLAB, BEAM, f, X, [0.0]),
        lambda f: bp.beam_width(SLAB, BEAM, f),
        lambda f: bp.beam_measures(SLAB, BEAM, f),
        lambda f: bp.scattering(SLAB, f, angle=0),
        lambda f: bp.bloch(SLAB.cell, f, kx_over_k0=1.0),
        lambda f: bp.guided_modes(SLAB, f),
    ],
    ids=["field", "beam_width", "beam_measures", "scattering", "bloch", "guided_modes"],
)
def test_questions_take_real_frequencies(question):
    with pytest.raises(ValueError, match=r"frequency: expected (a real number|real numbers), got"):
        question(ABOVE)
