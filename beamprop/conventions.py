"""The conventions, in one place: signs, units, and the one square root with a branch.

* Time dependence ``exp(-i w t)``. A passive fluid has ``Im(density) >= 0`` and ``Im(bulk_modulus) <= 0``;
  an outgoing wave along +z is ``exp(+i kz z)`` with ``Im(kz) >= 0``.
* SI units: m, Hz, kg/m3, Pa. Angles in degrees from the slab's normal z; x is the lateral coordinate;
  z = 0 is the near face of the slab and +z points into it.
* ``S(kx) = integral p(x) exp(-i kx x) dx`` and ``p(x) = (1/2 pi) integral S(kx) exp(+i kx x) dkx``.
* Kernels take complex frequencies too, ``exp(-i w t)`` with w anywhere in Re w > 0: what they answer is the analytic
  continuation from the real axis. Public questions take real frequencies.
* The state in a layer is ``(p, q)`` with ``q = (1/rho_z) dp/dz = i w v_z``: both are continuous at a face.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def branch_wavenumber(omega: Any, rho_x: Any, bulk_modulus: Any) -> np.ndarray:
    """The kx at which a half-space's kz vanishes, w sqrt(rho_x / K), with Im >= 0 at real frequencies.

    For an isotropic fluid this is its wavenumber. Where it is real, the sign is the one that a little
    loss would give: negative where density and bulk modulus both are (backward waves). At complex frequencies it is the
    analytic continuation of a passive fluid's: see `_continued_wavenumber`.

    Parameters
    ----------
    omega : array of float or complex, rad/s
    rho_x, bulk_modulus : complex, or arrays like omega; kg/m3, Pa

    Returns
    -------
    array of complex, rad/m; infinite for rho_x = inf.
    """
    omega = real_or_complex(omega)
    rho_x = np.asarray(rho_x, dtype=complex)
    bulk_modulus = np.asarray(bulk_modulus, dtype=complex)
    if not np.isfinite(rho_x).all():
        return np.full(np.broadcast_shapes(omega.shape, rho_x.shape), np.inf + 0j)
    if np.iscomplexobj(omega):
        return _continued_wavenumber(omega, rho_x, bulk_modulus)
    k = omega * np.sqrt(rho_x / bulk_modulus)
    if (k.imag < 0).any():
        k = np.where(k.imag < 0, -k, k)
    if not (rho_x.real < 0).any():
        return k
    backward = (k.imag == 0) & (rho_x.real < 0)
    return np.where(backward, -np.abs(k.real) + 0j, k)


def real_or_complex(values: Any) -> np.ndarray:
    """An array of complex where `values` are complex, of float otherwise: no imaginary part is dropped."""
    values = np.asarray(values)
    return values.astype(complex if np.iscomplexobj(values) else float, copy=False)


def _continued_wavenumber(omega: np.ndarray, rho: np.ndarray, bulk_modulus: np.ndarray) -> np.ndarray:
    """w sqrt(rho/K) of a passive fluid for complex w: the continuation of the root with Im >= 0 from real w > 0.

    Passive means that w rho and w/K lie in the upper half-plane for Im w >= 0, and so have roots in the first quadrant, whose
    product is k. Each root is cut along -i, which neither meets from a fluid without dispersion while Re w > 0.
    """
    return _root_cut_downward(omega * rho) * _root_cut_downward(omega / bulk_modulus)


def _root_cut_downward(w: np.ndarray) -> np.ndarray:
    """Square root whose cut is the negative imaginary axis."""
    return np.exp(0.25j * np.pi) * np.sqrt(-1j * w)


def outgoing_kz(kx: Any, omega: Any, rho_z: Any, rho_x: Any, bulk_modulus: Any) -> np.ndarray:
    """Wavenumber along z of the outgoing wave of a half-space: the only square root with a branch.

    ``kz = sqrt(rho_z (w^2/K - kx^2/rho_x))``. On the real axis it is the root that decays or carries energy
    along +z. Off the axis it is continued so that the cuts leave the axis upward at +k0 and downward
    at -k0: what an arbitrarily small loss does (limiting absorption). At complex frequencies it is continued analytically
    in w, too; the cuts in kx begin at the complex +-k0(w) and keep their directions.

    Parameters
    ----------
    kx : array of float or complex, rad/m
    omega : float or complex, or an array that broadcasts with kx; rad/s
    rho_z, rho_x, bulk_modulus : numbers or arrays that broadcast with kx; kg/m3, Pa

    Returns
    -------
    array of complex, rad/m
    """
    kx = np.asarray(kx, dtype=complex)
    rho_z = np.asarray(rho_z, dtype=complex)
    b = branch_wavenumber(omega, rho_x, bulk_modulus)
    bulk_modulus, omega = np.asarray(bulk_modulus, dtype=complex), real_or_complex(omega)
    if np.iscomplexobj(omega):
        at_normal = _continued_wavenumber(omega, rho_z, bulk_modulus)
    else:
        at_normal = _outgoing_sign(np.sqrt(rho_z / bulk_modulus) * omega, rho_z)
    if not np.isfinite(b).all():
        return at_normal + 0 * kx
    return at_normal / b * _root_of_product(kx, b)


def _root_of_product(kx: np.ndarray, b: np.ndarray) -> np.ndarray:
    """sqrt(b - kx) sqrt(b + kx), cuts upward from b and downward from -b; exactly real or imaginary where it should be."""
    # `response.reference.root_of_product` takes two roots, root(w) = e^{i pi/4} sqrt(-i w) being cut along -i. Their product is
    # i sqrt(kx^2 - b^2) but for a sign: the two angles add up to more than half a turn, where the principal root changes sign,
    # only if both factors lie on the same side, |Re kx| < |Re b|. Re kz and Re b then have the same sign.
    root = np.asarray(kx - b)
    root *= kx + b
    np.sqrt(root, out=root)
    turned = (np.abs(kx.real) < np.abs(b.real)) & (root.imag * b.real > 0)
    np.negative(root, out=root, where=turned)
    root *= 1j
    return root


def _outgoing_sign(kz: np.ndarray, rho_z: np.ndarray) -> np.ndarray:
    """+-kz, whichever decays along +z or, where it does neither, carries energy along +z."""
    lossless = kz.imag == 0
    outward = np.where(lossless, (kz / rho_z).real >= 0, kz.imag > 0) if lossless.any() else kz.imag > 0
    return kz if outward.all() else np.where(outward, kz, -kz)
