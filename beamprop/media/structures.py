"""What a user builds: fluids, layers, cells, slabs. Frozen records, checked when they are made.

The one bridge from these objects to arrays stands at the end of the file: `FluidValues` for the half-spaces
and `LayerValues` for the layers, both evaluated at an array of frequencies.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from .. import memory, validate
from ..conventions import branch_wavenumber
from ..validate import as_complex, as_count, as_number

Property = complex | Callable[[np.ndarray], np.ndarray]


def _check_property(
    values: Any, name: str, *, gain_sign: int, active: bool, infinite: bool = False, zero: bool = True
) -> None:
    """Refuse NaN, infinity and zero (unless legitimate), gain, and what double precision cannot compute with."""
    values = np.atleast_1d(np.asarray(values, dtype=complex))
    allowed = np.isfinite(values) | (np.isinf(values) if infinite else False)
    if not np.all(allowed):
        raise ValueError(f"{name}: expected finite values, got {values[~allowed][0]}")
    if not zero and np.any(values == 0):
        raise ValueError(f"{name}: expected a value other than zero, got 0")
    validate.within(values[values != 0], name)
    gain = np.isfinite(values) & (gain_sign * values.imag < 0)
    if not active and np.any(gain):
        relation = ">= 0" if gain_sign > 0 else "<= 0"
        raise ValueError(
            f"{name}: expected a passive medium, Im({name}) {relation} with exp(-i w t), got {values[gain][0]}; "
            "pass active=True for a medium with gain"
        )


def _values_at(prop: Property, frequency: np.ndarray, name: str) -> np.ndarray:
    """A property at frequencies [Hz], complex, of their shape. A function may overwrite what it is given: it gets a copy."""
    if not callable(prop):
        return np.full(frequency.shape, prop, dtype=complex)
    out = validate.numeric(prop(frequency.copy()), name, "a function that returns numbers").astype(complex)
    if out.shape != frequency.shape:
        raise ValueError(
            f"{name}: expected a function that returns an array of shape {frequency.shape}, got {out.shape}"
        )
    return out


@dataclass(frozen=True)
class Fluid:
    """A fluid with a scalar bulk modulus and a density that may differ along x and z.

    Parameters
    ----------
    density : complex, or function of frequency; kg/m3
        Along z, and along x too unless `density_x` is given. A function takes an array of frequencies [Hz]
        and returns an array of the same shape.
    bulk_modulus : complex, or function of frequency; Pa
    density_x : complex, or function of frequency, optional; kg/m3
        ``inf`` is legitimate: no motion along x at all.
    active : bool
        Allow gain, which is refused otherwise (Im(density) < 0 or Im(bulk_modulus) > 0).

    Raises
    ------
    ValueError
        NaN or infinite values, bulk_modulus 0, gain, or density_x = 0 beside another density.

    Examples
    --------
    >>> water = bp.Fluid(1000.0, bulk_modulus=2.19e9)
    >>> round(float(water.wavenumber(2500.0).real), 2)
    10.61
    >>> foam = bp.Fluid(lambda f: 2.0 + 500j / f, 1.2e5)  # by frequency [Hz], with loss
    >>> foam.dispersive
    True
    """

    density: Property
    bulk_modulus: Property
    density_x: Property | None = None
    active: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        for name in ("density", "bulk_modulus", "density_x"):
            value = getattr(self, name)
            if not callable(value) and not (name == "density_x" and value is None):
                object.__setattr__(self, name, as_complex(value, name))
        numbers = {
            n: v
            for n in ("density", "bulk_modulus", "density_x")
            if (v := getattr(self, n)) is not None and not callable(v)
        }
        self._check(**numbers)

    def _check(self, density: Any = None, bulk_modulus: Any = None, density_x: Any = None) -> None:
        if density is not None:
            _check_property(density, "density", gain_sign=1, active=self.active)
        if bulk_modulus is not None:
            _check_property(bulk_modulus, "bulk_modulus", gain_sign=-1, active=self.active, zero=False)
        if density_x is not None:
            _check_property(density_x, "density_x", gain_sign=1, active=self.active, infinite=True)
            if np.any(np.asarray(density_x) == 0):
                raise ValueError("density_x: zero beside a density that is given apart has no finite limit, got 0")

    @classmethod
    def from_speed(cls, density: complex, sound_speed: complex, *, active: bool = False) -> Fluid:
        """A fluid by its density [kg/m3] and speed of sound [m/s]: bulk modulus ``density * sound_speed**2``."""
        rho, c = as_complex(density, "density"), as_complex(sound_speed, "sound_speed")
        if not (np.isfinite(rho) and rho != 0):
            raise ValueError(f"density: expected a finite number other than zero beside a speed, got {density!r}")
        if not (np.isfinite(c) and c != 0):
            raise ValueError(f"sound_speed: expected a finite number other than zero, got {sound_speed!r}")
        for name, value in (("density", rho), ("sound_speed", c), ("sound_speed", rho * c * c)):
            validate.within(value, name)
        return cls(rho, rho * c * c, active=active)

    @property
    def dispersive(self) -> bool:
        """Whether any property is a function of frequency."""
        return any(callable(v) for v in (self.density, self.bulk_modulus, self.density_x))

    def at(self, frequency: Any) -> FluidValues:
        """The properties at frequencies [Hz], as complex arrays of frequency's shape."""
        frequency = np.asarray(frequency, dtype=float)
        rho_z = _values_at(self.density, frequency, "density")
        K = _values_at(self.bulk_modulus, frequency, "bulk_modulus")
        rho_x = rho_z if self.density_x is None else _values_at(self.density_x, frequency, "density_x")
        if self.dispersive:
            self._check(rho_z, K, None if self.density_x is None else rho_x)
        return FluidValues(rho_z, rho_x, K)

    def wavenumber(self, frequency: Any) -> np.ndarray:
        """The lateral wavenumber at which waves turn evanescent, w sqrt(rho_x / K) [rad/m]."""
        frequency = np.asarray(frequency, dtype=float)
        v = self.at(frequency)
        return branch_wavenumber(2 * np.pi * frequency, v.rho_x, v.bulk_modulus)

    def __repr__(self) -> str:
        def show(v: Any) -> str:
            if callable(v):
                return getattr(v, "__name__", None) or repr(v)
            return f"{v.real:.6g}" if v.imag == 0 else f"{v:.6g}"

        along_x = "" if self.density_x is None else f", density_x={show(self.density_x)}"
        return f"Fluid(density={show(self.density)}, bulk_modulus={show(self.bulk_modulus)}{along_x})"


