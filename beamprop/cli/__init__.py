"""The command `beamprop`. Data go to stdout, progress and warnings to stderr; wrong use exits with 2.

Everything heavy is imported inside the commands, so that ``beamprop --help`` is instant. options.py: what may be typed.
questions.py: the questions. files.py: comparison and conversion. answer.py: stdout and files.
"""

from __future__ import annotations

import click

from .._version import __version__
from . import files, questions


class _Commands(click.Group):
    """Commands, also under the names they had before, and with hyphens."""

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        return super().get_command(ctx, questions.ALIASES.get(name, name.replace("-", "_")))


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="beamprop")
def main() -> None:
    """Acoustic beams through exactly solved layered slabs, in open space.

    Without options, each command answers for the slab of the paper: 450 periods of 10 layers, designed for 2500 Hz. An
    axis is a number, numbers with commas between, or start:stop:count.
    """


for command in (*questions.COMMANDS, *files.COMMANDS):
    main.add_command(command)
