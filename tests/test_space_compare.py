"""`compare` on planes, cuts and volumes of three dimensions, and the pictures of them."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from click.testing import CliRunner
from drawn_texts import faults

import beamprop as bp
from beamprop.cli import main

SLAB = bp.Slab(bp.lmmd_cell(), 45)
BEAM = bp.GaussianBeam((0.2, 0.1), 20, z0=-0.05, azimuth=30.0)
X, Y, Z = np.linspace(-0.4, 0.4, 41), np.linspace(-0.3, 0.3, 31), np.linspace(0.11, 0.5, 9)


@pytest.fixture(scope="module")
def volumes():
    """One of the slab, one of a slab a period thinner."""
    thinner = bp.Slab(bp.lmmd_cell(), 44)
    return tuple(bp.field(slab, BEAM, 2500.0, X, Z, y=Y) for slab in (SLAB, thinner))


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_norms_of_volumes_planes_and_cuts_are_plain_sums(volumes):
    a, b = volumes
    for select in ({}, {"z": 3}, {"y": 7}, {"x": 5}):
        part_a, part_b = (ds.isel(select) for ds in volumes)
        cmp_ds = bp.compare(part_a, part_b)
        off, size = abs(part_a.p - part_b.p), abs(part_a.p)
        assert float(cmp_ds.relative_l2) == pytest.approx(float(np.sqrt((off**2).sum() / (size**2).sum())), rel=1e-12)
        assert float(cmp_ds.largest_error) == pytest.approx(float(off.max() / size.max()), rel=1e-12)
        place = {d: cmp_ds[f"largest_error_{d}"].item() for d in part_a.p.dims}
        assert float(off.sel(place)) == float(off.max())
    cmp_ds = bp.compare(a, b)
    across = np.sqrt((abs(a.p - b.p) ** 2).sum(("y", "x")) / (abs(a.p) ** 2).sum(("y", "x")))
    np.testing.assert_allclose(cmp_ds.relative_l2_by_z, across, rtol=1e-12)
    assert cmp_ds.p_a.dims == ("z", "y", "x")


def test_uneven_steps_are_weighed_by_their_cells():
    x = np.array([0.0, 0.1, 0.3, 0.4])
    a = bp.field(SLAB, BEAM, 2500.0, x, [0.2], y=x)
    b = a.assign(p=a.p.copy(data=a.p.values * (1 + 0.1 * (x > 0.2))))
    cell = np.multiply.outer(np.gradient(x), np.gradient(x))
    off, size = (np.sum(cell * np.abs(v[0]) ** 2) for v in ((a.p - b.p).values, a.p.values))
    assert float(bp.compare(a, b).relative_l2) == pytest.approx(np.sqrt(off / size), rel=1e-12)


def test_widths_are_those_along_both_axes_through_the_peak(volumes):
    cmp_ds = bp.compare(*volumes)
    assert cmp_ds.fwhm_a.dims == ("z", "axis")
    plane = volumes[0].isel(z=4)
    peak = abs(plane.p).argmax(("y", "x"))
    along = bp.fwhm(plane.p.isel(y=peak["y"])), bp.fwhm(plane.p.isel(x=peak["x"]), dim="y")
    np.testing.assert_allclose(cmp_ds.fwhm_a[4], along, rtol=1e-12)
    # the largest of a spline through samples of the row
    assert float(cmp_ds.peak_a[4]) == pytest.approx(float(abs(plane.p).max()), rel=1e-3)


def test_a_cut_is_compared_as_a_field_of_two_dimensions(volumes):
    cut = [ds.isel(y=10) for ds in volumes]
    flat = [ds.drop_vars(["y", "azimuth"]) for ds in cut]
    assert bp.compare(*cut).drop_vars(["y", "azimuth"], errors="ignore").equals(bp.compare(*flat))
    with pytest.raises(ValueError, match=r"^b: expected the same y as a, -0\.1, got -0\.08"):
        bp.compare(cut[0], volumes[1].isel(y=11))
    in_2d = bp.field(SLAB, bp.GaussianBeam(0.2, 20, z0=-0.05), 2500.0, X, Z)
    assert float(bp.compare(cut[0], in_2d).relative_l2) > 0.01


def test_coarser_grids_are_interpolated_along_y_too(volumes):
    a, fine = volumes[0], bp.field(SLAB, BEAM, 2500.0, np.linspace(-0.4, 0.4, 97), Z, y=np.linspace(-0.3, 0.3, 73))
    cmp_ds = bp.compare(a, fine)
    assert float(cmp_ds.relative_l2) < 1e-3
    assert 0 < float(cmp_ds.interpolation_error) < 1e-2


@pytest.mark.filterwarnings("ignore:b is periodic")
def test_periods(volumes):
    lattice = bp.field(SLAB, BEAM, 2500.0, X, Z, y=Y, boundary="periodic", period=(1.5, 1.2))
    cmp_ds = bp.compare(volumes[0], lattice, open_reference=volumes[0])
    assert float(cmp_ds.wraparound) == pytest.approx(float(cmp_ds.relative_l2), rel=0.1)
    longer = bp.field(SLAB, BEAM, 2500.0, X, Z, y=Y, boundary="periodic", period=(1.5, 1.3))
    with pytest.warns(UserWarning, match=r"a has the period 1\.5 x 1\.2 m, b 1\.5 x 1\.3 m"):
        bp.compare(lattice, longer)


def test_other_dims_are_refused(volumes):
    for pair in ((volumes[0], volumes[1].isel(y=3)), (volumes[0].isel(y=3), volumes[1])):
        with pytest.raises(ValueError, match=r"^b: expected the dims .* select one y"):
            bp.compare(*pair)


def test_the_command(volumes, tmp_path):
    paths = [str(tmp_path / f"{name}.nc") for name in "ab"]
    for ds, path in zip(volumes, paths, strict=True):
        bp.save(ds, path)
    result = CliRunner().invoke(main, ["compare", *paths, "--plot", str(tmp_path / "c.png")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "c.png").stat().st_size > 1000


@pytest.mark.parametrize("width", [88, 180])
def test_a_volume_is_three_planes_through_its_peak(volumes, width, monkeypatch):
    ds = volumes[0]
    axes = bp.plot.field(ds, width=width)
    peak = abs(ds.p).argmax(("z", "y", "x"))
    planes = (("x", "z", "y"), ("y", "z", "x"), ("y", "x", "z"))
    for ax, (upright, level, held) in zip(axes, planes, strict=True):
        values = abs(ds.p.isel({held: peak[held]})).transpose(upright, level)
        np.testing.assert_allclose(ax.collections[0].get_array(), values, rtol=1e-12)
        assert ax.collections[0].get_clim() == axes[0].collections[0].get_clim()
        assert f"{held} = " in ax.get_title()
    assert faults(axes[0].figure, monkeypatch) == []
    assert axes[0].figure.get_figwidth() * 25.4 == pytest.approx(width)
    with pytest.raises(ValueError, match=r"^ax: expected none for a volume"):
        bp.plot.field(ds, ax=plt.figure().add_subplot())


@pytest.mark.parametrize("width", [88, 180])
@pytest.mark.parametrize("shape", ["volume", "plane"])
def test_pictures_of_comparisons(volumes, width, shape, monkeypatch):
    cmp_ds = bp.compare(*(ds.isel(z=3) if shape == "plane" else ds for ds in volumes))
    axes = bp.plot.comparison(cmp_ds, width=width)
    assert len(axes) == (3 if shape == "plane" else 5)
    assert faults(axes[0].figure, monkeypatch) == []
