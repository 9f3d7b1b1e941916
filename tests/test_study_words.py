"""Layers in words of a study file, swept as those in tables."""

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
