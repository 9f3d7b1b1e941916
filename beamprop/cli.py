"""The command `beamprop`: field, width, spectrum, bloch. The paper's parameters are the defaults.

Data go to stdout, progress and warnings to stderr; wrong use exits with 2. Everything heavy is imported inside the
commands, so that ``beamprop --help`` is instant.
"""

from __future__ import annotations

import json
import sys
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ._version import __version__

if TYPE_CHECKING:
    import xarray as xr

    from .media import Slab


class Number(click.ParamType):
    """A complex number as Python writes it: 0.05+0.05j."""

    name = "complex"

    def convert(self, value: Any, param: Any, ctx: Any) -> complex:
        try:
            return complex(str(value).replace(" ", "").replace("i", "j"))
        except ValueError:
            self.fail(f"expected a number such as 0.05 or 0.05+0.05j, got {value!r}", param, ctx)


class Axis(click.ParamType):
    """A number, numbers with commas between, or start:stop:count."""

    name = "axis"

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        try:
            if ":" in value:
                start, stop, count = value.split(":")
                return _spaced(float(start), float(stop), int(count))
            numbers = [float(v) for v in value.split(",")]
        except ValueError:
            self.fail(f"expected a number, a,b,c or start:stop:count, got {value!r}", param, ctx)
        return numbers[0] if len(numbers) == 1 else numbers


def _spaced(start: float, stop: float, count: int) -> list[float]:
    if count < 1:
        raise ValueError(count)
    step = (stop - start) / max(1, count - 1)
    return [start + i * step for i in range(count - 1)] + [stop if count > 1 else start]


class Target(click.ParamType):
    """A file to write, with one of some endings, in a folder that exists."""

    name = "file"

    def __init__(self, *endings: str) -> None:
        self.endings = endings

    def convert(self, value: Any, param: Any, ctx: Any) -> Path:
        path = Path(value)
        if path.suffix.lower() not in self.endings:
            self.fail(f"expected a name ending in {' or '.join(self.endings)}, got {str(value)!r}", param, ctx)
        if not path.parent.is_dir():
            self.fail(f"expected a file in an existing folder, got {str(value)!r}", param, ctx)
        return path


Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def _all(*options: Decorator) -> Decorator:
    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate


def _option(*names: str, default: Any, kind: Any = None, text: str, show: bool | str = True) -> Decorator:
    return click.option(*names, default=default, type=kind, show_default=show, help=text)


CELL = _all(
    _option("--rho-m", default="0.05+0.05j", kind=Number(), text="Mean relative density."),
    _option("--delta-rho", default=0.025, text="Modulation of the loss."),
    click.option("--lossless", is_flag=True, help="Drop the losses: Im(rho-m) and delta-rho."),
    _option("--n-layers", default=10, text="Layers in a period."),
    _option("--eta", default=1 / 60, text="Period over the wavelength at the design frequency.", show="1/60"),
    _option("--design-frequency", default=2500.0, text="[Hz]"),
    _option("--density", default="1.25", kind=Number(), text="Of the background and both half-spaces [kg/m3]."),
    _option("--sound-speed", default="343", kind=Number(), text="Of the background and both half-spaces [m/s]."),
)
SLAB = _all(
    CELL,
    _option("--periods", default=450, text="Periods of the slab."),
    _option(
        "--medium",
        default="exact",
        kind=click.Choice(["exact", "lmmd-emt", "lmmd-emt-bare", "standard-emt", "none"]),
        text="The layers themselves, an effective medium (bare: without the interface term), or background only.",
    ),
    click.option("--after-density", type=Number(), help="Of the half-space behind, if it differs [kg/m3]."),
    click.option("--after-speed", type=Number(), help="Of the half-space behind, if it differs [m/s]."),
)
BEAM = _all(
    _option("--fwhm", default=0.096, text="Full width at half maximum at the launch plane [m]."),
    _option(
        "--angle", default="0", kind=Axis(), text="From the normal [degree]; an axis: a, a,b,c or start:stop:count."
    ),
    _option("--x0", default=0.0, text="Middle of the beam [m]."),
    _option(
        "--width-of",
        default="pressure",
        kind=click.Choice(["pressure", "intensity"]),
        text="What fwhm is the width of.",
    ),
    _option("--form", default="launch", kind=click.Choice(["launch", "rotated"]), text="Kind of oblique beam."),
    _option("--rtol", default=1e-8, text="Asked relative error."),
)
OUTPUT = _all(
    click.option("--output", "-o", type=Target(".nc", ".zarr"), help="Write the dataset to this .nc or .zarr."),
    click.option("--plot", "-p", type=Target(".png", ".pdf"), help="Draw it into this .png or .pdf."),
    click.option("--json", "as_json", is_flag=True, help="Print the dataset as JSON."),
    click.option("--quiet", "-q", is_flag=True, help="Print nothing but what was asked for by --json."),
)


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="beamprop")
def main() -> None:
    """Acoustic beams through exactly solved layered slabs, in open space.

    Without options, each command answers for the slab of the paper: 450 periods of 10 layers, designed for 2500 Hz. An
    axis is a number, numbers with commas between, or start:stop:count.
    """


