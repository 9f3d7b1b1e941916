"""One plain value: a number, also as text, with a fraction bar and a unit where it has one; or an axis of several."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

if TYPE_CHECKING:
    import numpy as np

Axis: TypeAlias = "float | np.ndarray"
#: Units as powers of ten.
LENGTHS = {"m": 0, "km": 3, "cm": -2, "mm": -3, "um": -6, "µm": -6, "μm": -6, "nm": -9}
FREQUENCIES = {"Hz": 0, "kHz": 3, "MHz": 6, "GHz": 9}
BYTES = {"B": 0, "kB": 3, "MB": 6, "GB": 9, "TB": 12}

T = TypeVar("T", float, complex)


def _read(text: str, kind: Callable[[str], T], units: Mapping[str, int]) -> T:
    """A number, or two with a fraction bar between, and perhaps a unit; ValueError for anything else."""
    text = text.strip()
    try:
        upper, bar, lower = text.partition("/")
        return kind(upper) / kind(lower) if bar else kind(upper)
    except ZeroDivisionError:
        raise ValueError from None
    except ValueError:
        unit = max((u for u in units if text.endswith(u)), key=len, default="")
        if not unit:
            raise
    power = units[unit]
    value = _read(text.removesuffix(unit), kind, {})
    return value * 10.0**power if power >= 0 else value / 10.0**-power  # dividing, 2 mm are 0.002 to the last bit


def _no_number(name: str, expected: str, text: str, units: Mapping[str, int]) -> ValueError:
    """The error to raise of a text; with the unit that was meant where its letters have the wrong size, as in 1mhz."""
    from .. import validate

    error = validate.refuse(name, expected, text)
    by_letters = {unit.casefold(): unit for unit in units}
    wrong = [word.casefold() for word in re.findall(r"[^\W\d_]+", text) if word not in units]
    meant = next((by_letters[word] for word in wrong if word in by_letters), None)
    return error if meant is None else ValueError(f"{error}; did you mean {meant}?")


def number(value: Any, name: str) -> complex:
    """A complex number, also as text: 0.05+0.05j, or with i, or 1/20; a float where it is real."""
    from .. import validate

    expected = "a number such as 0.05 or 0.05+0.05j"
    if isinstance(value, str):
        try:
            parsed = _read(value.replace(" ", "").replace("i", "j"), complex, {})
        except ValueError:
            raise validate.refuse(name, expected, value) from None
    else:
        parsed = complex(_scalar(value, name, expected))
    return parsed if parsed.imag else parsed.real


def real(
    value: Any, name: str, units: Mapping[str, int] | None = None, expected: str = "a number such as 0.05 or 1/60"
) -> float:
    """A real number, also as text: 0.0166, 1/60."""
    from .. import validate

    if isinstance(value, str):
        try:
            return _read(value, float, units or {})
        except ValueError:
            raise _no_number(name, expected, value, units or {}) from None
    scalar = _scalar(value, name, "a real number")
    if isinstance(scalar, complex):
        raise validate.refuse(name, "a real number", value)
    return scalar


def length(value: Any, name: str) -> float:
    """A length [m], as text also with a unit: 2mm."""
    return real(value, name, LENGTHS, "a length such as 0.002 or 2mm")


def frequency(value: Any, name: str) -> float:
    """A frequency [Hz], as text also with a unit: 1MHz."""
    return real(value, name, FREQUENCIES, "a frequency such as 2500 or 2.5kHz")


def _scalar(value: Any, name: str, expected: str) -> complex | float:
    from .. import validate

    array = validate.numeric(value, name, expected)
    if array.ndim:
        raise validate.refuse(name, expected, value)
    return array.item()


def count(value: Any, name: str) -> int:
    """A whole number of at least 1, also as text."""
    from .. import validate

    if isinstance(value, str):
        try:
            value = int(value)
        except ValueError:
            raise validate.refuse(name, "a whole number of at least 1", value) from None
    return validate.as_count(value, name)


def switch(value: Any, name: str) -> bool:
    """True or False, also as text in small letters."""
    from .. import validate

    return validate.flag({"true": True, "false": False}.get(value, value) if isinstance(value, str) else value, name)


def as_it_is(value: Any, name: str) -> Any:
    """A value as it is: `tables.read` holds it to the parameter's words."""
    return value


#: The units of what a function reads.
UNITS: dict[Callable[[Any, str], Any], Mapping[str, int]] = {length: LENGTHS, frequency: FREQUENCIES}


def text(value: Any, name: str) -> str:
    """A text."""
    from .. import validate

    if not isinstance(value, str) or not value:
        raise validate.refuse(name, "a text", value)
    return value


def size(value: Any, name: str) -> float:
    """A number of bytes above zero, as text also with a unit: 500MB, 2GB."""
    from .. import validate

    return validate.as_number(real(value, name, BYTES, "a size such as 500MB or 2GB"), name, positive=True)


def axis(value: Any, name: str, units: Mapping[str, int] | None = None) -> Axis:
    """A number, or several as an array; also as text: a number, numbers with commas between, start:stop:count, or
    start:stop:count:log for even ratios.

    Examples
    --------
    >>> axis("2000:3000:3", "frequency")
    array([2000., 2500., 3000.])
    >>> axis("1kHz:100kHz:3:log", "frequency", FREQUENCIES)
    array([  1000.,  10000., 100000.])
    """
    import numpy as np

    from .. import validate

    if isinstance(value, list) and any(isinstance(v, str) for v in value):
        return np.array([real(v, name, units) for v in value])
    if not isinstance(value, str):
        numbers = validate.axis(value, name)
        return numbers if numbers.ndim else float(numbers)
    even = value.removesuffix(":log")
    try:
        if ":" not in value:
            several = [_read(v, float, units or {}) for v in value.split(",")]
            return several[0] if len(several) == 1 else np.array(several)
        first, last, many = even.split(":")
        start, stop, size = _read(first, float, units or {}), _read(last, float, units or {}), int(many)
        if size < 1 or (even != value and not 0 < start * stop < math.inf):
            raise ValueError
    except ValueError:
        raise _no_number(name, "a number, a,b,c or start:stop:count", value, units or {}) from None
    from .. import memory

    memory.check(name, 32.0 * size, f"the {size} numbers of {value!r}", "take fewer")
    return spaced(start, stop, size) if even == value else spaced_by_ratio(start, stop, size)


def spaced_by_ratio(start: float, stop: float, size: int) -> np.ndarray:
    """Numbers of one sign with even ratios, both ends exact."""
    import numpy as np

    if size == 1:
        return np.array([start])
    return np.geomspace(start, stop, size)


def spaced(start: float, stop: float, size: int) -> np.ndarray:
    """Evenly spaced numbers, both ends exact."""
    import numpy as np

    with np.errstate(invalid="ignore"):  # the question refuses what is not finite
        numbers = start + np.arange(size) * ((stop - start) / max(1, size - 1))
    numbers[-1] = stop if size > 1 else start
    return numbers


def is_several(value: Axis | None) -> bool:
    """Whether an axis is given, and is more than a number."""
    return value is not None and not isinstance(value, float)
