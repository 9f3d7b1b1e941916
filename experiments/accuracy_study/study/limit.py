"""Limiting absorption: the field of the paper's slab as its loss vanishes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from common import LOSSLESS, slab

import beamprop as bp

ABSORPTIONS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def limiting_absorption(periods: int = 450) -> xr.Dataset:
    """The paper's slab with rho_m = 0.05 + i loss: how far its field is from the lossless one, over the largest |p|."""
    beam = bp.GaussianBeam(0.096)
    clear = slab(periods, LOSSLESS)
    x, z = np.linspace(-0.5, 0.5, 101), clear.thickness * np.array([0.0, 0.5, 1.0])
    frequency = np.array([2000.0, 2400.0])
    limit = bp.field(clear, beam, frequency, x, z, rtol=1e-10).p
    apart = []
    for loss in ABSORPTIONS:
        p = bp.field(slab(periods, (0.05 + 1j * loss, loss / 2)), beam, frequency, x, z, rtol=1e-10).p
        apart.append((np.abs(p - limit).max(("z", "x")) / np.abs(limit).max(("z", "x"))).values)
    return xr.Dataset(
        {"apart": (("loss", "frequency"), np.array(apart))}, {"loss": list(ABSORPTIONS), "frequency": frequency}
    )


def limit_table(ds: xr.Dataset) -> str:
    """Distance to the lossless field by loss, and how it falls per decade."""
    lines = ["| loss | " + " | ".join(f"{f:g} Hz | per decade" for f in ds.frequency.values) + " |", "|---" * 5 + "|"]
    for i, loss in enumerate(ds.loss.values):
        cells = []
        for j in range(ds.sizes["frequency"]):
            a = ds.apart.values[:, j]
            cells += [f"{a[i]:.3e}", f"{a[i - 1] / a[i]:.3f}" if i else ""]
        lines.append(f"| {loss:.0e} | " + " | ".join(cells) + " |")
    return "\n".join(lines)
