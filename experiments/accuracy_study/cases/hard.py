"""The classes of hard questions: each draws slab, beam, grid and planes of its own."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import beamprop as bp

from ..case import Case
from ..reference.source import Source
from .first import SEED, SOURCES, draw_beam, draw_grid, draw_planes
from .slabs import C_AIR, RHO_AIR, SLABS, WATER, fluid_like_air, log_uniform, modulated_cell, random_loss

Rng = np.random.Generator
STEEL = bp.Fluid.from_speed(7800.0, 5900.0)
MIXED = (0.7, 0.1, 0.12, 0.08)  # how often each of SOURCES
ENTIRE = (0.8, 0.0, 0.12, 0.08)


def rounded(x: np.ndarray, digits: int) -> np.ndarray:
    """Positions as printed: to so many significant digits of their span."""
    span = float(np.ptp(x)) or 1.0
    return np.unique(np.round(x, digits - 1 - math.floor(math.log10(span))))


def user_grid(rng: Rng, beam: Any, lam: float) -> np.ndarray:
    """x as users ask for them: the first classes' grids, some of them printed and read again, some begun at the middle."""
    x = draw_grid(rng, beam, lam)
    kind = rng.choice(["as drawn", "printed", "one side", "denser in the middle"], p=[0.5, 0.25, 0.15, 0.1])
    if kind == "printed":
        return rounded(x, int(rng.integers(4, 13)))
    if kind == "one side":
        return x - x[0] + beam.centre
    if kind == "denser in the middle" and x.size > 1:
        half = np.ptp(x) / 2
        return x.mean() + half * np.linspace(-1, 1, x.size) ** 3
    return x


def user_planes(rng: Rng, beam: Any, thickness: float, lam: float, source: str) -> np.ndarray:
    """z as users ask for them: some of the first classes', one, or an even row from the launch plane to behind the slab."""
    z = draw_planes(rng, beam, thickness, lam, source)
    kind = rng.choice(["some", "one", "row"], p=[0.6, 0.15, 0.25])
    if kind == "one":
        return z[[rng.integers(z.size)]]
    if kind == "row":
        front = beam.z0 * (0.9 if source == "Slits" else 1.0)
        return np.linspace(front, thickness + lam * log_uniform(rng, 0.1, 5), int(rng.integers(8, 31)))
    return z


def question(rng: Rng, kind: str, slab: bp.Slab, frequency: float, chances: tuple[float, ...] = MIXED) -> Case:
    """A case with a beam, grid and planes of any kind, of which the truth is cheap."""
    source = str(rng.choice(SOURCES, p=chances))
    lam = abs(slab.before.wavenumber(frequency).real)
    lam = 2 * np.pi / float(lam)
    while True:
        beam = draw_beam(rng, source, lam)
        x = user_grid(rng, beam, lam)
        extent = max(np.abs(x - beam.centre).max(), beam.reach(1e-12))
        if source == "Slits" or Source(beam, 2 * np.pi / lam).band(1e-12) * extent < 1.5e4:
            break
    z = user_planes(rng, beam, slab.thickness, lam, source)
    return Case(kind, source, slab, beam, float(frequency), x, z, draw_rtol(rng))


def brought_near(rng: Rng, case: Case, lam: float) -> Case:
    """Half of the cases with a narrow Gaussian close to the slab, whose evanescent waves meet the guided modes."""
    if case.source != "Gaussian, launch" or rng.random() < 0.4:
        return case
    z0 = -lam * float(rng.choice([0.0, log_uniform(rng, 0.005, 0.3)], p=[0.4, 0.6]))
    beam = bp.GaussianBeam(lam * log_uniform(rng, 0.1, 2), float(rng.uniform(-80, 80)), case.beam.x0, z0)
    x = user_grid(rng, beam, lam)
    return case._replace(beam=beam, x=x, z=user_planes(rng, beam, case.slab.thickness, lam, case.source))


def draw_rtol(rng: Rng) -> float:
    """From 1e-11 to 1e-3, by decade."""
    return float(10 ** rng.uniform(-11, -3))


def draw_frequency(rng: Rng) -> tuple[float, float]:
    """A frequency and its wavelength in air."""
    f = float(rng.uniform(500, 5000))
    return f, C_AIR / f


