"""What a source is in three dimensions: a pressure p(x, y) on a launch plane, sent off at an angle towards an azimuth."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .. import validate
from .base import Beam, Tilted


class SpaceBeam(Beam, Protocol):
    """A source in three dimensions, about (0, 0); as a `Beam` it is its own section through the spectrum along the azimuth.

    The spectrum is ``S(kx, ky) = integral p(x, y, z0) exp(-i kx x - i ky y) dx dy``; tolerances are relative.

    Notes
    -----
    Members that a source may have beside these:

    * ``mean_size(k, k0)``: see `mean_size`.
    * ``scattered_spectrum(kx, ky, k0)``: see `scattered_spectrum`.
    * ``by_velocity``: whether the spectrum is that of rho c times the normal velocity; of pressure without it.
    * ``radial_factor(k, kz)``: what the spectrum has to be multiplied with, where that is a function of kz in front as well, at complex k.
    """

    @property
    def azimuth(self) -> float:
        """Direction along which it is tilted, from x towards y [degree]."""

    def spectrum_at(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """S [Pa m^2] at real kx and ky, which are broadcast."""

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """Along x and y: beyond, |p| is below tolerance times its largest value [m]."""

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """The least and largest kx, then ky, between which |S| is above tolerance of its largest value: (2, 2) [rad/m]."""

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """The least and largest sqrt(kx^2 + ky^2) there [rad/m]."""


def unit_vector(azimuth: float) -> tuple[float, float]:
    """cos and sin of an azimuth [degree], exact at multiples of 90."""
    quarters, rest = divmod(azimuth, 90.0)
    x, y = (1.0, 0.0) if rest == 0 else (math.cos(math.radians(rest)), math.sin(math.radians(rest)))
    for _ in range(int(quarters) % 4):
        x, y = -y, x
    return x, y


def has_edge(beam: Any) -> bool:
    """Whether a source in space has a sharp edge, so that its spectrum does not end."""
    return not np.all(np.isfinite(beam.box(1.0, 0.5)))


#: Directions over which |S| is averaged: as many as follow its phases at the tolerance ENDED of the source, between these; and of how many
#: plane waves at a time.
AVERAGED, ENDED, AT_A_TIME = (48, 256), 1e-6, 2**17


def mean_size(beam: Any, k: np.ndarray, k0: float) -> np.ndarray:
    """|S| averaged over the directions of wavenumbers of the length k (n,), by the source's own method if it has it."""
    own = getattr(beam, "mean_size", None)
    if own is not None:
        return np.asarray(own(k, k0))
    phases = float(np.max(k)) * math.hypot(*beam.half_widths(ENDED))
    count = math.ceil(np.clip(2 * phases, *AVERAGED))
    turn = np.radians(beam.azimuth) + 2 * np.pi * np.arange(count) / count
    out, block = np.empty(k.shape), max(1, AT_A_TIME // count)
    for start in range(0, k.size, block):
        kx, ky = (np.multiply.outer(k[start : start + block], along) for along in (np.cos(turn), np.sin(turn)))
        out[start : start + block] = np.abs(beam.spectrum_at(kx, ky, k0)).mean(axis=1)
    return out


def scattered_spectrum(beam: Any, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
    """S at places (kx, ky), (n,) each, by the source's own method if `spectrum_at` answers on lattices alone: (n,)."""
    own = getattr(beam, "scattered_spectrum", None)
    return np.asarray(beam.spectrum_at(kx, ky, k0) if own is None else own(kx, ky, k0))


#: Directions on an ellipse in which its largest distance from the origin is looked for: between two the distance differs by
#: (pi/720)^2/2 of its radius, 1e-5.
DIRECTIONS = 720


@dataclass(frozen=True)
class EllipticalGaussian(Tilted):
    """``p(x, y, z0) = exp(-(x/ax)^2 - (y/ay)^2) exp(i k0 sin(angle) (x cos(azimuth) + y sin(azimuth)))``: a `SpaceBeam`."""

    radii: tuple[float, float]
    angle: float
    azimuth: float
    z0: float
    centre = 0.0

    @property
    def _along(self) -> float:
        """The radius that makes the spectrum's section along the azimuth [m]."""
        x, y = unit_vector(self.azimuth)
        return math.hypot(self.radii[0] * x, self.radii[1] * y)

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        ax, ay = self.radii
        return math.pi * ax * ay * np.exp(-((self._along * k / 2) ** 2))

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p along the azimuth through the middle."""
        across = math.hypot(*(v / a for v, a in zip(unit_vector(self.azimuth), self.radii, strict=True)))
        return np.exp(-((across * np.asarray(x)) ** 2) + 1j * self._tilt(k0) * np.asarray(x))

    def reach(self, tolerance: float) -> float:
        """The larger of `half_widths`."""
        return max(self.half_widths(tolerance))

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Of the section along the azimuth."""
        middle, half = self._tilt(k0), 2 / self._along * math.sqrt(math.log(1 / tolerance))
        return middle - half, middle + half

    def spectrum_at(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """The product of both Gaussians."""
        (ax, ay), tilt = self.radii, self._tilt(k0)
        x, y = unit_vector(self.azimuth)
        of_x = math.pi * ax * ay * np.exp(-((ax * (kx - tilt * x) / 2) ** 2))
        return np.asarray(of_x * np.exp(-((ay * (ky - tilt * y) / 2) ** 2)))

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """a sqrt(ln(1/tolerance))."""
        decay = math.sqrt(math.log(1 / tolerance))
        return self.radii[0] * decay, self.radii[1] * decay

    def _ellipse(self, k0: float, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
        """Middle and half axes of the ellipse on which |S| is `tolerance` of its largest value, (2,) each."""
        middle = self._tilt(k0) * np.array(unit_vector(self.azimuth))
        return middle, 2 / np.array(self.radii) * math.sqrt(math.log(1 / tolerance))

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """The ellipse's."""
        middle, half = self._ellipse(k0, tolerance)
        return np.stack([middle - half, middle + half], axis=1)

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """The ellipse's; from 0 where the origin lies inside."""
        middle, half = self._ellipse(k0, tolerance)
        turn = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
        away = np.hypot(middle[0] + half[0] * np.cos(turn), middle[1] + half[1] * np.sin(turn))
        inside = np.sum((middle / half) ** 2) <= 1
        return 0.0 if inside else float(away.min()) * (1 - 1e-4), float(away.max()) * (1 + 1e-4)


def needs_y(beam: Any) -> bool:
    """Whether a source is one of three dimensions alone, whose field depends on y."""
    return bool(getattr(beam, "in_space_only", False))


def check_on_a_line(beam: Any) -> Any:
    """The source, or a ValueError where it is one of three dimensions alone."""
    if needs_y(beam):
        expected = "one on which nothing depends on y (one width, no azimuth, no y0), or field asked with y="
        raise validate.refuse("beam", expected, beam)
    return beam
