"""The spectrum of a source, from its definition."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import beamprop as bp


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
        out = np.zeros(k.shape, complex)
        for x, p in zip(b.x - b.centre, b.p, strict=True):
            out += p * np.exp(-1j * q * x)
        return np.where(np.abs(q.real) <= np.pi / b.spacing, out * b.spacing, 0)

    def band(self, tolerance: float) -> float:
        """|k| beyond which S is negligible."""
        b, tilt = self.beam, self.k0 * abs(self.sine)
        if isinstance(b, bp.GaussianBeam):
            a = b.fwhm / (2 * math.sqrt(math.log(2)))
            return tilt + 2 / a * math.sqrt(math.log(1 / tolerance))
        return tilt + (np.pi / b.spacing if isinstance(b, bp.Profile) else 2 / (b.width * tolerance))
