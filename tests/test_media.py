"""Media in the user's words: half-spaces, faces, tables and names."""

import numpy as np
import pandas as pd
import pytest

import beamprop as bp

F = 2500.0
WATER = bp.Fluid.from_speed(1000.0, 1480.0)
STEEL = bp.Fluid.from_speed(7850.0, 5960.0)
LAYER = bp.Layer(bp.AIR, 0.01)
CELL = bp.lmmd_cell()

# --- half-spaces and faces --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "make",
    [
        lambda **sides: bp.Slab(CELL, 3, **sides),
        lambda **sides: bp.Slab.uniform(STEEL, 0.1, **sides),
        lambda **sides: bp.Slab.stack([(CELL, 2)], **sides),
        lambda **sides: bp.Slab.from_table(pd.DataFrame({"thickness": [1.0], "material": ["steel"]}), **sides),
    ],
    ids=["slab", "uniform", "stack", "from_table"],
)
def test_background_is_both_half_spaces(make):
    """And `before` or `after`, an AIR too, is that of its own side."""
    assert (make().before, make().after) == (bp.AIR, bp.AIR)
    both = make(background=WATER)
    assert both == make(before=WATER, after=WATER)
    assert make(background=WATER, after=STEEL) == make(before=WATER, after=STEEL)
    assert make(background=WATER, before=bp.AIR) == make(before=bp.AIR, after=WATER)


