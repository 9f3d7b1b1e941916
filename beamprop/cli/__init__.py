"""The command `beamprop`. Data go to stdout, progress and warnings to stderr; wrong use exits with 2.

Everything heavy is imported inside the commands, so that ``beamprop --help`` is instant. options.py: what may be typed.
questions.py: the questions. study.py: study files. explore.py: the page. files.py: comparison and conversion. answer.py: stdout and files. summaries.py: what is said of each answer. failures.py: what goes wrong.
commands.py: help and signals.
"""

from __future__ import annotations

from typing import Any

import click

from .._version import __version__
from . import explore, files, questions, study
from .commands import GUIDE, command, ending_by_signal, show_example


class _Commands(click.Group):
    """Commands, also under the names they had before, and with hyphens."""

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        return super().get_command(ctx, questions.ALIASES.get(name, name.replace("-", "_")))

    def format_help_text(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        show_example(formatter, "beamprop field --angle 45 --plot beam.png")
        super().format_help_text(ctx, formatter)

    def invoke(self, ctx: click.Context) -> Any:
        with ending_by_signal(ctx):
            return super().invoke(ctx)


@click.group(
    cls=_Commands,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog=f"\b\nGuide, and completion for your shell:\n{GUIDE}",
)
@click.version_option(__version__, prog_name="beamprop")
def main() -> None:
    """Acoustic beams through exactly solved layered slabs, in open space.

    Without options, each command answers for the slab of the paper: 450 periods of 10 layers, designed for 2500 Hz; with --layer,
    for layers of your own. An axis is a number, numbers with commas between, or start:stop:count; numbers may be fractions and have
    units: 1/60, 2mm, 1MHz.
    """


@command("help", example="beamprop help field")
@click.argument("name", metavar="[COMMAND]", required=False)
@click.pass_context
def show_help(ctx: click.Context, name: str | None) -> None:
    """Show the help of a command, or the overview."""
    above = ctx.find_root()
    wanted = main if name is None else main.get_command(above, name)
    if wanted is None:
        ctx.fail(f"COMMAND: expected one of {', '.join(main.list_commands(above))}, got {name!r}")
    click.echo(wanted.get_help(above if name is None else click.Context(wanted, info_name=wanted.name, parent=above)))


for each in (*questions.COMMANDS, *files.COMMANDS, *study.COMMANDS, *explore.COMMANDS, show_help):
    main.add_command(each)
