"""Backward modes on the wrong side of the contour: counted by the argument principle, found by Newton's method."""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Callable

import numpy as np

import beamprop as bp

from .medium import Medium


def turns(
    f: Callable[[np.ndarray], np.ndarray], corners: list[complex], finest: float, sides: int = 150, size: bool = False
) -> int:
    """Turns of exp(f) along a closed polygon, bisected until every step is small.

    Two poles close together turn it by 2 pi between two samples: with `size` its modulus, which they change too, must be smooth.
    """
    steps = np.arange(sides) / sides
    a = np.concatenate([p + (q - p) * steps for p, q in itertools.pairwise([*corners, corners[0]])])
    b = np.roll(a, -1)
    fa, fb = f(a), f(b)
    total = 0.0
    for _ in range(40):
        if a.size > (20 * sides if size else 2500):
            return sys.maxsize
        m = (a + b) / 2
        fm = f(m)
        first, second = ((v + np.pi) % (2 * np.pi) - np.pi for v in ((fm - fa).imag, (fb - fm).imag))
        calm = ((np.abs(first) < 0.6) & (np.abs(second) < 0.6) & (np.abs(first - second) < 0.3)) | (
            np.abs(b - a) < finest
        )
        if size:
            steep = np.maximum(np.abs((fm - fa).real), np.abs((fb - fm).real)) > 1
            calm &= ~(steep | (np.abs((fa + fb - 2 * fm).real) > 0.3)) | (np.abs(b - a) < finest)
        total += float((first + second)[calm].sum())
        a, b, fa, fb = (
            np.concatenate(v)
            for v in ((a[~calm], m[~calm]), (m[~calm], b[~calm]), (fa[~calm], fm[~calm]), (fm[~calm], fb[~calm]))
        )
        if not a.size:
            break
    return round(total / (2 * np.pi))


def media(m: Medium) -> list[tuple]:
    """The layers that sound reaches, and the half-space behind them."""
    layers = [layer for part, _ in m.segments for layer in part]
    return layers if m.wall < math.inf else [*layers, m.after]


def has_solids(m: Medium) -> bool:
    """Whether some layer, or the half-space behind, is a solid."""
    return any(len(layer) == 5 for layer in media(m))


def numbers(layer: tuple) -> tuple:
    """Density and moduli of a layer, without its thickness."""
    return (*layer[:3], *layer[4:])


def is_lossless(m: Medium) -> bool:
    """No layer has loss, nor the half-space behind."""
    return all(np.imag(v) == 0 for layer in media(m) for v in numbers(layer) if np.isfinite(v))


def is_lossy(m: Medium) -> bool:
    """Every layer has loss: no mode lies on the axis, where rounding would choose its side."""
    return all(any(np.imag(v) != 0 for v in numbers(layer)) for layers, _ in m.segments for layer in layers)


def has_negative(m: Medium) -> bool:
    """Some layer, or the half-space behind, has a negative density or modulus."""
    return any(np.real(v) < 0 for layer in media(m) for v in layer[:3])


def wrong_side(
    slab: bp.Slab, frequency: float, m: Medium, depth: float, corner: float, band: float
) -> list[complex] | None:
    """Backward modes above the contour: their kx; None where they cannot be told.

    Counted with a trace of loss where some layer has none, the less the thicker the slab. Where there are any, they are followed
    from a scan.
    """
    if not has_negative(m) and not has_solids(m):
        return []
    test = (
        m if is_lossy(m) and not has_solids(m) else type(m)(slab, frequency, 1e-5 / max(1.0, 0.1 * m.k0 * m.thickness))
    )
    path = [
        0.001 * corner * (1 + 0j),
        band + 0j,
        band - 1j * depth,
        corner - 1j * depth,
        0.001 * corner * (1 - 1j * depth / corner),
    ]
    count = -_turns(test, path[::-1])  # clockwise outline; t has poles
    if count == 0:
        return []
    if abs(count) > 60:
        return None
    return _find_wrong(m, test, depth, corner, band, abs(count))


def _turns(m: Medium, path: list[complex]) -> int:
    """Of t around an outline; with solids, which have many modes close to each other, by two samplings that agree."""
    if not has_solids(m):
        return turns(m.log_t, path, 1e-10 * m.k0)
    counts = {turns(m.log_t, path, 1e-10 * m.k0, sides, True) for sides in (211, 300)}
    return counts.pop() if len(counts) == 1 else sys.maxsize


def alone(m: Medium, k: complex, radius: float) -> float:
    """`radius`, or so much less that no other mode lies within 2.5 times as much around one: 40 nodes alias it by 0.4^40."""
    circle = np.exp(2j * np.pi * np.arange(12) / 12)
    while radius > 1e-9 * abs(k) and turns(m.log_t, list(k + 2.5 * radius * circle), 1e-10 * m.k0, 30, True) != -1:
        radius /= 2
    return radius


def _find_wrong(m: Medium, test: Medium, depth: float, corner: float, band: float, count: int) -> list[complex] | None:
    """Newton's method on 1/t from the peaks of |t| along the axis, and from a grid below it."""
    s = np.linspace(0.002 * m.k0, band, 6000)
    downward = (
        [0.0, 0.5 * depth] if not has_solids(m) else [share * depth for share in (0.0, 0.1, 0.25, 0.5, 0.75, 1.0)]
    )
    seeds = []
    for down in downward:  # leaky modes may lie anywhere above the contour
        v = test.log_t(s - 1j * down).real
        seeds.append(s[1:-1][(v[1:-1] > v[:-2]) & (v[1:-1] > v[2:])] - 1j * down)
    modes: list[tuple[complex, complex]] = []  # with the trace of loss, and as the medium is
    for seed in np.concatenate(seeds):
        k = _newton(test, seed)
        if k is None or not 0 < -k.imag < depth * min(1.0, k.real / corner) or not 0 < k.real < band:
            continue
        if all(abs(k - known) > 1e-7 * abs(k) for known, _ in modes):
            exact = _newton(m, k)
            if exact is not None:
                modes.append((k, exact))
    return [exact for _, exact in modes] if len(modes) == count else None


def _newton(m: Medium, k: complex) -> complex | None:
    for _ in range(60):
        h = 1e-6 * abs(k)
        f = m.log_t(np.array([k, k + h, k - h]))
        d = np.exp(-(f - f[0]))
        slope = (d[1] - d[2]) / (2 * h)
        if not np.isfinite(slope) or slope == 0:
            return None
        step = -d[0] / slope
        step *= min(1.0, 0.05 * abs(k) / abs(step))
        k = complex(k + step)
        if abs(step) < 1e-12 * abs(k):
            return k
    return None
