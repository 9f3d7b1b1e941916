"""A thousand random copies of the paper's slab, 4500 layers each, whose widths are the tolerance of a design: as a sweep.

    python experiments/benchmarks/tolerance.py                 # the table of docs/media.md
    python experiments/benchmarks/tolerance.py --count 100

Every layer's thickness and density err by a hundredth, independently. Processor time is that of one core.
"""

import _one_thread  # noqa: F401  # isort: skip

import argparse
import resource
import time

import numpy as np
import xarray as xr

import beamprop as bp

SLAB, BEAM, SIGMA = bp.Slab(bp.lmmd_cell(), 450), bp.GaussianBeam(0.096), 0.01
SHARES = [1, 5, 50, 95, 99]


def report(count: int) -> str:
    """The table, and sentences."""
    copies = bp.tolerance(SLAB, thickness=SIGMA, density=SIGMA, count=count)

    def width(sample: int) -> xr.Dataset:
        return bp.beam_width(copies[sample], BEAM, 2500.0)

    start = time.process_time()
    ds = bp.sweep(width, {"sample": np.arange(count)}, workers=1, progress=False)
    took = time.process_time() - start
    designed = bp.beam_width(SLAB, BEAM, 2500.0)
    shares = " | ".join(f"{share} %" for share in SHARES)
    lines = [f"| of {count} copies | as designed | {shares} |", "|---" * (2 + len(SHARES)) + "|"]
    for name, unit, scale in (("fwhm_out", "cm", 100.0), ("peak_out", "Pa", 1.0)):
        percentiles = " | ".join(f"{v:.3f}" for v in scale * np.percentile(ds[name], SHARES))
        lines.append(f"| {name} [{unit}] | {scale * designed[name].item():.3f} | {percentiles} |")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    answered = int((ds.status == 1).sum())
    lines += [
        "",
        f"{answered} answered; {1e3 * took / count:.0f} ms of processor time a copy, {took:.0f} s in all; largest memory {memory:.0f} MB",
    ]
    return "\n".join(lines)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    print(report(parser.parse_args().count))


if __name__ == "__main__":
    main()
