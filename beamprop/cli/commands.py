"""How commands look: examples first, options under headings, a link in the end; and how they end when they are interrupted."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

_PAGE = Path(__file__).parents[2] / "docs" / "guide.md"
#: Where the guide is: in the checkout that is run, or in any.
GUIDE = (_PAGE.as_uri() if _PAGE.exists() else "docs/guide.md") + "#the-command"
INTERRUPTED, TERMINATED = 128 + signal.SIGINT, 128 + signal.SIGTERM


class Command(click.Command):
    """A command with an example, and with its options under headings."""

    def __init__(self, *args: Any, example: str, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.example = example
        self.epilog = f"\b\nGuide: {GUIDE}"

    def format_help_text(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The example, and what the command does."""
        show_example(formatter, self.example)
        super().format_help_text(ctx, formatter)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The options by heading, in the order of the headings' first options."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx) if isinstance(parameter, click.Option) else None
            if record is not None:
                groups.setdefault(getattr(parameter, "group", "Help"), []).append(record)
        for heading in sorted(groups, key=lambda h: h in ("Output", "Help")):
            with formatter.section(heading):
                formatter.write_dl(groups[heading])


def show_example(formatter: click.HelpFormatter, example: str) -> None:
    """A line with an example, as it is typed."""
    formatter.write(f"Example: {example}\n")


def command(name: str | None = None, *, example: str) -> Callable[[Callable[..., Any]], click.Command]:
    """Make a command of a function."""
    return click.command(name=name, cls=Command, example=example)


@contextmanager
def ending_by_signal(ctx: click.Context) -> Iterator[None]:
    """Exit with 130 on Ctrl-C and with 143 on SIGTERM, after whatever was being written has been removed.

    SIGTERM takes the way of Ctrl-C, which the storage holds back while HDF5 writes.
    """
    terminated = []

    def terminate(number: int, frame: Any) -> None:
        terminated.append(number)
        if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in what a script starts with &
            signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.raise_signal(signal.SIGINT)

    in_main = threading.current_thread() is threading.main_thread()
    usual = signal.signal(signal.SIGTERM, terminate) if in_main else None
    try:
        yield
    except KeyboardInterrupt:
        click.echo("terminated" if terminated else "interrupted", err=True)
        ctx.exit(TERMINATED if terminated else INTERRUPTED)
    finally:
        if in_main:
            signal.signal(signal.SIGTERM, usual)
