"""Checks of public arguments: ValueErrors that name the argument, what was expected and what came."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from ..beam import Beam, sin_degrees
from ..media import Fluid, Slab, as_number

#: Wraps the items of a loop, to watch it.
Progress = Callable[[Iterable[Any]], Iterable[Any]]


class AccuracyWarning(UserWarning):
    """An answer whose estimated error is above the asked rtol."""


def announce(error: float, rtol: float, stacklevel: int = 3) -> None:
    """Nothing above rtol leaves a public call without a word."""
    if error > rtol:
        warnings.warn(
            f"estimated error {error:.1e} of the largest |p|, above the asked rtol {rtol:.1e}",
            AccuracyWarning,
            stacklevel=stacklevel,
        )


def axis(value: Any, name: str, *, kind: type = float, positive: bool = False) -> np.ndarray:
    """A scalar or 1-D array of finite numbers, as an array; ValueErrors name the argument."""
    try:
        array = np.asarray(value)
        array = array.astype(kind) if kind is complex or not np.iscomplexobj(array) else array
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected a number or a 1-D array of numbers, got {value!r}") from None
    if np.iscomplexobj(array) and kind is not complex:
        raise ValueError(f"{name}: expected real numbers, got complex ones")
    if array.ndim > 1 or array.size == 0:
        raise ValueError(f"{name}: expected a number or a 1-D array of at least one, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name}: expected finite values, got {array[~np.isfinite(array)].flat[0]}")
    if positive and np.any(array <= 0):
        raise ValueError(f"{name}: expected values above zero, got {array.min()}")
    return array


def instance(value: Any, cls: Any, name: str) -> None:
    """A ValueError unless value is an instance of cls."""
    if not isinstance(value, cls):
        raise ValueError(f"{name}: expected a {cls.__name__}, got {value!r}")


def angles(angle: Any, beam: Beam) -> np.ndarray:
    """The asked angles of a beam [degree], its own by default."""
    values = axis(beam.angle if angle is None else angle, "angle")
    if np.any(np.abs(values) >= 90):
        raise ValueError(
            f"angle: expected degrees from the normal, between -90 and 90, got {values[np.abs(values) >= 90].flat[0]}"
        )
    return values


def rtol(given: Any) -> float:
    """An rtol that double precision can keep."""
    value = as_number(given, "rtol", positive=True)
    if not 1e-12 <= value <= 0.1:
        raise ValueError(f"rtol: expected a value from 1e-12 to 0.1, got {given!r}")
    return value


def k0(slab: Slab, frequency: np.ndarray) -> np.ndarray:
    """Wavenumber of the medium in front [rad/m]."""
    return forward_k0(slab.before, frequency, "before")


def forward_k0(fluid: Fluid, frequency: np.ndarray, name: str) -> np.ndarray:
    """Wavenumber of a fluid that carries forward waves [rad/m]."""
    k = fluid.wavenumber(frequency)
    if not np.all(np.isfinite(k) & (k.real > 0)):
        raise ValueError(f"{name}: kx_over_k0 and angle need a fluid that carries forward waves, got {fluid!r}; use kx")
    return k.real


def one_of(**options: Any) -> tuple[str, Any]:
    """The one option that is given."""
    given = {name: value for name, value in options.items() if value is not None}
    if len(given) != 1:
        raise ValueError(f"expected exactly one of {', '.join(options)}, got {', '.join(given) or 'none'}")
    return next(iter(given.items()))


def lateral(name: str, value: Any, k0_at: Any, frequency: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The asked axis and kx on (frequency, axis); k0_at is a function that is called only where it is needed."""
    values = axis(value, name, kind=float if name == "angle" else complex)
    if not np.any(values.imag):
        values = values.real
    flat = np.atleast_1d(values)
    if name == "kx":
        return values, np.broadcast_to(flat, (frequency.size, flat.size))
    if name == "angle":
        if np.any(np.abs(flat) > 90):
            raise ValueError(f"angle: expected degrees from -90 to 90, got {flat[np.abs(flat) > 90][0]}")
        flat = sin_degrees(flat)
    return values, np.atleast_1d(k0_at(frequency))[:, None] * flat


def dims(**axes: np.ndarray) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """Names of the axes that are arrays, and the index that drops the scalar ones."""
    return tuple(n for n, a in axes.items() if a.ndim), tuple(slice(None) if a.ndim else 0 for a in axes.values())


def coords(**axes: np.ndarray) -> dict[str, tuple[tuple[str, ...], Any]]:
    """Coordinates of the axes, scalars as scalars."""
    return {n: ((n,) if a.ndim else (), a) for n, a in axes.items()}
