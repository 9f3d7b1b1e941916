"""What rounding leaves of plane-wave answers, against 50 digits and more: right where it can be known, told where it cannot."""

import warnings

import numpy as np
import oracles
import pytest

import beamprop as bp
from beamprop.media.values import materials, slab_values
from beamprop.response import solve, solve_checked
from beamprop.response.reflection import Stack, reflect

F = 2500.0
LAMBDA = 343 / F
K0 = 2 * np.pi / LAMBDA
RHO, BULK = 1.25, 1.25 * 343.0**2
AIR = (RHO, BULK)


def slab_of(layers, periods=1):
    return bp.Slab(bp.Cell(tuple(bp.Layer(bp.Fluid(rho, K), d) for rho, K, d in layers)), periods)


def lens(delta):
    return [(-RHO * (1 - 1j * delta), -BULK * (1 + 1j * delta), LAMBDA / 5)]


# --- the perfect lens and its like ------------------------------------------------------------------------


@pytest.mark.parametrize("delta", [0.0, 1e-12, 1e-8, 1e-6, 1e-4])
def test_a_perfect_lens_at_evanescent_waves(delta):
    """It makes evanescent waves grow as far as delta lets it: r and t to nearly all digits, and nothing to warn of."""
    kx = K0 * np.array([0.3, 0.9, 1.5, 3, 5, 8, 12, 16, 20])
    ds = bp.scattering(slab_of(lens(delta)), F, kx=kx)
    for i, k in enumerate(kx):
        r, t = oracles.slab_response(lens(delta), 1, AIR, AIR, F, k)
        t_error, r_error = abs(complex(ds.t.values[i] / t - 1)), abs(complex(ds.r.values[i] - r)) / max(1, abs(r))
        assert t_error < 1e-12
        assert r_error < 1e-12
        assert t_error < 3 * ds.t_error_estimate.values[i]
        assert r_error < 3 * ds.r_error_estimate.values[i]
    assert ds.error_estimate.max() < 1e-11


@pytest.mark.parametrize(
    ("layers", "periods"),
    [
        ([*lens(1e-09), (RHO, BULK, LAMBDA / 5)], 4),  # lenses in turn
        ([*lens(0.0), (2 * RHO, BULK, LAMBDA / 9), *lens(1e-05)], 1),
        ([(-RHO, -BULK, LAMBDA / 500)], 100),  # a lens of a hundred thin layers
        ([(-RHO * (1 + 1e-9), -BULK, LAMBDA / 500), (-RHO, -BULK * (1 + 1e-10), LAMBDA / 300)], 60),
        ([(-RHO * (1 - 1e-5j), BULK, LAMBDA / 4), (-RHO, -BULK, LAMBDA / 6)], 3),  # an opaque mirror at a lens
    ],
)
def test_stacks_of_lenses(layers, periods):
    kx = K0 * np.array([1.3, 2.6, 5.5, 9.7])
    ds = bp.scattering(slab_of(layers, periods), F, kx=kx)
    for i, k in enumerate(kx):
        _, t = oracles.slab_response(layers, periods, AIR, AIR, F, k, digits=90)
        assert abs(complex(ds.t.values[i] / t - 1)) < 1e-10


# --- the estimate -----------------------------------------------------------------------------------------


def random_fluid(rng, near):
    """Of air's values but for 1e-14 to 1e-1, or anything; negative or not; lossless or not."""
    loss = rng.choice([0.0, 0.0, 10.0 ** rng.uniform(-12, -1)])
    if near:
        off = 10.0 ** rng.uniform(-14, -1) * rng.choice([-1, 1])
        rho, K = RHO * (1 + off * rng.integers(2)), BULK * (1 + off * rng.integers(2))
        signs = 2 * [rng.choice([-1, -1, 1])]
    else:
        rho, K = RHO * 10 ** rng.uniform(-1, 2), BULK * 10 ** rng.uniform(-1, 1)
        signs = rng.choice([-1, 1], 2)
    return signs[0] * rho + 1j * loss * rho, signs[1] * K - 1j * loss * K


def random_layers(rng, most, near, low, high):
    return [
        (*random_fluid(rng, near or rng.random() < 0.5), LAMBDA * 10 ** rng.uniform(low, high))
        for _ in range(rng.integers(1, most))
    ]


