"""Contours of integration over kx: their plans and nodes.

A plain sum over equispaced real kx answers for a periodic array of beams: a lossless slab has guided modes, poles of t on
the real axis beyond k0, beside the branch points at +-k0, and no window makes the sum converge. In open space, the limit of vanishing
absorption, the contour of integration passes below the singularities on the right half of the axis and above those on the left.
h, the slab's response, is even in kx, so that half a contour serves for both halves:

    p(x) = sum_m w_m h(k_m) [ S(k_m) e^{i k_m x} + S(-k_m) e^{-i k_m x} ]

Two kinds of contour do this, with X the largest distance from the beam's middle and kb the smallest |kx| of a branch point:

**One bent contour**, ``k = s - i depth erf(1.5 s/kb)``, s = (m + 1/2) ds: the trapezoid rule on an analytic contour. It takes the fewest plane
waves, any x, and one matrix product. Errors: aliasing ``exp(-depth W)``, where W = 2 pi/ds must exceed X and the width of the
field; rounding ``1e-16 exp(depth X)``; the end of the band, ``S h`` at the last k.

**Two straight contours**, for FFTs on even grids of many points. With ``chi(k) = erfc(-k/delta)/2``, entire, 1 on the right and 0 on the
left, the integral of ``S h chi(kx)`` is shifted to s - i sigma and that of ``S h chi(-kx)`` to s + i sigma: k_m = m ds - i sigma, w_m = chi(k_m)
ds/2 pi. Errors, Z being the distance along z:

* images from the right, ``exp(-sigma W)``;
* images from the left, ``exp(sigma W - D^2/(4/delta^2 + (Z delta/k0)^2))``, D = W - X - source's half-width:
  chi is a Gaussian beam of waist 2/delta;
* leak past the branch point on the wrong side, ``exp(-(kb/delta)^2 + Z sqrt(kb sigma))``: below the axis on the left, waves grow with z;
* rounding, ``1e-16 exp(sigma X)``, and the end of the band.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

#: Spacing of floating-point numbers next to 1, 2^-52.
EPS = float(np.finfo(float).eps)


class Contour(NamedTuple):
    """Nodes k and weights w of ``p(x) = sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}]``.

    `step` is the spacing of Re k for an even contour that begins at ``first * step``, and 0 for uneven nodes. The first
    `circles` nodes are not on the contour itself but on circles around poles.
    """

    k: np.ndarray
    weight: np.ndarray
    step: Any = 0.0
    first: int = 0
    sigma: Any = 0.0
    circles: int = 0
    closed: bool = False  #: whether all spectra vanish beyond its end
    falling: int = 0  #: so many nodes at its end lie beyond the band, where a filter takes waves out
    lattice: Any = (
        None  #: of a beam in space, the real (kx, ky) over which its spectrum is summed: see `contour.space.lattice`
    )


class Extent(NamedTuple):
    """What a contour must serve: lengths in m, wavenumbers in rad/m; floats, or arrays (F,) for several frequencies."""

    k0: Any  #: wavenumber of the medium in front
    branch: Any  #: smallest |kx| of a branch point, kb
    band: Any  #: largest |Re kx| of the source's spectrum
    farthest: Any  #: from the beam's middle to the farthest requested point
    source: Any  #: half-width of the launch profile
    path: Any  #: Z, from the launch plane to the farthest requested plane
    low: Any = 0.0  #: smallest |Re kx| of the source's spectrum

    @property
    def across(self) -> Any:
        """X, the length along x over which phases turn: to the farthest point, or to the source's edge if that is farther."""
        return np.maximum(self.farthest, self.source)


class StraightPlan(NamedTuple):
    """The four numbers of a straight contour; floats, or arrays (F,)."""

    sigma: Any
    delta: Any
    window: Any
    band: Any

    def second_plan(self) -> StraightPlan:
        """A plan to estimate this one's error by: the exponents sigma W and (kb/delta)^2 of its error terms are a sixth larger."""
        return StraightPlan(self.sigma * 1.1, self.delta * 0.93, self.window * 1.07, self.band)


