"""Independent, slow and obvious fields of Gaussian beams in three dimensions. They share no code with the package's own.

The response of a slab is the accuracy study's cascade of scattering matrices, at complex wavenumbers of the plane.

* `polar_field`: Gauss panels over the radial wavenumber on a straight bend below the axis, the trapezoid rule over directions.
* `tensor_field`: kx and ky both on a bent contour of their own.
* `rayleigh_field`: Rayleigh's first integral in a homogeneous fluid, over the launch plane.
* `round_profile`: p(r) of a circular beam along the normal, at complex radii too: a tilted one is the same, moved to complex places.
* `peak_and_widths`, `area_of_samples`: what such fields measure.
"""

from __future__ import annotations

import numpy as np
from accuracy_study.reference.medium import Medium
from scipy.ndimage import label
from scipy.optimize import brentq, minimize
from scipy.special import jv


class Gaussian:
    """exp(-(x/ax)^2 - (y/ay)^2 + i (Kx x + i Ky y)) on z0, by its 1/e radii and the wavevector along the plane."""

    def __init__(self, beam, k0):
        turn = np.radians(beam.azimuth)
        widths = beam.fwhm if isinstance(beam.fwhm, tuple) else (beam.fwhm, beam.fwhm)
        self.a = [w / (2 * np.sqrt(np.log(2))) for w in widths]
        self.tilt = [k0 * np.sin(np.radians(beam.angle)) * v for v in (np.cos(turn), np.sin(turn))]
        self.at, self.z0 = (beam.x0, beam.y0), beam.z0

    def spectrum(self, kx, ky):
        (ax, ay), (tx, ty) = self.a, self.tilt
        return np.pi * ax * ay * np.exp(-((ax * (kx - tx) / 2) ** 2) - (ay * (ky - ty) / 2) ** 2)

    def launched(self, x, y):
        (ax, ay), (tx, ty) = self.a, self.tilt
        return np.exp(-((x / ax) ** 2) - (y / ay) ** 2 + 1j * (tx * x + ty * y))

    def end(self, rtol=1e-16):
        """|k| at which the spectrum has ended."""
        return np.hypot(*self.tilt) + 2 / min(self.a) * np.sqrt(np.log(1 / rtol))


def straight_bend(end, depth, corner, panels, gauss=20):
    """Nodes and weights on 0 -> corner - i depth -> end - i depth."""
    g, w = np.polynomial.legendre.leggauss(gauss)
    nodes, weights = [], []
    for lo, hi, slope, count in ((0, corner, depth / corner, max(4, panels // 4)), (corner, end, 0.0, panels)):
        edges = np.linspace(lo, hi, count + 1)
        s = (edges[:-1, None] + np.diff(edges)[:, None] * (g + 1) / 2).ravel()
        nodes.append(s - 1j * depth * np.minimum(s / corner, 1.0))
        weights.append((np.diff(edges)[:, None] * w / 2).ravel() * (1 - 1j * slope))
    return np.concatenate(nodes), np.concatenate(weights)


def polar_field(slab, frequency, beam, places, z, depth=3.0, panels=40, directions=300):
    """p (Z, P) at places (x, y), (P,) each."""
    medium = Medium(slab, frequency)
    source = Gaussian(beam, medium.k0)
    x, y = (np.asarray(v, float) - v0 for v, v0 in zip(places, source.at, strict=True))
    k, w = straight_bend(source.end(), depth, 0.5 * medium.k0, panels)
    alpha = 2 * np.pi * np.arange(directions) / directions
    kx, ky = np.multiply.outer(k, np.cos(alpha)), np.multiply.outer(k, np.sin(alpha))
    strength = source.spectrum(kx, ky) * (k * w)[:, None] * (2 * np.pi / directions) / (4 * np.pi**2)
    rings = np.stack([(strength * np.exp(1j * (kx * a + ky * b))).sum(axis=1) for a, b in zip(x, y, strict=True)])
    return medium.response(k, np.asarray(z, float), source.z0) @ rings.T


def tensor_field(slab, frequency, beam, places, z, depth=3.0, panels=16):
    """p (Z, P): the response at sqrt(kx^2 + ky^2), whose square lies below the axis where kx^2 and ky^2 do."""
    medium = Medium(slab, frequency)
    source = Gaussian(beam, medium.k0)
    x, y = (np.asarray(v, float) - v0 for v, v0 in zip(places, source.at, strict=True))
    k, w = straight_bend(source.end(), depth, 0.5 * medium.k0, panels)
    kx, ky = k[None, :], k[:, None]
    h = medium.response(np.sqrt(kx**2 + ky**2).ravel(), np.asarray(z, float), source.z0).reshape(-1, k.size, k.size)
    p = 0
    for sx in (1, -1):
        for sy in (1, -1):
            strength = np.multiply.outer(w, w) / (4 * np.pi**2) * source.spectrum(sx * kx, sy * ky)
            along_x, along_y = np.exp(1j * sx * np.outer(k, x)), np.exp(1j * sy * np.outer(k, y))
            p = p + np.einsum("yp,zyp->zp", along_y, (h * strength) @ along_x)
    return p


def rayleigh_field(k0, beam, places, z, step=0.1, reach=6.2):
    """p (Z, P) in a homogeneous fluid, z behind the launch plane: -(1/2 pi) integral p0 d/dz (exp(ikR)/R) dx dy."""
    source = Gaussian(beam, k0)
    u, v = (a * np.arange(-reach, reach, step) for a in source.a)
    launched = source.launched(u[:, None], v[None, :]) * (u[1] - u[0]) * (v[1] - v[0]) / (2 * np.pi)
    out = []
    for depth in z:
        d = depth - source.z0
        for a, b in zip(*places, strict=True):
            r = np.sqrt((a - source.at[0] - u[:, None]) ** 2 + (b - source.at[1] - v[None, :]) ** 2 + d**2)
            out.append(np.sum(launched * d / r**2 * (1 / r - 1j * k0) * np.exp(1j * k0 * r)))
    return np.reshape(out, (len(z), -1))


def round_profile(slab, frequency, beam, radius, z, depth=3.0, panels=60):
    """p (Z, P) of a circular beam along the normal, at complex radii (P,)."""
    medium = Medium(slab, frequency)
    source = Gaussian(beam, medium.k0)
    k, w = straight_bend(source.end(), depth, 0.5 * medium.k0, panels)
    strength = source.spectrum(k, 0.0) * k * w / (2 * np.pi)
    return medium.response(k, np.asarray(z, float), source.z0) @ (
        strength[:, None] * jv(0, np.multiply.outer(k, radius))
    )


def peak_and_widths(size, start):
    """The largest |p| of size(x, y) near a place, and its half widths along x and y, by a general optimiser and root finder."""
    best = minimize(lambda v: -size(*v), start, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-14})
    x, y = best.x
    cuts = (lambda t: size(x + t, y) + best.fun / 2), (lambda t: size(x, y + t) + best.fun / 2)
    return -best.fun, [brentq(cut, 0.0, 0.3, xtol=1e-10) - brentq(cut, -0.3, 0.0, xtol=1e-10) for cut in cuts]


def area_of_samples(p, x, y, level=0.5):
    """Of the samples connected to the largest |p| on which |p| is level times it or more, each counted as its cell."""
    size = np.abs(p)
    numbered, _ = label(size >= level * size.max())
    return np.count_nonzero(numbered == numbered.ravel()[size.argmax()]) * (x[1] - x[0]) * (y[1] - y[0])
