"""Files and folders that appear under their name when they are complete, and never harm what stands there.

A draft is made in a scratch folder beside the target, brought to the disk (fsync), and put under its name in one step:
a rename for files, an exchange of the two names for folders (Linux, macOS), so that a reader finds the old or the new.
Where the system cannot exchange, two renames do it, and for a moment between them there is neither.

The scratch folder holds a lock file that the system releases when its process ends, however it ends. The next run that writes to
the same target removes scratch folders whose lock is free.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import json
import os
import re
import secrets
import shutil
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

try:
    import fcntl
except ImportError:  # Windows, where an open file cannot be removed: that serves as the lock
    fcntl = None  # type: ignore[assignment]

LOCK, REPLACED = "lock", "replaced"
#: A scratch folder without a lock file and without contents is abandoned after this time [s].
FORGOTTEN = 600.0
#: How often, and at which intervals [s], the scratch folder of a failed run is removed.
PATIENCE, PAUSE = 5, 0.02
#: How often a name is tried for that another writer takes at the same time.
TRIES = 100
_METADATA = {"zarr.json", ".zgroup", ".zarray", ".zattrs", ".zmetadata"}
_CHUNK = re.compile(r"c|(c\.)?\d+(\.\d+)*")
#: errno of a system or file system that cannot exchange two names.
_CANNOT = {errno.ENOSYS, errno.EINVAL, errno.EOPNOTSUPP, errno.ENOTSUP}


def check_target(path: str | Path) -> Path:
    """The path, if a file or store can be written there.

    Raises
    ------
    ValueError
        The folder is missing or cannot be written, the name is too long, or a folder of other things is in the way.
    """
    path = Path(path)
    if "\0" in str(path):
        raise ValueError(f"path: expected a name that the file system takes, got {str(path)!r}")
    try:
        folder = path.parent.is_dir()
        os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:
        raise ValueError(f"path: expected a name that the file system takes, got {path!s} ({error.strerror})") from None
    if not folder:
        raise ValueError(f"path: expected a file in an existing folder, got {str(path)!r}")
    if not os.access(path.parent, os.W_OK | os.X_OK):
        raise ValueError(f"path: expected a file in a folder that can be written to, got {str(path)!r}")
    if path.is_dir() and not path.is_symlink() and (other := not_of_a_store(path)) is not None:
        raise ValueError(
            f"path: expected a file or a Zarr store to replace, got a folder with other things in it: {str(other)!r}"
        )
    return path


def write_whole(path: str | Path, write: Callable[[Path], None]) -> None:
    """Let `write` make a file or folder beside `path`, and give it its name only when it is complete.

    Raises
    ------
    ValueError
        `path` cannot be written to: see `check_target`.
    OSError
        The system refused a write (a full disk, say), with the name of the file. What stood there is left as it was.
    """
    path = check_target(path)
    try:
        with scratch_beside(path) as scratch:
            draft = scratch / f"draft{path.suffix}"
            write(draft)
            sync(draft)
            check_target(path)
            put_in_place(draft, path, scratch / REPLACED)
            _sync_one(path.parent)
    except OSError as error:
        if error.errno is None:
            raise OSError(f"{path}: {error}") from error
        raise OSError(error.errno, error.strerror, str(path)) from error


# --- what may be replaced -------------------------------------------------------------------------------------


def not_of_a_store(folder: Path, in_array: bool = False) -> Path | None:
    """The first thing in a folder that is no part of a Zarr store; None for a store and for an empty folder.

    A folder that another writer takes away meanwhile holds nothing.
    """
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except FileNotFoundError:
        return None
    kind = "array" if in_array else _node(folder, {entry.name for entry in entries})
    if entries and kind is None:
        gone = not all(os.path.lexists(entry.path) for entry in entries)
        return None if gone else folder
    for entry in entries:
        chunk = kind == "array" and _CHUNK.fullmatch(entry.name) is not None
        if entry.is_symlink():
            return Path(entry.path)
        if entry.is_dir():
            if kind == "array" and not chunk:
                return Path(entry.path)
            if (other := not_of_a_store(Path(entry.path), in_array=chunk)) is not None:
                return other
        elif not chunk and (in_array or entry.name not in _METADATA or not entry.is_file()):
            return Path(entry.path)
    return None


def _node(folder: Path, names: set[str]) -> str | None:
    """What a folder of a Zarr store is, "array" or "group"; None if it is no such folder."""
    if ".zarray" in names or ".zgroup" in names:
        return "array" if ".zarray" in names else "group"
    try:
        kind = json.loads((folder / "zarr.json").read_bytes())["node_type"]
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return None
    return kind if kind in ("array", "group") else None


# --- scratch folders ------------------------------------------------------------------------------------------


def _prefix(path: Path) -> str:
    """What scratch folders of a target begin with: short, whatever the length of the target's name."""
    return f".beamprop-{zlib.crc32(os.fsencode(path.name)):08x}-"


def scratch_of(path: Path) -> list[Path]:
    """The scratch folders of a target, those in use and those abandoned."""
    start = _prefix(path)
    return [Path(entry.path) for entry in os.scandir(path.parent) if entry.name.startswith(start)]


