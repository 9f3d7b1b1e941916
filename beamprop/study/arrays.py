"""The result of a study as arrays, in memory or in a store: named alike, filled alike."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, Protocol

import numpy as np

from .. import memory
from ..io import datasets
from .axes import Study
from .blocks import Grid
from .claims import Unclaimed
from .work import EMPTY, STATUS, Result, Schema


class Kept(Protocol):
    """Where blocks are kept."""

    def put(self, block: int, result: Result) -> None:
        """Keep a block."""

    def is_kept(self, block: int) -> bool:
        """Whether a block is kept already."""


class Spec(NamedTuple):
    """An array of the result."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    dtype: Any
    fill: Any
    attrs: dict[str, Any]


def specs(study: Study, schema: Schema, grid: Grid) -> dict[str, Spec]:
    """All arrays of a study's result but its axes: values, and what is known of each point and block."""
    names = tuple(study.axes)
    flags = {"long_name": "whether a point is answered", "flag_values": [0, 1, 2], "flag_meanings": " ".join(STATUS)}
    record = {"long_name": "number of the record of provenance", "per_block": math.prod(grid.chunk)}
    texts = {"long_name": "records of provenance: for each block a JSON list, compressed (zlib, base64)"}
    message = {"long_name": "error of a failed point, warnings of an answered one"}
    arrays = {
        name: Spec(
            (*names, *f.dims),
            (*grid.shape, *f.shape),
            (*grid.chunk, *f.shape),
            f.dtype,
            f.dtype.type(complex(np.nan, np.nan) if f.dtype.kind == "c" else np.nan),
            schema.attrs[name],
        )
        for name, f in schema.fields.items()
    }
    arrays["message"] = Spec(names, grid.shape, grid.chunk, str, "", message)
    arrays["record"] = Spec(names, grid.shape, grid.chunk, np.dtype(np.int64), -1, record)
    arrays["records"] = Spec(("block",), (grid.size,), (1,), str, "", texts)
    arrays["status"] = Spec(names, grid.shape, grid.chunk, np.dtype(np.int8), EMPTY, flags)
    return arrays


def chunks_of(grid: Grid, block: int, result: Result) -> dict[str, np.ndarray]:
    """A block's part of every array, in its shape there; the status last."""
    box = grid.box(block)
    parts = {name: v.reshape(*box, *v.shape[1:]) for name, v in result.values.items()}
    parts["message"] = np.array(result.messages, object).reshape(box)
    parts["record"] = (block * math.prod(grid.chunk) + result.record.astype(np.int64)).reshape(box)
    parts["records"] = np.array([datasets.packed(result.records)], object)
    parts["status"] = result.status.reshape(box)
    return parts


class InMemory:
    """Blocks in arrays of this process."""

    def __init__(self, study: Study, schema: Schema, grid: Grid) -> None:
        memory.check("axes", 1.2 * study.size * (schema.bytes_each + 17.0), f"{study.size:.3g} points", "give a store")
        self.grid = grid
        self.arrays = {
            name: np.full(spec.shape, spec.fill, object if spec.dtype is str else spec.dtype)
            for name, spec in specs(study, schema, grid).items()
        }
        self._kept: set[int] = set()

    def put(self, block: int, result: Result) -> None:
        """Keep a block."""
        for name, part in chunks_of(self.grid, block, result).items():
            self.arrays[name][slice(block, block + 1) if name == "records" else self.grid.where(block)] = part
        self._kept.add(block)

    def is_kept(self, block: int) -> bool:
        """Whether a block is kept already."""
        return block in self._kept

    def claims(self) -> Unclaimed:
        """Nobody else has these arrays."""
        return Unclaimed()
