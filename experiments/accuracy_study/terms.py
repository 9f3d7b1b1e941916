"""Is every term of the error estimate needed? Each is switched off in turn, and questions are sought that it alone decides.

A term is a line of the package's source: the function that holds it is compiled again with the line changed. Most terms make the
estimate larger, and are needed if without them it falls below a third of the true error somewhere, or if the search for a contour
does not reach rtol without what they tell; those that make it smaller are needed if without them a right field is warned of.
"""

from __future__ import annotations

import importlib
import inspect
import itertools
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import NamedTuple

import mpmath as mp
import numpy as np

import beamprop as bp

from .cases import Case
from .contour import panels
from .medium import Medium
from .numbering import fan_of, make_case, map_of, numbers_of
from .reference import EPS, Truth, field_sum
from .slabs import C_AIR
from .source import Source
from .study import compared_with, error_of


class Term(NamedTuple):
    """One term: where it stands, what it reads without it, and the questions that may need it."""

    name: str
    module: str
    function: str
    line: str
    without: str
    candidates: tuple[object, ...]  #: numbers of cases, or questions built for it
    larger: bool = True  #: whether the term makes the estimate larger


def _built(slab: bp.Slab, beam: object, x: np.ndarray, z: list[float], rtol: float, frequency: float = 2500.0) -> Case:
    return Case("built", "built", slab, beam, frequency, np.asarray(x, float), np.asarray(z, float), rtol)


class Among(NamedTuple):
    """A question built for a term, asked for among many angles of the same beam."""

    case: Case
    angles: np.ndarray  #: degree, that of the case's beam among them


#: Kinds of built questions with a truth of their own: a spectrum that ends in a step, which no contour but the real axis serves;
#: and a profile at its samples on its launch plane, where what is launched is the field.
STEPPED, LAUNCHED = "stepped", "as launched"


def on_the_axis(case: Case) -> Truth:
    """The truth of a question without guided modes, by panels on the real axis, graded to 0, its branch points and ends."""
    m = Medium(case.slab, case.frequency)
    source = Source(case.beam, m.k0)
    end, fields = source.band(1e-17), []
    for count in (300, 450):
        steps = end * np.geomspace(1e-13, 1, 200)
        near = [b + side * steps for b in (0.0, *m.branches()) for side in (-1, 1)]
        edges = np.concatenate([np.linspace(0, end, count), *near])
        k, w = panels(np.unique(edges[(edges >= 0) & (edges <= end)]))
        x = case.x - case.beam.centre
        fields.append(field_sum(source, lambda kk: m.response(kk, case.z, case.beam.z0), k + 0j, w + 0j, None, x))
    scale = np.abs(fields[1]).max(axis=1)
    error = np.abs(fields[1] - fields[0]).max(axis=1) / scale
    return Truth(fields[1], scale, error, np.zeros(scale.size, bool), 0)


def as_launched(case: Case) -> Truth:
    """p exp(i k0 sin(angle) x) at samples of a profile about x = 0, its phases in 40 digits."""
    beam = case.beam
    rho, _, K = (float(complex(v[0]).real) for v in case.slab.before.at(np.array([case.frequency])))
    with mp.workdps(40):
        k0 = 2 * mp.pi * mp.mpf(case.frequency) * mp.sqrt(mp.mpf(rho) / mp.mpf(K))
        tilt = k0 * mp.sin(mp.radians(mp.mpf(beam.angle)))
        turn = np.array([complex(mp.expj(tilt * mp.mpf(float(x)))) for x in case.x])
    p = (beam.p[np.searchsorted(beam.x, case.x)] * turn)[None]
    return Truth(p, np.abs(p).max(axis=1), np.array([EPS]), np.zeros(1, bool), 0)


def _coarse_profiles() -> Iterator[Among]:
    """White noise sampled every third of a wavelength to every wavelength: its spectrum ends in a step.

    At more angles than those for which the contour comes up to the axis at the steps.
    """
    for seed, spacing in enumerate((0.2, 0.33, 0.45, 0.8)):
        rng = np.random.default_rng(seed)
        x = np.arange(40) * spacing * C_AIR / 2500
        beam = bp.Profile(x - x.mean(), rng.normal(size=40) + 1j * rng.normal(size=40), -0.02)
        case = _built(bp.Slab.uniform(bp.AIR, 0.1), beam, np.linspace(beam.x[0], beam.x[-1], 37), [0.0], 1e-6)
        yield Among(case._replace(kind=STEPPED), np.linspace(-10, 10, 21))


