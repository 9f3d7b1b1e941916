"""A sum of sources on a plane of launch, each with a complex weight: ``a + 2j * b``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import validate
from .base import Beam, Summable
from .in_space import needs_y
from .slits import Slits


@dataclass(frozen=True)
class SourceSum(Summable):
    """Sources on the same launch plane, each times a complex weight; ``a + b``, ``a - b`` and ``2j * a`` make them.

    Parameters
    ----------
    sources : tuple of sources
        On a plane z0 that all share. In two dimensions of GaussianBeam, Profile and Slits, in three of GaussianBeam, Piston, Bowl, SourcePlane and
        Array.
    weights : tuple of complex

    Notes
    -----
    The field is the sum of the sources' fields, errors added: of sources that cancel each other the estimate grows, for it is over
    the largest \\|p\\| of the sum. The angle of a sum is its sources' where they share it, and 0 otherwise; `angle=` is
    refused then. Widths are by the sources' ``width_of`` where they share it, and of \\|p\\| otherwise.

    Examples
    --------
    >>> water = bp.Fluid.from_speed(1000.0, 1500.0)
    >>> plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=water)
    >>> both = bp.Piston(0.01, z0=-0.03) + 0.5j * bp.GaussianBeam(0.02, x0=0.04, z0=-0.03)
    >>> both.weights
    ((1+0j), 0.5j)
    >>> bool(bp.field(plate, both, 0.2e6, x=0.0, z=[0.02, 0.04], y=0.0).error_estimate < 1e-8)
    True
    """

    sources: tuple[Beam, ...]
    weights: tuple[complex, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.sources, tuple | list) or not all(isinstance(s, Beam) for s in self.sources):
            raise validate.refuse("sources", "a tuple of sources", self.sources)
        if len(self.sources) != len(self.weights):
            raise validate.refuse("weights", f"a weight of each of {len(self.sources)} sources", self.weights)
        merged: dict[Beam, complex] = {}
        for source, weight in zip(self.sources, self.weights, strict=True):
            merged[source] = merged.get(source, 0.0) + _weight(weight)
        merged = {source: weight for source, weight in merged.items() if weight}
        if not merged:
            raise ValueError("sources: expected a sum that is not zero everywhere, got sources that cancel")
        planes = sorted({s.z0 for s in merged})
        if len(planes) > 1:
            raise ValueError(
                f"z0: expected sources on the same launch plane, got z0 = {' and '.join(f'{z:.9g}' for z in planes)}: "
                "ask a field of each, and add their p"
            )
        entire = [s.entire for s in merged]
        if any(entire) and not all(entire):
            raise ValueError("form: expected no beam of the form 'rotated' beside other sources, got such a sum")
        object.__setattr__(self, "sources", tuple(merged))
        object.__setattr__(self, "weights", tuple(merged.values()))

    @property
    def in_space_only(self) -> bool:
        """Whether any is of three dimensions alone."""
        return any(map(needs_y, self.sources))

    @property
    def z0(self) -> float:
        """The launch plane of all [m]."""
        return self.sources[0].z0

    @property
    def entire(self) -> bool:
        """Whether the spectra hold for every complex kx."""
        return self.sources[0].entire

    @property
    def share_angle(self) -> bool:
        """Whether all have the same angle and azimuth."""
        return len({(s.angle, getattr(s, "azimuth", 0.0)) for s in self.sources}) == 1

    @property
    def angle(self) -> float:
        """The sources', where they share it, else 0 [degree]."""
        return self.sources[0].angle if self.share_angle else 0.0

    @property
    def azimuth(self) -> float:
        """The sources', where they share it, else 0 [degree]."""
        return getattr(self.sources[0], "azimuth", 0.0) if self.share_angle else 0.0

    @property
    def width_of(self) -> str:
        """What widths of the sum are of: the sources', where they share it, else "pressure"."""
        kinds = {getattr(s, "width_of", "pressure") for s in self.sources}
        return kinds.pop() if len(kinds) == 1 else "pressure"

    @property
    def centre(self) -> float:
        """Middle of the sources, 0 where there are slits, which stay where they are [m]."""
        if any(isinstance(s, Slits) for s in self.sources):
            return 0.0
        ends = [s.centre + side * s.reach(0.5) for s in self.sources for side in (-1, 1)]
        return (min(ends) + max(ends)) / 2

    def _each(self, of: Callable[[Any], Any]) -> Any:
        """The weighted sum of what a function makes of each source."""
        return sum(w * of(s) for s, w in zip(self.sources, self.weights, strict=True))

    def moved_to_origin(self) -> SourceSum:
        """The same sources about x = 0."""
        return replace(self, sources=tuple(_moved(s, self.centre) for s in self.sources))

    def at_angle(self, angle: float) -> SourceSum:
        """All sources at another angle [degree]."""
        return self if angle == self.angle else replace(self, sources=tuple(s.at_angle(angle) for s in self.sources))

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """The weighted sum of spectra [Pa m]."""
        return np.asarray(self._each(lambda s: s.spectrum(kx, k0)))

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """The weighted sum of profiles [Pa]."""
        return np.asarray(self._each(lambda s: s.profile(x, k0)))

    def reach(self, tolerance: float) -> float:
        """From the middle to the farthest end of any source [m]."""
        return max(abs(s.centre - self.centre) + s.reach(tolerance) for s in self.sources)

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Around those of all sources [rad/m]."""
        lows, highs = zip(*(s.band(k0, tolerance) for s in self.sources), strict=True)
        return np.minimum.reduce(lows), np.maximum.reduce(highs)

    @property
    def spectrum_ends(self) -> Callable[[float], tuple[float, ...]] | None:
        """Of sampled profiles among them, where their spectra end."""
        sampled: list[Any] = [s for s in self.sources if hasattr(s, "spectrum_ends")]
        return (lambda k0: tuple(end for s in sampled for end in s.spectrum_ends(k0))) if sampled else None

    @property
    def spectral_rounding(self) -> Callable[[np.ndarray, float], tuple[np.ndarray, ...]] | None:
        """Of sampled profiles among them, what rounding leaves unknown."""
        pairs: list[Any] = [(s, abs(w)) for s, w in zip(self.sources, self.weights, strict=True)]
        pairs = [(s, w) for s, w in pairs if hasattr(s, "spectral_rounding")]

        def rounding(kx: np.ndarray, k0: float) -> tuple[np.ndarray, ...]:
            parts = [tuple(w * part for part in s.spectral_rounding(kx, k0)) for s, w in pairs]
            return tuple(sum(part) for part in zip(*parts, strict=True))

        return rounding if pairs else None

    @property
    def rounding_of_values(self) -> Callable[[np.ndarray, float], np.ndarray] | None:
        """The same of the values of their samples alone."""
        pairs: list[Any] = [(s, abs(w)) for s, w in zip(self.sources, self.weights, strict=True)]
        pairs = [(s, w) for s, w in pairs if hasattr(s, "rounding_of_values")]
        return (lambda kx, k0: np.asarray(sum(w * s.rounding_of_values(kx, k0) for s, w in pairs))) if pairs else None


def _weight(value: Any) -> complex:
    weight = validate.as_complex(value, "weights", "finite numbers")
    if not np.isfinite(weight):
        raise validate.refuse("weights", "finite numbers", value)
    return weight


def _moved(source: Any, by: float) -> Any:
    """A source of two dimensions nearer to the origin by a distance [m]."""
    if isinstance(source, Slits) or not by:
        return source
    return replace(source, x0=source.x0 - by) if hasattr(source, "x0") else replace(source, x=source.x - by)
