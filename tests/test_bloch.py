"""Bloch waves: eigenvalues of the cell's matrix, the branch that is continuous, bands and their edges."""

import numpy as np
import pytest
from oracles import slab_response
from plane_waves import K0, F, cells

import beamprop as bp

K_AIR = 1.25 * 343.0**2


def product(cell, kx, f=F):
    """The cell's matrix as a plain numpy product."""
    m, w = np.eye(2, dtype=complex), 2 * np.pi * f
    for layer in cell.layers:
        rho, K, d = layer.fluid.density, layer.fluid.bulk_modulus, layer.thickness
        kz = np.sqrt(rho * (w**2 / K - kx**2 / rho) + 0j)
        m = np.array([[np.cos(kz * d), rho * np.sin(kz * d) / kz], [-kz * np.sin(kz * d) / rho, np.cos(kz * d)]]) @ m
    return m


TWO = bp.Cell([bp.Layer(bp.AIR, 0.03), bp.Layer(bp.Fluid.from_speed(5.0, 343.0), 0.03)])


@pytest.mark.parametrize(
    "cell",
    [bp.lmmd_cell(), bp.lmmd_cell(0.05, 0.0, 8), bp.lmmd_cell(0.05, 0, 14, 1 / 20), TWO],
    ids=["paper", "N=8", "N=14", "two"],
)
@pytest.mark.parametrize("ratio", [0.0, 0.7, 1.0 + 1e-7, 3.0, 9.5])
def test_bloch_waves_are_eigenvalues_of_the_cell_matrix(cell, ratio):
    """exp(i kz P) is an eigenvalue of the product matrix, the one that does not grow."""
    kz = bp.bloch(cell, F, kx=ratio * K0).kz.item()
    values = np.linalg.eigvals(product(cell, ratio * K0))
    eigenvalue = np.exp(1j * kz * cell.thickness)
    assert np.min(np.abs(values - eigenvalue)) < 1e-9 * np.abs(values).max()
    assert abs(eigenvalue) <= 1 + 1e-12


@pytest.mark.parametrize(("eta", "leaves"), [(1 / 20, True), (1 / 100, False)])
def test_contours_are_flat_as_far_as_the_period_is_short(eta, leaves):
    """Beyond 5 k0 the contour of eta = 1/20 departs from its flat value by over 5 %, that of 1/100 stays within 1 %."""
    ratio = np.linspace(0, 10, 201)
    kz = bp.bloch(bp.lmmd_cell(0.05, 0.0, eta=eta), F, kx_over_k0=ratio).kz_over_k0.values.real
    departure = np.abs(kz / kz[0] - 1)
    if leaves:
        assert np.all(departure[ratio > 5] > 0.05)
        assert departure[-1] > 0.2
    else:
        assert np.all(departure < 0.01)


@pytest.mark.parametrize("n_layers", [4, 8, 12])
def test_a_layer_where_the_cosine_is_zero_ends_non_diffraction(n_layers):
    """N a multiple of 4 has a layer of density rho_m, and its contour is no longer flat; N = 6, 10, 14 are."""
    ratio = [0.0, 1.0]
    bent, flat = (
        bp.bloch(bp.lmmd_cell(n_layers=n), F, kx_over_k0=ratio).kz_over_k0.values for n in (n_layers, n_layers + 2)
    )
    assert abs(bent[1] - bent[0]) > 1
    assert abs(flat[1] - flat[0]) < 2e-3


@pytest.mark.parametrize(
    "cell",
    [
        bp.lmmd_cell(),
        bp.lmmd_cell(0.05, 0.0, eta=1 / 20),
        bp.lmmd_cell(n_layers=8),
        bp.Cell([bp.Layer(bp.Fluid(1.25, K_AIR * (1 - 0.02j)), 0.15), bp.Layer(bp.Fluid.from_speed(5.0, 343.0), 0.15)]),
    ],
    ids=["paper", "coarse", "N=8", "many zones"],
)
def test_the_branch_is_continuous(cell):
    """On grids ten times finer the largest step of kz falls about ten times: nothing jumps."""
    coarse, fine = (
        np.abs(np.diff(bp.bloch(cell, F, kx_over_k0=np.linspace(-3, 3, n)).kz.values)).max() for n in (2001, 20001)
    )
    assert fine < 0.35 * coarse
    assert fine * cell.thickness < 0.1


