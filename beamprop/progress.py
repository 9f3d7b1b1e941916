"""Progress of long work: one meaning of `progress=` for every question."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from . import validate

#: What a user may give: whether to show a bar, or a function that wraps the items of a loop (`tqdm.tqdm`, say).
Progress = bool | Callable[[Iterable[Any]], Iterable[Any]]
#: Work that ends sooner shows no bar [s]: one would only flicker.
SHOWN_AFTER = 1.0


def watched(progress: Progress, items: Iterable[Any], what: str) -> Iterable[Any]:
    """The items of a loop, watched.

    Parameters
    ----------
    progress : bool or function
        True: a bar on stderr, if the work takes more than a second (`SHOWN_AFTER`). False: nothing. A function wraps the items.
    items : iterable, of known length where a bar is to say how far it is
    what : str
        What the bar is called.

    Raises
    ------
    ValueError
        `progress` is neither.
    """
    if callable(validate.flag_or_function(progress, "progress")):
        return progress(items)  # type: ignore[operator]
    if not progress:
        return items
    from tqdm import tqdm

    return tqdm(items, desc=what, delay=SHOWN_AFTER, file=sys.stderr, leave=False)


class Steps:
    """Steps of a solver that are counted rather than looped over."""

    def __init__(self, progress: Progress, count: int, what: str) -> None:
        self._left: Iterator[Any] = iter(watched(progress, range(count), what))

    def step(self, count: int) -> None:
        """`count` more are done."""
        for _ in range(count):
            next(self._left, None)

    def close(self) -> None:
        """No more are done."""
        for _ in self._left:
            pass
