"""The fast kernels against the plain formulas that stand above them in their comments, over random cases."""

import math

import numpy as np
import pytest

import beamprop as bp
from beamprop import conventions, response
from beamprop.arrays import fft, matmul
from beamprop.contour import choose as contour_choice
from beamprop.contour import error_estimate, paths
from beamprop.fields import evaluate, low_rank
from beamprop.media.structures import layer_values
from beamprop.profiles import many_frequencies
from beamprop.response import cell as cell_kernels
from beamprop.response import interior, recursion, sampled_slab
from beamprop.response import layer as one
from beamprop.sources import angles as source_angles

SEEDS = range(12)
RTOL = 1e-13


def close(found, wanted, rtol=RTOL, axis=None):
    """Largest difference over the largest wanted value (along an axis)."""
    scale = np.max(np.abs(wanted), axis=axis, keepdims=True)
    assert np.all(np.isfinite(found))
    assert np.max(np.abs(found - wanted) / np.where(scale > 0, scale, 1)) < rtol


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


# --- roots ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e6])
def test_principal_root(scale):
    rng = np.random.default_rng(4)
    w = rng.normal(size=500) + 1j * scale * rng.normal(size=500)
    w = np.concatenate([w, w.real + 0j, w.real - 0j, [0.0, 1e-40j]])
    root = conventions.principal_root(w)
    np.testing.assert_allclose(root, np.sqrt(w), rtol=1e-15)
    assert np.array_equal(root[500:].real == 0, np.sqrt(w[500:]).real == 0)


@pytest.mark.parametrize("b", [46.0, -46.0, 46 + 3j, -46 + 1e-6j, 80j, 1e-3 + 5j])
@pytest.mark.parametrize("depth", [0.0, 1e-12, 1.0, 60.0])
def test_the_root_with_a_branch(b, depth):
    """Against a root for each branch point, e^{i pi/4} sqrt(-i w), whose cut is along -i."""
    rng = np.random.default_rng(5)
    kx = rng.uniform(-100, 100, 1000) + 1j * depth * rng.normal(size=1000)
    b = complex(b)

    def root(w):
        return np.exp(0.25j * np.pi) * np.sqrt(w * -1j)

    found = conventions._root_of_product(kx, np.asarray(b))
    wanted = root(b - kx) * root(b + kx)
    assert np.max(np.abs(found / wanted - 1)) < 5e-15
    if depth == 0 and b.imag == 0:
        assert np.all((found.real == 0) | (found.imag == 0))


# --- cells ------------------------------------------------------------------------------------------------


def plain_layer(A, B, dtype=np.clongdouble):
    """[[C, A s], [-B s, C]] by square root, cosine and sine."""
    A, B = A.astype(dtype), B.astype(dtype)
    w = np.sqrt(A * B)
    C, s = np.cos(w), np.sin(w) / w
    return np.array([[C, A * s], [-B * s, C]])


def plain_cell(layers, omega, kx):
    """Layer after layer, from the near side on: (2, 2, F, n)."""
    m = None
    for mass, compliance, mobility in zip(layers.mass, layers.compliance, layers.mobility, strict=True):
        B = omega**2 * compliance[:, None] - kx**2 * mobility[:, None]
        layer = plain_layer(np.broadcast_to(mass[:, None], B.shape), B)
        m = layer if m is None else np.einsum("ijfn,jkfn->ikfn", layer, m)
    return m


@pytest.mark.parametrize("size", [1e-6, 1e-2, 0.3, 0.99, 5.0, 300.0])
def test_entire_functions(size):
    rng = np.random.default_rng(1)
    u = size * rng.random(200) * np.exp(2j * np.pi * rng.random(200))
    root = np.sqrt(u.astype(np.clongdouble))
    f = one.entire(u)
    np.testing.assert_allclose(np.asarray(f.c, complex), (-2 * np.sin(root / 2) ** 2).astype(complex), rtol=RTOL)
    np.testing.assert_allclose(f.s, (np.sin(root) / root).astype(complex), rtol=RTOL, atol=1e-15)


