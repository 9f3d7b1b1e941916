"""A command line as a study file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from .. import parameters
from .options import TYPED


def save_study(path: Path) -> None:
    """Write the study file that the present command line amounts to: what was typed, as it was typed."""
    from ..study import files
    from ..study.questions import OF_BEAMS, QUESTIONS
    from ..study.schema import OUTPUT

    ctx = click.get_current_context()
    name, typed = str(ctx.command.name), _typed(ctx)
    typed["file"] = typed.pop("output", None)
    homes = {"question": QUESTIONS[name], "slab": parameters.SLAB, "beam": parameters.BEAM if name in OF_BEAMS else {}}
    tables = {
        home: {key: typed[key] for key in names if typed.get(key) is not None}
        for home, names in (homes | {"output": OUTPUT}).items()
    }
    files.write(path, tables | {"question": {"name": name} | tables["question"]})


def _typed(ctx: click.Context) -> dict[str, Any]:
    """Name -> text of the options that were typed; a list of those that may be repeated, True of switches."""
    texts = ctx.meta.get(TYPED, {})
    typed: dict[str, Any] = {}
    for parameter in ctx.command.params:
        name = str(parameter.name)
        if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE:
            several = getattr(parameter, "multiple", False)
            typed[name] = (texts[name] if several else texts[name][-1]) if name in texts else ctx.params[name]
    return typed
