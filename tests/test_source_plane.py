"""Sampled planes: point sources summed one by one, a polar quadrature through a slab, files, and what has not ended."""

import h5py
import numpy as np
import pytest
import scipy.interpolate
import scipy.io
import xarray as xr
from accuracy_study.reference.medium import Medium
from space_oracles import straight_bend

import beamprop as bp

FREQUENCY, K = 2500.0, 2 * np.pi * 2500 / 343.0
LOSSLESS, AIR = bp.Slab(bp.lmmd_cell(0.05, 0), 45), bp.Slab.uniform(bp.AIR, 0.1)
X, Y = np.array([-0.5, 0.0, 0.07, 0.4]), np.array([-0.3, 0.02, 0.5])


def hologram(seed=1, dx=0.011, dy=0.012, z0=-0.1):
    """Random waves up to 0.4 of the Nyquist wavenumbers in a window that has ended at the rim, off the origin."""
    rng = np.random.default_rng(seed)
    x, y = 0.04 + dx * np.arange(-32, 33), -0.03 + dy * np.arange(-30, 31)
    p = 0
    for kx, ky, a in zip(*rng.uniform(-100, 100, (2, 9)), rng.normal(size=9) + 1j * rng.normal(size=9), strict=True):
        p = p + a * np.exp(1j * (kx * x + ky * y[:, None]))
    window = np.exp(-(((x - 0.04) / 0.06) ** 2) - ((y[:, None] + 0.03) / 0.055) ** 2)
    return bp.SourcePlane(x, y, p * window, z0)


def summed_points(source, z):
    """Each sample a point of Rayleigh's first integral: -(1/2 pi) d/dz exp(ikR)/R, times dx dy; (Z, Y, X)."""
    weight = source.p * (source.x[1] - source.x[0]) * (source.y[1] - source.y[0]) / (2 * np.pi)
    out = np.empty((z.size, Y.size, X.size), complex)
    for i, c in enumerate(z - source.z0):
        for j, b in enumerate(Y):
            for n, a in enumerate(X):
                r = np.sqrt((a - source.x) ** 2 + (b - source.y[:, None]) ** 2 + c**2)
                out[i, j, n] = np.sum(weight * c / r**2 * (1 / r - 1j * K) * np.exp(1j * K * r))
    return out


def errors(p, known):
    return np.max(np.abs(p - known), axis=(1, 2)) / np.max(np.abs(known), axis=(1, 2))


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
def test_in_air_it_is_its_points(rtol):
    source, z = hologram(), np.array([0.1, 1.0, 4.0])
    ds = bp.field(AIR, source, FREQUENCY, X, z, y=Y, rtol=rtol)
    assert np.max(errors(ds.p.values, summed_points(source, z))) < rtol
    assert float(ds.error_estimate) < rtol


def test_tilted_samples_are_samples_with_that_phase():
    source, z = hologram(), np.array([0.1, 1.0])
    along = np.cos(np.radians(70)) * (source.x - source.x0) + np.sin(np.radians(70)) * (source.y - source.y0)[:, None]
    p = bp.field(AIR, source, FREQUENCY, X, z, angle=[0, 20], y=Y, azimuth=70.0, rtol=1e-9).p.values[1]
    tilted = bp.SourcePlane(source.x, source.y, source.p * np.exp(1j * K * np.sin(np.radians(20)) * along), source.z0)
    assert np.max(errors(p, summed_points(tilted, z))) < 1e-9


@pytest.mark.parametrize("slab", [LOSSLESS, bp.Slab(bp.lmmd_cell(), 45)], ids=["lossless", "lossy"])
def test_through_a_slab_by_a_polar_quadrature(slab):
    """The samples' spectrum term by term at complex wavenumbers, over radius and direction."""
    source, z = hologram(2), np.array([0.05, slab.thickness, slab.thickness + 0.3])
    k, w = straight_bend(220.0, 3.0, 0.5 * K, 40)
    turn = 2 * np.pi * np.arange(240) / 240
    kx, ky = (np.multiply.outer(k, v).ravel() for v in (np.cos(turn), np.sin(turn)))
    of_y = np.exp(-1j * np.outer(ky, source.y)) @ source.p
    spectrum = np.sum(of_y * np.exp(-1j * np.outer(kx, source.x)), axis=1) * 0.011 * 0.012
    strength = spectrum.reshape(k.size, -1) * (k * w)[:, None] / (240 * 2 * np.pi)
    rings = [(strength * np.exp(1j * (kx * a + ky * b)).reshape(strength.shape)).sum(axis=1) for b in Y for a in X]
    known = (Medium(slab, FREQUENCY).response(k, z, source.z0) @ np.transpose(rings)).reshape(z.size, Y.size, X.size)
    ds = bp.field(slab, source, FREQUENCY, X, z, y=Y, rtol=1e-8)
    assert np.max(errors(ds.p.values, known)) < 1e-8
    assert float(ds.error_estimate) < 1e-8


