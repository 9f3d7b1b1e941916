"""Questions in three dimensions: slab, beam, grid and planes drawn by number, the same on every machine."""

from __future__ import annotations

import numpy as np

import beamprop as bp

from ..case import SpaceCase
from .first import draw_angle, draw_planes
from .slabs import C_AIR, SLABS, WATER, log_uniform

SEED = 20250301
#: All classes of slabs but those that are refused by name in three dimensions.
KINDS = [kind for kind in SLABS if kind != "density_x infinite"]


def _has_direction(slab: bp.Slab) -> bool:
    """Whether a density along x differs."""
    return any(layer.fluid.density_x is not None for cell, _ in slab.segments for layer in cell.layers)


def draw_slab(rng: np.random.Generator, kind: str, lam: float) -> bp.Slab:
    """One without a density along x of its own."""
    while _has_direction(slab := SLABS[kind](rng, lam)):
        pass
    return slab


def draw_beam(rng: np.random.Generator, lam: float) -> bp.GaussianBeam:
    """Circular, or elliptical up to one to four; 0.3 to 10 wavelengths wide."""
    z0 = -lam * float(rng.choice([0.0, log_uniform(rng, 0.01, 20)], p=[0.4, 0.6]))
    width = lam * log_uniform(rng, 0.3, 10)
    ratio = float(rng.choice([1.0, log_uniform(rng, 0.25, 4)], p=[0.4, 0.6]))
    fwhm = width if ratio == 1.0 and rng.random() < 0.5 else (width, ratio * width)
    x0, y0 = (float(rng.choice([0.0, rng.normal() * width])) for _ in range(2))
    azimuth = float(rng.choice([0.0, rng.uniform(-180, 360), 90.0], p=[0.2, 0.7, 0.1]))
    return bp.GaussianBeam(fwhm, draw_angle(rng), x0, z0, azimuth=azimuth, y0=y0)


def draw_positions(rng: np.random.Generator, width: float, middle: float, most: int) -> np.ndarray:
    """Even or uneven, about the beam or beside it; one position for a cut."""
    middle += float(rng.choice([0.0, rng.uniform(-1, 1) * 2 * width]))
    if rng.random() < 0.3:
        return np.array([middle])
    span, count = width * log_uniform(rng, 0.3, 8), int(rng.integers(2, most))
    return middle + span * (
        np.linspace(-0.5, 0.5, count) if rng.random() < 0.6 else np.sort(rng.uniform(-0.5, 0.5, count))
    )


def space_case(number: int) -> SpaceCase:
    """Case `number`."""
    rng = np.random.default_rng([SEED, number])
    kind = KINDS[number % len(KINDS)]
    frequency = float(rng.uniform(500, 5000))
    lam = C_AIR / frequency
    slab = draw_slab(rng, kind, lam)
    if slab.before is WATER:
        lam = 1480.0 / frequency
    beam = draw_beam(rng, lam)
    widths = beam.fwhm if isinstance(beam.fwhm, tuple) else (beam.fwhm, beam.fwhm)
    x, y = draw_positions(rng, widths[0], beam.x0, 9), draw_positions(rng, widths[1], beam.y0, 7)
    z = draw_planes(rng, beam, slab.thickness, lam, "Gaussian, launch")[:4]
    return SpaceCase(kind, slab, beam, frequency, x, y, z, float(10 ** rng.uniform(-11, -3)))
