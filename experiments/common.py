"""What the experiments share: the paper's parameters, a small command line, saving, and the table of statements."""

from __future__ import annotations

import argparse
import importlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import xarray as xr
from matplotlib import style

import beamprop as bp

matplotlib.use("agg")

#: rho_m, delta_rho of the paper's three losses, and of its lossless medium.
LOSSES = {"a": (0.05 + 0.05j, 0.025), "b": (0.05 + 0.005j, 0.0025), "c": (0.05 + 0.5j, 0.25)}
LOSSLESS = (0.05, 0.0)
DESIGN = 2500.0
FWHM = 0.096
WAVELENGTH = 343.0 / DESIGN
#: Two columns of a journal [inches], and the style of every figure.
PAGE = 180 / 25.4
in_style = style.context("beamprop.plot.paper")


def slab(periods: int, loss: tuple[complex, float] = LOSSES["a"], **cell: float) -> bp.Slab:
    """The paper's slab of `periods` periods."""
    return bp.Slab(bp.lmmd_cell(*loss, **cell), periods)


def three_media(exact: bp.Slab) -> dict[str, bp.Slab]:
    """The same slab exactly, by the paper's effective medium, with the interface term, and by the standard one."""
    return {
        "TMM": exact,
        "LMMD EMT": bp.lmmd_emt_slab(exact, interface=False),
        "LMMD EMT + interface": bp.lmmd_emt_slab(exact),
        "standard EMT": bp.Slab.uniform(bp.standard_emt(exact.cell), exact.thickness),
    }


@dataclass(frozen=True)
class Statement:
    """A row of the table: what the paper states, what this run computed, and whether it holds."""

    figure: str
    stated: str
    computed: str
    holds: bool


def table(rows: Iterable[Statement]) -> str:
    """The statements as a Markdown table."""
    lines = ["| figure | what the paper states | what we get | holds? |", "|---|---|---|---|"]
    lines += [f"| {r.figure} | {r.stated} | {r.computed} | {'yes' if r.holds else 'NO'} |" for r in rows]
    return "\n".join(lines)


def save_all(name: str, folder: Path, datasets: dict[str, xr.Dataset], figure: matplotlib.figure.Figure) -> None:
    """Write a figure and the data beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    for key, ds in datasets.items():
        bp.save(ds, folder / f"{name}_{key}.nc")
    figure.savefig(folder / f"{name}.png", dpi=150)
    importlib.import_module("matplotlib.pyplot").close(figure)


def arguments(text: str | None) -> argparse.Namespace:
    """--quick for a coarse run, --output for the folder."""
    parser = argparse.ArgumentParser(description=(text or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="coarse grids: a check that everything runs")
    parser.add_argument("--output", type=Path, default=Path("results"), help="folder for data and pictures")
    return parser.parse_args()


def run(name: str, text: str | None, compute: Callable, plot: Callable, statements: Callable) -> None:
    """The main function of every experiment."""
    options = arguments(text)
    data = compute(options.quick)
    save_all(name, options.output, data, plot(data))
    print(table(statements(data)))
