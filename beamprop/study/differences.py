"""How two studies differ, parameter by parameter: what a store that belongs to another study is refused with."""

from __future__ import annotations

import ast
import difflib
import re
from collections.abc import Iterator, Mapping

#: Differences that are told, and characters of each text.
MOST, LONGEST = 8, 100
NOTHING = "nothing"
#: What stands for an array in a text: no expression.
ARRAY = re.compile(r"array \w+ \([\d, ]*\) [0-9a-f]+")


def differences(there: Mapping[str, str], here: Mapping[str, str]) -> list[str]:
    """A line for each parameter that differs: of a function those of its source, of a value those of its fields.

    Parameters
    ----------
    there, here : name -> text
        As `fingerprint.parts_of` makes them.

    Examples
    --------
    >>> from beamprop.study.differences import differences
    >>> differences({"BEAM.value": "GaussianBeam(fwhm=0.096, angle=0.0)"}, {"BEAM.value": "GaussianBeam(fwhm=0.1, angle=0.0)"})
    ['BEAM.fwhm: 0.096 there, 0.1 here']
    """
    lines = []
    for name in dict.fromkeys((*there, *here)):
        old, new = there.get(name, NOTHING), here.get(name, NOTHING)
        if old != new:
            pairs = _of_sources if name.endswith(".source") and NOTHING not in (old, new) else _of_values
            lines += [f"{what}: {a} there, {b} here" for what, a, b in pairs(name, old, new)]
    more = len(lines) - MOST
    return lines if more <= 0 else [*lines[:MOST], f"and {more} more"]


def _of_sources(name: str, old: str, new: str) -> Iterator[tuple[str, str, str]]:
    """The lines that differ."""
    a, b = old.splitlines(), new.splitlines()
    for kind, i, j, k, m in difflib.SequenceMatcher(None, a, b, autojunk=False).get_opcodes():
        if kind != "equal":
            yield name, *_apart(*(" ".join(line.strip() for line in part) for part in (a[i:j], b[k:m])))


def _of_values(name: str, old: str, new: str) -> Iterator[tuple[str, str, str]]:
    """The fields, keys and items that differ, by their dotted paths; all of texts that are no expressions."""
    short = name.removesuffix(".value")
    a, b = (_fields(text, short) for text in (old, new))
    for path in dict.fromkeys((*a, *b)):
        if a.get(path) != b.get(path):
            # the description of a study file has the paths that the file has
            yield path.removeprefix("question.description."), *_apart(a.get(path, NOTHING), b.get(path, NOTHING))


def _fields(text: str, name: str) -> dict[str, str]:
    """Dotted path -> text of all that a value is made of."""
    try:
        return dict(_leaves(ast.parse(ARRAY.sub(lambda array: repr(array[0]), text), mode="eval").body, name))
    except (SyntaxError, ValueError, RecursionError):
        return {name: text}


def _leaves(node: ast.expr, name: str) -> Iterator[tuple[str, str]]:
    inner: list[tuple[str, ast.expr]] = []
    if isinstance(node, ast.Call):
        inner = [(word.arg or "", word.value) for word in node.keywords]
        yield f"{name} (kind)", ast.unparse(node.func)
    elif isinstance(node, ast.Dict):
        keys = (key.value if isinstance(key, ast.Constant) else ast.unparse(key or node) for key in node.keys)
        inner = [(str(key), value) for key, value in zip(keys, node.values, strict=True)]
    elif isinstance(node, ast.Tuple | ast.List):
        inner = [(str(number), item) for number, item in enumerate(node.elts, 1)]
    if not inner:
        yield name, ast.unparse(node)
    for part, value in inner:
        yield from _leaves(value, f"{name}.{part}")


def _apart(old: str, new: str) -> tuple[str, str]:
    """Both texts, of long ones the parts about the first place where they differ."""
    same = next((i for i, (a, b) in enumerate(zip(old, new, strict=False)) if a != b), min(len(old), len(new)))
    start = 0 if max(len(old), len(new)) <= LONGEST else max(0, same - LONGEST // 4)
    return _shown(old, start), _shown(new, start)


def _shown(text: str, start: int) -> str:
    part = text[start : start + LONGEST]
    return ("..." * (start > 0) + part + "..." * (start + LONGEST < len(text))) or NOTHING
