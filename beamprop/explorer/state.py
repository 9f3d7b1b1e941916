"""From the values that the page sends to the description of a question: nothing else of a request is ever used."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

from .. import parameters, validate
from ..media.planes import RESOLVED
from .controls import Board, Description

#: Values that the map, a curve of plane waves and the width curve are drawn from.
PLANES, POINTS, WAVES, FREQUENCIES = 400, 400, 401, 21
#: Questions, in the order of the page.
NAMES = ("field", "scattering", "bloch", "beam_width")
#: Gaussian beams have these; other sources have not.
_GAUSSIAN = ("fwhm", "x0", "form", "width_of")


def values_of(board: Board, moved: Any) -> dict[str, Any]:
    """Path -> value of every control, from those that were moved.

    Raises
    ------
    ValueError
        Names the path that is unknown, or whose value cannot be used.
    """
    if not isinstance(moved, Mapping):
        raise validate.refuse("state", "a table of paths and values", moved)
    known = {control.path: control for control in board.controls}
    for path in moved:
        if path not in known:
            raise validate.refuse("state", "paths of values of this study", path)
    slits = moved.get("beam.source") == "slits"
    start = {p: c.slits if slits and c.slits is not None else c.value for p, c in known.items()}
    return {path: control.checked(moved[path]) if path in moved else start[path] for path, control in known.items()}


def description(board: Board, values: Mapping[str, Any], name: str) -> Description:
    """The question `name` about the study at these values, as a study file has it: what is as it was by default is left out.

    Examples
    --------
    >>> from beamprop.explorer.controls import board
    >>> from beamprop.explorer.state import description, values_of
    >>> made = board()
    >>> description(made, values_of(made, {"slab.eta": 0.05}), "bloch")["slab"]
    {'periods': 450, 'eta': 0.05}
    """
    validate.word(name, "question", *NAMES)
    document = copy.deepcopy(dict(board.document))
    document["question"] = {"name": name}
    for control in board.controls:
        if values[control.path] != control.value:
            _put(document, control.path.split("."), values)
    document["beam"] = _beam(document["beam"], values)
    kept = {key: board.document["question"][key] for key in _KEPT[name] if key in board.document["question"]}
    document["question"] |= {"frequency": values["question.frequency"]} | kept
    document["question"] |= _axes(values, name, document)
    if name in ("scattering", "bloch"):
        del document["beam"]
    if name == "bloch":
        if "stack" in document["slab"]:
            raise ValueError("slab: expected one cell for a contour, got a stack of several")
        document.pop("tolerance", None)
        document["slab"] = {key: value for key, value in document["slab"].items() if key in parameters.CELL}
    return {key: table for key, table in document.items() if table}


#: What a study's question says beside its axes, and the page keeps.
_KEPT: dict[str, tuple[str, ...]] = {
    "field": ("rtol",),
    "beam_width": ("rtol", "air_distance"),
    "scattering": (),
    "bloch": (),
}


def _axes(values: Mapping[str, Any], name: str, document: Description) -> dict[str, Any]:
    """The axes of each question."""
    if name == "scattering":
        return {"kx_over_k0": f"0:{values['view.kx']!r}:{WAVES}"}
    if name == "bloch":
        end = values["view.contour"]
        return {"kx_over_k0": f"{-end!r}:{end!r}:{WAVES}"}
    angle = {"angle": values["question.angle"]}
    if name == "beam_width":
        low, high = sorted((values["view.from"], values["view.to"]))
        return {"frequency": f"{low!r}:{high!r}:{FREQUENCIES}", **angle}
    half = values["view.x"]
    return {**angle, "x": f"{-half!r}:{half!r}:{POINTS}", "z": _depths(document, values)}


def _depths(document: Description, values: Mapping[str, Any]) -> str:
    """Planes from the launch plane to behind the slab, on the faces of cells: inside a cell the pressure ripples by its own mean."""
    from ..study.questions import slab_of

    slab, _ = slab_of({key: table for key, table in document.items() if key != "tolerance"})
    first, last = values["beam.z0"], slab.thickness + values["view.behind"]
    wanted = (last - first) / (PLANES - 1)
    cell = slab.segments[0][0].thickness
    if RESOLVED * wanted <= cell:
        step = cell / math.floor(cell / wanted)
    else:
        step = cell * math.ceil(wanted / cell) if cell > 0 else wanted
    # on the launch plane itself the spectrum of an edge has no end: the first plane is behind it
    start = 0 if first == 0 and values["beam.source"] == "gaussian" else math.floor(first / step) + 1
    stop = min(math.ceil(last / step), start + PLANES - 1)
    return f"{start * step!r}:{stop * step!r}:{stop - start + 1}"


def _beam(beam: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The table of the source that is chosen, with its launch plane."""
    source = values["beam.source"]
    kept = {key: value for key, value in beam.items() if key in ("z0", *(_GAUSSIAN if source == "gaussian" else ()))}
    if source == "slits":
        kept["slits"] = [values[f"beam.slits.{key}"] for key in ("width", "separation", "count")]
    elif source == "profile":
        kept |= {key: beam[key] for key in ("profile", "conjugate") if key in beam}
    return kept | {"z0": values["beam.z0"]}


def _put(document: Description, path: list[str], values: Mapping[str, Any]) -> None:
    """Put a value at its path; both parts of a complex one at a time, and what is no value of the study nowhere."""
    if path[0] in ("view", "question") or path[:2] == ["beam", "source"] or path[:2] == ["beam", "slits"]:
        return
    value = values[".".join(path)]
    if path[-1] in ("re", "im"):
        path = path[:-1]
        value = _complex(*(values[".".join((*path, part))] for part in ("re", "im")))
    elif path[0] == "tolerance" and path[-1] in ("seed", "sample"):
        value = int(value)
    place: Any = document
    for part in path[:-1]:
        place = place[int(part) - 1] if isinstance(place, list) else place[part]
    place[path[-1]] = value


def _complex(real: float, imaginary: float) -> Any:
    """A complex number as a study file has it."""
    return real if imaginary == 0 else str(complex(real, imaginary)).strip("()")
