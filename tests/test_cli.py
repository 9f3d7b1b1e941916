"""The command: every subcommand with every kind of output, the API's numbers, and exit code 2 for wrong use."""

import json
import subprocess
import sys
import warnings

import click
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner
from matplotlib.image import imread
from versions import names

import beamprop as bp
from beamprop.cli import main

SLAB = bp.Slab(bp.lmmd_cell(), 20)
BEAM = bp.GaussianBeam(0.096)
P = ["--periods", "20"]
#: What the installed command runs.
COMMAND = "from beamprop.cli import main; main(prog_name='beamprop')"

COMMANDS = {
    "width": ([*P, "--frequency", "2400:2600:3"], lambda: bp.beam_width(SLAB, BEAM, [2400.0, 2500.0, 2600.0])),
    "field": (
        [*P, "--x", "-0.2:0.2:9", "--z", "0:0.2:5", "--z0", "-0.1"],
        lambda: bp.field(
            SLAB, bp.GaussianBeam(0.096, z0=-0.1), 2500.0, np.linspace(-0.2, 0.2, 9), np.linspace(0, 0.2, 5)
        ),
    ),
    "spectrum": ([*P, "--kx-over-k0", "0:2:5"], lambda: bp.scattering(SLAB, 2500.0, kx_over_k0=np.linspace(0, 2, 5))),
    "bloch": (["--kx-over-k0", "0,0.5,2"], lambda: bp.bloch(SLAB.cell, 2500.0, kx_over_k0=[0.0, 0.5, 2.0])),
}


def run(*arguments):
    return CliRunner().invoke(main, [str(a) for a in arguments])


def good(*arguments):
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result


def from_json(value):
    """{re, im} as complex numbers and null as nan, lists as arrays."""
    if isinstance(value, list):
        return np.array([from_json(v) for v in value])
    if isinstance(value, dict):
        return complex(value["re"], value["im"])
    return np.nan if value is None else value


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
    return from_json(json.loads(good("spectrum", *options, "--angle", "20", "--json").stdout)["data_vars"]["t"]["data"])


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


# --- wrong use --------------------------------------------------------------------------------------------


WRONG = [
    *[
        ("width", [*P, option, value], word)
        for option, value, word in [
            ("--fwhm", "nan", "fwhm"),
            ("--fwhm", "0", "fwhm"),
            ("--fwhm", "wide", "--fwhm"),
            ("--angle", "90", "angle"),
            ("--angle", "10:20", "--angle"),
            ("--z0", "0.1", "z0"),
            ("--frequency", "-5", "frequency"),
            ("--frequency", "nan", "frequency"),
            ("--frequency", "1:2:0", "--frequency"),
            ("--frequency", "", "--frequency"),
            ("--frequency", "1,a", "--frequency"),
            ("--rtol", "2", "rtol"),
            ("--air-distance", "-1", "air_distance"),
            ("--rho-m", "x", "--rho-m"),
            ("--rho-m", "0.05-0.05j", "density"),
            ("--n-layers", "0", "n_layers"),
            ("--n-layers", "2.5", "--n-layers"),
            ("--eta", "0", "eta"),
            ("--eta", "inf", "eta"),
            ("--design-frequency", "0", "design_frequency"),
            ("--density", "nan", "density"),
            ("--sound-speed", "0", "sound_speed"),
            ("--medium", "steel", "--medium"),
            ("--form", "bent", "--form"),
            ("--width-of", "power", "--width-of"),
            ("--nonsense", "1", "--nonsense"),
        ]
    ],
    ("width", ["--periods", "0"], "periods"),
    ("width", ["--periods", "1.5"], "--periods"),
    ("width", ["--periods", "-3"], "periods"),
    ("field", [*P, "--z", "-1"], "z"),
    ("field", [*P, "--x", "nan"], "x"),
    ("field", [*P, "--period", "1"], "period"),
    ("field", [*P, "--boundary", "closed"], "--boundary"),
    ("field", [*P, "--quantity", "phase"], "--quantity"),
    ("field", [*P, "--boundary", "periodic", "--period", "0.01"], "period"),
    ("field", [*P, "--boundary", "periodic", "--x", "0,0.1,0.5"], "period"),
    ("spectrum", [*P, "--kx", "0,1", "--angle", "0,3"], "exactly one"),
    ("spectrum", [*P, "--angle", "95"], "angle"),
    ("spectrum", [*P, "--kx-over-k0", "0,inf"], "kx_over_k0"),
    ("spectrum", [*P, "--quantity", "x"], "--quantity"),
    ("bloch", ["--kx-over-k0", "nan"], "kx_over_k0"),
    ("bloch", ["--eta", "-1"], "eta"),
    ("width", [*P, "--after-density", "0"], "density"),
    ("width", [*P, "--after-speed", "0"], "speed"),
    ("width", [*P, "--frequency", "2000:3000:1000000000000"], "--frequency"),
    ("width", [*P, "--frequency", "2000:3000:0"], "--frequency"),
    ("width", ["--periods", "1" + 400 * "0"], "periods"),
    ("width", [*P, "--fwhm", "1e-200"], "fwhm"),
    ("field", [*P, "--x", "0:1:1000000", "--z", "0:1:1000000"], "x"),
    ("field", [*P, "--frequency", "1e155"], "frequency"),
    ("spectrum", [*P, "--frequency", "1:2:10000000", "--kx", "0:1:10000000"], "kx"),
]