@pytest.mark.parametrize("count", [5, 300])
@pytest.mark.parametrize("seed", SEEDS)
def test_cell_matrix(seed, count):
    """Few kx go through the product of all layers, many through the polynomial."""
    rng = np.random.default_rng(seed)
    frequency = np.array([1500.0, 2500.0, 3100.0])
    layers, omega = layer_values(random_cell(rng), frequency), 2 * np.pi * frequency[:, None]
    kx = random_kx(rng, count, 3)
    m = cell_kernels.cell_matrix(layers, omega, kx)
    wanted = plain_cell(layers, omega, kx)
    assert m.growth is None
    for found, (i, j) in zip(m[1:5], ((0, 0), (0, 1), (1, 0), (1, 1)), strict=True):
        close(found, (wanted[i, j] - (i == j)).astype(complex), axis=-1)


def test_the_polynomial_serves_the_papers_cell_and_refuses_a_thick_one():
    frequency = np.array([2500.0])
    omega, kx2 = 2 * np.pi * frequency[:, None], np.linspace(0, 200, 300)[None] ** 2 + 0j
    assert cell_kernels._fitted(layer_values(bp.lmmd_cell(), frequency), omega, kx2) is not None
    assert cell_kernels._fitted(layer_values(bp.lmmd_cell(eta=0.5), frequency), omega, kx2) is None
    assert cell_kernels._fitted(layer_values(bp.lmmd_cell(), frequency), omega, 900 * kx2) is None


# --- the march and the field inside -----------------------------------------------------------------------


@pytest.mark.parametrize("size", [1e-12, 1e-5, 1e-2, 0.09])
def test_small_bloch_phases(size):
    rng = np.random.default_rng(6)
    h = size * np.sqrt(rng.random((2, 300))) * np.exp(2j * np.pi * rng.random((2, 300)))
    zero = np.zeros_like(h)
    b = cell_kernels.bloch_phase(cell_kernels.Matrix(1.0, 2 * h, zero, zero, zero, None))
    wanted = 2 * np.arcsin(np.sqrt(-h / 2))
    wanted = np.where(wanted.imag < 0, -wanted, wanted)
    np.testing.assert_allclose(b.reduced, wanted, rtol=5e-15)
    assert not b.flip.any()


@pytest.mark.parametrize("size", [1e-9, 1e-4, 0.1, 0.29, 0.31, 20.0])
def test_exponentials_near_one(size):
    rng = np.random.default_rng(7)
    z = size * np.sqrt(rng.random(500)) * np.exp(1j * np.pi * (0.5 + rng.random(500)))
    whole, less = cell_kernels._exp_and_expm1(z)
    np.testing.assert_allclose(whole, np.exp(z), rtol=1e-15 * (1 + size))
    np.testing.assert_allclose(less, np.expm1(z), rtol=2e-15)


@pytest.mark.parametrize("size", [1e-9, 0.5, 2.0, 30.0])
def test_exponentials_less_one(size):
    """To the rounding of the exponent, which is what the answer inherits."""
    rng = np.random.default_rng(8)
    z = size * np.sqrt(rng.random(500)) * np.exp(1j * np.pi * (0.5 + rng.random(500)))
    wanted = np.expm1(z)
    assert np.all(np.abs(cell_kernels._expm1(z) - wanted) <= 3e-16 * (np.abs(wanted) + (np.abs(z) >= 1)))


@pytest.mark.parametrize("count", [1, 7, 450])
@pytest.mark.parametrize("seed", SEEDS)
def test_powers_of_a_cell(seed, count):
    """The closed form as it stands in the comment."""
    rng = np.random.default_rng(seed)
    layers, omega = layer_values(random_cell(rng), np.array([2500.0])), np.array([[2 * np.pi * 2500.0]])
    kx = random_kx(rng, 70)
    m = cell_kernels.cell_matrix(layers, omega, kx)
    b = cell_kernels.bloch_phase(m)
    far = one.State(np.ones_like(kx), 20j + kx, np.zeros(kx.shape))
    lam, x2n, x2 = np.exp(1j * b.reduced), np.expm1(2j * b.reduced * count), np.expm1(2j * b.reduced)
    g, f = (lam + 1 + x2n) / (1 + lam), lam * x2n / x2
    sign = np.where(b.flip, -1, 1)
    p = g * far.p + f * (sign * (far.p + m.e22 * far.p - m.e12 * far.q) - far.p)
    q = g * far.q + f * (sign * (far.q + m.e11 * far.q - m.e21 * far.p) - far.q)
    found = cell_kernels.power_back(m, b, far, count)
    close(found.p, p, rtol=1e-12)
    close(found.q, q, rtol=1e-12)
    close(found.log, -1j * b.phase * count)


