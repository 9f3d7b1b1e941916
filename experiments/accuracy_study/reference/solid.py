"""The response of solids in contact between fluids, by a global matrix: the amplitudes of all waves, from conditions at all faces.

Of each solid the potentials phi = A exp(i a z) + B exp(i a (d - z)), psi alike with b, and u_x = i k phi - psi', u_z = phi' + i k psi. (Knopoff,
Bull. Seismol. Soc. Am. 54, 431 (1964).) Lengths are over 1/k0, densities over that of the fluid in front, and times over 1/omega.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import beamprop as bp

from .medium import Medium


class SolidMedium(Medium):
    """Solids between fluids, whose p is known in the fluids."""

    def __init__(self, slab: bp.Slab, frequency: float) -> None:
        super().__init__(bp.Slab.uniform(slab.before, slab.thickness, before=slab.before, after=slab.after), frequency)
        self.thickness, f = slab.thickness, np.array([frequency])
        layers: list[Any] = [layer for cell, _ in slab.segments for layer in cell.layers]
        self.solids = []
        for layer in layers:
            rho, longitudinal, shear = (complex(v[0]) for v in layer.fluid.at(f))
            k_l, k_t = (self.omega * np.sqrt(rho / modulus) for modulus in (longitudinal, shear))
            self.solids.append((rho, k_l, k_t, layer.thickness))

    def _waves(self, solid: tuple, k: np.ndarray, far: bool) -> np.ndarray:
        """(u_x, u_z, s_zz, s_xz) at a face of unit amplitudes of four waves: (n, 4, 4)."""
        rho, k_l, k_t, d = solid
        rho, d = rho / self.before[0], d * self.k0
        q, k_l, k_t = k / self.k0, k_l / self.k0, k_t / self.k0
        a, b = (np.sqrt(v * v - q * q + 0j) for v in (k_l, k_t))
        a, b = (np.where(v.imag < 0, -v, v) for v in (a, b))
        mu = rho / k_t**2
        lam = rho / k_l**2 - 2 * mu
        out = np.empty((k.size, 4, 4), complex)
        for column, (root, sign) in enumerate(((a, 1), (a, -1), (b, 1), (b, -1))):
            size = np.exp(1j * root * d) if (sign > 0) == far else 1.0
            slope = 1j * sign * root
            if column < 2:
                rows = (1j * q, slope, -lam * k_l**2 + 2 * mu * slope**2, 2j * mu * q * slope)
            else:
                rows = (-slope, 1j * q, 2j * mu * q * slope, mu * (root**2 - q * q))
            for i, row in enumerate(rows):
                out[:, i, column] = row * size
        return out

    def r_and_t(self, k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of p at the two faces, (n,) each."""
        n, size = len(self.solids), 4 * len(self.solids) + 2
        m, rhs = np.zeros((k.size, size, size), complex), np.zeros((k.size, size), complex)
        ahead = 1j * self.kz(self.before, k) / self.k0
        behind = 1j * self.kz(self.after, k) / self.k0 * (self.before[0] / self.after[0])
        near, far = (self._waves(self.solids[i], k, end) for i, end in ((0, False), (-1, True)))
        # p = -s_zz, u_z, and s_xz = 0 at the first face; then at the last
        for row, waves, column, fluid in ((0, near, 0, -ahead), (size - 3, far, size - 1, behind)):
            at = slice(1, 5) if row == 0 else slice(size - 5, size - 1)
            m[:, row, at], m[:, row + 1, at], m[:, row + 2, at] = waves[:, 2], waves[:, 1], waves[:, 3]
            m[:, row, column], m[:, row + 1, column] = 1.0, -fluid
        rhs[:, 0], rhs[:, 1] = -1.0, ahead
        for i in range(n - 1):
            rows = slice(3 + 4 * i, 7 + 4 * i)
            m[:, rows, 1 + 4 * i : 5 + 4 * i] = self._waves(self.solids[i], k, True)
            m[:, rows, 5 + 4 * i : 9 + 4 * i] = -self._waves(self.solids[i + 1], k, False)
        solved = np.linalg.solve(m, rhs[:, :, None])[:, :, 0]
        return solved[:, 0], solved[:, -1]

    def response(self, k: np.ndarray, z: np.ndarray, z0: float, velocity: bool = False) -> np.ndarray:
        """What a unit plane wave on z = z0 has become at z in the fluids: (Z, n)."""
        r, t = self.r_and_t(k)
        kz1, kz2 = self.kz(self.before, k), self.kz(self.after, k)
        rows = []
        for depth in z:
            if 0 < depth < self.thickness:
                raise ValueError(f"z: expected depths in the fluids, got {depth:g}")
            if depth <= 0:
                rows.append(np.exp(1j * kz1 * (depth - z0)) + r * np.exp(-1j * kz1 * (depth + z0)))
            else:
                rows.append(t * np.exp(1j * (kz2 * (depth - self.thickness) - kz1 * z0)))
        return np.array(rows)
