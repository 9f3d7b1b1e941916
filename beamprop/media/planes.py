"""Planes inside a slab of repeated cells: on the cells' faces, or where the mean over a cell is formed.

Inside a cell the pressure ripples, by q G(z) with G of `effective`: planes that lie at other places of one cell than of the next draw
stripes that are not there.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from .. import memory, validate
from .hints import hint
from .structures import Cell, Slab
from .values import along_normal

#: A cell of at least so many planes is drawn as it is; of fewer, the planes lie on its faces alone.
RESOLVED = 8
#: So many planes in a cell show that it ripples, those of a map whose steps are longer do not.
FEWEST = 4
#: A map: so many planes in a row of cells. Fewer are profiles, each of which says where it was taken.
MAP = 20
#: Of a map at least this share of steps is about as long as their median; of planes at random a third is.
EVEN = 0.75
#: Ripples of a smaller share of the pressure are not seen.
SEEN = 0.05
#: Planes that lie at the same place of each cell to this share of it show no stripes.
SAME_PLACE = 0.01


class Row(NamedTuple):
    """Cells in a row: one of them, their number, and where they begin [m]."""

    cell: Cell
    periods: int
    start: float

    @property
    def stop(self) -> float:
        """Where they end [m]."""
        return self.start + self.periods * self.cell.thickness

    @property
    def ripples(self) -> bool:
        """Whether there are several cells, of several layers."""
        return self.periods > 1 and len(set(self.cell.layers)) > 1

    def ripple(self, frequency: np.ndarray) -> float:
        """Ripple inside a cell over the pressure's mean, of a wave along z: w |G| over the impedance, at most over frequencies [Hz]."""
        masses, compliances, thickness = along_normal(self.cell, frequency)
        omega, share = 2 * np.pi * frequency, thickness / self.cell.thickness
        with np.errstate(all="ignore"):  # of extreme materials: what is not finite is seen
            mass = masses.sum(axis=0)
            G = np.cumsum(masses - mass * share[:, None], axis=0)
            G = G - (share[:, None] * G).sum(axis=0)
            modulus = self.cell.thickness / np.abs(compliances.sum(axis=0))
            density = (
                np.abs(mass) / self.cell.thickness + omega**2 * (share[:, None] * np.abs(G) ** 2).sum(axis=0) / modulus
            )
            ripple = omega * np.abs(G).max(axis=0) / np.sqrt(density * modulus)
        return float(np.max(np.nan_to_num(ripple, nan=np.inf)))


def rows_of(slab: Slab) -> Iterator[Row]:
    """The segments of a slab that have a thickness, from the near face on."""
    start = 0.0
    for cell, periods in slab.segments:
        row = Row(cell, periods, start)
        if cell.thickness > 0:
            yield row
        start = row.stop


def faces(slab: Slab, planes: int = 400, before: float = 0.0, after: float = 0.0) -> np.ndarray:
    """Depths for a map: on faces of cells inside a slab, evenly spaced in front of and behind it.

    Parameters
    ----------
    slab : Slab
    planes : int
        About so many. Inside of repeated cells steps are whole numbers of cells, or, where that gives 8 planes in a cell and more, whole
        fractions of one: all cells are seen at the same places, whose ripple draws no stripes then.
    before, after : float, m
        How far in front of and behind the slab.

    Returns
    -------
    (n,) array, m
        Rising, from -before to the thickness and `after`, with both faces of the slab.

    Raises
    ------
    ValueError
        Names the argument, what was expected and what came.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=450)
    >>> z = bp.faces(slab, planes=200, before=0.1, after=0.3)
    >>> z.size, bool(np.allclose(np.diff(z[z >= 0])[:3] / slab.cell.thickness, 3))
    (207, True)
    """
    validate.instance(slab, Slab, "slab")
    count = validate.as_count(planes, "planes", least=2)
    memory.check("planes", 32.0 * count, f"{count} planes", "take fewer")
    ways = []
    for name, value in (("before", before), ("after", after)):
        ways.append(validate.as_number(value, name))
        if ways[-1] < 0:
            raise validate.refuse(name, "a length of at least zero", value)
    thickness = slab.thickness
    step = (ways[0] + thickness + ways[1]) / (count - 1)
    inner = [_in_row(row, step) for row in rows_of(slab)]
    outer = [_even(a, b, step) for a, b in ((-ways[0], 0.0), (thickness, thickness + ways[1]))]
    # rounding may leave two planes where parts meet
    return np.unique(np.concatenate([outer[0], *(np.minimum(z, thickness) for z in inner), outer[1]]))


