"""Options of the command; those of cell, slab and beam are made of the tables of `parameters`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click
from click.shell_completion import CompletionItem

from .. import parameters
from ..parameters import Parameter
from .failures import attempt, typed

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]
Parse = Callable[[Any, str], Any]


#: Where a context keeps the texts that were typed: name of the parameter -> its texts.
TYPED = "beamprop.typed"


class Checked(click.ParamType):
    """Text that a function reads; what it refuses is wrong use, said of the option or argument as it is typed."""

    name = "value"

    def __init__(self, parse: Parse, name: str, words: tuple[str, ...] = ()) -> None:
        self.parse, self.name, self.words = parse, name, words

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        name = self.name if param is None else max(param.opts, key=len)
        if ctx is not None and param is not None:
            ctx.meta.setdefault(TYPED, {}).setdefault(param.name, []).append(value)
        return attempt(lambda: self.parse(value, name if name.startswith("--") else name.upper()))

    def shell_complete(self, ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
        if self.name == "FILE":
            return [CompletionItem(incomplete, type="file")]
        return [CompletionItem(word) for word in self.words if word.startswith(incomplete)]


def words(*options: str) -> Checked:
    """One of some words."""

    def parse(value: Any, name: str) -> Any:
        from .. import validate

        return validate.word(value, name, *options)

    return Checked(parse, f"[{'|'.join(options)}]", options)


def _positive(value: Any, name: str) -> float:
    from .. import validate

    return validate.as_number(parameters.real(value, name), name, positive=True)


def _at_least_zero(value: Any, name: str) -> float:
    from .. import validate

    number = validate.as_number(parameters.real(value, name), name)
    if number < 0:
        raise validate.refuse(name, "a number of at least 0", number)
    return number


def axis_of(name: str) -> Checked:
    """The kind of an axis, with the units that it may have."""
    return Checked(lambda value, option: parameters.axis(value, option, parameters.AXES[name]), "AXIS")


REAL = Checked(parameters.real, "NUMBER")
POSITIVE = Checked(_positive, "NUMBER")
AT_LEAST_ZERO = Checked(_at_least_zero, "NUMBER")
LENGTH = Checked(parameters.length, "LENGTH")
LENGTHS = Checked(parameters.lengths, "LENGTH")
COUNT = Checked(parameters.count, "COUNT")
NAMES = Checked(lambda value, name: [part.strip() for part in value.split(",")], "NAMES")


# --- files ------------------------------------------------------------------------------------------------


def target(*endings: str) -> Checked:
    """A file to write, with one of some endings (or any that a dataset is written with), where it can be written."""

    def parse(value: Any, name: str) -> Path:
        from ..io.exports import WRITTEN

        path = Path(value)
        if path.suffix.lower() not in (endings or WRITTEN):
            raise ValueError(f"{name}: expected a name ending in {' or '.join(endings or WRITTEN)}, got {value!r}")
        from ..io.storage import check_target

        with parameters.named(name, "path"):
            check_target(path)
        if path.suffix.lower() == ".zarr":
            from ..io.storage.zarr_store import need_zarr

            need_zarr()
        elif path.is_dir() and not path.is_symlink():
            raise ValueError(f"{name}: expected a file or a new name, got a folder: {value!r}")
        return path

    return Checked(parse, "FILE")


def _existing(value: Any, name: str) -> Path:
    path = Path(value)
    if "\0" in value or not path.exists():
        raise ValueError(f"{name}: expected an existing file, got {value!r}")
    return path


SOURCE = Checked(_existing, "FILE")


# --- options in groups ------------------------------------------------------------------------------------


class Option(click.Option):
    """An option with the heading that it stands under in the help; the function that reads it, not click, has its default."""

    def __init__(self, *args: Any, group: str = "Question", shown: Any = None, **kwargs: Any) -> None:
        if shown is not None:
            kwargs["help"] = f"{kwargs['help']}  [default: {shown}]"
        super().__init__(*args, **kwargs)
        self.group = group


def option(*names: str, kind: click.ParamType | None = None, text: str, shown: Any = None, **more: Any) -> Decorator:
    """An option of a kind."""
    if kind is not None:
        more["metavar"] = kind.name
    return click.option(*names, cls=Option, type=kind, help=text, shown=shown, **more)


def switch(*names: str, text: str, group: str = "Question") -> Decorator:
    """An option that is there or not."""
    return click.option(*names, cls=Option, is_flag=True, help=text, group=group)


def all_of(*options: Decorator) -> Decorator:
    """Options as one decorator."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for decorator in reversed(options):
            function = decorator(function)
        return function

    return decorate