def random_case(rng, kind):
    """Layers, periods and kx."""
    kx = K0 * (rng.random() if rng.random() < 0.4 else 10 ** rng.uniform(0, 1.3))
    if kind == "lens":
        return random_layers(rng, 4, True, -2, 0), 1, kx
    if kind == "stack":
        return random_layers(rng, 6, False, -2, 0.3), 1, kx
    if kind == "mirror":
        return random_layers(rng, 4, False, -1, 0.5), int(rng.integers(1, 12)), kx
    if kind == "thin":
        return random_layers(rng, 4, True, -3, -1), int(10 ** rng.uniform(0, 1.7)), kx
    if kind == "cell":
        mean = rng.choice([0.05, -1.0, 1.0, 0.3]) + 1j * rng.choice([0, 10.0 ** rng.uniform(-8, -1)])
        rho = RHO * (mean + 10 * np.cos(2 * np.pi * np.arange(6) / 6))
        return [(complex(v), BULK, LAMBDA / 360) for v in rho], int(rng.integers(2, 450)), kx
    # a resonance: air between quarter-wave mirrors 3000 times as hard, at resonance and beside it
    gap = LAMBDA / 2 * (1 + rng.choice([0.0, 10.0 ** rng.uniform(-12, -2)]))
    wall = (800 * RHO, 15_000 * BULK, np.sqrt(15_000 / 800) * LAMBDA / 4)
    return [wall, (RHO, BULK, gap), wall], 1, K0 * rng.choice([0.0, 10.0 ** rng.uniform(-8, -1)])


KINDS = ["lens", "stack", "mirror", "thin", "cell", "resonance"]


@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_estimated(kind):
    """Never below a third of the true error in 400 random stacks of a kind, and not 100 times above it in the median."""
    rng = np.random.default_rng(KINDS.index(kind))
    ratios = []
    for _ in range(400):
        layers, periods, kx = random_case(rng, kind)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", bp.AccuracyWarning)
            ds = bp.scattering(slab_of(layers, periods), F, kx=kx)
        r, t = oracles.slab_response(layers, periods, AIR, AIR, F, kx, digits=40)
        size = max(abs(t), abs(ds.t.item()), 1e-290)
        true = {"r": float(abs(ds.r.item() - r) / max(1, abs(r))), "t": float(abs(ds.t.item() - t) / size)}
        for name, error in true.items():
            estimate = float(ds[f"{name}_error_estimate"])
            assert estimate >= error / 3, (name, error, estimate, layers, periods, kx)
            ratios.append(estimate / max(error, 2e-16))
        assert ds.error_estimate == max(ds.r_error_estimate.item(), ds.t_error_estimate.item())
    assert np.median(ratios) < 100


def test_what_cannot_be_known_is_told():
    """A resonance so sharp that the last bits of the thickness move it: a warning, with the number and the place."""
    wall = (1e6 * RHO, 1e6 * BULK, LAMBDA / 4)
    layers = [wall, (RHO, BULK, LAMBDA / 2), wall]
    with pytest.warns(
        bp.AccuracyWarning, match=r"estimated error .* at 2500 Hz, kx 0, and above 1e-06 at 1 of 2 places"
    ):
        ds = bp.scattering(slab_of(layers), F, kx=[0.0, 0.5 * K0])
    _, t = oracles.slab_response(layers, 1, AIR, AIR, F, 0.0)
    assert float(abs(ds.t.values[0] / t - 1)) < 3 * ds.t_error_estimate.values[0]
    assert ds.error_estimate.values[1] < 1e-9


def test_plain_questions_are_not_warned_of():
    """Grazing incidence, the ambient itself, walls and the paper's slab: nothing above 1e-6."""
    ratio = np.linspace(0, 5, 1001)
    for slab in (bp.Slab(bp.lmmd_cell(), 450), bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0), 450)):
        assert bp.scattering(slab, [2000.0, F, 3000.0], kx_over_k0=ratio).error_estimate.max() < 1e-7
    for fluid in (bp.AIR, bp.Fluid(0.0, BULK), bp.Fluid(RHO, BULK, density_x=np.inf)):
        ds = bp.scattering(bp.Slab.uniform(fluid, 0.1), F, angle=np.linspace(0, 90, 91))
        assert ds.error_estimate.max() < 1e-6


def test_without_an_estimate():
    """The same r and t of a plain slab, and no word of errors."""
    slab = bp.Slab(bp.lmmd_cell(), 450)
    one, two = (bp.scattering(slab, F, kx_over_k0=[0.0, 0.5, 1.0, 4.0], estimate=e) for e in (True, False))
    assert set(one.data_vars) - set(two.data_vars) == {"error_estimate", "r_error_estimate", "t_error_estimate"}
    assert one.error_estimate.dims == one.t.dims
    for name in two.data_vars:
        np.testing.assert_array_equal(one[name], two[name])
    assert "error_estimate" not in bp.bloch(slab.cell, F, kx=1.0, estimate=False)


