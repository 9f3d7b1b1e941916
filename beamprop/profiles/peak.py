"""The largest |p| of a plane, by Newton's method on its plane waves; of equal ones, those of a ring say, the one farthest along x."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .space_plane import Plane, PlaneOfSum, Sampled

#: Maxima of the samples of more than this share of the largest are candidates for the peak: between samples |p| rises by no more.
CANDIDATES = 0.8
#: Newton's method squares errors of a grid step's size: 8 steps are many, and what is below this share of a grid step is rounding.
NEWTON, SETTLED = 12, 1e-11
#: Maxima that differ by less than this share are the same one; or by less than so many times the estimated error of each, but never by more
#: than the last.
EQUAL, ERRORS, MOST_APART = 1e-9, 4.0, 1e-2
#: A walk along a ring begins with this share of a grid step, turns by no more than so much at a time [rad], and gives up after so many steps.
STRIDE, TURN, STEPS = 0.25, 0.25, 400
#: Newton steps that put a place near a ring onto it, and vertices of parabolas that find its place farthest along x.
ACROSS, VERTICES = 4, 6


class Peak(NamedTuple):
    """Place and size of the largest |p|."""

    place: np.ndarray  #: (2,) m from the source's middle
    size: float  #: Pa
    ring: bool = False  #: whether |p| is as large all along a closed line, of which `place` is the one farthest along x


def peak_of(profile: Sampled) -> Peak:
    """The largest |p| of a plane; of those that the error cannot tell apart the one farthest along x, on a ring as between places."""
    size = np.abs(profile.p)
    padded = np.pad(size, 1)
    around = [
        padded[1 + i : 1 + i + size.shape[0], 1 + j : 1 + j + size.shape[1]] for i in (-1, 0, 1) for j in (-1, 0, 1)
    ]
    top = (size >= np.max(around, axis=0)) & (size > CANDIDATES * size.max())
    row, column = np.nonzero(top)
    begin = np.stack([profile.x[column], profile.y[row]], axis=1)
    spacing = np.array([profile.x[1] - profile.x[0], profile.y[1] - profile.y[0]])
    reached = _maxima(profile.plane, begin, spacing)
    sizes, before = (np.abs(profile.plane.taylor(places, 0)[0]) for places in (reached, begin))
    better = sizes >= before
    reached, sizes = np.where(better[:, None], reached, begin), np.where(better, sizes, before)
    apart = min(max(EQUAL, ERRORS * float(np.max(profile.plane.budget.total))), MOST_APART)
    # neither rounding nor where the samples lie must decide
    equal = sizes >= (1 - apart) * sizes.max()
    best = int(np.argmax(np.where(equal, reached @ [1.0, 1e-3], -np.inf)))
    walked = _around_ring(profile.plane, reached[best], (1 - apart) * sizes.max(), spacing)
    if walked is None:
        return Peak(reached[best], float(sizes.max()))
    return Peak(_farthest(profile.plane, walked), float(sizes.max()), True)


class _Curvature(NamedTuple):
    """Half of |p|^2, its gradient and second derivatives at places, and principal directions, the one of the sharpest maximum first."""

    half_square: np.ndarray  #: (P,)
    slope: np.ndarray  #: (P, 2)
    second: np.ndarray  #: (P, 2, 2)
    curvatures: np.ndarray  #: (P, 2)
    directions: np.ndarray  #: (P, 2, 2), the last axis counts them


def _curvature(plane: Plane | PlaneOfSum, places: np.ndarray) -> _Curvature:
    p, p_x, p_y, p_xx, p_xy, p_yy = plane.taylor(places, 2)
    slope = np.real(np.conj(p) * np.stack([p_x, p_y])).T
    xx, xy, yy = (
        np.real(np.conj(a) * b + np.conj(p) * c) for a, b, c in ((p_x, p_x, p_xx), (p_x, p_y, p_xy), (p_y, p_y, p_yy))
    )
    second = np.moveaxis(np.array([[xx, xy], [xy, yy]]), -1, 0)
    return _Curvature(np.abs(p) ** 2 / 2, slope, second, *np.linalg.eigh(second))


def _maxima(plane: Plane | PlaneOfSum, places: np.ndarray, spacing: np.ndarray) -> np.ndarray:
    """Maxima of |p|^2 within a sample of places (P, 2); along a ring, where it has none, they stay near where they began."""
    begin = places
    for _ in range(NEWTON):
        at = _curvature(plane, places)
        moved = np.clip(places + _uphill(at, 2), begin - spacing, begin + spacing)
        still = bool(np.all(np.abs(moved - places) <= SETTLED * spacing))
        places = moved
        if still:
            return places
    # along a ring rounding leads the last step, aside of it
    return np.clip(_onto_ring(plane, places), begin - spacing, begin + spacing)


def _uphill(at: _Curvature, count: int) -> np.ndarray:
    """Newton's step in the first principal directions along which |p|^2 has a maximum: (P, 2)."""
    along = np.einsum("pid,pi->pd", at.directions, at.slope)
    concave = at.curvatures < 0
    concave[:, count:] = False
    return np.asarray(
        np.einsum("pid,pd->pi", at.directions, np.where(concave, -along / np.where(concave, at.curvatures, 1.0), 0.0))
    )


