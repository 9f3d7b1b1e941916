"""Identities of plane waves: what must hold for every slab, whatever the numbers are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plane_waves import K0, OMEGA, F, amplitudes

import beamprop as bp
from beamprop.conventions import outgoing_kz

WATER = bp.Fluid.from_speed(1000.0, 1480.0)
HELIUM = bp.Fluid.from_speed(0.18, 972.0)
HEAVY = bp.Fluid.from_speed(6.0, 150.0)
CRYSTAL = bp.Fluid(2.0, 1.3e5, density_x=1.1)
FLUIDS = [bp.AIR, HELIUM, HEAVY, CRYSTAL, WATER]
DAMP = bp.Fluid(1.9 + 0.2j, 9e4 - 2e3j)

# --- random slabs -----------------------------------------------------------------------------------------

sizes = st.floats(0.05, 20.0)
signs = st.sampled_from([1.0, 1.0, -1.0])
losses = st.one_of(st.just(0.0), st.floats(1e-4, 1.0))
lossy = st.floats(1e-3, 1.0)
ratios = st.one_of(st.floats(0.0, 0.98), st.floats(1.02, 5.0))
fluids = st.sampled_from(FLUIDS)


@st.composite
def random_fluids(draw, loss):
    """A passive fluid: density of either sign, sometimes another along x, bulk modulus near that of air."""

    def density():
        return draw(signs) * draw(sizes) + 1j * draw(loss)

    K = draw(st.floats(5e4, 5e5)) * (1 - 0.1j * draw(loss))
    return bp.Fluid(density(), K, density() if draw(st.booleans()) else None)


@st.composite
def random_layers(draw, loss=losses, most=4):
    """One to four layers, up to 3 cm thick each."""
    count = draw(st.integers(1, most))
    return [bp.Layer(draw(random_fluids(loss)), draw(st.floats(1e-4, 0.03))) for _ in range(count)]


fixed = settings(max_examples=40, deadline=None, derandomize=True)


def admittance(fluid, kx):
    v = fluid.at(np.array([F]))
    return complex(outgoing_kz(kx, OMEGA, *(q[0] for q in v)) / v.rho_z[0])


def assert_same(a, b, rtol):
    """r, t and the field of two slabs agree, each relative to the largest |r| (at least 1), |t| and |p|."""
    for got, want, least in zip(a, b, (1.0, 0.0, 0.0), strict=True):
        np.testing.assert_allclose(got, want, rtol=0, atol=rtol * max(np.abs(want).max(initial=0.0), least))


# --- energy -----------------------------------------------------------------------------------------------


def dissipated(slab, layers, kx):
    """Power lost in the layers over the incident power, by integrating the loss of the field inside.

    d Im(p* q)/dz = -Im(rho_z) |q|^2 - (w^2 Im(1/K) - kx^2 Im(1/rho_x)) |p|^2, with q = p'/rho_z.
    """
    lost, start = 0.0, 0.0
    nodes = np.cos(np.pi * (np.arange(33) + 0.5) / 33)
    g, w = np.polynomial.legendre.leggauss(40)
    for layer in layers:
        half = layer.thickness / 2
        p = amplitudes(slab, kx, start + half * (1 + nodes))[2][:, 0]
        series = np.polynomial.Chebyshev.fit(nodes, p, 32)
        rho_z, rho_x, K = (complex(v) for v in layer.fluid.at(np.array(F)))
        flow = np.abs(series.deriv()(g) / half / rho_z) ** 2 * rho_z.imag
        press = np.abs(series(g)) ** 2 * (OMEGA**2 * (1 / K).imag - kx**2 * (1 / rho_x).imag)
        lost += half * w @ (flow + press)
        start += layer.thickness
    return lost / admittance(slab.before, kx).real


@fixed
@given(random_layers(), st.floats(0, 0.98), fluids, st.sampled_from([*FLUIDS, DAMP]))
def test_what_is_neither_reflected_nor_transmitted_is_lost_inside(layers, ratio, before, after):
    """R + T + A = 1 with A the loss integrated over the field inside; A >= 0 for a passive slab."""
    slab = bp.Slab(layers, before=before, after=after)
    kx = ratio * float(before.wavenumber(F).real)
    ds = bp.scattering(slab, F, kx=kx)
    inside = dissipated(slab, layers, kx)
    assert ds.reflectivity.item() + ds.energy_transmission.item() + inside == pytest.approx(1, abs=1e-8)
    assert ds.absorption.item() == pytest.approx(inside, abs=1e-8)
    assert ds.absorption.item() >= -1e-10


@fixed
@given(random_layers(loss=st.just(0.0)), st.integers(1, 200), st.floats(0, 0.98), fluids, fluids)
def test_a_lossless_slab_keeps_all_the_energy(layers, periods, ratio, before, after):
    """R + T = 1 between any two lossless fluids, however many periods."""
    ds = bp.scattering(bp.Slab(layers, periods, before, after), F, kx=ratio * float(before.wavenumber(F).real))
    assert ds.reflectivity.item() + ds.energy_transmission.item() == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize(("before", "after"), [(bp.AIR, WATER), (WATER, bp.AIR), (bp.AIR, HELIUM)])
def test_energy_transmission_is_by_impedances_and_angles(before, after):
    """|t|^2 Z1 cos(theta2) / (Z2 cos(theta1)) with Snell's law, 0 beyond the critical angle, nan for evanescent waves."""
    c1, c2 = (np.sqrt(v.bulk_modulus / v.density).real for v in (before, after))
    Z1, Z2 = before.density.real * c1, after.density.real * c2
    angle = np.array([0.0, 5.0, 10.0, 40.0, 80.0])
    ds = bp.scattering(bp.Slab(bp.lmmd_cell(), 5, before, after), F, angle=angle)
    sine = np.sin(np.deg2rad(angle))
    cos1, cos2 = np.sqrt(1 - sine**2), np.sqrt(np.maximum(0, 1 - (c2 / c1 * sine) ** 2))
    np.testing.assert_allclose(
        ds.energy_transmission, np.abs(ds.t) ** 2 * Z1 * cos2 / (Z2 * cos1), rtol=1e-10, atol=1e-14
    )
    assert np.any(cos2 == 0) == (c2 > c1)
    beyond = bp.scattering(bp.Slab(bp.lmmd_cell(), 5, before, after), F, kx_over_k0=[1.5])
    assert np.isnan(beyond.energy_transmission.item())
    assert np.isnan(beyond.absorption.item())


