"""The fast kernels against the plain formulas of `response.reference`, over random layers, cells and slabs."""

import mpmath
import numpy as np
import pytest
from closeness import RTOL, close

import beamprop as bp
from beamprop import conventions, response
from beamprop.arrays import exponentials
from beamprop.contour import sums
from beamprop.media.values import layer_values
from beamprop.modes import argument_principle
from beamprop.response import cell, interior, layer, periods, recursion, reference, sampled_slab

SEEDS = range(12)
#: Frequencies of several at once [Hz].
FREQUENCIES = np.array([1500.0, 2500.0, 3100.0])


def random_cell(rng):
    """Thin layers of both signs of density, an odd or even number of them."""
    layers = [
        bp.Layer(
            bp.Fluid(rng.normal(0, 40) + 0.1j * rng.random(), 1.5e5 * (0.5 + rng.random()), active=True),
            1e-4 * (1 + 4 * rng.random()),
        )
        for _ in range(rng.integers(1, 17))
    ]
    return bp.Cell(tuple(layers))


def random_slab(rng):
    """Two periodic segments about an aperiodic one, with thick layers and with thin ones."""
    thick = bp.Cell(tuple(bp.Layer(bp.Fluid(1 + rng.random() + 0.05j, 1.2e5), 0.02 * rng.random()) for _ in range(30)))
    return (
        bp.Slab(random_cell(rng), int(rng.integers(2, 200)))
        + bp.Slab(thick)
        + bp.Slab(bp.lmmd_cell(0.05 + 0.2j * rng.random(), 0.0), int(rng.integers(2, 100)))
    )


def random_kx(rng, count, frequencies=1):
    return 90 * rng.random((frequencies, count)) - 2j * rng.random((frequencies, 1))


def values_of(a_cell, frequency=2500.0):
    """A cell's values at frequencies, and omega (F, 1)."""
    frequency = np.atleast_1d(frequency)
    return layer_values(a_cell, frequency), 2 * np.pi * frequency[:, None]


def faces_of(s, kx):
    """The half-spaces in front and behind, kz by its definition continued below the axis."""
    return tuple(
        reference.Face(
            s.omega * np.sqrt(fluid.rho_z / fluid.bulk_modulus) / b * reference.root_of_product(kx, b), fluid.rho_z
        )
        for fluid in (s.before, s.after)
        for b in [complex(s.omega[0, 0] * np.sqrt(fluid.rho_x[0] / fluid.bulk_modulus[0]))]
    )


# --- half-spaces ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("b", [46.0, -46.0, 46 + 3j, -46 + 1e-6j, 80j, 1e-3 + 5j])
@pytest.mark.parametrize("depth", [0.0, 1e-12, 1.0, 60.0])
def test_the_root_with_a_branch(b, depth):
    rng = np.random.default_rng(5)
    kx = rng.uniform(-100, 100, 1000) + 1j * depth * rng.normal(size=1000)
    found = conventions._root_of_product(kx, np.asarray(complex(b)))
    assert np.max(np.abs(found / reference.root_of_product(kx, complex(b)) - 1)) < 5e-15
    if depth == 0 and complex(b).imag == 0:
        assert np.all((found.real == 0) | (found.imag == 0))


@pytest.mark.parametrize("seed", SEEDS)
def test_kz_of_a_half_space_on_the_real_axis(seed):
    rng = np.random.default_rng(seed)
    sign, loss = rng.choice([-1, 1]), rng.choice([0.0, 0.1])
    fluid = bp.Fluid(sign * (1 + rng.random()) + 1j * loss, sign * 1e5 * (1 + rng.random()))
    kx, omega = rng.uniform(-100, 100, 500), 2 * np.pi * FREQUENCIES[:, None]
    values = type(fluid.at(FREQUENCIES))(*(v[:, None] for v in fluid.at(FREQUENCIES)))
    found = conventions.outgoing_kz(kx, omega, *values)
    wanted = reference.kz_on_the_axis(kx, omega, values).astype(complex)
    apart = np.abs(kx**2 - np.abs(conventions.branch_wavenumber(omega, *values[1:])) ** 2) / kx.max() ** 2
    assert np.max(np.abs(found / wanted - 1) * np.minimum(1, apart)) < 2e-15


# --- cells ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-6, 1e-2, 0.3, 0.99, 5.0, 300.0])
def test_entire_functions(size):
    rng = np.random.default_rng(1)
    u = size * rng.random(200) * np.exp(2j * np.pi * rng.random(200))
    cosine, sine = reference.entire(u)
    f = layer.entire(u)
    np.testing.assert_allclose(f.c, cosine.astype(complex), rtol=RTOL)
    np.testing.assert_allclose(f.s, sine.astype(complex), rtol=RTOL, atol=1e-15)


