"""The first fifteen classes of questions: beam, grid and planes drawn by number, the same on every machine."""

from __future__ import annotations

from typing import Any

import numpy as np

import beamprop as bp

from ..case import Case
from ..reference.source import Source
from .slabs import C_AIR, SLABS, WATER, log_uniform

SEED = 20240607
#: Cases of the first fifteen classes: their numbers are 0 ... FIRST - 1.
FIRST = 2200
SOURCES = ("Gaussian, launch", "Gaussian, rotated", "Profile", "Slits")


# --- beams and grids --------------------------------------------------------------------------------------


def draw_angle(rng: np.random.Generator) -> float:
    return float(
        rng.choice([0.0, rng.uniform(-89.9, 89.9), rng.uniform(80, 89.9), 30.0, -89.9], p=[0.25, 0.5, 0.1, 0.1, 0.05])
    )


def draw_beam(rng: np.random.Generator, source: str, lam: float) -> Any:
    z0 = -lam * float(rng.choice([0.0, log_uniform(rng, 0.01, 50)], p=[0.4, 0.6]))
    fwhm = lam * log_uniform(rng, 0.2, 200)
    x0 = float(rng.choice([0.0, rng.normal() * fwhm]))
    if source == "Gaussian, launch":
        return bp.GaussianBeam(fwhm, draw_angle(rng), x0, z0)
    if source == "Gaussian, rotated":
        return bp.GaussianBeam(fwhm, draw_angle(rng), x0, z0, form="rotated")
    if source == "Slits":
        width = lam * log_uniform(rng, 0.05, 5)
        return bp.Slits(
            width,
            width * rng.uniform(1.1, 5),
            int(rng.integers(1, 4)),
            -lam * log_uniform(rng, 0.05, 20),
            float(rng.uniform(-60, 60)),
        )
    radius = lam * log_uniform(rng, 0.3, 20)
    x = x0 + np.linspace(-6.5, 6.5, int(rng.integers(90, 300))) * radius
    p = np.exp(-(((x - x0) / radius) ** 2)).astype(complex)
    if rng.random() < 0.6:
        u = (x - x0) / radius
        p *= sum((rng.normal() + 1j * rng.normal()) * np.exp(1j * rng.uniform(-3, 3) * u) for _ in range(4))
    return bp.Profile(x, p, z0, float(rng.choice([0.0, rng.uniform(-60, 60)])))


def draw_grid(rng: np.random.Generator, beam: Any, lam: float) -> np.ndarray:
    size = 2 * beam.reach(0.5)
    span = float(np.clip(size * log_uniform(rng, 0.1, 20), 0.1 * lam, 400 * lam))
    count = int(rng.integers(5, 41))
    middle = beam.centre + float(rng.choice([0.0, rng.uniform(-1, 1) * span]))
    kind = rng.choice(["even", "fine", "uneven", "one"], p=[0.5, 0.15, 0.3, 0.05])
    if kind == "one":
        return np.array([middle])
    if kind == "fine":  # many points: FFTs become the cheaper way
        return middle + span * np.linspace(-0.5, 0.5, int(rng.choice([401, 1000, 2048])))
    return middle + span * (np.linspace(-0.5, 0.5, count) if kind == "even" else np.sort(rng.uniform(-0.5, 0.5, count)))


def draw_planes(rng: np.random.Generator, beam: Any, thickness: float, lam: float, source: str) -> np.ndarray:
    front = beam.z0 * rng.uniform(0, 0.9 if source == "Slits" else 1, 2)
    inside = thickness * rng.uniform(0, 1, 2)
    behind = thickness + lam * np.array([0.0, log_uniform(rng, 0.01, 50)])
    every = np.concatenate([front, inside, behind])
    return np.sort(rng.choice(every, int(rng.integers(3, 7)), replace=False))


def first_case(number: int) -> Case:
    """Case `number` of the first fifteen classes."""
    rng = np.random.default_rng([SEED, number])
    kind = list(SLABS)[number % len(SLABS)]
    source = str(rng.choice(SOURCES, p=[0.7, 0.1, 0.12, 0.08]))
    frequency = rng.uniform(500, 5000)
    lam = C_AIR / frequency
    medium = SLABS[kind](rng, lam)
    if medium.before is WATER:
        lam = 1480.0 / frequency
    while True:  # the truth must stay cheap: modes go as band times extent
        beam = draw_beam(rng, source, lam)
        x = draw_grid(rng, beam, lam)
        extent = max(np.abs(x - beam.centre).max(), beam.reach(1e-12))
        if Source(beam, 2 * np.pi / lam).band(1e-12) * extent < 3e4 or source == "Slits":
            break
    z = draw_planes(rng, beam, medium.thickness, lam, source)
    return Case(kind, source, medium, beam, float(frequency), x, z, float(10 ** rng.uniform(-11, -3)))
