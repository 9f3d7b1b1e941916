"""What a table may hold: names, defaults and meanings, and the reading of one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

from .values import UNITS


class Parameter(NamedTuple):
    """A key of a table: its default, the function that turns a plain value into it, and its meaning."""

    default: Any
    parse: Callable[[Any, str], Any]
    text: str
    words: tuple[str, ...] = ()  #: the words that it may be, if it is a word
    shown: str = ""  #: the default as it is shown, where that is not its own text
    scaled: bool = False  #: whether the default is that of the paper's wavelength, and goes with it
    units: Mapping[str, int] = {}  #: those of its numbers, where `parse` does not tell


def read(
    table: Mapping[str, Any], parameters: Mapping[str, Parameter], what: str, scale: float = 1.0
) -> dict[str, Any]:
    """Every parameter of a table, parsed, with defaults for those that it leaves out.

    Parameters
    ----------
    table : mapping of str to plain values
    parameters : what it may hold: `CELL`, `SLAB` or `BEAM`
    what : str
        What the table describes, for messages.
    scale : float
        What lengths that are left out are multiplied with: see `scale.Design`.

    Raises
    ------
    ValueError
        Names the key that is unknown, or whose value cannot be used.
    """
    from .. import validate

    known(table, tuple(parameters), what)
    values: dict[str, Any] = {}
    for name, parameter in parameters.items():
        if name not in table:
            default = parameter.default * scale if parameter.scaled else parameter.default
            values[name] = default if default is None else parameter.parse(default, name)
            continue
        value = table[name]
        values[name] = None if value is None and parameter.default is None else parameter.parse(value, name)
        if parameter.words and values[name] is not None:
            validate.word(values[name], name, *parameter.words)
    return values


def known(table: Any, names: tuple[str, ...], what: str) -> None:
    """Refuse what is no table, and keys that are unknown."""
    from .. import validate

    if not isinstance(table, Mapping):
        raise validate.refuse(what, "a table of names and values", table)
    for key, value in table.items():
        if key not in names:
            name = key if isinstance(key, str) else validate.shown(key)
            raise validate.refuse(name, f"a name that a table of {what} has ({', '.join(names)})", value)


def apart(table: Mapping[str, Any], names: tuple[str, ...], beside: str) -> None:
    """Refuse those of `names` that a table gives beside another key, with which they mean nothing."""
    for name in names:
        if table.get(name) is not None and table[name] is not False:
            given = table[name]
            shown = ", ".join(map(repr, given)) if isinstance(given, tuple | list) else repr(given)
            raise ValueError(f"{name}: expected to be left out beside {beside}, got {shown}")


@contextmanager
def named(key: str, *names: str) -> Iterator[None]:
    """Errors of the arguments `names` of an object under the key of the table that they come from."""
    try:
        yield
    except ValueError as error:
        name, colon, said = str(error).partition(": ")
        if not colon or name not in names:
            raise
        raise ValueError(f"{key}: {said}") from None


def units_of(parameter: Parameter) -> Mapping[str, int]:
    """The units that numbers of a parameter may have."""
    return parameter.units or UNITS.get(parameter.parse, {})
