"""A source at many angles, interpolated from the same source at fewer.

At any depth, the field of a tilted source depends on the sine s of its angle as an integral of exp(i k0 s xi) over the launch
profile, |xi| <= w (`Beam.reach`, its half width). A polynomial in s through r Chebyshev nodes
approximates it, so that a real matrix makes the fields at any number of angles of those at r angles. Its error is at most 2 (c/2)^r / r! of the source's amplitude, c = k0 w (s_max - s_min)/2:
the first Bessel function that the Jacobi-Anger series leaves out. As a function of s the error follows the Chebyshev polynomial
T_r, because a term T_(r+j) that is left out is aliased to -T_(r-j) at the nodes and T_(r+j) + T_(r-j) = 2 T_r T_j: it vanishes at
the nodes and is largest at both extremes, where `contour.error` measures it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .base import Beam, sin_degrees


class AngleInterpolation(NamedTuple):
    """Beams whose fields are computed, and the weights (A, B) that make the requested fields of them; None if they are the same."""

    beam: Beam  #: the source, at any angle
    angles: np.ndarray  #: (B,) degree, of the computed fields
    weights: np.ndarray | None = None
    requested_angles: np.ndarray | None = None  #: (A,) degree, of the fields that `weights` makes

    @property
    def requested(self) -> np.ndarray:
        """The requested angles: (A,) degree."""
        return self.angles if self.requested_angles is None else self.requested_angles

    def spectra(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) of each computed beam: (B, n)."""
        spectra = getattr(self.beam, "spectra", None)
        if spectra is not None and self.beam.entire and self.angles.size > 1:
            return spectra(kx, k0, sin_degrees(self.angles))
        return np.stack([self.at(a).spectrum(kx, k0) for a in self.angles])

    def at(self, angle: float) -> Beam:
        """The beam at an angle [degree]."""
        return self.beam if angle == self.beam.angle else self.beam.at_angle(float(angle))

    def spread(self, count: int) -> np.ndarray:
        """Indices of at most `count` requested angles, evenly spaced in their order by size, both extremes included."""
        places = np.linspace(0, self.requested.size - 1, count).round().astype(int)
        return np.argsort(self.requested)[np.unique(places)]

    def taken(self, requested: slice | np.ndarray) -> AngleInterpolation:
        """A part of the requested beams."""
        if self.weights is None:
            return self._replace(angles=self.angles[requested])
        return self._replace(weights=self.weights[requested], requested_angles=self.requested[requested])

    def band(self, k0: float, tolerance: float) -> float:
        """Largest |kx| at which any spectrum exceeds `tolerance` of its largest value [rad/m]."""
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
        """The requested fields (A, ...) of the computed ones (B, ...), complex."""
        if self.weights is None:
            return summed
        flat = np.ascontiguousarray(summed).reshape(summed.shape[0], -1).view(float)
        if out is None:
            out = np.empty((self.weights.shape[0], *summed.shape[1:]), complex)
        np.matmul(self.weights, flat, out=out.view(float).reshape(out.shape[0], -1))
        return out


def single(beam: Beam) -> AngleInterpolation:
    """A beam at its own angle alone."""
    return AngleInterpolation(beam, np.array([float(beam.angle)]))


#: Interpolation is worth its matrix product and the fields that show its error where it computes less than this share of the beams.
WORTH_IT = 0.6


def interpolate_angles(beam: Beam, angles: np.ndarray, k0: float, tolerance: float) -> AngleInterpolation:
    """A source at angles (A,) [degree]: computed at Chebyshev nodes in sin(angle) where those are fewer."""
    smooth = getattr(beam, "shifts_smoothly", None)
    if angles.size > 4 and smooth is not None and smooth(tolerance):
        sines = sin_degrees(angles)
        middle, half = (sines.max() + sines.min()) / 2, (sines.max() - sines.min()) / 2
        count = nodes_for(k0 * beam.reach(tolerance) * half, tolerance)
        if count < WORTH_IT * angles.size:
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


def _barycentric(sines: np.ndarray, nodes: np.ndarray, magnitudes: np.ndarray) -> np.ndarray:
    """The matrix from values at Chebyshev nodes to the polynomial's values at `sines`: (A, r), barycentric formula.

    Its weights alternate in sign, with `magnitudes` sin of the nodes' Chebyshev angles (Berrut and Trefethen, 2004).
    """
    distance = sines[:, None] - nodes
    exact = distance == 0
    weights = magnitudes * (-1.0) ** np.arange(nodes.size) / np.where(exact, 1.0, distance)
    weights = np.where(exact.any(axis=1, keepdims=True), exact.astype(float), weights)
    return weights / weights.sum(axis=1, keepdims=True)
