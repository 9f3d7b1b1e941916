"""From a table to a cell and a slab: the paper's, or layers in the user's words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

from .models import MODEL, of_model, solid_behind
from .tables import Parameter, apart, named, read
from .values import as_it_is, count, frequency, length, number, real, switch
from .words import described, refused

if TYPE_CHECKING:
    from ..media.fluids import Fluid
    from ..media.structures import Cell, Layer, Membrane, Slab


def attenuation(value: Any, name: str) -> float:
    """An attenuation [Np/m], as text also with a unit: 0.5dB/cm.

    Examples
    --------
    >>> round(attenuation("0.5dB/cm", "attenuation"), 4)
    5.7565
    """
    from ..media.tables import COLUMNS

    split = re.fullmatch(r"(.*?)([A-Za-z]+/[a-z]+)", value.strip()) if isinstance(value, str) else None
    factor = COLUMNS["attenuation"].get(split[2].lower().replace("/", "_")) if split else None
    expected = "a number [Np/m], or such as 0.5dB/cm"
    if not split or factor is None:
        return real(value, name, expected=expected)
    return factor * real(split[1], name, expected=expected)


# --- what tables hold: the paper's parameters are the defaults ----------------------------------------------

#: The paper's cell.
LMMD: dict[str, Parameter] = {
    "rho_m": Parameter("0.05+0.05j", number, "Mean relative density."),
    "delta_rho": Parameter(0.025, real, "Modulation of the loss."),
    "lossless": Parameter(False, switch, "Drop the losses: the imaginary part of rho-m, and delta-rho."),
    "n_layers": Parameter(10, count, "Layers in a period."),
    "eta": Parameter("1/60", real, "Period over the wavelength at the design frequency."),
    "design_frequency": Parameter(2500.0, frequency, "[Hz]", shown="2500"),
}
#: Layers of the user's own in its place.
LAYERS: dict[str, Parameter] = {
    "layer": Parameter(
        None,
        as_it_is,
        "A layer of your own, from the near face on; may be repeated: 'water 2mm', 'solid steel 1mm' (with shear), "
        "'density=1000 speed=1480 2mm', or 'areal_density=0.3' for a membrane.",
    ),
    "layers": Parameter(
        None, as_it_is, "All layers of your own: a CSV file with a row each and columns such as thickness_mm, material."
    ),
}
BACKGROUND: dict[str, Parameter] = {
    "background": Parameter(None, as_it_is, "Material of the background and both half-spaces: water."),
    "density": Parameter("1.25", number, "Of the background and both half-spaces [kg/m3]."),
    "sound_speed": Parameter("343", number, "Of the background and both half-spaces [m/s]."),
}
CELL: dict[str, Parameter] = LMMD | LAYERS | BACKGROUND
SLAB: dict[str, Parameter] = CELL | {
    "periods": Parameter(450, count, "Periods of the slab.", shown="450, or 1 of layers of your own"),
    "medium": Parameter(
        "exact",
        as_it_is,
        "The layers themselves, an effective medium (bare: without the interface term), or background only.",
        words=("exact", "lmmd-emt", "lmmd-emt-bare", "standard-emt", "none"),
    ),
    "after": Parameter(
        None, as_it_is, "Material of the half-space behind, if it differs: water, or 'solid steel' (with shear)."
    ),
    "after_density": Parameter(None, number, "Of the half-space behind, if it differs [kg/m3]."),
    "after_speed": Parameter(None, number, "Of the half-space behind, if it differs [m/s]."),
    "after_shear_speed": Parameter(
        None, number, "Of a solid half-space behind [m/s], beside its density and (longitudinal) speed."
    ),
}
#: What a layer is described by.
LAYER: dict[str, Parameter] = {
    "material": Parameter(None, as_it_is, "A name."),
    "density": Parameter(None, number, "[kg/m3]"),
    "sound_speed": Parameter(None, number, "[m/s]"),
    "shear_speed": Parameter(None, number, "Of a solid [m/s]."),
    "bulk_modulus": Parameter(None, number, "[Pa]"),
    "attenuation": Parameter(None, attenuation, "Beside a speed [Np/m], or 0.5dB/cm; the same at every frequency."),
    "density_x": Parameter(None, number, "Along the layer, where it differs [kg/m3]."),
    "areal_density": Parameter(None, number, "Of a membrane [kg/m2]."),
    **MODEL,
    "thickness": Parameter(None, length, "[m]"),
}
#: What a half-space is described by, in place of a material's name.
FLUID: dict[str, Parameter] = {
    name: p for name, p in LAYER.items() if name not in ("areal_density", "thickness", "shear_speed")
}
#: What that behind is described by, which may be a solid.
BEHIND: dict[str, Parameter] = FLUID | {"shear_speed": LAYER["shear_speed"]}
#: What each part of a stack is described by.
PART: dict[str, Parameter] = LMMD | LAYERS | {"periods": Parameter(1, count, "Periods of the part.")}


def of_layers(table: Mapping[str, Any]) -> bool:
    """Whether a table gives layers of its own."""
    return any(table.get(name) is not None for name in LAYERS)


# --- from tables to objects ---------------------------------------------------------------------------------


def cell(table: Mapping[str, Any]) -> tuple[Cell, Fluid]:
    """One period and the background, from a table with the names of `CELL`."""
    return _cell(table, read(table, CELL, "cell"))


def slab(table: Mapping[str, Any]) -> Slab:
    """The slab, or an effective medium in its place, from a table with the names of `SLAB`.

    Examples
    --------
    >>> slab({"periods": 20, "lossless": True, "medium": "lmmd-emt"}).segments[0][1]
    1
    >>> round(slab({"layer": ["density=1000 speed=1480 2mm", "air 1cm"], "periods": 3}).thickness, 6)
    0.036
    """
    from ..media.effective import lmmd_emt_slab, standard_emt
    from ..media.structures import Slab

    values = read(table, SLAB, "slab")
    period, before = _cell(table, values)
    periods = 1 if of_layers(table) and "periods" not in table else values["periods"]
    layered = Slab(period, periods, before, _behind(table, values, before))
    if values["medium"] == "exact":
        return layered
    with named("medium", "cell"), named("periods", "thickness"):
        if values["medium"] in ("lmmd-emt", "lmmd-emt-bare"):
            return lmmd_emt_slab(layered, interface=values["medium"] == "lmmd-emt")
        fluid = standard_emt(period) if values["medium"] == "standard-emt" else before
        return Slab.uniform(fluid, layered.thickness, before, layered.after)


def stack(table: Mapping[str, Any]) -> Slab:
    """The slab of parts one behind another: `table["stack"]` lists tables of the names of `PART`, the rest is around them.

    Examples
    --------
    >>> slab = stack({"background": "water", "stack": [{"layer": "steel 1mm", "periods": 2}, {"layer": "air 1cm"}]})
    >>> [periods for _, periods in slab.segments]
    [2, 1]
    """
    from ..media.structures import Slab

    around = {key: value for key, value in table.items() if key != "stack"}
    apart(around, (*LMMD, *LAYERS, "periods", "medium"), "stack")
    values = read(around, SLAB, "slab")
    before = _half_space(around, values, "background", "density", "sound_speed")
    outside = {key: around[key] for key in BACKGROUND if key in around}
    segments = []
    for i, part in enumerate(table["stack"], 1):
        with _of(f"stack {i}"):
            described = read(part, PART, "stack")
            given = {key: value for key, value in part.items() if key != "periods"}
            segments.append((cell(given | outside)[0], described["periods"]))
    return Slab.stack(segments, before, _behind(around, values, before))


def _cell(table: Mapping[str, Any], values: Mapping[str, Any]) -> tuple[Cell, Fluid]:
    from ..media.lmmd import lmmd_cell
    from ..media.structures import UNSTATED, Cell

    if of_layers(table) and not any(table.get(name) is not None for name in BACKGROUND):
        background = UNSTATED
    else:
        background = _half_space(table, values, "background", "density", "sound_speed")
    if of_layers(table):
        apart(table, tuple(LMMD), "layers" if "layers" in table else "layer")
        return Cell(_layers(table, values)), background
    question = {name: values[name] for name in LMMD}
    with named("sound_speed" if values["background"] is None else "background", "background"):
        return lmmd_cell(**question, background=background), background


def _layers(table: Mapping[str, Any], values: Mapping[str, Any]) -> tuple[Layer | Membrane, ...]:
    if values["layers"] is not None:
        apart(table, ("layer",), "layers")
        return _of_file(values["layers"])
    given = values["layer"]
    several = given if isinstance(given, list | tuple) else (given,)
    return tuple(layer(value, f"layer {i}" if len(several) > 1 else "layer") for i, value in enumerate(several, 1))


def _of_file(path: Any) -> tuple[Layer | Membrane, ...]:
    from ..media.tables import layers_from_table

    try:
        return layers_from_table(path)
    except OSError as error:
        raise ValueError(
            f"layers: expected a CSV file that can be read, got {str(path)!r} ({error.strerror})"
        ) from None
    except ValueError as error:
        about, _, said = str(error).partition(": ")
        raise ValueError(f"layers: {said}" if about == "table" else f"{about} of layers: {said}") from None


def layer(given: Any, name: str = "layer") -> Layer | Membrane:
    """A layer or membrane from words such as "air 5mm", or from a table with the names of `LAYER`.

    Raises
    ------
    ValueError
        Names the layer, and the property that is wrong.

    Examples
    --------
    >>> layer("density=1000 speed=1480 2mm")
    Layer(fluid=Fluid(density=1000, bulk_modulus=2.1904e+09), thickness=0.002)
    >>> layer({"areal_density": 0.3})
    Membrane(areal_density=(0.3+0j), active=False)
    """
    table = described(given, name, LAYER) if isinstance(given, str) else given
    with _of(name):
        if (made := layer_of(table)) is not None:
            return made
    raise refused(given, name)


def layer_of(table: Mapping[str, Any]) -> Layer | Membrane | None:
    """A layer or membrane from a table with the names of `LAYER`; nothing if these do not make one. Errors name the table's keys."""
    from ..media.structures import Layer

    values = _given(table, LAYER, "layer")
    of_membrane = "areal_density" in values and ("model" in values or set(values) == {"areal_density"})
    if of_membrane:
        apart(values, ("thickness",), "areal_density")
        return of_model({"model": "mass-law"} | values)  # type: ignore[return-value]
    thickness = values.pop("thickness", None)
    if thickness is None or ("model" not in values and frozenset(values) not in _FLUIDS):
        return None
    return Layer(_fluid(values), thickness)


