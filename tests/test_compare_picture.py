"""The picture of a comparison."""

import matplotlib
import numpy as np
import pytest
from drawn_texts import faults
from slanted_beam import make, swept

from beamprop.comparison.fields import compare
from beamprop.plot.comparison import comparison

matplotlib.use("Agg")


@pytest.fixture
def figure():
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


def test_picture_with_maps(figure):
    c = compare(make(), make(values=make().p.values * 1.01))
    axes = comparison(c)
    assert len(axes) == 5
    np.testing.assert_allclose(axes[1].collections[0].get_array(), np.abs(c.p_b.T), rtol=1e-12)
    np.testing.assert_allclose(axes[3].lines[0].get_ydata(), c.relative_l2_by_z, rtol=1e-12)
    np.testing.assert_allclose(axes[4].lines[0].get_ydata(), c.fwhm_difference * 1e6, atol=1e-9)
    assert axes[4].get_ylabel().endswith("[µm]")
    axes[0].figure.canvas.draw()


def test_picture_without_fields_and_in_given_axes(figure):
    c = compare(make(), make(values=make().p.values * 1.01)).drop_vars(["p_a", "p_b", "error"])
    assert len(comparison(c)) == 2
    lower = figure.subplots()[1]
    assert comparison(c, lower) is lower
    pair = figure.subplots(1, 2)[1]
    assert comparison(c, pair)[1] is pair[1]
    with pytest.raises(ValueError, match="axes: expected 1, 2 or"):
        comparison(c, figure.subplots(1, 5)[1])


@pytest.mark.parametrize(
    "pair",
    [
        (make(), make()),
        (make().isel(z=[3]), make().isel(z=[3])),
        (make(np.linspace(0, 0.05, 9)), make(np.linspace(0, 0.05, 9), values=np.zeros((31, 9)) + 0j)),
    ],
    ids=["identical", "one plane", "no widths"],
)
def test_picture_of_odd_cases(figure, pair):
    axes = comparison(compare(*pair))
    axes[-1].figure.canvas.draw()


@pytest.mark.parametrize("width", [88, 180])
@pytest.mark.parametrize("shape", [(1.0, 0.6), (0.2, 2.0), (3.0, 0.3)], ids=["square", "flat", "steep"])
@pytest.mark.parametrize("size", [1.0, 4e-8])
def test_no_letter_is_cut_or_overlaps(figure, monkeypatch, width, shape, size):
    """Of both layouts, with maps and without; one scale for both fields, whose ends are told by tips."""
    x, z = shape[0] * np.linspace(-0.5, 0.5, 61), shape[1] * np.linspace(0, 1, 31)
    p = size * np.exp(-((x / shape[0] * 6) ** 2) + 5j * z[:, None] / shape[1])
    c = compare(make(x, z, values=p), make(x, z, values=p * (1 + 0.2j * x / shape[0])))
    for ds, pictures in ((c, 5), (c.drop_vars(["p_a", "p_b", "error"]), 2)):
        axes = comparison(ds, width=width)
        assert axes.size == pictures
        assert faults(axes[0].figure, monkeypatch) == []
        assert axes[0].figure.get_figwidth() * 25.4 == pytest.approx(width)
        assert axes[0].figure.get_figheight() * 25.4 < 247
    lower = figure.subplots()[1]
    assert comparison(c, ax=lower) is lower


def test_picture_refuses(figure):
    with pytest.raises(ValueError, match="cmp_ds: expected a dataset from compare, got p"):
        comparison(make())
    with pytest.raises(ValueError, match="cmp_ds: expected one field, got several along frequency, angle"):
        comparison(compare(swept(), swept()))
    comparison(compare(swept(), swept()).isel(frequency=0, angle=[1]))
