"""How near the machine's limits beamprop comes: a table of ratios, each measured in one run, and pictures of how time scales."""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tracemalloc
from pathlib import Path

import _one_thread  # noqa: F401
import limits
import numpy as np
import scaling
from timing import Row, measure, process, table
from tqdm import tqdm

import beamprop as bp
from beamprop import response
from beamprop.contour import paths, stationary_phase
from beamprop.profiles import many_frequencies, routes
from beamprop.response import sampled_slab

FREQUENCY = 2500.0
WAVELENGTH = 343.0 / FREQUENCY
SLAB = bp.Slab(bp.lmmd_cell(), 450)
BEAM = bp.GaussianBeam(0.096)


def grids(rows: int = 1000, points: int = 1024) -> tuple[np.ndarray, np.ndarray]:
    """x over 20 wavelengths, z through the slab."""
    x = 10 * WAVELENGTH * np.linspace(-1, 1, points, endpoint=False)
    return x, np.linspace(0, SLAB.thickness, rows)


def field_map(options: argparse.Namespace) -> list[Row]:
    """(a) a field map against one FFT of its size."""
    x, z = grids()
    beam = BEAM.at_angle(45.0)
    ours, limit = measure(
        lambda: bp.field(SLAB, beam, FREQUENCY, x, z), limits.inverse_fft(1000, 1024), repeats=options.repeats
    )
    return [Row("`field`, 45°, 1000 z × 1024 x", ours, "one FFT of that size", limit, "≤ 6", ours <= 6 * limit)]