def test_a_membrane_alone_is_a_slab():
    """With or without a list; as in the middle of no air at all, and several as one of their sum."""
    kx = [0.0, 20.0, 60.0]
    alone = bp.Slab(bp.Membrane(0.3))
    assert alone == bp.Slab([bp.Membrane(0.3)]) == bp.Slab(bp.Cell(bp.Membrane(0.3)))
    assert alone.thickness == 0
    thin = bp.Slab([bp.Membrane(0.3), bp.Layer(bp.AIR, 1e-15)])
    for slab in (thin, bp.Slab(bp.Membrane(0.1), 3), bp.Slab(bp.Membrane(0.2)) + bp.Slab(bp.Membrane(0.1))):
        ours, theirs = bp.scattering(slab, F, kx=kx), bp.scattering(alone, F, kx=kx)
        np.testing.assert_allclose(ours.r, theirs.r, rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(ours.t, theirs.t, rtol=1e-12)


def test_fields_and_widths_of_an_interface():
    """The same medium on both sides is no slab at all: the beam, its width and its shift are those in the open."""
    beam, x, z = bp.GaussianBeam(0.096, angle=20, z0=-0.05), np.linspace(-0.3, 0.3, 31), np.array([-0.02, 0.0, 0.1])
    none, air = bp.Slab.interface(), bp.Slab.uniform(bp.AIR, 0.05)
    np.testing.assert_allclose(bp.field(none, beam, F, x, z).p, bp.field(air, beam, F, x, z).p, atol=1e-9)
    assert float(bp.beam_width(none, beam, F).fwhm_out) == pytest.approx(float(bp.beam_width(none, beam, F).fwhm_in))
    assert bp.guided_modes(none, F).sizes["mode"] == 0
    with pytest.warns(bp.HintWarning, match="steel is taken as a fluid"):  # it is meant
        measures = bp.beam_measures(bp.Slab.interface(bp.AIR, STEEL), bp.GaussianBeam(0.096, z0=-0.05), F)
    assert float(measures.power.sum()) == pytest.approx(1, abs=1e-6)


def test_lossless_cell():
    """The real part of rho_m, no delta_rho."""
    assert bp.lmmd_cell(lossless=True) == bp.lmmd_cell(0.05, 0.0)
    assert bp.lmmd_cell(0.3 + 1j, 0.2, lossless=True) == bp.lmmd_cell(0.3, 0.0)


# --- tables -----------------------------------------------------------------------------------------------

STACK = (
    bp.Layer(bp.Fluid.from_speed(1180.0, 2680.0), 2e-3),
    bp.Layer(bp.Fluid.from_speed(998.0, 1482.0, attenuation=5.0), 0.5e-3),
    bp.Layer(bp.Fluid(1.2 + 0.1j, 1.4e5), 1e-2),
    bp.Membrane(0.2),
    bp.Layer(bp.material("steel"), 1e-3),
    bp.Layer(bp.Fluid.from_speed(1060.0, 1595.0, attenuation=bp.power_law(0.5, 1e6, 1.1)), 1e-2),
    bp.Layer(bp.material("acrylic", attenuation=12.0), 1e-2),
)
SHEET = """# a stack, from the near side on
thickness (mm),density,sound_speed [km/s],bulk_modulus_kPa,attenuation (Np/m),areal_density [g/m²],material,reference_frequency_MHz,exponent
2,1180,2.68,,,,,,

0.5,998,1.482,,5,,,,
10,1.2+0.1i,,140,,,,,
,,,,,200,,,
1,,,,,,Steel,,
10,1060,1.595,,5.7564627324851145,,,1,1.1
10,,,,12,,acrylic,,
"""


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_a_table_from_a_file(tmp_path, separator):
    """The same layers as by hand, whatever separates the cells; the mark that Excel writes first is left out."""
    path = tmp_path / "layers.csv"
    path.write_text(SHEET.replace(",", separator), encoding="utf-8-sig")
    slab = bp.Slab.from_table(path, periods=4, background=WATER)
    assert (slab.periods, slab.before, slab.after) == (4, WATER, WATER)
    assert len(slab.cell.layers) == len(STACK)
    for ours, theirs in zip(slab.cell.layers, STACK, strict=True):
        assert ours.thickness == pytest.approx(theirs.thickness, rel=1e-15)
        if isinstance(theirs, bp.Membrane):
            assert ours.areal_density == pytest.approx(theirs.areal_density)
        else:
            np.testing.assert_allclose(ours.fluid.at(3e5), theirs.fluid.at(3e5), rtol=1e-14)


def test_a_table_from_pandas():
    """NaN and None are empty cells, as pandas fills them in."""
    frame = pd.DataFrame(
        [{"thickness": 1e-3, "material": "steel"}, {"thickness": 0.01, "density": 1.25, "sound_speed": 343.0}]
    )
    assert bp.Slab.from_table(frame) == bp.Slab.from_table(frame.convert_dtypes())  # which knows NA
    assert bp.Slab.from_table(frame) == bp.Slab([bp.Layer(bp.material("steel"), 1e-3), bp.Layer(bp.AIR, 0.01)])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("thickness,material\n1,unobtainium\n", "material, row 1: expected a material of beamprop.materials()"),
        (
            "thickness,material\n1,steel\n1,stel\n",
            "material, row 2: expected a material .*, such as 'steel', got 'stel'",
        ),
        ("thickness,material,density\n1,steel,7\n", "density, row 1: expected an empty cell beside material"),
        ("thickness (mm),material\nabc,steel\n", "thickness, row 1: expected a number, got 'abc'"),
        ("thickness,material\n1,air\n-2,air\n", "thickness, row 2: expected a finite number above zero, got -2.0"),
        ("material\nair\n", "thickness, row 1: expected a number, got an empty cell or no such column"),
        ("thickness,density\n1,2\n", "density, row 1: expected material, or density and one of .*, got density"),
        (
            "thickness,density,sound_speed,bulk_modulus\n1,2,3,4\n",
            "density, row 1: expected material, or .*, got den",
        ),
        ("thickness,density,bulk_modulus,attenuation\n1,2,4,4\n", "attenuation, row 1: expected an empty cell besid"),
        (
            "thickness,density,sound_speed,exponent\n1,2,4,4\n",
            "attenuation, row 1: expected a number beside exponent",
        ),
        ("thickness,density,sound_speed\n1,2,0\n", "sound_speed, row 1: expected a finite number other than zero"),
        (
            "thickness,areal_density\n1,2\n",
            "thickness, row 1: expected 0 or nothing beside an areal density, got '1'",
        ),
        (
            "thickness,temperature\n1,2\n",
            r"table: expected columns of thickness \(m, cm, mm, um\), .*, got 'temperature",
        ),
        ("thickness_ft,material\n1,air\n", "table: expected columns of .*, got 'thickness_ft'"),
        ("thickness,thickness_mm\n1,2\n", "table: expected one column of thickness, got 2"),
        ("thickness,material\n1\n", "table: expected 2 cells in row 1, as in the header, got 1"),
        ("thickness,material\n", "table: expected at least one row below the header, got none"),
        ("# nothing\n\n", "table: expected a line of column names, got no text"),
    ],
)
def test_a_wrong_table_names_row_and_column(tmp_path, text, message):
    path = tmp_path / "layers.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match="^" + message):
        bp.Slab.from_table(path)


