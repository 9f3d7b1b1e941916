"""The picture of an answer, by what is said of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from .. import parameters
from ..parameters import QUANTITIES, is_several
from .failures import typed
from .options import TYPED

if TYPE_CHECKING:
    import xarray as xr

#: Function of `plot` for each question, and what is said of a picture that it takes.
_DRAWN_BY: dict[str, tuple[str, tuple[str, ...]]] = {
    "field": ("field", ("quantity",)),
    "beam_width": ("width", ("along",)),
    "beam_measures": ("sweep", ("quantity", "along")),
    "scattering": ("scattering", ("quantity", "log", "along")),
    "bloch": ("bloch", ("along",)),
    "guided_modes": ("modes", ()),
    "sweep": ("sweep", ("quantity", "log", "along", "band")),
}


def drawing(question: str, said: Mapping[str, Any]) -> Callable[[xr.Dataset], Any]:
    """What draws the answer to a question, or to a sweep."""

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        name, takes = _DRAWN_BY[question]
        options = {key: said[key] for key in takes if said[key] is not None}
        if question in QUANTITIES:
            options = {"quantity": QUANTITIES[question][0]} | options
        if said["plot_width"] is not None:
            options["width"] = said["plot_width"]
        return getattr(plot, name)(ds, **options)

    return draw


def was_typed(name: str) -> bool:
    """Whether an option stands on the command line."""
    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


def default_axis(o: dict[str, Any], name: str, text: str) -> None:
    """Take an axis as if it had been typed: for a picture, which has nothing to draw at one value."""
    ctx = click.get_current_context()
    ctx.meta.setdefault(TYPED, {})[name] = [text]
    ctx.set_parameter_source(name, ParameterSource.COMMANDLINE)
    o[name] = parameters.axis(text, typed(name), parameters.AXES[name])


def check_axes(o: Mapping[str, Any], axes: Mapping[str, Any]) -> None:
    """Refuse --plot where each of these axes is one value, and --along for what is none of several."""
    several = [name for name, value in axes.items() if is_several(value)]
    if o["plot"] and not several:
        raise click.UsageError(f"--plot: expected an axis for {' or '.join(map(typed, axes))}, got one value")
    if o["along"] is not None and o["along"] not in several:
        expected = " or ".join(several) or "to be left out, for there is one value"
        raise click.UsageError(f"--along: expected {expected}, got {o['along']!r}")