def _onto_ring(plane: Plane | PlaneOfSum, places: np.ndarray) -> np.ndarray:
    """Places moved to where |p| is largest across the line on which it changes least."""
    for _ in range(ACROSS):
        places = places + _uphill(_curvature(plane, places), 1)
    return places


def _around_ring(plane: Plane | PlaneOfSum, start: np.ndarray, least: float, spacing: np.ndarray) -> np.ndarray | None:
    """Places (n, 2) all along a closed line through `start` on which |p| >= least and largest across it; None where there is none."""
    shortest = STRIDE * float(spacing.min())
    places = [start]
    heading = _curvature(plane, start[None]).directions[0, :, 1]
    stride, bend, turned = shortest, 0.0, 0.0
    for _ in range(STEPS):
        ahead = places[-1] + stride * _turned(heading, bend * stride / 2)
        (placed,) = _onto_ring(plane, ahead[None])
        here = _curvature(plane, placed[None])
        along = here.directions[0, :, 1]
        along = along if along @ heading >= 0 else -along
        turn = math.atan2(heading[0] * along[1] - heading[1] * along[0], heading @ along)
        lost = math.sqrt(2 * here.half_square[0]) < least or math.dist(placed, ahead) > stride / 2
        if lost or abs(turn) > 2 * TURN:
            stride /= 2
            if stride < shortest / 4:
                return None
            continue
        places.append(placed)
        heading, bend, turned = along, turn / stride, turned + turn
        if abs(turned) >= 2 * math.pi:  # once around, at most a stride and its turn beyond the start
            return np.array(places) if math.dist(placed, start) < 2 * stride else None
        stride = min(2 * stride, TURN / max(abs(bend), 1e-300))
    return None


def _turned(direction: np.ndarray, angle: float) -> np.ndarray:
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([cosine * direction[0] - sine * direction[1], sine * direction[0] + cosine * direction[1]])


def _farthest(plane: Plane | PlaneOfSum, ring: np.ndarray) -> np.ndarray:
    """The place of a ring that lies farthest along x: the vertex of parabolas x(y) through three of its places beside each other."""
    x, y = ring[int(np.argmax(ring[:, 0]))]
    apart = 0.05 * float(np.ptp(ring[:, 1]))
    for _ in range(VERTICES):
        three = np.stack([np.full(3, x), y + apart * np.array([-1.0, 0.0, 1.0])], axis=1)
        for _ in range(2 * ACROSS):  # along x, which is across the ring there
            at = _curvature(plane, three)
            three[:, 0] -= at.slope[:, 0] / at.second[:, 0, 0]
        (before, x, behind) = three[:, 0]
        y += apart * (behind - before) / (4 * x - 2 * (before + behind))
    return np.array([x, y])
