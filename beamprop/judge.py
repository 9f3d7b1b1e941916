"""The error of a field on a line, judged by a second line that shares no number with the first.

Their difference at a few planes and positions is the error of the coarser one. What both would miss is added: the end of
the band, and a spectrum that ends inside a line. The second line's response is taken at kx and w moved in their last bits,
so that rounding which both share shows too. Errors are over the largest |p| of the plane, which may lie far from what is
asked: a beam is looked for where it lands, too.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from . import origin, spectral
from .beam import Beam
from .fan import Fan
from .memory import check_contour
from .scene import Scene, real_branches
from .spectral import Line, Reach
from .transfers import Transfer, shifts

#: How far kx and w are moved.
SHIFT = 4 * spectral.EPS
#: Planes on which the largest |p| is below this are dark.
DARK = 1e-290


class Checks(NamedTuple):
    """Where two lines are compared."""

    fan: Fan
    k0: float
    transfer: Transfer
    x: np.ndarray
    z: np.ndarray
    guided: bool  #: whether the transfer knows guided modes (none without a slab)
    bright: np.ndarray  #: |p| where each asked beam lands, if that is elsewhere, else 0; (A, Z)
    dark: np.ndarray | None  #: whether a plane is dark to rounding for each asked beam, (A, Z); None until it matters


class Sampled(NamedTuple):
    """A line, and its response at the planes that are compared."""

    line: Line
    h: np.ndarray
    amplitudes: tuple[np.ndarray, np.ndarray]  #: of the beams that are summed
    sums: np.ndarray | None = None  #: their p at the positions that are compared, (B, Z, X), if it is known


def check_points(
    x: np.ndarray, z: np.ndarray, centre: float, source: float, thickness: float, many: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """A few positions and planes that stand for all: the ends, the faces, some between, and the beam's own reach.

    Half as many positions for `many` mixed beams, each of which is looked at through the others too.
    """
    picked, around = (17, 19) if many else (31, 41)
    zs = np.sort(z)
    pick = zs[np.unique(np.linspace(0, zs.size - 1, 7).round().astype(int))]
    near = [zs[np.argmin(np.abs(zs - face))] for face in (0.0, thickness)]
    xs = np.sort(x)
    xs = xs[np.unique(np.linspace(0, xs.size - 1, picked).round().astype(int))]
    ends = _towards_ends(x, xs, source)
    own = centre + source * np.linspace(-1, 1, around // 4 if ends.size else around)
    return np.concatenate([xs, own, ends]), np.unique([*pick, *near])


def _towards_ends(x: np.ndarray, picked: np.ndarray, source: float) -> np.ndarray:
    """Positions that lie ever closer towards both ends, down to the source's size, where those picked are further apart.

    What a finite step in kx adds are images of the beam, about as wide as the source, that come in from both ends.
    """
    apart = float(np.max(np.diff(picked), initial=0.0))
    if apart <= 2 * source:
        return np.empty(0)
    octaves = math.log2(apart / source)
    steps = np.geomspace(source, apart, 2 + math.ceil(min(4 * octaves, max(20, 2 * octaves))))
    wanted = np.concatenate([picked[0] + steps, picked[-1] - steps])
    order = np.sort(x)
    return order[np.clip(np.searchsorted(order, wanted), 0, x.size - 1)]


# --- dark planes ------------------------------------------------------------------------------------------

#: Planes that are looked at besides: so many of the darkest for each of some beams, if they are darker by this than others within
#: half a wavelength in front and behind.
DARKEST, DARKER = 4, 0.3
#: How far beside a plane it is looked whether it is brighter there, in wavelengths in front of the slab; and how much darker a
#: plane may be before what is left on it is rounding: 1e-11 of what stands a thousandth of a wavelength beside it.
BESIDE, LIGHTLESS = 1e-3, 1e-11


def darkest_planes(fan: Fan, k0: float, transfer: Transfer, z: np.ndarray) -> np.ndarray:
    """Planes at nodes of standing waves: errors are over the largest |p| of each plane, so that these ask for the most.

    By the strong plane waves of some of the beams: what is dark for all of them is dark for the beam (Parseval).
    """
    order = np.sort(z)
    found: list[float] = []
    some = fan.spread(3)
    for angle in fan.asked[some]:
        darker = _darkness(_strengths(fan.at(float(angle)), k0, transfer, order), order, np.pi / k0)
        picked: list[float] = []
        for i in np.argsort(darker, kind="stable"):
            if darker[i] > DARKER or len(picked) == DARKEST:
                break
            if all(abs(order[i] - other) > 0.1 / k0 for other in picked):
                picked.append(float(order[i]))
        found += picked
    return np.unique(found)


def _darkness(size: np.ndarray, z: np.ndarray, window: float) -> np.ndarray:
    """Sizes on sorted planes over the largest within a window in front or behind, whichever is less: small at a node only."""
    bins = np.floor((z - z[0]) / (window / 2)).astype(int)
    bins = np.unique(bins, return_inverse=True)[1] if bins[-1] > 4 * z.size else bins
    largest = np.zeros(bins[-1] + 5)
    np.maximum.at(largest, bins + 2, size)
    padded = np.concatenate([size[:1], size, size[-1:]])
    front = np.max([largest[bins], largest[bins + 1], padded[:-2]], axis=0)
    behind = np.max([largest[bins + 3], largest[bins + 4], padded[2:]], axis=0)
    beside = np.minimum(front, behind)
    return np.divide(size, beside, out=np.ones(size.shape), where=beside > size)


def with_dark_planes(checks: Checks) -> Checks:
    """Tell which planes hold no more than rounding beside what stands next to them: p on a perfect wall."""
    fan, k0, transfer, z = checks.fan, checks.k0, checks.transfer, checks.z
    step = BESIDE * 2 * np.pi / k0
    near = np.concatenate([z, np.maximum(z - step, fan.beam.z0), z + step])
    some = fan.spread(9)
    dark = []
    for angle in fan.asked[some]:
        here, front, behind = np.split(_strengths(fan.at(float(angle)), k0, transfer, near), 3)
        dark.append(here < LIGHTLESS * np.where(behind > 0, np.minimum(front, behind), front))
    return checks._replace(dark=interpolated(fan.asked, fan.asked[some], np.array(dark)))


def _strengths(beam: Beam, k0: float, transfer: Transfer, z: np.ndarray) -> np.ndarray:
    """The largest |S h| of a beam's strong plane waves on each plane, (Z,)."""
    k = _strong(beam, k0)
    # even in kx; through a layer of density 0 passes kx = 0 alone
    h = np.abs(transfer(np.maximum(np.abs(k), origin.NEAREST * k0) + 0j, z))
    return np.max(np.nan_to_num(h * np.abs(beam.spectrum(k, k0))), axis=1)