def _cones() -> Iterator[Case]:
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


def _tilted_plateaus() -> Iterator[Case]:
    """Flat-topped profiles, 5000 to 7000 wavelengths wide, with a steep tilt, on their launch plane in cold air.

    All contours share k0 sin(angle), which is off by 1.9 units of its last place: the roundings of 2 pi f, of sqrt(rho/K), and of
    the sine go the same way at this frequency and angle. The phases k0 sin(angle) x are off by as much; and on the launch plane
    nothing shows of the second response's last bits.
    """
    air, frequency = bp.Fluid.from_speed(1.225, 330.0), 3510.0
    for half in (2600, 3400, 3000):
        x = np.linspace(-1.6, 1.6, 161) * half * 330.0 / frequency
        beam = bp.Profile(x, np.exp(-((x / x[-1] * 1.6) ** 8)), 0.0, 78.0)
        slab = bp.Slab.uniform(air, 0.1, before=air, after=air)
        yield _built(slab, beam, beam.x[27:134:3], [0.0], 1e-12, frequency)._replace(kind=LAUNCHED)


def _some(kind: str, count: int = 12) -> tuple[int, ...]:
    return tuple(itertools.islice(numbers_of(kind), count))


#: Every term of the estimate. Where the package's line changes, it changes here.
TERMS = [
    Term(
        "difference of two contours", "contour.error_estimate", "_difference",
        "np.max(np.abs(a - b), axis=2)", "0 * np.max(np.abs(a - b), axis=2)", tuple(range(15)),
    ),
    Term(
        "rounding of a profile's samples", "contour.error_estimate", "_difference", "+ source) / scale", "+ 0 * source) / scale", (CANCELLED,),
    ),
    Term(
        "what lies beyond the band", "contour.error_estimate", "_beyond",
        "return 2 * last * ratio / (1 - ratio)", "return 0 * last", tuple(_cones()),
    ),
    Term(
        "a spectrum that is cut off", "contour.error_estimate", "_difference", "error += cut / scale", "error += 0 * cut / scale",
        tuple(_coarse_profiles()),
    ),
    Term(
        "mixing of angles", "contour.error_estimate", "_difference", "error += 3 *", "error += 0 *", (MIXED,),
    ),
    Term(
        "planes made of a few", "fields.evaluate", "_fill_low_rank", "return error", "return 0 * error", tuple(range(1, 600, 5)),
    ),
    Term(
        "rounding of long phases", "contour.error_estimate", "_difference",
        "return worst + paths.EPS * (4 + checks.k0 * way)", "return worst + 0 * way", tuple(_tilted_plateaus()),
    ),
    Term(
        "second response moved in its last bits", "contour.error_estimate", "sampled", "SHIFT if moved else 0.0", "0.0",
        (*_some("sharp resonances", 20), *_some("LMMD, 1 or 100 000 periods", 20)),
    ),
    Term(
        "brightness outside the window", "contour.error_estimate", "_difference",
        "largest = np.maximum(largest, checks.peaks_outside)", "largest = largest * 1.0", (FAR,), False,
    ),
    Term(
        "planes too dark to be seen", "contour.error_estimate", "_difference", "seen = largest > DARK", "seen = largest > -1.0", (SHADOW, BLACK), False,
    ),
    Term(
        "planes dark to rounding", "contour.error_estimate", "_difference", "(largest > DARK) & ~checks.dark", "(largest > DARK)", (WALL,), False,
    ),
]  # fmt: skip


@contextmanager
def switched_off(term: Term) -> Iterator[None]:
    """The package without a term."""
    module: ModuleType = importlib.import_module(f"beamprop.{term.module}")
    kept = getattr(module, term.function)
    source = inspect.getsource(kept)
    if source.count(term.line) != 1:
        raise LookupError(
            f"{term.module}.{term.function}: expected one line {term.line!r}, found {source.count(term.line)}"
        )
    changed: dict[str, object] = {}
    exec(compile(source.replace(term.line, term.without), module.__file__ or "", "exec"), vars(module), changed)
    setattr(module, term.function, changed[term.function])
    try:
        yield
    finally:
        setattr(module, term.function, kept)


