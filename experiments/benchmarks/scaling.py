"""How time grows with the size of the question: a log-log picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np
from timing import measure

import beamprop as bp

FREQUENCY = 2500.0
BEAM = bp.GaussianBeam(0.096, 45.0)


def slab(periods: int = 450) -> bp.Slab:
    """The paper's slab."""
    return bp.Slab(bp.lmmd_cell(), periods)


def grid(count: int) -> np.ndarray:
    """x over 20 wavelengths."""
    return 1.372 * np.linspace(-1, 1, count, endpoint=False)


def periods(count: int) -> object:
    """Plane waves through `count` periods."""
    return bp.scattering(slab(count), FREQUENCY, kx_over_k0=np.linspace(0, 0.999, 1000))


def depths(count: int) -> object:
    """A field at `count` depths."""
    return bp.field(slab(), BEAM, FREQUENCY, grid(512), np.linspace(0, slab().thickness, count))


def points(count: int) -> object:
    """A field at `count` points across."""
    return bp.field(slab(), BEAM, FREQUENCY, grid(count), np.linspace(0, slab().thickness, 200))


def frequencies(count: int) -> object:
    """Widths at `count` frequencies."""
    return bp.beam_width(slab(), bp.GaussianBeam(0.096), np.linspace(2000, 3000, count))


SERIES: dict[str, tuple[Callable[[int], object], str, list[int]]] = {
    "periods (scattering, 1000 kx)": (periods, "o", [1, 10, 100, 1000, 10_000, 100_000]),
    "z samples (field, 512 x)": (depths, "s", [10, 30, 100, 300, 1000, 3000, 10_000]),
    "x samples (field, 200 z)": (points, "^", [32, 128, 512, 2048, 8192, 16_384]),
    "frequencies (beam_width)": (frequencies, "d", [1, 3, 10, 30, 100, 300, 1000]),
}


def draw(path: Path, quick: bool) -> None:
    """Time each series and draw them all."""
    fig, ax = plt.subplots(figsize=(6.2, 4.4), layout="constrained")
    for name, (ask, marker, counts) in SERIES.items():
        counts = counts[:3] if quick else counts
        times = [measure(lambda ask=ask, n=n: ask(n), repeats=1 if quick else 5)[0] for n in counts]  # type: ignore[misc]
        ax.loglog(counts, times, marker=marker, ms=4, label=name)
    n = np.array([300.0, 10_000.0])
    ax.loglog(n, 2e-4 * n, "k:", lw=1, label="proportional")
    ax.set(xlabel="number", ylabel="time (s)")
    ax.legend(fontsize="small")
    ax.grid(alpha=0.3)
    fig.savefig(path, dpi=150)
    plt.close(fig)
