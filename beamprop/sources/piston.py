"""A circular piston: a uniform velocity in a rigid baffle, or a uniform pressure in a soft one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import validate
from ..validate import as_number
from .on_normal import OnNormal

#: Of the envelope of 2 J1(v)/v at large v, 2 sqrt(2/pi) v^-1.5.
ENVELOPE = 2 * math.sqrt(2 / math.pi)


@dataclass(frozen=True)
class Piston(OnNormal):
    """A circular piston transducer, a source in three dimensions: fields of it are asked with y.

    Parameters
    ----------
    radius : float, m
    baffle : "rigid" or "soft"
        "rigid": a uniform normal velocity pressure/(rho c), rho and c of the medium in front, and none beside the piston. "soft": a uniform
        pressure, and none beside it.
    pressure : complex, Pa
    x0, y0, z0 : float, m
        Middle of the piston and its plane, z0 <= 0.

    Notes
    -----
    What the slab reflects passes the plane of the piston as if it were not there. Its edge is sharp: positions must lie behind its plane.
    On the axis in a homogeneous fluid, with R = sqrt(z^2 + radius^2), p is exp(i k z) - exp(i k R), or exp(i k z) - (z/R) exp(i k R)
    in a soft baffle (Rayleigh's integrals; Pierce, Acoustics, 1989, section 5.7).

    Examples
    --------
    >>> water = bp.Fluid.from_speed(1000.0, 1500.0)
    >>> plate = bp.Slab.uniform(bp.Fluid.from_speed(1900.0, 2800.0), 0.0065, background=water)
    >>> p = bp.field(plate, bp.Piston(0.01, z0=-0.03), 0.5e6, x=0.0, z=[0.02, 0.04], y=0.0).p
    >>> p.dims, bool(np.all(np.abs(p) < 2))
    (('z',), True)
    """

    radius: float
    baffle: str = "rigid"
    pressure: complex = 1.0
    x0: float = 0.0
    y0: float = 0.0
    z0: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", as_number(self.radius, "radius", positive=True))
        validate.word(self.baffle, "baffle", "rigid", "soft")
        self._check_place()

    @property
    def by_velocity(self) -> bool:
        """Whether its spectrum is that of rho c times the normal velocity."""
        return self.baffle == "rigid"

    def _of_radius(self, k: np.ndarray) -> np.ndarray:
        """pressure pi radius^2 times 2 J1(v)/v, v = k radius."""
        from scipy.special import j1, jv

        v = np.asarray(k) * self.radius
        small = np.abs(v) < 1e-6
        w = np.where(small, 1.0, v)
        ratio = (
            2 * (jv(1, w) if np.iscomplexobj(w) else j1(w)) / w
        )  # at real places, of which a lattice has millions, faster
        return np.asarray(self.pressure * math.pi * self.radius**2 * np.where(small, 1 - v * v / 8, ratio))

    def spectrum_at(self, kx: np.ndarray, ky: Any, k0: float) -> np.ndarray:
        """S(kx, ky) about the middle."""
        return self._of_radius(np.sqrt(kx * kx + ky * ky))

    def reach(self, tolerance: float) -> float:
        """Its radius."""
        return self.radius

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Where the envelope of S has fallen to the tolerance."""
        end = (ENVELOPE / tolerance) ** (2 / 3) / self.radius
        return -end, end


def driven_by_velocity(source: Any) -> bool:
    """Whether a source's spectrum is that of rho c times its normal velocity."""
    return bool(getattr(source, "by_velocity", False))
