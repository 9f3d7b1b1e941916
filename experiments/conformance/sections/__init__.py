"""The sections of the page, in its order. A new one is a file with a `SECTION`, and its name here."""

from __future__ import annotations

from . import (
    beams,
    faces,
    finite_elements,
    layered,
    media,
    paper,
    periodic,
    plates,
    programs,
    quadrature,
    solids,
    transducers,
    waveguides,
)

SECTIONS = (
    faces.SECTION,
    layered.SECTION,
    periodic.SECTION,
    waveguides.SECTION,
    solids.SECTION,
    plates.SECTION,
    beams.SECTION,
    media.SECTION,
    paper.SECTION,
    quadrature.SECTION,
    transducers.SECTION,
    finite_elements.SECTION,
    programs.SECTION,
)
