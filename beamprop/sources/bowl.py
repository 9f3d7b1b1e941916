"""A spherical bowl that vibrates uniformly along its normal: O'Neil's focusing transducer."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import validate
from ..validate import as_number
from .on_normal import OnNormal
from .piston import ENVELOPE

#: Gauss nodes of a panel over the bowl, and the most radians of phase in it: 20 nodes integrate exp(12 i v), |v| < 1, to 1e-14.
PANEL, PHASE = 20, 24.0
#: Bessel values that are held at a time: 32 MB.
BLOCK = 1_000_000


@dataclass(frozen=True)
class Bowl(OnNormal):
    """A focusing bowl, a part of a sphere, open towards the slab: a source in three dimensions, whose fields are asked with y.

    Parameters
    ----------
    radius_of_curvature : float, m
        The sphere's, whose middle is the focus (x0, y0, z0 + radius_of_curvature).
    aperture : float, m
        Diameter of the rim, at most that of the sphere.
    pressure : complex, Pa
        The normal velocity is pressure/(rho c) all over it, rho and c of the medium in front.
    x0, y0, z0 : float, m
        The apex. The rim lies in front of the slab, too.

    Notes
    -----
    Rayleigh's integral over the bowl itself, -(i k/2 pi) integral pressure exp(i k R)/R dS, as by H. T. O'Neil, J. Acoust. Soc. Am. 21, 516 (1949):
    waves that the bowl scatters are left out, and so is what the slab sends back to it. Positions lie behind the rim. On the axis of a
    homogeneous fluid, at z from the apex and B from the rim, p = (exp(i k z) - exp(i k B)) R/(R - z).

    Examples
    --------
    >>> water = bp.Fluid.from_speed(1000.0, 1500.0)
    >>> bowl = bp.Bowl(0.064, 0.064, pressure=60e3, z0=-0.03)
    >>> round(bowl.depth, 5)
    0.00857
    >>> plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=water)
    >>> p = bp.field(plate, bowl, 0.5e6, x=0.0, z=[0.03, 0.06], y=0.0).p
    >>> bool(abs(p[0]) > 2 * abs(p[1]))
    True
    """

    radius_of_curvature: float
    aperture: float
    pressure: complex = 1.0
    x0: float = 0.0
    y0: float = 0.0
    z0: float = 0.0
    by_velocity = True

    def __post_init__(self) -> None:
        for name in ("radius_of_curvature", "aperture"):
            object.__setattr__(self, name, as_number(getattr(self, name), name, positive=True))
        if self.aperture > 2 * self.radius_of_curvature:
            raise validate.refuse(
                "aperture", f"at most twice the radius_of_curvature, {2 * self.radius_of_curvature:g}", self.aperture
            )
        self._check_place()
        if self.z0 + self.depth > 0:
            raise validate.refuse("z0", f"a rim in front of the slab, z0 <= {-self.depth:.6g}", self.z0)

    @property
    def depth(self) -> float:
        """From the apex to the plane of the rim [m]."""
        half = self.aperture / 2
        return half**2 / (self.radius_of_curvature + math.sqrt(self.radius_of_curvature**2 - half**2))

    def in_space(self, azimuth: float) -> BowlAtRim:
        """The bowl as it sends through the plane of its rim, about (0, 0)."""
        return BowlAtRim(self.radius_of_curvature, self.aperture, self.pressure, z0=self.z0 + self.depth)

    def reach(self, tolerance: float) -> float:
        """The radius of the rim."""
        return self.aperture / 2

    def spectrum_at(self, kx: np.ndarray, ky: Any, k0: float) -> np.ndarray:
        """The pressure: that of a point, for `radial_factor` makes a bowl of it."""
        return np.full(np.broadcast_shapes(np.shape(kx), np.shape(ky)), self.pressure)

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Of rays along its normals, beside which it ends as a disc's envelope does."""
        half = self.aperture / 2
        end = k0 * half / self.radius_of_curvature + (ENVELOPE / tolerance) ** (2 / 3) / half
        return -end, end

    def radial_factor(self, k: np.ndarray, kz: np.ndarray) -> np.ndarray:
        """integral exp(-i k.x + i kz d) dS over the bowl, d from it to the plane of its rim, at complex k (n,): (n,) m^2.

        By Weyl's integral exp(i k R)/R is (i/2 pi) integral exp(i k.x + i kz d)/kz dkx dky.
        """
        from scipy.special import jv

        radius, depth = self.radius_of_curvature, self.depth
        opening = math.asin(min(1.0, self.aperture / 2 / radius))
        turns = float(np.max(np.abs(k))) * self.aperture / 2 + float(np.max(np.abs(kz))) * depth
        panels = math.ceil(turns / PHASE) + 1
        g, w = np.polynomial.legendre.leggauss(PANEL)
        at = (np.arange(panels)[:, None] + (g + 1) / 2).ravel() * (opening / panels)
        weight = np.tile(w, panels) * (math.pi * radius**2 * opening / panels) * np.sin(at)
        across, ahead = radius * np.sin(at), depth - 2 * radius * np.sin(at / 2) ** 2
        out, block = np.empty(k.size, complex), max(1, BLOCK // at.size)
        for start in range(0, k.size, block):
            part = slice(start, start + block)
            waves = jv(0, np.multiply.outer(k[part], across)) * np.exp(1j * np.multiply.outer(kz[part], ahead))
            out[part] = waves @ weight
        return out


@dataclass(frozen=True)
class BowlAtRim(Bowl):
    """A bowl by what it sends through the plane of its rim, which is `z0`."""

    def __post_init__(self) -> None:
        """It was checked as a bowl."""
