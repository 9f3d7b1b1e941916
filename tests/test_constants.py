"""The script that measures constants again changes those that are in the package, and puts them back."""

import importlib

import constants
import pytest


@pytest.mark.parametrize("constant", constants.CONSTANTS, ids=lambda constant: constant.name)
def test_constants_are_where_the_script_says(constant):
    module = importlib.import_module(f"beamprop.{constant.module}")
    value = getattr(module, constant.name)
    assert value not in constant.values
    for changed_to in constant.values:
        with constants.changed(constant, changed_to):
            assert getattr(module, constant.name) == changed_to
    assert getattr(module, constant.name) == value