# --- reciprocity and symmetry -----------------------------------------------------------------------------


def reversed_slab(slab):
    """The same slab seen from behind."""
    turned = [(bp.Cell(cell.layers[::-1]), periods) for cell, periods in slab.segments[::-1]]
    return bp.Slab.stack(turned, before=slab.after, after=slab.before)


@fixed
@given(random_layers(), random_layers(), st.integers(1, 30), ratios, fluids, st.sampled_from([*FLUIDS, DAMP]))
def test_reciprocity(first, second, periods, ratio, before, after):
    """t from the front times the admittance behind equals t from behind times the admittance in front."""
    slab = bp.Slab(first, periods, before=before) + bp.Slab(second, 2, after=after)
    kx = ratio * K0
    forward, backward = amplitudes(slab, kx)[1][0], amplitudes(reversed_slab(slab), kx)[1][0]
    there, back = forward * admittance(after, kx), backward * admittance(before, kx)
    assert abs(there - back) <= 1e-9 * abs(there) + 1e-280


@pytest.mark.parametrize("kx", [0.3 * K0, 1.7 * K0, 0.8 * K0 - 3j])
def test_a_symmetric_slab_looks_the_same_from_both_sides(kx):
    """A layer order that is its own mirror image reflects alike from both sides; another order does not."""
    layers = list(bp.lmmd_cell().layers)
    palindrome = bp.Slab(layers + layers[::-1], 3)
    assert_same(amplitudes(palindrome, kx), amplitudes(reversed_slab(palindrome), kx), 1e-12)
    slab = bp.Slab(layers[:7], 3)
    front, back = amplitudes(slab, kx), amplitudes(reversed_slab(slab), kx)
    assert abs(front[0] - back[0]) > 1e-3
    assert front[1] == pytest.approx(back[1], rel=1e-12)


@fixed
@given(random_layers(), st.integers(1, 50), ratios)
def test_the_response_is_even_in_kx(layers, periods, ratio):
    """r and t depend on kx^2 alone, to the last bit."""
    ds = bp.scattering(bp.Slab(layers, periods), F, kx=[ratio * K0, -ratio * K0])
    assert ds.r.values[0] == ds.r.values[1]
    assert ds.t.values[0] == ds.t.values[1]


# --- the same slab said otherwise -------------------------------------------------------------------------


@fixed
@given(random_layers(loss=lossy), st.lists(st.floats(0.05, 1.0), min_size=2, max_size=5), ratios, fluids)
def test_splitting_a_layer_changes_nothing(layers, parts, ratio, after):
    """Cuts inside homogeneous layers leave r, t and the field inside alone, to 1e-11."""
    shares = np.array(parts) / sum(parts)
    cut = [bp.Layer(layer.fluid, layer.thickness * s) for layer in layers for s in shares]
    whole, pieces = bp.Slab(layers, after=after), bp.Slab(cut, after=after)
    z = np.linspace(0.02, 0.98, 7) * whole.thickness
    assert_same(amplitudes(pieces, ratio * K0, z), amplitudes(whole, ratio * K0, z), 1e-11)


