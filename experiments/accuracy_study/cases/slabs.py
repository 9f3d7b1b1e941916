"""The random slabs of the study's first fifteen classes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import beamprop as bp

WATER, HELIUM = bp.Fluid.from_speed(1000.0, 1480.0), bp.Fluid.from_speed(0.167, 1000.0)
C_AIR, RHO_AIR = 343.0, 1.25


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def modulated_cell(rng: np.random.Generator, lossy: bool) -> bp.Cell:
    mean = rng.uniform(-0.3, 1.0)
    loss = 1j * log_uniform(rng, 1e-4, 0.5) if lossy else 0
    layers = int(rng.choice([3, 4, 5, 6, 7, 8, 10, 10, 12, 14]))
    return bp.lmmd_cell(mean + loss, abs(loss) / 2, layers, 1 / rng.uniform(10, 100))


def fluid_like_air(rng: np.random.Generator, rho: float, K: float, loss: float = 0.0, **more: Any) -> bp.Fluid:
    air = bp.AIR.bulk_modulus
    return bp.Fluid(RHO_AIR * (rho + 1j * loss * abs(rho)), air * (K - 1j * loss * abs(K)), **more)


def random_loss(rng: np.random.Generator) -> float:
    return log_uniform(rng, 1e-4, 0.3) if rng.random() < 0.5 else 0.0


def _lmmd_lossless(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(modulated_cell(rng, False), int(log_uniform(rng, 1, 600)))


def _lmmd_lossy(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(modulated_cell(rng, True), int(log_uniform(rng, 1, 2000)))


def _positive(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = fluid_like_air(rng, log_uniform(rng, 0.05, 20), log_uniform(rng, 0.2, 20), random_loss(rng))
    return bp.Slab.uniform(fluid, lam * log_uniform(rng, 0.01, 10))


def _negative(rng: np.random.Generator, lam: float) -> bp.Slab:
    rho, K = (
        (-log_uniform(rng, 0.1, 5), log_uniform(rng, 0.2, 5))
        if rng.random() < 0.6
        else (log_uniform(rng, 0.1, 5), -log_uniform(rng, 0.2, 5))
    )
    return bp.Slab.uniform(fluid_like_air(rng, rho, K, random_loss(rng)), lam * log_uniform(rng, 0.02, 2))


def _double_negative(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = fluid_like_air(
        rng,
        -log_uniform(rng, 0.2, 5),
        -log_uniform(rng, 0.2, 5),
        log_uniform(rng, 1e-3, 0.3) if rng.random() < 0.7 else 0.0,
    )
    return bp.Slab.uniform(fluid, lam * log_uniform(rng, 0.05, 2))


def _rigid_x(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab.uniform(
        fluid_like_air(rng, log_uniform(rng, 0.1, 3), 1.0, random_loss(rng), density_x=np.inf),
        lam * log_uniform(rng, 0.1, 10),
    )


def _water_or_helium_behind(rng: np.random.Generator, lam: float) -> bp.Slab:
    after = WATER if rng.random() < 0.5 else HELIUM
    if rng.random() < 0.5:
        return bp.Slab(modulated_cell(rng, rng.random() < 0.5), int(log_uniform(rng, 1, 300)), after=after)
    return bp.Slab.uniform(
        fluid_like_air(rng, log_uniform(rng, 0.1, 5), log_uniform(rng, 0.2, 5)),
        lam * log_uniform(rng, 0.05, 3),
        after=after,
    )


def _water_in_front(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = bp.Fluid.from_speed(1000.0 * log_uniform(rng, 0.2, 8), 1480.0 * log_uniform(rng, 0.3, 4))
    return bp.Slab.uniform(
        fluid, 4.3 * lam * log_uniform(rng, 0.05, 3), before=WATER, after=WATER if rng.random() < 0.5 else bp.AIR
    )


def _lossy_behind(rng: np.random.Generator, lam: float) -> bp.Slab:
    after = fluid_like_air(rng, log_uniform(rng, 0.5, 5), log_uniform(rng, 0.5, 5), log_uniform(rng, 1e-3, 0.3))
    return bp.Slab(modulated_cell(rng, rng.random() < 0.5), int(log_uniform(rng, 1, 300)), after=after)


def _opaque(rng: np.random.Generator, lam: float) -> bp.Slab:
    if rng.random() < 0.5:
        return bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), int(log_uniform(rng, 500, 20_000)))
    return bp.Slab.uniform(
        fluid_like_air(rng, -log_uniform(rng, 1, 20), 1.0, random_loss(rng)), lam * rng.uniform(1, 30)
    )


def _stack(rng: np.random.Generator, lam: float) -> bp.Slab:
    parts = [
        rng.choice(np.array([_lmmd_lossy, _positive, _rigid_x, _negative, _lmmd_lossless]))(rng, lam)
        for _ in range(rng.integers(2, 5))
    ]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole + part
    return whole


class Resonant:
    """Density of a membrane-like medium: crosses zero at f0 [Hz]; picklable."""

    def __init__(self, f0: float, loss: float) -> None:
        self.f0, self.loss = f0, loss

    def __call__(self, f: np.ndarray) -> np.ndarray:
        return RHO_AIR * (1 - (self.f0 / f) ** 2 + 1j * self.loss)


def _dispersive(rng: np.random.Generator, lam: float) -> bp.Slab:
    f = C_AIR / lam
    density = Resonant(f * rng.uniform(0.7, 1.3), log_uniform(rng, 1e-4, 0.1))
    return bp.Slab(
        [bp.Layer(bp.Fluid(density, bp.AIR.bulk_modulus), lam / 40), bp.Layer(bp.AIR, lam / 25)],
        int(log_uniform(rng, 1, 40)),
    )


def _backward(rng: np.random.Generator, lam: float) -> bp.Slab:
    loss = log_uniform(rng, 1e-5, 1e-2) if rng.random() < 0.5 else 0.0
    return bp.Slab.uniform(
        bp.Fluid(RHO_AIR * (-rng.uniform(0.3, 0.9) + 1j * loss), bp.AIR.bulk_modulus), lam * log_uniform(rng, 0.02, 0.1)
    )


def _single_or_many_periods(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(modulated_cell(rng, rng.random() < 0.7), int(rng.choice([1, 100_000])))


def _nothing(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab.uniform(bp.AIR, lam * log_uniform(rng, 0.01, 20))


SLABS: dict[str, Callable[[np.random.Generator, float], bp.Slab]] = {
    "air alone": _nothing,
    "LMMD, lossless": _lmmd_lossless,
    "LMMD, lossy": _lmmd_lossy,
    "LMMD, 1 or 100 000 periods": _single_or_many_periods,
    "uniform fluid": _positive,
    "negative density or modulus": _negative,
    "double negative": _double_negative,
    "density_x infinite": _rigid_x,
    "water or helium behind": _water_or_helium_behind,
    "water in front": _water_in_front,
    "lossy half-space behind": _lossy_behind,
    "opaque": _opaque,
    "stack": _stack,
    "dispersive": _dispersive,
    "backward modes": _backward,
}
