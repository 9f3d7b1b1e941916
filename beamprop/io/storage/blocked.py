"""Variables that are written block by block."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Where a block goes, and the values there of each variable by name.
Blocks = Iterable[tuple[tuple[Any, ...], dict[str, np.ndarray]]]


@dataclass(frozen=True)
class BlockedVariables:
    """Variables on the same dimensions that are never whole in memory.

    Attributes
    ----------
    kinds : dict
        Name -> type of its values, complex or float.
    sizes : dict
        Dimension -> length, in the variables' order.
    chunks : tuple of int
        Of the file; a block covers whole chunks.
    attrs : dict
        Name -> attributes.
    blocks : iterable of (index, name -> values)
    """

    kinds: dict[str, type]
    sizes: dict[str, int]
    chunks: tuple[int, ...]
    attrs: dict[str, dict[str, Any]]
    blocks: Blocks
