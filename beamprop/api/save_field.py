"""Field maps larger than memory: made plane by plane, written to a file block by block."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..io.storage import check_target, save_blocks
from ..media.structures import Slab
from ..memory import check_field
from ..progress import Progress, watched
from ..sources.base import Beam
from . import checks
from .cell_average import averaged_row
from .field_in_space import question_at
from .field_question import labelled
from .field_variables import bytes_held, kinds, no_errors, powers

#: The largest chunk of a file [bytes]: 16 MB, what a reader holds for one value of it, and what compresses at a time.
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
    period: float | tuple[float, float] | None = None,
    rtol: float = 1e-8,
    memory: float = 2**28,
    progress: Progress = False,
    *,
    variables: str | Sequence[str] = ("p",),
    average: str | None = None,
    y: Any = None,
    azimuth: float | None = None,
) -> xr.Dataset:
    """A field map in a file, written in blocks: as `save` would write the answer of `field`, without ever holding it.

    Parameters
    ----------
    path : path
        Ending in .nc (netCDF; also .nc4, .netcdf or .h5) or .zarr; replaced if it exists, once the new one is complete.
    slab, beam, frequency, x, z, angle, boundary, period, rtol, variables, average, y, azimuth
        As in `field`.
    memory : float, bytes
        Of the largest block of all variables that is held at a time: one row along x at least, with y one plane. What a block is made
        from takes some tens of MB more.
    progress : bool or function
        True: a bar on stderr for work of more than a second. A function wraps the list of blocks that is worked through.

    Returns
    -------
    Dataset
        All of the answer but the variables on (z, x) or (z, y, x). Read the file with `load`, or by parts with ``xarray.open_dataset(path, chunks={})``,
        where p is the pair ``p_real`` and ``p_imag``, or ``xarray.open_zarr(path)``.

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
    places, values_of, sides = (x, y, z, azimuth), (variables, average), (boundary, period)
    question, labels = question_at(places, slab, beam, (frequency, angle), sides, rtol, values_of)
    shape, dims, pick, names = question.shape, labels.dims, labels.pick, labels.variables
    values, each = kinds(names), bytes_held(names, question)
    check_field((*shape[:3], math.prod(shape[3:])), in_file=True, values=each)
    memory = validate.as_number(memory, "memory", positive=True)
    block, chunk = _block(shape, memory, sum(each))
    work = [
        (i, slice(j, j + block[0]), slice(k, k + block[1]))
        for i, j, k in itertools.product(range(shape[0]), range(0, shape[1], block[0]), range(0, shape[2], block[1]))
    ]
    errors = no_errors(names, shape)
    rest = {}
    if "power_through" in names:
        rest["power_through"] = powers(question, errors)
    kept, whole = [isinstance(p, slice) for p in pick], (slice(None),) * len(shape[3:])

    def blocks() -> Iterator[tuple[tuple[Any, ...], dict[str, np.ndarray]]]:
        chosen = -1
        for i, angles, planes in watched(progress, work, "blocks"):
            if i != chosen:
                row, chosen = averaged_row(question, i, names, average), i
            # a block at the end may be smaller
            sizes = [len(range(*part.indices(n))) for part, n in zip((angles, planes), shape[1:3], strict=True)]
            out: dict[str, np.ndarray] = {
                name: np.empty((1, *sizes, *shape[3:]), kind) for name, kind in values.items()
            }
            errors.add(i, angles, row.fill(planes, angles, {name: v[0] for name, v in out.items()}))
            where = (slice(i, i + 1), angles, planes, *whole)
            yield tuple(w for w, keep in zip(where, kept, strict=True) if keep), {n: v[pick] for n, v in out.items()}

    sizes = dict(zip(dims, (n for n, keep in zip(shape, kept, strict=True) if keep), strict=True))
    chunks = tuple(c for c, keep in zip((1, *chunk), kept, strict=True) if keep)
    save_blocks(path, values, sizes, chunks, blocks(), lambda: labelled(labels, errors.total, rest))
    for budget, scale in errors.worst_by_scale:
        checks.warn_if_inaccurate(budget, question.rtol, scale)
    return labelled(labels, errors.total, rest)


def _block(shape: tuple[int, ...], memory: float, size: int) -> tuple[tuple[int, int], tuple[int, ...]]:
    """Angles and planes of a block, of `size` bytes a point, and the chunk but for frequencies, of which a block is a whole number."""
    _, angles, planes, *across = shape
    row = max(size, SIZE) * math.prod(across)
    many = max(1, min(angles, int(memory // row)))
    held = max(1, min(planes, int(memory // (row * many))))
    chunk = max(1, min(held, int(CHUNK // (row * many))))
    rows = [max(1, min(n, int(CHUNK // (max(size, SIZE) * many * across[-1])))) for n in across[:-1]]
    return (many, held // chunk * chunk), (many, chunk, *rows, across[-1])