def plan_straight(extent: Extent, rtol: float, tighten: float = 1.0, noise: float = EPS) -> StraightPlan:
    """Choose sigma, delta and W so that the error terms above are below rtol; `tighten` > 1 multiplies their exponents.

    `noise` is the relative rounding of S h, which exp(sigma X) magnifies.
    """
    # each term may be a twentieth of rtol; the rounding of a sum of some 1e4 nodes is 100 EPS, that of S h counts thrice, and a
    # contour is at least 2/X deep. Z = 0 would divide by 0.
    decades = math.log(20 / rtol) * tighten
    rounding = max(2.0, math.log(rtol / max(100 * EPS, 3 * noise))) / tighten
    k, Z, X = extent.k0, np.maximum(extent.path, 1e-3 / extent.k0), extent.across
    delta = extent.branch / math.sqrt(decades)
    sigma, window = rounding / (X + 30 / k), X
    for _ in range(30):  # 3000 random ones came to rest within five rounds
        before = sigma, delta, window
        spread = np.sqrt(4 / delta**2 + (Z * delta / k) ** 2)
        guard = spread * np.sqrt(sigma * window + decades)
        window = np.maximum(X + extent.source + guard, decades / sigma)
        # below the axis waves of kx = -delta, as far as chi goes, grow as exp(Z delta sigma/k): by e^3 at most
        sigma = np.minimum(np.minimum(decades / window, rounding / X), 3.0 * k / (Z * delta))
        steep = extent.branch / np.sqrt(decades + Z * np.sqrt(extent.branch * sigma))
        delta = np.minimum(steep, np.sqrt(2 * k / Z))  # beyond, `spread` grows with delta
        if all(np.all(new == old) for new, old in zip((sigma, delta, window), before, strict=True)):
            break
    return StraightPlan(sigma, delta, np.maximum(window, decades / sigma), extent.band)


def straight_contour(plan: StraightPlan) -> Contour:
    """The even contour k = m ds - i sigma, from where chi has vanished on the left to the end of the band.

    A plan of arrays (F,) gives a contour for each frequency with the same m for all: k and weight are (F, n). Weights are
    `response.reference.chi` times ds/2 pi.
    """
    from scipy.special import erfc

    ds = 2 * math.pi / np.asarray(plan.window)
    first = -math.ceil(np.max(np.minimum(plan.band, 6.5 * plan.delta) / ds))  # erfc(6.5)/2 = 2e-20
    m = np.arange(first, math.ceil(np.max(plan.band / ds)) + 1)
    k = ds[..., None] * m - 1j * np.asarray(plan.sigma)[..., None]
    # |erfc(u + iv)| < exp(v^2 - u^2) for u > 1: beyond u^2 = v^2 + 37 chi is 1, for exp(-37) = 8e-17; and chi(k) = 1 - conj(chi(-conj k)),
    # so that the nodes on the right follow from those on the left.
    near = np.max(np.sqrt(37 * np.square(plan.delta) + np.square(plan.sigma)) / ds)
    size = max(-first, math.ceil(min(near, m[-1])))
    left = ds[..., None] * np.arange(-size, 1) - 1j * np.asarray(plan.sigma)[..., None]
    left = erfc(-left / np.asarray(plan.delta)[..., None]) / 2
    chi = np.ones(k.shape, complex)
    chi[..., : 1 - first] = left[..., size + first :]
    right = min(size, m[-1])
    chi[..., 1 - first : 1 - first + right] -= np.conj(left[..., :size][..., ::-1][..., :right])
    return Contour(k, chi * (ds[..., None] / (2 * math.pi)), ds if ds.ndim else float(ds), first, plan.sigma)


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

    def second_plan(self) -> BentPlan:
        """A plan to estimate this one's error by, all numbers of which differ by 5 to 40 per cent.

        The exponent depth W of its images is 0.87 1.3 = 1.13 times as large; nodes and images lie elsewhere.
        """
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


