"""Checks of what users give: one form of error, ``ValueError("name: expected X, got Y")``, for every public argument.

The range in which double precision answers is decided here. A layer's phase squared, ``rho_z d^2 w^2/K``, is a product of six
numbers, and so is ``rho_z d^2 kx^2/rho_x``; with each of them between 1e-50 and 1e50 no product overflows. Lengths, frequencies,
wavenumbers, densities and moduli outside of that range are refused. Densities may be zero, `density_x` infinite, and a layer as
thin as one likes, for nothing is divided by its thickness.
"""

from __future__ import annotations

import contextlib
import errno
import math
import numbers
import os
from pathlib import Path
from typing import Any

import numpy as np

from . import memory

#: Magnitudes that double precision can compute with: see above.
LEAST, MOST = 1e-50, 1e50
#: Up to here every whole number is a double.
MOST_COUNT = 2**53
#: Characters of a wrong value that a message shows.
SHOWN = 120


def shown(value: Any) -> str:
    """A value as a message shows it: shortened, and without an error of its own."""
    if isinstance(value, complex) and value.imag == 0:  # as it was written, most likely
        value = value.real
    if isinstance(value, list | tuple) and len(value) > 20:  # all of a long list would be written, to be cut off again
        return f"a {type(value).__name__} of {len(value)}"
    text = type(value).__name__
    with contextlib.suppress(Exception):  # an integer of 5000 digits has no repr
        text = " ".join(line.strip() for line in repr(value).splitlines())  # arrays have many
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


def refuse(name: str, expected: str, got: Any) -> ValueError:
    """The error to raise."""
    return ValueError(f"{name}: expected {expected}, got {got if isinstance(got, _Said) else shown(got)}")


class _Said(str):
    """What came, in words."""


# --- numbers ----------------------------------------------------------------------------------------------


def _is_masked(value: Any) -> bool:
    return isinstance(value, np.ma.MaskedArray) and bool(np.any(np.ma.getmaskarray(value)))


def _is_flag(value: Any) -> bool:
    return isinstance(value, bool | np.bool_)


def _no_loss(value: Any, name: str, expected: str) -> None:
    """Refuse what NumPy would turn into numbers by dropping a mask or the meaning of a truth value."""
    parts = value if isinstance(value, list | tuple) else (value,)
    if any(_is_masked(v) for v in parts):
        raise refuse(name, f"{expected} without masked values", _Said("a masked one"))
    if any(_is_flag(v) for v in parts):
        raise refuse(name, expected, value)


def numeric(value: Any, name: str, expected: str = "a number or an array of numbers") -> np.ndarray:
    """A new array of float or complex: numbers only, no truth values, strings, dates or masked values."""
    _no_loss(value, name, expected)
    memory.check(name, 3.0 * memory.COMPLEX * getattr(value, "size", 0), "a copy of it", "give fewer numbers, in parts")
    try:
        array = np.asarray(value)
        if array.dtype.kind == "O" and not all(
            isinstance(v, numbers.Number) and not _is_flag(v) for v in array.ravel().tolist()
        ):
            raise TypeError
        if array.dtype.kind not in "iufcO":
            raise TypeError
        complex_valued = array.dtype.kind == "c" or (
            array.dtype.kind == "O" and any(isinstance(v, complex | np.complexfloating) for v in array.ravel().tolist())
        )
        with np.errstate(over="ignore"):  # of extended precision; infinity is refused where it is not allowed
            return array.astype(complex if complex_valued else float)
    except OverflowError:
        raise refuse(name, f"{expected} that double precision can hold", value) from None
    except (TypeError, ValueError):
        raise refuse(name, expected, value) from None


def _scalar(value: Any, name: str, expected: str) -> complex | float:
    if type(value) in (float, complex):  # of the many layers of a slab; everything else is looked at closely
        return value
    if type(value) in (np.float64, np.complex128):
        return value.item()
    array = numeric(value, name, expected)
    if array.ndim:
        raise refuse(name, expected, value)
    return array.item()


def as_number(value: Any, name: str, *, positive: bool = False, tiny: bool = False) -> float:
    """A finite real number, of a magnitude that double precision can compute with; `tiny` positive ones may pass."""
    number = _scalar(value, name, "a real number")
    if isinstance(number, complex):
        raise refuse(name, "a real number", value)
    if not math.isfinite(number) or (positive and number <= 0):
        raise refuse(name, "a finite number above zero" if positive else "a finite number", number)
    within(number, name, zero=tiny or not positive)
    return number


def as_complex(value: Any, name: str, expected: str = "a number") -> complex:
    """A complex number, which may be infinite or NaN."""
    return complex(_scalar(value, name, expected))


def as_count(value: Any, name: str, least: int = 1) -> int:
    """A whole number of at least `least`, as exact as a double."""
    expected = f"a whole number of at least {least}"
    if not isinstance(value, int) or _is_flag(value):  # an int may have more digits than a float
        number = _scalar(value, name, expected)
        if isinstance(number, complex) or not math.isfinite(number) or number != int(number):
            raise refuse(name, expected, value)
        value = int(number)
    if value < least:
        raise refuse(name, expected, value)
    if value > MOST_COUNT:
        raise refuse(name, f"{expected} and at most {MOST_COUNT:.3g}", value)
    return int(value)


def is_usual(number: float | complex) -> bool:
    """Whether a number is well within `LEAST` to `MOST`, as nearly every one is: it needs no array to look at it."""
    return 2 * LEAST <= abs(number.real) + abs(number.imag) <= MOST  # abs(number) may overflow