@pytest.mark.parametrize("count", [5, 1500])
@pytest.mark.parametrize("seed", SEEDS)
def test_cell_matrix(seed, count):
    """Few kx go through the product of all layers, many through the polynomial."""
    rng = np.random.default_rng(seed)
    layers, omega = values_of(random_cell(rng), FREQUENCIES)
    kx = random_kx(rng, count, 3)
    m = cell.cell_matrix(layers, omega, kx)
    wanted = reference.cell_matrix(layers, omega, kx)
    assert m.growth is None
    for found, (i, j) in zip(m[1:5], ((0, 0), (0, 1), (1, 0), (1, 1)), strict=True):
        close(found, (wanted[..., i, j] - (i == j)).astype(complex), axis=-1)


def test_the_polynomial_serves_the_papers_cell_and_refuses_a_thick_one():
    kx2 = np.linspace(0, 200, 300)[None] ** 2 + 0j
    for a_cell, scale, serves in (
        (bp.lmmd_cell(), 1, True),
        (bp.lmmd_cell(eta=0.5), 1, False),
        (bp.lmmd_cell(), 900, False),
    ):
        layers, omega = values_of(a_cell)
        assert (cell._fitted(layers, omega, scale * kx2) is not None) is serves


@pytest.mark.parametrize("size", [1e-12, 1e-5, 1e-2, 0.09, 0.5])
def test_bloch_phases(size):
    """With full relative precision, however small; from the trace itself to the digits that it has."""
    rng = np.random.default_rng(6)
    h = size * np.sqrt(rng.random((2, 300))) * np.exp(2j * np.pi * rng.random((2, 300)))
    zero = np.zeros_like(h)
    b = periods.bloch_phase(cell.Matrix(1.0, 2 * h, zero, zero, zero, None))
    wanted = 2 * np.arcsin(np.sqrt(-h.astype(np.clongdouble) / 2))
    wanted = np.where(wanted.imag < 0, -wanted, wanted).astype(complex)
    np.testing.assert_allclose(b.reduced, wanted, rtol=5e-15)
    assert not b.flip.any()
    from_trace = reference.bloch_phase(2 + 2 * h.astype(np.clongdouble)).astype(complex)
    signs = np.minimum(np.abs(b.reduced - from_trace), np.abs(b.reduced + from_trace))
    assert np.max(signs * np.abs(b.reduced)) < 1e-18 + 1e-15 * size


@pytest.mark.parametrize("size", [1e-12, 1e-5, 0.5, 3, 1e4, 1e12])
@pytest.mark.parametrize("imaginary", [0, 1e-14, 1e-7, 1])
def test_both_parts_of_a_bloch_phase_and_its_eigenvalue_are_precise(size, imaginary):
    """Against 40 digits: growth over many periods is as exact as the phase, and exactly 0 in a lossless pass band."""
    rng = np.random.default_rng(8)
    h = size * (rng.uniform(-1, 1, 40) + 1j * imaginary * rng.uniform(-1, 1, 40))
    zero = np.zeros_like(h)
    b = periods.bloch_phase(cell.Matrix(1.0, 2 * h, zero, zero, zero, None))
    with mpmath.workdps(40):
        for i, value in enumerate(h):
            cosine = (1 + mpmath.mpc(value)) * (-1 if b.flip[i] else 1)
            phase = mpmath.acos(cosine)
            phase = -phase if phase.imag < 0 else phase
            want = complex(phase)
            assert abs(b.reduced[i] - want) < 1e-15 * abs(want) or abs(b.reduced[i] + want.conjugate()) < 1e-15 * abs(
                want
            )
            assert b.reduced[i].imag == pytest.approx(want.imag, rel=2e-15, abs=1e-300)
            eigenvalue = mpmath.exp(1j * mpmath.mpc(b.reduced[i]))
            assert abs(b.eigenvalue[i] - complex(eigenvalue)) < 2e-15 * (1 + abs(want)) * abs(eigenvalue)
            assert abs(b.less_one[i] - complex(eigenvalue - 1)) < 2e-15 * min(1, abs(want))
    if not imaginary:
        assert np.all(b.reduced.imag[(h.real > -2) & (h.real < 0)] == 0)


@pytest.mark.parametrize("count", [1, 7, 450])
@pytest.mark.parametrize("seed", SEEDS)
def test_powers_of_a_cell(seed, count):
    """The closed form is the inverse of the matrix's power."""
    rng = np.random.default_rng(seed)
    layers, omega = values_of(random_cell(rng))
    kx = random_kx(rng, 70)
    far = layer.State(np.ones_like(kx), 20j + kx, np.zeros(kx.shape))
    m = cell.cell_matrix(layers, omega, kx)
    found = periods.power_back(m, periods.bloch_phase(m), far, count)
    power = np.linalg.matrix_power(reference.cell_matrix(layers, omega, kx), count)
    p, q = reference.carried_through(power, far.p, far.q)
    scale = np.exp(found.log.astype(np.clongdouble))
    turns = (
        1e-13 * count * (1 + np.max(np.abs(periods.bloch_phase(m).phase)))
    )  # the phase's own rounding, times the periods
    largest = np.abs(p) + np.abs(q) / 50
    assert np.max(np.abs(found.p * scale - p) / largest) < turns
    assert np.max(np.abs(found.q * scale - q) / largest) < 50 * turns