def even_on_faces(slab: Slab, z: np.ndarray) -> np.ndarray:
    """Even planes z, or, where they skip through the cells of a slab, about as many on faces of the cells: even ones where the slab is
    one row of cells, with its far face if a near number of cells a step divides the row."""
    step = float(z[-1] - z[0]) / (z.size - 1)
    rows = list(rows_of(slab))
    if not any(row.ripples and step > row.cell.thickness / FEWEST for row in rows):
        return z
    if len(rows) > 1:
        return faces(slab, z.size, max(-float(z[0]), 0.0), max(float(z[-1]) - slab.thickness, 0.0))
    cells = max(1, round(step / rows[0].cell.thickness))
    near = (n for n in range(1 + cells // 2, 2 * cells + 1) if rows[0].periods % n == 0)
    lattice = rows[0].cell.thickness * min(near, key=lambda n: abs(n - cells), default=cells)
    return lattice * np.arange(np.ceil(z[0] / lattice), np.floor(z[-1] / lattice) + 1)


def _even(start: float, stop: float, step: float) -> np.ndarray:
    """Even planes about a step apart, with both ends."""
    return np.linspace(start, stop, max(1, round((stop - start) / step)) + 1) if stop > start else np.array([start])


def _in_row(row: Row, step: float) -> np.ndarray:
    """Planes in a row of cells about a step apart, at the same places of each cell, without its end."""
    if not row.ripples or step <= row.cell.thickness / RESOLVED:
        each = max(1, round(row.cell.thickness / step))
        return row.start + row.cell.thickness / each * np.arange(row.periods * each)
    return row.start + row.cell.thickness * np.arange(0, row.periods, max(1, round(step / row.cell.thickness)))


# --- the mean over a cell ---------------------------------------------------------------------------------


class CellMeans(NamedTuple):
    """Means over a cell as sums: depths [m] and weights of all terms, and the first term of each plane."""

    z: np.ndarray
    weight: np.ndarray
    first: np.ndarray


def cell_means(slab: Slab, z: np.ndarray, nodes: int) -> CellMeans:
    """The mean over one cell about each plane z [m] that lies in a row of rippling cells; other planes as they are.

    The interval is one cell long, the plane is its middle, and near the ends of the row it is moved into the row. Gauss-Legendre's rule of
    so many `nodes` in each layer, inside which the pressure is an entire function of z.
    """
    rows = [row for row in rows_of(slab) if row.ripples]
    at, share = np.polynomial.legendre.leggauss(nodes)
    terms = [_mean_about(plane, rows, at, share) for plane in z.tolist()]
    sizes = [len(depths) for depths, _ in terms]
    depths, weights = (np.concatenate(columns) for columns in zip(*terms, strict=True))
    return CellMeans(depths, weights, np.concatenate([[0], np.cumsum(sizes)[:-1]]))


def _mean_about(plane: float, rows: list[Row], at: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depths and weights of one plane."""
    row = next((row for row in rows if row.start <= plane <= row.stop), None)
    if row is None:
        return np.array([plane]), np.ones(1)
    period = row.cell.thickness
    begin = min(max(plane - period / 2, row.start), row.stop - period)
    inside = np.concatenate([[0.0], np.cumsum([layer.thickness for layer in row.cell.layers])])
    first = np.floor((begin - row.start) / period)
    cuts = row.start + period * first + np.concatenate([inside, period + inside[1:]])
    cuts = np.unique(np.clip(cuts, begin, begin + period))
    half = np.diff(cuts) / 2
    depths = (cuts[:-1] + half)[:, None] + half[:, None] * at
    return depths.ravel(), (half[:, None] * share / period).ravel()


# --- stripes that are not there ---------------------------------------------------------------------------


def warn_of_stripes(slab: Slab, z: np.ndarray, frequency: np.ndarray) -> None:
    """A hint that a map's planes skip through the cells of a slab."""
    for row in rows_of(slab):
        inside = np.unique(z[(z >= row.start) & (z <= row.stop)])
        if not row.ripples or inside.size < MAP:
            continue
        steps, period = np.diff(inside), row.cell.thickness
        step = float(np.median(steps))
        turns = np.exp(2j * np.pi * (inside - row.start) / period)
        if np.mean(np.abs(steps - step) < step / 2) < EVEN:  # nodes of a mesh are no map
            continue
        if step <= period / FEWEST * (1 + 1e-6) or abs(turns.mean()) > 1 - (np.pi * SAME_PLACE) ** 2:
            continue
        ripple = row.ripple(frequency)
        if ripple > SEEN:
            hint(
                f"z: steps of {step:.3g} m skip through cells of {period:.3g} m, inside which the pressure ripples by about "
                f"{min(ripple, 1.0):.0%} of its mean: a map shows stripes that are not there; take z=bp.faces(slab, ...), "
                "or average='cell'"
            )
            return
