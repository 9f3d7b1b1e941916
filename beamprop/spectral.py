"""Lines of integration over kx, and the sums over them.

A plain sum over equispaced real kx answers for a periodic array of beams: a lossless slab has guided modes, poles of t on
the real axis beyond k0, beside the branch points at +-k0, and no window makes the sum converge. In open space the path of
integration passes below what lies on the right half of the axis and above what lies on the left: the limit of vanishing
absorption. h, the slab's response, is even in kx, so that half a path serves for both halves:

    p(x) = sum_m w_m h(k_m) [ S(k_m) e^{i k_m x} + S(-k_m) e^{-i k_m x} ]

Two paths do this, with X the largest distance from the beam's middle and kb the smallest |kx| of a branch point:

**One bent path**, ``k = s - i depth erf(1.5 s/kb)``, s = (m + 1/2) ds: the trapezoid rule on an analytic path. Fewest modes, any
x, one matrix product. Errors: aliasing ``exp(-depth W)``, W = 2 pi/ds, which must exceed X and the width of the field; rounding
``1e-16 exp(depth X)``; the edge of the spectrum, ``S h`` at the last k.

**Two straight lines**, for FFTs on even grids of many points. With ``chi(k) = erfc(-k/delta)/2``, entire, 1 on the right and 0 on the
left, the integral of ``S h chi(kx)`` is shifted to s - i sigma and that of ``S h chi(-kx)`` to s + i sigma: k_m = m ds - i sigma, w_m = chi(k_m)
ds/2 pi. Errors, Z being the length of the path along z:

* images from the right, ``exp(-sigma W)``;
* images from the left, ``exp(sigma W - D^2/(4/delta^2 + (Z delta/k0)^2))``, D = W - X - reach of the source: chi is a
  Gaussian beam of its own, of waist 2/delta;
* leak past the wrong branch point, ``exp(-(kb/delta)^2 + Z sqrt(kb sigma))``: below the axis on the left, waves grow with z;
* rounding, ``1e-16 exp(sigma X)``, and the edge of the spectrum.
"""

from __future__ import annotations

import functools
import itertools
import math
from typing import Any, NamedTuple

import numpy as np

from .fft import fast_length as fast_length
from .fft import plan_for
from .memory import POINTS_AT_A_TIME
from .products import product

EPS = float(np.finfo(float).eps)


class Line(NamedTuple):
    """Nodes k and weights w of ``p(x) = sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}]``.

    `step` is the spacing of Re k for an even line that begins at ``first * step``, and 0 for uneven nodes. The first
    `circles` nodes do not belong to the path: they go around single modes.
    """

    k: np.ndarray
    weight: np.ndarray
    step: Any = 0.0
    first: int = 0
    sigma: Any = 0.0
    delta: Any = 0.0
    circles: int = 0


class Reach(NamedTuple):
    """What a line must serve: lengths in m, wavenumbers in rad/m; floats, or arrays (F,) for several frequencies."""

    k0: Any  #: wavenumber of the medium in front
    branch: Any  #: smallest |kx| of a branch point or pole, kb
    band: Any  #: largest |Re kx| of the source's spectrum
    extent: Any  #: X, from the beam's middle to the farthest point asked for
    source: Any  #: reach of the launch profile about its middle
    path: Any  #: Z, from the launch plane to the farthest plane asked for


class OpenPlan(NamedTuple):
    """The four numbers of an open line; floats, or arrays (F,)."""

    sigma: Any
    delta: Any
    window: Any
    band: Any

    def other(self) -> OpenPlan:
        """A plan that shares no number with this one, to judge it by."""
        return OpenPlan(self.sigma * 1.1, self.delta * 0.93, self.window * 1.07, self.band)


def plan_open(reach: Reach, rtol: float, tighten: float = 1.0, noise: float = EPS) -> OpenPlan:
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
    return OpenPlan(sigma, delta, np.maximum(window, decades / sigma), reach.band)


