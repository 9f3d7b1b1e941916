"""Independent, slow and obvious implementations of every headline quantity. They share no code with the package.

What the accuracy study's reference computes too, is its: scattering matrices, layers with many digits, sums over plane waves.

* `slab_response`: 50-digit transfer matrices (mpmath), layer by layer, periods by repeated squaring.
* `bloch_phase`: the same of one cell.
* `emt_transmissivity`: the paper's Eq. (11), a homogeneous slab without lateral motion.
* `air_beam`: the angular-spectrum integral in a homogeneous fluid, trapezoid rule on a bent contour.
* `open_field`: the open-space field by the trapezoid rule on a bent contour that passes below the poles and the branch point on
  the right and above those on the left.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
from accuracy_study.reference import many_digits
from accuracy_study.reference.medium import Medium
from accuracy_study.reference.quadrature import field_sum


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


def bent_contour(k0, bend=3.0, band=220.0, count=3001):
    """The right half of kx = s - i bend tanh(2 s/k0), below the axis, and its weights dkx/ds ds: the trapezoid rule from 0."""
    s = np.linspace(0, band, count)
    slope = 1 - 1j * bend * (2 / k0) / np.cosh(np.minimum(2 * s / k0, 300)) ** 2
    weight = slope * (s[1] - s[0])
    weight[0] /= 2
    return s - 1j * bend * np.tanh(2 * s / k0), weight


def air_beam(spectrum, k0, x, distances):
    """p(distance, x) of a beam that meets nothing: S(kx) exp(i kz distance), on the bent contour."""
    kx, weight = bent_contour(k0, bend=2.0)

    def propagated(k):
        return np.exp(1j * np.multiply.outer(np.asarray(distances), np.sqrt(k0**2 - k**2)))

    return field_sum(lambda k, kz: spectrum(k), propagated, kx, weight, None, np.asarray(x))


def open_field(slab, frequency, spectrum, z0, x, z, **contour):
    """p(z, x) in open space: the trapezoid rule on the bent contour, with the accuracy study's cascade of scattering matrices.

    spectrum: S(kx) of the pressure on the launch plane z0; contour: bend, band and count of `bent_contour`.
    """
    medium = Medium(slab, frequency)
    kx, weight = bent_contour(medium.k0, **contour)

    def response(k):
        return medium.response(k, np.asarray(z), z0)

    return field_sum(lambda k, kz: spectrum(k), response, kx, weight, None, np.asarray(x))