def plane_waves(options: argparse.Namespace) -> list[Row]:
    """(b) 1000 plane waves against the product of 4500 layers, and against navette."""
    sine = np.linspace(0, 0.999, 1000)
    ours, limit = measure(
        lambda: bp.scattering(SLAB, FREQUENCY, kx_over_k0=sine, estimate=False),
        lambda: limits.layer_product(SLAB, FREQUENCY, sine),
        repeats=max(3, options.repeats // 3),
    )
    ds = bp.scattering(SLAB, FREQUENCY, kx_over_k0=sine)
    assert np.allclose(ds.t, limits.layer_product(SLAB, FREQUENCY, sine), rtol=1e-8)
    name = "`scattering` without its estimate, 450 periods, 1000 kx"
    rows = [Row(name, ours, "4500 layers in NumPy", limit, "≤ 1/50", 50 * ours <= limit)]
    python = options.navette or sys.executable
    try:
        alone, both = (limits.navette(python, SLAB, FREQUENCY, sine, options.output, 3, threads) for threads in (1, 2))
    except subprocess.CalledProcessError:
        print("navette 0.8.0 is not installed here (it needs Python 3.12): rows skipped", file=sys.stderr)
        return rows
    assert all(abs(share - float(ds.transmissivity[0])) < 1e-9 for _, share in (alone, both))
    # as navette in its process: again and again
    (ours,) = measure(
        lambda: bp.scattering(SLAB, FREQUENCY, kx_over_k0=sine, estimate=False), repeats=20 * options.repeats
    )
    return [
        *rows,
        Row(name, ours, "navette 0.8.0, one thread", alone[0], "≤ 1/500", 500 * ours <= alone[0]),
        Row(name, ours, "navette 0.8.0, two threads", both[0], "-", None),
    ]


def widths(options: argparse.Namespace) -> list[Row]:
    """(c) a table of widths: in itself, and against the responses at the beam's own modes."""
    frequency = np.linspace(2000, 3000, 101)
    kernels = [_own_modes(f) for f in frequency]

    def responses() -> None:
        for s, kx in kernels:
            response.solve(s.segments, s.before, s.after, s.omega, kx[None])

    ours, limit = measure(lambda: bp.beam_width(SLAB, BEAM, frequency), responses, repeats=options.repeats)
    name = "`beam_width`, 101 frequencies"
    return [
        Row(name, ours, "itself", 0.060, "≤ 60 ms", ours <= 0.060),
        Row(name, ours, "101 responses at the beam's modes", limit, "≤ 3", ours <= 3 * limit),
    ]


def _own_modes(frequency: float) -> tuple[sampled_slab.SampledSlab, np.ndarray]:
    """A slab at a frequency, and the contour that `beam_width` takes for it."""
    batch = sampled_slab.sample_all(SLAB, np.array([frequency]))
    path = np.array([SLAB.thickness])
    rows = many_frequencies._Rows(batch.k0, batch.nearest_branch, path, routes.far_face(batch, BEAM.z0), guided=True)
    plan = many_frequencies._plan(rows, BEAM, *stationary_phase.landing(rows.k0, BEAM, rows.plane, path), 1e-8)
    return sampled_slab.sample(SLAB, frequency), paths.straight_contour(plan).k[0]


def angles(options: argparse.Namespace) -> list[Row]:
    """(d) many angles at one plane against as many FFTs."""
    count = 100 if options.quick else 1000
    x, _ = grids()
    angle = np.linspace(-80, 80, count)
    ours, limit = measure(
        lambda: bp.field(SLAB, BEAM, FREQUENCY, x, SLAB.thickness, angle=angle),
        limits.inverse_fft(count, 1024),
        repeats=max(1, options.repeats // 3),
    )
    return [Row(f"{count} angles, exit plane, 1024 x", ours, f"{count} FFTs", limit, "≤ 4", ours <= 4 * limit)]


def aperiodic() -> bp.Slab:
    """4500 different layers."""
    rng = np.random.default_rng(0)
    layers = [
        bp.Layer(bp.Fluid(layer.fluid.density * (1 + 0.1 * rng.random()), layer.fluid.bulk_modulus), layer.thickness)
        for _ in range(450)
        for layer in SLAB.cell.layers
    ]
    return bp.Slab(bp.Cell(tuple(layers)))


def many_layers(options: argparse.Namespace) -> list[Row]:
    """(e) 4500 different layers, 400 modes, the field at 1000 depths."""
    s = sampled_slab.sample(aperiodic(), FREQUENCY)
    kx = np.linspace(0, 60, 400)[None] - 1j
    _, z = grids()
    (ours,) = measure(
        lambda: response.solve(s.segments, s.before, s.after, s.omega, kx, z), repeats=max(3, options.repeats // 2)
    )
    each = ours / (4500 * 400)
    return [
        Row(
            "4500 different layers, 400 modes, field at 1000 z; per layer and mode",
            each,
            "itself",
            150e-9,
            "≤ 150 ns",
            each <= 150e-9,
        )
    ]


def starts(options: argparse.Namespace) -> list[Row]:
    """(f), (g) cold processes."""
    bare = "-c", "pass"
    repeats = max(3, options.repeats // 2)
    imports = "import numpy, xarray, pyfftw, matplotlib; matplotlib.use('agg'); import matplotlib.pyplot"
    width = ("width", "--output", str(options.output / "w.nc"), "--plot", str(options.output / "w.png"))
    command = "from beamprop.cli import main; main()"
    works = [
        process(*bare),
        process("-c", "import beamprop"),
        process("-c", command, "--help"),
        process("-c", imports),
        process("-c", command, *width),
    ]
    python, load, help_text, limit, ours = measure(*works, repeats=repeats)
    return [
        Row("`import beamprop`", load, "python's start", python, "≤ + 0.15 s", load - python <= 0.15),
        Row("`beamprop --help`", help_text, "python's start", python, "≤ + 0.15 s", help_text - python <= 0.15),
        Row("`beamprop beam_width --output --plot`, cold", ours, "its imports", limit, "≤ 1.5", ours <= 1.5 * limit),
    ]


def memory(options: argparse.Namespace) -> list[Row]:
    """(h) the most memory that a field map takes."""
    x, z = grids(2000, 2048)
    bp.field(SLAB, BEAM, FREQUENCY, x[:16], z[:16])
    tracemalloc.start()
    p = bp.field(SLAB, BEAM, FREQUENCY, x, z).p
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    tracemalloc.start()
    bp.save_field(options.output / "map.nc", SLAB, BEAM, FREQUENCY, x, z, memory=p.nbytes / 32)
    blocks = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return [
        Row("memory, `field`, 2000 z × 2048 x", peak, "its array", p.nbytes, "≤ 3", peak <= 3 * p.nbytes, unit="B"),
        Row(
            "memory, `save_field`, the same in 32 blocks", blocks, "its array", p.nbytes, "< 1", blocks < p.nbytes, "B"
        ),
    ]


WORKS = (field_map, plane_waves, widths, angles, many_layers, starts, memory)


def arguments() -> argparse.Namespace:
    """--quick, --output, --navette, --only."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few repeats, no scaling: a check that everything runs")
    parser.add_argument("--output", type=Path, default=Path("results"), help="folder for the table and the picture")
    parser.add_argument("--navette", metavar="PYTHON", help="an interpreter that has navette 0.8.0")
    parser.add_argument("--only", nargs="+", choices=[work.__name__ for work in WORKS], help="some rows alone")
    options = parser.parse_args()
    options.repeats = 3 if options.quick else 11
    return options


def main() -> None:
    """Measure, print and write the table; draw how time scales."""
    options = arguments()
    options.output.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    chosen = [work for work in WORKS if not options.only or work.__name__ in options.only]
    for work in tqdm(chosen, desc="benchmarks", file=sys.stderr):
        rows += work(options)
    text = table(rows)
    (options.output / "benchmarks.md").write_text(text + "\n", encoding="utf-8")
    print(text)
    held = statistics.mean(bool(row.holds) for row in rows if row.holds is not None)
    print(f"\n{held:.0%} of the rows hold.")
    if not options.only:
        scaling.draw(options.output / "scaling.png", options.quick)


if __name__ == "__main__":
    main()
