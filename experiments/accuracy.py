"""Does rtol keep its promise? Random beams x slabs x grids x rtol against an independent quadrature; limiting absorption.

The truth is computed here, from nothing of the package but the definitions of the slab and the source. Its response is a
cascade of scattering matrices in a reference medium (periods by doubling), its path of integration has a straight bend and
its rule is Gauss-Legendre on panels; the package carries states backward in closed form, on smooth paths, by the trapezoid
rule or FFTs. A case counts only where two such quadratures of different depth, bend and panels agree to a tenth of rtol.
Modes on the wrong side of the path are counted by the argument principle on this file's own function.
"""

from __future__ import annotations

import itertools
import math
import multiprocessing
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from common import LOSSLESS, Statement, run, slab
from tqdm import tqdm

import beamprop as bp

SEED = 20240607
CASES = 2200
WATER, HELIUM = bp.Fluid.from_speed(1000.0, 1480.0), bp.Fluid.from_speed(0.167, 1000.0)
C_AIR, RHO_AIR = 343.0, 1.25


# --- the slabs --------------------------------------------------------------------------------------------


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _lmmd(rng: np.random.Generator, lossy: bool) -> bp.Cell:
    mean = rng.uniform(-0.3, 1.0)
    loss = 1j * _log(rng, 1e-4, 0.5) if lossy else 0
    layers = int(rng.choice([3, 4, 5, 6, 7, 8, 10, 10, 12, 14]))
    return bp.lmmd_cell(mean + loss, abs(loss) / 2, layers, 1 / rng.uniform(10, 100))


def _fluid(rng: np.random.Generator, rho: float, K: float, loss: float = 0.0, **more: Any) -> bp.Fluid:
    air = bp.AIR.bulk_modulus
    return bp.Fluid(RHO_AIR * (rho + 1j * loss * abs(rho)), air * (K - 1j * loss * abs(K)), **more)


def _some_loss(rng: np.random.Generator) -> float:
    return _log(rng, 1e-4, 0.3) if rng.random() < 0.5 else 0.0


