"""Plates of solids: where waves begin, where their energy stands still, and what a plate in water reflects."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

import beamprop as bp

from ..formulas import plates
from ..records import Row, Section, next_term, rounding
from .solids import FREQUENCY, LOAD, NOTHING, SOLIDS, WATER

#: Fluids too light to load a plate, and so fast that few waves are leaky: one to search beside kx = 0, one for S1.
FASTEST, FAST = (NOTHING[0], 1e4), (NOTHING[0], 5e3)
SILICA = (2200.0, 5968.0, 3764.0)
#: (kx d)^2 of the waves from which cut-offs are extrapolated, in steps of it.
STEP = 5e-4
LAMB, SCHOCH = "Lamb 1917", "Schoch 1952"


class Wave(NamedTuple):
    """A wave of a plate: kx times thickness, and +1 or -1 as energy flows along kx or against it."""

    kd: complex
    direction: int


def waves(solid: tuple, fluid: tuple, fd: float, strip: float) -> list[Wave]:
    """The package's waves of a plate that are faster than sound in the fluid."""
    thickness = fd / FREQUENCY
    slab = bp.Slab(bp.Layer(bp.Solid(*solid), thickness), background=bp.Fluid.from_speed(*fluid))
    ds = bp.guided_modes(slab, FREQUENCY, kx_over_k0_max=1.01, strip_over_k0=strip, leaky=True)
    return [Wave(complex(k) * thickness, int(s)) for k, s in zip(ds.kx.values, ds.direction.values, strict=True)]


def pair(solid: tuple, fd: float) -> tuple[float, float]:
    """(Difference of kx d)^2 and mean of kx d of the backward wave and the forward one nearest to it.

    Both are smooth in fd where the two meet, and below that, where they are complex waves.
    """
    found = waves(solid, FAST, fd, 0.2)
    backward = min((w.kd for w in found if w.direction < 0), key=abs)
    forward = min((w.kd for w in found if w.direction > 0), key=lambda kd: abs(kd - backward))
    return ((forward - backward) ** 2).real, (forward + backward).real / 2


def zero_group_velocity(solid: tuple) -> tuple[float, float]:
    """Fd and kx d at which S1 and its backward wave are one, by the secant method from just below their cut-off."""
    cut_off = min(solid[1] / 2, solid[2])
    last, fd = 0.985 * cut_off, 0.975 * cut_off
    before, now = pair(solid, last), pair(solid, fd)
    while abs(fd - last) > 1e-6 * fd:
        share = now[0] / (before[0] - now[0])
        last, fd, before = fd, fd - share * (last - fd), now
        now = pair(solid, fd)
    return fd, now[1]


def of_zero_group_velocity() -> list[Row]:
    """Where S1 carries no energy: named solids, and two ratios of Poisson."""
    table = SOLIDS | {
        "fused silica": SILICA,
        "a solid of Poisson's ratio 0.2": (2500.0, 3000.0 * math.sqrt(8 / 3), 3000.0),
        "a solid of Poisson's ratio 0.4": (2500.0, 3000.0 * math.sqrt(6), 3000.0),
    }
    out = []
    for name, solid in table.items():
        ours, exact = zero_group_velocity(solid), plates.zero_group_velocity(solid)
        out.append(Row(f"f d (MHz mm) of zero group velocity, S1 of {name}", LAMB, ours[0] / 1e3, exact[0] / 1e3, LOAD))
        out.append(Row(f"kx d of zero group velocity, S1 of {name}", LAMB, ours[1], exact[1], LOAD))
    return out


def extrapolated(places: list[complex], fds: list[float]) -> list[tuple[float, float]]:
    """Value and slope at 0 of the polynomial through fd at complex places, each with what the last of them changes."""
    fits = [
        np.linalg.solve(np.vander(np.array(places[:n]), n, increasing=True), np.array(fds[:n]))[:2].real
        for n in (len(fds) - 1, len(fds))
    ]
    return [(float(value), abs(float(value - before))) for before, value in zip(*fits, strict=True)]


