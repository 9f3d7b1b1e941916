"""What the questions share about their arguments beyond plain checks of values: angles, kx, labels of axes, warnings."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from .. import memory, validate
from ..media.fluids import Fluid
from ..media.hints import HintWarning
from ..media.structures import UNSTATED, Layer, Slab
from ..sources.base import Beam, sin_degrees


class AccuracyWarning(UserWarning):
    """An answer whose estimated error is above the asked rtol.

    Examples
    --------
    >>> import warnings
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", bp.AccuracyWarning)  # from here on it is raised
    ...     p = bp.field(slab, beam, 2500.0, x=0.0, z=slab.thickness)
    """


def warn_if_inaccurate(
    error: float, rtol: float, stacklevel: int = 3, of: str = "the largest |p|", mostly: str = ""
) -> None:
    """Warn of an estimated error above rtol; `mostly` names its largest term where it is known."""
    if error > rtol:
        term = f", mostly: {mostly}" if mostly else ""
        warnings.warn(
            f"estimated error {error:.1e} of {of}, above the asked rtol {rtol:.1e}{term}",
            AccuracyWarning,
            stacklevel=stacklevel,
        )


def angles(angle: Any, beam: Beam) -> np.ndarray:
    """The asked angles of a beam [degree], its own by default."""
    return validate.angles(beam.angle if angle is None else angle)


def k0(slab: Slab, frequency: np.ndarray) -> np.ndarray:
    """Wavenumber of the medium in front [rad/m]."""
    return forward_k0(slab.before, frequency, "before")


def forward_k0(fluid: Fluid, frequency: np.ndarray, name: str) -> np.ndarray:
    """Wavenumber of a fluid that carries forward waves [rad/m]."""
    k = fluid.wavenumber(frequency)
    if not np.all(np.isfinite(k) & (k.real > 0)):
        raise ValueError(f"{name}: kx_over_k0 and angle need a fluid that carries forward waves, got {fluid!r}; use kx")
    return k.real


def one_of(**options: Any) -> tuple[str, Any]:
    """The one option that is given."""
    given = {name: value for name, value in options.items() if value is not None}
    if len(given) != 1:
        raise ValueError(f"expected exactly one of {', '.join(options)}, got {', '.join(given) or 'none'}")
    return next(iter(given.items()))


def lateral(
    name: str, value: Any, k0_at: Any, frequency: np.ndarray, bytes_each: float
) -> tuple[np.ndarray, np.ndarray]:
    """The asked axis and kx on (frequency, axis); k0_at is a function that is called only where it is needed.

    `bytes_each` is what the answer to one plane wave holds.
    """
    values = validate.angles(value, grazing=True) if name == "angle" else validate.axis(value, name, kind=complex)
    if not np.any(values.imag):
        values = values.real
    flat = np.atleast_1d(values)
    memory.check_waves(frequency.size * flat.size, flat.size, name, bytes_each)
    if name == "kx":
        return values, np.broadcast_to(flat, (frequency.size, flat.size))
    if name == "angle":
        flat = sin_degrees(flat)
    kx = np.atleast_1d(k0_at(frequency))[:, None] * flat
    validate.within(kx, name, zero=True)
    return values, kx


def dims(**axes: np.ndarray) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """Names of the axes that are arrays, and the index that drops the scalar ones."""
    return tuple(n for n, a in axes.items() if a.ndim), tuple(slice(None) if a.ndim else 0 for a in axes.values())


def coords(**axes: np.ndarray) -> dict[str, tuple[tuple[str, ...], Any]]:
    """Coordinates of the axes, scalars as scalars."""
    return {n: ((n,) if a.ndim else (), a) for n, a in axes.items()}


#: Relative errors of plane waves from which on a warning is due.
WORTH_A_WARNING = 1e-6


def warn_of_plane_waves(error: np.ndarray, frequency: np.ndarray, name: str, axis: np.ndarray) -> None:
    """A warning with the largest of errors (F, n) and where it is, if it is large."""
    i, j = np.unravel_index(np.argmax(error), error.shape)
    if error[i, j] > WORTH_A_WARNING:
        warnings.warn(
            f"estimated error {error[i, j]:.1e} (relative) at {frequency[i]:.8g} Hz, {name} {axis[j]:.8g}, and above "
            f"{WORTH_A_WARNING:.0e} at {np.count_nonzero(error > WORTH_A_WARNING)} of {error.size} places: "
            "the last bits of the input decide there",
            AccuracyWarning,
            stacklevel=3,
        )


#: Ultrasound: where a half-space of air behind water reflects all, and who asks has seldom meant it [Hz].
ULTRASOUND = 20e3
#: Density [kg/m3] and sound speed [m/s] of water and what is like it.
WATER_LIKE = ((850.0, 1200.0), (1300.0, 1700.0))


def warn_of_air(slab: Slab, frequency: np.ndarray, stacklevel: int = 3) -> None:
    """A hint that both half-spaces are air because none was given, around water at ultrasonic frequencies."""
    if slab.before is not UNSTATED or slab.after is not UNSTATED or np.max(frequency) < ULTRASOUND:
        return
    faces = slab.segments[0][0].layers[0], slab.segments[-1][0].layers[-1]
    if all(isinstance(layer, Layer) and _is_like_water(layer.fluid, frequency) for layer in faces):
        said = "before, after: air, for none was given, around layers like water; background= sets both (bp.AIR if it is meant)"
        warnings.warn(said, HintWarning, stacklevel=stacklevel)


def _is_like_water(fluid: Fluid, frequency: np.ndarray) -> bool:
    values = fluid.at(np.max(frequency))
    density, speed = abs(complex(values.rho_z)), abs(complex(values.bulk_modulus / values.rho_z)) ** 0.5
    return all(least <= v <= most for v, (least, most) in zip((density, speed), WATER_LIKE, strict=True))


def warn_of_width(slab: Slab, beam: Beam, frequency: np.ndarray, x: np.ndarray) -> None:
    """A hint that a beam of many wavelengths does not fit into the grid that its field is asked on."""
    fwhm, span = getattr(beam, "fwhm", 0.0), float(np.ptp(x))
    wavelengths = fwhm * float(np.max(np.abs(slab.before.wavenumber(np.max(frequency))))) / (2 * np.pi)
    if fwhm >= 1 and x.size >= 100 and fwhm > 2 * span and 20 < wavelengths < np.inf:
        said = f"fwhm: {fwhm:g} m is {wavelengths:.3g} wavelengths, and x spans {span:g} m: is it in metres?"
        warnings.warn(said, HintWarning, stacklevel=4)
