"""What the questions share about their arguments beyond plain checks of values: angles, kx, labels of axes, warnings."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import memory, validate
from ..media.fluids import Fluid
from ..media.structures import Slab
from ..sources.base import Beam, Tilted, moved_to_origin, sin_degrees
from ..sources.in_space import check_on_a_line
from . import hints

if TYPE_CHECKING:
    from ..contour.error import ErrorBudget
    from ..profiles.power import PowerError


class AccuracyWarning(UserWarning):
    """An answer whose estimated error is above the requested rtol.

    Examples
    --------
    >>> import warnings
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", bp.AccuracyWarning)  # from here on it is raised
    ...     p = bp.field(slab, beam, 2500.0, x=0.0, z=slab.thickness)
    """


def warn_if_inaccurate(error: ErrorBudget | PowerError, rtol: float, of: str = "the largest |p|") -> None:
    """Warn of an estimated error above rtol, with its largest term."""
    total = float(np.max(error.total))
    if total > rtol:
        warnings.warn(
            f"estimated error {total:.1e} of {of}, above the requested rtol {rtol:.1e}, mostly: {error.largest}",
            AccuracyWarning,
            stacklevel=3,
        )


def warn_if_not_ended(beam: Any, slab: Slab, frequency: np.ndarray, way: float, rtol: float) -> None:
    """Warn, with the numbers, of samples of a source that stop above rtol; `way` [m] is that to the nearest plane in front of the slab."""
    for source in getattr(beam, "sources", (beam,)):
        not_ended = getattr(source, "not_ended", None)
        if not_ended is None:
            continue
        shares = {at: share for at, share in not_ended(np.max(k0(slab, frequency)), way).items() if share > rtol}
        if shares:
            guessed = any("largest step" in at for at in shares)
            warnings.warn(
                f"p: expected samples that end to rtol {rtol:.1e} of their largest, got {', '.join(f'{s:.1e} {at}' for at, s in shares.items())}: "
                f"what lies beyond is left out{', or a guess by splines where steps are uneven' if guessed else ''}",
                AccuracyWarning,
                stacklevel=3,
            )


class Beams(NamedTuple):
    """What questions about beams share: checked arguments, axes as they were given (scalars stay scalars)."""

    frequency: np.ndarray  #: Hz
    angle: np.ndarray  #: degree, the beam's own by default
    rtol: float
    source: Beam  #: the beam, moved to the origin
    origin: float  #: its place before [m]

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """frequency and angle."""
        return {"frequency": self.frequency, "angle": self.angle}

    @property
    def flat(self) -> tuple[np.ndarray, np.ndarray]:
        """frequency (F,) and angle (A,)."""
        return np.atleast_1d(self.frequency), np.atleast_1d(self.angle)


def beams(slab: Slab, beam: Beam, frequency: Any, angle: Any, rtol: float) -> Beams:
    """The arguments of a question about beams, or a ValueError that names the wrong one."""
    checked = unmoved_beams(slab, beam, frequency, angle, rtol)
    source, origin = moved_to_origin(check_on_a_line(beam))
    return checked._replace(source=source, origin=origin)


def from_launch_plane(z: np.ndarray, beam: Beam) -> np.ndarray:
    """Positions from a beam's launch plane on; one that is in front of it by the rounding of a computed axis is on it."""
    nearest = float(np.min(z))
    if nearest < beam.z0 - 8 * np.finfo(float).eps * abs(beam.z0):
        raise ValueError(f"z: expected positions not in front of the launch plane z0 = {beam.z0}, got {nearest}")
    return np.maximum(z, beam.z0) if nearest < beam.z0 else z


def unmoved_beams(slab: Slab, beam: Beam, frequency: Any, angle: Any, rtol: float) -> Beams:
    """The same of a beam where it is, which may be of three dimensions."""
    validate.instance(slab, Slab, "slab")
    if not isinstance(beam, Tilted):  # to look a protocol up takes longer than all other checks
        validate.instance(beam, Beam, "beam")
    if angle is not None and not getattr(beam, "share_angle", True):
        raise validate.refuse("angle", "none with a sum of sources at angles of their own", angle)
    f = validate.axis(frequency, "frequency", positive=True)
    angles = validate.angles(beam.angle if angle is None else angle)
    hints.warn_of_air(slab, f)
    hints.warn_of_solids(slab, f)
    return Beams(f, angles, validate.rtol(rtol), beam, 0.0)


def k0(slab: Slab, frequency: np.ndarray) -> np.ndarray:
    """Wavenumber of the medium in front [rad/m]."""
    return forward_k0(slab.before, frequency, "before")


def forward_k0(fluid: Fluid, frequency: np.ndarray, name: str) -> np.ndarray:
    """Wavenumber of a fluid that carries forward waves [rad/m]."""
    k = fluid.wavenumber(frequency)
    if not np.all(np.isfinite(k) & (k.real > 0)):
        raise ValueError(f"{name}: kx_over_k0 and angle need a fluid that carries forward waves, got {fluid!r}; use kx")
    return k.real


def single_option(**options: Any) -> tuple[str, Any]:
    """The option that is given, by name and value."""
    given = {name: value for name, value in options.items() if value is not None}
    if len(given) != 1:
        raise ValueError(f"{', '.join(options)}: expected exactly one of them, got {', '.join(given) or 'none'}")
    return next(iter(given.items()))


def lateral(
    name: str, value: Any, k0_at: Any, frequency: np.ndarray, bytes_each: float
) -> tuple[np.ndarray, np.ndarray]:
    """The requested axis and kx on (frequency, axis); k0_at is a function that is called only where it is needed.

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


def warn_of_crossings(most: int, names: str = "") -> None:
    """Warn where |p| crosses the half level more than twice: which of its places a width lies between."""
    if most > 2:
        where = f": {names}" if names else ""
        warnings.warn(
            f"the half level is met up to {most} times; widths are between the two places nearest to the peak{where}",
            RuntimeWarning,
            stacklevel=3,
        )


#: Relative errors of plane waves from which on a warning is due: six digits, more than media are known to.
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