def test_the_launched_plane_is_given_back():
    source = hologram()
    p = bp.field(AIR, source, FREQUENCY, source.x[20:40:3], source.z0, y=source.y[18:40:4], rtol=1e-8).p.values
    assert np.max(np.abs(p - source.p[18:40:4, 20:40:3])) < 1e-8 * np.abs(source.p).max()


def test_a_field_goes_on_from_its_own_plane():
    """A plane of a beam in air, sampled, gives the beam's field behind it."""
    beam, grid = bp.GaussianBeam(0.1, 10, z0=-0.2), 0.02 * np.arange(-60, 61)
    plane = bp.field(AIR, beam, FREQUENCY, grid, -0.1, y=grid, rtol=1e-9)
    source = bp.SourcePlane.from_data(plane.p, z0=-0.1)
    with pytest.warns(bp.AccuracyWarning, match=r"^p: expected samples that end to rtol 1\.0e-03 .* at the rim"):
        p = bp.field(LOSSLESS, source, FREQUENCY, X, [0.05, 0.3], y=Y, rtol=1e-3).p.values
    known = bp.field(LOSSLESS, beam, FREQUENCY, X, [0.05, 0.3], y=Y, rtol=1e-9).p.values
    assert np.max(errors(p, known)) < 2e-2


# --- what has not ended -----------------------------------------------------------------------------------


def test_samples_that_have_not_ended_are_warned_of_with_the_number():
    """|p| at the rim is exp(-6.25), over exp(-0.25) at 0.02 m, the coarse samples nearest to the middle."""
    x = np.linspace(-0.1, 0.1, 41)
    coarse = bp.SourcePlane(x[::8], x, np.exp(-(x[::8] ** 2 + x[:, None] ** 2) / 0.04**2), -0.02)
    with pytest.warns(bp.AccuracyWarning) as warned:
        bp.field(AIR, coarse, FREQUENCY, 0.0, 0.2, y=0.0, rtol=1e-6)
    assert "got 2.5e-03 at the rim, 2.6e-05 at the Nyquist wavenumber: what lies beyond" in str(warned[0].message)
    assert "estimated error" in str(warned[1].message)


def test_a_disc_of_samples_is_a_soft_piston():
    """Its spectrum does not end at the Nyquist wavenumber, where waves decay by exp(-2.6e2) on the way: nothing to warn of."""
    dx = 0.001
    x = dx * np.arange(-62, 63)
    disc = bp.SourcePlane(x, x, (np.hypot(x, x[:, None]) <= 0.05).astype(float), -0.1)
    ds = bp.field(AIR, disc, FREQUENCY, X, [0.0, 0.3], y=Y, rtol=1e-6)
    assert float(ds.error_estimate) < 1e-6
    assert np.max(errors(ds.p.values, summed_points(disc, np.array([0.0, 0.3])))) < 1e-6
    area = disc.p.real.sum() * dx**2
    piston = bp.field(AIR, bp.Piston(np.sqrt(area / np.pi), "soft", z0=-0.1), FREQUENCY, X, [0.0, 0.3], y=Y)
    assert np.max(errors(ds.p.values, piston.p.values)) < 1e-3


WIDTH, GAP = 0.004, slice(33, 48)  # a spot, and where a scan lost its middle
SCAN = 5e-4 * np.arange(-40, 41)
KEPT = np.delete(SCAN, np.arange(81)[GAP])
WATER = bp.Slab.uniform(bp.Fluid.from_speed(1000.0, 1500.0), 5e-3, background=bp.Fluid.from_speed(1000.0, 1500.0))


def spot(x, y):
    return np.exp(-(x**2 + np.asarray(y)[:, None] ** 2) / WIDTH**2)


