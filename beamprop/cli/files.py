"""Comparison of two fields, conversion of files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .answer import answer
from .options import Target

if TYPE_CHECKING:
    import xarray as xr

SOURCE = click.Path(exists=True, path_type=Path)


def read(path: Path) -> xr.Dataset:
    """A dataset of ours (.nc, .zarr, .mat), or COMSOL's text."""
    from ..io.comsol import read_comsol
    from ..io.storage import STORED, load

    return load(path) if path.suffix.lower() in STORED else read_comsol(path)


@click.command()
@click.argument("a", type=SOURCE)
@click.argument("b", type=SOURCE)
@click.option("--tolerance", type=click.FloatRange(min=0), help="Exit with 1 when the relative L2 error is above this.")
@click.option("--rescale", is_flag=True, help="Bring b to a by the best complex factor first.")
@click.option(
    "--output", "-o", type=Target(), help="Write the comparison to this .nc, .zarr, .mat, .vti, .vtr or .csv."
)
@click.option("--plot", "-p", type=Target(".png", ".pdf"), help="Draw it into this .png or .pdf.")
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON.")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but what was asked for by --json.")
def compare(a: Path, b: Path, tolerance: float | None, rescale: bool, **o: Any) -> None:
    """Measure the field in file B against that in file A (.nc, .zarr, or COMSOL's text)."""

    def ask() -> xr.Dataset:
        from ..comparison.fields import compare

        return compare(read(a), read(b), rescale)

    def draw(ds: xr.Dataset) -> Any:
        import numpy as np

        from .. import plot

        return np.atleast_1d(plot.comparison(ds))[0]

    ds = answer(o, ask, draw, _summary)
    if tolerance is not None and not float(ds["relative_l2"].max()) <= tolerance:
        click.echo(f"relative L2 error {float(ds['relative_l2'].max()):.3e} is above {tolerance:g}", err=True)
        sys.exit(1)


def _summary(ds: xr.Dataset) -> str:
    scale = complex(ds["scale"].values.flat[0])
    return "\n".join(
        [
            f"relative L2 error    {float(ds['relative_l2'].max()):.4e}",
            f"largest error        {float(ds['largest_error'].max()):.4e} of the largest |a|",
            f"best scale factor    {scale:.6g}",
            f"widths differ by up to {float(abs(ds['fwhm_difference']).max()) * 1000:.4g} mm",
        ]
    )


@click.command()
@click.argument("source", type=SOURCE)
@click.argument("target", type=Target())
@click.option("--x", help="The file's coordinate that is lateral; its first by default.")
@click.option("--z", help="The file's coordinate that is depth; its second by default.")
@click.option("--expression", help="The expression that is the pressure, where several may be.")
@click.option("--split-complex", is_flag=True, help="Write real and imaginary parts as variables of their own.")
@click.option(
    "--digits", type=click.IntRange(1, 15), help="Keep so many digits of each variable's largest value, compressed."
)
@click.option("--quiet", "-q", is_flag=True, help="Print nothing.")
def convert(
    source: Path, target: Path, x: str | None, z: str | None, expression: str | None, quiet: bool, **options: Any
) -> None:
    """Bring COMSOL's text, or a dataset of ours, to a .nc, .zarr, .mat (MATLAB), .vti, .vtr (ParaView) or .csv."""
    from ..io.exports import write
    from ..io.storage import STORED

    def ask() -> xr.Dataset:
        if source.suffix.lower() in STORED:
            return read(source)
        from ..io.comsol import read_comsol

        return read_comsol(source, x, z, expression)

    o = {"output": None, "plot": None, "as_json": False, "quiet": True}
    ds = answer(o, ask, None, str)
    try:
        write(ds, target, **{name: value for name, value in options.items() if value})
    except ValueError as error:
        raise click.UsageError(str(error)) from None
    except (OSError, ImportError) as error:
        raise click.ClickException(str(error)) from None
    if not quiet:
        click.echo(f"wrote {target}")


COMMANDS = (compare, convert)
