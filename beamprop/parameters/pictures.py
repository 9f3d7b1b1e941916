"""What may be said of a picture: options of the command, and keys of a study's table of output."""

from __future__ import annotations

from typing import Any

from .tables import Parameter
from .values import real, switch, text

#: Endings of pictures.
PICTURES = (".png", ".svg", ".pdf")
#: What pictures of a question may show, the default first.
QUANTITIES: dict[str, tuple[str, ...]] = {
    "field": ("abs", "real", "phase", "dB", "intensity"),
    "scattering": ("transmissivity", "reflectivity", "energy_transmission", "absorption"),
    "beam_measures": (
        *("fwhm", "width_1e2", "width_second_moment", "centroid", "lateral_shift"),
        *("peak", "power", "divergence", "far_angle"),
    ),
}
#: As those of `plot.style`, which loads matplotlib [mm].
NARROWEST, WIDEST = 40.0, 2000.0


def _width(value: Any, name: str) -> float:
    from .. import validate

    width = validate.as_number(real(value, name, expected="a width in mm such as 88"), name, positive=True)
    if width < NARROWEST:
        raise validate.refuse(name, f"at least {NARROWEST:g} mm", width)
    if width > WIDEST:
        raise validate.refuse(name, f"at most {WIDEST:g} mm", width)
    return width


PICTURE: dict[str, Parameter] = {
    "quantity": Parameter(None, text, "What the picture shows."),
    "log": Parameter(False, switch, "On a logarithmic scale."),
    "along": Parameter(
        None, text, "The horizontal axis of the picture, of several.", shown="one of more than eight values"
    ),
    "plot_width": Parameter(None, _width, "Of the picture [mm]: 88 is one column of a journal, 180 two."),
}
