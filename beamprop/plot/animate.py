"""The motion of a field in time, as a film."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..io.storage import write_whole
from . import labels, maps, style
from .quantities import Drawn, drawn

#: Pixels per inch of a film: 520 across a column.
DPI = 150


def animate(
    ds: xr.Dataset,
    path: str | Path,
    frames: int = 24,
    ax: Any = None,
    limit: float | None = None,
    *,
    rate: float = 12.0,
    width: float = style.COLUMN,
) -> Any:
    """A film of the sound pressure over one period, Re(p exp(-i w t)), that runs on without a seam.

    Parameters
    ----------
    ds : Dataset
        From `beamprop.field` at one frequency and angle.
    path : path
        Ending in .gif, or in .mp4 where the program ffmpeg is installed; replaced if it exists, once the new one is complete.
    frames : int
        Of a period, evenly spread, the first at t = 0.
    ax : Axes, optional
        By default those of a new figure. The whole figure is filmed.
    limit : float, Pa, optional
        The colour scale's end; the 99.8th percentile of \\|p\\| by default.
    rate : float
        Frames a second.
    width : float, mm
        Of a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came; also for .mp4 without ffmpeg.

    Examples
    --------
    >>> slab, beam = bp.Slab(bp.lmmd_cell(), periods=20), bp.GaussianBeam(0.096)
    >>> ds = bp.field(slab, beam, 2500.0, x=np.linspace(-0.2, 0.2, 41), z=slab.cell.thickness * np.arange(60))
    >>> ax = bp.plot.animate(ds, "beam.gif", frames=4)
    """
    path = validate.as_path(path)
    frames = validate.as_count(frames, "frames", least=2)
    rate = validate.as_number(rate, "rate", positive=True)
    limit, _ = maps.checked_scale(limit, -1.0)
    writer = _writer(path, rate)
    validate.instance(ds, xr.Dataset, "ds")
    labels.need(ds, "p", "x", "z")
    p = maps.on_grid(ds, ("p",))[0]
    with style.drawing(ax, width) as axes:
        mesh = maps.draw(axes, ds, p, _over_a_period(p, limit), width if ax is None else None)
        write_whole(path, lambda draft: _film(axes.figure, mesh, motion(p.values, frames), writer, draft))
    return axes


def motion(p: np.ndarray, frames: int) -> Iterator[np.ndarray]:
    """Re(p exp(-i w t)) at even times of a period from t = 0 on."""
    for turn in 2 * np.pi * np.arange(frames) / frames:
        yield p.real * np.cos(turn) + p.imag * np.sin(turn)


def _over_a_period(p: xr.DataArray, limit: float | None) -> Drawn:
    """Re p, whose least and largest are those of the whole period: each point goes from -|p| to |p|."""
    most = drawn((p,), "abs").most
    return drawn((p,), "real", limit)._replace(least=-most, most=most)


def _film(figure: Any, mesh: Any, values: Iterator[np.ndarray], writer: Any, path: Path) -> None:
    figure = figure.get_figure(root=True)
    with writer.saving(figure, str(path), DPI):
        for frame in values:
            mesh.set_array(frame)
            writer.grab_frame()


def _writer(path: Path, rate: float) -> Any:
    """What writes films of that ending."""
    from matplotlib.animation import FFMpegWriter, PillowWriter

    ending = path.suffix.lower()
    if ending == ".gif":
        return PillowWriter(fps=rate)  # type: ignore[arg-type]
    if ending != ".mp4":
        raise ValueError(f"path: expected a name ending in .gif or .mp4, got {str(path)!r}")
    if not FFMpegWriter.isAvailable():
        raise ValueError(
            f"path: expected a name ending in .gif, for the program ffmpeg is not installed, got {str(path)!r}"
        )
    even = ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]  # what players need
    return FFMpegWriter(fps=rate, extra_args=even)  # type: ignore[arg-type]
