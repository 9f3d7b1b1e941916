"""The questions, asked by plain values: what the command line and study files share.

A description is a table of tables: `question` (its `name` and arguments), `slab` and `beam` with the names that
`parameters` has for them, and perhaps `tolerance`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from .. import parameters
from ..parameters import AXES, Axis, Parameter, read, spaced
from ..progress import Progress

if TYPE_CHECKING:
    import xarray as xr

    from ..media.structures import Slab

Description = Mapping[str, Any]


def _axis(name: str) -> Parameter:
    def parse(value: Any, given: str) -> Axis:
        import numpy as np

        # of what is parsed already the question says which magnitudes it can use
        parsed = isinstance(value, np.ndarray) or (isinstance(value, float) and math.isfinite(value))
        return value if parsed else parameters.axis(value, given, AXES[name])

    return Parameter(None, parse, "An axis.", units=AXES[name])


def _names(value: Any, name: str) -> list[str]:
    """Names as a list, or as text with commas between."""
    from .. import validate

    parts = [part.strip() for part in value.split(",")] if isinstance(value, str) else value
    if not isinstance(parts, list | tuple) or not all(isinstance(part, str) for part in parts):
        raise validate.refuse(name, "names such as p, v_x", value)
    return list(parts)


_FREQUENCY = {"frequency": _axis("frequency")}
_BEAM = _FREQUENCY | {"angle": _axis("angle"), "rtol": Parameter(1e-8, parameters.real, "Requested relative error.")}
#: What a plane wave may be given by.
LATERAL = ("kx_over_k0", "kx", "angle")
#: Name -> what each question may be asked with.
QUESTIONS: dict[str, dict[str, Parameter]] = {
    "field": _BEAM
    | {
        "x": _axis("x"),
        "y": _axis("y"),
        "z": _axis("z"),
        "boundary": Parameter(
            "open", parameters.as_it_is, "One beam, or a periodic array.", words=("open", "periodic")
        ),
        "period": Parameter(
            None, parameters.lengths, "Of the periodic array [m]; with y two, along x and y: 30mm,15mm."
        ),
        "variables": Parameter("p", _names, "p, v_x, v_z, intensity, power_through; with y v_y too."),
        "average": Parameter(None, parameters.as_it_is, "Mean over a cell about each plane.", words=("cell",)),
    },
    "beam_width": _BEAM
    | {
        "air_distance": Parameter(
            None, parameters.length, "Of the comparison without the slab, in the medium in front [m]."
        )
    },
    "beam_measures": _BEAM | {"window": Parameter(None, parameters.length, "Half-width of the window [m].")},
    "scattering": _FREQUENCY | {name: _axis(name) for name in LATERAL},
    "bloch": _FREQUENCY | {"kx_over_k0": _axis("kx_over_k0")},
    "guided_modes": _FREQUENCY
    | {
        "kx_over_k0_max": Parameter(10.0, parameters.real, "Search up to this Re kx over k0."),
        "strip_over_k0": Parameter(0.5, parameters.real, "Search up to this |Im kx| over k0."),
        "leaky": Parameter(False, parameters.switch, "Those that radiate as they run along, too."),
    },
}


def _number(value: Any, name: str) -> int:
    from .. import validate

    return validate.as_count(value, name, least=0)


#: Errors of manufacture: a random copy of the slab takes its place.
TOLERANCE: dict[str, Parameter] = {
    "thickness": Parameter(0.0, parameters.real, "Relative standard deviation of each layer's thickness."),
    "density": Parameter(0.0, parameters.real, "Relative standard deviation of each layer's density."),
    "seed": Parameter(0, _number, "Of the random numbers."),
    "sample": Parameter(0, _number, "Number of the copy, from 0."),
}
#: Questions about a beam.
OF_BEAMS = ("field", "beam_width", "beam_measures")


def ask(description: Description, progress: Progress = False) -> xr.Dataset:
    """The answer to a question.

    Raises
    ------
    ValueError
        Names the key of the table that is wrong.

    Examples
    --------
    >>> ask({"question": {"name": "scattering", "angle": 0}, "slab": {"periods": 20}}).transmissivity.dims
    ()
    """
    return _ASK[description["question"]["name"]](description, progress)


def slab_of(description: Description) -> tuple[Slab, parameters.Design]:
    """The slab, and what defaults are taken by."""
    table, slab = description.get("slab", {}), structure_of(description)
    around = {key: value for key, value in table.items() if key != "stack"} | (
        {"layers": ""} if "stack" in table else {}
    )
    return slab, parameters.design(around, slab.before, arguments(description)["frequency"])


def structure_of(description: Description) -> Slab:
    """The slab, whatever is asked of it."""
    table = description.get("slab", {})
    slab = parameters.stack(table) if "stack" in table else parameters.slab(table)
    if "tolerance" in description:
        slab = _copy_of(slab, read(description["tolerance"], TOLERANCE, "tolerance"))
    return slab


def _copy_of(slab: Slab, values: Mapping[str, Any]) -> Slab:
    from ..media.tolerance import tolerance

    with parameters.named("tolerance.thickness", "thickness"), parameters.named("tolerance.density", "density"):
        copies = tolerance(slab, values["thickness"], values["density"], values["sample"] + 1, values["seed"])
    return copies[values["sample"]]


def arguments(description: Description) -> dict[str, Any]:
    """The question's own arguments, parsed."""
    table = {key: value for key, value in description["question"].items() if key != "name"}
    name = description["question"]["name"]
    return read(table, QUESTIONS[name], name)


