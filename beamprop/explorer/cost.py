"""What an answer will take, from counts alone, and the refusal of what takes too long for a page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .. import parameters
from ..study.predict import duration

#: What the page waits for at most [s].
MOST_SECONDS = 5.0
#: What counts do not tell, the clock does: the process that answers is ended by then.
TOO_LONG = (
    f"question: expected one of at most {duration(MOST_SECONDS)}, got one that takes longer; ask it with beamprop run"
)
#: Seconds for each layer that differs, by question; measured by experiments/benchmarks/explorer.py with 10000 layers in a cell.
EACH_LAYER = {"field": 6e-5, "scattering": 1.3e-4, "bloch": 1.3e-4, "beam_width": 3e-4}


def layers_of(description: Mapping[str, Any]) -> float:
    """Layers that the recursion goes through: those of each cell once, and of random copies all."""
    slab = description.get("slab", {})
    counts = []
    for part in slab.get("stack", (slab,)):
        if part.get("layer") is not None:
            layers = len(part["layer"])
        else:
            layers = parameters.count(part.get("n_layers", parameters.LMMD["n_layers"].default), "n_layers")
        default = 1 if "stack" in slab or parameters.of_layers(part) else parameters.SLAB["periods"].default
        counts.append((layers, parameters.count(part.get("periods", default), "periods")))
    if "tolerance" not in description:
        return float(sum(layers for layers, _ in counts))
    copies = 1 + float(description["tolerance"].get("sample", 0))
    return copies * sum(layers * periods for layers, periods in counts)


def check(description: Mapping[str, Any]) -> None:
    """Refuse what would keep the page waiting.

    Raises
    ------
    ValueError
        Says what the question would take.

    Examples
    --------
    >>> from beamprop.explorer.cost import check
    >>> check({"question": {"name": "field"}, "slab": {"n_layers": 10}})
    """
    name = description["question"]["name"]
    layers = layers_of(description)
    seconds = layers * EACH_LAYER[name]
    if seconds > MOST_SECONDS:
        raise ValueError(
            f"slab: expected a question of at most {duration(MOST_SECONDS)}, got one that takes about {duration(seconds)} "
            f"for {layers:.3g} layers that differ; ask it with beamprop run"
        )