def sampled(checks: Checks, line: Line, moved: bool) -> Sampled:
    """The response at the planes that are compared, `moved` in its last bits or not."""
    check_contour(line.k.size, checks.fan.angles.size, checks.z.size)
    h = checks.transfer(line.k, checks.z, SHIFT if moved else 0.0)
    return Sampled(line, h, amplitudes(checks.k0, checks.fan, line))


def summed(checks: Checks, what: Sampled) -> np.ndarray:
    """p of the beams that are summed at the positions that are compared: (B, Z, X)."""
    right, left = what.amplitudes
    return np.asarray(spectral.direct_sum(what.line, what.h, right, left, checks.x - checks.fan.beam.centre))


class Survey(NamedTuple):
    """What a first look at the response tells."""

    noise: float  #: relative rounding of the response at the first and last plane
    bright: np.ndarray  #: see `Checks`
    sharp: float  #: distance from kx = 0 of the nearest singularity, inf where none is near


def survey(s: Scene, fan: Fan, transfer: Transfer, x: np.ndarray, z: np.ndarray, reach: Reach, rtol: float) -> Survey:
    """Rounding, seen in the change of the response when k changes in the last bits; where beams land, by stationary phase; and
    whether the response is sharp at kx = 0.

    All at the first and the last plane: if the beam lands among the positions there, it does so between.
    """
    k = np.linspace(0.03, min(reach.band, 3 * s.k0), 24) * (1 - 0.05j)
    asked = fan.asked
    some = fan.spread(3)
    rays = np.concatenate([_strong(fan.at(float(a)), s.k0) for a in asked[some]])
    step = 1e-6 * s.k0
    beside = np.abs(np.concatenate([rays - step, rays + step]))  # the response is even in kx
    ends = z[[0, -1]] if z.size > 1 else z
    # Gauss panels over propagating waves are wider than the step of a trapezoid rule
    wide = min(0.2 * reach.branch, math.sqrt(2 * s.k0 / max(reach.path, 1e-9)))
    first_node = math.pi / spectral.plan_bent(reach, rtol).window if fan.beam.entire else wide
    near = origin.around(np.array([first_node]))
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is not calm
        h = transfer(np.concatenate([k, k * (1 + SHIFT), near, beside]), ends)
    noise = _change(h[:, : k.size], h[:, k.size : 2 * k.size])
    allowed = max(0.01 * rtol, 30 * max(noise, spectral.EPS))
    sharp = math.inf
    if not np.all(origin.is_calm(h[:, 2 * k.size : 2 * k.size + near.size], allowed)):
        sharp = origin.nearest_singularity(transfer, ends, first_node, s.k0, allowed)
    middle, half = _landing(fan, h[:, 2 * k.size + near.size :], some.size, step)
    bright = np.zeros((asked.size, z.size))
    if np.any(middle < x.min() - half / 2) or np.any(middle > x.max() + half / 2):
        if z.size > 1:
            middle, half = _landing(fan, transfer(beside, z), some.size, step)
        places = middle[..., None] + half[..., None] * np.array([-0.4, 0.0, 0.4])
        bright = interpolated(asked, asked[some], _brightness(s, fan, transfer, z, asked[some], places.ravel()))
    return Survey(noise, bright, sharp)