@fixed
@given(random_layers(loss=lossy), st.integers(2, 9), ratios, fluids)
def test_copies_of_a_cell_are_periods(layers, count, ratio, after):
    """N copies of a cell's layers are `periods=N`, in r, t and at depths in every copy."""
    copies, periods = bp.Slab(layers * count, after=after), bp.Slab(layers, count, after=after)
    assert copies.thickness == pytest.approx(periods.thickness, rel=1e-14)
    z = (np.arange(3 * count) + 0.37) / (3 * count) * copies.thickness
    assert_same(amplitudes(periods, ratio * K0, z), amplitudes(copies, ratio * K0, z), 1e-10)


@fixed
@given(random_layers(loss=lossy, most=3), random_layers(loss=lossy, most=3), random_layers(loss=lossy, most=3), ratios)
def test_stacking_is_associative(first, second, third, ratio):
    """(a + b) + c is a + (b + c), and the slab of one cell with all the layers; outer half-spaces are kept."""
    a, b, c = bp.Slab(first, before=HELIUM), bp.Slab(second, 2, HEAVY, HEAVY), bp.Slab(third, after=HEAVY)
    left, right = (a + b) + c, a + (b + c)
    assert left == right
    assert (left.before, left.after) == (HELIUM, HEAVY)
    every = bp.Slab(first + second + second + third, before=HELIUM, after=HEAVY)
    z = np.linspace(0.01, 0.99, 9) * every.thickness
    assert_same(amplitudes(left, ratio * K0, z), amplitudes(every, ratio * K0, z), 1e-11)


@pytest.mark.parametrize("fluid", [bp.Fluid(2 + 0.01j, 2e5), bp.Fluid(-1 + 0.1j, 2e5), bp.Fluid(3, 1.5e5, np.inf)])
@pytest.mark.parametrize("ratio", [0.0, 0.7, 2.5])
def test_a_uniform_slab_is_any_number_of_thin_cells(fluid, ratio):
    """100000 periods of thin cells are one layer."""
    whole, thin_cells = bp.Slab.uniform(fluid, 0.2), bp.Slab([bp.Layer(fluid, 0.2 / 100_000)], 100_000)
    z = np.array([0.0, 0.0123456, 0.1, 0.19999])
    assert_same(amplitudes(thin_cells, ratio * K0, z), amplitudes(whole, ratio * K0, z), 1e-9)


@pytest.mark.parametrize("fluid", [*FLUIDS, DAMP], ids=["air", "helium", "heavy", "crystal", "water", "lossy"])
@pytest.mark.parametrize("ratio", [0.0, 0.6, 1.0, 1.4, 4.0, 0.9 - 0.2j])
@pytest.mark.parametrize("periods", [1, 40])
def test_a_slab_of_the_ambient_is_no_slab(fluid, ratio, periods):
    """r = 0 and t = exp(i kz L), for propagating, grazing, evanescent and complex kx."""
    kx = ratio * complex(fluid.wavenumber(F))
    if ratio == 1.0 and kx.imag == 0:
        kx = kx.real  # exactly where kz = 0
    slab = bp.Slab([bp.Layer(fluid, 0.003), bp.Layer(fluid, 0.002)], periods, fluid, fluid)
    z = np.array([0.0, 0.3, 0.77]) * slab.thickness
    r, t, p = amplitudes(slab, kx, z)
    kz = admittance(fluid, kx) * complex(fluid.at(np.array(F)).rho_z)
    assert abs(r[0]) < 1e-7 if ratio == 1.0 else abs(r[0]) < 1e-11
    assert t[0] == pytest.approx(np.exp(1j * kz * slab.thickness), rel=1e-7 if ratio == 1.0 else 1e-10)
    np.testing.assert_allclose(p[:, 0], np.exp(1j * kz * z), rtol=1e-7 if ratio == 1.0 else 1e-10)


@pytest.mark.parametrize("interface", [True, False])
def test_the_effective_slab_keeps_thickness_and_half_spaces(interface):
    """The effective slab is as thick as the layered one, stacked slabs too, and stands between the same fluids."""
    slab = bp.Slab(bp.lmmd_cell(), 33, HELIUM) + bp.Slab(bp.lmmd_cell(n_layers=6, eta=1 / 40), 7, after=WATER)
    emt = bp.lmmd_emt_slab(slab, interface)
    assert emt.thickness == pytest.approx(slab.thickness, rel=1e-14)
    assert (emt.before, emt.after) == (HELIUM, WATER)
    assert [cell.thickness for cell, _ in emt.segments] == pytest.approx([c.thickness * n for c, n in slab.segments])