def guessed():
    """|S| at pi over the gap's 8 mm over that at 0, of the spline through what is left of the spot along one axis."""
    fine = np.linspace(SCAN[0], SCAN[-1], 4001)
    p = scipy.interpolate.CubicSpline(KEPT, np.exp(-((KEPT / WIDTH) ** 2)))(fine)
    return abs(np.sum(p * np.exp(-1j * np.pi / 0.008 * fine))) / np.sum(p)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_gap_is_warned_of_by_the_nyquist_wavenumber_of_the_largest_step(axis):
    x, y = (KEPT, SCAN) if axis == "x" else (SCAN, KEPT)
    holed = bp.SourcePlane(x, y, spot(x, y), -0.02)
    for source in (holed, holed + bp.GaussianBeam((0.01, 0.01), z0=-0.02)):
        with pytest.warns(
            bp.AccuracyWarning, match=rf"step of {axis} \(0.008 m, behind -0.004 m\): .* a guess"
        ) as warned:
            bp.field(WATER, source, 2e5, 0.0, 0.02, y=0.0, rtol=1e-3)
        share = float(str(warned[0].message).split("got ")[1].split(" beyond")[0])
        assert share == pytest.approx(guessed(), rel=0.1)
    whole = bp.SourcePlane(SCAN, SCAN, spot(SCAN, SCAN), -0.02)
    with pytest.warns(bp.AccuracyWarning):  # and the answer is indeed wrong
        p = bp.field(WATER, holed, 2e5, 0.0, 0.02, y=0.0, rtol=1e-3).p
    assert abs(p / bp.field(WATER, whole, 2e5, 0.0, 0.02, y=0.0, rtol=1e-3).p - 1) > 0.1


def test_a_gap_in_a_profile_is_warned_of():
    plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 5e-3, background=WATER.before)
    holed = bp.Profile(KEPT, np.exp(-((KEPT / WIDTH) ** 2)), -0.02)
    for source in (holed, holed + bp.GaussianBeam(0.01, z0=-0.02)):
        for asked in (
            lambda beam: bp.field(plate, beam, 2e5, 0.0, 0.02, rtol=1e-3),
            lambda beam: bp.beam_width(plate, beam, 2e5, rtol=1e-3),
            lambda beam: bp.beam_measures(plate, beam, 2e5, rtol=1e-3, window=0.1),
        ):
            with pytest.warns(bp.AccuracyWarning, match=r"step of x \(0.008 m, behind -0.004 m\)") as warned:
                asked(source)
            share = float(str(warned[0].message).split("got ")[1].split(" beyond")[0])
            assert share == pytest.approx(guessed(), rel=0.1)


def test_uneven_steps_that_sample_a_spot_well_are_not_warned_of():
    """Whose spectrum has ended at the Nyquist wavenumber of the largest step, 0.5 mm; and steps that are even to printed digits."""
    uneven = 0.012 * np.sinh(np.linspace(-1, 1, 61)) / np.sinh(1)
    printed = np.round(np.linspace(-0.012, 0.012, 56), 6)
    for x in (uneven, printed):
        bp.field(WATER, bp.SourcePlane(x, x, spot(x, x), -0.02), 2e5, 0.0, 0.02, y=0.0, rtol=1e-3)
        bp.field(WATER, bp.Profile(x, np.exp(-((x / WIDTH) ** 2)), -0.02), 2e5, 0.0, 0.02, rtol=1e-3)


# --- records and files ------------------------------------------------------------------------------------


def test_uneven_samples_are_brought_onto_even_ones():
    x = 0.2 * np.sinh(np.linspace(-1, 1, 61)) / np.sinh(1)
    y = np.linspace(-0.2, 0.2, 51)
    source = bp.SourcePlane(x, y, np.exp(-(x**2 + y[:, None] ** 2) / 0.05**2))
    steps = np.diff(source.x)
    assert np.ptp(steps) < 1e-12
    assert source.p == pytest.approx(np.exp(-(source.x**2 + y[:, None] ** 2) / 0.05**2), abs=1e-5)


def write(path, x, y, p):
    if path.suffix == ".mat":
        scipy.io.savemat(path, {"x": x, "y": y, "p": p})
    elif path.suffix == ".npz":
        np.savez(path, x=x, y=y, p=p)
    else:
        ds = {
            "p_real": (("row", "column"), p.real),
            "p_imag": (("row", "column"), p.imag),
            "x": ("i", x),
            "y": ("j", y),
        }
        xr.Dataset(ds).to_netcdf(path)


