"""Widths and peaks of two sampled fields at each depth."""

from __future__ import annotations

import numpy as np
import xarray as xr

from ..profiles.fwhm import of_samples


def widths_and_peaks(p_a: xr.DataArray, p_b: xr.DataArray) -> dict[str, np.ndarray]:
    """Widths at half maximum and largest |p| of both fields and their differences, by z; of planes along x and along y, on a last axis."""
    out = {}
    for name, p in (("a", p_a), ("b", p_b)):
        widths, peaks = _of_planes(p) if "y" in p.dims else _of_lines(p.x.values, p.values)
        out[f"fwhm_{name}"], out[f"peak_{name}"] = widths, peaks
    for kind in ("fwhm", "peak"):
        out[f"{kind}_difference"] = out[f"{kind}_b"] - out[f"{kind}_a"]
    return out


def _of_planes(p: xr.DataArray) -> tuple[np.ndarray, np.ndarray]:
    """Widths (…, 2) along x and along y through the largest |p| of each plane, and that."""
    rows, columns = p.shape[-2:]
    planes = p.values.reshape(-1, rows, columns)
    size = np.where(np.isfinite(planes), np.abs(planes), -1.0)
    i, j = np.unravel_index(size.reshape(len(planes), -1).argmax(axis=1), (rows, columns))
    each = np.arange(len(planes))
    along_x, peaks = _of_lines(p.x.values, planes[each, i])
    along_y, _ = _of_lines(p.y.values, planes[each, :, j])
    return np.stack([along_x, along_y], axis=-1).reshape(*p.shape[:-2], 2), peaks.reshape(p.shape[:-2])


def _of_lines(x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Widths and peaks of values (…, n) at x (n,)."""
    widths, peaks = _of_sections(x, values.reshape(-1, x.size))
    return widths.reshape(values.shape[:-1]), peaks.reshape(values.shape[:-1])


def _of_sections(x: np.ndarray, sections: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Widths and peaks of sections (R, n), each over the run of finite values that holds its largest."""
    finite = np.isfinite(sections)
    size = np.where(finite, np.abs(sections), -1.0)
    top, index = np.argmax(size, axis=-1)[:, None], np.arange(x.size)
    first = np.max(np.where(~finite & (index < top), index + 1, 0), axis=-1)
    last = np.min(np.where(~finite & (index > top), index, x.size), axis=-1)
    peaks = np.take_along_axis(size, top, -1)[:, 0]
    peaks = np.where(peaks < 0, np.nan, peaks)
    widths = np.full(peaks.shape, np.nan)
    runs = np.stack([first, last], axis=-1)
    for start, stop in np.unique(runs[(last - first > 1) & (peaks > 0)], axis=0):
        rows = np.flatnonzero((first == start) & (last == stop) & (peaks > 0))
        measured = of_samples(x[start:stop], sections[rows, start:stop])
        widths[rows], peaks[rows] = measured.width, measured.peak
    return widths, peaks
