"""The command: every kind of output of every question, and options that reach the physics, held to the API's numbers."""

import json
import warnings

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from command import BEAM, COMMANDS, SLAB, P, from_json, good
from matplotlib.image import imread
from versions import names

import beamprop as bp
from beamprop.cli import main


def assert_same_numbers(got, want, rtol=1e-9):
    for name, v in want.variables.items():
        np.testing.assert_allclose(
            got[name], v.values, rtol=rtol, atol=1e-12 * np.abs(np.nan_to_num(v.values)).max(initial=0)
        )


@pytest.mark.parametrize("command", COMMANDS)
def test_json_is_the_api(command):
    """--json prints one JSON object on stdout whose numbers are those of the Python call."""
    options, call = COMMANDS[command]
    result = good(command, *options, "--json")
    record = json.loads(result.stdout)
    want = call()
    every = record["coords"] | record["data_vars"]
    assert set(every) == set(want.variables)
    assert_same_numbers({name: from_json(v["data"]) for name, v in every.items()}, want)
    assert record["attrs"]["provenance"]
    assert all(v["attrs"]["units"] for v in every.values())


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("ending", [".nc", ".zarr"])
def test_output_is_the_api(command, ending, tmp_path):
    """--output writes a file that load reads, with the Python call's numbers, and says so."""
    options, call = COMMANDS[command]
    path = tmp_path / f"a{ending}"
    result = good(command, *options, "--output", path)
    assert f"wrote {path}" in result.stdout
    ds, want = bp.load(path), call()
    assert set(ds.variables) == set(want.variables)
    assert_same_numbers(ds, want)
    record = bp.provenance(ds)
    assert record.get("slab", SLAB) == SLAB
    assert names(tmp_path) == [path.name]


@pytest.mark.parametrize("command", COMMANDS)
def test_plot_draws(command, tmp_path):
    """--plot writes a picture with more than one colour in it, or a PDF."""
    options, _ = COMMANDS[command]
    good(command, *options, "--plot", tmp_path / "a.png")
    picture = imread(tmp_path / "a.png")
    assert min(picture.shape[:2]) > 200
    assert np.ptp(picture) > 0.5
    good(command, *options, "--plot", tmp_path / "a.pdf", "--quiet")
    assert (tmp_path / "a.pdf").read_bytes().startswith(b"%PDF")
    assert names(tmp_path) == ["a.pdf", "a.png"]


@pytest.mark.parametrize("command", COMMANDS)
def test_quiet_says_nothing(command, tmp_path):
    """--quiet prints nothing and still writes; with --json it prints the JSON alone."""
    options, _ = COMMANDS[command]
    result = good(command, *options, "--quiet", "--output", tmp_path / "a.nc")
    assert result.output == ""
    assert names(tmp_path) == ["a.nc"]
    both = good(command, *options, "--quiet", "--json")
    assert json.loads(both.output)["data_vars"]


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("width", ["widths [cm]", "fwhm_out", "2400"]),
        ("field", ["x 9", "largest |p|", "estimated error"]),
        ("spectrum", ["transmissivity", "kx_over_k0"]),
        ("bloch", ["Re kz/k0", "Im kz/k0"]),
    ],
)
def test_the_summary_names_what_it_shows(command, words):
    """Without options for output, a short table goes to stdout."""
    out = good(command, *COMMANDS[command][0]).stdout
    for word in words:
        assert word in out
    assert len(out.splitlines()) < 20


def test_the_table_shows_the_numbers():
    """The table of widths is in centimetres."""
    ds = bp.beam_width(SLAB, BEAM, 2500.0)
    out = good("width", *P, "--frequency", "2500").stdout
    assert f"{100 * ds.fwhm_out.item():.6g}" in out
    assert f"{100 * ds.fwhm_air.item():.6g}" in out


# --- options reach the physics ----------------------------------------------------------------------------


HELIUM = bp.Fluid.from_speed(0.18, 972.0)
CELL = bp.lmmd_cell(0.1 + 0.2j, 0.1, 6, 1 / 40, 2000.0, HELIUM)
CELL_OPTIONS = [
    "--rho-m",
    "0.1+0.2j",
    "--delta-rho",
    "0.1",
    "--n-layers",
    "6",
    "--eta",
    "0.025",
    "--design-frequency",
    "2000",
    "--density",
    "0.18",
    "--sound-speed",
    "972",
]


def transmission(*options):
    return from_json(
        json.loads(good("spectrum", "--frequency", "2500", *options, "--angle", "20", "--json").stdout)["data_vars"][
            "t"
        ]["data"]
    )


@pytest.mark.parametrize(
    ("options", "slab"),
    [
        (CELL_OPTIONS, bp.Slab(CELL, 20, HELIUM, HELIUM)),
        (["--lossless"], bp.Slab(bp.lmmd_cell(0.05, 0.0), 20)),
        (["--medium", "none"], bp.Slab.uniform(bp.AIR, SLAB.thickness)),
        (["--medium", "standard-emt"], bp.Slab.uniform(bp.standard_emt(SLAB.cell), SLAB.thickness)),
        (["--medium", "lmmd-emt"], bp.lmmd_emt_slab(SLAB)),
        (["--medium", "lmmd-emt-bare"], bp.lmmd_emt_slab(SLAB, interface=False)),
        (
            ["--after-density", "1000", "--after-speed", "1480"],
            bp.Slab(SLAB.cell, 20, after=bp.Fluid.from_speed(1000.0, 1480.0)),
        ),
        (["--after-speed", "300"], bp.Slab(SLAB.cell, 20, after=bp.Fluid.from_speed(1.25, 300.0))),
        (["--rho-m", "0.05 + 0.1i"], bp.Slab(bp.lmmd_cell(0.05 + 0.1j), 20)),
    ],
)
def test_slab_options(options, slab):
    """Every option of the slab changes the slab as its words say."""
    want = bp.scattering(slab, 2500.0, angle=20.0).t.item()
    assert transmission(*P, *options) == pytest.approx(want, rel=1e-12)
    assert want != pytest.approx(bp.scattering(SLAB, 2500.0, angle=20.0).t.item(), rel=1e-6)


