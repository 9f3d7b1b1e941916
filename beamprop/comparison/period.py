"""What the period of a field contributes to its difference from another field."""

from __future__ import annotations

import numpy as np
import xarray as xr

from .grid import as_rows, matched, on_common_grid, pressure_of
from .norms import cell_areas, relative_l2, weights
from .warn import boundary_of


def wraparound(a: xr.Dataset, b: xr.Dataset, reference: xr.Dataset) -> np.ndarray:
    """Relative L2 difference of the periodic field (a, if both are) to the same field in open space."""
    p_open = pressure_of(reference, "open_reference")
    if boundary_of(reference)[0] == "periodic":
        raise ValueError("open_reference: expected a field in open space, got boundary 'periodic'")
    kinds = [boundary_of(ds)[0] for ds in (a, b)]
    if kinds == ["open", "open"]:
        raise ValueError("open_reference: expected a or b to be periodic, got boundary 'open' in both")
    chosen = kinds.index("periodic") if "periodic" in kinds else kinds.index(None)
    p = pressure_of((a, b)[chosen], "ab"[chosen])
    p, p_open, _ = on_common_grid(p, matched(p_open, p, p.attrs.get("units"), "open_reference"), "open_reference")
    ours, in_space = as_rows(p.values, p), as_rows(p_open.values, p)
    w = weights(ours, in_space, cell_areas(p))
    return relative_l2(np.where(w > 0, ours, 0), np.where(w > 0, in_space, 0), w)
