"""What a newcomer types first about layers of their own, and what they see."""

import numpy as np
import pytest
from click.testing import CliRunner
from command import good

import beamprop as bp
from beamprop import parameters
from beamprop.cli import main
from beamprop.study import files

WATER = ["scattering", "--layer", "water 2mm", "--frequency", "1MHz", "--angle", "0"]


def test_half_spaces_left_at_air_around_water():
    """A hint in the command as in Python; none where it was said, at low frequencies or around steel."""
    said = "warning: --background: air, for none was given"
    assert said in good(*WATER).stderr
    for more in (["--background", "air"], ["--background", "water"], ["--density", "1.25"], ["--frequency", "1kHz"]):
        assert said not in good(*WATER, *more).stderr
    assert said not in good("scattering", "--layer", "steel 2mm", *WATER[3:]).stderr


def test_a_metal_by_its_name_is_a_fluid_with_a_hint(tmp_path):
    """In the command, in a study file and in Python; none at the normal, where nothing shears."""
    said = "slab: steel is taken as a fluid, without shear waves; bp.Solid.from_material('steel') has them (--layer 'solid steel 5mm')"
    off = ["--background", "water", "--frequency", "1MHz", "--angle", "30"]
    assert f"warning: {said}" in good("scattering", "--layer", "steel 5mm", *off).stderr
    (tmp_path / "s.toml").write_text(
        '[question]\nname = "scattering"\nangle = [0, 30]\nfrequency = "1MHz"\n'
        '[slab]\nbackground = "water"\nlayer = ["steel 5mm"]\n[sweep]\nslab.periods = [1]\n'
    )
    with pytest.warns(RuntimeWarning, match="HintWarning: slab: steel is taken as a fluid"):
        files.read(tmp_path / "s.toml").answer(workers=1)
    assert "taken as a fluid" not in good("scattering", "--layer", "steel 5mm", *off[:-1], "0").stderr
    for layer in ("solid steel 5mm", "acrylic 5mm", "density=7850 speed=5000 5mm"):
        assert "taken as a fluid" not in good("scattering", "--layer", layer, *off).stderr


@pytest.mark.filterwarnings("ignore::beamprop.HintWarning")
def test_what_shear_waves_of_a_metal_change():
    """The numbers of docs/pitfalls.md."""
    for steel, known in ((bp.material("steel"), 3e-5), (bp.Solid.from_material("steel"), 0.84)):
        plate = bp.Slab(bp.Layer(steel, 5e-3), background=bp.material("water"))
        size = float(abs(bp.scattering(plate, 1e6, angle=30.0).t))
        assert float(f"{size:.0e}" if size < 1e-3 else f"{size:.2f}") == known


WATER_AROUND, STEEL = bp.material("water"), bp.material("steel")


@pytest.mark.parametrize(
    "ask",
    [
        lambda slab: bp.scattering(slab, 1e6, angle=[0.0, 30.0]),
        lambda slab: bp.field(slab, bp.GaussianBeam(0.02, z0=-0.01), 2e5, 0.0, 0.01),
        lambda slab: bp.field(slab, bp.GaussianBeam((0.02, 0.02), z0=-0.01), 2e5, 0.0, 0.01, y=0.0),
        lambda slab: bp.beam_width(slab, bp.GaussianBeam(0.02, z0=-0.01), 2e5),
        lambda slab: bp.guided_modes(slab, 2e4, strip_over_k0=0.1),
    ],
    ids=["scattering", "field", "in space", "beam_width", "guided_modes"],
)
def test_every_question_hints_at_a_metal_that_stands_as_a_fluid(ask):
    fluid = bp.material("steel", attenuation=2.0)  # with loss, too
    for slab in (bp.Slab(bp.Layer(fluid, 2e-3), background=WATER_AROUND), bp.Slab.interface(WATER_AROUND, STEEL)):
        with pytest.warns(bp.HintWarning, match="^slab: steel is taken as a fluid") as warned:
            ask(slab)
        assert warned[0].filename == __file__


