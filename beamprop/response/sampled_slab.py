"""A slab at given frequencies: the only door from slabs to arrays.

Contours, modes, fields and profiles ask a `SampledSlab` for its response, its dispersion function and where its half-spaces have
their branch points; what it is made of they do not know. `FluidSlab` is the one of layered fluids.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from ..conventions import branch_wavenumber, outgoing_kz
from ..media.fluids import FluidValues
from ..media.structures import Slab
from ..media.values import SegmentValues, half_space_values, slab_values
from . import walls
from .cell import cell_matrix
from .conditioning import SHIFT
from .layer import at_frequencies, half_space_with_loss, perturbed, properties, with_loss, with_solids
from .periods import bloch_phase
from .slab import Response, dispersion, solve


class SampledSlab(Protocol):
    """What is asked of a slab at F frequencies, w = 2 pi f.

    kx is (n,) or (F, n) [rad/m]; answers are (F, n). Of one frequency `k0` is a float and `branch_points` are complex numbers, of
    several they are (F,).
    """

    @property
    def k0(self) -> Any:
        """Wavenumber of the medium in front [rad/m]."""

    @property
    def thickness(self) -> float:
        """From the near face z = 0 to the far face [m]."""

    @property
    def faces(self) -> np.ndarray:
        """Depths between which the medium is of one kind, a layer or a run of periods, from 0 to `thickness` [m]."""

    @property
    def branch_points(self) -> tuple[Any, ...]:
        """Complex kx at which kz of a half-space vanishes, Im >= 0; Re < 0 where it carries backward waves."""

    @property
    def nearest_branch(self) -> Any:
        """Distance of the nearest branch point from kx = 0, shaped like `k0`."""

    @property
    def last_branch(self) -> Any:
        """The largest |Re kx| of a branch point: guided modes lie beyond; shaped like `k0`."""

    @property
    def real_branches(self) -> list[float]:
        """|Re kx| of the branch points that lie nearer to the real axis than to the imaginary one; of one frequency."""

    @property
    def backward_branch(self) -> complex | None:
        """The branch point, with Re kx > 0, of a half-space that carries backward waves; its cut leads downward. Of one frequency."""

    @property
    def lossless(self) -> bool:
        """Whether no layer and no half-space has loss."""

    @property
    def may_guide_backward(self) -> bool:
        """Whether some layer or half-space has a negative density or modulus: without, every mode is a forward one."""

    @property
    def has_wall(self) -> bool:
        """Whether some layer lets through no plane wave but the normal one."""

    @property
    def periodic(self) -> bool:
        """Whether it is several periods of one cell, so that Bloch waves tell what it lets through."""

    def response(self, kx: np.ndarray, z: np.ndarray | None = None, quantity: str = "p") -> Response:
        """r and t at the faces, and p, v_x/kx or v_z at depths z (Z,) inside over the incident p at the near face."""

    def dispersion(self, kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A function whose zeros in kx are the guided modes, as value and logarithm: value exp(logarithm)."""

    def half_trace(self, kx: np.ndarray, loss: float = 0.0) -> np.ndarray:
        """cos of the Bloch phase of one period without its own loss, but with `loss`; of a `periodic` slab."""

    def bloch_phase_across(self, kx: np.ndarray) -> np.ndarray:
        """Phase of a Bloch wave across all periods, with its decay as imaginary part; of a `periodic` slab."""

    def kz_before(self, kx: np.ndarray) -> np.ndarray:
        """kz of the medium in front [rad/m]."""

    def kz_after(self, kx: np.ndarray) -> np.ndarray:
        """kz of the medium behind [rad/m]."""

    def admittance_before(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z of the medium in front: w times its admittance along z."""

    def admittance_after(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z of the medium behind."""

    def velocity(self, kx: np.ndarray, quantity: str, behind: bool) -> np.ndarray:
        """ "v_x", over kx, or "v_z" of the wave along +z in front, or `behind`, per unit of its p."""

    def largest_kx(self, behind: bool) -> float:
        """The largest kx of waves that propagate in front, or `behind`, 0 if there are none; of one frequency [rad/m]."""

    def without_slab(self) -> SampledSlab:
        """The medium in front alone."""

    def stacked(self) -> SampledSlab:
        """One frequency as an array of one."""

    def perturbed(self, shift: float) -> SampledSlab:
        """Its frequency and layers moved by `shift`, to see what rounding does to a field."""

    def rounded(self) -> SampledSlab:
        """Its layers moved in their last bits, to see what rounding does to a mode."""

    def with_loss(self, loss: float) -> SampledSlab:
        """More loss in every layer and half-space: rho -> rho + i loss |rho|, 1/K -> 1/K + i loss |1/K|."""

    def up_to_wall(self) -> SampledSlab:
        """It without what lies behind its first wall, at one frequency."""

    def parts_between_walls(self) -> list[tuple[SampledSlab, int]]:
        """The parts into which walls divide it off the normal, of one frequency, and how often each is there.

        The first has the half-space in front, the last one that behind; the others are closed, have no branch point, and those of
        a cell that is repeated are alike.
        """

    def take(self, i: Any) -> SampledSlab:
        """Frequency i (an index: `k0` and branch points become numbers), or frequencies i (an array)."""


class FluidSlab(NamedTuple):
    """Layered fluids between two fluids: a `SampledSlab`."""

    segments: list[SegmentValues]
    before: FluidValues
    after: FluidValues
    omega: np.ndarray  # (F, 1)
    thickness: Any  # float, or (F,) of a slab for each frequency
    k0: Any  # float for one frequency, (F,) for several; complex where the frequency is
    branch_points: tuple[Any, ...]

    @property
    def faces(self) -> np.ndarray:
        """Depths of the faces and of those between segments [m]."""
        return np.cumsum([0.0, *(values.periods * values.layers.thickness.sum() for values in self.segments)])

    @property
    def nearest_branch(self) -> Any:
        """Distance of the nearest branch point from kx = 0."""
        return np.min(np.abs(np.stack(self.branch_points)), axis=0)

    @property
    def last_branch(self) -> Any:
        """The largest |Re kx| of a branch point."""
        return np.max(np.abs(np.real(np.stack(self.branch_points))), axis=0)

    @property
    def real_branches(self) -> list[float]:
        """|Re kx| of the branch points beside the real axis."""
        return [abs(b.real) for b in self.branch_points if abs(b.real) > abs(b.imag)]

    @property
    def backward_branch(self) -> complex | None:
        """The branch point of a half-space of backward waves."""
        return next((-b for b in self.branch_points if -b.real > b.imag), None)

    @property
    def lossless(self) -> bool:
        """Whether no property has an imaginary part."""
        return not self.has_loss.any()

    @property
    def has_loss(self) -> np.ndarray:
        """At which frequencies some property has an imaginary part, (F,)."""
        values = [v for seg in self.segments for v in properties(seg.layers)]
        return np.any(
            [np.any(v.imag, axis=0) for v in (*values, *(v[None] for v in (*self.before, *self.after)))], axis=0
        )

    @property
    def may_guide_backward(self) -> bool:
        """Whether some density or modulus is negative, or some layer a solid, whose plate waves may run backward."""
        solid = any(segment.layers.solids for segment in self.segments)
        layers = (v for seg in self.segments for v in (seg.layers.mass, seg.layers.mobility, seg.layers.compliance))
        return solid or any(bool(np.any(v.real < 0)) for v in (*layers, *self.before, *self.after))

    @property
    def has_wall(self) -> bool:
        """Whether some layer's density is 0."""
        return any(bool(np.any(values.layers.vanishing)) for values in self.segments)

    @property
    def periodic(self) -> bool:
        """Whether it is several periods of one cell."""
        return len(self.segments) == 1 and self.segments[0].periods > 1 and not self.has_wall

    def response(self, kx: np.ndarray, z: np.ndarray | None = None, quantity: str = "p") -> Response:
        """See `response.slab.solve`."""
        return solve(self.segments, self.before, self.after, self.omega, kx, z, quantity)

    def dispersion(self, kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See `response.slab.dispersion`."""
        return dispersion(self.segments, self.before, self.after, self.omega, kx)

    def half_trace(self, kx: np.ndarray, loss: float = 0.0) -> np.ndarray:
        """Half the trace of one period's matrix."""
        layers = self.segments[0].layers
        mass, compliance, mobility = (v.real for v in layers[:3])
        real = layers._replace(mass=mass, compliance=compliance, mobility=mobility)
        layers = with_solids(real, layers, lambda v, kind: v.real + 0j)
        m = cell_matrix(with_loss(layers, loss), self.omega, np.atleast_2d(kx) + 0j)
        trace = m.a + (m.e11 + m.e22) / 2
        with np.errstate(over="ignore"):
            return np.asarray(trace if m.growth is None else trace * np.exp(m.growth))

    def bloch_phase_across(self, kx: np.ndarray) -> np.ndarray:
        """That of one period, times the periods."""
        layers, periods = self.segments[0]
        return periods * bloch_phase(cell_matrix(layers, self.omega, np.atleast_2d(kx) + 0j)).phase

    def kz_before(self, kx: np.ndarray) -> np.ndarray:
        """kz in front."""
        return outgoing_kz(kx, self.omega, *(v[:, None] for v in self.before))

    def kz_after(self, kx: np.ndarray) -> np.ndarray:
        """kz behind."""
        return outgoing_kz(kx, self.omega, *(v[:, None] for v in self.after))

    def admittance_before(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z in front."""
        return self.kz_before(kx) / self.before.rho_z[:, None]

    def admittance_after(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z behind."""
        return self.kz_after(kx) / self.after.rho_z[:, None]

    def velocity(self, kx: np.ndarray, quantity: str, behind: bool) -> np.ndarray:
        """1/(w rho_x), or kz/(w rho_z)."""
        if quantity == "v_z":
            return (self.admittance_after(kx) if behind else self.admittance_before(kx)) / self.omega
        rho_x = (self.after if behind else self.before).rho_x[:, None]
        return np.divide(1, rho_x, out=np.zeros(rho_x.shape, complex), where=np.isfinite(rho_x)) / self.omega + 0 * kx

    def largest_kx(self, behind: bool) -> float:
        """w sqrt(rho_x/K), if it is finite."""
        fluid = self.after if behind else self.before
        k = complex(self.omega[0, 0] * np.sqrt(fluid.rho_x[0] / fluid.bulk_modulus[0]))
        return abs(k.real) if np.isfinite(k) else 0.0

    def without_slab(self) -> FluidSlab:
        """No layers, and the same medium behind."""
        return self._replace(segments=[], after=self.before, branch_points=(self.k0 + 0j,), thickness=0.0)

    def stacked(self) -> FluidSlab:
        """k0 and branch points as arrays (1,)."""
        return self._replace(k0=np.array([self.k0]), branch_points=tuple(np.array([b]) for b in self.branch_points))

    def perturbed(self, shift: float) -> FluidSlab:
        """omega (1 - shift), and layer masses moved by +-shift/8: rounding shows even where densities of a cell cancel."""
        if not shift:
            return self
        segments = []
        for values in self.segments:
            mass = values.layers.mass
            uneven = 1 + shift / 8 * np.where(np.sin(2.4 * np.arange(mass.shape[0])) > 0, 1, -1)[:, None]
            layers = with_solids(values.layers, values.layers, lambda v, kind: v if kind else v * (1 + shift / 8))
            segments.append(values._replace(layers=layers._replace(mass=mass * uneven)))
        return self._replace(omega=self.omega * (1 - shift), segments=segments)

    def rounded(self) -> FluidSlab:
        """See `response.layer.perturbed`."""
        return self._replace(segments=[perturbed(segment, SHIFT) for segment in self.segments])

    def with_loss(self, loss: float) -> FluidSlab:
        """Every density and modulus with `loss` more."""
        if not loss:
            return self
        segments = [values._replace(layers=with_loss(values.layers, loss)) for values in self.segments]
        before, after = (half_space_with_loss(values, loss) for values in (self.before, self.after))
        return self._replace(segments=segments, before=before, after=after)

    def up_to_wall(self) -> FluidSlab:
        """See `response.walls.up_to_wall`."""
        return self._replace(segments=walls.up_to_wall(self.segments)) if self.has_wall else self

    def parts_between_walls(self) -> list[tuple[SampledSlab, int]]:
        """See `response.walls.parts_between`."""
        parts = walls.parts_between(self.segments)
        if len(parts) == 1:
            return [(self, 1)]
        # the half-space behind a wall has no influence, and its branch point is left out
        shielded = FluidValues(*np.ones((3, 1)))
        front, behind = self.branch_points[:1], self.branch_points[1:]
        slabs = [self._replace(segments=p, before=shielded, after=shielded, branch_points=()) for p, _ in parts]
        slabs[0] = slabs[0]._replace(before=self.before, branch_points=front)
        slabs[-1] = slabs[-1]._replace(after=self.after, branch_points=behind)
        return [(slab, n) for slab, (segments, n) in zip(slabs, parts, strict=True) if not walls.all_walls(segments)]

    def take(self, i: Any) -> FluidSlab:
        """Frequency i, or frequencies i."""
        rows, single = np.atleast_1d(i), np.ndim(i) == 0
        segments = [seg._replace(layers=at_frequencies(seg.layers, rows, single)) for seg in self.segments]
        before, after = (FluidValues(*(v[rows] for v in f)) for f in (self.before, self.after))
        k0, branches = self.k0[rows], [b[rows] for b in self.branch_points]
        thickness = self.thickness[rows] if np.ndim(self.thickness) else self.thickness
        if single:
            k0, branches, thickness = k0[0].item(), [complex(b[0]) for b in branches], float(np.ravel(thickness)[0])
        return FluidSlab(segments, before, after, self.omega[rows], thickness, k0, tuple(branches))


def sample(slab: Slab, frequency: complex, backward: bool = False) -> FluidSlab:
    """A slab at one frequency; refuses half-spaces in which a question has no answer: see `sample_all`."""
    s = sample_all(slab, np.array([frequency]), backward)
    return s._replace(k0=s.k0[0].item(), branch_points=tuple(complex(b[0]) for b in s.branch_points))


def sample_all(slab: Slab | Sequence[Slab], frequency: np.ndarray, backward: bool = False) -> FluidSlab:
    """A slab at frequencies (F,), or a slab of the same `layout` for each; `backward`: whether backward waves may run behind.

    At complex frequencies the answers are the analytic continuation of those at real ones, and `k0` is the complex wavenumber.
    """
    slabs = [slab] if isinstance(slab, Slab) else slab
    omega, sides = 2 * np.pi * frequency, ("before", "after")
    before, after = (half_space_values([getattr(s, side) for s in slabs], frequency) for side in sides)
    branches = [branch_wavenumber(omega, values.rho_x, values.bulk_modulus) for values in (before, after)]
    for name, k in zip(sides, branches, strict=True):
        # waves that decay within a wavelength run neither way: any contour passes their branch point alike
        bad = (k.real <= 0) | np.isinf(k) if name == "before" else (-k.real > k.imag) & (not backward)
        if bad.any():
            i = int(np.argmax(bad))
            expected = f"a half-space that carries forward waves at {frequency[i]} Hz"
            raise ValueError(f"{name}: expected {expected}, got {getattr(slabs[min(i, len(slabs) - 1)], name)!r}")
    k0 = branches[0] if np.iscomplexobj(frequency) else branches[0].real
    thickness = slab.thickness if isinstance(slab, Slab) else np.array([s.thickness for s in slabs])
    finite = tuple(k for k in branches if np.isfinite(k).all())
    return FluidSlab(slab_values(slabs, frequency), before, after, omega[:, None], thickness, k0, finite)


def on_the_right(branch: Any) -> Any:
    """Of the branch points b and -b the one with Re kx >= 0: it lies below the axis for a half-space of backward waves."""
    return np.where(np.real(branch) < 0, -branch, branch)
