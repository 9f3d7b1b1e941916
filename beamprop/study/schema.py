"""What a study file may hold, and every mistake in it at a time.

The models of pydantic are made of the tables that the command's options are made of, so that names, units and messages are the same.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import lru_cache, partial
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Tag, ValidationError, create_model
from pydantic_core import ErrorDetails

from .. import parameters, validate
from ..parameters import Parameter
from .questions import LATERAL, OF_BEAMS, QUESTIONS, TOLERANCE, lateral_of, slab_of, structure_of

#: Where answers go.
OUTPUT: dict[str, Parameter] = {
    "file": Parameter(
        None, parameters.text, "The dataset: .nc (or .nc4, .netcdf, .h5), .zarr, .mat, .vti, .vtr or .csv."
    ),
    "plot": Parameter(None, parameters.text, "A picture: .png, .svg or .pdf."),
    **parameters.PICTURE,
    "band": Parameter(
        None,
        parameters.text,
        "The axis of random copies: their median, and a band from the 5th to the 95th percentile.",
    ),
    "store": Parameter(
        None, parameters.text, "A .zarr that a sweep is written to block by block, and goes on in after a kill."
    ),
    "memory": Parameter(None, parameters.size, "What may be held: 2GB."),
    "workers": Parameter(None, parameters.count, "Processes; all cores."),
}
_QUESTION = {"name": Parameter(None, parameters.as_it_is, "Which.", words=tuple(QUESTIONS))}


class Mistake(ValueError):
    """A mistake at a path of the file: what was expected, what came."""

    def __init__(self, path: str, said: str) -> None:
        super().__init__(f"{path}: {said}")
        self.path = path


def _value(name: str, parameter: Parameter) -> Any:
    """The type of a value: whatever its parameter reads."""
    return Annotated[Any, BeforeValidator(lambda value: parameters.read({name: value}, {name: parameter}, name)[name])]


def _made_by(make: Callable[[Any], Any]) -> Any:
    """The type of what a function can make; its errors name keys of the value."""

    def check(value: Any) -> Any:
        make(value)
        return value

    return Annotated[Any, BeforeValidator(check)]


def _model(name: str, table: Mapping[str, Parameter], **more: Any) -> type[BaseModel]:
    """A table as a model."""
    fields: dict[str, Any] = {key: (_value(key, parameter), None) for key, parameter in table.items()}
    fields |= {key: (kind, None) for key, kind in more.items()}
    made: type[BaseModel] = create_model(name, __config__=ConfigDict(extra="forbid"), **fields)
    return made


def _either(table: type[BaseModel], words: Any) -> Any:
    """A table, or what is said in words."""
    kind = Discriminator(lambda value: "table" if isinstance(value, Mapping) else "words")
    return Annotated[Annotated[table, Tag("table")] | Annotated[words, Tag("words")], kind]


def _layers(**more: Any) -> dict[str, Any]:
    layer: Any = _either(_model("Layer", parameters.LAYER), _made_by(parameters.layer))
    several = Annotated[list[layer], BeforeValidator(lambda value: value if isinstance(value, list) else [value])]
    return {"layer": several, **more}


@lru_cache(maxsize=len(QUESTIONS) + 1)
def _document(name: str | None) -> type[BaseModel]:
    """The model of a file that asks a question; of one without a good name, all that any question may be asked with."""
    fluid = _either(_model("Fluid", parameters.FLUID), _made_by(lambda name: parameters.slab({"background": name})))
    behind = _either(_model("Behind", parameters.BEHIND), _made_by(lambda name: parameters.slab({"after": name})))
    part = _model("Part", parameters.PART, **_layers())
    around = {"background": fluid, "after": behind, "stack": list[part]}  # type: ignore[valid-type]
    own = QUESTIONS.get(str(name), {key: p for table in QUESTIONS.values() for key, p in table.items()})
    fields: dict[str, Any] = {
        "question": (_model("Question", _QUESTION | own), ...),
        "slab": (_model("Slab", parameters.SLAB, **_layers(**around)), None),
        "beam": (_model("Beam", parameters.BEAM), None),
        "tolerance": (_model("Tolerance", TOLERANCE), None),
        "sweep": (dict[str, Any], None),
        "output": (_model("Output", OUTPUT), None),
    }
    if name is not None and name not in OF_BEAMS:
        del fields["beam"]
    if name == "bloch":
        del fields["tolerance"]
    made: type[BaseModel] = create_model("Study", __config__=ConfigDict(extra="forbid"), **fields)
    return made


def mistakes(document: Mapping[str, Any]) -> list[Mistake]:
    """Every mistake in the keys and values of a document, but those of its sweep."""
    question = document.get("question")
    name = question.get("name") if isinstance(question, Mapping) else None
    model = _document(name if isinstance(name, str) and name in QUESTIONS else None)
    wrong: list[Mistake] = []
    try:
        model.model_validate(document)
    except ValidationError as error:
        wrong = [_mistake(details, model) for details in error.errors(include_url=False)]
    if isinstance(question, Mapping) and name is None:
        wrong.append(Mistake("question.name", f"expected {' or '.join(map(repr, QUESTIONS))}, got none"))
    return wrong


def together(document: Mapping[str, Any], wrong: Iterable[Mistake]) -> list[Mistake]:
    """What is wrong with values of the right form, and with tables taken as a whole, at the first point of the sweep.

    A table that has mistakes by itself is not taken as a whole; mistakes in one hide none in another.
    """
    paths = {mistake.path for mistake in wrong}
    bad = {path.partition(".")[0] for path in paths}
    if "sweep" in bad:
        return []
    found = list(_magnitudes(document, paths))
    asked = not found and "question" not in bad
    if not bad & {"slab", "tolerance"}:
        found += _refusals(lambda: _structure(document, asked), "slab", document)
    beam = document.get("beam")
    if isinstance(beam, Mapping):
        if "beam" not in bad:
            found += _refusals(lambda: parameters.beam(beam), "beam", document)
        if (
            not paths & {"beam", "beam.z0"} and "z0" in beam
        ):  # whatever the source is, and whatever else is wrong with it
            found += _refusals(lambda: parameters.beam({"z0": beam["z0"]}), "beam", document)
    if "question" not in bad and _name_of(document) == "scattering":
        given = dict.fromkeys(LATERAL) | document["question"]
        found += _refusals(lambda: lateral_of(given), "question", document)
    return list({mistake.path: mistake for mistake in reversed(found)}.values())[::-1]


def _structure(document: Mapping[str, Any], asked: bool) -> Any:
    """The slab of a document, with what its question adds to it where that has no mistake."""
    if _name_of(document) == "bloch":
        return parameters.cell(document.get("slab", {}))
    return slab_of(document) if asked else structure_of(document)


def _magnitudes(document: Mapping[str, Any], wrong: Collection[str]) -> Iterator[Mistake]:
    """Numbers of the question that are none of its kind."""
    name = _name_of(document)
    own, asked = QUESTIONS.get(name, {}), document.get("question", {})
    checks: dict[str, Callable[[Any, str], Any]] = {
        "frequency": partial(validate.axis, positive=True),
        "angle": partial(validate.angles, grazing=name == "scattering"),
        "rtol": validate.rtol,
    }

    def look(key: str) -> None:
        checks[key](own[key].parse(asked[key], key), key)

    for key in checks:
        if key in own and key in asked and f"question.{key}" not in wrong:
            yield from _refusals(partial(look, key), "question", document)


def _name_of(document: Mapping[str, Any]) -> str:
    """The name of the question, as far as there is one."""
    question = document.get("question")
    return str(question.get("name")) if isinstance(question, Mapping) else ""


def _refusals(make: Callable[[], Any], table: str, document: Mapping[str, Any]) -> Iterator[Mistake]:
    try:
        make()
    except ValueError as error:
        yield at(str(error), document, table)


def at(message: str, document: Mapping[str, Any], table: str = "question") -> Mistake:
    """A refusal of the package as a mistake: ``eta of stack 2: expected ...`` is at slab.stack.2.eta."""
    about, colon, said = message.partition(": ")
    if not colon or len(about) > 80:
        return Mistake(table, message)
    *outer, last = reversed(about.split(" of "))
    path = ".".join((*".".join(outer).split(), last)) if outer else last
    first = path.replace(",", ".").partition(".")[0]
    own = QUESTIONS.get(_name_of(document), {})
    homes = {"slab": {*parameters.SLAB, "stack"}, "beam": {*parameters.BEAM}, "question": {*own}, "output": {*OUTPUT}}
    home = table if first in homes.get(table, ()) else next((h for h, names in homes.items() if first in names), "")
    return Mistake(f"{home}.{path}" if home else path, said)


def _mistake(details: ErrorDetails, model: type[BaseModel]) -> Mistake:
    """An error of pydantic in the words of the package."""
    where = [part + 1 if isinstance(part, int) else part for part in details["loc"] if part not in ("table", "words")]
    path, got = ".".join(map(str, where)), validate.shown(details["input"])
    if details["type"] == "extra_forbidden":
        names = _names_at(model, details["loc"][:-1])
        near = difflib.get_close_matches(str(where[-1]), names, 1)
        hint = f"; did you mean {near[0]}?" if near else f" (there are {', '.join(names)})"
        return Mistake(path, f"expected a name that {'.'.join(map(str, where[:-1])) or 'a study'} has, got {got}{hint}")
    if details["type"] == "value_error":
        about, colon, said = str(details["ctx"]["error"]).partition(": ")
        key = about.partition(" of ")[0]
        inner = f".{key}" if " of " in about and key not in path else ""
        return Mistake(path + inner, said if colon else about)
    kinds = {"missing": ("a table", "none"), "list_type": ("a list of tables", got)}
    expected, got = kinds.get(details["type"], ("a table of names and values", got))
    return Mistake(path, f"expected {expected}, got {got}")


def _names_at(model: Any, loc: tuple[int | str, ...]) -> list[str]:
    """Names of the fields of the model at a place within a model."""
    for part in loc:
        fields = getattr(model, "model_fields", None)
        if fields is not None and part in fields:
            model = _inner(fields[part].annotation)
    return list(getattr(model, "model_fields", ()))


def _inner(annotation: Any) -> Any:
    """The model within a type."""
    if hasattr(annotation, "model_fields"):
        return annotation
    within = (_inner(part) for part in getattr(annotation, "__args__", ()))
    return next((model for model in within if model is not None), None)


def parameter_at(document: Mapping[str, Any], path: str) -> Parameter:
    """The parameter at a dotted path of a study: slab.eta, slab.layer.2.thickness.

    Raises
    ------
    ValueError
        There is none.
    """
    tables = {
        "slab": parameters.SLAB,
        "beam": parameters.BEAM,
        "question": QUESTIONS.get(_name_of(document), {}),
        "tolerance": TOLERANCE,
    }
    kinds = {
        "layer": parameters.LAYER,
        "stack": parameters.PART,
        "background": parameters.FLUID,
        "after": parameters.BEHIND,
    }
    table, place = tables.get(path.partition(".")[0], {}), document.get(path.partition(".")[0], {})
    for part, following in zip(path.split(".")[1:], [*path.split(".")[2:], ""], strict=True):
        inside, place = place, _inside(place, part)
        if part in table and not following:
            return table[part]
        if isinstance(inside, list) and place is not None and table is parameters.LAYER and not following:
            return _LAYER
        if part in kinds and isinstance(place, Mapping | list):
            table = kinds[part]
        elif not part.isdigit() or not isinstance(place, Mapping):
            break
    known = [f"{home}.{key}" for home, names in tables.items() for key in names]
    near = difflib.get_close_matches(path, known, 1)
    hint = f"did you mean {near[0]}?" if near else "such as slab.eta or slab.layer.2.thickness"
    raise ValueError(f"expected the path of a value in the file, got {path!r}; {hint}")


def _layer(value: Any, name: str) -> Any:
    """The words of a layer, as they are; refused if they are none."""
    parameters.layer(value, name)
    return value


#: A layer as a value of its own.
_LAYER = Parameter(None, _layer, "A layer in words.")


def value_at(document: Mapping[str, Any], path: str) -> Any:
    """The value at a dotted path, or none."""
    place: Any = document
    for part in path.split("."):
        place = _inside(place, part)
    return place


def _inside(place: Any, part: str) -> Any:
    if isinstance(place, list):
        return place[int(part) - 1] if part.isdigit() and 0 < int(part) <= len(place) else None
    return place.get(part) if isinstance(place, Mapping) else None
