"""Reading, whatever the format: one version of a file, although another may take its place meanwhile, and variables one by one."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

from .whole import scratch_of

#: Times to begin again, and to wait for a name that a writer is just giving away [s].
TRIES, PAUSE, PATIENCE = 1000, 0.01, 2.0
#: Values may be this much larger than what a file stores of them, or small.
EXPANSION, HARMLESS = 2**16, 2**28


def read_settled(path: Path, read: Callable[[Path], xr.Dataset]) -> xr.Dataset:
    """Let `read` read a file or folder, again if another took its name before it was done.

    Raises
    ------
    ValueError
        No such file, what `read` raises, or a file that never stays long enough to be read.
    """
    for _ in range(TRIES):
        handle = _open(path)
        try:
            # while it is open, no other file gets its number
            before = _identity(path if handle is None else handle)
            failure: Exception | None = None
            try:
                ds = read(path)
            except (ValueError, OSError) as error:
                failure = error
            if before is not None and _identity(path) == before:
                if failure is not None:
                    raise failure
                return ds
        finally:
            if handle is not None:
                os.close(handle)
    raise ValueError(f"{path}: expected a file that stays while it is read, got {TRIES} replacements")


def _open(path: Path) -> int | None:
    """A handle that pins a file's number; None where the system opens no folders (Windows)."""
    waited = 0.0
    while True:
        try:
            return os.open(path, os.O_RDONLY)
        except (FileNotFoundError, NotADirectoryError):
            # between the two renames of a system that cannot exchange names there is neither old nor new
            if waited >= PATIENCE or not path.parent.is_dir() or not scratch_of(path):
                raise ValueError(f"path: expected an existing file, got {str(path)!r}") from None
            time.sleep(PAUSE)
            waited += PAUSE
        except (ValueError, OSError) as error:
            if isinstance(error, PermissionError) and os.name == "nt" and path.is_dir():
                return None
            if isinstance(error, OSError) and error.errno != errno.ENAMETOOLONG:
                raise
            raise ValueError(f"path: expected a name that the file system takes, got {str(path)!r}") from None


def _identity(path: Path | int) -> tuple[int, int] | None:
    try:
        status = os.stat(path)
    except FileNotFoundError:
        return None
    return status.st_dev, status.st_ino


class Refusal(ValueError):
    """A file is readable, but not to be read."""


def read_values(path: Path, open_dataset: Callable[[], xr.Dataset], unreadable: str) -> xr.Dataset:
    """Open a dataset and read all of its values into memory.

    Raises
    ------
    ValueError
        `unreadable`, which says what was expected and what came, where it cannot be opened; the name of the variable whose values
        are damaged.
    """
    try:
        opened = open_dataset()
    except (Refusal, MemoryError):
        raise
    except Exception as error:
        raise ValueError(f"{path}: {unreadable} ({error})") from None
    with opened:
        for name, v in opened.variables.items():
            _load(path, name, v)
        return opened.load()


def _load(path: Path, name: Any, v: xr.Variable) -> None:
    """Read the values of a variable; what goes wrong names it."""
    try:
        v.load()
    except MemoryError:
        raise
    except Exception as error:
        raise ValueError(f"{path}: expected the values of variable {name!r}, got damaged ones ({error})") from None


def refuse_expansion(where: str, array: str, size: float, stored: int) -> None:
    """Few stored bytes must not ask for much memory."""
    if size > HARMLESS and size > EXPANSION * stored:
        raise Refusal(f"{where}: expected values, got {array} of {size:.3g} bytes, of which {stored} are stored")
