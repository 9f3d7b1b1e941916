"""The command run in this process, and four of its questions beside the Python calls that ask the same."""

import numpy as np
from click.testing import CliRunner

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