@contextlib.contextmanager
def scratch_beside(path: Path) -> Iterator[Path]:
    """A scratch folder that is removed in the end; those that earlier runs left behind are removed first."""
    for left in scratch_of(path):
        remove_abandoned(left, path)
    scratch = path.parent / f"{_prefix(path)}{secrets.token_hex(8)}"
    failed = True
    try:  # before the folder is made, so that an interrupt in the moment after it finds this way out
        scratch.mkdir(mode=0o700)
        with _locked(scratch):
            yield scratch
        failed = False
    finally:
        _remove(scratch, path, failed)


def _remove(scratch: Path, path: Path, failed: bool = False) -> None:
    """Remove a scratch folder, after what was being replaced has been put back if nothing took its place."""
    if os.path.lexists(scratch / REPLACED) and not os.path.lexists(path):
        try:
            os.rename(scratch / REPLACED, path)
        except OSError:
            return  # the only copy of the old file is in there
    # zarr's threads may write on for a moment after one of them has failed, and make the folder anew
    for _ in range(PATIENCE):
        shutil.rmtree(scratch, ignore_errors=True)
        if not failed:
            return
        time.sleep(PAUSE)


@contextlib.contextmanager
def _locked(scratch: Path) -> Iterator[None]:
    """Hold the lock of a scratch folder; its file gets its name only when it is locked, so that nobody finds it free."""
    if fcntl is None:
        with open(scratch / LOCK, "wb"):
            yield
        return
    with open(scratch / "lock.new", "wb") as file:
        # a file system without locks: no lock file, and nobody will take this folder for abandoned
        if _lock(file):
            os.rename(scratch / "lock.new", scratch / LOCK)
        yield


def _lock(file: IO[bytes]) -> bool:
    """Whether the lock of a file could be had."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def remove_abandoned(scratch: Path, path: Path) -> None:
    """Remove a scratch folder of a process that has ended, and put back what it was replacing."""
    try:
        if fcntl is None:
            (scratch / LOCK).unlink()  # refused while a living process has it open
            _remove(scratch, path)
            return
        with open(scratch / LOCK, "rb") as file:
            if _lock(file):
                _remove(scratch, path)
    except FileNotFoundError:
        with contextlib.suppress(OSError):
            if time.time() - scratch.stat().st_mtime > FORGOTTEN:
                scratch.rmdir()
    except OSError:
        return


# --- renaming and syncing -------------------------------------------------------------------------------------


def put_in_place(draft: Path, path: Path, replaced: Path) -> None:
    """Give a draft its name in one step; what stood there is in the scratch folder afterwards."""
    for k in range(TRIES):
        try:
            if not os.path.lexists(path) or not (draft.is_dir() or (path.is_dir() and not path.is_symlink())):
                os.replace(draft, path)
            elif not exchange(draft, path):
                _rename_twice(draft, path, replaced)
            return
        except OSError as error:
            # another writer put its own there, or took it away, in between
            if error.errno not in (errno.ENOENT, errno.ENOTEMPTY, errno.EEXIST) or not draft.exists() or k == TRIES - 1:
                raise
            if os.path.lexists(replaced):
                os.rename(replaced, replaced.with_name(f"{replaced.name}-{k}"))


def _rename_twice(draft: Path, path: Path, replaced: Path) -> None:
    try:
        os.rename(path, replaced)
        os.rename(draft, path)
    except BaseException:
        if os.path.lexists(replaced) and not os.path.lexists(path):
            os.rename(replaced, path)
        raise


def exchange(a: Path, b: Path) -> bool:
    """Exchange two names at once; False where the system or the file system cannot."""
    try:
        library = ctypes.CDLL(None, use_errno=True)
        call: Any = library.renameat2 if sys.platform == "linux" else library.renamex_np
    except (AttributeError, TypeError, OSError):
        return False
    first, second = os.fsencode(a), os.fsencode(b)
    here, swap = -100, 2  # AT_FDCWD; RENAME_EXCHANGE on Linux, RENAME_SWAP on macOS
    status = call(here, first, here, second, swap) if sys.platform == "linux" else call(first, second, swap)
    if status == 0:
        return True
    number = ctypes.get_errno()
    if number in _CANNOT:
        return False
    raise OSError(number, os.strerror(number), str(b))


def sync(path: Path) -> None:
    """Bring a file, or a folder with all that is in it, to the disk."""
    if path.is_dir():
        for folder, _, files in os.walk(path, topdown=False):
            for name in files:
                _sync_one(Path(folder, name))
            _sync_one(Path(folder))
    else:
        _sync_one(path)


def _sync_one(path: Path) -> None:
    folder = path.is_dir()
    if folder and os.name == "nt":
        return  # folders cannot be opened there
    handle = os.open(path, os.O_RDONLY if os.name != "nt" else os.O_RDWR)
    try:
        os.fsync(handle)
    except OSError:
        if not folder:  # some file systems sync no folders
            raise
    finally:
        os.close(handle)
