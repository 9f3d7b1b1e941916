"""Options of the command; those of cell, slab and beam are made of the tables of `parameters`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from .. import parameters
from ..parameters import Parameter


class Number(click.ParamType):
    """A complex number as Python writes it: 0.05+0.05j."""

    name = "complex"

    def convert(self, value: Any, param: Any, ctx: Any) -> complex:
        return _parsed(self, parameters.number, value, param, ctx)


class Axis(click.ParamType):
    """A number, numbers with commas between, or start:stop:count."""

    name = "axis"

    def convert(self, value: Any, param: Any, ctx: Any) -> parameters.Axis:
        if not isinstance(value, str):
            return value
        return _parsed(self, parameters.axis, value, param, ctx)


def _parsed(kind: click.ParamType, parse: Callable[[Any, str], Any], value: Any, param: Any, ctx: Any) -> Any:
    """A parsed value, or click's error, which names the option by itself."""
    name = param.name if param is not None else "value"
    try:
        return parse(value, name)
    except ValueError as error:
        kind.fail(str(error).removeprefix(f"{name}: "), param, ctx)


class Target(click.ParamType):
    """A file to write, with one of the given endings (or any for datasets), in a folder that exists and can be written to."""

    name = "file"

    def __init__(self, *endings: str) -> None:
        self.endings = endings

    def convert(self, value: Any, param: Any, ctx: Any) -> Path:
        path = Path(value)
        from ..io.exports import WRITTEN

        endings = self.endings or WRITTEN
        if path.suffix.lower() not in endings:
            self.fail(f"expected a name ending in {' or '.join(endings)}, got {str(value)!r}", param, ctx)
        from ..io.storage import check_target

        try:
            return check_target(path)
        except ValueError as error:
            self.fail(str(error).removeprefix("path: "), param, ctx)


Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def all_of(*options: Decorator) -> Decorator:
    """Options as one decorator."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for decorator in reversed(options):
            function = decorator(function)
        return function

    return decorate


def option(*names: str, default: Any, kind: Any = None, text: str, show: bool | str = True) -> Decorator:
    """An option with its default shown."""
    return click.option(*names, default=default, type=kind, show_default=show, help=text)


def option_of(table: Mapping[str, Parameter], name: str) -> Decorator:
    """The option of a parameter."""
    parameter = table[name]
    typed = "--" + name.replace("_", "-")
    if parameter.parse is parameters.switch:
        return click.option(typed, is_flag=True, help=parameter.text)
    kind: click.ParamType | None = Number() if parameter.parse is parameters.number else None
    if parameter.words:
        kind = click.Choice(parameter.words)
    if parameter.default is None:
        return click.option(typed, type=kind, help=parameter.text)
    return option(typed, default=parameter.default, kind=kind, text=parameter.text, show=parameter.shown or True)


def given(options: Mapping[str, Any], table: Mapping[str, Parameter]) -> dict[str, Any]:
    """Those of a command's options that belong to a table of parameters."""
    return {name: options[name] for name in table}


CELL = all_of(*(option_of(parameters.CELL, name) for name in parameters.CELL))
SLAB = all_of(*(option_of(parameters.SLAB, name) for name in parameters.SLAB))
BEAM = all_of(
    option_of(parameters.BEAM, "fwhm"),
    option(
        "--angle", default="0", kind=Axis(), text="From the normal [degree]; an axis: a, a,b,c or start:stop:count."
    ),
    *(option_of(parameters.BEAM, name) for name in ("x0", "width_of", "form")),
    option("--rtol", default=1e-8, text="Requested relative error."),
)
OUTPUT_WITHOUT_PLOT = all_of(
    click.option(
        "--output",
        "-o",
        type=Target(),
        help="Write the dataset to this .nc, .zarr, .mat, .vti, .vtr or .csv (of one axis).",
    ),
    click.option("--json", "as_json", is_flag=True, help="Print the dataset as JSON."),
    click.option("--quiet", "-q", is_flag=True, help="Print nothing but what was asked for by --json."),
)
OUTPUT = all_of(
    click.option("--plot", "-p", type=Target(".png", ".pdf"), help="Draw it into this .png or .pdf."),
    OUTPUT_WITHOUT_PLOT,
)
