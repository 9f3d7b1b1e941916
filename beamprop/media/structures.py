"""What a user builds of fluids and membranes: layers, cells and slabs. Frozen records, checked when they are made."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from .. import validate
from ..validate import as_count, as_number
from .fluids import AIR, Fluid
from .membranes import Membrane
from .solids import Solid


@dataclass(frozen=True)
class Layer:
    """A homogeneous layer: a `Fluid` or a `Solid`, and its thickness [m].

    Examples
    --------
    >>> bp.Layer(bp.AIR, thickness=0.01)
    Layer(fluid=Fluid(density=1.25, bulk_modulus=147061), thickness=0.01)
    """

    fluid: Fluid | Solid
    thickness: float

    def __post_init__(self) -> None:
        if not isinstance(self.fluid, Fluid | Solid):
            raise validate.refuse("fluid", "a Fluid or a Solid", self.fluid)
        object.__setattr__(self, "thickness", as_number(self.thickness, "thickness", positive=True, tiny=True))


def is_solid(layer: Any) -> bool:
    """Whether a layer is a solid one."""
    return isinstance(layer, Layer) and isinstance(layer.fluid, Solid)


def _checked_layer(layer: Any) -> Layer | Membrane:
    if not isinstance(layer, Layer | Membrane):
        raise validate.refuse("layers", "Layer objects", layer)
    return layer


@dataclass(frozen=True)
class Cell:
    """One period: layers from the near side to the far side.

    Examples
    --------
    >>> cell = bp.Cell((bp.Layer(bp.AIR, 0.02), bp.Membrane(0.3)))
    >>> cell.thickness
    0.02
    """

    layers: tuple[Layer | Membrane, ...]

    def __post_init__(self) -> None:
        layers = (self.layers,) if isinstance(self.layers, Layer | Membrane) else self.layers
        if not isinstance(layers, Iterable):
            raise validate.refuse("layers", "a sequence of Layer", layers)
        layers = tuple(_checked_layer(layer) for layer in layers)
        if not layers:
            raise ValueError("layers: expected at least one Layer or Membrane, got none")
        object.__setattr__(self, "layers", layers)

    @property
    def thickness(self) -> float:
        """Thickness of the period [m]."""
        return math.fsum(layer.thickness for layer in self.layers)

    def __repr__(self) -> str:
        return f"Cell({len(self.layers)} layers, {self.thickness:.6g} m)"


#: The half-space of a slab that names none: air, and not the object `AIR`, so that an AIR that is given can be told from it.
UNSTATED = Fluid(AIR.density, AIR.bulk_modulus)


def _half_spaces(before: Fluid, after: Fluid | Solid, background: Fluid | None) -> tuple[Fluid, Fluid | Solid]:
    """The half-spaces: `background` where they are not given."""
    if background is None:
        return before, after
    validate.instance(background, Fluid, "background")
    return (background if before is UNSTATED else before), (background if after is UNSTATED else after)


def _refuse_membrane_between_solids(segments: list[tuple[Cell, int]], after: Fluid | Solid) -> None:
    layers: list[Any] = [layer for cell, periods in segments for layer in cell.layers * min(periods, 2)]
    kinds = ("membrane" if isinstance(layer, Membrane) else "solid" if is_solid(layer) else "fluid" for layer in layers)
    row = [kind for kind, _ in itertools.groupby([*kinds, "solid" if isinstance(after, Solid) else "fluid"])]
    if any(row[i : i + 3] == ["solid", "membrane", "solid"] for i in range(len(row))):
        raise ValueError("layers: expected a membrane beside a fluid, got one between two solids, which has no meaning")


@dataclass(frozen=True, init=False)
class Slab:
    """`periods` copies of a cell between two half-spaces; ``a + b`` stacks b behind a.

    Parameters
    ----------
    cell : Cell, Layer, Membrane, or a sequence of layers and membranes
        A membrane alone is a slab too, of thickness 0.
    periods : int
    before : Fluid
    after : Fluid or Solid
        The half-spaces in front and behind; air, unless `background` is given.
    background : Fluid, optional
        Both half-spaces at once; `before` or `after` beside it is that of its own side.

    Notes
    -----
    ``a + b`` keeps a's `before` and b's `after`; what stood between them is gone. A stacked slab has several
    `segments`, pairs (cell, periods) from the near face on.

    Examples
    --------
    >>> water = bp.Fluid.from_speed(1000.0, 1480.0)
    >>> layers = bp.Slab([bp.Layer(bp.AIR, 0.02), bp.Layer(water, 0.01)], periods=3)
    >>> stack = layers + bp.Slab.uniform(water, 0.05)
    >>> round(stack.thickness, 6)
    0.14
    >>> bp.Slab(bp.Layer(bp.AIR, 0.02), background=water, after=bp.AIR).before == water
    True
    """

    segments: tuple[tuple[Cell, int], ...]
    before: Fluid
    after: Fluid | Solid

    def __init__(
        self,
        cell: Cell | Layer | Membrane | Iterable[Layer | Membrane],
        periods: int = 1,
        before: Fluid = UNSTATED,
        after: Fluid | Solid = UNSTATED,
        *,
        background: Fluid | None = None,
    ) -> None:
        if not isinstance(cell, Cell):
            if not isinstance(cell, Layer | Membrane | Iterable):
                raise validate.refuse("cell", "a Cell", cell)
            cell = Cell(cell)  # type: ignore[arg-type]
        self._fill(((cell, as_count(periods, "periods")),), *_half_spaces(before, after, background))

    def _fill(self, segments: tuple[tuple[Cell, int], ...], before: Fluid, after: Fluid | Solid) -> None:
        if isinstance(before, Solid):
            raise ValueError(
                f"before: expected a Fluid (waves come from a fluid; a solid may lie behind), got {before!r}"
            )
        for name, fluid in (("before", before), ("after", after)):
            if name == "after" and isinstance(fluid, Solid):
                continue
            validate.instance(fluid, Fluid, name)
            if not callable(fluid.density) and fluid.density == 0:
                raise ValueError(f"{name}: expected a half-space of a density other than zero, got {fluid!r}")
        merged: list[tuple[Cell, int]] = []
        for cell, periods in segments:  # a + a becomes a with twice the periods
            if merged and merged[-1][0] == cell:
                merged[-1] = (cell, merged[-1][1] + periods)
            else:
                merged.append((cell, periods))
        _refuse_membrane_between_solids(merged, after)
        object.__setattr__(self, "segments", tuple(merged))
        object.__setattr__(self, "before", before)
        object.__setattr__(self, "after", after)

    @classmethod
    def stack(
        cls,
        segments: Iterable[tuple[Cell, int]],
        before: Fluid = UNSTATED,
        after: Fluid | Solid = UNSTATED,
        *,
        background: Fluid | None = None,
    ) -> Slab:
        """A slab of several (cell, periods) pairs, from the near face on.

        Examples
        --------
        >>> fine, coarse = bp.lmmd_cell(eta=1 / 60), bp.lmmd_cell(eta=1 / 30)
        >>> round(bp.Slab.stack([(fine, 20), (coarse, 10)]).thickness, 6)
        0.091467
        """
        try:
            given = [(cell, periods) for cell, periods in segments]
        except (TypeError, ValueError):
            raise validate.refuse("segments", "(Cell, periods) pairs", segments) from None
        pairs = tuple((validate.instance(cell, Cell, "segments"), as_count(n, "periods")) for cell, n in given)
        if not pairs:
            raise ValueError("segments: expected at least one (cell, periods) pair, got none")
        slab = object.__new__(cls)
        slab._fill(pairs, *_half_spaces(before, after, background))
        return slab

    @classmethod
    def uniform(
        cls,
        fluid: Fluid,
        thickness: float,
        before: Fluid = UNSTATED,
        after: Fluid | Solid = UNSTATED,
        *,
        background: Fluid | None = None,
    ) -> Slab:
        """A homogeneous slab of `fluid`, `thickness` metres thick.

        Examples
        --------
        >>> oil = bp.Slab.uniform(bp.material("castor oil"), 0.01, background=bp.material("water"))
        >>> oil.thickness
        0.01
        """
        return cls(Layer(fluid, thickness), 1, before, after, background=background)

    @classmethod
    def interface(cls, before: Fluid = UNSTATED, after: Fluid | Solid = UNSTATED) -> Slab:
        """The face between two half-spaces, without a layer: a slab of thickness 0.

        Examples
        --------
        >>> water = bp.Fluid.from_speed(998.0, 1482.0)
        >>> r = bp.scattering(bp.Slab.interface(bp.AIR, water), 1000.0, angle=0).r
        >>> round(float(r.real), 6)  # (Z2 - Z1)/(Z2 + Z1)
        0.99942
        """
        return cls(Membrane(0.0), 1, before, after)

    @classmethod
    def from_table(
        cls,
        table: Any,
        periods: int = 1,
        before: Fluid = UNSTATED,
        after: Fluid | Solid = UNSTATED,
        *,
        background: Fluid | None = None,
    ) -> Slab:
        """A slab from the rows of a CSV file or a pandas DataFrame, from the near face on.

        Parameters
        ----------
        table : path, or DataFrame
            A header and a row a layer. Columns: `thickness`, and `material` (a name that `material` knows), or `density` with
            `sound_speed` or `bulk_modulus`, and perhaps `shear_speed` (a solid) or `attenuation` (Np/m; with `reference_frequency` and `exponent` a
            power law); or `areal_density` alone, a membrane. SI units, or the one that the header names: ``thickness_mm``,
            ``density (g/cm3)``, ``attenuation [dB/cm]``. Empty cells are left out; so are lines of the file that begin with #.
        periods : int
            How often the rows repeat.
        before, after, background : Fluid
            As in `Slab`.

        Raises
        ------
        ValueError
            Names the column, and the row below the header, counted from 1.

        Examples
        --------
        >>> import pandas as pd
        >>> rows = pd.DataFrame({"thickness_mm": [2.0, 5.0], "material": ["steel", "water"]})
        >>> slab = bp.Slab.from_table(rows, periods=10, background=bp.material("water"))
        >>> round(slab.thickness, 9)
        0.07
        """
        from .tables import layers_from_table

        return cls(layers_from_table(table), periods, before, after, background=background)

    @property
    def cell(self) -> Cell:
        """The cell of a slab that is not stacked."""
        if len(self.segments) > 1:
            raise ValueError(f"cell: a stacked slab has {len(self.segments)} cells; use .segments")
        return self.segments[0][0]

    @property
    def periods(self) -> int:
        """The number of periods of a slab that is not stacked."""
        if len(self.segments) > 1:
            raise ValueError(f"periods: a stacked slab has {len(self.segments)} cells; use .segments")
        return self.segments[0][1]

    @property
    def thickness(self) -> float:
        """Distance from the near to the far face [m]."""
        return math.fsum(cell.thickness * periods for cell, periods in self.segments)

    def __add__(self, behind: Slab) -> Slab:
        if not isinstance(behind, Slab):
            return NotImplemented
        return Slab.stack(self.segments + behind.segments, self.before, behind.after)

    def __repr__(self) -> str:
        stack = " + ".join(f"{periods} x {cell!r}" for cell, periods in self.segments)
        return f"Slab({stack}, before={self.before!r}, after={self.after!r})"
