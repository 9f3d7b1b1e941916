"""Media in the user's words: half-spaces, faces, tables, names; what is refused, and what a file brings back."""

import dataclasses

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
        ("thickness,material\n1,unobtainium\n", "name, row 1: expected a material of beamprop.materials()"),
        ("thickness,material\n1,steel\n1,stel\n", "name, row 2: expected a material .*, such as 'steel', got 'stel'"),
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
    """Other objects, other encodings; a file that is not there is Python's own error."""
    with pytest.raises(ValueError, match=r"^table: expected the path of a file, got 3"):
        bp.Slab.from_table(3)
    (tmp_path / "binary.csv").write_bytes(b"thickness\xff\n1\n")
    with pytest.raises(ValueError, match=r"^table: expected text in UTF-8"):
        bp.Slab.from_table(tmp_path / "binary.csv")
    with pytest.raises(FileNotFoundError):
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


# --- attenuation ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: bp.power_law(-1, 1e6), "^db_per_cm: expected a number of at least 0, got -1"),
        (lambda: bp.power_law(1, 0), "^reference_frequency: expected a finite number above zero"),
        (lambda: bp.power_law(1, 1e6, 5), "^exponent: expected a number from 0 to 4, got 5"),
        (lambda: bp.power_law(1, 1e6, 3, dispersion=True), "^exponent: expected a number above 0, of at most 2, with"),
        (lambda: bp.power_law(1, 1e6, dispersion=1), "^dispersion: expected True or False, got 1"),
        (lambda: bp.Fluid.from_speed(1e3, 1500, -1.0), "^attenuation: expected at least 0 Np/m .*, got -1"),
        (lambda: bp.Fluid.from_speed(1e3, 1500, 1j), "^attenuation: expected a real number"),
        (lambda: bp.Fluid.from_speed(1e3, 1500 - 1j, 1.0), "^sound_speed: expected a real number above zero beside an"),
        (lambda: bp.Fluid.from_speed(-1e3, 1500, 1.0), "^density: expected a real number above zero beside an atten"),
        (
            lambda: bp.Fluid.from_speed(1e3, 1500, lambda f: -f).at(1e6),
            "^attenuation: expected values of at least 0 Np/m, got -1e",
        ),
        (lambda: bp.Fluid.from_speed(1e3, 1500, lambda f: 1.0).at(np.ones(2)), "^attenuation: expected a function"),
        (
            lambda: bp.Fluid.from_speed(1e3, 1500, bp.power_law(100, 1e6, 1.0, dispersion=True)).at(
                np.array([1e6, 1e12])
            ),
            r"^attenuation: expected a dispersion that leaves a phase velocity above zero, got PowerLaw.* at 1e\+12 Hz",
        ),
        (lambda: bp.Tabulated([2.0, 1.0], [1, 1]), "^frequency: expected a 1-D array of finite, strictly increasing"),
        (lambda: bp.Tabulated([-2.0, 1.0], [1, 1]), "^frequency: expected frequencies above zero, got -2"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, 1, 1]), "^values: expected one for each of 2 frequencies, got shape"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, np.nan]), "^values: expected finite values"),
        (lambda: bp.Tabulated([1.0, 2.0], [1, 2])(3.0), "^frequency: this medium is known from 1.0 to 2.0 Hz only"),
    ],
)
def test_wrong_attenuations(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_gain_by_negative_attenuation():
    """Where it is asked for, as a number and as a function."""
    for attenuation in (-1.0, lambda f: -1.0 + 0 * f):
        fluid = bp.Fluid.from_speed(1e3, 1500.0, attenuation, active=True)
        assert fluid.at(1e6).bulk_modulus.imag > 0


def test_energies_in_a_material():
    """Half-spaces by name are lossless unless asked for, so that shares of energy have a meaning."""
    slab = bp.Slab.uniform(bp.material("liver", attenuation=True), 0.01, background=bp.material("water"))
    ds = bp.scattering(slab, 1e6, angle=[0, 30])
    assert np.all(ds.absorption > 0.05)


# --- models -----------------------------------------------------------------------------------------------


def jca(**changed):
    usual = {
        "flow_resistivity": 1e4,
        "porosity": 0.97,
        "tortuosity": 1.1,
        "viscous_length": 1e-4,
        "thermal_length": 2e-4,
    }
    return bp.johnson_champoux_allard(**(usual | changed))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        *[(lambda n=n: jca(**{n: 0}), f"^{n}: expected ") for n in ("flow_resistivity", "porosity", "viscous_length")],
        (lambda: jca(porosity=1.2), "^porosity: expected a number above 0, of at most 1, got 1.2"),
        (lambda: jca(tortuosity=0.5), "^tortuosity: expected a number of at least 1, got 0.5"),
        (lambda: jca(gas="air"), "^gas: expected a Gas, got 'air'"),
        (lambda: bp.Gas(viscosity=0), "^viscosity: expected a finite number above zero"),
        (lambda: bp.Gas(heat_capacity_ratio=0.5), "^heat_capacity_ratio: expected a number of at least 1"),
        (lambda: bp.delany_bazley_miki(-1), "^flow_resistivity: expected a finite number above zero"),
        (
            lambda: bp.delany_bazley_miki(1e4).at(99.0),
            "^frequency: expected 100 to 10000 Hz, where delany_bazley.* got 99",
        ),
        (
            lambda: bp.delany_bazley_miki(1e4).at(np.array([500, 2e4])),
            "^frequency: expected 100 to 10000 Hz, .* got 20000",
        ),
        (lambda: bp.narrow_slits(0), "^width: expected a finite number above zero"),
        (lambda: bp.narrow_slits(1e-3, 2.0), "^porosity: expected a number above 0, of at most 1, got 2"),
        (lambda: bp.narrow_tubes("a"), "^radius: expected a real number, got 'a'"),
        (lambda: bp.narrow_tubes(1e-3, gas=bp.AIR), "^gas: expected a Gas"),
        (lambda: bp.wood_mixture((WATER, 0.5)), "^parts: expected shares of the volume that add up to 1, got 0.5"),
        (lambda: bp.wood_mixture(WATER, 0.5), r"^parts: expected pairs \(Fluid, share of the volume\)"),
        (lambda: bp.wood_mixture((3, 1.0)), "^parts: expected a Fluid, got 3"),
        (lambda: bp.wood_mixture((bp.Fluid(1, 1e5, 2), 1.0)), "^parts: expected isotropic fluids, got Fluid"),
        (
            lambda: bp.wood_mixture((WATER, 1.1), (bp.AIR, -0.1)),
            "^parts: expected a finite number above zero, got -0.1",
        ),
        (lambda: bp.Membrane.drude(0, 1.0), "^areal_density: expected a finite number above zero"),
        (lambda: bp.Membrane.drude(1.0, 700.0, -1.0), "^linewidth: expected a number of at least 0, got -1"),
        (lambda: bp.Membrane.lorentz(1.0, -5.0, 1.0), "^resonance_frequency: expected a finite number above zero"),
        (lambda: bp.Membrane.lorentz(1.0, 5.0, 1.0).at(np.array([5.0])), "^areal_density: expected finite values"),
    ],
)
def test_wrong_models(make, message):
    with pytest.raises(ValueError, match=message):
        make()


