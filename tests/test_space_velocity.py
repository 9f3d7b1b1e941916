"""Velocities, displacements, shear stress and intensity in three dimensions: derivatives, tilted plane waves, energy, averages."""

import numpy as np
import pytest

import beamprop as bp

F, W = 2500.0, 2 * np.pi * 2500.0
LOSSY = bp.Slab(bp.lmmd_cell(), 45)
BEAM = bp.GaussianBeam((0.2, 0.1), 20, z0=-0.05, azimuth=30.0)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(30.0, 600.0), 0.05)


def derivative(slab, beam, place, along, frequency=F, step=1e-4):
    """Of p along an axis, by five points."""
    at = place[along] + step * np.array([-2, -1, 1, 2])
    p = bp.field(slab, beam, frequency, **(place | {along: at}), rtol=1e-11).p.values.ravel()
    return (p[0] - 8 * p[1] + 8 * p[2] - p[3]) / (12 * step)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
@pytest.mark.parametrize("where", ["in front", "inside", "behind"])
@pytest.mark.parametrize("beam", [BEAM, bp.Piston(0.1, z0=-0.05), bp.GaussianBeam(0.1, z0=-0.05)])
def test_i_w_rho_v_is_the_derivative_of_p(axis, where, beam):
    place = {"x": 0.1, "y": 0.05, "z": {"in front": -0.02, "inside": 0.02, "behind": 0.2}[where]}
    density = 30.0 if where == "inside" else bp.AIR.density
    v = bp.field(PLATE, beam, F, **place, variables=f"v_{axis}")[f"v_{axis}"].item()
    assert v == pytest.approx(derivative(PLATE, beam, place, axis) / (1j * W * density), rel=1e-6)


@pytest.mark.parametrize("names", [("v_x", "v_y", "v_z"), ("intensity_x", "intensity_y", "intensity_z")])
def test_turned_by_a_quarter_x_and_y_change_places(names):
    x, y, z = np.linspace(-0.6, 0.5, 9), np.linspace(-0.3, 0.7, 7), [0.02, 0.2]
    ds = bp.field(LOSSY, bp.GaussianBeam((0.2, 0.1), 30, z0=-0.1), F, x, z, y=y, rtol=1e-10, variables=list(names))
    beam = bp.GaussianBeam((0.1, 0.2), 30, z0=-0.1, azimuth=90.0)
    turned = bp.field(LOSSY, beam, F, -y[::-1], z, y=x, rtol=1e-10, variables=list(names))
    for name, as_name, sign in ((names[0], names[1], 1), (names[1], names[0], -1), (names[2], names[2], 1)):
        q = sign * np.swapaxes(turned[as_name].values, 1, 2)[:, ::-1]
        assert np.abs(q - ds[name].values).max() < 2e-10 * np.abs(ds[name].values).max()


def test_the_estimate_is_that_of_each_variable():
    """Against the same at a lower rtol, over the largest of each whole plane."""
    x, y, z = np.linspace(-1, 1, 21), np.linspace(-1, 1, 17), [0.05, 0.2]
    names = ["p", "v_x", "v_y", "v_z", "intensity"]
    exact = bp.field(LOSSY, BEAM, F, x, z, y=y, rtol=1e-11, variables=names)
    rough = bp.field(LOSSY, BEAM, F, x, z, y=y, rtol=1e-4, variables=names)
    for name in ("p", "v_x", "v_y", "v_z"):
        error = float((abs(rough[name] - exact[name]).max(("y", "x")) / abs(exact[name]).max(("y", "x"))).max())
        stated = float(rough["error_estimate" if name == "p" else f"error_estimate_{name}"])
        assert error / 3 < stated < 1e-4
        assert error > 1e-13
    for axis in "xyz":
        v, half = f"v_{axis}", (exact.p * np.conj(exact[f"v_{axis}"])).real / 2
        np.testing.assert_allclose(exact[f"intensity_{axis}"], half, atol=1e-9 * float(abs(half).max()))
        assert f"error_estimate_{v}" in rough


