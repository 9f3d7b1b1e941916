"""A layered slab between two half-spaces: what `SampledSlab` demands, by the kernels of this room."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..conventions import outgoing_kz
from ..media.fluids import FluidValues
from ..media.solids import SolidHalfSpace
from ..media.values import SegmentValues
from . import solid_half_space, walls
from .cell import cell_matrix
from .conditioning import SHIFT
from .layer import (
    at_frequencies,
    changed_run,
    half_space_with_loss,
    perturbed,
    properties,
    solid_perturbed,
    solid_with_loss,
    with_loss,
    with_solids,
)
from .periods import bloch_phase
from .slab import Response, dispersion, solve, transmitted_flux


class FluidSlab(NamedTuple):
    """Layers of fluids and solids between two fluids, or in front of a solid: a `SampledSlab`."""

    segments: list[SegmentValues]
    before: FluidValues
    after: FluidValues | SolidHalfSpace
    omega: np.ndarray  # (F, 1)
    thickness: Any  # float, or (F,) of a slab for each frequency
    k0: Any  # float for one frequency, (F,) for several; complex where the frequency is
    branch_points: tuple[Any, ...]

    @property
    def faces(self) -> np.ndarray:
        """Depths of the faces and of those between segments [m]."""
        last = [block.thickness for block in self.after.run] if isinstance(self.after, SolidHalfSpace) else []
        return np.cumsum([0.0, *(s.periods * s.layers.thickness.sum() for s in self.segments), *last])

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
        values += [v[None] for v in (*self.before, *self.after[:3])]
        if isinstance(self.after, SolidHalfSpace):
            values += [v for block in self.after.run for v in block.layers[:3]]
        return np.any([np.any(v.imag, axis=0) for v in values], axis=0)

    @property
    def may_guide_backward(self) -> bool:
        """Whether some density or modulus is negative, or some layer a solid, whose plate waves may run backward."""
        layers = (v for seg in self.segments for v in (seg.layers.mass, seg.layers.mobility, seg.layers.compliance))
        return self.carries_shear or any(bool(np.any(v.real < 0)) for v in (*layers, *self.before, *self.after[:3]))

    @property
    def carries_shear(self) -> bool:
        """Whether some layer, or the half-space behind, is a solid."""
        return isinstance(self.after, SolidHalfSpace) or any(segment.layers.solids for segment in self.segments)

    @property
    def far_face_shears(self) -> bool:
        """Whether solids touch at the far face."""
        return isinstance(self.after, SolidHalfSpace) and bool(self.after.run)

    @property
    def lossless_outside(self) -> tuple[bool, bool]:
        """Whether a wave along the normal has no loss in front, and behind."""
        sides = []
        for values in (self.before, self.after):
            if isinstance(values, SolidHalfSpace):
                sides.append(not any(np.any(v.imag) for v in values[:3]))
                continue
            kz = outgoing_kz(np.zeros(1), self.omega, *(v[:, None] for v in values))
            sides.append(not any(np.any(v.imag) for v in (kz, kz / values.rho_z[:, None], values.rho_x)))
        return sides[0], sides[1]

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

    def admittance_before(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z in front."""
        return self.kz_before(kx) / self.before.rho_z[:, None]

    def velocity(self, kx: np.ndarray, quantity: str) -> np.ndarray:
        """1/(w rho_x), or kz/(w rho_z); 0 for the shear stress."""
        if quantity == "v_z":
            return self.admittance_before(kx) / self.omega
        return _velocity_along_x(self.before, self.omega, kx, quantity)

    def waves_behind(
        self, kx: np.ndarray, response: Response, quantity: str = "p"
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """The transmitted wave, or the P and the S wave of a solid."""
        if isinstance(self.after, SolidHalfSpace):
            assert response.waves is not None
            kx = np.broadcast_to(kx, response.t.shape)
            return solid_half_space.waves(self.after, self.omega, kx, response.waves, quantity)
        kz = outgoing_kz(kx, self.omega, *(v[:, None] for v in self.after))
        if quantity == "p":
            return [(kz, response.t)]
        if quantity == "v_z":
            return [(kz, kz / self.after.rho_z[:, None] / self.omega * response.t)]
        return [(kz, _velocity_along_x(self.after, self.omega, kx, quantity) * response.t)]

    def transmitted_flux(self, kx: np.ndarray, response: Response) -> np.ndarray:
        """|t|^2 Re(kz/rho_z), or that of both waves of a solid."""
        return transmitted_flux(self.before, self.after, self.omega, kx, response)

    def largest_kx(self, behind: bool) -> float:
        """w sqrt(rho_x/K), if it is finite; of a solid that of the slower wave."""
        if behind and isinstance(self.after, SolidHalfSpace):
            return max(abs(b[0].real) for b in solid_half_space.branches(self.after, self.omega[:, 0]))
        fluid = self.after if behind else self.before
        assert isinstance(fluid, FluidValues)
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
        after = self.after
        if isinstance(after, SolidHalfSpace):
            run = changed_run(after.run, lambda v, kind: v if kind else v * (1 + shift / 8))
            after = after._replace(run=run)
        return self._replace(omega=self.omega * (1 - shift), segments=segments, after=after)

    def rounded(self) -> FluidSlab:
        """See `response.layer.perturbed`."""
        after = self.after
        if isinstance(after, SolidHalfSpace):
            after = after._replace(run=changed_run(after.run, solid_perturbed(SHIFT)))
        return self._replace(segments=[perturbed(segment, SHIFT) for segment in self.segments], after=after)

    def with_loss(self, loss: float) -> FluidSlab:
        """Every density and modulus with `loss` more."""
        if not loss:
            return self
        segments = [values._replace(layers=with_loss(values.layers, loss)) for values in self.segments]
        after = self.after
        if isinstance(after, SolidHalfSpace):
            after = solid_half_space.changed(after, solid_with_loss(loss))
        else:
            after = half_space_with_loss(after, loss)
        return self._replace(segments=segments, before=half_space_with_loss(self.before, loss), after=after)

    def up_to_wall(self) -> FluidSlab:
        """See `response.walls.up_to_wall`."""
        return self._replace(segments=walls.up_to_wall(self.segments)) if self.has_wall else self

    def parts_between_walls(self) -> list[tuple[FluidSlab, int]]:
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
        before, after = (_rows(f, rows) for f in (self.before, self.after))
        k0, branches = self.k0[rows], [b[rows] for b in self.branch_points]
        thickness = self.thickness[rows] if np.ndim(self.thickness) else self.thickness
        if single:
            k0, branches, thickness = k0[0].item(), [complex(b[0]) for b in branches], float(np.ravel(thickness)[0])
        return FluidSlab(segments, before, after, self.omega[rows], thickness, k0, tuple(branches))


def _rows(values: Any, rows: np.ndarray) -> Any:
    """A half-space at frequencies `rows`."""
    if isinstance(values, SolidHalfSpace):
        return solid_half_space.taken(values, rows)
    return FluidValues(*(v[rows] for v in values))


def _velocity_along_x(fluid: FluidValues, omega: np.ndarray, kx: np.ndarray, quantity: str) -> np.ndarray:
    """v_x over kx, per unit of p; 0 for the shear stress."""
    if quantity == "s_xz":
        return np.zeros(np.broadcast_shapes(omega.shape, kx.shape))
    rho_x = fluid.rho_x[:, None]
    return np.divide(1, rho_x, out=np.zeros(rho_x.shape, complex), where=np.isfinite(rho_x)) / omega + 0 * kx
