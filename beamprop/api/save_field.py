"""Field maps larger than memory: made plane by plane, written to a file block by block."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..contour.error import uniform_budget
from ..fields.question import fill, prepare
from ..io.storage import check_target, save_blocks
from ..media.structures import Slab
from ..memory import check_field
from ..progress import Progress, watched
from ..sources.base import Beam
from .field_question import checked_question, labelled, warn_of_field

#: The largest chunk of a file [bytes].
CHUNK = 2**24
#: Of a complex number [bytes].
SIZE = 16


def save_field(
    path: str | Path,
    slab: Slab,
    beam: Beam,
    frequency: Any,
    x: Any,
    z: Any,
    angle: Any = None,
    boundary: str = "open",
    period: float | None = None,
    rtol: float = 1e-8,
    memory: float = 2**28,
    progress: Progress = False,
) -> xr.Dataset:
    """A field map in a file, written in blocks: as `save` would write the answer of `field`, without ever holding it.

    Parameters
    ----------
    path : path
        Ending in .nc (netCDF) or .zarr; replaced if it exists, once the new one is complete.
    slab, beam, frequency, x, z, angle, boundary, period, rtol
        As in `field`.
    memory : float, bytes
        Of the largest block of p that is held at a time: one row along x at least. What a block is made from takes
        some tens of MB more.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of blocks that is worked through.

    Returns
    -------
    Dataset
        All of the answer but `p`. Read the file with `load`, or by parts with ``xarray.open_dataset(path, chunks={})``, where p is the pair
        ``p_real`` and ``p_imag``, or ``xarray.open_zarr(path)``.

    Warns
    -----
    AccuracyWarning
        The estimate is above rtol.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came. A path that cannot be written is found before the work.
    OSError
        The system refused a write. Of a netCDF file the space is reserved before the work: a full disk is found then.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> x, z = np.linspace(-1, 1, 201), np.linspace(0, 0.2, 50)
    >>> rest = bp.save_field("map.nc", slab, beam, 2500.0, x, z, memory=2**16)  # 64 KiB at a time
    >>> dict(bp.load("map.nc").p.sizes)
    {'z': 50, 'x': 201}
    """
    path = validate.as_path(path)
    validate.flag_or_function(progress, "progress")
    check_target(path)
    question, labels = checked_question(slab, beam, frequency, x, z, angle, boundary, period, rtol)
    shape, dims, pick = question.shape, labels.dims, labels.pick
    check_field(shape, in_file=True)
    memory = validate.as_number(memory, "memory", positive=True)
    block, chunk = _block(shape, memory)
    work = [
        (i, slice(j, j + block[0]), slice(k, k + block[1]))
        for i, j, k in itertools.product(range(shape[0]), range(0, shape[1], block[0]), range(0, shape[2], block[1]))
    ]
    errors = np.full(shape[:2], np.nan)
    worst = uniform_budget(1, 0.0)
    kept = [isinstance(p, slice) for p in pick]

    def blocks() -> Iterator[tuple[tuple[Any, ...], np.ndarray]]:
        nonlocal worst
        chosen = -1
        for i, angles, planes in watched(progress, work, "blocks"):
            if i != chosen:
                prepared, chosen = prepare(question, i), i
            # a block at the end may be smaller
            sizes = [len(range(*part.indices(n))) for part, n in zip((angles, planes), shape[1:3], strict=True)]
            p = np.empty((1, *sizes, shape[3]), complex)
            budget = fill(prepared, planes, angles, p[0])
            errors[i, angles], worst = np.fmax(errors[i, angles], budget.total), worst.worse(budget)
            where = (slice(i, i + 1), angles, planes, slice(None))
            yield tuple(w for w, keep in zip(where, kept, strict=True) if keep), p[pick]

    sizes = dict(zip(dims, (n for n, keep in zip(shape, kept, strict=True) if keep), strict=True))
    chunks = tuple(c for c, keep in zip((1, *chunk, shape[3]), kept, strict=True) if keep)
    save_blocks(path, "p", sizes, chunks, blocks(), lambda: labelled(labels, errors, None))
    warn_of_field(worst, question.rtol)
    return labelled(labels, errors, None)


def _block(shape: tuple[int, ...], memory: float) -> tuple[tuple[int, int], tuple[int, int]]:
    """Angles and planes of a block, and of a chunk, of which a block is a whole number."""
    _, angles, planes, points = shape
    row = SIZE * points
    many = max(1, min(angles, int(memory // row)))
    few = max(1, min(planes, int(memory // (row * many))))
    chunk = max(1, min(few, int(CHUNK // (row * many))))
    return (many, few // chunk * chunk), (many, chunk)
