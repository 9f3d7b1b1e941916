"""The questions a user asks: objects in, labelled datasets out.

checks.py: what is said of a wrong argument. waves.py: plane waves, Bloch waves, guided modes. beams.py: fields and widths.
measures.py: a beam as a whole.
"""

from .beams import AccuracyWarning, beam_width, field, fwhm
from .measures import beam_measures
from .waves import bloch, guided_modes, scattering

__all__ = ["AccuracyWarning", "beam_measures", "beam_width", "bloch", "field", "fwhm", "guided_modes", "scattering"]