def plain_march(segments, omega, kx, state, depths):
    """States at the near face and in front of it all p at depths: one layer after another, all periods."""
    layers = [(s.layers, j) for s in segments for _ in range(s.periods) for j in range(len(s.layers.thickness))]
    stop = sum(s.periods * s.layers.thickness.sum() for s in segments)
    p = np.empty((len(depths), kx.shape[1]), complex)
    for values, j in reversed(layers):
        d = values.thickness[j]
        here = np.flatnonzero((depths <= stop) & (depths > stop - d))
        for i in here:
            part = plain_back(values, j, omega, kx, state, (stop - depths[i]) / d)
            p[i] = (part[0] * np.exp(part[2]))[0]
        state = plain_back(values, j, omega, kx, state, 1.0)
        size = np.abs(state[0]) + np.abs(state[1])
        state = (state[0] / size, state[1] / size, state[2] + np.log(size))
        stop -= d
    return state, p


def plain_back(layers, j, omega, kx, state, share):
    A = layers.mass[j][:, None] * share
    B = (omega**2 * layers.compliance[j][:, None] - kx**2 * layers.mobility[j][:, None]) * share
    (a, b), (c, d) = plain_layer(np.broadcast_to(A, B.shape), B) if share > 0 else np.eye(2)
    return d * state[0] - b * state[1], a * state[1] - c * state[0], state[2]


@pytest.mark.parametrize("at_once", [0, 2**14])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_field_inside_against_all_layers_in_turn(seed, at_once, monkeypatch):
    monkeypatch.setattr(interior, "AT_ONCE", at_once)
    rng = np.random.default_rng(seed)
    s = sampled_slab.sample(random_slab(rng), 2500.0)
    kx = random_kx(rng, 40)
    z = np.sort(s.thickness * rng.random(150))
    found = response.solve(s.segments, s.before, s.after, s.omega, kx, z)
    kz = np.sqrt(s.k0**2 - kx.astype(np.clongdouble) ** 2)
    kz = np.where(kz.imag < 0, -kz, kz)
    rho = s.after.rho_z[0]
    near, p = plain_march(s.segments, s.omega, kx, (1 + 0 * kz, 1j * kz / rho, 0 * kz.real), z)
    forward = (near[0] + near[1] * rho / (1j * kz)) / 2 * np.exp(near[2])
    clear = np.abs(kz[0]) > 1
    close(found.inside[0][:, clear], (p / forward[0])[:, clear].astype(complex), rtol=1e-9, axis=0)


