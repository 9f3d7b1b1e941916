"""Contours of integration over kx: their plans and nodes.

A plain sum over equispaced real kx answers for a periodic array of beams: a lossless slab has guided modes, poles of t on
the real axis beyond k0, beside the branch points at +-k0, and no window makes the sum converge. In open space the contour of
integration passes below what lies on the right half of the axis and above what lies on the left: the limit of vanishing
absorption. h, the slab's response, is even in kx, so that half a contour serves for both halves:

    p(x) = sum_m w_m h(k_m) [ S(k_m) e^{i k_m x} + S(-k_m) e^{-i k_m x} ]

Two kinds of contour do this, with X the largest distance from the beam's middle and kb the smallest |kx| of a branch point:

**One bent contour**, ``k = s - i depth erf(1.5 s/kb)``, s = (m + 1/2) ds: the trapezoid rule on an analytic contour. Fewest plane waves, any
x, one matrix product. Errors: aliasing ``exp(-depth W)``, W = 2 pi/ds, which must exceed X and the width of the field; rounding
``1e-16 exp(depth X)``; the edge of the spectrum, ``S h`` at the last k.

**Two straight contours**, for FFTs on even grids of many points. With ``chi(k) = erfc(-k/delta)/2``, entire, 1 on the right and 0 on the
left, the integral of ``S h chi(kx)`` is shifted to s - i sigma and that of ``S h chi(-kx)`` to s + i sigma: k_m = m ds - i sigma, w_m = chi(k_m)
ds/2 pi. Errors, Z being the distance along z:

* images from the right, ``exp(-sigma W)``;
* images from the left, ``exp(sigma W - D^2/(4/delta^2 + (Z delta/k0)^2))``, D = W - X - reach of the source: chi is a
  Gaussian beam of its own, of waist 2/delta;
* leak past the wrong branch point, ``exp(-(kb/delta)^2 + Z sqrt(kb sigma))``: below the axis on the left, waves grow with z;
* rounding, ``1e-16 exp(sigma X)``, and the edge of the spectrum.
"""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np

EPS = float(np.finfo(float).eps)


class Contour(NamedTuple):
    """Nodes k and weights w of ``p(x) = sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}]``.

    `step` is the spacing of Re k for an even contour that begins at ``first * step``, and 0 for uneven nodes. The first
    `circles` nodes do not belong to the contour itself: they go around single modes.
    """

    k: np.ndarray
    weight: np.ndarray
    step: Any = 0.0
    first: int = 0
    sigma: Any = 0.0
    delta: Any = 0.0
    circles: int = 0
    closed: bool = False  #: whether it ends where the spectra do: nothing lies beyond


class Extent(NamedTuple):
    """What a contour must serve: lengths in m, wavenumbers in rad/m; floats, or arrays (F,) for several frequencies."""

    k0: Any  #: wavenumber of the medium in front
    branch: Any  #: smallest |kx| of a branch point, kb
    band: Any  #: largest |Re kx| of the source's spectrum
    extent: Any  #: X, from the beam's middle to the farthest requested point
    source: Any  #: reach of the launch profile about its middle
    path: Any  #: Z, from the launch plane to the farthest requested plane
    low: Any = 0.0  #: smallest |Re kx| of the source's spectrum


class StraightPlan(NamedTuple):
    """The four numbers of a straight contour; floats, or arrays (F,)."""

    sigma: Any
    delta: Any
    window: Any
    band: Any

    def other(self) -> StraightPlan:
        """A plan that shares no number with this one, to estimate its error by."""
        return StraightPlan(self.sigma * 1.1, self.delta * 0.93, self.window * 1.07, self.band)