#: Air as in the paper: 1.25 kg/m3, 343 m/s.
AIR = Fluid.from_speed(1.25, 343.0)


@dataclass(frozen=True)
class Layer:
    """A homogeneous layer: a `Fluid` and its thickness [m].

    Examples
    --------
    >>> bp.Layer(bp.AIR, thickness=0.01)
    Layer(fluid=Fluid(density=1.25, bulk_modulus=147061), thickness=0.01)
    """

    fluid: Fluid
    thickness: float

    def __post_init__(self) -> None:
        validate.instance(self.fluid, Fluid, "fluid")
        object.__setattr__(self, "thickness", as_number(self.thickness, "thickness", positive=True, tiny=True))


@dataclass(frozen=True)
class Membrane:
    """A surface without thickness that carries mass: p jumps by ``areal_density * q`` across it.

    A limp membrane of `areal_density` kg/m2 (complex, or a function of frequency); the interface term of the
    effective medium is one, with a negative value on one face.

    Examples
    --------
    >>> sheet = bp.Slab([bp.Membrane(0.3), bp.Layer(bp.AIR, 0.01)])
    >>> T = float(bp.scattering(sheet, 1000.0, angle=0).transmissivity)
    >>> mass_law = 1 / (1 + (2 * np.pi * 1000.0 * 0.3 / (2 * 1.25 * 343)) ** 2)
    >>> bool(np.isclose(T, mass_law))
    True
    """

    areal_density: Property
    active: bool = field(default=False, kw_only=True)
    thickness = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "active", validate.flag(self.active, "active"))
        if not callable(self.areal_density):
            value = as_complex(self.areal_density, "areal_density")
            object.__setattr__(self, "areal_density", value)
            _check_property(value, "areal_density", gain_sign=1, active=self.active)

    def at(self, frequency: np.ndarray) -> np.ndarray:
        """Areal density at frequencies [Hz], checked."""
        out = _values_at(self.areal_density, frequency, "areal_density")
        if callable(self.areal_density):
            _check_property(out, "areal_density", gain_sign=1, active=self.active)
        return out


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
        layers = (self.layers,) if isinstance(self.layers, Layer) else self.layers
        if not isinstance(layers, Iterable):
            raise validate.refuse("layers", "a sequence of Layer", layers)
        layers = tuple(_checked_layer(layer) for layer in layers)
        if not any(isinstance(layer, Layer) for layer in layers):
            raise ValueError("layers: expected at least one Layer, got none")
        object.__setattr__(self, "layers", layers)

    @property
    def thickness(self) -> float:
        """Thickness of the period [m]."""
        return math.fsum(layer.thickness for layer in self.layers)

    def __repr__(self) -> str:
        return f"Cell({len(self.layers)} layers, {self.thickness:.6g} m)"


