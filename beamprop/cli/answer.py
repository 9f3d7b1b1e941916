"""From a dataset to stdout and files."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr


def answer(
    o: dict[str, Any],
    ask: Callable[[], xr.Dataset],
    draw: Callable[[xr.Dataset], Any] | None,
    summary: Callable[[xr.Dataset], str],
    saved: bool = False,
) -> xr.Dataset:
    """Ask, write (unless asking has `saved`), draw, print; the dataset. A ValueError is wrong use: exit 2."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            ds = ask()
        except ValueError as error:
            raise click.UsageError(str(error)) from None
        except (OSError, ImportError) as error:
            raise click.ClickException(str(error)) from None
    for w in caught:
        if not issubclass(w.category, DeprecationWarning):
            click.echo(f"warning: {w.message}", err=True)
    try:
        if o["output"] and not saved:
            from ..io.exports import write

            write(ds, o["output"])
        if o["plot"] and draw is not None:
            draw_into(ds, draw, o["plot"])
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    except (OSError, ImportError) as error:
        raise click.ClickException(str(error)) from None
    if o["as_json"]:
        click.echo(json.dumps(plain(ds.to_dict()), allow_nan=False))
    elif not o["quiet"]:
        click.echo(summary(ds))
        for path in filter(None, (o["output"], o["plot"])):
            click.echo(f"wrote {path}")
    return ds


def draw_into(ds: xr.Dataset, draw: Callable[[xr.Dataset], Any], path: Path) -> None:
    """Draw a dataset into a file that appears when it is complete."""
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    from ..io.storage import write_whole

    figure = draw(ds).figure
    write_whole(path, lambda draft: figure.savefig(draft, dpi=150))
    plt.close(figure)


def plain(value: Any) -> Any:
    """What JSON can hold: complex numbers as {re, im}, nan as null."""
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, complex):
        return {"re": plain(value.real), "im": plain(value.imag)}
    if isinstance(value, float) and not -1e400 < value < 1e400:
        return None
    return value


def table(ds: xr.Dataset, names: tuple[str, ...], scale: float = 1.0, most: int = 12) -> str:
    """At most `most` rows of a dataset as text, evenly spaced."""
    dims = list(ds[names[0]].dims)
    frame = ds[list(names)].to_dataframe().reset_index() if dims else None
    if frame is None:
        return "\n".join(f"{n:22s} {float(ds[n]) * scale:.6g}" for n in names)
    rows = list(range(len(frame)))
    if len(frame) > most:
        rows = sorted({round(i * (len(frame) - 1) / (most - 1)) for i in range(most)})
    keep = frame.iloc[rows][[*dims, *names]].copy()
    for n in names:
        keep[n] = keep[n] * scale
    left_out = f"\n({len(frame)} rows; {len(keep)} shown)" if len(keep) < len(frame) else ""
    return keep.to_string(index=False, float_format=lambda v: f"{v:.6g}") + left_out
