"""Which run works on which block of a store: locks that the system releases when their process ends, however it ends.

The lock of block b is that of byte b of an empty file in the store (POSIX record locks, which network file systems pass on), in the folder of
an array, where readers of Zarr do not look. No clock is read and nothing has to be cleaned up. Two sweeps of one process, and runs on Windows or on
a file system without locks, do not see each other: they may do a block twice, with the same values.
"""

from __future__ import annotations

import contextlib
import errno
from pathlib import Path
from typing import IO

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

#: The file that is locked.
NAME = "status/claims"


class Claims:
    """The claims of this run on the blocks of a store."""

    def __init__(self, store: Path) -> None:
        self._file: IO[bytes] = (store / NAME).open("ab")

    def take(self, block: int) -> bool:
        """Whether a block is this run's now: no living run has it."""
        if fcntl is None:
            return True
        try:
            fcntl.lockf(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, block)
        except OSError as error:
            return error.errno not in (errno.EACCES, errno.EAGAIN)  # else there are no locks here
        return True

    def release(self, block: int) -> None:
        """Give a block back, done or not."""
        if fcntl is not None:
            with contextlib.suppress(OSError):
                fcntl.lockf(self._file, fcntl.LOCK_UN, 1, block)

    def close(self) -> None:
        """Give all back."""
        self._file.close()


class Unclaimed:
    """Of blocks in memory, which no other run can see."""

    def take(self, block: int) -> bool:
        """Every block is this run's."""
        return True

    def release(self, block: int) -> None:
        """There is nothing to give back."""

    def close(self) -> None:
        """There is nothing to give back."""
