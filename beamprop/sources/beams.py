"""What is launched: Gaussian beams, sampled profiles, slits, as spectra on any line of complex kx.

Every source is a pressure on its launch plane z = z0 <= 0 and knows four things: its spectrum
``S(kx) = integral p(x, z0) exp(-i kx x) dx``, the centre and reach of its profile, and the band of its spectrum.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from .. import memory, validate
from ..arrays import exponentials
from ..validate import as_count, as_number
from .columns import read_columns

_B = TypeVar("_B", bound="_Tilted")


@runtime_checkable
class Beam(Protocol):
    """What `beamprop.field` and `beamprop.beam_width` need of a source."""

    angle: float
    z0: float

    @property
    def centre(self) -> float:
        """Middle of the launch profile [m]."""

    @property
    def entire(self) -> bool:
        """Whether the spectrum holds for every complex kx (else: propagating waves on the real axis only)."""

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) [Pa m] at kx [rad/m], in a medium of wavenumber k0."""

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p(x, z0) [Pa]."""

    def reach(self, tolerance: float) -> float:
        """Distance from the centre beyond which |p| stays below tolerance times its largest value [m]."""

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Interval of real kx outside which |S| is below tolerance times its largest value [rad/m]."""

    def at_angle(self, angle: float) -> Beam:
        """The same source sent off at another angle [degree]."""


def _check_launch(angle: Any, z0: Any) -> tuple[float, float]:
    angle, z0 = validate.angle(angle), as_number(z0, "z0")
    if z0 > 0:
        raise ValueError(f"z0: expected a launch plane in front of the slab, z0 <= 0, got {z0!r}")
    return angle, z0


def moved_to_origin(beam: Beam) -> tuple[Beam, float]:
    """The same source about x = 0, and how far it was moved [m].

    On a contour of complex kx the phase exp(-i kx x0) of a source far from x = 0 overflows, and rounding of x0 would be
    magnified with it: what is computed does not depend on where the origin lies. A source of the user's own stays where it is
    unless it has a method `moved_to_origin`, which returns the moved source.
    """
    move = getattr(beam, "moved_to_origin", None)
    return (beam, 0.0) if move is None else (move(), beam.centre)


def sin_degrees(angle: Any) -> np.ndarray:
    """sin of an angle in degrees, exact at multiples of 30 degrees where a user expects it."""
    angle = np.asarray(angle, dtype=float)
    value = np.sin(np.deg2rad(angle))
    return np.where(np.abs(angle) == 30.0, np.copysign(0.5, angle), value)


