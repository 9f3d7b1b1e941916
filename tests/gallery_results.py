"""What the studies of the gallery find, computed once."""

import importlib
from functools import cache

from source_tree import CHECKOUT

GALLERY = CHECKOUT / "experiments" / "gallery"


@cache
def result_of(name):
    """The result of a study at reduced size."""
    return importlib.import_module(name).study(quick=True)
