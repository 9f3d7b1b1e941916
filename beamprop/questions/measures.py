"""Question about a beam as a whole: widths by three definitions, place, shift, power, divergence."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.integrate import simpson

from .. import datasets, judge, lines, memory, power, propagate, sections, validate, widths
from ..beam import Beam, moved_to_origin
from ..conventions import outgoing_kz
from ..fan import single
from ..media import FluidValues, Slab
from ..power import NOTHING, Radiated
from ..response import solve
from ..scene import Scene, real_branches, scene
from ..transfers import shifted
from . import checks
from .checks import Progress

#: The window ends where |p| has fallen to this share of its peak; second moments and centroids are taken inside.
TAIL = 0.01
#: So often the window is doubled to get there; guided waves of a lossless slab run along for ever.
DOUBLINGS = 6
#: Samples in a window of the user's choice, over those that the beam's band needs: |p|^2 is cut off at its ends.
FINER = 8
SIDES = ("reflected", "transmitted")
#: Variables that are positions on x.
PLACES = ("centroid", "moments_from", "moments_to")


class Beamlet(NamedTuple):
    """Measures of one outgoing beam at a face; names of the dataset's variables."""

    fwhm: float
    width_1e2: float
    width_second_moment: float
    centroid: float
    lateral_shift: float
    peak: float
    power: float
    divergence: float
    far_angle: float
    crossings: int
    moments_from: float
    moments_to: float
    rim: float


def beam_measures(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    angle: Any = None,
    rtol: float = 1e-6,
    progress: Progress = iter,
    window: float | None = None,
) -> xr.Dataset:
    """The reflected beam at the near face and the transmitted beam at the far face, measured.

    Parameters
    ----------
    slab : Slab
    beam : GaussianBeam, Profile or Slits
    frequency : float or 1-D array, Hz
    angle : float or 1-D array, degree, optional
        Overrides the beam's.
    rtol : float
        Asked error of the fields over their largest |p|.
    progress : function
        Wraps the list of (frequency, angle) pairs that is worked through.
    window : float, optional, m
        Half-width of a window about the geometric ray of each side: everything on x is measured in it, and moments are
        integrals over all of it. For slabs without loss, whose guided waves run along for ever: without them the centroid is
        that of the beam alone, with them it depends on how far one looks. By default the window is widened until |p| falls
        to a hundredth of its peak on both sides.

    Returns
    -------
    Dataset
        On (frequency, angle, side):

        * `fwhm`, `width_1e2` [m]: between the places nearest to the peak where |p| is half, |p|^2 is 1/e^2 of the largest;
        * `width_second_moment` (four standard deviations of |p|^2; 2 a of a Gaussian of 1/e radius a) and `centroid` [m],
          inside the part around the peak where |p| exceeds a hundredth of it, or inside the whole window if one is given or
          |p| does not fall so far;
        * `moments_from`, `moments_to` [m]: the interval over which these were taken, and `rim`, the larger |p| at its ends over
          the peak: a hundredth or less, unless the beam is cut off there;
        * `lateral_shift` [m]: centroid less the geometric ray: for the reflected beam the ray that meets the near face (the
          Goos-Haenchen shift), for the transmitted one the same ray carried straight on to the far face;
        * `peak` [Pa]; `power`: radiated share of the launched power (plane waves that propagate; evanescent and guided
          waves carry none away along z);
        * `divergence` and `far_angle` [degree]: two standard deviations and mean of the direction of the radiated power;
        * `crossings`: how often |p| crosses the half level inside the window; 2 for a plain beam.

    Warns
    -----
    RuntimeWarning
        A level is not reached inside the window, or nothing goes that way (nan); the half level is met more than twice; |p|
        does not fall to a hundredth in the widest window that is tried, and none was given.
    AccuracyWarning
        The estimated error of a beam's |p|, over the largest, or of its power, over that power, is above rtol.
    """
    validate.function(progress, "progress")
    validate.instance(slab, Slab, "slab")
    validate.instance(beam, Beam, "beam")
    f = validate.axis(frequency, "frequency", positive=True)
    angles, rtol = checks.angles(angle, beam), validate.rtol(rtol)
    half = None if window is None else validate.as_number(window, "window", positive=True)
    flat, flat_angles = np.atleast_1d(f), np.atleast_1d(angles)
    memory.check_table(flat.size * flat_angles.size, 280.0)
    table = {name: np.full((flat.size, flat_angles.size, 2), np.nan) for name in Beamlet._fields}
    worst, worst_power = 0.0, 0.0
    source, origin = moved_to_origin(beam)
    for i, j in progress([(i, j) for i in range(flat.size) for j in range(flat_angles.size)]):
        s = scene(slab, float(flat[i]))
        for side, (beamlet, error, of_power) in enumerate(_both(s, source.at_angle(float(flat_angles[j])), rtol, half)):
            worst, worst_power = max(worst, error), max(worst_power, of_power)
            for name, value in beamlet._asdict().items():
                table[name][i, j, side] = value
    for name in PLACES:
        table[name] += origin
    checks.announce(worst, rtol)
    checks.announce(worst_power, rtol, of="a power")
    _announce(table, window is not None)
    dims, pick = checks.dims(frequency=f, angle=angles)
    coords = checks.coords(frequency=f, angle=angles) | {"side": (("side",), list(SIDES))}
    variables = {n: ((*dims, "side"), v[pick]) for n, v in table.items()}
    variables["crossings"] = (variables["crossings"][0], variables["crossings"][1].astype(int))
    return datasets.make(variables, coords, "beam_measures", flat, slab=slab, beam=beam, rtol=rtol, window=half)