@pytest.mark.parametrize("lossless", [False, True])
@pytest.mark.parametrize("seed", SEEDS)
def test_periods_by_tables_against_the_closed_form(seed, lossless):
    rng = np.random.default_rng(seed)
    cell = bp.lmmd_cell(0.05, 0.0) if lossless else bp.lmmd_cell()
    layers, omega = layer_values(cell, np.array([2500.0])), np.array([[2 * np.pi * 2500.0]])
    kx = random_kx(rng, 60)
    m = cell_kernels.cell_matrix(layers, omega, kx)
    b = cell_kernels.bloch_phase(m)
    far = one.State(1 + rng.random((1, 60)) + 0j, 30j * rng.random((1, 60)), np.zeros((1, 60)))
    # few, dense and sparse: without tables, by all products of two tables, by those that are asked for
    counts, _ = interior._counts(rng.integers(100, 100 + 10 ** rng.integers(1, 5), 400))
    two, factors = interior._in_two_terms(m, b, far, counts, np.zeros(60), np.ones(60))
    plain = cell_kernels.power_back(m, b, far, counts[:, None])
    scale = np.exp(plain.log)
    close((factors * two.p).sum(axis=1), plain.p * scale, rtol=3e-13, axis=0)
    close((factors * two.q).sum(axis=1), plain.q * scale, rtol=3e-13, axis=0)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_rest_of_a_layer_as_powers_of_the_share(seed):
    rng = np.random.default_rng(seed)
    layers, omega = layer_values(random_cell(rng), np.array([2500.0])), np.array([[2 * np.pi * 2500.0]])
    kx, share = random_kx(rng, 40), rng.random(30)
    faces = one.State(rng.random((2, 40)) + 0j, rng.random((2, 40)) * 1j, np.zeros(1))
    A, B, _ = one.one_layer(layers, 0, omega * omega, kx * kx)
    for many in (1, 30):
        found = interior._rest_of_layer(A, B, faces, many)(share)
        for i in range(2):
            face = one.State(faces.p[i : i + 1], faces.q[i : i + 1], faces.log)
            wanted = [plain_back(layers, 0, omega, kx, face, part)[0][0] for part in share]
            close(found[:, i], np.array(wanted).astype(complex))


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
    face = one.State(p, 1j * w[0] / A * p * (1 + 0.1 * rng.random(30)), np.zeros(30))  # nearly outgoing
    assert interior._steady(w * w) is not None
    found = interior._two_waves(interior._steady(w * w), np.array([[A]]), face, np.ones(30), share)
    v = w.astype(np.clongdouble) * share[:, None]
    close(found, np.cos(v) * face.p - A * share[:, None] * np.sin(v) / v * face.q, axis=0)


def test_layers_with_two_waves_that_cannot_be_told_or_overflow_are_left_to_others():
    assert interior._steady(np.array([[1.0 + 0j, 1e-4]])) is None
    assert interior._steady(np.array([[1.0 + 0j, -(400.0**2)]])) is None


@pytest.mark.parametrize("seed", SEEDS)
def test_layers_in_blocks_against_one_by_one(seed):
    rng = np.random.default_rng(seed)
    thick = [bp.Layer(bp.Fluid(1 + rng.random(), 1e5), 10 ** rng.uniform(-4, -0.3)) for _ in range(40)]
    layers, omega = layer_values(bp.Cell(tuple(thick)), np.array([2500.0])), np.array([[2 * np.pi * 2500.0]])
    kx = random_kx(rng, 30)
    state = one.State(np.ones_like(kx), 20j + 0 * kx, np.zeros(kx.shape))
    found, faces = recursion._through_layers(layers, omega, kx, state, {3, 17})
    for j in reversed(range(40)):
        if j in faces:
            close(faces[j].p / faces[j].q, state.p / state.q, rtol=1e-9)
        state = one.layer_back(state, *one.one_layer(layers, j, omega**2, kx**2))
        state = one.normalised(state)
    assert set(faces) == {3, 17}
    np.testing.assert_allclose(found.log, state.log, rtol=1e-12, atol=1e-12)
    close(found.p, state.p, rtol=1e-11)


# --- sums -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(1, 3, 2), (7, 146, 72), (300, 20, 500), (4, 7, 20_000), (40, 3000, 30)])
def test_products_in_pieces(shape):
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=shape[:2]) + 1j, rng.normal(size=shape[1:]) - 2j
    close(matmul.small_product(a, b), a @ b)
    close(matmul.product(a, b), a @ b)
    close(matmul.small_product(a.real, b), a.real @ b)


def random_sum(rng):
    n = int(rng.choice([8, 30, 64, 144, 400]))
    size, first = int(rng.integers(1, 3 * n)), -int(rng.integers(0, 40))
    dx = 0.01
    step = 2 * np.pi / (n * dx)
    k = step * (first + np.arange(size)) - 0.7j
    x = rng.uniform(-1, 0) + dx * np.arange(rng.integers(1, n + 1))
    line = paths.Contour(k, np.ones(size), step, first, 0.7, 1.0)
    h, right, left = (
        rng.normal(size=s) + 1j * rng.normal(size=s) for s in ((int(rng.integers(1, 90)), size), size, size)
    )
    return line, h, right, left * rng.integers(0, 2), x, n