def _layers(rng: Rng, lam: float, most: int = 3, lossy: float = 0.3) -> list[bp.Layer]:
    """One to `most` ordinary layers."""
    layers = []
    for _ in range(rng.integers(1, most + 1)):
        loss = log_uniform(rng, 1e-4, 0.1) if rng.random() < lossy else 0.0
        fluid = fluid_like_air(rng, log_uniform(rng, 0.1, 10), log_uniform(rng, 0.2, 10), loss)
        layers.append(bp.Layer(fluid, lam * log_uniform(rng, 0.02, 1.5)))
    return layers


# --- negative media ---------------------------------------------------------------------------------------


def _half_space_backward(rng: Rng, kind: str) -> Case:
    """A half-space behind of negative density or modulus, with ordinary layers in front, which it makes guide backward waves."""
    f, lam = draw_frequency(rng)
    rho, K = log_uniform(rng, 0.2, 5), log_uniform(rng, 0.3, 3)
    rho, K = (-rho, K) if rng.random() < 0.7 else (rho, -K)
    layers = _layers(rng, lam)
    if (
        rng.random() < 0.6
    ):  # heavier than air, behind a thin layer that is heavier still: their face guides a backward wave
        rho, K = -log_uniform(rng, 1.1, 5), log_uniform(rng, 0.3, 3)
        heavy = fluid_like_air(rng, -rho * rng.uniform(1.02, 2), log_uniform(rng, 0.3, 10))
        layers = [bp.Layer(heavy, lam * log_uniform(rng, 0.004, 0.06))]
    loss = 0.0 if rng.random() < 0.5 else log_uniform(rng, 1e-5, 1e-2)
    of_density, of_modulus = ((1, 0), (0, 1), (1, 1))[rng.integers(3)]
    after = bp.Fluid(
        RHO_AIR * (rho + 1j * loss * of_density * abs(rho)),
        bp.AIR.bulk_modulus * (K - 1j * loss * of_modulus * abs(K)),
    )
    return brought_near(rng, question(rng, kind, bp.Slab(layers, 1, after=after), f, ENTIRE), lam)


def _before_density_zero(rng: Rng, kind: str) -> Case:
    """A negative layer in front of a layer of density exactly 0: a soft wall for every kx but 0."""
    f, lam = draw_frequency(rng)
    rho, K = -log_uniform(rng, 0.1, 5), log_uniform(rng, 0.2, 5)
    rho, K = (rho, K) if rng.random() < 0.7 else (-rho, -K)
    negative = bp.Layer(fluid_like_air(rng, rho, K, random_loss(rng)), lam * log_uniform(rng, 0.02, 0.5))
    if rng.random() < 0.5:  # thin and light: it guides a backward wave
        fluid = fluid_like_air(rng, -rng.uniform(0.2, 1.0), log_uniform(rng, 0.5, 3), 0.0)
        negative = bp.Layer(fluid, lam * log_uniform(rng, 0.01, 0.15))
    zero = bp.Layer(bp.Fluid(0.0, bp.AIR.bulk_modulus * log_uniform(rng, 0.2, 5)), lam * log_uniform(rng, 0.02, 1))
    front = _layers(rng, lam, 2) if rng.random() < 0.5 else []
    between = _layers(rng, lam, 1) if rng.random() < 0.3 else []
    behind = _layers(rng, lam, 2) if rng.random() < 0.4 else []
    case = brought_near(rng, question(rng, kind, bp.Slab([*front, negative, *between, zero, *behind], 1), f), lam)
    wall = sum(y.thickness for y in [*front, negative, *between])
    more = [wall] * int(rng.random() < 0.3) + [wall * rng.uniform(0, 1)]
    return case._replace(z=np.union1d(case.z, more))


# --- resonances and mirrors -------------------------------------------------------------------------------


