"""Wrong commands, as a new user types them, each with the message that it must give: the whole of it, on one line, by the option's own name.

``...`` in the end stands for more: where the command's library says it, in words that change with its version, or where all that may be typed
is listed.
"""

import shlex

import pytest
from click.testing import CliRunner
from wrong_commands import WRONG

from beamprop.cli import main

#: What stands in the folder in which the commands are typed; a name with / is a folder.
FILES = {
    "text.txt": "no numbers\n",
    "one.txt": "0 1\n",
    "letters.txt": "0 1\n0.1 a\n",
    "layers.csv": "thickness_mm,material\n2,water\n1,unobtainium\n",
    "header.csv": "thick,material\n2,water\n",
    "nothing.csv": "",
    "empty.nc/": None,
    "full.zarr/": None,
    "full.zarr/thesis.txt": "years of work",
}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder to be in, and a memory that does not depend on the machine."""
    for name, text in FILES.items():
        if text is None:
            (tmp_path / name).mkdir()
        else:
            (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BEAMPROP_MEMORY", "1G")
    return tmp_path


def contents(folder):
    return {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}


@pytest.mark.parametrize(("line", "message"), WRONG)
def test_a_wrong_command(line, message, folder):
    """Exit 2, the message, nothing on stdout, and the folder as it was."""
    before = contents(folder)
    ran = CliRunner().invoke(main, shlex.split(line), prog_name="beamprop")
    assert ran.exit_code == 2, ran.output
    _, _, said = ran.stderr.rstrip().rpartition("Error: ")
    assert said.startswith(message[:-3]) if message.endswith("...") else said == message
    assert "\n" not in said
    assert ran.stdout == ""
    assert contents(folder) == before


def test_there_are_a_hundred():
    """Each typed once."""
    assert len({line for line, _ in WRONG}) == len(WRONG) >= 100


def test_the_command_alone_shows_its_help():
    ran = CliRunner().invoke(main, [], prog_name="beamprop")
    assert (ran.exit_code, "Commands:" in ran.output) == (2, True)
