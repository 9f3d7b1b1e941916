"""Sources whose fields in three dimensions are one integral over the radial wavenumber: circular beams, pistons and bowls.

    p(r) = (1/2 pi) integral S(k) h(k) J0(k r) k dk

A tilted circular Gaussian is the one along the normal, moved to complex places: p = exp(-K^2 a^2/4) P(rho), rho^2 = (x - i Kx a^2/2)^2 +
(y - i Ky a^2/2)^2. A bowl is the sum of rings, each of which sends exp(i kz d) through the plane of the rim, d before it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import jv, jve

import beamprop as bp

from .quadrature import Setting

#: Gauss nodes over a bowl's depth beside those that its phases take.
RINGS = 30


class Circular:
    """A circular Gaussian at any angle and azimuth, about its middle."""

    def __init__(self, beam: bp.GaussianBeam, k0: float) -> None:
        width = beam.fwhm[0] if isinstance(beam.fwhm, tuple) else beam.fwhm
        a = width / (2 * math.sqrt(math.log(2)))
        turn, self.k = math.radians(beam.azimuth), k0 * math.sin(math.radians(beam.angle))
        self.along = math.cos(turn), math.sin(turn)
        self.a = (a, a)
        self.middle, self.reach = (beam.x0, beam.y0), 6.1 * a
        self.plane, self.before = beam.z0, 0.0

    def field(
        self, s: Setting, nodes: tuple[np.ndarray, np.ndarray], places: tuple[np.ndarray, np.ndarray], count: int
    ) -> np.ndarray:
        """p (Z, P)."""
        (k, w), a = nodes, self.a[0]
        u, v = (p - 0.5j * self.k * c * a**2 for p, c in zip(places, self.along, strict=True))
        turned = np.multiply.outer(k, np.sqrt(u * u + v * v))
        size = np.abs(turned.imag) - (a / 2) ** 2 * (k**2 + self.k**2)[:, None]
        rings = math.pi * a * a * jve(0, turned) * np.exp(size)
        return s.response(k) @ (rings * (k * w)[:, None]) / (2 * np.pi)

    def flat(self, beam: bp.GaussianBeam) -> bp.GaussianBeam:
        """A source in two dimensions whose contours serve."""
        return bp.GaussianBeam(self.a[0] * 2 * math.sqrt(math.log(2)), abs(beam.angle), 0.0, beam.z0)

    def directions(self, s: Setting, k: np.ndarray) -> int:
        """Bessel functions have summed them."""
        return 1


class Transducer:
    """Pistons or bowls at places of their own, with weights."""

    k, along = 0.0, (1.0, 0.0)

    def __init__(self, beam: Any) -> None:
        array = isinstance(beam, bp.Array)
        element = beam.element if array else beam
        self.at = np.asarray(beam.positions) if array else np.array([[beam.x0, beam.y0]])
        self.weights = np.asarray(beam.weights) if array else np.ones(1)
        self.bowl, self.rigid = isinstance(element, bp.Bowl), getattr(element, "baffle", "rigid") == "rigid"
        self.pressure = element.pressure
        self.radius = element.aperture / 2 if self.bowl else element.radius
        self.curvature = element.radius_of_curvature if self.bowl else math.inf
        self.before = self.curvature - math.sqrt(max(0.0, self.curvature**2 - self.radius**2)) if self.bowl else 0.0
        self.plane = element.z0 + self.before
        self.a = (self.radius + float(np.max(np.abs(self.at - self.at.mean(axis=0)))),) * 2
        self.reach = self.radius
        self.middle = tuple(self.at.mean(axis=0))
        self.at = self.at - self.middle

    def _strength(self, k: np.ndarray, kz: np.ndarray) -> np.ndarray:
        """S at complex k (n,)."""
        if not self.bowl:
            return self.pressure * 2 * np.pi * self.radius * jv(1, k * self.radius) / k
        turns = float(np.max(np.abs(k))) * self.radius + float(np.max(np.abs(kz))) * self.before
        # over t = sqrt(depth), in which the rings' radii are smooth
        g, w = np.polynomial.legendre.leggauss(int(RINGS + turns))
        t = math.sqrt(self.before) * (g + 1) / 2
        ring, area = (
            np.sqrt(2 * self.curvature - t * t) * t,
            2 * np.pi * self.curvature * math.sqrt(self.before) * t * w,
        )
        out = np.empty(k.size, complex)
        for i in range(0, k.size, block := max(1, 1_000_000 // t.size)):
            part = slice(i, i + block)
            phase = np.exp(1j * np.multiply.outer(kz[part], self.before - t * t))
            out[part] = (jv(0, np.multiply.outer(k[part], ring)) * phase) @ area
        return self.pressure * out

    def field(
        self, s: Setting, nodes: tuple[np.ndarray, np.ndarray], places: tuple[np.ndarray, np.ndarray], count: int
    ) -> np.ndarray:
        """p (Z, P)."""
        k, w = nodes
        kz = s.m.kz(s.m.before, k)
        strength = self._strength(k, kz) * k * w / (2 * np.pi) * (s.m.k0 / kz if self.rigid else 1.0)
        h, out = s.response(k) * strength, 0
        for (x, y), weight in zip(self.at, self.weights, strict=True):
            r = np.hypot(places[0] - x, places[1] - y)
            out = out + weight * (h @ jv(0, np.multiply.outer(k, r)))
        return np.asarray(out)

    def directions(self, s: Setting, k: np.ndarray) -> int:
        """Bessel functions have summed them."""
        return 1

    def flat(self, beam: Any) -> bp.Slits:
        """A source in two dimensions whose contours serve."""
        return bp.Slits(2 * self.radius, 4 * self.radius, 1, self.plane, 0.0)
