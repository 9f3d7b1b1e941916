"""The part of a plane around the peak of |p| where |p| is above a level: its area, and which samples lie in it."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from .peak import NEWTON, Peak
from .space_plane import Plane, PlaneOfSum, Sampled

#: Newton's step onto a line squares the error: behind one below this share of a grid step is rounding.
SQUARED = 1e-6
#: Points of the first boundary, and of the last: those of a boundary with sharp corners.
FIRST, LAST = 128, 8192
#: Degree of the splines through the boundary, and Gauss nodes that integrate its area exactly between two points.
DEGREE, GAUSS = 5, 5


def connected(inside: np.ndarray, at: tuple[int, int]) -> np.ndarray:
    """The samples of a mask that are connected to the one `at`, by sides."""
    from scipy.ndimage import label

    numbered, _ = label(inside)
    return np.asarray((numbered == numbered[at]) & inside)


class Area(NamedTuple):
    """An area [m^2], nan where the level is not reached inside the window, and by how much it moved with twice as many points."""

    value: float
    change: float


def area_above(profile: Sampled, peak: Peak, level: float, rtol: float) -> Area:
    """Area of the connected part of the plane that holds the peak and on which |p| >= level times its size.

    Its boundary is that of the samples put on the level by Newton's method; its area is Green's integral over a spline through it, with
    twice as many points until that settles to rtol.
    """
    loops = _boundary(profile, peak, level)
    if loops is None:
        return Area(math.nan, 0.0)
    target = level * peak.size
    spacing = np.array([profile.x[1] - profile.x[0], profile.y[1] - profile.y[0]])
    total = change = 0.0
    for loop in loops:
        area, last = _settled(profile.plane, loop, target, spacing, rtol)
        total, change = total + area, change + last
    return Area(abs(total), change / abs(total))


def _boundary(profile: Sampled, peak: Peak, level: float) -> list[np.ndarray] | None:
    """The closed lines (n, 2) around the part that holds the peak and around its holes, these the other way round; None if one is cut off."""
    from contourpy import FillType, contour_generator

    size = np.pad(np.abs(profile.p), 1)
    x, y = (np.concatenate([[2 * v[0] - v[1]], v, [2 * v[-1] - v[-2]]]) for v in (profile.x, profile.y))
    lines = contour_generator(x, y, size, fill_type=FillType.OuterOffset)
    polygons: Any = lines.filled(level * peak.size, 2 * size.max())
    for points, offset in zip(*polygons, strict=True):
        loops = [points[a:b] for a, b in itertools.pairwise(offset)]
        if winding(loops[0], peak.place) and not any(winding(loop, peak.place) for loop in loops[1:]):
            inner = (profile.x[[0, -1]], profile.y[[0, -1]])
            within = [(loops[0][:, i] > a) & (loops[0][:, i] < b) for i, (a, b) in enumerate(inner)]
            return loops if np.all(within) else None
    return None


def winding(loop: np.ndarray, place: np.ndarray) -> int:
    """How often a closed line runs around a place."""
    turn = np.unwrap(np.arctan2(*(loop - place).T[::-1]))
    return round((turn[-1] - turn[0]) / (2 * math.pi))


def _settled(
    plane: Plane | PlaneOfSum, loop: np.ndarray, target: float, spacing: np.ndarray, rtol: float
) -> tuple[float, float]:
    """The area inside a closed line once it is on the level, and its last change; negative for a line that runs clockwise."""
    area, count = math.nan, FIRST
    curve = _spaced(loop[np.append(True, np.any(np.diff(loop, axis=0), axis=1))], count, 1)
    while True:
        placed = _on_level(plane, curve, target, spacing)
        before, area = area, _green(placed)
        change = abs(area - before)
        if change <= 0.1 * rtol * abs(area) or 2 * count > LAST:
            return area, change
        count *= 2
        curve = _spaced(np.concatenate([placed, placed[:1]]), count, DEGREE)


def _spaced(loop: np.ndarray, count: int, degree: int) -> np.ndarray:
    """`count` places at even distances along a spline through a closed line, whose last place is the first."""
    from scipy.interpolate import make_interp_spline

    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(loop, axis=0).T))])
    spline = make_interp_spline(way, loop, k=degree, bc_type="periodic" if degree > 1 else None)
    return np.asarray(spline(way[-1] * np.arange(count) / count))


def _on_level(plane: Plane | PlaneOfSum, places: np.ndarray, target: float, spacing: np.ndarray) -> np.ndarray:
    """Places moved along the gradient onto |p| = target, by no more than half a sample a step."""
    places, moving = places.copy(), np.arange(len(places))
    for _ in range(NEWTON):
        p, p_x, p_y = plane.taylor(places[moving], 1)
        slope = 2 * np.real(np.conj(p) * np.stack([p_x, p_y]))
        excess = np.abs(p) ** 2 - target**2
        step = (-excess * slope / np.maximum(np.sum(slope**2, axis=0), 1e-300)).T
        step *= np.minimum(1.0, 0.5 / np.maximum(np.max(np.abs(step) / spacing, axis=1), 1e-300))[:, None]
        places[moving] += step
        moving = moving[np.any(np.abs(step) > SQUARED * spacing, axis=1)]
        if not moving.size:
            break
    return places


def _green(places: np.ndarray) -> float:
    """Area inside a periodic spline through places, by Green's theorem: the integral of (x dy - y dx)/2."""
    from scipy.interpolate import make_interp_spline

    loop = np.concatenate([places, places[:1]])
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(loop, axis=0).T))])
    spline = make_interp_spline(way, loop - loop.mean(axis=0), k=DEGREE, bc_type="periodic")
    g, w = np.polynomial.legendre.leggauss(GAUSS)
    half = np.diff(way)[:, None] / 2
    at = way[:-1, None] + half * (g + 1)
    (x, y), (dx, dy) = np.moveaxis(spline(at), -1, 0), np.moveaxis(spline(at, 1), -1, 0)
    return float(np.sum((x * dy - y * dx) * w * half) / 2)
