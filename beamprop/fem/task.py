"""A question to the finite elements, checked, with the mesh that it leads to and what solving it takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import memory, validate
from ..media.solids import Solid
from ..media.structures import Slab
from ..sources.base import Beam
from ..validate import as_count, as_number
from . import boundary, solvers, strip

#: An order this share of the mesh's highest or lower is resolved as well as the errors of
#: `SIZE_OVER_WAVELENGTH` ask.
RESOLVED_SHARE = 1 / 4
#: Finest default elements over those for the wavelength in front, whatever the beam's band: twice as many unknowns take eight times as long.
FINEST = 2


@dataclass(frozen=True)
class Plan:
    """What a solve takes: unknowns, elements along x and z, memory [bytes] and time [s], both rough predictions."""

    dofs: int
    elements_x: int
    elements_z: int
    memory: int
    seconds: float


@dataclass(frozen=True)
class Task:
    """Checked arguments, with the mesh that they lead to."""

    slab: Slab
    beam: Beam
    frequency: float
    period: float
    order: int
    elements_x: int
    method: str
    segments: list[strip.Segment]
    rows: strip.Layout

    @property
    def omega(self) -> float:
        return 2 * math.pi * self.frequency


# --- checks and the mesh ----------------------------------------------------------------------------------


def _check(slab: Any, beam: Any, frequency: Any, period: Any, order: Any, method: Any) -> tuple[float, float, int]:
    validate.instance(slab, Slab, "slab")
    if slab.thickness == 0:
        raise ValueError("slab: expected a layer to divide into elements, got a slab of thickness 0")
    if isinstance(slab.after, Solid):
        raise ValueError(f"slab: finite elements take a fluid behind, got {slab.after!r}")
    validate.instance(beam, Beam, "beam")
    validate.word(method, "method", *solvers.SOLVERS)
    order = as_count(order, "order")
    if order not in strip.SIZE_OVER_WAVELENGTH:
        raise ValueError(f"order: expected 1, 2, 3 or 4, got {order}")
    return as_number(frequency, "frequency", positive=True), as_number(period, "period", positive=True), order


def wavenumber(slab: Slab, frequency: float) -> float:
    """|k| in front of the slab."""
    k = abs(complex(slab.before.wavenumber(frequency)))
    if not (math.isfinite(k) and k > 0):
        raise ValueError(f"slab: expected a medium in front with a finite wavenumber, got {slab.before!r}")
    return k


def _mesh_orders(slab: Slab, beam: Beam, frequency: float, period: float, order: int) -> tuple[int, int]:
    """Default number of elements along x, and the highest order of the beam that counts at the near face.

    The elements are `SIZE_OVER_WAVELENGTH` of the wavelength in front, or finer by up to `FINEST` so that
    orders with more than 1e-4 of the strongest on the near face stay within `RESOLVED_SHARE` of the mesh's
    highest.
    """
    across = period * wavenumber(slab, frequency) / (2 * math.pi * strip.SIZE_OVER_WAVELENGTH[order])
    memory.check("period", 400.0 * order * across, f"{across:.3g} elements along x", "take a shorter period")
    usual = max(4, math.ceil(across))
    orders = boundary.orders(slab, beam, frequency, period, math.ceil(RESOLVED_SHARE * FINEST * usual * order / 2))
    strength = np.abs(orders.incident)
    middle = strength.size // 2
    highest = int(np.max(np.abs(np.flatnonzero(strength > 1e-4 * strength.max()) - middle), initial=0))
    return min(max(usual, math.ceil(2 * highest / (order * RESOLVED_SHARE))), FINEST * usual), highest


def make_task(
    slab: Any, beam: Any, frequency: Any, period: Any, order: Any, elements_x: Any, method: Any, layer_rows: Any
) -> Task:
    """Check the arguments and choose the mesh."""
    frequency, period, order = _check(slab, beam, frequency, period, order, method)
    usual, highest = _mesh_orders(slab, beam, frequency, period, order)
    elements_x = usual if elements_x is None else as_count(elements_x, "elements_x")
    kx = max(2 * math.pi / period * highest, wavenumber(slab, frequency))
    segments = strip.slab_rows(slab, frequency, kx, order, as_count(layer_rows, "layer_rows"))
    lines = float(sum(count * periods for rows, periods in segments for _, count in rows))
    memory.check("slab", 100.0 * lines, f"{lines:.3g} rows of elements", "take a thinner slab or fewer layer_rows")
    return Task(slab, beam, frequency, period, order, elements_x, method, segments, strip.layout(segments, order))


def predict(task: Task) -> Plan:
    """What a task takes, from its size alone."""
    n, rows = task.order * task.elements_x, task.rows
    memory, seconds = solvers.COSTS[task.method](task.segments, rows, n, task.order)
    elements_z = int(np.count_nonzero(np.array([row.thickness for row in rows.kinds])[rows.kind]))
    return Plan(rows.lines * n, task.elements_x, elements_z, int(memory), float(seconds))
