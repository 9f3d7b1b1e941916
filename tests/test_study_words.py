"""What a user wrote into study files: layers in words, swept as those in tables, and mistakes of every kind beside one another."""

import numpy as np
import pytest
from study_texts import written, wrong

import beamprop as bp
from beamprop.study import files

WORDS = """
[question]
name = "scattering"
frequency = "1MHz"
angle = 10
[slab]
background = "water"
layer = LAYER
[sweep]
"PATH" = VALUES
"""


@pytest.mark.parametrize(
    ("layer", "path", "values"),
    [
        ('["acrylic 1mm", "solid steel 5mm"]', "slab.layer.2.thickness", '["3mm", "5mm"]'),
        ('["acrylic 1mm", "density=1 speed=1 1mm"]', "slab.layer.2", '["solid steel 3mm", "solid steel 5mm"]'),
    ],
)
def test_layers_in_words_are_swept(layer, path, values, tmp_path):
    """A value within the words, and the words as a value: each point as the call gives it."""
    text = WORDS.replace("LAYER", layer).replace("PATH", path).replace("VALUES", values)
    ds = files.read(written(tmp_path, text)).answer(workers=1)
    acrylic, steel, water = bp.material("acrylic"), bp.Solid.from_material("steel"), bp.material("water")
    for i, thickness in enumerate((3e-3, 5e-3)):
        slab = bp.Slab(bp.Cell([bp.Layer(acrylic, 1e-3), bp.Layer(steel, thickness)]), 1, water, water)
        assert ds.t.values[i] == bp.scattering(slab, 1e6, angle=10.0).t.item()


def test_the_one_layer_in_words_is_swept(tmp_path):
    """Words alone instead of a list; by either path."""
    for path, values in (("slab.layer.1.thickness", "[1e-3, 2e-3]"), ("slab.layer.1", '["air 1mm", "air 2mm"]')):
        text = WORDS.replace("LAYER", '"air 5mm"').replace("PATH", path).replace("VALUES", values)
        water = bp.material("water")
        slabs = [bp.Slab.uniform(bp.material("air"), thickness, water, water) for thickness in (1e-3, 2e-3)]
        expected = [bp.scattering(slab, 1e6, angle=10.0).t.item() for slab in slabs]
        np.testing.assert_array_equal(files.read(written(tmp_path, text)).answer(workers=1).t, expected)


@pytest.mark.parametrize(
    ("layer", "path", "values", "where", "message"),
    [
        ('"air 5mm"', "slab.layer.2.thickness", "[1]", "sweep.slab.layer.2.thickness", "expected the path of a value"),
        ('"air 5mm"', "slab.layer.1.thicknes", "[1]", "sweep.slab.layer.1.thicknes", "expected the path of a value"),
        ('"air 5mm"', "slab.layer.1", '["air 1mm", "airr"]', "sweep.slab.layer.1", "'air 5mm' or 'density=1000 speed"),
        ('"air"', "slab.layer.1.eta", "[1]", "slab.layer", "expected a fluid and a thickness"),
    ],
)
def test_wrong_sweeps_of_words(layer, path, values, where, message, tmp_path):
    said = wrong(tmp_path, WORDS.replace("LAYER", layer).replace("PATH", path).replace("VALUES", values))
    assert any(place.startswith(where) and message in text for place, text in said.items()), said


WRONG = """
[question]
name = "NAME"
frequency = "-1MHz"
rtol = 2
angle = 90
[slab]
layer = ["solid steel 5mm"]
background = "water"
[beam]
piston = "-12.5mm"
z0 = "3cm"
"""


def test_values_of_the_wrong_sign_are_named_together(tmp_path):
    """Of a question, and of a source, whose place is looked at whatever else is wrong with it."""
    said = wrong(tmp_path, WRONG.replace("NAME", "field"))
    assert {path: text.partition(", got ")[2] for path, text in said.items()} == {
        "question.frequency": "-1000000.0",
        "question.angle": "90.0",
        "question.rtol": "2.0",
        "beam.piston": "-0.0125",
        "beam.z0": "0.03",
    }


def test_unknown_names_hide_no_wrong_values(tmp_path):
    """A name that is unknown in each table, and what is wrong beside it; plane waves may graze, and have no beam."""
    text = WRONG.replace("NAME", "field").replace("piston", "pistn").replace("rtol = 2", "Y = 0")
    said = wrong(tmp_path, text.replace("steel 5mm", "steel -5mm"))
    assert said.keys() == {
        "question.Y",
        "question.frequency",
        "question.angle",
        "slab.layer.1.thickness",
        "beam.pistn",
        "beam.z0",
    }
    said = wrong(tmp_path, WRONG.replace("NAME", "scattering").partition("[beam]")[0].replace("rtol = 2", ""))
    assert said.keys() == {"question.frequency"}
    said = wrong(tmp_path, WRONG.replace('background = "water"', "eta = 2").replace("NAME", "field"))
    assert said["slab.eta"] == "expected to be left out beside layer, got 2"  # which is seen of the whole table
    assert len(said) == 6
