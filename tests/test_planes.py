"""Planes on faces of cells, means over a cell, and the hint where a map would show stripes that are not there."""

import shlex
import warnings

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from command import good

import beamprop as bp
from beamprop.media.planes import rows_of
from beamprop.parameters import Design

mpl.use("agg")
PAPER = bp.Slab(bp.lmmd_cell(rho_m=0.05, delta_rho=0), periods=450)
WATER, ACRYLIC = bp.material("water"), bp.material("acrylic")
PLATES = bp.Slab([bp.Layer(ACRYLIC, 1.5e-3), bp.Layer(WATER, 2e-3)], periods=6, background=WATER)
STACK = bp.Slab(bp.lmmd_cell(), periods=30) + bp.Slab.uniform(bp.AIR, 0.1) + bp.Slab(bp.lmmd_cell(eta=0.1), periods=40)
BEAM = bp.GaussianBeam(0.096, angle=30, z0=-0.05)
X = np.linspace(-0.2, 0.3, 41)


# --- faces ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slab", [PAPER, PLATES, STACK], ids=["paper", "plates", "stack"])
@pytest.mark.parametrize("planes", [2, 9, 100, 561, 5000])
def test_planes_lie_at_the_same_places_of_every_cell(slab, planes):
    """Of a row of cells either on faces, or at 8 and more places that are the same in all cells."""
    t = slab.thickness
    z = bp.faces(slab, planes, before=0.4 * t, after=0.7 * t)
    assert np.all(np.diff(z) > 0)
    assert (z[0], z[-1]) == (-0.4 * t, t + 0.7 * t)
    assert {0.0, t} <= set(z)
    for row in rows_of(slab):
        inside = z[(z >= row.start) & (z < row.stop * (1 - 1e-12))]
        places = np.unique(np.round((inside - row.start) / row.cell.thickness % 1, 9) % 1)
        assert not row.ripples or places.size == 1 or places.size >= 8
        assert 0 in places
    assert z.size <= 2 * planes + 6


def test_steps_are_the_nearest_whole_number_of_cells():
    z = bp.faces(PAPER, 150) / PAPER.cell.thickness
    np.testing.assert_allclose(z, np.arange(0, 451, 3), atol=1e-9)
    z = bp.faces(PAPER, 113, before=0.01) / PAPER.cell.thickness
    np.testing.assert_allclose(z[1:], [*np.arange(0, 450, 4), 450], atol=1e-9)  # the last step is shorter
    assert bp.faces(bp.Slab.interface(), 5, before=0.2, after=0.2).tolist() == [-0.2, -0.1, 0.0, 0.1, 0.2]
    assert bp.faces(bp.Slab.interface(), 5).tolist() == [0.0]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"planes": 1}, "planes: expected a whole number of at least 2, got 1"),
        ({"before": -0.1}, "before: expected a length of at least zero, got -0.1"),
        ({"after": np.nan}, "after: expected a finite number"),
    ],
)
def test_wrong_faces_are_refused(more, said):
    with pytest.raises(ValueError, match=f"^{said}"):
        bp.faces(PAPER, **more)
    with pytest.raises(ValueError, match=r"^slab: expected a Slab, got 3"):
        bp.faces(3)


# --- the mean over a cell ---------------------------------------------------------------------------------


def mean_by_many_planes(slab, beam, frequency, plane, begin, period, variable="p", count=3000):
    """The mean over a period from `begin` on by the midpoint rule on planes as many as there is patience for."""
    z = begin + period * (np.arange(count) + 0.5) / count
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", bp.HintWarning)
        return bp.field(slab, beam, frequency, X, z, variables=[variable])[variable].values.mean(axis=0)


@pytest.mark.parametrize(
    ("plane", "begin"),
    [(0.0, 0.0), (0.0005, 0.0), (0.4561, None), (PAPER.thickness, PAPER.thickness - PAPER.cell.thickness)],
)
@pytest.mark.parametrize("variable", ["p", "intensity_z"])
def test_means_over_a_cell(plane, begin, variable):
    """About the plane; near the ends of the row over the first and the last cell. The midpoint rule errs by its steps squared."""
    period = PAPER.cell.thickness
    begin = plane - period / 2 if begin is None else begin
    ds = bp.field(PAPER, BEAM, 2500.0, X, [plane], average="cell", variables=[variable])
    expected = mean_by_many_planes(PAPER, BEAM, 2500.0, plane, begin, period, variable)
    np.testing.assert_allclose(ds[variable].values[0], expected, atol=3e-6 * np.abs(expected).max())
    assert ds.attrs["average"] == bp.provenance(ds)["average"] == "cell"


