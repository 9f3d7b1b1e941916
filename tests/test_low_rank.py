"""Maps of many planes, summed on a few of them: the map is that of every plane by itself."""

import numpy as np
import pytest

import beamprop as bp
from beamprop.contour import choose as contour_choice
from beamprop.contour import error as contour_error
from beamprop.fields import evaluate, low_rank

#: Planes that skip through cells, as users' may.
pytestmark = pytest.mark.filterwarnings("ignore:z. steps of:beamprop.HintWarning")


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
    mix = low_rank.row_weights(h[:, columns], h[rows][:, columns])
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

    def watched(waves, h, out):
        count.append(h.shape[0])
        return fill(waves, h, out)

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
        contour_choice,
        "choose_contour",
        lambda *given: choose(*given)._replace(
            budget=contour_error.uniform_budget(1, 0.9999e-8 / len(contour_error.ErrorBudget._fields))
        ),
    )
    assert bp.field(slab, beam, 2500.0, x, z).error_estimate <= 1e-8


def test_planes_that_do_not_follow_are_summed_themselves(monkeypatch):
    """Where the few planes do not serve, the answer is that of every plane by itself."""
    slab, beam = MANY_PLANES["lossy"][0], bp.GaussianBeam(0.096)
    x, z = np.linspace(-1.2, 1.2, 100), np.linspace(0, slab.thickness, 300)
    right = low_rank.row_weights
    monkeypatch.setattr(evaluate, "row_weights", lambda *given: right(*given) * (1 + 1e-6))
    spoiled = bp.field(slab, beam, 2500.0, x, z)
    monkeypatch.setattr(evaluate, "MANY_PLANES", 10**9)
    np.testing.assert_array_equal(spoiled.p, bp.field(slab, beam, 2500.0, x, z).p)