def _announce(table: dict[str, np.ndarray], chosen: bool) -> None:
    missing = [name for name, values in table.items() if np.any(np.isnan(values))]
    if missing:
        warnings.warn(
            f"no beam on a side, or a level not reached inside the window: nan in {', '.join(missing)}",
            RuntimeWarning,
            stacklevel=3,
        )
    rim = float(np.max(np.nan_to_num(table["rim"], nan=0.0)))
    if rim > TAIL and not chosen:
        warnings.warn(
            f"|p| falls to {rim:.2g} of its peak only, in the widest window tried: centroid, lateral_shift and second moment "
            "are those of moments_from to moments_to; choose a window",
            RuntimeWarning,
            stacklevel=3,
        )
    most = int(table["crossings"].max())
    if most > 2:
        warnings.warn(
            f"the half level is met up to {most} times; widths are between the two places nearest to the peak",
            RuntimeWarning,
            stacklevel=3,
        )


def _both(s: Scene, beam: Beam, rtol: float, window: float | None) -> list[tuple[Beamlet, float, float]]:
    """The reflected and the transmitted beam, each with the estimated errors of its |p| over the largest, and of its power."""
    lines.check_rays(s, beam, s.thickness - beam.z0, 0.0 if window is None else window)
    slope = math.tan(math.radians(beam.angle))
    ray = beam.centre - beam.z0 * slope
    launched = _power(s, beam, _unchanged, s.before, rtol)
    out = []
    for transfer, place, fluid in (
        (_reflected(s, beam.z0), ray, s.before),
        (_transmitted(s, beam.z0), ray + s.thickness * slope, s.after),
    ):
        out.append(_measure(s, beam, transfer, place, fluid, launched, rtol, window))
    return out


#: kx (n,), shift -> h (n,), at kx (1 + shift) and w (1 - shift): see `transfers`.
Face = Callable[..., np.ndarray]


def _launch(s: Scene, kx: np.ndarray, z0: float) -> np.ndarray:
    return np.exp(-1j * outgoing_kz(kx, s.omega[0], *(v[0] for v in s.before)) * z0)