@pytest.mark.parametrize("lossless", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_numbers_of_periods_in_two_terms_against_the_closed_form(seed, lossless):
    rng = np.random.default_rng(seed)
    layers, omega = values_of(bp.lmmd_cell(0.05, 0.0) if lossless else bp.lmmd_cell())
    kx = random_kx(rng, 60)
    m = cell.cell_matrix(layers, omega, kx)
    b = periods.bloch_phase(m)
    far = layer.State(1 + rng.random((1, 60)) + 0j, 30j * rng.random((1, 60)), np.zeros((1, 60)))
    counts = np.unique(rng.integers(100, 100 + 10 ** rng.integers(1, 5), 400))
    states, factors = interior._in_two_terms(m, b, far, counts, np.zeros(60), np.ones(60))
    plain = periods.power_back(m, b, far, counts[:, None])
    scale = np.exp(plain.log)
    close((factors * states.p).sum(axis=1), plain.p * scale, rtol=3e-13, axis=0)
    close((factors * states.q).sum(axis=1), plain.q * scale, rtol=3e-13, axis=0)


# --- slabs ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", SEEDS)
def test_reflection_and_transmission(seed):
    """By the recursion and by the waves of each medium, against the product of all matrices."""
    rng = np.random.default_rng(seed)
    layers = [bp.Layer(bp.Fluid(1 + 2 * rng.random() + 0.05j, 1.2e5), 0.03 * rng.random()) for _ in range(4)]
    behind = bp.Fluid(1 + rng.random(), 1.4e5)
    s = sampled_slab.sample(bp.Slab(layers, after=behind) + bp.Slab(bp.lmmd_cell(), 5, after=behind), 2500.0)
    kx = random_kx(rng, 60)
    before, after = faces_of(s, kx)
    r, t = reference.reflection_and_transmission(reference.slab_matrix(s.segments, s.omega, kx), before, after)
    found = response.solve(s.segments, s.before, s.after, s.omega, kx)
    close(found.r, r.astype(complex), rtol=1e-12)
    close(found.t, t.astype(complex), rtol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_field_inside_against_all_layers_in_turn(seed):
    rng = np.random.default_rng(seed)
    s = sampled_slab.sample(random_slab(rng), 2500.0)
    kx = random_kx(rng, 40)
    z = np.sort(s.thickness * rng.random(150))
    found = response.solve(s.segments, s.before, s.after, s.omega, kx, z)
    before, after = faces_of(s, kx)
    wanted = reference.pressure_inside(s.segments, s.omega, kx, z, before, after)
    clear = np.abs(before.kz[0]) > 1
    close(found.inside[0][:, clear], wanted[0][:, clear].astype(complex), rtol=1e-9, axis=0)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_rest_of_a_layer(seed):
    rng = np.random.default_rng(seed)
    layers, omega = values_of(random_cell(rng))
    kx, share = random_kx(rng, 40), rng.random(30)
    face = layer.State(rng.random((2, 40)) + 0j, rng.random((2, 40)) * 1j, np.zeros(1))
    A, B, _ = layer.one_layer(layers, 0, omega * omega, kx * kx)
    found = interior._rest_of_layer(A, B, face)(share)
    for part, pressures in zip(share, found, strict=True):
        p, _ = reference.carried_through(reference.layer_matrix(layers, 0, omega, kx, part), face.p, face.q)
        close(pressures, p.astype(complex))


@pytest.mark.parametrize("growth", [0.0, 3.0, 100.0])
@pytest.mark.parametrize("phase", [0.06, 1.0, 50.0])
def test_two_waves_in_a_thick_layer_are_the_entire_functions(phase, growth):
    """Many depths in a thick layer are made of two exponentials; a state that grows on its way back stays exact."""
    rng = np.random.default_rng(3)
    w = (
        phase * (1 + rng.random((1, 30))) + 1j * growth * (0.5 + rng.random((1, 30))) * (rng.random((1, 30)) < 0.7)
    ).astype(complex)
    A, share = 1.3 * (1 + rng.random()), rng.random(20)
    p = rng.random(30) + 0.5 + 0j
    face = layer.State(p, 1j * w[0] / A * p * (1 + 0.1 * rng.random(30)), np.zeros(30))  # nearly outgoing
    assert interior._steady(w * w) is not None
    found = interior._two_waves(interior._steady(w * w), np.array([[A]]), face, np.ones(30), share)
    v = w.astype(np.clongdouble) * share[:, None]
    close(found, np.cos(v) * face.p - A * share[:, None] * np.sin(v) / v * face.q, axis=0)


def test_layers_whose_two_waves_coincide_or_overflow_have_no_two_waves():
    assert interior._steady(np.array([[1.0 + 0j, 1e-4]])) is None
    assert interior._steady(np.array([[1.0 + 0j, -(400.0**2)]])) is None


@pytest.mark.parametrize("seed", SEEDS)
def test_layers_in_blocks_against_each_in_turn(seed):
    rng = np.random.default_rng(seed)
    thick = [bp.Layer(bp.Fluid(1 + rng.random(), 1e5), 10 ** rng.uniform(-4, -0.3)) for _ in range(40)]
    layers, omega = values_of(bp.Cell(tuple(thick)))
    kx = random_kx(rng, 30)
    state = layer.State(np.ones_like(kx), 20j + 0 * kx, np.zeros(kx.shape))
    found, faces = recursion._through_layers(layers, omega, kx, state, {3, 17})
    for j in reversed(range(40)):
        if j in faces:
            close(faces[j].p / faces[j].q, state.p / state.q, rtol=1e-9)
        state = layer.layer_back(state, *layer.one_layer(layers, j, omega**2, kx**2))
        state = layer.normalised(state)
    assert set(faces) == {3, 17}
    np.testing.assert_allclose(found.log, state.log, rtol=1e-12, atol=1e-12)
    close(found.p, state.p, rtol=1e-11)


# --- sums -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 128, 1001])
@pytest.mark.parametrize("waves", [1, 7, 5000])
def test_sums_of_exponentials_by_tables(count, waves, monkeypatch):
    """To rounding, with complex k, at any number of positions, in one block or in many."""
    monkeypatch.setattr(exponentials, "BLOCK", 2**12)
    rng = np.random.default_rng(count)
    k = rng.uniform(-50, 50, waves) - 0.3j * rng.uniform(0, 1, waves)
    x = -1.3 + 0.004 * np.arange(count)
    amplitudes, weights = (rng.normal(size=n) + 1j * rng.normal(size=n) for n in ((2, waves), (count, 3)))
    found = exponentials.over_waves(k, amplitudes, x[0], 0.004, count)
    np.testing.assert_allclose(
        found, reference.over_waves(k, amplitudes, x), rtol=0, atol=1e-13 * np.abs(amplitudes).sum()
    )
    found = exponentials.over_positions(k, weights, x[0], 0.004)
    np.testing.assert_allclose(
        found, reference.over_positions(k, weights, x), rtol=0, atol=3e-13 * np.abs(weights).sum()
    )


@pytest.mark.parametrize("off", [0.0, 1e-10, 1e-3, 0.2])
@pytest.mark.parametrize("count", [1, 63, 64, 1001])
def test_plane_waves_by_tables(count, off):
    """On even grids, on those that are even to printed digits, and on uneven ones; below the axis too."""
    rng = np.random.default_rng(count)
    k = rng.uniform(0, 50, 40) - 0.3j * rng.uniform(0, 1, 40)
    x = -1.3 + 0.004 * (np.arange(count) + off * rng.uniform(-1, 1, count))
    forward, backward = reference.plane_waves(k, x)
    forth, back = sums._phases(k, x, True)
    rounding = 1e-15 * (1 + np.abs(k).max() * np.abs(x).max())  # of phases, which are sums of two products
    np.testing.assert_allclose(forth, forward, rtol=rounding)
    np.testing.assert_allclose(back, backward, rtol=rounding)
    assert sums._phases(k, x, False)[1] is None


@pytest.mark.parametrize("count", [1, 5, 8, 9, 30])
@pytest.mark.parametrize("first", [-13, -1, 0, 3, 9])
def test_harmonics_folded_onto_an_fft(first, count):
    """Bins beyond the harmonics keep what they hold, which is 0."""
    rng = np.random.default_rng(count)
    h, amplitude = rng.normal(size=(3, count)) + 0j, rng.normal(size=(2, 1, count)) * 1j
    out = np.zeros((2, 3, 8), complex)
    sums._fold(h, amplitude, first, out)
    np.testing.assert_allclose(out, reference.folded(h * amplitude, first, 8), rtol=0, atol=1e-14)


def test_logarithms():
    """But for whole turns."""
    rng = np.random.default_rng(2)
    value, log = rng.normal(size=500) + 1j * rng.normal(size=500), 90 * rng.normal(size=500)
    turns = (argument_principle.logarithm(value, log) - reference.logarithm(value, log)) / (2j * np.pi)
    assert np.max(np.abs(turns - np.rint(turns.real))) < 1e-14