def fluid_of(table: Mapping[str, Any], names: Mapping[str, Parameter] = FLUID) -> Fluid:
    """A fluid from a table with the names of `FLUID`, or a half-space behind from those of `BEHIND`.

    Examples
    --------
    >>> fluid_of({"density": 1000, "sound_speed": "1480"})
    Fluid(density=1000, bulk_modulus=2.1904e+09)
    """
    values = _given(table, names, "fluid")
    if "model" not in values and frozenset(values) not in _FLUIDS:
        raise ValueError(
            f"material: expected a name, or density and sound_speed or bulk_modulus, got {', '.join(values) or 'nothing'}"
        )
    made: Fluid = _fluid(values)
    return made


def _given(table: Mapping[str, Any], parameters: Mapping[str, Parameter], what: str) -> dict[str, Any]:
    return {key: value for key, value in read(table, parameters, what).items() if value is not None}


@contextmanager
def _of(name: str) -> Iterator[None]:
    """Errors about a property of a layer, as ``density of layer 2: ...``."""
    try:
        yield
    except ValueError as error:
        raise ValueError(
            f"{error}" if str(error).startswith("layer: ") else f"{error}".replace(": ", f" of {name}: ", 1)
        ) from None


_FLUIDS = {
    frozenset({"material"}),
    frozenset({"density", "sound_speed"}),
    frozenset({"density", "sound_speed", "attenuation"}),
    frozenset({"density", "sound_speed", "shear_speed"}),
    frozenset({"density", "bulk_modulus"}),
    frozenset({"density", "bulk_modulus", "density_x"}),
}


