"""What the page starts from: the controls of the study, and colour maps."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import cache

from .controls import Board
from .panels import plain

#: Of magnitudes, of signed values, of angles: to be told apart by the colour-blind.
COLOURS = {"sequential": "viridis", "signed": "RdBu_r", "cyclic": "twilight"}


@cache
def colour_maps() -> dict[str, str]:
    """256 colours of each kind, as hexadecimal digits.

    Examples
    --------
    >>> from beamprop.explorer.start import colour_maps
    >>> colour_maps()["sequential"][:6]
    '440154'
    """
    import matplotlib

    return {
        kind: matplotlib.colormaps[name](range(256), bytes=True)[:, :3].tobytes().hex()
        for kind, name in COLOURS.items()
    }


def board_text(board: Board) -> bytes:
    """The controls and colour maps, as JSON."""
    start = {"title": board.title, "controls": [asdict(c) for c in board.controls], "colours": colour_maps()}
    return json.dumps(plain(start), allow_nan=False).encode()