# --- hints ------------------------------------------------------------------------------------------------

ULTRASOUND = 1e6
PLATE = bp.Slab.uniform(bp.material("water"), 1e-3)
WIDE = bp.GaussianBeam(9.6, z0=-0.1)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda: bp.Fluid(1.25, 343.0),
            r"^bulk_modulus: 343 Pa looks like a sound speed, which Fluid.from_speed\(1.25, 343",
        ),
        (lambda: bp.Fluid(1000, 1500), "^bulk_modulus: 1500 Pa looks like a sound speed"),
        (lambda: bp.Fluid(7850, 5960), "^bulk_modulus: 5960 Pa looks like a sound speed"),
        (lambda: bp.lmmd_cell(eta=60), "^eta: 60 wavelengths a period; for 60 periods a wavelength give eta=1/60"),
        (
            lambda: bp.scattering(PLATE, ULTRASOUND, angle=0),
            "^before, after: air, for none was given, around layers like",
        ),
        (lambda: bp.beam_width(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, rtol=1e-3), "^before, after: air"),
        (lambda: bp.beam_measures(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, rtol=1e-3), "^before, after: air"),
        (lambda: bp.field(PLATE, bp.GaussianBeam(0.01), ULTRASOUND, 0.0, 0.0, rtol=1e-3), "^before, after: air"),
        (
            lambda: bp.field(bp.Slab(CELL, 20), WIDE, F, np.linspace(-1.4, 1.4, 101), 0.1),
            "^fwhm: 9.6 m is 70 wavelengths, and x spans 2.8 m: is it in metres",
        ),
    ],
)
@pytest.mark.filterwarnings("ignore::RuntimeWarning", "ignore::beamprop.AccuracyWarning")
def test_a_likely_slip_is_hinted_at(ask, message):
    """One hint, at the line that the user wrote; the answer is given all the same."""
    with pytest.warns(bp.HintWarning, match=message) as caught:
        assert ask() is not None
    hints = [w for w in caught if w.category is bp.HintWarning]
    assert [w.filename for w in hints] == [__file__]


