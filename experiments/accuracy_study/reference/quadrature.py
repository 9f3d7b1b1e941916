"""The truth: the field by two quadratures of different depth, bend and panels that agree, or why there is none.

Each plane is known to its own error. A plane on which |p| is so small beside the two waves that cancel there that rounding
of lengths and phases alone exceeds a tenth of rtol is `dark`: nothing can be said of it in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import beamprop as bp

from ..case import Case
from .bands import Tent, sided_nodes, stretches
from .contour import Contour, Grading, bent_nodes, panels, real_nodes
from .medium import Medium
from .misplaced import alone, has_solids, is_lossless, wrong_side
from .near_axis import NearAxis
from .solid_medium import medium_of
from .source import Source

EPS = float(np.finfo(float).eps)
#: The most nodes of a quadrature, and |p| below which a plane counts as silent.
MOST_NODES, SILENT = 120_000, 1e-280
#: Classes with resonances at normal incidence so sharp that double precision does not resolve them.
SHARP = ("sharp resonances",)
#: Classes of lossless slabs of very many periods, whose Bloch waves tell on which side of the axis the contour passes.
BANDED = ("100 000 lossless periods",)
#: Classes with planes on which waves cancel, where little rounding may be magnified.
DARK = (
    "nearly dark planes",
    "negative layer before density 0",
    "nearly rigid half-space",
    "behind a mirror, band edge",
)


class Truth(NamedTuple):
    """p(z, x), and of each plane: what errors are relative to, p's own error, and whether it is too dark to be known."""

    p: np.ndarray
    scale: np.ndarray
    error: np.ndarray
    dark: np.ndarray
    wrong: int  #: backward modes on the wrong side of the contour


class Setting(NamedTuple):
    """What all quadratures of one case share; lengths in m, x relative to the source's middle."""

    case: Case
    m: Medium
    source: Source
    x: np.ndarray
    extent: float
    reach: float
    path: float
    near: NearAxis | None

    @property
    def rotated(self) -> bool:
        return getattr(self.case.beam, "form", "launch") == "rotated"

    def response(self, k: np.ndarray, velocity: bool = False) -> np.ndarray:
        """The response at the case's planes, beside kx = 0 by series where resonances are sharp."""
        h = self.m.response(k, self.case.z, self.source.beam.z0, velocity)
        if self.near is not None and not velocity:
            close = np.abs(k) < self.near.radius
            if np.any(close):
                h[:, close] = self.near.response(k[close])
        return h


def setting(case: Case, own: np.ndarray) -> Setting:
    m = medium_of(case.slab, case.frequency)
    x = np.concatenate([case.x, own]) - case.beam.centre
    path = max(case.z.max() - m.thickness, 0.0) - case.beam.z0 + max(0.0, -case.z.min())
    near = NearAxis(m, case.z, case.beam.z0) if case.kind in SHARP else None
    return Setting(
        case, m, Source(case.beam, m.k0), x, float(np.abs(x).max()), case.beam.reach(1e-16), path, near
    )  # fmt: skip


def _ends(s: Setting, tolerance: float) -> tuple[float, float]:
    """Re kx between which the source's spectrum, and what of it arrives, is not negligible."""
    end = s.source.band(tolerance)
    nearest = float(s.case.z.min())  # waves decay in the half-spaces; through a slab they may go on undiminished
    gap = min(nearest, 0.0) - s.case.beam.z0 + max(0.0, nearest - s.m.thickness)
    if gap > 0:
        end = min(end, math.hypot(s.m.k0, 42 / gap) + s.m.k0)
    if not isinstance(s.case.beam, bp.GaussianBeam):
        return 0.0, end
    tilt = s.m.k0 * abs(s.source.sine)
    return max(0.0, tilt - (s.source.band(1e-40) - tilt)), end


