"""Sampled pressure profiles, from arrays, text files or a line of a dataset."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from .. import memory, validate
from .base import BLOCK, Tilted, spectral_sum
from .columns import read_columns

#: Steps that differ by less than this share are even: printed positions are known to some six digits.
EVEN = 1e-6


class LargestStep(NamedTuple):
    """The largest step of uneven samples [m], and the position behind which it lies."""

    size: float
    behind: float

    def said(self, name: str) -> str:
        """In words, of the axis `name`."""
        return f"beyond the Nyquist wavenumber of the largest step of {name} ({self.size:.3g} m, behind {self.behind:.3g} m)"


def on_even_positions(
    x: np.ndarray, p: np.ndarray, axis: int, name: str
) -> tuple[np.ndarray, np.ndarray, LargestStep | None]:
    """Samples along an axis as they are, or on even positions of the finest spacing by a cubic spline, with the largest step then."""
    steps = np.diff(x)
    if np.ptp(steps) <= EVEN * steps.min():
        return x, p, None
    from scipy.interpolate import CubicSpline

    count = float((x[-1] - x[0]) / steps.min()) + 1
    beside = p.size / p.shape[axis]
    memory.check(
        name, 200.0 * count * beside, f"{count:.3g} even steps as small as the least", f"space {name} more evenly"
    )
    even, widest = np.linspace(x[0], x[-1], round(count)), int(np.argmax(steps))
    return even, CubicSpline(x, p, axis=axis)(even), LargestStep(float(steps[widest]), float(x[widest]))


def beyond_largest_step(
    step: LargestStep, k: np.ndarray, size: np.ndarray, k0: float, way: float, largest: float
) -> float:
    """The largest of spectrum sizes at wavenumbers k, (n,) each, beyond the Nyquist wavenumber of a step, over `largest`.

    There a spline through uneven samples has guessed. Evanescent waves have decayed on a `way` [m] through the medium in front.
    """
    nyquist = math.pi / step.size
    beyond = size[
        np.abs(k) >= nyquist - abs(k[1])
    ]  # k by even steps: the neighbour below shows what is at the number itself
    decay = math.exp(-math.sqrt(max(nyquist**2 - k0**2, 0.0)) * way)
    return float(beyond.max(initial=0.0)) / largest * decay


@dataclass(frozen=True, eq=False)
class Profile(Tilted):
    """Any sampled pressure profile on the launch plane, zero outside its samples.

    Parameters
    ----------
    x : 1-D array, m
        Strictly increasing. Uneven samples are brought onto an even grid of the finest spacing by a cubic spline; questions warn where the
        spectrum has not ended, to rtol, at the Nyquist wavenumber of the largest step.
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
    # of the samples as they were given, if uneven; not annotated: no field, so that changed samples, even by now, have none
    _largest_step = None

    def __post_init__(self) -> None:
        self._check_launch()
        x, p = validate.positions(self.x, "x", increasing=True), validate.numeric(self.p, "p").astype(complex)
        if x.size < 2:
            raise ValueError(f"x: expected a 1-D array of at least 2 positions, got shape {x.shape}")
        if p.shape != x.shape:
            raise ValueError(f"p: expected an array of x's shape {x.shape}, got {p.shape}")
        validate.within(p, "p", zero=True)
        if not np.all(np.isfinite(p)):
            raise ValueError("p: expected finite values, got NaN or infinity")
        if not np.any(p):
            raise ValueError("p: expected a profile that is not zero everywhere, got zeros")
        x, p, largest_step = on_even_positions(x, p, 0, "x")
        object.__setattr__(self, "_largest_step", largest_step)
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

        Examples
        --------
        >>> x = np.linspace(-0.3, 0.3, 121)
        >>> np.savetxt("measured.txt", np.column_stack([x, np.exp(-((x / 0.05) ** 2))]))
        >>> bp.Profile.from_file("measured.txt", z0=-0.01).x.size
        121
        """
        path = validate.existing(validate.as_path(path))
        validate.flag(conjugate, "conjugate")
        table = read_columns(path, 2, 3, "x, Re p, Im p")
        p = table[:, 1] + (1j * table[:, 2] if table.shape[1] == 3 else 0)
        order = np.argsort(table[:, 0], kind="stable")
        profile = cls(table[order, 0], (p.conj() if conjugate else p)[order], z0, angle)
        object.__setattr__(profile, "file", path.name)
        return profile

    @classmethod
    def from_data(cls, profile: Any, z0: float = 0.0, angle: float = 0.0) -> Profile:
        """One line of a dataset: a DataArray of complex pressure along x (``ds.p.sel(z=0, method="nearest")``, say).

        Parameters
        ----------
        profile : DataArray, Pa
            Along x [m] alone.
        z0, angle
            As in `Profile`.

        Raises
        ------
        ValueError
            It has other dimensions.

        Examples
        --------
        >>> first = bp.Slab(bp.lmmd_cell(), periods=20)
        >>> ds = bp.field(first, bp.GaussianBeam(0.096), 2500.0, x=np.linspace(-1, 1, 501), z=first.thickness)
        >>> bp.Profile.from_data(ds.p, z0=-0.1).x.size
        501
        """
        if getattr(profile, "dims", None) != ("x",):
            raise ValueError(
                f"profile: expected a DataArray along x, got {getattr(profile, 'dims', type(profile).__name__)}"
            )
        return cls(profile["x"].values, profile.values, z0, angle)

    def __eq__(self, value: object) -> bool:
        return isinstance(value, Profile) and self._key() == value._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[bytes, bytes, float, float]:
        # + 0.0 turns -0.0 into 0.0, which it is equal to
        return (self.x + 0.0).tobytes(), (self.p + 0.0).tobytes(), self.z0, self.angle

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
        S = self.spacing * spectral_sum(k, self.x, self.p)
        return np.where(np.abs(np.asarray(k).real) <= np.pi / self.spacing, S, 0)

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """S(kx) [Pa m], zero beyond the samples' Nyquist wavenumber."""
        return super().spectrum(kx, k0) * np.exp(-1j * self._tilt(k0) * self.centre)

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """S(kx) at angles of given sines (B,): (B, n) for kx (n,). Angles tilt the samples, so all share exp(-i kx x)."""
        kx, tilt = np.asarray(kx), k0 * sines
        tilted = self.p[:, None] * np.exp(1j * np.multiply.outer(self.x - self.centre, tilt))
        S = self.spacing * spectral_sum(kx, self.x, tilted).T
        return np.where(np.abs(kx.real - tilt[:, None]) <= np.pi / self.spacing, S, 0)

    def spectral_rounding(self, kx: np.ndarray, k0: float) -> tuple[np.ndarray, np.ndarray]:
        """What rounding of positions and phases leaves unknown of S(kx): root mean square [Pa m], and as white noise [Pa m^(1/2)].

        Every p_j exp(-i k x_j) errs by itself, by up to EPS (1 + |k x_j|) |p_j|, k = kx - k0 sin(angle). It counts where a slab
        lets through only such kx at which the samples cancel to next to nothing.
        """
        k = np.abs(np.asarray(kx) - self._tilt(k0))
        size, far = np.abs(self.p), np.abs(self.x)
        moments = [float(np.sqrt(np.sum((size * far**m) ** 2))) for m in (0, 1)]
        largest = [float(np.max(size * far**m)) for m in (0, 1)]
        eps, dx = np.finfo(float).eps, self.spacing
        return eps * dx * (moments[0] + k * moments[1]), eps * math.sqrt(dx) * (largest[0] + k * largest[1])

    def rounding_of_values(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """What rounding of the samples p_j alone adds to S(kx), as white noise up to the Nyquist wavenumber [Pa m^(1/2)].

        Each errs by up to EPS/2 |p_j|, evenly: EPS |p_j|/(2 sqrt(3)), root mean square. Samples thus have a spectrum far beyond that of their profile.
        """
        noise = np.finfo(float).eps / (2 * math.sqrt(3)) * math.sqrt(self.spacing) * np.max(np.abs(self.p))
        return np.full(np.shape(kx), noise)

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Whether the samples' spectrum has vanished where it ends, at the Nyquist wavenumber."""
        lo, hi = self.band(0.0, tolerance)
        return (hi - lo) / 2 < (1 - 1e-9) * np.pi / self.spacing

    def not_ended(self, k0: float, way: float) -> dict[str, float]:
        """Of uneven samples |S| beyond the Nyquist wavenumber of their largest step, over the largest; see `SourcePlane.not_ended`."""
        step: LargestStep | None = self._largest_step
        if step is None:
            return {}
        size = np.abs(np.fft.fft(self.p, 4 * self.x.size))
        k = 2 * np.pi * np.fft.fftfreq(size.size, self.spacing)
        return {step.said("x"): beyond_largest_step(step, k, size, k0, way, float(size.max()))}

    def spectrum_ends(self, k0: float) -> tuple[float, float]:
        """The interval of kx at whose ends the spectrum is cut off, whatever its value there [rad/m]."""
        middle, half = self._tilt(k0), np.pi / self.spacing
        return middle - half, middle + half

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """p(x, z0): the band-limited interpolation of the samples [Pa]."""
        x = np.asarray(x, dtype=float)
        p, flat = np.empty(x.size, complex), x.ravel()
        block = max(1, BLOCK // self.x.size)
        for start in range(0, x.size, block):
            part = slice(start, start + block)
            p[part] = np.sinc((flat[part, None] - self.x) / self.spacing) @ self.p
        return p.reshape(x.shape) * np.exp(1j * self._tilt(k0) * (x - self.centre))

    def reach(self, tolerance: float) -> float:
        """Half width of the launch profile, whatever the level: half the sampled interval, and a sample [m]."""
        return float(self.x[-1] - self.x[0]) / 2 + self.spacing

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """The interval in which the samples' spectrum exceeds tolerance times its largest value [rad/m]."""
        size = 4 * self.x.size
        k = 2 * np.pi * np.fft.fftfreq(size, self.spacing)
        strong = np.abs(np.fft.fft(self.p, size))
        used = np.abs(k[strong > tolerance * strong.max()])
        middle, half = self._tilt(k0), min(used.max() + 2 * np.pi / (size * self.spacing), np.pi / self.spacing)
        return middle - half, middle + half