class Found(NamedTuple):
    """What a question says of a term."""

    number: object
    error: float
    estimate: float
    without: float  #: the estimate without the term
    needed: bool


class _Question(NamedTuple):
    """A case, and what is asked for with it."""

    case: Case
    x: np.ndarray
    z: np.ndarray
    angles: np.ndarray | None


def _question(candidate: object) -> _Question:
    if isinstance(candidate, int):
        case = make_case(candidate)
        return _Question(case, *map_of(candidate, case), fan_of(candidate, case))
    if isinstance(candidate, Among):
        return _Question(candidate.case, candidate.case.x, candidate.case.z, candidate.angles)
    assert isinstance(candidate, Case)
    return _Question(candidate, candidate.x, candidate.z, None)


def _truth(case: Case, goal: float) -> tuple[Truth | str, np.ndarray]:
    """The truth, and at which of the case's positions."""
    every = np.arange(case.x.size)
    if case.kind == STEPPED:
        return on_the_axis(case), every
    if case.kind == LAUNCHED:
        return as_launched(case), every
    return compared_with(case, goal)


def _estimate(question: _Question) -> tuple[np.ndarray, float] | None:
    """The package's p at the case's own positions and its estimate; None where it refuses."""
    case, x, z, angles = question
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            ds = bp.field(case.slab, case.beam, case.frequency, x, z, angle=angles, rtol=case.rtol)
        except ValueError:
            return None
    ds = ds if angles is None else ds.isel(angle=int(np.flatnonzero(angles == case.beam.angle)[0]))
    p = ds.p.values.reshape(z.size, x.size)[np.searchsorted(z, case.z)][:, np.searchsorted(x, case.x)]
    return p, float(ds.error_estimate)


def tried(term: Term, candidate: object) -> Found | None:
    """One question with and without a term; None where there is no truth or no answer."""
    question = _question(candidate)
    case = question.case
    whole = _estimate(question)
    with switched_off(term):
        without = _estimate(question)
    label = candidate if isinstance(candidate, int) else "built"
    if whole is not None and without is None and not term.larger:  # what is answered, is refused without it
        return Found(label, np.nan, whole[1], np.inf, whole[1] <= case.rtol)
    if whole is None or without is None:
        return None
    if term.larger and whole[1] <= case.rtol < without[1]:  # the search needs it
        return Found(label, np.nan, whole[1], without[1], True)
    if term.larger and without[1] > 0.9 * whole[1]:
        return None
    truth, some = _truth(case, max(without[1], 1e-16))
    if isinstance(truth, str):
        return None
    error, unknown = error_of(without[0][:, some], truth)
    if term.larger:
        needed = error - unknown > 3 * max(without[1], unknown)
    else:
        needed = error + unknown < case.rtol / 3 and not without[1] <= case.rtol
    return Found(label, error, whole[1], without[1], needed)


def decided(term: Term, candidates: Iterable[object] | None = None) -> Found | None:
    """The first question that needs a term, or the one that came nearest; None where no question was changed by it."""
    nearest: Found | None = None
    for candidate in term.candidates if candidates is None else candidates:
        found = tried(term, candidate)
        if found is None:
            continue
        if found.needed:
            return found
        if nearest is None or found.error / max(found.without, 1e-17) > nearest.error / max(nearest.without, 1e-17):
            nearest = found
    return nearest


def term_table() -> str:
    """Every term, and the question that needs it."""
    lines = ["| term | case | true error | estimate | without it | needed |", "|---" * 6 + "|"]
    for term in TERMS:
        try:
            found = decided(term)
        except LookupError as gone:
            lines.append(f"| {term.name} | | | | | the package has no such line: {gone} |")
            continue
        if found is None:
            lines.append(f"| {term.name} | none changed | | | | NO |")
            continue
        says = "yes" if found.needed else "not shown"
        lines.append(
            f"| {term.name} | {found.number} | {found.error:.1e} | {found.estimate:.1e} | {found.without:.1e} | {says} |"
        )
    return "\n".join(lines)