def _lmmd_lossless(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(_lmmd(rng, False), int(_log(rng, 1, 600)))


def _lmmd_lossy(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(_lmmd(rng, True), int(_log(rng, 1, 2000)))


def _positive(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = _fluid(rng, _log(rng, 0.05, 20), _log(rng, 0.2, 20), _some_loss(rng))
    return bp.Slab.uniform(fluid, lam * _log(rng, 0.01, 10))


def _negative(rng: np.random.Generator, lam: float) -> bp.Slab:
    rho, K = (-_log(rng, 0.1, 5), _log(rng, 0.2, 5)) if rng.random() < 0.6 else (_log(rng, 0.1, 5), -_log(rng, 0.2, 5))
    return bp.Slab.uniform(_fluid(rng, rho, K, _some_loss(rng)), lam * _log(rng, 0.02, 2))


def _double_negative(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = _fluid(rng, -_log(rng, 0.2, 5), -_log(rng, 0.2, 5), _log(rng, 1e-3, 0.3) if rng.random() < 0.7 else 0.0)
    return bp.Slab.uniform(fluid, lam * _log(rng, 0.05, 2))


def _rigid_x(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab.uniform(
        _fluid(rng, _log(rng, 0.1, 3), 1.0, _some_loss(rng), density_x=np.inf), lam * _log(rng, 0.1, 10)
    )


def _other_behind(rng: np.random.Generator, lam: float) -> bp.Slab:
    after = WATER if rng.random() < 0.5 else HELIUM
    if rng.random() < 0.5:
        return bp.Slab(_lmmd(rng, rng.random() < 0.5), int(_log(rng, 1, 300)), after=after)
    return bp.Slab.uniform(_fluid(rng, _log(rng, 0.1, 5), _log(rng, 0.2, 5)), lam * _log(rng, 0.05, 3), after=after)


def _water_in_front(rng: np.random.Generator, lam: float) -> bp.Slab:
    fluid = bp.Fluid.from_speed(1000.0 * _log(rng, 0.2, 8), 1480.0 * _log(rng, 0.3, 4))
    return bp.Slab.uniform(
        fluid, 4.3 * lam * _log(rng, 0.05, 3), before=WATER, after=WATER if rng.random() < 0.5 else bp.AIR
    )


def _lossy_behind(rng: np.random.Generator, lam: float) -> bp.Slab:
    after = _fluid(rng, _log(rng, 0.5, 5), _log(rng, 0.5, 5), _log(rng, 1e-3, 0.3))
    return bp.Slab(_lmmd(rng, rng.random() < 0.5), int(_log(rng, 1, 300)), after=after)


def _opaque(rng: np.random.Generator, lam: float) -> bp.Slab:
    if rng.random() < 0.5:
        return bp.Slab(bp.lmmd_cell(0.05 + 0.5j, 0.25), int(_log(rng, 500, 20_000)))
    return bp.Slab.uniform(_fluid(rng, -_log(rng, 1, 20), 1.0, _some_loss(rng)), lam * rng.uniform(1, 30))


def _stack(rng: np.random.Generator, lam: float) -> bp.Slab:
    parts = [
        rng.choice(np.array([_lmmd_lossy, _positive, _rigid_x, _negative, _lmmd_lossless]))(rng, lam)
        for _ in range(rng.integers(2, 5))
    ]
    whole = parts[0]
    for part in parts[1:]:
        whole = whole + part
    return whole


class Resonant:
    """Density of a membrane-like medium: crosses zero at f0 [Hz]; picklable."""

    def __init__(self, f0: float, loss: float) -> None:
        self.f0, self.loss = f0, loss

    def __call__(self, f: np.ndarray) -> np.ndarray:
        return RHO_AIR * (1 - (self.f0 / f) ** 2 + 1j * self.loss)


def _dispersive(rng: np.random.Generator, lam: float) -> bp.Slab:
    f = C_AIR / lam
    density = Resonant(f * rng.uniform(0.7, 1.3), _log(rng, 1e-4, 0.1))
    return bp.Slab(
        [bp.Layer(bp.Fluid(density, bp.AIR.bulk_modulus), lam / 40), bp.Layer(bp.AIR, lam / 25)], int(_log(rng, 1, 40))
    )


def _backward(rng: np.random.Generator, lam: float) -> bp.Slab:
    loss = _log(rng, 1e-5, 1e-2) if rng.random() < 0.5 else 0.0
    return bp.Slab.uniform(
        bp.Fluid(RHO_AIR * (-rng.uniform(0.3, 0.9) + 1j * loss), bp.AIR.bulk_modulus), lam * _log(rng, 0.02, 0.1)
    )


def _one_or_many(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab(_lmmd(rng, rng.random() < 0.7), int(rng.choice([1, 100_000])))


def _nothing(rng: np.random.Generator, lam: float) -> bp.Slab:
    return bp.Slab.uniform(bp.AIR, lam * _log(rng, 0.01, 20))


SLABS: dict[str, Callable[[np.random.Generator, float], bp.Slab]] = {
    "air alone": _nothing,
    "LMMD, lossless": _lmmd_lossless,
    "LMMD, lossy": _lmmd_lossy,
    "LMMD, 1 or 100 000 periods": _one_or_many,
    "uniform fluid": _positive,
    "negative density or modulus": _negative,
    "double negative": _double_negative,
    "density_x infinite": _rigid_x,
    "water or helium behind": _other_behind,
    "water in front": _water_in_front,
    "lossy half-space behind": _lossy_behind,
    "opaque": _opaque,
    "stack": _stack,
    "dispersive": _dispersive,
    "backward modes": _backward,
}
SOURCES = ("Gaussian, launch", "Gaussian, rotated", "Profile", "Slits")


# --- beams and grids --------------------------------------------------------------------------------------


class Case(NamedTuple):
    """One question, and what it belongs to."""

    kind: str
    source: str
    slab: bp.Slab
    beam: Any
    frequency: float
    x: np.ndarray
    z: np.ndarray
    rtol: float


def _angle(rng: np.random.Generator) -> float:
    return float(
        rng.choice([0.0, rng.uniform(-89.9, 89.9), rng.uniform(80, 89.9), 30.0, -89.9], p=[0.25, 0.5, 0.1, 0.1, 0.05])
    )


def _beam(rng: np.random.Generator, source: str, lam: float) -> Any:
    z0 = -lam * float(rng.choice([0.0, _log(rng, 0.01, 50)], p=[0.4, 0.6]))
    fwhm = lam * _log(rng, 0.2, 200)
    x0 = float(rng.choice([0.0, rng.normal() * fwhm]))
    if source == "Gaussian, launch":
        return bp.GaussianBeam(fwhm, _angle(rng), x0, z0)
    if source == "Gaussian, rotated":
        return bp.GaussianBeam(fwhm, _angle(rng), x0, z0, form="rotated")
    if source == "Slits":
        width = lam * _log(rng, 0.05, 5)
        return bp.Slits(
            width,
            width * rng.uniform(1.1, 5),
            int(rng.integers(1, 4)),
            -lam * _log(rng, 0.05, 20),
            float(rng.uniform(-60, 60)),
        )
    radius = lam * _log(rng, 0.3, 20)
    x = x0 + np.linspace(-6.5, 6.5, int(rng.integers(90, 300))) * radius
    p = np.exp(-(((x - x0) / radius) ** 2)).astype(complex)
    if rng.random() < 0.6:
        u = (x - x0) / radius
        p *= sum((rng.normal() + 1j * rng.normal()) * np.exp(1j * rng.uniform(-3, 3) * u) for _ in range(4))
    return bp.Profile(x, p, z0, float(rng.choice([0.0, rng.uniform(-60, 60)])))


def _grid(rng: np.random.Generator, beam: Any, lam: float) -> np.ndarray:
    size = 2 * beam.reach(0.5)
    span = float(np.clip(size * _log(rng, 0.1, 20), 0.1 * lam, 400 * lam))
    count = int(rng.integers(5, 41))
    middle = beam.centre + float(rng.choice([0.0, rng.uniform(-1, 1) * span]))
    kind = rng.choice(["even", "fine", "uneven", "one"], p=[0.5, 0.15, 0.3, 0.05])
    if kind == "one":
        return np.array([middle])
    if kind == "fine":  # many points: FFTs become the cheaper way
        return middle + span * np.linspace(-0.5, 0.5, int(rng.choice([401, 1000, 2048])))
    return middle + span * (np.linspace(-0.5, 0.5, count) if kind == "even" else np.sort(rng.uniform(-0.5, 0.5, count)))


def _planes(rng: np.random.Generator, beam: Any, thickness: float, lam: float, source: str) -> np.ndarray:
    front = beam.z0 * rng.uniform(0, 0.9 if source == "Slits" else 1, 2)
    inside = thickness * rng.uniform(0, 1, 2)
    behind = thickness + lam * np.array([0.0, _log(rng, 0.01, 50)])
    every = np.concatenate([front, inside, behind])
    return np.sort(rng.choice(every, int(rng.integers(3, 7)), replace=False))


def make_case(number: int) -> Case:
    """Case `number` of the study; the same on every machine."""
    rng = np.random.default_rng([SEED, number])
    kind = list(SLABS)[number % len(SLABS)]
    source = str(rng.choice(SOURCES, p=[0.7, 0.1, 0.12, 0.08]))
    frequency = rng.uniform(500, 5000)
    lam = C_AIR / frequency
    medium = SLABS[kind](rng, lam)
    if medium.before is WATER:
        lam = 1480.0 / frequency
    while True:  # the truth must stay cheap: modes go as band times extent
        beam = _beam(rng, source, lam)
        x = _grid(rng, beam, lam)
        extent = max(np.abs(x - beam.centre).max(), beam.reach(1e-12))
        if Source(beam, 2 * np.pi / lam).band(1e-12) * extent < 3e4 or source == "Slits":
            break
    z = _planes(rng, beam, medium.thickness, lam, source)
    return Case(kind, source, medium, beam, float(frequency), x, z, float(10 ** rng.uniform(-11, -3)))


# --- the truth: the source --------------------------------------------------------------------------------


class Source:
    """S(kx) of a beam from its definition, relative to its middle."""

    def __init__(self, beam: Any, k0: float) -> None:
        self.beam, self.k0 = beam, k0
        self.sine = math.sin(math.radians(beam.angle))
        self.cosine = math.cos(math.radians(beam.angle))

    def __call__(self, k: np.ndarray, kz: Any = None) -> np.ndarray:
        """S(k) exp(i k centre); the rotated form takes kz too, which k gives badly near grazing."""
        b = self.beam
        q = k - self.k0 * self.sine
        if isinstance(b, bp.GaussianBeam):
            a = b.fwhm / (2 * math.sqrt(math.log(2)))
            jacobian: Any = 1.0
            if b.form == "rotated":
                q, jacobian = k * self.cosine - kz * self.sine, self.cosine + self.sine * k / kz
            return a * math.sqrt(math.pi) * np.exp(-((a * q / 2) ** 2)) * jacobian
        if isinstance(b, bp.Slits):
            edges = [(m - b.width / 2, m + b.width / 2) for m in b.positions]
            return sum((np.exp(-1j * q * lo) - np.exp(-1j * q * hi)) / (1j * q) for lo, hi in edges)
        out = np.zeros(k.shape, complex)
        for x, p in zip(b.x - b.centre, b.p, strict=True):
            out += p * np.exp(-1j * q * x)
        return np.where(np.abs(q.real) <= np.pi / b.spacing, out * b.spacing, 0)

    def band(self, tolerance: float) -> float:
        """|k| beyond which S is negligible."""
        b, tilt = self.beam, self.k0 * abs(self.sine)
        if isinstance(b, bp.GaussianBeam):
            a = b.fwhm / (2 * math.sqrt(math.log(2)))
            return tilt + 2 / a * math.sqrt(math.log(1 / tolerance))
        return tilt + (np.pi / b.spacing if isinstance(b, bp.Profile) else 2 / (b.width * tolerance))


# --- the truth: the response ------------------------------------------------------------------------------


class Scatter(NamedTuple):
    """Reflection from the left and the right, and log t, in a reference medium of admittance y."""

    left: np.ndarray
    right: np.ndarray
    log_t: np.ndarray


def _cascade(a: Scatter | None, b: Scatter) -> Scatter:
    if a is None:
        return b
    loop = 1 - a.right * b.left
    left = a.left + np.exp(2 * a.log_t) * b.left / loop
    right = b.right + np.exp(2 * b.log_t) * a.right / loop
    return Scatter(left, right, a.log_t + b.log_t - np.log(loop))


def _power(cell: Scatter, periods: int) -> Scatter | None:
    out, square = None, cell
    while periods:
        if periods & 1:
            out = _cascade(out, square)
        periods >>= 1
        if periods:
            square = _cascade(square, square)
    return out


class Medium:
    """A slab at one frequency, with `loss` added to everything."""

    def __init__(self, slab: bp.Slab, frequency: float, loss: float = 0.0) -> None:
        f = np.array([frequency])
        self.omega = 2 * np.pi * frequency

        def values(fluid: bp.Fluid) -> tuple[complex, complex, complex]:
            rho_z, rho_x, K = (complex(v[0]) for v in fluid.at(f))
            more = 1j * loss
            rho_x = rho_x + more * abs(rho_x) if np.isfinite(rho_x) else rho_x
            return rho_z + more * abs(rho_z), rho_x, 1 / (1 / K + more * abs(1 / K))

        self.before, self.after = values(slab.before), values(slab.after)
        self.segments = [([(*values(y.fluid), y.thickness) for y in cell.layers], n) for cell, n in slab.segments]
        self.thickness = slab.thickness
        self.k0 = self.omega * np.sqrt(self.before[1] / self.before[2]).real

    def branches(self) -> list[float]:
        """|kx| of the branch points."""
        found = [self.omega * np.sqrt(f[1] / f[2]).real for f in (self.before, self.after) if np.isfinite(f[1])]
        return [b for b in found if b > 0]

    def kz(self, fluid: tuple, k: np.ndarray) -> np.ndarray:
        """The outgoing root below the right half of the axis, and a little above it beyond the branch point."""
        rho_z, rho_x, K = fluid[:3]
        square = rho_z * (self.omega**2 / K - (k**2 / rho_x if np.isfinite(rho_x) else 0)) + 0j
        return np.exp(0.25j * np.pi) * np.sqrt(-1j * square)

    def layer(self, fluid: tuple, d: float, k: np.ndarray, y: np.ndarray) -> Scatter:
        """One layer between two reference media: 1/t = cos - (i/2) (y A + B/y) s, r/t = (i/2) (B/y - y A) s."""
        rho, kz = fluid[0], self.kz(fluid, k)
        kz = np.where(kz.imag < 0, -kz, kz)
        phase = kz * d
        thick = phase.imag > 15
        calm = np.where(thick, 1.0, phase)
        s = np.sinc(calm / np.pi) * d
        forward, back = y * rho * s, kz**2 / rho * s / y
        log_t = -np.log1p(-2 * np.sin(calm / 2) ** 2 - 0.5j * (forward + back))
        r = 0.5j * (back - forward) * np.exp(log_t)
        if np.any(thick):
            face = (y - kz / rho) / (y + kz / rho)
            loop = 1 - (face * np.exp(1j * phase)) ** 2
            log_t = np.where(thick, np.log((1 - face**2) / loop) + 1j * phase, log_t)
            r = np.where(thick, face * (1 - np.exp(2j * phase)) / loop, r)
        return Scatter(r, r, log_t)

    def part(self, k: np.ndarray, y: np.ndarray, start: float, stop: float) -> Scatter | None:
        """What lies between two depths."""
        out, at = None, 0.0
        for layers, periods in self.segments:
            period = sum(v[3] for v in layers)
            end = at + period * periods
            lo, hi = max(start, at), min(stop, end)
            if hi > lo:
                first, last = math.ceil((lo - at) / period - 1e-12), math.floor((hi - at) / period + 1e-12)
                if last < first:  # within one period
                    out = self._pieces(out, layers, at + last * period, lo, hi, k, y)
                else:
                    out = self._pieces(out, layers, at + (first - 1) * period, lo, at + first * period, k, y)
                    if last > first:
                        cell = None
                        for v in layers:
                            cell = _cascade(cell, self.layer(v, v[3], k, y))
                        whole = _power(cell, last - first)
                        out = _cascade(out, whole)
                    out = self._pieces(out, layers, at + last * period, at + last * period, hi, k, y)
            at = end
        return out

    def _pieces(self, out: Any, layers: list, at: float, lo: float, hi: float, k: np.ndarray, y: np.ndarray) -> Any:
        """Parts of the layers of one period that begins at `at`."""
        for v in layers:
            d = min(at + v[3], hi) - max(at, lo)
            if d > 1e-13 * self.thickness:
                out = _cascade(out, self.layer(v, d, k, y))
            at += v[3]
        return out

    def response(self, k: np.ndarray, z: np.ndarray, z0: float) -> np.ndarray:
        """What a unit plane wave on z = z0 has become at z: (Z, n)."""
        y = np.sqrt(self.k0**2 + np.abs(k) ** 2) / abs(self.before[0])
        kz1, kz2 = self.kz(self.before, k), self.kz(self.after, k)
        y1, y2 = kz1 / self.before[0], kz2 / self.after[0]
        end = (y - y2) / (y + y2)

        def load(s: Scatter | None) -> np.ndarray:
            return end if s is None else s.left + np.exp(2 * s.log_t) * end / (1 - s.right * end)

        whole = self.part(k, y, 0, self.thickness)
        gamma = load(whole)
        inward = 2 * y1 / (y1 * (1 + gamma) + y * (1 - gamma))
        r = inward * (1 + gamma) - 1
        launch = np.exp(-1j * kz1 * z0)
        out = np.empty((z.size, k.size), complex)
        for row, depth in zip(out, z, strict=True):
            if depth <= 0:
                row[:] = np.exp(1j * kz1 * (depth - z0)) + r * np.exp(-1j * kz1 * (depth + z0))
                continue
            inside = min(depth, self.thickness)
            front = self.part(k, y, 0, inside)
            rest = load(self.part(k, y, inside, self.thickness) if inside < self.thickness else None)
            row[:] = inward * np.exp(front.log_t) / (1 - front.right * rest) * (1 + rest) * launch
            row *= np.exp(1j * kz2 * (depth - inside))
        return out

    def log_t(self, k: np.ndarray) -> np.ndarray:
        """log t of the slab up to turns, whose poles are the modes."""
        y = np.sqrt(self.k0**2 + np.abs(k) ** 2) / abs(self.before[0])
        y1, y2 = self.kz(self.before, k) / self.before[0], self.kz(self.after, k) / self.after[0]
        s = self.part(k, y, 0, self.thickness)
        end = (y - y2) / (y + y2)
        gamma = s.left + np.exp(2 * s.log_t) * end / (1 - s.right * end)
        return s.log_t + np.log(2 * y1 * (1 + end) / (y1 * (1 + gamma) + y * (1 - gamma)) / (1 - s.right * end))


# --- the truth: modes on the wrong side -------------------------------------------------------------------


def turns(f: Callable[[np.ndarray], np.ndarray], corners: list[complex], finest: float) -> int:
    """Turns of exp(f) along a closed polygon, bisected until every step is small."""
    a = np.concatenate([p + (q - p) * np.arange(150) / 150 for p, q in itertools.pairwise([*corners, corners[0]])])
    b = np.roll(a, -1)
    fa, fb = f(a), f(b)
    total = 0.0
    for _ in range(40):
        if a.size > 2500:
            return sys.maxsize
        m = (a + b) / 2
        fm = f(m)
        first, second = ((v + np.pi) % (2 * np.pi) - np.pi for v in ((fm - fa).imag, (fb - fm).imag))
        calm = ((np.abs(first) < 0.6) & (np.abs(second) < 0.6) & (np.abs(first - second) < 0.3)) | (
            np.abs(b - a) < finest
        )
        total += float((first + second)[calm].sum())
        a, b, fa, fb = (
            np.concatenate(v)
            for v in ((a[~calm], m[~calm]), (m[~calm], b[~calm]), (fa[~calm], fm[~calm]), (fm[~calm], fb[~calm]))
        )
        if not a.size:
            break
    return round(total / (2 * np.pi))


def is_lossless(m: Medium) -> bool:
    """Nothing has loss."""
    return all(np.imag(v) == 0 for layers, _ in m.segments for layer in layers for v in layer[:3] if np.isfinite(v))


def is_lossy(m: Medium) -> bool:
    """Every layer has loss: no mode lies on the axis, where rounding would choose its side."""
    return all(any(np.imag(v) != 0 for v in layer[:3]) for layers, _ in m.segments for layer in layers)


def has_negative(m: Medium) -> bool:
    """Some layer has a negative density or modulus."""
    return any(np.real(v) < 0 for layers, _ in m.segments for layer in layers for v in layer[:3])


def wrong_side(
    slab: bp.Slab, frequency: float, m: Medium, depth: float, corner: float, band: float
) -> list[complex] | None:
    """Backward modes above the path: their kx; None where they cannot be told.

    Counted with a trace of loss where some layer has none, the less the thicker the slab. Where there are any, they are followed
    from a scan.
    """
    if not has_negative(m):
        return []
    test = m if is_lossy(m) else Medium(slab, frequency, 1e-5 / max(1.0, 0.1 * m.k0 * m.thickness))
    path = [
        0.001 * corner * (1 + 0j),
        band + 0j,
        band - 1j * depth,
        corner - 1j * depth,
        0.001 * corner * (1 - 1j * depth / corner),
    ]
    count = -turns(test.log_t, path[::-1], 1e-10 * m.k0)  # clockwise outline; t has poles
    if count == 0:
        return []
    if abs(count) > 60:
        return None
    return _find_wrong(m, test, depth, corner, band, abs(count))


def _find_wrong(m: Medium, test: Medium, depth: float, corner: float, band: float, count: int) -> list[complex] | None:
    """Newton's method on 1/t from the peaks of |t| along the axis, and from a grid below it."""
    s = np.linspace(0.002 * m.k0, band, 6000)
    seeds = [
        s.astype(complex)[1:-1][(v[1:-1] > v[:-2]) & (v[1:-1] > v[2:])]
        for v in (test.log_t(s + 0j).real, test.log_t(s - 0.5j * depth).real)
    ]
    found: list[tuple[complex, complex]] = []
    for seed in np.concatenate([seeds[0], seeds[1] - 0.5j * depth]):
        k = _newton(test, seed)
        if k is None or not 0 < -k.imag < depth * min(1.0, k.real / corner) or not 0 < k.real < band:
            continue
        if all(abs(k - other) > 1e-7 * abs(k) for other, _ in found):
            exact = _newton(m, k)
            if exact is not None:
                found.append((k, exact))
    return [exact for _, exact in found] if len(found) == count else None


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


# --- the truth: quadrature --------------------------------------------------------------------------------

GAUSS = np.polynomial.legendre.leggauss(20)


def _panels(edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    half = np.diff(edges) / 2
    return (edges[:-1, None] + half[:, None] * (GAUSS[0] + 1)).ravel(), (half[:, None] * GAUSS[1]).ravel()


def _bent_nodes(
    m: Medium, depth: float, corner: float, band: float, length: float, Z: float
) -> tuple[np.ndarray, np.ndarray]:
    """Panels along 0 -> corner - i depth -> band - i depth, short where the integrand turns fast."""
    nodes, weights = [], []
    for lo, hi, slope in ((0.0, corner, depth / corner), (corner, band, 0.0)):
        s = np.linspace(lo, hi, 4001)
        k = s - 1j * (slope * s if slope else depth)
        reach = np.maximum(-k.imag, 0.05 * depth) if slope else depth
        fast = length + Z * np.max([np.abs(k / np.sqrt(b**2 - k**2)) for b in m.branches()], axis=0)
        density = fast / 7 + 0.7 / np.broadcast_to(reach, s.shape)
        total = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(s))])
        u, w = _panels(np.interp(np.linspace(0, 1, math.ceil(total[-1]) + 2) * total[-1], total, s))
        nodes.append(u - 1j * (slope * u if slope else depth))
        weights.append(w * (1 - 1j * slope))
    return np.concatenate(nodes), np.concatenate(weights)


def _real_nodes(m: Medium, length: float, finer: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Panels over 0 < kx < k0 in alpha, kx = k0 sin(alpha), graded towards the branch points inside; and kz.

    Not towards k0, where alpha itself takes the root out: a kx that rounds to k0 has no response.
    """
    stops = np.arcsin(np.unique(np.clip([0, *(b / m.k0 for b in m.branches() if b < m.k0 * (1 - 1e-12)), 1], 0, 1)))
    nodes, weights, across = [], [], []
    for lo, hi in itertools.pairwise(stops):
        fine = np.linspace(lo, hi, math.ceil(finer * (4 + m.k0 * length / 6)))
        steep = (hi - lo) / 2 * 2.0 ** -np.arange(1, 26)
        graded = [lo + steep] * int(lo > 0) + [hi - steep] * int(hi < stops[-1])
        a, w = _panels(np.unique(np.concatenate([fine, *graded])))
        nodes.append(m.k0 * np.sin(a))
        weights.append(m.k0 * np.cos(a) * w)
        across.append(m.k0 * np.cos(a))
    return np.concatenate(nodes).astype(complex), np.concatenate(weights).astype(complex), np.concatenate(across)


def _sum(
    m: Medium, source: Source, k: np.ndarray, w: np.ndarray, kz: np.ndarray | None, x: np.ndarray, z: np.ndarray
) -> np.ndarray:
    """(1/2 pi) sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}], in blocks."""
    out = np.zeros((z.size, x.size), complex)
    block = max(500, 4_000_000 // max(x.size, 1))
    for i in range(0, k.size, block):
        kk, ww = k[i : i + block], w[i : i + block] / (2 * np.pi)
        h = m.response(kk, z, source.beam.z0) * ww
        wave = np.exp(1j * np.outer(kk, x))
        across = None if kz is None else kz[i : i + block]
        out += (h * source(kk, across)) @ wave + (h * source(-kk, across)) @ (1 / wave)
    return out


def brightness(m: Medium, source: Source, z: np.ndarray) -> np.ndarray:
    """|p| of the propagating waves where the beam lands on each plane: errors are over the largest |p| of a plane, (Z,).

    Rays of nine strong plane waves, and panels over the strong part of the spectrum; rays that go too far are left out.
    """
    wide, tilt = source.band(1e-3) - m.k0 * abs(source.sine), m.k0 * source.sine
    lo, hi = max(tilt - wide, -0.995 * m.k0), min(tilt + wide, 0.995 * m.k0)
    if hi <= lo:
        return np.zeros(z.size)

    def h(k: np.ndarray) -> np.ndarray:
        return m.response(np.abs(k) + 0j, z, source.beam.z0)  # even in k

    rays, step = np.linspace(0.95 * lo + 0.05 * hi, 0.05 * lo + 0.95 * hi, 9), 1e-5 * m.k0
    x = np.nan_to_num(-np.angle(h(rays + step) / h(rays - step)) / (2 * step))  # (Z, 9)
    most = 4 * 800 / (hi - lo) - source.beam.reach(1e-3) - m.thickness
    x = np.where(np.abs(x) < most, x, 0.0)
    count = math.ceil(3 + (hi - lo) * (np.abs(x).max() + source.beam.reach(1e-3) + m.thickness) / 4)
    if count > 1500:
        return np.zeros(z.size)
    k, w = _panels(np.linspace(lo, hi, count))
    sent = h(k) * source(k, np.sqrt((m.k0 - k) * (m.k0 + k))) * w / (2 * np.pi)
    p = [np.exp(1j * np.outer(there, k)) @ row for there, row in zip(x, sent, strict=True)]
    return np.nan_to_num(np.abs(p).max(axis=1))


class Truth(NamedTuple):
    """p(z, x), its own relative error by plane's scale, and how many backward modes lay on the wrong side."""

    p: np.ndarray
    scale: np.ndarray
    error: float
    wrong: int


def truth(case: Case, own: np.ndarray, goal: float = 0.0) -> Truth | str:
    """The field by two quadratures that agree to a tenth of rtol, if they can to `goal`; or why there is none."""
    m = Medium(case.slab, case.frequency)
    source = Source(case.beam, m.k0)
    x = np.concatenate([case.x, own]) - case.beam.centre
    X = float(np.abs(x).max())
    source_reach = case.beam.reach(1e-16)
    z_far = max(case.z.max() - m.thickness, 0.0) - case.beam.z0 + max(0.0, -case.z.min())
    rotated = getattr(case.beam, "form", "launch") == "rotated"
    gap = max(case.z.min() - case.beam.z0, 0.0)
    band = source.band(1e-17)
    if gap > 0:
        band = min(band, math.hypot(m.k0, 42 / gap) + m.k0)
    kb = min(m.branches())
    fields: list[np.ndarray] = []
    wrong: list[complex] | None = []
    shallow = 1.0
    rounding = np.finfo(float).eps * sum(len(layers) * periods for layers, periods in m.segments)
    elsewhere = brightness(m, source, case.z)
    found: Truth | None = None
    for step in range(5):
        finer = 1.5**step
        if rotated:
            k, w, kz = _real_nodes(m, X + source_reach + 2 * z_far + m.thickness, finer**2)
        else:
            depth = shallow * min((0.3 - 0.07 * (step % 2)) * kb, (6 - 1.5 * (step % 2)) / max(X, source_reach, 1e-9))
            corner = min((0.45 + 0.2 * (step % 2)) * kb, (0.4 + 0.2 * (step % 2)) * band)
            if step == 0:
                wrong = wrong_side(case.slab, case.frequency, m, 1.01 * depth, 0.9 * corner, band)
                while wrong is None and shallow > 0.01 and not is_lossless(m):  # nearer to the axis there are fewer
                    shallow, depth = shallow / 4, depth / 4
                    wrong = wrong_side(case.slab, case.frequency, m, 1.01 * depth, 0.9 * corner, band)
                if wrong is None:
                    return "backward modes not located"
            k, w = _bent_nodes(m, depth, corner, band, finer * (X + source_reach), finer * z_far)
            circle = np.exp(-2j * np.pi * (np.arange(40) + 0.5) / 40)
            for k1 in wrong:
                if k1.imag < -depth * min(1.0, k1.real / corner):
                    continue
                radius = (0.3 + 0.1 * (step % 2)) * min(
                    [depth, *(abs(k1 - b) for b in m.branches()), *(abs(k1 - o) for o in wrong if o != k1)]
                )
                k, w = np.append(k, k1 + radius * circle), np.append(w, radius * circle * (-2j * np.pi / 40))
        if k.size > 120_000:
            return found or "too many nodes"
        fields.append(_sum(m, source, k, w, kz if rotated else None, x, case.z))
        scale = np.maximum(np.abs(fields[-1]).max(axis=1), elsewhere)
        if not np.all(np.isfinite(fields[-1])):
            return found or "not finite"
        if step:
            seen = np.where(scale > 1e-280, scale, np.inf)
            own_error = float(np.max(np.abs(fields[-1] - fields[-2]).max(axis=1) / seen))
            if own_error < max(0.1 * case.rtol, 1e-13) and (found is None or own_error < found.error):
                found = Truth(fields[-1][:, : case.x.size], scale, own_error + rounding, len(wrong))
            if found and found.error < max(goal, 1e-13):
                break
    if found:
        return found
    return f"no two quadratures agree: {own_error:.0e} at rtol {case.rtol:.0e}"


# --- the study --------------------------------------------------------------------------------------------


def fan_of(number: int, case: Case) -> np.ndarray | None:
    """For one case in seven: 40 or 150 angles among which its own is asked for."""
    if number % 7 or getattr(case.beam, "form", "launch") == "rotated":
        return None
    rng = np.random.default_rng([SEED, number, 1])
    angles = rng.uniform(-89, 89, int(rng.choice([40, 150])))
    angles[rng.integers(angles.size)] = case.beam.angle
    return angles


def map_of(number: int, case: Case) -> tuple[np.ndarray, np.ndarray]:
    """x and z that are asked for; for one case in five a map of many planes and positions, the case's own among them."""
    if number % 5 != 1 or number % 7 == 0:
        return case.x, case.z
    rng = np.random.default_rng([SEED, number, 2])
    half = max(np.ptp(case.x) / 2, case.beam.reach(0.5))
    x = case.x.mean() + half * np.linspace(-1, 1, 80)
    return np.union1d(case.x, x), np.union1d(case.z, rng.uniform(case.z.min(), case.z.max(), 250))


#: How a refusal begins: the argument that it names, and why.
REFUSALS = ("slab: it guides more backward waves", "rtol: ")


def judge(number: int) -> dict[str, Any]:
    """One case: the package's answer, its promise, and the truth."""
    case = make_case(number)
    angles = fan_of(number, case)
    x, z = map_of(number, case)
    row: dict[str, Any] = {
        "number": number, "kind": case.kind, "source": case.source, "rtol": case.rtol, "error": np.nan, "estimate": np.nan,
        "truth_error": np.nan, "seconds": np.nan, "warned": False, "status": "answered", "reason": "", "wrong": 0,
        "fan": angles is not None, "many_planes": z.size > case.z.size,
    }  # fmt: skip
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            ds = bp.field(case.slab, case.beam, case.frequency, x, z, angle=angles, rtol=case.rtol)
            ds = ds if angles is None else ds.isel(angle=int(np.flatnonzero(angles == case.beam.angle)[0]))
        except ValueError as error:  # refused, if it names what asks too much; any other is a fault of the package
            status = "refused" if str(error).startswith(REFUSALS) else "crashed"
            row |= {"status": status, "reason": str(error)[:90]}
        except Exception as error:  # a crash is a finding, not the study's end
            row |= {"status": "crashed", "reason": f"{type(error).__name__}: {error}"[:90]}
    row["seconds"] = time.perf_counter() - start
    row["warned"] = any(issubclass(w.category, bp.AccuracyWarning) for w in caught)
    if angles is not None and row["status"] == "answered":  # the warning is of the worst angle
        row["warned"] = row["warned"] and float(ds.error_estimate) > case.rtol
    other = [str(w.message) for w in caught if not issubclass(w.category, bp.AccuracyWarning)]
    if other:
        row["reason"] = f"warning: {other[0][:80]}"
    if row["status"] != "answered":
        return row
    row["estimate"] = float(ds.error_estimate)
    some = np.unique(np.linspace(0, case.x.size - 1, 61).round().astype(int))  # of a fine grid
    own = case.beam.centre + case.beam.reach(1e-3 * case.rtol) * np.linspace(-1, 1, 41)
    with np.errstate(all="ignore"):
        found = truth(case._replace(x=case.x[some]), own, min(0.1 * case.rtol, 0.3 * row["estimate"]))
    if isinstance(found, str):
        return row | {"status": "no truth", "reason": row["reason"] or found}
    p = ds.p.values.reshape(z.size, x.size)[np.searchsorted(z, case.z)][:, np.searchsorted(x, case.x)][:, some]
    scale = np.where(found.scale > 1e-280, found.scale, np.inf)
    error = float(np.max(np.abs(p - found.p).max(axis=1) / scale))
    return row | {"error": error, "truth_error": found.error, "wrong": found.wrong}


def study(numbers: range, workers: int = 2) -> xr.Dataset:
    """All cases, in processes of their own."""
    with multiprocessing.get_context("spawn").Pool(workers) as pool:
        jobs = pool.imap_unordered(judge, numbers)
        rows = sorted(tqdm(jobs, total=len(numbers), desc="cases", file=sys.stderr), key=lambda r: r["number"])
    return xr.Dataset({key: ("case", np.array([r[key] for r in rows])) for key in rows[0] if key != "number"},
                      {"case": [r["number"] for r in rows]})  # fmt: skip


# --- limiting absorption ----------------------------------------------------------------------------------

ABSORPTIONS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def limiting_absorption(periods: int = 450) -> xr.Dataset:
    """The paper's slab with rho_m = 0.05 + i loss: how far its field is from the lossless one, over the largest |p|."""
    beam = bp.GaussianBeam(0.096)
    clear = slab(periods, LOSSLESS)
    x, z = np.linspace(-0.5, 0.5, 101), clear.thickness * np.array([0.0, 0.5, 1.0])
    frequency = np.array([2000.0, 2400.0])
    limit = bp.field(clear, beam, frequency, x, z, rtol=1e-10).p
    apart = []
    for loss in ABSORPTIONS:
        p = bp.field(slab(periods, (0.05 + 1j * loss, loss / 2)), beam, frequency, x, z, rtol=1e-10).p
        apart.append((np.abs(p - limit).max(("z", "x")) / np.abs(limit).max(("z", "x"))).values)
    return xr.Dataset(
        {"apart": (("loss", "frequency"), np.array(apart))}, {"loss": list(ABSORPTIONS), "frequency": frequency}
    )


def limit_table(ds: xr.Dataset) -> str:
    """Distance to the lossless field by loss, and how it falls per decade."""
    lines = ["| loss | " + " | ".join(f"{f:g} Hz | per decade" for f in ds.frequency.values) + " |", "|---" * 5 + "|"]
    for i, loss in enumerate(ds.loss.values):
        cells = []
        for j in range(ds.sizes["frequency"]):
            a = ds.apart.values[:, j]
            cells += [f"{a[i]:.3e}", f"{a[i - 1] / a[i]:.3f}" if i else ""]
        lines.append(f"| {loss:.0e} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


# --- table, picture, main ---------------------------------------------------------------------------------


def verdicts(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Which cases are what; an error counts less what the truth itself may be off, below which it judges no estimate."""
    status = ds.status.values
    judged = status == "answered"
    error = ds.error.values - ds.truth_error.values
    return {
        "judged": judged,
        "refused": status == "refused",
        "crashed": status == "crashed",
        "without truth": status == "no truth",
        "warned": ds.warned.values.astype(bool),
        "broken": judged & (error > ds.rtol.values) & ~ds.warned.values.astype(bool),
        "too sure": judged & (error > 3 * np.maximum(ds.estimate.values, ds.truth_error.values)),
    }


def class_table(ds: xr.Dataset) -> str:
    """By kind of slab, then by source, then all: what the promise was worth."""
    lines = [
        "| class | cases | refused | warned | judged | rtol broken | estimate < error/3 | median estimate/error | median s |",
        "|---" * 9 + "|",
    ]
    v = verdicts(ds)
    groups = [(k, ds.kind.values == k) for k in SLABS] + [(k, ds.source.values == k) for k in SOURCES]
    groups.append(("one of 40 or 150 angles", ds.fan.values.astype(bool)))
    groups.append(("in a map of 250 planes and more", ds.many_planes.values.astype(bool)))
    for name, rows in [*groups, ("all", np.ones(ds.sizes["case"], bool))]:
        if not rows.any():
            continue
        judged = v["judged"] & rows
        ratio = (
            np.median(ds.estimate.values[judged] / np.maximum(ds.error.values[judged], 1e-17))
            if judged.any()
            else np.nan
        )
        counts = [int((v[key] & rows).sum()) for key in ("refused", "warned", "judged", "broken", "too sure")]
        middle = " | ".join(str(c) for c in [int(rows.sum()), *counts])
        lines.append(f"| {name} | {middle} | {ratio:.2g} | {np.nanmedian(ds.seconds.values[rows]):.2g} |")
    return "\n".join(lines)


def reasons(ds: xr.Dataset) -> str:
    """Why cases were refused, crashed, or had no truth, counted."""
    lines = ["| status | reason | cases |", "|---|---|---|"]
    keys = [
        (s, "".join("#" if c.isdigit() else c for c in r))
        for s, r in zip(ds.status.values, ds.reason.values, strict=True)
        if r
    ]
    for status, reason in sorted(set(keys)):
        lines.append(f"| {status} | {reason} | {keys.count((status, reason))} |")
    return "\n".join(lines)


def compute(quick: bool = False) -> dict[str, xr.Dataset]:
    """The study and the sequence of losses."""
    return {"cases": study(range(60 if quick else CASES)), "limit": limiting_absorption(40 if quick else 450)}


def plot(data: dict[str, xr.Dataset]) -> plt.Figure:
    """True error against rtol, and the estimate against the true error."""
    ds = data["cases"]
    v = verdicts(ds)
    judged = v["judged"]
    fig, (left, right) = plt.subplots(1, 2, figsize=(13, 6), layout="constrained")
    for i, kind in enumerate(SLABS):
        rows = judged & (ds.kind.values == kind)
        style: dict[str, Any] = {"s": 9, "color": plt.get_cmap("tab20")(i), "label": kind}
        error = np.maximum(ds.error.values[rows], 1e-17)
        left.scatter(ds.rtol.values[rows], error, **style)
        right.scatter(error, ds.estimate.values[rows], **style)
    marked = judged & v["warned"]
    left.scatter(
        ds.rtol.values[marked], ds.error.values[marked], s=50, facecolors="none", edgecolors="k", label="warned"
    )
    span = np.array([1e-17, 1.0])
    left.plot([1e-11, 1e-3], [1e-11, 1e-3], "k-", lw=0.8)
    right.plot(span, span, "k-", lw=0.8)
    right.plot(span, span / 3, "k--", lw=0.8)
    left.set(
        xscale="log",
        yscale="log",
        xlabel="asked rtol",
        ylabel="true error",
        title="a point above the line must be warned of",
    )
    right.set(
        xscale="log",
        yscale="log",
        xlabel="true error",
        ylabel="error_estimate",
        title="no point below the dashed line, a third",
        xlim=(1e-17, 2),
    )
    left.legend(fontsize="x-small", loc="upper left", ncols=2)
    return fig


def statements(data: dict[str, xr.Dataset]) -> list[Statement]:
    """The promise, and the limit of vanishing absorption."""
    v = verdicts(data["cases"])
    n = int(v["judged"].sum())
    apart = data["limit"].apart.values
    rates = apart[:-1] / apart[1:]
    share = f"{n} of {v['judged'].size} cases judged"
    return [
        Statement(
            "accuracy",
            "no error above rtol without a warning",
            f"{int(v['broken'].sum())}; {share}",
            not v["broken"].any(),
        ),
        Statement(
            "accuracy",
            "no estimate below a third of the error",
            f"{int(v['too sure'].sum())}; {share}",
            not v["too sure"].any(),
        ),
        Statement("accuracy", "no crash", str(int(v["crashed"].sum())), not v["crashed"].any()),
        Statement(
            "accuracy",
            "vanishing loss tends to the lossless field, linearly",
            f"ten times less loss, {rates[2:].min():.3f} to {rates[2:].max():.3f} times nearer below 1e-4",
            bool(np.all(np.abs(rates[2:] - 10) < 0.2)),
        ),
    ]


if __name__ == "__main__":
    found: dict[str, xr.Dataset] = {}

    def keep(quick: bool) -> dict[str, xr.Dataset]:
        """Compute, and keep for the tables below."""
        found.update(compute(quick))
        print(class_table(found["cases"]), reasons(found["cases"]), limit_table(found["limit"]), sep="\n\n", end="\n\n")
        return found

    run("accuracy", __doc__, keep, plot, statements)
