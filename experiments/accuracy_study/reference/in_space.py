"""The truth in three dimensions: panels over the radial wavenumber, and over directions the trapezoid rule or Bessel functions, twice.

The radial contour, its circles around backward modes and the response are those of the study in two dimensions.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import beamprop as bp

from ..case import Case, SpaceCase
from . import quadrature
from .quadrature import EPS, Setting, Truth
from .radial import Circular, Transducer
from .solid import SolidMedium
from .solid_medium import has_solid

#: The most products of nodes, directions and positions that a quadrature may take: some 10 s.
MOST_TERMS = 3e8
#: Rays that go farther than this over 1/k0 are not followed.
MOST_RADIANS = 400.0
#: Two arrays (n,): nodes and weights, or x and y.
Pair = tuple[np.ndarray, np.ndarray]


class Elliptical:
    """The spectrum of an elliptical beam from its definition, about its middle, and its sum over directions."""

    before = 0.0

    def __init__(self, beam: bp.GaussianBeam, k0: float) -> None:
        widths = beam.fwhm if isinstance(beam.fwhm, tuple) else (beam.fwhm, beam.fwhm)
        self.a = [w / (2 * math.sqrt(math.log(2))) for w in widths]
        turn, self.k = math.radians(beam.azimuth), k0 * math.sin(math.radians(beam.angle))
        self.along = math.cos(turn), math.sin(turn)
        self.middle, self.reach, self.plane = (beam.x0, beam.y0), 6.1 * max(self.a), beam.z0

    def __call__(self, kx: np.ndarray, ky: np.ndarray) -> np.ndarray:
        (ax, ay), (cx, cy) = self.a, self.along
        return math.pi * ax * ay * np.exp(-((ax * (kx - self.k * cx) / 2) ** 2) - (ay * (ky - self.k * cy) / 2) ** 2)

    def flat(self, beam: bp.GaussianBeam) -> bp.GaussianBeam:
        """A source in two dimensions whose contours serve: as narrow a beam."""
        return bp.GaussianBeam(min(self.a) * 2 * math.sqrt(math.log(2)), abs(beam.angle), 0.0, beam.z0)

    def directions(self, s: Setting, k: np.ndarray) -> int:
        """How many the trapezoid rule takes."""
        return int(60 + 1.2 * float(np.max(np.abs(k.real))) * (s.extent + s.reach))

    def field(self, s: Setting, nodes: Pair, places: Pair, count: int) -> np.ndarray:
        """p (Z, P) over `count` directions."""
        (k, w), (x, y) = nodes, places
        alpha = 2 * np.pi * (np.arange(count) + 0.5) / count
        rings = np.empty((k.size, x.size), complex)
        for i in range(0, k.size, block := max(1, 200_000 // count)):
            kx, ky = (np.multiply.outer(k[i : i + block], v) for v in (np.cos(alpha), np.sin(alpha)))
            strength = self(kx, ky)
            for j, (a, b) in enumerate(zip(x, y, strict=True)):
                rings[i : i + block, j] = (strength * np.exp(1j * (kx * a + ky * b))).sum(axis=1)
        return s.response(k) @ (rings * (k * w)[:, None]) / (2 * np.pi * count)


def source_of(case: SpaceCase, k0: float) -> Any:
    """The source, by whichever integral is the shortest."""
    beam = case.beam
    if not isinstance(beam, bp.GaussianBeam):
        return Transducer(beam)
    widths = beam.fwhm if isinstance(beam.fwhm, tuple) else (beam.fwhm, beam.fwhm)
    return Circular(beam, k0) if widths[0] == widths[1] else Elliptical(beam, k0)


def _setting(case: SpaceCase, source: Any, x: np.ndarray) -> Setting:
    """A setting in two dimensions whose contours serve: the same distances, and solids with what they answer."""
    solid = has_solid(case.slab)
    slab = (
        bp.Slab.uniform(bp.AIR, case.slab.thickness, before=case.slab.before, after=case.slab.after)
        if solid
        else case.slab
    )
    label = "Gaussian, launch"
    flat = Case(case.kind, label, slab, source.flat(case.beam), case.frequency, x, case.z, case.rtol)
    s = quadrature.setting(flat, np.array([0.0]))
    s = s._replace(reach=source.reach, path=s.path + source.before)
    return s._replace(m=SolidMedium(case.slab, case.frequency)) if solid else s


def _positions(case: SpaceCase, source: Any) -> Pair:
    """The requested ones from the middle, row by row; then the source's own, (P,) each."""
    x, y = (v.ravel() for v in np.meshgrid(case.x - source.middle[0], case.y - source.middle[1]))
    half = np.array([-0.3, 0.0, 0.3])
    u, v = (w.ravel() for w in np.meshgrid(half * source.a[0], half * source.a[1]))
    at = getattr(source, "at", np.zeros((0, 2)))
    return np.concatenate([x, u, at[:, 0]]), np.concatenate([y, v, at[:, 1]])


