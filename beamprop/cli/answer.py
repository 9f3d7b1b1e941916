"""From a dataset to stdout and files."""

from __future__ import annotations

import contextlib
import json
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import memory
from ..parameters import PICTURE, is_several, named
from .failures import attempt, in_options, typed
from .pictures import was_typed
from .typed import save_study

if TYPE_CHECKING:
    import xarray as xr

#: Bytes that a complex value takes on its way to JSON.
JSON = 1000.0


def progress(o: dict[str, Any]) -> bool:
    """Whether to show bars: to a person who looks at a terminal, and has not asked for quiet."""
    return not o["quiet"] and _on_terminal()


def _on_terminal() -> bool:
    return sys.stderr.isatty()


def answer(
    o: dict[str, Any],
    ask: Callable[[], xr.Dataset],
    draw: Callable[[xr.Dataset], Any] | None,
    summary: Callable[[xr.Dataset], str],
    saved: bool = False,
) -> xr.Dataset:
    """Ask, draw, write (unless asking has `saved`), print; the dataset. A ValueError is wrong use: exit 2."""
    with _warnings_on_lines():
        warn_of_no_picture(o)
        ds = attempt(ask)
        files = attempt(lambda: _write(o, ds, draw, saved))
        if o.get("save_study"):
            attempt(lambda: save_study(o["save_study"]))
            files.append(o["save_study"])
        if o["as_json"]:
            attempt(lambda: check_text(ds.nbytes / 16))
            printed = json.dumps(plain(ds.to_dict()), allow_nan=False)
        else:
            printed = "\n".join([*_where(ds), summary(ds), *(f"wrote {path}" for path in files)])
    if o["as_json"] or not o["quiet"]:
        click.echo(printed)
    return ds


@contextlib.contextmanager
def _warnings_on_lines() -> Iterator[None]:
    """Print warnings in the end, each on a line of its own; also where the question is refused, for they may tell why."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            yield
        finally:
            said = [str(w.message) for w in caught if not issubclass(w.category, DeprecationWarning)]
            for message in dict.fromkeys(said):  # a question and its picture may warn of the same
                click.echo(f"warning: {in_options(message)}", err=True)


def warn_of_no_picture(o: Mapping[str, Any]) -> None:
    """Say that options of a picture were typed, and no picture."""
    unused = [typed(n) for n in PICTURE if was_typed(n)]
    if unused and not o.get("plot"):
        warnings.warn(f"{', '.join(unused)}: of a picture, and there is no --plot: nothing is drawn", stacklevel=2)


def check_text(values: float) -> None:
    """Refuse JSON of more complex values than fit in memory as text."""
    memory.check("--json", JSON * values, f"the text of {values:.3g} values", "write them to a file with --output")


def check_output(o: dict[str, Any], axes: Mapping[str, Any], field: bool = False) -> None:
    """Refuse, before the work, a file that cannot hold the answer (of several axes, or without positions), or that is read."""
    if o.get("memory") is not None and o.get("save_study"):
        raise click.UsageError("--save-study: expected to be left out beside --memory, which study files do not have")
    output = o["output"]
    for name in ("layers", "profile", "source_plane", "array"):
        if output is not None and o.get(name) is not None and Path(o[name]).resolve() == output.resolve():
            raise click.UsageError(f"--output: expected a file other than that of {typed(name)}, got {str(output)!r}")
    several = [f"--{name.replace('_', '-')}" for name, value in axes.items() if is_several(value)]
    ending = "" if output is None else output.suffix.lower()
    if ending == ".csv" and len(several) > 1:
        raise click.UsageError(f"--output: expected one axis for a .csv, got {' and '.join(several)}")
    if ending in (".vti", ".vtr") and not field:
        raise click.UsageError(f"--output: expected a field for a {ending}, got an answer without positions")


def _write(o: dict[str, Any], ds: xr.Dataset, draw: Callable[[xr.Dataset], Any] | None, saved: bool) -> list[Path]:
    """Write the picture and the dataset; their names. The picture is drawn first: where that fails, nothing is written."""
    output, plot = o["output"], o.get("plot")
    drawn = draw(ds) if plot and draw is not None else None
    figure = getattr(drawn, "flat", [drawn])[0].figure if drawn is not None else None  # panels are an array of Axes
    if output and not saved:
        from ..io.exports import write

        with named("output", "path", "ds"):
            write(ds, output)
    if plot and figure is not None:
        import matplotlib.pyplot as plt

        from ..io.storage import write_whole

        write_whole(plot, lambda draft: figure.savefig(draft))
        plt.close(figure)
    return [path for path in (output, plot) if path]


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


def _where(ds: xr.Dataset) -> list[str]:
    """A line with the frequency and angle of the answer, where it is at one."""
    scalars = [ds[name] for name in ("frequency", "angle") if name in ds.coords and not ds[name].dims]
    return [", ".join(f"{v.name} {float(v):.8g} {v.attrs['units']}" for v in scalars)] if scalars else []


# --- tables -----------------------------------------------------------------------------------------------

#: Rows and columns that a table shows at most, and rows of each where there are several tables.
ROWS, COLUMNS, ROWS_EACH = 12, 7, 6


def _spread(size: int, most: int) -> list[int]:
    """At most so many of the indices below `size`, evenly spread, with both ends."""
    return list(range(size)) if size <= most else sorted({round(i * (size - 1) / (most - 1)) for i in range(most)})


def table(ds: xr.Dataset, names: tuple[str, ...], scale: float = 1.0, rows: int = 0) -> str:
    """Variables of a dataset as text: along an axis a column each, on two axes a table each; apart by what they depend on."""
    ds = ds[list(names)] * scale
    kinds = list(dict.fromkeys(ds[n].dims for n in names))
    if len(kinds) > 1:
        return "\n\n".join(table(ds, tuple(n for n in names if ds[n].dims == kind), rows=rows) for kind in kinds)
    dims = list(ds[names[0]].dims)
    if not dims:
        return "\n".join(f"{n:22s} {float(ds[n]):.6g}" for n in names)
    if len(dims) == 1:
        return _text(ds.to_dataframe()[list(names)], rows or ROWS, len(names))
    return "\n\n".join(
        f"{n}\n" + _text(ds[n].to_series().unstack(dims[-1], sort=False), rows or ROWS_EACH, COLUMNS) for n in names
    )


def units(ds: xr.Dataset, names: tuple[str, ...]) -> str:
    """The units of variables, a line."""
    of = {unit: [n for n in names if ds[n].attrs["units"] == unit] for unit in (ds[n].attrs["units"] for n in names)}
    return "; ".join(f"{', '.join(members)} [{unit}]" for unit, members in of.items())


def _text(frame: Any, rows: int, columns: int) -> str:
    """A frame as text, of the rows and columns that fit."""
    part = frame.iloc[_spread(len(frame), rows), _spread(frame.shape[1], columns)]
    head = [] if part.columns.name is None else [str(part.columns.name)]
    shown = part.rename_axis(columns=None).reset_index()
    shown.columns = [c if isinstance(c, str) else f"{head[0]} {c:g}" for c in shown.columns]
    left_out = ""
    if part.shape != frame.shape:
        left_out = f"\n({len(part)} of {len(frame)} rows shown" + (
            f", {part.shape[1]} of {frame.shape[1]} columns)" if part.shape[1] < frame.shape[1] else ")"
        )
    return shown.to_string(index=False, float_format=lambda v: f"{v:.6g}") + left_out
