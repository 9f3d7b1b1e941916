"""Pictures of widths and of sweeps: kinds of widths, panels, bands of percentiles."""

import matplotlib as mpl
import numpy as np
import pytest
from drawn_datasets import AXES, made, widths

import beamprop as bp
from beamprop.io.labels import label

mpl.use("agg")


@pytest.fixture(autouse=True)
def figures():
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


def test_widths_in_one_axes():
    """In cm as ever, a line style for each kind and a colour for each angle; from 0 up to the largest, also of a second call."""
    ds = widths("frequency")
    ax = bp.plot.width(ds, label="first")
    assert [line.get_label() for line in ax.lines] == [
        f"first: {text}" for text in ("incident, near face", "behind the slab", "without the slab")
    ]
    np.testing.assert_array_equal(ax.lines[1].get_ydata(), 100 * ds.fwhm_out)
    bp.plot.width(2 * ds, ax=ax, label="second")
    assert len({(line.get_color(), line.get_linestyle()) for line in ax.lines}) == 6
    assert len({line.get_color() for line in ax.lines}) == 2
    assert ax.get_ylim()[0] == 0
    assert ax.get_ylim()[1] > 200 * float(ds.to_dataarray().max())


def test_widths_beyond_eight_curves_have_panels_and_beyond_eight_panels_a_map():
    ds = widths("frequency", "angle")
    axes = bp.plot.width(ds)
    assert [ax.get_title() for ax in axes] == [f"{10 * i}°" for i in range(7)]
    np.testing.assert_array_equal(axes[2].lines[2].get_ydata(), 100 * ds.fwhm_air.isel(angle=2))
    assert len({ax.get_ylim() for ax in axes}) == 1
    assert axes[0].get_ylim()[1] > 100 * float(ds.to_dataarray().max())
    with pytest.raises(ValueError, match=r"^ax: expected none for a figure of 7 panels, got Axes"):
        bp.plot.width(ds, ax=axes[0])
    many = widths("frequency", "angle", angle=np.linspace(0, 60, 13))
    ax = bp.plot.width(many)
    np.testing.assert_array_equal(ax.collections[0].get_array(), many.fwhm_out.T)
    assert bp.plot.width(many, along="angle").get_xlabel() == "angle [°]"


def test_widths_along_any_axis_and_small_ones_in_mm():
    ax = bp.plot.width(widths("eta") / 1000)
    ax.figure.canvas.draw()
    assert ax.get_ylabel() == "full width at half maximum [mm]"
    assert ax.get_xlabel() == "period over the wavelength at the design frequency"
    top = [text.get_text() for text in ax.get_yticklabels() if text.get_text()][-1]
    assert 0.1 < float(top) < 1


def test_a_band_is_median_and_percentiles():
    """Of 25 sorted copies the 13th is the median, and the 7th and 19th are at 25 and 75 percent; nan are left out with a warning."""
    ds = made("sample", "frequency", names=("fwhm_out",))
    ordered = np.sort(ds.fwhm_out.values, axis=0)
    ax = bp.plot.sweep(ds, band="sample", percentiles=(25, 75))
    np.testing.assert_allclose(ax.lines[0].get_ydata(), ordered[12], rtol=1e-12)
    edge = {tuple(point) for point in ax.collections[0].get_paths()[0].vertices.round(12)}
    for row in (6, 18):
        assert set(zip(AXES["frequency"].round(12), ordered[row].round(12), strict=True)) <= edge
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["median", "25th to 75th percentile"]
    ds.fwhm_out[3, 4] = np.nan
    with pytest.warns(UserWarning, match="1 of 525 values are nan, and left out of the band over sample"):
        bp.plot.sweep(ds, band="sample")


def test_bands_of_several_media_and_in_panels():
    ax = bp.plot.sweep(made("sample", "frequency", "eta"), band="sample")
    assert [t.get_text() for t in ax.get_legend().get_texts()][2:] == ["eta = 0.05", "5th to 95th percentile"]
    axes = bp.plot.sweep(made("sample", "frequency", "eta", "angle"), band="sample", log=True)
    assert [(len(ax.lines), len(ax.collections), ax.get_yscale()) for ax in axes] == [(7, 7, "log")] * 3


def test_complex_values_are_drawn_by_their_magnitude():
    ds = made("frequency", names=("r",)) * np.exp(1j)
    ds.r.attrs = label("r")
    ax = bp.plot.sweep(ds)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), np.abs(ds.r), rtol=1e-15)
    assert ax.get_ylabel().split() == ["magnitude", "of", "complex", "pressure", "reflection", "coefficient"]
