"""Counts of modes where they crowd and where a slab turns fast: whole turns between two points of a path are not lost."""

import itertools

import numpy as np
import pytest

import beamprop as bp
from beamprop.modes import argument_principle, guided
from beamprop.response.sampled_slab import sample

STEEL = bp.Fluid.from_speed(7800.0, 5900.0)  # as fluids: density and speed of longitudinal waves
WATER = bp.Fluid.from_speed(1000.0, 1480.0)


def polynomial(zeros, turns):
    """exp(i turns k) prod(k - z), as (value, logarithm): it turns fast along a path, and around none of its own."""

    def f(k):
        k = np.asarray(k, complex)
        log = 1j * turns * k + np.log(k[..., None] - zeros).sum(-1)
        return np.ones(k.shape, complex), log

    return f


@pytest.mark.parametrize("turns", [0.0, 40.0, -300.0])
@pytest.mark.parametrize("beside", [1e-2, 1e-6])
def test_seventy_five_zeros_beside_a_path(turns, beside):
    """On a line just inside of the path, or just outside, evenly or crowding towards the end of a band."""
    box = argument_principle.Box(1.0, 9.0, -0.5, 0.5)
    for band in (3.0 + 4.0 * np.arange(75) / 75, 5.0 - 2.0 * np.cos(np.pi * (np.arange(75) + 0.5) / 75)):
        for count, height in ((75, 0.5 - beside), (0, 0.5 + beside)):
            f = polynomial(band + 1j * height, turns)
            for nodes in (24, 61):
                assert argument_principle.winding(f, box.outline(nodes), 1e-12) == count


@pytest.mark.parametrize("seed", range(30))
def test_random_crowds_in_a_fast_function(seed):
    """Up to 200 zeros in clusters of any width; the thorough count and the quick one."""
    rng = np.random.default_rng(seed)
    zeros = np.concatenate(
        [
            complex(rng.uniform(0, 10), rng.uniform(-1, 1)) + 10 ** rng.uniform(-6, 0) * rng.normal(size=n) * (1 + 0.1j)
            for n in rng.integers(1, 40, 6)
        ]
    )
    box = argument_principle.Box(2.0, 8.0, -0.4, 0.6)
    inside = sum(box.holds(z, 0.0) for z in zeros)
    f = polynomial(zeros, rng.uniform(-2000, 2000))
    assert argument_principle.winding(f, box.outline(48), 1e-12, thorough=True) == inside
    assert argument_principle.winding(f, box.outline(48), 1e-12) == inside


@pytest.mark.parametrize(
    ("frequency", "highest"), [(8000.0, 20), (9500.0, 20), (13_000.0, 20), (14_000.0, 20), (30_000.0, 10)]
)
def test_the_lossless_modulated_slab_at_high_frequencies(frequency, highest):
    """All modes that are counted are found, each once, and parts of the strip hold as many together."""
    slab = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0.0), 450)
    ds = bp.guided_modes(slab, frequency, kx_over_k0_max=highest)
    assert ds["count"] == ds.sizes["mode"]
    kx = ds.kx.values
    assert np.all(np.abs(kx[:, None] - kx)[~np.eye(kx.size, dtype=bool)] > 1e-6)
    assert np.all(ds.residual < 1e-10)
    s = sample(slab, frequency)
    edges = np.linspace(s.last_branch * (1 + guided.BESIDE), highest * s.k0, 12)
    parts = [argument_principle.Box(a, b, -0.5 * s.k0, 0.5 * s.k0) for a, b in itertools.pairwise(edges)]
    f = guided.dispersion_of(s)
    assert sum(argument_principle.winding(f, part.outline(200), 1e-9 * highest * s.k0) for part in parts) == kx.size


@pytest.mark.parametrize("loss", [0.0, 1e-4])
@pytest.mark.parametrize(
    ("thickness", "frequency", "bands"), [(1e-3, 2e5, 1), (1e-3, 7e5, 1), (2e-3, 5e5, 1), (5e-4, 5e5, 2)]
)
def test_a_lattice_of_seventy_five_layers_of_water_in_steel(thickness, frequency, bands, loss):
    """Each layer of water guides; together they make bands of 75 modes beside the axis."""
    steel = bp.Fluid(STEEL.density * (1 + 1j * loss), STEEL.bulk_modulus)
    water = 2e-3 if thickness < 1e-3 else 1e-3
    cell = bp.Cell((bp.Layer(steel, thickness), bp.Layer(WATER, water)))
    ds = bp.guided_modes(bp.Slab(cell, 75, STEEL, STEEL), frequency, kx_over_k0_max=6)
    assert ds["count"] == ds.sizes["mode"] == 75 * bands
    assert np.all(ds.direction == 1)
    assert np.all(np.diff(np.sort(ds.kx.values.real)) > 1e-3)
    assert ds.error_estimate.max() < 1e-12


def test_counts_that_differ_are_refused(monkeypatch):
    """Two outlines that disagree, or more changes of sign than modes: never a list that may lack some."""
    slab = bp.Slab.uniform(bp.Fluid(1.25 * 3, bp.AIR.bulk_modulus), 0.3)
    real = guided.winding
    with monkeypatch.context() as m:
        m.setattr(guided, "winding", lambda f, path, *a, **k: real(f, path, *a, **k) + (path.size > 150))
        with pytest.raises(ValueError, match=r"kx_over_k0_max: expected a strip in which modes can be counted, got"):
            bp.guided_modes(slab, 2500.0)
    with monkeypatch.context() as m:
        m.setattr(guided, "winding", lambda *a, **k: 1)
        with pytest.raises(ValueError, match=r"got 1, 1 and no fewer than \d modes at 2500"):
            bp.guided_modes(slab, 2500.0)


def test_a_zero_that_leaves_its_interval_is_not_taken_twice(monkeypatch):
    """Newton's method may run to a neighbour: the zero of an interval lies in it."""

    def f(k):
        return np.sin(k), np.zeros(k.shape)

    want = np.pi * np.arange(1, 7)
    np.testing.assert_allclose(np.real(argument_principle.real_zeros(f, 0.5, 21.0, 40)), want, rtol=1e-12)
    monkeypatch.setattr(argument_principle, "refine", lambda f, k, reach: (complex(np.pi), 0.0))
    assert len(argument_principle.real_zeros(f, 0.5, 21.0, 40)) == 1
