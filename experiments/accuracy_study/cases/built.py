"""Questions built for single terms of the error estimate."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import beamprop as bp

from ..case import Case
from ..reference.real_axis import LAUNCHED, STEPPED
from .numbering import numbers_of
from .slabs import C_AIR


def _built(slab: bp.Slab, beam: object, x: np.ndarray, z: list[float], rtol: float, frequency: float = 2500.0) -> Case:
    return Case("built", "built", slab, beam, frequency, np.asarray(x, float), np.asarray(z, float), rtol)


class Among(NamedTuple):
    """A question built for a term, requested among many angles of the same beam."""

    case: Case
    angles: np.ndarray  #: degree, that of the case's beam among them


def coarse_profiles() -> Iterator[Among]:
    """White noise sampled every third of a wavelength to every wavelength: its spectrum ends in a step.

    At more angles than those for which the contour comes up to the axis at the steps.
    """
    for seed, spacing in enumerate((0.2, 0.33, 0.45, 0.8)):
        rng = np.random.default_rng(seed)
        x = np.arange(40) * spacing * C_AIR / 2500
        beam = bp.Profile(x - x.mean(), rng.normal(size=40) + 1j * rng.normal(size=40), -0.02)
        case = _built(bp.Slab.uniform(bp.AIR, 0.1), beam, np.linspace(beam.x[0], beam.x[-1], 37), [0.0], 1e-6)
        yield Among(case._replace(kind=STEPPED), np.linspace(-10, 10, 21))


def cones() -> Iterator[Case]:
    """Indefinite slabs, through which only what does not propagate in air gets: all of it lies at the end of the source's band."""
    lam = C_AIR / 2500
    for thick, width, first in itertools.product((1, 3, 8), (1.0, 2.0), (1.5, 2.5)):
        fluid = bp.Fluid((-5 + 0.05j) * 1.25, bp.AIR.bulk_modulus, first**2 * 1.25)
        slab = bp.Slab.uniform(fluid, thick * lam)
        yield _built(slab, bp.GaussianBeam(width * lam), np.linspace(-0.2, 0.2, 21), [thick * lam], 1e-6)


FAR = _built(
    bp.Slab.uniform(bp.AIR, 0.1), bp.GaussianBeam(0.7, 60.0, z0=-20.0), np.linspace(-0.1, 0.1, 11), [0.05, 0.1], 1e-9
)
BLACK = _built(
    bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), 60_000),
    bp.GaussianBeam(0.3),
    np.linspace(-0.5, 0.5, 11),
    [0.0, 900.0],
    1e-8,
)


#: The plane of a perfect wall among others: p = 0 there.
WALL = _built(
    bp.Slab.uniform(bp.Fluid(0, bp.AIR.bulk_modulus), 0.1),
    bp.GaussianBeam(0.5, z0=-0.3),
    np.linspace(-0.4, 0.4, 21),
    [-0.2, -0.1, 0.0],
    1e-8,
)
#: A plane in the shadow behind such a wall, where p = 0 exactly.
SHADOW = WALL._replace(z=np.array([-0.2, 0.05]))


#: A slit at many angles, seen through water, where all that is left are plane waves near the normal: there two contours of a high rtol
#: agree to 1e-13, and share the polynomial in sin(angle), whose error is largest at the extreme angles.
MIXED = Among(
    _built(
        bp.Slab.uniform(bp.AIR, 0.05, after=bp.Fluid.from_speed(1000.0, 1480.0)),
        bp.Slits(0.4, 0.8, count=1, angle=15.0),
        np.linspace(-0.5, 0.5, 41),
        [0.12],
        1e-5,
    ),
    np.linspace(-15, 15, 181),
)


#: A tilted profile behind a layer of next to no density, which lets only such plane waves through at which the samples cancel to 1e-7.
_AT = np.linspace(-1.5, 1.5, 201)
CANCELLED = _built(
    bp.Slab.uniform(bp.Fluid(1e-6, 1.47e5), 0.1),
    bp.Profile(_AT, np.exp(-((_AT / 0.3) ** 2)), -0.05, 70.0),
    np.linspace(-0.5, 0.5, 21),
    [0.1],
    1e-12,
    2000.0,
)._replace(kind=STEPPED)


@dataclass(frozen=True, eq=False)
class OwnSource:
    """A user's own source: samples, by the members that every source has and none beside them.

    It does not say what rounding leaves unknown of its spectrum, as `bp.Profile` does.
    """

    samples: bp.Profile
    centre = 0.0
    entire = True

    @property
    def angle(self) -> float:
        return self.samples.angle

    @property
    def z0(self) -> float:
        return self.samples.z0

    def spectrum(self, kx: np.ndarray, k0: float) -> np.ndarray:
        return self.samples.spectrum(kx, k0)

    def profile(self, x: np.ndarray, k0: float) -> np.ndarray:
        return self.samples.profile(x, k0)

    def reach(self, tolerance: float) -> float:
        return self.samples.reach(tolerance)

    def band(self, k0: float, tolerance: float) -> tuple[float, float]:
        return self.samples.band(k0, tolerance)

    def at_angle(self, angle: float) -> OwnSource:
        return OwnSource(self.samples.at_angle(angle))


def tilted_plateaus() -> Iterator[Case]:
    """Flat-topped profiles, 5000 to 7000 wavelengths wide, with a steep tilt, on their launch plane in cold air.

    All contours share k0 sin(angle), which is off by 1.9 units of its last place: the roundings of 2 pi f, of sqrt(rho/K), and of
    the sine go the same way at this frequency and angle. The phases k0 sin(angle) x are off by as much; and on the launch plane
    nothing shows of the second response's last bits. Of a `bp.Profile` the rounding of its samples is a term that covers it; a
    user's own source need not tell it.
    """
    air, frequency = bp.Fluid.from_speed(1.225, 330.0), 3510.0
    for half in (2600, 3400, 3000):
        x = np.linspace(-1.6, 1.6, 161) * half * 330.0 / frequency
        samples = bp.Profile(x, np.exp(-((x / x[-1] * 1.6) ** 8)), 0.0, 78.0)
        slab = bp.Slab.uniform(air, 0.1, before=air, after=air)
        yield _built(slab, OwnSource(samples), samples.x[27:134:3], [0.0], 1e-12, frequency)._replace(kind=LAUNCHED)


def first_numbers(kind: str, count: int) -> tuple[int, ...]:
    """The first `count` cases of a class."""
    return tuple(itertools.islice(numbers_of(kind), count))
