"""k-Wave's solver for CPUs on benchmark 4 of the transcranial intercomparison, beside the field of this package in the same run.

    python experiments/benchmarks/transcranial_peer.py [--spacing 0.5] [--axial 64] [--lateral 36]

prints the time of each, and how far k-Wave lies from the exact field of the piston behind the layers. It needs
``pip install k-wave-python==0.6.2``, which fetches binaries when it is first imported; they are not used here. The box is the
smallest that holds 60 mm of the axis, with the intercomparison's spacing of 0.5 mm, 6 points per wavelength in water; its whole
domain of 120 x 70 x 70 mm has six times as many nodes. Layers and source are those of the intercomparison: nodes in (start, end]
belong to a layer, and the piston is a band-limited disc of mass sources, which radiates 60 kPa.
"""

from __future__ import annotations

import argparse
import functools
import sys
import time
from pathlib import Path

import numpy as np
import scipy.fft

sys.path.insert(0, str(Path(__file__).parents[1] / "gallery"))

import transcranial as benchmark

import beamprop as bp

#: Nodes of the absorbing layers on each side; steps of time in a period; periods, of the ramp, of the way, and of echoes in the layers.
PML, STEPS, PERIODS = 10, 40, 36
NAME, SOURCE = "BM4", "piston"


def k_wave() -> object:
    """Its modules, or what to install."""
    try:
        from kwave import data, kgrid, kmedium, ksensor, ksource, kspaceFirstOrder  # noqa: F401
        from kwave.utils import kwave_array, signals  # noqa: F401
    except ImportError:
        sys.exit("k-Wave is not installed: pip install k-wave-python==0.6.2")
    return sys.modules["kwave"]


def nodes_of(size: float, spacing: float) -> int:
    """The number of nodes, so that with the absorbing layers transforms are quick."""
    return scipy.fft.next_fast_len(round(size / spacing) + 1 + 2 * PML) - 2 * PML


def grid_of(kwave: object, spacing: float, sizes: tuple[float, float]) -> object:
    """x along the axis, the piston's plane at its first node."""
    nx, ny = (nodes_of(size, spacing) for size in sizes)
    grid = kwave.kgrid.kWaveGrid(kwave.data.Vector([nx, ny, ny]), kwave.data.Vector([spacing] * 3))
    grid.setTime(STEPS * PERIODS, 1 / (STEPS * benchmark.FREQUENCY))
    return grid


def medium_of(kwave: object, grid: object) -> object:
    """Speeds, densities and attenuations by nodes.

    Attenuation grows as f^2, with which k-Wave needs no more transforms, and 40 steps in a period to be stable.
    """
    values = np.empty((3, grid.Nx))
    values[:] = np.array(benchmark.TISSUES["water"])[:, None]
    depth = np.arange(grid.Nx) * grid.dx
    start = benchmark.START[NAME]
    for tissue, thickness in (*benchmark.LAYERS[NAME], ("brain", np.inf)):
        inside = (depth > start + 1e-9) & (depth <= start + thickness + 1e-9)
        values[:, inside] = np.array(benchmark.TISSUES[tissue])[:, None]
        start += thickness
    density, speed, loss = (np.broadcast_to(v[:, None, None], (grid.Nx, grid.Ny, grid.Nz)).copy() for v in values)
    alpha = loss / (benchmark.FREQUENCY / 1e6) ** 2
    return kwave.kmedium.kWaveMedium(sound_speed=speed, density=density, alpha_coeff=alpha, alpha_power=2.0)


def source_of(kwave: object, grid: object) -> object:
    """The disc by its band-limited weights, all in phase."""
    disc = kwave.utils.kwave_array.kWaveArray(bli_tolerance=0.01, upsampling_rate=16)
    at = float(np.ravel(grid.x_vec)[0])
    disc.add_disc_element([at, 0.0, 0.0], 2 * benchmark.RADIUS, [at + 1.0, 0.0, 0.0])
    weights = disc.get_array_grid_weights(grid)
    signal = kwave.utils.signals.create_cw_signals(
        np.ravel(grid.t_array), benchmark.FREQUENCY, np.array([benchmark.PRESSURE]), np.array([0.0])
    )
    source = kwave.ksource.kSource()
    source.p_mask = weights != 0
    source.p = weights[source.p_mask][:, None] * np.ravel(signal)[None, :]
    return source


def amplitudes(
    kwave: object, spacing: float, sizes: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Depths, lateral positions, |p| on the cut through the axis by the last period, and seconds."""
    # SciPy's transforms on two threads take half the time of those that it calls
    np.fft.fftn, np.fft.ifftn = (functools.partial(f, workers=2) for f in (scipy.fft.fftn, scipy.fft.ifftn))
    start = time.perf_counter()
    grid = grid_of(kwave, spacing, sizes)
    sensor = kwave.ksensor.kSensor()
    sensor.mask = np.zeros((grid.Nx, grid.Ny, grid.Nz), bool)
    sensor.mask[:, :, grid.Nz // 2] = True
    sensor.record, sensor.record_start_index = ["p"], STEPS * (PERIODS - 1) + 1
    p = kwave.kspaceFirstOrder.kspaceFirstOrder(
        grid, medium_of(kwave, grid), source_of(kwave, grid), sensor, pml_size=PML, dtype=np.float32, quiet=False
    )["p"]
    turns = np.exp(2j * np.pi * np.arange(STEPS) / STEPS)
    size = np.abs(p @ turns).reshape(grid.Nx, grid.Ny) * 2 / STEPS
    return np.arange(grid.Nx) * spacing, np.ravel(grid.y_vec), size, time.perf_counter() - start


def main() -> None:
    """Both, and what lies between them."""
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    for name, value in (("spacing", 0.5), ("axial", 64.0), ("lateral", 36.0)):
        parser.add_argument(f"--{name}", type=float, default=value, help="[mm]")
    options = parser.parse_args()
    sizes = 1e-3 * options.axial, 1e-3 * options.lateral
    depth, x, theirs, seconds = amplitudes(k_wave(), 1e-3 * options.spacing, sizes)
    slab, source = benchmark.problem(NAME, SOURCE)
    behind = depth > benchmark.START[NAME] + slab.thickness + 1e-9
    start = time.perf_counter()
    field = bp.field(slab, source, benchmark.FREQUENCY, x, depth[behind] + source.z0, y=0.0)
    ours_seconds = time.perf_counter() - start
    ours, theirs = np.abs(field.p.values), theirs[behind]
    on_axis, at = np.argmin(np.abs(x)), np.argmin(np.abs(depth[behind] - benchmark.PROFILE))
    print(
        f"grid {depth.size} x {x.size} x {x.size}, {STEPS * PERIODS} steps: k-Wave {seconds:.0f} s, this package {ours_seconds:.2f} s"
    )
    for where, a, b in (("cut", theirs, ours), ("axis", theirs[:, on_axis], ours[:, on_axis])):
        print(f"L2 on the {where} behind the layers: {100 * np.linalg.norm(a - b) / np.linalg.norm(b):.2f} %")
    print(
        f"|p| at {1e3 * benchmark.PROFILE:g} mm: {theirs[at, on_axis] / 1e3:.3f} kPa, exact {ours[at, on_axis] / 1e3:.3f} kPa"
    )


if __name__ == "__main__":
    main()
