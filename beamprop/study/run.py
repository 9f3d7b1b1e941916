"""The blocks of a study one after another, many at a time, whatever dies meanwhile."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass, field
from typing import Protocol

from .arrays import Kept
from .engine import Engine
from .work import FAILED, Result, Task, answers, empty_result

#: How often blocks that another run works on are looked at [s].
LOOK = 0.2
#: A block whose worker dies so many times, with no other under way, has failed.
DEATHS = 2
#: So many blocks that fail so, one after another, mean that no worker lives.
HOPELESS = 10


class Locks(Protocol):
    """Claims on blocks, between runs."""

    def take(self, block: int) -> bool:
        """Whether a block is this run's now."""

    def release(self, block: int) -> None:
        """Give a block back."""


@dataclass
class Run:
    """What is to be done, what is under way, and what is to be tried alone because its worker may have died of it."""

    kept: Kept
    locks: Locks
    task: Callable[[int], Task]
    engine: Engine
    step: Callable[[int], None]
    waiting: deque[int]
    flight: dict[Future, int] = field(default_factory=dict)
    suspects: deque[int] = field(default_factory=deque)
    deaths: dict[int, int] = field(default_factory=dict)
    lost: int = 0


def answer_all(run: Run) -> None:
    """Answer every block that waits, or wait until another run has.

    Raises
    ------
    RuntimeError
        Workers die before any block is answered.
    """
    try:
        while run.waiting or run.flight or run.suspects:
            _submit(run)
            if run.flight:
                done, _ = wait(run.flight, LOOK, FIRST_COMPLETED)
                _collect(run, done)
            else:
                time.sleep(LOOK)
    finally:
        run.engine.close()
        for block in (*run.flight.values(), *run.suspects):
            run.locks.release(block)


def _submit(run: Run) -> None:
    """Hand over as many blocks as may be under way; a suspect goes alone."""
    if run.suspects:
        if not run.flight:
            _hand_over(run, run.suspects[0])
        return
    for _ in range(len(run.waiting)):
        if len(run.flight) >= run.engine.width:
            return
        block = run.waiting.popleft()
        if run.kept.is_kept(block):
            run.step(block)
        elif not run.locks.take(block):
            run.waiting.append(block)
        elif run.kept.is_kept(block):  # another run finished it before it gave it back
            run.locks.release(block)
            run.step(block)
        else:
            _hand_over(run, block)


def _hand_over(run: Run, block: int) -> None:
    run.flight[run.engine.submit(answers, run.task(block))] = block


def _collect(run: Run, done: set[Future]) -> None:
    """Keep what is answered; begin afresh if a worker has died."""
    dead = False
    for future in done:
        try:
            result = future.result()
        except BrokenExecutor:
            dead = True
        else:
            run.lost = 0
            _keep(run, run.flight.pop(future), result)
    if dead:
        _bury(run)


def _keep(run: Run, block: int, result: Result) -> None:
    run.kept.put(block, result)
    run.locks.release(block)
    if run.suspects and run.suspects[0] == block:
        run.suspects.popleft()
    run.step(block)


def _bury(run: Run) -> None:
    """What was under way is suspect; a block that was alone, twice, has failed."""
    blocks = sorted(run.flight.values())
    run.flight.clear()
    if not run.engine.restart():
        run.suspects.extend(blocks)
        raise RuntimeError(
            "executor: expected one whose workers live, got one that has broken; the same call goes on"
        ) from None
    if not run.suspects:
        run.suspects.extend(blocks)
        return
    block = run.suspects[0]
    run.deaths[block] = run.deaths.get(block, 0) + 1
    if run.deaths[block] >= DEATHS:
        run.lost += 1
        if run.lost >= HOPELESS:
            raise RuntimeError(
                f"workers: expected processes that live, got {HOPELESS} blocks in a row that none survived"
            )
        task = run.task(block)
        message = (
            "the process that answered it died (killed, perhaps for want of memory), twice, with nothing beside it"
        )
        _keep(run, block, empty_result(task.schema, len(task.points), FAILED, message))