def plan_straight(reach: Extent, rtol: float, tighten: float = 1.0, noise: float = EPS) -> StraightPlan:
    """Choose sigma, delta, W and the band from the error terms above; `tighten` > 1 asks for more of everything.

    `noise` is the relative rounding of S h, which exp(sigma X) magnifies.
    """
    decades = math.log(20 / rtol) * tighten
    rounding = max(2.0, math.log(rtol / max(100 * EPS, 3 * noise))) / tighten
    k, Z = reach.k0, np.maximum(reach.path, 1e-3 / reach.k0)
    X = np.maximum(reach.extent, reach.source)
    delta = reach.branch / math.sqrt(decades)
    sigma, window = rounding / (X + 30 / k), X
    for _ in range(30):
        before = sigma, delta, window
        spread = np.sqrt(4 / delta**2 + (Z * delta / k) ** 2)
        guard = spread * np.sqrt(sigma * window + decades)
        window = np.maximum(X + reach.source + guard, decades / sigma)
        sigma = np.minimum(np.minimum(decades / window, rounding / X), 3.0 * k / (Z * delta))
        steep = reach.branch / np.sqrt(decades + Z * np.sqrt(reach.branch * sigma))
        delta = np.minimum(steep, np.sqrt(2 * k / Z))
        if all(np.all(new == old) for new, old in zip((sigma, delta, window), before, strict=True)):
            break
    return StraightPlan(sigma, delta, np.maximum(window, decades / sigma), reach.band)


def straight_contour(plan: StraightPlan) -> Contour:
    """The even contour k = m ds - i sigma, from where chi has vanished on the left to the edge of the band.

    Of arrays (F,), one contour a frequency with the same m for all: k and weight are (F, n).
    """
    from scipy.special import erfc

    ds = 2 * math.pi / np.asarray(plan.window)
    first = -math.ceil(np.max(np.minimum(plan.band, 6.5 * plan.delta) / ds))
    m = np.arange(first, math.ceil(np.max(plan.band / ds)) + 1)
    k = ds[..., None] * m - 1j * np.asarray(plan.sigma)[..., None]
    # plain: chi = erfc(-k/delta)/2 everywhere. |erfc(u + iv)| < exp(v^2 - u^2) for u > 1: beyond u^2 = v^2 + 37, chi = 1;
    # and chi(k) = 1 - conj(chi(-conj k)), so that the nodes on the right follow from those on the left.
    near = np.max(np.sqrt(37 * np.square(plan.delta) + np.square(plan.sigma)) / ds)
    size = max(-first, math.ceil(min(near, m[-1])))
    left = ds[..., None] * np.arange(-size, 1) - 1j * np.asarray(plan.sigma)[..., None]
    left = erfc(-left / np.asarray(plan.delta)[..., None]) / 2
    chi = np.ones(k.shape, complex)
    chi[..., : 1 - first] = left[..., size + first :]
    right = min(size, m[-1])
    chi[..., 1 - first : 1 - first + right] -= np.conj(left[..., :size][..., ::-1][..., :right])
    return Contour(
        k, chi * (ds[..., None] / (2 * math.pi)), ds if ds.ndim else float(ds), first, plan.sigma, plan.delta
    )


class BentPlan(NamedTuple):
    """The numbers of a bent contour.

    Below the axis up to Re kx = `crossing` and above it beyond; nodes are graded towards the origin from `sharp` on.
    """

    depth: float  #: below the axis
    window: float  #: W = 2 pi / spacing of the nodes
    band: float  #: Re kx where it ends
    bend: float  #: over which it leaves the axis
    low: float = 0.0  #: Re kx where it begins: a beam may have no plane waves nearer to the normal
    sharp: float = math.inf  #: distance of the nearest singularity from the origin, where nodes are graded
    grading: float = 0.0  #: nodes for each e-fold of |kx|
    crossing: float = math.inf
    gap: float = math.inf  #: half-width of the crossing

    def other(self) -> BentPlan:
        """A plan that shares no number with this one, to estimate its error by."""
        return self._replace(
            depth=self.depth * 0.87,
            window=self.window * 1.3,
            band=self.band * 1.12,
            bend=self.bend * 0.95,
            low=self.low * 0.9,
            sharp=self.sharp * 0.6,
            grading=self.grading * 1.2,
            crossing=self.crossing + 0.1 * self.gap if math.isfinite(self.gap) else math.inf,
            gap=self.gap * 0.8,
        )

    @property
    def nodes(self) -> float:
        """About how many nodes the contour takes."""
        graded = self.grading * math.asinh(self.band / self.sharp) if self.grading else 0.0
        return (self.band - self.low) * self.window / (2 * math.pi) + graded


