"""Titles tell what a picture holds at one value."""

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from drawn_texts import faults
from slanted_beam import make

import beamprop as bp

mpl.use("agg")
SLAB, BEAM = bp.Slab(bp.lmmd_cell(), periods=5), bp.GaussianBeam(0.096)


@pytest.fixture(autouse=True)
def figures():
    yield
    plt.close("all")


PICTURES = {
    "scattering": (lambda: bp.plot.scattering(bp.scattering(SLAB, 2500.0, kx_over_k0=[0.0, 0.5])), "2500 Hz"),
    "angle": (lambda: bp.plot.scattering(bp.scattering(SLAB, [2e3, 3e3], angle=30.0)), "30°"),
    "bloch": (lambda: bp.plot.bloch(bp.bloch(bp.lmmd_cell(), 2e4, kx_over_k0=[0.0, 0.5])), "20 kHz"),
    "modes": (lambda: bp.plot.modes(bp.guided_modes(SLAB, 2500.0)), "2500 Hz"),
    "measures": (
        lambda: bp.plot.sweep(bp.beam_measures(SLAB, BEAM, [2e3, 3e3], 10.0, window=1.0, rtol=1e-4), "power"),
        "10°",
    ),
    "width": (lambda: bp.plot.width(bp.beam_width(SLAB, BEAM, [2e3, 3e3], 10.0, air_distance=0.1, rtol=1e-4)), "10°"),
}


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.filterwarnings("ignore:the half level")
def test_frequency_and_angle_are_told(name, monkeypatch):
    draw, title = PICTURES[name]
    ax = draw()
    assert ax.get_title() == title
    assert faults(ax.figure, monkeypatch) == []


def test_positions_and_parameters_are_told():
    ds = make().assign_coords(frequency=2500.0, eta=0.05)
    assert bp.plot.cut(ds.sel(x=0.1, method="nearest")).get_title() == "2500 Hz, x = 0.1 m, eta = 0.05"
    ax = bp.plot.cut(ds, x=0.1)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["x = 0.1 m"]


def test_a_title_of_ones_own_stays():
    ax = plt.figure().add_subplot(title="mine")
    bp.plot.scattering(bp.scattering(SLAB, 2500.0, kx_over_k0=[0.0, 0.5]), ax=ax)
    assert ax.get_title() == "mine"


def test_panels_share_a_line_above_them(monkeypatch):
    ds = bp.scattering(SLAB, np.linspace(2e3, 3e3, 20), angle=np.linspace(0, 40, 20))
    several = ds.expand_dims(eta=[0.05, 0.1]).assign_coords(sample=3)
    axes = bp.plot.scattering(several)
    assert axes[0].figure.get_suptitle() == "sample = 3"
    assert faults(axes[0].figure, monkeypatch) == []
