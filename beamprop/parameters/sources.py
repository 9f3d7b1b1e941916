"""From a table to a source."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .tables import Parameter, apart, named, read
from .values import LENGTHS, as_it_is, count, length, number, real, switch

if TYPE_CHECKING:
    from ..sources.base import Beam


def _parts(value: Any) -> Any:
    return value.split(",") if isinstance(value, str) else value


def _slits(value: Any, name: str) -> tuple[float, float, int]:
    """Width and separation [m], and a count, as text with commas between or as a list."""
    from .. import validate

    parts = _parts(value)
    if not isinstance(parts, list | tuple) or len(parts) not in (2, 3):
        raise validate.refuse(name, "width,separation or width,separation,count such as 10mm,40mm,2", value)
    return length(parts[0], name), length(parts[1], name), count(parts[2], name) if len(parts) == 3 else 2


def widths(value: Any, name: str) -> float | tuple[float, float]:
    """A width [m], or those along x and y, as text with a comma between or as a list."""
    return _along_x_and_y(value, name, "width")


def lengths(value: Any, name: str) -> float | tuple[float, float]:
    """A length [m], or those along x and y, as text with a comma between or as a list."""
    return _along_x_and_y(value, name, "length")


def _along_x_and_y(value: Any, name: str, what: str) -> float | tuple[float, float]:
    from .. import validate

    parts = _parts(value)
    if not isinstance(parts, list | tuple) or len(parts) == 1:
        return length(value, name)
    if len(parts) != 2:
        raise validate.refuse(name, f"a {what}, or two {what}s along x and y such as 30mm,15mm", value)
    return length(parts[0], name), length(parts[1], name)


def _bowl(value: Any, name: str) -> tuple[float, float]:
    """Radius of curvature and aperture [m], as text with a comma between or as a list."""
    from .. import validate

    parts = _parts(value)
    if not isinstance(parts, list | tuple) or len(parts) != 2:
        raise validate.refuse(name, "radius_of_curvature,aperture such as 64mm,64mm", value)
    return length(parts[0], name), length(parts[1], name)


BEAM: dict[str, Parameter] = {
    "fwhm": Parameter(
        0.096,
        widths,
        "Full width at half maximum at the launch plane [m]; two, along x and y, of an elliptical beam: 30mm,15mm.",
        shown="0.7 wavelengths, 0.096 in the paper",
        scaled=True,
        units=LENGTHS,
    ),
    "x0": Parameter(0.0, length, "Middle of the beam [m]."),
    "y0": Parameter(0.0, length, "Middle of the beam along y, in three dimensions [m]."),
    "z0": Parameter(0.0, length, "Launch plane, at or in front of the near face at 0 [m]."),
    "azimuth": Parameter(0.0, real, "Direction of the tilt, from x towards y, in three dimensions [degree]."),
    "width_of": Parameter("pressure", as_it_is, "What fwhm is the width of.", words=("pressure", "intensity")),
    "form": Parameter("launch", as_it_is, "Kind of oblique beam.", words=("launch", "rotated")),
    "slits": Parameter(
        None, _slits, "Slits driven in phase instead: width,separation or width,separation,count, such as 10mm,40mm,2."
    ),
    "profile": Parameter(None, as_it_is, "A measured profile instead: a text file of columns x [m], Re p, Im p [Pa]."),
    "piston": Parameter(None, length, "A circular piston of this radius instead, in three dimensions [m]."),
    "baffle": Parameter(None, as_it_is, "Around the piston.", words=("rigid", "soft"), shown="rigid"),
    "pressure": Parameter(None, number, "Amplitude of the piston or bowl, rho c times its velocity [Pa].", shown="1"),
    "bowl": Parameter(
        None, _bowl, "A focusing bowl instead, its apex at z0: radius_of_curvature,aperture, such as 64mm,64mm."
    ),
    "source_plane": Parameter(
        None, as_it_is, "A measured plane (hologram) instead: a .mat, .npz or .nc file with x, y [m] and p (y, x) [Pa]."
    ),
    "conjugate": Parameter(
        False, switch, "The file of the profile or measured plane is of the convention exp(+i w t)."
    ),
    "array": Parameter(
        None,
        as_it_is,
        "Pistons, bowls or beams at the positions of this text file of columns x, y [m], and Re, Im of their weights.",
    ),
}
#: What each source but the Gaussian beam is described by beside z0, in the order in which it is looked for.
_BESIDE = {
    "slits": (),
    "profile": ("conjugate",),
    "piston": ("baffle", "pressure", "x0", "y0", "array"),
    "bowl": ("pressure", "x0", "y0", "array"),
    "source_plane": ("azimuth", "conjugate"),
}
#: Parameters of the Gaussian beam.
_GAUSSIAN = ("fwhm", "x0", "y0", "azimuth", "width_of", "form")


def beam(table: Mapping[str, Any], scale: float = 1.0) -> Beam:
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
    >>> beam({"piston": "1cm", "baffle": "soft", "z0": "-3cm"})
    Piston(radius=0.01, baffle='soft', pressure=(1+0j), x0=0.0, y0=0.0, z0=-0.03)
    """
    values = read(table, BEAM, "beam", scale)
    kind = next((name for name in _BESIDE if values[name] is not None), None)
    known = _GAUSSIAN if kind is None else _BESIDE[kind]
    names = [name for name in BEAM if name not in (*known, kind, "z0")]
    if kind is None:
        for name, where in (
            ("baffle", "piston"),
            ("pressure", "piston or bowl"),
            ("conjugate", "profile or source_plane"),
        ):
            if values[name] not in (None, False):
                raise ValueError(f"{name}: expected to be left out without {where}, got {values[name]!r}")
    else:
        apart(table, tuple(names), kind)
    if values["array"] is None:
        return _source(kind, values)
    apart(table, ("x0", "y0", *(() if kind else ("azimuth",))), "array")
    return _array(_source(kind, values), values["array"])


