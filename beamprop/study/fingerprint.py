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
import sys
import sysconfig
import textwrap
import types
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

#: Of a part's text so much is kept [characters], and a checksum.
LONGEST = 5000
_INSTALLED = tuple(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib"))


def parts_of(question: Any) -> dict[str, str]:
    """Name -> text of everything that a question's answer may depend on; equal for equal questions."""
    parts: dict[str, str] = {}
    _collect(question, "question", parts, set())
    return {
        name: text if len(text) <= LONGEST else f"{text[:LONGEST]} {_hash(text.encode())}"
        for name, text in parts.items()
    }


def _collect(value: Any, name: str, parts: dict[str, str], seen: set[int]) -> None:
    """Add a value's parts under its name; functions that call themselves end here."""
    if isinstance(value, functools.partial):
        parts[f"{name}.arguments"] = text_of((value.args, value.keywords))
        _collect(value.func, name, parts, seen)
    elif isinstance(value, types.MethodType):
        parts[f"{name}.self"] = text_of(value.__self__)
        _collect(value.__func__, name, parts, seen)
    elif isinstance(value, types.FunctionType | type):
        if not _is_own(value):
            parts[f"{name}.value"] = text_of(value)
        elif id(value) not in seen:
            seen.add(id(value))
            parts[f"{name}.source"] = source_of(value)
            functions = vars(value).values() if isinstance(value, type) else (value,)
            for function in functions:
                for inner, around in _taken_from_around(function) if isinstance(function, types.FunctionType) else ():
                    _collect(around, inner, parts, seen)
    else:
        parts[f"{name}.value"] = text_of(value)
        if callable(value):
            _collect(type(value), type(value).__qualname__, parts, seen)


def _is_own(value: types.FunctionType | type) -> bool:
    """Whether a function or class is neither an installed package's nor this one's."""
    module = value.__module__ or ""
    file = getattr(sys.modules.get(module), "__file__", None) or ""
    return module.split(".")[0] not in (__name__.split(".")[0], "builtins") and not file.startswith(_INSTALLED)


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


#: Names that many texts have: from Python 3.13 on, what is looked up under them is the program of ``python -c``, whatever was executed.
SHARED_NAMES = ("<string>", "<stdin>")


def source_of(value: types.FunctionType | type) -> str:
    """The source without comments and layout; of a lambda its body; the instructions where there is no source."""
    try:
        if isinstance(value, types.FunctionType) and value.__code__.co_filename in SHARED_NAMES:
            raise OSError("no source")
        if value.__name__ == "<lambda>" and isinstance(value, types.FunctionType):
            return _body_of_lambda(value.__code__)
        return ast.unparse(ast.parse(textwrap.dedent(inspect.getsource(value))))
    except (OSError, TypeError, SyntaxError, ValueError):
        functions = vars(value).values() if isinstance(value, type) else (value,)
        return " ".join(_instructions(f.__code__) for f in functions if isinstance(f, types.FunctionType))


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
    text = b"".join(encoded).decode()
    try:
        return ast.unparse(ast.parse(f"({text}\n)"))
    except SyntaxError:  # the outermost parentheses are no instruction's
        return " ".join(text.split())


def _instructions(code: types.CodeType) -> str:
    constants = [_instructions(c) if isinstance(c, types.CodeType) else repr(c) for c in code.co_consts]
    return f"instructions {_hash(code.co_code)} {code.co_names} {constants}"


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def text_of(value: Any) -> str:
    """A text that differs where values do; arrays by their checksum."""
    value = _plain(value)
    if isinstance(value, np.ndarray):
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


def _plain(value: Any) -> Any:
    """Containers whose repr is shortened or has no order, as those whose has."""
    if isinstance(value, pd.DataFrame | pd.Series):
        value = value.to_xarray()
    if isinstance(value, xr.Dataset | xr.DataArray):
        return value.to_dict(data="array")
    if isinstance(value, set | frozenset):
        return sorted(map(text_of, value))
    if isinstance(value, np.ndarray) and value.dtype.kind == "O":
        return value.tolist()
    return value


def _text_of_object(value: Any) -> str:
    """Of an object whose repr is an address: its class and what it holds."""
    return f"{type(value).__qualname__}({text_of(getattr(value, '__dict__', {}))})"