def field_arguments(description: Description) -> dict[str, Any]:
    """The arguments of `field`, which are those of `save_field` too; of a source in three dimensions, y is that of its middle by default."""
    given = arguments(description)
    slab, design = slab_of(description)
    table = description.get("beam", {})
    z0 = parameters.length(table.get("z0", design.launch), "z0")
    beam = parameters.beam({**table, "z0": z0}, design.scale)
    if given["y"] is None and not getattr(beam, "in_space_only", False):
        del given["y"]
    elif given["y"] is None:
        given["y"] = float(getattr(beam, "y0", 0.0))
    return given | {
        "slab": slab,
        "beam": beam,
        "frequency": _or(given["frequency"], design.frequency),
        "x": _or(given["x"], design.x),
        "z": design.z(z0, slab) if given["z"] is None else given["z"],
    }


def _or(given: Axis | None, default: Axis) -> Axis:
    return default if given is None else given


def _field(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.field import field

    return field(**field_arguments(description), progress=progress)


def _azimuth(description: Description, beam: Any) -> float | None:
    """That of a beam whose azimuth or y0 is said, though it be 0 as at a point of a sweep: its widths are of three dimensions."""
    return beam.azimuth if {"azimuth", "y0"} & description.get("beam", {}).keys() else None


def _beam_width(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.beam_width import beam_width

    given = arguments(description)
    slab, design = slab_of(description)
    beam = parameters.beam(description.get("beam", {}), design.scale)
    frequency = _or(given["frequency"], design.band)
    about = {"air_distance": given["air_distance"], "azimuth": _azimuth(description, beam), "progress": progress}
    return beam_width(slab, beam, frequency, given["angle"], given["rtol"], **about)


def _beam_measures(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.beam_measures import beam_measures

    given = arguments(description)
    slab, design = slab_of(description)
    beam = parameters.beam(description.get("beam", {}), design.scale)
    frequency = _or(given["frequency"], design.frequency)
    about = {"window": given["window"], "azimuth": _azimuth(description, beam), "progress": progress}
    return beam_measures(slab, beam, frequency, given["angle"], given["rtol"], **about)


def lateral_of(given: Mapping[str, Any]) -> dict[str, Any]:
    """What the plane waves of `scattering` are given by."""
    axes = {name: given[name] for name in LATERAL if given[name] is not None}
    if len(axes) > 1:
        raise ValueError(f"{', '.join(axes)}: expected exactly one of them, got {len(axes)}")
    return axes or {"kx_over_k0": spaced(0.0, 5.0, 1001)}


def _scattering(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.scattering import scattering

    given = arguments(description)
    slab, design = slab_of(description)
    return scattering(slab, _or(given["frequency"], design.frequency), **lateral_of(given))


def _bloch(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.bloch import bloch

    given, table = arguments(description), description.get("slab", {})
    cell, background = parameters.cell(table)
    design = parameters.design(table, background, given["frequency"])
    kx_over_k0 = _or(given["kx_over_k0"], spaced(-10.0, 10.0, 801))
    with parameters.named("layer", *(("cell",) if design.layered else ())):
        return bloch(cell, _or(given["frequency"], design.frequency), kx_over_k0=kx_over_k0, background=background)


def _guided_modes(description: Description, progress: Progress) -> xr.Dataset:
    from ..api.guided_modes import guided_modes

    given = arguments(description)
    slab, design = slab_of(description)
    frequency = _or(given["frequency"], design.frequency)
    return guided_modes(slab, frequency, given["kx_over_k0_max"], given["strip_over_k0"], leaky=given["leaky"])


_ASK: dict[str, Callable[[Description, Progress], xr.Dataset]] = {
    "field": _field,
    "beam_width": _beam_width,
    "beam_measures": _beam_measures,
    "scattering": _scattering,
    "bloch": _bloch,
    "guided_modes": _guided_modes,
}
