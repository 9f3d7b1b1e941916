"""A question's answer as a file: the dataset, or a picture of it. Files lie in a folder of the server's own for a moment."""

from __future__ import annotations

import io
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from . import panels, state
from .controls import Board


def file(board: Board, name: str, moved: Any, kind: str, quantity: Any) -> bytes:
    """The bytes of a dataset (nc) or of a picture (png, pdf, svg) of a question at moved values.

    Raises
    ------
    ValueError
        Names the value that is wrong, or says what the question would take.
    """
    described = state.description(board, state.values_of(board, moved), name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the page has shown them
        ds = panels.ask(described)
        return _dataset(ds) if kind == "nc" else _picture(ds, name, kind, quantity)


def _dataset(ds: Any) -> bytes:
    from ..io.storage import save

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "answer.nc"
        save(ds, path)
        return path.read_bytes()


def _picture(ds: Any, name: str, kind: str, quantity: Any) -> bytes:
    import matplotlib.pyplot as plt

    plt.switch_backend("agg")  # no window is opened here

    from .. import plot

    draw: dict[str, Any] = {"scattering": plot.scattering, "bloch": plot.bloch, "beam_width": plot.width}
    drawn_in = plot.field(ds, quantity) if name == "field" else draw[name](ds)
    figure = np.atleast_1d(drawn_in).flat[0].figure
    drawn = io.BytesIO()
    try:
        figure.savefig(drawn, format=kind, dpi=200)
    finally:
        plt.close(figure)
    return drawn.getvalue()