def _pinch(s: Setting) -> float:
    """How near to kx = 0 a pole or branch point lies, where that is much nearer than k0; else infinite.

    A layer of little density lets through what arrives with kx below k0 sqrt(density), relative to the medium in front.
    """
    scales = [abs(b) for b in s.m.branch_points()]
    thin = [abs(v[1] / s.m.before[1]) for layers, _ in s.m.segments for v in layers]
    scales += [s.m.k0 * math.sqrt(ratio) for ratio in thin if ratio > 0]
    if s.near is not None:
        scales.append(s.near.smallest)
    smallest = min(scales)
    return smallest if smallest < 0.05 * s.m.k0 else math.inf


def _contour(s: Setting, step: int, shallow: float) -> tuple[Contour, Grading]:
    """The contour of a step: depths and bends alternate, so that no two neighbours share a node."""
    odd = step % 2
    pinch = _pinch(s)
    kb = min([b for b in s.m.branches() if b > 0.05 * s.m.k0], default=s.m.k0)
    start, end = _ends(s, 1e-22 if odd else 1e-18)
    growth = 2.0 if s.case.kind in DARK + SHARP else 6.0  # exp(growth) magnifies rounding
    depth = shallow * min((0.3 - 0.07 * odd) * kb, (1 - 0.25 * odd) * growth / max(s.extent, s.reach, 1e-9))
    depth = min(depth, *(0.45 * abs(b) for b in s.m.branch_points() if b.real <= abs(b.imag)), math.inf)
    corner = min((0.45 + 0.2 * odd) * kb, (0.4 + 0.2 * odd) * end)
    if pinch < math.inf:
        corner = min(corner, (1.3 + 0.4 * odd) * depth)
    finer = 1.5**step
    near = tuple(side * b for b in s.m.branch_points() for side in (1, -1))
    floor = 0.05 * depth if pinch == math.inf else 0.1 * min(pinch, depth)
    return Contour(depth, corner, start, end), Grading(finer * (s.extent + s.reach), finer * s.path, near, floor)


def misplaced_modes(s: Setting) -> tuple[list[complex] | None, float]:
    """Backward modes above the contour, and by how much it had to be made shallower for them to be found."""
    shallow = 1.0
    while True:
        c, _ = _contour(s, 0, shallow)
        end = _slab_end(s, c.end)
        wrong = wrong_side(s.case.slab, s.case.frequency, s.m, 1.01 * c.depth, 0.9 * c.corner, end)
        if wrong is not None or shallow < 0.01 or (is_lossless(s.m) and not has_solids(s.m)):
            return wrong, shallow
        shallow /= 4


def _slab_end(s: Setting, end: float) -> float:
    """|kx| beyond which nothing that reaches the slab comes back."""
    z0 = -s.case.beam.z0
    return min(end, math.hypot(s.m.k0, 42 / z0) + s.m.k0) if z0 > 0 else end


def _sided_nodes(s: Setting, step: int) -> tuple[np.ndarray, np.ndarray]:
    """A contour on either side of the axis, for periodic slabs without loss or nearly."""
    odd = step % 2
    _, end = _ends(s, 1e-22 if odd else 1e-18)
    deepest = min((0.3 - 0.07 * odd) * s.m.k0, (1 - 0.25 * odd) * 4 / max(s.extent, s.reach, 1e-9))
    highest = min(deepest, (1 - 0.25 * odd) * 2 / max(s.path, 1e-9))  # above the axis waves grow along z
    tents = []
    for part in stretches(s.m, end, _slab_end(s, end)):
        height = min(highest if part.side > 0 else deepest, (0.3 - 0.05 * odd) * (part.hi - part.lo))
        tents.append(Tent(part, height, 0.8 - 0.2 * odd))
    return sided_nodes(s.m, tents, s.extent + s.reach, s.path, 1.5**step)


