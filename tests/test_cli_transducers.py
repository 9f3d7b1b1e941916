"""Sources in three dimensions on the command line and in study files: each beside the call that asks the same."""

import json

import numpy as np
import pytest
from command import from_json, good, run
from scipy.io import savemat

import beamprop as bp

WATER = bp.material("water")
PLATE = bp.Slab([bp.Layer(bp.material("acrylic"), 0.0065)], before=WATER, after=WATER)
AROUND = ["--layer", "acrylic 6.5mm", "--background", "water", "--frequency", "0.5MHz", "--rtol", "1e-6"]
AT = ["--x=-1cm:1cm:5", "--y", "0,5mm", "--z", "2cm"]
GRID = np.linspace(-0.02, 0.02, 41)
HOLOGRAM = np.exp(-(GRID**2 + GRID[:, None] ** 2) / 0.005**2) * (1 + 40j * GRID)
POSITIONS = np.array([[0.0, 0.0], [0.01, 0.005]])
SOURCES = {
    "piston": (["--piston", "1cm"], bp.Piston(0.01, z0=-0.03)),
    "soft": (["--piston", "1cm", "--baffle", "soft", "--x0", "2mm"], bp.Piston(0.01, "soft", x0=0.002, z0=-0.03)),
    "loud": (["--piston", "1cm", "--pressure", "60e3"], bp.Piston(0.01, pressure=60e3, z0=-0.03)),
    "bowl": (["--bowl", "64mm,30mm", "--y0", "1mm"], bp.Bowl(0.064, 0.03, y0=0.001, z0=-0.03)),
    "ellipse": (
        ["--fwhm", "10mm,6mm", "--azimuth", "30", "--angle", "10"],
        bp.GaussianBeam((0.01, 0.006), 10, azimuth=30, z0=-0.03),
    ),
    "circle": (["--fwhm", "8mm"], bp.GaussianBeam(0.008, z0=-0.03)),
    "plane": (["--source-plane", "hologram.mat"], bp.SourcePlane(GRID, GRID, HOLOGRAM, -0.03)),
    "turned": (
        ["--source-plane", "hologram.mat", "--conjugate"],
        bp.SourcePlane(GRID, GRID, HOLOGRAM.conj(), -0.03),
    ),
    "array": (["--array", "array.csv", "--piston", "3mm"], bp.Array(POSITIONS, bp.Piston(0.003, z0=-0.03), [1, 0.5j])),
}


@pytest.fixture(autouse=True)
def files(tmp_path, monkeypatch):
    """A hologram and an array in the folder of the command."""
    monkeypatch.chdir(tmp_path)
    savemat("hologram.mat", {"x": GRID, "y": GRID, "p": HOLOGRAM})
    (tmp_path / "array.csv").write_text("# x, y, Re w, Im w\n0,0,1,0\n0.01,0.005,0,0.5\n")


@pytest.mark.parametrize("name", SOURCES)
def test_it_asks_what_python_asks_and_so_does_its_study(name):
    options, source = SOURCES[name]
    z0 = ["--z0=-3cm"]
    printed = good(
        "field", *AROUND, *AT, *z0, *options, "--json", "--save-study", "study.toml", "--output", "a.nc"
    ).stdout
    known = bp.field(PLATE, source, 0.5e6, np.linspace(-0.01, 0.01, 5), 0.02, y=[0.0, 0.005], rtol=1e-6)
    p = from_json(json.loads(printed)["data_vars"]["p"]["data"])
    np.testing.assert_array_equal(p, known.p.values)
    good("run", "study.toml")
    assert bp.load("a.nc").p.identical(bp.load("a.nc").p.copy(data=known.p.values))


@pytest.mark.parametrize("question", ["beam_width", "beam_measures"])
@pytest.mark.parametrize("name", ["ellipse", "piston"])
def test_widths_are_those_of_python(name, question):
    """As numbers, and as a text that has every axis."""
    options, source = SOURCES[name]
    known = getattr(bp, question)(PLATE, source, 0.1e6, rtol=1e-6)
    held = json.loads(good(question, *AROUND, "--frequency", "0.1MHz", "--z0=-3cm", *options, "--json").stdout)[
        "data_vars"
    ]
    for variable in known:
        np.testing.assert_array_equal(from_json(held[variable]["data"]), known[variable].values)
    said = good(question, *AROUND, "--frequency", "0.1MHz", "--z0=-3cm", *options).stdout
    widths = known.fwhm_out * 100 if question == "beam_width" else known.fwhm.sel(side="transmitted")
    assert all(f"{float(v):.6g}"[:5] in said for v in widths)


