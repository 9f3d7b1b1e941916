"""The unit of work: boxes of neighbouring points, which are the chunks of the result."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: What a block costs beside its points [s]: sending, writing a dozen chunks, waiting; `experiments/benchmarks/sweep.py` measures it.
OVERHEAD = 0.02
#: The part of a block's time that this may be.
SHARE = 1 / 20
#: The largest block [bytes]: it is sent, held and written whole.
LARGEST = 2**26


@dataclass(frozen=True)
class Grid:
    """All points of a study, in blocks of the shape `chunk` (smaller at the upper ends)."""

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of blocks along each axis."""
        return tuple(-(-n // m) for n, m in zip(self.shape, self.chunk, strict=True))

    @property
    def size(self) -> int:
        """Number of blocks."""
        return math.prod(self.counts)

    def index(self, block: int) -> tuple[int, ...]:
        """Place of a block along each axis."""
        return tuple(map(int, np.unravel_index(block, self.counts)))

    def where(self, block: int) -> tuple[slice, ...]:
        """The part of the result that a block is."""
        corner = zip(self.index(block), self.shape, self.chunk, strict=True)
        return tuple(slice(i * m, min(n, (i + 1) * m)) for i, n, m in corner)

    def box(self, block: int) -> tuple[int, ...]:
        """Number of points of a block along each axis."""
        return tuple(part.stop - part.start for part in self.where(block))

    def points(self, block: int) -> np.ndarray:
        """Numbers of a block's points in the study, the last axis fastest."""
        places = np.ix_(*(np.arange(part.start, part.stop) for part in self.where(block)))
        return np.ravel_multi_index(places, self.shape).ravel()


def grid_of(shape: tuple[int, ...], points: int) -> Grid:
    """Blocks of about `points` points, the last axes whole, each axis in parts of nearly equal length."""
    chunk = []
    for length in reversed(shape):
        parts = -(-length // min(length, max(1, points)))
        chunk.append(-(-length // parts))
        points //= length
    return Grid(shape, tuple(reversed(chunk)))


def points_of_a_block(seconds: float, bytes_each: int) -> int:
    """So many points that a block's overhead is a twentieth of its time, and that it is not too large.

    Parameters
    ----------
    seconds, bytes_each : of a point, as measured
    """
    return max(1, min(math.ceil(OVERHEAD / SHARE / max(seconds, 1e-6)), LARGEST // max(1, bytes_each)))