def _sharp_resonances(rng: Rng, kind: str) -> Case:
    """Cavities between quarter-wave mirrors of steel or water and air, at resonance at normal incidence and just beside it."""
    f, _ = draw_frequency(rng)
    heavy = STEEL if rng.random() < 0.5 else WATER
    quarter = {m: float(m.wavenumber(f).real) for m in (heavy, bp.AIR)}
    quarter = {m: math.pi / 2 / k for m, k in quarter.items()}
    mirror = [bp.Layer(heavy, quarter[heavy])]
    for _ in range(int(rng.choice([0, 1, 2, 3], p=[0.4, 0.3, 0.2, 0.1]))):
        mirror += [bp.Layer(bp.AIR, quarter[bp.AIR]), bp.Layer(heavy, quarter[heavy])]
    cavity = bp.Layer(bp.AIR, 2 * quarter[bp.AIR] * int(rng.integers(1, 4)))
    if rng.random() < 0.15:
        layers = [bp.Layer(heavy, 2 * quarter[heavy] * int(rng.integers(1, 4)))]  # a plate of half waves
    else:
        layers = [*mirror, cavity, *mirror[::-1]]
    apart = 0.0 if rng.random() < 0.35 else rng.choice([-1, 1]) * log_uniform(rng, 1e-12, 1e-5)
    case = question(rng, kind, bp.Slab(layers, 1), f * (1 + apart), ENTIRE)
    if rng.random() < 0.5 and case.source == "Gaussian, launch":  # most of a wide beam goes straight on
        case = case._replace(beam=case.beam.at_angle(0.0))
    return case


def _band_edge(rng: Rng, kind: str) -> Case:
    """Planes in and behind an opaque periodic mirror near an edge of its stop band."""
    f, lam = draw_frequency(rng)
    contrast = log_uniform(rng, 1.5, 10)
    loss = random_loss(rng) * 1e-2
    hard = fluid_like_air(rng, contrast, 1 / contrast if rng.random() < 0.5 else 1.0, loss)
    cell = [bp.Layer(bp.AIR, lam / 4), bp.Layer(hard, math.pi / 2 / float(hard.wavenumber(f).real))]
    impedance = math.sqrt(abs(complex(hard.density) * complex(hard.bulk_modulus))) / (RHO_AIR * C_AIR)  # type: ignore
    half = (
        2 / math.pi * math.asin(abs(impedance - 1) / (impedance + 1))
    )  # half the width of the stop band, over its middle
    side = rng.choice([-1, 1])
    beside = side * half * (1 - rng.choice([1, 1, -0.3]) * log_uniform(rng, 1e-5, 0.1))
    case = question(rng, kind, bp.Slab(cell, int(log_uniform(rng, 10, 400))), f * (1 + beside), (0.75, 0.1, 0.15, 0.0))
    if rng.random() < 0.5 and case.source == "Gaussian, launch":
        case = case._replace(beam=case.beam.at_angle(0.0))
    behind = case.slab.thickness + lam * np.array([0.0, log_uniform(rng, 0.01, 50)])
    return case._replace(z=np.union1d(case.z, behind[: rng.integers(1, 3)]))


def _dark_planes(rng: Rng, kind: str) -> Case:
    """Planes at and beside the nodes of the standing wave in front of a hard or soft wall, and the wall's own plane."""
    f, lam = draw_frequency(rng)
    hard = bool(rng.random() < 0.5)
    if hard:
        density = rng.choice([7800.0, RHO_AIR * log_uniform(rng, 1e4, 1e12)])
        wall = STEEL if density == 7800.0 else bp.Fluid.from_speed(density, C_AIR * log_uniform(rng, 0.3, 20))
    else:
        density = rng.choice([0.0, RHO_AIR * log_uniform(rng, 1e-9, 1e-3)])
        wall = bp.Fluid(density, bp.AIR.bulk_modulus * log_uniform(rng, 0.1, 10))
    gap = lam * rng.uniform(0.3, 4)
    slab = bp.Slab([bp.Layer(bp.AIR, gap), bp.Layer(wall, lam * rng.uniform(0.1, 2))], 1)
    case = question(rng, kind, slab, f)
    if case.source == "Gaussian, launch":
        angle = 0.0 if rng.random() < 0.6 else float(rng.uniform(0, 60))
        case = case._replace(beam=bp.GaussianBeam(lam * log_uniform(rng, 2, 100), angle, case.beam.x0, case.beam.z0))
        case = case._replace(x=user_grid(rng, case.beam, lam))
    between = lam / 2 / math.cos(math.radians(case.beam.angle))
    count = int(rng.integers(12, 41))
    node = (rng.integers(0, 9, count) + (0.5 if hard else 0.0)) * between
    offset = rng.choice([-1, 1], count) * lam * np.exp(rng.uniform(np.log(1e-14), np.log(0.1), count))
    z = gap - node + np.where(rng.random(count) < 0.15, 0.0, offset)
    z = np.append(z[(z >= case.beam.z0) & (z <= gap)], [gap] * int(rng.random() < 0.6) + [gap - lam / 8])
    return case._replace(z=np.unique(z))


