"""The conventions, in one place: signs, units, and the one square root with a branch.

* Time dependence ``exp(-i w t)``. A passive fluid has ``Im(density) >= 0`` and ``Im(bulk_modulus) <= 0``;
  an outgoing wave along +z is ``exp(+i kz z)`` with ``Im(kz) >= 0``.
* SI units: m, Hz, kg/m3, Pa. Angles in degrees from the slab's normal z; x is the lateral coordinate;
  z = 0 is the near face of the slab and +z points into it.
* ``S(kx) = integral p(x) exp(-i kx x) dx`` and ``p(x) = (1/2 pi) integral S(kx) exp(+i kx x) dkx``.
* The state in a layer is ``(p, q)`` with ``q = (1/rho_z) dp/dz = i w v_z``: both are continuous at a face.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def principal_root(w: np.ndarray) -> np.ndarray:
    """Square root of complex w with Re >= 0, by real roots: np.sqrt with three times its speed, to two roundings."""
    # plain: np.sqrt(w). With t = sqrt((|w| + |Re w|)/2) the parts of the root are t and |Im w|/2t, in the order of |parts of w|
    if w.size < 500:  # the number of statements counts
        return np.sqrt(w)
    t = np.sqrt(0.5 * (np.abs(w) + np.abs(w.real)))
    other = w.imag / np.maximum(2 * t, 1e-300)
    left = w.real < 0
    out = np.empty(w.shape, complex)
    out.real = np.where(left, np.abs(other), t)
    out.imag = np.where(left, np.copysign(t, w.imag), other)
    return out


def branch_wavenumber(omega: Any, rho_x: Any, bulk_modulus: Any) -> np.ndarray:
    """The kx at which a half-space's kz vanishes, w sqrt(rho_x / K), with Im >= 0.

    For an isotropic fluid this is its wavenumber. Where it is real, the sign is the one that a little
    loss would give: negative where density and bulk modulus both are (backward waves).

    Parameters
    ----------
    omega : array of float, rad/s
    rho_x, bulk_modulus : complex, or arrays like omega; kg/m3, Pa

    Returns
    -------
    array of complex, rad/m; infinite for rho_x = inf.
    """
    omega = np.asarray(omega, dtype=float)
    rho_x = np.asarray(rho_x, dtype=complex)
    bulk_modulus = np.asarray(bulk_modulus, dtype=complex)
    if not np.isfinite(rho_x).all():
        return np.full(np.broadcast_shapes(omega.shape, rho_x.shape), np.inf + 0j)
    k = omega * np.sqrt(rho_x / bulk_modulus)
    if (k.imag < 0).any():
        k = np.where(k.imag < 0, -k, k)
    if not (rho_x.real < 0).any():
        return k
    backward = (k.imag == 0) & (rho_x.real < 0)
    return np.where(backward, -np.abs(k.real) + 0j, k)


def outgoing_kz(kx: Any, omega: Any, rho_z: Any, rho_x: Any, bulk_modulus: Any) -> np.ndarray:
    """Wavenumber along z of the outgoing wave of a half-space: the only square root with a branch.

    ``kz = sqrt(rho_z (w^2/K - kx^2/rho_x))``. On the real axis it is the root that decays or carries energy
    along +z. Off the axis it is continued so that the cuts leave the axis upward at +k0 and downward
    at -k0: what an arbitrarily small loss does (limiting absorption).

    Parameters
    ----------
    kx : array of float or complex, rad/m
    omega, rho_z, rho_x, bulk_modulus : numbers or arrays that broadcast with kx

    Returns
    -------
    array of complex, rad/m
    """
    kx = np.asarray(kx, dtype=complex)
    rho_z = np.asarray(rho_z, dtype=complex)
    b = branch_wavenumber(omega, rho_x, bulk_modulus)
    at_normal = _outgoing_sign(np.sqrt(rho_z / np.asarray(bulk_modulus, dtype=complex)) * omega, rho_z)
    if not np.isfinite(b).all():
        return at_normal + 0 * kx
    return at_normal / b * _root_of_product(kx, b)


def _root_of_product(kx: np.ndarray, b: np.ndarray) -> np.ndarray:
    """sqrt(b - kx) sqrt(b + kx), cuts upward from b and downward from -b; exactly real or imaginary where it should be."""
    # plain: root(b - kx) root(b + kx), root(w) = e^{i pi/4} sqrt(-i w) being cut along -i.
    # It is i sqrt(kx^2 - b^2) but for a sign: the plain form's two angles add up to beyond a half turn, where the principal
    # root turns back, only if both factors lie on the same side, |Re kx| < |Re b|. kz and b then go the same way.
    root = np.asarray(kx - b)
    root *= kx + b
    root = np.asarray(principal_root(root))
    turned = (np.abs(kx.real) < np.abs(b.real)) & (root.imag * b.real > 0)
    np.negative(root, out=root, where=turned)
    root *= 1j
    return root


def _outgoing_sign(kz: np.ndarray, rho_z: np.ndarray) -> np.ndarray:
    """+-kz, whichever decays along +z or, where it does neither, carries energy along +z."""
    lossless = kz.imag == 0
    outward = np.where(lossless, (kz / rho_z).real >= 0, kz.imag > 0) if lossless.any() else kz.imag > 0
    return kz if outward.all() else np.where(outward, kz, -kz)