def _fluid(values: Mapping[str, Any]) -> Any:
    from ..media.fluids import Fluid
    from ..media.solids import Solid

    if "model" in values:
        return of_model(values)
    if "shear_speed" in values:
        with named("sound_speed", "longitudinal_speed"):
            return Solid(values["density"], values["sound_speed"], values["shear_speed"])
    if "material" in values:
        return _material(values["material"], "material")
    return Fluid.from_speed(**values) if "sound_speed" in values else Fluid(**values)


def _material(value: Any, key: str) -> Any:
    from ..media.materials import material
    from ..media.solids import Solid

    if isinstance(value, Mapping):
        return fluid_of(value, BEHIND if key == "after" else FLUID)
    with named(key, "name"):
        if key in ("material", "after") and isinstance(value, str) and value.startswith("solid "):
            return Solid.from_material(value.removeprefix("solid "))
        return material(value)


def _half_space(table: Mapping[str, Any], values: Mapping[str, Any], key: str, density: str, speed: str) -> Fluid:
    """A half-space by its material, or by density and speed."""
    from ..media.fluids import Fluid

    if values[key] is not None:
        apart(table, (density, speed), key)
        return _material(values[key], key)
    with named(density, "density"), named(speed, "sound_speed", "bulk_modulus"):
        return Fluid.from_speed(values[density], values[speed])


def _behind(table: Mapping[str, Any], values: Mapping[str, Any], before: Fluid) -> Fluid:
    """The half-space behind: as that in front, but for what is given apart."""
    density, speed = values["after_density"], values["after_speed"]
    if values["after_shear_speed"] is not None:
        return solid_behind(table, values)
    if values["after"] is None and density is None and speed is None:
        return before
    if values["after"] is None and values["background"] is not None and None in (density, speed):
        missing = "after_density" if density is None else "after_speed"
        raise ValueError(f"{missing}: expected a number, since background is a material, got none")
    rest = {
        "after_density": values["density"] if density is None else density,
        "after_speed": values["sound_speed"] if speed is None else speed,
    }
    with named("after_density", "after_speed") if speed is None else nullcontext():
        return _half_space(table, dict(values) | rest, "after", "after_density", "after_speed")
