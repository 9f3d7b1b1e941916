"""`sweep`: one question at all points of a grid of parameters."""

from __future__ import annotations

import contextlib
import time
import warnings
from collections import deque
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, NamedTuple

import cloudpickle
import numpy as np
import xarray as xr

from .. import validate
from ..api.together import asks_for_widths, together
from ..io import datasets
from ..progress import Progress, Steps
from . import engine as engines
from . import store as stores
from .arrays import InMemory, specs
from .axes import Question, Study, study_of
from .blocks import Grid, grid_of, points_of_a_block
from .run import Run, answer_all
from .work import DONE, FAILED, TOGETHER, Answer, Schema, Task, alone, asking, schema_of

#: Points are measured for so long [s], the first aside, which pays for what is loaded once, unless it takes longer than that can; and at so
#: many places at most.
MEASURED, LOADED, PLACES = 0.2, 10.0, 16
#: Less work than processes take to start [s] is done without them.
START = 2.0


def sweep(
    question: Question,
    axes: dict[str, Any],
    *,
    store: str | Path | None = None,
    executor: Executor | None = None,
    workers: int | None = None,
    progress: Progress = True,
    shard: tuple[int, int] = (1, 1),
    repair: bool = False,
) -> xr.Dataset:
    """Ask a question at every point of a grid of parameters, in many processes.

    Parameters
    ----------
    question : function
        Of the axes' names; returns a Dataset of numbers, with the same variables, dimensions and coordinates at every point. Lambdas and
        functions of the running script are welcome. What it reduces (a map to its width, say) is never kept. One that asks for
        `beam_width` is called twice at a point: up to there, and again when the widths at many points have been computed at once.
    axes : dict
        Name -> 1-D array of different numbers or strings; names and their order are those of the result's first dimensions.
    store : path, optional
        A .zarr that is written block by block. The same call again goes on with what a kill, a full disk or another run left.
    executor : Executor, optional
        Who answers: any of `concurrent.futures`, dask's ``client.get_executor()``, one of mpi4py or executorlib. By default a pool of processes with
        one BLAS thread each; work of less than two seconds is done without it.
    workers : int, optional
        Processes of the pool, or of the executor: all cores by default. 1: this process alone.
    progress : bool or function
        True: a bar on stderr. A function wraps the range of points.
    shard : (k, n)
        The k-th of n parts of the blocks only, for machines that share nothing but the store.
    repair : bool
        Answer again blocks whose chunks are damaged or missing, and those with failed points.

    Returns
    -------
    Dataset
        On the axes and then the question's own dimensions; from a store, read when it is used. `status` is 1 where a point is answered, 2
        where it failed: its values are nan and `message` is its error. `provenance` of a point is the question's there.

    Warns
    -----
    RuntimeWarning
        Points failed, or the question warned.

    Raises
    ------
    ValueError
        An argument; a store of another study (says what differs), of another version, or with damage; a question that fails everywhere it is
        tried at first.
    OSError
        The system refused a write. What is in the store stays good.

    Examples
    --------
    >>> def width(eta, frequency):
    ...     slab = bp.Slab(bp.lmmd_cell(eta=eta), periods=450)
    ...     return bp.beam_width(slab, bp.GaussianBeam(0.096), frequency)
    >>> ds = bp.sweep(width, {"eta": [1 / 60, 1 / 30], "frequency": [2400.0, 2500.0, 2600.0]})
    >>> ds.fwhm_out.dims, ds.sizes["frequency"]
    (('eta', 'frequency'), 3)
    >>> bp.provenance(ds.isel(eta=1, frequency=0))["slab"].cell == bp.lmmd_cell(eta=1 / 30)
    True
    """
    study = study_of(question, axes)
    workers = None if workers is None else validate.as_count(workers, "workers")
    if executor is not None:
        validate.instance(executor, Executor, "executor")
    validate.flag_or_function(progress, "progress")
    way = _Way(executor, workers, progress, _part(shard, store), validate.flag(repair, "repair"))
    return _announced(_in_memory(study, way) if store is None else _in_store(study, stores.target(store), way))


class _Way(NamedTuple):
    """How a study is to be answered."""

    executor: Executor | None
    workers: int | None
    progress: Progress
    #: Number of this part of the blocks, and of all parts.
    part: tuple[int, int]
    repair: bool

    def engine(self, seconds: float) -> engines.Engine:
        """Who answers what takes so long in this process alone."""
        workers = self.workers or int(getattr(self.executor, "_max_workers", engines.cores()))
        if self.executor is not None:
            return engines.Given(self.executor, workers)
        return engines.Inline() if workers == 1 or seconds < START else engines.Processes(workers)


def _part(shard: Any, store: Any) -> tuple[int, int]:
    if not isinstance(shard, list | tuple) or len(shard) != 2:
        raise validate.refuse("shard", "a pair (k, n)", shard)
    k, n = (validate.as_count(value, "shard") for value in shard)
    if k > n or (n > 1 and store is None):
        raise validate.refuse("shard", "(k, n) with k from 1 to n, and a store if n is not 1", shard)
    return k - 1, n


# --- where the answers go -----------------------------------------------------------------------------------


def _in_memory(study: Study, way: _Way) -> xr.Dataset:
    sample = sample_of(study)
    kept = InMemory(study, sample.schema, sample.grid(study))
    _answer(study, kept, sample, range(kept.grid.size), way)
    described = specs(study, sample.schema, kept.grid)
    arrays = {name: (described[name].dims, v, described[name].attrs) for name, v in kept.arrays.items()}
    variables = {name: arrays.pop(name) for name in sample.schema.fields if name not in sample.schema.secondary}
    attrs = stores.attributes_of(study, sample.schema)
    return datasets.labelled(variables, {**study.coords(), **sample.schema.coords, **arrays}, attrs)


