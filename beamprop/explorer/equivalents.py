"""A question as text that asks it again: lines of Python, a command line, a study file."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from pprint import pformat
from typing import Any

from .. import parameters
from ..sources.profile import Profile
from ..sources.slits import Slits
from ..study.files import text_of
from ..study.questions import QUESTIONS, TOLERANCE, slab_of
from . import state
from .controls import Board, Description

#: Lines end before this column.
WIDE = 110


def texts(board: Board, name: str, moved: Any) -> list[dict[str, str]]:
    """Title, file name and text of each way to ask a question at moved values.

    Raises
    ------
    ValueError
        Names the value that is wrong.
    """
    described = state.description(board, state.values_of(board, moved), name)
    return [
        {"title": "Python", "file": f"{name}.py", "text": python(described)},
        {"title": "Command", "file": f"{name}.sh", "text": command(described)},
        {"title": "Study file, for beamprop run", "file": f"{name}.toml", "text": study(described)},
    ]


def study(description: Description) -> str:
    """The study file.

    Examples
    --------
    >>> from beamprop.explorer.equivalents import study
    >>> print(study({"question": {"name": "bloch", "frequency": 2500.0}}), end="")
    [question]
    name = "bloch"
    frequency = 2500.0
    <BLANKLINE>
    [output]
    file = "bloch.nc"
    """
    return text_of(description | {"output": {"file": f"{description['question']['name']}.nc"}})


# --- the command --------------------------------------------------------------------------------------------


def command(description: Description) -> str:
    """The command line; of what has no options, the study file is run.

    Examples
    --------
    >>> from beamprop.explorer.equivalents import command
    >>> command({"question": {"name": "bloch", "frequency": 2500.0}, "slab": {"eta": 0.05}})
    'beamprop bloch --frequency=2500.0 --eta=0.05 --output=bloch.nc\\n'
    """
    name, slab = description["question"]["name"], description.get("slab", {})
    in_file = "stack" in slab or "tolerance" in description
    if in_file or any(isinstance(slab.get(key), Mapping) for key in ("background", "after")):
        return f"beamprop run {name}.toml\n"
    tables = [{k: v for k, v in description["question"].items() if k != "name"}, slab, description.get("beam", {})]
    options = [
        shlex.quote(option) for table in tables for key, value in table.items() for option in _options(key, value)
    ]
    return " ".join(["beamprop", name, *options, f"--output={name}.nc"]) + "\n"


def _options(key: str, value: Any) -> Iterator[str]:
    option = "--" + key.replace("_", "-")
    if isinstance(value, bool):
        if value:
            yield option
    elif key == "layer":
        yield from (f"{option}={_words(layer)}" for layer in value)
    else:
        yield f"{option}={','.join(map(str, value)) if isinstance(value, list | tuple) else value}"


def _words(layer: Mapping[str, Any]) -> str:
    """A layer as the command takes it."""
    return " ".join(str(value) if key == "material" else f"{key}={value}" for key, value in layer.items())


# --- Python -------------------------------------------------------------------------------------------------


def python(description: Description) -> str:
    """The lines of Python.

    Examples
    --------
    >>> from beamprop.explorer.equivalents import python
    >>> print(python({"question": {"name": "bloch", "frequency": 2500.0, "kx_over_k0": "0:2:5"}}), end="")
    import numpy as np
    import beamprop as bp
    <BLANKLINE>
    cell = bp.lmmd_cell()
    ds = bp.bloch(cell, 2500.0, kx_over_k0=np.linspace(0.0, 2.0, 5))
    bp.save(ds, "bloch.nc")
    """
    question = description["question"]
    name = question["name"]
    lines = ["import numpy as np", "import beamprop as bp", "", *_slab(description)]
    arguments = ["cell" if name == "bloch" else "slab"]
    if "beam" in description:
        lines.append(_beam(description))
        arguments.append("beam")
    given = {k: parameters.read({k: v}, {k: QUESTIONS[name][k]}, name)[k] for k, v in question.items() if k != "name"}
    arguments += [_number(question["frequency"], given["frequency"])]
    arguments += [f"{key}={_number(question[key], value)}" for key, value in given.items() if key != "frequency"]
    if name == "bloch" and any(line.startswith(("background = ", "cell, background = ")) for line in lines):
        arguments.append("background=background")
    lines += [_call(f"ds = bp.{name}", arguments), f'bp.save(ds, "{name}.nc")']
    return "\n".join(lines) + "\n"


def _number(plain: Any, value: Any) -> str:
    """A number, or evenly spaced numbers."""
    if parameters.is_several(value) and isinstance(plain, str):
        return f"np.linspace({float(value[0])!r}, {float(value[-1])!r}, {len(value)})"
    return repr(value.tolist() if parameters.is_several(value) else value)


def _call(function: str, arguments: list[str]) -> str:
    """A call, on as many lines as it needs."""
    line = f"{function}({', '.join(arguments)})"
    if len(line) <= WIDE:
        return line
    return f"{function}(\n" + "".join(f"    {argument},\n" for argument in arguments) + ")"


def _beam(description: Description) -> str:
    """The line that makes `beam`."""
    table = description["beam"]
    made: Any = parameters.beam(table, slab_of(description)[1].scale)
    z0 = f"z0={made.z0!r}"
    if isinstance(made, Slits):
        return f"beam = bp.Slits({made.width!r}, {made.separation!r}, {made.count}, {z0})"
    if isinstance(made, Profile):
        turned = ", conjugate=True" if table.get("conjugate") else ""
        return f"beam = bp.Profile.from_file({table['profile']!r}, {z0}{turned})"
    more = [f"{key}={getattr(made, key)!r}" for key in ("x0", "form", "width_of") if key in table]
    return _call("beam = bp.GaussianBeam", [repr(made.fwhm), *more, z0])


def _slab(description: Description) -> Iterator[str]:
    """Lines that make `slab`, or for a contour `cell`."""
    table, of_cell = description.get("slab", {}), description["question"]["name"] == "bloch"
    if _is_plain(table):
        yield from _cell(table)
        if not of_cell:
            yield from _of_cell(table)
    else:
        yield "from beamprop import parameters  # what follows is as in the study file"
        yield ""
        yield f"table = {pformat(dict(table), width=WIDE, sort_dicts=False)}"
        make = "stack" if "stack" in table else "slab"
        yield "cell, background = parameters.cell(table)" if of_cell else f"slab = parameters.{make}(table)"
    if "tolerance" in description:
        values = parameters.read(description["tolerance"], TOLERANCE, "tolerance")
        copies = f"{values['thickness']!r}, {values['density']!r}, count={values['sample'] + 1}, seed={values['seed']}"
        yield f"slab = bp.tolerance(slab, {copies})[{values['sample']}]"


def _is_plain(table: Mapping[str, Any]) -> bool:
    """Whether a slab is a cell of the paper's, or of layers without models, between half-spaces in words or numbers."""
    layers = table.get("layer") or ()
    return (
        not {"stack", "layers", "after_shear_speed"} & set(table)
        and not any("model" in layer for layer in layers)
        and not any(isinstance(table.get(key), Mapping) for key in ("background", "after"))
    )


