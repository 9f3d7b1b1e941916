"""Tables of plain values: the objects that they stand for, and refusals that name the key."""

import doctest
import importlib
import json
import re
import tomllib

import numpy as np
import pytest
from click.testing import CliRunner

import beamprop as bp
from beamprop import parameters
from beamprop.cli import main

HELIUM = bp.Fluid.from_speed(0.18, 972.0)
PAPER = bp.Slab(bp.lmmd_cell(), 450)


# --- what tables stand for ---------------------------------------------------------------------------------


def test_empty_tables_are_the_paper():
    """Without a key: the slab of the paper and its beam."""
    assert parameters.slab({}) == PAPER
    assert parameters.cell({}) == (bp.lmmd_cell(), bp.AIR)
    assert parameters.beam({}) == bp.GaussianBeam(0.096)
    assert parameters.axes({}) == {}


@pytest.mark.parametrize("as_text", [False, True])
def test_every_key_of_a_slab(as_text):
    """Numbers and their texts describe the same slab."""
    table = {
        "rho_m": "0.1+0.2i",
        "delta_rho": 0.1,
        "n_layers": 6,
        "eta": 0.025,
        "design_frequency": 2000.0,
        "density": 0.18,
        "sound_speed": 972,
        "periods": 20,
        "lossless": False,
        "after_density": 1000.0,
        "after_speed": 1480.0,
    }
    if as_text:
        table = {key: str(value).lower() for key, value in table.items()}
    cell = bp.lmmd_cell(0.1 + 0.2j, 0.1, 6, 0.025, 2000.0, HELIUM)
    assert parameters.slab(table) == bp.Slab(cell, 20, HELIUM, bp.Fluid.from_speed(1000.0, 1480.0))
    assert set(table) | {"medium", "layer", "layers", "background", "after", "after_shear_speed"} == set(
        parameters.SLAB
    )


@pytest.mark.parametrize(
    ("medium", "slab"),
    [
        ("exact", bp.Slab(bp.lmmd_cell(0.05, 0), 30)),
        ("lmmd-emt", bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(0.05, 0), 30))),
        ("lmmd-emt-bare", bp.lmmd_emt_slab(bp.Slab(bp.lmmd_cell(0.05, 0), 30), interface=False)),
        (
            "standard-emt",
            bp.Slab.uniform(bp.standard_emt(bp.lmmd_cell(0.05, 0)), bp.Slab(bp.lmmd_cell(), 30).thickness),
        ),
        ("none", bp.Slab.uniform(bp.AIR, bp.Slab(bp.lmmd_cell(), 30).thickness)),
    ],
)
def test_media(medium, slab):
    """Every word of `medium`, without loss."""
    assert parameters.slab({"medium": medium, "periods": 30, "lossless": "true"}) == slab
    assert medium in parameters.SLAB["medium"].words


def test_half_spaces_behind_differ_by_what_is_given():
    """The density alone, or the speed alone; the other is that in front."""
    assert parameters.slab({"after_speed": 300}).after == bp.Fluid.from_speed(1.25, 300.0)
    assert parameters.slab({"after_density": 2}).after == bp.Fluid.from_speed(2.0, 343.0)
    assert parameters.slab({"after_density": None}).after == bp.AIR


def test_every_key_of_a_beam():
    """And no angle, which is an axis."""
    table = {"fwhm": "0.2", "x0": 0.1, "z0": "-0.3", "width_of": "intensity", "form": "rotated"}
    assert parameters.beam(table) == bp.GaussianBeam(0.2, 0.0, 0.1, -0.3, "intensity", "rotated")
    elsewhere = {
        "slits",
        "profile",
        "y0",
        "azimuth",
        "piston",
        "baffle",
        "bowl",
        "source_plane",
        "array",
        "pressure",
        "conjugate",
    }
    assert set(table) | elsewhere == set(parameters.BEAM)


@pytest.mark.parametrize(
    ("value", "numbers"),
    [
        ("2500", 2500.0),
        (2500, 2500.0),
        ("2400,2500", [2400.0, 2500.0]),
        ([2400, 2500], [2400.0, 2500.0]),
        (np.array([2400.0, 2500.0]), [2400.0, 2500.0]),
        ("2400:2500:3", [2400.0, 2450.0, 2500.0]),
        ("-1e-3:1e-3:2", [-1e-3, 1e-3]),
        ("2400:2600:1", [2400.0]),
    ],
)
def test_axes(value, numbers):
    """A number, several, and both ends of evenly spaced ones."""
    for name in parameters.AXES:
        assert parameters.axes({name: value}) == {name: numbers}


