"""Lines of integration over kx, and the sums over them. The only user of an FFT library.

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

EPS = float(np.finfo(float).eps)


class Line(NamedTuple):
    """Nodes k and weights w of ``p(x) = sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}]``.

    `step` is the spacing of Re k for an even line that begins at ``first * step``, and 0 for uneven nodes.
    """

    k: np.ndarray
    weight: np.ndarray
    step: Any = 0.0
    first: int = 0
    sigma: Any = 0.0
    delta: Any = 0.0


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


def plan_open(reach: Reach, rtol: float, tighten: float = 1.0) -> OpenPlan:
    """Choose sigma, delta, W and the band from the error terms above; `tighten` > 1 asks for more of everything."""
    decades = math.log(20 / rtol) * tighten
    rounding = max(2.0, math.log(rtol / (100 * EPS))) / tighten
    k, Z = reach.k0, np.maximum(reach.path, 1e-3 / reach.k0)
    X = np.maximum(reach.extent, reach.source)
    delta = reach.branch / math.sqrt(decades)
    sigma, window = rounding / (X + 30 / k), X
    for _ in range(30):
        spread = np.sqrt(4 / delta**2 + (Z * delta / k) ** 2)
        guard = spread * np.sqrt(sigma * window + decades)
        window = np.maximum(X + reach.source + guard, decades / sigma)
        sigma = np.minimum(np.minimum(decades / window, rounding / X), 3.0 * k / (Z * delta))
        steep = reach.branch / np.sqrt(decades + Z * np.sqrt(reach.branch * sigma))
        delta = np.minimum(steep, np.sqrt(2 * k / Z))
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
    chi = erfc(-k / np.asarray(plan.delta)[..., None]) / 2
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


def plan_bent(reach: Reach, rtol: float, noise: float = EPS) -> BentPlan:
    """A first plan from the error terms; what they do not know (the field's own width) shows in the difference to `other`.

    `noise` is the relative rounding of S h from one k to the next, which exp(depth X) magnifies.
    """
    X = max(reach.extent, reach.source)
    depth = min(max(1.5, math.log(rtol / (30 * max(noise, 2 * EPS)))) / X, 0.35 * reach.branch)
    return BentPlan(depth, 1.2 * X + 0.8 * math.log(10 / rtol) / depth, reach.band, reach.branch)


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
    intervals meet. alpha goes as u^2 at both ends of every interval, which takes out a root there too; u is divided into
    panels of 24 nodes.
    """
    edges = np.arcsin(np.unique(np.clip([0.0, *(b / k0 for b in breaks if 0 < b < k0), 1.0], 0, 1)))
    g, v = np.polynomial.legendre.leggauss(24)
    panels = max(2, math.ceil(count / 24))
    u = ((np.arange(panels)[:, None] + (g + 1) / 2) / panels).ravel()
    w = np.tile(v / 2 / panels, panels)
    smooth, slope = u * u * (3 - 2 * u), 6 * u * (1 - u)
    nodes, weights = [], []
    for lo, hi in itertools.pairwise(edges):
        alpha = lo + (hi - lo) * smooth
        nodes.append(k0 * np.sin(alpha))
        weights.append(k0 * np.cos(alpha) * (hi - lo) * slope * w / (2 * np.pi))
    return Line(np.concatenate(nodes).astype(complex), np.concatenate(weights))


# --- sums over a line -------------------------------------------------------------------------------------


def amplitudes(line: Line, spectrum: Any, centre: float) -> tuple[np.ndarray, np.ndarray]:
    """w S(k) and w S(-k) about x = centre; `spectrum` is a function of kx about x = 0."""
    right = line.weight * spectrum(line.k) * np.exp(1j * line.k * centre)
    left = line.weight * spectrum(-line.k) * np.exp(-1j * line.k * centre)
    return right, left


def direct_sum(line: Line, h: np.ndarray, right: np.ndarray, left: np.ndarray, x: np.ndarray) -> np.ndarray:
    """p at any x (relative to the centre): one matrix product, (Z, n) by (n, X)."""
    phase = np.exp(1j * np.multiply.outer(line.k, x))
    both = right[:, None] * phase
    if np.any(left):
        # e^{-ikx}: 1/phase, which neither overflows nor loses digits, for |Im k| |x| was chosen small
        both += left[:, None] / phase
    return h @ both


@functools.lru_cache(maxsize=16)
def _inverse_plan(rows: int, n: int) -> tuple[np.ndarray, Any]:
    """A buffer (rows, n) and a function that transforms it in place: sum_m c_m e^{2 pi i m j/n}, unscaled."""
    try:
        import pyfftw
    except ImportError:  # no wheel for this platform
        import scipy.fft

        buffer = np.empty((rows, n), complex)

        def transform() -> None:
            buffer[...] = scipy.fft.ifft(buffer, axis=1, norm="forward", overwrite_x=True)

        return buffer, transform
    buffer = pyfftw.empty_aligned((rows, n), dtype="complex128")
    fftw = pyfftw.FFTW(buffer, buffer, axes=(1,), direction="FFTW_BACKWARD", flags=("FFTW_ESTIMATE",))
    return buffer, fftw.execute


def transform(coefficients: np.ndarray) -> np.ndarray:
    """sum_m c_m e^{2 pi i m j/n} along the last axis, unscaled."""
    flat = coefficients.reshape(-1, coefficients.shape[-1])
    buffer, execute = _inverse_plan(*flat.shape)
    buffer[...] = flat
    execute()
    return buffer.reshape(coefficients.shape).copy()


def fast_length(n: int) -> int:
    """The next length that an FFT likes: 2^a 3^b 5^c."""
    best = 1 << max(0, (n - 1).bit_length())
    five = 1
    while five < best:
        three = five
        while three < best:
            two = three
            while two < n:
                two *= 2
            best = min(best, two)
            three *= 3
        five *= 5
    return best


def _fold(values: np.ndarray, bins: np.ndarray, n: int, out: np.ndarray) -> None:
    """Add the columns of values into bins modulo n: exact aliasing, for the output has n points a window."""
    out[...] = 0
    for start in range(0, bins.size, n):
        part = slice(start, start + n)
        out[:, bins[part] % n] += values[:, part]


def fft_sum(line: Line, h: np.ndarray, right: np.ndarray, left: np.ndarray, x: np.ndarray, n: int) -> np.ndarray:
    """p at even x = x_0 + j dx (relative to the centre), where line.step = 2 pi/(n dx): two FFTs a plane."""
    out = np.empty((h.shape[0], x.size), complex)
    rows = max(1, min(h.shape[0], 2**16 // n))
    buffer, transform = _inverse_plan(rows, n)
    m = line.first + np.arange(line.k.size)
    turn = np.exp(1j * m * line.step * x[0])
    grow = np.exp(line.sigma * x)
    parts = [(right * turn, m, grow)]
    if np.any(left):
        parts.append((left / turn, -m, 1 / grow))
    for start in range(0, h.shape[0], rows):
        block = slice(start, min(start + rows, h.shape[0]))
        size = block.stop - block.start
        for number, (amplitude, bins, envelope) in enumerate(parts):
            _fold(h[block] * amplitude, bins, n, buffer[:size])
            buffer[size:] = 0
            transform()
            part = buffer[:size, : x.size] * envelope
            if number:
                out[block] += part
            else:
                out[block] = part
    return out