def test_a_lattice_and_its_study():
    """Two periods, as text and in a study."""
    options = ["--fwhm", "8mm", "--z0=-3cm", "--boundary", "periodic", "--period", "5cm,6cm"]
    good("field", *AROUND, *AT, *options, "--output", "a.nc", "--save-study", "study.toml")
    at = {"x": np.linspace(-0.01, 0.01, 5), "z": 0.02, "y": [0.0, 0.005], "rtol": 1e-6}
    known = bp.field(PLATE, SOURCES["circle"][1], 0.5e6, **at, boundary="periodic", period=(0.05, 0.06))
    first = bp.load("a.nc")
    np.testing.assert_array_equal(first.p.values, known.p.values)
    good("run", "study.toml")
    assert bp.load("a.nc").p.identical(first.p)


def test_volumes_written_by_blocks_are_compared():
    volume = ["--fwhm", "8mm", "--z0=-3cm", "--x=-1cm:1cm:9", "--y=-1cm:1cm:7", "--z", "1cm:2cm:4"]
    good("field", *AROUND, *volume, "--output", "whole.nc")
    good("field", *AROUND, *volume, "--output", "blocks.nc", "--memory", "1")
    compared = json.loads(good("compare", "whole.nc", "blocks.nc", "--json").stdout)["data_vars"]
    assert compared["relative_l2"]["data"] < 1e-12


def test_without_y_it_is_the_cut_through_the_middle():
    ds = json.loads(
        good("field", *AROUND, "--piston", "1cm", "--y0", "2mm", "--z0=-3cm", "--x", "0", "--z", "2cm", "--json").stdout
    )
    assert ds["coords"]["y"]["data"] == 0.002


@pytest.mark.parametrize(
    "axes",
    [
        ["--x=-1cm:1cm:9", "--z", "1cm:2cm:5"],
        ["--x=-1cm:1cm:9", "--y=-1cm:1cm:9", "--z", "2cm"],
        ["--x=-1cm:1cm:9", "--y=-1cm:1cm:9", "--z", "1cm:2cm:5"],
    ],
    ids=["cut", "plane", "volume"],
)
def test_pictures(axes, tmp_path):
    good("field", *AROUND, "--piston", "1cm", "--z0=-3cm", *axes, "--plot", "a.png", "--save-study", "study.toml")
    assert (tmp_path / "a.png").stat().st_size > 5000
    (tmp_path / "a.png").unlink()
    good("run", "study.toml")
    assert (tmp_path / "a.png").stat().st_size > 5000


def test_leaky_modes():
    """With the solid plate that has them."""
    plate = ["--layer", "solid steel 1mm", "--background", "water", "--frequency", "3MHz", "--strip-over-k0", "0.12"]
    ran = good("guided_modes", *plate, "--leaky", "--json", "--save-study", "study.toml", "--output", "a.nc")
    slab = bp.Slab(bp.Layer(bp.Solid.from_material("steel"), 1e-3), background=bp.material("water"))
    known = bp.guided_modes(slab, 3e6, strip_over_k0=0.12, leaky=True).kx_over_k0.values
    assert known.size > 3
    np.testing.assert_allclose(from_json(json.loads(ran.stdout)["data_vars"]["kx_over_k0"]["data"]), known, rtol=1e-12)
    good("run", "study.toml")
    np.testing.assert_allclose(bp.load("a.nc").kx_over_k0, known, rtol=1e-12)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--baffle", "soft"], "--baffle: expected to be left out without"),
        (["--piston", "1cm", "--fwhm", "3cm"], "--fwhm: expected to be left out beside --piston, got 0.03"),
        (["--piston", "1cm", "--slits", "1mm,2mm"], "--piston: expected to be left out beside --slits"),
        (["--piston", "-1cm"], "--piston: expected a finite number above zero"),
        (
            ["--piston", "1cm", "--angle", "10"],
            "--angle: expected 0 with a Piston, which is not steered (an Array of them is; tilted transducers are not available), got 10",
        ),
        (["--pressure", "2"], "--pressure: expected to be left out without"),
        (["--conjugate"], "--conjugate: expected to be left out without"),
        (["--piston", "1cm", "--conjugate"], "--conjugate: expected to be left out beside --piston"),
        (["--piston", "1cm", "--pressure", "0"], "--pressure: expected a finite number other than 0, got 0"),
        (["--bowl", "1cm"], "--bowl: expected radius_of_curvature,aperture such as 64mm,64mm, got '1cm'"),
        (["--bowl", "1cm,3cm"], "--bowl: expected at most twice the radius_of_curvature, 0.02, got 0.03"),
        (["--fwhm", "1cm,2cm,3cm"], "--fwhm: expected a width, or two widths along x and y"),
        (["--array", "none.csv"], "--array: expected a text file that can be read, got 'none.csv'"),
        (["--array", "array.csv", "--x0", "1cm"], "--x0: expected to be left out beside --array, got 0.01"),
        (["--source-plane", "array.csv"], "--source-plane: expected a file .mat, .npz, .nc, got 'array.csv'"),
        (
            ["--piston", "1cm", "--plot", "a.png"],
            "--plot: expected axes for two or three of --x, --y and --z, got one value",
        ),
        (["--piston", "1cm", "--variables", "power"], "--variables: expected"),
        (
            ["--boundary", "periodic", "--period", "1cm"],
            "--period: expected two lengths (Lx, Ly) [m] where y is given, got 0.01",
        ),
        (["--period", "1cm,2cm,3cm"], "--period: expected a length, or two lengths along x and y such as 30mm,15mm"),
    ],
)
def test_wrong_use(options, said, tmp_path):
    before = sorted(p.name for p in tmp_path.iterdir())
    result = run("field", *AROUND, "--z0=-3cm", "--x", "0", "--y", "0", "--z", "2cm", *options, "--output", "out.nc")
    assert result.exit_code == 2
    assert said in result.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_a_solid_behind_by_its_numbers():
    numbers = ["--after-density", "7800", "--after-speed", "5900", "--after-shear-speed", "3200"]
    options = ["--layer", "acrylic 2mm", "--background", "water", "--frequency", "1MHz", "--angle", "0,10,20"]
    ds = json.loads(good("scattering", *options, *numbers, "--json", "--save-study", "solid.toml").stdout)
    slab = bp.Slab([bp.Layer(bp.material("acrylic"), 0.002)], before=WATER, after=bp.Solid(7800, 5900, 3200))
    known = bp.scattering(slab, 1e6, angle=[0, 10, 20])
    np.testing.assert_array_equal(from_json(ds["data_vars"]["r"]["data"]), known.r.values)
    good("check", "solid.toml")
    for left, said in ((4, "--after-speed: expected a number beside"), (2, "--after-density: expected a number")):
        kept = numbers[:2] + numbers[4:] if left == 4 else numbers[2:]
        result = run("scattering", *options, *kept)
        assert (result.exit_code, said in result.stderr) == (2, True)
    result = run("scattering", *options, "--after", "steel", *numbers[4:])
    assert "--after: expected to be left out beside --after-shear-speed" in result.stderr


