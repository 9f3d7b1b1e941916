"""What a point of a study costs, made and measured: a new slab, its widths, their dataset. Processor time, which other programs change little.

    python experiments/benchmarks/point.py                     this checkout alone
    python experiments/benchmarks/point.py --before CHECKOUT   beside an older one, in turn, with the ratio

`by itself` calls `beam_width` at each point, `together` asks a block of 128 points as a sweep does, `many angles` in blocks of four.
A copy is the paper's slab with 4500 layers that all differ. Rows that a checkout does not know are left out.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import _one_thread  # noqa: F401
import numpy as np

import beamprop as bp

HERE = Path(__file__).resolve()
#: Questions of a row, each with a slab of its own.
POINTS = 128


def paper(number: int, angle: float = 0.0, lossless: bool = False) -> float:
    """A width behind the paper's slab with another eta."""
    loss = {"rho_m": 0.05, "delta_rho": 0.0} if lossless else {}
    slab = bp.Slab(bp.lmmd_cell(eta=1 / (60 - number / 16), **loss), 450)
    return bp.beam_width(slab, bp.GaussianBeam(0.096, angle), 2500.0).fwhm_out.item()


def layers(number: int) -> bp.Slab:
    """4500 layers that all differ, as they are made by hand."""
    rng = np.random.default_rng(number)
    factors = 1 + 0.01 * rng.normal(size=(450, 10, 2))
    cell = bp.lmmd_cell()
    return bp.Slab(
        [
            bp.Layer(bp.Fluid(layer.fluid.density * rho, layer.fluid.bulk_modulus), layer.thickness * d)
            for period in factors
            for layer, (rho, d) in zip(cell.layers, period, strict=True)
        ]
    )


def copies(number: int) -> bp.Slab:
    """The same by `tolerance`."""
    return bp.tolerance(bp.Slab(bp.lmmd_cell(), 450), 0.01, 0.01, count=1000)[number]


def behind(make: Callable[[int], bp.Slab], number: int) -> float:
    """A width behind a slab."""
    return bp.beam_width(make(number), bp.GaussianBeam(0.096), 2500.0).fwhm_out.item()


QUESTIONS: dict[str, tuple[Callable[[int], float], int]] = {
    "with loss, normal": (paper, POINTS),
    "with loss, 45 degrees": (partial(paper, angle=45.0), POINTS),
    "with loss, many angles": (lambda number: paper(number, angle=15.0 * (number % 4)), POINTS),
    "lossless, normal": (partial(paper, lossless=True), POINTS),
    "4500 layers, by hand": (partial(behind, layers), 8),
    "4500 layers, a copy": (partial(behind, copies), 8),
}


def one_by_one(question: Callable[[int], float], count: int) -> None:
    """A plain loop."""
    for number in range(count):
        question(number)


def in_a_block(question: Callable[[int], float], count: int) -> None:
    """As a sweep asks."""
    from beamprop.api.together import together

    together([partial(question, number) for number in range(count)])


def measured() -> dict[str, float]:
    """Processor time of a point in each row [s]."""
    times = {}
    for name, (question, count) in QUESTIONS.items():
        for way, ask in (("by itself", one_by_one), ("together", in_a_block)):
            try:
                ask(question, 2)
            except (AttributeError, ImportError):  # an older checkout
                continue
            number = count if way == "together" else min(count, 32)
            start = time.process_time()
            ask(question, number)
            times[f"{name} | {way}"] = (time.process_time() - start) / number
    return times


def run(checkout: Path) -> dict[str, float]:
    """The rows of a checkout, in a fresh process."""
    command = [sys.executable, str(HERE), "--json"]
    environment = os.environ | {"PYTHONPATH": str(checkout)}
    return json.loads(subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=Path, help="an older checkout")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", action="store_true", help="measure once and print it")
    arguments = parser.parse_args()
    if arguments.json:
        warnings.simplefilter("ignore")
        print(json.dumps(measured()))
        return
    checkouts = [path for path in (arguments.before, HERE.parents[2]) if path]
    runs: list[list[dict[str, float]]] = [[] for _ in checkouts]
    for _ in range(arguments.repeats):
        for path, seen in zip(checkouts, runs, strict=True):
            seen.append(run(path))
    times = [{row: statistics.median(r[row] for r in seen) for row in seen[0]} for seen in runs]
    print("| a point | asked | before | now | |\n|---|---|---|---|---|")
    for row, now in times[-1].items():
        before = times[0].get(row, times[0].get(row.replace("together", "by itself").replace("a copy", "by hand")))
        old = f"{before * 1e3:.3g} ms" if arguments.before and before else "-"
        ratio = f"{before / now:.1f} ×" if arguments.before and before else ""
        print(f"| {row} | {old} | {now * 1e3:.3g} ms | {ratio} |", flush=True)


if __name__ == "__main__":
    main()
