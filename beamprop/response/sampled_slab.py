"""A slab at given frequencies: the only door from slabs to arrays.

Contours, modes, fields and profiles ask a `SampledSlab` for its response, its dispersion function and where its half-spaces have
their branch points; what it is made of they do not know. `fluid_slab.FluidSlab` answers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from ..conventions import branch_wavenumber
from ..media.solids import SolidHalfSpace
from ..media.structures import Slab
from ..media.values import behind_values, half_space_values, slab_values
from . import solid_half_space
from .fluid_slab import FluidSlab
from .slab import Response


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

    @property
    def carries_shear(self) -> bool:
        """Whether shear stress acts in some layer or half-space: power then has a part beside p v_z."""

    @property
    def far_face_shears(self) -> bool:
        """Whether shear stress may act on the far face: solids touch there."""

    @property
    def lossless_outside(self) -> tuple[bool, bool]:
        """Whether a wave along the normal has no loss in front, and behind."""

    def response(self, kx: np.ndarray, z: np.ndarray | None = None, quantity: str = "p") -> Response:
        """r and t at the faces, and p, v_z, v_x/kx or s_xz/kx at depths z (Z,) inside over the incident p at the near face."""

    def dispersion(self, kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A function whose zeros in kx are the guided modes, as value and logarithm: value exp(logarithm)."""

    def half_trace(self, kx: np.ndarray, loss: float = 0.0) -> np.ndarray:
        """cos of the Bloch phase of one period without its own loss, but with `loss`; of a `periodic` slab."""

    def bloch_phase_across(self, kx: np.ndarray) -> np.ndarray:
        """Phase of a Bloch wave across all periods, with its decay as imaginary part; of a `periodic` slab."""

    def kz_before(self, kx: np.ndarray) -> np.ndarray:
        """kz of the medium in front [rad/m]."""

    def admittance_before(self, kx: np.ndarray) -> np.ndarray:
        """kz/rho_z of the medium in front: w times its admittance along z."""

    def velocity(self, kx: np.ndarray, quantity: str) -> np.ndarray:
        """ "v_x" or "s_xz", over kx, or "v_z" of the wave along +z in front, per unit of its p."""

    def waves_behind(
        self, kx: np.ndarray, response: Response, quantity: str = "p"
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """kz of each wave behind, and its `quantity` at the far face over the incident p, of what `response` gave for that quantity."""

    def transmitted_flux(self, kx: np.ndarray, response: Response) -> np.ndarray:
        """2 w times the power along z behind, at real kx, for unit incident p."""

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

    def parts_between_walls(self) -> Sequence[tuple[SampledSlab, int]]:
        """The parts into which walls divide it off the normal, of one frequency, and how often each is there.

        The first has the half-space in front, the last one that behind; the others are closed, have no branch point, and those of
        a cell that is repeated are alike.
        """

    def take(self, i: Any) -> SampledSlab:
        """Frequency i (an index: `k0` and branch points become numbers), or frequencies i (an array)."""


def sample(slab: Slab, frequency: complex, backward: bool = False) -> FluidSlab:
    """A slab at one frequency; refuses half-spaces in which a question has no answer: see `sample_all`."""
    s = sample_all(slab, np.array([frequency]), backward)
    return s._replace(k0=s.k0[0].item(), branch_points=tuple(complex(b[0]) for b in s.branch_points))


def sample_all(slab: Slab | Sequence[Slab], frequency: np.ndarray, backward: bool = False) -> FluidSlab:
    """A slab at frequencies (F,), or a slab of the same `layout` for each; `backward`: whether backward waves may run behind.

    At complex frequencies the answers are the analytic continuation of those at real ones, and `k0` is the complex wavenumber.
    """
    slabs = [slab] if isinstance(slab, Slab) else slab
    omega = 2 * np.pi * frequency
    before = half_space_values([s.before for s in slabs], frequency)
    after = behind_values(slabs, frequency)
    branches = [branch_wavenumber(omega, before.rho_x, before.bulk_modulus)]
    if isinstance(after, SolidHalfSpace):
        branches += solid_half_space.branches(after, omega)
    else:
        branches.append(branch_wavenumber(omega, after.rho_x, after.bulk_modulus))
    for name, k in zip(("before", "after", "after"), branches, strict=False):
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