# --- from options to objects ------------------------------------------------------------------------------


def _cell(o: dict[str, Any]) -> Any:
    from .media import Fluid, lmmd_cell

    background = Fluid.from_speed(o["density"], o["sound_speed"])
    rho_m, delta_rho = o["rho_m"], o["delta_rho"]
    if o["lossless"]:
        rho_m, delta_rho = rho_m.real, 0.0
    return lmmd_cell(rho_m, delta_rho, o["n_layers"], o["eta"], o["design_frequency"], background), background


def _slab(o: dict[str, Any]) -> Slab:
    from .homogenize import lmmd_emt_slab, standard_emt
    from .media import Fluid, Slab

    cell, before = _cell(o)
    after = before
    if o["after_density"] is not None or o["after_speed"] is not None:
        after = Fluid.from_speed(o["after_density"] or o["density"], o["after_speed"] or o["sound_speed"])
    slab = Slab(cell, o["periods"], before, after)
    if o["medium"].startswith("lmmd"):
        return lmmd_emt_slab(slab, interface=o["medium"] == "lmmd-emt")
    if o["medium"] != "exact":
        fluid = standard_emt(cell) if o["medium"] == "standard-emt" else before
        return Slab.uniform(fluid, slab.thickness, before, after)
    return slab


def _beam(o: dict[str, Any], z0: float = 0.0) -> Any:
    from .beam import GaussianBeam

    return GaussianBeam(o["fwhm"], 0.0, o["x0"], z0, o["width_of"], o["form"])


def _progress(quiet: bool, what: str) -> Callable[[Iterable[Any]], Iterable[Any]]:
    """A bar on stderr for work that takes more than a second."""

    def wrap(items: Iterable[Any]) -> Iterable[Any]:
        from tqdm import tqdm

        return tqdm(items, desc=what, delay=1.0, file=sys.stderr, disable=quiet, leave=False)

    return wrap


# --- from datasets to stdout and files --------------------------------------------------------------------


