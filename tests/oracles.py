"""Independent, slow and obvious implementations of every headline quantity. They share no code with the package.

What the accuracy study's reference computes too, is its: scattering matrices, layers with many digits, sums over plane waves.

* `slab_response`: 50-digit transfer matrices (mpmath), layer by layer, periods by repeated squaring.
* `bloch_phase`: the same of one cell.
* `emt_transmissivity`: the paper's Eq. (11), a homogeneous slab without lateral motion.
* `air_beam`: the angular-spectrum integral in a homogeneous fluid, trapezoid rule on a bent contour.
* `plane_wave_flow`, `open_flow`: pressure and particle velocity by 2 x 2 matrices from face to face, and summed as `open_field` is.

The open-space field, `open_field`, is the accuracy study's, too.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
from accuracy_study.reference import many_digits
from accuracy_study.reference.plain import bent_contour, open_field
from accuracy_study.reference.quadrature import field_sum

import beamprop as bp

__all__ = [
    "air_beam",
    "bloch_phase",
    "emt_transmissivity",
    "open_field",
    "open_flow",
    "plane_wave_flow",
    "slab_response",
]


def _isotropic(layers):
    """(density, density_x, bulk modulus, thickness) of layers (density, bulk modulus, thickness)."""
    return [(rho, rho, K, d) for rho, K, d in layers]


def slab_response(layers, periods, before, after, frequency, kx, digits=50):
    """r and t of `periods` copies of layers [(density, bulk_modulus, thickness), ...] between two fluids.

    before, after: (density, bulk_modulus). Working precision grows with the opacity, so that `digits` are left.
    """
    own = [2 * np.pi * float(frequency) * abs(complex(rho) / complex(K)) ** 0.5 for rho, K, _ in layers]
    depth = sum((abs(complex(kx)) + k) * d for k, (_, _, d) in zip(own, layers, strict=True))
    estimate = depth * periods + 30 * np.sqrt(periods)
    with mp.workdps(int(digits + 20 + estimate)):
        # the package works in double precision from w = 2 pi f on; its rounding is part of the input
        w, kx2 = mp.mpf(2 * np.pi * float(frequency)), mp.mpmathify(kx) ** 2
        m = many_digits.power(many_digits.product(_isotropic(layers), w, kx2), periods)
        y1, y2 = (1j * many_digits.outgoing((rho, rho, K), w, kx2) / mp.mpmathify(rho) for rho, K in (before, after))
        # [t; y2 t] = m [1 + r; y1 (1 - r)]
        a = m[1, 0] - y2 * m[0, 0]
        b = m[1, 1] - y2 * m[0, 1]
        r = -(a + b * y1) / (a - b * y1)
        t = 2 * y1 / (y2 * m[0, 0] * 1 - m[1, 0] + y1 * (m[1, 1] - y2 * m[0, 1]))  # det m = 1
        return r, t


def bloch_phase(layers, frequency, kx, digits=60):
    """acos(trace/2) of a cell of [(density, bulk_modulus, thickness), ...], with 0 <= Re <= pi."""
    with mp.workdps(digits):
        w, kx2 = mp.mpf(2 * np.pi * float(frequency)), mp.mpmathify(kx) ** 2
        m = many_digits.product(_isotropic(layers), w, kx2)
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


def air_beam(spectrum, k0, x, distances):
    """p(distance, x) of a beam that meets nothing: S(kx) exp(i kz distance), on the bent contour."""
    kx, weight = bent_contour(k0, bend=2.0)

    def propagated(k):
        return np.exp(1j * np.multiply.outer(np.asarray(distances), np.sqrt(k0**2 - k**2)))

    return field_sum(lambda k, kz: spectrum(k), propagated, kx, weight, None, np.asarray(x))


# --- particle velocity ------------------------------------------------------------------------------------


def plane_wave_flow(slab, frequency, kx, z0, z):
    """p, v_x and v_z at depths z, (Z, n) each, of plane waves kx of unit pressure on z0: products of 2 x 2 matrices from face to face.

    The state (p, v_z) is carried forward from the near face, which is stable for slabs that are not opaque. At an interface v_x is that
    of the medium behind.
    """
    w, kx = 2 * np.pi * frequency, np.asarray(kx, complex)
    at_frequency = np.array([float(frequency)])

    def medium(fluid):
        rho_z, rho_x, K = (complex(v[0]) for v in fluid.at(at_frequency))
        kz = np.sqrt(rho_z * (w**2 / K - (0 if np.isinf(rho_x) else kx**2 / rho_x)))
        return kz, w * rho_z / kz, 0 * kx if np.isinf(rho_x) else kx / (w * rho_x)

    def across(fluid, d):
        kz, impedance, _ = medium(fluid)
        c, s = np.cos(kz * d), 1j * np.sin(kz * d)
        return np.array([[c, s * impedance], [s / impedance, c]])

    def times(a, b):
        return np.einsum("ij...,jk...->ik...", a, b)

    unit = np.array([[1 + 0 * kx, 0 * kx], [0 * kx, 1 + 0 * kx]])
    places, m, depth = (
        [],
        unit,
        0.0,
    )  # of each layer: its near face, fluid, and the matrix from the slab's near face to there
    for cell, periods in slab.segments:
        for layer in cell.layers * periods:
            if isinstance(layer, bp.Membrane):  # p behind = p in front + i w mass v_z
                m = times(np.array([[1 + 0 * kx, 1j * w * complex(layer.areal_density) + 0 * kx], unit[1]]), m)
                continue
            places.append((depth, layer.fluid, m))
            m, depth = times(across(layer.fluid, layer.thickness), m), depth + layer.thickness
    (kz1, before, lateral1), (kz2, after, lateral2) = medium(slab.before), medium(slab.after)
    launch = np.exp(-1j * kz1 * z0)
    # t = m11 (1 + r) + m12 (1 - r)/Z1 and t/Z2 = m21 (1 + r) + m22 (1 - r)/Z1
    a, b = m[0, 0] - after * m[1, 0], (m[0, 1] - after * m[1, 1]) / before
    r = -(a + b) / (a - b)
    near = np.array([1 + r, (1 - r) / before]) * launch
    far = np.einsum("ij...,j...->i...", m, near)
    rows, on_it = [], 1e-12  # depths this near to an interface lie on it
    for at in z:
        if at < 0 or (at == 0 and not places):
            back = r * np.exp(-1j * kz1 * at)
            forth = np.exp(1j * kz1 * at)
            p, v_z, lateral = (forth + back) * launch, (forth - back) * launch / before, lateral1
        elif at >= depth - on_it:
            wave = np.exp(1j * kz2 * (at - depth))
            p, v_z, lateral = far[0] * wave, far[1] * wave, lateral2
        else:
            start, fluid, to_here = [place for place in places if place[0] <= at + on_it][-1]
            p, v_z = np.einsum("ij...,j...->i...", times(across(fluid, at - start), to_here), near)
            lateral = medium(fluid)[2]
        rows.append((p, lateral * p, v_z))
    return np.array(rows).transpose(1, 0, 2)


def open_flow(slab, frequency, spectrum, z0, x, z, **contour):
    """p, v_x and v_z on (z, x) in open space, (3, Z, X): the trapezoid rule on the bent contour and on its mirror image about the origin."""
    k0 = (
        2 * np.pi * frequency / complex(slab.before.at(frequency).bulk_modulus / slab.before.at(frequency).rho_z) ** 0.5
    )
    kx, weight = bent_contour(k0.real, **contour)
    flow = 0
    for k in (kx, -kx):
        waves = (spectrum(k) * weight / (2 * np.pi))[:, None] * np.exp(1j * np.multiply.outer(k, x))
        flow = flow + plane_wave_flow(slab, frequency, k, z0, z) @ waves
    return flow
