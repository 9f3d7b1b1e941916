"""The response with its estimated rounding error, by a second evaluation; by the form of `reflection.py` where that is more exact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..conventions import outgoing_kz
from ..media.fluids import FluidValues
from ..media.solids import SolidHalfSpace
from ..media.values import Materials, SegmentValues
from . import solid_half_space
from .layer import at_frequencies, perturbed
from .reflection import Stack, reflect
from .slab import Response, solve

#: By how much (relative) inputs and terms are moved for the second evaluation.
SHIFT = 2.0**-47
#: An estimated error of the recursion above this (7 SHIFT) for each 32 layers exceeds the layers' own rounding: the form of
#: `reflection.py` is evaluated too.
DOUBTFUL = 5e-14
#: Rounding that no perturbation shows.
ROUNDING = 4 * 2.0**-52
#: Below this t has fewer digits than its arithmetic: it is on its way to 0.
FAINT = 1e-290


class Checked(NamedTuple):
    """r and t, and the estimated error of each: of r over the larger of |r| and 1, of t over |t|. (F, n) each."""

    r: np.ndarray
    t: np.ndarray
    r_error: np.ndarray
    t_error: np.ndarray
    waves: np.ndarray | None = None


def solve_checked(
    segments: list[SegmentValues],
    materials: list[Materials],
    before: FluidValues,
    after: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
) -> Checked:
    """`solve` with estimated errors, and more exactly where the recursion of (p, q) cancels."""
    kx = np.broadcast_to(kx, np.broadcast_shapes(omega.shape, np.shape(kx))).astype(complex, copy=False)
    with np.errstate(all="ignore"):  # on a pole the recursion divides by 0, and its error is infinite
        one = solve(segments, before, after, omega, kx)
        two, moved = _moved(segments, before, after, omega, kx)
    # r and t share a denominator, and the rounding of the recursion may show in one of them only: see `_moved`
    r_error, t_error = _errors(one.r, one.t, two.r, two.t)
    larger = np.maximum(r_error, t_error)
    limit = DOUBTFUL * max(1.0, sum(s.periods * len(s.layers.thickness) for s in segments) / 32)
    doubtful = larger > limit
    out = Checked(one.r, one.t, np.where(doubtful, larger, r_error), larger, one.waves)
    if isinstance(after, FluidValues) and not any(np.any(s.layers.vanishing) or s.layers.solids for s in segments):
        for i in np.flatnonzero(np.any(doubtful, axis=-1)):
            part = [s._replace(layers=at_frequencies(s.layers, slice(i, i + 1))) for s in segments]
            rows = [m._replace(fluid=FluidValues(*(v[:, i : i + 1] for v in m.fluid))) for m in materials]
            front, behind = (FluidValues(*(v[i : i + 1] for v in f)) for f in (before, after))
            _by_waves(
                out,
                Stack(part, rows, front, behind, float(omega[i, 0])),
                kx,
                moved,
                int(i),
                np.flatnonzero(doubtful[i]),
            )
    return _with_rounding(out)


def _moved(
    segments: list[SegmentValues],
    before: FluidValues,
    after: FluidValues | SolidHalfSpace,
    omega: np.ndarray,
    kx: np.ndarray,
) -> tuple[Response, np.ndarray]:
    """The response at inputs moved by SHIFT, and the moved kx; at grazing incidence kx stays, which is exact there.

    kx is moved less than the layers: beside grazing its rounding alone decides, and nothing adds to it.

    The half-space behind is moved (by a trace of loss, which keeps its branch) apart from the layers, or what the outgoing
    state's own rounding does could cancel: a lens that is matched at both of its faces feels only the square of a change.
    """
    segments = [perturbed(s, SHIFT) for s in segments]
    grazing = outgoing_kz(kx, omega, *(v[:, None] for v in before)) == 0
    moved = np.where(grazing, kx, kx * (1 + SHIFT / 4 * np.exp(0.7j)))
    behind: FluidValues | SolidHalfSpace
    if isinstance(after, SolidHalfSpace):
        behind = solid_half_space.moved(after, SHIFT)
    else:
        behind = after._replace(rho_z=after.rho_z + 1j * SHIFT * np.abs(after.rho_z))
    two = solve(segments, before, behind, omega, moved)
    if np.any(grazing):  # a limit 0/0 there, which `solve` knows between equal half-spaces only
        at = np.any(grazing, axis=0)
        limit = solve(segments, before, after, omega, moved[:, at])
        for old, new in ((two.r, limit.r), (two.t, limit.t)):
            old[:, at] = np.where(grazing[:, at], new, old[:, at])
    return two, moved


def _errors(r: np.ndarray, t: np.ndarray, r2: np.ndarray, t2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Differences of two evaluations as relative errors; infinite where one of them is not finite."""
    with np.errstate(all="ignore"):
        r_error = np.abs(r2 - r) / np.maximum(np.abs(r), 1.0)
        t_error = np.abs(t2 - t) / np.maximum(np.maximum(np.abs(t), np.abs(t2)), FAINT)
    return tuple(np.where(np.isfinite(e), e, np.inf) for e in (r_error, t_error))  # type: ignore[return-value]


def _with_rounding(c: Checked) -> Checked:
    """Add what no perturbation shows: the last operations' rounding, and that of the logarithm from which t is made."""
    size = np.abs(c.t)
    logarithm = np.abs(np.log(np.where(size > FAINT, size, 1.0)))
    return c._replace(r_error=c.r_error + ROUNDING, t_error=c.t_error + ROUNDING * (1 + logarithm))


def _by_waves(out: Checked, stack: Stack, kx: np.ndarray, moved: np.ndarray, i: int, at: np.ndarray) -> None:
    """Replace the recursion's answers at frequency i and kx `at` by those of `reflection.py` where these are more exact."""
    r, t = reflect(stack, kx[i, at])
    errors = _errors(r, t, *reflect(stack, moved[i, at], SHIFT))
    apart = _errors(out.r[i, at], out.t[i, at], r, t)
    better = np.maximum(*errors) < np.maximum(out.r_error[i, at], out.t_error[i, at])
    for old, new in zip((out.r, out.t), (r, t), strict=True):
        old[i, at[better]] = new[better]
    for old, own, difference in zip((out.r_error, out.t_error), errors, apart, strict=True):
        # an answer that is kept has at least the difference of the two forms, less the error of `reflection.py`, as its error
        own = np.minimum(own, 1e300)
        old[i, at] = np.where(better, own, np.maximum(old[i, at], np.where(own < 1, difference - own, 0.0)))
