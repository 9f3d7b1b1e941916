"""Fluids and membranes by the name of a model, stacks, and axes of even ratios, out of plain values."""

import numpy as np
import pytest

import beamprop as bp
from beamprop import parameters
from beamprop.media.membranes import DrudeMass, LorentzMass

FOAM = {
    "flow_resistivity": 1e4,
    "porosity": 0.97,
    "tortuosity": 1.1,
    "viscous_length": "100um",
    "thermal_length": "200um",
}
MADE = {
    "mass-law": ({"areal_density": "0.3"}, bp.Membrane(0.3)),
    "drude": ({"areal_density": 0.1, "cutoff_frequency": "0.7kHz"}, bp.Membrane.drude(0.1, 700.0)),
    "lorentz": (
        {"areal_density": 0.1, "resonance_frequency": 500, "resonator_density": 0.3, "linewidth": 5},
        bp.Membrane.lorentz(0.1, 500.0, 0.3, 5.0),
    ),
    "power-law": (
        {"density": 1060, "sound_speed": 1595, "attenuation_db_per_cm": 0.5, "reference_frequency": "1MHz"},
        bp.Fluid.from_speed(1060.0, 1595.0, bp.power_law(0.5, 1e6)),
    ),
    "johnson-champoux-allard": (FOAM, bp.johnson_champoux_allard(1e4, 0.97, 1.1, 1e-4, 2e-4)),
    "delany-bazley-miki": ({"flow_resistivity": 2e4}, bp.delany_bazley_miki(2e4)),
}


@pytest.mark.parametrize("model", MADE)
def test_models_are_those_of_python(model):
    table, made = MADE[model]
    fluid = isinstance(made, bp.Fluid)
    layer = parameters.layer({"model": model} | table | ({"thickness": "2cm"} if fluid else {}))
    assert layer == (bp.Layer(made, 0.02) if fluid else made)
    if fluid:
        assert parameters.slab({"layer": "air 1cm", "background": {"model": model} | table}).before == made


def test_fluids_of_resonant_density():
    """Drude's and Lorentz's densities in a fluid, whose modulus is that of its speed."""
    air = bp.Fluid.from_speed(1.25, 343.0)
    body = {"density": 1.25, "sound_speed": 343, "thickness": 0.01}
    drude = parameters.layer({"model": "drude", "cutoff_frequency": 700, **body}).fluid
    lorentz = parameters.layer({"model": "lorentz", "resonance_frequency": 900, "resonator_density": 2, **body}).fluid
    assert drude == bp.Fluid(DrudeMass(1.25, 700.0, 0.0), air.bulk_modulus)
    assert lorentz == bp.Fluid(LorentzMass(1.25, 900.0, 2.0, 0.0), air.bulk_modulus)
    assert drude.at(350.0).rho_z == pytest.approx(1.25 * (1 - 4), rel=1e-15)


def test_the_command_takes_models_in_words():
    said = parameters.layer("model=drude areal_density=0.1 cutoff_frequency=700Hz")
    assert said == bp.Membrane.drude(0.1, 700.0)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"model": "drud"}, "model of layer: expected .*'drude'"),
        (
            {"model": "drude", "areal_density": 1},
            "cutoff_frequency of layer: expected a number beside model drude, got none",
        ),
        ({"model": "mass-law", "areal_density": 1, "porosity": 1}, "porosity of layer: expected to be left out"),
        ({"model": "drude", "cutoff_frequency": 7, "density": 1, "thickness": 1}, "model of layer: .* got density"),
        (
            {"model": "power-law", **MADE["power-law"][0], "attenuation_db_per_cm": -1, "thickness": 1},
            "attenuation_db_per_cm of",
        ),
    ],
)
def test_what_a_model_refuses(table, message):
    with pytest.raises(ValueError, match=message):
        parameters.layer(table)


def test_a_stack():
    """Parts one behind another, each a cell of its own; what is around them is given once."""
    parts = [{"layer": ["steel 1mm", "water 2mm"], "periods": 3}, {"eta": "1/20", "periods": 5, "lossless": True}]
    slab = parameters.stack({"background": "water", "after": "air", "stack": parts})
    water = bp.material("water")
    steel = bp.Cell([bp.Layer(bp.material("steel"), 1e-3), bp.Layer(water, 2e-3)])
    cell = bp.lmmd_cell(eta=1 / 20, lossless=True, background=water)
    assert slab == bp.Slab.stack([(steel, 3), (cell, 5)], water, bp.material("air"))
    with pytest.raises(ValueError, match="material of layer of stack 2: expected a material"):
        parameters.stack({"stack": [parts[0], {"layer": "steal 1mm"}]})
    with pytest.raises(ValueError, match="eta: expected to be left out beside stack"):
        parameters.stack({"stack": parts, "eta": 1})


def test_axes_of_even_ratios():
    values = parameters.axis("10Hz:1kHz:5:log", "frequency", parameters.AXES["frequency"])
    np.testing.assert_allclose(np.diff(np.log(values)), np.log(100) / 4, rtol=1e-13)
    assert (values[0], values[-1]) == (10.0, 1000.0)
    assert parameters.axis("3:9:1:log", "x") == [3.0]
    for text in ("0:10:3:log", "-1:10:3:log", "1:10:log", "log"):
        with pytest.raises(ValueError, match="x: expected a number, a,b,c or start:stop:count"):
            parameters.axis(text, "x")
