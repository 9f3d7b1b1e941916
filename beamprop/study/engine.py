"""Engines: who answers the tasks, how many are under way, and what happens when a process dies or the user stops.

Any `concurrent.futures.Executor` will do. The pool of processes that is used by default is made here: its workers start afresh (spawn), know nothing of
the script that started them (questions come pickled by value), and end with it, however it ends.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from typing import Any, Protocol

#: Blocks under way for each worker: one that is computed and one that waits.
AHEAD = 2


class Engine(Protocol):
    """Where tasks go."""

    #: How many tasks are under way at most.
    width: int

    def submit(self, work: Callable[[Any], Any], task: Any) -> Future:
        """Hand a task over."""

    def restart(self) -> bool:
        """Begin afresh after a worker has died; False if that is another's to do."""

    def close(self) -> None:
        """Let nothing go on."""


class Inline:
    """This process, a task at a time."""

    width = 1

    def submit(self, work: Callable[[Any], Any], task: Any) -> Future:
        """Do it now."""
        future: Future = Future()
        future.set_result(work(task))
        return future

    def restart(self) -> bool:
        """There is nothing to restart."""
        return False

    def close(self) -> None:
        """There is nothing to close."""


class Given:
    """An executor of the user's, which stays open."""

    def __init__(self, executor: Executor, workers: int) -> None:
        self._executor, self._futures, self.width = executor, set[Future](), AHEAD * workers

    def submit(self, work: Callable[[Any], Any], task: Any) -> Future:
        """Hand a task over."""
        future = self._executor.submit(work, task)
        self._futures.add(future)
        future.add_done_callback(self._futures.discard)
        return future

    def restart(self) -> bool:
        """It is the user's."""
        return False

    def close(self) -> None:
        """Take back what has not begun."""
        for future in list(self._futures):
            future.cancel()


class Processes:
    """A pool of processes of one thread each."""

    def __init__(self, workers: int) -> None:
        self._workers, self.width = workers, AHEAD * workers
        self._start()

    def _start(self) -> None:
        _start_tracker()
        context = multiprocessing.get_context("spawn")
        self._leash = context.Pipe(duplex=False)
        self._executor = ProcessPoolExecutor(self._workers, context, _begin, (self._leash[0],))

    def submit(self, work: Callable[[Any], Any], task: Any) -> Future:
        """Hand a task over; workers are started here."""
        with _without_main():
            return self._executor.submit(work, task)

    def restart(self) -> bool:
        """A pool of new processes."""
        self.close()
        self._start()
        return True

    def close(self) -> None:
        """End the workers, whatever they do."""
        for end in self._leash:
            end.close()
        self._executor.shutdown(wait=True, cancel_futures=True)


def _start_tracker() -> None:
    """Start the process that removes the semaphores of killed ones, which it would warn of as leaks: after a kill they are none."""
    if os.name == "posix":
        sys.warnoptions.append(quiet := "ignore:resource_tracker")
        try:
            resource_tracker.ensure_running()
        finally:
            sys.warnoptions.remove(quiet)


def _begin(leash: Connection) -> None:
    """A worker's first steps: Ctrl-C is for the process that started it, and it ends with that."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(leash,), daemon=True).start()


def _end_with(leash: Connection) -> None:
    """Wait until the other end of a pipe is closed, by hand or by the end of its process."""
    with contextlib.suppress(EOFError, OSError):
        leash.recv()
    os._exit(1)


@contextlib.contextmanager
def _without_main() -> Iterator[None]:
    """Hide the file of the running script while processes start, or each would run it again, and ask for
    ``if __name__ == "__main__"``; they need it not, for what stands in it is pickled by value.
    """
    names = vars(sys.modules["__main__"])
    hidden: dict[str, Any] = {name: names.pop(name) for name in ("__file__", "__spec__") if name in names}
    names["__spec__"] = None
    try:
        yield
    finally:
        names.update(hidden)


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