def test_what_is_no_table(tmp_path):
    """Other objects, other encodings, a file that is not there."""
    with pytest.raises(ValueError, match=r"^table: expected the path of a file, got 3"):
        bp.Slab.from_table(3)
    (tmp_path / "binary.csv").write_bytes(b"thickness\xff\n1\n")
    with pytest.raises(ValueError, match=r"^table: expected text in UTF-8"):
        bp.Slab.from_table(tmp_path / "binary.csv")
    with pytest.raises(FileNotFoundError, match=r"^table: expected an existing file, got '.*none\.csv'"):
        bp.Slab.from_table(tmp_path / "none.csv")


# --- names ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", bp.materials())
def test_every_material_is_a_fluid_with_its_source(name):
    """With the numbers of the table at a frequency where it may be used."""
    row = bp.materials()[name]
    fluid = bp.material(name, attenuation=row.attenuation is not None)
    assert len(row.source) > 20
    assert row.conditions
    k = fluid.wavenumber(1e5)
    assert 2 * np.pi * 1e5 / k.real == pytest.approx(row.sound_speed, rel=1e-6)
    assert fluid.density == row.density
    assert k.imag == pytest.approx(0.0 if row.attenuation is None else float(row.attenuation(1e5)), rel=1e-9)
    assert not bp.material(name).dispersive


def test_names_of_materials():
    """In capitals, with underscores, and by a second name."""
    assert bp.material("Stainless_Steel") == bp.material("stainless steel")
    assert bp.material("aluminum") == bp.material("Aluminium")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": "xyzzy"}, r"^name: expected a material of beamprop.materials\(\), one of air, water, .*got 'xyzzy'"),
        ({"name": "watr"}, r"^name: expected .*, such as 'water', got 'watr'"),
        ({"name": 3}, r"^name: expected the name of a material, got 3"),
        (
            {"name": "steel", "temperature": 20},
            r"^temperature: expected nothing, for steel is known at room .*, got 20",
        ),
        ({"name": "water", "humidity": 20}, r"^humidity: expected nothing, for water"),
        ({"name": "water", "temperature": 120}, r"^temperature: expected 0 to 95 Celsius, .*, got 120"),
        ({"name": "air", "temperature": -5}, r"^temperature: expected 0 to 30 Celsius, .*, got -5"),
        ({"name": "air", "humidity": 120}, r"^humidity: expected 0 to 100 %, .*, got 120"),
        (
            {"name": "steel", "attenuation": True},
            "^attenuation: expected a number or a function, for the table has none of s",
        ),
        ({"name": "steel", "attenuation": "yes"}, "^attenuation: expected a real number, got 'yes'"),
        ({"name": "air", "pressure": 1013.25}, r"^pressure: expected 75000 to 102000 Pa, .*, got 1013"),
    ],
)
def test_wrong_materials(arguments, message):
    with pytest.raises(ValueError, match=message):
        bp.material(**arguments)


def test_a_cell_that_is_made_again_is_the_same_cell():
    """The last one is kept: not beside other arguments, nor in the place of a refusal or a hint."""
    arguments = {"rho_m": 0.3 + 0.1j, "eta": 0.02, "n_layers": 6}
    first = bp.lmmd_cell(**arguments)
    assert bp.lmmd_cell(**arguments) is first
    for change in (
        {"eta": 0.03},
        {"delta_rho": 0.0},
        {"design_frequency": 2000.0},
        {"lossless": True},
        {"background": bp.Fluid(2.0, 2e5)},
    ):
        changed = bp.lmmd_cell(**arguments | change)
        assert changed != first
        assert bp.lmmd_cell(**arguments) == first
    for _ in range(2):
        with pytest.raises(ValueError, match="rho_m, delta_rho: expected a passive medium"):
            bp.lmmd_cell(rho_m=0.05)
        with pytest.warns(bp.HintWarning, match="eta: 3 wavelengths a period"):
            bp.lmmd_cell(eta=3.0)
    with pytest.warns(bp.HintWarning):
        soft = bp.Fluid(1.25, 1400.0)
    for _ in range(2):
        with pytest.warns(bp.HintWarning, match="bulk_modulus"):
            bp.lmmd_cell(lossless=True, rho_m=1.0, eta=0.5, background=soft)