def wide_enough(transfer: Transfer, z: np.ndarray, low: float, band: float) -> bool:
    """Whether a beam's own plane waves, low < kx < band, arrive on the first and the last plane, not only what else there is."""
    k = np.linspace(low, band, 24) + 0j
    h = np.abs(transfer(k, z[[0, -1]] if z.size > 1 else z))
    return bool(np.all(np.max(np.nan_to_num(h), axis=1) > 0.01))


def _landing(fan: Fan, h: np.ndarray, count: int, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Middle and half-width of the places where `count` beams land on each plane, (Z, count), from h beside their rays."""
    low, high = (v.reshape(h.shape[0], count, -1) for v in np.split(h, 2, axis=1))
    least, most = shifts(low, high, step)
    return fan.beam.centre + (least + most) / 2, fan.beam.reach(0.1) + (most - least) / 2


def _change(a: np.ndarray, b: np.ndarray) -> float:
    """Largest relative change from a to b, over the largest of each row."""
    size = np.max(np.abs(a), axis=1, keepdims=True)
    change = np.abs(a - b) / np.where(size > 0, size, 1.0)
    return float(np.max(change, initial=0.0, where=np.isfinite(change)))


def _strong(beam: Beam, k0: float) -> np.ndarray:
    """A few strong plane waves of a beam that propagate, or nearly."""
    lo, hi = beam.band(k0, 0.3)
    if not beam.entire:  # the band of a rotated beam is all that propagates: its strong part is that of its waist
        k = np.linspace(-0.999, 0.999, 4001) * k0
        size = np.abs(beam.spectrum(k, k0))
        lo, hi = k[np.flatnonzero(size >= 0.3 * size.max())[[0, -1]]]
    return np.clip(np.linspace(lo, hi, 9), -0.98 * k0, 0.98 * k0)


#: The most nodes over the propagating waves by which a beam is looked for where it lands, and the most terms of their sum.
MOST_RAYS, MOST_LOOKED_AT = 300_000, 1e7


def _brightness(s: Scene, fan: Fan, transfer: Transfer, z: np.ndarray, angles: np.ndarray, x: np.ndarray) -> np.ndarray:
    """The largest |p| of propagating waves at positions x, roughly, the less of two sums over them: (angles, Z)."""
    x = x - fan.beam.centre
    path = float(z.max()) - fan.beam.z0 + s.thickness
    count = 60 + 0.6 * s.k0 * (float(np.max(np.abs(x))) + path)
    found = np.full((2, angles.size, z.size), np.inf)
    if count > MOST_RAYS or count * x.size > MOST_LOOKED_AT:
        return np.zeros(found.shape[1:])
    beams = Fan(fan.beam, angles)
    for i, more in enumerate((1.0, 1.4)):
        line = spectral.propagating_line(s.k0, real_branches(s), int(more * count))
        right, left = amplitudes(s.k0, beams, line)
        with np.errstate(invalid="ignore", over="ignore"):
            p = spectral.direct_sum(line, transfer(line.k, z), right, left, x)
            found[i] = np.max(np.abs(p), axis=2)
    return np.nan_to_num(found.min(axis=0), nan=0.0, posinf=0.0)


def interpolated(at: np.ndarray, known: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (P, ...) at `known`, increasing, brought to `at`: the less of both neighbours'."""
    above = np.clip(np.searchsorted(known, at), 0, known.size - 1)
    below = np.where(known[above] == at, above, np.maximum(above - 1, 0))
    return np.minimum(values[above], values[below])


def arriving_band(s: Scene, checks: Checks, reach: Reach, tolerance: float) -> float:
    """|kx| up to which more than `tolerance` of the strongest plane wave arrives on some plane: what the slab lets through."""
    k = np.geomspace(0.01 * reach.k0, reach.band, 400)
    h = np.abs(checks.transfer(k.astype(complex), checks.z))
    launched = np.max(np.abs(checks.fan.spectra(k, s.k0)) + np.abs(checks.fan.spectra(-k, s.k0)), axis=0)
    size = np.nan_to_num(h * launched * k, nan=0.0, posinf=0.0)  # by decade of kx
    size = np.maximum.accumulate(size[:, ::-1], axis=1)[:, ::-1]  # edges have spectra with zeros
    strong = np.any(size > tolerance * size.max(axis=1, keepdims=True), axis=0)
    last = int(np.flatnonzero(strong)[-1]) if np.any(strong) else 0
    return float(k[min(last + 1, k.size - 1)])


def cut_spectra(s: Scene, checks: Checks, reach: Reach, tolerance: float) -> np.ndarray:
    """Every |kx| in the band at which a spectrum is cut off while more than `tolerance` of the strongest plane wave arrives there."""
    ends = checks.fan.spectrum_ends(s.k0)
    ends = ends[(ends > 0) & (ends <= reach.band * (1 + 1e-9))]
    if not ends.size:
        return ends
    # spectra of edges have zeros: the last twentieth in front of each end stands for it
    before = ends[:, None] * np.linspace(0.95, 1 - 1e-12, 9)
    k = np.concatenate([np.linspace(0.01, 1, 100) * ends[-1], before.ravel()])
    launched = np.max(np.abs(checks.fan.spectra(k, s.k0)) + np.abs(checks.fan.spectra(-k, s.k0)), axis=0)
    size = np.nan_to_num(np.abs(checks.transfer(k.astype(complex), checks.z)) * launched, nan=0.0, posinf=0.0)
    at = size[:, 100:].reshape(size.shape[0], *before.shape).max(axis=2)
    return ends[np.any(at > tolerance * size.max(axis=1, keepdims=True), axis=0)]


#: Of more asked beams than this so many are judged, spread evenly over the angles; those between take the worse neighbour's error.
JUDGED = 64


def difference(checks: Checks, one: Sampled, two: Sampled) -> tuple[np.ndarray, float]:
    """Estimated error of the first line over the largest |p| of each plane, by asked beam; and what lies beyond the ends of both."""
    asked = checks.fan.asked
    if checks.fan.mix is None or asked.size <= JUDGED:
        return _difference(checks, one, two)
    some = checks.fan.spread(JUDGED)
    dark = None if checks.dark is None else checks.dark[some]
    part = checks._replace(fan=checks.fan.taken(some), bright=checks.bright[some], dark=dark)
    error, edge = _difference(part, one, two)
    return -interpolated(asked, asked[some], -error), edge


def _difference(checks: Checks, one: Sampled, two: Sampled) -> tuple[np.ndarray, float]:
    fan = checks.fan
    (right1, left1), (right2, left2) = one.amplitudes, two.amplitudes
    x = checks.x - fan.beam.centre
    # some of the angles that are mixed are summed by themselves too, in the same product: the extremes, where mixing errs most
    some = np.empty(0, int)
    right, left = right1, left1
    if fan.mix is not None:
        some = fan.spread(5)
        pairs = zip(one.amplitudes, amplitudes(checks.k0, Fan(fan.beam, fan.asked[some]), one.line), strict=True)
        right, left = (np.concatenate(pair) for pair in pairs)
    own = np.asarray(spectral.direct_sum(one.line, one.h, right, left, x))
    a = fan.mixed(own[: fan.angles.size])
    b = fan.mixed(summed(checks, two) if two.sums is None else two.sums)
    largest = np.minimum(np.max(np.abs(a), axis=2), np.max(np.abs(b), axis=2))  # (A, Z)
    largest = np.maximum(largest, checks.bright)
    seen = largest > DARK if checks.dark is None else (largest > DARK) & ~checks.dark
    scale = np.where(seen, largest, 1.0)
    source = _source_rounding(checks.k0, fan, one)
    edge = first_edge = np.zeros(largest.shape)
    with np.errstate(invalid="ignore", over="ignore"):
        error = (np.max(np.abs(a - b), axis=2) + source) / scale
        if fan.beam.entire:
            mix = None if fan.mix is None else np.abs(fan.mix)
            edge, cut = (
                _beyond(two, right2, left2),
                _cut_off(checks, one, right1, left1, float(np.max(np.abs(x)))),
            )
            first_edge = _beyond(one, right1, left1)
            edge, cut, first_edge = (v if mix is None else mix @ v for v in (edge, cut, first_edge))
            error += cut / scale
        if fan.mix is not None:
            error += 3 * np.max(np.abs(own[fan.angles.size :] - a[some]), axis=(0, 2)) / scale
    worst = np.max(np.where(seen, 1.5 * np.nan_to_num(error, nan=np.inf) + edge / scale, 0.0), axis=1)
    # both lines share the rounding of k0, of a tilt k0 sin(angle) and of lengths: a unit of the last place of the longest phase
    way = float(np.max(np.abs(x)) + np.max(checks.z) - fan.beam.z0)
    ends = np.max(np.where(seen, np.maximum(edge, first_edge) / scale, 0.0))
    return worst + spectral.EPS * (4 + checks.k0 * way), float(ends)


def amplitudes(k0: float, fan: Fan, line: Line) -> tuple[np.ndarray, np.ndarray]:
    """w S(k) and w S(-k) about the source's middle: (B, n) each."""
    return spectral.amplitudes(line, lambda k: fan.spectra(k, k0), fan.beam.centre)


def _source_rounding(k0: float, fan: Fan, one: Sampled) -> np.ndarray:
    """What rounding of a sampled source brings to each plane, on both lines alike; (Z,).

    The less of two bounds: all plane waves in phase; or, as white noise of power N over kx, (1/2 pi) integral N |h|^2 dkx
    (Parseval). Of many angles the outermost stand for all, |kx - k0 sin(angle)| is largest there.
    """
    h, weight, bounds = np.abs(one.h), 2 * np.abs(one.line.weight), [np.zeros(one.h.shape[0])]
    for angle in {float(fan.angles.min()), float(fan.angles.max())}:
        rounding: Any = getattr(fan.at(angle), "spectral_rounding", None)
        for k in (one.line.k, -one.line.k) if rounding else ():
            coherent, white = rounding(k, k0)
            with np.errstate(over="ignore", invalid="ignore"):
                bounds.append(np.fmin(h @ (weight * coherent), np.sqrt(h**2 @ (weight * white**2))))
    return 4 * np.nan_to_num(np.max(bounds, axis=0), posinf=0.0)  # the largest of many positions


def _beyond(end: Sampled, right: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Size of what lies beyond the end of a path: its last two tenths, continued geometrically; (B, Z)."""
    if end.line.closed:
        return np.zeros((right.shape[0], end.h.shape[0]))
    n, circles = end.line.k.size, end.line.circles
    tenth = max(1, (n - circles) // 10)
    tail = slice(max(circles, n - 2 * tenth), n)
    size = (np.abs(right[:, tail]) + np.abs(left[:, tail]))[:, None] * np.abs(end.h[:, tail])
    last, before = size[..., -tenth:].sum(axis=-1), size[..., :-tenth].sum(axis=-1)
    ratio = np.clip(last / np.maximum(before, 1e-300), 0.0, 0.95)
    return 2 * last * ratio / (1 - ratio)


def _cut_off(checks: Checks, one: Sampled, right: np.ndarray, left: np.ndarray, extent: float) -> np.ndarray:
    """Size of what is missing where a spectrum ends inside a line (samples too coarse for their profile); (B, Z).

    |w S h e^{ikx}| at the last node or above it on the real axis, where the cut is defined, times the nodes that would fit between
    them: on a long way along z waves below the axis have died when those on the axis have not.
    """
    line, fan, k0 = one.line, checks.fan, checks.k0
    missing = np.zeros((right.shape[0], one.h.shape[0]))
    for side, amplitude in ((1, right), (-1, left)):
        beyond = fan.spectra(side * _after(line, line.k.size - 1), k0)
        for i in np.flatnonzero((amplitude[:, -1] == 0) | ~beyond.any(axis=1)):
            used = np.flatnonzero(amplitude[i])
            if used.size < 2:
                continue
            j = int(used[-1])
            if fan.at(float(fan.angles[i])).spectrum(side * _after(line, j), k0).any():
                continue
            step, depth = max(abs(line.k[j] - line.k[j - 1]), 1e-300), abs(line.k[j].imag)
            below = np.abs(one.h[:, j]) * math.exp(min(depth * extent, 100))
            on_axis = np.nan_to_num(np.abs(checks.transfer(np.array([line.k[j].real + 0j]), checks.z)[:, 0]))
            missing[i] += np.abs(amplitude[i, j]) * np.maximum(below, on_axis) * (1 + depth / step)
    return missing


def _after(line: Line, j: int) -> np.ndarray:
    """Two places beyond node j."""
    step = max(abs(line.k[j] - line.k[j - 1]), 1e-300)
    return line.k[j] + 2 * step * np.arange(1, 3)
