"""The local page: explore."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import parameters
from .commands import command
from .failures import attempt
from .options import SOURCE, Checked, option, switch, target
from .study import read_study

if TYPE_CHECKING:
    from ..explorer.controls import Board


def _port(value: Any, name: str) -> int:
    port = parameters.count(value, name)
    if port > 65535:
        raise ValueError(f"{name}: expected a number up to 65535, got {value!r}")
    return port


@command("explore", example="beamprop explore study.toml")
@click.argument("file", type=SOURCE, required=False)
@option("--port", kind=Checked(_port, "NUMBER"), text="Where the page listens.", shown="any that is free")
@switch("--no-open", text="Do not open it in the browser.")
@option(
    "--export",
    kind=target(".html"),
    group="Output",
    text="Write one page of the stored results of FILE (a study, .nc, .zarr or .mat) that needs no server; a file of that name is replaced.",
)
def explore(file: Path | None, port: int | None, no_open: bool, export: Path | None) -> None:
    """A page with a slider for every value of a study.

    Field, transmission, contour and widths are answered while sliders move; without FILE, for the slab of the paper. The first line is the
    address, for this machine alone; the page ends with its terminal.
    """
    if export is not None:
        if file is None:
            raise click.UsageError("FILE: expected a study or a dataset for --export, got none")
        _export(file, export)
        return
    board = _board(file)

    def started(url: str) -> None:
        click.echo(url)
        if not no_open:
            threading.Thread(target=click.launch, args=(url,), daemon=True).start()  # a browser may keep its caller

    from ..explorer.server import serve

    attempt(lambda: serve(board, port or 0, started))


def _board(file: Path | None) -> Board:
    from ..explorer import controls

    study = None if file is None else read_study(file)
    return attempt(lambda: controls.board(study))


def _export(file: Path, export: Path) -> None:
    from ..explorer import stored
    from ..io.storage import write_whole

    source: Any = read_study(file) if file.suffix.lower() == ".toml" else file
    page = attempt(lambda: stored.page(source))
    attempt(lambda: write_whole(export, lambda draft: _write(page, draft)))
    click.echo(f"wrote {export}")


def _write(page: str, draft: Path) -> None:
    draft.write_text(page, encoding="utf-8")


COMMANDS = (explore,)
