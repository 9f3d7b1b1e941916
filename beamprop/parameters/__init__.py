"""From plain values to objects: a table of strings and numbers becomes a slab, a beam or axes.

Options of the command and tables in files share the names, defaults and texts that stand here, and the form of error that names
the key: ``ValueError("periods: expected ..., got ...")``. NumPy and the rooms are imported inside the functions, so that the command
shows its help at once.

values.py: one number, with its unit. tables.py: what a table may hold. models.py: fluids that change with frequency, by the name of a model. media.py: `cell` and `slab`. sources.py: `beam`. pictures.py: what is said of a picture. scale.py: the
axes and lengths that are taken where none are given, by the wavelength.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .media import BACKGROUND as BACKGROUND
from .media import BEHIND as BEHIND
from .media import CELL as CELL
from .media import FLUID as FLUID
from .media import LAYER as LAYER
from .media import LAYERS as LAYERS
from .media import LMMD as LMMD
from .media import PART as PART
from .media import SLAB as SLAB
from .media import cell as cell
from .media import fluid_of as fluid_of
from .media import layer as layer
from .media import layer_of as layer_of
from .media import of_layers as of_layers
from .media import slab as slab
from .media import stack as stack
from .pictures import PICTURE as PICTURE
from .pictures import PICTURES as PICTURES
from .pictures import QUANTITIES as QUANTITIES
from .scale import Design as Design
from .scale import design as design
from .sources import BEAM as BEAM
from .sources import beam as beam
from .sources import lengths as lengths
from .sources import widths as widths
from .tables import Parameter as Parameter
from .tables import known
from .tables import named as named
from .tables import read as read
from .tables import units_of as units_of
from .values import FREQUENCIES, LENGTHS, Axis, axis
from .values import as_it_is as as_it_is
from .values import count as count
from .values import frequency as frequency
from .values import is_several as is_several
from .values import length as length
from .values import number as number
from .values import real as real
from .values import size as size
from .values import spaced as spaced
from .values import switch as switch
from .values import text as text
from .words import described as described

#: What a question may be asked along, and the units that its numbers may have.
AXES: dict[str, Mapping[str, int]] = {
    "frequency": FREQUENCIES,
    "angle": {},
    "x": LENGTHS,
    "y": LENGTHS,
    "z": LENGTHS,
    "kx": {},
    "kx_over_k0": {},
}


def axes(table: Mapping[str, Any]) -> dict[str, Axis]:
    """Those of `AXES` that a table gives: each as a number or a list of finite numbers.

    Examples
    --------
    >>> axes({"frequency": "1MHz", "x": "-5mm:5mm:3"})
    {'frequency': 1000000.0, 'x': [-0.005, 0.0, 0.005]}
    """
    from .. import validate

    known(table, tuple(AXES), "axes")
    return {name: validate.axis(axis(value, name, AXES[name]), name).tolist() for name, value in table.items()}
