"""What a source in three dimensions sends, by directions in the plane: means, for integrals over |k| alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..fields.in_space import driven_by
from ..response import transfer_function
from ..response.sampled_slab import SampledSlab
from ..response.transfer_function import TransferFunction
from ..sources.in_space import scattered_spectrum, unit_vector
from ..sources.sum_in_space import SumInSpace, parts_of
from .measures import unchanged

#: Directions beyond those of the source's extent: its spectrum's harmonics fall off within them.
MARGIN = 40
#: Values of spectra that are held at a time: 32 MB.
BLOCK = 1_000_000
#: |k| (n,), and kx and ky at directions (n, d) -> what |S|^2 is multiplied with, (n, d) or a number each.
Factors = Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[Any, ...]]


class Directions(NamedTuple):
    """Means over directions of what a source sends, at |k| that quadrature rules, sides and moved last bits share."""

    source: Any
    slab: SampledSlab
    #: by |k|, the wavenumber of the medium (0 for |S|^2 alone), and moved last bits, (8,) or (1,) each
    known: dict[tuple[float, ...], np.ndarray]

    @property
    def drive(self) -> TransferFunction:
        """What drives a source; 1 of a sum, whose sources have it in their spectra."""
        unit = TransferFunction(self.slab, unchanged)
        return unit if isinstance(self.source, SumInSpace) else driven_by(self.source, unit)

    def count(self, radius: float) -> int:
        """Directions over which a mean at |k| is taken."""
        return 4 * math.ceil((MARGIN + 2 * radius * self.source.reach(1e-8)) / 4)  # x and y alike

    def means(self, radii: np.ndarray, k: float, shift: float) -> np.ndarray:
        """Means at |k| (n,) of |S|^2 and of it times what follows: (8, n).

        x, y and z of the unit vector in a medium of wavenumber k, the angles to the planes x = 0 and y = 0 less the
        source's own, and their squares.
        """
        own = [math.sin(math.radians(self.source.angle)) * v for v in unit_vector(self.source.azimuth)]

        def factors(radii: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[Any, ...]:
            z = np.sqrt(np.maximum(k * k - radii**2, 0.0))[:, None]
            angles = [np.arcsin(np.clip(v / k, -1, 1)) - math.asin(a) for v, a in zip((x, y), own, strict=True)]
            return 1.0, x / k, y / k, z / k, *angles, *(v**2 for v in angles)

        return self._remembered(radii, k, shift, factors)

    def sent(self, radii: np.ndarray, shift: float) -> np.ndarray:
        """The mean of |S|^2 over directions at |k| (n,), times |.|^2 of what drives the source: (n,)."""
        driven = self.drive(radii.astype(complex), np.zeros(1), shift)[0]
        return np.asarray(np.abs(driven) ** 2 * self._remembered(radii, 0.0, shift, lambda *_: (1.0,))[0])

    def _remembered(self, radii: np.ndarray, k: float, shift: float, factors: Factors) -> np.ndarray:
        """Means of |S|^2 times factors: (m, n). They are kept by |k|, k and shift."""
        if not isinstance(self.source, SumInSpace):  # whose rounding shows in the response alone
            shift = 0.0
        missing = np.array([radius for radius in radii.tolist() if (radius, k, shift) not in self.known])
        if missing.size:
            columns = _by_direction(self, missing, shift, factors).T
            self.known.update(
                ((radius, k, shift), column) for radius, column in zip(missing.tolist(), columns, strict=True)
            )
        return np.array([self.known[radius, k, shift] for radius in radii.tolist()]).T

    def spectrum(self, radii: np.ndarray, x: np.ndarray, y: np.ndarray, shift: float) -> np.ndarray:
        """S at kx and ky (n, m), whose lengths are |k| (n,): (n, m).

        Of a sum with what drives each source, on the plane behind which all are.
        """
        # where sources cancel, rounding of their spectra shows with moved last bits
        x, y = x * (1 + shift), y * (1 + shift)
        s, total = self.slab, np.zeros(x.shape, complex)
        for part in parts_of(self.source):
            own = scattered_spectrum(part.source, x.ravel(), y.ravel(), s.k0).reshape(x.shape)
            if not isinstance(self.source, SumInSpace):
                return own
            ahead = TransferFunction(s, partial(_ahead, distance=self.source.z0 - part.source.z0))
            driven = driven_by(part.source, ahead)(radii.astype(complex), np.zeros(1), shift)[0]
            total += part.weight * driven[:, None] * own * np.exp(-1j * (x * part.at[0] + y * part.at[1]))
        return total


def _ahead(s: SampledSlab, kx: np.ndarray, z: np.ndarray, distance: float) -> np.ndarray:
    """H over a distance in the medium in front: (1, n)."""
    return transfer_function.over_distance(s, kx, np.array([distance]))


def _by_direction(directions: Directions, radii: np.ndarray, shift: float, factors: Factors) -> np.ndarray:
    """Means over directions at |k| (n,) of |S|^2 times factors, in blocks of bounded memory: (m, n)."""
    count = directions.count(float(radii.max()))
    turn = 2 * math.pi * np.arange(count) / count
    block, parts = max(1, BLOCK // count), []
    for start in range(0, radii.size, block):
        k = radii[start : start + block]
        x, y = (np.multiply.outer(k, v(turn)) for v in (np.cos, np.sin))
        strength = np.abs(directions.spectrum(k, x, y, shift)) ** 2
        parts.append(np.array([np.mean(strength * factor, axis=1) for factor in factors(k, x, y)]))
    return np.concatenate(parts, axis=1)