class _Tilted:
    """A source that is an envelope times exp(i k0 sin(angle) (x - centre))."""

    angle: float
    z0: float
    entire = True

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        raise NotImplementedError

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx), the envelope's spectrum shifted by k0 sin(angle)."""
        return self._envelope_spectrum(np.asarray(kx) - k0 * float(sin_degrees(self.angle)))

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """S(kx) at angles of given sines (B,), if the source is entire: (B, n) for kx (n,)."""
        return self._envelope_spectrum(np.asarray(kx) - k0 * sines[:, None])

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Whether S is an entire function of sin(angle), but for `tolerance` of its largest value."""
        return self.entire

    def at_angle(self: _B, angle: float) -> _B:
        """The same envelope at another angle [degree]."""
        return replace(self, angle=angle)  # type: ignore[type-var]


@dataclass(frozen=True)
class GaussianBeam(_Tilted):
    """A Gaussian beam.

    Parameters
    ----------
    fwhm : float, m
        Full width at half maximum of |p| at the launch plane (of |p|^2 with ``width_of="intensity"``).
    angle : float, degree
        From the normal.
    x0, z0 : float, m
        Middle of the beam and launch plane, z0 <= 0.
    width_of : "pressure" or "intensity"
        With a the 1/e radius of |p|: fwhm = 2 a sqrt(ln 2), or a sqrt(2 ln 2).
    form : "launch" or "rotated"
        "launch": ``p(x, z0) = exp(-(x-x0)^2/a^2) exp(i k0 sin(angle) (x-x0))``, fwhm along the launch plane.
        "rotated": a beam whose waist lies at (x0, z0), across its own axis, made of propagating waves only.

    Examples
    --------
    >>> beam = bp.GaussianBeam(fwhm=0.096, angle=45, z0=-0.1)
    >>> round(beam.radius, 4)
    0.0577
    """

    fwhm: float
    angle: float = 0.0
    x0: float = 0.0
    z0: float = 0.0
    width_of: str = "pressure"
    form: str = "launch"

    def __post_init__(self) -> None:
        object.__setattr__(self, "fwhm", as_number(self.fwhm, "fwhm", positive=True))
        object.__setattr__(self, "x0", as_number(self.x0, "x0"))
        for name, value in zip(("angle", "z0"), _check_launch(self.angle, self.z0), strict=True):
            object.__setattr__(self, name, value)
        validate.word(self.width_of, "width_of", "pressure", "intensity")
        validate.word(self.form, "form", "launch", "rotated")

    @property
    def radius(self) -> float:
        """The 1/e radius a of |p| [m]."""
        return self.fwhm / (2 * math.sqrt(math.log(2)) if self.width_of == "pressure" else math.sqrt(2 * math.log(2)))

    @property
    def centre(self) -> float:
        """x0 [m]."""
        return self.x0

    def moved_to_origin(self) -> GaussianBeam:
        """The same beam with x0 = 0."""
        return replace(self, x0=0.0)

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
        return np.exp(-((xi * cosine / self.radius) ** 2) + 1j * k0 * float(sin_degrees(self.angle)) * xi)

    def reach(self, tolerance: float) -> float:
        """a sqrt(ln(1/tolerance)), divided by cos(angle) for the rotated form [m]."""
        cosine = 1.0 if self.form == "launch" else math.cos(math.radians(self.angle))
        return self.radius * math.sqrt(math.log(1 / tolerance)) / cosine

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """k0 sin(angle) -+ (2/a) sqrt(ln(1/tolerance)); (-k0, k0) for the rotated form [rad/m]."""
        if self.form == "rotated":
            return -k0, k0
        middle, half = k0 * float(sin_degrees(self.angle)), 2 / self.radius * math.sqrt(math.log(1 / tolerance))
        return middle - half, middle + half


def _spectral_sum(k: np.ndarray, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """sum_j weights_j exp(-i k x_j), shaped like k and then like weights_j, in blocks of bounded memory."""
    k = np.asarray(k)
    step = exponentials.even_step(x) if x.size >= exponentials.MANY else 0.0
    if step:
        summed = exponentials.over_positions(k.ravel(), weights.reshape(x.size, -1), float(x[0]), step)
        return summed.reshape(*k.shape, *weights.shape[1:])
    out = np.empty((k.size, *weights.shape[1:]), complex)
    block = max(1, 2_000_000 // max(1, x.size))
    flat = k.ravel()
    for start in range(0, k.size, block):
        out[start : start + block] = np.exp(-1j * np.multiply.outer(flat[start : start + block], x)) @ weights
    return out.reshape(*k.shape, *weights.shape[1:])


@dataclass(frozen=True, eq=False)
class Profile(_Tilted):
    """Any sampled pressure profile on the launch plane, zero outside its samples.

    Parameters
    ----------
    x : 1-D array, m
        Strictly increasing. Uneven samples are brought onto an even grid of the finest spacing by a cubic spline.
    p : 1-D array of complex, Pa
    z0 : float, m
        Launch plane, z0 <= 0.
    angle : float, degree
        Tilts the profile further by ``exp(i k0 sin(angle) (x - centre))``.

    Notes
    -----
    Between the samples the profile is its band-limited (Whittaker) interpolation: the spectrum is
    ``dx sum_j p_j exp(-i kx x_j)`` for ``|kx - k0 sin(angle)| <= pi/dx`` and 0 beyond.

    Examples
    --------
    >>> x = np.linspace(-0.3, 0.3, 601)
    >>> ring = bp.Profile(x, (1 - (x / 0.05) ** 2) * np.exp(-((x / 0.05) ** 2)), z0=-0.05)
    >>> round(ring.spacing, 6)
    0.001
    """

    x: np.ndarray
    p: np.ndarray
    z0: float = 0.0
    angle: float = 0.0

    def __post_init__(self) -> None:
        for name, value in zip(("angle", "z0"), _check_launch(self.angle, self.z0), strict=True):
            object.__setattr__(self, name, value)
        x, p = validate.positions(self.x, "x", increasing=True), validate.numeric(self.p, "p").astype(complex)
        if x.size < 2:
            raise ValueError(f"x: expected a 1-D array of at least 2 positions, got shape {x.shape}")
        if p.shape != x.shape:
            raise ValueError(f"p: expected an array of x's shape {x.shape}, got {p.shape}")
        validate.within(p, "p", zero=True)
        if not np.all(np.isfinite(p)):
            raise ValueError("p: expected finite values, got NaN or infinity")
        if not np.any(p):
            raise ValueError("p: expected a profile that is not zero everywhere")
        steps = np.diff(x)
        if np.ptp(steps) > 1e-6 * steps.min():
            from scipy.interpolate import CubicSpline

            count = float((x[-1] - x[0]) / steps.min()) + 1
            memory.check("x", 200.0 * count, f"{count:.3g} even steps as small as the least", "space x more evenly")
            even = np.linspace(x[0], x[-1], round(count))
            x, p = even, CubicSpline(x, p)(even)
        for key, array in (("x", x), ("p", p)):
            array.setflags(write=False)
            object.__setattr__(self, key, array)

    @classmethod
    def from_file(
        cls, path: str | os.PathLike[str], z0: float = 0.0, angle: float = 0.0, conjugate: bool = False
    ) -> Profile:
        """A measured profile from a text file of two or three columns: x [m], Re p, Im p [Pa].

        Columns are parted by blanks, commas or semicolons; lines that begin with # or % are comments. Commas are decimal
        where semicolons or tabs part the columns and no number has a point; what could be read either way is refused.

        Parameters
        ----------
        path : path
        z0, angle
            As in `Profile`.
        conjugate : bool
            For files in the convention exp(+i w t).

        Raises
        ------
        ValueError
            Names the file, and the line that is no row of finite numbers or may be read in two ways.
        OSError
            The file cannot be opened.
        """
        path = validate.as_path(path)
        validate.flag(conjugate, "conjugate")
        table = read_columns(path, 2, 3, "x, Re p, Im p")
        p = table[:, 1] + (1j * table[:, 2] if table.shape[1] == 3 else 0)
        order = np.argsort(table[:, 0], kind="stable")
        return cls(table[order, 0], (p.conj() if conjugate else p)[order], z0, angle)

    @classmethod
    def from_data(cls, profile: Any, z0: float = 0.0, angle: float = 0.0) -> Profile:
        """One line of a dataset: a DataArray of complex pressure along x (``ds.p.sel(z=0, method="nearest")``, say)."""
        if getattr(profile, "dims", None) != ("x",):
            raise ValueError(
                f"profile: expected a DataArray along x, got {getattr(profile, 'dims', type(profile).__name__)}"
            )
        return cls(profile["x"].values, profile.values, z0, angle)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Profile) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[bytes, bytes, float, float]:
        return (self.x + 0.0).tobytes(), (self.p + 0.0).tobytes(), self.z0, self.angle  # -0.0 is 0.0

    @property
    def spacing(self) -> float:
        """Distance between samples [m]."""
        return float((self.x[-1] - self.x[0]) / (self.x.size - 1))

    @property
    def centre(self) -> float:
        """Middle of the sampled interval [m]."""
        return float((self.x[0] + self.x[-1]) / 2)

    def moved_to_origin(self) -> Profile:
        """The same samples about x = 0."""
        return replace(self, x=self.x - self.centre)

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        S = self.spacing * _spectral_sum(k, self.x, self.p)
        return np.where(np.abs(np.asarray(k).real) <= np.pi / self.spacing, S, 0)

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) [Pa m], zero beyond the samples' Nyquist wavenumber."""
        return super().spectrum(kx, k0) * np.exp(-1j * k0 * float(sin_degrees(self.angle)) * self.centre)

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """S(kx) at angles of given sines (B,): (B, n) for kx (n,). Angles tilt the samples, so all share exp(-i kx x)."""
        kx, tilt = np.asarray(kx), k0 * sines
        tilted = self.p[:, None] * np.exp(1j * np.multiply.outer(self.x - self.centre, tilt))
        S = self.spacing * _spectral_sum(kx, self.x, tilted).T
        return np.where(np.abs(kx.real - tilt[:, None]) <= np.pi / self.spacing, S, 0)

    def spectral_rounding(self, kx: np.ndarray, k0: float) -> tuple[np.ndarray, np.ndarray]:
        """What rounding of positions and phases leaves unknown of S(kx): root mean square [Pa m], and as white noise [Pa m^(1/2)].

        Every p_j exp(-i k x_j) errs by itself, by up to EPS (1 + |k x_j|) |p_j|, k = kx - k0 sin(angle). It counts where a slab
        lets through only such kx at which the samples cancel to next to nothing.
        """
        k = np.abs(np.asarray(kx) - k0 * float(sin_degrees(self.angle)))
        size, far = np.abs(self.p), np.abs(self.x)
        moments = [float(np.sqrt(np.sum((size * far**m) ** 2))) for m in (0, 1)]
        largest = [float(np.max(size * far**m)) for m in (0, 1)]
        eps, dx = np.finfo(float).eps, self.spacing
        return eps * dx * (moments[0] + k * moments[1]), eps * math.sqrt(dx) * (largest[0] + k * largest[1])

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Whether the samples' spectrum has vanished where it ends, at the Nyquist wavenumber."""
        lo, hi = self.band(0.0, tolerance)
        return (hi - lo) / 2 < (1 - 1e-9) * np.pi / self.spacing

    def spectrum_ends(self, k0: float) -> tuple[float, float]:
        """The interval of kx at whose ends the spectrum is cut off, whatever its value there [rad/m]."""
        middle, half = k0 * float(sin_degrees(self.angle)), np.pi / self.spacing
        return middle - half, middle + half

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p(x, z0): the band-limited interpolation of the samples [Pa]."""
        x = np.asarray(x, dtype=float)
        p, flat = np.empty(x.size, complex), x.ravel()
        block = max(1, 2_000_000 // self.x.size)
        for start in range(0, x.size, block):
            part = slice(start, start + block)
            p[part] = np.sinc((flat[part, None] - self.x) / self.spacing) @ self.p
        return p.reshape(x.shape) * np.exp(1j * k0 * float(sin_degrees(self.angle)) * (x - self.centre))

    def reach(self, tolerance: float) -> float:
        """Half the sampled interval [m]."""
        return float(self.x[-1] - self.x[0]) / 2 + self.spacing

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """The interval in which the samples' spectrum exceeds tolerance times its largest value [rad/m]."""
        size = 4 * self.x.size
        k = 2 * np.pi * np.fft.fftfreq(size, self.spacing)
        strong = np.abs(np.fft.fft(self.p, size))
        used = np.abs(k[strong > tolerance * strong.max()])
        middle, half = (
            k0 * float(sin_degrees(self.angle)),
            min(used.max() + 2 * np.pi / (size * self.spacing), np.pi / self.spacing),
        )
        return middle - half, middle + half


