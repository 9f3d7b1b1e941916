"""The style of the pictures: publication widths, 7 pt letters, and figures that keep it until they are written.

`drawing` is what every function of this room draws in: ``with drawing(ax, width) as ax: ...``.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from .. import validate

#: Widths of one and of two columns of a journal [mm].
COLUMN, PAGE = 88.0, 180.0
#: A figure narrower than this has no room for its labels [mm].
NARROWEST = 40.0
#: Matplotlib refuses pictures of more than 2^16 pixels a side, which at 300 dots an inch are 5.5 m; no sheet is broader than this [mm].
WIDEST = 2000.0
#: Height over width of a figure of curves.
PROPORTION = 0.65
#: [mm].
INCH = 25.4


@functools.cache
def settings() -> mpl.RcParams:
    """What the style file says."""
    return mpl.rc_params_from_file(Path(__file__).with_name("paper.mplstyle"), use_default_template=False)


class PaperFigure(Figure):
    """A figure that is drawn and written in the style, whatever the settings are by then: text of an SVG stays text."""

    def draw(self, renderer: Any) -> None:
        """Draw in the style."""
        with mpl.rc_context(settings()):
            super().draw(renderer)

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write in the style."""
        with mpl.rc_context(settings()):
            super().savefig(fname, **options)


def new_figure(width: float, height: float | None = None) -> Any:
    """An empty figure of the style, `width` [mm] by `height` [mm], by default of a proportion that suits curves."""
    import matplotlib.pyplot as plt

    width = validate.as_number(width, "width", positive=True)
    if width < NARROWEST:
        raise ValueError(f"width: expected at least {NARROWEST:g} mm, got {width:g}: 88 is one column, 180 is two")
    if width > WIDEST:
        raise ValueError(f"width: expected at most {WIDEST:g} mm, got {width:g}: 88 is one column, 180 is two")
    size = (width / INCH, (height or PROPORTION * width) / INCH)
    with mpl.rc_context(settings()):
        return plt.figure(FigureClass=PaperFigure, figsize=size, layout="constrained")


def styled(figure: Any) -> Any:
    """The settings to draw on a figure with: the style's on its own figures, those that hold already on others."""
    return mpl.rc_context(settings()) if isinstance(figure, PaperFigure) else nullcontext()


@contextmanager
def drawing(ax: Any, width: float, height: float | None = None) -> Iterator[Any]:
    """The Axes to draw in, with the style's settings: `ax`, or those of a new figure.

    Axes of a figure of another style keep the settings that hold where they are drawn in.

    Parameters
    ----------
    ax : Axes or None
    width, height : float, mm
        Of a new figure.

    Examples
    --------
    >>> with drawing(None, 88.0) as ax:
    ...     lines = ax.plot([0, 1])
    >>> float(round(ax.figure.get_figwidth() * 25.4, 3)), ax.xaxis.label.get_fontsize()
    (88.0, 7.0)
    """
    if ax is not None and not hasattr(ax, "pcolormesh"):
        raise validate.refuse("ax", "Axes of matplotlib", ax)
    figure = new_figure(width, height) if ax is None else ax.get_figure(root=True)
    with styled(figure):
        yield figure.add_subplot() if ax is None else ax