def _answer(
    o: dict[str, Any],
    ask: Callable[[], xr.Dataset],
    draw: Callable[[xr.Dataset], Any],
    summary: Callable[[xr.Dataset], str],
) -> None:
    """Ask, write, draw, print. A ValueError is wrong use: exit 2."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            ds = ask()
        except ValueError as error:
            raise click.UsageError(str(error)) from None
    for w in caught:
        if not issubclass(w.category, DeprecationWarning):
            click.echo(f"warning: {w.message}", err=True)
    try:
        if o["output"]:
            from .storage import save

            save(ds, o["output"])
        if o["plot"]:
            _draw(ds, draw, o["plot"])
    except (OSError, ImportError) as error:
        raise click.ClickException(str(error)) from None
    if o["as_json"]:
        click.echo(json.dumps(_plain(ds.to_dict()), allow_nan=False))
    elif not o["quiet"]:
        click.echo(summary(ds))
        for path in filter(None, (o["output"], o["plot"])):
            click.echo(f"wrote {path}")


def _draw(ds: xr.Dataset, draw: Callable[[xr.Dataset], Any], path: Path) -> None:
    import matplotlib

    matplotlib.use("agg")
    import matplotlib.pyplot as plt

    from .storage import write_whole

    figure = draw(ds).figure
    write_whole(path, lambda draft: figure.savefig(draft, dpi=150))
    plt.close(figure)


def _plain(value: Any) -> Any:
    """What JSON can hold: complex numbers as {re, im}, nan as null."""
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    if isinstance(value, complex):
        return {"re": _plain(value.real), "im": _plain(value.imag)}
    if isinstance(value, float) and not -1e400 < value < 1e400:
        return None
    return value


def _table(ds: xr.Dataset, names: tuple[str, ...], scale: float = 1.0, most: int = 12) -> str:
    """A few rows of a dataset as text."""
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


# --- the commands -----------------------------------------------------------------------------------------


@main.command()
@SLAB
@BEAM
@_option("--frequency", default="2000:3000:101", kind=Axis(), text="[Hz], an axis.")
@_option("--z0", default=0.0, text="Launch plane, at or in front of the near face at 0 [m].")
@click.option("--air-distance", type=float, help="Of the comparison without the slab [m]; two wavelengths by default.")
@OUTPUT
def width(**o: Any) -> None:
    """Beam widths against frequency or angle (the paper's Fig. 6)."""

    def ask() -> xr.Dataset:
        from .questions import beam_width

        return beam_width(
            _slab(o),
            _beam(o, o["z0"]),
            o["frequency"],
            o["angle"],
            o["rtol"],
            o["air_distance"],
            progress=_progress(o["quiet"], "widths"),
        )

    def draw(ds: xr.Dataset) -> Any:
        from . import plot

        return plot.width(ds)

    _needs_axis(o, "frequency", "angle")
    names = ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air")
    _answer(o, ask, draw, lambda ds: "widths [cm]\n" + _table(ds, names, 100.0))


def _needs_axis(o: dict[str, Any], *names: str) -> None:
    if o["plot"] and not any(isinstance(o[n], list) for n in names):
        raise click.UsageError(f"--plot: expected an axis for {' or '.join('--' + n for n in names)}, got one value")


@main.command()
@SLAB
@BEAM
@_option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@_option("--z0", default=-0.1, text="Launch plane, at or in front of the near face at 0 [m].")
@_option("--x", default="-0.7:0.7:561", kind=Axis(), text="Lateral positions [m], an axis.")
@click.option(
    "--z", type=Axis(), help="Depths [m], an axis; from the launch plane to a little behind the slab by default."
)
@_option("--boundary", default="open", kind=click.Choice(["open", "periodic"]), text="One beam, or a periodic array.")
@click.option("--period", type=float, help="Of the periodic array [m].")
@_option("--quantity", default="abs", kind=click.Choice(["abs", "real"]), text="What --plot draws.")
@OUTPUT
def field(**o: Any) -> None:
    """The pressure field of a beam in front of, inside and behind the slab (the paper's Fig. 5)."""

    def ask() -> xr.Dataset:
        from .questions import field

        slab = _slab(o)
        z = o["z"] or _spaced(o["z0"], 1.25 * slab.thickness, 561)
        return field(
            slab,
            _beam(o, o["z0"]),
            o["frequency"],
            o["x"],
            z,
            o["angle"],
            o["boundary"],
            o["period"],
            o["rtol"],
            progress=_progress(o["quiet"], "fields"),
        )

    def draw(ds: xr.Dataset) -> Any:
        from . import plot

        return plot.field(ds, o["quantity"])

    if o["plot"] and (isinstance(o["frequency"], list) or isinstance(o["angle"], list)):
        raise click.UsageError("--plot: expected one frequency and one angle, got several")
    _answer(o, ask, draw, _field_summary)


def _field_summary(ds: xr.Dataset) -> str:
    sizes = ", ".join(f"{d} {n}" for d, n in ds["p"].sizes.items())
    lines = [f"p on ({sizes}); largest |p| {float(abs(ds['p']).max()):.6g} Pa"]
    if "error_estimate" in ds:
        lines.append(f"estimated error {float(ds['error_estimate'].max()):.1e} of the largest |p| of a plane")
    return "\n".join(lines)


@main.command()
@SLAB
@_option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@click.option("--kx-over-k0", type=Axis(), help="An axis; 0:5:1001 by default.")
@click.option("--kx", type=Axis(), help="[rad/m], an axis.")
@click.option("--angle", type=Axis(), help="[degree], an axis.")
@_option(
    "--quantity",
    default="transmissivity",
    kind=click.Choice(["transmissivity", "reflectivity", "energy_transmission", "absorption"]),
    text="What --plot draws.",
)
@click.option("--log", is_flag=True, help="Draw on a logarithmic scale.")
@OUTPUT
def spectrum(**o: Any) -> None:
    """Plane-wave reflection and transmission against kx or angle (the paper's Figs. 2 and 3)."""
    axes = {n: o[n] for n in ("kx_over_k0", "kx", "angle") if o[n] is not None} or {
        "kx_over_k0": _spaced(0.0, 5.0, 1001)
    }

    def ask() -> xr.Dataset:
        from .questions import scattering

        return scattering(_slab(o), o["frequency"], **axes)

    def draw(ds: xr.Dataset) -> Any:
        from . import plot

        return plot.scattering(ds, o["quantity"], log=o["log"])

    if o["plot"] and not any(isinstance(v, list) for v in axes.values()):
        raise click.UsageError("--plot: expected an axis for kx, kx-over-k0 or angle, got one value")
    names = ("transmissivity", "reflectivity", "energy_transmission", "absorption")
    _answer(o, ask, draw, lambda ds: _table(ds, names))


@main.command()
@CELL
@_option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@_option("--kx-over-k0", default="-10:10:801", kind=Axis(), text="An axis.")
@OUTPUT
def bloch(**o: Any) -> None:
    """Bloch wavenumber of the infinite medium against kx: equifrequency contours (the paper's Fig. 4)."""

    def ask() -> xr.Dataset:
        from .questions import bloch

        cell, background = _cell(o)
        return bloch(cell, o["frequency"], kx_over_k0=o["kx_over_k0"], background=background)

    def draw(ds: xr.Dataset) -> Any:
        from . import plot

        return plot.bloch(ds)

    def summary(ds: xr.Dataset) -> str:
        kz = ds["kz_over_k0"]
        return _table(ds.assign({"Re kz/k0": kz.real, "Im kz/k0": kz.imag}), ("Re kz/k0", "Im kz/k0"))

    _needs_axis(o, "kx_over_k0")
    _answer(o, ask, draw, summary)


if __name__ == "__main__":
    main()
