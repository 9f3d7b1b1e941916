"""Pictures of curves as pictures: at 88 and 180 mm nothing is cut, overlaps, or lies on what it should not."""

import matplotlib as mpl
import numpy as np
import pytest
from drawn_datasets import AXES, made, widths
from drawn_texts import faults

import beamprop as bp

mpl.use("agg")
HIGH = {"frequency": np.linspace(0.9e6, 1.1e6, 21)}
MANY = {"angle": np.linspace(0.0, 60.0, 13)}
FEW = {"frequency": np.linspace(2e3, 2.7e3, 8)}


def bands(f, kx):
    cell = bp.Cell((bp.Layer(bp.AIR, 0.05), bp.Layer(bp.Fluid.from_speed(5.0, 600.0), 0.03)))
    return bp.bloch(cell, f, kx_over_k0=kx)


#: A picture of each kind, of few and of many curves and panels, with long names and large numbers.
PICTURES = {
    "a curve": lambda **o: bp.plot.scattering(made("frequency", **HIGH), **o),
    "long name": lambda **o: bp.plot.scattering(
        made("frequency", names=("energy_transmission",)), "energy_transmission", **o
    ),
    "eight curves": lambda **o: bp.plot.scattering(made("frequency", "kx_over_k0", **FEW), log=True, **o),
    "long labels": lambda **o: bp.plot.scattering(made("eta", "angle"), label="a slab of 450 periods", **o),
    "long name and legend": lambda **o: bp.plot.sweep(
        made("eta", "frequency", "mode", names=("power",)).assign_coords(mode=["reflected", "transmitted"]), **o
    ),
    "map": lambda **o: bp.plot.scattering(1e7 * made("frequency", "kx_over_k0", **HIGH), **o),
    "map with a note": lambda **o: bp.plot.scattering(made("frequency", "kx_over_k0").map(lambda v: v**-40), **o),
    "logarithmic map": lambda **o: bp.plot.scattering(
        made("frequency", "angle", **MANY).map(lambda v: v**9), log=True, **o
    ),
    "panels of maps": lambda **o: bp.plot.sweep(made("frequency", "kx_over_k0", "eta"), along="kx_over_k0", **o),
    "contours": lambda **o: bp.plot.bloch(bands([500.0, 900.0], np.linspace(-10, 10, 81)), mirror=True, **o),
    "bands": lambda **o: bp.plot.bloch(bands(np.linspace(100, 6000, 90), [0.0, 0.5, 0.9]), **o),
    "maps of bands": lambda **o: bp.plot.bloch(bands(np.linspace(100, 6000, 30), np.linspace(0, 2, 21)), **o),
    "modes": lambda **o: bp.plot.modes(made("frequency", "mode", names=("kx_over_k0", "direction")).map(np.ceil), **o),
    "widths": lambda **o: bp.plot.width(widths("frequency"), **o),
    "widths at two angles": lambda **o: bp.plot.width(
        widths("frequency", "angle", angle=[0.0, 22.5]), label="lossless", **o
    ),
    "small widths": lambda **o: bp.plot.width(widths("frequency", **HIGH) / 1000, **o),
    "panels of widths": lambda **o: bp.plot.width(widths("frequency", "angle", **HIGH), **o),
    "map of widths": lambda **o: bp.plot.width(widths("frequency", "angle", **MANY), **o),
    "band": lambda **o: bp.plot.sweep(made("sample", "frequency", names=("fwhm_out",)), band="sample", **o),
    "bands of three": lambda **o: bp.plot.sweep(made("sample", "frequency", "eta"), band="sample", **o),
    "panels of curves": lambda **o: bp.plot.sweep(
        made("eta", "angle", "frequency", names=("width_second_moment",)), **o
    ),
    "long horizontal name": lambda **o: bp.plot.sweep(made("eta", names=("error_estimate_intensity_x",)), **o),
}


@pytest.fixture(autouse=True)
def figures():
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


@pytest.mark.parametrize("width", [88, 180])
@pytest.mark.parametrize("name", PICTURES)
def test_nothing_is_cut_or_overlaps(name, width, monkeypatch):
    """Letters are whole, apart from one another and beside the curves; the legend, too, covers no Axes."""
    drawn = np.atleast_1d(PICTURES[name](width=width))
    figure = drawn[0].figure
    assert faults(figure, monkeypatch) == []
    assert figure.get_figwidth() * 25.4 == pytest.approx(width)
    boxes = [legend.get_window_extent() for legend in (*figure.legends, *(ax.get_legend() for ax in drawn)) if legend]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0
        assert not any(box.overlaps(ax.get_window_extent()) for ax in drawn)
    for ax in drawn:
        assert ax.get_window_extent().height > 0.25 * figure.get_figwidth() * figure.dpi / len(drawn)


@pytest.mark.parametrize("layout", ["constrained", "compressed"])
def test_panels_of_a_figure_of_the_users_own(layout, monkeypatch, figures):
    """Each with a title and a legend below it."""
    figure, axes = figures.subplots(2, 2, figsize=(7, 7), layout=layout)
    for ax, ds in zip(
        axes.flat, (widths("frequency"), widths("angle"), widths("eta"), widths("frequency")), strict=True
    ):
        assert bp.plot.width(ds, ax=ax) is ax
        ax.set_title("a title")
    assert faults(figure, monkeypatch) == []
    for ax in axes.flat:
        assert not ax.get_legend().get_window_extent().overlaps(ax.get_window_extent())


def test_a_figure_without_layout_keeps_its_size_and_its_legend_inside(figures):
    figure, ax = figures.subplots()
    bp.plot.scattering(made("angle", "eta"), ax=ax)
    figure.canvas.draw()
    box, inside = ax.get_legend().get_window_extent(), ax.get_window_extent()
    assert inside.x0 <= box.x0 < box.x1 <= inside.x1
    assert tuple(figure.get_size_inches()) == (6.4, 4.8)


def test_a_legend_follows_the_curves_of_every_call(monkeypatch):
    """A second dataset in the same Axes: one legend, of all the curves."""
    ax = bp.plot.scattering(made("frequency"), label="exact")
    bp.plot.scattering(made("frequency"), ax=ax, label="effective medium")
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["exact", "effective medium"]
    assert len(ax.figure.legends) == 0
    assert faults(ax.figure, monkeypatch) == []
    assert len(AXES["frequency"]) == len(ax.lines[1].get_xdata())
