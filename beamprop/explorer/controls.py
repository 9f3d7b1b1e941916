"""The values of a study that the page moves: each with its place in the study, its range on a slider and its bounds."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from .. import parameters
from ..parameters import Parameter
from ..sources.in_space import needs_y
from ..study import questions
from ..study.files import StudyFile

if TYPE_CHECKING:
    from ..media.structures import Slab

Description = dict[str, Any]
#: Beyond its slider a value may be typed, up to so many times the slider's end, down to that part of it.
TYPED = 100.0
MOST_PERIODS, MOST_LAYERS = 100_000, 50_000


@dataclass(frozen=True)
class Control:
    """A value of the study: ``path`` is its place, with parts of complex and composed values below it (``slab.rho_m.im``)."""

    path: str
    label: str
    group: str
    value: Any
    kind: str = "number"  #: or count, switch, word
    unit: str = ""
    low: float = 0.0  #: ends of the slider
    high: float = 1.0
    ratio: bool = False  #: whether equal steps of the slider are equal ratios
    words: tuple[str, ...] = ()
    #: What may be typed at most; of an angle the slider's end, of others more.
    least: float = -math.inf
    most: float = math.inf
    slits: float | None = None  #: where it starts once slits are chosen, if elsewhere

    def checked(self, value: Any) -> Any:
        """The value, as the study file may hold it.

        Raises
        ------
        ValueError
            Names the path.
        """
        from .. import validate

        if self.kind == "switch":
            return validate.flag(value, self.path)
        if self.kind == "word":
            return validate.word(value, self.path, *self.words)
        number = (
            validate.as_number(value, self.path)
            if self.kind == "number"
            else validate.as_count(value, self.path, least=0)
        )
        if not self.least <= number <= self.most:
            raise validate.refuse(self.path, f"a number from {self.least:g} to {self.most:g}", value)
        return number


@dataclass(frozen=True)
class Board:
    """A study as the page has it: what is fixed, and what moves."""

    title: str
    document: Mapping[str, Any]
    controls: tuple[Control, ...]

    def at(self, path: str) -> Control:
        """The control of a path."""
        return next(control for control in self.controls if control.path == path)


def board(study: StudyFile | None = None) -> Board:
    """The controls of a study, or of the paper's slab.

    Examples
    --------
    >>> from beamprop.explorer.controls import board
    >>> board().at("slab.eta").value
    0.016666666666666666
    """
    document = _document(study)
    ranges = dict(_swept(study))
    slab, design = questions.slab_of(document)
    if "stack" not in document["slab"]:
        document["slab"].setdefault("periods", 1 if design.layered else parameters.SLAB["periods"].default)
    made = [
        *_of_beam(document, design),
        *_of_slab(document, design),
        *_of_tolerance(document),
        *_of_view(document, design, slab),
    ]
    controls = (_bounded(_over(control, ranges.get(control.path))) for control in made)
    title = "the slab of the paper" if study is None else study.path.name
    return Board(title, document, tuple(controls))


def _document(study: StudyFile | None) -> Description:
    """The description at the first point of the sweep: tables where words may stand, and none that is missing."""
    if study is None:
        document: Description = {"question": {"name": "beam_width"}}
    else:
        document = study.point.at(**{name: values[0] for name, values in study.axes.items()})
        document = copy.deepcopy(document)
    for table in ("slab", "beam"):
        document.setdefault(table, {})
    for part in (document["slab"], *document["slab"].get("stack", ())):
        if part.get("layer") is not None:
            layers = part["layer"] if isinstance(part["layer"], list | tuple) else [part["layer"]]
            part["layer"] = [
                parameters.described(v, "layer", parameters.LAYER) if isinstance(v, str) else dict(v) for v in layers
            ]
    return document


def _swept(study: StudyFile | None) -> Iterator[tuple[str, list[Any]]]:
    if study is not None:
        yield from ((study.point.paths[name], values) for name, values in study.axes.items())


def _over(control: Control, values: list[Any] | None) -> Control:
    """The control over the values of a sweep, where they are numbers."""
    if values is None or control.kind not in ("number", "count") or len(values) < 2:
        return control
    return replace(control, low=float(min(values)), high=float(max(values)), ratio=False)


def _bounded(control: Control) -> Control:
    if control.kind not in ("number", "count"):
        return control
    far = TYPED * max(abs(control.low), abs(control.high), abs(control.value))
    near = control.low / TYPED if control.ratio else 0.0
    below = -far if control.low < 0 else control.low if control.kind == "count" else near
    least = below if control.least == -math.inf else control.least
    return replace(control, least=least, most=far if control.most == math.inf else control.most)


# --- the beam -----------------------------------------------------------------------------------------------


def _of_beam(document: Mapping[str, Any], design: parameters.Design) -> Iterator[Control]:
    own, beam = questions.arguments(document), document["beam"]
    wave, group = design.wavelength, "Beam"
    if own.get("y") is not None or needs_y(parameters.beam(beam, design.scale)):
        raise ValueError("beam: expected a source of two dimensions on the page, got one of three: ask field for it")
    angle = _middle(own.get("angle"), 0.0)
    yield Control("question.angle", "Angle", group, angle, unit="°", low=-80, high=80, least=-89.9, most=89.9)
    frequency = _middle(own["frequency"], design.frequency)
    low, high = _ends(own["frequency"], 0.5 * frequency, 1.5 * frequency)
    yield Control("question.frequency", "Frequency", group, frequency, unit="Hz", low=low, high=high)
    source = next((name for name in ("slits", "profile") if beam.get(name) is not None), "gaussian")
    kinds = ("gaussian", "slits", *(("profile",) if source == "profile" else ()))
    yield Control("beam.source", "Source", group, source, "word", words=kinds)
    values = parameters.read(
        {k: v for k, v in beam.items() if k not in ("slits", "profile")}, parameters.BEAM, "beam", design.scale
    )
    # as the question has it: maps of `field` begin in front of the slab, all else at its near face, where the many plane waves of
    # slits take long: chosen on the page, they start in front
    in_front = document["question"]["name"] == "field" and "z0" not in beam
    z0 = design.launch if in_front else values["z0"]
    of_slits = design.launch if source == "gaussian" and "z0" not in beam else None
    about: dict[str, Any] = {"group": group, "unit": "m"}
    yield Control(
        "beam.fwhm", "Width at launch", value=values["fwhm"], low=0.1 * wave, high=6 * wave, ratio=True, **about
    )
    width, separation, count = (
        parameters.BEAM["slits"].parse(beam["slits"], "slits")
        if beam.get("slits") is not None
        else (0.1 * wave, 0.4 * wave, 2)
    )
    yield Control("beam.slits.width", "Slit width", value=width, low=0.02 * wave, high=wave, ratio=True, **about)
    yield Control(
        "beam.slits.separation", "Slit spacing", value=separation, low=0.05 * wave, high=4 * wave, ratio=True, **about
    )
    yield Control("beam.slits.count", "Slits", group, count, "count", low=1, high=12, most=100)
    launch: dict[str, Any] = {"value": z0, "low": min(-3 * wave, z0), "high": 0.0, "most": 0.0, "slits": of_slits}
    yield Control("beam.z0", "Launch plane z₀, before the slab", **launch, **about)
    yield Control("beam.x0", "Middle x₀", value=values["x0"], low=-3 * wave, high=3 * wave, **about)
    words = parameters.BEAM["form"].words
    yield Control("beam.form", "Oblique form", group, values["form"], "word", words=words)
    words = parameters.BEAM["width_of"].words
    yield Control("beam.width_of", "Width of", group, values["width_of"], "word", words=words)


def _middle(axis: Any, default: float) -> float:
    """The middle value of an axis."""
    if axis is None:
        return default
    return float(axis[len(axis) // 2]) if parameters.is_several(axis) else float(axis)


def _ends(axis: Any, low: float, high: float) -> tuple[float, float]:
    several = axis is not None and parameters.is_several(axis) and len(axis) > 1
    return (float(min(axis)), float(max(axis))) if several else (low, high)


# --- the slab -----------------------------------------------------------------------------------------------


def _of_slab(document: Mapping[str, Any], design: parameters.Design) -> Iterator[Control]:
    table = document["slab"]
    if "stack" in table:
        for i, part in enumerate(table["stack"], 1):
            group = f"Part {i}"
            periods = parameters.count(part.get("periods", 1), "periods")
            yield _periods(f"slab.stack.{i}.periods", group, periods)
            yield from _of_cell(part, f"slab.stack.{i}", group)
    else:
        yield _periods("slab.periods", "Slab", parameters.count(table["periods"], "periods"))
        medium = parameters.SLAB["medium"]
        value = table.get("medium", medium.default)
        yield Control("slab.medium", "Medium", "Slab", value, "word", words=medium.words)
        yield from _of_cell(table, "slab", "Slab")
    for key, what in (("background", "Around"), ("after", "Behind")):
        if isinstance(table.get(key), Mapping):
            yield from _numbers(table[key], parameters.FLUID, f"slab.{key}", what, "")
    stated = "density" in table or "sound_speed" in table
    if table.get("background") is None and (stated or not (design.layered or "stack" in table)):
        around = {name: table.get(name, parameters.SLAB[name].default) for name in ("density", "sound_speed")}
        yield from _numbers(around, parameters.SLAB, "slab", "Around", "")
    given = {key: table[key] for key in ("after_density", "after_speed") if key in table}
    yield from _numbers(given, parameters.SLAB, "slab", "Behind", "")


def _periods(path: str, group: str, value: int) -> Control:
    high = max(1000.0, 2.0 * value) if value > 50 else 100.0
    return Control(path, "Periods", group, value, "count", low=1, high=high, ratio=True, most=MOST_PERIODS)


def _of_cell(table: Mapping[str, Any], path: str, group: str) -> Iterator[Control]:
    """The paper's cell, or layers of the user's own; those of a file move with the file alone."""
    if table.get("layer") is not None:
        for i, layer in enumerate(table["layer"], 1):
            name = layer.get("material", layer.get("model", ""))
            label = f"Layer {i}{f' ({name})' if name else ''}: "
            yield from _numbers(layer, parameters.LAYER, f"{path}.layer.{i}", group, label)
    elif not parameters.of_layers(table):
        yield from _of_lmmd(table, path, group)


def _of_lmmd(table: Mapping[str, Any], path: str, group: str) -> Iterator[Control]:
    values = parameters.read(
        {k: v for k, v in table.items() if k in parameters.LMMD}, parameters.LMMD, "slab", scale=1.0
    )
    rho_m = complex(values["rho_m"])

    def of(key: str, label: str, value: Any, low: float, high: float, **more: Any) -> Control:
        return Control(f"{path}.{key}", label, group, value, low=low, high=high, **more)

    eta = values["eta"]
    yield of("eta", "Period over wavelength η", eta, min(0.004, eta), max(0.2, eta), ratio=True)
    yield of("n_layers", "Layers a cell N", values["n_layers"], 2, 40, kind="count", most=MOST_LAYERS)
    yield of("rho_m.re", "Mean density, real part", rho_m.real, 0.0, max(0.5, 2 * rho_m.real))
    yield of("rho_m.im", "Mean density, loss", rho_m.imag, 0.0, max(0.2, 2 * rho_m.imag))
    yield of("delta_rho", "Modulation of the loss δρ", values["delta_rho"], 0.0, max(0.2, 2 * values["delta_rho"]))
    yield of("lossless", "Without loss", values["lossless"], 0, 1, kind="switch")
    frequency = values["design_frequency"]
    yield of("design_frequency", "Design frequency", frequency, 0.2 * frequency, 3 * frequency, unit="Hz", ratio=True)


#: Keys of layers and fluids: their names on the page, and their units.
_NAMES = {
    "thickness": ("thickness", "m"),
    "density": ("density", "kg/m³"),
    "density_x": ("density along x", "kg/m³"),
    "sound_speed": ("sound speed", "m/s"),
    "bulk_modulus": ("bulk modulus", "Pa"),
    "attenuation": ("attenuation", "Np/m"),
    "areal_density": ("areal density", "kg/m²"),
    "after_density": ("density", "kg/m³"),
    "after_speed": ("sound speed", "m/s"),
}


def _numbers(
    table: Mapping[str, Any],
    described: Mapping[str, Parameter],
    path: str,
    group: str,
    label: str,
) -> Iterator[Control]:
    """Every number that a table gives, from a quarter to four times itself; of complex ones both parts."""
    for key, plain in table.items():
        parameter = described.get(key)
        if parameter is None or parameter.parse in (parameters.as_it_is, parameters.switch) or plain is None:
            continue
        value = parameter.parse(plain, key)
        name, unit = _NAMES.get(key, (key.replace("_", " "), "Hz" if key.endswith("frequency") else ""))
        text = f"{label}{name}" if label else name.capitalize()
        parts = {"": value} if not isinstance(value, complex) else {".re": value.real, ".im": value.imag}
        for part, number in parts.items():
            said = text + {"": "", ".re": ", real part", ".im": ", imaginary part"}[part]
            yield _about(f"{path}.{key}{part}", said, group, number, unit)


def _about(path: str, label: str, group: str, value: float, unit: str) -> Control:
    """From a quarter of a value to four times it; of zero, from zero to one."""
    if value == 0:
        return Control(path, label, group, value, unit=unit)
    ends = sorted((value / 4, value * 4))
    return Control(path, label, group, value, unit=unit, low=ends[0], high=ends[1], ratio=value > 0)


def _of_tolerance(document: Mapping[str, Any]) -> Iterator[Control]:
    if "tolerance" in document:
        group = "Errors of manufacture"
        values = parameters.read(document["tolerance"], questions.TOLERANCE, "tolerance")
        for key in ("thickness", "density"):
            yield Control(f"tolerance.{key}", f"{key.capitalize()} error", group, values[key], high=0.1)
        for key in ("seed", "sample"):
            yield Control(f"tolerance.{key}", key.capitalize(), group, values[key], "count", high=50, most=1000)


# --- what is shown ------------------------------------------------------------------------------------------


def _of_view(document: Mapping[str, Any], design: parameters.Design, slab: Slab) -> Iterator[Control]:
    own, group, wave = document["question"], "Shown", design.wavelength
    field = questions.arguments(document) if own["name"] == "field" else {}
    half = max(map(abs, _ends(field.get("x"), *design.x[[0, -1]].tolist())))
    behind = max(_ends(field.get("z"), 0.0, float(design.z(0.0, slab)[-1]))[1] - slab.thickness, wave)
    low, high = _ends(questions.arguments(document)["frequency"], *design.band[[0, -1]].tolist())
    metres: dict[str, Any] = {"group": group, "unit": "m"}
    yield Control("view.x", "Half-height of the map", value=half, low=wave, high=30 * wave, ratio=True, **metres)
    yield Control(
        "view.behind", "Depth behind the slab", value=behind, low=0.1 * wave, high=30 * wave, ratio=True, **metres
    )
    yield Control("view.kx", "Transmission up to kx/k₀", group, 5.0, low=0.5, high=20, ratio=True)
    yield Control("view.contour", "Contour up to kx/k₀", group, 10.0, low=0.5, high=40, ratio=True)
    yield Control("view.from", "Widths from", group, low, unit="Hz", low=0.2 * low, high=high)
    yield Control("view.to", "Widths to", group, high, unit="Hz", low=low, high=3 * high)
