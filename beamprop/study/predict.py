"""What a study will take, from a few of its points: time, memory and the size of its file."""

from __future__ import annotations

import contextlib
import math
import time
import warnings
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from .. import memory, parameters
from ..io import datasets
from . import engine, questions
from .axes import Study, study_of
from .files import Mistakes, StudyFile
from .schema import Mistake
from .sweep import sample_of

#: What a picture of each question shows: the dimensions that it may have beside those of the sweep.
DRAWN = {
    "field": ({"x", "y", "z"}, "one frequency and one angle, and axes for x and z, or with y for two of x, y and z"),
    "beam_width": ({"frequency", "angle"}, "an axis for frequency or angle"),
    "scattering": ({"frequency", "kx", "kx_over_k0", "angle"}, "an axis for frequency, kx_over_k0, kx or angle"),
    "bloch": ({"frequency", "kx_over_k0"}, "an axis for frequency or kx_over_k0"),
    "beam_measures": ({"frequency", "angle"}, "an axis for frequency or angle"),
}
#: Parts of a question's longest axis that are measured, whose difference shows what each value of it takes.
FEWER, MORE = 2, 8
#: What an array's own description takes in a store [bytes].
ARRAY = 900.0
#: So many neighbouring points show how their records of provenance compress together.
NEIGHBOURS = 4


class Cost(NamedTuple):
    """What a study takes; sizes in bytes, times in seconds."""

    points: int
    #: Of the whole study, on `workers` cores.
    seconds: float
    workers: int
    held: float
    file: float
    #: Number of blocks, and the largest number of points in one; (1, 1) without a sweep.
    blocks: tuple[int, int]
    #: Name -> dimension -> size.
    variables: dict[str, dict[str, int]]

    def lines(self) -> list[str]:
        """As a person reads it."""
        number, largest = self.blocks
        cores = "1 core" if self.workers == 1 else f"{self.workers} cores"
        return [
            f"points    {self.points}" + (f", in {number} blocks of at most {largest}" if number > 1 else ""),
            f"time      about {duration(self.seconds)} on {cores}",
            f"memory    about {memory.text(self.held)}",
            f"file      about {memory.text(self.file)}",
        ]


def duration(seconds: float) -> str:
    """A time as a person reads it."""
    for unit, size in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= 2 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.2g} s"


def predict(study: StudyFile) -> Cost:
    """What a study will take.

    Raises
    ------
    Mistakes
        A point cannot be answered, more is held than fits, or there is no picture of the answer.
    """
    try:
        cost = _of_sweep(study) if study.axes else _of_question(study)
    except ValueError as error:
        raise study.refused(error) from None
    wrong = list(_too_large(study, cost)) + list(not_drawn(study, cost.variables))
    if wrong:
        raise Mistakes(study.path, wrong)
    return cost


def _of_sweep(study: StudyFile) -> Cost:
    points = study_of(study.point, dict(study.axes))
    sample = sample_of(points)
    grid = sample.grid(points)
    workers = study.output["workers"] or engine.cores()
    each = sample.schema.bytes_each + 17.0  # status, record and message of a point
    largest = min(points.size, math.prod(grid.chunk))
    held = 1.2 * points.size * each if study.output["store"] is None else 2.0 * workers * largest * each
    variables = {
        name: dict(zip((*points.axes, *f.dims), (*points.shape, *f.shape), strict=True))
        for name, f in sample.schema.fields.items()
        if name not in sample.schema.secondary
    }
    seconds = sample.seconds * points.size / min(workers, grid.size)
    file = (
        points.size * each
        + grid.size * _records(points, largest)
        + ARRAY * (len(sample.schema.fields) + len(points.axes) + 4)
    )
    return Cost(points.size, seconds, workers, held, file, (grid.size, largest), variables)


def _records(points: Study, largest: int) -> float:
    """Size of the records of provenance of a block, by those of the first points, which are neighbours as in a block."""
    first = points.points(np.arange(min(NEIGHBOURS, largest, points.size)))
    texts: dict[str, None] = {}
    for point in first:
        with contextlib.suppress(ValueError), warnings.catch_warnings():  # points that fail have no record
            warnings.simplefilter("ignore")
            ds = points.question(**dict(zip(points.axes, point, strict=True)))
            texts[ds.attrs.get("provenance", "")] = None
    single, several = len(datasets.packed(list(texts)[:1])), len(datasets.packed(list(texts)))
    return single + (several - single) / max(1, len(first) - 1) * (largest - 1)


def _of_question(study: StudyFile) -> Cost:
    description = dict(study.point.description)
    given = questions.field_arguments(description) if study.name == "field" else questions.arguments(description)
    axes = {
        n: v
        for n, v in given.items()
        if parameters.is_several(v) and n in ("frequency", "angle", "z", "kx", "kx_over_k0")
    }
    if study.name == "field":
        memory.check_field(tuple(np.size(given[n]) for n in ("frequency", "angle", "z", "x")))
    longest = max(axes, key=lambda name: len(axes[name]), default=None)
    if longest is None or len(axes[longest]) <= MORE:
        seconds, size, variables = _measured(description)
        return Cost(1, seconds, 1, 2 * size, size, (1, 1), variables)
    (_, _, _), fewer, more = (
        _measured(_with(description, longest, _part(axes[longest], count))) for count in (FEWER, FEWER, MORE)
    )
    steps = (len(axes[longest]) - MORE) / (MORE - FEWER)
    seconds, size = (high + steps * max(0.0, high - low) for low, high in zip(fewer[:2], more[:2], strict=True))
    return Cost(1, seconds, 1, 2 * size, size, (1, 1), more[2])


