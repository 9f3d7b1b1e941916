"""The question of a field map, checked once: for a dataset in memory, or for a file that is written block by block."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from .. import validate
from ..api import checks
from ..contour import choose as contour_choice
from ..contour import paths
from ..io import datasets
from ..media.sampled import Scene, scene
from ..media.structures import Slab
from ..response import transfer_function
from ..sources.angles import Fan, fan
from ..sources.beams import Beam, moved_to_origin
from . import evaluate


class FieldMap:
    """p on (frequency, angle, z, x), to be made in parts: first `choose` a frequency, then `fill` planes of it."""

    def __init__(
        self,
        slab: Slab,
        beam: Beam,
        frequency: Any,
        x: Any,
        z: Any,
        angle: Any,
        boundary: str,
        period: float | None,
        rtol: float,
    ) -> None:
        validate.instance(slab, Slab, "slab")
        validate.instance(beam, Beam, "beam")
        f, xs, zs = validate.axis(frequency, "frequency", positive=True), validate.axis(x, "x"), validate.axis(z, "z")
        angles, self.rtol = checks.angles(angle, beam), validate.rtol(rtol)
        validate.word(boundary, "boundary", "open", "periodic")
        if np.min(zs) < beam.z0:
            raise ValueError(f"z: expected positions not in front of the launch plane z0 = {beam.z0}, got {np.min(zs)}")
        self.slab, self.beam, self.boundary, self.period = slab, beam, boundary, period
        self.axes = {"frequency": f, "angle": angles, "z": zs, "x": xs}
        self.frequency, self.angles, self.z, positions = (np.atleast_1d(v) for v in self.axes.values())
        self._source, origin = moved_to_origin(beam)
        self.x = positions - origin  # from the source's middle, as all that is computed
        if boundary == "periodic":
            self.period = _period(period, self.x, self._source, slab, self.frequency)
        elif period is not None:
            raise ValueError(f"period: expected none with boundary='open', got {period!r}")
        self.dims, self.pick = checks.dims(**self.axes)
        self.shape = tuple(v.size for v in (self.frequency, self.angles, self.z, self.x))
        self.errors = np.full(self.shape[:2], np.nan)
        self._chosen = -1
        self._scene: Scene
        self._fan: Fan
        self._solution: contour_choice.Solution

    def choose(self, i: int) -> None:
        """The line of integration, and the error, for frequency i."""
        s = scene(self.slab, float(self.frequency[i]), backward=True)
        beams = fan(self._source, self.angles, s.k0, self.rtol * 1e-4)
        if self.period is None:
            transfer = transfer_function.through(s, self.beam.z0)
            solution = contour_choice.choose_line(s, beams, transfer, self.x, self.z, self.rtol)
            self.errors[i] = solution.error
        else:
            solution = contour_choice.periodic_solution(s, beams, self.x, self.period)
        self._chosen, self._scene, self._fan, self._solution = i, s, beams, solution

    def fill(self, planes: slice, angles: slice, out: np.ndarray) -> None:
        """p of the chosen frequency into out (A, Z, X), whose (Z, X) is contiguous, at some planes and angles."""
        s = self._scene
        transfer, part, z = transfer_function.through(s, self.beam.z0), self._fan.taken(angles), self.z[planes]
        more = evaluate.fill_map(s, part, self._solution, transfer, z, self.x, out, self.rtol)
        if self.period is None:
            self.errors[self._chosen, angles] = np.maximum(
                self.errors[self._chosen, angles], self._solution.error[angles] + more
            )

    def announce(self) -> None:
        """Nothing above rtol leaves without a word."""
        checks.announce(float(np.max(self.errors, initial=0.0, where=np.isfinite(self.errors))), self.rtol, 4)

    def dataset(self, p: np.ndarray | None) -> xr.Dataset:
        """The labelled answer; without p, all else."""
        variables: dict[str, Any] = {} if p is None else {"p": (self.dims, p[self.pick])}
        if self.boundary == "open":
            few = tuple(d for d in self.dims if d in ("frequency", "angle"))
            variables["error_estimate"] = (few, self.errors[self.pick[:2]])
        ds = datasets.make(
            variables,
            checks.coords(**self.axes),
            "field",
            self.frequency,
            slab=self.slab,
            beam=self.beam,
            boundary=self.boundary,
            period=self.period,
            rtol=self.rtol,
        )
        ds.attrs |= {"boundary": self.boundary, "slab_thickness": self.slab.thickness}
        if self.period is not None:
            ds.attrs["period"] = self.period
        return ds


def _period(period: Any, x: np.ndarray, beam: Beam, slab: Slab, frequency: np.ndarray) -> float:
    """The period of a periodic boundary; refused where neighbouring beams overlap."""
    if period is None:
        dx = paths.grid_of(x).step
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
