"""Random copies of a slab, as errors of manufacture make them: every layer of every period differs."""

from __future__ import annotations

import functools
import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .. import memory, validate
from .fluids import Fluid
from .membranes import Membrane
from .properties import Property
from .solids import Solid
from .structures import Cell, Layer, Slab

#: Standard deviations at which errors are cut off: 6e-5 of a Gaussian's lie beyond, and without them its standard deviation is 0.9995.
CUT = 4.0
#: Bytes of a layer with a fluid of its own while it is made: tests/test_tolerance.py measures them.
LAYER = 400.0


@dataclass(frozen=True)
class Tolerance:
    """Random copies of a slab, each made when it is asked for: what `tolerance` returns."""

    slab: Slab
    thickness: float
    density: float
    count: int
    seed: int

    def __post_init__(self) -> None:
        validate.instance(self.slab, Slab, "slab")
        for name in ("thickness", "density"):
            value = validate.as_number(getattr(self, name), name)
            if not 0 <= value < 1 / CUT:
                raise validate.refuse(name, f"a relative standard deviation from 0 to below {1 / CUT:g}", value)
            object.__setattr__(self, name, value)
        object.__setattr__(self, "count", validate.as_count(self.count, "count"))
        object.__setattr__(self, "seed", validate.as_count(self.seed, "seed", least=0))
        layers = sum(periods * len(cell.layers) for cell, periods in self.slab.segments)
        memory.check("slab", LAYER * layers, f"{layers:.3g} layers that all differ", "take fewer periods")

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, index: Any) -> Slab:
        i = operator.index(index)
        if not -self.count <= i < self.count:
            raise IndexError(f"index: expected one of {self.count} copies, got {i}")
        return Copy(self, i % self.count)


@dataclass(frozen=True, init=False, repr=False, eq=False)
class Copy(Slab):
    """A random copy of a slab, which is drawn again from a few numbers wherever it is sent or recorded."""

    tolerance: Tolerance
    index: int

    #: What pickles and files hold of it, instead of its layers.
    recorded = ("tolerance", "index")

    def __init__(self, tolerance: Tolerance, index: int) -> None:
        object.__setattr__(self, "tolerance", tolerance)
        object.__setattr__(self, "index", index)
        object.__setattr__(self, "before", tolerance.slab.before)
        object.__setattr__(self, "after", tolerance.slab.after)

    def __getattr__(self, name: str) -> Any:
        """The layers, drawn when they are first needed: a copy that is only sent or compared needs none."""
        if name != "segments":
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        layers = [layer for cell, n in self.tolerance.slab.segments for _ in range(n) for layer in cell.layers]
        factors = _factors(self.tolerance, self.index, len(layers)).tolist()
        object.__setattr__(self, name, ((Cell(tuple(map(_changed, layers, *factors))), 1),))
        return self.segments

    @property
    def _draw(self) -> tuple[Slab, float, float, int, int]:
        """What its layers depend on."""
        return self.tolerance.slab, self.tolerance.thickness, self.tolerance.density, self.tolerance.seed, self.index

    def __eq__(self, second: object) -> bool:
        return self._draw == second._draw if isinstance(second, Copy) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._draw)

    def __reduce__(self) -> tuple[type[Copy], tuple[Tolerance, int]]:
        return Copy, (self.tolerance, self.index)


def tolerance(slab: Slab, thickness: float = 0.0, density: float = 0.0, count: int = 100, seed: int = 0) -> Tolerance:
    """Random copies of a slab for Monte Carlo studies of manufacture.

    Every layer of every period gets errors of its own: its thickness and its density are multiplied by 1 + sigma g, where g is
    Gaussian, of mean 0 and standard deviation 1, and cut off at 4. Signs, the positivity of thicknesses, phases of complex
    densities and `density_x` over `density` are therefore kept. A membrane's areal density changes as a density; bulk moduli
    and half-spaces stay.

    Parameters
    ----------
    slab : Slab
    thickness, density : float
        Relative standard deviations, sigma, from 0 to below 0.25.
    count : int
        How many copies.
    seed : int
        Copy i depends on the slab, both deviations, the seed and i alone: not on `count`, nor on the other copies.

    Returns
    -------
    sequence of Slab
        Of `len` count. Each is made when it is asked for by its index, or in turn, and not kept. In files, and on the way to another process, a
        copy is these arguments and its index.

    Raises
    ------
    ValueError
        Names the argument.

    Examples
    --------
    >>> slab = bp.Slab(bp.lmmd_cell(), periods=20)
    >>> copies = bp.tolerance(slab, thickness=0.02, density=0.01, count=50, seed=1)
    >>> len(copies), len(copies[7].cell.layers)
    (50, 200)
    >>> widths = [bp.beam_width(copy, bp.GaussianBeam(0.096), 2500.0).fwhm_out.item() for copy in copies]
    >>> np.percentile(widths, [5, 50, 95]).round(4)
    array([0.0998, 0.1042, 0.1081])
    """
    return Tolerance(slab, thickness, density, count, seed)


def _factors(tolerance: Tolerance, index: int, layers: int) -> np.ndarray:
    """What thicknesses and densities are multiplied by, (2, layers): by the inverse of the distribution, a uniform number each."""
    from scipy.special import ndtr, ndtri

    uniform = np.random.Generator(np.random.PCG64([tolerance.seed, index])).random((2, layers))
    beyond = ndtr(-CUT)
    deviates = ndtri(beyond + (1 - 2 * beyond) * uniform)
    return np.asarray(1 + np.array([[tolerance.thickness], [tolerance.density]]) * deviates)


def _changed(layer: Layer | Membrane, thickness: float, density: float) -> Layer | Membrane:
    """A layer with its thickness and density multiplied."""
    if isinstance(layer, Membrane):
        return replace(layer, areal_density=_times(layer.areal_density, density))
    fluid = layer.fluid
    if isinstance(fluid, Solid):  # its moduli stay, as a fluid's does
        speeds = (_times(v, density**-0.5) for v in (fluid.longitudinal_speed, fluid.shear_speed))
        fluid = Solid(_times(fluid.density, density), *speeds, active=fluid.active)
    elif density != 1:
        along_x = None if fluid.density_x is None else _times(fluid.density_x, density)
        fluid = Fluid(_times(fluid.density, density), fluid.bulk_modulus, along_x, active=fluid.active)
    return Layer(fluid, layer.thickness * thickness)


def _times(prop: Property, factor: float) -> Property:
    """A property multiplied by a number."""
    return functools.partial(_product, prop, factor) if callable(prop) else prop * factor


def _product(prop: Callable[[np.ndarray], np.ndarray], factor: float, frequency: np.ndarray) -> np.ndarray:
    return factor * prop(frequency)
