"""Positions along an axis: in m, or in mm or um where they are small; the data stay in m."""

from __future__ import annotations

from typing import Any

import numpy as np


def name_length(axis: Any, name: str, positions: Any) -> None:
    """Name an axis of matplotlib by the positions [m] that it shows, and its ticks in that unit."""
    largest = float(np.max(np.abs(positions)))
    unit, factor = ("m", 1.0) if largest >= 0.1 else ("mm", 1e3) if largest >= 1e-4 else ("um", 1e6)
    axis.set_label_text(f"{name} [{unit}]")
    if factor > 1:
        axis.set_major_formatter(lambda v, _: f"{v * factor:.6g}")
