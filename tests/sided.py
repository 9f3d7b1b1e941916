"""Fields by plain matrices on a contour that is told on which side to pass each singular point: an oracle of its own.

It shares no code with the package. A mode of a lossless slab lies on the axis; on which side of it the contour passes is read off
where a trace of loss moves it (limiting absorption). With loss the same contour serves, since modes move away from it.
Media are pairs (density, bulk modulus), layers (density, bulk modulus, thickness).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

F = 2500.0
OMEGA = 2 * np.pi * F
RHO, BULK = 1.25, 1.25 * 343.0**2
AIR = (RHO, BULK)
K0 = OMEGA / 343.0
LAM = 343.0 / F


def lossy(medium, loss):
    """rho (1 + i loss) and K (1 - i loss), with the signs that absorb for negative rho and K too."""
    rho, K, *thickness = medium
    return (rho + 1j * loss * abs(rho), K - 1j * loss * abs(K), *thickness)


def half_space_kz(medium, k, omega=OMEGA):
    """kz that decays or carries energy along +z: what is negative decides which root that is. Cuts run along Re k = |Re b|."""
    rho, K = medium
    b2 = omega**2 * rho / K
    evanescent = 1j * np.sqrt(k**2 - b2 + 0j)
    if (np.real(rho) < 0) != (np.real(K) < 0):
        return evanescent
    propagating = (-1 if np.real(rho) < 0 else 1) * np.sqrt(b2 - k**2 + 0j)
    return np.where(np.real(k) > np.real(np.sqrt(b2 + 0j)), evanescent, propagating)


def _across(medium, d, k, p, q, omega=OMEGA):
    """(p, q = p'/rho) a distance d behind, or in front for d < 0."""
    rho, K = medium
    kz = np.sqrt(omega**2 * rho / K - k**2 + 0j)
    c, s = np.cos(kz * d), np.sin(kz * d)
    return c * p + rho * s / kz * q, -kz * s / rho * p + c * q


def _states(layers, after, k):
    """(p, q) at all faces, near face first, from the outgoing wave behind or from p = 0 on a soft wall (after None)."""
    one = np.ones(np.shape(k), complex)
    states = [(0 * one, one) if after is None else (one, 1j * half_space_kz(after, k) / after[0])]
    for rho, K, d in reversed(layers):
        states.insert(0, _across((rho, K), -d, k, *states[0]))
    return states


def dispersion(layers, after, k, before=AIR):
    """D(k), zero at a mode; real without loss beyond all branch points."""
    p, q = _states(layers, after, k)[0]
    return 1j * half_space_kz(before, k) / before[0] * p + q


def response(layers, after, k, z, z0, before=AIR):
    """p on planes z, (Z, n), of a unit plane wave launched on z0."""
    states, kz = _states(layers, after, k), half_space_kz(before, k)
    y = 1j * kz / before[0]
    near, slope = states[0]
    unit = 2 * np.exp(-1j * kz * z0) / (near + slope / y)
    faces = np.concatenate([[0.0], np.cumsum([d for *_, d in layers])])
    rows = []
    for depth in z:
        if depth <= 0:
            rows.append(np.cos(kz * depth) * near + np.sin(kz * depth) / kz * before[0] * slope)
        elif depth >= faces[-1]:
            rows.append(states[-1][0] * np.exp(1j * half_space_kz(after, k) * (depth - faces[-1])) if after else 0 * k)
        else:
            i = int(np.searchsorted(faces, depth, "right")) - 1
            rows.append(_across(layers[i][:2], depth - faces[i], k, *states[i])[0])
    return np.array(rows) * unit


def modes(layers, after, band):
    """(k, side) of the lossless slab's modes up to `band`: side 1 where the contour passes below, -1 where above."""
    media = [AIR] + ([after] if after else [])
    first = max(OMEGA * abs(rho / K) ** 0.5 for rho, K in media if rho / K > 0)
    k = first * (1 + np.geomspace(1e-9, band / first, 20001))
    values = dispersion(layers, after, k + 0j).real
    found = []
    for i in np.flatnonzero(np.diff(np.sign(values))):
        on_axis = brentq(lambda v: dispersion(layers, after, v + 0j).real, k[i], k[i + 1], xtol=1e-13, rtol=1e-15)
        loss = 1e-6
        with_loss = [lossy(layer, loss) for layer in layers], lossy(after, loss) if after else None
        root = complex(on_axis)
        for _ in range(30):
            step = 1e-5
            here = dispersion(*with_loss, root)
            root -= here * 2 * step / (dispersion(*with_loss, root + step) - dispersion(*with_loss, root - step))
        assert abs(root - on_axis) < 1e-2 * on_axis
        found.append((on_axis, 1 if root.imag > 0 else -1))
    return found


def contour(singular, band, height, finest=0.0, panel=0.7, order=20):
    """Gauss nodes and weights from 0 to `band`, below the points (k, 1) and above the points (k, -1).

    If `finest` is given, nodes are graded geometrically towards 0 from there on, and the contour leaves 0 at 45 degrees.
    """
    singular = sorted(singular)
    places = np.array([0.0, *(k for k, _ in singular), band])
    corners = [0j, height * (1 - 1j)] if finest else [0j]
    for i, (k, side) in enumerate(singular, 1):
        corners.append(k - 1j * side * min(height, 0.4 * (places[i + 1] - k), 0.4 * (k - places[i - 1])))
    corners.append(complex(band))
    edges = [np.zeros(1, complex)]
    for i in range(len(corners) - 1):
        start, stop = corners[i], corners[i + 1]
        least = min(abs(corner.imag) or height for corner in (start, stop))
        share = np.linspace(0, 1, int(np.ceil(abs(stop - start) / (panel * least))) + 1)
        if i == 0 and finest:
            share = np.concatenate([[0.0], np.exp(np.arange(np.log(finest / abs(stop)), 0, 0.6)), [1.0]])
        edges.append(start + (stop - start) * share[1:])
    edges = np.concatenate(edges)
    g, v = np.polynomial.legendre.leggauss(order)
    width = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + width * (1 + g)).ravel(), (width * v).ravel()


def summed(k, weight, h, spectrum, x):
    """p(z, x) = (1/2 pi) sum w h(k) [S(k) e^{ikx} + S(-k) e^{-ikx}]: h is even."""
    turn = np.exp(1j * np.outer(k, x))
    return ((h * weight * spectrum(k)) @ turn + (h * weight * spectrum(-k)) @ (1 / turn)) / (2 * np.pi)


def gaussian(fwhm, angle=0.0, k0=K0):
    """S(kx) of exp(-(x/a)^2 + i k0 sin(angle) x), half as large at +-fwhm/2."""
    a = fwhm / 2 / np.sqrt(np.log(2))
    return lambda k: a * np.sqrt(np.pi) * np.exp(-((a * (k - k0 * np.sin(np.radians(angle))) / 2) ** 2))
