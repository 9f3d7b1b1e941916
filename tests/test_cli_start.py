"""The command's help, its names, and what it imports before it answers."""

import json
import subprocess
import sys

import click
import pytest
from command import COMMAND, COMMANDS, SLAB, from_json, good

import beamprop as bp
from beamprop.cli import main


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
        (("-c", "import beamprop.api.beam_width, beamprop.io.datasets"), ("scipy", "matplotlib")),
    ],
    ids=["help", "field help", "import", "a slab", "a question"],
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


@pytest.mark.parametrize(
    ("old", "new"),
    [("width", "beam_width"), ("spectrum", "scattering"), ("modes", "guided_modes"), ("beam-width", "beam_width")],
)
def test_names_are_those_of_python_and_old_ones_stay(old, new):
    """A command has the name of its question; what was typed before, and hyphens, are taken too."""
    assert main.get_command(click.Context(main), old) is main.commands[new]
    assert set(main.commands) == {
        "beam_measures", "beam_width", "bloch", "check", "compare", "convert", "explore", "field", "guided_modes", "help", "init", "run", "scattering",
    }  # fmt: skip
