"""Study files: a TOML file says which question is asked, of what, at which points, and where the answers go."""

from __future__ import annotations

import contextlib
import copy
import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import parameters, validate
from ..parameters import Parameter
from ..progress import Progress
from . import questions
from . import store as stores
from .axes import BOOKKEEPING
from .schema import OUTPUT, Mistake, at, mistakes, parameter_at, together, value_at
from .sweep import sweep

if TYPE_CHECKING:
    import xarray as xr

#: Values that are paths, relative to the file's folder.
_PATHS = {"slab": ("layers",), "beam": ("profile", "source_plane", "array"), "output": ("file", "plot", "store")}


class Mistakes(ValueError):
    """All mistakes in a study file, a line each."""

    def __init__(self, file: Path, wrong: list[Mistake]) -> None:
        self.wrong = tuple(wrong)
        many = "1 mistake" if len(wrong) == 1 else f"{len(wrong)} mistakes"
        super().__init__("\n".join([f"{file}: {many}", *(f"  {mistake}" for mistake in wrong)]))


@dataclass(frozen=True)
class Point:
    """The question of a study at a point: the description with values put at the paths of the axes."""

    description: Mapping[str, Any]
    paths: Mapping[str, str]
    #: What the files that it reads hold, for a store that outlives them.
    digests: Mapping[str, str]

    def __call__(self, **values: Any) -> xr.Dataset:
        """The answer there."""
        return questions.ask(self.at(**values))

    def at(self, **values: Any) -> dict[str, Any]:
        """The description there."""
        return _put_in(self.description, {name: [value] for name, value in values.items()}, self.paths)


@dataclass(frozen=True)
class StudyFile:
    """A study file that has no mistake."""

    path: Path
    point: Point
    #: Name -> values, in the order of the file.
    axes: Mapping[str, list[Any]]
    output: Mapping[str, Any]

    @property
    def name(self) -> str:
        """The question's."""
        return str(self.point.description["question"]["name"])

    def answer(self, progress: Progress = False, **options: Any) -> xr.Dataset:
        """The answer, at all points if there are several; options are those of `sweep`.

        Raises
        ------
        ValueError
            Named by its place in the file.
        """
        try:
            if not self.axes:
                return questions.ask(self.point.description, progress)
            given = {"store": self.output["store"], "workers": self.output["workers"]} | options
            return sweep(self.point, dict(self.axes), progress=progress, **given)
        except ValueError as error:
            raise self.refused(error) from None

    def refused(self, error: ValueError) -> Mistakes:
        """A refusal of the package, named by its place in the file."""
        return Mistakes(self.path, [at(str(error), self.point.description)])


def read(path: str | Path) -> StudyFile:
    """A study from its file.

    Raises
    ------
    Mistakes
        All that is wrong with it.
    OSError
        It cannot be read.
    """
    path = validate.as_path(path)
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Mistakes(path, [Mistake("TOML", f"expected a file in its form, got: {error}")]) from None
    document = _rooted(document, path.parent)
    wrong = mistakes(document)
    document = _with_tables(document)
    axes, paths, wrong_axes = _axes(document)
    wrong += wrong_axes
    wrong += together(_put_in(document, axes, paths), wrong)
    if not wrong:
        study = _study(path, document, axes, paths)
        wrong = list(_targets(study))
    if wrong:
        raise Mistakes(path, wrong)
    return study


def _put_in(document: Mapping[str, Any], axes: Mapping[str, list[Any]], paths: Mapping[str, str]) -> dict[str, Any]:
    """The document with the first value of each axis in its place."""
    first = copy.deepcopy(dict(document))
    for name, values in axes.items():
        _put(first, paths[name].split("."), values[0])
    return first


def _study(path: Path, document: dict[str, Any], axes: dict[str, list[Any]], paths: dict[str, str]) -> StudyFile:
    description: dict[str, Any] = {
        key: document[key] for key in ("question", "slab", "beam", "tolerance") if key in document
    }
    read = [within[key] for within, key in _paths(description)]
    digests = {file: hashlib.sha256(Path(file).read_bytes()).hexdigest() for file in read}
    output = parameters.read(document.get("output", {}), OUTPUT, "output")
    return StudyFile(path, Point(description, paths, digests), axes, output)


def _paths(document: Mapping[str, Any]) -> Iterator[tuple[dict[str, Any], str]]:
    """The tables in which a path stands, and its key."""
    slab = document.get("slab")
    parts = slab.get("stack") if isinstance(slab, Mapping) else None
    tables = [("slab", part) for part in (parts if isinstance(parts, list) else ())]
    for name, table in [*((name, document.get(name)) for name in _PATHS), *tables]:
        for key in _PATHS[name]:
            if isinstance(table, dict) and isinstance(table.get(key), str):
                yield table, key