# --- grids and origins ------------------------------------------------------------------------------------

EASY = ("air alone", "LMMD, lossy", "uniform fluid", "negative density or modulus", "density_x infinite", "stack")


def _printed(rng: Rng, kind: str) -> Case:
    """An even grid that has been printed: to 9 to 12 digits of its span."""
    f, lam = draw_frequency(rng)
    case = question(rng, kind, SLABS[str(rng.choice(EASY))](rng, lam), f)
    half = max(case.beam.reach(0.5) * log_uniform(rng, 0.5, 10), 0.5 * lam)
    half = min(half, 300 * lam)
    middle = case.beam.centre + rng.choice([0.0, rng.uniform(-1, 1) * half])
    count = int(rng.choice([41, 101, 401, 1000, 1024, 2048, 4096]))
    x = middle + half * np.linspace(-1, 1, count)
    if (
        isinstance(case.beam, bp.GaussianBeam) and rng.random() < 0.4
    ):  # beside x = 0: positions are large beside their span
        away = float(rng.uniform(1, 50))
        beam = case.beam
        beam = bp.GaussianBeam(beam.fwhm, beam.angle, beam.x0 + away, beam.z0, form=beam.form)
        case, x = case._replace(beam=beam), x + away
    digits = int(rng.choice([9, 10, 11, 12], p=[0.15, 0.15, 0.3, 0.4]))
    rtol = case.rtol if rng.random() < 0.3 else float(10 ** rng.uniform(-11, -8))
    return case._replace(x=rounded(x, digits), rtol=rtol)


def _long(rng: Rng, kind: str) -> Case:
    """Grids of 2^14 to 2^20 points."""
    f, lam = draw_frequency(rng)
    while True:
        case = question(rng, kind, SLABS[str(rng.choice(EASY))](rng, lam), f)
        half = lam * log_uniform(rng, 10, 1000)
        if Source(case.beam, 2 * np.pi / lam).band(1e-12) * half < 3e4 and case.source != "Slits":
            break
    exponent = 14 + 6 * rng.random() ** 2.5  # a million points take seconds
    count = int(2**exponent) if rng.random() < 0.5 else 2 ** round(exponent)
    x = case.beam.centre + rng.choice([0.0, rng.uniform(-0.5, 0.5) * half]) + half * np.linspace(-1, 1, count)
    if rng.random() < 0.3:
        x = rounded(x, int(rng.integers(10, 13)))
    return case._replace(x=x, z=case.z[rng.integers(case.z.size, size=1)])


def _far(rng: Rng, kind: str) -> Case:
    """Beams and grids 60 m to 100 km from x = 0."""
    f, lam = draw_frequency(rng)
    case = question(rng, kind, SLABS[str(rng.choice(EASY))](rng, lam), f, (0.7, 0.1, 0.2, 0.0))
    away = float(rng.choice([-1, 1]) * log_uniform(rng, 60, 1e5))
    away = float(round(away)) if rng.random() < 0.5 else away
    beam = case.beam
    if isinstance(beam, bp.Profile):
        beam = bp.Profile(beam.x + away, beam.p, beam.z0, beam.angle)
    else:
        beam = bp.GaussianBeam(beam.fwhm, beam.angle, beam.x0 + away, beam.z0, form=beam.form)
    return case._replace(beam=beam, x=np.unique(case.x + away))


# --- half-spaces and beams at the edge --------------------------------------------------------------------


def _nearly_rigid(rng: Rng, kind: str) -> Case:
    """A half-space behind that is nearly rigid, or whose speed is huge."""
    f, lam = draw_frequency(rng)
    if rng.random() < 0.5:
        density, speed = RHO_AIR * log_uniform(rng, 1e3, 1e12), C_AIR * log_uniform(rng, 0.3, 30)
    else:
        density, speed = RHO_AIR * log_uniform(rng, 0.3, 1e4), log_uniform(rng, 1e4, 1e9)
    after = bp.Fluid.from_speed(density, speed)
    return question(rng, kind, bp.Slab(_layers(rng, lam), 1, after=after), f, ENTIRE)