@pytest.mark.parametrize(
    ("options", "beam"),
    [
        (["--fwhm", "0.2"], bp.GaussianBeam(0.2)),
        (["--angle", "30"], bp.GaussianBeam(0.096, 30.0)),
        (["--x0", "0.1"], bp.GaussianBeam(0.096, x0=0.1)),
        (["--width-of", "intensity"], bp.GaussianBeam(0.096, width_of="intensity")),
        (["--z0", "-0.1"], bp.GaussianBeam(0.096, z0=-0.1)),
        (["--z0", "-0.1", "--form", "rotated", "--angle", "40"], bp.GaussianBeam(0.096, 40.0, z0=-0.1, form="rotated")),
    ],
)
def test_beam_options(options, beam):
    """Every option of the beam changes the beam as its words say; at 30 degrees a second hump is half as high, and said."""
    result = good("width", *P, "--frequency", "2500", *options, "--json")
    got = json.loads(result.stdout)["data_vars"]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        want = bp.beam_width(SLAB, beam, 2500.0)
    assert [str(w.message) for w in caught if f"warning: {w.message}" not in result.stderr] == []
    assert ("met up to 4 times" in result.stderr) == (options == ["--angle", "30"])
    for name in ("fwhm_launch", "fwhm_in", "fwhm_out", "centroid_out"):
        assert got[name]["data"] == pytest.approx(want[name].item(), rel=1e-6, abs=1e-9)


def test_axes():
    """A number, numbers with commas between, and start:stop:count with both ends."""
    for text, want in (
        ("2500", 2500.0),
        ("2400,2500", [2400.0, 2500.0]),
        ("2400:2500:3", [2400.0, 2450.0, 2500.0]),
        ("2400:2600:1", [2400.0]),
    ):
        record = json.loads(good("bloch", "--frequency", text, "--kx-over-k0", "0", "--json").stdout)
        assert record["coords"]["frequency"]["data"] == want


def test_periodic_fields():
    """--boundary and --period reach the question."""
    options = ["--boundary", "periodic", "--period", "1.5", "--x", "0", "--z", "0.1,0.2"]
    record = json.loads(good("field", *P, *options, "--json").stdout)
    want = bp.field(SLAB, bp.GaussianBeam(0.096, z0=-0.1), 2500.0, 0.0, [0.1, 0.2], boundary="periodic", period=1.5)
    np.testing.assert_allclose(from_json(record["data_vars"]["p"]["data"]), want.p, rtol=1e-10)
    assert record["attrs"]["period"] == 1.5


def test_the_default_depths_run_from_the_launch_plane_to_behind_the_slab():
    """Without --z the field covers the slab and a quarter more."""
    record = json.loads(good("field", *P, "--x", "0", "--json").stdout)
    z = record["coords"]["z"]["data"]
    assert z[0] == -0.1
    assert z[-1] == pytest.approx(1.25 * SLAB.thickness)


def test_one_depth_of_zero():
    """--z 0 is the near face, and not the default axis."""
    record = json.loads(good("field", *P, "--x", "0", "--z", "0", "--json").stdout)
    assert record["coords"]["z"]["data"] == 0


@pytest.mark.parametrize("ending", ["json", "nc"])
def test_nan_is_null(ending, tmp_path):
    """Energies of evanescent waves are null in JSON, which knows no NaN, and nan in the file."""
    options = ["spectrum", *P, "--kx-over-k0", "0.5,1.5"]
    if ending == "json":
        assert json.loads(good(*options, "--json").stdout)["data_vars"]["absorption"]["data"][1] is None
    else:
        good(*options, "-o", tmp_path / "a.nc")
        assert np.isnan(bp.load(tmp_path / "a.nc").absorption[1])


def test_warnings_go_to_stderr():
    """nan widths behind an opaque slab: exit 0, a warning on stderr, clean JSON on stdout."""
    result = good(
        "width", "--rho-m", "0.05+0.5j", "--delta-rho", "0.25", "--periods", "50000", "--frequency", "2500", "--json"
    )
    assert "half level" in result.stderr
    assert json.loads(result.stdout)["data_vars"]["fwhm_out"]["data"] is None


# --- help and start-up ------------------------------------------------------------------------------------


def test_datasets_of_the_command_are_those_of_the_api(tmp_path):
    """Not the numbers alone: dims, coordinates and attributes too."""
    good("bloch", "--kx-over-k0", "0,0.5", "-o", tmp_path / "a.nc")
    xr.testing.assert_identical(bp.load(tmp_path / "a.nc"), bp.bloch(SLAB.cell, 2500.0, kx_over_k0=[0.0, 0.5]))


def test_beam_measures():
    """The same numbers as in Python."""
    ran = CliRunner().invoke(
        main, ["beam_measures", *P, "--lossless", "--window", "1", "--frequency", "2400", "--json", "-q"]
    )
    assert ran.exit_code == 0, ran.output
    given = json.loads(ran.stdout)["data_vars"]["power"]["data"]
    slab = bp.Slab(bp.lmmd_cell(0.05, 0), 20)
    expected = bp.beam_measures(slab, BEAM, 2400.0, rtol=1e-8, window=1.0).power
    np.testing.assert_allclose(given, expected, rtol=1e-12)
