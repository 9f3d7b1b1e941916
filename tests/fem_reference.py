"""The exact field of an x-periodic array of beams, order by order, for the finite-element tests: slow and
obvious.

Shares nothing with the package but the records that describe a slab and a beam. Time dependence exp(-i w t).
In a layer, ``p'' = -kz^2 p`` with ``kz^2 = rho_z (w^2/K - kx^2/rho_x)`` and ``q = p'/rho_z``. Each order
starts as the outgoing wave behind the slab and is carried back layer by layer, in extended precision, with
its growth kept apart; what it must have been in front fixes its amplitude.
"""

import numpy as np


def _half_space_kz(fluid, frequency, kx):
    """Root of kz^2 that decays along +z, or carries energy that way (no order may sit at kz = 0)."""
    rho_z, rho_x, K = (np.clongdouble(complex(v)) for v in fluid.at(frequency))
    omega = 2 * np.longdouble(np.pi) * frequency
    kz = np.sqrt(rho_z * (omega**2 / K - kx.astype(np.longdouble) ** 2 / rho_x))
    wrong = np.where(np.abs(kz.imag) > 1e-15 * np.abs(kz), kz.imag < 0, (kz / rho_z).real < 0)
    return np.where(wrong, -kz, kz), rho_z


def _elements(slab):
    """Every layer and membrane from the near face on."""
    return [layer for cell, periods in slab.segments for _ in range(periods) for layer in cell.layers]


def _back(layer, frequency, kx, depth, p, q):
    """The state `depth` in front of a state, inside a layer."""
    rho_z, rho_x, K = (np.clongdouble(complex(v)) for v in layer.fluid.at(frequency))
    inverse_rho_x = 1 / rho_x if np.isfinite(rho_x) else 0
    omega = 2 * np.longdouble(np.pi) * frequency
    kz = np.sqrt(rho_z * (omega**2 / K - kx.astype(np.longdouble) ** 2 * inverse_rho_x))
    kz = np.where(kz == 0, 1e-12, kz)
    c, s = np.cos(kz * depth), np.sin(kz * depth)
    return c * p - rho_z / kz * s * q, kz / rho_z * s * p + c * q


def periodic_field(slab, beam, frequency, x, z, period, count):
    """p(z, x), total pressure, from the orders |m| <= count; z in front (from z0 on), inside and behind."""
    kx = 2 * np.pi / period * np.arange(-count, count + 1)
    k0 = float(slab.before.wavenumber(frequency).real)
    kz0, rho0 = _half_space_kz(slab.before, frequency, kx)
    kz1, rho1 = _half_space_kz(slab.after, frequency, kx)
    launched = beam.spectrum(kx, k0) / period
    incident = launched * np.exp(-1j * kz0 * beam.z0)

    z = np.asarray(z, dtype=float)
    states = np.zeros((z.size, kx.size), dtype=np.clongdouble)
    logs = np.zeros((z.size, kx.size), dtype=np.longdouble)
    p, q = np.ones(kx.size, dtype=np.clongdouble), 1j * kz1 / rho1
    log = np.zeros(kx.size, dtype=np.longdouble)
    far = slab.thickness
    for layer in reversed(_elements(slab)):
        if not hasattr(layer, "fluid"):
            p = p - np.clongdouble(complex(layer.at(np.array([frequency]))[0])) * q
            continue
        near = far - layer.thickness
        for i in np.flatnonzero((z > 0) & (z < slab.thickness) & (z < far) & (z >= near)):
            states[i], logs[i] = _back(layer, frequency, kx, far - z[i], p, q)[0], log
        p, q = _back(layer, frequency, kx, layer.thickness, p, q)
        size = np.abs(p) + np.abs(q)
        p, q, log, far = p / size, q / size, log + np.log(size), near
    forward = (p + rho0 * q / (1j * kz0)) / 2
    reflected = incident * (p / forward - 1)
    for i in range(z.size):
        if z[i] <= 0:
            states[i] = launched * np.exp(1j * kz0 * (z[i] - beam.z0)) + reflected * np.exp(-1j * kz0 * z[i])
        elif z[i] >= slab.thickness:
            states[i] = incident / forward * np.exp(1j * kz1 * (z[i] - slab.thickness) - log)
        else:
            states[i] = incident / forward * states[i] * np.exp(logs[i] - log)
    return states.astype(complex) @ np.exp(1j * np.multiply.outer(kx, np.asarray(x, dtype=float)))


def relative_error(p, exact):
    """Relative L2 difference."""
    return float(np.linalg.norm(p - exact) / np.linalg.norm(exact))
