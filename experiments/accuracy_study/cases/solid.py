"""The classes with solids: plates, coatings and lattices, each with a slab of its own and beams, grids and planes of the hard classes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import beamprop as bp

from ..case import Case
from .first import SEED
from .hard import ENTIRE, brought_near, question, user_planes
from .slabs import WATER, log_uniform

Rng = np.random.Generator
AIR = bp.Fluid.from_speed(1.2, 343.0)
#: Density, longitudinal and shear speed of steel, aluminium, brass, glass, acrylic and epoxy; and how far a draw may differ from them.
COMMON = ((7900, 5900, 3200), (2700, 6320, 3130), (8400, 4400, 2200), (2500, 5660, 3420), (1180, 2700, 1340), (1200, 2600, 1150))  # fmt: skip
SPREAD = 0.1


def draw_loss(rng: Rng, lossy: float = 0.5) -> float:
    """Of some of the solids none, of the others Im/Re of their speeds."""
    return log_uniform(rng, 1e-4, 0.05) if rng.random() < lossy else 0.0


def draw_solid(rng: Rng, lossy: float = 0.5) -> bp.Solid:
    """One of the common ones, its numbers moved by up to SPREAD."""
    rho, c_l, c_t = np.array(COMMON[rng.integers(len(COMMON))]) * (1 + SPREAD * rng.uniform(-1, 1, 3))
    loss = draw_loss(rng, lossy)
    return bp.Solid(rho, c_l * (1 - 1j * loss), c_t * (1 - 1j * loss * rng.uniform(1, 1.3)))


def draw_soft(rng: Rng) -> bp.Solid:
    """A solid like rubber, gel or tissue: shear waves of 3 to 700 m/s, the slower the more lossy."""
    rho, c, c_t = rng.uniform(900, 2000), rng.uniform(900, 2200), log_uniform(rng, 3, 700)
    loss = log_uniform(rng, 0.02, 0.4) if c_t < 150 or rng.random() < 0.7 else 0.0
    return bp.Solid.from_moduli(rho, rho * c**2 * (1 - 0.1j * loss), rho * c_t**2 * (1 - 2j * loss))


def draw_liquid(rng: Rng) -> bp.Fluid:
    return bp.Fluid.from_speed(1000 * rng.uniform(0.7, 1.6), 1480 * rng.uniform(0.7, 1.3))


def _layer(rng: Rng, medium: bp.Solid | bp.Fluid, lam: float, thick: tuple[float, float]) -> bp.Layer:
    return bp.Layer(medium, lam * log_uniform(rng, *thick))


def _question(rng: Rng, kind: str, slab: bp.Slab, frequency: float, lam: float) -> Case:
    """Half of the Gaussians narrow and close, whose evanescent waves meet what a plate guides."""
    case = question(rng, kind, slab, frequency, ENTIRE)
    return brought_near(rng, case, lam) if rng.random() < 0.5 else case


def _sizes(rng: Rng, speed: float = 1480.0) -> tuple[float, float]:
    """A frequency and the wavelength."""
    f = log_uniform(rng, 2e4, 5e6)
    return f, speed / f


def _thin_plate(rng: Rng, kind: str) -> Case:
    """0.002 to 0.2 wavelengths of water thick."""
    f, lam = _sizes(rng)
    return _question(rng, kind, bp.Slab([_layer(rng, draw_solid(rng), lam, (0.002, 0.2))], background=WATER), f, lam)


def _thick_plate(rng: Rng, kind: str) -> Case:
    """0.2 to 10 wavelengths of water thick, with layers of fluid beside it or not."""
    f, lam = _sizes(rng)
    plate = [_layer(rng, draw_solid(rng), lam, (0.2, 10))]
    if rng.random() < 0.3:
        plate.insert(rng.integers(2), _layer(rng, draw_liquid(rng), lam, (0.05, 1)))
    return _question(
        rng, kind, bp.Slab(plate, before=WATER, after=draw_liquid(rng) if rng.random() < 0.3 else WATER), f, lam
    )


def _backward(rng: Rng, kind: str) -> Case:
    """A plate half a longitudinal wave thick, whose mode S1 runs backward beside kx = 0, and a beam near the normal."""
    before, after = ((WATER, WATER), (WATER, WATER), (AIR, AIR), (WATER, draw_liquid(rng)))[rng.integers(4)]
    f, lam = _sizes(rng, 343.0 if before is AIR else 1480.0)
    solid = draw_solid(rng, 0.3)
    half = complex(solid.longitudinal_speed).real / 2 / f  # type: ignore[arg-type]
    plate = bp.Layer(solid, half * int(rng.choice([1, 1, 1, 2, 3])) * rng.uniform(0.93, 1.02))
    case = question(rng, kind, bp.Slab([plate], before=before, after=after), f, ENTIRE)
    if case.source != "Gaussian, launch" or rng.random() < 0.3:
        return case
    # most of them narrow: the contour of a wide one runs above what is backward
    z0 = -lam * float(rng.choice([0.0, log_uniform(rng, 0.01, 5)]))
    beam = bp.GaussianBeam(lam * log_uniform(rng, 0.3, 8), float(rng.uniform(-12, 12)), case.beam.x0, z0)
    x = beam.x0 + beam.fwhm * log_uniform(rng, 0.3, 3) * np.linspace(-1, 1, int(rng.integers(5, 40)))
    return case._replace(beam=beam, x=x, z=user_planes(rng, beam, case.slab.thickness, lam, case.source))


def _air(rng: Rng, kind: str) -> Case:
    """A plate in air, between water and air, or behind air, whose waves leak next to nothing."""
    before, after = ((AIR, AIR), (WATER, AIR), (AIR, WATER))[rng.integers(3)]
    f, lam = _sizes(rng, 343.0 if before is AIR else 1480.0)
    plate = _layer(rng, draw_solid(rng), lam, (0.01, 5) if before is AIR else (0.01, 2))
    return _question(rng, kind, bp.Slab([plate], before=before, after=after), f, lam)


def _coated(rng: Rng, kind: str) -> Case:
    """A half-space of solid behind, bare or below up to three layers of solid or fluid."""
    f, lam = _sizes(rng)
    media = [draw_liquid(rng) if rng.random() < 0.25 else draw_solid(rng) for _ in range(rng.integers(0, 4))]
    layers = [_layer(rng, m, lam, (0.005, 1)) for m in media] or [bp.Layer(WATER, lam * rng.uniform(0.1, 1))]
    return _question(rng, kind, bp.Slab(layers, before=WATER, after=draw_solid(rng)), f, lam)


def _lattice(rng: Rng, kind: str) -> Case:
    """2 to 75 periods of a cell of a solid and a fluid, or of two solids and a fluid, in any order."""
    f, lam = _sizes(rng)
    media = [draw_liquid(rng), draw_solid(rng), *([draw_solid(rng)] if rng.random() < 0.3 else [])]
    cell = [_layer(rng, media[i], lam, (0.02, 0.5)) for i in rng.permutation(len(media))]
    return _question(rng, kind, bp.Slab(cell, int(log_uniform(rng, 2, 76)), background=WATER), f, lam)


def _bonded(rng: Rng, kind: str) -> Case:
    """Two to five solids in contact, or up to 30 periods of two."""
    f, lam = _sizes(rng)
    repeated = rng.random() < 0.3
    layers = [
        _layer(rng, draw_solid(rng), lam, (0.01, 0.3 if repeated else 1.5))
        for _ in range(2 if repeated else rng.integers(2, 6))
    ]
    return _question(
        rng, kind, bp.Slab(layers, int(log_uniform(rng, 2, 31)) if repeated else 1, background=WATER), f, lam
    )


def _soft(rng: Rng, kind: str) -> Case:
    """One soft solid, by itself, on a plate, or on a half-space."""
    f, lam = _sizes(rng)
    layers = [_layer(rng, draw_soft(rng), lam, (0.005, 1))]
    after: bp.Fluid | bp.Solid = WATER
    if rng.random() < 0.5:
        after = draw_solid(rng)
        layers += [_layer(rng, draw_solid(rng), lam, (0.02, 0.5))] if rng.random() < 0.5 else []
        after = after if rng.random() < 0.5 else WATER
    return _question(rng, kind, bp.Slab(layers, before=WATER, after=after), f, lam)


SOLID: dict[str, Callable[[Rng, str], Case]] = {
    "thin plate": _thin_plate,
    "thick plate": _thick_plate,
    "plate with a backward mode": _backward,
    "plate beside air": _air,
    "half-space of solid, coated": _coated,
    "lattice of solids and fluids": _lattice,
    "solids in contact": _bonded,
    "soft solids": _soft,
}


def solid_case(number: int, count: int) -> Case:
    """Case `number` of the classes with solids, counted from 0, which are gone through in turn; the same on every machine."""
    kind = list(SOLID)[count % len(SOLID)]
    return SOLID[kind](np.random.default_rng([SEED, number]), kind)
