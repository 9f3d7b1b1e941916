"""Comparison of two fields, conversion of files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ..parameters import named
from .answer import answer
from .commands import command
from .comsol import COMSOL, GROUP, on_grid, read, refuse_unused
from .failures import attempt
from .options import AT_LEAST_ZERO, COUNT, SOURCE, option, output, switch, target

if TYPE_CHECKING:
    import xarray as xr


@command(example="beamprop compare beam.nc comsol_export.txt --tolerance 1e-3")
@click.argument("a", type=SOURCE)
@click.argument("b", type=SOURCE)
@option("--tolerance", kind=AT_LEAST_ZERO, text="Exit with 1 when the relative L2 error is above this.")
@switch("--rescale", text="Bring b to a by the best complex factor first.")
@COMSOL
@output("plot_width")
def compare(a: Path, b: Path, tolerance: float | None, rescale: bool, grid: Any, **o: Any) -> None:
    """Measure the field in file B against A.

    Files are .nc (or .nc4, .netcdf, .h5: the same), .zarr, .mat, or COMSOL's text. Scattered nodes are compared as they
    are with a field of this command, which is evaluated there; --grid interpolates them.
    """

    def ask() -> xr.Dataset:
        from ..comparison.fields import compare

        units = {name: o[name] for name in ("length_unit", "angle_unit")}
        refuse_unused(units, a, b)
        first, second = on_grid(grid, read(a, **units), read(b, **units))
        ds = compare(first, second, rescale)
        if o["plot"] and "node" in ds.dims:
            raise ValueError("plot: expected a comparison on a grid, got one on scattered nodes: give --grid")
        return ds

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        return plot.comparison(ds, **({} if o["plot_width"] is None else {"width": o["plot_width"]}))

    if o["output"] and any(source.resolve() == o["output"].resolve() for source in (a, b)):
        raise click.UsageError(f"--output: expected a file other than those compared, got {str(o['output'])!r}")
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
            *_widths(ds),
            f"compared on          {ds.attrs['compared_on']}",
        ]
    )


def _widths(ds: xr.Dataset) -> list[str]:
    """The line on widths, which scattered nodes have none of, nor fields that fall to half nowhere."""
    if "fwhm_difference" not in ds or bool(ds["fwhm_difference"].isnull().all()):
        return []
    return [f"widths differ by up to {float(abs(ds['fwhm_difference']).max()) * 1000:.4g} mm"]


@command(example="beamprop convert comsol_export.txt field.nc")
@click.argument("source", type=SOURCE)
@click.argument("target", type=target())
@option("--x", text="The file's coordinate that is lateral.", shown="its first", group=GROUP)
@option("--z", text="The file's coordinate that is depth.", shown="its second", group=GROUP)
@option("--expression", text="The expression that is the pressure, where several may be.", group=GROUP)
@COMSOL
@switch("--split-complex", text="Write real and imaginary parts as variables of their own.", group="Output")
@option(
    "--digits", kind=COUNT, text="Keep so many digits of each variable's largest value, compressed.", group="Output"
)
@switch("--quiet", "-q", text="Print nothing but warnings.", group="Output")
def convert(source: Path, target: Path, quiet: bool, grid: Any, **o: Any) -> None:
    """Bring a file to another format.

    From COMSOL's text, .nc, .zarr or .mat to .nc, .zarr, .mat (MATLAB), .vti, .vtr (ParaView) or .csv; .nc4, .netcdf
    and .h5 are the same as .nc. A file or store of that name is replaced.
    """
    from ..io.exports import write

    def ask() -> xr.Dataset:
        about = {name: o[name] for name in ("x", "z", "expression", "length_unit", "angle_unit")}
        refuse_unused(about, source)
        return on_grid(grid, read(source, **about))[0]

    ds = answer({"output": None, "as_json": False, "quiet": True}, ask, None, str)
    options = {name: o[name] for name in ("split_complex", "digits") if o[name]}

    def written() -> None:
        with named("TARGET", "ds", "path"):
            write(ds, target, **options)

    attempt(written)
    if not quiet:
        click.echo(f"wrote {target}")


COMMANDS = (compare, convert)
