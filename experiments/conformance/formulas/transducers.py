"""Pistons and bowls: closed forms on the axis of one fluid, and before lossy layers by panels of Gauss nodes over the radial wavenumber."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import jv

from .beams import panels

#: Density (kg/m3), sound speed (m/s), attenuation (dB/cm).
Tissue = tuple[float, float, float]


def piston_on_axis(k: float, radius: float, z: np.ndarray) -> np.ndarray:
    """p over rho c v of a rigid piston: exp(ikz) - exp(ikR), R from its edge (Pierce 1989, section 5.7)."""
    return np.exp(1j * k * z) - np.exp(1j * k * np.hypot(z, radius))


def bowl_on_axis(k: float, radius: float, aperture: float, z: np.ndarray) -> np.ndarray:
    """p over rho c v, z from the apex: (exp(ikz) - exp(ikB)) R/(R - z), B from the rim (O'Neil 1949)."""
    depth = radius - math.sqrt(radius**2 - aperture**2 / 4)
    return (np.exp(1j * k * z) - np.exp(1j * k * np.hypot(z - depth, aperture / 2))) * radius / (radius - z)


def piston_spectrum(radius: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """The integral of J0 over the disc, over 2 pi."""
    return lambda k, kz: radius * jv(1, k * radius) / k


def bowl_spectrum(radius: float, aperture: float, count: int = 100) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Rings of a bowl, each brought back from its depth d to the apex by exp(-i kz d), over 2 pi."""
    t, weight = panels(0, math.asin(aperture / 2 / radius), 1, count)
    rings, depths = radius * np.sin(t), radius * (1 - np.cos(t))

    def spectrum(k: np.ndarray, kz: np.ndarray) -> np.ndarray:
        waves = jv(0, np.multiply.outer(k, rings)) * np.exp(-1j * np.multiply.outer(kz, depths))
        return waves @ (weight * radius * rings)

    return spectrum


@dataclass(frozen=True)
class Layered:
    """A source of unit rho c v, whose apex is at z = 0, before layers from `start` on, between two half-spaces; plane waves on a contour."""

    omega: float
    start: float
    layers: tuple[tuple[Tissue, float], ...]
    before: Tissue
    after: Tissue
    spectrum: Callable[[np.ndarray, np.ndarray], np.ndarray]

    def wavenumber(self, tissue: Tissue) -> complex:
        """w/c + i alpha."""
        return self.omega / tissue[1] + 1j * tissue[2] * 100 * math.log(10) / 20

    @cached_property
    def contour(self) -> tuple[np.ndarray, np.ndarray]:
        """Nodes and weights below the axis: down to -20i rad/m over half of k0, and along to where nothing is left of a source 10 mm away."""
        depth, corner = 20.0, self.wavenumber(self.before).real / 2
        down, first = panels(0, corner, 30)
        along, second = panels(corner, 2 * corner + 3500, 120)
        slope = 1 - 1j * depth / corner
        return np.concatenate([down * slope, along - 1j * depth]), np.concatenate([first * slope, second])

    @cached_property
    def launched(self) -> np.ndarray:
        """Plane waves at z = 0 by their weights: a velocity p/(rho c) is k0/kz times a pressure."""
        k, weight = self.contour
        kz = self.kz(self.before, k)
        return self.spectrum(k, kz) * self.wavenumber(self.before) / kz * k * weight

    def kz(self, tissue: Tissue, k: np.ndarray) -> np.ndarray:
        """Outgoing: k^2 lies below the axis."""
        return np.sqrt(self.wavenumber(tissue) ** 2 - k**2)

    def through(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Reflection at the near face, and p at the far face over that at the near one: admittances from behind."""
        admittance, passed = self.kz(self.after, k) / self.after[0], 1.0
        for tissue, thickness in reversed(self.layers):
            own = self.kz(tissue, k) / tissue[0]
            r = (own - admittance) / (own + admittance)
            step = np.exp(1j * own * tissue[0] * thickness)
            passed = passed * (1 + r) * step / (1 + r * step**2)
            admittance = own * (1 - r * step**2) / (1 + r * step**2)
        own = self.kz(self.before, k) / self.before[0]
        return (own - admittance) / (own + admittance), passed

    def fields(self, x: np.ndarray, z: float) -> tuple[np.ndarray, np.ndarray]:
        """p and dp/dz at x, of z before the layers or behind them."""
        k = self.contour[0]
        kz, kz_after = self.kz(self.before, k), self.kz(self.after, k)
        r, passed = self.through(k)
        deepest = self.start + sum(d for _, d in self.layers)
        if z <= self.start:
            forward, back = np.exp(1j * kz * z), r * np.exp(1j * kz * (2 * self.start - z))
            waves, slopes = forward + back, 1j * kz * (forward - back)
        else:
            waves = (1 + r) * passed * np.exp(1j * (kz * self.start + kz_after * (z - deepest)))
            slopes = 1j * kz_after * waves
        orders = jv(0, np.multiply.outer(np.asarray(x, float), k))
        return orders @ (self.launched * waves), orders @ (self.launched * slopes)

    def peak(self, low: float, high: float) -> float:
        """z between two, of the largest |p| on the axis: where Re(conj(p) dp/dz) changes its sign."""

        def growth(z: float) -> float:
            p, slope = self.fields(np.zeros(1), z)
            return float((np.conj(p) * slope).real[0])

        return brentq(growth, low, high, xtol=1e-14)

    def half(self, level: float, ends: tuple[float, float], at: float | None = None) -> float:
        """Where |p| is `level`: along the axis, or along x at a z."""

        def excess(place: float) -> float:
            x, z = (0.0, place) if at is None else (place, at)
            return abs(self.fields(np.array([x]), z)[0][0]) - level

        return brentq(excess, *ends, xtol=1e-14)