def open_line(plan: OpenPlan) -> Line:
    """The even line k = m ds - i sigma, from where chi has vanished on the left to the edge of the band.

    Of arrays (F,), one line a frequency with the same m for all: k and weight are (F, n).
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
    return Line(k, chi * (ds[..., None] / (2 * math.pi)), ds if ds.ndim else float(ds), first, plan.sigma, plan.delta)


class BentPlan(NamedTuple):
    """The numbers of a bent path: depth below the axis, W, band, and the branch point that sets the bend."""

    depth: float
    window: float
    band: float
    branch: float

    def other(self) -> BentPlan:
        """A plan that shares no number with this one, to judge it by."""
        return BentPlan(self.depth * 0.87, self.window * 1.3, self.band * 1.12, self.branch * 0.95)


#: Most of depth times X for a first plan; measured over the cases of the accuracy study.
DEEPEST = 8.0


def plan_bent(reach: Reach, rtol: float, noise: float = EPS, deepest: float = math.inf) -> BentPlan:
    """A first plan from the error terms; what they do not know (the field's own width) shows in the difference to `other`.

    `noise` is the relative rounding of S h from one k to the next, which exp(depth X) magnifies; `deepest` is a limit from
    elsewhere: what lies below the axis. Magnified by more than exp(DEEPEST), images from the other side cost more than what a
    deeper path saves.
    """
    X = max(reach.extent, reach.source)
    growth = min(max(1.5, math.log(rtol / (30 * max(noise, 2 * EPS)))), DEEPEST)
    depth = min(growth / X, 0.35 * reach.branch, deepest)
    decades = math.log(10 / rtol)
    # far from its launch plane what is left on the path is exp(-i s^2 Z/2k0) about s = 0, whose width asks for a window too
    window = max(1.2 * X + 0.8 * decades / depth, 1.5 * math.sqrt(2 * decades * max(reach.path, 0.0) / reach.k0))
    return BentPlan(depth, window, reach.band, reach.branch)


def bent_line(plan: BentPlan) -> Line:
    """Nodes k = s - i depth erf(1.5 s/kb), s = (m + 1/2) 2 pi/W, and weights dk/2 pi."""
    from scipy.special import erf

    ds = 2 * math.pi / plan.window
    s = (np.arange(max(1, math.ceil(plan.band / ds))) + 0.5) * ds
    u = 1.5 * s / plan.branch
    slope = 1 - 1j * plan.depth * (1.5 / plan.branch) * (2 / math.sqrt(math.pi)) * np.exp(-(np.minimum(u, 26.0) ** 2))
    return Line(s - 1j * plan.depth * erf(u), slope * (ds / (2 * math.pi)))


def periodic_line(period: float, band: float) -> Line:
    """The real orders 2 pi m / period of a periodic array of beams, up to the band."""
    ds = 2 * math.pi / period
    k = np.arange(math.ceil(band / ds) + 1) * (ds + 0j)
    weight = np.full(k.size, 1 / period)
    weight[0] /= 2
    return Line(k, weight, ds, 0)


def propagating_line(k0: float, breaks: list[float], count: int) -> Line:
    """About `count` Gauss nodes over |kx| < k0, for sources of propagating waves only.

    The substitution kx = k0 sin(alpha) takes out the square roots at k0; `breaks` are other branch points inside, where
    intervals meet and alpha goes as u^2, which takes out a root there too; u is divided into panels of 24 nodes. Weights are
    k0 cos(alpha) of the rounded kx, for spectra with 1/kz in them.
    """
    edges = np.arcsin(np.unique(np.clip([0.0, *(b / k0 for b in breaks if 0 < b < k0), 1.0], 0, 1)))
    g, v = np.polynomial.legendre.leggauss(24)
    panels = max(2, math.ceil(count / 24))
    u = ((np.arange(panels)[:, None] + (g + 1) / 2) / panels).ravel()
    w = np.tile(v / 2 / panels, panels)
    nodes, weights = [], []
    for lo, hi in itertools.pairwise(edges):
        smooth, slope = _slow_ends(u, lo > 0, hi < edges[-1])
        k = k0 * np.sin(lo + (hi - lo) * smooth)
        nodes.append(k)
        weights.append(np.sqrt((k0 - k) * (k0 + k)) * (hi - lo) * slope * w / (2 * np.pi))
    return Line(np.concatenate(nodes).astype(complex), np.concatenate(weights))


def _slow_ends(u: np.ndarray, at_0: bool, at_1: bool) -> tuple[np.ndarray, np.ndarray]:
    """A map of (0, 1) to itself, and its slope, that goes as u^2 at the chosen ends."""
    if at_0 and at_1:
        return u * u * (3 - 2 * u), 6 * u * (1 - u)
    if at_0:
        return u * u, 2 * u
    if at_1:
        return u * (2 - u), 2 * (1 - u)
    return u, np.ones_like(u)


# --- sums over a line -------------------------------------------------------------------------------------


def amplitudes(line: Line, spectrum: Any, centre: float) -> tuple[np.ndarray, np.ndarray]:
    """w S(k) and w S(-k) about x = centre; `spectrum` is a function of kx about x = 0."""
    right, left = line.weight * spectrum(line.k), line.weight * spectrum(-line.k)
    if centre == 0:
        return right, left
    turn = np.exp(1j * line.k * centre)
    return right * turn, left / turn


#: The most exponentials that are held at a time.
MOST_PHASES = 4_000_000


def direct_sum(line: Line, h: np.ndarray, right: np.ndarray, left: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p at any x (relative to the centre): one matrix product, (Z, n) by (n, X).

    With amplitudes (B, n) of B beams the answer is (B, Z, X), for no more exponentials than one beam takes.
    """
    # plain: h @ (right[:, None] * exp(i k x) + left[:, None] * exp(-i k x))
    if x.size > POINTS_AT_A_TIME:
        whole = np.empty((*right.shape[:-1], h.shape[0], x.size), complex)
        for start in range(0, x.size, POINTS_AT_A_TIME):
            few = slice(start, start + POINTS_AT_A_TIME)
            whole[..., few] = direct_sum(line, h, right, left, x[few])
        return whole
    block = max(1, MOST_PHASES // max(1, x.size))
    if line.k.size > block:
        parts = [slice(start, start + block) for start in range(0, line.k.size, block)]
        sums = (direct_sum(Line(line.k[p], line.weight[p]), h[:, p], right[..., p], left[..., p], x) for p in parts)
        return functools.reduce(np.add, sums)
    forth, back = _phases(line.k, x, bool(np.any(left)))
    if right.ndim == 1 and h.shape[0] > 2:
        both = right[:, None] * forth
        if back is not None:
            both += left[:, None] * back
        return product(h, both)
    rows = (*right.shape[:-1], h.shape[0])
    out = product((right[..., None, :] * h).reshape(-1, h.shape[1]), forth)
    if back is not None:
        out += product((left[..., None, :] * h).reshape(-1, h.shape[1]), back)
    return out.reshape(*rows, x.size)


#: On even grids of at least this many points exponentials are products of two small tables, this many apart.
TABLE, STEP = 64, 32


def _phases(k: np.ndarray, x: np.ndarray, both: bool) -> tuple[np.ndarray, np.ndarray | None]:
    """e^{ikx} and, if asked for, e^{-ikx}: (n, X) each. Neither overflows, for |Im k| |x| was chosen small."""
    ik = 1j * k[:, None]
    if not _is_even(x):
        forth = np.exp(ik * x)
        return forth, 1 / forth if both else None
    dx = (x[-1] - x[0]) / (x.size - 1)
    coarse, fine = np.exp(ik * (x[0] + dx * np.arange(0, x.size, STEP))), np.exp(ik * (dx * np.arange(STEP)))
    forth = _outer(coarse, fine, x.size)
    return forth, _outer(1 / coarse, 1 / fine, x.size) if both else None


def _outer(coarse: np.ndarray, fine: np.ndarray, count: int) -> np.ndarray:
    out = coarse[:, :, None] * fine[:, None, :]
    return out.reshape(coarse.shape[0], -1)[:, :count]


def _is_even(x: np.ndarray) -> bool:
    """Whether a grid is even to rounding, and large enough for tables."""
    if x.size < TABLE:
        return False
    even = np.linspace(x[0], x[-1], x.size)
    return float(np.max(np.abs(x - even))) <= 4 * EPS * max(abs(float(x[0])), abs(float(x[-1])))


def _fold(h: np.ndarray, amplitude: np.ndarray, first: int, out: np.ndarray) -> None:
    """h (rows, count) times each amplitude (2, rows or 1, count), into bins first, first + 1, ... modulo n of out (2, rows, n).

    Exact aliasing, for the output has n points a window. Bins beside them are left as they are.
    """
    # plain: out = 0; out[..., bins % n] += h * amplitude
    n, count, start = out.shape[2], h.shape[1], 0
    while start < count:
        here = (first + start) % n
        part = slice(start, min(count, start + n - here, n if start < n else count))
        into = out[..., here : here + part.stop - part.start]
        if start < n:
            np.multiply(h[:, part], amplitude[..., part], out=into)
        else:
            into += h[:, part] * amplitude[..., part]
        start = part.stop


def fft_sum(
    line: Line,
    h: np.ndarray,
    right: np.ndarray,
    left: np.ndarray,
    x: np.ndarray,
    n: int,
    out: np.ndarray | None = None,
) -> np.ndarray:
    """p at even x = x_0 + j dx (relative to the centre), where line.step = 2 pi/(n dx): two FFTs a plane.

    Planes go through in blocks that stay in the cache. With amplitudes (B, n) of B beams the answer is (B, Z, X);
    `out`, of its shape and contiguous, is filled if given.
    """
    shape = (*right.shape[:-1], h.shape[0], x.size)
    turn = np.exp(1j * (line.first + np.arange(line.k.size)) * line.step * x[0])
    amplitude = np.stack([np.atleast_2d(right) * turn, np.atleast_2d(left) / turn])  # (2, B, n)
    grow = np.exp(line.sigma * x)
    scale = np.repeat([grow, 1 / grow], 2, axis=1)  # for complex numbers seen as pairs of real ones
    leftward = bool(np.any(left))
    planes, total = h.shape[0], amplitude.shape[1] * h.shape[0]
    flat = np.empty((total, x.size), complex) if out is None else out.reshape(-1, x.size)
    real = flat.view(float)
    rows = max(1, min(total, 2**14 // n))
    plan = plan_for(rows, n)
    plan.source[...] = 0
    result = plan.result[..., : x.size].view(float)
    # plain: flat = grow ifft(right h) + fft(left h)/grow
    for start in range(0, total, rows):
        stop = min(start + rows, total)
        if amplitude.shape[1] == 1:
            part, weights = h[start:stop], amplitude
        else:
            beam, plane = np.divmod(np.arange(start, stop), planes)
            part, weights = h[plane], amplitude[:, beam]
        _fold(part, weights, line.first, plan.source[:, : stop - start])
        plan.run[0]()
        if leftward:
            plan.run[1]()
            np.einsum("srx,sx->rx", result[:, : stop - start], scale, out=real[start:stop])
        else:
            np.multiply(result[0, : stop - start], scale[0], out=real[start:stop])
    return flat.reshape(shape)
