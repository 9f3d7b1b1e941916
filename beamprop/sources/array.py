"""Many equal transducers on a plane, with complex weights, steered and focused by delays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import validate
from .base import Beam, Summable, sin_degrees
from .in_space import SpaceBeam, mean_size, scattered_spectrum, unit_vector


@dataclass(frozen=True, eq=False)
class Array(Summable):
    """Equal elements at positions of the launch plane, each with a complex weight: a source in three dimensions.

    Parameters
    ----------
    positions : array (N, 2), m
        x and y of the elements' middles.
    element : Piston, Bowl, GaussianBeam or SourcePlane
        Moved to each position; its z0 is that of all.
    weights : array of N complex, optional
        1 by default.
    angle, azimuth : float, degree
        Steer the array by delays: each element is multiplied with ``exp(i k0 sin(angle) s)``, s its distance from the middle towards the
        azimuth, from x towards y. `field` takes many angles.
    focus : (x, y, z), m, optional
        Focus it by delays, so that its elements are in phase there in the medium in front; z behind z0. With an angle beside it both
        delays add up, and the focus moves.

    Notes
    -----
    Delays are phases proportional to k0, the same delays at every frequency. With a rigid baffle the weights are those of velocities.

    Examples
    --------
    >>> water = bp.Fluid.from_speed(1000.0, 1500.0)
    >>> plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=water)
    >>> row = np.stack([0.003 * np.arange(-8, 9), np.zeros(17)], axis=1)
    >>> array = bp.Array(row, bp.Piston(0.0012, z0=-0.03), focus=(0.01, 0.0, 0.02))
    >>> p = bp.field(plate, array, 0.5e6, x=[-0.01, 0.01], z=0.02, y=0.0).p
    >>> bool(abs(p[1]) > 5 * abs(p[0]))
    True
    """

    positions: np.ndarray
    element: Beam
    weights: np.ndarray | None = None
    angle: float = field(default=0.0, kw_only=True)
    azimuth: float = field(default=0.0, kw_only=True)
    focus: tuple[float, float, float] | None = field(default=None, kw_only=True)
    entire = True
    in_space_only = True

    def __post_init__(self) -> None:
        positions = validate.numeric(self.positions, "positions")
        if positions.ndim != 2 or positions.shape[1] != 2 or not positions.size or np.iscomplexobj(positions):
            raise validate.refuse("positions", "an array (N, 2) of x and y [m]", self.positions)
        weights = np.ones(len(positions)) if self.weights is None else validate.numeric(self.weights, "weights")
        if weights.shape != (len(positions),):
            raise ValueError(
                f"weights: expected a weight of each of {len(positions)} positions, got shape {weights.shape}"
            )
        for values, name in ((positions, "positions"), (weights, "weights")):
            validate.within(values, name, zero=True)
            if not np.all(np.isfinite(values)):
                raise ValueError(f"{name}: expected finite values, got NaN or infinity")
        if not np.any(weights):
            raise ValueError("weights: expected any that is not zero, got zeros")
        if not (hasattr(self.element, "in_space") or hasattr(self.element, "spectrum_at")) or isinstance(
            self.element, Array
        ):
            raise validate.refuse("element", "a Piston, Bowl, GaussianBeam or SourcePlane", self.element)
        object.__setattr__(self, "angle", validate.angle(self.angle))
        object.__setattr__(self, "azimuth", validate.as_number(self.azimuth, "azimuth"))
        for key, array in (("positions", positions), ("weights", weights.astype(complex))):
            array.setflags(write=False)
            object.__setattr__(self, key, array)
        if self.focus is not None:
            object.__setattr__(self, "focus", _checked_focus(self.focus, self.z0))

    def __eq__(self, value: object) -> bool:
        return isinstance(value, Array) and self._key() == value._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[Any, ...]:
        # + 0.0 turns -0.0 into 0.0, which it is equal to
        arrays = ((np.asarray(v) + 0.0).tobytes() for v in (self.positions, self.weights))
        return *arrays, self.element, self.angle, self.azimuth, self.focus

    # --- about its middle -------------------------------------------------------------------------------

    @property
    def z0(self) -> float:
        """The elements' launch plane [m]."""
        return self.element.z0

    @property
    def _middle(self) -> np.ndarray:
        return (self.positions.min(axis=0) + self.positions.max(axis=0)) / 2

    @property
    def x0(self) -> float:
        """Middle of the positions along x [m]."""
        return float(self._middle[0])

    @property
    def y0(self) -> float:
        """Middle of the positions along y [m]."""
        return float(self._middle[1])

    @property
    def centre(self) -> float:
        """x0 [m]."""
        return self.x0

    def in_space(self, azimuth: float) -> Array:
        """The same array about (0, 0), steered along an azimuth, its delays to a focus in the weights' place."""
        element: Any = self.element
        moved = element.in_space(element.azimuth)
        focus = self.focus
        if focus is not None:  # from the elements' own plane, in whose place a bowl has that of its rim
            focus = (focus[0] - self.x0, focus[1] - self.y0, focus[2] - element.z0 + moved.z0)
        return replace(self, positions=self.positions - self._middle, element=moved, azimuth=azimuth, focus=focus)

    def at_angle(self, angle: float) -> Array:
        """The same array steered to another angle [degree]."""
        return self if angle == self.angle else replace(self, angle=angle)

    @property
    def _own(self) -> SpaceBeam:
        element: Any = self.element
        return element

    @property
    def by_velocity(self) -> bool:
        """Whether the elements' spectrum is that of rho c times the normal velocity."""
        return bool(getattr(self.element, "by_velocity", False))

    @property
    def radial_factor(self) -> Callable[[np.ndarray, np.ndarray], np.ndarray] | None:
        """The elements', if they have a depth."""
        return getattr(self.element, "radial_factor", None)

    def driven(self, k0: float) -> np.ndarray:
        """The weights with the phases of their delays at k0: (N,)."""
        away = self.positions - self._middle
        length = away @ np.array(unit_vector(self.azimuth)) * float(sin_degrees(self.angle))
        if self.focus is not None:
            x, y, z = self.focus
            way = np.sqrt((x - self.positions[:, 0]) ** 2 + (y - self.positions[:, 1]) ** 2 + (z - self.z0) ** 2)
            length = length - way + math.dist((x, y, z), (*self._middle, self.z0))
        return np.asarray(self.weights) * np.exp(1j * k0 * length)

    def spectrum_at(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """The element's times sum w exp(-i k.r), at kx (1, X) and ky (Y, 1): (Y, X)."""
        x, y = self.positions.T
        along_y = np.exp(-1j * np.multiply.outer(np.ravel(ky), y)) * self.driven(k0)
        return self._own.spectrum_at(kx, ky, k0) * (along_y @ np.exp(-1j * np.multiply.outer(x, np.ravel(kx))))

    def scattered_spectrum(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """The same at places (kx, ky), (n,) each: (n,)."""
        driven, phases = self.driven(k0), np.zeros(kx.size, complex)
        for (x, y), weight in zip(self.positions, driven, strict=True):
            phases += weight * np.exp(-1j * (kx * x + ky * y))
        return scattered_spectrum(self._own, kx, ky, k0) * phases

    # --- how far it reaches -----------------------------------------------------------------------------

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """The element's beyond the outermost positions."""
        x, y = np.max(np.abs(self.positions - self._middle), axis=0)
        own = self._own.half_widths(tolerance)
        return float(x) + own[0], float(y) + own[1]

    def reach(self, tolerance: float) -> float:
        """The element's beyond the farthest position."""
        return float(np.max(np.hypot(*(self.positions - self._middle).T))) + self.element.reach(tolerance)

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """The element's."""
        return self._own.box(k0, tolerance)

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """The element's."""
        return self._own.rings(k0, tolerance)

    def mean_size(self, k: np.ndarray, k0: float) -> np.ndarray:
        """A bound, all elements in phase."""
        return float(np.sum(np.abs(np.asarray(self.weights)))) * mean_size(self.element, k, k0)

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Yes: a tilt turns the elements' phases, no farther than `reach`."""
        return True

    def not_ended(self, k0: float, way: float) -> dict[str, float]:
        """What the elements leave out, see `SourcePlane.not_ended`."""
        own = getattr(self.element, "not_ended", None)
        return {} if own is None else own(k0, way)

    # --- as a `Beam`: along the azimuth -------------------------------------------------------------------

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """The element's times the sum along the azimuth."""
        kx, along = np.asarray(kx), self.positions @ np.array(unit_vector(self.azimuth))
        return self.element.spectrum(kx, k0) * (np.exp(-1j * np.multiply.outer(kx, along)) @ self.driven(k0))

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """That of the main lobe: the element's, narrower as the array is wider, about its direction, and wider by its rays to a focus."""
        low, high = self.element.band(k0, tolerance)
        half, middle = (high - low) / 2 * self.element.reach(0.5) / self.reach(0.5), k0 * float(sin_degrees(self.angle))
        if self.focus is not None:
            half += k0 * self.reach(0.5) / math.hypot(self.reach(0.5), self.focus[2] - self.z0)
        return middle - half, middle + half

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """The elements' sum along x through the middle of each."""
        at = np.asarray(x)[..., None] - self.positions[:, 0]
        return np.asarray(self.element.profile(at + self.element.centre, k0) @ self.driven(k0))


def _checked_focus(focus: Any, z0: float) -> tuple[float, float, float]:
    if not isinstance(focus, tuple | list | np.ndarray) or len(focus) != 3:
        raise validate.refuse("focus", "x, y and z [m]", focus)
    x, y, z = (validate.as_number(v, "focus") for v in focus)
    if z <= z0:
        raise validate.refuse("focus", f"a z behind the launch plane z0 = {z0:g}", z)
    return x, y, z