@dataclass(frozen=True, init=False)
class Slab:
    """`periods` copies of a cell between two half-spaces; ``a + b`` stacks b behind a.

    Parameters
    ----------
    cell : Cell, or a sequence of Layer
    periods : int
    before, after : Fluid
        The half-spaces in front and behind.

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
    """

    segments: tuple[tuple[Cell, int], ...]
    before: Fluid
    after: Fluid

    def __init__(self, cell: Cell | Iterable[Layer], periods: int = 1, before: Fluid = AIR, after: Fluid = AIR) -> None:
        if not isinstance(cell, Cell):
            if not isinstance(cell, Layer | Iterable):
                raise validate.refuse("cell", "a Cell", cell)
            cell = Cell(cell)  # type: ignore[arg-type]
        self._fill(((cell, as_count(periods, "periods")),), before, after)

    def _fill(self, segments: tuple[tuple[Cell, int], ...], before: Fluid, after: Fluid) -> None:
        for name, fluid in (("before", before), ("after", after)):
            validate.instance(fluid, Fluid, name)
            if not callable(fluid.density) and fluid.density == 0:
                raise ValueError(f"{name}: a half-space cannot have density 0")
        merged: list[tuple[Cell, int]] = []
        for cell, periods in segments:  # so that a + a is a with twice the periods
            if merged and merged[-1][0] == cell:
                merged[-1] = (cell, merged[-1][1] + periods)
            else:
                merged.append((cell, periods))
        object.__setattr__(self, "segments", tuple(merged))
        object.__setattr__(self, "before", before)
        object.__setattr__(self, "after", after)

    @classmethod
    def stack(cls, segments: Iterable[tuple[Cell, int]], before: Fluid = AIR, after: Fluid = AIR) -> Slab:
        """A slab of several (cell, periods) pairs, from the near face on."""
        try:
            given = [(cell, periods) for cell, periods in segments]
        except (TypeError, ValueError):
            raise validate.refuse("segments", "(Cell, periods) pairs", segments) from None
        pairs = tuple((validate.instance(cell, Cell, "segments"), as_count(n, "periods")) for cell, n in given)
        if not pairs:
            raise ValueError("segments: expected at least one (cell, periods) pair, got none")
        slab = object.__new__(cls)
        slab._fill(pairs, before, after)
        return slab

    @classmethod
    def uniform(cls, fluid: Fluid, thickness: float, before: Fluid = AIR, after: Fluid = AIR) -> Slab:
        """A homogeneous slab of `fluid`, `thickness` metres thick."""
        return cls(Cell((Layer(fluid, thickness),)), 1, before, after)

    @property
    def cell(self) -> Cell:
        """The one cell of a slab that is not stacked."""
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

    def __add__(self, other: Slab) -> Slab:
        if not isinstance(other, Slab):
            return NotImplemented
        return Slab.stack(self.segments + other.segments, self.before, other.after)

    def __repr__(self) -> str:
        stack = " + ".join(f"{periods} x {cell!r}" for cell, periods in self.segments)
        return f"Slab({stack}, before={self.before!r}, after={self.after!r})"


def lmmd_cell(
    rho_m: complex = 0.05 + 0.05j,
    delta_rho: float = 0.025,
    n_layers: int = 10,
    eta: float = 1 / 60,
    design_frequency: float = 2500.0,
    background: Fluid = AIR,
) -> Cell:
    """One period of the rapidly modulated medium of large modulation depth, the paper's Eq. (10).

    Layer j = 1..N has the density ``rho_m + (1/eta + i delta_rho) cos(2 pi (j-1)/N)`` relative to the
    background's, the background's bulk modulus, and the thickness ``eta lambda0 / N``.

    Parameters
    ----------
    rho_m : complex
        Mean relative density.
    delta_rho : float
        Modulation of the loss.
    n_layers : int
        N, layers in a period.
    eta : float
        Period over the background's wavelength at `design_frequency`.
    design_frequency : float, Hz
    background : Fluid
        Isotropic; evaluated at `design_frequency` if it is dispersive.

    Examples
    --------
    >>> cell = bp.lmmd_cell(0.05, 0)  # without loss
    >>> [round(layer.fluid.density.real / 1.25, 2) for layer in cell.layers][:3]
    [60.05, 48.59, 18.59]
    """
    n_layers = as_count(n_layers, "n_layers")
    memory.check("n_layers", 1000.0 * n_layers, f"{n_layers:.3g} layers", "take fewer")
    eta = as_number(eta, "eta", positive=True)
    design_frequency = as_number(design_frequency, "design_frequency", positive=True)
    delta_rho = as_number(delta_rho, "delta_rho")
    rho_m = as_complex(rho_m, "rho_m")
    if not np.isfinite(rho_m):
        raise ValueError(f"rho_m: expected a finite number, got {rho_m}")
    validate.within(rho_m, "rho_m", zero=True)
    validate.instance(background, Fluid, "background")
    values = background.at(design_frequency)
    k0 = float(background.wavenumber(design_frequency).real)
    if not (math.isfinite(k0) and k0 > 0):
        raise ValueError(f"background: expected a fluid in which waves propagate, got {background!r}")
    cosine = np.cos(2 * np.pi * np.arange(n_layers) / n_layers)
    cosine[np.abs(cosine) < 1e-15] = 0.0  # cos(pi/2): exactly zero, as in the formula
    density = complex(values.rho_z) * (rho_m + (1 / eta + 1j * delta_rho) * cosine)
    thickness = eta * 2 * np.pi / k0 / n_layers
    return Cell(tuple(Layer(Fluid(rho, complex(values.bulk_modulus)), thickness) for rho in density))