@pytest.mark.parametrize(("command", "options", "word"), WRONG)
def test_wrong_use_exits_with_two_and_writes_nothing(command, options, word, tmp_path):
    """The message on stderr names the option or argument; stdout and the folder stay empty."""
    # a valid axis for the plot comes first: of an option given twice the last one counts
    axis = {"width": "--frequency=2400,2500", "bloch": "--kx-over-k0=0,1"}.get(command)
    result = run(
        command, *([axis] if axis else []), *options, "--output", tmp_path / "a.nc", "--plot", tmp_path / "a.png"
    )
    assert result.exit_code == 2, result.output
    assert word in result.stderr.split("Error:")[1]
    assert result.stdout == ""
    assert names(tmp_path) == []


@pytest.mark.parametrize(
    ("command", "options"),
    [
        ("width", [*P, "--frequency", "2500"]),
        ("spectrum", [*P, "--angle", "45"]),
        ("bloch", ["--kx-over-k0", "1"]),
        ("field", [*P, "--angle", "0,10"]),
        ("field", [*P, "--frequency", "2400,2500"]),
        ("field", [*P, "--x", "0"]),
        ("field", [*P, "--z", "0.1"]),
    ],
)
def test_a_plot_that_cannot_be_drawn_is_refused_first(command, options, tmp_path):
    """One value where a picture needs an axis: exit 2, before anything is computed or written."""
    result = run(command, *options, "--output", tmp_path / "a.nc", "--plot", tmp_path / "a.png")
    assert result.exit_code == 2, result.output
    assert "Error:" in result.stderr
    assert names(tmp_path) == []


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--output", "a.txt"),
        ("--output", "a"),
        ("--output", "none/a.nc"),
        ("--plot", "a.jpg"),
        ("--plot", "a.nc"),
        ("--plot", "none/a.png"),
    ],
)
def test_files_that_cannot_be_written_are_refused_first(command, option, value, tmp_path):
    """A wrong ending or a missing folder: exit 2."""
    result = run(command, *COMMANDS[command][0], option, tmp_path / value)
    assert result.exit_code == 2
    assert option in result.stderr
    assert names(tmp_path) == []


def test_unknown_commands():
    """No command, or one that is not there: exit 2."""
    assert run().exit_code == 2
    result = run("paint")
    assert result.exit_code == 2
    assert "paint" in result.stderr


# --- help and start-up ------------------------------------------------------------------------------------


def test_help_lists_the_commands():
    """--help and -h, of the group and of each command, with defaults."""
    out = good("--help").stdout
    assert good("-h").stdout == out
    for command in COMMANDS:
        assert f"\n  {main.get_command(click.Context(main), command).name} " in out
        text = good(command, "--help").stdout
        for option in ("--output", "--plot", "--json", "--quiet", "--eta", "--rho-m"):
            assert option in text
        assert "[default: 0.05+0.05j]" in text
    assert bp.__version__ in good("--version").stdout


def imported(*arguments):
    """Modules that a fresh interpreter has imported with these arguments, and its stdout."""
    done = subprocess.run([sys.executable, "-X", "importtime", *arguments], capture_output=True, text=True, check=True)
    return {
        line.rsplit("|", 1)[1].strip() for line in done.stderr.splitlines() if line.startswith("import time:")
    }, done.stdout


@pytest.mark.parametrize(
    ("arguments", "heavy"),
    [
        (("-c", COMMAND, "--help"), ("numpy", "xarray", "scipy", "matplotlib", "pyfftw", "h5netcdf")),
        (("-c", COMMAND, "field", "--help"), ("numpy", "xarray", "scipy", "matplotlib", "pyfftw", "h5netcdf")),
        (("-c", "import beamprop"), ("numpy", "xarray", "scipy", "matplotlib", "pyfftw", "h5netcdf")),
        (
            ("-c", "import beamprop as bp; bp.Slab(bp.lmmd_cell(), 450)"),
            ("xarray", "scipy", "matplotlib", "pyfftw", "h5netcdf"),
        ),
    ],
    ids=["help", "field help", "import", "a slab"],
)
def test_what_need_not_be_imported_is_not(arguments, heavy):
    """Help and the bare import are instant: nothing heavy is imported before it is used."""
    modules, out = imported(*arguments)
    assert "beamprop" in modules
    assert not {name.split(".")[0] for name in modules} & set(heavy)
    assert ("Usage" in out) == ("--help" in arguments)


def test_the_installed_command():
    """In a process of its own: JSON on stdout that another program can read, and nothing on stderr."""
    options = ["bloch", "--kx-over-k0", "0", "--json"]
    done = subprocess.run([sys.executable, "-c", COMMAND, *options], capture_output=True, text=True, check=True)
    data = json.loads(done.stdout)["data_vars"]["kz_over_k0"]["data"]
    assert from_json(data) == pytest.approx(bp.bloch(SLAB.cell, 2500.0, kx_over_k0=0.0).kz_over_k0.item(), rel=1e-12)
    assert done.stderr == ""


def test_datasets_of_the_command_are_those_of_the_api(tmp_path):
    """Not the numbers alone: dims, coordinates and attributes too."""
    good("bloch", "--kx-over-k0", "0,0.5", "-o", tmp_path / "a.nc")
    xr.testing.assert_identical(bp.load(tmp_path / "a.nc"), bp.bloch(SLAB.cell, 2500.0, kx_over_k0=[0.0, 0.5]))


@pytest.mark.parametrize(
    ("old", "new"),
    [("width", "beam_width"), ("spectrum", "scattering"), ("modes", "guided_modes"), ("beam-width", "beam_width")],
)
def test_names_are_those_of_python_and_old_ones_stay(old, new):
    """A command has the name of its question; what was typed before, and hyphens, are taken too."""
    assert main.get_command(click.Context(main), old) is main.commands[new]
    assert set(main.commands) == {
        "beam_measures", "beam_width", "bloch", "compare", "convert", "field", "guided_modes", "scattering",
    }  # fmt: skip


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
