"""The limits: what others, or the machine itself, need for the work or for its unavoidable part."""

from __future__ import annotations

import os
import subprocess
from typing import Any

import numpy as np
from timing import Work

import beamprop as bp


def inverse_fft(rows: int, n: int) -> Work:
    """One batched in-place complex128 inverse FFT, planned with FFTW_MEASURE, one thread."""
    import pyfftw

    a = pyfftw.zeros_aligned((rows, n), dtype="complex128")
    plan = pyfftw.FFTW(a, a, axes=(1,), direction="FFTW_BACKWARD", flags=("FFTW_MEASURE",), threads=1)
    rng = np.random.default_rng(0)
    a[...] = rng.normal(size=a.shape)
    return plan.execute


def layer_product(slab: bp.Slab, frequency: float, kx_over_k0: np.ndarray) -> np.ndarray:
    """t by the product of all layers' matrices, vectorised over kx: what plain NumPy does."""
    omega = 2 * np.pi * frequency
    k0 = slab.before.wavenumber(frequency).real
    kx = k0 * kx_over_k0 + 0j
    a, b = np.ones_like(kx), np.zeros_like(kx)
    c, d = np.zeros_like(kx), np.ones_like(kx)
    for cell, periods in slab.segments:
        for layer in cell.layers * periods:
            rho, K = layer.fluid.density, layer.fluid.bulk_modulus
            kz = np.sqrt(rho * omega**2 / K - kx**2)
            cos, sin = np.cos(kz * layer.thickness), np.sin(kz * layer.thickness)
            up, down = rho * sin / kz, -kz * sin / rho
            a, b, c, d = cos * a + up * c, cos * b + up * d, down * a + cos * c, down * b + cos * d
    y = 1j * np.sqrt(k0**2 - kx**2) / slab.before.density
    return 2 * y / (y * (a + d) - c - y * y * b)


#: Run by a Python that has navette: prints the median time [s] and |t|^2 of the slab at normal incidence.
NAVETTE = """
import sys, time, numpy as np
from navette.smatrix.smatrix import ScatterMatrix
data = np.load(sys.argv[1])
n = np.sqrt(data["density"] + 0j)
angles = np.degrees(np.arcsin(data["sine"]))
times = []
for _ in range(int(sys.argv[2]) + 1):
    start = time.perf_counter()
    m = ScatterMatrix(n, data["thickness"] * 1e9, wavelengths=[data["wavelength"] * 1e9], angles=angles)
    found = m.reflectance_transmittance("p")
    times.append(time.perf_counter() - start)
print(np.median(times[1:]), np.ravel(found[[k for k in found if k.startswith("T")][0]])[0])
"""


def navette(
    python: str, slab: bp.Slab, frequency: float, sine: np.ndarray, folder: Any, repeats: int, threads: int = 1
) -> tuple[float, float]:
    """Time and transmittance of navette on the same slab: p-polarised light, n^2 the relative density."""
    background = complex(slab.before.density)
    layers = [layer for cell, periods in slab.segments for layer in cell.layers * periods]
    path = folder / "navette.npz"
    np.savez(
        path,
        density=np.array([1, *(layer.fluid.density / background for layer in layers), 1]),
        thickness=np.array([0, *(layer.thickness for layer in layers), 0]),
        wavelength=2 * np.pi / float(slab.before.wavenumber(frequency).real),
        sine=sine,
    )
    out = subprocess.run(
        [python, "-c", NAVETTE, str(path), str(repeats)],
        check=True,
        capture_output=True,
        text=True,
        env=os.environ | {"RAYON_NUM_THREADS": str(threads)},
    ).stdout
    seconds, transmittance = (float(v) for v in out.split())
    return seconds, transmittance
