"""Where the time goes, by stage, and what each step buys: the same question with the step and with it switched off, in turn."""

from __future__ import annotations

import contextlib
import cProfile
import pstats
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import _one_thread  # noqa: F401
import numpy as np
from run import BEAM, FREQUENCY, SLAB, grids
from timing import amount, measure

import beamprop as bp
from beamprop.contour import straight
from beamprop.fields import evaluate, question
from beamprop.response import cell, interior
from beamprop.sources import angles as source_angles

Work = Callable[[], object]
X, Z = grids()
ANGLES, FREQUENCIES = np.linspace(-80, 80, 1000), np.linspace(2000, 3000, 101)


def field_map(slab: bp.Slab = SLAB) -> object:
    """The map of the first row of the table."""
    return bp.field(slab, BEAM.at_angle(45.0), FREQUENCY, X, Z)


def angles() -> object:
    """Many angles at one plane."""
    return bp.field(SLAB, BEAM, FREQUENCY, X, SLAB.thickness, angle=ANGLES)


def hundred_angles() -> object:
    """A hundred angles at one plane."""
    return bp.field(SLAB, BEAM, FREQUENCY, X, SLAB.thickness, angle=ANGLES[::10])


def widths() -> object:
    """Widths against frequency."""
    return bp.beam_width(SLAB, BEAM, FREQUENCIES)


def coarse_in_z() -> object:
    """The map on every sixth plane."""
    return bp.field(SLAB, BEAM.at_angle(45.0), FREQUENCY, X, Z[::6])


def coarse_map() -> object:
    """The map on every sixth plane, at every eighth position."""
    return bp.field(SLAB, BEAM.at_angle(45.0), FREQUENCY, X[::8], Z[::6])


def air() -> object:
    """The map without a slab."""
    return field_map(bp.Slab.uniform(bp.AIR, SLAB.thickness))


# --- where the time goes ----------------------------------------------------------------------------------

#: Function by which a stage is known in a profile: (file's name, function's name).
STAGES: dict[str, tuple[Work, dict[str, tuple[str, str]]]] = {
    "`field`, 1000 z × 1024 x": (
        field_map,
        {
            "the choice of a contour and its error estimate": ("contour/choose.py", "choose_contour"),
            "of it: poles on the wrong side": ("modes/misplaced.py", "misplaced"),
            "of it: two contours compared": ("contour/error.py", "estimate"),
            "all planes, by low rank": ("fields/evaluate.py", "fill_map"),
            "of it: cross approximation": ("fields/low_rank.py", "cross"),
            "of it: its planes summed": ("fields/evaluate.py", "fill"),
            "the response, in both": ("response/transfer_function.py", "total_pressure"),
            "labels, provenance": ("api/field_question.py", "labelled"),
        },
    ),
    "1000 angles, exit plane": (
        angles,
        {
            "the choice of a contour and its error estimate": ("contour/choose.py", "choose_contour"),
            "fields at the nodes": ("contour/sums.py", "fft_sum"),
            "angle interpolation": ("sources/angles.py", "interpolated_to"),
            "labels, provenance": ("api/field_question.py", "labelled"),
        },
    ),
    "`beam_width`, 101 frequencies": (
        widths,
        {
            "windows, by stationary phase": ("contour/stationary_phase.py", "landing"),
            "poles on the wrong side": ("modes/misplaced.py", "any_misplaced"),
            "contours and their response": ("profiles/many_frequencies.py", "_both_contours"),
            "samples, peak, edges": ("profiles/many_frequencies.py", "_measured"),
        },
    ),
}


def shares(work: Work, stages: dict[str, tuple[str, str]], runs: int = 20) -> dict[str, float]:
    """Share of a work's time that is spent in each stage and below."""
    work()
    profile = cProfile.Profile()
    profile.enable()
    for _ in range(runs):
        work()
    profile.disable()
    stats: Any = pstats.Stats(profile)
    spent = {}
    for stage, (file, function) in stages.items():
        rows = [
            v for (path, _, name), v in stats.stats.items() if path.endswith(f"beamprop/{file}") and name == function
        ]
        if not rows:
            raise LookupError(f"{stage}: expected a call of {function} in {file}, found none")
        spent[stage] = sum(v[3] for v in rows) / stats.total_tt
    return spent


# --- what each step buys ----------------------------------------------------------------------------------


class Step(NamedTuple):
    """A step, the work that shows it, and what to put in whose place to be without."""

    name: str
    work: Work
    where: Any
    what: str
    without: Any


def never(*_: object) -> None:
    """No polynomial, no pair of waves: the plain formula is taken."""


def every_angle(beam: Any, angles: np.ndarray, *_: object) -> source_angles.AngleInterpolation:
    """All angles as they are."""
    return source_angles.AngleInterpolation(beam, angles)


#: More than any number of planes or periods.
NEVER_SO_MANY = 10**9
STEPS = [
    Step("low rank of the planes: 450 periods", field_map, evaluate, "MANY_PLANES", NEVER_SO_MANY),
    Step("low rank of the planes: air", air, evaluate, "MANY_PLANES", NEVER_SO_MANY),
    Step("angle interpolation", hundred_angles, question, "interpolate_angles", every_angle),
    Step(
        "straight contours and FFTs where they are cheaper", coarse_in_z, straight, "fft_is_cheaper", lambda *_: False
    ),
    Step("cells as polynomials in kx², 101 frequencies", widths, cell, "_fitted", never),
    Step("two waves in a thick layer", air, interior, "_steady", never),
]


@contextlib.contextmanager
def switched_off(step: Step) -> Iterator[None]:
    """Without the step, for a while."""
    kept = getattr(step.where, step.what)
    setattr(step.where, step.what, step.without)
    try:
        yield
    finally:
        setattr(step.where, step.what, kept)


def compare(step: Step, repeats: int) -> tuple[float, float]:
    """Median times without and with the step, in turn."""

    def without() -> object:
        with switched_off(step):
            return step.work()

    before, after = measure(without, step.work, repeats=repeats)
    return before, after


def planes_summed(work: Work) -> int:
    """How many planes stand for all of a map."""
    approximations = []
    cross = evaluate.cross

    def watched(*arguments: Any) -> Any:
        approximations.append(cross(*arguments))
        return approximations[-1]

    with switched_off(Step("", work, evaluate, "cross", watched)):
        work()
    return max(approximation.within(2e-12) for approximation in approximations)


def main(repeats: int = 9) -> None:
    """Print both tables, and how many planes stand for the 1000 of a map."""
    print(f"planes that stand for 1000: 450 periods {planes_summed(field_map)}, air {planes_summed(air)}\n")
    for title, (work, stages) in STAGES.items():
        print(f"| {title} | share |\n|---|---|")
        for stage, share in shares(work, stages).items():
            print(f"| {stage} | {share:.2f} |")
        print()
    print("| step | without | with | |\n|---|---|---|---|")
    for step in STEPS:
        before, after = compare(step, repeats)
        print(f"| {step.name} | {amount(before, 's')} | {amount(after, 's')} | {before / after:.1f} × |", flush=True)


if __name__ == "__main__":
    main()
