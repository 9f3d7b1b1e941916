"""From a table to a beam."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from .tables import Parameter, apart, named, read
from .values import as_it_is, count, length

if TYPE_CHECKING:
    from ..sources.gaussian import GaussianBeam
    from ..sources.profile import Profile
    from ..sources.slits import Slits


def _slits(value: Any, name: str) -> tuple[float, float, int]:
    """Width and separation [m], and a count, as text with commas between or as a list."""
    from .. import validate

    parts = value.split(",") if isinstance(value, str) else value
    if not isinstance(parts, list | tuple) or len(parts) not in (2, 3):
        raise validate.refuse(name, "width,separation or width,separation,count such as 10mm,40mm,2", value)
    return length(parts[0], name), length(parts[1], name), count(parts[2], name) if len(parts) == 3 else 2


BEAM: dict[str, Parameter] = {
    "fwhm": Parameter(
        0.096,
        length,
        "Full width at half maximum at the launch plane [m].",
        shown="0.7 wavelengths, 0.096 in the paper",
        scaled=True,
    ),
    "x0": Parameter(0.0, length, "Middle of the beam [m]."),
    "z0": Parameter(0.0, length, "Launch plane, at or in front of the near face at 0 [m]."),
    "width_of": Parameter("pressure", as_it_is, "What fwhm is the width of.", words=("pressure", "intensity")),
    "form": Parameter("launch", as_it_is, "Kind of oblique beam.", words=("launch", "rotated")),
    "slits": Parameter(
        None, _slits, "Slits driven in phase instead: width,separation or width,separation,count, such as 10mm,40mm,2."
    ),
    "profile": Parameter(None, as_it_is, "A measured profile instead: a text file of columns x [m], Re p, Im p [Pa]."),
}
_GAUSSIAN = ("fwhm", "x0", "width_of", "form")


def beam(table: Mapping[str, Any], scale: float = 1.0) -> GaussianBeam | Slits | Profile:
    """The source, along the normal, from a table with the names of `BEAM`; its angle is an axis of the question.

    Parameters
    ----------
    table : mapping of str to plain values
    scale : float
        The wavelength over that of the paper, which a width that is not given goes with: see `scale.Design`.

    Examples
    --------
    >>> beam({"fwhm": "5mm"}).fwhm
    0.005
    >>> beam({"slits": "10mm,40mm"}).positions
    array([-0.02,  0.02])
    """
    values = read(table, BEAM, "beam", scale)
    for source in ("slits", "profile"):
        if values[source] is not None:
            apart(table, _GAUSSIAN, source)
    if values["slits"] is not None:
        return _of_slits(table, values)
    if values["profile"] is not None:
        return _of_file(values)
    from ..sources.gaussian import GaussianBeam

    return GaussianBeam(**{name: values[name] for name in (*_GAUSSIAN, "z0")})


def _of_slits(table: Mapping[str, Any], values: Mapping[str, Any]) -> Slits:
    from ..sources.slits import Slits

    apart(table, ("profile",), "slits")
    with named("slits", "width", "separation", "count"):
        width, separation, many = values["slits"]
        return Slits(width, separation, many, values["z0"])


def _of_file(values: Mapping[str, Any]) -> Profile:
    from ..sources.profile import Profile

    with named("profile", "x", "p", "path"):
        try:
            return Profile.from_file(values["profile"], values["z0"])
        except OSError as error:
            got = f"{str(values['profile'])!r} ({error.strerror})"
            raise ValueError(f"profile: expected a text file that can be read, got {got}") from None