def _in_store(study: Study, path: Path, way: _Way) -> xr.Dataset:
    sample = None
    if not path.is_dir() or not any(path.iterdir()):
        sample = sample_of(study)
        stores.create(path, study, sample.schema, sample.grid(study), sample.seconds)
    kept = stores.Store(path, study)
    blocks = range(way.part[0], kept.grid.size, way.part[1])
    _check(kept, blocks, way.repair)
    if any(not kept.is_kept(block) for block in blocks):
        _answer(study, kept, sample or Sample(kept.schema, {}, kept.seconds), blocks, way)
    return kept.dataset()


def _check(kept: stores.Store, blocks: range, repair: bool) -> None:
    """Refuse damaged blocks, or make them empty, and those with failed points, to be answered again."""
    damaged = {block: wrong for block in blocks if kept.is_kept(block) and (wrong := kept.damage(block))}
    # another run may be repairing them
    damaged = {block: wrong for block, wrong in damaged.items() if kept.is_kept(block)}
    if damaged and not repair:
        wrong = next(iter(damaged.values()))
        raise ValueError(
            f"store: expected chunks as they were written, got damage in {len(damaged)} of {kept.grid.size} blocks, the first: {wrong}; "
            "answer them again with repair=True"
        )
    if repair:
        with contextlib.closing(kept.claims()) as claims:
            for again in (lambda: damaged, kept.failures):
                for block in set(again()) & set(blocks):
                    if claims.take(block) and kept.is_kept(block):
                        kept.forget(block)


# --- how they come ------------------------------------------------------------------------------------------


class Sample(NamedTuple):
    """What the first points show."""

    schema: Schema
    #: Number of a point -> its answer.
    known: dict[int, Answer]
    #: Time of a point.
    seconds: float

    def grid(self, study: Study) -> Grid:
        """Blocks that are worth their overhead."""
        return grid_of(study.shape, points_of_a_block(self.seconds, self.schema.bytes_each))


def sample_of(study: Study) -> Sample:
    """Answer points all over the study until their time is known.

    Raises
    ------
    ValueError
        None of them can be answered, or the answer is not one that a study can keep.
    """
    answers: dict[int, Answer] = {}
    shared: set[int] = set()
    seconds: list[float] = []
    schema = None
    places = np.unique(np.linspace(0, study.size - 1, PLACES).astype(int))
    with alone() as caught:
        for place, point in zip(places.tolist(), study.points(places), strict=True):
            start = time.perf_counter()
            answer, shares = asks_for_widths(asking(study.question, tuple(study.axes), point, caught))
            seconds.append(time.perf_counter() - start)
            answers[place] = answer
            if shares:
                shared.add(place)
            if schema is None and answer.dataset is not None:
                schema = schema_of(answer.dataset, set(study.axes))
            if schema is not None and (sum(seconds[1:]) > MEASURED or seconds[0] > LOADED):
                break
    if schema is None:
        message = next(iter(answers.values())).message
        raise ValueError(
            f"question: expected an answer at one of {len(answers)} points, got none, at the first: {message}"
        )
    # widths that share their work are computed again with their block, so that they do not depend on what was measured here
    known = {place: answer for place, answer in answers.items() if place not in shared}
    each = _seconds_together(study) if len(shared) == len(answers) and seconds[-1] < LOADED else None
    return Sample(schema, known, float(np.median(seconds[1:] or seconds)) if each is None else each)


def _seconds_together(study: Study) -> float:
    """Time of a point whose work is shared with neighbours."""
    flat = np.arange(min(study.size, TOGETHER // 4))
    with alone() as caught:
        start = time.perf_counter()
        together([asking(study.question, tuple(study.axes), point, caught) for point in study.points(flat)])
        return (time.perf_counter() - start) / flat.size


def _answer(study: Study, kept: InMemory | stores.Store, sample: Sample, blocks: range, way: _Way) -> None:
    """Answer those blocks that are not kept yet."""
    try:
        question = cloudpickle.dumps(study.question)
    except Exception as error:
        raise ValueError(
            f"question: expected a function that can be sent to processes, got one that cannot: {error}"
        ) from None
    grid = kept.grid
    waiting = deque(block for block in blocks if not kept.is_kept(block))
    sizes = {block: grid.points(block).size for block in blocks}
    steps = Steps(way.progress, sum(sizes.values()), "study")

    def task(block: int) -> Task:
        flat = grid.points(block)
        known = {k: sample.known[p] for k, p in enumerate(flat.tolist()) if p in sample.known}
        return Task(question, tuple(study.axes), study.points(flat), sample.schema, known)

    steps.step(sum(sizes.values()) - sum(sizes[block] for block in waiting))
    seconds = sample.seconds * sum(sizes[block] for block in waiting)
    with contextlib.closing(kept.claims()) as claims:
        engine = way.engine(seconds)
        answer_all(Run(kept, claims, task, engine, lambda block: steps.step(sizes[block]), waiting))
    steps.close()


def _announced(ds: xr.Dataset) -> xr.Dataset:
    """The dataset, after a warning of points that failed or warned."""
    status, message = ds["status"].values, ds["message"]
    for kind, what in ((FAILED, "failed: their values are nan"), (DONE, "warned")):
        told = status == kind if kind == FAILED else (status == kind) & (message.values != "")
        if np.any(told):
            first = ds["message"].values[tuple(np.argwhere(told)[0])]
            text = f"{np.count_nonzero(told)} of {status.size} points {what}; message has all, the first is: {first}"
            warnings.warn(text, RuntimeWarning, stacklevel=3)
    return ds