def _elsewhere(case: SpaceCase, s: Setting, source: Any, contour: tuple[float, list[complex]]) -> np.ndarray:
    """|p| where nine rays land on each plane, (Z,), roughly: errors are over the largest |p| of a plane."""
    step, wide = 1e-5 * s.m.k0, 3 / max(source.a)
    k = np.clip(source.k + wide * np.linspace(-1, 1, 9), -0.98 * s.m.k0, 0.98 * s.m.k0)
    low, high = (s.m.response(np.abs(k + side * step) + 0j, case.z, source.plane) for side in (-1, 1))
    with np.errstate(all="ignore"):
        r = np.nan_to_num(-np.angle(high / low) / (2 * step)).ravel()
    r = np.unique(np.round(r[np.abs(r) * s.m.k0 < MOST_RADIANS], 6))
    if not r.size:
        return np.zeros(case.z.size)
    far = _setting(case, source, np.abs(r))
    nodes = quadrature.nodes_on_contour(far, 0, *contour)
    count = source.directions(far, nodes[0])
    if float(nodes[0].size) * count * r.size > MOST_TERMS:
        return np.zeros(case.z.size)
    p = source.field(far, nodes, (r * source.along[0], r * source.along[1]), count)
    return np.nan_to_num(np.abs(p).max(axis=1))


def _farthest(source: Any, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The largest distances that a contour is made for: from the middle, or from any of the source's parts."""
    at = getattr(source, "at", np.zeros((1, 2)))
    return np.max([np.hypot(x - a, y - b) for a, b in at], axis=0)


def truth(case: SpaceCase) -> Truth | str:
    """The field by two quadratures that agree to a tenth of rtol; or why there is none."""
    source = source_of(case, float(case.slab.before.wavenumber(case.frequency).real))
    x, y = _positions(case, source)
    s = _setting(case, source, _farthest(source, x, y))
    wrong, shallow = quadrature.misplaced_modes(s)
    if wrong is None:
        return "backward modes not located"
    before, why = None, "too many terms"
    elsewhere = _elsewhere(case, s, source, (shallow, wrong))
    for step in range(3):
        k, w = quadrature.nodes_on_contour(s, step, shallow, wrong)
        count = int((1.0 + 0.25 * step) * source.directions(s, k))
        if float(k.size) * count * x.size > MOST_TERMS:
            return why
        p = source.field(s, (k, w), (x, y), count)
        if not np.all(np.isfinite(p)):
            return "not finite"
        if before is not None:
            scale = np.maximum(np.abs(p).max(axis=1), elsewhere)
            error = np.abs(p - before).max(axis=1) / np.where(scale > quadrature.SILENT, scale, np.inf)
            periods = sum(len(layers) * n for layers, n in s.m.segments)
            error = error + EPS * (periods + s.m.k0 * (s.extent + s.path))
            if np.max(error) < max(0.1 * case.rtol, 1e-13):
                return Truth(p[:, : case.x.size * case.y.size], scale, error, np.zeros(scale.shape, bool), len(wrong))
            why = f"no two quadratures agree: {np.max(error):.0e}"
        before = p
    return why