def _cell(table: Mapping[str, Any]) -> Iterator[str]:
    """Lines that make `background`, unless it is air, and `cell`."""
    values = parameters.read(table, parameters.SLAB, "slab")
    around = ""
    if values["background"] is not None:
        around = f"bp.material({values['background']!r})"
    elif "density" in table or "sound_speed" in table:
        around = f"bp.Fluid.from_speed({values['density']!r}, {values['sound_speed']!r})"
    if around:
        yield f"background = {around}"
    if table.get("layer"):
        yield _call("cell = bp.Cell", [f"[{', '.join(map(_layer, table['layer']))}]"])
    else:
        given = [f"{key}={values[key]!r}" for key in parameters.LMMD if key in table]
        yield _call("cell = bp.lmmd_cell", given + (["background=background"] if around else []))


def _layer(table: Mapping[str, Any]) -> str:
    values = {k: v for k, v in parameters.read(table, parameters.LAYER, "layer").items() if v is not None}
    if "areal_density" in values:
        return f"bp.Membrane({values['areal_density']!r})"
    thickness = values.pop("thickness")
    if "material" in values:
        return f"bp.Layer(bp.material({values['material']!r}), {thickness!r})"
    make = "bp.Fluid.from_speed" if "sound_speed" in values else "bp.Fluid"
    return f"bp.Layer({make}({', '.join(f'{key}={value!r}' for key, value in values.items())}), {thickness!r})"


def _of_cell(table: Mapping[str, Any]) -> Iterator[str]:
    """Lines that make `slab` of `cell`."""
    values = parameters.read(table, parameters.SLAB, "slab")
    arguments = ["cell", f"periods={values['periods']}"]
    if {"background", "density", "sound_speed"} & set(table):
        arguments.append("background=background")
    if values["after"] is not None:
        arguments.append(f"after=bp.material({values['after']!r})")
    elif "after_density" in table or "after_speed" in table:
        pair = (
            values[f"after_{key}"] or values[plain] for key, plain in (("density", "density"), ("speed", "sound_speed"))
        )
        arguments.append(f"after=bp.Fluid.from_speed({', '.join(map(repr, pair))})")
    yield _call("slab = bp.Slab", arguments)
    medium = values["medium"]
    if medium.startswith("lmmd-emt"):
        yield f"slab = bp.lmmd_emt_slab(slab, interface={medium == 'lmmd-emt'})"
    elif medium != "exact":
        fluid = "bp.standard_emt(cell)" if medium == "standard-emt" else "slab.before"
        yield f"slab = bp.Slab.uniform({fluid}, slab.thickness, slab.before, slab.after)"