def plain_sum(line, h, right, left, x):
    phase = np.exp(1j * np.multiply.outer(line.k, x))
    return h @ (right[:, None] * phase + left[:, None] / phase)


@pytest.mark.parametrize("seed", range(40))
def test_sums_over_a_line(seed):
    rng = np.random.default_rng(seed)
    line, h, right, left, x, n = random_sum(rng)
    wanted = plain_sum(line, h, right, left, x)
    scale = math.sqrt(line.k.size) * np.abs(h).max() * np.exp(0.7)
    phases = np.abs(line.k).max() * np.abs(x).max()  # whose rounding no order of sums avoids
    assert np.abs(paths.fft_sum(line, h, right, left, x, n) - wanted).max() < (RTOL + 4e-16 * phases) * scale
    assert np.abs(paths.direct_sum(line, h, right, left, x) - wanted).max() < (RTOL + 4e-16 * phases) * scale


@pytest.mark.parametrize("seed", SEEDS)
def test_many_beams_at_once(seed):
    rng = np.random.default_rng(seed)
    line, h, right, left, x, n = random_sum(rng)
    rights, lefts = np.stack([right, 2j * right, right * right]), np.stack([left, left * 0, 3 * left])
    each = zip(rights, lefts, strict=True)
    wanted = np.stack([paths.direct_sum(line, h, a, b, x) for a, b in each])
    close(paths.direct_sum(line, h, rights, lefts, x), wanted, rtol=1e-11)
    close(paths.fft_sum(line, h, rights, lefts, x, n), wanted, rtol=1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_straight_contour(seed):
    """chi = erfc(-k/delta)/2 at every node, for one frequency and for several."""
    from scipy.special import erfc

    rng = np.random.default_rng(seed)
    sigma, delta, window, band = rng.uniform(0.1, 15, 3), rng.uniform(1, 15, 3), rng.uniform(1, 5, 3), np.full(3, 150.0)
    plans = [paths.StraightPlan(*(float(v[i]) for v in (sigma, delta, window, band))) for i in range(3)]
    for plan in (paths.StraightPlan(sigma, delta, window, band), *plans):
        line = paths.straight_contour(plan)
        d, w = (np.asarray(v)[..., None] for v in (plan.delta, plan.window))
        np.testing.assert_allclose(line.weight, erfc(-line.k / d) / 2 / w, rtol=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_plan_has_come_to_rest(seed):
    """The same numbers as after all 30 rounds."""
    rng = np.random.default_rng(seed)
    k, extent, source, path = (rng.uniform(*ends, 4) for ends in ((20, 80), (0.2, 3), (0.1, 0.5), (0.0, 5)))
    branch, rtol = k * rng.uniform(0.2, 1, 4), 10 ** rng.uniform(-11, -2)
    found = paths.plan_straight(paths.Extent(k, branch, 3 * k, extent, source, path), rtol)
    decades, rounding = math.log(20 / rtol), max(2.0, math.log(rtol / (100 * paths.EPS)))
    Z, X = np.maximum(path, 1e-3 / k), np.maximum(extent, source)
    delta, sigma, window = branch / math.sqrt(decades), rounding / (X + 30 / k), X
    for _ in range(30):
        guard = np.sqrt(4 / delta**2 + (Z * delta / k) ** 2) * np.sqrt(sigma * window + decades)
        window = np.maximum(X + source + guard, decades / sigma)
        sigma = np.minimum(np.minimum(decades / window, rounding / X), 3.0 * k / (Z * delta))
        delta = np.minimum(branch / np.sqrt(decades + Z * np.sqrt(branch * sigma)), np.sqrt(2 * k / Z))
    for got, want in zip(found[:3], (sigma, delta, np.maximum(window, decades / sigma)), strict=True):
        close(got, want)


def test_fast_lengths():
    lengths = sorted(2**a * 3**b * 5**c for a in range(13) for b in range(9) for c in range(6))
    for n in (1, 2, 7, 11, 97, 1025, 1331, 2049, 4000):
        assert fft.next_smooth(n) == min(m for m in lengths if m >= n)
        assert n <= fft.fast_length(n) <= max(1.125 * n, fft.next_smooth(n))
    assert [fft.fast_length(n) for n in (1, 2, 5, 1020, 1100, 1199, 1300, 1440)] == [
        1,
        2,
        5,
        1024,
        1125,
        1280,
        1350,
        1440,
    ]


# --- widths -----------------------------------------------------------------------------------------------


def random_modes(rng):
    """Amplitudes on even lines, the same m for three frequencies."""
    ds, sigma, first = rng.uniform(1, 3, 3), rng.uniform(0, 2, 3), -int(rng.integers(0, 20))
    n = int(rng.integers(1, 60))
    k = ds[:, None] * (first + np.arange(n)) - 1j * sigma[:, None]
    right, left = (rng.normal(size=k.shape) + 1j * rng.normal(size=k.shape) for _ in range(2))
    return many_frequencies.PlaneWaves(paths.Contour(k, np.ones(k.shape), ds, first, sigma), right, left)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_profile_at_any_position(seed):
    """By tables of exponentials, and by the sum over plane waves."""
    rng = np.random.default_rng(seed)
    plane_waves, x = random_modes(rng), rng.uniform(-1, 1, (3, 4))
    k = plane_waves.contour.k[:, None]
    right = plane_waves.right[:, None] * np.exp(1j * k * x[..., None])
    left = plane_waves.left[:, None] * np.exp(-1j * k * x[..., None])
    close(plane_waves.evaluator()(x), (right + left).sum(-1))


# --- many angles ------------------------------------------------------------------------------------------

PROFILE_X = np.linspace(-0.2, 0.2, 200)
SOURCES = {
    "gaussian": bp.GaussianBeam(0.096, x0=0.3, z0=-0.1),
    "wide": bp.GaussianBeam(3.0),
    "slits": bp.Slits(0.02, 0.05, 3, z0=-0.02),
    "profile": bp.Profile(PROFILE_X, np.exp(-((PROFILE_X / 0.03) ** 2)) * (1 + 0.3j * np.sin(50 * PROFILE_X))),
    "coarse profile": bp.Profile(PROFILE_X[::5], np.exp(-((PROFILE_X[::5] / 0.1) ** 2)), z0=-0.2),
    "rotated": bp.GaussianBeam(0.096, form="rotated"),
}


@pytest.mark.parametrize("name", SOURCES)
def test_spectra_of_many_angles_are_those_of_each(name):
    beam, rng = SOURCES[name], np.random.default_rng(3)
    angles, kx = rng.uniform(-89, 89, 7), rng.uniform(-300, 300, 50) - 3j * rng.random(50)
    wanted = np.stack([beam.at_angle(float(a)).spectrum(kx, 45.0) for a in angles])
    close(source_angles.AngleInterpolation(beam, angles).spectra(kx, 45.0), wanted, rtol=1e-11)


@pytest.mark.parametrize("name", SOURCES)
def test_many_angles_are_mixed_from_a_few(name):
    """A fan's spectra are, to the tolerance, the mixture of those at its nodes: at the ends and between."""
    beam, rng, k0 = SOURCES[name], np.random.default_rng(4), 45.0
    angles = np.concatenate([[-89.9, 89.9, 0.0], rng.uniform(-89.9, 89.9, 150)])
    found = source_angles.interpolate_angles(beam, angles, k0, 1e-12)
    assert (found.weights is None) == (name in ("wide", "rotated", "coarse profile"))
    kx = np.linspace(-100, 100, 41) + 0j
    wanted = np.stack([beam.at_angle(float(a)).spectrum(kx, k0) for a in angles])
    close(found.interpolated_to(found.spectra(kx, k0)), wanted, rtol=3e-12 * angles.size)


@pytest.mark.parametrize("x", [[0.1], np.linspace(-1, 1, 101)])
def test_many_angles_at_one_position_and_plane(x):
    """What is summed there need not lie in one piece: one plane, one position."""
    slab, angles = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), np.linspace(-60, 60, 50)
    many = bp.field(slab, bp.GaussianBeam(0.096), 2500.0, x, 0.1, angle=angles)
    one = bp.field(slab, bp.GaussianBeam(0.096, angles[7]), 2500.0, x, 0.1)
    assert np.abs(many.p[7].values - one.p.values).max() < 1e-8


@pytest.mark.parametrize("count", [65, 200])
def test_errors_of_many_angles_are_judged_by_some(count, monkeypatch):
    """No angle has a smaller error estimate than it has alone among all, but for the worse of its neighbours."""
    slab, beam = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), bp.GaussianBeam(0.096)
    x, z, angles = (
        np.linspace(-1, 1, 51),
        slab.thickness,
        np.linspace(-85, 85, count)[np.random.default_rng(0).permutation(count)],
    )
    some = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    monkeypatch.setattr(error_estimate, "ESTIMATED", 1000)
    all_of_them = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    np.testing.assert_array_equal(some.p, all_of_them.p)
    assert np.all(some.error_estimate > 0.5 * all_of_them.error_estimate)