@pytest.mark.parametrize("ending", [".mat", ".npz", ".nc"])
def test_from_files(tmp_path, ending):
    source, path = hologram(), tmp_path / f"plane{ending}"
    write(path, source.x, source.y, source.p)
    assert bp.SourcePlane.from_file(path, -0.1) == source
    assert bp.SourcePlane.from_file(path, -0.1, conjugate=True).p == pytest.approx(np.conj(source.p))
    write(path, source.y, source.x, source.p)
    with pytest.raises(ValueError, match=rf"plane{ending}: expected p \(y, x\) .* its transpose"):
        bp.SourcePlane.from_file(path)
    path.write_bytes(b"no such thing")
    with pytest.raises(ValueError, match=rf"plane{ending}: expected a {ending} file, got one that cannot be read"):
        bp.SourcePlane.from_file(path)


@pytest.mark.parametrize("ending", [".nc", ".mat"])
def test_planes_that_were_saved_come_back(tmp_path, ending):
    ds = bp.field(AIR, bp.GaussianBeam(0.1, z0=-0.1), FREQUENCY, X, -0.1, y=Y)
    bp.save(ds, tmp_path / f"plane{ending}")
    read = bp.SourcePlane.from_file(tmp_path / f"plane{ending}", -0.1)
    assert read == bp.SourcePlane.from_data(ds.p, -0.1)
    assert bp.SourcePlane.from_data(ds.p.transpose("x", "y"), -0.1) == read


def test_provenance_brings_it_back(tmp_path):
    source = hologram()
    bp.save(bp.field(AIR, source, FREQUENCY, 0.0, 0.1, y=0.0), tmp_path / "p.nc")
    assert bp.provenance(bp.load(tmp_path / "p.nc"))["beam"] == source


def test_files_are_refused_by_what_they_lack(tmp_path):
    for path, held, message in (
        ("a.npz", {"x": X, "y": Y}, "got no p in x, y"),
        ("b.npz", {"x": X, "p": np.ones((3, 4))}, "got no y in p, x"),
        ("c.npz", {"x": X, "y": Y, "p": np.ones((3, 5))}, r"p: expected an array \(y, x\)"),
    ):
        np.savez(tmp_path / path, **held)
        with pytest.raises(ValueError, match=rf"{path}: .*{message}"):
            bp.SourcePlane.from_file(tmp_path / path)
    with h5py.File(tmp_path / "d.nc", "w") as file:
        file["x"], file["y"], file["p"] = X, Y, np.ones((3, 4))
        file["p"].attrs["scale_factor"] = 2.0
    with pytest.raises(ValueError, match=r"d\.nc: expected values as they are, got p with a scale"):
        bp.SourcePlane.from_file(tmp_path / "d.nc")
    with pytest.raises(ValueError, match=r"^path: expected a file \.mat, \.npz, \.nc"):
        bp.SourcePlane.from_file("plane.txt")
    for kind, name in ((bp.SourcePlane, "none.npz"), (bp.Profile, "none.txt")):
        with pytest.raises(FileNotFoundError, match=rf"^path: expected an existing file, got '.*{name}'") as missing:
            kind.from_file(tmp_path / name)
        assert missing.value.filename == str(tmp_path / name)
        assert missing.value.strerror == "No such file or directory"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"x": [0.0]}, r"x: expected a 1-D array of at least 2"),
        ({"y": [0.0, 0.0, 1.0]}, "y: expected"),
        ({"p": np.ones((4, 3))}, r"p: expected an array \(y, x\) of shape \(3, 4\), got \(4, 3\)"),
        ({"p": np.full((3, 4), np.nan)}, "p: expected finite"),
        ({"p": np.zeros((3, 4))}, "p: expected a plane that is not zero"),
        ({"z0": 0.1}, "z0: expected a launch plane in front"),
        ({"angle": 95}, "angle: expected"),
        ({"azimuth": "east"}, "azimuth: expected"),
    ],
)
def test_arguments_are_checked(changes, message):
    with pytest.raises(ValueError, match=f"^{message}"):
        bp.SourcePlane(**({"x": X, "y": Y, "p": np.ones((3, 4))} | changes))


def test_data_are_checked():
    with pytest.raises(ValueError, match=r"^plane: expected a DataArray along y and x, got \('z', 'x'\)"):
        bp.SourcePlane.from_data(xr.DataArray(np.ones((2, 3)), dims=("z", "x")))
    p = xr.DataArray(np.ones((3, 4)), {"x": ("x", X, {"units": "mm"}), "y": Y}, dims=("y", "x"))
    with pytest.raises(ValueError, match=r"^plane: expected x in m, got 'mm'"):
        bp.SourcePlane.from_data(p)
    with pytest.raises(ValueError, match=r"^beam: expected one on which nothing depends on y"):
        bp.field(AIR, hologram(), FREQUENCY, 0.0, 0.1)