def test_tables_of_files():
    """What a TOML or JSON file holds needs no conversion."""
    text = (
        'slab = {periods = 20, rho_m = "0.05+0.1j", lossless = false}\nbeam = {fwhm = 0.2}\naxes = {angle = "0:40:3"}'
    )
    read = tomllib.loads(text)
    assert json.loads(json.dumps(read)) == read
    assert parameters.slab(read["slab"]) == bp.Slab(bp.lmmd_cell(0.05 + 0.1j), 20)
    assert parameters.beam(read["beam"]) == bp.GaussianBeam(0.2)
    assert parameters.axes(read["axes"]) == {"angle": [0.0, 20.0, 40.0]}


@pytest.mark.parametrize("name", ["", ".media", ".scale", ".sources", ".values"])
def test_examples(name):
    """Those of the docstrings run and print what they say."""
    module = importlib.import_module(f"beamprop.parameters{name}")
    ran = doctest.testmod(module, extraglobs={"bp": bp, "np": np})
    assert ran.attempted > 0
    assert ran.failed == 0


# --- refusals ------------------------------------------------------------------------------------------------

MAKERS = {
    "cell": parameters.cell,
    "slab": parameters.slab,
    "beam": parameters.beam,
    "axes": parameters.axes,
}
REFUSED = [
    ("slab", "periods", 0, "a whole number of at least 1, got 0"),
    ("slab", "periods", "1.5", "a whole number of at least 1, got '1.5'"),
    ("slab", "periods", 1.5, "a whole number of at least 1, got 1.5"),
    ("slab", "periods", True, "a whole number of at least 1, got True"),
    ("slab", "periods", None, "a whole number of at least 1, got None"),
    ("slab", "rho_m", "x", "a number such as 0.05 or 0.05+0.05j, got 'x'"),
    ("slab", "rho_m", [0.1, 0.2], "a number such as 0.05 or 0.05+0.05j, got [0.1, 0.2]"),
    ("slab", "rho_m", {"re": 1}, "a number such as 0.05 or 0.05+0.05j, got {'re': 1}"),
    ("cell", "delta_rho", "0.1j", "a number such as 0.05 or 1/60, got '0.1j'"),
    ("cell", "delta_rho", 0.1j, "a real number, got 0.1j"),
    ("cell", "eta", 0, "a finite number above zero, got 0.0"),
    ("cell", "n_layers", 2.5, "a whole number of at least 1, got 2.5"),
    ("cell", "design_frequency", "nan", "a finite number above zero, got nan"),
    ("slab", "lossless", 1, "True or False, got 1"),
    ("slab", "lossless", "yes", "True or False, got 'yes'"),
    ("slab", "medium", "steel", "'exact', 'lmmd-emt', 'lmmd-emt-bare', 'standard-emt' or 'none', got 'steel'"),
    ("slab", "medium", 3, "'exact', 'lmmd-emt', 'lmmd-emt-bare', 'standard-emt' or 'none', got 3"),
    ("slab", "density", 0, "a finite number other than zero beside a speed, got 0.0"),
    ("slab", "sound_speed", "0", "a finite number other than zero, got 0.0"),
    ("slab", "sound_speed", "343+5j", "a passive medium, Im(bulk_modulus) <= 0"),
    ("slab", "sound_speed", "343j", "a fluid in which waves propagate, got Fluid"),
    ("slab", "after_density", 0, "a finite number other than zero beside a speed, got 0.0"),
    ("slab", "after_density", "1+1j", "a passive medium, Im(bulk_modulus) <= 0"),
    ("slab", "after_speed", "343+5j", "a passive medium, Im(bulk_modulus) <= 0"),
    ("beam", "fwhm", "wide", "a length such as 0.002 or 2mm, got 'wide'"),
    ("beam", "fwhm", -1, "a finite number above zero, got -1.0"),
    ("beam", "z0", 0.1, "a launch plane in front of the slab, z0 <= 0, got 0.1"),
    ("beam", "form", "bent", "'launch' or 'rotated', got 'bent'"),
    ("axes", "frequency", "1,a", "a number, a,b,c or start:stop:count, got '1,a'"),
    ("axes", "frequency", "", "a number, a,b,c or start:stop:count, got ''"),
    ("axes", "x", "0:1:0", "a number, a,b,c or start:stop:count, got '0:1:0'"),
    ("axes", "kx", "0:inf:3", "finite values, got"),
    ("axes", "z", [[0.0]], "a number or a 1-D array of at least one, got shape (1, 1)"),
    ("axes", "angle", [], "a number or a 1-D array of at least one, got shape (0,)"),
]


