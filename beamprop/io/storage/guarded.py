"""A file for HDF5 to write into that never fails while HDF5 looks.

HDF5 does not survive a failing write on closing a file (a full disk, a limit of file sizes): the process crashes. Here space is
reserved before the first write, and a write that fails nevertheless is remembered; its bytes are kept in memory, where HDF5 finds them if
it reads them again, and the failure is raised by `check` and `finish`, outside of HDF5. For the same reason Ctrl-C waits until HDF5 has
returned (`uninterrupted`): it would be a failing write.
"""

from __future__ import annotations

import contextlib
import errno
import os
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: Of the bytes that could not be written all are kept up to this many; then small pieces alone, since HDF5 reads its tables again, which are
#: small, and not the values.
KEEP, SMALL = 2**26, 2**16


class GuardedFile:
    """A new file, readable and writable, as h5py's driver for file objects wants it."""

    def __init__(self, path: Path, reserve: int = 0) -> None:
        self._file = open(path, "w+b", buffering=0)  # noqa: SIM115 (`close` closes it)
        self._size = self._position = self._kept = 0
        self._unwritten: list[tuple[int, bytes]] = []
        self._failure: OSError | None = None
        try:
            _reserve(self._file.fileno(), reserve)
        except OSError:
            self._file.close()
            raise

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset from the begin or the end."""
        self._position = offset + (self._size if whence == os.SEEK_END else 0)
        return self._position

    def tell(self) -> int:
        """The offset of what is read or written next."""
        return self._position

    def read(self, count: int) -> bytes:
        """The next bytes."""
        out = bytearray(count)
        return bytes(out[: self.readinto(out)])

    def readinto(self, buffer: Any) -> int:
        """Fill a buffer with the next bytes, those that could not be written among them."""
        view = memoryview(buffer).cast("B")
        start, count = self._position, max(0, min(len(view), self._size - self._position))
        self._file.seek(start)
        done = 0
        while done < count and (n := self._file.readinto(view[done:count])):
            done += n
        for offset, piece in self._unwritten:
            first, last = max(start, offset), min(start + count, offset + len(piece))
            if first < last:
                view[first - start : last - start] = piece[first - offset : last - offset]
        self._position += count
        return count

    def write(self, data: Any) -> int:
        """Write, or remember that it failed."""
        view = memoryview(data).cast("B")
        if self._failure is None:
            try:
                self._write_all(view)
            except OSError as error:
                self._failure = error
        if self._failure is not None and (self._kept < KEEP or len(view) < SMALL):
            with contextlib.suppress(MemoryError):
                self._unwritten.append((self._position, bytes(view)))
                self._kept += len(view)
        self._position += len(view)
        self._size = max(self._size, self._position)
        return len(view)

    def _write_all(self, view: memoryview) -> None:
        self._file.seek(self._position)
        done = 0
        while done < len(view):
            done += self._file.write(view[done:]) or 0

    def truncate(self, size: int) -> int:
        """Take a size; the file itself gets it in `finish`, so that what is reserved stays reserved."""
        self._size = size
        return size

    def flush(self) -> None:
        """Nothing is buffered."""

    def check(self) -> None:
        """Raise the first failure."""
        if self._failure is not None:
            raise self._failure

    def finish(self) -> None:
        """Give the file its size, or raise the first failure."""
        self.check()
        self._file.truncate(self._size)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _reserve(handle: int, size: int) -> None:
    """Reserve space for a file; nothing where the system or the file system knows no reservations."""
    if size <= 0 or not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(handle, 0, size)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EFBIG, errno.EDQUOT):
            raise


@contextlib.contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back; it takes effect at the end. Python interrupts its main thread alone."""
    usual = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(usual):
        yield
        return
    pressed: list[tuple[int, Any]] = []
    signal.signal(signal.SIGINT, lambda number, frame: pressed.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, usual)
        if pressed:
            usual(*pressed[0])
