"""What is written block by block."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Where a block of a variable goes, and its values.
Blocks = Iterable[tuple[tuple[Any, ...], np.ndarray]]


@dataclass(frozen=True)
class BlockedVariable:
    """One complex variable that is never whole in memory.

    Attributes
    ----------
    name : str
    sizes : dict
        Dimension -> length, in the variable's order.
    chunks : tuple of int
        Of the file; a block covers whole chunks.
    attrs : dict
    blocks : iterable of (index, values)
    """

    name: str
    sizes: dict[str, int]
    chunks: tuple[int, ...]
    attrs: dict[str, Any]
    blocks: Blocks
