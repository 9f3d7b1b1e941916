"""beamprop: acoustic beams through exactly solved layered slabs, in open space.

>>> import numpy as np, beamprop as bp
>>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
>>> widths = bp.beam_width(slab, bp.GaussianBeam(0.096), np.linspace(2000, 3000, 101))

Examples in the docstrings of public names begin after ``import numpy as np, beamprop as bp``.

Names are loaded when they are first used, so that ``import beamprop`` and ``beamprop --help`` are instant.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from ._version import __version__

if TYPE_CHECKING:
    from . import fem, plot
    from .api.beam_measures import beam_measures
    from .api.beam_width import beam_width
    from .api.bloch import bloch
    from .api.checks import AccuracyWarning
    from .api.field import field
    from .api.fwhm import fwhm
    from .api.guided_modes import guided_modes
    from .api.rayleigh_angle import rayleigh_angle
    from .api.save_field import save_field
    from .api.scattering import scattering
    from .comparison.fields import compare
    from .io.comsol import read_comsol, to_grid
    from .io.datasets import provenance
    from .io.exports import export
    from .io.storage import load, save
    from .media.attenuation import power_law
    from .media.effective import lmmd_emt, lmmd_emt_slab, standard_emt, wood_mixture
    from .media.fluids import AIR, Fluid
    from .media.hints import HintWarning
    from .media.lmmd import lmmd_cell
    from .media.materials import material, materials
    from .media.membranes import Membrane
    from .media.planes import faces
    from .media.porous import Gas, delany_bazley_miki, johnson_champoux_allard, narrow_slits, narrow_tubes
    from .media.properties import Tabulated
    from .media.solids import Solid
    from .media.structures import Cell, Layer, Slab
    from .media.tolerance import tolerance
    from .sources.array import Array
    from .sources.bowl import Bowl
    from .sources.gaussian import GaussianBeam
    from .sources.piston import Piston
    from .sources.profile import Profile
    from .sources.slits import Slits
    from .sources.source_plane import SourcePlane
    from .sources.source_sum import SourceSum
    from .study.sweep import sweep

_HOMES = {
    "media.attenuation": ("power_law",),
    "media.fluids": ("AIR", "Fluid"),
    "media.hints": ("HintWarning",),
    "media.materials": ("material", "materials"),
    "media.porous": (
        "Gas",
        "delany_bazley_miki",
        "johnson_champoux_allard",
        "narrow_slits",
        "narrow_tubes",
    ),
    "media.planes": ("faces",),
    "media.properties": ("Tabulated",),
    "media.membranes": ("Membrane",),
    "media.solids": ("Solid",),
    "media.structures": ("Cell", "Layer", "Slab"),
    "media.tolerance": ("tolerance",),
    "media.lmmd": ("lmmd_cell",),
    "media.effective": ("lmmd_emt", "lmmd_emt_slab", "standard_emt", "wood_mixture"),
    "sources.array": ("Array",),
    "sources.bowl": ("Bowl",),
    "sources.gaussian": ("GaussianBeam",),
    "sources.piston": ("Piston",),
    "sources.profile": ("Profile",),
    "sources.slits": ("Slits",),
    "sources.source_plane": ("SourcePlane",),
    "sources.source_sum": ("SourceSum",),
    "api.beam_measures": ("beam_measures",),
    "api.beam_width": ("beam_width",),
    "api.bloch": ("bloch",),
    "api.checks": ("AccuracyWarning",),
    "api.field": ("field",),
    "api.fwhm": ("fwhm",),
    "api.guided_modes": ("guided_modes",),
    "api.rayleigh_angle": ("rayleigh_angle",),
    "api.scattering": ("scattering",),
    "api.save_field": ("save_field",),
    "comparison.fields": ("compare",),
    "io.comsol": ("read_comsol", "to_grid"),
    "io.datasets": ("provenance",),
    "io.exports": ("export",),
    "io.storage": ("load", "save"),
    "study.sweep": ("sweep",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}
_MODULES = ("fem", "plot")

__all__ = [
    "AIR",
    "AccuracyWarning",
    "Array",
    "Bowl",
    "Cell",
    "Fluid",
    "Gas",
    "GaussianBeam",
    "HintWarning",
    "Layer",
    "Membrane",
    "Piston",
    "Profile",
    "Slab",
    "Slits",
    "Solid",
    "SourcePlane",
    "SourceSum",
    "Tabulated",
    "__version__",
    "beam_measures",
    "beam_width",
    "bloch",
    "compare",
    "delany_bazley_miki",
    "export",
    "faces",
    "fem",
    "field",
    "fwhm",
    "guided_modes",
    "johnson_champoux_allard",
    "lmmd_cell",
    "lmmd_emt",
    "lmmd_emt_slab",
    "load",
    "material",
    "materials",
    "narrow_slits",
    "narrow_tubes",
    "plot",
    "power_law",
    "provenance",
    "rayleigh_angle",
    "read_comsol",
    "save",
    "save_field",
    "scattering",
    "standard_emt",
    "sweep",
    "to_grid",
    "tolerance",
    "wood_mixture",
]


def __getattr__(name: str) -> Any:
    if name in _HOME_OF:
        value = getattr(importlib.import_module(f"{__name__}.{_HOME_OF[name]}"), name)
    elif name in _MODULES:
        value = importlib.import_module(f"{__name__}.{name}")
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