# --- the bridge from objects to arrays -------------------------------------------------------------------


class FluidValues(NamedTuple):
    """A fluid at given frequencies: arrays of frequency's shape."""

    rho_z: np.ndarray
    rho_x: np.ndarray
    bulk_modulus: np.ndarray


class LayerValues(NamedTuple):
    """The layers of a cell at F frequencies: arrays (N, F), and the thickness (N,).

    A layer's matrix needs no more than mass ``rho_z d``, compliance ``d / K`` and mobility ``d / rho_x``; a
    membrane has mass alone. Rows are divided in proportion where a layer is cut.
    """

    mass: np.ndarray
    compliance: np.ndarray
    mobility: np.ndarray
    thickness: np.ndarray
    vanishing: np.ndarray  # (N, F): isotropic density 0, solved as the limit of small density


class SegmentValues(NamedTuple):
    """One segment of a slab: its layers and how often they repeat."""

    layers: LayerValues
    periods: int


#: Stands for an isotropic density of exactly 0: what is left of its limit (r = -1, t = 0 off the normal) is of
#: this size against densities near 1.
TINY_DENSITY = 1e-40


class Materials(NamedTuple):
    """The layers of a cell as their materials at F frequencies: what differences between neighbours are formed from.

    `fluid` arrays (N, F); a membrane has its areal density [kg/m2] for rho_z.
    """

    fluid: FluidValues
    thickness: np.ndarray  # (N,)
    membrane: np.ndarray  # (N,)


def materials(cell: Cell, frequency: np.ndarray) -> Materials:
    """A cell's layers as materials at frequencies [Hz] (1-D)."""
    seen: dict[Fluid, FluidValues] = {}
    rows = []
    for layer in cell.layers:
        if isinstance(layer, Membrane):  # mass on no thickness, which nothing moves along x
            rows.append(
                FluidValues(layer.at(frequency), np.full(frequency.shape, np.inf + 0j), np.ones(frequency.shape))
            )
            continue
        if layer.fluid not in seen:
            seen[layer.fluid] = layer.fluid.at(frequency)
        rows.append(seen[layer.fluid])
    fluid = FluidValues(*(np.stack(column) for column in zip(*rows, strict=True)))
    thickness = np.array([layer.thickness for layer in cell.layers])
    return Materials(fluid, thickness, np.array([isinstance(layer, Membrane) for layer in cell.layers]))


def layer_values(cell: Cell, frequency: np.ndarray) -> LayerValues:
    """The bridge: a cell's layers as arrays at frequencies [Hz] (1-D)."""
    (rho_z, rho_x, K), thickness, membrane = materials(cell, frequency)
    vanishing = (rho_z == 0) & (rho_x == 0)
    if vanishing.any():
        rho_z, rho_x = (np.where(vanishing, TINY_DENSITY, rho) for rho in (rho_z, rho_x))
    mobility = np.divide(1, rho_x, out=np.zeros(rho_x.shape, complex), where=np.isfinite(rho_x))
    d = thickness[:, None]
    mass = rho_z * np.where(membrane[:, None], 1.0, d)
    return LayerValues(mass, d / K, mobility * d, thickness, vanishing)


def slab_values(slab: Slab, frequency: np.ndarray) -> list[SegmentValues]:
    """The bridge: a slab's segments as arrays at frequencies [Hz] (1-D)."""
    return [SegmentValues(layer_values(cell, frequency), periods) for cell, periods in slab.segments]
