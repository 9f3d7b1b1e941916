"""The truth in three dimensions: panels over the radial wavenumber and the trapezoid rule over directions, twice.

The radial contour, its circles around backward modes and the response are those of the study in two dimensions.
"""

from __future__ import annotations

import math

import numpy as np

import beamprop as bp

from ..case import Case, SpaceCase
from . import quadrature
from .quadrature import EPS, Setting, Truth

#: The most products of nodes, directions and positions that a quadrature may take: some 10 s.
MOST_TERMS = 3e8
#: Rays that go farther than this over 1/k0 are not followed.
MOST_RADIANS = 400.0


class Round:
    """The spectrum of an elliptical beam from its definition, about its middle."""

    def __init__(self, beam: bp.GaussianBeam, k0: float) -> None:
        widths = beam.fwhm if isinstance(beam.fwhm, tuple) else (beam.fwhm, beam.fwhm)
        self.a = [w / (2 * math.sqrt(math.log(2))) for w in widths]
        turn, self.k = math.radians(beam.azimuth), k0 * math.sin(math.radians(beam.angle))
        self.along = math.cos(turn), math.sin(turn)

    def __call__(self, kx: np.ndarray, ky: np.ndarray) -> np.ndarray:
        (ax, ay), (cx, cy) = self.a, self.along
        return math.pi * ax * ay * np.exp(-((ax * (kx - self.k * cx) / 2) ** 2) - (ay * (ky - self.k * cy) / 2) ** 2)


def _flat(case: SpaceCase, radii: np.ndarray) -> Case:
    """A case in two dimensions whose contours serve: as narrow a beam, and the same distances."""
    a = min(case.beam.fwhm) if isinstance(case.beam.fwhm, tuple) else case.beam.fwhm
    beam = bp.GaussianBeam(a, abs(case.beam.angle), 0.0, case.beam.z0)
    return Case(case.kind, "Gaussian, launch", case.slab, beam, case.frequency, radii, case.z, case.rtol)


def _positions(case: SpaceCase, source: Round) -> tuple[np.ndarray, np.ndarray]:
    """The requested ones from the middle, row by row; then the middle's own, (P,) each."""
    x, y = (v.ravel() for v in np.meshgrid(case.x - case.beam.x0, case.y - case.beam.y0))
    half = np.array([-0.3, 0.0, 0.3])
    u, v = (w.ravel() for w in np.meshgrid(half * source.a[0], half * source.a[1]))
    return np.append(x, u), np.append(y, v)


def _elsewhere(case: SpaceCase, s: Setting, source: Round, contour: tuple[float, list[complex]]) -> np.ndarray:
    """|p| where nine rays land on each plane, (Z,), roughly: errors are over the largest |p| of a plane."""
    step, wide = 1e-5 * s.m.k0, 3 / max(source.a)
    k = np.clip(source.k + wide * np.linspace(-1, 1, 9), -0.98 * s.m.k0, 0.98 * s.m.k0)
    low, high = (s.m.response(np.abs(k + side * step) + 0j, case.z, case.beam.z0) for side in (-1, 1))
    with np.errstate(all="ignore"):
        r = np.nan_to_num(-np.angle(high / low) / (2 * step)).ravel()
    r = np.unique(np.round(r[np.abs(r) * s.m.k0 < MOST_RADIANS], 6))
    if not r.size:
        return np.zeros(case.z.size)
    far = quadrature.setting(_flat(case, np.abs(r)), np.array([0.0]))._replace(reach=s.reach)
    nodes = quadrature.nodes_on_contour(far, 0, *contour)
    count = _directions(far, nodes[0])
    if float(nodes[0].size) * count * r.size > MOST_TERMS:
        return np.zeros(case.z.size)
    p = _sum(far, source, nodes, (r * source.along[0], r * source.along[1]), count)
    return np.nan_to_num(np.abs(p).max(axis=1))


def _directions(s: Setting, k: np.ndarray) -> int:
    """How many the trapezoid rule takes."""
    return int(60 + 1.2 * float(np.max(np.abs(k.real))) * (s.extent + s.reach))


def _sum(
    s: Setting, source: Round, nodes: tuple[np.ndarray, np.ndarray], places: tuple[np.ndarray, np.ndarray], count: int
) -> np.ndarray:
    """p (Z, P) over `count` directions."""
    (k, w), (x, y) = nodes, places
    alpha = 2 * np.pi * (np.arange(count) + 0.5) / count
    rings = np.empty((k.size, x.size), complex)
    for i in range(0, k.size, block := max(1, 200_000 // count)):
        kx, ky = (np.multiply.outer(k[i : i + block], v) for v in (np.cos(alpha), np.sin(alpha)))
        strength = source(kx, ky)
        for j, (a, b) in enumerate(zip(x, y, strict=True)):
            rings[i : i + block, j] = (strength * np.exp(1j * (kx * a + ky * b))).sum(axis=1)
    return s.response(k) @ (rings * (k * w)[:, None]) / (2 * np.pi * count)


def truth(case: SpaceCase) -> Truth | str:
    """The field by two quadratures that agree to a tenth of rtol; or why there is none."""
    first = quadrature.setting(_flat(case, np.array([0.0])), np.array([0.0]))
    source = Round(case.beam, first.m.k0)
    x, y = _positions(case, source)
    flat = _flat(case, np.hypot(x, y))
    s = quadrature.setting(flat, np.array([0.0]))._replace(reach=6.1 * max(source.a))
    wrong, shallow = quadrature.misplaced_modes(s)
    if wrong is None:
        return "backward modes not located"
    before, why = None, "too many terms"
    elsewhere = _elsewhere(case, s, source, (shallow, wrong))
    for step in range(3):
        k, w = quadrature.nodes_on_contour(s, step, shallow, wrong)
        count = int((1.0 + 0.25 * step) * _directions(s, k))
        if float(k.size) * count * x.size > MOST_TERMS:
            return why
        p = _sum(s, source, (k, w), (x, y), count)
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
