"""Holograms: files of MATLAB's newer format, planes of a field that go on behind a plate, and what is recorded of many samples."""

import dataclasses
import hashlib
import json

import h5py
import numpy as np
import pytest

import beamprop as bp
from beamprop.study.fingerprint import parts_of

WATER = bp.Fluid.from_speed(1000.0, 1500.0)
PLATE = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=WATER)
FREQUENCY = 0.2e6
GRID = 0.002 * np.arange(-40, 41)  # 81 x 81 samples, more than are kept


def gauss(x, y, width=0.02):
    return np.exp(-(x**2 + y[:, None] ** 2) / width**2) * np.exp(1j * (40 * x + 25 * y[:, None]))


def hologram(factor=1.0):
    return bp.SourcePlane(GRID, GRID, factor * gauss(GRID, GRID), z0=-0.03)


def asked(source):
    return bp.field(PLATE, source, FREQUENCY, 0.0, 0.01, y=0.0, rtol=1e-3)


# --- files ------------------------------------------------------------------------------------------------


def as_matlab_7_3(path, **variables):
    """As MATLAB's save('-v7.3') writes: a block of 512 bytes in front of HDF5, by columns, complex numbers as pairs."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in variables.items():
            values = np.atleast_2d(values).T
            if np.iscomplexobj(values):
                pairs = np.empty(values.shape, [("real", "<f8"), ("imag", "<f8")])
                pairs["real"], pairs["imag"] = values.real, values.imag
                values = pairs
            file[name] = values
        file.create_group("#refs#")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM")


def test_matlab_7_3(tmp_path):
    x, y = GRID[:31], GRID[:21]
    path, p = tmp_path / "plane.mat", gauss(x, y)
    as_matlab_7_3(path, x=x, y=y[:, None], p=p)
    assert bp.SourcePlane.from_file(path, -0.01) == bp.SourcePlane(x, y, p, -0.01)
    tilted = bp.SourcePlane.from_file(path, -0.01, conjugate=True, angle=3.0, azimuth=20.0)
    assert tilted == bp.SourcePlane(x, y, p.conj(), -0.01, angle=3.0, azimuth=20.0)
    as_matlab_7_3(path, x=x, y=y, p_real=p.real, p_imag=p.imag)
    assert bp.SourcePlane.from_file(path) == bp.SourcePlane(x, y, p)
    as_matlab_7_3(path, x=x, y=y)
    with pytest.raises(ValueError, match=r"plane\.mat: expected variables x, y and p .* got no p in x, y"):
        bp.SourcePlane.from_file(path)
    as_matlab_7_3(path, x=x, y=y, p=p.T)
    with pytest.raises(ValueError, match=r"plane\.mat: expected p \(y, x\) .* its transpose"):
        bp.SourcePlane.from_file(path)


# --- a field from its own plane ---------------------------------------------------------------------------


def test_a_plane_behind_a_plate_goes_on_there():
    """As the field does, to what its rim leaves out, which is warned of with the number."""
    beam, measured, places, z = bp.GaussianBeam(0.03, 10, z0=-0.05), 0.03, GRID[20:61:10], np.array([0.04, 0.08])
    p = bp.field(PLATE, beam, FREQUENCY, GRID, [measured], y=GRID, azimuth=30.0, rtol=1e-7).p.sel(z=measured)
    size = np.abs(p.values)
    rim = max(v.max() for v in (size[0], size[-1], size[:, 0], size[:, -1])) / size.max()
    assert rim > 1e-4
    # z of the new question begins where the plane was measured: a hologram lies in front of the slab, which is of water here
    source = bp.SourcePlane.from_data(p, z0=-0.01)
    open_water = bp.Slab.uniform(WATER, 0.01, background=WATER)
    with pytest.warns(bp.AccuracyWarning, match=rf"got {rim:.1e} at the rim".replace("+", r"\+")):
        on = bp.field(open_water, source, FREQUENCY, places, z - measured - 0.01, y=places, rtol=1e-4).p.values
    known = bp.field(PLATE, beam, FREQUENCY, places, z, y=places, azimuth=30.0, rtol=1e-7).p.values
    assert np.max(np.abs(on - known)) < 3 * rim * np.max(np.abs(known))


def test_no_field_in_front_of_a_hologram():
    """Propagation backward is refused, by the name of the position."""
    with pytest.raises(
        ValueError, match=r"^z: expected positions not in front of the launch plane z0 = -0\.03, got -0\.05"
    ):
        bp.field(PLATE, hologram(), FREQUENCY, 0.0, [-0.05, 0.01], y=0.0)


# --- what is recorded -------------------------------------------------------------------------------------


def test_many_samples_are_told_by_their_checksum(tmp_path):
    """Shape, checksum, ends, steps and the file; the same after a file, and no source is made of them."""
    np.savez(tmp_path / "scan.npz", x=GRID, y=GRID, p=gauss(GRID, GRID))
    source = bp.SourcePlane.from_file(tmp_path / "scan.npz", -0.03)
    ds = asked(source)
    assert len(ds.attrs["provenance"]) < 3000
    bp.save(ds, tmp_path / "p.nc")
    told = bp.provenance(bp.load(tmp_path / "p.nc"))["beam"]
    assert told == bp.provenance(ds)["beam"]
    assert (told["source"], told["file"], told["z0"]) == ("SourcePlane", "scan.npz", -0.03)
    digest = hashlib.sha256(source.p.astype("<c16").tobytes(order="C")).hexdigest()
    assert told["p"] == {"shape": [81, 81], "dtype": "complex128", "sha256": digest}
    assert [told["y"][k] for k in ("shape", "from", "to")] == [[81], GRID[0], GRID[-1]]
    assert told["y"]["step"] == pytest.approx(0.002)


def test_changed_samples_are_no_longer_those_of_the_file(tmp_path):
    np.savez(tmp_path / "scan.npz", x=GRID, y=GRID, p=gauss(GRID, GRID))
    source = bp.SourcePlane.from_file(tmp_path / "scan.npz", -0.03)
    changed = dataclasses.replace(source, p=2 * source.p)
    records = [bp.provenance(asked(s))["beam"] for s in (source, changed)]
    assert "file" not in records[1]
    assert records[0]["p"]["sha256"] != records[1]["p"]["sha256"]


def many_elements():
    """2100 positions, 4200 numbers."""
    x, y = np.meshgrid(0.0005 * np.arange(-30, 30), 0.0005 * np.arange(-17, 18))
    return bp.Array(np.column_stack([x.ravel(), y.ravel()]), bp.GaussianBeam(0.02, z0=-0.03))


@pytest.mark.parametrize(
    ("source", "name", "within"),
    [
        (many_elements(), "Array", lambda told: told["positions"]["shape"] == [2100, 2]),
        (hologram() + 0.5 * bp.Piston(0.02, z0=-0.03), "SourceSum", lambda told: told["sources"][0]["p"]["sha256"]),
        (
            bp.Array([[0.0, 0.0], [0.01, 0.0]], hologram()),
            "Array",
            lambda told: told["element"]["source"] == "SourcePlane" and told["positions"]["array"][1] == [0.01, 0.0],
        ),
    ],
    ids=["elements", "sum", "element"],
)
def test_what_holds_many_samples_is_told_and_not_made(source, name, within):
    told = bp.provenance(asked(source))["beam"]
    assert told["source"] == name
    assert within(told)


def test_many_samples_on_a_line():
    x = np.linspace(-0.3, 0.3, 5001)
    told = bp.provenance(bp.beam_width(PLATE, bp.Profile(x, np.exp(-((x / 0.02) ** 2)), -0.03), FREQUENCY))["beam"]
    assert (told["source"], told["x"]["shape"], told["p"]["shape"]) == ("Profile", [5001], [5001])


def test_few_samples_are_kept_whole():
    x = GRID[8:72]  # 64 x 64, as many numbers as are kept
    source = bp.SourcePlane(x, x, gauss(x, x, 0.01), -0.03)
    assert bp.provenance(asked(source))["beam"] == source


def test_a_record_of_before_is_rebuilt():
    """Files that hold all samples of many, as they were written until now."""
    source = hologram()
    ds = asked(bp.Piston(0.01, z0=-0.03))
    values = {"x": source.x, "y": source.y}
    record = {"type": "SourcePlane"} | {k: {"array": v.tolist()} for k, v in values.items()}
    record["p"] = {"array": [[{"re": v.real, "im": v.imag} for v in row] for row in source.p.tolist()]}
    record |= {"z0": -0.03, "angle": 0.0, "azimuth": 0.0}
    ds.attrs["provenance"] = json.dumps(json.loads(ds.attrs["provenance"]) | {"beam": record})
    assert bp.provenance(ds)["beam"] == source


def test_studies_tell_holograms_apart(tmp_path):
    """By their values, wherever these came from."""
    np.savez(tmp_path / "scan.npz", x=GRID, y=GRID, p=gauss(GRID, GRID))

    def parts(source):
        return parts_of(lambda frequency: bp.field(PLATE, source, frequency, 0.0, 0.01, y=0.0))

    read = bp.SourcePlane.from_file(tmp_path / "scan.npz", -0.03)
    other = gauss(GRID, GRID)
    other[40, 40] *= 1 + 1e-12
    assert parts(read) == parts(hologram())
    assert parts(bp.SourcePlane(GRID, GRID, other, -0.03)) != parts(read)
