"""Modes of slabs that layers of density 0, soft walls, divide: each part's own dispersion relation, on paper."""

import numpy as np
import pytest
import sided
from answers import slab_of
from scipy.optimize import brentq
from sided import AIR, BULK, K0, LAM, OMEGA, RHO, F

import beamprop as bp

SLOW, MIDDLE = (2 * RHO, 2 * RHO * 150.0**2), (1.5 * RHO, 1.5 * RHO * 200.0**2)
WALL = (0.0, BULK, 0.05 * LAM)
DENSE = (1.1 * RHO, 1.1 * RHO * 300.0**2)  # a half-space that is slower than air


def on_a_wall(medium, d, beside):
    """kx of the modes of a layer between a soft wall and a half-space: k cot(k d)/rho + alpha/rho_beside = 0, without the poles."""
    rho, rho_beside = medium[0], beside[0]
    low, high = (OMEGA * np.sqrt(r / k) for r, k in (beside, medium))

    def relation(kx):
        k, alpha = np.sqrt(high**2 - kx**2), np.sqrt(kx**2 - low**2)
        return k * np.cos(k * d) / rho + alpha * np.sin(k * d) / rho_beside

    kx = np.linspace(low * (1 + 1e-9), high * (1 - 1e-9), 4001)
    changes = np.flatnonzero(np.diff(np.sign([relation(k) for k in kx])))
    return [brentq(relation, kx[i], kx[i + 1], xtol=1e-13) for i in changes]


def between_walls(medium, d):
    """kx^2 = k^2 - (n pi/d)^2: all of them that do not decay."""
    rho, K = medium
    n = np.arange(1, 40)
    kx = np.sqrt(OMEGA**2 * rho / K - (n * np.pi / d) ** 2 + 0j)
    return list(kx[np.abs(kx.imag) < 0.4 * K0])


def held_to(ds, expected):
    expected = sorted(expected, key=lambda k: complex(k).real)
    assert int(ds["count"]) == len(expected)
    np.testing.assert_allclose(ds.kx.values, expected, rtol=1e-11)
    assert np.all(ds.error_estimate.values < 1e-10)


@pytest.mark.parametrize("d", [0.1 * LAM, 0.3 * LAM, 0.9 * LAM])
def test_the_part_in_front_of_a_wall_and_the_part_behind(d):
    """A slow layer on a soft wall guides alike on either side; each with the half-space that it sees, the slower one behind."""
    layer = (*SLOW, d)
    front, behind = on_a_wall(SLOW, d, AIR), on_a_wall(SLOW, d, DENSE)
    assert len(front) == {0.1 * LAM: 0, 0.3 * LAM: 1, 0.9 * LAM: 4}[d]
    held_to(bp.guided_modes(slab_of([layer, WALL], after=DENSE), F), front)
    held_to(bp.guided_modes(slab_of([WALL, layer], after=DENSE), F), behind)
    held_to(bp.guided_modes(slab_of([layer, WALL, layer], after=DENSE), F), front + behind)
    # not one cluster of two, but two modes known to all digits
    alike = bp.guided_modes(slab_of([layer, WALL, layer]), F)
    held_to(alike, front + front)
    assert np.all(alike.direction == 1)


@pytest.mark.parametrize("loss", [0.0, 0.02])
def test_parts_between_walls_are_closed(loss):
    """Between two soft walls stand n half waves, at any Re kx, those below k0 too."""
    medium, D = sided.lossy(MIDDLE, loss), 1.6 * LAM
    closed = between_walls(medium, D)
    assert min(np.real(closed)) < K0 < max(np.real(closed))
    held_to(bp.guided_modes(slab_of([(*SLOW, 0.3 * LAM), WALL, (*medium, D), WALL, WALL]), F),
            closed + on_a_wall(SLOW, 0.3 * LAM, AIR))  # fmt: skip
    # a wall at the end of each period of a cell: the first layer is beside air, the three others between walls
    ds = bp.guided_modes(slab_of([(*SLOW, 0.3 * LAM), WALL], periods=4), F)
    held_to(ds, on_a_wall(SLOW, 0.3 * LAM, AIR) + 3 * between_walls(SLOW, 0.3 * LAM))


def test_two_layers_between_walls():
    """tan(k1 d1) rho1/k1 + tan(k2 d2) rho2/k2 = 0."""
    (d1, d2), (k1, k2) = (0.8 * LAM, 0.25 * LAM), (OMEGA / 150.0, OMEGA / 200.0)

    def relation(kx):
        a, b = np.emath.sqrt(k1**2 - kx**2), np.emath.sqrt(k2**2 - kx**2)
        return np.real(SLOW[0] * np.sinc(a * d1 / np.pi) * d1 * np.cos(b * d2)
                       + MIDDLE[0] * np.sinc(b * d2 / np.pi) * d2 * np.cos(a * d1))  # fmt: skip

    kx = np.linspace(2e-3 * K0, k1, 4001)
    changes = np.flatnonzero(np.diff(np.sign([relation(k) for k in kx])))
    expected = [brentq(relation, kx[i], kx[i + 1], xtol=1e-13) for i in changes]
    assert len(expected) > 2
    held_to(bp.guided_modes(slab_of([WALL, (*SLOW, d1), (*MIDDLE, d2), WALL]), F), expected)


def test_a_backward_mode_in_front_of_a_wall():
    """A thin negative layer on a soft wall: its mode runs against its phase, as the field's contour knows it."""
    layers = [(-0.6 * RHO, 2 * BULK, 0.04 * LAM), (RHO, BULK, 0.1 * LAM)]
    known = sided.modes(layers, None, 340.0)
    ds = bp.guided_modes(slab_of([*layers, WALL]), F, kx_over_k0_max=340.0 / K0)
    held_to(ds, [k for k, _ in known])
    assert list(ds.direction.values) == [side for _, side in sorted(known)]
    assert -1 in ds.direction


def test_a_wall_alone_guides_nothing():
    """Neither does it at a frequency at which its density passes through 0, with a slab that guides at others."""
    assert int(bp.guided_modes(slab_of([WALL]), F)["count"]) == 0
    crossing = bp.Fluid(lambda f: (f - F) / F * RHO, BULK)
    slab = bp.Slab([bp.Layer(bp.Fluid(*SLOW), 0.3 * LAM), bp.Layer(crossing, 0.05 * LAM)])
    ds = bp.guided_modes(slab, [F - 1e-6, F, F + 1e-6])
    kx = ds.kx.values[:, -1]
    assert kx[1] == pytest.approx(on_a_wall(SLOW, 0.3 * LAM, AIR)[0], rel=1e-11)
    np.testing.assert_allclose(kx[[0, 2]], kx[1], rtol=1e-6)


def test_as_many_parts_as_fit_into_memory(monkeypatch):
    """Each period of a cell with a wall has modes of its own: a table of them all may be too large, and is refused by name."""
    monkeypatch.setenv("BEAMPROP_MEMORY", "100M")
    with pytest.raises(ValueError, match=r"^slab: expected a question that fits into .* take fewer periods$"):
        bp.guided_modes(slab_of([(*SLOW, 0.3 * LAM), WALL], periods=10**6), F)
