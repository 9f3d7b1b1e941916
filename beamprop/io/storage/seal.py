"""Checksums of every byte of a netCDF file, written behind its end, where HDF5 does not look.

HDF5's own Fletcher-32 guards chunks of values alone: neither attributes nor the tables that say where a chunk lies. The seal lists
stretches of the file with a CRC-32 and the variable each belongs to, so that damage is noticed and named without parsing the
damaged file. A library that changes the file cuts it at HDF5's end, and with that the seal: such a file is read unchecked.

Layout: JSON ``{"names": [...], "stretches": [[length, crc, index of its name], ...]}``, then its length (16 hex digits), the CRC-32 of both
(8 hex digits) and `MARK`. Name "" stands for what is no variable's values.
"""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import IO

MARK = b"beamprop-checked"
FOOT = 16 + 8 + len(MARK)
#: Read at a time [bytes].
PIECE = 2**20

#: Begin and end of a stretch of a file, and the variable whose values lie there.
Stretch = tuple[int, int, str]


def seal(path: Path, values: Iterable[Stretch]) -> None:
    """Append the checksums of a complete file in which values of variables lie at the given stretches."""
    with open(path, "r+b") as file:
        size = file.seek(0, os.SEEK_END)
        whole = _filled(sorted(values), size)
        names = sorted({name for _, _, name in whole})
        file.seek(0)
        stretches = [[stop - start, _crc(file, stop - start), names.index(name)] for start, stop, name in whole]
        text = json.dumps({"names": names, "stretches": stretches}, separators=(",", ":")).encode()
        text += b"%016x" % len(text)
        file.seek(size)
        file.write(text + b"%08x" % zlib.crc32(text) + MARK)


def _filled(values: list[Stretch], size: int) -> list[Stretch]:
    """Stretches that cover a file of this size: neighbours of one variable joined, what lies between them under ""."""
    whole: list[Stretch] = []
    end = 0
    for start, stop, name in [*(v for v in values if v[1] > v[0]), (size, size, "")]:
        if start > end:
            whole.append((end, start, ""))
        if whole and whole[-1][2] == name and stop > start:
            whole[-1] = (whole[-1][0], stop, name)
        elif stop > start:
            whole.append((start, stop, name))
        end = max(end, stop)
    return whole


def _crc(file: IO[bytes], length: int) -> int:
    """CRC-32 of the next bytes of a file."""
    crc = 0
    while length > 0 and (piece := file.read(min(PIECE, length))):
        crc = zlib.crc32(piece, crc)
        length -= len(piece)
    return crc


def check_seal(path: Path) -> None:
    """Raise a ValueError that names the file and the variables whose bytes are not those that were written."""
    with open(path, "rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - FOOT))
        foot = file.read(FOOT)
        if len(foot) < FOOT or not foot.endswith(MARK):
            return
        try:
            length = int(foot[:16], 16)
            file.seek(size - FOOT - length)
            text = file.read(length + 16)
            if zlib.crc32(text) != int(foot[16:24], 16):
                raise ValueError
            record = json.loads(text[:length])
            stretches = [(int(n), int(crc), str(record["names"][name])) for n, crc, name in record["stretches"]]
        except (ValueError, OSError, LookupError, TypeError, RecursionError):
            raise ValueError(
                f"{path}: expected a file as it was written, got one whose list of checksums is damaged"
            ) from None
        if sum(n for n, _, _ in stretches) != size - FOOT - length:
            raise ValueError(f"{path}: expected a file as it was written, got one of another length")
        file.seek(0)
        wrong = {name for n, crc, name in stretches if _crc(file, n) != crc}
    if wrong:
        what = " and ".join(
            f"the values of variable {n!r}" if n else "the names, attributes or layout" for n in sorted(wrong)
        )
        raise ValueError(f"{path}: expected a file as it was written, got one with damage in {what} (wrong checksum)")
