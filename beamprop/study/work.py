"""What a worker does: the points of a block, their values in arrays of one schema, what failed and what was warned of."""

from __future__ import annotations

import contextlib
import functools
import pickle
import threading
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..api.together import together
from .axes import BOOKKEEPING

#: What the status of a point may be.
EMPTY, DONE, FAILED = range(3)
STATUS = ("empty", "done", "failed")
#: Of a message so much is kept [characters].
LONGEST = 1000


class Field(NamedTuple):
    """A variable at one point of a study."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype


@dataclass(frozen=True, eq=False)
class Schema:
    """What a question answers at each point."""

    fields: dict[str, Field]
    #: The dimensions of its own, with their values.
    coords: dict[str, xr.Variable]
    #: Of the variables.
    attrs: dict[str, dict[str, Any]]
    #: Those variables that are coordinates.
    secondary: tuple[str, ...]
    convention: str

    @property
    def bytes_each(self) -> int:
        """Bytes of a point's values."""
        return sum(int(np.prod(f.shape)) * f.dtype.itemsize for f in self.fields.values())


class Answer(NamedTuple):
    """What came of one point: a dataset or None, and what was said."""

    dataset: xr.Dataset | None
    message: str


class Task(NamedTuple):
    """The points of a block, as they are sent."""

    question: bytes
    names: tuple[str, ...]
    points: list[tuple[Any, ...]]
    schema: Schema
    #: Number in the block -> what is known already.
    known: dict[int, Answer]


class Result(NamedTuple):
    """The answers of a block: arrays whose first axis is the points."""

    values: dict[str, np.ndarray]
    status: np.ndarray
    messages: list[str]
    #: For each point the number of its record of provenance in `records`.
    record: np.ndarray
    records: list[str]


def answers(task: Task) -> Result:
    """Answer the points of a task."""
    question = _question(task.question)
    result = empty_result(task.schema, len(task.points), EMPTY, "")
    numbers: dict[str, int] = {}
    names = set(task.names)
    with alone() as caught:
        for k, answer in _in_turn(task, question, caught):
            problem = _put(answer, result, k, task.schema, names) if answer.dataset is not None else ""
            failed = answer.dataset is None or bool(problem)
            result.status[k] = FAILED if failed else DONE
            result.messages[k] = problem or answer.message
            text = "" if failed or answer.dataset is None else answer.dataset.attrs.get("provenance", "")
            result.record[k] = numbers.setdefault(text, len(numbers))
    return result._replace(records=list(numbers))


#: Points that are asked together: the work around their numbers is shared, and their plane waves stay well below a gigabyte.
TOGETHER = 128


def _in_turn(task: Task, question: Any, caught: list[warnings.WarningMessage]) -> Iterator[tuple[int, Answer]]:
    """The answers at all points of a task, in order; those that are not known yet are asked `together`."""
    for start in range(0, len(task.points), TOGETHER):
        block = range(start, min(start + TOGETHER, len(task.points)))
        new = [k for k in block if k not in task.known]
        answered = together([asking(question, task.names, task.points[k], caught) for k in new])
        known = task.known | dict(zip(new, answered, strict=True))
        yield from ((k, known[k]) for k in block)


def asking(
    question: Any, names: tuple[str, ...], point: tuple[Any, ...], caught: list[warnings.WarningMessage]
) -> Callable[[], Answer]:
    """The question at a point, to be asked."""
    return functools.partial(answer_of, question, dict(zip(names, point, strict=True)), caught)


def empty_result(schema: Schema, count: int, status: int, message: str) -> Result:
    """A result of nan."""
    values = {n: np.full((count, *f.shape), np.nan, f.dtype) for n, f in schema.fields.items()}
    numbers = np.zeros(count, np.int32)
    return Result(values, np.full(count, status, np.int8), [message] * count, numbers, [""])


@functools.lru_cache(maxsize=2)
def _question(pickled: bytes) -> Any:
    """The question that came with a task; a worker unpickles it at its first block."""
    return pickle.loads(pickled)