def test_without_loss_the_same_power_passes_through_every_plane():
    """intensity_z summed over planes, and the launched power of plane waves that propagate: R + T = 1."""
    beam, x = bp.GaussianBeam((0.25, 0.3), z0=-0.05), np.linspace(-1.6, 1.6, 81)
    slab = bp.Slab.uniform(bp.Fluid.from_speed(1.25, 250.0), 0.05, after=bp.Fluid.from_speed(2.0, 300.0))
    z = [-0.02, 0.03, 0.05, 0.15]
    ds = bp.field(slab, beam, F, x, z, y=x, variables="intensity_z")
    power = ds.intensity_z.sum(("x", "y")).values
    assert np.ptp(power) < 1e-6 * power[0]


def test_in_solids_displacements_and_stresses_follow_the_direction_of_the_wave():
    """A circular beam along the normal: u_x at (r, 0) is u_y at (0, r), and s_xz at it s_yz; the shear stress is 0 in water."""
    water, steel = bp.Fluid.from_speed(1000.0, 1480.0), bp.Solid(7900.0, 5900.0, 3200.0)
    plate = bp.Slab([bp.Layer(steel, 2e-3)], before=water, after=water)
    names = ["u_x", "u_y", "u_z", "s_xz", "s_yz"]
    r, z = np.array([0.0, 1e-3, 2e-3]), [1e-3, 4e-3]
    ds = bp.field(plate, bp.GaussianBeam(3e-3, z0=-2e-3), 1e6, r, z, y=r, variables=names)
    for along_x, along_y in (("u_x", "u_y"), ("s_xz", "s_yz")):
        largest = float(abs(ds[along_x]).max())
        assert float(abs(ds[along_x].values - np.swapaxes(ds[along_y].values, 1, 2)).max()) < 1e-7 * largest
        assert float(abs(ds[along_x][0]).max()) > 0
    assert not np.any(ds.s_xz.values[1] > 1e-6 * float(abs(ds.s_xz).max()))
    flat = bp.field(plate, bp.GaussianBeam((3e-3, 0.2), z0=-2e-3), 1e6, r, z, y=0.0, variables=names)
    in_2d = bp.field(plate, bp.GaussianBeam(3e-3, z0=-2e-3), 1e6, r, z, variables=["u_x", "u_z", "s_xz"])
    for name in in_2d.data_vars:
        if not name.startswith("error"):  # 4 a doubling: (3/200)^2
            assert float(abs(flat[name] - in_2d[name]).max()) < 3e-3 * float(abs(in_2d[name]).max())
    with pytest.raises(ValueError, match=r"^variables: expected an intensity at z in fluids"):
        bp.field(plate, bp.GaussianBeam(3e-3, z0=-2e-3), 1e6, r, z, y=0.0, variables="intensity_y")


@pytest.mark.parametrize("y", [0.05, [-0.1, 0.0, 0.2]])
def test_means_over_a_cell(y):
    """Of many planes inside the cell, 100 in each of its ten layers: the midpoint rule, whose error falls with their square."""
    cell = LOSSY.cell.thickness
    x, z = np.linspace(-0.2, 0.2, 5), 20.5 * cell
    means = bp.field(LOSSY, BEAM, F, x, [z], y=y, average="cell", variables=["p", "v_y"])
    inside = 20 * cell + cell * (np.arange(1000) + 0.5) / 1000
    values = bp.field(LOSSY, BEAM, F, x, inside, y=y, variables=["p", "v_y"]).mean("z")
    for name in ("p", "v_y"):
        assert float(abs(means[name][0] - values[name]).max()) < 1e-5 * float(abs(values[name]).max())
    assert means.attrs["average"] == "cell"


def test_refusals_name_what_there_is():
    plate = bp.Slab(bp.Layer(bp.Solid(7900.0, 5900.0, 3200.0), 1e-3), background=bp.Fluid.from_speed(1000.0, 1500.0))
    with pytest.raises(ValueError, match=r"got z = 0.0005 in a solid; power_through is the whole flux there$"):
        bp.field(plate, bp.GaussianBeam((0.01, 0.01)), 1e6, 0.0, 5e-4, y=0.0, variables="intensity")
    said = r"^variables: expected some of p, v_x, v_y, v_z, u_x, .*, power_through, intensity, got 'power'"
    with pytest.raises(ValueError, match=said):
        bp.field(LOSSY, BEAM, F, 0.0, 0.1, y=0.0, variables="power")
    with pytest.raises(ValueError, match=r"^variables: expected some of p, v_x, v_z, .*, got 'v_y'"):
        bp.field(LOSSY, bp.GaussianBeam(0.1), F, 0.0, 0.1, variables="v_y")