def _source(kind: str | None, values: Mapping[str, Any]) -> Any:
    """A single source of a kind."""
    place = {name: values[name] for name in ("x0", "y0", "z0")}
    driven = place | ({} if values["pressure"] is None else {"pressure": values["pressure"]})
    if kind == "slits":
        return _of_slits(values)
    if kind == "piston":
        from ..sources.piston import Piston

        with named("piston", "radius"):
            return Piston(values["piston"], values["baffle"] or "rigid", **driven)
    if kind == "bowl":
        from ..sources.bowl import Bowl

        with named("bowl", "radius_of_curvature", "aperture"):
            return Bowl(*values["bowl"], **driven)
    if kind is not None:
        return _of_file(kind, values)
    from ..sources.gaussian import GaussianBeam

    return GaussianBeam(**{name: values[name] for name in (*_GAUSSIAN, "z0")})


def _of_slits(values: Mapping[str, Any]) -> Any:
    from ..sources.slits import Slits

    with named("slits", "width", "separation", "count"):
        width, separation, many = values["slits"]
        return Slits(width, separation, many, values["z0"])


@contextmanager
def _from_file(key: str, what: str, path: Any) -> Iterator[None]:
    """Errors of a file under the key that names it."""
    with named(key, "x", "y", "p", "path", "positions", "weights", "element"):
        try:
            yield
        except OSError as error:
            raise ValueError(f"{key}: expected {what} that can be read, got {str(path)!r} ({error.strerror})") from None


def _of_file(kind: str, values: Mapping[str, Any]) -> Any:
    from ..sources.profile import Profile
    from ..sources.source_plane import SourcePlane

    path = values[kind]
    if kind == "profile":
        with _from_file(kind, "a text file", path):
            return Profile.from_file(path, values["z0"], conjugate=values["conjugate"])
    with _from_file(kind, "a .mat, .npz or .nc file", path):
        return SourcePlane.from_file(path, values["z0"], values["conjugate"], azimuth=values["azimuth"])


def _array(element: Any, path: Any) -> Any:
    """Elements at the positions of a text file."""
    from .. import validate
    from ..sources.array import Array
    from ..sources.columns import read_columns

    with _from_file("array", "a text file", path):
        table = read_columns(validate.as_path(path), 2, 4, "x, y, Re weight, Im weight")
        weights = table[:, 2] if table.shape[1] > 2 else None
        if weights is not None and table.shape[1] == 4:
            weights = weights + 1j * table[:, 3]
        return Array(table[:, :2], element, weights)