#: Most of depth times X for a first plan; measured over the cases of the accuracy study.
DEEPEST = 8.0
#: Depth of a contour over its bend: it leaves the origin at 30 degrees, as far from poles above it on the right as from those
#: below it on the left.
SLOPE = 0.35


def plan_bent(
    reach: Extent, rtol: float, noise: float = EPS, deepest: float = math.inf, sharp: float = math.inf
) -> BentPlan:
    """A first plan from the error terms; what they do not know (the field's own width) shows in the difference to `other`.

    `noise` is the relative rounding of S h from one k to the next, which exp(depth X) magnifies; `deepest` is a limit from
    elsewhere: what lies below the axis; `sharp` is the distance from the origin of a pole near it. Magnified by more than
    exp(DEEPEST), images from the other side cost more than what a deeper contour saves.

    What lies much nearer to the origin than the contour could be deep (a branch point of a fast half-space, a resonance at
    normal incidence) does not hold the contour at the axis: nodes are graded towards the origin instead. On the scale of each
    |kx| the contour passes all of it by the same angle, SLOPE sees to that.
    """
    X = max(reach.extent, reach.source)
    growth = min(max(1.5, math.log(rtol / (30 * max(noise, 2 * EPS)))), DEEPEST)
    broad = max(reach.branch, reach.k0 / 2) if reach.branch < reach.k0 else reach.branch
    deep = min(growth / X, SLOPE * broad, deepest)
    decades = math.log(10 / rtol)
    nearest = min(reach.branch, sharp)
    if SLOPE * nearest < deep / 2:
        depth, bend, graded = deep, deep / SLOPE, (nearest / 2, decades / 2.5)
    else:
        depth, bend, graded = min(deep, SLOPE * nearest), reach.branch, (math.inf, 0.0)
    # far from its launch plane what is left on the contour is exp(-i s^2 Z/2k0) about s = 0, whose width asks for a window too
    window = max(1.2 * X + 0.8 * decades / depth, 1.5 * math.sqrt(2 * decades * max(reach.path, 0.0) / reach.k0))
    return BentPlan(depth, window, reach.band, bend, reach.low, *graded)


def bent_contour(plan: BentPlan) -> Contour:
    """Nodes k = s - i depth erf(1.5 s/bend) of the trapezoid rule, and weights dk/2 pi; s = (m + 1/2) 2 pi/W where not graded.

    At a crossing the imaginary part changes sign as erf((crossing - s)/gap).
    """
    from scipy.special import erf

    s, step = _graded(plan)
    u = 1.5 * s / plan.bend
    down = erf(u)
    slope = (1.5 / plan.bend) * GAUSS * np.exp(-(np.minimum(u, 26.0) ** 2))
    if math.isfinite(plan.crossing):
        v = (plan.crossing - s) / plan.gap
        side = erf(v)
        slope = slope * side - down * (GAUSS / plan.gap) * np.exp(-(np.minimum(np.abs(v), 26.0) ** 2))
        down = down * side
    return Contour(s - 1j * plan.depth * down, (1 - 1j * plan.depth * slope) * (step / (2 * math.pi)))


GAUSS = 2 / math.sqrt(math.pi)


def _graded(plan: BentPlan) -> tuple[np.ndarray, np.ndarray | float]:
    """Re kx of the nodes, and the spacing at each.

    Node m + 1/2 = s/ds + grading asinh(s/sharp): even where s is large, and even in log(s) between `sharp` and there.
    """
    ds = 2 * math.pi / plan.window
    if not plan.grading:
        first = math.floor(plan.low / ds)
        return (first + np.arange(max(1, math.ceil(plan.band / ds) - first)) + 0.5) * ds, ds
    a, B = plan.sharp, plan.grading
    v = np.arange(max(1, math.ceil(plan.band / ds + B * math.asinh(plan.band / a)))) + 0.5
    # a sinh(y)/ds + B y = v is convex in y: Newton's method from above descends
    y = np.minimum(v / B, np.arcsinh(v * ds / a))
    for _ in range(60):
        step = (a / ds * np.sinh(y) + B * y - v) / (a / ds * np.cosh(y) + B)
        y = y - step
        if float(np.max(np.abs(step))) < 1e-14:
            break
    return a * np.sinh(y), 1 / (1 / ds + B / (a * np.cosh(y)))


