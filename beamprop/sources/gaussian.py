"""Gaussian beams, given along the launch plane or across their own axis."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace

import numpy as np

from .. import validate
from ..validate import as_number
from .base import Tilted, sin_degrees
from .in_space import EllipticalGaussian


@dataclass(frozen=True, repr=False)
class GaussianBeam(Tilted):
    """A Gaussian beam.

    Parameters
    ----------
    fwhm : float, or two of them, m
        Full width at half maximum of |p| at the launch plane (of |p|^2 with ``width_of="intensity"``). Two are those along x and y, of an
        elliptical beam in three dimensions; one is that of a beam on which nothing depends on y, or of a circular beam where y is given.
    angle : float, degree
        From the normal.
    x0, z0 : float, m
        Middle of the beam and launch plane, z0 <= 0.
    width_of : "pressure" or "intensity"
        With a the 1/e radius of |p|: fwhm = 2 a sqrt(ln 2), or a sqrt(2 ln 2).
    form : "launch" or "rotated"
        "launch": ``p(x, z0) = exp(-(x-x0)^2/a^2) exp(i k0 sin(angle) (x-x0))``, fwhm along the launch plane.
        "rotated": a beam whose waist lies at (x0, z0), across its own axis, made of propagating waves only.
    azimuth : float, degree
        In three dimensions, the direction along which `angle` tilts the beam, from x towards y; the widths stay along x and y.
    y0 : float, m
        Middle of the beam along y, in three dimensions.

    Examples
    --------
    >>> beam = bp.GaussianBeam(fwhm=0.096, angle=45, z0=-0.1)
    >>> round(beam.radius, 4)
    0.0577
    >>> bp.GaussianBeam(fwhm=(0.3, 0.15), angle=45, azimuth=30, z0=-0.1).fwhm
    (0.3, 0.15)
    """

    fwhm: float | tuple[float, float]
    angle: float = 0.0
    x0: float = 0.0
    z0: float = 0.0
    width_of: str = "pressure"
    form: str = "launch"
    azimuth: float = field(default=0.0, kw_only=True)
    y0: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "fwhm", _widths(self.fwhm))
        object.__setattr__(self, "azimuth", as_number(self.azimuth, "azimuth"))
        object.__setattr__(self, "y0", as_number(self.y0, "y0"))
        object.__setattr__(self, "x0", as_number(self.x0, "x0"))
        self._check_launch()
        validate.word(self.width_of, "width_of", "pressure", "intensity")
        validate.word(self.form, "form", "launch", "rotated")

    def __repr__(self) -> str:
        names = (f.name for f in fields(self) if f.name not in ("azimuth", "y0") or getattr(self, f.name))
        return f"GaussianBeam({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    @property
    def radius(self) -> float:
        """The 1/e radius a of |p|, along x [m]."""
        return self.radii[0]

    @property
    def radii(self) -> tuple[float, float]:
        """The 1/e radii of |p| along x and y [m]."""
        ratio = 2 * math.sqrt(math.log(2)) if self.width_of == "pressure" else math.sqrt(2 * math.log(2))
        x, y = self.fwhm if isinstance(self.fwhm, tuple) else (self.fwhm, self.fwhm)
        return x / ratio, y / ratio

    @property
    def in_space_only(self) -> bool:
        """Whether it is a beam of three dimensions alone, whose field depends on y."""
        return isinstance(self.fwhm, tuple) or bool(self.azimuth) or bool(self.y0)

    def in_space(self, azimuth: float) -> EllipticalGaussian:
        """The beam in three dimensions, tilted along an azimuth [degree], about (0, 0); the launch form alone is known there."""
        if self.form != "launch":
            raise ValueError(
                f"form: expected 'launch' with y, got {self.form!r}, which is not available in three dimensions"
            )
        return EllipticalGaussian(self.radii, self.angle, azimuth, self.z0)

    @property
    def centre(self) -> float:
        """x0 [m]."""
        return self.x0

    @property
    def launch_width(self) -> float | None:
        """The width along the launch plane, known for the launch form [m]."""
        return self.fwhm if self.form == "launch" and not isinstance(self.fwhm, tuple) else None

    def moved_to_origin(self) -> GaussianBeam:
        """The same beam with x0 = 0."""
        return replace(self, x0=0.0) if self.x0 else self

    @property
    def entire(self) -> bool:  # type: ignore[override]
        """True for the launch form; the rotated form has propagating waves only."""
        return self.form == "launch"

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        a = self.radius
        return a * math.sqrt(math.pi) * np.exp(-((a * k / 2) ** 2))

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) [Pa m] about x = 0.

        The rotated form: with kappa = kx cos(angle) - kz sin(angle) the wavenumber across the beam's axis,
        ``S = S_waist(kappa) dkappa/dkx`` for |kx| < k0, and 0 beyond.
        """
        kx = np.asarray(kx)
        with np.errstate(over="ignore"):  # infinite far from x = 0 for complex kx: the field's check says so
            shift = np.exp(-1j * kx * self.x0) if self.x0 else 1.0
        if self.form == "launch":
            return super().spectrum(kx, k0) * shift
        inside = np.abs(kx.real) < k0
        kz = np.sqrt(np.where(inside, (k0 - kx) * (k0 + kx), 1.0))
        sine, cosine = float(sin_degrees(self.angle)), math.cos(math.radians(self.angle))
        waist = self._envelope_spectrum(kx * cosine - kz * sine)
        return np.where(inside, waist * (cosine + sine * kx / kz), 0.0) * shift

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """S(kx) of the launch form at angles of given sines (B,): (B, n) for kx (n,)."""
        return super().spectra(kx, k0, sines) * np.exp(-1j * kx * self.x0)

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p(x, z0) of the launch form; of the rotated form, its waist without the truncation to |kx| < k0."""
        xi = np.asarray(x) - self.x0
        cosine = 1.0 if self.form == "launch" else math.cos(math.radians(self.angle))
        return np.exp(-((xi * cosine / self.radius) ** 2) + 1j * self._tilt(k0) * xi)

    def reach(self, tolerance: float) -> float:
        """Half width of |p| above `tolerance`: a sqrt(ln(1/tolerance)), divided by cos(angle) for the rotated form [m]."""
        cosine = 1.0 if self.form == "launch" else math.cos(math.radians(self.angle))
        return self.radius * math.sqrt(math.log(1 / tolerance)) / cosine

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """k0 sin(angle) -+ (2/a) sqrt(ln(1/tolerance)); (-k0, k0) for the rotated form [rad/m]."""
        if self.form == "rotated":
            return -k0, k0
        middle, half = self._tilt(k0), 2 / self.radius * math.sqrt(math.log(1 / tolerance))
        return middle - half, middle + half


def _widths(fwhm: object) -> float | tuple[float, float]:
    """A width, or those along x and y."""
    if not isinstance(fwhm, tuple | list) and not (isinstance(fwhm, np.ndarray) and fwhm.ndim):
        return as_number(fwhm, "fwhm", positive=True)
    if len(fwhm) != 2:
        raise validate.refuse("fwhm", "a width, or two widths along x and y", fwhm)
    x, y = (as_number(width, "fwhm", positive=True) for width in fwhm)
    return x, y