def nodes_on_contour(s: Setting, step: int, shallow: float, wrong: list[complex]) -> tuple[np.ndarray, np.ndarray]:
    """Contour and circles around what it leaves on the wrong side."""
    c, g = _contour(s, step, shallow)
    points = [side * b for b in s.m.branch_points() for side in (1, -1)]
    inside = [k for k in wrong if k.imag >= -c.depth * min(1.0, k.real / c.corner)]
    k, w = bent_nodes(c, g._replace(near=g.near + tuple(wrong)), s.m.branch_points())
    circle = np.exp(-2j * np.pi * (np.arange(40) + 0.5) / 40)
    for k1 in inside:
        apart = [c.depth, *(abs(k1 - b) for b in points), *(abs(k1 - o) for o in wrong if o != k1)]
        radius = (0.3 + 0.1 * (step % 2)) * min(apart)
        radius = alone(s.m, k1, radius) if has_solids(s.m) else radius
        k, w = np.append(k, k1 + radius * circle), np.append(w, radius * circle * (-2j * np.pi / 40))
    return k, w


def field_sum(
    source: Source, h_of: Callable[[np.ndarray], np.ndarray], k: np.ndarray, w: np.ndarray, kz: Any, x: np.ndarray
) -> np.ndarray:
    """(1/2 pi) sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}], in blocks."""
    out: Any = 0
    block = max(500, 4_000_000 // max(x.size, 1))
    for i in range(0, k.size, block):
        kk, ww = k[i : i + block], w[i : i + block] / (2 * np.pi)
        h = h_of(kk) * ww
        wave = np.exp(1j * np.outer(kk, x))
        across = None if kz is None else kz[i : i + block]
        out = out + (h * source(kk, across)) @ wave + (h * source(-kk, across)) @ (1 / wave)
    return out


def largest_elsewhere(m: Medium, source: Source, z: np.ndarray) -> np.ndarray:
    """|p| of the propagating waves where the beam lands on each plane: errors are over the largest |p| of a plane, (Z,).

    Rays of nine strong plane waves, and panels over the strong part of the spectrum; rays that go too far are left out. Solids let narrow bands
    through, which may lie where little is launched: of them also rays of 129 plane waves down to 1e-9 of the strongest.
    """
    strong = _largest_of_rays(m, source, z, 1e-3, 9)
    return np.maximum(strong, _largest_of_rays(m, source, z, 1e-9, 129)) if has_solids(m) else strong


def _largest_of_rays(m: Medium, source: Source, z: np.ndarray, level: float, number: int) -> np.ndarray:
    """|p| where so many rays of the plane waves above a level land, (Z,)."""
    wide, tilt = source.band(level) - m.k0 * abs(source.sine), m.k0 * source.sine
    lo, hi = max(tilt - wide, -0.995 * m.k0), min(tilt + wide, 0.995 * m.k0)
    if hi <= lo:
        return np.zeros(z.size)

    def h(k: np.ndarray) -> np.ndarray:
        return m.response(np.abs(k) + 0j, z, source.beam.z0)  # even in k

    rays, step = np.linspace(0.95 * lo + 0.05 * hi, 0.05 * lo + 0.95 * hi, number), 1e-5 * m.k0
    x = np.nan_to_num(-np.angle(h(rays + step) / h(rays - step)) / (2 * step))  # (Z, rays)
    most = 4 * 800 / (hi - lo) - source.beam.reach(1e-3) - m.thickness
    x = np.where(np.abs(x) < most, x, 0.0)
    if has_solids(m):  # what a resonance narrower than the rays' steps lets through lies between them
        x = np.concatenate([x, np.linspace(x.min(axis=1), x.max(axis=1), number, axis=1)], axis=1)
    count = math.ceil(3 + (hi - lo) * (np.abs(x).max() + source.beam.reach(1e-3) + m.thickness) / 4)
    if count > 1500:
        return np.zeros(z.size)
    k, w = panels(np.linspace(lo, hi, count))
    sent = h(k) * source(k, np.sqrt((m.k0 - k) * (m.k0 + k))) * w / (2 * np.pi)
    p = [np.exp(1j * np.outer(there, k)) @ row for there, row in zip(x, sent, strict=True)]
    return np.nan_to_num(np.abs(p).max(axis=1))


def _uncancelled(s: Setting, k: np.ndarray, w: np.ndarray, kz: Any, p: np.ndarray) -> np.ndarray:
    """The larger of |p| and |v_z| on each plane: what cancels where a plane is dark, (Z,)."""
    v = field_sum(s.source, lambda kk: s.response(kk, True), k, w, kz, s.x)
    return np.nan_to_num(np.maximum(np.abs(p).max(axis=1), np.abs(v).max(axis=1)), posinf=0.0)


def _cancelled(s: Setting, uncancelled: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """What rounding of lengths and phases leaves unknown on each plane where waves cancel; (Z,)."""
    way = np.maximum(np.abs(s.case.z), s.m.thickness) - s.case.beam.z0
    return np.where(uncancelled > 10 * scale, 4 * EPS * (1 + s.m.k0 * way) * uncancelled / scale, 0.0)


def _rounding(s: Setting) -> float:
    """What rounding of periods, of long phases, and of a profile's positions far from x = 0, leaves unknown."""
    origin = abs(s.case.beam.centre) if isinstance(s.case.beam, bp.Profile) else 0.0
    periods = sum(len(layers) * count for layers, count in s.m.segments)
    return EPS * (periods + s.m.k0 * (4 * origin + s.extent + s.path))


def truth(case: Case, own: np.ndarray, goal: float = 0.0) -> Truth | str:
    """The field by two quadratures that agree to a tenth of rtol, if they can to `goal`; or why there is none."""
    s = setting(case, own)
    sided = case.kind in BANDED and not s.rotated
    wrong, shallow = ([], 1.0) if s.rotated or sided else misplaced_modes(s)
    if wrong is None:
        return "backward modes not located"
    elsewhere = np.zeros(case.z.size) if s.near is not None else largest_elsewhere(s.m, s.source, case.z)
    best: Truth | None = None
    before = uncancelled = None
    why = "too many nodes"
    for step in range(5):
        if s.rotated:
            length = s.extent + s.reach + 2 * s.path + s.m.thickness
            k, w, kz = real_nodes(s.m, length, 1.5 ** (2 * step), _pinch(s))
        elif sided:
            (k, w), kz = _sided_nodes(s, step), None
        else:
            (k, w), kz = nodes_on_contour(s, step, shallow, wrong), None
        if k.size > MOST_NODES:
            break
        p = field_sum(s.source, s.response, k, w, kz, s.x)
        if not np.all(np.isfinite(p)):
            why = "not finite"
            break
        if before is None or uncancelled is None:
            before, uncancelled = p, _uncancelled(s, k, w, kz, p)
            continue
        agreed = _agreement(s, p, before, elsewhere, uncancelled, len(wrong))
        best = agreed if best is None or _worst(agreed) < _worst(best) else best
        before, why = p, f"no two quadratures agree: {_worst(best):.0e} at rtol {case.rtol:.0e}"
        if _worst(best) < max(goal, 1e-13):
            break
    known = best is not None and not np.all(best.dark) and _worst(best) < max(0.1 * case.rtol, 1e-13)
    return best._replace(error=best.error + _rounding(s)) if best is not None and known else why


def _worst(t: Truth) -> float:
    """The largest error of a plane that is not dark."""
    return float(t.error[~t.dark].max(initial=0.0))


def _agreement(
    s: Setting,
    p: np.ndarray,
    before: np.ndarray,
    elsewhere: np.ndarray,
    uncancelled: np.ndarray,
    wrong: int,
) -> Truth:
    """What two quadratures say together."""
    scale = np.maximum(np.abs(p).max(axis=1), elsewhere)
    seen = np.where(scale > SILENT, scale, np.inf)
    unknown = _cancelled(s, uncancelled, seen)
    error = np.abs(p - before).max(axis=1) / seen + unknown
    dark = unknown > 0.1 * s.case.rtol
    dark |= (error > 0.1 * s.case.rtol) & (error * scale < 1e-14 * uncancelled)
    return Truth(p[:, : s.case.x.size], scale, error, dark, wrong)