@pytest.mark.parametrize(("maker", "key", "value", "said"), REFUSED)
def test_a_refusal_names_the_key(maker, key, value, said):
    """`key: expected ..., got ...`, also where an object that is made of several keys refuses."""
    with pytest.raises(ValueError, match="^" + re.escape(f"{key}: expected {said}")):
        MAKERS[maker]({key: value})


@pytest.mark.parametrize(
    ("maker", "key", "value", "unit"),
    [
        ("axes", "frequency", "1mhz", "MHz"),
        ("axes", "frequency", "1kHz:-1e3KHZ:3", "kHz"),
        ("axes", "x", "1mm,2MM", "mm"),
        ("axes", "z", ["1mm", "2Cm"], "cm"),
        ("slab", "design_frequency", "2500hz", "Hz"),
        ("beam", "fwhm", "3CM", "cm"),
        ("beam", "bowl", "6cm,6Mm", "mm"),
        ("slab", "layer", "water 2MM", "mm"),
    ],
)
def test_a_unit_in_letters_of_the_wrong_size(maker, key, value, unit):
    with pytest.raises(ValueError, match=rf", got .*; did you mean {unit}\?$"):
        MAKERS[maker]({key: value})


@pytest.mark.parametrize("value", ["1a", "2m", "1 parsec", "", "1xMHz"])
def test_no_unit_is_guessed(value):
    with pytest.raises(ValueError, match=f", got '{value}'$"):
        parameters.frequency(value, "frequency")


def test_axes_that_do_not_fit():
    """The key, and the count that is too large."""
    with pytest.raises(ValueError, match=r"^x: expected a question that fits.* the 1000000000000 numbers of '0:1:10"):
        parameters.axes({"x": "0:1:1000000000000"})


def test_gain_names_both_keys_of_the_loss():
    """A layer's loss is that of rho_m with that of delta_rho, either of which may be the one to change."""
    for table in ({"rho_m": "0.05-0.05j"}, {"delta_rho": 0.5}):
        with pytest.raises(ValueError, match=r"^rho_m, delta_rho: expected a passive medium, Im\(density\) >= 0"):
            parameters.slab(table)


def test_a_medium_that_does_not_exist():
    """The mean of 1/density of a cell with a layer of density 0."""
    table = {"rho_m": 0, "delta_rho": 0, "n_layers": 4, "medium": "standard-emt"}
    with pytest.raises(ValueError, match=r"^medium: the mean of 1/density does not exist"):
        parameters.slab(table)


@pytest.mark.parametrize(
    ("maker", "key"),
    [("slab", "perods"), ("slab", "rho-m"), ("cell", "periods"), ("beam", "angle"), ("axes", "period"), ("slab", 3)],
)
def test_unknown_keys_are_refused_by_name(maker, key):
    """With the names that the table has; nothing is dropped."""
    with pytest.raises(ValueError, match=f"^{key}: expected a name that a table of {maker} has") as refused:
        MAKERS[maker]({key: 20})
    names = {"cell": parameters.CELL, "slab": parameters.SLAB, "beam": parameters.BEAM, "axes": parameters.AXES}[maker]
    assert f"({', '.join(names)}), got 20" in str(refused.value)


@pytest.mark.parametrize("maker", MAKERS)
def test_what_is_no_table(maker):
    with pytest.raises(ValueError, match=f"^{maker}: expected a table of names and values, got"):
        MAKERS[maker]([("periods", 3)])


# --- the command ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in parameters.SLAB if name != "lossless"])
def test_the_command_asks_with_the_same_words(name):
    """An option that is wrong exits with 2, and names itself."""
    ran = CliRunner().invoke(main, ["guided_modes", f"--{name.replace('_', '-')}", "wrong"])
    assert ran.exit_code == 2
    assert f"Error: --{name.replace('_', '-')}: expected " in ran.stderr