def test_the_explorer_refuses_what_it_cannot_show():
    from beamprop.explorer.controls import board
    from beamprop.study.files import read

    good("field", *AROUND, *AT, "--piston", "1cm", "--z0=-3cm", "--save-study", "study.toml")
    with pytest.raises(ValueError, match="beam: expected a source of two dimensions on the page, got one of three"):
        board(read("study.toml"))


def test_a_solid_behind_by_a_table(tmp_path):
    """As by its name; in front there is none."""
    text = '[question]\nname = "scattering"\nfrequency = "1MHz"\nangle = "0,10,20"\n[slab]\nlayer = ["acrylic 2mm"]\nbackground = "water"\n'
    solid = "{density = 7800, sound_speed = 5900, shear_speed = 3200}"
    (tmp_path / "a.toml").write_text(f"{text}after = {solid}\n[output]\nfile = 'a.nc'\n")
    good("run", "a.toml")
    slab = bp.Slab([bp.Layer(bp.material("acrylic"), 0.002)], before=WATER, after=bp.Solid(7800, 5900, 3200))
    np.testing.assert_array_equal(bp.load("a.nc").r.values, bp.scattering(slab, 1e6, angle=[0, 10, 20]).r.values)
    (tmp_path / "b.toml").write_text(f'{text}after = "solid steel"\n')
    good("check", "b.toml")
    (tmp_path / "c.toml").write_text(text.replace('"water"', solid))
    result = run("check", "c.toml")
    assert result.exit_code == 2
    assert "slab.background.shear_speed: expected a name that slab.background has" in result.stderr


def test_a_sweep_over_azimuth_and_place(tmp_path):
    """A circular beam's widths have their two axes at every point, at azimuth and y0 of 0 too."""
    (tmp_path / "a.toml").write_text(
        '[question]\nname = "beam_width"\nfrequency = "0.1MHz"\nangle = 10\nrtol = 1e-6\n[slab]\nlayer = ["acrylic 6.5mm"]\n'
        'background = "water"\n[beam]\nfwhm = "30mm"\nz0 = "-3cm"\n[sweep]\n"beam.azimuth" = [0, 20]\n"beam.y0" = ["0", "5mm"]\n'
        '[output]\nfile = "a.nc"\n'
    )
    good("run", "a.toml")
    swept = bp.load("a.nc")
    for azimuth in (0.0, 20.0):
        for y0 in (0.0, 0.005):
            beam = bp.GaussianBeam(0.03, y0=y0, z0=-0.03)
            known = bp.beam_width(PLATE, beam, 0.1e6, angle=10, rtol=1e-6, azimuth=azimuth)
            at = swept.sel(azimuth=azimuth, y0=y0)
            np.testing.assert_allclose(at.fwhm_out.values, known.fwhm_out.values, rtol=1e-9)
            np.testing.assert_allclose(at.centroid_out.values, known.centroid_out.values, rtol=1e-7)