def test_the_contour_is_even_and_does_not_depend_on_the_grid():
    """kz(-kx) = kz(kx); a single kx gives the same value as a grid, up to whole turns."""
    ratio = np.linspace(-4, 4, 161)
    kz = bp.bloch(bp.lmmd_cell(), F, kx_over_k0=ratio).kz.values
    np.testing.assert_allclose(kz, kz[::-1], rtol=1e-12)
    np.testing.assert_allclose(
        [bp.bloch(bp.lmmd_cell(), F, kx_over_k0=q).kz.item() for q in ratio[::40]], kz[::40], rtol=1e-12
    )
    assert np.all(kz.imag >= 0)


@pytest.mark.parametrize(
    ("cell", "frequency", "ratio"),
    [(TWO, 800.0, 0.0), (TWO, 5500.0, 0.0), (TWO, 7000.0, 0.0), (bp.lmmd_cell(0.05, 0.0, 4), F, 1.0)],
    ids=["first band", "second band", "third band", "N=4"],
)
def test_without_loss_the_sign_of_kz_is_that_of_a_little_loss(cell, frequency, ratio):
    """The wave that carries energy along +z is the one that decays there when a little loss is added: backward bands too."""
    hazy = bp.Cell(
        [bp.Layer(bp.Fluid(v.fluid.density, v.fluid.bulk_modulus * (1 - 1e-7j)), v.thickness) for v in cell.layers]
    )
    kx = ratio * 2 * np.pi * frequency / 343
    clear, damped = (bp.bloch(c, frequency, kx=kx).kz.item() * cell.thickness for c in (cell, hazy))
    assert clear.imag == 0
    assert 0 < damped.imag < 1e-3
    assert np.exp(1j * clear) == pytest.approx(np.exp(1j * damped.real), abs=1e-4)
    assert abs(np.sin(clear)) > 0.1  # the two signs differ


def edge(lo, hi):
    """A band edge of TWO by bisection: where trace/2 of the product matrix passes -1."""
    for _ in range(100):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if np.trace(product(TWO, 0.0, middle)).real / 2 > -1 else (lo, middle)
    return lo, hi


def test_band_edges():
    """At the edge of a stop band the powers are degenerate; r and t pass it smoothly and agree with 50 digits."""
    for f in (*edge(1000.0, 2600.0), edge(1000.0, 2600.0)[0] * (1 + 1e-10)):
        slab = bp.Slab(TWO, 12)
        ds = bp.scattering(slab, f, kx=0.0)
        ends = [(bp.AIR.density, bp.AIR.bulk_modulus)] * 2
        r, t = slab_response(cells(slab), 12, *ends, f, 0.0)
        assert ds.t.item() == pytest.approx(complex(t), rel=1e-7)
        assert ds.r.item() == pytest.approx(complex(r), rel=1e-7)


def test_a_stop_band_decays_with_kz_on_the_zone_edge():
    """Inside the stop band |Re kz| P = pi and |t| falls by Im kz; in the pass bands of the lossless cell Im kz = 0."""
    low = edge(1000.0, 2600.0)[0]
    kz = bp.bloch(TWO, [low - 100, low + 200], kx=0.0).kz.values * TWO.thickness
    assert kz[0].imag == 0
    assert abs(kz[1].real) == pytest.approx(np.pi, abs=1e-9)
    assert kz[1].imag > 0.1
    t = [abs(bp.scattering(bp.Slab(TWO, n), low + 200, kx=0.0).t.item()) for n in (20, 30)]
    assert np.log(t[0] / t[1]) == pytest.approx(10 * kz[1].imag, rel=1e-6)


def test_a_single_kx_is_answered_in_the_first_zone():
    """|Re kz| P <= pi at the kx nearest to 0, and the sign is that of the wave that carries energy along +z."""
    low = edge(1000.0, 2600.0)[0]
    kz = bp.bloch(TWO, [0.3 * low, 0.7 * low, 0.95 * low], kx=0.0).kz.values * TWO.thickness
    assert np.all(np.abs(kz.real) <= np.pi)
    assert np.all(np.diff(kz.real) > 0)
