"""The questions, under the names that they have in Python."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from .. import parameters
from ..parameters import spaced
from .answer import answer, table
from .options import BEAM, CELL, OUTPUT, OUTPUT_WITHOUT_PLOT, SLAB, Axis, given, option

if TYPE_CHECKING:
    import xarray as xr


@click.command(name="beam_width")
@SLAB
@BEAM
@option("--frequency", default="2000:3000:101", kind=Axis(), text="[Hz], an axis.")
@option("--z0", default=0.0, text=parameters.BEAM["z0"].text)
@click.option("--air-distance", type=float, help="Of the comparison without the slab [m]; two wavelengths by default.")
@OUTPUT
def beam_width(**o: Any) -> None:
    """Beam widths against frequency or angle (the paper's Fig. 6)."""

    def ask() -> xr.Dataset:
        from ..api.beam_width import beam_width as question

        return question(
            parameters.slab(given(o, parameters.SLAB)),
            parameters.beam(given(o, parameters.BEAM)),
            o["frequency"],
            o["angle"],
            o["rtol"],
            o["air_distance"],
            progress=not o["quiet"],
        )

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        return plot.width(ds)

    _needs_axis(o, "frequency", "angle")
    names = ("fwhm_launch", "fwhm_in", "fwhm_out", "fwhm_air")
    answer(o, ask, draw, lambda ds: "widths [cm]\n" + table(ds, names, 100.0))


def _needs_axis(o: dict[str, Any], *names: str) -> None:
    if o["plot"] and not any(isinstance(o[n], list) for n in names):
        raise click.UsageError(f"--plot: expected an axis for {' or '.join('--' + n for n in names)}, got one value")


@click.command(name="beam_measures")
@SLAB
@BEAM
@option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@option("--z0", default=0.0, text=parameters.BEAM["z0"].text)
@click.option("--window", type=float, help="Half-width of the window [m]; as wide as the beam by default.")
@OUTPUT_WITHOUT_PLOT
def beam_measures(**o: Any) -> None:
    """Reflected and transmitted beam: widths by three definitions, place, shift, power, divergence."""

    def ask() -> xr.Dataset:
        from ..api.beam_measures import beam_measures as question

        beam = parameters.beam(given(o, parameters.BEAM))
        return question(
            parameters.slab(given(o, parameters.SLAB)),
            beam,
            o["frequency"],
            o["angle"],
            o["rtol"],
            window=o["window"],
            progress=not o["quiet"],
        )

    names = ("fwhm", "width_1e2", "centroid", "lateral_shift", "power", "divergence")
    answer(o | {"plot": None}, ask, None, lambda ds: table(ds, names))


@click.command()
@SLAB
@BEAM
@option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@option("--z0", default=-0.1, text=parameters.BEAM["z0"].text)
@option("--x", default="-0.7:0.7:561", kind=Axis(), text="Lateral positions [m], an axis.")
@click.option(
    "--z", type=Axis(), help="Depths [m], an axis; from the launch plane to a little behind the slab by default."
)
@option("--boundary", default="open", kind=click.Choice(["open", "periodic"]), text="One beam, or a periodic array.")
@click.option("--period", type=float, help="Of the periodic array [m].")
@option("--quantity", default="abs", kind=click.Choice(["abs", "real"]), text="What --plot draws.")
@click.option(
    "--memory",
    type=click.FloatRange(min=0, min_open=True),
    help="Write --output block by block, each of at most this many MiB: for maps larger than memory.",
)
@OUTPUT
def field(**o: Any) -> None:
    """The pressure field of a beam in front of, inside and behind the slab (the paper's Fig. 5)."""

    def ask() -> xr.Dataset:
        from ..api.field import field

        slab = parameters.slab(given(o, parameters.SLAB))
        z = o["z"] if o["z"] is not None else spaced(o["z0"], 1.25 * slab.thickness, 561)
        question = (
            slab,
            parameters.beam(given(o, parameters.BEAM)),
            o["frequency"],
            o["x"],
            z,
            o["angle"],
            o["boundary"],
            o["period"],
            o["rtol"],
        )
        if o["memory"] is None:
            return field(*question, progress=not o["quiet"])
        from ..api.save_field import save_field

        return save_field(o["output"], *question, memory=o["memory"] * 2**20, progress=not o["quiet"])

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        return plot.field(ds, o["quantity"])

    if o["plot"] and (isinstance(o["frequency"], list) or isinstance(o["angle"], list)):
        raise click.UsageError("--plot: expected one frequency and one angle, got several")
    if o["plot"] and not (isinstance(o["x"], list) and isinstance(o["z"] or [], list)):
        raise click.UsageError("--plot: expected axes for --x and --z, got one value")
    if o["memory"] is not None and (o["plot"] or o["as_json"] or not o["output"]):
        raise click.UsageError("--memory: expected --output alone, for a map that is written and never held")
    answer(o, ask, draw, _field_summary, saved=o["memory"] is not None)


def _field_summary(ds: xr.Dataset) -> str:
    sizes = ", ".join(f"{d} {n}" for d, n in ds.sizes.items())
    largest = f"; largest |p| {float(abs(ds['p']).max()):.6g} Pa" if "p" in ds else ""
    lines = [f"p on ({sizes}){largest}"]
    if "error_estimate" in ds:
        lines.append(f"estimated error {float(ds['error_estimate'].max()):.1e} of the largest |p| of a plane")
    return "\n".join(lines)


@click.command()
@SLAB
@option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@click.option("--kx-over-k0", type=Axis(), help="An axis; 0:5:1001 by default.")
@click.option("--kx", type=Axis(), help="[rad/m], an axis.")
@click.option("--angle", type=Axis(), help="[degree], an axis.")
@option(
    "--quantity",
    default="transmissivity",
    kind=click.Choice(["transmissivity", "reflectivity", "energy_transmission", "absorption"]),
    text="What --plot draws.",
)
@click.option("--log", is_flag=True, help="Draw on a logarithmic scale.")
@OUTPUT
def scattering(**o: Any) -> None:
    """Plane-wave reflection and transmission against kx or angle (the paper's Figs. 2 and 3)."""
    axes = {n: o[n] for n in ("kx_over_k0", "kx", "angle") if o[n] is not None} or {
        "kx_over_k0": spaced(0.0, 5.0, 1001)
    }

    def ask() -> xr.Dataset:
        from ..api.scattering import scattering as question

        return question(parameters.slab(given(o, parameters.SLAB)), o["frequency"], **axes)

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        return plot.scattering(ds, o["quantity"], log=o["log"])

    if o["plot"] and not any(isinstance(v, list) for v in axes.values()):
        raise click.UsageError("--plot: expected an axis for kx, kx-over-k0 or angle, got one value")
    names = ("transmissivity", "reflectivity", "energy_transmission", "absorption")
    answer(o, ask, draw, lambda ds: table(ds, names))


@click.command()
@CELL
@option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@option("--kx-over-k0", default="-10:10:801", kind=Axis(), text="An axis.")
@OUTPUT
def bloch(**o: Any) -> None:
    """Bloch wavenumber of the infinite medium against kx: equifrequency contours (the paper's Fig. 4)."""

    def ask() -> xr.Dataset:
        from ..api.bloch import bloch

        cell, background = parameters.cell(given(o, parameters.CELL))
        return bloch(cell, o["frequency"], kx_over_k0=o["kx_over_k0"], background=background)

    def draw(ds: xr.Dataset) -> Any:
        from .. import plot

        return plot.bloch(ds)

    def summary(ds: xr.Dataset) -> str:
        kz = ds["kz_over_k0"]
        return table(ds.assign({"Re kz/k0": kz.real, "Im kz/k0": kz.imag}), ("Re kz/k0", "Im kz/k0"))

    _needs_axis(o, "kx_over_k0")
    answer(o, ask, draw, summary)


@click.command(name="guided_modes")
@SLAB
@option("--frequency", default="2500", kind=Axis(), text="[Hz], an axis.")
@option("--kx-over-k0-max", default=10.0, text="Search up to this Re kx over k0.")
@option("--strip-over-k0", default=0.5, text="Search up to this |Im kx| over k0.")
@OUTPUT_WITHOUT_PLOT
def guided_modes(**o: Any) -> None:
    """The modes that the slab guides, with the direction of their energy."""

    def ask() -> xr.Dataset:
        from ..api.guided_modes import guided_modes as question

        return question(
            parameters.slab(given(o, parameters.SLAB)), o["frequency"], o["kx_over_k0_max"], o["strip_over_k0"]
        )

    def summary(ds: xr.Dataset) -> str:
        if ds.sizes["mode"] == 0:
            return "no guided mode in the strip"
        k = ds["kx_over_k0"]
        return table(ds.assign({"Re kx/k0": k.real, "Im kx/k0": k.imag}), ("Re kx/k0", "Im kx/k0", "direction"))

    answer(o | {"plot": None}, ask, None, summary)


COMMANDS = (field, beam_width, beam_measures, scattering, bloch, guided_modes)
#: Names that commands had before they had those of Python.
ALIASES = {"width": "beam_width", "spectrum": "scattering", "modes": "guided_modes"}