def _unchanged(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
    return np.ones(kx.shape)


def _reflected(s: Scene, z0: float) -> Face:
    return lambda kx, shift=0.0: _response(shifted(s, shift), kx * (1 + shift), z0, "r")


def _transmitted(s: Scene, z0: float) -> Face:
    return lambda kx, shift=0.0: _response(shifted(s, shift), kx * (1 + shift), z0, "t")


def _response(s: Scene, kx: np.ndarray, z0: float, name: str) -> np.ndarray:
    """r or t of plane waves launched on z0."""
    h: np.ndarray = getattr(solve(s.segments, s.before, s.after, s.omega, kx[None]), name)[0]
    return h * _launch(s, kx, z0)


def _measure(
    s: Scene,
    beam: Beam,
    face: Face,
    ray: float,
    fluid: FluidValues,
    launched: Radiated,
    rtol: float,
    window: float | None,
) -> tuple[Beamlet, float, float]:
    if not _any_beam(s, beam, face):
        return NO_BEAM, 0.0, 0.0
    plane = np.array([s.thickness])

    def transfer(kx: np.ndarray, z: np.ndarray, shift: float = 0.0) -> np.ndarray:
        return np.broadcast_to(face(kx, shift), (z.size, kx.size))  # the beam at its face, whatever z

    for x in _windows(s, beam, ray, window):
        solution = lines.choose_line(s, single(beam), transfer, x, plane, rtol)
        h = face(solution.line.k)[None]
        if window is None and not solution.fft:
            x = sections.needed(s, beam, solution, h, x)
        p = propagate.beam_sum(s, beam, solution, h, x)[0]
        size = np.abs(p)
        if max(size[0], size[-1]) < TAIL * size.max() or size.max() == 0:
            break
    between = propagate.evaluator(s, beam, solution, h)
    full = widths.full_width(x, p, 0.5, between)
    e2 = widths.full_width(x, p, math.exp(-1), between)
    centroid, spread, part = _moments(x, size, window is not None)
    radiated = _power(s, beam, face, fluid, rtol)
    crossings = int(np.count_nonzero(np.diff(size > full.peak / 2)))
    beamlet = Beamlet(
        full.width,
        e2.width,
        4 * spread,
        centroid,
        centroid - ray,
        full.peak,
        radiated.total / launched.total if launched.total > 0 else math.nan,
        2 * radiated.deviation,
        radiated.mean,
        crossings,
        float(x[part][0]),
        float(x[part][-1]),
        float(max(size[part][0], size[part][-1]) / full.peak) if full.peak > 0 else 0.0,
    )
    return beamlet, float(solution.error[0]), radiated.error + launched.error


#: What is said of a side without a beam.
_NAN = math.nan
NO_BEAM = Beamlet(_NAN, _NAN, _NAN, _NAN, _NAN, 0.0, 0.0, _NAN, _NAN, 0, _NAN, _NAN, _NAN)


def _any_beam(s: Scene, beam: Beam, face: Face) -> bool:
    """Whether more than rounding goes that way (a slab of the ambient reflects nothing)."""
    k = np.linspace(-0.999, 0.999, 101) * s.k0 + 0j
    strength = np.abs(beam.spectrum(k, s.k0))
    return bool(np.max(strength * np.abs(face(k))) > 1e-12 * np.max(strength * np.abs(_launch(s, k, beam.z0))))


def _windows(s: Scene, beam: Beam, ray: float, window: float | None) -> Iterator[np.ndarray]:
    """Positions of the window that is asked for, or of wider and wider ones."""
    if window is not None:
        yield ray + window * np.linspace(-1, 1, FINER * (_samples(s, beam, window) - 1) + 1)
        return
    half = 1.5 * beam.reach(TAIL) + 4 * np.pi / s.k0 + abs(ray - beam.centre)
    for _ in range(DOUBLINGS + 1):
        yield beam.centre + half * np.linspace(-1, 1, _samples(s, beam, half))
        half *= 2


def _samples(s: Scene, beam: Beam, half: float) -> int:
    finest = max(abs(k) for k in beam.band(s.k0, 1e-3))
    return 2 * int(min(max(64, math.ceil(2 * half * finest / np.pi)), 40_000)) + 1


def _moments(x: np.ndarray, size: np.ndarray, whole: bool) -> tuple[float, float, slice]:
    """Centroid and standard deviation of |p|^2, and where they are taken.

    That is where |p| is connected to the peak above the tail, or the `whole` window if asked for or if the tail is cut off.
    """
    top = int(np.argmax(size))
    below = np.flatnonzero(size < TAIL * size[top])
    left, right = below[below < top], below[below > top]
    part = slice(None) if whole or left.size == 0 or right.size == 0 else slice(left[-1], right[0] + 1)
    x, weight = x[part], size[part] ** 2
    integral = simpson if whole else np.trapezoid  # samples of a beam that ends inside are best summed alike
    total = integral(weight, x=x)
    if not total > 0:
        return math.nan, math.nan, part
    centre = integral(weight * x, x=x) / total
    return float(centre), float(np.sqrt(integral(weight * (x - centre) ** 2, x=x) / total)), part


def _far_k(s: Scene, fluid: FluidValues) -> float:
    """Wavenumber of the propagating waves of a half-space, 0 if it has none."""
    k = complex(s.omega[0, 0] * np.sqrt(fluid.rho_x[0] / fluid.bulk_modulus[0]))
    return abs(k.real) if np.isfinite(k) else 0.0


def _power(s: Scene, beam: Beam, face: Face, fluid: FluidValues, rtol: float) -> Radiated:
    """What S h radiates into a half-space, but for a constant."""
    k = _far_k(s, fluid)
    if k == 0:
        return NOTHING

    def density(kx: np.ndarray, shift: float = 0.0) -> np.ndarray:
        kx = kx.astype(complex)
        kz = outgoing_kz(kx, s.omega[0], *(v[0] for v in fluid)).real
        h = face(kx, shift)
        right, left = (np.abs(beam.spectrum(sign * kx, s.k0)) ** 2 * kz / fluid.rho_z[0].real for sign in (1, -1))
        return np.stack([np.abs(h) ** 2 * right, np.abs(h) ** 2 * left, h * (right + left)])

    count = 200 + 2 * k * (beam.reach(1e-6) + s.thickness - beam.z0)
    return power.radiated(density, lambda kx: density(kx, judge.SHIFT), k, real_branches(s), count, rtol)