#: Most of depth times X for a first plan. W is 1.2 X + 0.8 decades/depth: at rtol 1e-8, 3.3 X with 8 and 2.2 X with 16, but images from
#: the other side are magnified by exp(depth X) and ask for a wider window again.
DEEPEST = 8.0
#: Depth of a contour over its bend: it leaves the origin with the slope 1.5 GAUSS SLOPE = 0.59, at 30 degrees, a third of the way from
#: the axis with its poles to the imaginary axis; and at the bend it is erf(1.5) = 0.97 of its depth.
SLOPE = 0.35
#: Slope of erf at 0.
GAUSS = 2 / math.sqrt(math.pi)


def plan_bent(
    extent: Extent, rtol: float, noise: float = EPS, deepest: float = math.inf, sharp: float = math.inf
) -> BentPlan:
    """A first plan from the error terms; the field's own width, which they lack, shows in the difference to the second plan.

    `noise` is the relative rounding of S h from one k to the next, which exp(depth X) magnifies; `deepest` is the depth at which
    singularities below the axis begin; `sharp` is the distance from the origin of a pole near it.

    A singularity much nearer to the origin than the contour could be deep (a branch point of a fast half-space, a resonance at
    normal incidence) does not hold the contour at the axis: nodes are graded towards the origin instead. SLOPE keeps the angle,
    seen from the origin, between the contour and singularities on the axis the same at any |kx|.
    """
    X = extent.across
    # magnified rounding may be a thirtieth of rtol; a depth of 1.5/X, which magnifies by 4.5, is always taken
    growth = min(max(1.5, math.log(rtol / (30 * max(noise, 2 * EPS)))), DEEPEST)
    # the branch point of a half-space faster than k0/2 is left to the grading
    broad = max(extent.branch, extent.k0 / 2) if extent.branch < extent.k0 else extent.branch
    deep = min(growth / X, SLOPE * broad, deepest)
    decades = math.log(10 / rtol)
    nearest = min(extent.branch, sharp)
    if SLOPE * nearest < deep / 2:  # a contour above it would take twice the window, or more
        # n nodes an e-fold of s, 0.53 rad from the axis, err by exp(-2 pi 0.53 n): n = decades/3.4 would do; a third more is taken
        depth, bend, graded = deep, deep / SLOPE, (nearest / 2, decades / 2.5)
    else:
        depth, bend, graded = min(deep, SLOPE * nearest), extent.branch, (math.inf, 0.0)
    # images exp(-depth W) are below rtol/10 where depth X > decades/6; elsewhere the second plan shows what is missing. Far from the
    # launch plane exp(-i s^2 Z/2k0) about s = 0 is left on the contour: sqrt(2 decades Z/k0) wide in x, and half as much again
    window = max(1.2 * X + 0.8 * decades / depth, 1.5 * math.sqrt(2 * decades * max(extent.path, 0.0) / extent.k0))
    return BentPlan(depth, window, extent.band, bend, extent.low, *graded)


#: Places v of the nodes `first` to `first + count` of a rule over 0 < v, about 1 apart, and their weights over that step.
Rule = Callable[[int, int], tuple[np.ndarray, Any]]


def midpoints(first: int, count: int) -> tuple[np.ndarray, Any]:
    """Half whole numbers: the trapezoid rule of functions that are even in v."""
    return first + np.arange(count) + 0.5, 1.0


def bent_contour(plan: BentPlan, rule: Rule = midpoints) -> Contour:
    """Nodes k = s - i depth erf(1.5 s/bend) of a rule, and weights dk/2 pi; s = v 2 pi/W where not graded.

    At a crossing the imaginary part changes sign as erf((crossing - s)/gap). Exponents are cut at 26^2: exp(-26^2) = 2e-294
    does not underflow.
    """
    from scipy.special import erf

    s, step = _graded(plan, rule)
    u = 1.5 * s / plan.bend
    down = erf(u)
    slope = (1.5 / plan.bend) * GAUSS * np.exp(-(np.minimum(u, 26.0) ** 2))
    if math.isfinite(plan.crossing):
        v = (plan.crossing - s) / plan.gap
        side = erf(v)
        slope = slope * side - down * (GAUSS / plan.gap) * np.exp(-(np.minimum(np.abs(v), 26.0) ** 2))
        down = down * side
    return Contour(s - 1j * plan.depth * down, (1 - 1j * plan.depth * slope) * (step / (2 * math.pi)))


