"""What a source is: the protocol of a pressure on a launch plane z = z0 <= 0, and what the package's own sources share."""

from __future__ import annotations

from dataclasses import replace
from numbers import Number
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from .. import validate
from ..arrays import exponentials
from ..validate import as_number

_Source = TypeVar("_Source", bound="Tilted")


@runtime_checkable
class Beam(Protocol):
    """A source: what the questions need to know of a pressure p(x, z0) on a launch plane z0 <= 0.

    kx is an array [rad/m] of any shape, real or complex; k0 is the wavenumber of the medium in front [rad/m]. A tolerance
    is relative, between 0 and 1. The spectrum is ``S(kx) = integral p(x, z0) exp(-i kx x) dx``.

    Notes
    -----
    Members that a source may have beside these; `Tilted` gives the first two to a source that is written with it:

    * ``spectra(kx, k0, sines)``: S at kx (n,) of the same source at angles of given sines (B,), as an array (B, n).
    * ``shifts_smoothly(tolerance)``: whether S is an entire function of sin(angle) but for `tolerance` of its largest value, so
      that fields at many angles may be interpolated from those at fewer.
    * ``moved_to_origin()``: the same source about x = 0; without it, a source stays where it is.
    * ``spectrum_ends(k0)``: the interval of kx at whose ends the spectrum is cut off, whatever its value there.
    * ``spectral_rounding(kx, k0)``: what rounding of its samples leaves unknown of S, see `Profile.spectral_rounding`;
      ``rounding_of_values(kx, k0)``: the part of it that its samples' values bring, up to the ends of the spectrum.
    * ``launch_width``: the width of its profile, by its own ``width_of``, where it is known exactly.
    * ``width_of``: "pressure" or "intensity", the definition of its width; "pressure" without it.
    """

    @property
    def angle(self) -> float:
        """Direction from the normal [degree]."""

    @property
    def z0(self) -> float:
        """Launch plane [m], z0 <= 0."""

    @property
    def centre(self) -> float:
        """Middle of the launch profile [m]."""

    @property
    def entire(self) -> bool:
        """Whether the spectrum holds for every complex kx (else: propagating waves on the real axis only)."""

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) [Pa m], shaped like kx."""

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p(x, z0) [Pa] at x [m], shaped like x."""

    def reach(self, tolerance: float) -> float:
        """Half width of the launch profile above a level: beyond, |p| is below tolerance times its largest value [m]."""

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Interval of real kx outside which |S| is below tolerance times its largest value [rad/m]."""

    def at_angle(self, angle: float) -> Beam:
        """The same source sent off at another angle [degree]."""


def moved_to_origin(beam: Beam) -> tuple[Beam, float]:
    """The same source about x = 0, and how far it was moved [m].

    On a contour of complex kx the phase exp(-i kx x0) of a source far from x = 0 overflows, and rounding of x0 would be
    magnified with it: what is computed does not depend on where the origin lies. A source of the user's own stays where it is
    unless it has a method `moved_to_origin`, which returns the moved source.
    """
    move = getattr(beam, "moved_to_origin", None)
    return (beam, 0.0) if move is None else (move(), beam.centre)


def sin_degrees(angle: Any) -> np.ndarray:
    """sin of an angle in degrees, exact at multiples of 30 degrees where a user expects it."""
    angle = np.asarray(angle, dtype=float)
    value = np.sin(np.deg2rad(angle))
    return np.where(np.abs(angle) == 30.0, np.copysign(0.5, angle), value)


class Summable:
    """A source that can be added to others on its plane, and multiplied with a complex number."""

    __array_ufunc__ = None  # of a NumPy number times a source, too, the source makes the product

    def __add__(self, source: Any) -> Any:
        """The sum of two sources: a `SourceSum`."""
        return _sum((self, 1.0), (source, 1.0)) if isinstance(source, Summable) else NotImplemented

    def __radd__(self, nothing: Any) -> Any:
        """0 + a source, with which Python's `sum` begins: the source."""
        return self if type(nothing) is int and nothing == 0 else NotImplemented

    def __sub__(self, source: Any) -> Any:
        """The difference of two sources."""
        return _sum((self, 1.0), (source, -1.0)) if isinstance(source, Summable) else NotImplemented

    def __mul__(self, weight: Any) -> Any:
        """The source times a complex number."""
        return _sum((self, weight)) if isinstance(weight, Number) else NotImplemented

    __rmul__ = __mul__

    def __neg__(self) -> Any:
        """The source times -1."""
        return _sum((self, -1.0))


def _sum(*terms: tuple[Any, Any]) -> Any:
    from .source_sum import SourceSum

    sources: list[Any] = []
    weights: list[Any] = []
    for source, weight in terms:
        own = source.weights if isinstance(source, SourceSum) else (1.0,)
        sources += source.sources if isinstance(source, SourceSum) else (source,)
        weights += [weight * w for w in own]
    return SourceSum(tuple(sources), tuple(weights))


class Tilted(Summable):
    """A source that is an envelope times exp(i k0 sin(angle) (x - centre))."""

    angle: float
    z0: float
    entire = True

    def _check_launch(self) -> None:
        """Angle and launch plane as numbers, or the error that says what is wrong with them."""
        object.__setattr__(self, "angle", validate.angle(self.angle))
        object.__setattr__(self, "z0", as_number(self.z0, "z0"))
        if self.z0 > 0:
            raise ValueError(f"z0: expected a launch plane in front of the slab, z0 <= 0, got {self.z0!r}")

    def _tilt(self, k0: float) -> float:
        """kx of the source's direction, k0 sin(angle) [rad/m]."""
        return k0 * float(sin_degrees(self.angle))

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        raise NotImplementedError

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx), the envelope's spectrum shifted by k0 sin(angle)."""
        return self._envelope_spectrum(np.asarray(kx) - self._tilt(k0))

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """S(kx) at angles of given sines (B,), if the source is entire: (B, n) for kx (n,)."""
        return self._envelope_spectrum(np.asarray(kx) - k0 * sines[:, None])

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Whether S is an entire function of sin(angle), but for `tolerance` of its largest value."""
        return self.entire

    def at_angle(self: _Source, angle: float) -> _Source:
        """The same envelope at another angle [degree]."""
        return self if angle == self.angle else replace(self, angle=angle)  # type: ignore[type-var]


#: Exponentials that are held at a time: 32 MB.
BLOCK = 2_000_000


def spectral_sum(k: np.ndarray, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """sum_j weights_j exp(-i k x_j), shaped like k and then like weights_j, in blocks of bounded memory."""
    k = np.asarray(k)
    step = exponentials.even_step(x) if x.size >= exponentials.MANY else 0.0
    if step:
        summed = exponentials.over_positions(k.ravel(), weights.reshape(x.size, -1), float(x[0]), step)
        return summed.reshape(*k.shape, *weights.shape[1:])
    out = np.empty((k.size, *weights.shape[1:]), complex)
    block = max(1, BLOCK // max(1, x.size))
    flat = k.ravel()
    for start in range(0, k.size, block):
        out[start : start + block] = np.exp(-1j * np.multiply.outer(flat[start : start + block], x)) @ weights
    return out.reshape(*k.shape, *weights.shape[1:])