@dataclass(frozen=True)
class Slits(_Tilted):
    """`count` slits, each `width` wide and driven in phase with 1 Pa, `separation` apart from middle to middle.

    The test of sub-wavelength imaging. Lengths in m; z0 <= 0 is the launch plane; `angle` [degree] tilts the phase.

    Examples
    --------
    >>> slits = bp.Slits(width=0.01, separation=0.04, count=2, z0=-0.005)
    >>> slits.positions
    array([-0.02,  0.02])
    """

    width: float
    separation: float
    count: int = 2
    z0: float = 0.0
    angle: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "width", as_number(self.width, "width", positive=True))
        object.__setattr__(self, "count", as_count(self.count, "count"))
        memory.check("count", 50.0 * self.count, f"{self.count:.3g} slits", "take fewer")
        object.__setattr__(self, "separation", as_number(self.separation, "separation", positive=True))
        for name, value in zip(("angle", "z0"), _check_launch(self.angle, self.z0), strict=True):
            object.__setattr__(self, name, value)
        if self.count > 1 and self.separation < self.width:
            raise ValueError(f"separation: expected at least the slits' width {self.width}, got {self.separation}")

    @property
    def positions(self) -> np.ndarray:
        """Middles of the slits [m]."""
        return (np.arange(self.count) - (self.count - 1) / 2) * self.separation

    @property
    def centre(self) -> float:
        """0 m."""
        return 0.0

    def _envelope_spectrum(self, k: np.ndarray) -> np.ndarray:
        half = np.asarray(k) * self.width / 2
        small = np.abs(half) < 1e-4
        safe = np.where(small, 1.0, half)
        sinc = np.where(small, 1 - half**2 / 6, np.sin(safe) / safe)
        return self.width * sinc * _spectral_sum(k, self.positions, np.ones(self.count))

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """1 Pa inside the slits, 0 elsewhere, tilted."""
        x = np.asarray(x, dtype=float)
        inside = np.zeros(x.shape, bool)
        middle = (self.count - 1) / 2
        below = np.floor(x / self.separation + middle)
        for number in (below, below + 1):  # no other slit is as near
            nearest = (np.clip(number, 0, self.count - 1) - middle) * self.separation
            inside |= np.abs(x - nearest) <= self.width / 2
        return inside * np.exp(1j * k0 * float(sin_degrees(self.angle)) * x)

    def reach(self, tolerance: float) -> float:
        """Half of the distance between the outermost edges [m]."""
        return float(self.positions[-1]) + self.width / 2

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Where the envelope 2/(k width) of the spectrum falls below the tolerance: wide, for edges are sharp."""
        middle, half = k0 * float(sin_degrees(self.angle)), 2 / (self.width * tolerance)
        return middle - half, middle + half