def test_waves_and_march_agree():
    """Two forms of one response: membranes, anisotropy, rho_x infinite, stacks, many periods, other half-spaces."""
    flat = bp.Fluid(RHO * (0.6 + 0.1j), BULK, density_x=np.inf)
    leaning = bp.Fluid(-0.4 * RHO + 0.02j, BULK, density_x=3 * RHO)
    heavy = bp.Fluid.from_speed(1000.0, 1480.0)
    cells = [
        bp.Cell((bp.Membrane(0.05), bp.Layer(leaning, 0.02), bp.Membrane(0.1 + 0.01j), bp.Layer(heavy, 0.01))),
        bp.Cell((bp.Layer(flat, 0.03), bp.Layer(leaning, 0.01), bp.Membrane(-0.02))),
        bp.Cell((bp.Layer(bp.Fluid(0.3 * RHO, BULK - 200j), 0.02),)),
    ]
    slabs = [bp.Slab(cell, periods) for cell in cells for periods in (1, 3)]
    slabs += [bp.Slab.stack([(cells[1], 2), (bp.lmmd_cell(), 300), (cells[0], 1)], bp.AIR, heavy)]
    kx = K0 * np.array([0.0, 0.4, 0.93, 1.7, 4.0, 0.5 - 0.2j]) + 0j
    f = np.array([F])
    for slab in slabs:
        before, after = slab.before.at(f), slab.after.at(f)
        rows = [materials(cell, f) for cell, _ in slab.segments]
        want = solve(slab_values(slab, f), before, after, 2 * np.pi * f[:, None], kx[None])
        r, t = reflect(Stack(slab_values(slab, f), rows, before, after, 2 * np.pi * F), kx)
        np.testing.assert_allclose(r, want.r[0], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(t, want.t[0], rtol=1e-9)
        checked = solve_checked(slab_values(slab, f), rows, before, after, 2 * np.pi * f[:, None], kx[None])
        np.testing.assert_allclose(checked.t, want.t, rtol=1e-9)


# --- other plane-wave questions ---------------------------------------------------------------------------


def test_errors_of_bloch_waves():
    """kz of random cells, at band edges too, where it is a square root: estimates against 60 digits."""
    rng = np.random.default_rng(7)
    ratios = []
    for i in range(300):
        layers = random_layers(rng, 5, False, -2, -0.3)
        kx = K0 * 3 * rng.random()
        if i % 3 == 0:  # move kx to where the trace is 2 or -2: a band edge
            grid = np.linspace(0, 3 * K0, 400)
            half = np.array([complex(oracles.bloch_phase(layers, F, k, digits=20)) for k in grid[::20]])
            near = np.flatnonzero(np.diff((np.abs(half.imag) > 1e-9).astype(int)))
            if near.size:
                low, high = grid[::20][near[0]], grid[::20][near[0] + 1]
                stop = abs(half[near[0]].imag) > 1e-9
                for _ in range(45):
                    kx = (low + high) / 2
                    inside = abs(complex(oracles.bloch_phase(layers, F, kx, digits=40)).imag) > 1e-12
                    low, high = (kx, high) if inside == stop else (low, kx)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", bp.AccuracyWarning)
            ds = bp.bloch(slab_of(layers).cell, F, kx=kx)
        thickness = sum(d for _, _, d in layers)
        want = complex(oracles.bloch_phase(layers, F, kx))
        got = ds.kz.item() * thickness
        apart = min(abs(one - 2 * np.pi * np.rint(one.real / (2 * np.pi))) for one in (got - want, got + want))
        error = apart / thickness / max(abs(ds.kz.item()), K0)
        assert ds.error_estimate >= error / 3
        ratios.append(float(ds.error_estimate) / max(error, 2e-16))
    assert np.median(ratios) < 100


def test_errors_of_guided_modes():
    """Modes of a dense slab against the textbook's equation in 50 digits; the estimate is not below a third of the error."""
    import mpmath as mp

    thickness, density = 0.31, 3.0
    ds = bp.guided_modes(bp.Slab.uniform(bp.Fluid(RHO * density, BULK), thickness), F, kx_over_k0_max=5)
    w, c2 = mp.mpf(2 * np.pi * F), mp.mpf(BULK) / mp.mpf(RHO)
    with mp.workdps(50):

        def equation(k):
            kz, kappa = mp.sqrt(density * w**2 / c2 - k**2), mp.sqrt(k**2 - w**2 / c2)
            phase = kz * mp.mpf(thickness)
            return (kz**2 - (density * kappa) ** 2) * mp.sin(phase) - 2 * kz * density * kappa * mp.cos(phase)

        for k, estimate in zip(ds.kx.values, ds.error_estimate.values, strict=True):
            exact = mp.findroot(equation, mp.mpf(k.real))
            assert abs(k - complex(exact)) / abs(k) < 3 * estimate
    assert ds.error_estimate.max() < 1e-12
    assert ds.sizes["mode"] >= 3
