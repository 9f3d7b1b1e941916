"""Widths and peaks of two sampled fields at each depth."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..profiles.fwhm import full_width


def widths_and_peaks(p_a: xr.DataArray, p_b: xr.DataArray) -> dict[str, np.ndarray]:
    """Widths and peaks by z."""
    out = {}
    for name, p in (("a", p_a), ("b", p_b)):
        lines = p.values.reshape(-1, p.sizes["x"])
        found = np.array([_width_and_peak(p.x.values, line) for line in lines]).reshape(*p.shape[:-1], 2)
        out[f"fwhm_{name}"], out[f"peak_{name}"] = found[..., 0], found[..., 1]
    for kind in ("fwhm", "peak"):
        out[f"{kind}_difference"] = out[f"{kind}_b"] - out[f"{kind}_a"]
    return out


def _width_and_peak(x: np.ndarray, line: np.ndarray) -> tuple[float, float]:
    """Width at half maximum and largest |p|, over the run of finite values that holds the largest."""
    good = np.isfinite(line)
    if not np.any(good):
        return np.nan, np.nan
    top = int(np.argmax(np.where(good, np.abs(line), -1)))
    gaps = np.flatnonzero(~good)
    first, last = (gaps[gaps < top].max(initial=-1) + 1, gaps[gaps > top].min(initial=line.size))
    if last - first < 2 or line[top] == 0:
        return np.nan, float(np.abs(line[top]))
    width = full_width(x[first:last], line[first:last])
    return width.width, width.peak