def test_means_of_thick_layers_know_their_error():
    """Cells of five wavelengths, whose mean is small: more nodes are taken, and the estimate holds against many more planes."""
    beam = bp.GaussianBeam(0.004, angle=20, z0=-1e-3)
    x, period = np.linspace(-0.004, 0.006, 21), PLATES.cell.thickness
    z = np.array([0.006, 0.0101])
    for rtol in (1e-4, 1e-8):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", bp.AccuracyWarning)  # errors of p over the largest mean
            ds = bp.field(PLATES, beam, 3e6, x, z, rtol=rtol, average="cell")
        assert ds.error_estimate < 100 * rtol
        for i, plane in enumerate(z):
            at, w = np.polynomial.legendre.leggauss(40)
            cuts = np.arange(8) * period + np.array([[0.0], [1.5e-3]])
            begin, end = plane - period / 2, plane + period / 2
            cuts = np.unique([begin, end, *cuts[(cuts > begin) & (cuts < end)]])
            half = np.diff(cuts)[:, None] / 2
            depths = cuts[:-1, None] + half * (1 + at)
            p = bp.field(PLATES, beam, 3e6, x, depths.ravel(), rtol=1e-10).p.values
            expected = ((half * w).ravel() / period) @ p
            assert (
                np.abs(ds.p.values[i] - expected).max() < max(float(ds.error_estimate), 1e-8) * np.abs(expected).max()
            )


def test_what_has_no_cells_is_as_without_means():
    """Planes outside of a slab, a slab of a layer, power through planes; and a map larger than a block has the means of its planes."""
    outside = [-0.02, PAPER.thickness + 0.1]
    for slab, z in ((PAPER, outside), (bp.Slab.uniform(WATER, 0.2), [0.0, 0.05, 0.1])):
        plain, mean = (bp.field(slab, BEAM, 2500.0, X, z, average=average) for average in (None, "cell"))
        np.testing.assert_array_equal(mean.p, plain.p)
    z = np.linspace(-0.05, 1.2, 411)
    ds = bp.field(PAPER, BEAM, 2500.0, X, z, angle=[10.0, 30.0], average="cell", variables=["p", "power_through"])
    assert np.all(ds.error_estimate < 1e-8)
    lone = bp.field(PAPER, BEAM, 2500.0, X, z[[0, 200, 410]], angle=30.0, average="cell")
    np.testing.assert_allclose(ds.p.sel(angle=30)[[0, 200, 410]], lone.p, atol=2e-8 * np.abs(lone.p).max())
    assert np.ptp(ds.power_through.sel(angle=30).values) < 1e-6 * float(ds.power_through.max())


def test_means_in_a_file_and_by_the_command(tmp_path):
    z = np.linspace(0.0, 0.2, 31)
    ds = bp.field(PAPER, BEAM, 2500.0, X, z, average="cell")
    rest = bp.save_field(tmp_path / "a.nc", PAPER, BEAM, 2500.0, X, z, average="cell", memory=16 * 41 * 7)
    np.testing.assert_allclose(bp.load(tmp_path / "a.nc").p, ds.p, atol=2e-8)
    assert rest.attrs["average"] == "cell"
    words = ["--lossless", "--angle", "30", "--z0=-0.05", "--x=-0.2:0.3:41", "--z", "0:0.2:31", "--average", "cell"]
    good("field", *words, "--output", tmp_path / "b.nc")
    np.testing.assert_allclose(bp.load(tmp_path / "b.nc").p, ds.p, atol=2e-8)
    with pytest.raises(ValueError, match=r"^average: expected 'cell', got 'layer'"):
        bp.field(PAPER, BEAM, 2500.0, X, z, average="layer")


# --- the hint ---------------------------------------------------------------------------------------------


def hints_of(slab, z, frequency=2500.0, average=None):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ds = bp.field(slab, bp.GaussianBeam(0.096, z0=-0.05), frequency, [0.0, 0.1], z, rtol=1e-4, average=average)
        asked = len(caught)
        bp.plot.field(ds)
        bp.plot.cut(ds, x=0.0)
        plt.close("all")
    assert [str(w.message) for w in caught[asked:]] == 2 * [str(w.message) for w in caught[:asked]]
    assert all(w.category is bp.HintWarning and w.filename == __file__ for w in caught)
    return [str(w.message) for w in caught[:asked]]


@pytest.mark.parametrize("step", [0.26, 0.7, 1.001, 1.3, 2.5])
def test_planes_that_skip_through_cells_are_told(step):
    """By `field`, by `plot.field` and by `plot.cut` along z, each at the line that calls it."""
    (said,) = hints_of(PAPER, PAPER.cell.thickness * step * np.arange(30))
    assert said.startswith(
        f"z: steps of {step * PAPER.cell.thickness:.3g} m skip through cells of 0.00229 m, inside which"
    )
    assert "take z=bp.faces(slab, ...), or average='cell'" in said


