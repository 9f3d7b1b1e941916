"""What the command says of a field: numbers at few places, typed or from a study file."""

import numpy as np
import pytest
from command import P, good

import beamprop as bp

SLAB, SMALL = bp.Slab(bp.lmmd_cell(), 20), ["field", *P, "--rtol", "1e-6"]


def rows(text):
    """The lines of numbers alone."""
    found = []
    for line in text.splitlines():
        try:
            found.append([float(part) for part in line.split()])
        except ValueError:
            continue
    return [row for row in found if row]


def of_python(x, z):
    return bp.field(SLAB, bp.GaussianBeam(0.096, z0=-0.1), 2500.0, x, z, rtol=1e-6).p.values


def test_along_one_axis_there_are_magnitude_and_phase():
    z = [0.0, 0.01, 0.05]
    out = good(*SMALL, "--x", "0", "--z", "0,1cm,5cm").stdout
    p = of_python(0.0, z)
    assert "z [m]; |p| [Pa]; arg p [degree]" in out
    np.testing.assert_allclose(rows(out), np.stack([z, abs(p), np.degrees(np.angle(p))], 1), rtol=1e-5)
    assert f"largest |p| {abs(p).max():.6g} Pa" in out
    assert "estimated error" in out


def test_at_one_place_there_are_both_forms_of_the_number():
    p = of_python(0.0, 0.01).item()
    lines = good(*SMALL, "--x", "0", "--z", "1cm").stdout.splitlines()
    assert lines[1:3] == [f"p {p:.6g} Pa", f"|p| {abs(p):.6g} Pa, arg p {np.degrees(np.angle(p)):.6g} degree"]


def test_in_three_dimensions_too():
    options = [
        "--layer",
        "acrylic 1mm",
        "--background",
        "water",
        "--frequency",
        "0.1MHz",
        "--piston",
        "1cm",
        "--z0=-1cm",
    ]
    out = good("field", *options, "--rtol", "1e-3", "--x", "0", "--y", "0", "--z", "1cm,2cm").stdout
    water = bp.material("water")
    slab = bp.Slab.uniform(bp.material("acrylic"), 1e-3, water, water)
    p = bp.field(slab, bp.Piston(0.01, z0=-0.01), 1e5, 0.0, [0.01, 0.02], rtol=1e-3, y=0.0).p.values
    np.testing.assert_allclose(rows(out), np.stack([[0.01, 0.02], abs(p), np.degrees(np.angle(p))], 1), rtol=1e-5)


def test_of_many_places_some_are_shown_with_both_ends():
    out = good(*SMALL, "--x", "0:0.4:41", "--z", "0").stdout
    shown = rows(out)
    assert len(shown) == 20
    assert (shown[0][0], shown[-1][0]) == (0.0, 0.4)
    assert "(20 of 41 rows shown)" in out


def test_few_places_on_two_axes_have_a_table_for_each_quantity():
    out = good(*SMALL, "--x", "0,5cm", "--z", "0,1cm,5cm").stdout
    p = of_python([0.0, 0.05], [0.0, 0.01, 0.05])
    np.testing.assert_allclose(np.array(rows(out))[:3, 1:], abs(p), rtol=1e-5)
    np.testing.assert_allclose(np.array(rows(out))[3:, 1:], np.degrees(np.angle(p)), rtol=1e-5)
    many = good(*SMALL, "--x", "0:0.1:7", "--z", "0,1cm,5cm").stdout
    assert rows(many) == []
    assert "p on (z 3, x 7)" in many


def test_real_variables_and_planes_are_shown_as_they_are():
    out = good(*SMALL, "--x", "0,5cm", "--z", "0,1cm", "--variables", "intensity,power_through").stdout
    ds = bp.field(
        SLAB,
        bp.GaussianBeam(0.096, z0=-0.1),
        2500.0,
        [0.0, 0.05],
        [0.0, 0.01],
        rtol=1e-6,
        variables=["intensity", "power_through"],
    )
    numbers = rows(out)
    np.testing.assert_allclose(np.array(numbers[2:4])[:, 1:], ds.intensity_z, rtol=1e-5)
    np.testing.assert_allclose(np.array(numbers[4:])[:, 1], ds.power_through, rtol=1e-5)
    sizes = good(*SMALL, "--x", "0:0.1:30", "--z", "0,1cm", "--variables", "intensity,power_through").stdout
    assert "intensity_x, intensity_z on (z 2, x 30)\npower_through on (z 2)\n" in sizes


def test_of_a_map_that_is_in_a_file_alone_there_are_the_sizes(tmp_path):
    typed = ["--x", "0,5cm", "--z", "0,1cm,5cm", "--memory", "1", "--output", tmp_path / "a.nc"]
    out = good(*SMALL, *typed, "--variables", "p,power_through").stdout
    assert "p on (z 3, x 2)\n" in out
    np.testing.assert_allclose(np.array(rows(out))[:, 1], bp.load(tmp_path / "a.nc").power_through, rtol=1e-5)


STUDY = """
[question]
name = "NAME"
AXES
[slab]
periods = 20
"""


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("field", {"x": "0", "z": "1cm"}),
        ("field", {"x": "0", "z": "1cm,2cm"}),
        ("beam_width", {"frequency": "2500"}),
        ("scattering", {"kx_over_k0": "0:1:3"}),
        ("bloch", {"kx_over_k0": "0,1"}),
    ],
)
def test_a_study_of_one_question_says_what_the_command_says(name, options, tmp_path):
    """The numbers, without a table for output."""
    text = STUDY.replace("NAME", name).replace(
        "AXES", "\n".join(f'{key} = "{value}"' for key, value in options.items())
    )
    path = tmp_path / "study.toml"
    path.write_text(text if name != "bloch" else text.partition("[slab]")[0])
    typed = [part for key, value in options.items() for part in (f"--{key.replace('_', '-')}", value)]
    out = good("run", path).stdout
    assert out == good(name, *(P if name != "bloch" else []), *typed).stdout
    if name == "field":
        p = bp.field(SLAB, bp.GaussianBeam(0.096, z0=-0.1), 2500.0, 0.0, 0.01).p.item()
        assert f"{abs(p):.6g}" in out