def _rooted(document: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The document with whole paths, wherever the command runs."""
    rooted = copy.deepcopy(document)
    for table, key in _paths(rooted):
        table[key] = os.path.abspath(folder / table[key])
    return rooted


# --- axes ---------------------------------------------------------------------------------------------------


def _axes(document: Mapping[str, Any]) -> tuple[dict[str, list[Any]], dict[str, str], list[Mistake]]:
    """Name -> values and name -> path of each axis of the sweep, and what is wrong with them."""
    axes: dict[str, list[Any]] = {}
    paths: dict[str, str] = {}
    wrong = []
    # the width that it measures
    variables = {"fwhm"} if "beam_measures" in str(document.get("question")) else set()
    table = document.get("sweep", {})
    for path, given in _flat(table) if isinstance(table, Mapping) else ():
        try:
            parameter = parameter_at(document, path)
            values = _values(given, parameter)
            name = _name(path, {*paths, *variables})
            _put(copy.deepcopy(dict(document)), path.split("."), values[0])
        except ValueError as error:
            wrong.append(Mistake(f"sweep.{path}", str(error).removeprefix("axis: ")))
        else:
            axes[name], paths[name] = values, path
    return axes, paths, wrong


def _with_tables(document: dict[str, Any]) -> dict[str, Any]:
    """The document with a table in place of the words of each layer that a sweep goes into, for words have no place for a value."""
    changed, table = copy.deepcopy(document), document.get("sweep", {})
    for path, _ in _flat(table) if isinstance(table, Mapping) else ():
        before, within, after = path.partition(".layer.")
        number, _, key = after.partition(".")
        home = value_at(changed, before) if within and number.isdigit() else None
        if not isinstance(home, dict):
            continue
        layers = home.get("layer")
        layers = [layers] if isinstance(layers, str | Mapping) else layers
        if isinstance(layers, list) and 0 < int(number) <= len(layers):
            home["layer"] = layers
            if key and isinstance(words := layers[int(number) - 1], str):
                with contextlib.suppress(ValueError):  # words that are no layer are a mistake of their own
                    layers[int(number) - 1] = parameters.described(words, "layer", parameters.LAYER)
    return changed


def _flat(table: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path -> value, of keys with dots within quotes and of those without."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield above + key, value


def _name(path: str, taken: set[str]) -> str:
    """The last part of a path with a name of its own, and what comes before as far as a number or another axis needs it."""
    parts = path.split(".")
    for size in range(1, len(parts) + 1):
        name = "_".join(parts[-size:])
        if name not in taken and name.isidentifier() and not any(part.isdigit() for part in parts[-size - 1 : -size]):
            return name + "_" if name in BOOKKEEPING else name
    return "_".join(parts)


def _values(given: Any, parameter: Parameter) -> list[Any]:
    """The values of an axis: a list, each as the parameter reads it, or a text of evenly spaced numbers."""
    if isinstance(given, str) and ":" in given:
        given = parameters.axis(given, "axis", parameters.units_of(parameter))
        given = given.tolist() if parameters.is_several(given) else [given]
    if not isinstance(given, list) or not given:
        raise validate.refuse("axis", "a list, start:stop:count or start:stop:count:log", given)
    values = [parameters.read({"axis": v}, {"axis": parameter}, "axis")["axis"] for v in given]
    values = [str(v).lower() if isinstance(v, bool) else v for v in values]
    if any(not isinstance(v, int | float | complex | str) for v in values):
        raise validate.refuse("axis", "numbers or words", given)
    if len(set(values)) < len(values):
        raise validate.refuse("axis", "values that differ from one another", given)
    return values


def _put(table: Any, path: list[str], value: Any) -> None:
    """Put a value at a path; numbers in it count from 1."""
    for part in path[:-1]:
        table = table[int(part) - 1] if isinstance(table, list) else table.setdefault(part, {})
    if isinstance(table, list):
        table[int(path[-1]) - 1] = value
    else:
        table[path[-1]] = value


# --- where answers go ---------------------------------------------------------------------------------------


def _targets(study: StudyFile) -> Iterator[Mistake]:
    """What cannot be written."""
    from ..io.exports import WRITTEN
    from ..io.storage import check_target

    for key, endings in (("file", WRITTEN), ("plot", parameters.PICTURES), ("store", (".zarr",))):
        target = study.output[key]
        if target is None:
            continue
        if Path(target).suffix.lower() not in endings:
            yield Mistake(
                f"output.{key}", f"expected a name ending in {' or '.join(endings)}, got {Path(target).name!r}"
            )
            continue
        try:
            (stores.target if key == "store" else check_target)(target)
        except ValueError as error:
            yield Mistake(f"output.{key}", str(error).partition(": ")[2])
    if study.output["store"] is not None and not study.axes:
        yield Mistake(
            "output.store",
            "expected a sweep, whose blocks it keeps, got none; a question's answer goes to output.file",
        )
    if study.output["store"] is not None and study.output["store"] == study.output["file"]:
        yield Mistake("output.file", f"expected a name other than that of output.store, got {study.output['file']!r}")


# --- from a command line ------------------------------------------------------------------------------------


def write(path: Path, tables: Mapping[str, Mapping[str, Any]]) -> None:
    """Write a study file; the paths in it, given relative to where the command runs, become relative to its folder."""
    from ..io.storage import write_whole

    moved = {name: dict(table) for name, table in tables.items() if table}
    for table, keys in _PATHS.items():
        for key in set(keys) & moved.get(table, {}).keys():
            moved[table][key] = os.path.relpath(moved[table][key], path.parent)
    write_whole(path, lambda draft: _write(draft, text_of(moved)))


def text_of(tables: Mapping[str, Mapping[str, Any]]) -> str:
    """Tables of plain values as the text of a study file.

    Examples
    --------
    >>> from beamprop.study.files import text_of
    >>> print(text_of({"slab": {"layer": [{"material": "water", "thickness": "2mm"}]}}))
    [slab]
    layer = [{material = "water", thickness = "2mm"}]
    <BLANKLINE>
    """
    return "\n".join(f"[{name}]\n" + "".join(f"{k} = {_toml(v)}\n" for k, v in t.items()) for name, t in tables.items())


def _write(draft: Path, text: str) -> None:
    draft.write_text(text, encoding="utf-8")


def _toml(value: Any) -> str:
    """A value as TOML has it; JSON's strings and numbers are TOML's."""
    import json

    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {_toml(v)}" for key, v in value.items()) + "}"
    return json.dumps(value if isinstance(value, bool | int | float) else os.fspath(value), ensure_ascii=False)
