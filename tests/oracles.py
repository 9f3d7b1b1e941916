"""Independent, slow and obvious implementations of every headline quantity. They share no code with the package.

* `slab_response`: 50-digit transfer matrices (mpmath), layer by layer, periods by repeated squaring.
* `emt_transmissivity`: the paper's Eq. (11), a homogeneous slab without lateral motion.
* `air_beam`: the angular-spectrum integral in a homogeneous fluid, trapezoid rule on a bent contour.
* `open_field`: the open-space field by quadrature on a bent contour that passes below the poles and the branch point on
  the right and above those on the left, with plain layer-by-layer matrices.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np


def _mp_layer(rho, K, d, omega, kx):
    kz2 = rho * (omega**2 / K - kx**2 / rho)
    kz = mp.sqrt(kz2)
    if kz == 0:
        return mp.matrix([[1, rho * d], [0, 1]])
    c, s = mp.cos(kz * d), mp.sin(kz * d)
    return mp.matrix([[c, rho * s / kz], [-kz * s / rho, c]])


def _mp_power(m, n):
    out = mp.eye(2)
    while n:
        if n & 1:
            out = m * out
        m = m * m
        n >>= 1
    return out


def _mp_outgoing(rho, K, omega, kx):
    kz = mp.sqrt(omega**2 * rho / K - kx**2)
    return -kz if mp.im(kz) < 0 else kz


def slab_response(layers, periods, before, after, frequency, kx, digits=50):
    """r and t of `periods` copies of layers [(density, bulk_modulus, thickness), ...] between two fluids.

    before, after: (density, bulk_modulus). Working precision grows with the opacity, so that `digits` are left.
    """
    own = [2 * np.pi * float(frequency) * abs(complex(rho) / complex(K)) ** 0.5 for rho, K, _ in layers]
    depth = sum((abs(complex(kx)) + k) * d for k, (_, _, d) in zip(own, layers, strict=True))
    estimate = depth * periods + 30 * np.sqrt(periods)
    with mp.workdps(int(digits + 20 + estimate)):
        w, k = 2 * mp.pi * mp.mpf(frequency), mp.mpmathify(kx)
        # the package works in double precision from w = 2 pi f on; its rounding is part of the input
        w = mp.mpf(2 * np.pi * float(frequency))
        m = mp.eye(2)
        for rho, K, d in layers:
            m = _mp_layer(mp.mpmathify(rho), mp.mpmathify(K), mp.mpf(d), w, k) * m
        m = _mp_power(m, periods)
        (rb, Kb), (ra, Ka) = [(mp.mpmathify(a), mp.mpmathify(b)) for a, b in (before, after)]
        y1 = 1j * _mp_outgoing(rb, Kb, w, k) / rb
        y2 = 1j * _mp_outgoing(ra, Ka, w, k) / ra
        # [t; y2 t] = m [1 + r; y1 (1 - r)]
        a = m[1, 0] - y2 * m[0, 0]
        b = m[1, 1] - y2 * m[0, 1]
        r = -(a + b * y1) / (a - b * y1)
        t = 2 * y1 / (y2 * m[0, 0] * 1 - m[1, 0] + y1 * (m[1, 1] - y2 * m[0, 1]))  # det m = 1
        return r, t


def bloch_phase(layers, frequency, kx, digits=60):
    """acos(trace/2) of a cell of [(density, bulk_modulus, thickness), ...], with 0 <= Re <= pi."""
    with mp.workdps(digits):
        w, k = mp.mpf(2 * np.pi * float(frequency)), mp.mpmathify(kx)
        m = mp.eye(2)
        for rho, K, d in layers:
            m = _mp_layer(mp.mpmathify(rho), mp.mpmathify(K), mp.mpf(d), w, k) * m
        return mp.acos((m[0, 0] + m[1, 1]) / 2)


def emt_transmissivity(rho_eff, thickness, k0, kx):
    """Eq. (11): |cos(kz L) - i F sin(kz L)|^-2, kz = k0 sqrt(rho_eff), F = (a + 1/a)/2, a = sqrt(rho_eff) cos(theta)."""
    cosine = np.sqrt(1 - (np.asarray(kx, complex) / k0) ** 2)
    kz = k0 * np.sqrt(complex(rho_eff))
    # admittance ratio of the effective fluid to the background: (kz/rho_eff)/(k0 cos) = 1/(sqrt(rho_eff) cos)
    a = np.sqrt(complex(rho_eff)) * cosine
    F = (a + 1 / a) / 2
    return np.abs(np.cos(kz * thickness) - 1j * F * np.sin(kz * thickness)) ** -2


# --- beams ------------------------------------------------------------------------------------------------


def _layer(rho, K, d, omega, kx, rho_x=None):
    """Plain numpy layer matrices on an array of kx: (n, 2, 2)."""
    rho_x = rho if rho_x is None else rho_x
    kz = np.sqrt(rho * (omega**2 / K - kx**2 / rho_x) + 0j)
    c, s = np.cos(kz * d), np.sin(kz * d)
    return np.moveaxis(np.array([[c, rho * s / kz], [-kz * s / rho, c]]), -1, 0)


def _product(layers, omega, kx):
    m = np.broadcast_to(np.eye(2, dtype=complex), (kx.size, 2, 2))
    for rho, K, d in layers:
        m = _layer(rho, K, d, omega, kx) @ m
    return m


def bent_contour(k0, band, bend, count):
    """kx = s - i bend tanh(2 s/k0) and its weights dkx/ds ds: below the right half of the axis, above the left."""
    s = np.linspace(-band, band, count)
    kx = s - 1j * bend * np.tanh(2 * s / k0)
    slope = 1 - 1j * bend * (2 / k0) / np.cosh(np.clip(2 * s / k0, -300, 300)) ** 2
    return kx, slope * (s[1] - s[0])


def air_beam(spectrum, k0, x, distances, bend=2.0, band=220.0, count=6001):
    """p(distance, x) of a beam that meets nothing: S(kx) exp(i kz distance), on the bent contour."""
    kx, weight = bent_contour(k0, band, bend, count)
    kz = np.sqrt(k0**2 - kx**2)
    waves = np.exp(1j * np.outer(x, kx)) * (spectrum(kx) * weight / (2 * np.pi))
    return np.array([waves @ np.exp(1j * kz * d) for d in distances])


def open_field(layers, periods, before, after, frequency, spectrum, z0, x, z, bend=3.0, band=220.0, count=6001):
    """p(z, x) in open space: trapezoid rule on a bent contour, plain matrices from the near face on.

    layers [(density, bulk_modulus, thickness), ...]; before, after (density, bulk_modulus); spectrum: S(kx) of the pressure
    on the launch plane z0.
    """
    omega = 2 * np.pi * frequency
    (rb, Kb), (ra, Ka) = before, after
    k0 = omega * np.sqrt(rb / Kb)
    kx, weight = bent_contour(k0, band, bend, count)
    kz1 = np.sqrt(omega**2 * rb / Kb - kx**2)  # on this contour the principal root is the outgoing one
    kz2 = np.sqrt(omega**2 * ra / Ka - kx**2)
    cell = _product(layers, omega, kx)
    whole = np.linalg.matrix_power(cell, periods)
    y1, y2 = 1j * kz1 / rb, 1j * kz2 / ra
    a = whole[:, 1, 0] - y2 * whole[:, 0, 0]
    b = whole[:, 1, 1] - y2 * whole[:, 0, 1]
    r = -(a + b * y1) / (a - b * y1)
    near = np.stack([1 + r, y1 * (1 - r)], axis=-1)
    period = sum(d for _, _, d in layers)
    total = period * periods
    launched = spectrum(kx) * np.exp(-1j * kz1 * z0) * weight / (2 * np.pi)
    rows = []
    for depth in z:
        if depth <= 0:
            h = np.exp(1j * kz1 * depth) + r * np.exp(-1j * kz1 * depth)
        else:
            inside = min(depth, total)
            n = min(int(inside // period), periods)
            state = np.linalg.matrix_power(cell, n) @ near[..., None]
            left = inside - n * period
            for rho, K, d in layers if n < periods else []:
                part = min(d, left)
                if part > 0:
                    state = _layer(rho, K, part, omega, kx) @ state
                left -= part
            h = state[:, 0, 0] * np.exp(1j * kz2 * (depth - inside))
        rows.append(np.exp(1j * np.outer(x, kx)) @ (launched * h))
    return np.array(rows)