def _part(values: list[float], count: int) -> list[float]:
    """Values all over an axis, with both its ends."""
    return [values[round(i * (len(values) - 1) / (count - 1))] for i in range(count)]


def _with(description: dict[str, Any], name: str, values: list[float]) -> dict[str, Any]:
    return description | {"question": description["question"] | {name: values}}


def _measured(description: dict[str, Any]) -> tuple[float, float, dict[str, dict[str, int]]]:
    """Time and size of an answer, and the sizes of its variables."""
    start = time.perf_counter()
    ds = questions.ask(description)
    seconds = time.perf_counter() - start
    return seconds, float(ds.nbytes), {str(n): {str(d): s for d, s in v.sizes.items()} for n, v in ds.data_vars.items()}


def before(study: StudyFile) -> Cost | None:
    """What has to be known before a study runs: the cost of a sweep; of one question only that there is a picture of it.

    Raises
    ------
    Mistakes
        As `predict`.
    """
    if study.axes:
        return predict(study)
    given = questions.arguments(study.point.description)
    missing = {"field": ("x", "z"), "beam_width": ("frequency",), "bloch": ("kx_over_k0",), "scattering": ()}
    defaults = [name for name in missing.get(study.name, ()) if given[name] is None]
    if study.name == "scattering" and all(given[name] is None for name in questions.LATERAL):
        defaults = ["kx_over_k0"]
    dims = tuple(name for name in given if name in parameters.AXES and parameters.is_several(given[name])) + tuple(
        defaults
    )
    if wrong := list(not_drawn(study, {"": dict.fromkeys(dims, 2)})):
        raise Mistakes(study.path, wrong)
    return None


def _too_large(study: StudyFile, cost: Cost) -> Iterable[Mistake]:
    limit = memory.limit()
    if cost.held > limit:
        expected = f"expected a study that fits into {memory.text(limit)} of memory"
        got = f"got {cost.points} points that take about {memory.text(cost.held)}, and {duration(cost.seconds)} on {cost.workers} cores"
        advice = (
            "; name a .zarr, which takes it block by block"
            if study.axes and study.output["store"] is None
            else "; ask for fewer points"
        )
        yield Mistake("output.store" if study.axes else "question", f"{expected}, {got}{advice}")


def not_drawn(study: StudyFile, variables: dict[str, dict[str, int]]) -> Iterable[Mistake]:
    """What forbids a picture of variables of these sizes."""
    quantity = study.output["quantity"]
    if study.output["plot"] is None:
        return
    if study.axes:
        shown = quantity or next(iter(variables))
        if shown not in variables:
            yield Mistake("output.quantity", f"expected {' or '.join(variables)}, got {shown!r}")
        else:
            yield from _sweep_not_drawn(study, variables[shown])
        return
    if quantity is not None and quantity not in parameters.QUANTITIES.get(study.name, (quantity,)):
        expected = " or ".join(map(repr, parameters.QUANTITIES[study.name]))
        yield Mistake("output.quantity", f"expected {expected}, got {quantity!r}")
    if study.name not in DRAWN:
        return
    dims, expected = DRAWN[study.name]
    got = set().union(*variables.values())
    along = study.output["along"]
    if not got & dims or (study.name == "field" and (len(got & dims) < 2 or got - dims)):
        yield Mistake("output.plot", f"expected {expected}, got {', '.join(sorted(got)) or 'one value'}")
    elif along is not None and along not in got:
        yield Mistake("output.along", f"expected {' or '.join(sorted(got))}, got {along!r}")


def _sweep_not_drawn(study: StudyFile, sizes: dict[str, int]) -> Iterable[Mistake]:
    """What forbids a picture of a variable of a sweep: the plan of the picture itself."""
    from ..plot import spread

    band = study.output["band"]
    several = {name: size for name, size in sizes.items() if size > 1}
    if band is not None and band not in several:
        yield Mistake("output.band", f"expected {' or '.join(several)}, got {band!r}")
        return
    across = {name: size for name, size in several.items() if name != band}
    coords = {name: (name, list(values)) for name, values in study.axes.items() if name in across}
    values = np.broadcast_to(0.0, tuple(across.values()))
    v = datasets.labelled({"shown": (tuple(across), values)}, coords, {})["shown"]
    try:
        spread.plan(v, spread.axis_along(v, study.output["along"]))
    except ValueError as error:
        name, _, said = str(error).partition(": ")
        yield Mistake("output.along" if name == "along" else "output.plot", said.partition(": select")[0])
