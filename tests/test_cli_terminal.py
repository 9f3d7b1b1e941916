"""What the command says and does on a terminal: help, completion, signals, pipes, progress."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from click.testing import CliRunner
from command import COMMAND, good
from source_tree import CHECKOUT
from versions import names

import beamprop as bp
from beamprop.cli import main
from beamprop.io.exports import WRITTEN

PROCESS = [sys.executable, "-c", COMMAND]


# --- help -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(main.commands))
def test_every_help_has_an_example_that_parses_and_a_link(name, tmp_path, monkeypatch):
    """The first line after the usage, as it is typed; options under headings; the guide in the end."""
    monkeypatch.chdir(tmp_path)
    for file in ("beam.nc", "comsol_export.txt", "study.toml"):
        (tmp_path / file).touch()
    text = good(name, "--help").stdout
    assert good("help", name).stdout == text
    example = text.splitlines()[1].removeprefix("Example: ")
    words = shlex.split(example)
    assert words[:2] == ["beamprop", name]
    main.commands[name].make_context(name, words[2:])
    assert text.rstrip().splitlines()[-1].strip().endswith("docs/guide.md#the-command")
    if name not in ("help", "convert", "run", "check", "init"):
        assert text.index("Output:") < text.index("Help:")
        assert "is replaced" in " ".join(text.split())


@pytest.mark.parametrize("name", ["field", "bloch", "convert"])
def test_every_ending_that_is_written_is_named(name):
    text = good(name, "--help").stdout
    assert [ending for ending in WRITTEN if not re.search(rf"{re.escape(ending)}\b", text)] == []
    page = (CHECKOUT / "docs" / "study-files.md").read_text(encoding="utf-8")
    assert [ending for ending in WRITTEN if not re.search(rf"{re.escape(ending)}\b", page)] == []
    page = (CHECKOUT / "docs" / "guide.md").read_text(encoding="utf-8").partition("## Files")[2]
    assert [ending for ending in WRITTEN if f"`{ending}`" not in page] == []


def test_air_in_a_name_is_the_medium_in_front():
    """As --air-distance measures it: in water, what the width is two wavelengths of water away."""
    assert "in the medium in front" in " ".join(good("beam_width", "--help").stdout.partition("Options")[0].split())
    typed = [
        "--layer",
        "steel 1mm",
        "--background",
        "water",
        "--frequency",
        "1MHz",
        "--fwhm",
        "2mm",
        "--air-distance",
        "20mm",
    ]
    water = bp.material("water")
    profile = bp.field(
        bp.Slab.uniform(water, 0.02, water, water), bp.GaussianBeam(0.002), 1e6, np.linspace(-0.02, 0.02, 2001), 0.02
    )
    said = good("beam_width", *typed).stdout.partition("fwhm_air")[2].split()[0]
    assert float(said) == pytest.approx(100 * float(bp.fwhm(profile.p)), rel=1e-4)


def test_help_of_everything_and_of_nothing():
    assert good("help").stdout == good("--help").stdout
    assert good("help", "width").stdout == good("beam_width", "--help").stdout
    result = CliRunner().invoke(main, ["help", "paint"])
    assert result.exit_code == 2
    assert "COMMAND: expected one of beam_measures, " in result.stderr


def test_headings():
    """Options stand under what they are about, in this order."""
    text = good("field", "--help").stdout
    headings = [line.rstrip(":") for line in text.splitlines() if line.endswith(":") and not line.startswith(" ")]
    own = ["Layers of your own", "The paper's cell", "Around the layers", "The slab", "The beam", "Question"]
    assert headings == [*own, "Output", "Help"]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("beamprop guid", "guided_modes"),
        ("beamprop field --des", "--design-frequency"),
        ("beamprop field --medium lmm", "lmmd-emt"),
        ("beamprop field --output ", "file"),
    ],
)
def test_completion(words, offered):
    """What click's completion offers to a shell."""
    environment = os.environ | {"_BEAMPROP_COMPLETE": "bash_complete", "COMP_WORDS": words}
    environment["COMP_CWORD"] = str(len(words.split(" ")) - 1)
    done = subprocess.run(PROCESS, capture_output=True, text=True, env=environment, check=True)
    assert offered in done.stdout