def of_cut_offs() -> list[Row]:
    """Where waves begin, and how fd grows from there with (kx d)^2."""
    out = []
    for name, solid in {"steel": SOLIDS["steel"], "fused silica": SILICA}.items():
        for cut_off in plates.cut_offs(solid, lengthwise=2, shear=3):
            fds = [cut_off.fd + i * STEP * cut_off.curvature for i in (1, 2, 3, 4)]
            places = [min((w.kd for w in waves(solid, FASTEST, fd, 0.05)), key=abs) ** 2 for fd in fds]
            for what, exact, (ours, change) in zip(
                ("f d (Hz m) where a wave begins", "growth of it (Hz m) with (kx d)²"),
                (cut_off.fd, cut_off.curvature),
                extrapolated(places, fds),
                strict=True,
            ):
                tolerance = next_term(LOAD.value + change / abs(exact))
                out.append(Row(f"{what}, {name}, {cut_off.name}", LAMB, ours, exact, tolerance))
    return out


def of_cones() -> list[Row]:
    """Brass has cL = 2 cT: a forward wave above f d = cT goes on below it as a backward one of -kx."""
    solid, places, fds = SOLIDS["brass"], [], []
    for i in (1, 2, 3):
        for side in (1, -1):
            fds.append(solid[2] * (1 + side * i * STEP))
            found = [w.kd for w in waves(solid, FASTEST, fds[-1], 0.05) if w.direction == side]
            places.append(side * min(found, key=abs))
    (fd, change), (slope, bend) = extrapolated(places, fds)
    speed, exact = 2 * math.pi * slope, plates.cone(solid)
    return [
        Row(
            "f d (Hz m) where two waves of brass meet at kx = 0",
            LAMB,
            fd,
            solid[2],
            next_term(LOAD.value + change / fd),
        ),
        Row("their group velocity (m/s)", LAMB, speed, exact, next_term(LOAD.value + bend / slope)),
    ]


def of_reflection() -> list[Row]:
    """Plates in water: half-wave resonances, and slanted waves."""
    out, water = [], bp.Fluid.from_speed(*WATER)
    for name, solid in SOLIDS.items():
        for n in (1, 2):
            slab = bp.Slab(bp.Layer(bp.Solid(*solid), n * solid[1] / 2 / FREQUENCY), background=water)
            ds = bp.scattering(slab, FREQUENCY, angle=0.0)
            what = f"of a plate of {name} in water, f d = {n} cL/2"
            out.append(Row(f"r {what}", SCHOCH, complex(ds.r), 0.0, rounding(), scale=1))
            out.append(Row(f"t {what}", SCHOCH, complex(ds.t), (-1.0) ** n, rounding()))
        slab = bp.Slab(bp.Layer(bp.Solid(*solid), 3000.0 / FREQUENCY), background=water)
        for angle in (14.0, 25.0, 50.0):
            ds = bp.scattering(slab, FREQUENCY, angle=angle)
            for which, ours, exact in zip(
                "rt", (complex(ds.r), complex(ds.t)), plates.in_fluid(solid, WATER, 3000.0, angle), strict=True
            ):
                what = f"{which} of a plate of {name} in water, 3 MHz mm, {angle:g}°"
                out.append(Row(what, SCHOCH, ours, exact, rounding(10), scale=1))
    return out


def rows() -> list[Row]:
    """All of them."""
    return of_zero_group_velocity() + of_cut_offs() + of_cones() + of_reflection()


SECTION = Section(
    "Plates",
    "Waves of plates of solids where they begin and where their energy stands still, in a fluid of 1e-5 kg/m3, and "
    "plates in water. Zero group velocity is found where a backward and a forward wave of the package become one, and "
    "by the derivative of Lamb's equation to thirty digits; what is at kx = 0 is extrapolated from waves beside it, "
    "and what the last of them changes is the next term.",
    rows,
)
