"""A source at many angles, one in each row of a table of plane waves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .base import Beam, Tilted, sin_degrees


@dataclass(frozen=True, eq=False)
class AngleRows:
    """What measures of many rows need of a source that is tilted to an angle of its own in each of R rows.

    Tilting shifts a spectrum by k0 sin(angle). k0 is an array (R,), or (R, 1) beside kx (R, n).
    """

    source: Tilted  #: at normal incidence, about x = 0
    angles: np.ndarray  #: (R,) degree

    def __getattr__(self, name: str) -> Any:
        """What no angle changes: reach, centre, z0, entire, and the definition of the width."""
        return getattr(self.source, name)

    def spectrum(self, kx: np.ndarray, k0: np.ndarray) -> np.ndarray:
        """S(kx) of each row, (R, n)."""
        return self.source.spectrum(kx - k0 * sin_degrees(self.angles)[:, None], k0)  # type: ignore[arg-type]

    def band(self, k0: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
        """The interval of real kx outside which |S| is below tolerance times its largest value, (R,) each."""
        lo, hi = self.source.band(k0, tolerance)  # type: ignore[attr-defined]
        tilt = k0 * sin_degrees(self.angles)
        return lo + tilt, hi + tilt


#: A source for all rows, or one that is tilted row by row.
RowBeam = Beam | AngleRows


def rows_of(beams: list[Beam]) -> RowBeam:
    """Sources that differ in their angle alone, as a source for all rows or tilted row by row."""
    angles = np.array([beam.angle for beam in beams])
    if np.all(angles == angles[0]) or not isinstance(beams[0], Tilted):
        return beams[0]
    return AngleRows(beams[0].at_angle(0.0), angles)


def taken(beam: RowBeam, rows: np.ndarray) -> RowBeam:
    """The source in rows of these indices."""
    return AngleRows(beam.source, beam.angles[rows]) if isinstance(beam, AngleRows) else beam


def at_row(beam: RowBeam, i: int) -> Beam:
    """The plain source of row i."""
    return beam.source.at_angle(float(beam.angles[i])) if isinstance(beam, AngleRows) else beam  # type: ignore[return-value]


def repeated(beam: RowBeam, times: int) -> RowBeam:
    """The source of a table that repeats another one several times, one below the other."""
    return AngleRows(beam.source, np.tile(beam.angles, times)) if isinstance(beam, AngleRows) else beam