def option_of(table: Mapping[str, Parameter], name: str, group: str) -> Decorator:
    """The option of a parameter."""
    parameter = table[name]
    if parameter.parse is parameters.switch:
        return switch(typed(name), text=parameter.text, group=group)
    kind = Checked(parameter.parse, "FILE" if name in ("profile", "layers", "source_plane", "array") else "TEXT")
    if parameter.words:
        kind = words(*parameter.words)
    elif parameter.parse in _METAVARS:
        kind = Checked(parameter.parse, _METAVARS[parameter.parse])
    shown = parameter.shown or parameter.default
    return option(typed(name), kind=kind, text=parameter.text, shown=shown, group=group, multiple=name == "layer")


_METAVARS = {
    parameters.number: "COMPLEX",
    parameters.real: "NUMBER",
    parameters.length: "LENGTH",
    parameters.widths: "LENGTH",
    parameters.frequency: "FREQUENCY",
    parameters.count: "COUNT",
}


def axis(name: str, text: str, shown: Any = None) -> Decorator:
    """The option of an axis."""
    return option(typed(name), kind=axis_of(name), text=text, shown=shown)


def given(options: Mapping[str, Any], table: Mapping[str, Parameter]) -> dict[str, Any]:
    """Those of a command's options that belong to a table of parameters and were typed."""
    return {name: options[name] for name in table if not any(options[name] is left for left in (None, False, ()))}


def _group(heading: str, table: Mapping[str, Parameter]) -> tuple[Decorator, ...]:
    return tuple(option_of(table, name, heading) for name in table)


CELL = all_of(
    *_group("Layers of your own", parameters.LAYERS),
    *_group("The paper's cell", parameters.LMMD),
    *_group("Around the layers", parameters.BACKGROUND),
)
SLAB = all_of(CELL, *_group("The slab", {n: p for n, p in parameters.SLAB.items() if n not in parameters.CELL}))
BEAM = all_of(
    *_group("The beam", {n: p for n, p in parameters.BEAM.items() if n != "z0"}),
    axis("angle", "From the normal [degree]; an axis: a, a,b,c or start:stop:count.", 0),
    option("--rtol", kind=REAL, text="Requested relative error.", shown=1e-8, default="1e-8"),
)


def launch(shown: str) -> Decorator:
    """The launch plane."""
    return option("--z0", kind=LENGTH, text=parameters.BEAM["z0"].text, shown=shown, group="The beam")


def quantity(question: str) -> Decorator:
    """What the picture of a question shows."""
    shown = parameters.QUANTITIES[question]
    return option("--quantity", kind=words(*shown), text="What --plot draws.", default=shown[0], shown=shown[0])


def output(*picture: str) -> Decorator:
    """Where the answer goes, and of `parameters.PICTURE` what may be said of its picture."""
    return all_of(
        option(
            "--plot",
            "-p",
            kind=target(*parameters.PICTURES),
            group="Output",
            text="Draw it into this .png, .svg or .pdf; a file of that name is replaced.",
        ),
        *_group("Output", {name: parameters.PICTURE[name] for name in picture}),
        option(
            "--output",
            "-o",
            kind=target(),
            group="Output",
            text="Write the dataset to this .nc (or .nc4, .netcdf, .h5: the same), .zarr, .mat, .vti, .vtr or .csv (of one axis); a file or store of that name is replaced.",
        ),
        option(
            "--save-study",
            kind=target(".toml"),
            group="Output",
            text="Write this command as a study file, for beamprop run; a file of that name is replaced.",
        ),
        switch("--json", "as_json", text="Print the dataset as JSON.", group="Output"),
        switch("--quiet", "-q", text="Print nothing but warnings and what was asked for by --json.", group="Output"),
    )
