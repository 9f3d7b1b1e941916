"""What makes two questions the same study: equal parts for equal questions, different ones for different answers."""

import functools
import linecache

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import beamprop as bp
from beamprop.study.fingerprint import LONGEST, parts_of, text_of

SHIFT = 1.0


def shifted(value):
    """Reads a global, calls a function of this module."""
    return doubled(value) + SHIFT


def doubled(value):
    return 2.0 * value


def recursive(value):
    return value if value < 1 else recursive(value - 1)


class Scaled:
    def __init__(self, factor):
        self.factor = factor

    def __call__(self, value):
        return shifted(value) * self.factor

    def of(self, value):
        return self(value)


def test_a_function_is_its_source_and_what_it_reads():
    parts = parts_of(shifted)
    assert set(parts) == {"question.source", "doubled.source", "SHIFT.value"}
    assert parts["SHIFT.value"] == "1.0"
    assert parts["doubled.source"] == "def doubled(value):\n    return 2.0 * value"
    assert set(parts_of(recursive)) == {"question.source"}


def test_packages_stand_by_their_names():
    """Neither NumPy nor beamprop is followed."""
    question = lambda eta: bp.lmmd_cell(eta=np.sin(eta))  # noqa: E731
    assert parts_of(question) == {
        "question.source": "bp.lmmd_cell(eta=np.sin(eta))",
        "bp.value": "beamprop",
        "np.value": "numpy",
    }
    assert parts_of(bp.beam_width) == {"question.value": "beamprop.api.beam_width.beam_width"}


def test_lambdas_are_their_bodies():
    """Of several on a line, each its own; layout does not count."""
    first, second = (lambda v: v + 1), (lambda v: v + 2)
    assert parts_of(first) == {"question.source": "v + 1"}
    assert parts_of(second) == {"question.source": "v + 2"}
    long = lambda v: [  # noqa: E731
        v,
        "ä" * 2,
    ]
    assert parts_of(long)["question.source"] == "[v, 'ä' * 2]"


def test_code_without_source_is_its_instructions():
    names = [{}, {}, {}]
    for space, text in zip(names, ("v + 1", "v + 1", "v + 2"), strict=True):
        exec(f"def question(v): return {text}", space)
    same, again, different = (parts_of(space["question"]) for space in names)
    assert same == again
    assert same != different


def test_a_text_of_another_program_is_no_source(monkeypatch):
    """Python 3.13 keeps the program of `python -c` under the name that executed texts have, too."""
    monkeypatch.setitem(linecache.cache, "<string>", (9, None, ["def question(v): return 7\n"], "<string>"))
    names = [{}, {}]
    for space, text in zip(names, ("v + 1", "v + 2"), strict=True):
        exec(f"def question(v): return {text}\nshort = lambda v: {text}", space)
    for name in ("question", "short"):
        assert parts_of(names[0][name]) != parts_of(names[1][name])


def test_objects_and_partials():
    assert parts_of(Scaled(2)) == parts_of(Scaled(2))
    assert parts_of(Scaled(2)) != parts_of(Scaled(3))
    assert {"question.value", "Scaled.source", "SHIFT.value"} <= set(parts_of(Scaled(2)))
    assert parts_of(Scaled(2).of) != parts_of(Scaled(3).of)
    assert parts_of(functools.partial(Scaled(2), value=1)) != parts_of(functools.partial(Scaled(2), value=2))


LONG = np.arange(10_000.0)
CHANGED = np.where(LONG == 5000, 0.0, LONG)


@pytest.mark.parametrize(
    "make",
    [
        lambda v: v,
        lambda v: {"a": [v, 3]},
        lambda v: xr.Dataset({"v": ("x", v)}),
        lambda v: pd.DataFrame({"v": v}),
        lambda v: v.astype(object),
        lambda v: set(v.tolist()),
        lambda v: bp.Profile(np.arange(10_000.0), v),
        lambda v: Scaled(v),
    ],
)
def test_a_value_in_the_middle_of_much_data_counts(make):
    assert text_of(make(LONG)) == text_of(make(LONG.copy()))
    assert text_of(make(LONG)) != text_of(make(CHANGED))


def test_texts_are_bounded():
    """A slab of many layers is recorded by its begin and a checksum of all."""
    layers = [bp.Layer(bp.AIR, 0.001 * (k + 1)) for k in range(500)]
    slab, changed = bp.Slab(layers), bp.Slab([*layers[:-1], layers[0]])
    texts = [parts_of(lambda v, slab=s: slab)["defaults.value"] for s in (slab, changed)]
    assert all(len(text) < LONGEST + 20 for text in texts)
    assert texts[0] != texts[1]