def _graded(plan: BentPlan, rule: Rule) -> tuple[np.ndarray, np.ndarray | float]:
    """Re kx of the nodes, and the spacing at each.

    Node v = s/ds + grading asinh(s/sharp): even where s is large, and even in log(s) between `sharp` and there.
    """
    ds = 2 * math.pi / plan.window
    if not plan.grading:
        first = math.floor(plan.low / ds)
        v, share = rule(first, max(1, math.ceil(plan.band / ds) - first))
        return v * ds, ds * share
    a, B = plan.sharp, plan.grading
    v, share = rule(0, max(1, math.ceil(plan.band / ds + B * math.asinh(plan.band / a))))
    # a sinh(y)/ds + B y = v is convex in y: Newton's method from above descends
    y = np.minimum(v / B, np.arcsinh(v * ds / a))
    for _ in range(60):  # ten serve; the step is quadratic at the end
        step = (a / ds * np.sinh(y) + B * y - v) / (a / ds * np.cosh(y) + B)
        y = y - step
        if float(np.max(np.abs(step))) < 1e-14:
            break
    return a * np.sinh(y), share / (1 / ds + B / (a * np.cosh(y)))


def periodic_contour(period: float, band: float) -> Contour:
    """The real orders 2 pi m / period of a periodic array of beams, up to the band."""
    ds = 2 * math.pi / period
    k = np.arange(math.ceil(band / ds) + 1) * (ds + 0j)
    weight = np.full(k.size, 1 / period)
    weight[0] /= 2
    return Contour(k, weight, ds, 0)


#: Gauss nodes of a panel over the propagating waves: 24 integrate 40 rad of phase to 1e-14 (J_48(20)).
PANEL = 24


def propagating_contour(
    k0: float, breaks: list[float], count: int, dip: float = 0.0, sharp: float = math.inf
) -> Contour:
    """About `count` Gauss nodes from 0 to k0, for sources of propagating waves only.

    The substitution kx = k0 sin(alpha) takes out the square roots at k0, and a spectrum with 1/kz in it is an entire function of
    alpha. Between 0 and k0 the contour may dip below the axis, ``alpha = t - i dip cos(t) tanh(t/2 dip)``, away from poles of sharp
    resonances; weights are complex then. `breaks` are further branch points inside, where intervals meet and t goes as u^2, which
    takes out their roots. u is divided into panels, the first of which is graded towards 0 if there is a singularity at the
    distance `sharp` from it. Weights are k0 cos(alpha) of the rounded kx.
    """
    edges = np.arcsin(np.unique(np.clip([0.0, *(b / k0 for b in breaks if 0 < b < k0), 1.0], 0, 1)))
    g, v = np.polynomial.legendre.leggauss(PANEL)
    even = np.linspace(0, 1, max(2, math.ceil(count / PANEL)) + 1)
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
    """alpha on the contour that dips below the axis, and dalpha/dt: it leaves 0 with the slope 1/2 and is back on the axis at k0."""
    rise = np.tanh(t / (2 * dip))
    return t - 1j * dip * np.cos(t) * rise, 1 - 1j * (np.cos(t) * (1 - rise**2) / 2 - dip * np.sin(t) * rise)


def _towards_origin(stops: np.ndarray, sharp: float) -> np.ndarray:
    """Ends of panels, the first panel halved towards 0 down to a quarter of `sharp`: each is as long as it is far from 0."""
    if not sharp < 2 * stops[1]:  # beyond twice the panel's length 24 nodes follow a singularity as they are
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