def test_the_field_at_many_angles_is_that_of_each():
    slab, beam = bp.Slab(bp.lmmd_cell(0.05, 0.0), 60), bp.GaussianBeam(0.096)
    x, z, angles = np.linspace(-1, 1, 101), [0.0, 0.05, slab.thickness], np.linspace(-85, 85, 90)
    many = bp.field(slab, beam, 2500.0, x, z, angle=angles)
    for i in (0, 1, 44, 89):
        one = bp.field(slab, beam, 2500.0, x, z, angle=angles[i])
        apart = np.abs(one.p - many.p[i].drop_vars("angle")).max("x") / np.abs(one.p).max("x")
        assert apart.max() <= one.error_estimate + many.error_estimate[i].drop_vars("angle")


# --- many planes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rank", [1, 5, 17])
def test_rows_of_low_rank_follow_from_a_few(rank):
    """Singular values that fall by five a step, rows of very different size: as many rows as the tolerance asks."""
    rng = np.random.default_rng(rank)

    def unitary(n):
        return np.linalg.qr(rng.normal(size=(n, rank)) + 1j * rng.normal(size=(n, rank)))[0]

    h = (unitary(300) * 5.0 ** -np.arange(rank)) @ unitary(80).T
    h *= np.exp(rng.uniform(-200, 200, (300, 1)))
    size = np.linalg.norm(h, axis=1, keepdims=True)
    rows, columns, pivots = low_rank.cross(h / size, 1e-14, 40)
    assert rows.size <= rank + 1
    assert np.all(np.diff(pivots) < 1e-12)
    mix = low_rank.mixing(h[:, columns], h[rows][:, columns])
    np.testing.assert_allclose((mix @ (h[rows] / size[rows] * size[rows]) - h) / size, 0, atol=1e-12)
    assert low_rank.cross(h / size, 1e-14, rank - 1).rows.size == rank - 1


