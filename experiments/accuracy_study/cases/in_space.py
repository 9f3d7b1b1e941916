"""Questions in three dimensions: slab, source, grid and planes drawn by number, the same on every machine."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import beamprop as bp

from ..case import SpaceCase
from .first import draw_angle, draw_planes
from .slabs import C_AIR, SLABS, WATER, fluid_like_air, log_uniform, random_loss

SEED = 20250301
Rng = np.random.Generator
#: Planes of a volume beside a case's own: from 200 on, and 64 positions, it is made from planes of low rank.
VOLUME = 200


def _different_layers(rng: Rng, lam: float) -> bp.Slab:
    """450 layers, no two alike."""
    layers = []
    for _ in range(450):
        fluid = fluid_like_air(rng, log_uniform(rng, 0.3, 3), log_uniform(rng, 0.5, 3), random_loss(rng) / 30)
        layers.append(bp.Layer(fluid, lam * log_uniform(rng, 0.002, 0.03)))
    return bp.Slab(layers, 1)


def _water_to_air(rng: Rng, lam: float) -> bp.Slab:
    """A plate or nothing between water and air, of wavelengths in water."""
    if rng.random() < 0.3:
        return bp.Slab.uniform(WATER, 4.3 * lam * log_uniform(rng, 0.05, 2), before=WATER, after=bp.AIR)
    fluid = bp.Fluid.from_speed(1000.0 * log_uniform(rng, 0.5, 8), 1480.0 * log_uniform(rng, 0.5, 4))
    return bp.Slab.uniform(fluid, 4.3 * lam * log_uniform(rng, 0.05, 2), before=WATER, after=bp.AIR)


def _solid_plates(rng: Rng, lam: float) -> bp.Slab:
    """One to three solids in contact in water."""
    layers = []
    for _ in range(rng.integers(1, 4)):
        c_l = 1480.0 * log_uniform(rng, 1.2, 4)
        solid = bp.Solid(1000.0 * log_uniform(rng, 1, 8), c_l * (1 - 0.01j), c_l * rng.uniform(0.3, 0.6) * (1 - 0.01j))
        layers.append(bp.Layer(solid, 4.3 * lam * log_uniform(rng, 0.05, 1)))
    return bp.Slab(layers, 1, background=WATER)


def _any(rng: Rng, lam: float) -> bp.Slab:
    """A slab of the first classes."""
    return draw_slab(rng, str(rng.choice(list(FIRST))), lam)


#: All classes of slabs of the study in two dimensions but those that are refused by name in three.
FIRST = {kind: draw for kind, draw in SLABS.items() if kind != "density_x infinite"}
#: Classes of slabs, and two of beams: 20 wavelengths wide ones, and windows 300 wavelengths beside the source.
WIDE, FAR, SOLID = "20 wavelengths wide", "300 wavelengths off axis", "solid plates"
CLASSES: dict[str, Callable[[Rng, float], bp.Slab]] = FIRST | {
    "450 different layers": _different_layers,
    "water | air": _water_to_air,
    SOLID: _solid_plates,
    WIDE: _any,
    FAR: _any,
}
KINDS = list(CLASSES)
#: Widths of their beams over the wavelength, where they are not 0.3 to 10: lattices of narrower ones would be too large so far out.
SIZES = {WIDE: (15, 25), FAR: (1, 10)}


def _has_direction(slab: bp.Slab) -> bool:
    """Whether a density along x differs."""
    fluids: list[Any] = [layer.fluid for cell, _ in slab.segments for layer in cell.layers]
    return any(getattr(fluid, "density_x", None) is not None for fluid in fluids)


def draw_slab(rng: Rng, kind: str, lam: float) -> bp.Slab:
    """One without a density along x of its own."""
    while _has_direction(slab := CLASSES[kind](rng, lam)):
        pass
    return slab


class Drawn(NamedTuple):
    """A source, its half widths along x and y about its middle, and the plane behind which it is asked."""

    beam: Any
    widths: tuple[float, float]
    middle: tuple[float, float]
    plane: float
    sharp: bool


def draw_beam(rng: Rng, kind: str, lam: float) -> Drawn:
    """Circular, or elliptical up to one to four; 0.3 to 10 wavelengths wide, and circular in the classes of beams."""
    z0 = -lam * float(rng.choice([0.0, log_uniform(rng, 0.01, 20)], p=[0.4, 0.6]))
    width = lam * log_uniform(rng, *SIZES.get(kind, (0.3, 10)))
    ratio = float(rng.choice([1.0, log_uniform(rng, 0.25, 4)], p=[0.4, 0.6])) if kind not in (WIDE, FAR) else 1.0
    fwhm = width if ratio == 1.0 and rng.random() < 0.5 else (width, ratio * width)
    x0, y0 = (float(rng.choice([0.0, rng.normal() * width])) for _ in range(2))
    azimuth = float(rng.choice([0.0, rng.uniform(-180, 360), 90.0], p=[0.2, 0.7, 0.1]))
    beam = bp.GaussianBeam(fwhm, draw_angle(rng), x0, z0, azimuth=azimuth, y0=y0)
    return Drawn(beam, (width, ratio * width), (x0, y0), z0, False)


def draw_transducer(rng: Rng, lam: float) -> Drawn:
    """A piston in either baffle, a bowl, or up to four of either with weights of their own."""
    gap = lam * log_uniform(rng, 0.1, 20)
    x0, y0 = (float(rng.choice([0.0, rng.normal() * lam])) for _ in range(2))
    radius, pressure = lam * log_uniform(rng, 0.3, 5), complex(rng.normal(), rng.normal())
    element: Any = bp.Piston(radius, str(rng.choice(["rigid", "soft"])), pressure, z0=-gap)
    if rng.random() < 0.4:
        curvature = radius / rng.uniform(0.1, 1)
        depth = bp.Bowl(curvature, 2 * radius, z0=-10 * curvature).depth
        element = bp.Bowl(curvature, 2 * radius, pressure, z0=-gap - depth)
    count = int(rng.choice([1, rng.integers(2, 5)], p=[0.7, 0.3]))
    if count > 1:
        positions = 3 * radius * rng.uniform(-1, 1, (count, 2))
        beam = bp.Array(positions, element, rng.normal(size=count) + 1j * rng.normal(size=count))
        return Drawn(beam, (4 * radius, 4 * radius), (0.0, 0.0), -gap, True)
    beam = element.__class__(**{**element.__dict__, "x0": x0, "y0": y0})
    return Drawn(beam, (2 * radius, 2 * radius), (x0, y0), -gap, True)


def draw_positions(rng: Rng, width: float, middle: float, most: int) -> np.ndarray:
    """Even or uneven, about the beam or beside it; one position for a cut."""
    middle += float(rng.choice([0.0, rng.uniform(-1, 1) * 2 * width]))
    if rng.random() < 0.3:
        return np.array([middle])
    span, count = width * log_uniform(rng, 0.3, 8), int(rng.integers(2, most))
    return middle + span * (
        np.linspace(-0.5, 0.5, count) if rng.random() < 0.6 else np.sort(rng.uniform(-0.5, 0.5, count))
    )


class _Launch(NamedTuple):
    """A launch plane, for `draw_planes`."""

    z0: float


def space_case(number: int) -> SpaceCase:
    """Case `number`."""
    rng = np.random.default_rng([SEED, number])
    kind = KINDS[number % len(KINDS)]
    frequency = float(rng.uniform(500, 5000))
    lam = C_AIR / frequency
    slab = draw_slab(rng, kind, lam)
    if slab.before is WATER:
        lam = 1480.0 / frequency
    transducer = kind not in (WIDE, FAR) and rng.random() < 0.25
    drawn = draw_transducer(rng, lam) if transducer else draw_beam(rng, kind, lam)
    x, y = (
        draw_positions(rng, width, middle, most)
        for width, middle, most in zip(drawn.widths, drawn.middle, (9, 7), strict=True)
    )
    if kind == FAR:
        x = x + 300 * lam * float(rng.choice([-1, 1]))
    source = "Slits" if drawn.sharp else "Gaussian, launch"
    z = draw_planes(rng, _Launch(drawn.plane), slab.thickness, lam, source)[:4]
    if kind == SOLID:  # the truth knows p in fluids alone
        z = np.unique(np.where((z > 0) & (z < slab.thickness), slab.thickness + 0.1 * lam, z))
    return SpaceCase(kind, slab, drawn.beam, frequency, x, y, z, float(10 ** rng.uniform(-11, -3)))


def requested(number: int, case: SpaceCase) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, y and z that are requested; for one case in five a volume of many planes, the case's own among them."""
    if number % 5 != 1:
        return case.x, case.y, case.z
    rng = np.random.default_rng([SEED, number, 1])
    x, y = (np.union1d(v, v.mean() + max(float(np.ptp(v)), 1e-3) * np.linspace(-0.5, 0.5, 9)) for v in (case.x, case.y))
    return x, y, np.union1d(case.z, rng.uniform(case.z.min(), case.z.max(), VOLUME))
