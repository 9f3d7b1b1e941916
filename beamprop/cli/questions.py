"""The questions, under the names that they have in Python."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from .. import parameters
from ..parameters import is_several, spaced
from . import summaries
from .answer import answer, check_output, check_text, progress
from .commands import command
from .failures import typed
from .options import (
    BEAM,
    CELL,
    LENGTH,
    LENGTHS,
    NAMES,
    POSITIVE,
    REAL,
    SLAB,
    axis,
    given,
    launch,
    option,
    output,
    quantity,
    switch,
    words,
)
from .pictures import check_axes, default_axis, drawing, was_typed

if TYPE_CHECKING:
    import xarray as xr

#: What a frequency is by default, for the help.
ONE, BAND = "2500, the design frequency", "2000:3000:101, about the design frequency"


def described(name: str, o: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """What was typed, as the table of tables that studies ask by."""
    from ..study.questions import OF_BEAMS, QUESTIONS

    own = {key: o[key] for key in QUESTIONS[name] if o[key] is not None}
    tables = {"question": {"name": name} | own, "slab": given(o, {k: p for k, p in parameters.SLAB.items() if k in o})}
    return tables | ({"beam": given(o, parameters.BEAM)} if name in OF_BEAMS else {})


def asking(name: str, o: dict[str, Any]) -> Callable[[], xr.Dataset]:
    """The question of a command, to be asked."""

    def ask() -> xr.Dataset:
        from ..study import questions

        return questions.ask(described(name, o), progress(o))

    return ask


@command("beam_width", example="beamprop beam_width --angle 0:60:13 --frequency 2500 --plot width.png")
@SLAB
@BEAM
@axis("frequency", "[Hz], an axis.", BAND)
@launch("0")
@option(
    "--air-distance",
    kind=LENGTH,
    text="Of the comparison without the slab, fwhm_air, in the medium in front [m].",
    shown="two wavelengths",
)
@output("along", "plot_width")
def beam_width(**o: Any) -> None:
    """Beam widths by frequency or angle.

    The paper's Fig. 6. fwhm_air is without the slab, in the medium in front, whatever it is.
    """
    axes = {"frequency": [] if o["frequency"] is None else o["frequency"], "angle": o["angle"]}
    check_axes(o, axes)
    check_output(o, axes)
    answer(o, asking("beam_width", o), drawing("beam_width", o), summaries.beam_width)


@command("beam_measures", example="beamprop beam_measures --angle 30 --lossless --periods 20 --window 1")
@SLAB
@BEAM
@axis("frequency", "[Hz], an axis.", ONE)
@launch("0")
@option("--window", kind=LENGTH, text="Half-width of the window [m].", shown="as wide as the beam")
@quantity("beam_measures")
@output("along", "plot_width")
def beam_measures(**o: Any) -> None:
    """The reflected and transmitted beam, measured.

    Widths by three definitions, place, lateral shift, power and divergence.
    """
    if o["plot"] and not was_typed("angle") and not is_several(o["frequency"]):
        default_axis(o, "angle", "0:60:13")
    axes = {"frequency": o["frequency"], "angle": o["angle"]}
    check_axes(o, axes)
    check_output(o, axes | {"side": []})
    answer(o, asking("beam_measures", o), drawing("beam_measures", o), summaries.beam_measures)


@command(example="beamprop field --layer 'density=1000 speed=1480 2mm' --frequency 1MHz --plot beam.png")
@SLAB
@BEAM
@axis("frequency", "[Hz], an axis.", ONE)
@launch("-0.1, 0.73 wavelengths")
@axis("x", "Lateral positions [m], an axis.", "-0.7:0.7:561, 5.1 wavelengths to both sides")
@axis(
    "y",
    "Positions across x [m], an axis, in three dimensions.",
    "none; through the middle of sources of three dimensions",
)
@axis("z", "Depths [m], an axis.", "from the launch plane to a little behind the slab, on faces of thin cells")
@option(
    "--boundary", kind=words("open", "periodic"), text="One beam, or a periodic array.", default="open", shown="open"
)
@option("--period", kind=LENGTHS, text="Of the periodic array [m]; with y two, along x and y: 30mm,15mm.")
@quantity("field")
@option(
    "--variables",
    kind=NAMES,
    text="Of the dataset, with commas between: p, v_x, v_z, u_x, u_z, s_xz, intensity, power_through; with y v_y, u_y and s_yz too.",
    shown="p",
)
@option(
    "--average", kind=words("cell"), text="Mean over a cell about each plane, inside of which the pressure ripples."
)
@option(
    "--memory",
    kind=POSITIVE,
    text="Write --output block by block, each of at most this many MiB: for maps larger than memory.",
)
@output("plot_width")
def field(**o: Any) -> None:
    """The field of a beam: pressure, velocity, intensity.

    In front of, inside and behind the slab: the paper's Fig. 5.
    """
    variables = o["variables"] or ["p"]

    def ask() -> xr.Dataset:
        import numpy as np

        from ..api.field import field
        from ..api.save_field import save_field
        from ..study.questions import field_arguments

        question = field_arguments(described("field", o))
        if o["as_json"]:
            sizes = [np.size(question[n]) for n in ("frequency", "angle", "x", "z")] + [np.size(question.get("y", 0.0))]
            check_text(math.prod(sizes) * len(variables))
        if o["memory"] is None:
            return field(**question, progress=progress(o))
        with parameters.named("output", "path"):
            return save_field(o["output"], **question, memory=o["memory"] * 2**20, progress=progress(o))

    if o["plot"] and (is_several(o["frequency"]) or is_several(o["angle"])):
        raise click.UsageError("--plot: expected one frequency and one angle, got several")
    flat = [n for n in "xyz" if isinstance(o[n], float) or (n == "y" and o[n] is None)]
    if o["plot"] and len(flat) > 1:
        wanted = "--x and --z" if o["y"] is None else "two or three of --x, --y and --z"
        raise click.UsageError(f"--plot: expected axes for {wanted}, got one value")
    if o["plot"] and "p" not in variables:
        raise click.UsageError(f"--plot: expected p among --variables, got {','.join(variables)}")
    if o["memory"] is not None and (o["plot"] or o["as_json"] or not o["output"]):
        raise click.UsageError("--memory: expected --output alone, for a map that is written and never held")
    check_output(
        o,
        {n: o[n] for n in ("frequency", "angle")} | {n: [] if o[n] is None and n != "y" else o[n] for n in "xyz"},
        field=True,
    )
    saved = o["memory"] is not None
    summary = (lambda ds: summaries.written(ds, variables)) if saved else summaries.field
    answer(o, ask, drawing("field", o), summary, saved)


#: What a plane wave may be given by.
LATERAL = ("kx_over_k0", "kx", "angle")


@command(example="beamprop scattering --frequency 500:5000:451 --angle 0 --plot spectrum.png")
@SLAB
@axis("frequency", "[Hz], an axis.", ONE)
@axis("kx_over_k0", "An axis.", "0:5:1001")
@axis("kx", "[rad/m], an axis.")
@axis("angle", "[degree], an axis.")
@quantity("scattering")
@switch("--log", text="Draw on a logarithmic scale.")
@output("along", "plot_width")
def scattering(**o: Any) -> None:
    """Reflection and transmission of plane waves.

    By kx, angle or frequency: the paper's Figs. 2 and 3.
    """
    axes = {n: o[n] for n in LATERAL if o[n] is not None} or {"kx_over_k0": spaced(0.0, 5.0, 1001)}

    if len(axes) > 1:
        raise click.UsageError(f"{', '.join(map(typed, axes))}: expected exactly one of them, got {len(axes)}")
    check_axes(o, {"frequency": o["frequency"]} | axes)
    check_output(o, {"frequency": o["frequency"]} | axes)
    answer(o, asking("scattering", o), drawing("scattering", o), summaries.scattering)


@command(example="beamprop bloch --eta 1/20 --plot contour.png")
@CELL
@axis("frequency", "[Hz], an axis.", ONE)
@axis("kx_over_k0", "An axis.", "-10:10:801")
@output("along", "plot_width")
def bloch(**o: Any) -> None:
    """Bloch wavenumber: equifrequency contours.

    Of the infinite medium against kx: the paper's Fig. 4.
    """
    kx_over_k0 = spaced(-10.0, 10.0, 801) if o["kx_over_k0"] is None else o["kx_over_k0"]

    axes = {"frequency": o["frequency"], "kx_over_k0": kx_over_k0}
    check_axes(o, axes)
    check_output(o, axes)
    answer(o, asking("bloch", o), drawing("bloch", o), summaries.bloch)


@command("guided_modes", example="beamprop guided_modes --lossless --periods 20")
@SLAB
@axis("frequency", "[Hz], an axis.", ONE)
@option("--kx-over-k0-max", kind=REAL, text="Search up to this Re kx over k0.", default="10", shown="10")
@option("--strip-over-k0", kind=REAL, text="Search up to this |Im kx| over k0.", default="0.5", shown="0.5")
@switch("--leaky", text="Those that radiate as they run along, too.")
@output("plot_width")
def guided_modes(**o: Any) -> None:
    """The modes that the slab guides.

    Each with the direction of its energy.
    """

    check_output(o, {"frequency": o["frequency"], "mode": []})
    answer(o, asking("guided_modes", o), drawing("guided_modes", o), summaries.guided_modes)


COMMANDS = (field, beam_width, beam_measures, scattering, bloch, guided_modes)
#: Names that commands had before they had those of Python.
ALIASES = {"width": "beam_width", "spectrum": "scattering", "modes": "guided_modes"}
