"""Guided modes of a slab: zeros of the dispersion function in the plane of complex kx, located by the argument principle.

Loss moves a mode off the real axis: up if it carries energy along Re kx (forward), down if against it (backward, which
negative densities allow). A mode of a lossless slab lies on the axis; the direction in which a small loss moves it is its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..response.sampled_slab import SampledSlab
from .argument_principle import (
    CLUSTER,
    Box,
    Dispersion,
    TooManyModes,
    UncertainCount,
    real_zeros,
    refine,
    winding,
    zeros,
)

#: Relative loss that shows a mode's direction: rho -> rho + i LOSS |rho|, 1/K -> 1/K + i LOSS |1/K|. Seven digits above rounding; not more,
#: because it moves a mode farther the more the densities of a slab cancel.
LOSS = 1e-8
#: A box of the search begins this far (relative) to the right of the last branch point: kz/kx, 1.4e-4 there, is clear of rounding.
BESIDE = 1e-8


class Mode(NamedTuple):
    """A zero of D: kx [rad/m], +1 forward or -1 backward, the last step of its refinement and its estimated error, over kx."""

    kx: complex
    direction: int
    residual: float
    error: float = 0.0


def dispersion_of(s: SampledSlab, loss: float = 0.0) -> Dispersion:
    """The dispersion function of a slab at one frequency, made more lossy by `loss`."""
    s = s.with_loss(loss)

    def evaluate(kx: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        value, log = s.dispersion(np.asarray(kx, complex))
        return value[0], log[0]

    return evaluate


def find_modes(s: SampledSlab, box: Box, most: float = math.inf) -> tuple[list[Mode], int]:
    """All modes in a box, and their number by the argument principle; `most`: see `zeros`.

    UncertainCount if outlines with different nodes, or the changes of sign of a lossless slab, contradict each other.
    """
    # 48 and 61 nodes a side have no common node but the corners
    f = dispersion_of(s)
    total, recount = (winding(f, box.outline(nodes), 1e-9 * box.right, most, thorough=True) for nodes in (48, 61))
    on_axis = real_zeros(f, box.left, box.right) if s.lossless and box.low < 0 < box.high else []
    if total != recount or len(on_axis) > total:
        raise UncertainCount(f"{total}, {recount} and no fewer than {len(on_axis)}")
    kx = located(s, box, total, most=most) if total > 0 else []
    modes = [_checked(s, f, m, kx.count(m.kx) > 1) for m in with_directions(s, kx)]
    return sorted(modes, key=lambda m: m.kx.real), total


def _checked(s: SampledSlab, f: Dispersion, mode: Mode, cluster: bool) -> Mode:
    """A mode with its residual, and its error: its move when layers are rounded anew; of a cluster at least its size."""
    size = abs(mode.kx)
    residual = refine(f, mode.kx, 1e-3 * size, 2)[1] / size
    k, step = refine(dispersion_of(s.rounded()), mode.kx, 1e-3 * size)
    error = max((abs(k - mode.kx) + step) / size, CLUSTER if cluster else 0.0)
    return mode._replace(residual=residual, error=error if math.isfinite(error) else math.inf)


#: D of a slab with a relative loss added: `dispersion_of`, or a function with the same zeros in the boxes that are searched.
DispersionOf = Callable[[SampledSlab, float], Dispersion]


def located(
    s: SampledSlab,
    box: Box,
    total: int,
    many: float = math.inf,
    most: float = math.inf,
    of: DispersionOf = dispersion_of,
) -> list[complex]:
    """The `total` zeros in a box, those of a lossless slab by changes of sign if all lie on the axis.

    The axis is sampled eight times as finely up to twice, for modes may lie closer together. TooManyModes if more than `many` have
    to be located by halving boxes, or if that takes more than `most` values of D (see `zeros`).
    """
    f = of(s, 0.0)
    if s.lossless and box.low < 0 < box.high:
        for samples in (600, 4800, 38_400):
            on_axis = real_zeros(f, box.left, box.right, samples, 8 * many)
            if len(on_axis) >= total:
                return on_axis
    if total > many:
        raise TooManyModes
    return zeros(f, box, box.right, total, most)


def with_directions(s: SampledSlab, kx: list[complex], of: DispersionOf = dispersion_of) -> list[Mode]:
    """Zeros as modes, forward or backward."""
    return [Mode(k, _direction(s, k, kx.count(k) > 1, of), 0.0) for k in kx]


def _direction(s: SampledSlab, k: complex, cluster: bool, of: DispersionOf) -> int:
    """+1 if the mode decays along +Re kx, or would with a small loss."""
    # nearer to the axis than `blur`, over kx, a mode may lie on it; a cluster, located to half the digits, takes more loss too
    blur, loss = (1e-7, 1e3 * LOSS) if cluster else (1e-9, LOSS)
    if abs(k.imag) > blur * abs(k):
        return 1 if k.imag > 0 else -1
    moved, _ = refine(of(s, loss), k, 1e-4 * abs(k))
    if cluster and abs((moved - k).imag) < blur * abs(k):
        raise TooManyModes
    return 1 if (moved - k).imag >= 0 else -1
