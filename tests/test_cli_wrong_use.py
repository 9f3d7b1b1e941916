"""Wrong use of the command: exit code 2, the option's name on stderr, and nothing written."""

import pytest
from command import COMMANDS, P, run
from versions import names

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
            ("--air-distance", "-1", "--air-distance"),
            ("--rho-m", "x", "--rho-m"),
            ("--rho-m", "0.05-0.05j", "density"),
            ("--n-layers", "0", "--n-layers"),
            ("--n-layers", "2.5", "--n-layers"),
            ("--eta", "0", "eta"),
            ("--eta", "inf", "eta"),
            ("--design-frequency", "0", "--design-frequency"),
            ("--density", "nan", "density"),
            ("--sound-speed", "0", "--sound-speed"),
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
    ("field", [*P, "--quantity", "angle"], "--quantity"),
    ("field", [*P, "--boundary", "periodic", "--period", "0.01"], "period"),
    ("field", [*P, "--boundary", "periodic", "--x", "0,0.1,0.5"], "period"),
    ("spectrum", [*P, "--kx", "0,1", "--angle", "0,3"], "--kx, --angle: expected exactly one"),
    ("spectrum", [*P, "--angle", "95"], "angle"),
    ("spectrum", [*P, "--kx-over-k0", "0,inf"], "--kx-over-k0"),
    ("spectrum", [*P, "--quantity", "x"], "--quantity"),
    ("bloch", ["--kx-over-k0", "nan"], "--kx-over-k0"),
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
