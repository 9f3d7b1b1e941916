"""A sampled or measured plane of pressure (a hologram), from arrays, datasets and files."""

from __future__ import annotations

import functools
import math
import os
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import memory, validate
from .base import BLOCK, Tilted, spectral_sum
from .in_space import unit_vector
from .plane_files import read_plane
from .profile import LargestStep, beyond_largest_step, on_even_positions

#: The plane is padded to so many times its samples, where the extent of its spectrum is read off: |S| between two wavenumbers is at most 1.3
#: times the larger of both then.
PADDED = 2


@dataclass(frozen=True, eq=False)
class SourcePlane(Tilted):
    """A sampled pressure on the launch plane, zero outside its samples: a source in three dimensions.

    Parameters
    ----------
    x, y : 1-D arrays, m
        Strictly increasing. Uneven samples are brought onto even ones of the finest spacing by cubic splines, which guess what lies in a gap.
    p : array of complex (y, x), Pa
        exp(-i w t).
    z0 : float, m
        Launch plane, z0 <= 0.
    angle, azimuth : float, degree
        Tilt the samples further, by ``exp(i k0 sin(angle) s)``, s the distance from their middle towards the azimuth, from x towards y.

    Notes
    -----
    Between the samples the pressure is their band-limited interpolation: the spectrum is ``dx dy sum p exp(-i kx x - i ky y)`` up to the
    Nyquist wavenumbers pi/dx and pi/dy, and 0 beyond. Space around the samples is open. `field` warns, with the number, where samples have not
    ended at their rim, or their spectrum at the Nyquist wavenumber, of uneven samples that of their largest step, to the requested rtol.

    Examples
    --------
    >>> x = y = np.linspace(-0.2, 0.2, 81)
    >>> ring = np.hypot(x, y[:, None]) ** 2 * np.exp(-(x**2 + y[:, None] ** 2) / 0.03**2)
    >>> source = bp.SourcePlane(x, y, ring, z0=-0.1)
    >>> ds = bp.field(bp.Slab(bp.lmmd_cell(), 45), source, 2500.0, x=0.0, z=[0.0, 0.1], y=[-0.1, 0.0, 0.1])
    >>> dict(ds.p.sizes), bool(ds.error_estimate < 1e-8)
    ({'z': 2, 'y': 3}, True)
    """

    x: np.ndarray
    y: np.ndarray
    p: np.ndarray
    z0: float = 0.0
    angle: float = field(default=0.0, kw_only=True)
    azimuth: float = field(default=0.0, kw_only=True)
    in_space_only = True
    file = ""  # the name of the one it was read from, for the record; changed samples are no longer its
    # of the samples as they were given, where uneven; like `file` no field
    _largest_steps = (None, None)

    def __post_init__(self) -> None:
        self._check_launch()
        object.__setattr__(self, "azimuth", validate.as_number(self.azimuth, "azimuth"))
        x, y = (validate.positions(getattr(self, name), name, increasing=True) for name in "xy")
        for positions, name in ((x, "x"), (y, "y")):
            if positions.size < 2:
                raise ValueError(f"{name}: expected a 1-D array of at least 2 positions, got shape {positions.shape}")
        p = validate.numeric(self.p, "p").astype(complex)
        if p.shape != (y.size, x.size):
            raise ValueError(f"p: expected an array (y, x) of shape {(y.size, x.size)}, got {p.shape}")
        validate.within(p, "p", zero=True)
        if not np.all(np.isfinite(p)):
            raise ValueError("p: expected finite values, got NaN or infinity")
        if not np.any(p):
            raise ValueError("p: expected a plane that is not zero everywhere, got zeros")
        x, p, step_x = on_even_positions(x, p, 1, "x")
        y, p, step_y = on_even_positions(y, p, 0, "y")
        object.__setattr__(self, "_largest_steps", (step_x, step_y))
        for key, array in (("x", x), ("y", y), ("p", p)):
            array.setflags(write=False)
            object.__setattr__(self, key, array)

    @classmethod
    def from_data(cls, plane: Any, z0: float = 0.0) -> SourcePlane:
        """A DataArray of complex pressure along y and x, in any order (``ds.p.sel(z=0.1, method="nearest")``, say).

        Examples
        --------
        >>> x = y = np.linspace(-0.05, 0.05, 51)
        >>> import xarray as xr
        >>> p = xr.DataArray(np.exp(-(x**2 + y[:, None] ** 2) / 0.01**2), {"y": y, "x": x}, ("y", "x"))
        >>> bp.SourcePlane.from_data(p, z0=-0.03).z0
        -0.03
        """
        if sorted(map(str, getattr(plane, "dims", ()))) != ["x", "y"]:
            raise ValueError(
                f"plane: expected a DataArray along y and x, got {getattr(plane, 'dims', type(plane).__name__)}"
            )
        for name in "xy":
            if (units := plane[name].attrs.get("units", "m")) != "m":
                raise validate.refuse("plane", f"{name} in m", units)
        plane = plane.transpose("y", "x")
        return cls(plane["x"].values, plane["y"].values, plane.values, z0)

    @classmethod
    def from_file(
        cls,
        path: str | os.PathLike[str],
        z0: float = 0.0,
        conjugate: bool = False,
        *,
        angle: float = 0.0,
        azimuth: float = 0.0,
    ) -> SourcePlane:
        """A plane from x, y and p (or p_real and p_imag) in a file: .mat (of any version), .npz or .nc.

        Parameters
        ----------
        path : path
        z0 : float, m
        conjugate : bool
            For files in the convention exp(+i w t).
        angle, azimuth : float, degree
            As in `SourcePlane`.

        Raises
        ------
        ValueError
            Names the file, and what it does not hold or holds otherwise.
        OSError
            The file cannot be opened.

        Examples
        --------
        >>> x = y = np.linspace(-0.05, 0.05, 51)
        >>> np.savez("hologram.npz", x=x, y=y, p=np.exp(-(x**2 + y[:, None] ** 2) / 0.01**2))
        >>> bp.SourcePlane.from_file("hologram.npz", z0=-0.03).z0
        -0.03
        """
        path = validate.as_path(path)
        validate.flag(conjugate, "conjugate")
        x, y, p = read_plane(path)
        try:
            plane = cls(x, y, np.conj(p) if conjugate else p, z0, angle=angle, azimuth=azimuth)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        object.__setattr__(plane, "file", path.name)
        return plane

    def __eq__(self, value: object) -> bool:
        return isinstance(value, SourcePlane) and self._key() == value._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[Any, ...]:
        # + 0.0 turns -0.0 into 0.0, which it is equal to
        arrays = ((v + 0.0).tobytes() for v in (self.x, self.y, self.p))
        return *arrays, self.z0, self.angle, self.azimuth

    # --- about its middle -------------------------------------------------------------------------------

    @property
    def x0(self) -> float:
        """Middle of the samples along x [m]."""
        return float((self.x[0] + self.x[-1]) / 2)

    @property
    def y0(self) -> float:
        """Middle of the samples along y [m]."""
        return float((self.y[0] + self.y[-1]) / 2)

    @property
    def centre(self) -> float:
        """x0 [m]."""
        return self.x0

    def in_space(self, azimuth: float) -> SourcePlane:
        """The same samples about (0, 0), tilted along an azimuth."""
        return replace(self, x=self.x - self.x0, y=self.y - self.y0, azimuth=azimuth)

    @property
    def _spacings(self) -> tuple[float, float]:
        return tuple(float((v[-1] - v[0]) / (v.size - 1)) for v in (self.x, self.y))  # type: ignore[return-value]

    def _tilts(self, k0: float) -> tuple[float, float]:
        x, y = unit_vector(self.azimuth)
        return self._tilt(k0) * x, self._tilt(k0) * y

    def spectrum_at(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """S(kx, ky) at kx (1, X) and ky (Y, 1), by two products: (Y, X)."""
        sums = self.p
        for k, tilt, at, spacing in zip((kx, ky), self._tilts(k0), (self.x, self.y), self._spacings, strict=True):
            own = np.ravel(k) - tilt
            inside = np.abs(own) <= math.pi / spacing * (1 + 1e-12)
            sums = np.where(inside, spacing, 0.0)[:, None] * spectral_sum(own, at, sums.T)
        return sums

    def scattered_spectrum(self, kx: np.ndarray, ky: np.ndarray, k0: float) -> np.ndarray:
        """S at places (kx, ky), (n,) each, in blocks of bounded memory: (n,)."""
        (dx, dy), tilts, out = self._spacings, self._tilts(k0), np.empty(kx.size, complex)
        block = max(1, BLOCK // max(self.p.shape))
        for start in range(0, kx.size, block):
            part = slice(start, start + block)
            x, y = kx[part] - tilts[0], ky[part] - tilts[1]
            along_x, along_y = np.exp(-1j * np.outer(x, self.x)), np.exp(-1j * np.outer(y, self.y))
            inside = (np.abs(x) * dx <= math.pi) & (np.abs(y) * dy <= math.pi)
            out[part] = inside * dx * dy * np.einsum("ky,ky->k", along_y, along_x @ self.p.T)
        return out

    # --- how far it reaches -----------------------------------------------------------------------------

    def half_widths(self, tolerance: float) -> tuple[float, float]:
        """Along x and y to the last sample above the tolerance, and a spacing farther."""
        strong = np.abs(self.p) > tolerance * np.max(np.abs(self.p))
        dx, dy = self._spacings
        return (
            float(np.max(np.abs(self.x - self.x0)[strong.any(axis=0)])) + dx,
            float(np.max(np.abs(self.y - self.y0)[strong.any(axis=1)])) + dy,
        )

    def reach(self, tolerance: float) -> float:
        """The corner of `half_widths`."""
        return math.hypot(*self.half_widths(tolerance))

    @functools.cached_property
    def _padded(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """kx (X,), ky (Y,) and |S|/dx dy of the samples without their tilt, padded: (Y, X)."""
        (dx, dy), (rows, columns) = self._spacings, (2 * math.ceil(PADDED * n / 2) for n in self.p.shape)
        memory.check("p", 64.0 * rows * columns, f"the spectrum of {self.p.shape} samples", "give fewer samples")
        size = np.abs(np.fft.fft2(self.p, (rows, columns)))
        return 2 * np.pi * np.fft.fftfreq(columns, dx), 2 * np.pi * np.fft.fftfreq(rows, dy), size

    def box(self, k0: float, tolerance: float) -> np.ndarray:
        """That of the padded samples' spectrum, up to the Nyquist wavenumbers."""
        kx, ky, size = self._padded
        strong = size > tolerance * size.max()
        ends = []
        for k, axis, tilt in ((kx, 0, self._tilts(k0)[0]), (ky, 1, self._tilts(k0)[1])):
            used, step, nyquist = k[strong.any(axis=axis)], k[1], abs(k[k.size // 2])
            ends.append([max(used.min() - step, -nyquist) + tilt, min(used.max() + step, nyquist) + tilt])
        return np.array(ends)

    def _radii(self, k0: float) -> tuple[np.ndarray, float]:
        """|k| of the padded spectrum, with the tilt, and the diagonal of its steps."""
        (kx, ky, _), (x, y) = self._padded, self._tilts(k0)
        return np.hypot(kx + x, ky[:, None] + y), math.hypot(kx[1], ky[1])

    def rings(self, k0: float, tolerance: float) -> tuple[float, float]:
        """Those of the padded samples' spectrum."""
        radii, step = self._radii(k0)
        size = self._padded[2]
        strong = radii[size > tolerance * size.max()]
        return max(0.0, float(strong.min()) - step), float(strong.max()) + step

    def _by_ring(self, k: np.ndarray, k0: float, largest: bool) -> np.ndarray:
        """The largest |S|, or its mean, on rings a step wide of the padded spectrum, at |k|."""
        radii, step = self._radii(k0)
        ring, size = (radii / step).astype(int).ravel(), self._padded[2].ravel() * math.prod(self._spacings)
        values = np.zeros(ring.max() + 2)
        if largest:
            np.maximum.at(values, ring, size)
        else:
            values[:-1] = np.bincount(ring, size) / np.maximum(np.bincount(ring), 1)
        return values[np.minimum((np.abs(np.real(k)) / step).astype(int), values.size - 1)]

    def mean_size(self, k: np.ndarray, k0: float) -> np.ndarray:
        """|S| averaged over directions at |k|."""
        return self._by_ring(k, k0, largest=False)

    # --- as a `Beam`: what is strongest in any direction --------------------------------------------------

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        """The largest |S| in any direction at |kx|."""
        return self._by_ring(np.asarray(kx), k0, largest=True)

    def spectra(self, kx: np.ndarray, k0: float, sines: np.ndarray) -> np.ndarray:
        """The same at angles of given sines: (B, n)."""
        return np.stack([self.at_angle(math.degrees(math.asin(s))).spectrum(kx, k0) for s in sines])

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        """That of `rings`, to both sides where it begins at 0."""
        low, high = self.rings(k0, tolerance)
        return low or -high, high

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        """The samples' row nearest to the middle, interpolated, along x."""
        row, dx = self.p[self.p.shape[0] // 2], self._spacings[0]
        return np.asarray(np.sinc((np.asarray(x)[..., None] - self.x) / dx) @ row)

    def shifts_smoothly(self, tolerance: float) -> bool:
        """Whether the samples' spectrum has vanished where it ends."""
        return self._at_nyquist <= tolerance

    # --- what has not ended -------------------------------------------------------------------------------

    @property
    def _at_nyquist(self) -> float:
        size = self._padded[2]
        return float(max(size[:, size.shape[1] // 2].max(), size[size.shape[0] // 2].max()) / size.max())

    def not_ended(self, k0: float, way: float) -> dict[str, float]:
        """What the samples leave out, over their largest values: |p| at the rim, and |S| at the Nyquist wavenumber.

        Waves at the Nyquist wavenumber have decayed on a `way` [m] through the medium in front.
        """
        size = np.abs(self.p)
        rim = max(float(v.max()) for v in (size[0], size[-1], size[:, 0], size[:, -1])) / float(size.max())
        nyquist = math.pi / max(self._spacings)
        decay = math.exp(-math.sqrt(max(nyquist**2 - k0**2, 0.0)) * way)
        return {"at the rim": rim, "at the Nyquist wavenumber": self._at_nyquist * decay} | self._guessed(k0, way)

    def _guessed(self, k0: float, way: float) -> dict[str, float]:
        """|S| beyond the Nyquist wavenumbers of the largest steps of uneven samples."""
        (*both, size), shares = self._padded, {}
        steps: tuple[LargestStep | None, ...] = self._largest_steps
        for name, step, k, axis in zip("xy", steps, both, (0, 1), strict=True):
            if step is not None:
                along = size.max(axis=axis)
                shares[step.said(name)] = beyond_largest_step(step, k, along, k0, way, float(size.max()))
        return shares
