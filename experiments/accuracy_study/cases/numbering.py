"""Which case has which number, and the many angles and planes among which a case is requested."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ..case import Case
from .first import FIRST, SEED, first_case
from .hard import HARD, hard_case
from .slabs import SLABS
from .solid import SOLID, solid_case

#: Cases of the whole study: those of the first fifteen classes, and as many hard ones as make 3000.
CASES = 3000
#: Cases with solids have numbers from here on, which no other class comes to.
SOLIDS_FROM = 1_000_000
KINDS = [*SLABS, *HARD, *SOLID]
#: Grids of more points, and fields wider in wavelengths, than these are requested by themselves.
MANY, WIDE = 5000, 3000


def is_large(case: Case) -> bool:
    """Whether many angles or planes of it would take too long."""
    k0 = float(case.slab.before.wavenumber(case.frequency).real)
    return (
        case.source == "Slits"
        or case.x.size > MANY
        or max(np.ptp(case.x), case.beam.reach(0.5)) * k0 / (2 * np.pi) > WIDE
    )


def make_case(number: int) -> Case:
    """Case `number` of the study; the same on every machine."""
    if number >= SOLIDS_FROM:
        return solid_case(number, number - SOLIDS_FROM)
    return first_case(number) if number < FIRST else hard_case(number, number - FIRST)


def numbers_of(kind: str) -> Iterator[int]:
    """The numbers of the cases of one class, without end for a hard one and one with solids."""
    if kind in SOLID:
        return itertools.count(SOLIDS_FROM + list(SOLID).index(kind), len(SOLID))
    if kind in HARD:
        return itertools.count(FIRST + list(HARD).index(kind), len(HARD))
    return iter(range(list(SLABS).index(kind), FIRST, len(SLABS)))


def quick_numbers() -> list[int]:
    """A few of each class."""
    return [*range(60), *range(FIRST, FIRST + 2 * len(HARD))]


def angles_of(number: int, case: Case) -> np.ndarray | None:
    """For one case in seven: 40 or 150 angles among which its own is requested."""
    if number % 7 or getattr(case.beam, "form", "launch") == "rotated" or (number >= FIRST and is_large(case)):
        return None
    rng = np.random.default_rng([SEED, number, 1])
    angles = rng.uniform(-89, 89, int(rng.choice([40, 150])))
    angles[rng.integers(angles.size)] = case.beam.angle
    return angles


def map_of(number: int, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """x and z that are requested; for one case in five a map of many planes and positions, the case's own among them."""
    if number % 5 != 1 or number % 7 == 0 or (number >= FIRST and is_large(case)):
        return case.x, case.z
    rng = np.random.default_rng([SEED, number, 2])
    half = max(np.ptp(case.x) / 2, case.beam.reach(0.5))
    x = case.x.mean() + half * np.linspace(-1, 1, 80)
    return np.union1d(case.x, x), np.union1d(case.z, rng.uniform(case.z.min(), case.z.max(), 250))
