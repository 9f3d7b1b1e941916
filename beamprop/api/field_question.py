"""What `field` and `save_field` share: the question checked, and its answer labelled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from .. import validate
from ..contour import sums
from ..fields.question import FieldQuestion
from ..io import datasets
from ..io.labels import label
from ..media.planes import warn_of_stripes
from ..media.structures import Slab
from ..sources.base import Beam
from . import checks, hints
from .field_variables import checked_variables


class Labels(NamedTuple):
    """What an answer is labelled with: axes as they were given (scalars stay scalars), and the arguments."""

    axes: dict[str, np.ndarray]
    slab: Slab
    beam: Beam
    boundary: str
    period: float | tuple[float, float] | None
    rtol: float
    variables: tuple[str, ...]
    average: str | None = None
    azimuth: float | None = None  #: of a beam in three dimensions [degree]

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the axes that are arrays."""
        return checks.dims(**self.axes)[0]

    @property
    def pick(self) -> tuple[Any, ...]:
        """The index that drops scalar axes of (frequency, angle, z, x), or (frequency, angle, z, y, x)."""
        return checks.dims(**self.axes)[1]


def checked_question(
    slab: Slab,
    beam: Beam,
    frequency: Any,
    x: Any,
    z: Any,
    angle: Any,
    boundary: str,
    period: float | None,
    rtol: float,
    variables: Any = ("p",),
    average: str | None = None,
) -> tuple[FieldQuestion, Labels]:
    """The question of a field, or a ValueError that names the argument."""
    beams = checks.beams(slab, beam, frequency, angle, rtol)
    xs, zs = validate.axis(x, "x"), validate.axis(z, "z")
    validate.word(boundary, "boundary", "open", "periodic")
    zs = checks.from_launch_plane(zs, beam)
    hints.warn_of_width(slab, beam, beams.frequency, xs)
    frequencies, angles = beams.flat
    checks.warn_if_not_ended(beam, slab, frequencies, min(float(np.min(zs)), 0.0) - beam.z0, beams.rtol)
    if average is not None:
        validate.word(average, "average", "cell")
    else:
        warn_of_stripes(slab, np.atleast_1d(zs), frequencies)
    positions = np.atleast_1d(xs) - beams.origin
    if boundary == "periodic":
        period = _period(period, positions, beams.source, slab, frequencies)
    elif period is not None:
        raise ValueError(f"period: expected none with boundary='open', got {period!r}")
    question = FieldQuestion(slab, beams.source, frequencies, angles, np.atleast_1d(zs), positions, period, beams.rtol)
    axes = beams.axes | {"z": zs, "x": xs}
    names = checked_variables(variables, slab, np.atleast_1d(zs))
    return question, Labels(axes, slab, beam, boundary, period, beams.rtol, names, average)


def labelled(labels: Labels, errors: dict[str, np.ndarray], values: dict[str, np.ndarray]) -> xr.Dataset:
    """The dataset of variables, on the first of (frequency, angle, z, x) or (…, z, y, x), and of their errors, by name."""
    pick, names = labels.pick, list(labels.axes)
    axes = {n: tuple(d for d in labels.dims if d in names[:n]) for n in range(2, len(names) + 1)}
    variables: dict[str, Any] = {name: (axes[v.ndim], v[pick[: v.ndim]]) for name, v in values.items()}
    if labels.boundary == "open":
        for name, error in errors.items():
            variables["error_estimate" if name == "p" else f"error_estimate_{name}"] = (axes[2], error[pick[:2]])
    more: dict[str, Any] = {} if labels.variables == ("p",) else {"variables": labels.variables}
    if labels.average is not None:
        more["average"] = labels.average
    coords = checks.coords(**labels.axes)
    if labels.azimuth is not None:
        more["azimuth"] = labels.azimuth
        coords["azimuth"] = ((), labels.azimuth)
    ds = datasets.make(
        variables,
        coords,
        "field",
        np.atleast_1d(labels.axes["frequency"]),
        slab=labels.slab,
        beam=labels.beam,
        boundary=labels.boundary,
        period=labels.period,
        rtol=labels.rtol,
        **more,
    )
    geometry = "2-D" if labels.azimuth is None else "3-D"
    if geometry == "3-D" and "power_through" in ds:
        ds["power_through"].attrs = label("power_through", in_space=True)
    ds.attrs |= {"boundary": labels.boundary, "slab_thickness": labels.slab.thickness, "geometry": geometry}
    if labels.period is not None:
        ds.attrs["period"] = labels.period
    if labels.average is not None:
        ds.attrs["average"] = labels.average
    return ds


def _period(period: Any, x: np.ndarray, beam: Beam, slab: Slab, frequency: np.ndarray) -> float:
    """The period of a periodic boundary; refused where neighbouring beams overlap."""
    if period is None:
        dx = sums.grid_of(x).step
        if not dx:
            raise ValueError("period: expected a length [m] with boundary='periodic' and an uneven x, got None")
        period = dx * x.size
    value = validate.as_number(period, "period", positive=True)
    k0 = float(checks.k0(slab, frequency)[0])
    across = beam.profile(beam.centre + value / 2 * np.linspace(-1, 1, 2001), k0)
    largest = float(np.abs(across).max())
    if largest == 0:  # a gap of the beam is all that such a period holds
        raise ValueError(
            f"period: expected a grid wide enough for the beam, got {value:.6g} m, in which the launched |p| is zero"
        )
    seam = float(max(abs(across[0]), abs(across[-1])) / largest)
    if seam > 1e-2:
        raise ValueError(
            f"period: expected a grid wide enough for the beam, got {value:.6g} m, at whose ends the launched |p| is "
            f"still {seam:.2g} of its largest"
        )
    return value
