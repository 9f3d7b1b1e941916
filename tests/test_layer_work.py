"""How often layers are evaluated: once a cell, and once for all angles."""

import numpy as np
import pytest
from plane_waves import K0, F, inside

import beamprop as bp
from beamprop.response import layer as layer_kernels

PAPER = bp.Slab(bp.lmmd_cell(), 450)


def layer_work(monkeypatch, ask):
    """How many numbers the layers' functions are evaluated at while `ask` runs."""
    work = []
    original = layer_kernels.entire

    def counted(u):
        work.append(np.size(u))
        return original(u)

    with monkeypatch.context() as patch:
        patch.setattr(layer_kernels, "entire", counted)
        ask()
    return sum(work)


@pytest.mark.parametrize("depths", [None, [0.001, 0.002, 0.0035]])
def test_the_work_does_not_grow_with_the_periods(monkeypatch, depths):
    """The layers of one cell are evaluated once, for 2 periods as for a million; once more for the estimate."""
    kx = np.linspace(0, 3, 50) * K0

    def ask(periods, estimate=False):
        slab = bp.Slab(bp.lmmd_cell(0.05 + 0.05j, 0.025, 10, 1 / 60), periods)
        return lambda: inside(slab, kx, depths) if depths else bp.scattering(slab, F, kx=kx, estimate=estimate)

    of_two, of_a_million = (layer_work(monkeypatch, ask(n)) for n in (2, 1_000_000))
    assert of_two == of_a_million > 0
    if depths is None:
        assert of_a_million == 10 * kx.size
        assert layer_work(monkeypatch, ask(450, estimate=True)) == 2 * of_a_million


def test_one_response_serves_every_angle(monkeypatch):
    """An angle sweep at one frequency evaluates the layers hardly more often than one angle."""

    def ask(angle):
        return lambda: bp.field(PAPER, bp.GaussianBeam(0.096, z0=-0.1), F, np.linspace(-1, 1, 64), [0.5, 1.0], angle)

    single, sweep = layer_work(monkeypatch, ask(80.0)), layer_work(monkeypatch, ask(np.linspace(-80, 80, 9)))
    assert sweep < 2 * single
