"""`variables` of `field` and `save_field`: what is in the dataset, in files and pictures, what is refused and warned of."""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest

import beamprop as bp

F = 2500.0
SLAB = bp.Slab(bp.lmmd_cell(), periods=20)
BEAM = bp.GaussianBeam(0.15, angle=10, z0=-0.05)
X, Z = np.linspace(-0.5, 0.5, 33), np.linspace(-0.05, 0.1, 12)
ALL = ("p", "v_x", "v_z", "intensity", "power_through")


def ask(variables, *, x=X, z=Z, **more):
    return bp.field(SLAB, BEAM, F, x, z, variables=variables, **more)


def test_the_pressure_alone_is_what_it_was():
    """The default, by name or not, alone or beside others: the same bits, and nothing else in the dataset."""
    plain = bp.field(SLAB, BEAM, F, X, Z)
    assert list(plain) == ["p", "error_estimate"]
    assert "variables" not in bp.provenance(plain)
    assert ask("p").identical(plain)
    assert ask(["p", "v_x"]).p.equals(plain.p)
    assert ask(["v_x", "p"]).error_estimate.equals(plain.error_estimate)


def test_names_units_and_dimensions():
    """Intensity stands for both components; every variable has its error, power none of x."""
    ds = ask(ALL, angle=[0.0, 10.0])
    names = ["p", "v_x", "v_z", "intensity_x", "intensity_z", "power_through"]
    assert list(ds) == names + ["error_estimate"] + [f"error_estimate_{n}" for n in names[1:]]
    assert [ds[n].attrs["units"] for n in names] == ["Pa", "m/s", "m/s", "W/m^2", "W/m^2", "W/m"]
    assert all(ds[n].attrs["long_name"] for n in ds)
    assert all(ds[n].dims == ("angle", "z", "x") for n in names[:-1])
    assert ds.power_through.dims == ("angle", "z")
    assert all(ds[n].dims == ("angle",) for n in ds if n.startswith("error"))
    assert ds.intensity_x.dtype == ds.power_through.dtype == float
    assert bp.provenance(ds)["variables"] == tuple(names)
    for name, v in (("intensity_x", "v_x"), ("intensity_z", "v_z")):
        np.testing.assert_allclose(ds[name], (ds.p * np.conj(ds[v])).real / 2, rtol=1e-13, atol=1e-20)
    periodic = ask(ALL, boundary="periodic", period=2.0)
    assert list(periodic) == names
    scalar = ask(ALL, x=0.0, z=0.01)
    assert all(scalar[n].dims == () for n in scalar)
    assert ask("power_through").power_through.equals(ask(ALL).power_through)


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_files(tmp_path, ending):
    """Saved whole or block by block, loaded again: the same values."""
    asked = {"angle": [0.0, 10.0], "variables": ALL}
    ds = bp.field(SLAB, BEAM, [F, 2600.0], X, Z, **asked)
    bp.save(ds, tmp_path / f"whole.{ending}")
    assert bp.load(tmp_path / f"whole.{ending}").identical(ds)
    path = tmp_path / f"blocks.{ending}"
    rest = bp.save_field(path, SLAB, BEAM, [F, 2600.0], X, Z, memory=2**13, **asked)
    loaded = bp.load(path)
    assert set(loaded) == set(ds)
    assert loaded.attrs == ds.attrs
    for name in ds:
        assert loaded[name].dims == ds[name].dims
        assert loaded[name].attrs == ds[name].attrs
        np.testing.assert_allclose(loaded[name], ds[name], rtol=1e-9, atol=1e-13 * float(np.abs(ds[name]).max()))
    assert set(rest) == {"power_through"} | {n for n in ds if n.startswith("error")}
    bp.save_field(path, SLAB, BEAM, F, X, 0.01, variables="intensity_z")
    assert bp.load(path).intensity_z.dims == ("x",)


def test_pictures_and_comparisons():
    """A dataset with velocities is drawn and compared by its pressure; one without says what is missing."""
    ds = ask(ALL)
    bp.plot.field(ds)
    plt.close("all")
    assert float(bp.compare(ds, ask("p")).relative_l2) < 1e-8
    with pytest.raises(ValueError, match=r"^b: expected a dataset with the pressure p, got v_x, error_estimate_v_x$"):
        bp.compare(ds, ask("v_x"))


REFUSED = {
    "an unknown name": ("v_y", "'v_y'"),
    "one among others": (["p", "velocity"], "'velocity'"),
    "none": ([], "[]"),
    "a number": (3, "3"),
    "no name": (["p", None], "None"),
    "True": (True, "True"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals(name, tmp_path):
    """They name `variables`, what it takes, and what came; no file is begun."""
    given, shown = REFUSED[name]
    said = f"variables: expected some of p, v_x, v_z, u_x, u_z, s_xz, intensity_x, intensity_z, power_through, intensity, got {shown}"
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        ask(given)
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        bp.save_field(tmp_path / "a.nc", SLAB, BEAM, F, X, Z, variables=given)
    assert not list(tmp_path.iterdir())


def test_power_that_takes_too_many_plane_waves():
    """An edge on the face of a slab with loss radiates without end into it; a slab of a million wavelengths takes too long."""
    said = r"^variables: expected power_through of at most 6e\+04 plane waves, got .*: take a thinner slab, or bring"
    with pytest.raises(ValueError, match=said):
        bp.field(SLAB, bp.Slits(0.02, 0.05), F, 0.0, 0.1, variables="power_through")
    with pytest.raises(ValueError, match=said):
        bp.field(bp.Slab.uniform(bp.AIR, 1e6), BEAM, F, 0.0, 0.1, variables="power_through")
    far = bp.GaussianBeam(0.15, z0=-1e6)  # a long way through a medium without loss changes no power
    near = bp.GaussianBeam(0.15, z0=-1.0)
    powers = [
        bp.field(SLAB, beam, F, 0.0, [-0.5, 0.1], variables="power_through").power_through for beam in (far, near)
    ]
    np.testing.assert_allclose(*powers, rtol=1e-6)


def test_warnings_name_the_variable():
    """With no more than 1e-12 to be had, each variable is warned of by itself, and an intensity by its scale."""
    with pytest.warns(bp.AccuracyWarning) as seen:
        # the rounding of phases over 300 m is more than that
        ds = bp.field(
            SLAB, bp.GaussianBeam(5.0, z0=-300.0), F, X, [0.0, 0.1], rtol=1e-12, variables=["p", "v_z", "intensity_x"]
        )
    for name, scale in (
        ("p", "the largest |p|"),
        ("v_z", "the largest |v_z|"),
        ("intensity_x", "intensity_x: half the"),
    ):
        error = float(ds["error_estimate" if name == "p" else f"error_estimate_{name}"])
        said = [str(w.message) for w in seen if f" of {scale}" in str(w.message)]
        assert len(said) == (error > 1e-12), (name, error, said)
        assert error > 1e-12
        assert "mostly: " in said[0]
        assert seen[0].filename == __file__