def within(values: Any, name: str, *, zero: bool = False) -> None:
    """Refuse finite values of a magnitude outside of `LEAST` to `MOST`; with `zero`, small ones and zero may pass.

    Infinite values and NaN are looked at elsewhere.
    """
    if isinstance(values, float | complex) and is_usual(values):
        return
    size = np.abs(np.asarray(values))
    bad = np.isfinite(size) & (size > MOST)
    if not zero:
        bad |= size < LEAST
    if np.any(bad):
        least = "" if zero else f"{LEAST:g} to "
        kind = f"a magnitude of {least or 'at most '}{MOST:g}, which double precision can compute with"
        raise refuse(name, kind, np.atleast_1d(values)[np.atleast_1d(bad)].flat[0].item())


# --- arrays -----------------------------------------------------------------------------------------------


def axis(value: Any, name: str, *, kind: type = float, positive: bool = False) -> np.ndarray:
    """A scalar or 1-D array of finite numbers, as an array of `kind`: float, or complex."""
    if (
        type(value) is float and (value > 0 or not positive) and (is_usual(value) or value == 0)
    ):  # of the many points of a study
        return np.array(value, kind)
    array = numeric(value, name, "a number or a 1-D array of numbers")
    if np.iscomplexobj(array) and kind is not complex:
        raise refuse(name, "real numbers", _Said("complex ones"))
    if array.ndim > 1 or array.size == 0:
        raise refuse(name, "a number or a 1-D array of at least one", _Said(f"shape {array.shape}"))
    if not np.all(np.isfinite(array)):
        raise refuse(name, "finite values", _Said(f"{array[~np.isfinite(array)].flat[0]}"))
    if positive and np.any(array <= 0):
        raise refuse(name, "values above zero", _Said(f"{array.min()}"))
    within(array, name, zero=not positive)
    return array.astype(kind, copy=False)


def positions(value: Any, name: str, *, increasing: bool = False) -> np.ndarray:
    """A 1-D array of finite positions, strictly increasing if asked for."""
    expected = f"a 1-D array of finite{', strictly increasing' if increasing else ''} positions"
    array = numeric(value, name, expected)
    if np.iscomplexobj(array) or array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
        raise refuse(name, expected, value)
    within(array, name, zero=True)
    if increasing and np.any(np.diff(array) <= 0):
        raise refuse(name, expected, value)
    return array


def angles(value: Any, name: str = "angle", *, grazing: bool = False) -> np.ndarray:
    """Angles from the normal [degree] as a scalar or 1-D array, between -90 and 90; both included if `grazing`."""
    values = axis(value, name)
    beyond = np.abs(values) > 90 if grazing else np.abs(values) >= 90
    if np.any(beyond):
        expected = "degrees from -90 to 90" if grazing else "degrees from the normal, between -90 and 90"
        raise refuse(name, expected, _Said(f"{values[beyond].flat[0]}"))
    return values


def angle(value: Any, name: str = "angle") -> float:
    """One angle from the normal [degree], between -90 and 90."""
    number = as_number(value, name)
    if abs(number) >= 90:
        angles(number, name)
    return number


def rtol(value: Any, name: str = "rtol") -> float:
    """A relative tolerance that double precision can keep."""
    number = as_number(value, name, positive=True)
    if not 1e-12 <= number <= 0.1:
        raise refuse(name, "a value from 1e-12 to 0.1", value)
    return number


# --- everything else --------------------------------------------------------------------------------------


def instance(value: Any, cls: Any, name: str) -> Any:
    """An instance of a class."""
    if not isinstance(value, cls) or isinstance(value, type):  # a class has the members of a protocol, too
        article = "an" if cls.__name__[0] in "AEIO" else "a"
        such = " (GaussianBeam, Profile, Slits)" if cls.__name__ == "Beam" else ""  # a protocol, which nobody makes
        raise refuse(name, f"{article} {cls.__name__}{such}", value)
    return value


def flag(value: Any, name: str) -> bool:
    """True or False."""
    if not _is_flag(value):
        raise refuse(name, "True or False", value)
    return bool(value)


def flag_or_function(value: Any, name: str) -> Any:
    """True, False, or something that can be called."""
    if callable(value) or _is_flag(value):
        return value
    raise refuse(name, "True, False or a function", value)


def word(value: Any, name: str, *options: str) -> str:
    """One of some words."""
    if not isinstance(value, str) or value not in options:
        *first, last = map(repr, options)
        raise refuse(name, f"{', '.join(first)} or {last}" if first else last, value)
    return value


def as_path(value: Any, name: str = "path") -> Path:
    """The path of a file: text, or an object that stands for a path."""
    with contextlib.suppress(TypeError):
        text = os.fspath(value)
        if isinstance(text, str) and text and "\0" not in text:
            return Path(text)
    raise refuse(name, "the path of a file", value)


class MissingFile(FileNotFoundError):
    """A file that is not there: with its errno and strerror, and said as every wrong argument is."""

    argument = "path"

    def __str__(self) -> str:
        return f"{self.argument}: expected an existing file, got {self.filename!r}"


def existing(path: Path, name: str = "path") -> Path:
    """The path of a file that is there, or the `FileNotFoundError` that names the argument."""
    if not path.exists():
        error = MissingFile(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        error.argument = name
        raise error
    return path
