"""What may go wrong, as the command says it: one sentence with the option as it is typed, and an exit code."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TypeVar

import click

T = TypeVar("T")
#: What Python's messages advise, and what the command has for it.
_ADVICE = {
    "take one value by ds.isel(": "select one value in Python, as ds.isel(",
    "; pass active=True for a medium with gain": "",
    "lossless=True drops": "--lossless drops",
    "by kx_over_k0_max and strip_over_k0": "by --kx-over-k0-max and --strip-over-k0",
    ", got None": ", got none",
    "before, after: air, for none": "--background: air, for none",
    "background= sets both (bp.AIR if it is meant)": "it sets both half-spaces (to air if that is meant)",
    "a material of beamprop.materials()": "a material",
    "write the map to a file with save_field": "write the map to a file with --output and --memory",
}

#: What a message begins with: names of arguments, or a property of a numbered layer.
_NAMES = re.compile(r"([\w, ]+ of )?\w+( \d+)?(, \w+)*")


def typed(name: str) -> str:
    """The option that a name of Python's is typed as."""
    return "--" + name.replace("_", "-")


def attempt(action: Callable[[], T]) -> T:
    """What `action` returns. A ValueError is wrong use and exits with 2, what the system refuses exits with 1."""
    failure: click.ClickException
    try:
        return action()
    except ValueError as error:
        failure = click.UsageError(in_options(str(error)), click.get_current_context(silent=True))
    except MemoryError:
        failure = click.ClickException("not enough memory for this question: ask for fewer points, or for parts of it")
    except (OSError, ImportError) as error:
        failure = click.ClickException(str(error))
    # out here no frame of the action is alive: a bar of its progress is gone from the line that the message is printed on
    raise failure


def in_options(message: str) -> str:
    """A message about arguments in Python's words, in those of the command: ``air_distance: ...`` is of --air-distance."""
    ctx = click.get_current_context(silent=True)
    options = {p.name for p in ctx.command.params if isinstance(p, click.Option)} if ctx else set()
    for python, command in _ADVICE.items():
        message = message.replace(python, command)
    names, colon, said = message.partition(": ")
    if not colon or not _NAMES.fullmatch(names):
        return message
    of, _, name = names.rpartition(" of ")
    renamed = re.sub(r"[^\W\d]\w*", lambda m: typed(m[0]) if m[0] in options else m[0], name)
    beside = re.sub(r"(?<=beside )(\w+)", lambda m: typed(m[0]) if m[0] in options else m[0], said)
    return f"{f'{of} of ' if of else ''}{renamed}: {beside}"