@pytest.mark.parametrize(
    ("typed", "nepers"), [("0.5dB/cm", 5.756462732), ("50dB/m", 5.756462732), ("3Np/cm", 300.0), ("1/4", 0.25)]
)
def test_attenuation_of_a_layer(typed, nepers):
    """20 log10(e) dB are a neper."""
    layer = parameters.layer(f"density=1000 speed=1480 attenuation={typed} 2mm")
    assert complex(layer.fluid.wavenumber(1e6)).imag == pytest.approx(nepers, rel=1e-9)


def test_an_unknown_unit_of_attenuation():
    ran = CliRunner().invoke(main, ["scattering", "--layer", "density=1e3 speed=1480 attenuation=1dB/foot 2mm"])
    assert ran.exit_code == 2
    assert "attenuation of --layer: expected a number [Np/m], or such as 0.5dB/cm, got '1dB/foot'" in ran.stderr


def test_speed_is_a_column(tmp_path):
    """As it is a word of --layer."""
    (tmp_path / "a.csv").write_text("Thickness (mm),Density,Speed [km/s]\n2,1000,1.48\n")
    slab = bp.Slab.from_table(tmp_path / "a.csv")
    assert slab.segments[0][0].layers == (bp.Layer(bp.Fluid.from_speed(1000.0, 1480.0), 0.002),)


def test_the_field_at_one_place_is_a_number():
    """Not the largest of one."""
    options = ["--periods", "5", "--x", "0", "--z", "0.02", "--rtol", "1e-6"]
    p = bp.field(bp.Slab(bp.lmmd_cell(), 5), bp.GaussianBeam(0.096, z0=-0.1), 2500.0, 0.0, 0.02, rtol=1e-6).p.item()
    lines = good("field", *options).stdout.splitlines()
    assert lines[1] == f"p {p:.6g} Pa"
    assert not any("largest |p| " in line and "Pa" in line for line in lines)


@pytest.mark.parametrize(("scale", "unit"), [(1.0, "m"), (1e-3, "mm"), (1e-6, "µm")])
def test_small_maps_are_told_in_small_units(scale, unit):
    """On the same data, in m."""
    at = np.linspace(0, scale, 11)
    p = bp.field(bp.Slab.interface(), bp.GaussianBeam(0.1), 2500.0, at, at, rtol=1e-6)
    ax = bp.plot.field(p)
    assert (ax.get_xlabel(), ax.get_ylabel()) == (f"z [{unit}]", f"x [{unit}]")
    ax.figure.canvas.draw()
    assert "0.4" in [text.get_text() for text in ax.get_xticklabels()]
    assert ax.get_xlim()[1] == pytest.approx(1.05 * scale)


def test_a_map_is_no_table(tmp_path):
    """`convert` names what was typed."""
    source = tmp_path / "a.mat"
    good("field", "--periods", "2", "--x", "0,0.1", "--z", "0,0.1", "--rtol", "1e-6", "--output", source)
    ran = CliRunner().invoke(main, ["convert", str(source), str(tmp_path / "a.csv")])
    assert ran.exit_code == 2
    assert "Error: TARGET: expected one dimension, which a table has, got z 2, x 2: select one value in" in ran.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.mat"]


def test_warnings_are_printed_where_a_question_is_refused():
    """A warning may tell why: here that no unit of the angles was named."""
    ran = CliRunner().invoke(
        main, ["beam_width", "--layer", "density=1000 bulk_modulus=343 2mm", "--frequency", "1e6,0"]
    )
    assert ran.exit_code == 2
    lines = ran.stderr.splitlines()
    assert any(line.startswith("warning: ") and "bulk_modulus" in line for line in lines)
    assert lines[-1].startswith("Error: --frequency: ")


def test_measures_and_planes_have_their_units_and_axes():
    assert "power [1]; divergence [degree]\n" in good("beam_measures", "--lossless", "--periods", "5").stdout
    said = good("field", "--periods", "5", "--x=-.2:.2:11", "--z=0:1:5", "--variables", "p,power_through").stdout
    assert "p on (z 5, x 11)\npower_through on (z 5)\n" in said