# --- terminals and signals --------------------------------------------------------------------------------

#: Minutes of work; it makes a block of the map and then the next.
LONG = ["field", "--lossless", "--x", "-5:5:1001", "--z", "0:2:16001", "--memory", "1", "--output"]


@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_signals_leave_nothing(number, code, word, tmp_path):
    """While a map is being written: 130 for Ctrl-C, 143 for SIGTERM, and an empty folder."""
    with subprocess.Popen([*PROCESS, *LONG, str(tmp_path / "a.nc")], stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("*/*")) and time.monotonic() < deadline:
            time.sleep(0.01)
        assert list(tmp_path.glob("*/*"))
        process.send_signal(number)
        said = process.stderr.read()
        assert process.wait(60) == code, said
    assert said.splitlines() == [word]
    assert names(tmp_path) == []


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_a_job_of_a_script_ends_by_sigterm(tmp_path):
    """A shell's `command &` ignores SIGINT, by whose way SIGTERM goes."""
    words = [*PROCESS, *LONG, str(tmp_path / "a.nc")]
    ignoring = f"import os, signal; signal.signal(signal.SIGINT, signal.SIG_IGN); os.execv({words[0]!r}, {words!r})"
    with subprocess.Popen([sys.executable, "-c", ignoring], stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob("*/*")) and time.monotonic() < deadline:
            time.sleep(0.01)
        process.terminate()
        try:
            assert process.wait(30) == 143
        finally:
            process.kill()
    assert names(tmp_path) == []


def test_a_closed_pipe_is_no_traceback():
    """`beamprop bloch --json | head -1`."""
    with subprocess.Popen(
        [*PROCESS, "bloch", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.close()
        assert "Traceback" not in process.stderr.read()


def test_progress_is_for_terminals(monkeypatch):
    """Without a terminal there is no bar, nor where --quiet asks for none."""
    seen = []

    def question(*arguments, progress, **options):
        seen.append(progress)
        raise ValueError("slab: expected nothing but this test")

    monkeypatch.setattr("beamprop.api.beam_width.beam_width", question)
    CliRunner().invoke(main, ["beam_width"])
    monkeypatch.setattr("beamprop.cli.answer._on_terminal", lambda: True)
    CliRunner().invoke(main, ["beam_width"])
    CliRunner().invoke(main, ["beam_width", "--quiet"])
    assert seen == [False, True, False]


#: Bars that are drawn at once, and a question that fails while its bar is there.
BARS = "import tqdm; bar = tqdm.tqdm; tqdm.tqdm = lambda *a, delay, **o: bar(*a, mininterval=0, **o)\n"
FAILS = "import beamprop.profiles.sections as s\ndef rows(*a): raise ValueError('rtol: expected less, got more')\ns.rows = rows\n"


@pytest.mark.skipif(os.name == "nt", reason="POSIX terminals")
@pytest.mark.parametrize(
    ("code", "begins"), [(BARS, "warning: the half level is met"), (BARS + FAILS, "Usage: beamprop beam_width")]
)
def test_messages_on_a_terminal_stand_on_their_own_lines(code, begins):
    """A bar is drawn, and is gone from its line when a warning or an error is printed."""
    import pty
    import termios

    options = ["beam_width", "--angle", "30", "--frequency", "2500", "--periods", "20"]
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(ours, (24, 100))
    command = [sys.executable, "-c", code + COMMAND, *options]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=theirs) as process:
        os.close(theirs)
        assert process.wait(60) == (2 if FAILS in code else 0)
    text = os.read(ours, 100_000).decode()
    os.close(ours)
    assert "widths:" in text
    message = text.replace("\r\n", "\n").split("\r")[-1]
    assert message.startswith(begins)
