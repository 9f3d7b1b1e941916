"""From plain values to objects: a table of strings and numbers becomes a slab, a beam or axes.

Options of the command and tables in files share the names, defaults and texts that stand here, and the form of error that names
the key: ``ValueError("periods: expected ..., got ...")``. NumPy and the rooms are imported inside the functions, so that the command
shows its help at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from .media.fluids import Fluid
    from .media.structures import Cell, Slab
    from .sources.gaussian import GaussianBeam

Axis = float | list[float]


class Parameter(NamedTuple):
    """A key of a table: its default, the function that turns a plain value into it, and its meaning."""

    default: Any
    parse: Callable[[Any, str], Any]
    text: str
    words: tuple[str, ...] = ()  #: the words that it may be, if it is a word
    shown: str = ""  #: the default as it is shown, where that is not its own text


# --- one value ----------------------------------------------------------------------------------------------


def number(value: Any, name: str) -> complex:
    """A complex number, also as text: 0.05+0.05j, or with i."""
    from . import validate

    expected = "a number such as 0.05 or 0.05+0.05j"
    if isinstance(value, str):
        try:
            return complex(value.replace(" ", "").replace("i", "j"))
        except ValueError:
            raise validate.refuse(name, expected, value) from None
    return complex(_scalar(value, name, expected))


def real(value: Any, name: str) -> float:
    """A real number, also as text."""
    from . import validate

    expected = "a real number"
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            raise validate.refuse(name, expected, value) from None
    scalar = _scalar(value, name, expected)
    if isinstance(scalar, complex):
        raise validate.refuse(name, expected, value)
    return scalar


def _scalar(value: Any, name: str, expected: str) -> complex | float:
    from . import validate

    array = validate.numeric(value, name, expected)
    if array.ndim:
        raise validate.refuse(name, expected, value)
    return array.item()


def count(value: Any, name: str) -> int:
    """A whole number of at least 1, also as text."""
    from . import validate

    if isinstance(value, str):
        try:
            value = int(value)
        except ValueError:
            raise validate.refuse(name, "a whole number of at least 1", value) from None
    return validate.as_count(value, name)


def switch(value: Any, name: str) -> bool:
    """True or False, also as text in small letters."""
    from . import validate

    return validate.flag({"true": True, "false": False}.get(value, value) if isinstance(value, str) else value, name)


def _word(value: Any, name: str) -> Any:
    """A value as it is: `read` holds it to the parameter's words."""
    return value


def axis(value: Any, name: str) -> Axis:
    """A number, or several as a list; also as text: a number, numbers with commas between, or start:stop:count.

    Examples
    --------
    >>> axis("2000:3000:3", "frequency")
    [2000.0, 2500.0, 3000.0]
    """
    from . import validate

    if not isinstance(value, str):
        return validate.axis(value, name).tolist()
    try:
        if ":" not in value:
            numbers = [float(v) for v in value.split(",")]
            return numbers[0] if len(numbers) == 1 else numbers
        start, stop, size = (kind(v) for kind, v in zip((float, float, int), value.split(":"), strict=True))
        if size < 1:
            raise ValueError
    except ValueError:
        raise validate.refuse(name, "a number, a,b,c or start:stop:count", value) from None
    from . import memory

    try:
        memory.check(f"count of {value!r}", 80.0 * size, "an axis", "ask for fewer points")
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None
    return spaced(start, stop, size)


def spaced(start: float, stop: float, size: int) -> list[float]:
    """Evenly spaced numbers, both ends exact."""
    step = (stop - start) / max(1, size - 1)
    return [start + i * step for i in range(size - 1)] + [stop if size > 1 else start]


# --- tables: the paper's parameters are the defaults --------------------------------------------------------

CELL: dict[str, Parameter] = {
    "rho_m": Parameter("0.05+0.05j", number, "Mean relative density."),
    "delta_rho": Parameter(0.025, real, "Modulation of the loss."),
    "lossless": Parameter(False, switch, "Drop the losses: Im(rho-m) and delta-rho."),
    "n_layers": Parameter(10, count, "Layers in a period."),
    "eta": Parameter(1 / 60, real, "Period over the wavelength at the design frequency.", shown="1/60"),
    "design_frequency": Parameter(2500.0, real, "[Hz]"),
    "density": Parameter("1.25", number, "Of the background and both half-spaces [kg/m3]."),
    "sound_speed": Parameter("343", number, "Of the background and both half-spaces [m/s]."),
}
SLAB: dict[str, Parameter] = CELL | {
    "periods": Parameter(450, count, "Periods of the slab."),
    "medium": Parameter(
        "exact",
        _word,
        "The layers themselves, an effective medium (bare: without the interface term), or background only.",
        words=("exact", "lmmd-emt", "lmmd-emt-bare", "standard-emt", "none"),
    ),
    "after_density": Parameter(None, number, "Of the half-space behind, if it differs [kg/m3]."),
    "after_speed": Parameter(None, number, "Of the half-space behind, if it differs [m/s]."),
}
BEAM: dict[str, Parameter] = {
    "fwhm": Parameter(0.096, real, "Full width at half maximum at the launch plane [m]."),
    "x0": Parameter(0.0, real, "Middle of the beam [m]."),
    "z0": Parameter(0.0, real, "Launch plane, at or in front of the near face at 0 [m]."),
    "width_of": Parameter("pressure", _word, "What fwhm is the width of.", words=("pressure", "intensity")),
    "form": Parameter("launch", _word, "Kind of oblique beam.", words=("launch", "rotated")),
}
#: What a question may be asked along.
AXES = ("frequency", "angle", "x", "z", "kx", "kx_over_k0")


