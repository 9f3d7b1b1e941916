"""One source sent off at many angles.

Away from its own plane, too, the field of a tilted source depends on the sine s of its angle as a sum of exp(i k0 s xi) over
the launch profile, |xi| <= reach: a function of s that a polynomial through a few Chebyshev nodes follows. So the fields at
any number of angles are made, by a real matrix, of those at the nodes. The polynomial of r nodes errs by no more than
2 (c/2)^r / r!, c = k0 reach (s_max - s_min)/2, of what the source sends (the next Bessel function of the Jacobi-Anger series).
The error goes with s as the Chebyshev polynomial T_r, for what is left out, T_(r+j), looks like -T_(r-j) at the nodes, and
T_(r+j) + T_(r-j) = 2 T_r T_j: it vanishes at the nodes and is largest at both extremes. There it is measured (`contour.error`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .beams import Beam, sin_degrees


class AngleInterpolation(NamedTuple):
    """Beams that are summed, and the matrix (A, B) that makes the requested ones of them; None where they are the requested ones."""

    beam: Beam  #: any of them: what they share
    angles: np.ndarray  #: (B,) degree
    weights: np.ndarray | None = None
    requested_angles: np.ndarray | None = None  #: (A,) degree, those that `weights` makes

    @property
    def requested(self) -> np.ndarray:
        """The requested angles: (A,) degree."""
        return self.angles if self.requested_angles is None else self.requested_angles

    def spectra(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) of each: (B, n)."""
        many = getattr(self.beam, "spectra", None)
        if many is not None and self.beam.entire and self.angles.size > 1:
            return many(kx, k0, sin_degrees(self.angles))
        return np.stack([self.at(a).spectrum(kx, k0) for a in self.angles])

    def at(self, angle: float) -> Beam:
        """The beam at one angle."""
        return self.beam if angle == self.beam.angle else self.beam.at_angle(float(angle))

    def spread(self, count: int) -> np.ndarray:
        """Indices of `count` asked angles, or fewer, evenly through all of them in growing order: both extremes and some between."""
        places = np.linspace(0, self.requested.size - 1, count).round().astype(int)
        return np.argsort(self.requested)[np.unique(places)]

    def taken(self, requested: slice | np.ndarray) -> AngleInterpolation:
        """Some of the asked beams."""
        if self.weights is None:
            return self._replace(angles=self.angles[requested])
        return self._replace(weights=self.weights[requested], requested_angles=self.requested[requested])

    def band(self, k0: float, tolerance: float) -> float:
        """Largest |kx| at which a spectrum exceeds `tolerance` of its largest value [rad/m]."""
        ends = (self.at(float(a)).band(k0, tolerance) for a in (self.angles.min(), self.angles.max()))
        return max(max(-lo, hi) for lo, hi in ends)

    def low(self, k0: float, tolerance: float) -> float:
        """|kx| below which all spectra are below `tolerance` of their largest value [rad/m]."""
        ends = [self.at(float(a)).band(k0, tolerance) for a in (self.angles.min(), self.angles.max())]
        return max(0.0, min(lo for lo, _ in ends), -max(hi for _, hi in ends))

    def spectrum_ends(self, k0: float) -> np.ndarray:
        """Every |kx|, in order, at which a spectrum is cut off inside its values [rad/m]: none for most sources."""
        if getattr(self.beam, "spectrum_ends", None) is None:
            return np.empty(0)
        ends = [self.at(float(a)).spectrum_ends(k0) for a in self.angles]  # type: ignore[attr-defined]
        return np.unique(np.abs(ends))

    def interpolated_to(self, summed: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
        """The asked fields (A, ...) of those that were summed (B, ...), complex."""
        if self.weights is None:
            return summed
        flat = np.ascontiguousarray(summed).reshape(summed.shape[0], -1).view(float)
        if out is None:
            out = np.empty((self.weights.shape[0], *summed.shape[1:]), complex)
        np.matmul(self.weights, flat, out=out.view(float).reshape(out.shape[0], -1))
        return out


def single(beam: Beam) -> AngleInterpolation:
    """A beam by itself."""
    return AngleInterpolation(beam, np.array([float(beam.angle)]))


def interpolate_angles(beam: Beam, angles: np.ndarray, k0: float, tolerance: float) -> AngleInterpolation:
    """A source at angles (A,) [degree]: summed at a few Chebyshev nodes in sin(angle) where those are fewer."""
    smooth = getattr(beam, "shifts_smoothly", None)
    if angles.size > 4 and smooth is not None and smooth(tolerance):
        sines = sin_degrees(angles)
        middle, half = (sines.max() + sines.min()) / 2, (sines.max() - sines.min()) / 2
        count = nodes_for(k0 * beam.reach(tolerance) * half, tolerance)
        if count < 0.6 * angles.size:
            turn = np.pi * (np.arange(count) + 0.5) / count
            nodes = middle + half * np.cos(turn)
            return AngleInterpolation(
                beam, np.degrees(np.arcsin(nodes)), _barycentric(sines, nodes, np.sin(turn)), angles
            )
    return AngleInterpolation(beam, angles)


def nodes_for(c: float, tolerance: float) -> int:
    """The fewest nodes with 2 (c/2)^r / r! below the tolerance."""
    count = max(4, math.ceil(c / 2))
    while count * math.log(max(c, 1e-3) / 2) - math.lgamma(count + 1) > math.log(tolerance / 2):
        count += 1
    return count


def _barycentric(at: np.ndarray, nodes: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The matrix that takes values at Chebyshev nodes to the polynomial's values: (A, r); `size` of the weights."""
    apart = at[:, None] - nodes
    exact = apart == 0
    weights = size * (-1.0) ** np.arange(nodes.size) / np.where(exact, 1.0, apart)
    weights = np.where(exact.any(axis=1, keepdims=True), exact.astype(float), weights)
    return weights / weights.sum(axis=1, keepdims=True)