WATER = bp.Fluid.from_speed(1000.0, 1480.0)
MANY_PLANES = {
    "lossy": (bp.Slab(bp.lmmd_cell(), 450), 45.0, 0.0),
    "lossless": (bp.Slab(bp.lmmd_cell(0.05, 0.0), 450), 85.0, -0.1),
    "air": (bp.Slab.uniform(bp.AIR, 1.0), 30.0, 0.0),
    "water behind": (bp.Slab(bp.lmmd_cell(), 100, after=WATER), 20.0, -0.05),
    "stack": (
        bp.Slab(bp.lmmd_cell(), 60) + bp.Slab.uniform(bp.Fluid(3.0, 2e5), 0.2) + bp.Slab(bp.lmmd_cell(0.3, 0.0), 40),
        10.0,
        0.0,
    ),
    "opaque": (bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 2000), 0.0, 0.0),
    "backward": (bp.Slab.uniform(bp.Fluid(1.25 * -0.6, bp.AIR.bulk_modulus), 0.01), 45.0, -0.01),
}


@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-10])
@pytest.mark.parametrize("name", MANY_PLANES)
def test_many_planes_are_made_of_a_few(name, rtol, monkeypatch):
    """In front, inside and behind, the map is the one of every plane by itself, within what its error estimate gained."""
    slab, angle, z0 = MANY_PLANES[name]
    beam = bp.GaussianBeam(0.096, angle, z0=z0)
    x, z = np.linspace(-1.2, 1.2, 200), np.linspace(z0, slab.thickness + 0.3, 500)
    few = bp.field(slab, beam, 2500.0, x, z, rtol=rtol)
    monkeypatch.setattr(evaluate, "MANY_PLANES", 10**9)
    alone = bp.field(slab, beam, 2500.0, x, z, rtol=rtol)
    apart = np.abs(few.p - alone.p).max("x") / np.abs(alone.p).max("x")
    assert apart.max() <= 0.1 * rtol
    assert few.error_estimate <= max(rtol, float(alone.error_estimate) * 1.1)