def test_what_is_meant_is_not_hinted_at():
    """Warnings are errors here: half-spaces that are given, audible frequencies, plates, soft media, gases of low pressure."""
    water = bp.material("water")
    for sides in ({"background": bp.AIR}, {"background": water}, {"before": bp.AIR}, {"after": water}):
        bp.scattering(bp.Slab.uniform(water, 1e-3, **sides), ULTRASOUND, angle=0)
    bp.scattering(bp.Slab.uniform(water, 0.05), F, angle=0)
    bp.scattering(bp.Slab([bp.Layer(bp.AIR, 1e-3), bp.Layer(water, 1e-3)]), ULTRASOUND, angle=0)
    bp.scattering(bp.Slab.uniform(bp.material("steel"), 1e-3), ULTRASOUND, angle=0)
    for density, modulus in (
        (1.25, 1.4e5),
        (1.0, 1.0),
        (0.012, 1400.0),
        (1000.0, 1e5),
        (300.0, 3000.0),
        (1.2, 343 - 5j),
    ):
        bp.Fluid(density, modulus)
    bp.lmmd_cell(eta=0.5)
    bp.lmmd_cell(eta=1.5)
    bp.field(bp.Slab.uniform(bp.AIR, 0.1), WIDE, F, np.linspace(-10, 10, 101), 0.1, rtol=1e-4)
    bp.field(bp.Slab.uniform(bp.AIR, 0.1), WIDE, F, 0.0, 0.1, rtol=1e-4)
    closely = np.linspace(-1e-3, 1e-3, 101)  # into the middle of a beam of 34 wavelengths
    bp.field(bp.Slab.interface(water, water), bp.GaussianBeam(0.05), ULTRASOUND, closely, 0.0, rtol=1e-4)


# --- what files record ------------------------------------------------------------------------------------

RECORDED = {
    "power law": bp.Fluid.from_speed(1e3, 1500.0, bp.power_law(0.5, 1e6, 1.1, dispersion=True)),
    "constant attenuation": bp.Fluid.from_speed(1e3, 1500.0, 5.0),
    "tabulated attenuation": bp.Fluid.from_speed(1e3, 1500.0, bp.Tabulated([1e3, 1e4], [1.0, 2.0])),
    "water": bp.material("water", temperature=30, attenuation=True),
    "air": bp.material("air", humidity=20, attenuation=True),
    "liver": bp.material("liver", attenuation=True),
    "johnson_champoux_allard": jca(),
    "delany_bazley_miki": bp.delany_bazley_miki(2e4),
    "narrow_slits": bp.narrow_slits(1e-3, 0.5, bp.Gas(density=1.1)),
    "narrow_tubes": bp.narrow_tubes(1e-3),
    "wood_mixture": bp.wood_mixture((bp.material("water", attenuation=True), 0.9), (bp.AIR, 0.1)),
}


@pytest.mark.parametrize("name", RECORDED)
def test_provenance_rebuilds_the_medium(name):
    """The record makes an equal slab; a medium is hashable, and cannot be changed."""
    fluid = RECORDED[name]
    sheets = bp.Membrane.drude(0.1, 3000.0, 10.0), bp.Membrane.lorentz(0.1, 2000.0, 0.2, 10.0)
    slab = bp.Slab([bp.Layer(fluid, 0.1), *sheets], background=fluid)
    assert bp.provenance(bp.scattering(slab, [F, 2600.0], kx=1.0))["slab"] == slab
    assert len({fluid, RECORDED[name]}) == 1
    assert "object at 0x" not in repr(fluid)
    for part in (fluid.density, fluid.bulk_modulus):
        if dataclasses.is_dataclass(part):
            with pytest.raises(dataclasses.FrozenInstanceError):
                part.density = 1.0


@pytest.mark.parametrize("name", sorted(set(RECORDED) - {"tabulated attenuation"}))
def test_media_are_analytic_in_frequency(name):
    """The derivatives along the real and the imaginary axis agree, at a complex frequency: so do kernels take them."""
    fluid, f, step = RECORDED[name], 3000.0 + 200.0j, 0.5
    for prop in ("rho_z", "bulk_modulus"):
        at = {d: getattr(fluid.at(np.array(f + d)), prop) for d in (step, -step, 1j * step, -1j * step)}
        along, across = at[step] - at[-step], (at[1j * step] - at[-1j * step]) / 1j
        assert abs(along - across) <= 1e-4 * abs(along) + 1e-13 * abs(at[step])