@contextlib.contextmanager
def alone() -> Iterator[list[warnings.WarningMessage]]:
    """One BLAS thread, and the list of the warnings that come meanwhile.

    Both are settings of a whole process. In a thread of an executor, which is not alone, they stay as they are, and warnings take their usual way.
    """
    if threading.current_thread() is not threading.main_thread():
        yield []
        return
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield caught


def answer_of(question: Any, arguments: dict[str, Any], caught: list[warnings.WarningMessage]) -> Answer:
    """Ask at one point; an error is an answer, and so are the warnings that are caught."""
    try:
        dataset = question(**arguments)
        if not isinstance(dataset, xr.Dataset):
            raise TypeError(f"question: expected a Dataset, got {type(dataset).__name__}")
    except Exception as error:
        return Answer(None, f"{type(error).__name__}: {error}"[:LONGEST])
    finally:
        said = dict.fromkeys(f"{w.category.__name__}: {w.message}" for w in caught)
        caught.clear()
    return Answer(dataset, "; ".join(said)[:LONGEST])


def schema_of(ds: xr.Dataset, names: set[str]) -> Schema:
    """The schema of a first answer; coordinates with an axis's name are the axis.

    Raises
    ------
    ValueError
        A name that the study needs, or a variable that is not of numbers.
    """
    fields, attrs = {}, {}
    coords = {str(d): ds.variables[d] for d in ds.dims if d in ds.variables}
    taken = (set(map(str, ds.data_vars)) & names) | (
        (set(map(str, ds.variables)) | set(map(str, ds.dims))) & {*BOOKKEEPING}
    )
    if taken or set(map(str, ds.dims)) & names:
        wrong = sorted(taken | (set(map(str, ds.dims)) & names))
        raise ValueError(f"question: expected a Dataset without {', '.join(wrong)}, names that the study has itself")
    for name, v in _variables(ds, names).items():
        if v.dtype.kind not in "biufc":
            raise ValueError(f"question: expected variables of numbers, got {name} of {v.dtype}")
        dtype = np.dtype(complex if v.dtype.kind == "c" else float)
        fields[name] = Field(tuple(map(str, v.dims)), v.shape, dtype)
        attrs[name] = dict(v.attrs)
    if not fields:
        raise ValueError("question: expected a Dataset with variables, got one without")
    secondary = tuple(name for name in fields if name in ds.coords)
    return Schema(fields, coords, attrs, secondary, str(ds.attrs.get("convention", "")))


def _variables(ds: xr.Dataset, names: set[str]) -> dict[str, xr.Variable]:
    """Those variables that have a value at each point: all but the axes and the dimensions' own coordinates."""
    return {str(n): v for n, v in ds.variables.items() if n not in ds.dims and n not in names}


def _put(answer: Answer, result: Result, k: int, schema: Schema, names: set[str]) -> str:
    """Put a point's values into a result; what is wrong if they do not fit the schema, and then nothing is put."""
    ds = answer.dataset
    assert ds is not None
    given = _variables(ds, names)
    problem = _difference(ds, given, schema)
    if not problem:
        for name, v in given.items():
            result.values[name][k] = v.values
    return problem


def _difference(ds: xr.Dataset, given: dict[str, xr.Variable], schema: Schema) -> str:
    """How an answer differs from those before it."""
    if given.keys() != schema.fields.keys():
        return f"question: expected the variables {', '.join(schema.fields)} as before, got {', '.join(given)}"
    for name, field in schema.fields.items():
        v = given[name]
        if v.dims != field.dims or v.shape != field.shape or (v.dtype.kind == "c" and field.dtype.kind != "c"):
            before = f"{field.dtype} on {dict(zip(field.dims, field.shape, strict=True))}"
            return f"question: expected {name} to be {before} as before, got {v.dtype} on {v.sizes}"
    for name, coord in schema.coords.items():
        if not ds.variables[name].equals(coord):
            return f"question: expected the same values of its own dimension {name} at every point, got different ones"
    return ""
