"""What the studies of the gallery share: panels of a figure, and a main function that prints, draws and saves."""

from __future__ import annotations

import argparse
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import beamprop as bp
from beamprop.plot.style import new_figure

#: Width of two columns of a journal [mm]; one is 88.
PAGE = 180.0


def published(name: str) -> Any:
    """Values that others have printed, by their name in `conformance/published.py`, which lies in the folder above."""
    return runpy.run_path(str(Path(__file__).parents[1] / "conformance" / "published.py"))[name]


def panels(count: int, width: float = PAGE, height: float = 54.0) -> tuple[plt.Figure, np.ndarray]:
    """A figure `width` wide and its Axes, each `height` high [mm]: side by side on a page, stacked in a column."""
    rows = count if width < PAGE else 1
    figure = new_figure(width, rows * height)
    return figure, figure.subplots(rows, count // rows, squeeze=False).ravel()


def main(study: Callable, picture: Callable) -> None:
    """Print the numbers of a study and draw it; with --output, write its data, its tables and the picture there."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true", help="fewer points of curves and maps")
    parser.add_argument("--width", type=float, default=PAGE, help="of the picture [mm]")
    parser.add_argument("--output", type=Path, help="folder for the picture and the data")
    options = parser.parse_args()
    result: dict[str, Any] = study(options.quick)
    for name, value in result.items():
        if not isinstance(value, xr.Dataset | str):
            print(f"{name} = {value:.6g}")
    with plt.style.context("beamprop.plot.paper"):
        figure = picture(result, options.width)
        figure.draw_without_rendering()  # the layout settles in a second pass where ticks change in the first
        if options.output:
            options.output.mkdir(parents=True, exist_ok=True)
            name = Path(study.__code__.co_filename).stem
            figure.savefig(options.output / f"{name}.png")
            for key, value in result.items():
                if isinstance(value, xr.Dataset):
                    bp.save(value, options.output / f"{name}_{key}.nc")
                elif isinstance(value, str):
                    (options.output / f"{name}_{key}.csv").write_text(value, encoding="utf-8")
