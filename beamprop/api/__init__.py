"""The questions a user asks: objects in, labelled datasets out.

checks.py: what is said of a wrong argument. waves.py: plane waves, Bloch waves, guided modes. maps.py: the question of a
field map, in parts. beams.py: fields and widths.
measures.py: a beam as a whole.
"""

from ..fields.question import FieldMap
from .beam_measures import beam_measures
from .beams import beam_width, field, fwhm
from .checks import AccuracyWarning, Progress
from .plane_waves import bloch, guided_modes, scattering

__all__ = [
    "AccuracyWarning",
    "FieldMap",
    "Progress",
    "beam_measures",
    "beam_width",
    "bloch",
    "field",
    "fwhm",
    "guided_modes",
    "scattering",
]