@pytest.mark.parametrize(
    ("slab", "z", "average"),
    [
        (PAPER, PAPER.cell.thickness * np.arange(30), None),
        (PAPER, PAPER.cell.thickness * (0.3 + 3 * np.arange(30)), None),
        (PAPER, PAPER.cell.thickness * 0.25 * np.arange(50), None),
        (PAPER, PAPER.cell.thickness * 1.3 * np.arange(19), None),
        (PAPER, PAPER.cell.thickness * 1.3 * np.arange(30), "cell"),
        (PAPER, PAPER.thickness + np.linspace(0, 1, 50), None),
        (PAPER, np.random.default_rng(0).uniform(0, PAPER.thickness, 50), None),
        (PAPER, bp.faces(PAPER, 60, after=0.4), None),
        (bp.Slab.uniform(WATER, 1.0), np.linspace(0, 1, 50), None),
        (bp.Slab([bp.Layer(WATER, 0.001), bp.Layer(bp.material("blood"), 0.001)], 300), np.linspace(0, 0.6, 50), None),
    ],
    ids=[
        "faces",
        "the same place",
        "resolved",
        "a few planes",
        "means",
        "behind",
        "at random",
        "bp.faces",
        "uniform",
        "hardly any ripple",
    ],
)
def test_maps_without_such_stripes_are_not_warned_of(slab, z, average):
    assert hints_of(slab, z, average=average) == []


def test_stripes_are_those_of_the_grid():
    """What the hint says is so: between faces |p| of one line ripples by half its size, on faces from cell to cell by a hundredth."""
    z = PAPER.cell.thickness * (200 + 1.3 * np.arange(30))
    with pytest.warns(bp.HintWarning):
        between = np.abs(bp.field(PAPER, BEAM, 2500.0, 0.3, z).p.values)
    on_faces = np.abs(bp.field(PAPER, BEAM, 2500.0, 0.3, PAPER.cell.thickness * (200 + np.arange(40))).p.values)
    assert np.abs(np.diff(between)).max() > 0.4 * between.mean()
    assert np.abs(np.diff(on_faces)).max() < 0.15 * on_faces.mean()


#: What is typed -> planes in a cell, and whether they are even.
DEFAULTS = {
    "": (1, True),
    "--periods 4500": (0.1, True),
    "--periods 997": (0.5, True),
    "--periods 20": (12, True),
    "--layer 'acrylic 1.5mm' --layer 'water 2mm' --background water --frequency 1MHz --periods 3": (100, True),
    "--layer 'acrylic 1.5mm' --layer 'water 2mm' --background water --frequency 1MHz --periods 300": (1, True),
}


@pytest.mark.parametrize("typed", DEFAULTS)
def test_the_default_planes_of_the_command_draw_no_stripes(typed, tmp_path):
    """On faces of thin cells, where there is room at as many places of each; even, as some files want them; no warning."""
    words = [*shlex.split(typed), "--x=-0.001:0.001:3", "--rtol", "1e-4", "--output", tmp_path / "a.nc"]
    assert good("field", *words).stderr == ""
    z, slab = bp.load(tmp_path / "a.nc").z.values, bp.provenance(bp.load(tmp_path / "a.nc"))["slab"]
    inside = z[(z >= 0) & (z < slab.thickness * (1 - 1e-9))] / slab.cell.thickness
    each, even = DEFAULTS[typed]
    assert each / 2 <= inside.size / slab.periods <= 2 * each
    if each <= 1:
        np.testing.assert_allclose(inside, np.round(inside), atol=1e-6)
    assert bool(np.ptp(np.diff(z)) < 1e-9) == even
    assert 140 < z.size < 1200
    assert z[0] <= 0 < slab.thickness < z[-1]


def test_the_default_planes_of_a_stack_lie_on_faces_of_all_its_cells():
    z = Design(2500.0, 0.1372).z(-0.1, STACK + PAPER)
    for row in rows_of(STACK + PAPER):
        inside = (z[(z >= row.start) & (z < row.stop * (1 - 1e-9))] - row.start) / row.cell.thickness
        assert not row.ripples or np.abs(inside - np.round(inside)).max() < 1e-6
    assert z[0] == -0.1


def test_planes_that_are_given_are_told_of_once(tmp_path):
    """Though the picture would tell the same."""
    words = ["--x=-0.1:0.1:3", "--rtol", "1e-4", "--z", "0:0.3:80", "--plot", tmp_path / "a.png"]
    assert good("field", *words, "--periods", "300").stderr.count("skip through cells") == 1
