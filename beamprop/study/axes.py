"""A study: a question, and the values of its parameters."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..io.labels import COORDINATES, PARAMETERS, label

Question = Callable[..., xr.Dataset]
#: Names that a study's dataset has for itself.
BOOKKEEPING = ("status", "message", "record", "records", "block")


@dataclass(frozen=True, eq=False)
class Study:
    """A question and the axes on which it is asked, in the order of the result's dimensions."""

    question: Question
    axes: dict[str, np.ndarray]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(map(len, self.axes.values()))

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def points(self, flat: np.ndarray) -> list[tuple[Any, ...]]:
        """Arguments of points as Python's own numbers and strings, in the order of the axes.

        Parameters
        ----------
        flat : array of int
            Numbers of points, the last axis fastest.
        """
        places = np.unravel_index(flat, self.shape)
        return list(zip(*(v[i].tolist() for v, i in zip(self.axes.values(), places, strict=True)), strict=True))

    def coords(self) -> dict[str, tuple[str, np.ndarray, dict[str, str]]]:
        """The axes as coordinates, with units where the name is known."""
        return {
            name: (name, values, label(name) if name in COORDINATES | PARAMETERS else {"long_name": name})
            for name, values in self.axes.items()
        }


def study_of(question: Any, axes: Any) -> Study:
    """A study of what a user gave.

    Raises
    ------
    ValueError
        `question` cannot be called with the axes' names; an axis is not one of different numbers or strings.
    """
    if not callable(question):
        raise validate.refuse("question", "a function of the axes' names", question)
    if not isinstance(axes, Mapping) or not axes or not all(isinstance(name, str) for name in axes):
        raise validate.refuse("axes", "a dict of at least one name and its values", axes)
    for name in axes:
        if name in BOOKKEEPING or not name.isidentifier():
            raise validate.refuse("axes", f"names of arguments other than {', '.join(BOOKKEEPING)}", name)
    _check_arguments(question, tuple(axes))
    return Study(question, {name: _axis(values, f"axes[{name!r}]") for name, values in axes.items()})


def _check_arguments(question: Question, names: tuple[str, ...]) -> None:
    try:
        signature = inspect.signature(question)
    except (TypeError, ValueError):  # of a function written in C
        return
    try:
        signature.bind(**dict.fromkeys(names))
    except TypeError as error:
        takes = f"the arguments of question{signature}"
        raise ValueError(f"axes: expected {takes}, got {', '.join(names)} ({error})") from None


def _axis(values: Any, name: str) -> np.ndarray:
    """A 1-D array of different finite numbers or strings."""
    array = np.asarray(values)
    if array.dtype.kind not in "iufcU" or array.ndim != 1 or array.size == 0:
        raise validate.refuse(name, "a 1-D array of numbers or strings", values)
    if array.dtype.kind != "U" and not np.all(np.isfinite(array)):
        raise validate.refuse(name, "finite values", values)
    if len(np.unique(array)) < len(array):
        raise validate.refuse(name, "values that differ from one another", values)
    return array
