"""`together`: many questions at once, whose widths at single points are computed in one go.

A question is any function that asks for `beam_width` at a point and may go on with the answer. It is asked twice: up to the
point, which is noted, and again when the widths at the points of all questions are known (`widths_of`). Whatever else it asks for is
answered as ever, so that its answer is that of a plain call; only the time differs. This is what a sweep does with a block of points.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from contextvars import ContextVar
from typing import Any, NamedTuple

from ..media.structures import Slab
from ..sources.base import Beam
from .widths_of import Widths, widths_of


class Point(NamedTuple):
    """Where `beam_width` is asked for: its arguments, checked."""

    slab: Slab
    beam: Beam
    frequency: float
    rtol: float
    air_distance: float | None


class _Unknown(BaseException):
    """Ends a question at a point whose widths are not known yet; no handler of the question's own catches it."""


class _Call:
    """A call of a question: the points that it came to, in order, and their widths."""

    def __init__(self, question: Callable[[], Any]) -> None:
        self.question = question
        self.points: list[Point] = []
        self.widths: list[Widths | None] = []  #: None of points that are computed by themselves
        self.passed = 0

    def answer(self) -> Any:
        """The answer, or the error that was raised; _Unknown where a point stands in the way."""
        self.passed = 0
        token = _RUNNING.set(self)
        try:
            return self.question()
        except _Unknown:
            return _Unknown
        except Exception as error:
            return error
        finally:
            _RUNNING.reset(token)

    def known(self, point: Point) -> Widths | None:
        """The widths at a point that is met again."""
        place, self.passed = self.passed, self.passed + 1
        if place < len(self.points):  # a question that comes to another point than before is answered there and then
            return self.widths[place] if self.points[place] == point else None
        self.points.append(point)
        raise _Unknown


_RUNNING: ContextVar[_Call | None] = ContextVar("question", default=None)


def widths_known(point: Point) -> Widths | None:
    """The widths at a point if they were computed for a question that is asked `together`; else None."""
    call = _RUNNING.get()
    return None if call is None or not isinstance(point.beam, Hashable) else call.known(point)


def together(questions: Sequence[Callable[[], Any]]) -> list[Any]:
    """The answers to questions without arguments; in the place of one that raised an error the error.

    Examples
    --------
    >>> from functools import partial
    >>> from beamprop.api.together import together
    >>> def width(eta):
    ...     return bp.beam_width(bp.Slab(bp.lmmd_cell(eta=eta), 45), bp.GaussianBeam(0.096), 2500.0).fwhm_out.item()
    >>> [round(answer, 5) for answer in together([partial(width, 1 / 60), partial(width, 1 / 50)])]
    [0.09665, 0.09688]
    """
    return _answers([_Call(question) for question in questions])


def asks_for_widths(question: Callable[[], Any]) -> tuple[Any, bool]:
    """The answer to a question or its error, and whether it asked for widths that are computed in one go with those of others."""
    call = _Call(question)
    (answer,) = _answers([call])
    return answer, bool(call.points)


def _answers(calls: list[_Call]) -> list[Any]:
    answers: list[Any] = [_Unknown] * len(calls)
    waiting = list(range(len(calls)))
    while waiting:
        for i in waiting:
            answers[i] = calls[i].answer()
        waiting = [i for i in waiting if answers[i] is _Unknown]
        for i, widths in zip(waiting, _widths([calls[i].points[-1] for i in waiting]), strict=True):
            calls[i].widths.append(widths)
    return answers


def _widths(points: list[Point]) -> list[Widths | None]:
    """The widths at points; None where an error was raised at any of those that share the settings."""
    widths: list[Widths | None] = [None] * len(points)
    settings = {(point.rtol, point.air_distance) for point in points}
    for rtol, air_distance in settings:
        same = [i for i, point in enumerate(points) if (point.rtol, point.air_distance) == (rtol, air_distance)]
        slabs, beams, frequency = zip(*(points[i][:3] for i in same), strict=True)
        try:
            many = widths_of(slabs, beams, frequency, rtol, air_distance)
        except ValueError:  # the points are computed one by one then, and the one at fault raises it again
            continue
        for place, i in enumerate(same):
            widths[i] = many.at(place)
    return widths
