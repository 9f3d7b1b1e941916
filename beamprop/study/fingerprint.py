"""What a question is, by parts: its source without comments, and the values it takes from around it.

A study that goes on in a store must be the one that began it. Functions of the user's own are followed into what they call;
those of installed packages and of this one stand by their names.
"""

from __future__ import annotations

import ast
import dataclasses
import dis
import functools
import hashlib
import inspect
import linecache
import sysconfig
import textwrap
import types
from collections.abc import Iterator
from typing import Any

import numpy as np

_INSTALLED = tuple(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib"))


def parts_of(question: Any) -> dict[str, str]:
    """Name -> text of everything that a question's answer may depend on; equal for equal questions."""
    parts = {"question": f"{getattr(question, '__module__', '')}.{getattr(question, '__qualname__', type(question))}"}
    _collect(question, "question", parts, set())
    return parts


def _collect(value: Any, name: str, parts: dict[str, str], seen: set[int]) -> None:
    """Add a value's parts under its name; functions that call themselves end here."""
    if isinstance(value, functools.partial):
        parts[f"{name}.arguments"] = text_of((value.args, value.keywords))
        _collect(value.func, name, parts, seen)
    elif isinstance(value, types.MethodType):
        parts[f"{name}.self"] = text_of(value.__self__)
        _collect(value.__func__, name, parts, seen)
    elif isinstance(value, types.FunctionType) and _is_own(value):
        if id(value) not in seen:
            seen.add(id(value))
            parts[f"{name}.source"] = source_of(value)
            for inner, around in _taken_from_around(value):
                _collect(around, inner, parts, seen)
    else:
        parts[f"{name}.value"] = text_of(value)


def _is_own(function: types.FunctionType) -> bool:
    """Whether a function is neither an installed package's nor this one's."""
    module = function.__module__ or ""
    return module.split(".")[0] != __name__.split(".")[0] and not function.__code__.co_filename.startswith(_INSTALLED)


def _taken_from_around(function: types.FunctionType) -> Iterator[tuple[str, Any]]:
    """Defaults, variables of the functions around, and globals that a function reads."""
    if function.__defaults__ or function.__kwdefaults__:
        yield "defaults", (function.__defaults__, function.__kwdefaults__)
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            yield name, cell.cell_contents
        except ValueError:  # not assigned yet
            yield name, None
    for name in sorted(_globals_of(function.__code__)):
        if name in function.__globals__:
            yield name, function.__globals__[name]


def _globals_of(code: types.CodeType) -> set[str]:
    """Names of the globals that a code and those within it read."""
    names = {str(step.argval) for step in dis.get_instructions(code) if step.opname in ("LOAD_GLOBAL", "LOAD_NAME")}
    return names.union(*(_globals_of(inner) for inner in code.co_consts if isinstance(inner, types.CodeType)))


def source_of(function: types.FunctionType) -> str:
    """The source without comments and layout; of a lambda its body; the instructions where there is no source."""
    try:
        if function.__name__ == "<lambda>":
            return _body_of_lambda(function.__code__)
        return ast.unparse(ast.parse(textwrap.dedent(inspect.getsource(function))))
    except (OSError, TypeError, SyntaxError, ValueError):
        return _instructions(function.__code__)


def _body_of_lambda(code: types.CodeType) -> str:
    """The text between the first and the last place that a lambda's instructions come from."""
    places = [(p[0] or 0, p[1] or 0, p[2] or 0, p[3] or 0) for p in code.co_positions() if None not in p]
    # an instruction of no width is none of the text's
    starts = [(line, column) for line, end, column, stop in places if (line, column) != (end, stop)]
    start, end = min(starts), max((end, stop) for _, end, _, stop in places)
    lines = linecache.getlines(code.co_filename)[start[0] - 1 : end[0]]
    if not lines:
        raise OSError("no source")
    encoded = [line.encode() for line in lines]  # columns count bytes
    encoded[-1] = encoded[-1][: end[1]]
    encoded[0] = encoded[0][start[1] :]
    return " ".join(b"".join(encoded).decode().split())


def _instructions(code: types.CodeType) -> str:
    constants = [_instructions(c) if isinstance(c, types.CodeType) else repr(c) for c in code.co_consts]
    return f"instructions {_hash(code.co_code)} {code.co_names} {constants}"


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def text_of(value: Any) -> str:
    """A text that differs where values do; arrays by their checksum."""
    if isinstance(value, np.ndarray) and value.dtype.kind != "O":
        return f"array {value.dtype} {value.shape} {_hash(np.ascontiguousarray(value).tobytes())}"
    if isinstance(value, np.generic):
        return repr(value.item())
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k!r}: {text_of(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return f"({', '.join(map(text_of, value))})"
    if isinstance(value, types.ModuleType):
        return value.__name__
    if isinstance(value, types.FunctionType) and _is_own(value):
        return "; ".join(parts_of(value).values())
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = ", ".join(f"{f.name}={text_of(getattr(value, f.name))}" for f in dataclasses.fields(value))
        return f"{type(value).__qualname__}({fields})"
    if isinstance(value, type | types.FunctionType | types.BuiltinFunctionType):
        return f"{value.__module__}.{value.__qualname__}"
    text = repr(value)
    return text if " at 0x" not in text else _text_of_object(value)


def _text_of_object(value: Any) -> str:
    """Of an object whose repr is an address: its class and what it holds."""
    return f"{type(value).__module__}.{type(value).__qualname__}({text_of(getattr(value, '__dict__', {}))})"
