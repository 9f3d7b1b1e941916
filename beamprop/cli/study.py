"""Study files: run, check and init."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .. import parameters
from .answer import answer, progress, table
from .commands import command
from .failures import attempt
from .options import COUNT, SOURCE, Checked, option, switch, words
from .pictures import drawing
from .summaries import SUMMARIES

if TYPE_CHECKING:
    import xarray as xr

    from ..study.files import StudyFile

#: Studies to start from.
EXAMPLES = ("width", "angles", "tolerance", "imaging")
_FILES = Path(__file__).parents[1] / "study" / "examples"


def _shard(value: Any, name: str) -> tuple[int, int]:
    part, bar, parts = value.partition("/")
    if not bar or not 1 <= parameters.count(part, name) <= parameters.count(parts, name):
        raise ValueError(f"{name}: expected k/n with k from 1 to n, such as 2/8, got {value!r}")
    return int(part), int(parts)


def read_study(path: Path) -> StudyFile:
    """The study of a file, or all that is wrong with it as wrong use."""
    from ..study import files

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # they come again where the question is asked
        study: StudyFile = _refusing(lambda: files.read(path))
    return study


def _refusing(action: Callable[[], Any]) -> Any:
    """What an action returns; mistakes keep the names that they have in the file."""
    from ..study.files import Mistakes

    def ask() -> Any:
        try:
            return action()
        except Mistakes as error:
            raise click.UsageError(str(error), click.get_current_context(silent=True)) from None

    return attempt(ask)


@contextmanager
def _memory(stated: float | None) -> Iterator[None]:
    """The memory that a study states, as the limit of this process and of those that it starts."""
    from ..memory import VARIABLE

    before = os.environ.get(VARIABLE)
    if stated is not None:
        os.environ[VARIABLE] = str(stated)
    try:
        yield
    finally:
        os.environ.pop(VARIABLE, None)
        if before is not None:
            os.environ[VARIABLE] = before


@command("run", example="beamprop run study.toml")
@click.argument("file", type=SOURCE)
@option("--workers", kind=COUNT, text="Processes, instead of what the file says.", shown="all cores")
@option(
    "--shard", kind=Checked(_shard, "K/N"), text="The k-th of n parts of a sweep: for machines that share its store."
)
@option("--scheduler", text="Ask on the cluster of dask at this address, such as tcp://host:8786.", metavar="ADDRESS")
@switch("--repair", text="Answer again what is damaged in the store, or has failed.")
@switch("--json", "as_json", text="Print the dataset as JSON.", group="Output")
@switch("--quiet", "-q", text="Print nothing but warnings and what was asked for by --json.", group="Output")
def run(**o: Any) -> None:
    """Answer the question of a study file.

    At all its points; the same command again goes on with what a kill left in its store.
    """
    study = read_study(o["file"])
    unused = [name for name in ("shard", "repair", "scheduler", "workers") if o[name]]
    if unused and not study.axes:
        raise click.UsageError(f"--{unused[0]}: expected a study with a sweep, got one question")

    def ask() -> xr.Dataset:
        from ..study.predict import before

        cost = _refusing(lambda: before(study))
        if cost is not None and progress(o):
            click.echo("\n".join(cost.lines()), err=True)
        return _refusing(lambda: study.answer(progress(o), **(_way(o) if study.axes else {})))

    o |= {name: study.output[key] and Path(study.output[key]) for name, key in (("output", "file"), ("plot", "plot"))}
    with _memory(study.output["memory"]):
        draw = drawing("sweep" if study.axes else study.name, study.output)
        answer(o, ask, draw, lambda ds: _summary(study, ds))


def _way(o: dict[str, Any]) -> dict[str, Any]:
    """How a sweep is answered, where the options say more than the file."""
    way = {"repair": o["repair"]} | {name: o[name] for name in ("workers", "shard") if o[name] is not None}
    if o["scheduler"] is not None:
        from distributed import Client

        way["executor"] = Client(o["scheduler"]).get_executor()
    return way


def _summary(study: StudyFile, ds: xr.Dataset) -> str:
    """Of a question what its command says; of a sweep the numbers where they are on one axis, else what there is."""
    if not study.axes:
        return SUMMARIES[study.name](ds)
    names = tuple(str(name) for name, v in ds.data_vars.items() if v.dtype.kind in "fi")
    if (
        len(names) == len(ds.data_vars) > 0
        and len({ds[name].dims for name in names}) == 1
        and len(ds[names[0]].dims) <= 1
    ):
        return table(ds, names)
    lines = [f"{study.name} on ({', '.join(f'{d} {n}' for d, n in ds.sizes.items() if d != 'block')})"]
    return "\n".join(lines + ([f"in {study.output['store']}"] if study.output["store"] else []))


@command("check", example="beamprop check study.toml")
@click.argument("file", type=SOURCE)
@switch("--json", "as_json", text="Print the prediction as JSON.", group="Output")
def check(**o: Any) -> None:
    """Check a study file, and predict what it takes.

    All mistakes at a time; then points, time, memory and the size of the file, from a few points that are answered.
    """
    study = read_study(o["file"])

    def predict() -> Any:
        from ..study.predict import predict

        return predict(study)

    with _memory(study.output["memory"]), warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cost = _refusing(predict)
    for said in dict.fromkeys(str(w.message) for w in caught):
        click.echo(f"warning: {said}", err=True)
    numbers = {key: value for key, value in cost._asdict().items() if key != "variables"}
    click.echo(json.dumps(numbers) if o["as_json"] else "\n".join(cost.lines()))


@command("init", example="beamprop init angles.toml --example angles")
@click.argument("file", type=click.Path(path_type=Path), default="study.toml")
@option("--example", kind=words(*EXAMPLES), text="What to start from.", default="width", shown="width")
def init(file: Path, example: str) -> None:
    """Write a commented study file to start from.

    A file of that name is left as it is; - is stdout.
    """
    text = (_FILES / f"{example}.toml").read_text(encoding="utf-8")
    if str(file) == "-":
        click.echo(text, nl=False)
        return
    if file.exists():
        raise click.UsageError(f"FILE: expected a new name, got {str(file)!r}, which exists")
    from ..io.storage import write_whole

    with parameters.named("FILE", "path"):
        attempt(lambda: write_whole(file, lambda draft: _copy(text, draft)))
    click.echo(f"wrote {file}; see what it takes with: beamprop check {file}")


def _copy(text: str, draft: Path) -> None:
    draft.write_text(text, encoding="utf-8")


COMMANDS = (run, check, init)