def read(table: Mapping[str, Any], parameters: Mapping[str, Parameter], what: str) -> dict[str, Any]:
    """Every parameter of a table, parsed, with defaults for those that it leaves out.

    Parameters
    ----------
    table : mapping of str to plain values
    parameters : what it may hold: `CELL`, `SLAB` or `BEAM`
    what : str
        What the table describes, for messages.

    Raises
    ------
    ValueError
        Names the key that is unknown, or whose value cannot be used.
    """
    from . import validate

    _known(table, tuple(parameters), what)
    values: dict[str, Any] = {}
    for name, parameter in parameters.items():
        value = table.get(name, parameter.default)
        if value is None and parameter.default is None:
            values[name] = None
            continue
        values[name] = parameter.parse(value, name)
        if parameter.words:
            validate.word(values[name], name, *parameter.words)
    return values


def _known(table: Any, names: tuple[str, ...], what: str) -> None:
    """Refuse what is no table, and keys that are unknown."""
    from . import validate

    if not isinstance(table, Mapping):
        raise validate.refuse(what, "a table of names and values", table)
    for key, value in table.items():
        if key not in names:
            name = key if isinstance(key, str) else validate.shown(key)
            raise validate.refuse(name, f"a name that a table of {what} has ({', '.join(names)})", value)


@contextmanager
def named(key: str, *names: str) -> Iterator[None]:
    """Errors of the arguments `names` of an object under the key of the table that they come from."""
    try:
        yield
    except ValueError as error:
        name, colon, said = str(error).partition(": ")
        if not colon or name not in names:
            raise
        raise ValueError(f"{key}: {said}") from None


# --- from tables to objects ---------------------------------------------------------------------------------


def cell(table: Mapping[str, Any]) -> tuple[Cell, Fluid]:
    """The paper's cell and its background, from a table with the names of `CELL`."""
    return _cell(read(table, CELL, "cell"))


def slab(table: Mapping[str, Any]) -> Slab:
    """The slab, or an effective medium in its place, from a table with the names of `SLAB`.

    Examples
    --------
    >>> slab({"periods": 20, "lossless": True, "medium": "lmmd-emt"}).segments[0][1]
    1
    """
    from .media.effective import lmmd_emt_slab, standard_emt
    from .media.structures import Slab

    values = read(table, SLAB, "slab")
    period, before = _cell(values)
    layered = Slab(period, values["periods"], before, _behind(values, before))
    if values["medium"] == "exact":
        return layered
    with named("medium", "cell"), named("periods", "thickness"):
        if values["medium"] in ("lmmd-emt", "lmmd-emt-bare"):
            return lmmd_emt_slab(layered, interface=values["medium"] == "lmmd-emt")
        fluid = standard_emt(period) if values["medium"] == "standard-emt" else before
        return Slab.uniform(fluid, layered.thickness, before, layered.after)


def beam(table: Mapping[str, Any]) -> GaussianBeam:
    """The beam, along the normal, from a table with the names of `BEAM`; its angle is an axis of the question."""
    from .sources.gaussian import GaussianBeam

    return GaussianBeam(**read(table, BEAM, "beam"))


def axes(table: Mapping[str, Any]) -> dict[str, Axis]:
    """Those of `AXES` that a table gives: each as a number or a list of finite numbers."""
    from . import validate

    _known(table, AXES, "axes")
    return {name: validate.axis(axis(value, name), name).tolist() for name, value in table.items()}


def _cell(values: Mapping[str, Any]) -> tuple[Cell, Fluid]:
    from .media.fluids import Fluid
    from .media.lmmd import lmmd_cell

    with named("sound_speed", "bulk_modulus"):
        background = Fluid.from_speed(values["density"], values["sound_speed"])
    rho_m, delta_rho = values["rho_m"], values["delta_rho"]
    if values["lossless"]:
        rho_m, delta_rho = rho_m.real, 0.0
    question = rho_m, delta_rho, values["n_layers"], values["eta"], values["design_frequency"], background
    with named("rho_m, delta_rho", "density"), named("eta", "thickness"), named("sound_speed", "background"):
        return lmmd_cell(*question), background


def _behind(values: Mapping[str, Any], before: Fluid) -> Fluid:
    """The half-space behind: as that in front, but for what is given apart."""
    from .media.fluids import Fluid

    density, speed = values["after_density"], values["after_speed"]
    if density is None and speed is None:
        return before
    given = "after_density" if speed is None else "after_speed"
    with named("after_density", "density"), named(given, "sound_speed", "bulk_modulus"):
        return Fluid.from_speed(
            values["density"] if density is None else density, values["sound_speed"] if speed is None else speed
        )