@pytest.mark.parametrize("name", ["lossy", "air", "water behind"])
def test_a_map_sums_few_of_its_planes(name, monkeypatch):
    """That it is worth it: less than a fifth of the planes are summed, and their order does not matter."""
    slab, angle, z0 = MANY_PLANES[name]
    beam = bp.GaussianBeam(0.096, angle, z0=z0)
    x, z = np.linspace(-1.2, 1.2, 200), np.linspace(z0, slab.thickness + 0.3, 600)
    count, fill = [], evaluate.fill

    def watched(s, beams, solution, h, *rest):
        count.append(h.shape[0])
        return fill(s, beams, solution, h, *rest)

    monkeypatch.setattr(evaluate, "fill", watched)
    ordered = bp.field(slab, beam, 2500.0, x, z)
    assert sum(count) < 120
    shuffled = np.random.default_rng(0).permutation(z.size)
    other = bp.field(slab, beam, 2500.0, x, z[shuffled])
    apart = np.abs(other.p.values - ordered.p.values[shuffled]).max(axis=1) / np.abs(ordered.p.values[shuffled]).max(
        axis=1
    )
    assert apart.max() < 3e-9


def test_planes_made_of_others_never_bring_an_error_above_rtol(monkeypatch):
    """A line that leaves no room for them: every plane by itself, and no warning."""
    slab, beam = MANY_PLANES["lossy"][0], bp.GaussianBeam(0.096)
    x, z = np.linspace(-1.2, 1.2, 100), np.linspace(0, slab.thickness, 300)
    choose = contour_choice.choose_contour
    monkeypatch.setattr(
        contour_choice, "choose_contour", lambda *given: choose(*given)._replace(error=np.array([0.9999e-8]))
    )
    assert bp.field(slab, beam, 2500.0, x, z).error_estimate <= 1e-8


def test_the_end_of_a_path_is_not_that_of_its_circles():
    """What lies beyond a band is judged by the path's last nodes, however strong the nodes around single modes are."""
    k = np.linspace(1, 50, 60).astype(complex)
    line = paths.Contour(k, np.ones(60))
    with_discs = paths.Contour(np.concatenate([np.full(400, 5.0 + 0j), k]), np.ones(460), circles=400)
    right = np.exp(-k / 2)[None]
    strong = np.concatenate([np.full((1, 400), 1e9 + 0j), right], axis=1)
    alone = error_estimate._beyond(error_estimate.Sampled(line, np.ones((1, 60)), (right, right)), right, right)
    beside = error_estimate._beyond(
        error_estimate.Sampled(with_discs, np.ones((1, 460)), (strong, strong)), strong, strong
    )
    np.testing.assert_allclose(beside, alone, rtol=1e-12)
    assert alone > 0


def test_planes_that_do_not_follow_are_summed_themselves(monkeypatch):
    """Where the few planes do not serve, the answer is that of every plane by itself."""
    slab, beam = MANY_PLANES["lossy"][0], bp.GaussianBeam(0.096)
    x, z = np.linspace(-1.2, 1.2, 100), np.linspace(0, slab.thickness, 300)
    right = low_rank.mixing
    monkeypatch.setattr(evaluate, "mixing", lambda *given: right(*given) * (1 + 1e-6))
    spoiled = bp.field(slab, beam, 2500.0, x, z)
    monkeypatch.setattr(evaluate, "MANY_PLANES", 10**9)
    np.testing.assert_array_equal(spoiled.p, bp.field(slab, beam, 2500.0, x, z).p)
