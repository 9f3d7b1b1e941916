"""Fluids and membranes by the name of a model: properties that change with frequency, out of plain numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from .tables import Parameter, apart, named
from .values import as_it_is, frequency, length, real, switch

if TYPE_CHECKING:
    from ..media.fluids import Fluid
    from ..media.membranes import DrudeMass, LorentzMass, Membrane

_POROUS = ("flow_resistivity", "porosity", "tortuosity", "viscous_length", "thermal_length")
_POWERS = ("attenuation_db_per_cm", "reference_frequency", "exponent", "dispersion")
_BODY = ("density", "sound_speed", "bulk_modulus", "areal_density")


class Model(NamedTuple):
    """What a model has to be given, what else it may be given, and the function that makes it of these."""

    needs: tuple[str, ...]
    may: tuple[str, ...]
    make: Callable[[Mapping[str, Any]], Fluid | Membrane]


def _membrane(values: Mapping[str, Any]) -> Membrane:
    from ..media.membranes import Membrane

    return Membrane(values["areal_density"])


def _drude(values: Mapping[str, Any]) -> Fluid | Membrane:
    from ..media.membranes import DrudeMass

    return _resonant(values, lambda mass: DrudeMass(mass, values["cutoff_frequency"], values.get("linewidth", 0.0)))


def _lorentz(values: Mapping[str, Any]) -> Fluid | Membrane:
    from ..media.membranes import LorentzMass

    rest = values["resonance_frequency"], values["resonator_density"], values.get("linewidth", 0.0)
    return _resonant(values, lambda mass: LorentzMass(mass, *rest))


def _resonant(values: Mapping[str, Any], mass: Callable[[Any], DrudeMass | LorentzMass]) -> Fluid | Membrane:
    """A membrane whose areal density follows a model, or a fluid whose density does; its modulus is that of its speed beside `density`."""
    from ..media.fluids import Fluid
    from ..media.membranes import Membrane

    given = tuple(name for name in _BODY if name in values)
    if given == ("areal_density",):
        with named("areal_density", "areal_density"):
            return Membrane(mass(values["areal_density"]))
    if given not in (("density", "sound_speed"), ("density", "bulk_modulus")):
        expected = "expected areal_density, or density with sound_speed or bulk_modulus"
        raise ValueError(f"model: {expected} beside {values['model']}, got {' and '.join(given) or 'none of them'}")
    base = {name: values[name] for name in given}
    plain = Fluid.from_speed(**base) if "sound_speed" in base else Fluid(**base)
    with named("density", "areal_density"):
        return replace(plain, density=mass(values["density"]))


def _power_law(values: Mapping[str, Any]) -> Fluid:
    from ..media.attenuation import power_law
    from ..media.fluids import Fluid

    powers = {name.removeprefix("attenuation_"): values[name] for name in _POWERS if name in values}
    with named("attenuation_db_per_cm", "db_per_cm"):
        return Fluid.from_speed(values["density"], values["sound_speed"], power_law(**powers))


def _porous(values: Mapping[str, Any]) -> Fluid:
    from ..media.porous import johnson_champoux_allard

    return johnson_champoux_allard(**{name: values[name] for name in _POROUS})


def _fibrous(values: Mapping[str, Any]) -> Fluid:
    from ..media.porous import delany_bazley_miki

    return delany_bazley_miki(values["flow_resistivity"])


MODELS: dict[str, Model] = {
    "mass-law": Model(("areal_density",), (), _membrane),
    "drude": Model(("cutoff_frequency",), ("linewidth", *_BODY), _drude),
    "lorentz": Model(("resonance_frequency", "resonator_density"), ("linewidth", *_BODY), _lorentz),
    "power-law": Model(("density", "sound_speed", *_POWERS[:2]), _POWERS[2:], _power_law),
    "johnson-champoux-allard": Model(_POROUS, (), _porous),
    "delany-bazley-miki": Model(("flow_resistivity",), (), _fibrous),
}
#: What models are given by, beside density, sound_speed, bulk_modulus and areal_density.
MODEL: dict[str, Parameter] = {
    "model": Parameter(None, as_it_is, "How it changes with frequency.", words=tuple(MODELS)),
    "cutoff_frequency": Parameter(None, frequency, "Of drude [Hz]: the mass is negative below it."),
    "resonance_frequency": Parameter(None, frequency, "Of lorentz [Hz]."),
    "resonator_density": Parameter(None, real, "Of lorentz: the mass on the spring [kg/m3 or kg/m2]."),
    "linewidth": Parameter(None, frequency, "Of drude and lorentz [Hz]: loss."),
    "attenuation_db_per_cm": Parameter(None, real, "Of power-law, at reference_frequency [dB/cm]."),
    "reference_frequency": Parameter(None, frequency, "Of power-law [Hz]."),
    "exponent": Parameter(None, real, "Of power-law; 2."),
    "dispersion": Parameter(None, switch, "Of power-law: let the speed change with it, as causality asks."),
    "flow_resistivity": Parameter(None, real, "Of porous models [Pa s/m2]."),
    "porosity": Parameter(None, real, "Of porous models."),
    "tortuosity": Parameter(None, real, "Of porous models."),
    "viscous_length": Parameter(None, length, "Of porous models [m]."),
    "thermal_length": Parameter(None, length, "Of porous models [m]."),
}


def of_model(values: Mapping[str, Any]) -> Fluid | Membrane:
    """The fluid or membrane of a table with a `model`; the values are parsed, and those that are not given are left out.

    Raises
    ------
    ValueError
        Names the property that is missing, or that the model does not have.

    Examples
    --------
    >>> of_model({"model": "drude", "areal_density": 0.1, "cutoff_frequency": 700.0}).areal_density(350.0)
    (-0.30000000000000004+0j)
    """
    name = values["model"]
    model = MODELS[name]
    for key in model.needs:
        if key not in values:
            raise ValueError(f"{key}: expected a number beside model {name}, got none")
    apart(values, tuple(key for key in values if key not in (*model.needs, *model.may, "model")), f"model {name}")
    return model.make(values)


def solid_behind(table: Mapping[str, Any], values: Mapping[str, Any]) -> Any:
    """A solid half-space by its three numbers."""
    from ..media.solids import Solid

    apart(table, ("after",), "after_shear_speed")
    for name in ("after_density", "after_speed"):
        if values[name] is None:
            raise ValueError(f"{name}: expected a number beside after_shear_speed, got none")
    speeds = named("after_speed", "longitudinal_speed"), named("after_shear_speed", "shear_speed")
    with named("after_density", "density"), speeds[0], speeds[1]:
        return Solid(values["after_density"], values["after_speed"], values["after_shear_speed"])
