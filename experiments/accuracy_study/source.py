"""The spectrum of a source, from its definition."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import beamprop as bp

#: The most products of kx and samples that are summed in long double.
MOST_LONG = 3_000_000


class Source:
    """S(kx) of a beam from its definition, relative to its middle."""

    def __init__(self, beam: Any, k0: float) -> None:
        self.beam, self.k0 = beam, k0
        self.sine = math.sin(math.radians(beam.angle))
        self.cosine = math.cos(math.radians(beam.angle))

    def __call__(self, k: np.ndarray, kz: Any = None) -> np.ndarray:
        """S(k) exp(i k centre); the rotated form takes kz too, which k gives badly near grazing."""
        b = self.beam
        q = k - self.k0 * self.sine
        if isinstance(b, bp.GaussianBeam):
            a = b.fwhm / (2 * math.sqrt(math.log(2)))
            jacobian: Any = 1.0
            if b.form == "rotated":
                q, jacobian = k * self.cosine - kz * self.sine, self.cosine + self.sine * k / kz
            return a * math.sqrt(math.pi) * np.exp(-((a * q / 2) ** 2)) * jacobian
        if isinstance(b, bp.Slits):
            edges = [(m - b.width / 2, m + b.width / 2) for m in b.positions]
            return sum((np.exp(-1j * q * lo) - np.exp(-1j * q * hi)) / (1j * q) for lo, hi in edges)
        return np.where(np.abs(q.real) <= np.pi / b.spacing, self._sampled(k), 0)

    def _sampled(self, k: np.ndarray) -> np.ndarray:
        """The sum over a profile's samples, in long double: where a slab lets only such kx through at which they cancel to next
        to nothing, rounding of each is what arrives."""
        b = self.beam
        real, kind = (np.longdouble, np.clongdouble) if k.size * b.x.size < MOST_LONG else (np.float64, np.complex128)
        spacing = (real(b.x[-1]) - real(b.x[0])) / (b.x.size - 1)
        q = k.astype(kind) - real(self.k0) * np.sin(real(b.angle) * (2 * np.arcsin(real(1)) / 180))
        out = np.zeros(k.shape, kind)
        for j, p in enumerate(b.p):
            out += p * np.exp(kind(-1j) * q * ((j - real(b.x.size - 1) / 2) * spacing))
        return (out * spacing).astype(complex)

    def band(self, tolerance: float) -> float:
        """|k| beyond which S is negligible."""
        b, tilt = self.beam, self.k0 * abs(self.sine)
        if isinstance(b, bp.GaussianBeam):
            a = b.fwhm / (2 * math.sqrt(math.log(2)))
            return tilt + 2 / a * math.sqrt(math.log(1 / tolerance))
        return tilt + (np.pi / b.spacing if isinstance(b, bp.Profile) else 2 / (b.width * tolerance))