def periodic_contour(period: float, band: float) -> Contour:
    """The real orders 2 pi m / period of a periodic array of beams, up to the band."""
    ds = 2 * math.pi / period
    k = np.arange(math.ceil(band / ds) + 1) * (ds + 0j)
    weight = np.full(k.size, 1 / period)
    weight[0] /= 2
    return Contour(k, weight, ds, 0)


def propagating_contour(
    k0: float, breaks: list[float], count: int, dip: float = 0.0, sharp: float = math.inf
) -> Contour:
    """About `count` Gauss nodes from 0 to k0, for sources of propagating waves only.

    The substitution kx = k0 sin(alpha) takes out the square roots at k0, and a spectrum with 1/kz in it is an entire function of
    alpha: between 0 and k0 the contour may dip below the axis, ``alpha = t - i dip cos(t) tanh(t/2 dip)``, away from poles of sharp
    resonances; weights are complex then. `breaks` are other branch points inside, where intervals meet and t goes as u^2, which takes out a root there too; u is divided
    into panels of 24 nodes, the first one graded towards 0 where something is `sharp` at that distance from it. Weights are k0
    cos(alpha) of the rounded kx.
    """
    edges = np.arcsin(np.unique(np.clip([0.0, *(b / k0 for b in breaks if 0 < b < k0), 1.0], 0, 1)))
    g, v = np.polynomial.legendre.leggauss(24)
    even = np.linspace(0, 1, max(2, math.ceil(count / 24)) + 1)
    nodes, weights = [], []
    for lo, hi in itertools.pairwise(edges):
        stops = _towards_origin(even, min(sharp / k0, dip or math.inf) / (hi - lo)) if lo == 0 else even
        u = (stops[:-1, None] + np.diff(stops)[:, None] * (g + 1) / 2).ravel()
        w = (np.diff(stops)[:, None] * v / 2).ravel()
        smooth, slope = slow_ends(u, lo > 0, hi < edges[-1])
        t = lo + (hi - lo) * smooth
        alpha, turn = _dipped(t, dip) if dip else (t, 1.0)
        k = k0 * np.sin(alpha)
        nodes.append(k)
        weights.append(np.sqrt((k0 - k) * (k0 + k)) * turn * (hi - lo) * slope * w / (2 * np.pi))
    return Contour(np.concatenate(nodes).astype(complex), np.concatenate(weights))


def _dipped(t: np.ndarray, dip: float) -> tuple[np.ndarray, np.ndarray]:
    """alpha on the contour that dips below the axis, and dalpha/dt: at half the slope from 0, and back at the end."""
    rise = np.tanh(t / (2 * dip))
    return t - 1j * dip * np.cos(t) * rise, 1 - 1j * (np.cos(t) * (1 - rise**2) / 2 - dip * np.sin(t) * rise)


def _towards_origin(stops: np.ndarray, sharp: float) -> np.ndarray:
    """Stops of panels, those in the first one halved towards 0 down to a quarter of `sharp`."""
    if not sharp < 2 * stops[1]:
        return stops
    halvings = math.ceil(math.log2(4 * stops[1] / sharp))
    return np.concatenate([[0.0], stops[1] * 2.0 ** -np.arange(halvings, -1, -1), stops[2:]])


def slow_ends(u: np.ndarray, at_0: bool, at_1: bool) -> tuple[np.ndarray, np.ndarray]:
    """A map of (0, 1) to itself, and its slope, that goes as u^2 at the chosen ends."""
    if at_0 and at_1:
        return u * u * (3 - 2 * u), 6 * u * (1 - u)
    if at_0:
        return u * u, 2 * u
    if at_1:
        return u * (2 - u), 2 * (1 - u)
    return u, np.ones_like(u)