def _very_wide(rng: Rng, kind: str) -> Case:
    """Gaussians 2000 to 20 000 wavelengths wide, in air and through slabs."""
    f, lam = draw_frequency(rng)
    width, z0 = lam * log_uniform(rng, 2000, 20_000), -lam * float(rng.choice([0.0, log_uniform(rng, 1, 1000)]))
    angle = float(rng.choice([0.0, 30.0, 45.0, 60.0, rng.uniform(-60, 60)], p=[0.2, 0.1, 0.2, 0.1, 0.4]))
    name = str(rng.choice(["air alone", "LMMD, lossy", "uniform fluid", "density_x infinite"]))
    slab = SLABS[name](rng, lam)
    beam = bp.GaussianBeam(width, angle, float(rng.choice([0.0, rng.normal() * width])), z0)
    half = width * log_uniform(rng, 0.1, 2)
    count = int(rng.integers(5, 200))
    x = beam.x0 + half * (np.linspace(-1, 1, count) if rng.random() < 0.6 else np.sort(rng.uniform(-1, 1, count)))
    z = user_planes(rng, beam, slab.thickness, lam, "Gaussian, launch")
    rounding = 2.2e-16 * 2 * np.pi / lam * (np.abs(x - beam.x0).max() + beam.reach(1e-16))  # of phases
    return Case(kind, "Gaussian, launch", slab, beam, f, x, z, max(draw_rtol(rng), 40 * rounding))


# --- many guided modes ------------------------------------------------------------------------------------


def _slits_and_slab(rng: Rng, kind: str) -> Case:
    """Two slits of a twentieth wavelength a little in front of the modulated slab, lossless or nearly so."""
    f = 2500.0 * float(rng.choice([1.0, rng.uniform(0.7, 1.2)]))
    lam = C_AIR / f
    loss = float(rng.choice([0.0, log_uniform(rng, 1e-6, 1e-4)]))
    cell = bp.lmmd_cell(0.05 + 1j * loss, loss / 2, int(rng.choice([10, 10, 6, 14])))
    slab = bp.Slab(cell, int(rng.choice([450, log_uniform(rng, 20, 600)])))
    beam = bp.Slits(lam / 20, lam * log_uniform(rng, 0.1, 1), 2, -lam * log_uniform(rng, 0.08, 1))
    x = lam * log_uniform(rng, 0.5, 10) * np.linspace(-1, 1, int(rng.choice([21, 41, 101, 401])))
    x = rounded(x, 6) if rng.random() < 0.3 else x
    inside = slab.thickness * rng.uniform(0, 1, 2)
    behind = slab.thickness + lam * np.array([0.0, log_uniform(rng, 0.01, 1)])
    every = np.concatenate([[0.0], beam.z0 * rng.uniform(0, 0.8, 1), inside, behind])
    z = np.sort(rng.choice(every, int(rng.integers(1, 6)), replace=False))
    return Case(kind, "Slits", slab, beam, f, x, z, max(draw_rtol(rng), 1e-10))


def _hundred_thousand(rng: Rng, kind: str) -> Case:
    """100 000 lossless periods."""
    f, _ = draw_frequency(rng)
    case = question(rng, kind, bp.Slab(modulated_cell(rng, False), 100_000), f, ENTIRE)
    return case._replace(
        rtol=float(10 ** rng.uniform(-8, -3))
    )  # rounding of so many periods leaves no more to be known


HARD: dict[str, Callable[[Rng, str], Case]] = {
    "half-space, backward": _half_space_backward,
    "negative layer before density 0": _before_density_zero,
    "sharp resonances": _sharp_resonances,
    "nearly dark planes": _dark_planes,
    "x to printed digits": _printed,
    "long x": _long,
    "far from x = 0": _far,
    "behind a mirror, band edge": _band_edge,
    "nearly rigid half-space": _nearly_rigid,
    "very wide beams": _very_wide,
    "slits before the lossless slab": _slits_and_slab,
    "100 000 lossless periods": _hundred_thousand,
}


def hard_case(number: int, count: int) -> Case:
    """Case `number` of the hard classes, counted from 0, which are gone through in turn; the same on every machine."""
    kind = list(HARD)[count % len(HARD)]
    return HARD[kind](np.random.default_rng([SEED, number]), kind)
